// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Shape and irregularity of the object. Within the contact the membrane lies on the object, so the
// depth map there is the object's own surface. This gives its points in mm, the best-fitting plane,
// sphere or quadric, and the deviation from that. Source: Ito, Kim, Obinata, "Shape sensing by
// vision-based tactile sensor for dexterous handling of robot hands" (slides), which name shape and
// irregularity but give no equations; those of the fits stand in surface_models.hpp and
// quadric_model.hpp.
//
// Normals point toward the object. Curvatures are positive where the object is convex.
#include <array>
#include <concepts>
#include <type_traits>
#include <utility>

#include "fingerpad/contact/detail/patch.hpp"
#include "fingerpad/contact/quadric_model.hpp"
#include "fingerpad/contact/surface_models.hpp"
#include "fingerpad/contact/surface_points.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/pixel_box.hpp"
#include "fingerpad/image/detail/pixel_rays.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

struct SurfaceOptions {
  Index min_px = 50;  ///< fewer pixels are refused (too_few), >= 1; a model needs its unknowns + 1
  Index border_px = 0;  ///< strip along the contact's border to leave out, in [0, 1000]: there the
                        ///< membrane is just leaving the object
};

/// Refuses what has no meaning (parameter_error).
inline void expects_valid(const SurfaceOptions& options) {
  expects(options.min_px >= 1, "SurfaceOptions", "min_px", static_cast<long long>(options.min_px),
          ">= 1");
  expects(options.border_px >= 0 && options.border_px <= 1000, "SurfaceOptions", "border_px",
          static_cast<long long>(options.border_px), "in [0, 1000]");
}

enum class SurfaceStatus : unsigned char {
  ok,
  too_few,     ///< pixels in contact that have a depth
  degenerate,  ///< the pixels do not determine the shape (all in one line, for the quadric also two
               ///< level lines), or no camera could see it
  refused,     ///< a grid, state or workspace has another size: nothing was done
};

/// `shape` is a Plane, Sphere or Quadric; its numbers are finite where the status is ok, and NaN
/// elsewhere.
template <class Shape, scalar S = double>
struct [[nodiscard]] SurfaceResult {
  SurfaceStatus status = SurfaceStatus::refused;
  Index pixels = 0;  ///< that were used
  Shape shape = {};
  S rms_mm = not_a_number<S>();      ///< of the distances from the shape
  S largest_mm = not_a_number<S>();  ///< the distance largest in size, positive where the object
                                     ///< stands out into the pad; NaN without a residual map
  Index largest_row = -1;            ///< where that is
  Index largest_col = -1;

  bool accepted() const { return status != SurfaceStatus::refused; }
  bool ok() const { return status == SurfaceStatus::ok; }
};

namespace detail {

template <scalar S>
PlaneModel model_for(const Plane<S>&);
template <scalar S>
SphereModel model_for(const Sphere<S>&);
template <scalar S>
QuadricModel model_for(const Quadric<S>&);
template <class Shape>
using model_of = decltype(model_for(Shape{}));

}  // namespace detail

/// Fits a shape to the contact.
///   ShapeType   Plane<>, Sphere<> or Quadric<>, in the camera's number
///   CameraType  Camera<S> or OrthographicCamera<S>; S is the number computed in. Sums hold fourth
///               powers: for float they are in double. Depth maps may be of any number.
///
/// Pixels without contact or without a depth (not finite) change nothing. Standard errors are those
/// of pixels with independent errors of the size of the rms. Depth maps are averaged over a window
/// of some w x w pixels: their errors are alike within it, and the true standard error is about w
/// times larger.
///
/// const, so that threads may share one; a frame takes no memory, throws nothing, and looks at the
/// pixels once (plane) or twice, once more for the residual map.
template <class ShapeType = Plane<>, class CameraType = Camera<double>>
class SurfaceFit {
  using Model = detail::model_of<ShapeType>;

 public:
  using Scalar = detail::camera_scalar_t<CameraType>;
  using Shape = typename Model::template Shape<Scalar>;
  using Result = SurfaceResult<Shape, Scalar>;

 private:
  using Wide = std::conditional_t<std::same_as<Scalar, float>, double, Scalar>;
  using WideResult = SurfaceResult<typename Model::template Shape<Wide>, Wide>;

  static decltype(auto) widened(const CameraType& camera) {
    if constexpr (std::same_as<Wide, Scalar>) {
      return (camera);
    } else {
      return cast<Wide>(camera);
    }
  }

 public:
  SurfaceFit(Index rows,
             Index cols,
             const CameraType& camera,
             const SurfaceOptions& options = SurfaceOptions())
      : rows_(rows),
        cols_(cols),
        options_(checked(rows, cols, camera, options)),
        rays_(widened(camera), rows, cols) {}

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

  /// The shape of the object where `contact` is true.
  template <grid Depth, contact_mask Mask>
    requires(std::constructible_from<Scalar, cell_t<Depth>>)
  Result operator()(const Depth& depth_mm, const Mask& contact) const {
    const auto depth = as_view(depth_mm);
    const auto mask = as_view(contact);
    if (!has_size(depth) || !has_size(mask)) {
      return {};
    }
    const detail::ContactPixels<Wide, decltype(depth), decltype(mask)> pixels(depth, mask,
                                                                              options_.border_px);
    return told(fitted(pixels).result);
  }

  /// The same, and the distance of each pixel used from the shape, in mm: positive where the object
  /// stands out into the pad; NaN elsewhere, and everywhere unless ok(). `residual_mm` may be the
  /// depth map.
  template <grid Depth, contact_mask Mask, class Residual>
    requires(std::constructible_from<Scalar, cell_t<Depth>>)
  Result operator()(const Depth& depth_mm, const Mask& contact, Residual&& residual_mm) const {
    static_assert(detail::takes_numbers<Residual, Scalar>,
                  "this grid is written to: its cells must be assignable and able to hold NaN");
    const auto depth = as_view(depth_mm);
    const auto mask = as_view(contact);
    const auto out = as_view(std::forward<Residual>(residual_mm));
    if (!has_size(depth) || !has_size(mask) || !has_size(out)) {
      return {};
    }
    const detail::ContactPixels<Wide, decltype(depth), decltype(mask)> pixels(depth, mask,
                                                                              options_.border_px);
    Fitted fit = fitted(pixels);
    write_residuals(pixels, fit, out);
    return told(fit.result);
  }

 private:
  struct Fitted {
    WideResult result;
    detail::PixelBox box;
  };

  static Result told(const WideResult& r) {
    if constexpr (std::same_as<Wide, Scalar>) {
      return r;
    } else {
      return {.status = r.status,
              .pixels = r.pixels,
              .shape = cast<Scalar>(r.shape),
              .rms_mm = Scalar(r.rms_mm),
              .largest_mm = Scalar(r.largest_mm),
              .largest_row = r.largest_row,
              .largest_col = r.largest_col};
    }
  }

  static const SurfaceOptions& checked(Index rows,
                                       Index cols,
                                       const CameraType& camera,
                                       const SurfaceOptions& options) {
    expects_grid_size("SurfaceFit", rows, cols);
    require(camera);
    expects_valid(options);
    return options;
  }

  template <class View>
  bool has_size(const View& view) const {
    return view.rows() == rows_ && view.cols() == cols_;
  }

  template <class Pixels>
  Fitted fitted(const Pixels& pixels) const {
    using std::sqrt;
    Fitted fit;
    WideResult& result = fit.result;
    result.status = SurfaceStatus::too_few;
    detail::PixelSpread spread;
    const detail::PatchMoments<Wide> patch = moments(pixels, spread, fit.box);
    result.pixels = patch.pixels;
    if (patch.pixels < options_.min_px || patch.pixels <= Model::unknowns) {
      return fit;
    }
    result.status = SurfaceStatus::degenerate;
    typename Model::template Shape<Wide> shape;
    Wide mean_sq = Wide(0);
    const auto add_up = [&](const auto& kernel) {
      return sums_about(patch.centroid, pixels, fit.box, kernel);
    };
    if (!spread.is_line() && Model::fit(patch, add_up, shape, mean_sq) &&
        Model::is_finite_shape(shape) && value(shape.normal.z) > 0 && is_finite(mean_sq)) {
      result.status = SurfaceStatus::ok;
      result.shape = shape;
      result.rms_mm = value(mean_sq) > 0 ? Wide(sqrt(mean_sq)) : Wide(0);
    }
    return fit;
  }

  /// The first look at the pixels: moments about the first of them, moved to the centroid.
  template <class Pixels>
  detail::PatchMoments<Wide> moments(const Pixels& pixels,
                                     detail::PixelSpread& spread,
                                     detail::PixelBox& box) const {
    using Kernel = typename Model::template Moments<Wide>;
    std::array<Wide, Kernel::sums> sums;
    sums.fill(Wide(0));
    detail::PointBlock<Wide> block;
    Point3<Wide> origin = {Wide(0), Wide(0), Wide(0)};
    Index total = 0;
    box = {rows_, 0, cols_, 0};
    for (Index i = 0; i < rows_; ++i) {
      Index count = 0, sum_j = 0, sum_jj = 0, last = 0;
      pixels.for_each_in_row(i, 0, cols_, [&](Index j, const Wide& depth) {
        const Point3<Wide> p = rays_(i, j, depth);
        if (total + count == 0) {
          origin = p;
        }
        block.add(p - origin);
        if (block.full()) {
          flush(block, Kernel(), sums);
        }
        box.first_col = j < box.first_col ? j : box.first_col;
        last = j + 1;
        ++count;
        sum_j += j;
        sum_jj += j * j;
      });
      if (count > 0) {
        spread.add_row(i, count, sum_j, sum_jj);
        box.first_row = total == 0 ? i : box.first_row;
        box.last_row = i + 1;
        box.last_col = last > box.last_col ? last : box.last_col;
        total += count;
      }
    }
    flush(block, Kernel(), sums);
    return detail::centered(total, origin, sums);
  }

  template <class Pixels, class Kernel>
  std::array<Wide, Kernel::sums> sums_about(const Point3<Wide>& origin,
                                            const Pixels& pixels,
                                            const detail::PixelBox& box,
                                            const Kernel& kernel) const {
    std::array<Wide, Kernel::sums> sums;
    sums.fill(Wide(0));
    detail::PointBlock<Wide> block;
    for (Index i = box.first_row; i < box.last_row; ++i) {
      pixels.for_each_in_row(i, box.first_col, box.last_col, [&](Index j, const Wide& depth) {
        block.add(rays_(i, j, depth) - origin);
        if (block.full()) {
          flush(block, kernel, sums);
        }
      });
    }
    flush(block, kernel, sums);
    return sums;
  }

  template <class Kernel, class Sums>
  static void flush(detail::PointBlock<Wide>& block, const Kernel& kernel, Sums& sums) {
    detail::add_block(block, kernel, sums);
    block.count = 0;
  }

  template <class Pixels, class Out>
  void write_residuals(const Pixels& pixels, Fitted& fit, const Out& out) const {
    using std::sqrt;
    using Cell = std::remove_cvref_t<decltype(out(0, 0))>;
    const Cell missing = static_cast<Cell>(not_a_number<Wide>());
    WideResult& result = fit.result;
    Wide sum_sq = Wide(0);
    Wide largest = Wide(0);
    for (Index i = 0; i < rows_; ++i) {
      Index next = 0;  // first column not written yet
      const auto skip_to = [&](Index j) {
        for (; next < j; ++next) {
          out(i, next) = missing;
        }
      };
      const bool within = result.ok() && i >= fit.box.first_row && i < fit.box.last_row;
      pixels.for_each_in_row(i, fit.box.first_col, within ? fit.box.last_col : 0,
                             [&](Index j, const Wide& depth) {
                               const Wide r = result.shape.stands_out(rays_(i, j, depth));
                               skip_to(j);
                               out(i, j) = static_cast<Cell>(r);
                               next = j + 1;
                               const Wide r_sq = r * r;
                               sum_sq = sum_sq + r_sq;
                               if (result.largest_row < 0 || largest < r_sq) {
                                 largest = r_sq;
                                 result.largest_mm = r;
                                 result.largest_row = i;
                                 result.largest_col = j;
                               }
                             });
      skip_to(cols_);
    }
    if (result.ok()) {
      result.rms_mm = sqrt(Wide(sum_sq / Wide(static_cast<double>(result.pixels))));
    }
  }

  Index rows_;
  Index cols_;
  SurfaceOptions options_;
  detail::PixelRays<std::remove_cvref_t<decltype(widened(std::declval<const CameraType&>()))>>
      rays_;
};

}  // namespace v0
}  // namespace fingerpad
