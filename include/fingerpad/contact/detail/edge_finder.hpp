// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Turns the seeds that the threshold found into contact regions, for each edge policy.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/contact/contact_test.hpp"
#include "fingerpad/contact/detail/outside_level.hpp"
#include "fingerpad/contact/edge_level.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/curvature.hpp"
#include "fingerpad/image/detail/pixel_box.hpp"
#include "fingerpad/image/detail/regions.hpp"
#include "fingerpad/image/detail/sparse_mean.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Turns the regions of seeds for which keep(region) is true into contact and returns their number.
/// `statistic`, with the layout of the BorderedImage, is the result of `map`.
template <class Edge, class S>
class EdgeFinder;

template <class S>
class EdgeFinder<AtThreshold, S> {
 public:
  template <class CameraType>
  EdgeFinder(const AtThreshold&, const ContactTest&, const CameraType&, const BorderedImage&) {}
  struct Workspace {};
  Workspace workspace() const { return {}; }

  template <class Depth, class Keep>
  Index operator()(const Depth&,
                   const S*,
                   CurvatureMap<S>&,
                   const Keep& keep,
                   Regions& regions,
                   Workspace&) const {
    return regions.for_each(keep, [](const Regions::Region&) {});
  }
};

template <class S>
class EdgeFinder<HalfLevelEdge, S> {
 public:
  template <class CameraType>
  EdgeFinder(const HalfLevelEdge& edge,
             const ContactTest& test,
             const CameraType& camera,
             const BorderedImage& image)
      : image_(image),
        threshold_(S(test.threshold_per_mm)),
        gap_mm_(edge.touching_gap_mm),
        radius_px_(test.ring.radius_px),
        ring_px_(static_cast<Index>(std::ceil(radius_px_))),
        pitch_mm_(static_cast<double>(value(camera.pitch_mm))),
        growth_per_mm_(static_cast<double>(value(growth_per_mm(camera)))),
        cell_(static_cast<std::size_t>(image.size())) {
    const OutsideLevel<S> outside(image, ring_px_);
    for (Index i = 0; i < image.rows; ++i) {
      for (Index j = 0; j < image.cols; ++j) {
        cell_[static_cast<std::size_t>(image.at(i, j))] =
            static_cast<std::uint32_t>(outside.cell(i, j));
      }
    }
  }

  struct Workspace {
    OutsideLevel<S> outside;
    SparseMean<S> smoothing;
    std::vector<S> raw;    ///< mean curvature, in the layout of the BorderedImage
    std::vector<S> mean;   ///< the same, smoothed
    std::vector<S> inner;  ///< samples of a region, for a quantile
    std::vector<S> level;  ///< edge of the current region by cell of `outside`; NaN: not computed
  };
  Workspace workspace() const {
    const SparseMean<S> smoothing(image_.cols, spread_px());
    Workspace w{OutsideLevel<S>(image_, ring_px_), smoothing, {}, {}, {}, {}};
    w.raw.assign(static_cast<std::size_t>(image_.size()), not_a_number<S>());
    w.mean = w.raw;
    w.inner.resize(static_cast<std::size_t>(2 * max_samples));
    w.level.resize(static_cast<std::size_t>(w.outside.cells()));
    return w;
  }

  template <class Depth, class Keep>
  Index operator()(const Depth& depth_mm,
                   const S* statistic,
                   CurvatureMap<S>& map,
                   const Keep& keep,
                   Regions& regions,
                   Workspace& w) const {
    const auto marks = regions.marks();
    const PixelBox seeds = box_of_seeds(marks);
    if (seeds.first_row >= seeds.last_row) {
      return 0;
    }
    w.outside.measure(image_.view(statistic), marks, threshold_);
    // a region grows by at most the ring's radius; smoothing needs a few more columns
    const PixelBox reach = seeds.grown(ring_px_, image_.rows, image_.cols);
    PixelBox part = seeds.grown(ring_px_ + spread_px(), image_.rows, image_.cols);
    part.first_row = reach.first_row;
    part.last_row = reach.last_row;
    map.mean(part.first_row, part.last_row, part.first_col, part.last_col,
             image_.view(w.raw.data()));
    w.smoothing(part, image_.view(w.raw.data()), image_.view(w.mean.data()));
    return regions.for_each(keep,
                            [&](Regions::Region& region) { place(depth_mm, regions, region, w); });
  }

 private:
  template <class Marks>
  static PixelBox box_of_seeds(const Marks& marks) {
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

  /// Grows and trims the region to the pixels whose mean curvature is below the level of the edge.
  template <class Depth>
  void place(const Depth& depth_mm, Regions& regions, Regions::Region& region, Workspace& w) const {
    const S inside = inside_level(regions, region, w);
    const double pixel_mm = pixel_size_at(depth_mm, regions, region);
    const double area_mm2 = static_cast<double>(region.pixels()) * pixel_mm * pixel_mm;
    const S patch_mm = S(std::sqrt(area_mm2 / 3.14159265358979323846));
    const S ring_mm = S(radius_px_ * pixel_mm);
    const S spread_mm = S(static_cast<double>(spread_px()) * pixel_mm);
    const auto edge = [&](const S& outside) {
      return edge_level(inside, outside, S(gap_mm_), ring_mm, patch_mm, spread_mm);
    };
    std::fill(w.level.begin(), w.level.end(), not_a_number<S>());
    const auto within = [&](Index at) {
      const auto pixel = static_cast<std::size_t>(at);
      S& level = w.level[cell_[pixel]];
      if (!(level == level)) {
        const S outside = w.outside[cell_[pixel]];
        level = outside > inside ? edge(outside) : inside;
      }
      return w.mean[pixel] < level;
    };
    regions.grow(region, ring_px_, within);
    regions.trim(region, within);
  }

  /// Mean curvature of the object, at most 0: the lower quartile over the region, because a quarter
  /// of the pixels lie so far inside that their ring sees only the object. NaN if no pixel has a
  /// curvature, as can happen beside missing depth.
  S inside_level(const Regions& regions, const Regions::Region& region, Workspace& w) const {
    S* end = w.inner.data();
    for (Index k = region.begin; k < region.end; k += sparse(region)) {
      *end = w.mean[static_cast<std::size_t>(regions.pixel(k))];
      end += is_finite(*end) ? 1 : 0;
    }
    if (end == w.inner.data()) {
      return not_a_number<S>();
    }
    S* quarter = w.inner.data() + (end - w.inner.data()) / 4;
    std::nth_element(w.inner.data(), quarter, end);
    return *quarter < S(0) ? *quarter : S(0);
  }

  /// Distance in mm between the points that neighbouring pixels see, at the region's mean depth.
  template <class Depth>
  double pixel_size_at(const Depth& depth_mm,
                       const Regions& regions,
                       const Regions::Region& region) const {
    double sum = 0;
    double count = 0;
    for (Index k = region.begin; k < region.end; k += sparse(region)) {
      const Index pixel = regions.pixel(k) - image_.at(0, 0);
      sum += static_cast<double>(depth_mm(pixel / image_.stride(), pixel % image_.stride()));
      count += 1;
    }
    return pitch_mm_ * (1 + growth_per_mm_ * (sum / count));
  }

  /// Smoothing distance: a third of the ring, which smooths noise along the edge without moving the
  /// edge.
  Index spread_px() const { return (ring_px_ + 1) / 3; }

  /// Sampling step: a region's properties come from one to two thousand of its pixels, or from all
  /// if there are fewer.
  static Index sparse(const Regions::Region& region) { return region.pixels() / max_samples + 1; }
  static constexpr Index max_samples = 2000;

  BorderedImage image_;
  S threshold_;
  double gap_mm_;
  double radius_px_;
  Index ring_px_;  ///< radius_px_ rounded up to whole pixels
  double pitch_mm_;
  double growth_per_mm_;
  std::vector<std::uint32_t> cell_;  ///< cell of `outside` for each pixel of the BorderedImage
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
