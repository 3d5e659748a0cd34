// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Features of a foam finger at each sample: where it is pressed, which taxel vibrates and how fast.
// Source: "Pre-Slip Sensing Using Tactile Sensor" (2007), the data of its stack: x-bar and y-bar,
// vibrating location, and vibration frequency as the number of sensed waves. The paper gives no
// formulas for them; docs/foam/preslip.md has those used here. A taxel vibrates where its readings
// deviate from a straight line in the window by more than its noise: a grip that is loosened evenly
// does not vibrate. Waves are crossings of that line, two per wave.
//
// Taxels that are dead, saturated, stuck, flickering or missing are left out. They can vibrate
// again a whole window after they were last bad. A taxel is stuck only where it should have
// changed: an object that is held still stays felt.
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
#include "fingerpad/foam/preslip.hpp"

namespace fingerpad {
inline namespace v1 {

/// The array and its window. Readings are in the sensor's own unit (counts, V, N). The paper prints
/// no values; the defaults suit arrays of 12-bit counts read 30 times a second.
struct TaxelOptions {
  double pitch_mm = 3.4;             ///< distance of neighbouring taxels, > 0
  Index window = 16;                 ///< samples in which vibration is detected, in [4, 4096]
  double sample_period_s = 1. / 30;  ///< nominal, > 0
  /// A gap counts as at most two periods. A gap longer than this, or a clock that is set back,
  /// begins a new window. > 0.
  double longest_gap_s = 2;
  double noise = 6;  ///< standard deviation of a taxel at rest, >= 0
  /// Vibration exceeds this many standard deviations, >= 0. A finger is pressed from the sample on
  /// in which a taxel reads twice as many, until none reads that many.
  double noise_factor = 2.5;
  double saturated_at = 1e9;  ///< this reading and larger ones do not count, in (0, 1e9]
  /// A taxel is stuck, and does not count, if its reading has stayed the same for this many samples
  /// in which the median of the others asked it to change by more than its noise. An array of which
  /// no reading has changed for as long is frozen. >= 0; 0: not checked.
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
                {"saturated_at", o.saturated_at, {.min = 0, .max = 1e9, .above_min = true}},
                {"stuck_after", o.stuck_after, not_negative}});
}

namespace detail {

/// The last n readings of every taxel, and how they vary about a straight line.
template <scalar S>
class TaxelWindow {
 public:
  TaxelWindow(std::size_t taxels, Index length)
      : length_(length), readings_(taxels * static_cast<std::size_t>(length), S(0)) {}

  /// Replaces the oldest reading of every taxel by reading(k); at first all readings.
  template <class Reading>
  void push(const Reading& reading, bool is_first) {
    const auto length = static_cast<std::size_t>(length_);
    for (Index u = is_first ? 0 : length_ - 1; u < length_; ++u) {
      for (std::size_t k = 0; k * length < readings_.size(); ++k) {
        readings_[k * length + static_cast<std::size_t>(oldest_)] = reading(k);
      }
      oldest_ = (oldest_ + 1) % length_;
    }
  }

  /// The largest reading of a taxel less its smallest, at least twice its rms about its line.
  auto range(std::size_t taxel) const {
    const S* const ring = readings_.data() + taxel * static_cast<std::size_t>(length_);
    auto low = value(*ring), high = low;
    for (Index u = 1; u < length_; ++u) {
      low = (std::min)(low, value(ring[u]));
      high = (std::max)(high, value(ring[u]));
    }
    return high - low;
  }

  /// Residuals of a taxel about its line, oldest first. Returns their mean square. Sums are those
  /// of the differences from the newest reading, so that a large reading costs no digits. O(n).
  S residuals(std::size_t taxel, std::vector<S>& out) const {
    const auto ring = readings_.begin() + static_cast<Index>(taxel) * length_;
    std::rotate_copy(ring, ring + oldest_, ring + length_, out.begin());
    const S n = S(static_cast<int>(length_)), middle = (n - S(1)) / S(2), newest = out.back();
    S at = -middle, sum = S(0), tilt = S(0), squares = S(0);
    for (S& r : out) {
      r = r - newest;
      sum = sum + r;
      tilt = tilt + at * r;
      at = at + S(1);
    }
    const S mean = sum / n, slope = S(12) * tilt / (n * (square(n) - S(1)));
    at = -middle;
    for (S& r : out) {
      r = r - mean - slope * at;
      squares = squares + square(r);
      at = at + S(1);
    }
    return squares / n;
  }

 private:
  Index length_;
  Index oldest_ = 0;
  std::vector<S> readings_;  // taxels x length, each a ring from `oldest_`
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
        residuals_(clock_.size(), S(0)),
        sorted_(taxels_.size()) {
    const S pitch_mm = S(options.pitch_mm);
    for (std::size_t k = 0; k < taxels_.size(); ++k) {
      const S row = S(static_cast<int>(k) / static_cast<int>(cols));
      const S col = S(static_cast<int>(k) % static_cast<int>(cols));
      const Real sd = noise.empty() ? Real(options.noise) : value(noise[k]);
      taxels_[k].place_mm =
          places_mm.empty() ? Point2<S>{col * pitch_mm, row * pitch_mm} : places_mm[k];
      require("TaxelFeatures", {{"places_mm.x", taxels_[k].place_mm.x, finite_number},
                                {"places_mm.y", taxels_[k].place_mm.y, finite_number}});
      taxels_[k].least = sd >= 0 ? Real(options.noise_factor) * sd : infinite();
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
    const double step_s = time_s - clock_.back();
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
    Real least = Real(0);    // it vibrates if its rms is larger; infinite: dead
    S reading = S(0);        // the last good one
    Real others = Real(0);   // median reading of those that press, when it last changed
    Index due_for = 0;       // samples for which it should have changed since
    Index bad_for = 0;       // samples until the taxel can vibrate again
    Index returned_for = 0;  // samples for which its return from 0 is remembered
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
    is_pressed_ = has_rested_ = false;
    for (Taxel& taxel : taxels_) {
      taxel.reading = S(0);
      taxel.due_for = taxel.bad_for = taxel.returned_for = 0;
    }
  }

  /// Stores the usable readings and computes the centroid of those that press.
  template <class View>
  void read(const View& readings, FingerSample<S>& sample) {
    Point2<S> moment = {S(0), S(0)};
    bool touches = false, holds = false;
    auto end = sorted_.begin();
    ++unchanged_for_;
    for (std::size_t k = 0; k < taxels_.size(); ++k) {
      const auto at = static_cast<Index>(k);
      const S reading = static_cast<S>(readings(at / cols_, at % cols_));
      Taxel& taxel = taxels_[k];
      if (!counts(reading, taxel)) {
        ++sample.left_out;
      } else if (value(reading) > 0) {
        sample.sum = sample.sum + reading;
        moment += reading * taxel.place_mm;
        touches = touches || value(reading) > 2 * taxel.least;
        holds = holds || value(reading) > taxel.least;
      }
      if (taxel.least < infinite() && value(taxel.reading) > 0) {
        *end++ = value(taxel.reading);
      }
    }
    const auto middle = sorted_.begin() + (end - sorted_.begin()) / 2;
    std::nth_element(sorted_.begin(), middle, end);
    typical_ = middle == end ? Real(0) : *middle;
    is_pressed_ = touches || (is_pressed_ && holds);
    if (is_pressed_) {
      sample.center_x_mm = moment.x / sample.sum;
      sample.center_y_mm = moment.y / sample.sum;
    }
  }

  /// Whether the reading of a taxel counts now. Updates what is remembered of the taxel.
  bool counts(const S& reading, Taxel& taxel) {
    if (!detail::is_reading(reading, options_)) {
      taxel.bad_for = options_.window;
      taxel.due_for = 0;
      return false;
    }
    const Real before = value(taxel.reading), now = value(reading);
    const bool is_first = samples_ == 0;
    if (is_first || now != before) {
      unchanged_for_ = is_first ? unchanged_for_ : 0;
      taxel.others = Real(0);
    } else if (!(taxel.others > 0)) {
      taxel.others = typical_;
    }
    using std::fabs;
    const Real due = now * (typical_ - taxel.others);
    const bool is_due = taxel.others > 0 && fabs(due) > taxel.least * taxel.others;
    taxel.due_for = is_due ? taxel.due_for + 1 : 0;
    taxel.bad_for = (std::max)(taxel.bad_for - 1, Index(0));
    taxel.returned_for = (std::max)(taxel.returned_for - 1, Index(0));
    // a loose contact: twice in a window from 0 to more than others read
    if (!is_first && before == 0 && now > typical_ && now > taxel.least) {
      taxel.bad_for = taxel.returned_for > 0 ? options_.window : taxel.bad_for;
      taxel.returned_for = options_.window;
    }
    taxel.reading = reading;
    const bool flickers = taxel.bad_for > 0 && taxel.returned_for > 0;
    return taxel.least < infinite() && !flickers && !is_stuck(taxel);
  }

  bool is_stuck(const Taxel& taxel) const {
    return options_.stuck_after > 0 && taxel.due_for >= options_.stuck_after;
  }

  /// Stores time and readings of the sample.
  void store(double time_s) {
    const bool is_first = samples_ == 0;
    window_.push([&](std::size_t k) { return taxels_[k].reading; }, is_first);
    std::move(clock_.begin() + 1, clock_.end(), clock_.begin());
    clock_.back() = time_s;
    if (is_first) {
      std::fill(clock_.begin(), clock_.end(), time_s);
    }
    samples_ = (std::min)(samples_ + 1, options_.window);
    unfilled_for_ =
        samples_ == options_.window ? 0 : (std::min)(unfilled_for_ + 1, 2 * options_.window + 1);
  }

  /// Sets the status of the sample: its vibration, or why this cannot be judged.
  void judge(FingerSample<S>& sample) {
    Index gaps = 0;
    double counted_s = 0;  // gaps shortened to two periods
    for (std::size_t k = 1; k < clock_.size(); ++k) {
      const double step_s = clock_[k] - clock_[k - 1], longest_s = 2 * options_.sample_period_s;
      counted_s += (std::min)(step_s, longest_s);
      gaps += step_s > longest_s ? 1 : 0;
    }
    const bool none_changes = options_.stuck_after > 0 && unchanged_for_ >= options_.stuck_after;
    if (unfilled_for_ > 2 * options_.window || 2 * gaps > options_.window) {
      sample.status = TaxelStatus::clock_jumps;
    } else if (sample.left_out == static_cast<Index>(taxels_.size())) {
      sample.status = TaxelStatus::no_taxels;
    } else if (samples_ < options_.window) {
      sample.status = TaxelStatus::filling;
    } else if (none_changes) {
      sample.status = TaxelStatus::frozen;
    } else {
      list_vibrations(sample);
      const bool vibrates = sample.vibration_count > 0;
      sample.status = vibrates ? TaxelStatus::vibrating : status_without_vibration();
      has_rested_ = has_rested_ || sample.status == TaxelStatus::quiet;
      // the window reaches one period beyond its newest sample
      const auto n = static_cast<double>(options_.window);
      sample.frequency_hz = S(static_cast<double>(sample.waves) * (n - 1) / (n * counted_s));
    }
    sample.has_rested = has_rested_;
  }

  /// `quiet` if some taxel that can be judged reads enough to vibrate.
  TaxelStatus status_without_vibration() const {
    TaxelStatus status = TaxelStatus::no_taxels;
    for (const Taxel& taxel : taxels_) {
      if (can_vibrate(taxel)) {
        if (value(taxel.reading) > 0 && value(taxel.reading) > taxel.least) {
          return TaxelStatus::quiet;
        }
        status = TaxelStatus::too_weak;
      }
    }
    return status;
  }

  /// Whether the taxel was good in its whole window.
  bool can_vibrate(const Taxel& taxel) const {
    return taxel.least < infinite() && taxel.bad_for == 0 && !is_stuck(taxel);
  }

  /// Adds the taxels that vibrate to the sample, and which of them vibrates most.
  void list_vibrations(FingerSample<S>& sample) {
    using std::sqrt;
    for (std::size_t k = 0; k < taxels_.size(); ++k) {
      if (!can_vibrate(taxels_[k]) || !(window_.range(k) > 2 * taxels_[k].least)) {
        continue;
      }
      const S rms = sqrt(window_.residuals(k, residuals_));
      if (value(rms) > taxels_[k].least) {
        const Index waves = detail::count_waves(residuals_, rms);
        sample.add_vibration(static_cast<Index>(k), waves);
        if (value(sample.deviation) < value(rms)) {
          sample.deviation = rms;
          sample.location = static_cast<Index>(k);
          sample.waves = waves;
        }
      }
    }
  }

  Index rows_;
  Index cols_;
  TaxelOptions options_;
  std::vector<Taxel> taxels_;
  detail::TaxelWindow<S> window_;
  std::vector<double> clock_;  // times of the window, oldest first
  std::vector<S> residuals_;   // of one taxel
  std::vector<Real> sorted_;   // readings of those that press, for their median
  Index samples_ = 0;
  Index unfilled_for_ = 0;   // samples since the window was last full
  Index unchanged_for_ = 0;  // samples since any reading changed; stuck_after: none ever has
  Real typical_ = Real(0);   // median reading of the taxels that press, in the last sample
  bool is_pressed_ = false;
  bool has_rested_ = false;  // a window was quiet since the start or the last new clock
};

}  // namespace v1
}  // namespace fingerpad
