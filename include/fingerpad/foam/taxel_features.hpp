// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a foam finger feels at each sample: where it is pressed, which taxel vibrates and how fast.
// Source: "Pre-Slip Sensing Using Tactile Sensor" (2007), the data of its stack: x-bar and y-bar,
// vibrating location, and vibration frequency as the number of sensed waves. The paper gives no
// formulas for them; here they are
//
//   centroid   sum of reading x place / sum of readings, over the taxels that press
//   location   the taxel whose readings spread most in the window, beyond its noise; of equals the
//              first in row-major order
//   waves      crossings of the mean by that taxel, or the strongest line of its spectrum
//
// Taxels that are dead, saturated, stuck or missing are left out, and come back a whole window
// after they were last bad.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/detail/taxel_health.hpp"
#include "fingerpad/foam/finger_sample.hpp"
#include "fingerpad/foam/taxel_options.hpp"

namespace fingerpad {
inline namespace v0 {

/// Features of one finger, sample by sample. Waves: ZeroCrossings or SpectralPeak; Level:
/// TrendRemoved or MeanRemoved. Const: one serves any number of fingers of its size, each with a
/// state of its own. A sample takes O(rows cols) time, and what Waves says while a taxel vibrates;
/// after a jump of the clock O(rows cols window). Nothing is allocated or thrown.
template <class Waves = ZeroCrossings, class Level = TrendRemoved, scalar S = double>
class TaxelFeatures {
  using Real = scalar_real_t<S>;
  using Health = detail::TaxelHealth<S>;

 public:
  /// The window of one finger. A value: copy it to go back to this sample later.
  class State {
   public:
    /// Forgets all samples.
    void reset() { samples_ = 0; }
    /// Samples since the start or the last jump of the clock, at most a window.
    Index samples() const { return samples_; }

   private:
    friend class TaxelFeatures;
    State(Index taxels, Index length)
        : window_(taxels, length),
          health_(taxels),
          spread_(static_cast<std::size_t>(taxels), Real(0)),
          time_s_(static_cast<std::size_t>(length), S(0)),
          residual_(time_s_.size(), S(0)),
          scratch_(length) {}

    detail::TaxelWindow<Level, S> window_;
    detail::TaxelHealth<S> health_;
    std::vector<Real> spread_;  // variance of those beyond their floor, else 0
    std::vector<S> time_s_;     // of the window, oldest first
    std::vector<S> residual_;
    typename Waves::template Scratch<S> scratch_;
    Index samples_ = 0;
  };

  /// Refuses bad parameters (parameter_error).
  TaxelFeatures(Index rows,
                Index cols,
                const TaxelOptions<S>& options = {},
                const Waves& waves = {})
      : rows_(rows), cols_(cols), options_(options), waves_(waves) {
    check();
    floor_.assign(taxels(), floor_of(value(options.noise)));
    place_taxels();
  }

  /// With a standard deviation for each taxel; one that is not a number >= 0 marks a dead taxel.
  template <grid Noise>
    requires std::constructible_from<S, cell_t<Noise>>
  explicit TaxelFeatures(const Noise& noise,
                         const TaxelOptions<S>& options = {},
                         const Waves& waves = {})
      : rows_(fingerpad::rows(noise)),
        cols_(fingerpad::cols(noise)),
        options_(options),
        waves_(waves) {
    check();
    const auto of = as_view(noise);
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        floor_.push_back(floor_of(value(static_cast<S>(of(i, j)))));
      }
    }
    place_taxels();
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  const TaxelOptions<S>& options() const { return options_; }

  /// Takes all memory.
  State start() const { return State(rows_ * cols_, options_.window); }

  /// The features at `time_s`, when the sample was received. NaN, infinite and saturated readings
  /// are left out. A time that is NaN or not later than the last is refused; one that is earlier by
  /// more than the longest gap is a new clock, which begins a new window.
  template <grid Taxels>
    requires std::constructible_from<S, cell_t<Taxels>> FingerSample<S>
  operator()(const Taxels& taxels, const S& time_s, State& state) const {
    FingerSample<S> sample;
    const auto readings = as_view(taxels);
    if (readings.rows() != rows_ || readings.cols() != cols_ ||
        state.health_.size() != floor_.size() || state.window_.length() != options_.window) {
      sample.status = TaxelStatus::other_size;
      return sample;
    }
    const Clock clock = tell(time_s, state);
    if (clock == Clock::not_later) {
      sample.status = TaxelStatus::time_not_later;
      return sample;
    }
    if (clock == Clock::jumped) {
      forget(state);
    }
    read(readings, sample, state);
    store(time_s, state);
    find_vibration(sample, state);
    return sample;
  }

 private:
  enum class Clock : std::uint8_t { runs, jumped, not_later };

  void check() const {
    expects(rows_ >= 1 && rows_ <= 4096, "TaxelFeatures", "rows", static_cast<long long>(rows_),
            "in [1, 4096]");
    expects(cols_ >= 1 && cols_ <= 4096, "TaxelFeatures", "cols", static_cast<long long>(cols_),
            "in [1, 4096]");
    expects_valid(options_);
    waves_.check();
  }

  void place_taxels() {
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        x_mm_.push_back(S(S(static_cast<int>(j)) * options_.pitch_mm));
        y_mm_.push_back(S(S(static_cast<int>(i)) * options_.pitch_mm));
      }
    }
  }

  std::size_t taxels() const { return static_cast<std::size_t>(rows_ * cols_); }

  Real floor_of(const Real& noise) const {
    const Real beyond = value(options_.noise_factor) * noise;
    return noise >= 0 ? Real(beyond * beyond) : Health::infinite();
  }

  Clock tell(const S& time_s, const State& state) const {
    if (!is_finite(time_s)) {
      return Clock::not_later;
    }
    if (state.samples_ == 0) {
      return Clock::jumped;
    }
    const Real step = value(time_s) - value(state.time_s_.back());
    const Real gap = value(options_.longest_gap_s);
    return step > gap || step < -gap ? Clock::jumped : step > 0 ? Clock::runs : Clock::not_later;
  }

  static void forget(State& state) {
    state.samples_ = 0;
    state.health_.forget();
  }

  /// Takes over what can be used of the readings, and finds the centroid of what presses.
  template <class View>
  void read(const View& readings, FingerSample<S>& sample, State& state) const {
    S* const now = state.health_.incoming();
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        now[i * cols_ + j] = static_cast<S>(readings(i, j));
      }
    }
    state.health_.judge(floor_.data(), limits());
    find_centroid(state, sample);
  }

  /// Sums in lanes, each over every eighth taxel, which compilers turn into vectors.
  void find_centroid(const State& state, FingerSample<S>& sample) const {
    const S* const weights = state.health_.weights();
    const Real* const counts = state.health_.counts();
    std::array<S, lanes> sum, sum_x, sum_y;
    std::array<Real, lanes> counted;
    sum.fill(S(0));
    sum_x.fill(S(0));
    sum_y.fill(S(0));
    counted.fill(Real(0));
    const auto add = [&](std::size_t k, std::size_t lane) {
      sum[lane] = sum[lane] + weights[k];
      sum_x[lane] = sum_x[lane] + S(weights[k] * x_mm_[k]);
      sum_y[lane] = sum_y[lane] + S(weights[k] * y_mm_[k]);
      counted[lane] = counted[lane] + counts[k];
    };
    const std::size_t count = x_mm_.size(), in_lanes = count - count % lanes;
    for (std::size_t k = 0; k < in_lanes; k += lanes) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        add(k + lane, lane);
      }
    }
    for (std::size_t lane = 0; lane < count - in_lanes; ++lane) {
      add(in_lanes + lane, lane);
    }
    S total_x = S(0), total_y = S(0);
    Real total = Real(0);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      sample.sum = sample.sum + sum[lane];
      total_x = total_x + sum_x[lane];
      total_y = total_y + sum_y[lane];
      total = total + counted[lane];
    }
    sample.left_out = rows_ * cols_ - static_cast<Index>(total);
    if (value(sample.sum) > 0 && value(sample.sum) >= value(options_.min_sum)) {
      sample.center_x_mm = total_x / sample.sum;
      sample.center_y_mm = total_y / sample.sum;
    }
  }

  typename Health::Limits limits() const {
    const bool looked_for = options_.stuck_after > 0;
    return {value(options_.saturated_at),
            looked_for ? Real(static_cast<double>(options_.stuck_after)) : Health::infinite(),
            Real(static_cast<int>(options_.window))};
  }

  void store(const S& time_s, State& state) const {
    if (state.samples_ == 0) {
      state.window_.restart(state.health_.held());
      std::fill(state.time_s_.begin(), state.time_s_.end(), time_s);
    } else {
      state.window_.push(state.health_.held());
      std::move(state.time_s_.begin() + 1, state.time_s_.end(), state.time_s_.begin());
      state.time_s_.back() = time_s;
    }
    state.samples_ = (std::min)(state.samples_ + 1, options_.window);
  }

  void find_vibration(FingerSample<S>& sample, State& state) const {
    if (sample.left_out == rows_ * cols_) {
      sample.status = TaxelStatus::no_taxels;
      return;
    }
    if (state.samples_ < options_.window) {
      return;
    }
    sample.status = TaxelStatus::quiet;
    const Index strongest = strongest_taxel(state);
    if (strongest == FingerSample<S>::no_location) {
      return;
    }
    const S mean_square = state.window_.residuals(strongest, state.residual_.data());
    if (!(value(mean_square) > 0)) {
      return;
    }
    using std::sqrt;
    const S duration = options_.sample_period_s * S(static_cast<int>(options_.window));
    const S rms = S(sqrt(mean_square));
    const detail::WaveWindow<S> window{state.residual_.data(), state.time_s_.data(),
                                       options_.window, rms, duration};
    sample.status = TaxelStatus::vibrating;
    sample.location = strongest;
    sample.waves = waves_(window, state.scratch_);
    sample.frequency_hz = S(static_cast<int>(sample.waves)) / duration;
    sample.deviation = rms;
  }

  /// The first of those whose variance is largest, of those beyond their floor.
  Index strongest_taxel(State& state) const {
    Real* const spread = state.spread_.data();
    const Real* const floor = state.health_.floor();
    state.window_.variances(spread);
    const std::size_t count = floor_.size(), in_lanes = count - count % lanes;
    for (std::size_t i = 0; i < count; ++i) {
      spread[i] = spread[i] > floor[i] ? spread[i] : Real(0);
    }
    Real largest[lanes] = {};
    for (std::size_t i = 0; i < in_lanes; i += lanes) {
      for (std::size_t k = 0; k < lanes; ++k) {
        largest[k] = spread[i + k] > largest[k] ? spread[i + k] : largest[k];
      }
    }
    for (std::size_t i = in_lanes; i < count; ++i) {
      largest[0] = spread[i] > largest[0] ? spread[i] : largest[0];
    }
    const Real most = *std::max_element(largest, largest + lanes);
    if (!(most > 0)) {
      return FingerSample<S>::no_location;
    }
    return std::find(spread, spread + count, most) - spread;
  }

  static constexpr std::size_t lanes = 8;

  Index rows_;
  Index cols_;
  TaxelOptions<S> options_;
  Waves waves_;
  std::vector<Real> floor_;
  std::vector<S> x_mm_;  // of each taxel, from the middle of the first
  std::vector<S> y_mm_;
};

}  // namespace v0
}  // namespace fingerpad
