// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Pad and mesh of the six-axis force.
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

template <scalar S = double>
struct WrenchOptions {
  S base_radius_mm = S(18735) / S(1000);  ///< of the clamped rim, around Q, > 0
  S side_dot_length_mm = S(4) / S(5);     ///< from the rim to its side dot along the stress-free
                                          ///< membrane, > 0, short against the radius
  Index columns = 36;  ///< n, lines from the rim to A_g, in [8, 720]; published 72
  Index rows = 30;     ///< m, segments of a column, in [2, 1000]; published steps of 0.2 mm: 65
  S line_step_mm = S(2) / S(5);  ///< step along a line, in [radius / 1000, radius / 10]
  S blur_mm = S(3) / S(5);  ///< what lies nearer to the edge of the contact is not looked at, >= 0:
                            ///< a node of the height map, and half of the half width over which a
                            ///< depth map was averaged; more makes the edge less certain
  S reach_mm = S(4);        ///< how far beyond that the membrane's inclination is read, >= 4 steps
};

template <scalar S>
void expects_valid(const WrenchOptions<S>& o) {
  const char* const owner = "WrenchOptions";
  const auto positive = [&](const S& x, const char* name) {
    expects(is_finite(x) && value(x) > 0, owner, name, x, "finite and > 0");
  };
  positive(o.base_radius_mm, "base_radius_mm");
  positive(o.side_dot_length_mm, "side_dot_length_mm");
  expects(o.columns >= 8 && o.columns <= 720, owner, "columns", static_cast<long long>(o.columns),
          "in [8, 720]");
  expects(o.rows >= 2 && o.rows <= 1000, owner, "rows", static_cast<long long>(o.rows),
          "in [2, 1000]");
  const S steps = o.base_radius_mm / o.line_step_mm;
  expects(is_finite(steps) && value(steps) >= 10 && value(steps) <= 1000, owner, "line_step_mm",
          o.line_step_mm, "in [base_radius_mm / 1000, base_radius_mm / 10]");
  expects(is_finite(o.reach_mm) && !(o.reach_mm < S(4) * o.line_step_mm), owner, "reach_mm",
          o.reach_mm, "finite and >= 4 line_step_mm");
  expects(is_finite(o.blur_mm) && value(o.blur_mm) >= 0, owner, "blur_mm", o.blur_mm,
          "finite and >= 0");
}

}  // namespace v0
}  // namespace fingerpad
