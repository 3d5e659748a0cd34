// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The area of the flat contact that would press as hard as the object. With it a look-up of force
// (force/normal_force.hpp) holds for objects of any shape.
//
// Cut the membrane along a closed curve around the contact. Three things act on the piece inside:
// the fluid's pressure p over the plan area A, the object's force, and along the curve the tension
// T, whose vertical part is T sin(alpha) with the slope alpha across the curve:
//
//   F_z = p A - T_mean f,   f = integral of sin(alpha) ds = integral of k dA            (EA1)
//
// where k is the sum of the two principal curvatures (divergence theorem). It holds for every
// curve, so with S_eq = F_z / p, the area of the plate that would press as hard (eq. 2 of Ito, Kim
// and Obinata),
//
//   A = S_eq + (T_mean / p) f,   T_mean / p = a + b f                                   (EA2)
//
// The depth map gives A and f for a series of curves. The mean tension changes slowly from curve to
// curve and is assumed to be linear in f: S_eq is where a parabola through (f, A) meets f = 0. No
// curve runs through the contact, so errors of its edge and smoothing there do not matter:
// smoothing moves curvature but keeps its integral.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/pixel_box.hpp"
#include "fingerpad/image/detail/quick_math.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// Where the curves run around the contact.
struct FlatAreaOptions {
  double spacing_mm = 0.6;  ///< between sampled points, and between curves, on the plate, in
                            ///< [0.05, 10]; noise of a curvature grows as 1 / spacing^2
  double margin_mm = 0.8;   ///< from the contact to the first curve, in [0, 100]: the error of the
                            ///< contact's edge plus half the smoothing window of the depths
  double max_slope = 1.0;   ///< steeper points have no curvature; > 0
  Index min_curves = 5;     ///< in [4, 1000]; with fewer there is no answer
  double tension_share = 0.2;  ///< standard deviation of the tension inside the first curve from
                               ///< that of (EA2), as a fraction of it, >= 0
};

/// Refuses what has no meaning (parameter_error).
inline void expects_valid(const FlatAreaOptions& options) {
  const auto refuse_if_not = [](bool held, const char* name, double value, const char* range) {
    expects(held, "FlatAreaOptions", name, value, range);
  };
  refuse_if_not(options.spacing_mm >= 0.05 && options.spacing_mm <= 10, "spacing_mm",
                options.spacing_mm, "in [0.05, 10]");
  refuse_if_not(options.margin_mm >= 0 && options.margin_mm <= 100, "margin_mm", options.margin_mm,
                "in [0, 100]");
  refuse_if_not(options.max_slope > 0, "max_slope", options.max_slope, "> 0");
  refuse_if_not(options.min_curves >= 4 && options.min_curves <= 1000, "min_curves",
                static_cast<double>(options.min_curves), "in [4, 1000]");
  refuse_if_not(options.tension_share >= 0 && options.tension_share <= 1e3, "tension_share",
                options.tension_share, "in [0, 1000]");
}

/// The equivalent flat area; NaN if too little of the free membrane was seen.
template <scalar S = double>
struct [[nodiscard]] FlatAreaResult {
  S area_mm2 = not_a_number<S>();      ///< of the flat plate that would press as hard; F_z = p area
  S variance_mm4 = not_a_number<S>();  ///< of the area, from the unknown tension
  Index curves = 0;                    ///< around the contact that took part

  bool ok() const { return is_finite(area_mm2); }
};

namespace detail {

/// Of one coordinate of a surface r(u, v), from its points on a 3 x 3 lattice.
template <class V>
struct LatticeDerivatives {
  V u, v, uu, vv, uv;

  /// `at` is the middle one, in rows of `cols` points.
  template <class S>
  LatticeDerivatives(const S* at, Index cols) {
    const auto from = [&](Index down, Index right) {
      return load_cells<V, S>(at + down * cols + right);
    };
    const S half = S(1) / S(2), quarter = half * half;
    const V north = from(-1, 0), south = from(1, 0), west = from(0, -1), east = from(0, 1);
    const V here = from(0, 0), twice = here + here;
    u = half * (east - west);
    v = half * (south - north);
    uu = east - twice + west;
    vv = south - twice + north;
    uv = quarter * (from(1, 1) - from(1, -1) - from(-1, 1) + from(-1, -1));
  }
};

/// A point's part of the lattice in plan, and the integral of the sum of the principal curvatures
/// over it: positive where the surface is a dome seen from +z, NaN where it is steeper than
/// max_slope or has no direction.
template <class V>
struct FlatAreaPoint {
  V area_mm2, flux_mm;

  template <class S>
  FlatAreaPoint(const S* x_mm, const S* y_mm, const S* z_mm, Index cols, const S& max_slope) {
    using Derivatives = LatticeDerivatives<V>;
    const Derivatives x(x_mm, cols), y(y_mm, cols), z(z_mm, cols);
    const V nx = y.u * z.v - z.u * y.v;
    const V ny = z.u * x.v - x.u * z.v;
    const V nz = x.u * y.v - y.u * x.v;
    const V zero = every_lane<V>(S(0));
    const V level_sq = nx * nx + ny * ny;
    const V steepest_sq = max_slope * max_slope * (nz * nz);
    const V metric = level_sq + nz * nz;  // E G - F^2
    const V e = x.u * x.u + y.u * y.u + z.u * z.u;
    const V f = x.u * x.v + y.u * y.v + z.u * z.v;
    const V g = x.v * x.v + y.v * y.v + z.v * z.v;
    const V of_uu = x.uu * nx + y.uu * ny + z.uu * nz;
    const V of_uv = x.uv * nx + y.uv * ny + z.uv * nz;
    const V of_vv = x.vv * nx + y.vv * ny + z.vv * nz;
    const V sum = of_uu * g - (of_uv * f + of_uv * f) + of_vv * e;
    const V per_length = inverse_sqrt<V>(metric);
    const V minus = -nz;
    const V inward = nz < zero ? nz : minus;
    const V flux = inward * sum * (per_length * per_length * per_length);
    const V none = every_lane<V>(not_a_number<S>());
    const V seen = metric > zero ? flux : none;
    area_mm2 = nz;
    flux_mm = level_sq <= steepest_sq ? seen : none;
  }
};

/// Plan area within a curve, and the integral of the curvature over it.
template <scalar S>
struct FlatAreaCurve {
  S area_mm2 = S(0);
  S flux_mm = S(0);
  Index points = 0;
  Index unseen = 0;

  /// Takes the unseen points for ones like the others.
  void fill() {
    if (unseen > 0 && unseen < points) {
      const S share = S(static_cast<double>(points)) / S(static_cast<double>(points - unseen));
      area_mm2 = area_mm2 * share;
      flux_mm = flux_mm * share;
    }
  }
  void add(const FlatAreaCurve& within) {
    area_mm2 = area_mm2 + within.area_mm2;
    flux_mm = flux_mm + within.flux_mm;
    points += within.points;
    unseen += within.unseen;
  }
};

/// Where the least-squares parabola of the areas over the fluxes meets flux = 0, by polynomials
/// that are orthogonal on the given fluxes. NaN where they do not tell three parameters.
template <scalar S>
S area_without_flux(const FlatAreaCurve<S>* curves, Index count) {
  const S n = S(static_cast<double>(count));
  S mean = S(0), area = S(0);
  for (Index k = 0; k < count; ++k) {
    mean = mean + curves[k].flux_mm / n;
    area = area + curves[k].area_mm2 / n;
  }
  S square_sum = S(0), cube_sum = S(0);
  for (Index k = 0; k < count; ++k) {
    const S x = curves[k].flux_mm - mean;
    square_sum = square_sum + x * x;
    cube_sum = cube_sum + x * x * x;
  }
  const S skew = cube_sum / square_sum, spread = square_sum / n;
  const auto second = [&](const S& x) { return S(x * (x - skew) - spread); };
  S first_part = S(0), second_part = S(0), second_sq = S(0);
  for (Index k = 0; k < count; ++k) {
    const S x = curves[k].flux_mm - mean, y = curves[k].area_mm2, q = second(x);
    first_part = first_part + y * x / square_sum;
    second_part = second_part + y * q;
    second_sq = second_sq + q * q;
  }
  return S(area - first_part * mean + second_part / second_sq * second(S(-mean)));
}

}  // namespace detail

/// Evaluates (EA2) on a depth map and its contact mask. The map is sampled on a lattice of points
/// spacing_mm apart. A curve encloses all points within some distance of the contact. It takes part
/// if at most one in twenty of its points lacks a curvature (no depth, too steep, at the border of
/// the image); these get the mean of the points beside the same curve. There is no answer if the
/// pad does not curve outward around the contact.
///
/// Threads may share one object, each with its own workspace. Bounded time and no allocation per
/// frame; O(pixels / step^2) with step = spacing_mm / pitch.
template <class CameraType = Camera<double>, scalar S = double>
class EquivalentFlatArea {
  using Curve = detail::FlatAreaCurve<S>;
  static constexpr Index step_length = 5, diagonal_length = 7;  // of the distance, Borgefors 1986

 public:
  /// Refuses bad parameters (parameter_error).
  EquivalentFlatArea(const CameraType& camera,
                     Index rows,
                     Index cols,
                     const FlatAreaOptions& options = {})
      : options_(checked(camera, rows, cols, options)),
        image_rows_(rows),
        image_cols_(cols),
        step_((std::max)(
            Index(1), static_cast<Index>(std::lround(options.spacing_mm / pitch_mm_of(camera))))),
        rows_((rows - 1) / step_ + 1),
        cols_((cols - 1) / step_ + 1) {
    const double step_mm = static_cast<double>(step_) * pitch_mm_of(camera);
    margin_ = static_cast<Index>(std::lround(step_length * options.margin_mm / step_mm));
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        const S row = S(static_cast<double>(i * step_)), col = S(static_cast<double>(j * step_));
        const Point3<S> on_plate = point_at(camera, row, col, S(0));
        rays_.push_back({on_plate, point_at(camera, row, col, S(1)) - on_plate});
      }
    }
  }

  /// Scratch memory for a frame; one per thread.
  class Workspace {
   public:
    explicit Workspace(const EquivalentFlatArea& area)
        : x_(area.rays_.size()),
          y_(x_.size()),
          z_(x_.size()),
          areas_(x_.size()),
          fluxes_(x_.size(), not_a_number<S>()),
          distances_(static_cast<std::size_t>((area.rows_ + 2) * (area.cols_ + 2)), area.far()),
          curves_(static_cast<std::size_t>(area.rows_ + area.cols_)) {}

   private:
    friend class EquivalentFlatArea;
    std::vector<S> x_, y_, z_;       // of the points
    std::vector<S> areas_, fluxes_;  // of their parts of the lattice; none along its border
    std::vector<Index> distances_;   // with a border of far ones
    std::vector<Curve> curves_;
  };
  Workspace workspace() const { return Workspace(*this); }

  /// Processes one frame. With grids of another size, without contact, or with the workspace of
  /// another estimator there is no answer: ok() is false.
  template <contact_mask Mask, grid Depth>
  FlatAreaResult<S> operator()(const Mask& contact, const Depth& depth_mm, Workspace& w) const {
    const auto mask = as_view(contact);
    const auto depth = as_view(depth_mm);
    FlatAreaResult<S> result;
    if (!same_size(mask, depth) || depth.rows() != image_rows_ || depth.cols() != image_cols_ ||
        w.x_.size() != rays_.size()) {
      return result;
    }
    for (Index i = 0; i < rows_; ++i) {
      Index* distance = w.distances_.data() + beside(i, 0);
      for (Index j = 0; j < cols_; ++j) {
        const std::size_t k = place(i, j);
        const Ray& ray = rays_[k];
        const S l = S(depth(i * step_, j * step_));
        w.x_[k] = ray.on_plate.x + l * ray.per_depth.x;
        w.y_[k] = ray.on_plate.y + l * ray.per_depth.y;
        w.z_[k] = ray.on_plate.z + l * ray.per_depth.z;
        distance[j] = is_contact(cell_t<Mask>(mask(i * step_, j * step_))) ? 0 : far();
      }
    }
    spread(w.distances_);
    measure(w);
    collect(w);
    result.curves = usable(w.curves_);
    if (result.curves >= options_.min_curves) {
      const S area = detail::area_without_flux(w.curves_.data(), result.curves);
      const S carried = S(options_.tension_share) * (w.curves_[0].area_mm2 - area);
      if (is_finite(area) && value(area) > 0) {
        result.area_mm2 = area;
        result.variance_mm4 = square(carried);
      }
    }
    return result;
  }

  Index rows() const { return image_rows_; }
  Index cols() const { return image_cols_; }

 private:
  struct Ray {
    Point3<S> on_plate, per_depth;
  };

  static const FlatAreaOptions& checked(const CameraType& camera,
                                        Index rows,
                                        Index cols,
                                        const FlatAreaOptions& options) {
    expects_grid_size("EquivalentFlatArea", rows, cols, 1);
    require(camera);
    expects_valid(options);
    return options;
  }

  static double pitch_mm_of(const CameraType& camera) {
    return static_cast<double>(value(camera.pitch_mm));
  }

  std::size_t place(Index i, Index j) const { return static_cast<std::size_t>(i * cols_ + j); }

  /// The same in a lattice with a border.
  Index beside(Index i, Index j) const { return (i + 1) * (cols_ + 2) + j + 1; }
  Index far() const { return step_length * (rows_ + cols_); }

  /// From 0 in contact and far elsewhere to the distance from the contact, within 6 %.
  void spread(std::vector<Index>& distances) const {
    const auto from = [&](Index* here, const Index* next_row, Index before) {
      *here = (std::min)({*here, next_row[0] + step_length, next_row[-1] + diagonal_length,
                          next_row[1] + diagonal_length, here[before] + step_length});
    };
    const Index width = cols_ + 2;
    for (Index i = 0; i < rows_; ++i) {
      Index* row = distances.data() + beside(i, 0);
      for (Index j = 0; j < cols_; ++j) {
        from(row + j, row + j - width, -1);
      }
    }
    for (Index i = rows_; i-- > 0;) {
      Index* row = distances.data() + beside(i, 0);
      for (Index j = cols_; j-- > 0;) {
        from(row + j, row + j + width, 1);
      }
    }
  }

  /// Areas and fluxes; vectors of float would be too coarse.
  void measure(Workspace& w) const {
    constexpr int lanes = std::same_as<S, double> ? detail::row_lanes<S> : 1;
    const S max_slope = S(options_.max_slope);
    for (Index i = 1; i + 1 < rows_; ++i) {
      const Index first = i * cols_ + 1;
      detail::for_each_cell<S, lanes>(cols_ - 2, [&]<class V>(Index j) {
        const Index k = first + j;
        const detail::FlatAreaPoint<V> point(w.x_.data() + k, w.y_.data() + k, w.z_.data() + k,
                                             cols_, max_slope);
        detail::store_cells<S>(w.areas_.data() + k, point.area_mm2);
        detail::store_cells<S>(w.fluxes_.data() + k, point.flux_mm);
      });
    }
  }

  /// What each point adds to the first curve around it; then all curves within.
  void collect(Workspace& w) const {
    std::fill(w.curves_.begin(), w.curves_.end(), Curve{});
    const Index last = static_cast<Index>(w.curves_.size()) - 1;
    for (Index i = 0; i < rows_; ++i) {
      const Index* distance = w.distances_.data() + beside(i, 0);
      for (Index j = 0; j < cols_; ++j) {
        const Index beyond = (std::max)(Index(0), distance[j] - margin_);
        const Index k = (std::min)(last, (beyond + step_length - 1) / step_length);
        Curve& curve = w.curves_[static_cast<std::size_t>(k)];
        const S& flux = w.fluxes_[place(i, j)];
        ++curve.points;
        if (is_finite(flux)) {
          curve.area_mm2 = curve.area_mm2 + w.areas_[place(i, j)];
          curve.flux_mm = curve.flux_mm + flux;
        } else {
          ++curve.unseen;
        }
      }
    }
    for (std::size_t k = 0; k < w.curves_.size(); ++k) {
      w.curves_[k].fill();
      if (k > 0) {
        w.curves_[k].add(w.curves_[k - 1]);
      }
    }
  }

  Index usable(const std::vector<Curve>& curves) const {
    Index count = 0;
    for (const Curve& curve : curves) {
      const bool grows =
          count == 0 ||
          value(curve.flux_mm) > value(curves[static_cast<std::size_t>(count - 1)].flux_mm);
      if (curve.points == 0 || 20 * curve.unseen > curve.points || !grows) {
        break;
      }
      ++count;
    }
    return count;
  }

  FlatAreaOptions options_;
  Index image_rows_, image_cols_;
  Index step_;
  Index rows_, cols_;  // of the lattice
  Index margin_ = 0;   // in lengths of the distance
  std::vector<Ray> rays_;
};
template <class CameraType>
EquivalentFlatArea(const CameraType&, Index, Index) -> EquivalentFlatArea<CameraType>;
template <class CameraType>
EquivalentFlatArea(const CameraType&, Index, Index, const FlatAreaOptions&)
    -> EquivalentFlatArea<CameraType>;

}  // namespace v0
}  // namespace fingerpad
