// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A quadratic surface through the center pixel and, by least squares, the ring. The sum of a
// section's ends less twice the center is o^T H o, their difference 2 g^T o: second derivatives and
// gradient separate. In the basis 1, cos(2 theta), sin(2 theta) the normal equations of a whole
// ring are nearly diagonal, and those of half a ring still well conditioned.
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fingerpad/image/detail/curvature_rows.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// Curvature linear in depth: what each section lacks of its center, over the radius squared.

template <int Directions, class S>
class CurvatureKernel<RingStencil<Directions>, S> {
 public:
  static constexpr int directions = Directions;

  CurvatureKernel(const std::vector<RingOffset>& ring,
                  Index stride,
                  const S& pitch,
                  const S& per_mm) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const S radius_sq = S(static_cast<double>(ring[k].radius_sq())) * pitch * pitch;
      section_[k] = {ring[k].row * stride + ring[k].col, S(per_mm / radius_sq)};
    }
  }

  template <class V>
  [[gnu::always_inline]] V complete(const S* cells, const V&) const {
    const V center = load_cells<V, S>(cells);
    V total{};
    for (const Weighted& at : section_) {
      total = total + at.weight * bend_at<V>(cells, center, at.step);
    }
    return total * (S(1) / S(Directions));
  }

  template <class V>
  [[gnu::always_inline]] PartialCurvature<V> partial(const S* cells, const V&, int least) const {
    const V center = load_cells<V, S>(cells);
    V total{};
    V count{};
    for (const Weighted& at : section_) {
      const V bend = bend_at<V>(cells, center, at.step);
      const auto complete = known<V>(bend);
      total = total + at.weight * (complete ? bend : V{});
      count = count + (complete ? whole<V>(1) : V{});
    }
    const V mean = total / count;
    const V nan = V{} + not_a_number<S>();
    return {at_least<V>(count, least) ? mean : nan, count};
  }

 private:
  struct Weighted {
    Index step;
    S weight;
  };

  template <class V>
  [[gnu::always_inline]] static V bend_at(const S* cells, const V& center, Index step) {
    const V before = load_cells<V, S>(cells - step);
    const V after = load_cells<V, S>(cells + step);
    return (center - before) - (after - center);
  }

  std::array<Weighted, static_cast<std::size_t>(Directions)> section_;
};

/// Symmetric 3 x 3 equations for the bend: round, and along 0 and 45 degrees.
template <class V>
struct BendEquations {
  V rr{}, rc{}, rs{}, cc{}, cs{}, ss{};
  V round{}, straight{}, oblique{};  ///< right-hand sides

  struct Solution {
    V round, straight, oblique;
    V share;  ///< determinant over its largest value: how well the directions are spread
  };

  [[gnu::always_inline]] Solution solution() const {
    const V a = cc * ss - cs * cs;
    const V b = cs * rs - rc * ss;
    const V c = rc * cs - cc * rs;
    const V determinant = rr * a + rc * b + rs * c;
    const V d = rr * ss - rs * rs;
    const V e = rc * rs - rr * cs;
    const V f = rr * cc - rc * rc;
    const V inverse = 1 / determinant;
    return {V((a * round + b * straight + c * oblique) * inverse),
            V((b * round + d * straight + e * oblique) * inverse),
            V((c * round + e * straight + f * oblique) * inverse), V(determinant / (rr * rr * rr))};
  }
};

/// Symmetric 2 x 2 equations for the slope.
template <class V>
struct SlopeEquations {
  V xx{}, xy{}, yy{};
  V x{}, y{};
};

template <class S>
struct FittedSection {
  Index step;
  S x, y;                      ///< the offset, in radii of the ring
  S round, straight, oblique;  ///< x^2 + y^2, x^2 - y^2, 2 x y
  S round_weight, straight_weight, oblique_weight, x_weight, y_weight;  ///< of the whole ring
};

template <class S, int Directions, FittedValue Value>
class FittedKernel {
 public:
  static constexpr int directions = Directions;

  FittedKernel(const std::vector<RingOffset>& ring, Index stride, const S& pitch, const S& per_mm) {
    using std::sqrt;
    const S radius_sq = S(static_cast<double>(ring.back().radius_sq()));
    const S radius = sqrt(radius_sq);
    const S per_radius = S(1) / radius;
    slope_scale_ = per_radius / pitch;
    bend_scale_ = slope_scale_ * slope_scale_ * per_mm;
    const std::vector<RingOffset> ends = in_pairs(ring);
    BendEquations<S> bend;
    SlopeEquations<S> slope;
    for (std::size_t k = 0; k < ends.size(); ++k) {
      FittedSection<S>& at = section_[k];
      at.step = ends[k].row * stride + ends[k].col;
      at.x = S(static_cast<double>(ends[k].col)) * per_radius;
      at.y = S(static_cast<double>(ends[k].row)) * per_radius;
      at.round = at.x * at.x + at.y * at.y;
      at.straight = at.x * at.x - at.y * at.y;
      at.oblique = S(2) * at.x * at.y;
      add<S>(at, S(1), bend, slope);
    }
    for (FittedSection<S>& at : section_) {
      bend.round = at.round;
      bend.straight = at.straight;
      bend.oblique = at.oblique;
      const auto weights = bend.solution();
      at.round_weight = weights.round;
      at.straight_weight = weights.straight;
      at.oblique_weight = weights.oblique;
      at.x_weight = at.x / (S(2) * slope.xx);  // a ring is its own mirror image: xy is 0
      at.y_weight = at.y / (S(2) * slope.yy);
    }
  }

  template <class V>
  [[gnu::always_inline]] V complete(const S* cells, const V& shrink) const {
    const V center = load_cells<V, S>(cells);
    V round{}, straight{}, oblique{}, x{}, y{};
    const FittedSection<S>* at = section_.data();
    for (; at != section_.data() + paired_; at += 2) {
      const Ends<V> one = ends_at<V>(cells, center, at[0].step);
      const Ends<V> mirrored = ends_at<V>(cells, center, at[1].step);
      const V both = one.bend + mirrored.bend;
      round = round + at->round_weight * both;
      straight = straight + at->straight_weight * both;
      oblique = oblique + at->oblique_weight * (one.bend - mirrored.bend);
      x = x + at->x_weight * (one.rise - mirrored.rise);
      y = y + at->y_weight * (one.rise + mirrored.rise);
    }
    for (; at != section_.data() + section_.size(); ++at) {
      const Ends<V> one = ends_at<V>(cells, center, at->step);
      round = round + at->round_weight * one.bend;
      straight = straight + at->straight_weight * one.bend;
      oblique = oblique + at->oblique_weight * one.bend;
      x = x + at->x_weight * one.rise;
      y = y + at->y_weight * one.rise;
    }
    return curvature<V>({x, y, V(round + straight), oblique, V(round - straight)}, shrink);
  }

  template <class V>
  [[gnu::always_inline]] PartialCurvature<V> partial(const S* cells,
                                                     const V& shrink,
                                                     int least) const {
    const V center = load_cells<V, S>(cells);
    BendEquations<V> bend;
    SlopeEquations<V> slope;
    V count{};
    for (const FittedSection<S>& at : section_) {
      const Ends<V> ends = ends_at<V>(cells, center, at.step);
      const auto complete = known<V>(ends.bend);
      const V here = complete ? whole<V>(1) : V{};
      const V sum = complete ? ends.bend : V{};
      const V rise = complete ? ends.rise : V{};
      add<V>(at, here, bend, slope);
      bend.round = bend.round + at.round * sum;
      bend.straight = bend.straight + at.straight * sum;
      bend.oblique = bend.oblique + at.oblique * sum;
      slope.x = slope.x + at.x * rise;
      slope.y = slope.y + at.y * rise;
      count = count + here;
    }
    const auto fit = bend.solution();
    const V half_inverse = S(1) / (2 * (slope.xx * slope.yy - slope.xy * slope.xy));
    const V x = (slope.yy * slope.x - slope.xy * slope.y) * half_inverse;
    const V y = (slope.xx * slope.y - slope.xy * slope.x) * half_inverse;
    const V k = curvature<V>(
        {x, y, V(fit.round + fit.straight), fit.oblique, V(fit.round - fit.straight)}, shrink);
    const V nan = V{} + not_a_number<S>();
    const V spread = fit.share > V{} + S(1e-4) ? k : nan;
    return {at_least<V>(count, least) ? spread : nan, count};
  }

 private:
  /// Sections next to their mirror image in the vertical, then those that have none.
  std::vector<RingOffset> in_pairs(std::vector<RingOffset> rest) {
    std::vector<RingOffset> pairs, alone;
    while (!rest.empty()) {
      const RingOffset one = rest.back();
      rest.pop_back();
      const auto mirrored = std::find(rest.begin(), rest.end(), RingOffset{one.row, -one.col});
      if (mirrored == rest.end()) {
        alone.push_back(one);
      } else {
        pairs.push_back(one);
        pairs.push_back(*mirrored);
        rest.erase(mirrored);
      }
    }
    paired_ = static_cast<std::ptrdiff_t>(pairs.size());
    pairs.insert(pairs.end(), alone.begin(), alone.end());
    return pairs;
  }

  template <class V>
  struct Ends {
    V bend;  ///< sum of both less twice the center
    V rise;
  };

  template <class V>
  [[gnu::always_inline]] static Ends<V> ends_at(const S* cells, const V& center, Index step) {
    const V before = load_cells<V, S>(cells - step);
    const V after = load_cells<V, S>(cells + step);
    return {V((after - center) - (center - before)), V(after - before)};
  }

  template <class V>
  [[gnu::always_inline]] static void add(const FittedSection<S>& at,
                                         const V& here,
                                         BendEquations<V>& bend,
                                         SlopeEquations<V>& slope) {
    const V round = here * at.round;
    const V straight = here * at.straight;
    const V oblique = here * at.oblique;
    bend.rr = bend.rr + round * at.round;
    bend.rc = bend.rc + round * at.straight;
    bend.rs = bend.rs + round * at.oblique;
    bend.cc = bend.cc + straight * at.straight;
    bend.cs = bend.cs + straight * at.oblique;
    bend.ss = bend.ss + oblique * at.oblique;
    const V x = here * at.x;
    const V y = here * at.y;
    slope.xx = slope.xx + x * at.x;
    slope.xy = slope.xy + x * at.y;
    slope.yy = slope.yy + y * at.y;
  }

  template <class V>
  [[gnu::always_inline]] V curvature(const SurfacePatch<V>& fit, const V& shrink) const {
    const V slope_scale = slope_scale_ / shrink;
    const NormalCurvature<V> k = normal_curvature<V>(
        {V(fit.slope_x * slope_scale), V(fit.slope_y * slope_scale),
         V(fit.bend_xx_per_mm * bend_scale_), V(fit.bend_xy_per_mm * bend_scale_),
         V(fit.bend_yy_per_mm * bend_scale_)});
    if constexpr (Value == FittedValue::mean) {
      return k.mean;
    } else if constexpr (Value == FittedValue::larger) {
      return k.mean + k.half_range;
    } else if constexpr (Value == FittedValue::smaller) {
      return k.mean - k.half_range;
    } else {
      return clamped_mean<V>(k);
    }
  }

  std::array<FittedSection<S>, static_cast<std::size_t>(Directions)> section_;
  std::ptrdiff_t paired_ = 0;
  S slope_scale_;  ///< per unit of length
  S bend_scale_;   ///< per unit of length, and from there per mm
};

template <int D, FittedValue Value, class S>
class CurvatureKernel<HessianFit<D, Value>, S> : public FittedKernel<S, D, Value> {
  using FittedKernel<S, D, Value>::FittedKernel;
};
template <int D, FittedValue Value>
inline constexpr int fewest_sections<HessianFit<D, Value>> = 3;
template <int D>
inline constexpr int curvature_vector_bytes<ClampedHessian<D>, double> = 0;

}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
