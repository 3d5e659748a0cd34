// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Rotation of the object.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "fingerpad/math/rotation.hpp"
#include "row.hpp"
#include "support/pad.hpp"

namespace hard {

using fingerpad::Angles;
using fingerpad::Point3;
using fingerpad::Rotation;

/// Angles in the slides' order: y by asin first.
template <class S>
Angles<S> angles_by_asin(const Rotation<S>& r) {
  return {std::atan2(r.m[2][1], r.m[2][2]), std::asin(-r.m[2][0]),
          std::atan2(r.m[1][0], r.m[0][0])};
}

/// Largest element of the rotation of `angles` minus `r`.
template <class S>
Digits50 largest_difference(const Angles<S>& angles, const Rotation<S>& r) {
  const auto again = fingerpad::rotation_of(
      Angles<Digits50>{Digits50(angles.x_rad), Digits50(angles.y_rad), Digits50(angles.z_rad)});
  Digits50 worst(0);
  for (int i = 0; i < 9; ++i) {
    const Digits50 off = abs(Digits50(again.m[i / 3][i % 3] - Digits50(r.m[i / 3][i % 3])));
    worst = off > worst || off != off ? off : worst;
  }
  return worst;
}

inline Row gimbal_lock() {
  return row("rotation", "angles of a product of rotations, y to 90 degrees; elements given back",
             "atan2 for every angle, z from what remains without x", []<class S>(S) {
               Forms f;
               test::Random random(3);
               const auto add = [](Tally& t, const Angles<S>& a, const Rotation<S>& r) {
                 const S sum = a.x_rad + a.y_rad + a.z_rad;
                 if (fingerpad::is_finite(sum)) {
                   t.add_absolute(S(0), largest_difference(a, r));
                 } else {
                   t.add_absolute(sum, Digits50(0));
                 }
               };
               for (const double away : sweep(1e-18, 0.2, 3)) {
                 const auto any = [&random] { return S(random.uniform(-3, 3)); };
                 const auto other = fingerpad::rotation_of(Angles<S>{any(), any(), any()});
                 const auto turn = fingerpad::rotation_of(
                     Angles<S>{any(), S(std::numbers::pi / 2 * (1 - away)), any()});
                 const auto product = other * (fingerpad::inverse(other) * turn);
                 add(f.naive, angles_by_asin(product), product);
                 add(f.stable, fingerpad::zyx_angles(product), product);
               }
               return f;
             });
}

inline Row small_angle() {
  return row(
      "rotation", "angle between two rotations, 1e-9 to 1 rad; rad", "atan2 of sine and cosine",
      []<class S>(S) {
        Forms f;
        const auto other = fingerpad::rotation_of(Angles<S>{S(0.4), S(-0.7), S(1.1)});
        for (const double angle : sweep(1e-9, 1, 3)) {
          const auto rotated = fingerpad::rotation_of(Angles<S>{S(0), S(0), S(angle)}) * other;
          const auto d = rotated * fingerpad::inverse(other);
          const S trace = d.m[0][0] + d.m[1][1] + d.m[2][2];
          f.naive.add_absolute(std::acos((trace - S(1)) / S(2)), Digits50(S(angle)));
          f.stable.add_absolute(fingerpad::angle_between(other, rotated), Digits50(S(angle)));
        }
        return f;
      });
}

}  // namespace hard
