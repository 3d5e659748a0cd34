// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From two channels of a frame to rows of smoothed red and green in grey levels, one row after the
// other. A pixel counts where the reference knows the pad and both its channels lie strictly
// between the limits of the grey scale; a mean over no such pixel is NaN.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "fingerpad/detail/depth_reference.hpp"
#include "fingerpad/detail/pixel_status.hpp"
#include "fingerpad/detail/row_lanes.hpp"
#include "fingerpad/detail/smoothing.hpp"
#include "fingerpad/detail/window_sums.hpp"
#include "fingerpad/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// 8- and 16-bit images are averaged as whole numbers, exactly and fast, where means are wanted in
/// float; everything else in the scalar itself.
template <class Pixel, class S>
inline constexpr bool averages_integers = std::same_as<S, float> &&
                                          (std::same_as<Pixel, std::uint8_t> ||
                                           std::same_as<Pixel, std::uint16_t>);

/// Per pixel, what an anchored mean needs of the free pad's depth l0: the residual
/// r = rise green - kappa red + scattered is F(l0), 0 where the membrane is where it was.
template <class S>
struct Anchor {
  std::vector<S> rise;       ///< exp(delta k l0)
  std::vector<S> scattered;  ///< g W(l0), grey levels
  S kappa = S(1);
};

/// What all rows of all frames share; the estimator owns it.
template <class S>
struct ColourSetup {
  Index rows = 0;
  Index cols = 0;
  std::vector<std::uint8_t> in_pad;  ///< rows x cols, nonzero inside
  Anchor<S> anchor;                  ///< empty unless the smoothing is anchored
};

template <class Smoothing>
inline constexpr bool is_anchored = false;
template <class Mean>
inline constexpr bool is_anchored<Anchored<Mean>> = true;

/// The anchor at the free pad of `reference`. Outside the pad, where nothing is averaged, it holds
/// harmless numbers.
template <class Heights, class S, class Scattering>
Anchor<S> anchor_of(const Camera<double>& camera,
                    const Absorption<double>& fluid,
                    const DepthReference<S, Scattering>& reference) {
  const double delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
  Anchor<S> anchor;
  anchor.kappa = S(fluid.kappa);
  for (Index i = 0; i < reference.rows; ++i) {
    for (Index j = 0; j < reference.cols; ++j) {
      S rise = S(1);
      S scattered = S(0);
      if (reference.in_pad(i, j)) {
        const auto ray = ray_at_pixel(camera, static_cast<double>(i), static_cast<double>(j));
        const auto pencil = pencil_of<Heights>(camera, ray);
        const auto l = static_cast<double>(value(reference.depth(i, j)));
        const S g = reference.scattering(i, j, S(square(ray.plate_rho_mm)));
        rise = S(std::exp(delta * pencil.path_factor * l));
        scattered = g * S(scattered_light(l, fluid.c_red_per_mm, pencil));
      }
      anchor.rise.push_back(rise);
      anchor.scattered.push_back(scattered);
    }
  }
  return anchor;
}

/// Why a pixel without a smoothed colour has none: what is wrong with its own.
template <class Cell>
PixelStatus status_of_cells(const Cell& red, const Cell& green, const GreyScale& scale) {
  using S = real_of_t<Cell>;
  const auto r = static_cast<double>(value(S(red)));
  const auto g = static_cast<double>(value(S(green)));
  if (r >= scale.saturated || g >= scale.saturated) {
    return PixelStatus::saturated;
  }
  return r <= scale.dark || g <= scale.dark ? PixelStatus::dark : PixelStatus::not_a_number;
}

/// A status grid that nobody asked for.
struct IgnoredCell {
  struct Sink {
    constexpr const Sink& operator=(PixelStatus) const { return *this; }
  };
  constexpr Sink operator()(Index, Index) const { return {}; }
};

template <class View, class S>
void load_row(const View& view, Index row, S* to) {
  for (Index j = 0; j < view.cols(); ++j) {
    to[j] = static_cast<S>(view(row, j));
  }
}
template <class S, class View>
void store_row(const S* from, const View& view, Index row) {
  for (Index j = 0; j < view.cols(); ++j) {
    view(row, j) = static_cast<cell_t<View>>(from[j]);
  }
}
template <class View>
void store_row(const std::uint8_t* from, const View& view, Index row) {
  if constexpr (!std::is_same_v<decltype(view(row, Index(0))), IgnoredCell::Sink>) {
    for (Index j = 0; j < view.cols(); ++j) {
      view(row, j) = static_cast<PixelStatus>(from[j]);
    }
  }
}

/// Copies one row of each channel to plain memory.
template <class Red, class Green, class Pixel>
void load_pixels(const Red& red, const Green& green, Index row, Pixel* to_red, Pixel* to_green) {
  for (Index j = 0; j < red.cols(); ++j) {
    to_red[j] = static_cast<Pixel>(red(row, j));
    to_green[j] = static_cast<Pixel>(green(row, j));
  }
}
/// The same for images in plain memory. Two channels of one interleaved image are read together.
template <std::unsigned_integral Pixel>
void load_pixels(const StridedView<const Pixel>& red,
                 const StridedView<const Pixel>& green,
                 Index row,
                 Pixel* to_red,
                 Pixel* to_green) {
  const Pixel* r = red.row(row);
  const Pixel* g = green.row(row);
  const Index step = red.col_stride();
  const Index n = red.cols();
  const auto bytes = static_cast<std::size_t>(n) * sizeof(Pixel);
  if (step == 1 && green.col_stride() == 1) {
    std::memcpy(to_red, r, bytes);
    std::memcpy(to_green, g, bytes);
    return;
  }
  Index done = 0;
  const bool together = step == green.col_stride() && r - g < step && g - r < step;
  if (together && (step == 3 || step == 4)) {
    // Which channel is first in a pixel is not known, so the last pixel is left: a block that
    // begins at the first of the two would reach past it.
    const Pixel* first = (std::min)(r, g);
    const auto red_at = static_cast<int>(r - first);
    const auto green_at = static_cast<int>(g - first);
    done = n - 1;
    if (step == 3) {
      load_interleaved_row<3>(first, done, red_at, green_at, to_red, to_green);
    } else {
      load_interleaved_row<4>(first, done, red_at, green_at, to_red, to_green);
    }
  }
  for (Index j = done; j < n; ++j) {
    to_red[j] = r[j * step];
    to_green[j] = g[j * green.col_stride()];
  }
}
template <std::unsigned_integral Pixel>
void load_pixels(const StridedView<Pixel>& red,
                 const StridedView<Pixel>& green,
                 Index row,
                 Pixel* to_red,
                 Pixel* to_green) {
  load_pixels(StridedView<const Pixel>(red), StridedView<const Pixel>(green), row, to_red,
              to_green);
}

/// Rows of plain colours, in grey levels.
template <class Pixel, class S>
class PlainRows {
 public:
  PlainRows(const ColourSetup<S>& setup, const NoSmoothing&, const GreyScale& scale)
      : scale_(scale),
        red_(static_cast<std::size_t>(setup.cols)),
        green_(static_cast<std::size_t>(setup.cols)) {}

  template <class Red, class Green>
  void start(const ColourSetup<S>&, const Red&, const Green&, Index first_row) {
    row_ = first_row;
  }

  template <class Red, class Green>
  void next(
      const ColourSetup<S>& setup, const Red& red, const Green& green, S* to_red, S* to_green) {
    load_pixels(red, green, row_, red_.data(), green_.data());
    const std::uint8_t* inside = setup.in_pad.data() + row_ * setup.cols;
    const auto counts = [this](const Pixel& x) {
      return static_cast<double>(value(S(x))) > scale_.dark &&
             static_cast<double>(value(S(x))) < scale_.saturated;
    };
    const S level = S(1) / S(scale_.units_per_level);
    for (std::size_t j = 0; j < red_.size(); ++j) {
      const bool valid = inside[j] != 0 && counts(red_[j]) && counts(green_[j]);
      to_red[j] = valid ? S(S(red_[j]) * level) : not_a_number<S>();
      to_green[j] = valid ? S(S(green_[j]) * level) : not_a_number<S>();
    }
    ++row_;
  }

 private:
  GreyScale scale_;
  std::vector<Pixel> red_;
  std::vector<Pixel> green_;
  Index row_ = 0;
};

/// Rows of window means of whatever was loaded: colours, or an anchored residual and green.
/// Everything that is averaged passes through as `Element`: first = offset + units * what it means.
template <class Pixel, class S, class Smoothing>
class MeanRowsOf {
  using Windows = WindowsOf<Smoothing>;
  static constexpr int windows = Windows::count;
  static constexpr bool exact = averages_integers<Pixel, S>;
  static constexpr bool anchored = Windows::anchored;
  using Element = std::conditional_t<!exact, S, std::conditional_t<anchored, std::uint16_t, Pixel>>;
  using Limit = real_of_t<Element>;

 public:
  MeanRowsOf(const ColourSetup<S>& setup, const Smoothing& smoothing, const GreyScale& scale)
      : scale_(scale), sums_(setup.rows, setup.cols, Windows::sizes_px(smoothing), limits(scale)) {
    const auto size = static_cast<std::size_t>(setup.cols);
    const auto weight = window_weights(Windows::sizes_px(smoothing));
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
    for (std::size_t k = 0; k < static_cast<std::size_t>(windows); ++k) {
      out[k] = {mean_[k].red.data(), mean_[k].green.data()};
    }
    sums_.advance(source(setup, red, green), out);
    finish(setup, row_++, to_red, to_green);
  }

 private:
  /// Residuals as 16-bit numbers: 1/128 of a grey level around the middle of the range.
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

  /// Fills one row for the window sums, and says which of its pixels count.
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
                      std::uint8_t* valid) {
    const S* rise = setup.anchor.rise.data() + row * setup.cols;
    const S* scattered = setup.anchor.scattered.data() + row * setup.cols;
    const S level = S(1) / S(scale_.units_per_level);
    const S dark = S(scale_.dark) * level;
    const S saturated = S(scale_.saturated) * level;
    const S kappa = setup.anchor.kappa;
    for_each_cell<S>(setup.cols, [&]<class V>(Index j) {
      const V green = load_cells<V, S>(green_.data() + j) * level;
      const V red = load_cells<V, S>(red_.data() + j) * level;
      const V residual =
          load_cells<V, S>(rise + j) * green - kappa * red + load_cells<V, S>(scattered + j);
      if constexpr (exact) {
        const V low = V{} + S(1);
        const V high = V{} + S(65535);
        const V stored = residual * S(residual_units) + (S(residual_zero) + S(0.5));
        store_cells<S>(first + j, stored < low ? low : stored > high ? high : stored);
        store_cells<S>(second + j, green * S(green_units));
      } else {
        store_cells<S>(first + j, residual);
        store_cells<S>(second + j, green);
      }
      store_flags<S>(valid + j, (red > dark) & (red < saturated) & (green > dark) &
                                    (green < saturated) & load_flags<V, S>(inside + j));
    });
  }

  /// Weighs the means and turns them back into grey levels.
  void finish(const ColourSetup<S>& setup, Index row, S* to_red, S* to_green) const {
    const S* rise = anchored ? setup.anchor.rise.data() + row * setup.cols : nullptr;
    const S* scattered = anchored ? setup.anchor.scattered.data() + row * setup.cols : nullptr;
    const S level = exact && !anchored ? S(1) / S(scale_.units_per_level) : S(1);
    const S per_kappa = S(1) / setup.anchor.kappa;
    for_each_cell<S>(setup.cols, [&]<class V>(Index j) {
      V red = weighted<V>(mean_.front().red, mean_.back().red, j);
      V green = weighted<V>(mean_.front().green, mean_.back().green, j);
      if constexpr (anchored) {
        if constexpr (exact) {
          red = (red - S(residual_zero)) * (S(1) / S(residual_units));
          green = green * (S(1) / S(green_units));
        }
        red = (load_cells<V, S>(rise + j) * green + load_cells<V, S>(scattered + j) - red) *
              per_kappa;
      } else {
        red = red * level;
        green = green * level;
      }
      store_cells<S>(to_red + j, red);
      store_cells<S>(to_green + j, green);
    });
  }

  /// The weighted mean; where the inner window holds no valid pixel, the outer one alone.
  template <class V>
  V weighted(const std::vector<S>& inner_row, const std::vector<S>& outer_row, Index j) const {
    const V inner = load_cells<V, S>(inner_row.data() + j);
    if constexpr (windows == 1) {
      return inner;
    } else {
      const V outer = load_cells<V, S>(outer_row.data() + j);
      const V both = weight_[0] * inner + weight_[1] * outer;
      return inner == inner ? both : outer;
    }
  }

  struct Means {
    std::vector<S> red;
    std::vector<S> green;
  };

  GreyScale scale_;
  WindowSums<Element, windows> sums_;
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
