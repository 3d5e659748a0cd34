// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Noise of the taxels of a foam array, from a recording. The paper ("Pre-Slip Sensing Using Tactile
// Sensor", 2007) does not give it.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/taxels.hpp"

namespace fingerpad {
inline namespace v1 {

/// Noise of a taxel array. Readings are in the unit of the sensor.
template <scalar S = double>
struct [[nodiscard]] TaxelNoise {
  const char* cause = nullptr;  ///< likely mistake
  /// Of each taxel, row by row, for TaxelFeatures. At least `typical`, because a constant reading
  /// becomes noisy once the taxel is pressed; NaN: never read, a dead taxel.
  std::vector<S> deviations;
  S typical = S(0);        ///< root mean square over the taxels whose readings changed
  S typical_error = S(0);  ///< its standard error, for independent Gaussian readings
  /// Largest deviation in a window, in `deviations` of its taxel. TaxelOptions::noise_factor must
  /// exceed it if nothing was touched.
  S largest_factor = S(0);
  S centroid_deviation_mm = S(0);  ///< of the centroid, in a window; NaN: never pressed
  /// Share of the readings' spread that taxels have in common, from the squared correlations of all
  /// pairs: about 0 for noise, 1 for an object that shakes; NaN with fewer than three taxels that
  /// change, or windows of fewer than 8 samples.
  S shared = not_a_number<S>();
  Index windows = 0;  ///< number of windows used

  bool ok() const { return cause == nullptr; }
};

/// Collects samples of an array that is at rest for more than half of the time: medians over the
/// windows are used, so that an occasional touch or slip does not count as noise.
template <scalar S = double>
class TaxelNoiseCalibration {
 public:
  /// Refuses bad parameters (parameter_error). Options that depend on the noise need not be set.
  TaxelNoiseCalibration(Index rows, Index cols, const TaxelOptions& options = {})
      : features_(rows, cols, without_noise(options)),
        now_(static_cast<std::size_t>(rows * cols) + 2, S(0)),
        window_(now_.size(), options.window),
        residuals_(static_cast<std::size_t>(options.window), S(0)),
        variances_(now_.size()),
        is_bad_(now_.size(), false) {}

  /// Adds the next sample; false, and nothing changed, if the array has another size or the time is
  /// not later. A jump of the clock begins a new window. A window with a bad reading of a taxel is
  /// not used for this taxel.
  template <grid Taxels>
    requires std::constructible_from<S, cell_t<Taxels>>
  bool add(const Taxels& taxels, double time_s) {
    const FingerSample<S> sample = features_(taxels, time_s);
    if (sample.status == TaxelStatus::refused) {
      return false;
    }
    const bool is_new = features_.samples() == 1;
    if (is_new || in_window_ == features_.options().window) {
      in_window_ = 0;
      std::fill(is_bad_.begin(), is_bad_.end(), false);
    }
    const auto readings = as_view(taxels);
    const auto keep = [&](std::size_t k, bool is_good, const S& reading) {  // else the last one
      now_[k] = is_good ? reading : now_[k];
      is_bad_[k] = is_bad_[k] || !is_good;
    };
    for (std::size_t k = 0; k < taxel_count(); ++k) {
      const auto at = static_cast<Index>(k), cols = features_.cols();
      const S reading = S(readings(at / cols, at % cols));
      keep(k, detail::is_reading(reading, features_.options()), reading);
    }
    keep(taxel_count(), sample.is_pressed(), sample.center_x_mm);
    keep(taxel_count() + 1, sample.is_pressed(), sample.center_y_mm);
    window_.push([&](std::size_t k) { return now_[k]; }, is_new);
    if (++in_window_ == features_.options().window) {
      ++windows_;
      std::vector<std::vector<S>> moving;  // residuals of the taxels that change
      for (std::size_t k = 0; k < now_.size(); ++k) {
        if (!is_bad_[k]) {
          variances_[k].push_back(window_.residuals(k, residuals_));
          if (k < taxel_count() && S(0) < variances_[k].back()) {
            moving.push_back(residuals_);
          }
        }
      }
      if (moving.size() >= 3 && residuals_.size() >= 8) {  // else chance correlates them as much
        shared_.push_back(mean_squared_correlation(moving));
      }
    }
    return true;
  }

  /// Refuses a recording of less than four windows, or in which no reading changed
  /// (parameter_error).
  TaxelNoise<S> fit() const {
    using std::sqrt;
    const std::size_t count = taxel_count();
    TaxelNoise<S> noise;
    noise.windows = windows_;
    require("TaxelNoiseCalibration", {{"windows", windows_, at_least(4)}});
    std::vector<S> squares;
    S sum = S(0);
    int changed = 0, dead = 0;
    for (std::size_t k = 0; k < count; ++k) {
      squares.push_back(mean_square_of(variances_[k]));
      sum = S(0) < squares[k] ? sum + squares[k] : sum;
      changed += S(0) < squares[k] ? 1 : 0;
    }
    require("TaxelNoiseCalibration", {{"taxels whose readings change", changed, at_least(1)}});
    noise.typical = sqrt(sum / S(changed));
    // A median has pi / 2 times the variance of the mean. A mean square with f degrees of freedom
    // has a relative variance of 2 / f, and its root half of the relative error.
    const double freedom = (length() - 2) * static_cast<double>(windows_);
    noise.typical_error =
        noise.typical *
        S(std::sqrt(std::numbers::pi / 4 / (freedom * static_cast<double>(changed))));
    for (std::size_t k = 0; k < count; ++k) {
      const bool is_dead = variances_[k].empty();
      const S own = S(0) < squares[k] ? sqrt(squares[k]) : S(0);
      const S deviation = noise.typical < own ? own : noise.typical;
      noise.deviations.push_back(is_dead ? not_a_number<S>() : deviation);
      dead += is_dead ? 1 : 0;
      for (const S& variance : variances_[k]) {
        const S factor = S(0) < variance ? sqrt(variance) / deviation : S(0);
        noise.largest_factor = noise.largest_factor < factor ? factor : noise.largest_factor;
      }
    }
    noise.shared = shared_.empty() ? not_a_number<S>() : shared_spread();
    noise.cause = 2 * static_cast<std::size_t>(dead) > count
                      ? "fewer than half of the taxels gave readings in range: "
                        "check bytes, range and order"
                  : S(0.5) < noise.shared ? "most of what the taxels read they have in common, so "
                                            "that it is no noise: record while nothing shakes"
                                          : nullptr;
    const S centroid_sq =
        (mean_square_of(variances_[count]) + mean_square_of(variances_[count + 1])) / S(2);
    noise.centroid_deviation_mm = value(centroid_sq) == 0 ? S(0) : sqrt(centroid_sq);
    return noise;
  }

 private:
  static TaxelOptions without_noise(TaxelOptions options) {
    require(options);
    options.noise = 0;
    return options;
  }

  std::size_t taxel_count() const { return now_.size() - 2; }

  /// Over all pairs of taxels, in at most 64 samples.
  static S mean_squared_correlation(const std::vector<std::vector<S>>& taxels) {
    const auto end = static_cast<std::ptrdiff_t>((std::min)(taxels[0].size(), std::size_t{64}));
    const auto product = [end](const std::vector<S>& a, const std::vector<S>& b) {
      return std::inner_product(a.begin(), a.begin() + end, b.begin(), S(0));
    };
    S sum = S(0);
    for (std::size_t j = 0; j < taxels.size(); ++j) {
      const S own = product(taxels[j], taxels[j]);
      for (std::size_t k = 0; k < j; ++k) {
        sum = sum + square(product(taxels[j], taxels[k])) / (own * product(taxels[k], taxels[k]));
      }
    }
    const auto count = static_cast<double>(taxels.size());
    return sum / S(count * (count - 1) / 2);
  }
  /// From the median window. Independent noise has a squared correlation of 1 / (times - 2) by
  /// chance, and taxels that have the share p of their variance in common add p^2.
  S shared_spread() const {
    using std::sqrt;
    std::vector<S> all = shared_;
    std::sort(all.begin(), all.end());
    const double chance = 1 / ((std::min)(length(), 64.0) - 2);
    const S squared = (all[all.size() / 2] - S(chance)) / S(1 - chance);
    return S(0) < squared ? S(sqrt(squared)) : S(0);
  }
  double length() const { return static_cast<double>(features_.options().window); }

  /// Variance from the median of the windows' mean squares; NaN if there are none. It is corrected
  /// for the part removed by the line of each window, and for the median of a chi-square
  /// distribution, which is below its mean.
  S mean_square_of(std::vector<S> variances) const {
    if (variances.empty()) {
      return not_a_number<S>();
    }
    std::sort(variances.begin(), variances.end());
    const std::size_t half = variances.size() / 2;
    const S median = (variances[half] + variances[(variances.size() - 1) / 2]) / S(2);
    const double freedom = length() - 2;
    return median * S(length() / (freedom * std::pow(1 - 2 / (9 * freedom), 3)));
  }

  TaxelFeatures<S> features_;
  std::vector<S> now_;  // the taxels, then both places of the centroid
  detail::TaxelWindow<S> window_;
  std::vector<S> residuals_;
  std::vector<std::vector<S>> variances_;  // of the windows of each of `now_`
  std::vector<bool> is_bad_;               // in the present window
  std::vector<S> shared_;                  // squared correlation of each window
  Index in_window_ = 0;                    // samples of the present window
  Index windows_ = 0;
};

}  // namespace v1
}  // namespace fingerpad
