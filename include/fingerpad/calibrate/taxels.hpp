// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Noise of the taxels of a given array, from a recording that is at rest for more than half of the
// time: the standard deviation of each taxel, its largest value in a window, and that of the
// centroid. The paper gives no rule for them. Medians over the windows are used, so that an
// occasional touch or slip does not count as noise.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/taxel_features.hpp"

namespace fingerpad {
inline namespace v0 {

/// Noise of a taxel array. Readings are in the unit of the sensor.
template <scalar S = double>
struct [[nodiscard]] TaxelNoise {
  const char* cause = nullptr;  ///< likely mistake
  Index rows = 0;
  Index cols = 0;
  std::vector<S> deviations;       ///< rows x cols, row by row, for TaxelFeatures. At least
                                   ///< `typical`, because a constant reading becomes noisy once the
                                   ///< taxel is pressed; NaN: never read, a dead taxel
  S typical = S(0);                ///< root mean square over the taxels whose readings changed
  S typical_error = S(0);          ///< its standard error, for independent Gaussian readings
  S largest_factor = S(0);         ///< largest deviation in a window, in `deviations` of its taxel.
                                   ///< TaxelOptions::noise_factor must exceed it if nothing was
                                   ///< touched
  S centroid_deviation_mm = S(0);  ///< of the centroid, in a window; NaN: never pressed
  Index windows = 0;               ///< number of windows used

  bool ok() const { return cause == nullptr; }
  StridedView<const S> view() const { return {deviations.data(), rows, cols, cols}; }
};

/// Collects samples at rest.
template <scalar S = double>
class TaxelNoiseCalibration {
  using Features = TaxelFeatures<S>;

 public:
  /// Refuses bad parameters (parameter_error). Options that depend on the noise need not be set.
  TaxelNoiseCalibration(Index rows, Index cols, const TaxelOptions<S>& options = {})
      : features_(rows, cols, options),
        state_(features_.start()),
        window_(rows * cols, options.window),
        centroid_(2, options.window),
        held_(static_cast<std::size_t>(rows * cols), S(0)),
        spread_(held_.size(), S(0)),
        taxels_(held_.size()) {}

  /// Adds the next sample; false, and nothing changed, if the array has another size or the time is
  /// not later. A jump of the clock begins a new window. A window with a bad reading of a taxel is
  /// not used for this taxel.
  template <grid Taxels>
    requires std::constructible_from<S, cell_t<Taxels>>
  bool add(const Taxels& taxels, double time_s) {
    const FingerSample<S> sample = features_(taxels, time_s, state_);
    if (sample.status == TaxelStatus::other_size || sample.status == TaxelStatus::time_not_later) {
      return false;
    }
    const bool is_new = state_.samples() == 1;
    in_window_ = is_new ? 0 : in_window_;
    read(as_view(taxels));
    const S centroid[2] = {sample.is_pressed() ? sample.center_x_mm : S(0),
                           sample.is_pressed() ? sample.center_y_mm : S(0)};
    if (is_new) {
      window_.restart(held_.data());
      centroid_.restart(centroid);
    } else {
      window_.push(held_.data());
      centroid_.push(centroid);
    }
    is_pressed_ = (in_window_ == 0 || is_pressed_) && sample.is_pressed();
    if (++in_window_ == features_.options().window) {
      judge();
      in_window_ = 0;
    }
    return true;
  }

  /// Refuses a recording of less than four windows, or in which no reading changed
  /// (parameter_error).
  TaxelNoise<S> fit() const {
    using std::sqrt;
    const char* const owner = "TaxelNoiseCalibration";
    expects(windows_ >= 4, owner, "windows", static_cast<long long>(windows_), ">= 4");
    TaxelNoise<S> noise;
    noise.rows = features_.rows();
    noise.cols = features_.cols();
    noise.windows = windows_;
    std::vector<S> squares;
    S sum = S(0);
    Index changed = 0;
    for (const Taxel& taxel : taxels_) {
      squares.push_back(mean_square_of(taxel.variances));
      sum += S(0) < squares.back() ? squares.back() : S(0);
      changed += S(0) < squares.back() ? 1 : 0;
    }
    expects(changed > 0, owner, "taxels whose readings change", static_cast<long long>(changed),
            ">= 1");
    const S typical_sq = S(sum / S(static_cast<double>(changed)));
    noise.typical = sqrt(typical_sq);
    // A median has pi / 2 times the variance of the mean. A mean square with f degrees of freedom
    // has a relative variance of 2 / f, and its root half of the relative error.
    const double freedom = static_cast<double>((features_.options().window - 2) * windows_);
    noise.typical_error =
        noise.typical *
        S(std::sqrt(std::numbers::pi / 4 / (freedom * static_cast<double>(changed))));
    Index read = 0;
    for (std::size_t k = 0; k < taxels_.size(); ++k) {
      const bool is_dead = taxels_[k].variances.empty();
      const S deviation = typical_sq < squares[k] ? S(sqrt(squares[k])) : noise.typical;
      noise.deviations.push_back(is_dead ? not_a_number<S>() : deviation);
      read += is_dead ? 0 : 1;
      for (const S& variance : taxels_[k].variances) {
        const S factor = S(0) < variance ? S(sqrt(variance) / deviation) : S(0);
        noise.largest_factor = noise.largest_factor < factor ? factor : noise.largest_factor;
      }
    }
    noise.cause = 2 * read < static_cast<Index>(taxels_.size())
                      ? "fewer than half of the taxels gave readings in range: "
                        "check bytes, range and order"
                      : nullptr;
    const S centroid_sq = mean_square_of(centroid_variances_);
    noise.centroid_deviation_mm = value(centroid_sq) == 0 ? S(0) : S(sqrt(centroid_sq));
    return noise;
  }

 private:
  struct Taxel {
    std::vector<S> variances;  // of its windows
    bool is_bad = false;       // a bad reading in the present window
  };

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
    const double n = static_cast<double>(features_.options().window);
    const double freedom = n - 2;
    const double median_share = std::pow(1 - 2 / (9 * freedom), 3);
    return S(median * S(n / (freedom * median_share)));
  }

  template <class View>
  void read(const View& readings) {
    for (Index i = 0; i < features_.rows(); ++i) {
      for (Index j = 0; j < features_.cols(); ++j) {
        const std::size_t k = static_cast<std::size_t>(i * features_.cols() + j);
        const S reading = S(readings(i, j));
        const bool good = detail::is_reading(reading) && reading < features_.options().saturated_at;
        held_[k] = good ? reading : held_[k];
        taxels_[k].is_bad = (in_window_ > 0 && taxels_[k].is_bad) || !good;
      }
    }
  }

  void judge() {
    ++windows_;
    window_.variances(spread_.data());
    for (std::size_t k = 0; k < taxels_.size(); ++k) {
      Taxel& taxel = taxels_[k];
      if (!taxel.is_bad) {
        taxel.variances.push_back(S(0) < spread_[k] ? spread_[k] : S(0));
      }
    }
    if (is_pressed_) {
      S spread[2];
      centroid_.variances(spread);
      const S both = (spread[0] + spread[1]) / S(2);
      centroid_variances_.push_back(S(0) < both ? both : S(0));
    }
  }

  Features features_;
  typename Features::State state_;
  detail::TaxelWindow<S> window_;
  detail::TaxelWindow<S> centroid_;
  std::vector<S> held_;
  std::vector<S> spread_;
  std::vector<Taxel> taxels_;
  std::vector<S> centroid_variances_;  // mean of both axes
  Index in_window_ = 0;                // samples of the present window
  bool is_pressed_ = false;            // in all samples of the present window
  Index windows_ = 0;
};

}  // namespace v0
}  // namespace fingerpad
