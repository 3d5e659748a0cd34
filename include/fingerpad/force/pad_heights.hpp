// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The membrane's shape over the plate, from a depth map along camera rays and the mask of the
// contact: height, slope and contact as functions of the position in plan.
#include <cmath>
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// The membrane at a position; NaN where unknown.
template <scalar S>
struct MembranePoint {
  S height_mm = not_a_number<S>();
  S along_x = not_a_number<S>();  ///< slopes
  S along_y = not_a_number<S>();
  S contact_share = S(0);  ///< of the membrane here that touches the object, from 0 to 1
};

/// Heights on a square mesh in plan about Q, the shape that Wrench takes. Slopes at the nodes are
/// central differences; between nodes all is interpolated bilinearly. 32 bytes per node in double.
template <scalar S>
class HeightMap {
 public:
  /// Covers positions within `half_width_mm` of Q along x and y, with nodes `spacing_mm` > 0 apart.
  /// Refuses bad parameters, and widths below 2 or above 2000 spacings (parameter_error).
  explicit HeightMap(const S& half_width_mm, const S& spacing_mm = S(0.5))
      : spacing_mm_(spacing_mm), per_mm_(S(1) / spacing_mm) {
    require("HeightMap", {{"spacing_mm", spacing_mm, positive}});
    const double spacing = static_cast<double>(value(spacing_mm));
    require("HeightMap", {{"half_width_mm", half_width_mm, within(2 * spacing, 2000 * spacing)}});
    middle_ = static_cast<Index>(value(half_width_mm / spacing_mm)) + 1;
    nodes_.resize(static_cast<std::size_t>(side() * side()));
  }

  /// Number of nodes along each side, odd; the middle node is at Q.
  Index side() const { return 2 * middle_ + 1; }
  const S& spacing_mm() const { return spacing_mm_; }
  /// x of node column k, which is also y of node row k.
  S position_mm(Index k) const { return S(static_cast<double>(k - middle_)) * spacing_mm_; }
  const MembranePoint<S>& node(Index row, Index col) const { return nodes_[at(row, col)]; }

  /// Writes every node, row after row: `height(row, col)` in mm (NaN: unknown), and
  /// `contact_share(row, col, height)`. `height` may read the heights of the nodes before.
  template <class Height, class Share>
  void fill(const Height& height, const Share& contact_share) {
    for (Index i = 0; i < side(); ++i) {
      // two loops, because a share waits for the height of its node, but not for others of the row
      for (Index j = 0; j < side(); ++j) {
        nodes_[at(i, j)].height_mm = height(i, j);
      }
      for (Index j = 0; j < side(); ++j) {
        nodes_[at(i, j)].contact_share = contact_share(i, j, nodes_[at(i, j)].height_mm);
      }
    }
    const S per_step = per_mm_ / S(2);
    for (Index i = 1; i + 1 < side(); ++i) {
      for (Index j = 1; j + 1 < side(); ++j) {
        const auto high = [&](Index row, Index col) { return nodes_[at(row, col)].height_mm; };
        nodes_[at(i, j)].along_x = (high(i, j + 1) - high(i, j - 1)) * per_step;
        nodes_[at(i, j)].along_y = (high(i + 1, j) - high(i - 1, j)) * per_step;
      }
    }
  }

  /// The membrane at a position. O(1).
  MembranePoint<S> operator()(const S& x_mm, const S& y_mm) const {
    const S col = x_mm * per_mm_ + S(static_cast<double>(middle_));
    const S row = y_mm * per_mm_ + S(static_cast<double>(middle_));
    const auto last = static_cast<scalar_real_t<S>>(static_cast<double>(side() - 1));
    if (!(value(row) >= 0 && value(col) >= 0 && value(row) < last && value(col) < last)) {
      return {};  // also for NaN
    }
    const Index i = static_cast<Index>(value(row)), j = static_cast<Index>(value(col));
    const S down = row - S(static_cast<double>(i)), right = col - S(static_cast<double>(j));
    const MembranePoint<S>* up = &nodes_[at(i, j)];
    const MembranePoint<S>* low = up + side();
    const auto between = [&](S MembranePoint<S>::*m) {
      const S above = up[0].*m + right * (up[1].*m - up[0].*m);
      const S below = low[0].*m + right * (low[1].*m - low[0].*m);
      return above + down * (below - above);
    };
    return {between(&MembranePoint<S>::height_mm), between(&MembranePoint<S>::along_x),
            between(&MembranePoint<S>::along_y), between(&MembranePoint<S>::contact_share)};
  }

  /// Whether at least half of the membrane here is in contact.
  bool in_contact(const S& x_mm, const S& y_mm) const {
    return !((*this)(x_mm, y_mm).contact_share < S(0.5));
  }

 private:
  std::size_t at(Index row, Index col) const {
    return static_cast<std::size_t>(row * side() + col);
  }

  S spacing_mm_;
  S per_mm_;  ///< nodes per mm
  Index middle_ = 0;
  std::vector<MembranePoint<S>> nodes_;
};

/// Fills height maps from the depth maps of a camera (or of an OrthographicCamera). Which pixel
/// sees the membrane above a position depends on the height there. So the height is found by
/// Newton's method; what depends on the position alone is computed in advance. Threads may share
/// one object. A frame allocates nothing, throws nothing, and takes bounded time for each node.
template <class CameraType = Camera<double>>
class PadHeights {
 public:
  using Scalar = std::remove_cvref_t<decltype(CameraType::pitch_mm)>;
  using Map = HeightMap<Scalar>;

  /// For depth maps of rows x cols pixels. The mesh covers positions within `half_width_mm` of Q
  /// along x and y, which must be at least the radius of the base plus a node. Refuses bad
  /// parameters (parameter_error).
  PadHeights(Index rows,
             Index cols,
             const CameraType& camera,
             const Scalar& half_width_mm = Scalar(19.5),
             const Scalar& spacing_mm = Scalar(0.5))
      : rows_(rows),
        cols_(cols),
        center_px_{camera.center_x_px, camera.center_y_px},
        half_width_mm_(half_width_mm),
        spacing_mm_(spacing_mm) {
    expects_grid_size("PadHeights", rows, cols, 2);
    require(camera);
    const Map nodes = map();
    side_ = nodes.side();
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
    const auto depth = as_view(depth_mm);
    const auto mask = as_view(contact);
    if (depth.rows() != rows_ || depth.cols() != cols_ || !same_size(depth, mask) ||
        heights.side() != side_) {
      return false;
    }
    heights.fill(
        [&](Index i, Index j) {
          // from the two nodes before it in its column
          const S guess =
              i < 2 ? not_a_number<S>()
                    : S(2) * heights.node(i - 1, j).height_mm - heights.node(i - 2, j).height_mm;
          return height(depth, at(i, j), guess);
        },
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
    // on the axis, a point beside it gives the limit
    const bool on_axis = value(x) == 0 && value(y) == 0;
    const S r = on_axis ? S(1) / S(1024) : norm(Point2<S>{x, y});
    const S high = S(highest_mm);
    const auto mm_per_px = [&](const S& z) {
      return r / (pixel_of(camera, Point3<S>{r, S(0), z}).x - camera.center_x_px);
    };
    const S low = mm_per_px(S(0)), middle = mm_per_px(high / S(2)), top = mm_per_px(high);
    const S bending = S(2) * (top - S(2) * middle + low) / (high * high);
    return {x, y / camera.pixel_aspect, low, (top - low) / high - bending * high, bending};
  }
  const Projection& at(Index i, Index j) const {
    return projections_[static_cast<std::size_t>(i * side_ + j)];
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
    const S close = S(0.05);  // mm; the step that follows leaves an error of some 0.001 mm
    for (int step = 0; step < max_steps; ++step) {
      const Seen here = seen(depth, s, z);
      const S excess = here.depth_mm - z;
      if (!is_depth(here.depth_mm)) {
        return not_a_number<S>();
      }
      const S slope = here.per_mm - S(1);
      z = z - excess / (slope < S(-0.1) ? slope : S(-1));
      if (excess < close && -excess < close) {
        return z;
      }
    }
    return not_a_number<S>();
  }

  /// The depth seen at a position of height z, and its derivative by z.
  struct Seen {
    S depth_mm = not_a_number<S>();
    S per_mm = not_a_number<S>();
  };
  /// By bilinear interpolation; NaN outside the map and beside pixels without depth.
  template <class View>
  Seen seen(const View& depth, const Projection& s, const S& z) const {
    const S px_per_mm = S(1) / (s.at_plate + z * (s.rising + z * s.bending));
    const S out_x = s.x * px_per_mm, out_y = s.y * px_per_mm;
    const S x = center_px_.x + out_x, y = center_px_.y + out_y;
    const bool inside = value(x) >= 0 && value(y) >= 0 &&
                        value(x) < static_cast<scalar_real_t<S>>(cols_ - 1) &&
                        value(y) < static_cast<scalar_real_t<S>>(rows_ - 1);
    if (!inside) {
      return {};
    }
    const Index i = static_cast<Index>(value(y)), j = static_cast<Index>(value(x));
    const S right = x - S(static_cast<double>(j)), down = y - S(static_cast<double>(i));
    const S up_rise = S(depth(i, j + 1)) - S(depth(i, j));
    const S low_rise = S(depth(i + 1, j + 1)) - S(depth(i + 1, j));
    const S up = S(depth(i, j)) + right * up_rise;
    const S low = S(depth(i + 1, j)) + right * low_rise;
    const S outward = (up_rise + down * (low_rise - up_rise)) * out_x + (low - up) * out_y;
    // per mm of height the pixel moves toward the center, by this share
    const S nearer = (s.rising + S(2) * z * s.bending) * px_per_mm;
    return {up + down * (low - up), -outward * nearer};
  }

  /// The share of four positions around a node where the mask says contact.
  template <class View>
  S contact_share(const View& mask, const Projection& s, const S& z) const {
    if (!is_finite(z)) {
      return S(0);
    }
    const S px_per_mm = S(1) / (s.at_plate + z * (s.rising + z * s.bending));
    const S away = spacing_mm_ / S(4) * px_per_mm;
    int touching = 0;
    for (const S& dy : {-away, away}) {
      for (const S& dx : {-away, away}) {
        const auto row = nearest(center_px_.y + s.y * px_per_mm + dy, rows_);
        const auto col = nearest(center_px_.x + s.x * px_per_mm + dx, cols_);
        touching += row >= 0 && col >= 0 && is_contact(mask(row, col)) ? 1 : 0;
      }
    }
    return S(touching) / S(4);
  }
  /// The nearest pixel; -1 outside the image.
  static Index nearest(const S& px, Index count) {
    const auto shifted = value(px + S(0.5));
    const bool inside = shifted >= 0 && shifted < static_cast<scalar_real_t<S>>(count);
    return inside ? static_cast<Index>(shifted) : Index(-1);
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
