// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Converts two channels of a frame to rows of smoothed red and green in grey levels, row by row. A
// pixel counts if it lies in the reference's pad and both its channels lie strictly between the
// limits of the grey scale; a mean over no such pixel is NaN.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <tuple>
#include <type_traits>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/detail/frame_rows.hpp"
#include "fingerpad/depth/smoothing.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/window_means.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// True if pixels are averaged as integers, exactly and fast: 8- and 16-bit images with means in
/// float. All others are averaged in the scalar itself.
template <class Pixel, class S>
inline constexpr bool averages_integers = std::same_as<S, float> &&
                                          (std::same_as<Pixel, std::uint8_t> ||
                                           std::same_as<Pixel, std::uint16_t>);

/// What all rows of all frames share; the estimator owns it.
template <class S>
struct ColourSetup {
  Index rows = 0;
  Index cols = 0;
  std::vector<std::uint8_t> in_pad;  ///< rows x cols, nonzero inside
  Anchor<S> anchor;                  ///< empty unless the smoothing is anchored
};

/// Whether a channel's value lies strictly between the limits of the grey scale.
template <class Pixel>
struct Counts {
  GreyScale scale;
  bool operator()(const Pixel& x) const {
    const auto plain = static_cast<double>(value(real_of_t<Pixel>(x)));
    return plain > scale.dark && plain < scale.saturated;
  }
};

/// Rows of unsmoothed colours, in grey levels.
template <class Pixel, class S>
class PlainRows {
 public:
  PlainRows(const ColourSetup<S>& setup, const NoSmoothing&, const GreyScale& scale)
      : scale_(scale),
        red_(static_cast<std::size_t>(setup.cols)),
        green_(static_cast<std::size_t>(setup.cols)),
        valid_(static_cast<std::size_t>(setup.cols)) {}

  template <class Red, class Green>
  void start(const ColourSetup<S>&, const Red&, const Green&, Index first_row) {
    row_ = first_row;
  }

  template <class Red, class Green>
  void next(
      const ColourSetup<S>& setup, const Red& red, const Green& green, S* to_red, S* to_green) {
    load_pixels(red, green, row_, red_.data(), green_.data());
    const std::uint8_t* inside = setup.in_pad.data() + row_ * setup.cols;
    const S level = S(1) / S(scale_.units_per_level);
    if constexpr (averages_integers<Pixel, S>) {
      const ClosedRange<Pixel> range({scale_.dark, scale_.saturated});
      mark_valid(range, red_.data(), green_.data(), inside, valid_.data(), setup.cols);
      for_each_cell<S>(setup.cols, [&]<class V>(Index j) {
        store_cells<S>(to_red + j, load_cells<V, S>(red_.data() + j) * level);
        store_cells<S>(to_green + j, load_cells<V, S>(green_.data() + j) * level);
      });
      for (Index j = first_zero(0); j < setup.cols; j = first_zero(j)) {
        for (; j < setup.cols && valid_[static_cast<std::size_t>(j)] == 0; ++j) {
          to_red[j] = to_green[j] = not_a_number<S>();
        }
      }
    } else {
      const Counts<Pixel> counts{scale_};
      for (std::size_t j = 0; j < red_.size(); ++j) {
        const bool valid = inside[j] != 0 && counts(red_[j]) && counts(green_[j]);
        to_red[j] = valid ? S(S(red_[j]) * level) : not_a_number<S>();
        to_green[j] = valid ? S(S(green_[j]) * level) : not_a_number<S>();
      }
    }
    ++row_;
  }

 private:
  /// The first pixel from j on that does not count.
  Index first_zero(Index j) const {
    const std::uint8_t* begin = valid_.data();
    const std::size_t left = valid_.size() - static_cast<std::size_t>(j);
    const void* zero = std::memchr(begin + j, 0, left);
    return zero == nullptr ? static_cast<Index>(valid_.size())
                           : static_cast<const std::uint8_t*>(zero) - begin;
  }

  GreyScale scale_;
  std::vector<Pixel> red_;
  std::vector<Pixel> green_;
  std::vector<std::uint8_t> valid_;
  Index row_ = 0;
};

/// Rows of window means of two channels: colours, or an anchored residual and green. Averaged
/// values are stored as `Element`: offset + units * value.
template <class Pixel, class S, class Smoothing>
class MeanRowsOf {
  static constexpr auto windows =
      static_cast<int>(std::tuple_size_v<decltype(Smoothing().windows_px())>);
  static constexpr bool exact = averages_integers<Pixel, S>;
  static constexpr bool anchored = Smoothing::anchored;
  using Element = std::conditional_t<!exact, S, std::conditional_t<anchored, std::uint16_t, Pixel>>;
  using Limit = real_of_t<Element>;

 public:
  MeanRowsOf(const ColourSetup<S>& setup, const Smoothing& smoothing, const GreyScale& scale)
      : scale_(scale), sums_(setup.rows, setup.cols, smoothing.windows_px(), limits(scale)) {
    const auto size = static_cast<std::size_t>(setup.cols);
    const auto weight = window_weights(smoothing.windows_px());
    for (std::size_t k = 0; k < weight.size(); ++k) {
      weight_[k] = S(weight[k]);
      mean_[k].red.resize(size);
      mean_[k].green.resize(size);
    }
    red_.resize(size);
    green_.resize(size);
  }

  template <class Red, class Green>
  void start(const ColourSetup<S>& setup, const Red& red, const Green& green, Index first_row) {
    row_ = first_row;
    sums_.start(first_row, source(setup, red, green));
  }

  template <class Red, class Green>
  void next(
      const ColourSetup<S>& setup, const Red& red, const Green& green, S* to_red, S* to_green) {
    MeanRows<S> out[static_cast<std::size_t>(windows)];
    if constexpr (!anchored) {  // the means are the result
      static_assert(windows == 1);
      out[0] = {to_red, to_green};
      sums_.advance(source(setup, red, green), out);
      if constexpr (exact) {
        const float level = static_cast<float>(1 / scale_.units_per_level);
        for (Index j = 0; j < setup.cols; ++j) {
          to_red[j] *= level;
          to_green[j] *= level;
        }
      }
    } else {
      for (std::size_t k = 0; k < static_cast<std::size_t>(windows); ++k) {
        out[k] = {mean_[k].red.data(), mean_[k].green.data()};
      }
      sums_.advance(source(setup, red, green), out);
      finish(setup, row_++, to_red, to_green);
    }
  }

 private:
  /// Residuals are stored as 16-bit numbers in steps of 1/128 grey level around the middle of the
  /// range.
  static constexpr int residual_units = 128;
  static constexpr int residual_zero = 32768;
  static constexpr int green_units = 256;

  static window_limits_t<Element> limits(const GreyScale& scale) {
    if constexpr (anchored) {  // the source decides what counts
      const Limit all = Limit((std::numeric_limits<scalar_real_t<Limit>>::infinity)());
      return {Limit(-all), all};
    } else {
      const double level = exact ? 1.0 : scale.units_per_level;
      return {Limit(scale.dark / level), Limit(scale.saturated / level)};
    }
  }

  /// The row source of the window sums: fills one row and marks which of its pixels count.
  template <class Red, class Green>
  auto source(const ColourSetup<S>& setup, const Red& red, const Green& green) {
    return [this, &setup, &red, &green](Index row, Element* first, Element* second,
                                        std::uint8_t* valid) {
      const std::uint8_t* inside = setup.in_pad.data() + row * setup.cols;
      if constexpr (!anchored && exact) {
        std::memcpy(valid, inside, red_.size());
        load_pixels(red, green, row, first, second);
      } else if constexpr (!anchored) {
        std::memcpy(valid, inside, red_.size());
        load_pixels(red, green, row, red_.data(), green_.data());
        const S level = S(1) / S(scale_.units_per_level);
        for (std::size_t j = 0; j < red_.size(); ++j) {
          first[j] = S(red_[j]) * level;
          second[j] = S(green_[j]) * level;
        }
      } else {
        load_pixels(red, green, row, red_.data(), green_.data());
        load_residuals(setup, row, inside, first, second, valid);
      }
    };
  }

  void load_residuals(const ColourSetup<S>& setup,
                      Index row,
                      const std::uint8_t* inside,
                      Element* first,
                      Element* second,
                      std::uint8_t* valid) const {
    const S* rise = setup.anchor.rise.data() + row * setup.cols;
    const S* scattered = setup.anchor.scattered.data() + row * setup.cols;
    const Pixel* reds = red_.data();
    const Pixel* greens = green_.data();
    const S level = S(1) / S(scale_.units_per_level);
    const S kappa = setup.anchor.kappa * level;
    if constexpr (exact) {
      const ClosedRange<Pixel> range({scale_.dark, scale_.saturated});
      mark_valid(range, reds, greens, inside, valid, setup.cols);
      const S units = S(residual_units);
      const S zero = S(residual_zero) + S(0.5);  // + 1/2: truncation then rounds
      for_each_cell<S>(setup.cols, [&]<class V>(Index j) {
        const V green = load_cells<V, S>(greens + j) * level;
        const V membrane = load_cells<V, S>(rise + j) * green;
        const V fluid = load_cells<V, S>(scattered + j) - load_cells<V, S>(reds + j) * kappa;
        const V stored = (membrane + fluid) * units + zero;
        const V low = V{} + S(1);
        const V high = V{} + S(65535);
        store_cells<S>(first + j, stored < low ? low : stored > high ? high : stored);
        const V scaled = green * S(green_units);
        store_cells<S>(second + j, scaled > high ? high : scaled);
      });
    } else {
      const Counts<Pixel> counts{scale_};
      for (Index j = 0; j < setup.cols; ++j) {
        const S green = S(greens[j]) * level;
        first[j] = S(rise[j] * green - kappa * S(reds[j]) + scattered[j]);
        second[j] = green;
        valid[j] = inside[j] != 0 && counts(reds[j]) && counts(greens[j]);
      }
    }
  }

  /// Combines the means of the windows and converts residuals back to red. If a pixel's inner
  /// window holds no valid pixel, its mean is NaN and so is the result. Green needs only one
  /// window, because its share in the equation is small.
  void finish(const ColourSetup<S>& setup, Index row, S* to_red, S* to_green) const {
    const S* rise = setup.anchor.rise.data() + row * setup.cols;
    const S* scattered = setup.anchor.scattered.data() + row * setup.cols;
    const S per_kappa = S(1) / setup.anchor.kappa;
    for_each_cell<S>(setup.cols, [&]<class V>(Index j) {
      V residual = weighted<V>(mean_.front().red, mean_.back().red, j);
      V green = load_cells<V, S>(mean_.front().green.data() + j);
      if constexpr (exact) {
        green = green * (S(1) / S(green_units));
        residual = (residual - S(residual_zero)) * (S(1) / S(residual_units));
      }
      const V membrane = load_cells<V, S>(rise + j) * green;
      const V red = (membrane + load_cells<V, S>(scattered + j) - residual) * per_kappa;
      store_cells<S>(to_red + j, red);
      store_cells<S>(to_green + j, green);
    });
  }

  template <class V>
  V weighted(const std::vector<S>& inner, const std::vector<S>& outer, Index j) const {
    const V first = load_cells<V, S>(inner.data() + j);
    if constexpr (windows == 1) {
      return first;
    } else {
      return weight_[0] * first + weight_[1] * load_cells<V, S>(outer.data() + j);
    }
  }

  struct Means {
    std::vector<S> red;
    std::vector<S> green;
  };

  GreyScale scale_;
  WindowMeans<Element, windows> sums_;
  std::array<S, static_cast<std::size_t>(windows)> weight_;
  std::array<Means, static_cast<std::size_t>(windows)> mean_;
  std::vector<Pixel> red_;
  std::vector<Pixel> green_;
  Index row_ = 0;
};

template <class Pixel, class S, class Smoothing>
struct ColourRowsOf {
  using type = MeanRowsOf<Pixel, S, Smoothing>;
};
template <class Pixel, class S>
struct ColourRowsOf<Pixel, S, NoSmoothing> {
  using type = PlainRows<Pixel, S>;
};
template <class Pixel, class S, class Smoothing>
using ColourRows = typename ColourRowsOf<Pixel, S, Smoothing>::type;

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
