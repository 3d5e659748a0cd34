// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Curvature of the membrane.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>
#include <utility>

#include "fingerpad/image/curvature.hpp"
#include "fingerpad/published/contact_region.hpp"
#include "row.hpp"
#include "support/pad.hpp"

namespace hard {

/// Random sections, as those of a pad: depth 5 to 13 mm, slope up to 1.5.
inline Row flat_section() {
  return row(
      "curvature", "sections of curvature 1.5e-4/mm, ring of 0.768 mm; 1/mm",
      "(K1), Menger's form: no center, no radius", []<class S>(S) {
        Forms f;
        test::Random random(7);
        for (int k = 0; k < 2000; ++k) {
          const S r = S(0.768);
          const double middle = random.uniform(5, 13), rise = 0.768 * random.uniform(-1.5, 1.5);
          const double bend = 1.5e-4 * 0.768 * 0.768 / 2;
          const S before = S(middle - rise - bend), center = S(middle);
          const S after = S(middle + rise - bend);
          const Digits50 exact = fingerpad::section_curvature(Digits50(r), Digits50(before),
                                                              Digits50(center), Digits50(after));
          f.naive.add_absolute(
              fingerpad::published::circle_center_curvature(r, before, center, after), exact);
          f.stable.add_absolute(fingerpad::section_curvature(r, before, center, after), exact);
        }
        return f;
      });
}

inline Row flat_contact() {
  return row("curvature",
             "mean of 18 sections on a flat contact that is tilted by 0 to 0.02, "
             "depths on the grid of a bisection; 1/mm",
             "the same", []<class S>(S) {
               Forms f;
               test::Random random(7);
               const double grid = 14.0 / 32768;
               for (int k = 0; k < 400; ++k) {
                 const double along_x = k < 40 ? 0 : random.uniform(-0.02, 0.02);
                 const double along_y = k < 40 ? 0 : random.uniform(-0.02, 0.02);
                 const double center = random.uniform(5, 13);
                 const auto depth = [&](double x, double y) {
                   return S(grid * std::round((center + along_x * x + along_y * y) / grid));
                 };
                 S circle = S(0), menger = S(0);
                 Digits50 exact(0);
                 for (int n = 0; n < 18; ++n) {
                   const double at = std::numbers::pi * n / 18;
                   const double x = 0.0768 * std::round(10 * std::cos(at));
                   const double y = 0.0768 * std::round(10 * std::sin(at));
                   const S r = S(std::hypot(x, y));
                   const S before = depth(-x, -y), middle = depth(0, 0), after = depth(x, y);
                   circle +=
                       fingerpad::published::circle_center_curvature(r, before, middle, after) /
                       S(18);
                   menger += fingerpad::section_curvature(r, before, middle, after) / S(18);
                   exact += fingerpad::section_curvature(Digits50(r), Digits50(before),
                                                         Digits50(middle), Digits50(after)) /
                            18;
                 }
                 f.naive.add_absolute(circle, exact);
                 f.stable.add_absolute(menger, exact);
               }
               return f;
             });
}

}  // namespace hard
