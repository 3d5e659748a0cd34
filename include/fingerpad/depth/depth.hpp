// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Depth of a fluid-filled pad from the colour of its membrane, seen by one camera through the
// fluid. Source: Ito, Kim, Obinata, "Shape sensing by vision-based tactile sensor" (slides). The
// law is in depth/absorption.hpp; published and corrected forms in docs/errata.md, E001-E007;
// published/depth.hpp is the method as printed.
//
// Once per sensor: depth/fit_reference.hpp on a frame of the free pad. Per frame: the colours are
// averaged over a window (depth/detail/colour_rows.hpp) and the depth equation is solved per pixel
// (depth/detail/depth_polynomial.hpp). The depth is the height z of the membrane above the plate in
// mm, where the pixel's refracted ray meets it; point_at() of optics/camera.hpp turns it into a
// point. depth/neighbour_light.hpp optionally compensates light from neighbouring membrane.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/detail/colour_rows.hpp"
#include "fingerpad/depth/detail/depth_polynomial.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

struct DepthOptions {
  int window_px = 29;  ///< width of the smoothing window, odd, 3..109 step; 1: no smoothing, for
                       ///< frames without noise
  int step = 1;        ///< pixels from one sample to the next, for sampled frames, 1..16
};

/// Says which value is out of range; "" if none is.
inline std::string check(const DepthOptions& options) {
  return check("DepthOptions",
               {{"step", options.step, within(1, 16)},
                {"window_px", options.window_px, odd_within(1, 109 * options.step)}});
}

/// The outcome of a frame. not_of_this_pad: depths were written, but the rim of the pad is more
/// than 5 % lighter or darker than in the reference, or mostly dark or saturated: another lamp or
/// gain, an aged membrane, another pixel layout. Take a new reference. The same where fewer than
/// half of the pad's pixels have a depth.
struct [[nodiscard]] DepthResult {
  FrameStatus status = FrameStatus::refused;
  Index pad_pixels = 0;  ///< pixels with a depth and g > 0 in the reference
  std::array<Index, pixel_status_count> count = {};  ///< pixels by PixelStatus

  bool ok() const { return status == FrameStatus::ok; }
  Index valid_pixels() const { return count[static_cast<std::size_t>(PixelStatus::ok)]; }
};

/// Computes the depth of every pixel of a frame, in float or double. A call allocates nothing and
/// throws nothing; O(rows cols), whatever the window. The object holds the memory of its frame: use
/// one per thread.
template <scalar S = float>
class DepthEstimator {
 public:
  /// Refuses bad parameters (parameter_error).
  DepthEstimator(const Camera<double>& camera,
                 const Absorption<double>& fluid,
                 const DepthReference<S>& reference,
                 const DepthOptions& options = {})
      : rows_(reference.rows),
        cols_(reference.cols),
        pad_(checked_area(camera, fluid, reference, options)),
        colours_(camera, fluid, reference, pad_, options.window_px, options.step),
        solver_(camera, fluid, radius_px(camera, reference) + 1, least_g(reference)),
        rim_(reference),
        span_(static_cast<std::size_t>(rows_)),
        red_(static_cast<std::size_t>(cols_ + block)),
        green_(red_.size()),
        depth_(red_.size()),
        status_(red_.size()) {
    for (Index i = 0; i < pad_.rows; ++i) {
      Span& span = span_[static_cast<std::size_t>(pad_.row + i)];
      for (Index j = 0; j < pad_.cols; ++j) {
        if (colours_.per_g(i)[j] > S(0)) {
          span = {span.last == 0 ? pad_.col + j : span.first, pad_.col + j + 1};
          ++pad_pixels_;
        }
      }
    }
  }

  /// The light of the frames that follow, over that of the reference (depth/free_light.hpp): both
  /// gains finite and > 0.
  void set_light(const LightGains& gains) {
    light_ = gains;
    colours_.set_light(gains);
  }

  /// Depth of a frame in mm from its red and green channels; NaN where there is none.
  template <grid Red, grid Green, class Depth>
  DepthResult operator()(const Red& red, const Green& green, Depth&& depth_mm) {
    return (*this)(red, green, depth_mm, nullptr);
  }

  /// The same, with a PixelStatus per pixel, unless `status` is nullptr.
  template <grid Red, grid Green, class Depth, class Status>
  DepthResult operator()(const Red& red, const Green& green, Depth&& depth_mm, Status&& status) {
    constexpr bool has_status = !std::is_null_pointer_v<std::remove_cvref_t<Status>>;
    detail::writes_to<Depth, S>();
    if constexpr (has_status) {
      detail::writes_to<Status, PixelStatus>();
    }
    static_assert(!detail::has_channels<cell_t<Red>> && !detail::has_channels<cell_t<Green>>,
                  "a colour image is not a channel: pass fingerpad::channel<T>(image, c) of it");
    static_assert(std::is_same_v<cell_t<Red>, cell_t<Green>>,
                  "red and green have different types of cell");
    DepthResult result;
    if (!(has_size(red) && has_size(green) && has_size(depth_mm) && has_size(status))) {
      return result;
    }
    const auto from_red = as_view(red);
    const auto from_green = as_view(green);
    const auto to_depth = as_view(depth_mm);
    result.pad_pixels = pad_pixels_;
    const auto pad_red = detail::crop(from_red, pad_);
    const auto pad_green = detail::crop(from_green, pad_);
    colours_.start(pad_red, pad_green);
    for (Index i = 0; i < rows_; ++i) {
      if (i >= pad_.row && i < pad_.row + pad_.rows) {
        colours_.next(pad_red, pad_green, red_.data() + pad_.col, green_.data() + pad_.col);
      }
      invert(i, from_red, from_green, result.count);
      detail::store_row(depth_.data(), to_depth, i);
      if constexpr (has_status) {
        detail::store_row(status_.data(), as_view(status), i);
      }
    }
    const bool is_unknown = 2 * result.valid_pixels() < pad_pixels_;
    result.status = is_unknown || rim_.has_changed(from_red, from_green, light_.green)
                        ? FrameStatus::not_of_this_pad
                        : FrameStatus::ok;
    return result;
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

 private:
  /// Columns [first, last) of a row, from the first used pixel to the last.
  struct Span {
    Index first = 0;
    Index last = 0;
  };

  static detail::PadArea checked_area(const Camera<double>& camera,
                                      const Absorption<double>& fluid,
                                      const DepthReference<S>& reference,
                                      const DepthOptions& options) {
    require(camera);
    require(fluid);
    require(options);
    expects_grid_size("DepthEstimator", reference.rows, reference.cols);
    const auto size = static_cast<std::size_t>(reference.rows * reference.cols);
    expects(reference.pixels_used > 0 && reference.depth_mm.size() == size &&
                reference.scattering.size() == size &&
                (reference.red_gain.empty() || reference.red_gain.size() == size),
            "DepthEstimator", "reference.pixels_used",
            static_cast<long long>(reference.pixels_used),
            "> 0 with planes of rows x cols, as fit_reference() returns them");
    const detail::PadArea area = detail::area_of(reference);
    expects(area.rows > 0, "DepthEstimator", "pixels of the reference with a depth", 0, ">= 1");
    return area;
  }

  /// Distance of the farthest pixel of the pad from the axis, in widths of a pixel.
  static double radius_px(const Camera<double>& camera, const DepthReference<S>& reference) {
    double radius_sq = 0;
    detail::each_pixel(reference.rows, reference.cols, [&](Index i, Index j) {
      const double dx = static_cast<double>(j) - camera.center_x_px;
      const double dy = (static_cast<double>(i) - camera.center_y_px) * camera.pixel_aspect;
      radius_sq = reference.in_pad(i, j) ? (std::max)(radius_sq, dx * dx + dy * dy) : radius_sq;
    });
    return std::sqrt(radius_sq);
  }

  static double least_g(const DepthReference<S>& reference) {
    double least = (std::numeric_limits<double>::infinity)();
    for (const S& g : reference.scattering) {
      least = g > S(0) ? (std::min)(least, static_cast<double>(g)) : least;
    }
    return least;
  }

  template <class G>
  bool has_size(const G& g) const {
    return fingerpad::rows(g) == rows_ && fingerpad::cols(g) == cols_;
  }
  bool has_size(std::nullptr_t) const { return true; }

  /// Depths and statuses of one row, from its colours. Counts pixels by status, and finds out why
  /// pixels without a colour have none.
  template <class Red, class Green>
  void invert(Index row,
              const Red& red,
              const Green& green,
              std::array<Index, pixel_status_count>& count) {
    const auto [begin, end] = span_[static_cast<std::size_t>(row)];
    count[static_cast<std::size_t>(PixelStatus::outside_pad)] += cols_ - (end - begin);
    std::fill_n(depth_.begin(), begin, not_a_number<S>());
    std::fill_n(status_.begin(), begin, PixelStatus::outside_pad);
    for (Index j = begin; j < end; j += block) {
      PixelStatus* status = status_.data() + j;
      solver_.invert(static_cast<int>(row), static_cast<int>(j), red_.data() + j, green_.data() + j,
                     colours_.per_g(row - pad_.row) + (j - pad_.col), depth_.data() + j, status);
      const Index n = (std::min)(block, end - j);
      std::fill(status + n, status + block, PixelStatus::ok);
      if (all_ok(status)) {
        count[static_cast<std::size_t>(PixelStatus::ok)] += n;
        continue;
      }
      for (Index i = 0; i < n; ++i) {
        if (status[i] == PixelStatus::not_a_number) {
          status[i] = without_colour(red(row, j + i), green(row, j + i));
        }
        ++count[static_cast<std::size_t>(status[i])];
      }
    }
    std::fill(depth_.begin() + end, depth_.end(), not_a_number<S>());
    std::fill(status_.begin() + end, status_.end(), PixelStatus::outside_pad);
  }

  static bool all_ok(const PixelStatus* status) {
    unsigned any = 0;
    for (Index i = 0; i < block; ++i) {
      any |= static_cast<std::uint8_t>(status[i]);
    }
    return any == 0;
  }

  /// Why a pixel has no mean colour, judged by its own channels.
  template <class Cell>
  static PixelStatus without_colour(const Cell& red, const Cell& green) {
    constexpr GreyScale scale = grey_scale_of<Cell>();
    const auto r = static_cast<double>(red), g = static_cast<double>(green);
    if (!is_finite(r) || !is_finite(g)) {
      return PixelStatus::not_a_number;
    }
    return r >= scale.saturated || g >= scale.saturated ? PixelStatus::saturated
           : r <= scale.dark || g <= scale.dark         ? PixelStatus::dark
                                                        : PixelStatus::not_a_number;
  }

  static constexpr Index block = detail::DepthPolynomial<S>::block;

  Index rows_;
  Index cols_;
  detail::PadArea pad_;
  LightGains light_;
  detail::ColourRows<S> colours_;
  detail::DepthPolynomial<S> solver_;
  detail::Rim rim_;
  std::vector<Span> span_;  // of each row
  std::vector<S> red_;      // a row, and a block of spare elements, as the next three
  std::vector<S> green_;
  std::vector<S> depth_;
  std::vector<PixelStatus> status_;
  Index pad_pixels_ = 0;
};

}  // namespace v1
}  // namespace fingerpad
