// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Parameters of the contact test: the ring, the threshold, the smallest region, and where the edge
// is placed.
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/curvature.hpp"

namespace fingerpad {
inline namespace v0 {

/// The test for contact: a mean curvature below the threshold.
struct ContactTest {
  /// delta in the sources. Half the curvature of the free pad is a good choice: 1/40 per mm for the
  /// published pad of 20 mm radius. calibrate/contact.hpp measures it. Finite, > 0.
  double threshold_per_mm = 0.025;
  double free_apex_mm = 13;  ///< height of the free pad, from which contact depth counts; finite
  CurvatureRing ring = {};
  Index min_region_px = 200;  ///< smaller regions are dropped: noise makes specks of about half a
                              ///< ring's radius. >= 1; 1 drops none
};

/// Refuses values out of range (parameter_error).
inline void expects_valid(const ContactTest& test) {
  expects(is_finite(test.threshold_per_mm) && test.threshold_per_mm > 0, "ContactTest",
          "threshold_per_mm", test.threshold_per_mm, "finite and > 0");
  expects(is_finite(test.free_apex_mm), "ContactTest", "free_apex_mm", test.free_apex_mm, "finite");
  expects(test.min_region_px >= 1, "ContactTest", "min_region_px",
          static_cast<long long>(test.min_region_px), ">= 1");
  require(test.ring);
}

/// Contact is where the statistic is below the threshold, as published. A ring that reaches beyond
/// the edge includes free membrane: with a threshold near 0 the region is too small by about a
/// ring's radius on all sides.
struct AtThreshold {};

/// The threshold finds the contact; the edge is then placed where the mean curvature changes from
/// that of the object to that of the free membrane (edge_level.hpp). Costs a second curvature map
/// of the rows around the contact.
struct HalfLevelEdge {
  /// Membrane nearer than this to the object counts as touched. This moves the edge outward by
  /// sqrt(gap / jump of the mean curvature), about 0.5 mm at the default; a depth map from 8-bit
  /// frames cannot distinguish such a gap from contact. In [0, 1].
  double touching_gap_mm = 0.02;
};

inline void expects_valid(const AtThreshold&) {}
/// Refuses values out of range (parameter_error).
inline void expects_valid(const HalfLevelEdge& edge) {
  expects(edge.touching_gap_mm >= 0 && edge.touching_gap_mm <= 1, "HalfLevelEdge",
          "touching_gap_mm", edge.touching_gap_mm, "in [0, 1]");
}

}  // namespace v0
}  // namespace fingerpad
