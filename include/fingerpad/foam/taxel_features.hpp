// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Features of a foam finger at each sample: where it is pressed, which taxel vibrates and how fast.
// Source: "Pre-Slip Sensing Using Tactile Sensor" (2007), the data of its stack: x-bar and y-bar,
// vibrating location, and vibration frequency as the number of sensed waves. The paper gives no
// formulas for them; here they are
//
//   centroid   sum of reading x position / sum of readings, over the taxels that press
//   location   the taxel whose readings deviate most from a straight line in the window, by more
//              than its noise: a grip that is loosened evenly does not vibrate. Among equals, the
//              first in row-major order
//   waves      crossings of that line, two per wave. They are counted per window of samples, so
//              that a gap of the clock does not reduce their number. A step, as of a taxel that
//              lets go, counts as one wave that has begun. Waves shorter than three samples may be
//              missed
//
// "Some tactile elements" may vibrate: all of them are listed, each with its waves.
// Taxels that are dead, saturated, stuck, flickering or missing are left out. They can vibrate
// again a whole window after they were last bad.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/detail/taxel_window.hpp"
#include "fingerpad/foam/finger_sample.hpp"
#include "fingerpad/foam/taxel_options.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

/// Time from the oldest sample to one period beyond the newest.
inline double span_s(const double* time_s, Index length) {
  const double length_s = time_s[length - 1] - time_s[0];
  return length_s / static_cast<double>(length - 1) * static_cast<double>(length);
}

/// The waves in the residuals of a taxel. A crossing counts when the signal exceeds half of its rms
/// on the other side, so that noise on a slow wave does not count.
template <scalar S>
Index count_waves(const S* residual, Index length, const S& rms) {
  const auto beyond = value(rms) / 2;
  int side = 0, crossings = 0;
  for (Index u = 0; u < length; ++u) {
    const auto r = value(residual[u]);
    const int now = r > beyond ? 1 : r < -beyond ? -1 : side;
    crossings += now != side && side != 0 ? 1 : 0;
    side = now;
  }
  return (crossings + 1) / 2;
}

}  // namespace detail

/// Features of one finger, sample by sample. One object serves any number of fingers of its size,
/// each with its own state. A sample takes O(rows cols window) time. It allocates nothing and
/// throws nothing.
template <scalar S = double>
class TaxelFeatures {
  using Real = scalar_real_t<S>;

 public:
  /// The window of one finger. A value: copy it to return to this sample later.
  class State {
   public:
    /// A taxel that vibrates.
    struct Vibrating {
      Index location;
      Index waves;
      S deviation;  // rms, in the unit of the readings
    };

    /// All taxels that vibrate in the newest sample, row by row.
    std::span<const Vibrating> vibrating() const { return vibrating_; }

    /// Forgets all samples.
    void reset() {
      vibrating_.clear();
      samples_ = 0;
      unfilled_for_ = 0;
    }
    /// Samples since the start or the last new clock, at most a window.
    Index samples() const { return samples_; }

   private:
    friend class TaxelFeatures;
    State(Index taxels, Index length)
        : window_(taxels, length),
          held_(static_cast<std::size_t>(taxels), S(0)),
          same_for_(held_.size(), 0),
          bad_for_(held_.size(), 0),
          returned_for_(held_.size(), 0),
          time_s_(static_cast<std::size_t>(length), 0.0),
          is_gap_(time_s_.size(), 0),
          spread_(held_.size(), S(0)),
          residual_(time_s_.size(), S(0)) {
      vibrating_.reserve(held_.size());
    }

    detail::TaxelWindow<S> window_;
    std::vector<S> held_;               // the last good reading of each taxel
    std::vector<Index> same_for_;       // samples since it last changed
    std::vector<Index> bad_for_;        // samples until it can vibrate again
    std::vector<Index> returned_for_;   // samples for which its return from 0 is remembered
    std::vector<double> time_s_;        // of the window, oldest first; gaps shortened
    std::vector<std::uint8_t> is_gap_;  // whether a gap precedes each of them
    std::vector<S> spread_;             // variance of each taxel about its line
    std::vector<S> residual_;
    detail::ReservedVector<Vibrating> vibrating_;
    Index samples_ = 0;
    Index unfilled_for_ = 0;    // samples since the window was last full
    Index unchanged_for_ = 0;   // samples since any reading changed
    double last_time_s_ = 0;    // as received
    Real typical_ = Real(0);    // mean reading of the taxels that press, in the last sample
    bool has_changed_ = false;  // since the start or the last new clock
    bool has_rested_ = false;
  };

  /// Refuses bad parameters (parameter_error).
  TaxelFeatures(Index rows, Index cols, const TaxelOptions<S>& options = {})
      : rows_(rows), cols_(cols), options_(options) {
    check();
    floor_.assign(static_cast<std::size_t>(rows * cols), floor_of(value(options.noise)));
  }

  /// With a standard deviation for each taxel. A value that is not >= 0, such as NaN, marks a dead
  /// taxel.
  template <grid Noise>
    requires std::constructible_from<S, cell_t<Noise>>
  explicit TaxelFeatures(const Noise& noise, const TaxelOptions<S>& options = {})
      : rows_(fingerpad::rows(noise)), cols_(fingerpad::cols(noise)), options_(options) {
    check();
    const auto of = as_view(noise);
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        floor_.push_back(floor_of(value(static_cast<S>(of(i, j)))));
      }
    }
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  const TaxelOptions<S>& options() const { return options_; }

  /// The state before any sample, with all the memory that samples will need.
  State start() const { return State(rows_ * cols_, options_.window); }

  /// Features of the sample received at `time_s`. Readings that are NaN, saturated, or a billion or
  /// more are left out. So is a taxel that twice in a window returns from 0 to more than others
  /// read (a loose contact). A time that is NaN or not later than the last one is refused. A time
  /// earlier by more than a window or longest_gap_s, whichever is shorter, or later by more than
  /// longest_gap_s, starts a new clock.
  template <grid Taxels>
    requires std::constructible_from<S, cell_t<Taxels>> FingerSample<S>
  operator()(const Taxels& taxels, double time_s, State& state) const {
    FingerSample<S> sample;
    const auto readings = as_view(taxels);
    if (readings.rows() != rows_ || readings.cols() != cols_ ||
        state.window_.taxels() != rows_ * cols_ || state.window_.length() != options_.window) {
      sample.status = TaxelStatus::other_size;
      return sample;
    }
    const Clock clock = tell(time_s, state);
    if (clock == Clock::not_later) {
      sample.status = TaxelStatus::time_not_later;
      return sample;
    }
    if (clock == Clock::is_new) {
      forget(state);
    }
    read(readings, sample, state);
    store(time_s, state);
    judge(sample, state);
    return sample;
  }

 private:
  enum class Clock : std::uint8_t { runs, is_new, not_later };

  static constexpr Real infinite() { return (std::numeric_limits<Real>::infinity)(); }

  void check() const {
    expects(rows_ >= 1 && rows_ <= 4096, "TaxelFeatures", "rows", static_cast<long long>(rows_),
            "in [1, 4096]");
    expects(cols_ >= 1 && cols_ <= 4096, "TaxelFeatures", "cols", static_cast<long long>(cols_),
            "in [1, 4096]");
    expects_valid(options_);
    expects_grid_size("TaxelFeatures", rows_, cols_, 1, options_.window);
  }

  Real floor_of(const Real& noise) const {
    const Real beyond = value(options_.noise_factor) * noise;
    return noise >= 0 ? Real(beyond * beyond) : infinite();
  }

  Clock tell(double time_s, const State& state) const {
    if (!is_finite(time_s)) {
      return Clock::not_later;
    }
    if (state.samples_ == 0) {
      return Clock::is_new;
    }
    const double step = time_s - state.last_time_s_;
    const double longest = static_cast<double>(value(options_.longest_gap_s));
    const double window = period_s() * static_cast<double>(options_.window);
    const bool is_new = step > longest || step < -(std::min)(window, longest);
    return is_new ? Clock::is_new : step > 0 ? Clock::runs : Clock::not_later;
  }

  double period_s() const { return static_cast<double>(value(options_.sample_period_s)); }

  static void forget(State& state) {
    state.samples_ = 0;
    state.unchanged_for_ = 0;
    state.typical_ = Real(0);
    state.has_changed_ = state.has_rested_ = false;
    std::fill(state.held_.begin(), state.held_.end(), S(0));
    std::fill(state.same_for_.begin(), state.same_for_.end(), 0);
    std::fill(state.bad_for_.begin(), state.bad_for_.end(), 0);
    std::fill(state.returned_for_.begin(), state.returned_for_.end(), 0);
  }

  /// Stores the usable readings and computes the centroid of those that press.
  template <class View>
  void read(const View& readings, FingerSample<S>& sample, State& state) const {
    S sum_x = S(0), sum_y = S(0);
    Index pressed = 0;
    std::size_t k = 0;
    ++state.unchanged_for_;
    for (Index i = 0; i < rows_; ++i) {
      S row_sum = S(0);
      for (Index j = 0; j < cols_; ++j, ++k) {
        const S reading = static_cast<S>(readings(i, j));
        if (!counts(reading, k, state)) {
          ++sample.left_out;
        } else if (value(reading) > 0) {
          row_sum = row_sum + reading;
          sum_x = sum_x + S(reading * S(static_cast<int>(j)));
          ++pressed;
        }
        sample.frozen += is_frozen(k, state) ? 1 : 0;
      }
      sample.sum = sample.sum + row_sum;
      sum_y = sum_y + S(row_sum * S(static_cast<int>(i)));
    }
    state.typical_ = pressed > 0 ? value(sample.sum) / Real(static_cast<double>(pressed)) : Real(0);
    if (value(sample.sum) > 0 && value(sample.sum) >= value(options_.min_sum)) {
      sample.center_x_mm = S(sum_x * options_.pitch_mm) / sample.sum;
      sample.center_y_mm = S(sum_y * options_.pitch_mm) / sample.sum;
    }
  }

  /// Whether the reading of a taxel counts now. Updates what is remembered of the taxel.
  bool counts(const S& reading, std::size_t k, State& state) const {
    const bool is_good =
        detail::is_reading(reading) && value(reading) < value(options_.saturated_at);
    Index& bad_for = state.bad_for_[k];
    if (!is_good) {
      bad_for = options_.window;
      state.same_for_[k] = 0;
      return false;
    }
    bad_for = bad_for > 0 ? bad_for - 1 : 0;
    const Real before = value(state.held_[k]);
    const bool is_same = state.samples_ > 0 && value(reading) == before;
    if (!is_same && state.samples_ > 0) {
      state.unchanged_for_ = 0;
      state.has_changed_ = true;
    }
    state.same_for_[k] = is_same ? state.same_for_[k] + 1 : 0;
    look_for_flicker(before, value(reading), k, state);
    state.held_[k] = reading;
    const bool flickers = bad_for > 0 && state.returned_for_[k] > 0;
    return floor_[k] < infinite() && !flickers && !(is_frozen(k, state) && value(reading) != 0);
  }

  /// Detects a loose contact: a taxel that returns from 0 to more than others read, twice in a
  /// window.
  void look_for_flicker(const Real& before, const Real& now, std::size_t k, State& state) const {
    Index& returned_for = state.returned_for_[k];
    returned_for = returned_for > 0 ? returned_for - 1 : 0;
    if (state.samples_ > 0 && before == 0 && now > state.typical_ && now * now > floor_[k]) {
      state.bad_for_[k] = returned_for > 0 ? options_.window : state.bad_for_[k];
      returned_for = options_.window;
    }
  }

  bool is_frozen(std::size_t k, const State& state) const {
    return options_.stuck_after > 0 && state.same_for_[k] >= options_.stuck_after;
  }

  /// Stores time and readings of the sample; a gap counts as two periods.
  void store(double time_s, State& state) const {
    if (state.samples_ == 0) {
      state.window_.restart(state.held_.data());
      std::fill(state.time_s_.begin(), state.time_s_.end(), time_s);
      std::fill(state.is_gap_.begin(), state.is_gap_.end(), std::uint8_t{0});
    } else {
      const double step = time_s - state.last_time_s_, longest = 2 * period_s();
      const double now_s = state.time_s_.back() + (std::min)(step, longest);
      state.window_.push(state.held_.data());
      std::move(state.time_s_.begin() + 1, state.time_s_.end(), state.time_s_.begin());
      std::move(state.is_gap_.begin() + 1, state.is_gap_.end(), state.is_gap_.begin());
      state.time_s_.back() = now_s;
      state.is_gap_.back() = step > longest ? 1 : 0;
    }
    state.last_time_s_ = time_s;
    state.samples_ = (std::min)(state.samples_ + 1, options_.window);
    const bool is_full = state.samples_ == options_.window;
    state.unfilled_for_ =
        is_full ? 0 : (std::min)(state.unfilled_for_ + 1, 2 * options_.window + 1);
  }

  /// Sets the status of the sample: its vibration, or why this cannot be judged.
  void judge(FingerSample<S>& sample, State& state) const {
    state.vibrating_.clear();
    sample.has_rested = state.has_rested_;
    sample.gaps = std::count(state.is_gap_.begin() + 1, state.is_gap_.end(), std::uint8_t{1});
    if (state.unfilled_for_ > 2 * options_.window || 2 * sample.gaps > options_.window) {
      sample.status = TaxelStatus::clock_jumps;
    } else if (sample.left_out == rows_ * cols_ && sample.frozen == 0) {
      sample.status = TaxelStatus::no_taxels;
    } else if (state.samples_ < options_.window) {
      sample.status = TaxelStatus::filling;
    } else if (sample.left_out == rows_ * cols_ || is_frozen(state)) {
      sample.status = TaxelStatus::frozen;
    } else if (!find_vibration(sample, state)) {
      sample.status = status_without_vibration(state);
      state.has_rested_ = state.has_rested_ || sample.status == TaxelStatus::quiet;
      sample.has_rested = state.has_rested_;
    }
  }

  /// Whether no reading has changed for `stuck_after` samples, or ever.
  bool is_frozen(const State& state) const {
    return options_.stuck_after > 0 &&
           (!state.has_changed_ || state.unchanged_for_ >= options_.stuck_after);
  }

  /// `quiet` if some taxel that can be judged reads enough to vibrate.
  TaxelStatus status_without_vibration(const State& state) const {
    TaxelStatus status = TaxelStatus::no_taxels;
    for (std::size_t k = 0; k < floor_.size(); ++k) {
      if (can_vibrate(k, state)) {
        const Real reading = value(state.held_[k]);
        const bool presses = reading > 0 && reading * reading > floor_[k];
        status =
            presses || status == TaxelStatus::quiet ? TaxelStatus::quiet : TaxelStatus::too_weak;
      }
    }
    return status;
  }

  /// Whether the taxel was good in its whole window.
  bool can_vibrate(std::size_t k, const State& state) const {
    return floor_[k] < infinite() && state.bad_for_[k] == 0 && !is_frozen(k, state);
  }

  /// Lists the taxels that vibrate and copies the strongest to the sample. False: none vibrates.
  bool find_vibration(FingerSample<S>& sample, State& state) const {
    state.window_.variances(state.spread_.data());
    for (std::size_t k = 0; k < floor_.size(); ++k) {
      if (value(state.spread_[k]) > floor_[k] && can_vibrate(k, state)) {
        list(static_cast<Index>(k), state);
      }
    }
    if (state.vibrating_.empty()) {
      return false;
    }
    const auto& most = *std::max_element(
        state.vibrating_.begin(), state.vibrating_.end(),
        [](const auto& a, const auto& b) { return value(a.deviation) < value(b.deviation); });
    sample.status = TaxelStatus::vibrating;
    sample.location = most.location;
    sample.waves = most.waves;
    sample.frequency_hz =
        S(static_cast<double>(most.waves) / detail::span_s(state.time_s_.data(), options_.window));
    sample.deviation = most.deviation;
    sample.add_vibration({most.waves, most.location});
    for (const auto& one : state.vibrating_) {
      sample.add_vibration({one.waves, one.location});
    }
    return true;
  }

  /// Adds a taxel to the list, unless its variance vanishes when computed anew.
  void list(Index location, State& state) const {
    using std::sqrt;
    const S mean_square = state.window_.residuals(location, state.residual_.data());
    if (value(mean_square) > 0) {
      const S rms = S(sqrt(mean_square));
      const Index waves = detail::count_waves(state.residual_.data(), options_.window, rms);
      state.vibrating_.push_back({location, waves, rms});
    }
  }

  Index rows_;
  Index cols_;
  TaxelOptions<S> options_;
  // variance above which each taxel vibrates; infinite: dead
  std::vector<Real> floor_;
};

}  // namespace v0
}  // namespace fingerpad
