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

#include "fingerpad/published/object_motion.hpp"
#include "row.hpp"
#include "support/pad.hpp"

namespace hard {

using fingerpad::Angles;
using fingerpad::Point3;
using fingerpad::Rotation;
using fingerpad::detail::motion::Neighbourhood;

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

/// Nine dots with a spacing of 1.5 mm in the first direction and `across` times that in the second.
template <class S>
Neighbourhood<S> dots(const Rotation<double>& turn, double shear, double across = 1) {
  Neighbourhood<S> n;
  for (std::size_t k = 0; k < 9; ++k) {
    const double u = static_cast<double>(k % 3) - 1, v = across * (static_cast<double>(k / 3) - 1);
    const Point3<double> p = {1.5 * (u + shear / 2 * v), 1.5 * (v + shear / 2 * u), 0};
    const auto q = turn(p);
    n.dot[k] = {S(q.x + 3), S(q.y - 2), S(q.z + 10)};
    n.found[k] = true;
  }
  return n;
}

inline Row sheared_dots() {
  return row("rotation", "dots sheared by 0.02 to 0.2 while they turn; worst angle, degrees",
             "symmetric orthonormal frame of both directions", []<class S>(S) {
               Forms f;
               const Angles<double> truth{0.35, -0.2, 0.5};
               for (const double shear : {0.02, 0.05, 0.1, 0.2}) {
                 const auto from = dots<S>(Rotation<double>(), 0);
                 const auto to = dots<S>(fingerpad::rotation_of(truth), shear);
                 const auto add = [&](Tally& tally,
                                      const fingerpad::detail::motion::LocalRotation<S>& turn) {
                   const auto a = fingerpad::zyx_angles(turn.rotation);
                   const Digits50 degree(std::numbers::pi / 180);
                   tally.add(a.x_rad, Digits50(truth.x_rad), degree);
                   tally.add(a.y_rad, Digits50(truth.y_rad), degree);
                   tally.add(a.z_rad, Digits50(truth.z_rad), degree);
                 };
                 add(f.naive, fingerpad::published::PublishedBasis::turn(from, to));
                 add(f.stable, fingerpad::published::SymmetricFrame::turn(from, to));
               }
               return f;
             });
}

/// Eqs. 14-18 as printed, without a check that there are two directions.
template <class S>
Rotation<S> published_turn(const Neighbourhood<S>& from, const Neighbourhood<S>& to) {
  namespace d = fingerpad::detail;
  const auto basis = [](const Neighbourhood<S>& n) {
    const auto q = d::motion::directions_of_all(n.dot);
    const auto n1 = normalized(q.q1), n2 = normalized(q.q2);
    return d::motion::Basis<S>{n1, n2, cross(n1, n2), true};
  };
  return d::motion::turn_between(d::motion::inverse_transposed(basis(from)), basis(to));
}

inline Row collinear_dots() {
  return row("rotation", "dots nearly on a line, 1e-12 to 1 of the pitch across; elements",
             "spread across below a tenth: status collinear", []<class S>(S) {
               Forms f;
               const auto truth = fingerpad::rotation_of(Angles<double>{0.35, -0.2, 0.5});
               std::vector<double> spreads = sweep(1e-12, 1, 4);
               spreads.push_back(0);
               for (const double across : spreads) {
                 // a line of dots: both directions of the grid are parallel to it
                 Neighbourhood<S> from, to;
                 for (std::size_t k = 0; k < 9; ++k) {
                   const double u = static_cast<double>(k % 3) - 1;
                   const double v = static_cast<double>(k / 3) - 1;
                   const Point3<double> p = {1.5 * u + 0.5 * v, 1.5 * across * v, 0};
                   const auto q = truth(p);
                   from.dot[k] = {S(p.x + 3), S(p.y - 2), S(10)};
                   to.dot[k] = {S(q.x + 3), S(q.y - 2), S(q.z + 10)};
                   from.found[k] = to.found[k] = true;
                 }
                 const auto add = [&](Tally& tally, const Rotation<S>& r) {
                   S worst = S(0);
                   for (int i = 0; i < 9; ++i) {
                     const S off = std::abs(r.m[i / 3][i % 3] - S(truth.m[i / 3][i % 3]));
                     worst = off <= worst ? worst : off;
                   }
                   tally.add_absolute(worst, Digits50(0));
                 };
                 add(f.naive, published_turn(from, to));
                 const auto turn = fingerpad::published::SymmetricFrame::turn(from, to);
                 if (turn.status == fingerpad::MotionStatus::ok) {
                   add(f.stable, turn.rotation);
                 } else {
                   f.stable.answer_none(true);
                 }
               }
               return f;
             });
}

}  // namespace hard
