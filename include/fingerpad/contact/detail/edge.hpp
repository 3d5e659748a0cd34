// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The edge of a contact: where the mean curvature that a ring measures changes from that of the
// object to that of the free membrane.
//
// A membrane without stiffness leaves an object tangentially: at the edge its slope is that of the
// object, and its mean curvature jumps from the object's (inside) to the free membrane's (outside).
// All of the jump is in the section across the edge. At the distance s from a straight edge the gap
// between membrane and object is
//   gap(s) = (outside - inside) s^2
// A ring of radius r, centered at s >= 0 outside a straight edge, measures as the mean over all its
// sections
//   inside + q (outside - inside),  q = 1 + (2/pi) [(3/2) sigma sin(phi) - phi (1/2 + sigma^2)]
// with sigma = s / r, cos(phi) = sigma. q is 1/2 on the edge and 1 from sigma = 1 on. The edge of a
// round patch of radius R curves away from the ring, which adds 2 r / (9 pi R) to q, to first
// order.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/curvature.hpp"
#include "fingerpad/image/detail/pixel_box.hpp"
#include "fingerpad/image/detail/regions.hpp"
#include "fingerpad/image/detail/sparse_mean.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// q: the share of the jump that a ring measures if its center lies `offset` ring radii outside a
/// straight edge. For a center inside, q(-offset) = 1 - q(offset).
template <scalar S>
S edge_share(const S& offset) {
  using std::acos;
  using std::sqrt;
  if (value(offset) < 0) {
    return S(1) - edge_share(S(-offset));
  }
  if (!(value(offset) < 1)) {
    return S(1);
  }
  const S sine = sqrt(S(1) - offset * offset);
  const S angle = acos(offset);
  const S bracket = S(3) / S(2) * offset * sine - angle * (S(1) / S(2) + offset * offset);
  return S(1) + bracket * S(0.63661977236758134308);
}

/// The mean curvature in 1/mm at which the contact region ends. Membrane nearer than `gap_mm` to
/// the object then counts as contact. Needs outside > inside; radii of ring and patch in mm, > 0.
/// `spread_mm` is the distance between the pixels that SparseMean averages; 0: no averaging.
template <scalar S>
S edge_level(const S& inside_per_mm,
             const S& outside_per_mm,
             const S& gap_mm,
             const S& ring_mm,
             const S& patch_mm,
             const S& spread_mm = S(0)) {
  using std::sqrt;
  const S jump = outside_per_mm - inside_per_mm;
  const S ratio = gap_mm / jump;
  const S offset = value(ratio) > 0 ? sqrt(ratio) : S(0);
  const S here = edge_share(S(offset / ring_mm));
  const S inward = edge_share(S((offset - spread_mm) / ring_mm));
  const S outward = edge_share(S((offset + spread_mm) / ring_mm));
  const S share = (here + inward + outward) / S(3);
  const S round = share + S(0.070735530263064590) * ring_mm / patch_mm;
  return inside_per_mm + (value(round) < 1 ? round : S(1)) * jump;
}

/// Moves regions of seeds to the edge of their contacts. Curvatures have the layout of a
/// BorderedImage.
template <scalar S>
class EdgePlacer {
 public:
  /// `pitch_mm` and `growth_per_mm` give the width of a pixel at a depth; `aspect` is its height
  /// over its width.
  EdgePlacer(const BorderedImage& image,
             const CurvatureRing& ring,
             double gap_mm,
             double pitch_mm,
             double growth_per_mm,
             double aspect)
      : image_(image),
        gap_mm_(gap_mm),
        radius_px_(ring.radius_px),
        pitch_mm_(pitch_mm),
        growth_per_mm_(growth_per_mm),
        aspect_(aspect),
        ring_cols_(static_cast<Index>(std::ceil(ring.radius_px))),
        ring_rows_(static_cast<Index>(std::ceil(ring.radius_px / aspect))),
        // a third of the ring smooths noise along the edge without moving the edge
        spread_px_((ring_cols_ + 1) / 3),
        smoothing_(image.cols, spread_px_, (ring_rows_ + 1) / 3),
        raw_(static_cast<std::size_t>(image.size()), not_a_number<S>()),
        mean_(raw_),
        samples_(static_cast<std::size_t>(
            (std::max)(2 * most, ((image.rows + 3) / 4) * ((image.cols + 3) / 4)))) {}

  /// Before the regions of a frame: their mean curvatures, and the level of the free membrane, the
  /// median of the curvature `statistic` over the free pixels (every fourth row and column) within
  /// three rings around all contacts. `otherwise` is that level if no pixel is free.
  void prepare(CurvatureMap<S>& map, const S* statistic, Regions& regions, const S& otherwise) {
    const auto marks = regions.marks();
    const PixelBox seeds = box_of_seeds(marks);
    if (seeds.first_row >= seeds.last_row) {
      return;
    }
    const auto free = image_.view(statistic);
    const PixelBox near = grown(seeds, 3 * ring_rows_, 3 * ring_cols_);
    std::size_t count = 0;
    for (Index i = near.first_row; i < near.last_row; i += 4) {
      for (Index j = near.first_col; j < near.last_col; j += 4) {
        samples_[count] = free(i, j);
        count += marks(i, j) == Mark::free ? 1U : 0U;
      }
    }
    outside_ = count > 0 ? quantile(count, count / 2) : otherwise;
    // a region grows by at most the ring's radius; smoothing needs a few more columns
    const PixelBox part = grown(seeds, ring_rows_, ring_cols_ + spread_px_);
    map.mean(part.first_row, part.last_row, part.first_col, part.last_col,
             image_.view(raw_.data()));
    smoothing_(part, image_.view(raw_.data()), image_.view(mean_.data()));
  }

  /// Grows and trims a region to the pixels whose mean curvature is below the level of its edge.
  template <class Depth>
  void place(const Depth& depth_mm, Regions& regions, Regions::Region& region) {
    const S inside = inside_level(regions, region);
    const double pixel_mm = pixel_width_at(depth_mm, regions, region);
    const double area_mm2 = static_cast<double>(region.pixels()) * pixel_mm * pixel_mm * aspect_;
    const S patch_mm = S(std::sqrt(area_mm2 / std::numbers::pi));
    const S ring_mm = S(radius_px_ * pixel_mm);
    const S spread_mm = S(static_cast<double>(spread_px_) * pixel_mm);
    const S level = outside_ > inside
                        ? edge_level(inside, outside_, S(gap_mm_), ring_mm, patch_mm, spread_mm)
                        : inside;
    const auto within = [&](Index at) { return mean_[static_cast<std::size_t>(at)] < level; };
    regions.grow(region, (std::max)(ring_rows_, ring_cols_), within);
    regions.trim(region, within);
  }

 private:
  static constexpr Index most = 2000;  // samples of a region

  /// A region's properties come from one to two thousand of its pixels, or from all if there are
  /// fewer.
  static Index step(const Regions::Region& region) { return region.pixels() / most + 1; }

  /// The k-th smallest of the first `count` samples.
  const S& quantile(std::size_t count, std::size_t k) {
    const auto first = samples_.begin();
    std::nth_element(first, first + static_cast<std::ptrdiff_t>(k),
                     first + static_cast<std::ptrdiff_t>(count));
    return samples_[k];
  }

  PixelBox grown(const PixelBox& box, Index by_rows, Index by_cols) const {
    return {(std::max)(box.first_row - by_rows, Index(0)),
            (std::min)(box.last_row + by_rows, image_.rows),
            (std::max)(box.first_col - by_cols, Index(0)),
            (std::min)(box.last_col + by_cols, image_.cols)};
  }

  static PixelBox box_of_seeds(const StridedView<Mark>& marks) {
    PixelBox box{marks.rows(), 0, marks.cols(), 0};
    for (Index i = 0; i < marks.rows(); ++i) {
      const Mark* row = marks.row(i);
      const Mark* end = row + marks.cols();
      const Mark* first = find_mark(row, end, Mark::seed);
      if (first == end) {
        continue;
      }
      while (end[-1] != Mark::seed) {
        --end;
      }
      box.first_row = (std::min)(box.first_row, i);
      box.last_row = i + 1;
      box.first_col = (std::min)(box.first_col, static_cast<Index>(first - row));
      box.last_col = (std::max)(box.last_col, static_cast<Index>(end - row));
    }
    return box;
  }

  /// Mean curvature of the object, at most 0: the lower quartile over the region, because a quarter
  /// of the pixels lie so far inside that their ring sees only the object. NaN if no pixel has a
  /// curvature, as can happen beside missing depth.
  S inside_level(const Regions& regions, const Regions::Region& region) {
    std::size_t count = 0;
    for (Index k = region.begin; k < region.end; k += step(region)) {
      samples_[count] = mean_[static_cast<std::size_t>(regions.pixel(k))];
      count += is_finite(samples_[count]) ? 1U : 0U;
    }
    return count == 0 ? not_a_number<S>() : (std::min)(quantile(count, count / 4), S(0));
  }

  /// Distance in mm between the points that pixels side by side see, at the region's mean depth.
  template <class Depth>
  double pixel_width_at(const Depth& depth_mm,
                        const Regions& regions,
                        const Regions::Region& region) const {
    double sum = 0;
    double count = 0;
    for (Index k = region.begin; k < region.end; k += step(region)) {
      const Index pixel = regions.pixel(k) - image_.at(0, 0);
      sum += static_cast<double>(depth_mm(pixel / image_.stride(), pixel % image_.stride()));
      count += 1;
    }
    return pitch_mm_ * (1 + growth_per_mm_ * (sum / count));
  }

  BorderedImage image_;
  double gap_mm_;
  double radius_px_;
  double pitch_mm_;
  double growth_per_mm_;
  double aspect_;
  Index ring_cols_, ring_rows_;  // the ring's radius in whole pixels
  Index spread_px_;
  SparseMean<S> smoothing_;
  std::vector<S> raw_;   // mean curvature
  std::vector<S> mean_;  // the same, smoothed
  std::vector<S> samples_;
  S outside_ = S(0);
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
