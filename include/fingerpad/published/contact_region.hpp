// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The contact region, word for word as in paper and slides: Ito, Kim, Nagai, Obinata, "Acquisition
// of tactile information by vision-based tactile sensor for dexterous handling of robot hands".
// Plain loops over every fifth pixel fit circles through three points of the membrane in many
// sections (E012 repaired). There are three tests: eq. 12; the slides' mean curvature with negative
// ones set to 0; and the slides' first test, every direction below delta_R. A level section has no
// circle: its curvature is NaN and passes no test (E013). Heights are orthographic, as printed. The
// mask is not cleaned. With noise the printed threshold misses half of a flat contact: E018. The
// slides' thresholds, from the free pad, are those of `threshold_by_slides`.
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace published {

/// Curvature of a section from the center of the circle through three points, as published: eqs. 10
/// and 11 in the plane of the section, repaired by E012-E014. NaN on a level section, and few
/// correct digits on a nearly flat one.
template <scalar S>
S circle_center_curvature(const S& radius_mm,
                          const S& before_mm,
                          const S& center_mm,
                          const S& after_mm) {
  using std::sqrt;
  const S z =
      (S(2) * square(radius_mm) + square(before_mm) + square(after_mm) - S(2) * square(center_mm)) /
      (S(2) * (before_mm + after_mm - S(2) * center_mm));
  const S u = (square(radius_mm) + square(after_mm) - square(center_mm) -
               S(2) * (after_mm - center_mm) * z) /
              (S(2) * radius_mm);
  const S curvature = S(1) / sqrt(square(u) + square(center_mm - z));
  return value(center_mm) < value(z) ? -curvature : curvature;
}

struct SlidesContactOptions {
  /// f of the slides: the mean over n directions, negative curvatures set to 0. Else eq. 12: the
  /// sum over 2n directions, divided by n.
  bool clamps = false;
  bool every_direction = false;       ///< the slides' first test: 1/R' < delta_R in each of n
                                      ///< directions; `clamps` applies to each
  double threshold_per_mm = 0.00015;  ///< delta, delta_f or delta_R, finite
  int directions = 18;                ///< n, in [1, 360]
  double radius_px = 10;              ///< r, in [1, 1000]; 25 px in the slides
  double pitch_mm = 0.08;             ///< size of a pixel on the membrane, in (0, 10]
  int step_px = 5;                    ///< "changing the center point P by 5 pixel", in [1, 1000]
};

/// The first parameter without meaning, or "".
inline std::string check(const SlidesContactOptions& o) {
  return fingerpad::check("SlidesContactOptions",
                          {{"threshold_per_mm", o.threshold_per_mm, finite_number},
                           {"directions", o.directions, within(1, 360)},
                           {"radius_px", o.radius_px, within(1, 1000)},
                           {"pitch_mm", o.pitch_mm, {.min = 0, .max = 10, .above_min = true}},
                           {"step_px", o.step_px, within(1, 1000)}});
}

/// 1/R' of the section at the angle theta through (row, col). The circle passes through the pixel
/// itself and the pixels nearest to the distance r before and after it. NaN if a pixel lies outside
/// the map, and on a level section.
template <scalar S, grid Depth>
S section_curvature(const Depth& depth_mm,
                    Index row,
                    Index col,
                    double theta_rad,
                    double radius_px,
                    double pitch_mm) {
  const auto offset = [&](double direction) {
    return static_cast<Index>(std::lround(radius_px * direction));
  };
  const Index down = offset(std::sin(theta_rad)), right = offset(std::cos(theta_rad));
  const auto at = [&](Index i, Index j) {
    const bool inside = i >= 0 && j >= 0 && i < rows(depth_mm) && j < cols(depth_mm);
    return inside ? S(grid_traits<Depth>::at(depth_mm, i, j)) : not_a_number<S>();
  };
  const S reach = S(pitch_mm * std::hypot(static_cast<double>(down), static_cast<double>(right)));
  return circle_center_curvature(reach, at(row - down, col - right), at(row, col),
                                 at(row + down, col + right));
}

/// Calls visit(x) with each curvature that the test holds against its threshold at (row, col):
/// those of all sections with every_direction, else their mean alone.
template <scalar S, grid Depth, class Visit>
void for_each_compared(const Depth& depth_mm,
                       Index row,
                       Index col,
                       const SlidesContactOptions& o,
                       const Visit& visit) {
  const int count = o.clamps || o.every_direction ? o.directions : 2 * o.directions;
  S sum = S(0);
  for (int i = 1; i <= count; ++i) {
    S k = section_curvature<S>(depth_mm, row, col, std::numbers::pi * i / count, o.radius_px,
                               o.pitch_mm);
    k = o.clamps && k < S(0) ? S(0) : k;
    sum += k;
    if (o.every_direction) {
      visit(k);
    }
  }
  if (!o.every_direction) {
    visit(sum / S(o.directions));
  }
}

/// Whether the membrane is in contact at (row, col).
template <scalar S = double, grid Depth>
bool touches(const Depth& depth_mm, Index row, Index col, const SlidesContactOptions& o) {
  bool all_below = true;
  for_each_compared<S>(depth_mm, row, col, o, [&](const S& k) {
    all_below = all_below && k < S(o.threshold_per_mm);  // false for NaN
  });
  return all_below;
}

/// The contact mask of a height map. Every pixel gets the answer at the center of its block of
/// step_px x step_px. Returns the contact area in mm^2. If the mask has another size it returns NaN
/// and writes nothing. Refuses bad parameters (parameter_error). O(pixels directions / step_px^2).
template <scalar S = double, grid Depth, class Mask>
double contact_by_slides(const Depth& depth_mm, Mask&& mask, const SlidesContactOptions& o = {}) {
  static_assert(writable_grid<Mask, bool>, "this grid is written to: its cells must be assignable");
  require(o);
  const auto to = as_view(std::forward<Mask>(mask));
  if (!same_size(depth_mm, to)) {
    return not_a_number<double>();
  }
  double touching_px = 0;
  for (Index top = 0; top < to.rows(); top += o.step_px) {
    for (Index left = 0; left < to.cols(); left += o.step_px) {
      const bool set = touches<S>(depth_mm, top + o.step_px / 2, left + o.step_px / 2, o);
      for (Index i = top; i < top + o.step_px && i < to.rows(); ++i) {
        for (Index j = left; j < left + o.step_px && j < to.cols(); ++j) {
          to(i, j) = static_cast<cell_t<Mask>>(set);
          touching_px += set ? 1 : 0;
        }
      }
    }
  }
  return touching_px * o.pitch_mm * o.pitch_mm;
}

/// The slides' threshold of a test, 1/mm, from frames of the free pad: min(E - 2 sigma) over all
/// centers, with the mean E and the standard deviation sigma over the frames of the mean curvature
/// (delta_f), or with every_direction over all centers and sections, of each section (delta_R).
/// `depths_mm` is a container of at least 2 height maps of one size. What is NaN in one frame does
/// not count; infinity if nothing does. Refuses bad parameters (parameter_error). O(frames pixels
/// directions / step_px^2).
template <scalar S = double, class Frames>
double threshold_by_slides(const Frames& depths_mm, const SlidesContactOptions& o) {
  require(o);
  const auto first = as_view(*std::begin(depths_mm));
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> mean, squares;  // of what is compared
  for (Index row = o.step_px / 2; row < first.rows(); row += o.step_px) {
    for (Index col = o.step_px / 2; col < first.cols(); col += o.step_px) {
      mean.assign(static_cast<std::size_t>(o.directions), 0);
      squares = mean;
      double n = 0;
      std::size_t compared = 0;
      for (const auto& depth_mm : depths_mm) {
        n += 1;
        compared = 0;
        for_each_compared<S>(depth_mm, row, col, o, [&](const S& k) {
          const double x = static_cast<double>(value(k)), off = x - mean[compared];
          mean[compared] += off / n;
          squares[compared] += off * (x - mean[compared]);
          ++compared;
        });
      }
      for (std::size_t k = 0; k < compared; ++k) {
        const double low = mean[k] - 2 * std::sqrt(squares[k] / (n - 1));
        least = low < least ? low : least;  // false for NaN
      }
    }
  }
  return least;
}

}  // namespace published
}  // namespace v1
}  // namespace fingerpad
