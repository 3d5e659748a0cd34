// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The area of the flat contact that would press as hard as the object. With it a look-up of force
// (force/look_up.hpp) holds for objects of any shape.
//
// The depth map gives the plan area A within a series of curves around the contact, and the
// integral f of the sum k of the principal curvatures over it. With p the pressure and the mean
// tension linear in f (docs/force/normal_force.md),
//
//   A = S_eq + (a + b f) f,   S_eq = F_z / p,                                            (EA2)
//
// S_eq is where a parabola through (f, A) meets f = 0.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

/// The equivalent flat area; NaN if too little of the free membrane was seen.
template <scalar S = double>
struct [[nodiscard]] FlatAreaResult {
  S area_mm2 = not_a_number<S>();      ///< of the flat plate that would press as hard; F_z = p area
  S variance_mm4 = not_a_number<S>();  ///< of the area, from the tension inside the first curve,
                                       ///< which differs from that of (EA2) by a fifth (sd)

  bool ok() const { return is_finite(area_mm2); }
};

namespace detail {

/// A point of a lattice on a surface r(u, v), from it and its neighbours: its part of the lattice
/// in plan, and the integral over it of the sum of the principal curvatures, positive where the
/// surface is a dome seen from +z.
template <scalar S>
struct FlatAreaPoint {
  S area_mm2, flux_mm;
  bool is_steep;  ///< steeper than 45 degrees

  /// `at` is the middle one, in rows of `cols` points.
  FlatAreaPoint(const Point3<S>* at, Index cols) {
    using std::sqrt;
    const S half = S(1) / S(2), quarter = half * half;
    const Point3<S>&west = at[-1], &east = at[1], &north = at[-cols], &south = at[cols];
    const Point3<S> u = half * (east - west), v = half * (south - north);
    const Point3<S> uu = east - at[0] - at[0] + west, vv = south - at[0] - at[0] + north;
    const Point3<S> uv = quarter * (at[cols + 1] - at[cols - 1] - at[1 - cols] + at[-1 - cols]);
    const Point3<S> n = cross(u, v);
    const S metric = dot(n, n);  // E G - F^2
    const S sum = dot(uu, n) * dot(v, v) - S(2) * dot(uv, n) * dot(u, v) + dot(vv, n) * dot(u, u);
    area_mm2 = n.z;
    flux_mm = (value(n.z) < 0 ? n.z : -n.z) * sum / (metric * sqrt(metric));
    is_steep = value(n.x * n.x + n.y * n.y) > value(n.z * n.z);
  }
};

}  // namespace detail

/// Evaluates (EA2) on a depth map and its contact mask. The map is sampled on a lattice of points
/// 0.6 mm apart on the plate; noise of a curvature grows as 1 / spacing^2. A curve encloses all
/// points within some distance of the contact. The first one lies 0.8 mm from it, the error of the
/// contact's edge plus half the smoothing window of the depths; the others follow 0.6 mm apart. A
/// curve takes part if at most one in twenty of its points lacks a curvature (no depth, steeper
/// than 45 degrees, at the border of the image); these get the mean of the points beside the same
/// curve. There is no answer with fewer than five curves, or if the pad does not curve outward
/// around the contact.
///
/// One object a thread. Bounded time and no allocation per frame; O(points of the lattice).
template <scalar S = double>
class EquivalentFlatArea {
  static constexpr Index straight = 5, diagonal = 7;  // steps of the distance (Borgefors 1986)
  static constexpr std::size_t min_curves = 5;
  static constexpr double spacing_mm = 0.6, margin_mm = 0.8, tension_share = 0.2;

 public:
  /// rows, cols in [1, 1e6]. Refuses bad parameters (parameter_error).
  template <class CameraType>
  EquivalentFlatArea(const CameraType& camera, Index rows, Index cols)
      : image_rows_(rows), image_cols_(cols) {
    expects_grid_size("EquivalentFlatArea", rows, cols);
    require(camera);
    const double width_mm = static_cast<double>(value(camera.pitch_mm));
    const double height_mm = width_mm * static_cast<double>(value(camera.pixel_aspect));
    const auto step = [&](double pixel_mm) {
      return (std::max)(Index(1), static_cast<Index>(std::lround(spacing_mm / pixel_mm)));
    };
    row_step_ = step(height_mm);
    col_step_ = step(width_mm);
    rows_ = (rows - 1) / row_step_ + 1;
    cols_ = (cols - 1) / col_step_ + 1;
    const double step_mm =
        (static_cast<double>(row_step_) * height_mm + static_cast<double>(col_step_) * width_mm) /
        2;
    margin_ = static_cast<Index>(std::lround(static_cast<double>(straight) * margin_mm / step_mm));
    const auto eye = cast<S>(camera);
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        const auto seen = [&](int depth_mm) {
          return point_at(eye, S(static_cast<double>(i * row_step_)),
                          S(static_cast<double>(j * col_step_)), S(depth_mm));
        };
        rays_.push_back({seen(0), seen(1) - seen(0)});
      }
    }
    const std::size_t cells = static_cast<std::size_t>((rows_ + 2) * (cols_ + 2));
    points_.assign(cells, detail::missing_point<S>());
    distances_.assign(cells, far());
    curves_.resize(static_cast<std::size_t>(rows_ + cols_));
  }

  /// Processes one frame. With grids of another size or without contact there is no answer: ok() is
  /// false.
  template <contact_mask Mask, grid Depth>
  FlatAreaResult<S> operator()(const Mask& contact, const Depth& depth_mm) {
    const auto mask = as_view(contact);
    const auto depth = as_view(depth_mm);
    FlatAreaResult<S> result;
    if (!same_size(mask, depth) || depth.rows() != image_rows_ || depth.cols() != image_cols_) {
      return result;
    }
    const Ray* ray = rays_.data();
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j, ++ray) {
        const Index row = i * row_step_, col = j * col_step_;
        points_[place(i, j)] = ray->on_plate + S(depth(row, col)) * ray->per_depth;
        distances_[place(i, j)] = is_contact(cell_t<Mask>(mask(row, col))) ? 0 : far();
      }
    }
    spread();
    collect();
    const S area = area_without_flux();
    if (is_finite(area) && value(area) > 0) {
      result.area_mm2 = area;
      result.variance_mm4 = square(S(tension_share) * (curves_[0].area_mm2 - area));
    }
    return result;
  }

  Index rows() const { return image_rows_; }
  Index cols() const { return image_cols_; }

 private:
  struct Ray {
    Point3<S> on_plate, per_depth;
  };
  /// Plan area within a curve, and the integral of the curvature over it.
  struct Curve {
    S area_mm2 = S(0), flux_mm = S(0);
    Index points = 0, unseen = 0;

    /// Adds a point of the lattice. It is not seen where it or a neighbour has no depth.
    void add(const Point3<S>* at, Index cols) {
      ++points;
      ++unseen;
      if (is_finite(at->z)) {
        const detail::FlatAreaPoint<S> point(at, cols);
        if (is_finite(point.flux_mm) && !point.is_steep) {
          area_mm2 += point.area_mm2;
          flux_mm += point.flux_mm;
          --unseen;
        }
      }
    }

    /// Adds a curve; its points that are not seen count like the others.
    void add(const Curve& other) {
      const S seen = S(static_cast<double>((std::max)(Index(1), other.points - other.unseen)));
      const S fill = S(static_cast<double>(other.points)) / seen;
      area_mm2 += fill * other.area_mm2;
      flux_mm += fill * other.flux_mm;
      points += other.points;
      unseen += other.unseen;
    }
  };

  /// In a lattice with a border of points that are missing and far.
  std::size_t place(Index i, Index j) const {
    return static_cast<std::size_t>((i + 1) * (cols_ + 2) + j + 1);
  }
  Index far() const { return straight * (rows_ + cols_); }

  /// From 0 in contact and far elsewhere to the distance from the contact, within 6 %.
  void spread() {
    const Index width = cols_ + 2;
    const auto nearest = [](Index* here, Index beside, Index next_row) {
      *here = (std::min)({*here, beside + straight, here[next_row] + straight,
                          here[next_row - 1] + diagonal, here[next_row + 1] + diagonal});
      return *here;
    };
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0, beside = far(); j < cols_; ++j) {
        beside = nearest(&distances_[place(i, j)], beside, -width);
      }
    }
    for (Index i = rows_; i-- > 0;) {
      for (Index j = cols_, beside = far(); j-- > 0;) {
        beside = nearest(&distances_[place(i, j)], beside, width);
      }
    }
  }

  /// Adds each point to the first curve around it, then to each curve all those within.
  void collect() {
    std::fill(curves_.begin(), curves_.end(), Curve());
    const Index last = static_cast<Index>(curves_.size()) - 1;
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        const std::size_t at = place(i, j);
        const Index beyond = (std::max)(Index(0), distances_[at] - margin_);
        const Index curve = (std::min)(last, (beyond + straight - 1) / straight);
        curves_[static_cast<std::size_t>(curve)].add(&points_[at], cols_ + 2);
      }
    }
    Curve within;
    for (Curve& curve : curves_) {
      within.add(curve);
      curve = within;
    }
  }

  /// Where the least-squares parabola of the areas over the fluxes meets flux = 0. NaN unless
  /// enough curves see enough, with more flux each than the one within. Fluxes are counted from
  /// the first one's.
  S area_without_flux() const {
    const S first = curves_[0].flux_mm;
    detail::ProductSums<S, 4> sums;  // of 1, x, x^2, area
    std::size_t count = 0;
    for (const Curve& curve : curves_) {
      const S x = curve.flux_mm - first;
      const bool grows = count == 0 || value(curve.flux_mm) > value(curves_[count - 1].flux_mm);
      if (curve.points == 0 || 20 * curve.unseen > curve.points || !grows) {
        break;
      }
      sums.add({S(1), x, x * x, curve.area_mm2});
      ++count;
    }
    const detail::NormalEquations<S, 3> equations(sums.template corner<3>());
    const std::array<S, 3> c = equations.solve(sums.template column<3>(3));
    return count >= min_curves && equations.good ? c[0] - first * (c[1] - first * c[2])
                                                 : not_a_number<S>();
  }

  Index image_rows_, image_cols_;
  Index row_step_, col_step_;  // px between the points of the lattice
  Index rows_, cols_;          // of the lattice
  Index margin_ = 0;           // in steps of the distance
  detail::SharedVector<Ray> rays_;
  std::vector<Point3<S>> points_;
  std::vector<Index> distances_;
  std::vector<Curve> curves_;
};

}  // namespace v1
}  // namespace fingerpad
