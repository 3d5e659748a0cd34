// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Motion of the dots, from which the stick ratio follows.
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "fingerpad/slip/stick_ratio.hpp"
#include "row.hpp"
#include "support/slipping_dots.hpp"

namespace hard {

/// Four neighbours before and after a motion, relative to the reference dot.
template <class S>
struct Cross {
  std::array<std::array<S, 2>, 4> then, now;

  Cross(double turn, test::Random& random) {
    for (std::size_t k = 0; k < 4; ++k) {
      const double at = std::numbers::pi / 2 * static_cast<double>(k), there = at + turn;
      const auto place = [&](double angle) {
        return std::array<S, 2>{S(19.5 * std::cos(angle) + 0.02 * random.normal()),
                                S(19.5 * std::sin(angle) + 0.02 * random.normal())};
      };
      then[k] = place(at);
      now[k] = place(there);
    }
  }
  /// (theta_1 + ... + theta_4) / 4 (E034).
  S mean_angle() const {
    S sum = S(0);
    for (std::size_t k = 0; k < 4; ++k) {
      sum += std::atan2(then[k][0] * now[k][1] - then[k][1] * now[k][0],
                        then[k][0] * now[k][0] + then[k][1] * now[k][1]);
    }
    return sum / S(4);
  }
  /// atan2 of the sums of then x now and then . now.
  template <class T>
  T angle_of_sums() const {
    using std::atan2;
    T across = T(0), along = T(0);
    for (std::size_t k = 0; k < 4; ++k) {
      across += T(then[k][0]) * T(now[k][1]) - T(then[k][1]) * T(now[k][0]);
      along += T(then[k][0]) * T(now[k][0]) + T(then[k][1]) * T(now[k][1]);
    }
    return T(atan2(across, along));
  }
};

inline Row half_a_turn() {
  return row("stick ratio",
             "turn of four neighbours within 0.1 rad of half a turn, noisy dots; rad",
             "atan2 of the sums of a x b and a . b", []<class S>(S) {
               Forms f;
               test::Random random(8);
               for (int k = 0; k < 200; ++k) {
                 const double away = random.uniform(-0.1, 0.1);
                 const Cross<S> cross(std::numbers::pi - away, random);
                 const Digits50 exact = cross.template angle_of_sums<Digits50>();
                 f.naive.add_absolute(cross.mean_angle(), exact);
                 f.stable.add_absolute(cross.template angle_of_sums<S>(), exact);
               }
               return f;
             });
}

/// alpha as printed: distances across unit(d_a + d_b), of every dot to its right and lower
/// neighbour.
template <class S>
S published_alpha(const test::PointsPx& then, const test::PointsPx& now) {
  S of_then = S(0), of_now = S(0);
  for (fingerpad::Index i = 0; i + 1 < then.rows(); ++i) {
    for (fingerpad::Index j = 0; j + 1 < then.cols(); ++j) {
      for (const auto& [p, q] : {std::array<fingerpad::Index, 2>{i + 1, j}, {i, j + 1}}) {
        const auto& a = then(i, j);
        const auto& b = then(p, q);
        const auto& c = now(i, j);
        const auto& d = now(p, q);
        const S qx = S(c.x) - S(a.x) + S(d.x) - S(b.x), qy = S(c.y) - S(a.y) + S(d.y) - S(b.y);
        const S length = std::sqrt(qx * qx + qy * qy);
        of_then += std::abs((S(a.x) - S(b.x)) * qy / length - (S(a.y) - S(b.y)) * qx / length);
        of_now += std::abs((S(c.x) - S(d.x)) * qy / length - (S(c.y) - S(d.y)) * qx / length);
      }
    }
  }
  return of_then / of_now;
}

template <class S>
fingerpad::StickResult<S> stick_ratio_between(const test::PointsPx& then,
                                              const test::PointsPx& now,
                                              const test::ContactFlags& contact) {
  fingerpad::StickRatio<S> stick(contact.rows(), contact.cols(), test::stick_options(2, 0.24));
  (void)stick(then, contact);
  return stick(now, contact);
}

inline Row plain_press() {
  return row("stick ratio", "scale of a plain press, where nothing moves along; alpha",
             "least squares over all sticking dots: no direction", []<class S>(S) {
               Forms f;
               for (const double zoom : {33.0 / 32, 17.0 / 16, 31.0 / 32}) {
                 // with an even number of columns, two neighbours lie opposite each other about the
                 // middle
                 const test::SlippingDots truth({.cols = 20, .contact_pitches = 20});
                 test::PointsPx then = truth.dots, now = truth.dots;
                 for (auto& p : now.cells) {
                   p = {320 + zoom * (p.x - 320), 240 + zoom * (p.y - 240)};
                 }
                 for (test::PointsPx* dots : {&then, &now}) {
                   for (auto& p : dots->cells) {
                     p = {static_cast<double>(S(p.x)), static_cast<double>(S(p.y))};
                   }
                 }
                 const Digits50 exact = 1 / Digits50(zoom);
                 f.naive.add_absolute(published_alpha<S>(then, now), exact);
                 f.stable.add_absolute(
                     S(1) / stick_ratio_between<S>(then, now, truth.contact).scale, exact);
               }
               return f;
             });
}

inline Row nothing_moved() {
  return row("stick ratio", "no dot has moved: threshold and differences are 0; answers",
             "a reference by the distance moved; status", []<class S>(S) {
               Forms f;
               for (const double contact : {3.2, 5.2, 8.2}) {
                 const test::SlippingDots truth({.contact_pitches = contact});
                 // delta = delta_0 d_max / U; a dot sticks if |d_0 - d_k| < delta, and the
                 // reference always does
                 const double furthest = 0, delta = 0.24 * furthest / 2;
                 int stick = 1, all = 0;
                 for (const auto touches : truth.contact.cells) {
                   all += touches != 0 ? 1 : 0;
                   stick += touches != 0 && furthest < delta ? 1 : 0;
                 }
                 f.naive.answer_none(!(stick > 0 && all > 0));
                 const auto r = stick_ratio_between<S>(truth.dots, truth.dots, truth.contact);
                 f.stable.answer_none(!r.updated());
               }
               return f;
             });
}

}  // namespace hard
