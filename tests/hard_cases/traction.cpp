// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The traction field against itself in fifty digits.
#include "fingerpad/force/traction.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "support/membrane_triangle.hpp"
#include "support/numbers.hpp"
#include "support/traction_scenes.hpp"

using namespace fingerpad;
using test::Corners;
using test::Digits50;

namespace {

template <class S, class From>
Corners<S> as(const Corners<From>& x) {
  Corners<S> out;
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = {S(x[k].x), S(x[k].y), S(x[k].z)};
  }
  return out;
}

/// Largest errors of a load and of the force, relative to the pressure and to the largest
/// component.
struct Loss {
  double load = 0;
  double pressure = 0;
  double force = 0;
};

template <class S>
Loss loss_of(const test::TractionScene& s) {
  // rounding of the inputs to S is no error of the method: both start from the numbers of S
  const auto stored_free = test::as<S>(test::stress_free_dots());
  const auto stored = test::as<S>(s.dots);
  TractionField<S> field(stored_free, {.mu_t_n_per_mm = S(0.5)});
  TractionField<Digits50> exact(stored_free, {.mu_t_n_per_mm = Digits50(0.5)});
  const S p = S(s.pressure_mpa);
  const auto r = field(stored, s.contact, p);
  const auto e = exact(stored, s.contact, Digits50(p));
  REQUIRE(r.ok());
  REQUIRE(e.ok());
  REQUIRE(r.free_dots == e.free_dots);
  Loss loss;
  const auto off = [](const S& a, const Digits50& b) {
    return std::abs(static_cast<double>(Digits50(a) - b));
  };
  for (Index i = 0; i < 21; ++i) {
    for (Index j = 0; j < 21; ++j) {
      if (is_finite(field.pressure_mpa()(i, j))) {
        const auto& a = field.load_mpa()(i, j);
        const auto& b = exact.load_mpa()(i, j);
        loss.load = (std::max)({loss.load, off(a.x, b.x), off(a.y, b.y), off(a.z, b.z)});
        loss.pressure =
            (std::max)(loss.pressure, off(field.pressure_mpa()(i, j), exact.pressure_mpa()(i, j)));
      }
    }
  }
  loss.load /= s.pressure_mpa;
  loss.pressure /= s.pressure_mpa;
  loss.force = (std::max)({off(r.force_n.x, e.force_n.x), off(r.force_n.y, e.force_n.y),
                           off(r.force_n.z, e.force_n.z)}) /
               s.largest_force_n();
  return loss;
}

}  // namespace

TEST_CASE("membrane triangle with fifty digits", "[traction][hard]") {
  test::Gauss gauss(4);
  double worst = 0;
  for (int k = 0; k < 200; ++k) {
    Corners<double> free = {Point3<double>{0, 0, 0}, {1.5, 0, 0}, {0.3, 1.4, 0}};
    Corners<double> now = free;
    for (std::size_t c = 0; c < 3; ++c) {
      free[c] = free[c] + 0.1 * Point3<double>{gauss(), gauss(), gauss()};
      now[c] = now[c] + 0.2 * Point3<double>{gauss(), gauss(), gauss()};
    }
    const auto force = test::corner_forces(test::stress_free(free), now);
    const auto exact =
        test::corner_forces(test::stress_free(as<Digits50>(free)), as<Digits50>(now));
    for (std::size_t c = 0; c < 3; ++c) {
      const double scale = std::sqrt(static_cast<double>(squared_norm(exact[c])));
      worst = (std::max)(
          worst, std::abs(static_cast<double>(Digits50(force[c].x) - exact[c].x)) / (1 + scale));
    }
  }
  INFO("worst error of a force " << worst);
  CHECK(worst < 1e-13);
}

TEST_CASE("traction in double and in float against fifty digits", "[traction][hard]") {
  for (const auto& s : test::traction_scenes()) {
    const Loss in_double = loss_of<double>(s);
    const Loss in_float = loss_of<float>(s);
    CAPTURE(s.name, in_double.load, in_float.load, in_float.pressure, in_float.force);
    CHECK(in_double.load < 1e-12);
    CHECK(in_double.force < 1e-12);
    CHECK(in_float.load < 1e-3);
    CHECK(in_float.pressure < 1e-3);
    CHECK(in_float.force < 1e-4);
  }
}
