// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Depth of a fluid-filled pad from the colour of its membrane, seen by one camera through the
// fluid. Source: Ito, Kim, Obinata, "Shape sensing by vision-based tactile sensor" (slides). The
// law is in depth/absorption.hpp; published and corrected forms in docs/errata.md,
// E001-E007.
//
// Once per sensor: fit_reference() on a frame of the free pad. Per frame: the colours are averaged
// over a window (depth/smoothing.hpp) and the depth equation is solved per pixel
// (depth/depth_inverse.hpp, depth/detail/scatter_polynomial.hpp). The depth is the height z of the
// membrane above the plate in mm, where the pixel's refracted ray meets it; point_at() of
// optics/camera.hpp turns it into a point. depth/neighbour_light.hpp optionally compensates light
// from neighbouring membrane.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/status.hpp"
#include "fingerpad/depth/depth_inverse.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/detail/colour_rows.hpp"
#include "fingerpad/depth/detail/depth_rows.hpp"
#include "fingerpad/depth/detail/pad_area.hpp"
#include "fingerpad/depth/detail/rim_light.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

enum class DepthStatus : std::uint8_t {
  ok,
  pad_has_changed,  ///< depths were written, but the rim of the pad is more than 5 % lighter or
                    ///< darker than in the reference, or mostly dark or saturated: another lamp or
                    ///< gain, an aged membrane, another pixel layout. Take a new reference.
  refused,          ///< a grid or the memory given with it has another size: nothing was written
};

/// "ok", "pad has changed" or "refused".
constexpr const char* name_of(DepthStatus status) {
  constexpr std::array<const char*, 3> names = {"ok", "pad has changed", "refused"};
  return names[static_cast<std::size_t>(status)];
}

/// The outcome of a frame, or of a band of its rows.
struct [[nodiscard]] DepthResult {
  DepthStatus status = DepthStatus::refused;
  Index pad_pixels = 0;  ///< pixels with a depth and g > 0 in the reference
  std::array<Index, pixel_status_count> count = {};  ///< pixels by PixelStatus
  Index rim_pixels = 0;  ///< pixels near the rim whose light was compared with the reference
  Index rim_lit = 0;     ///< those of them that are neither dark nor saturated
  double rim_light = not_a_number<double>();  ///< their mean green over that of the reference

  bool ok() const { return status == DepthStatus::ok; }
  Index valid_pixels() const { return count[static_cast<std::size_t>(PixelStatus::ok)]; }

  /// Merges the result of another band of the same frame into this one.
  void add(const DepthResult& band) {
    status = (std::max)(status, band.status);
    pad_pixels = band.pad_pixels;
    for (std::size_t k = 0; k < count.size(); ++k) {
      count[k] += band.count[k];
    }
    const double green = light_of(*this) + light_of(band);
    rim_pixels += band.rim_pixels;
    rim_lit += band.rim_lit;
    rim_light = green / static_cast<double>(rim_lit);
    if (status != DepthStatus::refused) {
      judge();
    }
  }

 private:
  template <class, class, class, scalar, class>
  friend class DepthEstimator;

  static double light_of(const DepthResult& r) {
    return r.rim_lit > 0 ? static_cast<double>(r.rim_lit) * r.rim_light : 0;
  }
  /// Compares the light at the rim with the reference. Displaced printed dots change it by 1 % with
  /// a thousand samples and by 4 % with 64; with fewer than 64 rim pixels the status is ok.
  void judge() {
    const bool same = 2 * rim_lit >= rim_pixels && std::abs(rim_light - 1) <= 0.05;
    status = same || rim_pixels < 64 ? DepthStatus::ok : DepthStatus::pad_has_changed;
  }
};

/// Computes the depth of every pixel of a frame, in the scalar S.
///   Smoothing  BiasFreeMean       the default; use it for curved contacts
///              AnchoredMean       use it when time matters and contacts are flat
///              NoSmoothing        use it for frames without noise
///   Inverse    ExponentialFree<>  use it for float and double
///              Newton             use it for other scalars, and for derivatives
/// Heights and Scattering are those of the reference. published/depth.hpp is the method as printed.
/// Threads may share one estimator, each with its own workspace, and may each process a band of
/// rows. A call allocates nothing and throws nothing; O(rows cols), whatever the window.
template <class Smoothing = BiasFreeMean,
          class Inverse = ExponentialFree<>,
          class Heights = AstigmaticHeights,
          scalar S = float,
          class Scattering = RadialScattering<S>>
class DepthEstimator {
  static_assert(!scalar<Smoothing>,
                "the scalar comes last: DepthEstimator<BiasFreeMean, ExponentialFree<>, "
                "AstigmaticHeights, double>");

 public:
  using Reference = DepthReference<S, Scattering, Heights>;

  /// Refuses bad parameters (parameter_error).
  DepthEstimator(const Camera<double>& camera,
                 const Absorption<double>& fluid,
                 const Reference& reference,
                 Smoothing smoothing = {},
                 Inverse inverse = {})
      : DepthEstimator(detail::crop_to_pad(checked(camera, fluid, reference), reference),
                       fluid,
                       smoothing,
                       inverse) {}

  /// Scratch memory for frames with cells of type Pixel; one per thread. Refuses an impossible grey
  /// scale (parameter_error).
  template <class Pixel>
  class Workspace {
   public:
    Workspace(const DepthEstimator& estimator, const GreyScale& scale)
        : area_(estimator.pad_),
          rows_(estimator.setup_, estimator.smoothing_, scale),
          scale_(scale),
          red_(static_cast<std::size_t>(estimator.setup_.cols)),
          green_(red_.size()),
          depth_(red_.size()),
          status_(red_.size()) {
      expects_valid(scale);
    }

   private:
    friend class DepthEstimator;
    detail::PadArea area_;
    detail::ColourRows<Pixel, S, Smoothing> rows_;
    GreyScale scale_;
    std::vector<S> red_;
    std::vector<S> green_;
    std::vector<S> depth_;
    std::vector<PixelStatus> status_;
  };
  template <class Pixel>
  Workspace<Pixel> workspace(const GreyScale& scale = grey_scale_of<Pixel>()) const {
    return Workspace<Pixel>(*this, scale);
  }

  /// Depth of a frame in mm from its red and green channels; NaN where there is none.
  template <grid Red, grid Green, class Depth, class Pixel>
  DepthResult operator()(const Red& red,
                         const Green& green,
                         Depth&& depth_mm,
                         Workspace<Pixel>& workspace) const {
    const LazyView no_status(rows_, cols_, detail::IgnoredCell{});
    return band(0, rows_, red, green, depth_mm, no_status, workspace);
  }

  /// The same, with a PixelStatus per pixel.
  template <grid Red, grid Green, class Depth, class Status, class Pixel>
  DepthResult operator()(const Red& red,
                         const Green& green,
                         Depth&& depth_mm,
                         Status&& status,
                         Workspace<Pixel>& workspace) const {
    detail::writes_to<Status, PixelStatus>();
    return band(0, rows_, red, green, depth_mm, status, workspace);
  }

  /// Only rows [first, last) of the frame, for threads that share a frame. The depths are bit for
  /// bit those of a whole frame.
  template <grid Red, grid Green, class Depth, class Status, class Pixel>
  DepthResult band(Index first,
                   Index last,
                   const Red& red,
                   const Green& green,
                   Depth&& depth_mm,
                   Status&& status,
                   Workspace<Pixel>& workspace) const {
    detail::writes_to<Depth, S>();
    static_assert(!detail::has_channels<cell_t<Red>> && !detail::has_channels<cell_t<Green>>,
                  "a colour image is not a channel: pass fingerpad::channel<T>(image, c) of it");
    static_assert(std::is_same_v<cell_t<Red>, Pixel> && std::is_same_v<cell_t<Green>, Pixel>,
                  "the workspace was made for another type of cell");
    DepthResult result;
    if (!(has_size(red) && has_size(green) && has_size(depth_mm) && has_size(status) &&
          workspace.area_ == pad_ && 0 <= first && first <= last && last <= rows_)) {
      return result;
    }
    result.status = DepthStatus::ok;
    result.pad_pixels = pad_pixels_;
    const auto depth_view = as_view(depth_mm);
    const auto status_view = as_view(status);
    detail::fill_outside(pad_, first, last, depth_view,
                         static_cast<cell_t<Depth>>(not_a_number<S>()));
    detail::fill_outside(pad_, first, last, status_view, PixelStatus::outside_pad);
    auto& outside = result.count[static_cast<std::size_t>(PixelStatus::outside_pad)];
    outside = (last - first) * cols_;

    const Index begin = (std::max)(first - pad_.row, Index(0));
    const Index end = (std::min)(last - pad_.row, pad_.rows);
    if (begin < end) {
      outside -= (end - begin) * pad_.cols;
      invert_rows(begin, end, detail::crop(as_view(red), pad_), detail::crop(as_view(green), pad_),
                  detail::crop(depth_view, pad_), detail::crop(status_view, pad_), workspace,
                  result);
    }
    const detail::RimLight::Sum rim =
        rim_.sum(first, last, as_view(red), as_view(green), workspace.scale_);
    result.rim_pixels = rim.pixels;
    result.rim_lit = rim.lit;
    result.rim_light = rim.light / static_cast<double>(rim.lit);
    result.judge();
    return result;
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

 private:
  /// All work is done on the rectangle of pixels that holds the pad, in its own coordinates.
  DepthEstimator(const detail::PadReference<S, Scattering, Heights>& pad,
                 const Absorption<double>& fluid,
                 Smoothing smoothing,
                 Inverse inverse)
      : rows_(pad.rows),
        cols_(pad.cols),
        pad_(pad.area),
        smoothing_(smoothing),
        solver_(pad.camera, fluid, pad.reference, inverse),
        rim_(pad) {
    setup_.rows = pad_.rows;
    setup_.cols = pad_.cols;
    setup_.in_pad = detail::usable_pixels(pad.camera, pad.reference);
    pad_pixels_ = std::count(setup_.in_pad.begin(), setup_.in_pad.end(), std::uint8_t(1));
    if constexpr (Smoothing::anchored) {
      setup_.anchor = detail::anchor_of(pad.camera, fluid, pad.reference);
    }
  }

  static const Camera<double>& checked(const Camera<double>& camera,
                                       const Absorption<double>& fluid,
                                       const Reference& reference) {
    require(camera);
    expects_valid(fluid);
    expects_grid_size("DepthEstimator", reference.rows, reference.cols);
    expects(reference.pixels_used > 0, "DepthEstimator", "reference.pixels_used",
            static_cast<long long>(reference.pixels_used), "> 0, as fit_reference() returns it");
    return camera;
  }

  template <class G>
  bool has_size(const G& g) const {
    return fingerpad::rows(g) == rows_ && fingerpad::cols(g) == cols_;
  }

  template <class Red, class Green, class Depth, class Status, class Pixel>
  void invert_rows(Index begin,
                   Index end,
                   const Red& red,
                   const Green& green,
                   const Depth& depth,
                   const Status& status,
                   Workspace<Pixel>& w,
                   DepthResult& result) const {
    w.rows_.start(setup_, red, green, begin);
    for (Index i = begin; i < end; ++i) {
      w.rows_.next(setup_, red, green, w.red_.data(), w.green_.data());
      solver_.invert(i, pad_.cols, w.red_.data(), w.green_.data(), w.depth_.data(),
                     w.status_.data());
      explain(i, red, green, w, result);
      detail::store_row(w.depth_.data(), depth, i);
      detail::store_row(w.status_.data(), status, i);
    }
  }

  /// Counts the row's pixels by status, and finds out why pixels without a colour have none.
  template <class Red, class Green, class Pixel>
  void explain(Index row,
               const Red& red,
               const Green& green,
               Workspace<Pixel>& w,
               DepthResult& result) const {
    const std::uint8_t* inside = setup_.in_pad.data() + row * pad_.cols;
    PixelStatus* status = w.status_.data();
    Index j = 0;
    while (j < pad_.cols) {
      const Index well = detail::count_well(inside + j, status + j, pad_.cols - j);
      result.count[static_cast<std::size_t>(PixelStatus::ok)] += well;
      j += well;
      const Index out = detail::count_zeros(inside + j, pad_.cols - j);
      std::fill_n(status + j, out, PixelStatus::outside_pad);
      std::fill_n(w.depth_.begin() + j, out, not_a_number<S>());
      result.count[static_cast<std::size_t>(PixelStatus::outside_pad)] += out;
      j += out;
      if (j < pad_.cols && inside[j] != 0 && status[j] != PixelStatus::ok) {
        if (status[j] == PixelStatus::not_a_number) {
          status[j] = detail::status_of_cells(red(row, j), green(row, j), w.scale_);
        }
        ++result.count[static_cast<std::size_t>(status[j])];
        ++j;
      }
    }
  }

  Index rows_;
  Index cols_;
  detail::PadArea pad_;
  Smoothing smoothing_;
  detail::ColourSetup<S> setup_;
  detail::DepthRows<Inverse, Heights, S, Scattering> solver_;
  detail::RimLight rim_;
  Index pad_pixels_ = 0;
};

template <scalar S,
          class Scattering,
          class Heights,
          class Smoothing = BiasFreeMean,
          class Inverse = ExponentialFree<>>
DepthEstimator(const Camera<double>&,
               const Absorption<double>&,
               const DepthReference<S, Scattering, Heights>&,
               Smoothing = {},
               Inverse = {}) -> DepthEstimator<Smoothing, Inverse, Heights, S, Scattering>;

}  // namespace v0
}  // namespace fingerpad
