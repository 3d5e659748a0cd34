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
// again a whole window after they were last bad. Where most taxels that press are frozen, none is
// stuck: an object is held still.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/finger_sample.hpp"

namespace fingerpad {
inline namespace v0 {

/// The array and its window. Readings are in the sensor's own unit (counts, V, N). The paper prints
/// no values; the defaults suit arrays of 12-bit counts read 30 times a second.
struct TaxelOptions {
  double pitch_mm = 3.4;             ///< distance of neighbouring taxels, > 0
  Index window = 16;                 ///< samples in which vibration is detected, in [4, 4096]
  double sample_period_s = 1. / 30;  ///< nominal, > 0
  /// A gap counts as at most two periods. A gap longer than this, or a clock that is set back,
  /// begins a new window. > 0.
  double longest_gap_s = 2;
  double noise = 6;           ///< standard deviation of a taxel at rest, >= 0
  double noise_factor = 2.5;  ///< vibration exceeds this many standard deviations, >= 0
  double min_sum = 0;         ///< with a smaller sum of readings there is no centroid, >= 0
  double saturated_at = 1e9;  ///< this reading and larger ones do not count, in (0, 1e9]
  /// A reading that was the same in this many samples is frozen. Unless it is 0, or more than half
  /// of those that press are frozen, it does not count. >= 0; 0: not checked.
  Index stuck_after = 30;
};

/// Says which option has no meaning; "" if all have one.
inline std::string check(const TaxelOptions& o) {
  return check("TaxelOptions",
               {{"pitch_mm", o.pitch_mm, positive},
                {"window", o.window, within(4, 4096)},
                {"sample_period_s", o.sample_period_s, positive},
                {"longest_gap_s", o.longest_gap_s, positive},
                {"noise", o.noise, not_negative},
                {"noise_factor", o.noise_factor, not_negative},
                {"min_sum", o.min_sum, not_negative},
                {"saturated_at", o.saturated_at, {.min = 0, .max = 1e9, .above_min = true}},
                {"stuck_after", o.stuck_after, not_negative}});
}

namespace detail {

/// The last n readings of every taxel, and how much they vary about a straight line. Sums are those
/// of the differences from the newest reading, so that a large reading costs no digits; places in
/// the window are counted from its middle.
template <scalar S>
class TaxelWindow {
 public:
  TaxelWindow(std::size_t taxels, Index length)
      : length_(length),
        readings_(taxels * static_cast<std::size_t>(length), S(0)),
        sum_(taxels, S(0)),
        tilt_(sum_) {}

  /// Replaces the oldest reading of every taxel by reading(k); at first all readings.
  template <class Reading>
  void push(const Reading& reading, bool is_first) {
    for (Index u = is_first ? 0 : length_ - 1; u < length_; ++u) {
      const std::size_t begin = static_cast<std::size_t>(oldest_) * sum_.size();
      for (std::size_t k = 0; k < sum_.size(); ++k) {
        readings_[begin + k] = reading(k);
      }
      oldest_ = (oldest_ + 1) % length_;
    }
  }

  /// Mean square of the residuals of each taxel about its line; roundoff may make it negative.
  /// O(taxels length).
  void variances(S* out) {
    std::fill(sum_.begin(), sum_.end(), S(0));
    std::fill(tilt_.begin(), tilt_.end(), S(0));
    std::fill(out, out + sum_.size(), S(0));
    const S* const newest = row(length_ - 1);
    for (Index u = 0; u < length_; ++u) {
      const S* const now = row(u);
      const S from_middle = from_middle_of(u);
      for (std::size_t k = 0; k < sum_.size(); ++k) {
        const S d = now[k] - newest[k];
        sum_[k] = sum_[k] + d;
        tilt_[k] = tilt_[k] + from_middle * d;
        out[k] = out[k] + d * d;
      }
    }
    for (std::size_t k = 0; k < sum_.size(); ++k) {
      out[k] = (out[k] - square(sum_[k]) / n() - square(tilt_[k]) * per_spread()) / n();
    }
  }

  /// Residuals of a taxel about its line, oldest first, after variances(). Returns their mean
  /// square.
  S residuals(std::size_t taxel, S* out) const {
    S squares = S(0);
    for (Index u = 0; u < length_; ++u) {
      const S line = sum_[taxel] / n() + tilt_[taxel] * per_spread() * from_middle_of(u);
      out[u] = row(u)[taxel] - row(length_ - 1)[taxel] - line;
      squares = squares + square(out[u]);
    }
    return squares / n();
  }

 private:
  S n() const { return S(static_cast<int>(length_)); }
  /// 1 / sum of the squared distances from the middle.
  S per_spread() const { return S(12) / (n() * (square(n()) - S(1))); }
  S from_middle_of(Index u) const { return S(static_cast<int>(2 * u + 1 - length_)) / S(2); }
  /// Readings at one time; u is 0 for the oldest.
  const S* row(Index u) const {
    return readings_.data() + static_cast<std::size_t>((oldest_ + u) % length_) * sum_.size();
  }

  Index length_;
  Index oldest_ = 0;
  std::vector<S> readings_;  // length x taxels, a ring from `oldest_`
  std::vector<S> sum_;       // of each taxel, in variances()
  std::vector<S> tilt_;
};

/// The waves in the residuals of a taxel. A crossing counts when the signal exceeds half of its rms
/// on the other side, so that noise on a slow wave does not count.
template <scalar S>
Index count_waves(const std::vector<S>& residuals, const S& rms) {
  const auto beyond = value(rms) / 2;
  int side = 0, crossings = 0;
  for (const S& residual : residuals) {
    const auto r = value(residual);
    const int now = r > beyond ? 1 : r < -beyond ? -1 : side;
    crossings += now != side && side != 0 ? 1 : 0;
    side = now;
  }
  return (crossings + 1) / 2;
}

/// Whether a reading is a number between minus a billion and saturation; false for NaN.
template <scalar S>
bool is_reading(const S& reading, const TaxelOptions& options) {
  return -1000000000 < value(reading) && value(reading) < scalar_real_t<S>(options.saturated_at);
}

}  // namespace detail

/// Features of one finger, sample by sample. It keeps the last window: one object a finger; copy it
/// to return to this sample later. A sample takes O(taxels window) time. It allocates nothing and
/// throws nothing.
template <scalar S = double>
class TaxelFeatures {
  using Real = scalar_real_t<S>;

 public:
  /// A finger of rows x cols taxels, which are listed row by row. `noise`: standard deviation of
  /// each at rest, NaN: dead; empty: that of the options for all. `places_mm`: where each is, x
  /// along columns; empty: on a regular array from the first taxel at 0. So a finger of several
  /// arrays, like that of the paper with 204 elements on five sides, is one column of all their
  /// taxels, with places in the unrolled plan of its sides. Refuses bad parameters
  /// (parameter_error).
  TaxelFeatures(Index rows,
                Index cols,
                const TaxelOptions& options = {},
                std::span<const S> noise = {},
                std::span<const Point2<S>> places_mm = {})
      : rows_(checked(rows, cols, options, noise, places_mm)),
        cols_(cols),
        options_(options),
        taxels_(static_cast<std::size_t>(rows * cols)),
        window_(taxels_.size(), options.window),
        clock_(static_cast<std::size_t>(options.window)),
        variances_(taxels_.size(), S(0)),
        residuals_(clock_.size(), S(0)) {
    const S pitch_mm = S(options.pitch_mm);
    for (std::size_t k = 0; k < taxels_.size(); ++k) {
      const S row = S(static_cast<int>(k) / static_cast<int>(cols));
      const S col = S(static_cast<int>(k) % static_cast<int>(cols));
      const Real sd = noise.empty() ? Real(options.noise) : value(noise[k]);
      taxels_[k].place_mm =
          places_mm.empty() ? Point2<S>{col * pitch_mm, row * pitch_mm} : places_mm[k];
      require("TaxelFeatures", {{"places_mm.x", taxels_[k].place_mm.x, finite_number},
                                {"places_mm.y", taxels_[k].place_mm.y, finite_number}});
      taxels_[k].floor = sd >= 0 ? square(Real(options.noise_factor) * sd) : infinite();
    }
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  const TaxelOptions& options() const { return options_; }
  /// Samples since the start or the last new clock, at most a window.
  Index samples() const { return samples_; }

  /// Forgets all samples.
  void reset() { samples_ = unfilled_for_ = 0; }

  /// Features of the sample received at `time_s`. Readings that are NaN, saturated, or a billion or
  /// more are left out. So is a taxel that twice in a window returns from 0 to more than others
  /// read (a loose contact). A time that is NaN or not later than the last one is refused. A time
  /// earlier by more than a window or longest_gap_s, whichever is shorter, or later by more than
  /// longest_gap_s, starts a new clock.
  template <grid Readings>
    requires std::constructible_from<S, cell_t<Readings>> FingerSample<S>
  operator()(const Readings& readings, double time_s) {
    FingerSample<S> sample;
    const auto now = as_view(readings);
    const double step_s = time_s - clock_.back().received_s;
    const double window_s = options_.sample_period_s * static_cast<double>(options_.window);
    const bool is_new = samples_ == 0 || step_s > options_.longest_gap_s ||
                        step_s < -(std::min)(window_s, options_.longest_gap_s);
    if (now.rows() != rows_ || now.cols() != cols_ || !is_finite(time_s) ||
        !(is_new || step_s > 0)) {
      sample.status = TaxelStatus::refused;
      return sample;
    }
    if (is_new) {
      forget();
    }
    read(now, sample);
    store(time_s);
    judge(sample);
    return sample;
  }

 private:
  /// What is known of a taxel.
  struct Taxel {
    Point2<S> place_mm = {S(0), S(0)};
    Real floor = Real(0);    // variance above which it vibrates; infinite: dead
    S reading = S(0);        // the last good one
    Index same_for = 0;      // samples since it last changed
    Index bad_for = 0;       // samples until the taxel can vibrate again
    Index returned_for = 0;  // samples for which its return from 0 is remembered
    Index waves = 0;         // in the window, if it vibrates
  };
  /// Time of a sample.
  struct Instant {
    double received_s = 0;
    double counted_s = 0;  // gaps shortened to two periods
    bool is_gap = false;   // a gap precedes it
  };

  static constexpr Real infinite() { return (std::numeric_limits<Real>::infinity)(); }

  static Index checked(Index rows,
                       Index cols,
                       const TaxelOptions& options,
                       std::span<const S> noise,
                       std::span<const Point2<S>> places_mm) {
    require(options);
    expects_grid_size("TaxelFeatures", rows, cols, 1, options.window);
    for (const std::size_t size : {noise.size(), places_mm.size()}) {
      expects(size == 0 || static_cast<Index>(size) == rows * cols, "TaxelFeatures",
              "size of noise or places_mm", size, "0 or rows * cols");
    }
    return rows;
  }

  void forget() {
    samples_ = 0;
    unchanged_for_ = options_.stuck_after;
    typical_ = Real(0);
    has_rested_ = false;
    for (Taxel& taxel : taxels_) {
      taxel.reading = S(0);
      taxel.same_for = taxel.bad_for = taxel.returned_for = 0;
    }
  }

  /// Stores the usable readings and computes the centroid of those that press.
  template <class View>
  void read(const View& readings, FingerSample<S>& sample) {
    Point2<S> moment = {S(0), S(0)}, frozen_moment = moment;
    S frozen_sum = S(0);
    int pressed = 0, frozen = 0;
    ++unchanged_for_;
    for (std::size_t k = 0; k < taxels_.size(); ++k) {
      const auto at = static_cast<Index>(k);
      const S reading = static_cast<S>(readings(at / cols_, at % cols_));
      const bool is_counted = counts(reading, taxels_[k]), is_held = is_frozen(taxels_[k]);
      if (!is_counted) {
        ++sample.left_out;
      } else if (value(reading) > 0) {
        (is_held ? frozen_sum : sample.sum) = (is_held ? frozen_sum : sample.sum) + reading;
        (is_held ? frozen_moment : moment) += reading * taxels_[k].place_mm;
        ++(is_held ? frozen : pressed);
      }
      sample.frozen += is_held ? 1 : 0;
    }
    if (frozen > pressed) {
      sample.sum = sample.sum + frozen_sum;
      moment += frozen_moment;
      pressed += frozen;
    } else {
      sample.left_out += frozen;
    }
    typical_ = pressed > 0 ? value(sample.sum) / Real(pressed) : Real(0);
    if (value(sample.sum) > 0 && value(sample.sum) >= Real(options_.min_sum)) {
      sample.center_x_mm = moment.x / sample.sum;
      sample.center_y_mm = moment.y / sample.sum;
    }
  }

  /// Whether the reading of a taxel counts now. Updates what is remembered of the taxel.
  bool counts(const S& reading, Taxel& taxel) {
    if (!detail::is_reading(reading, options_)) {
      taxel.bad_for = options_.window;
      taxel.same_for = 0;
      return false;
    }
    const Real before = value(taxel.reading), now = value(reading);
    const bool is_same = samples_ > 0 && now == before;
    if (!is_same && samples_ > 0) {
      unchanged_for_ = 0;
    }
    taxel.same_for = is_same ? taxel.same_for + 1 : 0;
    taxel.bad_for = (std::max)(taxel.bad_for - 1, Index(0));
    taxel.returned_for = (std::max)(taxel.returned_for - 1, Index(0));
    // a loose contact: twice in a window from 0 to more than others read
    if (samples_ > 0 && before == 0 && now > typical_ && now * now > taxel.floor) {
      taxel.bad_for = taxel.returned_for > 0 ? options_.window : taxel.bad_for;
      taxel.returned_for = options_.window;
    }
    taxel.reading = reading;
    const bool flickers = taxel.bad_for > 0 && taxel.returned_for > 0;
    return taxel.floor < infinite() && !flickers;
  }

  bool is_frozen(const Taxel& taxel) const {
    return options_.stuck_after > 0 && taxel.same_for >= options_.stuck_after;
  }

  /// Stores time and readings of the sample.
  void store(double time_s) {
    const bool is_first = samples_ == 0;
    window_.push([&](std::size_t k) { return taxels_[k].reading; }, is_first);
    if (is_first) {
      std::fill(clock_.begin(), clock_.end(), Instant{time_s, time_s});
    } else {
      const Instant last = clock_.back();
      const double step_s = time_s - last.received_s, longest_s = 2 * options_.sample_period_s;
      std::move(clock_.begin() + 1, clock_.end(), clock_.begin());
      clock_.back() = {time_s, last.counted_s + (std::min)(step_s, longest_s), step_s > longest_s};
    }
    samples_ = (std::min)(samples_ + 1, options_.window);
    unfilled_for_ =
        samples_ == options_.window ? 0 : (std::min)(unfilled_for_ + 1, 2 * options_.window + 1);
  }

  /// Sets the status of the sample: its vibration, or why this cannot be judged.
  void judge(FingerSample<S>& sample) {
    const Index gaps =
        std::count_if(clock_.begin() + 1, clock_.end(), [](const Instant& t) { return t.is_gap; });
    const bool none_counts = sample.left_out == static_cast<Index>(taxels_.size());
    const bool none_changes = options_.stuck_after > 0 && unchanged_for_ >= options_.stuck_after;
    if (unfilled_for_ > 2 * options_.window || 2 * gaps > options_.window) {
      sample.status = TaxelStatus::clock_jumps;
    } else if (none_counts && sample.frozen == 0) {
      sample.status = TaxelStatus::no_taxels;
    } else if (samples_ < options_.window) {
      sample.status = TaxelStatus::filling;
    } else if (none_counts || none_changes) {
      sample.status = TaxelStatus::frozen;
    } else {
      sample.status = has_vibration(sample) ? TaxelStatus::vibrating : status_without_vibration();
      has_rested_ = has_rested_ || sample.status == TaxelStatus::quiet;
    }
    sample.has_rested = has_rested_;
  }

  /// `quiet` if some taxel that can be judged reads enough to vibrate.
  TaxelStatus status_without_vibration() const {
    TaxelStatus status = TaxelStatus::no_taxels;
    for (const Taxel& taxel : taxels_) {
      if (can_vibrate(taxel)) {
        const Real reading = value(taxel.reading);
        if (reading > 0 && reading * reading > taxel.floor) {
          return TaxelStatus::quiet;
        }
        status = TaxelStatus::too_weak;
      }
    }
    return status;
  }

  /// Whether the taxel was good in its whole window.
  bool can_vibrate(const Taxel& taxel) const {
    return taxel.floor < infinite() && taxel.bad_for == 0 && !is_frozen(taxel);
  }

  /// Adds the taxels that vibrate to the sample, the strongest first. False: none vibrates.
  bool has_vibration(FingerSample<S>& sample) {
    using std::sqrt;
    window_.variances(variances_.data());
    std::size_t most = 0;
    for (std::size_t k = 0; k < taxels_.size(); ++k) {
      const bool is_beyond = value(variances_[k]) > taxels_[k].floor && can_vibrate(taxels_[k]);
      // anew: roundoff alone is no vibration
      variances_[k] = is_beyond ? window_.residuals(k, residuals_.data()) : S(0);
      if (value(variances_[k]) > 0) {
        taxels_[k].waves = detail::count_waves(residuals_, S(sqrt(variances_[k])));
        most = value(variances_[most]) < value(variances_[k]) ? k : most;
      }
    }
    if (!(value(variances_[most]) > 0)) {
      return false;
    }
    sample.add_vibration(static_cast<Index>(most), taxels_[most].waves);
    for (std::size_t k = 0; k < taxels_.size(); ++k) {
      if (value(variances_[k]) > 0) {
        sample.add_vibration(static_cast<Index>(k), taxels_[k].waves);
      }
    }
    sample.deviation = sqrt(variances_[most]);
    // from the oldest sample to one period beyond the newest
    const double periods = static_cast<double>(options_.window - 1);
    const double period_s = (clock_.back().counted_s - clock_.front().counted_s) / periods;
    const double window_s = period_s * static_cast<double>(options_.window);
    sample.frequency_hz = S(static_cast<double>(sample.waves) / window_s);
    return true;
  }

  Index rows_;
  Index cols_;
  TaxelOptions options_;
  std::vector<Taxel> taxels_;
  detail::TaxelWindow<S> window_;
  std::vector<Instant> clock_;  // of the window, oldest first
  std::vector<S> variances_;    // of each taxel about its line; 0: it does not vibrate
  std::vector<S> residuals_;    // of one taxel
  Index samples_ = 0;
  Index unfilled_for_ = 0;   // samples since the window was last full
  Index unchanged_for_ = 0;  // samples since any reading changed; stuck_after: none ever has
  Real typical_ = Real(0);   // mean reading of the taxels that press, in the last sample
  bool has_rested_ = false;  // a window was quiet since the start or the last new clock
};

}  // namespace v0
}  // namespace fingerpad
