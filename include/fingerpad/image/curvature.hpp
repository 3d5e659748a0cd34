// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Curvature of the membrane along sections of three depths, and its mean over all directions at
// each pixel of a depth map. It tells contact from free membrane: under pressure, a membrane bulges
// outward wherever nothing touches it. Depth grows away from the plate, and curvature is positive
// where the membrane bulges outward (a dome), as in the papers.
// Source: Ito et al. 2011, III.B (eqs. 1-12), and the slides, contact region; E012-E017.
//
// Both papers compute the center of the circle through three points. This is 0/0 on a level
// membrane, the very case that they look for. Menger's form of the same circle has no division that
// can fail. With a = l(0) - l(-r) and b = l(r) - l(0):
//
//   K = 2 r (a - b) / sqrt((r^2 + a^2) (r^2 + b^2) (4 r^2 + (a + b)^2))                     (K1)
//
// K is the curvature of the vertical section, not the normal curvature (E016): on a sphere of
// radius R at slope tan(alpha) it is 1/R along the gradient and 1/(R cos(alpha)) across it, and its
// mean over all directions is (2 / pi) K_ell(sin(alpha)) / R, where K_ell is the complete elliptic
// integral of the first kind. Its sign is that of the normal curvature.
//
// Through a camera, the distance between the points that neighbouring pixels see grows with the
// depth, pitch (1 + c l), and a tilted plane seems to be concave, by 2 c slope^2 / ((1 + c l) (1 +
// slope^2)^(3/2)) in a section along the slope. The substitution zeta = l / (1 + c l) removes both
// effects: it maps planes to planes for a camera at 1/c behind the plate, and on the axis
//   K = K of (K1) for radius r / (1 + c l) and depths zeta, over (1 + c l)^2.
// A flat section stays flat. Where K is not 0, its relative error is of the order of c times the
// slope times the distance from the axis. Refraction makes c smaller off the axis, which leaves
// less than 5e-4 per mm on a plane of slope 1/2 (tests/image/curvature.cpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/quick_math.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

namespace detail {

/// 1 / sqrt(x) for x > 0, rough for a vector.
template <class V>
[[gnu::always_inline]] inline V inverse_sqrt(const V& x) {
  if constexpr (scalar<V>) {
    using std::sqrt;
    return V(1) / sqrt(x);
  } else {
    return rough_inverse_sqrt<V>(x);
  }
}

/// (K1) over 2 r, for scalars and vectors.
template <class V>
[[gnu::always_inline]] inline V section(const V& radius_sq,
                                        const V& before,
                                        const V& center,
                                        const V& after) {
  const V a = center - before;
  const V b = after - center;
  const V rise = after - before;
  const V ends = (radius_sq + a * a) * (radius_sq + b * b);
  const V twice = radius_sq + radius_sq;
  return (a - b) * inverse_sqrt<V>(ends * (twice + twice + rise * rise));
}

/// One end of a section as an offset from the center pixel; the other end is its negative.
struct RingOffset {
  Index row;
  Index col;

  /// Squared distance in widths of a pixel, which is `aspect` widths high.
  constexpr double distance_sq(double aspect = 1) const {
    return static_cast<double>(col * col) + aspect * aspect * static_cast<double>(row * row);
  }
  friend constexpr bool operator==(const RingOffset&, const RingOffset&) = default;
};

/// One end of each section in the directions pi k / directions, sorted from shortest to longest.
/// For pixels `aspect` times as high as wide; the radius is in widths. The set is its own mirror
/// image and, for square pixels and an even number of directions, stays the same under exchange of
/// rows and columns: ties round toward the center, whatever the rounding of sine and cosine.
inline std::vector<RingOffset> ring_offsets(double radius_px, int directions, double aspect = 1) {
  const auto nearest = [](double px) { return static_cast<Index>(std::ceil(px - 0.5 - 1e-9)); };
  std::vector<RingOffset> offsets;
  for (int k = 0; k < directions; ++k) {
    const double angle = std::numbers::pi * k / directions, along = std::cos(angle);
    const Index col = nearest(radius_px * std::abs(along));
    offsets.push_back({nearest(radius_px * std::sin(angle) / aspect), along < 0 ? -col : col});
  }
  std::stable_sort(offsets.begin(), offsets.end(), [&](const RingOffset& a, const RingOffset& b) {
    return a.distance_sq(aspect) < b.distance_sq(aspect);
  });
  return offsets;
}

/// The sections of a ring. Those of equal length form a group and share its factors.
template <scalar S>
class RingSections {
 public:
  RingSections() = default;
  RingSections(const std::vector<RingOffset>& ring,
               Index stride,
               const S& pitch_mm,
               double aspect) {
    using std::sqrt;
    double last_sq = 0;
    for (const RingOffset& end : ring) {
      steps_.push_back(end.row * stride + end.col);
      const double distance_sq = end.distance_sq(aspect);
      if (distance_sq != last_sq) {
        last_sq = distance_sq;
        const S radius = sqrt(S(distance_sq)) * pitch_mm;
        groups_.push_back({S(2) * radius, radius * radius, 0});
      }
      ++groups_.back().sections;
    }
  }

  template <class V>
  struct Means {
    V clamped;  ///< negative curvatures count as 0
    V plain;    ///< only if asked for
  };

  /// Mean curvatures of the complete sections through the pixels from cells[0] on, in 1/mm; NaN
  /// where fewer than `least` are complete. `shrink` is 1 / (1 + c l), see curvature.hpp.
  template <bool Plain, class V>
  [[gnu::always_inline]] Means<V> means(const S* cells, const V& shrink, int least) const {
    const V center = load_cells<V, S>(cells), shrink_sq = shrink * shrink;
    const V none = every_lane<V>(S(0)), one = every_lane<V>(S(1));
    V clamped = none, plain = none, complete = none;
    const Index* step = steps_.data();
    for (const Group& group : groups_) {
      const V radius_sq = shrink_sq * group.radius_sq;
      V clamped_sum = none, plain_sum = none;
      for (int k = 0; k < group.sections; ++k, ++step) {
        const V term = section<V>(radius_sq, load_cells<V, S>(cells - *step), center,
                                  load_cells<V, S>(cells + *step));
        complete = complete + V(known<V>(term) ? one : none);
        clamped_sum = clamped_sum + V(none < term ? term : none);
        if constexpr (Plain) {
          plain_sum = plain_sum + V(known<V>(term) ? term : none);
        }
      }
      clamped = clamped + clamped_sum * group.twice_radius;
      plain = plain + plain_sum * group.twice_radius;
    }
    const V nan = every_lane<V>(not_a_number<S>());
    const V scale = complete < every_lane<V>(S(least)) ? nan : V(shrink_sq * shrink / complete);
    return {V(clamped * scale), V(plain * scale)};
  }

 private:
  struct Group {
    S twice_radius;
    S radius_sq;
    int sections;
  };

  std::vector<Index> steps_;
  std::vector<Group> groups_;
};

}  // namespace detail

/// Curvature in 1/mm of the section through depths at -radius, 0 and +radius; radius_mm > 0.
template <scalar S>
S section_curvature(const S& radius_mm, const S& before_mm, const S& center_mm, const S& after_mm) {
  const S radius_sq = radius_mm * radius_mm;
  return S(2) * radius_mm * detail::section<S>(radius_sq, before_mm, center_mm, after_mm);
}

/// Mean curvature of depth maps of one size, computed in the scalar S: by vectors in float, pixel
/// by pixel in any other.
///
/// It is measured on a ring of pixels: sections through the center pixel in evenly spaced
/// directions, each with one pixel at either end. An end is the pixel nearest to the circle, and
/// its true distance is used as the radius, because interpolation would bias the second difference
/// by up to curvature px^2 / 4 per sample. A pixel gets NaN if its depth is missing (not in (-100,
/// 100) mm, or next to the camera) or more than half of its sections are not complete, else the
/// mean of the complete ones. A missing depth affects no pixel beyond the ring's radius.
///
/// Rounding: in double about 1e-15 per mm. In float, by vectors, sections have a relative error of
/// 2.1e-5. An error of one unit in the last place e in a depth (through a camera, in zeta) changes
/// a curvature by up to 4 e / r^2.
///
/// One object a thread. Bounded time and no allocation per frame; O(rows cols directions).
template <scalar S = float>
class CurvatureMap {
 public:
  /// rows, cols in [1, 1e6], at most 1e8 pixels; the camera's pitch in [1e-4, 10] mm and its
  /// pixel_aspect in [0.1, 10], at most ring_px. Depths along the rays of a Camera, or heights of
  /// an OrthographicCamera. ring_px: radius of the ring in widths of a pixel, in [1, 1000];
  /// directions in [1, 360]. Their defaults are those of the slides; 25 px is 1.92 mm on the
  /// published pad. Refuses bad parameters (parameter_error).
  template <class CameraType = Camera<double>>
  CurvatureMap(
      const CameraType& camera, Index rows, Index cols, double ring_px = 25, int directions = 18)
      : growth_(growth_of(camera, rows, cols, ring_px, directions)),
        rows_(rows),
        cols_(cols),
        least_((directions + 1) / 2),
        clamped_(static_cast<std::size_t>(columns), S(0)),
        plain_(clamped_) {
    const double aspect = static_cast<double>(value(camera.pixel_aspect));
    const double size_px =
        (std::max)(static_cast<double>(cols), aspect * static_cast<double>(rows));
    const double reach_px = (std::min)(ring_px, size_px);  // larger rings are never complete
    row_margin_ = static_cast<Index>(std::ceil(reach_px / aspect));
    col_margin_ = static_cast<Index>(std::ceil(reach_px));
    stride_ = cols + 2 * col_margin_;
    sections_ = {detail::ring_offsets(reach_px, directions, aspect), stride_,
                 static_cast<S>(camera.pitch_mm), aspect};
    cells_.assign(static_cast<std::size_t>((rows + 2 * row_margin_) * stride_ + 2 * n),
                  not_a_number<S>());
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

  /// Writes the mean of the curvatures in 1/mm, negative ones counted as 0, to `clamped`, which may
  /// be the depth map itself, and returns the number of pixels that got NaN. By the slides, this
  /// mean is below p / (2 sigma) (pressure p, membrane tension sigma) only in contact; it is 0
  /// where the object is convex or flat. Takes a depth map in mm. No number, and nothing written,
  /// for other sizes.
  template <grid Depth, class Out>
  [[nodiscard]] std::optional<Index> operator()(const Depth& depth_mm, Out&& clamped) {
    std::nullptr_t no_plain = nullptr;
    return write_means(depth_mm, clamped, no_plain);
  }

  /// Also writes the plain mean, which locates the edge of contact.
  template <grid Depth, class Clamped, class Plain>
  [[nodiscard]] std::optional<Index> operator()(const Depth& depth_mm,
                                                Clamped&& clamped,
                                                Plain&& plain) {
    return write_means(depth_mm, clamped, plain);
  }

 private:
  static constexpr int n = detail::row_lanes<S>;
  using V = detail::lanes<S, n>;
  static constexpr Index columns = 128;  // of a strip, which fits the cache with its ring

  template <class CameraType>
  static S growth_of(
      const CameraType& camera, Index rows, Index cols, double ring_px, int directions) {
    require(camera);
    expects_grid_size("CurvatureMap", rows, cols);
    require("CurvatureMap",
            {{"ring_px", ring_px, within(1, 1000)},
             {"directions", directions, within(1, 360)},
             {"camera.pitch_mm", camera.pitch_mm, within(1e-4, 10)},
             {"camera.pixel_aspect", camera.pixel_aspect, within(0.1, (std::min)(10.0, ring_px))}});
    return static_cast<S>(growth_per_mm(camera));
  }

  template <class G>
  bool has_size(const G& g) const {
    return fingerpad::rows(g) == rows_ && fingerpad::cols(g) == cols_;
  }
  bool has_size(std::nullptr_t) const { return true; }

  S* cell(Index row, Index col) {
    return cells_.data() + (row + row_margin_) * stride_ + col_margin_ + col;
  }

  /// Stores zeta of a row; NaN where the depth is missing.
  template <class View>
  void load_row(const View& from, Index i) {
    S* row = cell(i, 0);
    const S* depth_mm = detail::row_of(from, i, row);
    const double growth = static_cast<double>(value(growth_));
    const auto highest = scalar_real_t<S>(100);
    const auto lowest = growth > 0.0099 ? scalar_real_t<S>(-0.99 / growth) : -highest;
    detail::for_each_cell<S>(cols_, [&]<class W>(Index j) {
      const W l = detail::load_cells<W, S>(depth_mm + j);
      const W zeta = l / (1 + growth_ * l);
      const W nan = detail::every_lane<W>(not_a_number<S>());
      if constexpr (scalar<W>) {
        row[j] = value(l) > lowest && value(l) < highest ? zeta : nan;
      } else {
        detail::store_cells<S>(row + j, W(((l > lowest) & (l < highest)) ? zeta : nan));
      }
    });
  }

  template <class Depth, class Clamped, class Plain>
  std::optional<Index> write_means(const Depth& depth_mm, Clamped& clamped, Plain& plain) {
    constexpr bool has_plain = !std::is_null_pointer_v<Plain>;
    static_assert(detail::takes_numbers<Clamped, S> &&
                      (detail::takes_numbers<Plain, S> || std::is_null_pointer_v<Plain>),
                  "this grid is written to: its cells must be assignable and able to hold NaN");
    if (!has_size(depth_mm) || !has_size(clamped) || !has_size(plain)) {
      return {};
    }
    const auto from = as_view(depth_mm);
    for (Index i = 0; i < rows_; ++i) {
      load_row(from, i);
    }
    Index known = 0;
    for (Index j = 0; j < cols_; j += columns) {
      const Index count = (std::min)(columns, cols_ - j);
      for (Index i = 0; i < rows_; ++i) {
        known += compute_segment<has_plain>(cell(i, j), count);
        store_segment(clamped_.data(), as_view(clamped), i, j, count);
        if constexpr (has_plain) {
          store_segment(plain_.data(), as_view(plain), i, j, count);
        }
      }
    }
    return rows_ * cols_ - known;
  }

  /// Computes `count` means from cells[0] on, rounded up to whole vectors, and returns how many of
  /// them are known. Beyond the image none is.
  template <bool Plain>
  [[gnu::noinline]] Index compute_segment(const S* cells, Index count) {
    const V none = detail::every_lane<V>(S(0)), one = detail::every_lane<V>(S(1));
    const V nan = detail::every_lane<V>(not_a_number<S>());
    V known = none;
    for (Index j = 0; j < count; j += n) {
      const V zeta = detail::load_cells<V, S>(cells + j);
      typename detail::RingSections<S>::template Means<V> mean = {nan, nan};
      if (detail::any_lane(detail::known<V>(zeta))) {
        mean = sections_.template means<Plain, V>(cells + j, V(1 - growth_ * zeta), least_);
      }
      known = known + V(detail::known<V>(mean.clamped) ? one : none);
      detail::store_cells<S>(clamped_.data() + j, mean.clamped);
      if constexpr (Plain) {
        detail::store_cells<S>(plain_.data() + j, mean.plain);
      }
    }
    std::array<S, static_cast<std::size_t>(n)> of_lane;
    detail::store_cells<S>(of_lane.data(), known);
    Index sum = 0;
    for (const S& count_of_lane : of_lane) {
      sum += static_cast<Index>(value(count_of_lane));
    }
    return sum;
  }

  template <class View>
  static void store_segment(
      const S* from, const View& to, Index row, Index first_col, Index count) {
    if constexpr (detail::plain_rows<View, S>) {
      if (to.col_stride() == 1) {
        std::copy_n(from, count, to.row(row) + first_col);
        return;
      }
    }
    for (Index j = 0; j < count; ++j) {
      to(row, first_col + j) = static_cast<cell_t<View>>(from[j]);
    }
  }

  S growth_;  // c
  Index rows_;
  Index cols_;
  int least_;  // number of sections that must be complete
  Index row_margin_ = 0, col_margin_ = 0, stride_ = 0;
  detail::RingSections<S> sections_;
  std::vector<S> cells_;            // zeta, with a margin of NaN on every side
  std::vector<S> clamped_, plain_;  // of a segment
};

}  // namespace v1
}  // namespace fingerpad
