// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What the contact test is made of, beside the curvature statistic: the threshold, where the edge
// is put, and how specks are cleaned away. Policies; what is not asked for costs nothing.
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/curvature_options.hpp"
#include "fingerpad/image/detail/regions.hpp"

namespace fingerpad {
inline namespace v0 {

/// The test for contact: a curvature statistic below the threshold.
struct ContactTest {
  /// delta. Half the curvature of the free pad is a good one: 1/40 per mm for the published pad of
  /// 20 mm radius; calibrate/contact_region.hpp takes it from frames. Finite, > 0.
  double threshold_per_mm = 0.025;
  double free_apex_mm = 13;  ///< height of the free pad, from which contact depth counts; finite
  CurvatureRing ring = {};
};

/// Paper 002: delta = 0.00015 per mm on a ring of 10 px, with PublishedTwiceMean<36>. Two orders
/// below its own rule for delta (E018): in noise, half of a flat contact is missed.
constexpr ContactTest published_contact_test() {
  return {0.00015, 13, published_ring()};
}

inline void expects_valid(const ContactTest& test) {
  expects(is_finite(test.threshold_per_mm) && test.threshold_per_mm > 0, "ContactTest",
          "threshold_per_mm", test.threshold_per_mm, "finite and > 0");
  expects(is_finite(test.free_apex_mm), "ContactTest", "free_apex_mm", test.free_apex_mm, "finite");
  expects_valid(test.ring);
}

/// Contact is where the statistic is below the threshold, as published. A ring that reaches beyond
/// the edge sees the free membrane: with a threshold near 0 the region is about a ring's radius too
/// small all around.
struct AtThreshold {};

/// The same, widened again by a share of the ring's radius. Right for a threshold near 0 and an
/// edge that is far from any other; it rounds corners and closes gaps.
struct WidenedByRing {
  double share = 0.9;  ///< in [0, 1]
};

/// The threshold finds the contact; its edge is put where the mean curvature passes from that of
/// the object to that of the free membrane, see edge_level.hpp. Costs a second curvature map of the
/// rows around the contact.
struct HalfLevelEdge {
  /// What is nearer than this to the object counts as touched; it moves the edge outward by
  /// sqrt(gap / jump of the mean curvature), about 0.5 mm at the default, which is what a depth map
  /// from 8-bit frames cannot tell from contact. In [0, 1].
  double touching_gap_mm = 0.02;
};

inline void expects_valid(const AtThreshold&) {}
inline void expects_valid(const WidenedByRing& edge) {
  expects(edge.share >= 0 && edge.share <= 1, "WidenedByRing", "share", edge.share, "in [0, 1]");
}
inline void expects_valid(const HalfLevelEdge& edge) {
  expects(edge.touching_gap_mm >= 0 && edge.touching_gap_mm <= 1, "HalfLevelEdge",
          "touching_gap_mm", edge.touching_gap_mm, "in [0, 1]");
}

struct NoCleaning {};

/// Regions of fewer pixels are dropped: noise makes specks of about half a ring's radius.
struct WithoutSpecks {
  Index min_px = 200;  ///< >= 1
};

/// Only the largest region is kept.
struct LargestRegion {};

/// Regions below the threshold grow into neighbours below a second, looser one.
struct Hysteresis {
  double loose_per_mm = 0.035;  ///< finite, >= threshold_per_mm
};

inline void expects_valid(const NoCleaning&, const ContactTest&) {}
inline void expects_valid(const LargestRegion&, const ContactTest&) {}
inline void expects_valid(const WithoutSpecks& cleaning, const ContactTest&) {
  expects(cleaning.min_px >= 1, "WithoutSpecks", "min_px", static_cast<long long>(cleaning.min_px),
          ">= 1");
}
inline void expects_valid(const Hysteresis& cleaning, const ContactTest& test) {
  expects(is_finite(cleaning.loose_per_mm) && cleaning.loose_per_mm >= test.threshold_per_mm,
          "Hysteresis", "loose_per_mm", cleaning.loose_per_mm,
          "finite and >= threshold_per_mm of the test");
}

namespace detail {

// Which of the regions that the threshold found are contact: prepare() changes the seeds where that
// depends on all of them, keeps() judges each region.

constexpr auto keep_all = [](const Regions::Region&) { return true; };

template <class Cleaning, class S>
void prepare(const Cleaning&, const S*, Regions&) {}

template <class S>
void prepare(const LargestRegion&, const S*, Regions& regions) {
  Regions::Region largest;
  regions.for_each(keep_all, [&](const Regions::Region& region) {
    const bool larger = region.pixels() > largest.pixels();
    regions.set(larger ? largest : region, Mark::free);
    largest = larger ? region : largest;
  });
  regions.set(largest, Mark::seed);
}

/// `statistic` has the image's border.
template <class S>
void prepare(const Hysteresis& cleaning, const S* statistic, Regions& regions) {
  const S loose = S(cleaning.loose_per_mm);
  regions.for_each(keep_all, [&](Regions::Region& region) {
    regions.grow(region, regions.image().size(), [&](Index at) { return statistic[at] < loose; });
  });
  regions.reseed();
}

template <class Cleaning>
bool keeps(const Cleaning&, const Regions::Region&) {
  return true;
}
inline bool keeps(const WithoutSpecks& cleaning, const Regions::Region& region) {
  return region.pixels() >= cleaning.min_px;
}

}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
