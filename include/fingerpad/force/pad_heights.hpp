// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Converts a depth map along camera rays, and the mask of the contact, to heights in plan view.
#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/height_map.hpp"
#include "fingerpad/image/detail/pixel_rays.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// Fills height maps from the depth maps of a camera (or of an OrthographicCamera). Which pixel
/// sees the membrane above a position depends on the height there. So the height is found by
/// Newton's method; what depends on the position alone is computed in advance.
///
/// Threads may share one object. A frame allocates nothing, throws nothing, and takes bounded time
/// for each node.
template <class CameraType = Camera<double>>
class PadHeights {
 public:
  using Scalar = detail::camera_scalar_t<CameraType>;
  /// Heights on a square mesh in plan about Q: the shape that Wrench takes.
  using Map = detail::membrane::HeightMap<Scalar>;

  /// For depth maps of rows x cols pixels. The mesh covers positions within `half_width_mm` of Q
  /// along x and y, which must be at least the radius of the base plus a node. Refuses bad
  /// parameters (parameter_error).
  PadHeights(Index rows,
             Index cols,
             const CameraType& camera,
             const Scalar& half_width_mm = Scalar(39) / Scalar(2),
             const Scalar& spacing_mm = Scalar(1) / Scalar(2))
      : rows_(rows),
        cols_(cols),
        center_px_{camera.center_x_px, camera.center_y_px},
        half_width_mm_(half_width_mm),
        spacing_mm_(spacing_mm) {
    expects_grid_size("PadHeights", rows, cols, 2);
    require(camera);
    const Map nodes = map();
    side_ = nodes.side();
    projections_.reserve(static_cast<std::size_t>(side_ * side_));
    for (Index i = 0; i < side_; ++i) {
      for (Index j = 0; j < side_; ++j) {
        projections_.push_back(projection(camera, nodes.position_mm(j), nodes.position_mm(i)));
      }
    }
  }

  /// Memory for the heights of a frame.
  Map map() const { return Map(half_width_mm_, spacing_mm_); }

  /// Fills `heights` (from map()). False, and nothing written, if a size does not fit. Positions
  /// that no pixel with a depth sees have no height. A position is in contact to the extent that
  /// the pixels around it are.
  template <grid Depth, contact_mask Mask>
    requires(std::constructible_from<Scalar, cell_t<Depth>>)
  bool operator()(const Depth& depth_mm, const Mask& contact, Map& heights) const {
    for (int k = 0; k < parts; ++k) {
      if (!part(k, depth_mm, contact, heights)) {
        return false;
      }
    }
    heights.find_slopes();
    return true;
  }

  /// Number of parts of a frame, for threads that share it. It is fixed, because the search for a
  /// row's heights starts from the rows before it in its part: the result is the same whichever
  /// thread fills which part.
  static constexpr int parts = 2;
  /// Fills part `k` of `heights`, in [0, parts). False, and nothing written, for another k or if a
  /// size does not fit. Call heights.find_slopes() once all parts are filled.
  template <grid Depth, contact_mask Mask>
    requires(std::constructible_from<Scalar, cell_t<Depth>>)
  bool part(int k, const Depth& depth_mm, const Mask& contact, Map& heights) const {
    const auto depth = as_view(depth_mm);
    const auto mask = as_view(contact);
    if (k < 0 || k >= parts || depth.rows() != rows_ || depth.cols() != cols_ ||
        !same_size(depth, mask) || heights.side() != side_) {
      return false;
    }
    const Index first = k * side_ / parts;
    heights.fill_rows(
        first, (k + 1) * side_ / parts,
        [&](Index i, Index j) { return height(depth, at(i, j), continued(heights, first, i, j)); },
        [&](Index i, Index j, const S& z) { return contact_share(mask, at(i, j), z); });
    return true;
  }

 private:
  using S = Scalar;

  /// Projections are exact up to this height, and no guess exceeds it. So wildly wrong depths
  /// affect only the positions where they are seen.
  static constexpr int highest_mm = 20;

  /// Where a position in plan is seen: at center + (x, y) / mm_per_px, which depends on the height
  /// z there: mm_per_px = at_plate + rising z + bending z^2, nearly linear.
  struct Projection {
    S x, y;  ///< y in pixel heights over widths
    S at_plate, rising, bending;
  };

  static Projection projection(const CameraType& camera, const S& x, const S& y) {
    using std::sqrt;
    // on the axis, a point beside it gives the limit
    const S r_sq = x * x + y * y;
    const S r = value(r_sq) == 0 ? S(1) / S(1024) : S(sqrt(r_sq));
    const S high = S(highest_mm);
    const auto mm_per_px = [&](const S& z) {
      return S(r / S(pixel_of(camera, Point3<S>{r, S(0), z}).x - camera.center_x_px));
    };
    const S low = mm_per_px(S(0));
    const S middle = mm_per_px(S(high / S(2)));
    const S top = mm_per_px(high);
    const S bending = S(2) * (top - S(2) * middle + low) / (high * high);
    return {x, S(y / camera.pixel_aspect), low, S((top - low) / high - bending * high), bending};
  }

  const Projection& at(Index i, Index j) const {
    return projections_[static_cast<std::size_t>(i * side_ + j)];
  }

  /// The pixel that sees a position at some height.
  struct ProjectedPlace {
    S x_px, y_px;  ///< from the center
    S px_per_mm;
    S nearer;  ///< shift toward the center per mm of height, as a share of x_px and y_px
  };

  static ProjectedPlace projected(const Projection& s, const S& z) {
    const S px_per_mm = S(1) / (s.at_plate + z * (s.rising + z * s.bending));
    return {S(s.x * px_per_mm), S(s.y * px_per_mm), px_per_mm,
            S((s.rising + S(2) * z * s.bending) * px_per_mm)};
  }

  /// The depth there, and its derivative by the height of the position.
  struct Seen {
    S depth_mm;
    S per_mm;
  };

  /// Bilinear interpolation; NaN outside the map and beside pixels without depth.
  template <class View>
  Seen seen(const View& depth, const Projection& s, const S& z) const {
    const ProjectedPlace at = projected(s, z);
    const S x = center_px_.x + at.x_px;
    const S y = center_px_.y + at.y_px;
    const bool inside = value(x) >= 0 && value(y) >= 0 &&
                        value(x) < static_cast<scalar_real_t<S>>(cols_ - 1) &&
                        value(y) < static_cast<scalar_real_t<S>>(rows_ - 1);
    if (!inside) {
      return {not_a_number<S>(), not_a_number<S>()};
    }
    const Index j = static_cast<Index>(value(x));
    const Index i = static_cast<Index>(value(y));
    const S right = x - S(static_cast<double>(j));
    const S down = y - S(static_cast<double>(i));
    const S up_rise = S(depth(i, j + 1)) - S(depth(i, j));
    const S low_rise = S(depth(i + 1, j + 1)) - S(depth(i + 1, j));
    const S up = S(depth(i, j)) + right * up_rise;
    const S low = S(depth(i + 1, j)) + right * low_rise;
    const S outward = (up_rise + down * (low_rise - up_rise)) * at.x_px + (low - up) * at.y_px;
    return {S(up + down * (low - up)), S(-outward * at.nearer)};
  }

  /// Height of a node by linear extrapolation from the two before it in its column; NaN where these
  /// lie before row `first`.
  static S continued(const Map& heights, Index first, Index i, Index j) {
    if (i < first + 2) {
      return not_a_number<S>();
    }
    return S(S(2) * heights.node(i - 1, j).height_mm - heights.node(i - 2, j).height_mm);
  }

  /// The height z at which the depth seen equals z.
  template <class View>
  S height(const View& depth, const Projection& s, const S& guess) const {
    if (value(guess) >= 0 && value(guess) <= highest_mm) {
      const S near = root(depth, s, guess);
      if (is_finite(near)) {
        return near;
      }
    }
    const S on_plate = seen(depth, s, S(0)).depth_mm;
    // where the membrane is steep, a pixel further inside sees it
    return root(depth, s, is_depth(on_plate) ? on_plate : S(4));
  }

  template <class View>
  S root(const View& depth, const Projection& s, S z) const {
    constexpr int max_steps = 8;
    const S close = S(1) / S(20);  // mm; the step that follows leaves an error of some 0.001 mm
    for (int step = 0; step < max_steps; ++step) {
      const Seen here = seen(depth, s, z);
      const S excess = here.depth_mm - z;
      if (!is_depth(here.depth_mm)) {
        return not_a_number<S>();
      }
      const S slope = here.per_mm - S(1);
      z = z - excess / (slope < S(-1) / S(10) ? slope : S(-1));
      if (value(excess) < value(close) && value(excess) > value(S(-close))) {
        return z;
      }
    }
    return not_a_number<S>();
  }

  /// The share of four positions around a node where the mask says contact.
  template <class View>
  S contact_share(const View& mask, const Projection& s, const S& z) const {
    if (!is_finite(z)) {
      return S(0);
    }
    const ProjectedPlace at = projected(s, z);
    const S x = center_px_.x + at.x_px;
    const S y = center_px_.y + at.y_px;
    const S away = spacing_mm_ / S(4) * at.px_per_mm;
    const Index up = nearest(S(y - away), rows_), low = nearest(S(y + away), rows_);
    const Index left = nearest(S(x - away), cols_), right = nearest(S(x + away), cols_);
    const auto touches = [&](Index row, Index col) {
      return row >= 0 && col >= 0 && is_contact(mask(row, col)) ? 1 : 0;
    };
    const int touching =
        touches(up, left) + touches(up, right) + touches(low, left) + touches(low, right);
    return S(touching) / S(4);
  }

  /// The nearest pixel; -1 outside the image.
  static Index nearest(const S& px, Index count) {
    const S shifted = px + S(1) / S(2);
    const bool inside =
        value(shifted) >= 0 && value(shifted) < static_cast<scalar_real_t<S>>(count);
    return inside ? static_cast<Index>(value(shifted)) : Index(-1);
  }

  Index rows_;
  Index cols_;
  Point2<S> center_px_;
  S half_width_mm_;
  S spacing_mm_;
  Index side_ = 0;
  std::vector<Projection> projections_;
};

}  // namespace v0
}  // namespace fingerpad
