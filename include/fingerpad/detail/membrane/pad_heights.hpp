// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From a depth map along camera rays, and the mask of the contact, to heights in plan.
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

#include "fingerpad/detail/membrane/height_map.hpp"
#include "fingerpad/detail/space/pixel_rays.hpp"
#include "fingerpad/dots.hpp"
#include "fingerpad/expects.hpp"
#include "fingerpad/grid.hpp"
#include "fingerpad/optics.hpp"
#include "fingerpad/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// Fills height maps from the depth maps of a camera (or of an OrthographicCamera). Above a place
/// in plan the pixel that sees the membrane there depends on the height that is looked for: it is
/// found by the secant method, from what depends on the place alone.
///
/// const, so that threads may share one; a frame takes no memory, throws nothing, and takes
/// bounded time for each node.
template <class CameraType = Camera<double>>
class PadHeights {
 public:
  using Scalar = detail::camera_scalar_t<CameraType>;

  /// For depth maps of rows x cols pixels; places within `half_width_mm` of Q along x and y, at
  /// least the radius of the base and a node more.
  PadHeights(Index rows,
             Index cols,
             const CameraType& camera,
             const Scalar& half_width_mm = Scalar(39) / Scalar(2),
             const Scalar& spacing_mm = Scalar(1) / Scalar(2))
      : rows_(rows), cols_(cols), half_width_mm_(half_width_mm), spacing_mm_(spacing_mm) {
    expects(rows >= 2, "PadHeights", "rows", static_cast<long long>(rows), ">= 2");
    expects(cols >= 2, "PadHeights", "cols", static_cast<long long>(cols), ">= 2");
    expects_valid(camera);
    const HeightMap<Scalar> nodes = map();
    side_ = nodes.side();
    sights_.reserve(static_cast<std::size_t>(side_ * side_));
    for (Index i = 0; i < side_; ++i) {
      for (Index j = 0; j < side_; ++j) {
        sights_.push_back(sight(camera, nodes.position_mm(j), nodes.position_mm(i)));
      }
    }
  }

  /// Memory for the heights of a frame.
  HeightMap<Scalar> map() const { return HeightMap<Scalar>(half_width_mm_, spacing_mm_); }

  /// Fills `heights` (from map()); false where a size does not fit: nothing is written. Places that
  /// no pixel with a depth sees have no height; a place is in contact as far as the pixels around
  /// it are.
  template <grid Depth, contact_mask Mask>
    requires(std::constructible_from<Scalar, cell_t<Depth>>)
  bool operator()(const Depth& depth_mm, const Mask& contact, HeightMap<Scalar>& heights) const {
    const auto depth = as_view(depth_mm);
    const auto mask = as_view(contact);
    if (depth.rows() != rows_ || depth.cols() != cols_ || !same_size(depth, mask) ||
        heights.side() != side_) {
      return false;
    }
    heights.fill([&](Index i, Index j) { return height(depth, at(i, j)); },
                 [&](Index i, Index j, const S& z) { return contact_share(mask, at(i, j), z); });
    return true;
  }

 private:
  using S = Scalar;

  /// Where the membrane above a place is seen: at center + (x, y) / mm_per_px, which depends on its
  /// height: mm_per_px = at_plate + rising z + bending z^2, nearly straight.
  struct Sight {
    S center_x, center_y;
    S x, y;
    S at_plate, rising, bending;
  };

  static Sight sight(const CameraType& camera, const S& x, const S& y) {
    using std::sqrt;
    // on the axis, the limit from beside it
    const S r_sq = x * x + y * y;
    const S r = value(r_sq) == 0 ? S(1) / S(1024) : S(sqrt(r_sq));
    const S high = S(20);
    const auto mm_per_px = [&](const S& z) {
      return S(r / S(pixel_of(camera, Point3<S>{r, S(0), z}).x - camera.center_x_px));
    };
    const S low = mm_per_px(S(0));
    const S middle = mm_per_px(S(high / S(2)));
    const S top = mm_per_px(high);
    const S bending = S(2) * (top - S(2) * middle + low) / (high * high);
    return {camera.center_x_px,
            camera.center_y_px,
            x,
            y,
            low,
            S((top - low) / high - bending * high),
            bending};
  }

  const Sight& at(Index i, Index j) const {
    return sights_[static_cast<std::size_t>(i * side_ + j)];
  }

  static Point2<S> pixel(const Sight& s, const S& z) {
    const S mm_per_px = s.at_plate + z * (s.rising + z * s.bending);
    return {S(s.center_x + s.x / mm_per_px), S(s.center_y + s.y / mm_per_px)};
  }

  /// Bilinear; NaN outside of the map and beside pixels without depth.
  template <class View>
  S depth_at(const View& depth, const Point2<S>& p) const {
    const bool inside = value(p.x) >= 0 && value(p.y) >= 0 &&
                        value(p.x) < static_cast<scalar_real_t<S>>(cols_ - 1) &&
                        value(p.y) < static_cast<scalar_real_t<S>>(rows_ - 1);
    if (!inside) {
      return not_a_number<S>();
    }
    const Index j = static_cast<Index>(value(p.x));
    const Index i = static_cast<Index>(value(p.y));
    const S right = p.x - S(static_cast<double>(j));
    const S down = p.y - S(static_cast<double>(i));
    const S up = S(depth(i, j)) + right * (S(depth(i, j + 1)) - S(depth(i, j)));
    const S low = S(depth(i + 1, j)) + right * (S(depth(i + 1, j + 1)) - S(depth(i + 1, j)));
    return S(up + down * (low - up));
  }

  /// The z with depth(pixel(z)) = z.
  template <class View>
  S height(const View& depth, const Sight& s) const {
    constexpr int most_steps = 8;
    const S close = S(1) / S(2000);  // mm
    S z = depth_at(depth, pixel(s, S(0)));
    if (!is_finite(z)) {  // steep membrane: seen from further inside
      z = S(4);
    }
    S before = z;
    S excess_before = S(0);
    for (int step = 0; step < most_steps; ++step) {
      const S excess = depth_at(depth, pixel(s, z)) - z;
      if (!is_finite(excess)) {
        return not_a_number<S>();
      }
      if (value(excess) < value(close) && value(excess) > value(S(-close))) {
        return S(z + excess);
      }
      const S slope = step == 0 ? S(-1) : S((excess - excess_before) / (z - before));
      before = z;
      excess_before = excess;
      z = z - excess / (slope < S(-1) / S(10) ? slope : S(-1));
    }
    return not_a_number<S>();
  }

  template <class View>
  S contact_share(const View& mask, const Sight& s, const S& z) const {
    if (!is_finite(z)) {
      return S(0);
    }
    const Point2<S> p = pixel(s, z);
    const S away = spacing_mm_ / (S(4) * s.at_plate);  // px
    S share = S(0);
    for (const int down : {-1, 1}) {
      for (const int right : {-1, 1}) {
        const S col = p.x + S(right) * away + S(1) / S(2);
        const S row = p.y + S(down) * away + S(1) / S(2);
        const bool inside = value(col) >= 0 && value(row) >= 0 &&
                            value(col) < static_cast<scalar_real_t<S>>(cols_) &&
                            value(row) < static_cast<scalar_real_t<S>>(rows_);
        if (inside &&
            says_contact(mask(static_cast<Index>(value(row)), static_cast<Index>(value(col))))) {
          share = share + S(1) / S(4);
        }
      }
    }
    return share;
  }

  Index rows_;
  Index cols_;
  S half_width_mm_;
  S spacing_mm_;
  Index side_ = 0;
  std::vector<Sight> sights_;
};

}  // namespace v0
}  // namespace fingerpad
