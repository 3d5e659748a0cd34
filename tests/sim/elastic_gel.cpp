// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "support/elastic_gel.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using test::BallOnGel;
using test::GelPad;

namespace {

constexpr double pi = std::numbers::pi;
using Point = Point2<double>;

double shear_mpa(const GelPad& pad) {
  return pad.young_mpa / (2 * (1 + pad.poisson));
}

/// Surface displacement as the sum of Boussinesq's and Cerruti's point loads over the contact, in
/// rings about the point: the pole of the kernels cancels with the area of the ring.
Point3<double> by_point_loads(const GelPad& pad, const BallOnGel<>& contact, const Point& at) {
  const double a = contact.radius_mm();
  const double c = contact.stick_radius_mm();
  const double p0 = 2 * a * pad.young_mpa / (1 - pad.poisson * pad.poisson) / (pi * pad.ball_mm);
  const Point q = contact.shear_n();
  const double force = std::hypot(q.x, q.y);
  const Point along = force > 0 ? q / force : Point{0, 0};
  const auto bump = [](double r, double radius) {
    return r < radius ? std::sqrt(1 - r * r / (radius * radius)) : 0.0;
  };
  const double nu = pad.poisson;
  const double factor = 1 / (2 * pi * shear_mpa(pad));
  Point3<double> u = {0, 0, 0};
  constexpr int rings = 1600;
  constexpr int spokes = 720;
  const double far = norm(Point(at - contact.ball_mm())) + a;
  const double ds = far / rings;
  const double da = 2 * pi / spokes;
  for (int k = 0; k < rings; ++k) {
    const double s = (k + 0.5) * ds;
    for (int m = 0; m < spokes; ++m) {
      const double angle = (m + 0.5) * da;
      const Point to = {std::cos(angle), std::sin(angle)};  // from the point to the load
      const double r = norm(Point(at + s * to - contact.ball_mm()));
      if (r >= a) {
        continue;
      }
      const double pressure = p0 * bump(r, a);
      const double shear = pad.friction * p0 * (bump(r, a) - (c > 0 ? c / a * bump(r, c) : 0));
      const double area = ds * da;  // times s, by which the kernels divide
      const double turned = shear * nu * dot(to, along);
      u.x += area * factor * (shear * (1 - nu) * along.x + turned * to.x);
      u.y += area * factor * (shear * (1 - nu) * along.y + turned * to.y);
      // under a normal load the surface moves inward and toward the load
      u.z -= area * factor * (1 - nu) * pressure;
      u.x += area * factor * (1 - 2 * nu) / 2 * pressure * to.x;
      u.y += area * factor * (1 - 2 * nu) / 2 * pressure * to.y;
    }
  }
  return u;
}

}  // namespace

TEST_CASE("elastic gel: closed forms are the sums of point loads", "[elastic_gel]") {
  for (const double poisson : {0.5, 0.3}) {
    const GelPad pad{.young_mpa = 0.3, .poisson = poisson, .ball_mm = 8, .friction = 0.5};
    BallOnGel<> contact(pad);
    contact.drag(1.2, {0, 0});
    const double far = contact.max_pull_mm();
    for (const double share : {0.4, 1.5}) {
      contact.drag(1.2, {0.8 * share * far, 0.6 * share * far});
      CHECK(contact.slides() == (share > 1));
      for (const Point& p : {Point{0.1, 0.2}, Point{1.9, -0.7}, Point{4.1, 2.6}}) {
        const Point at = contact.ball_mm() + p;
        const auto closed = contact.displacement_mm(at);
        const auto summed = by_point_loads(pad, contact, at);
        const double size = norm(summed);
        CHECK(std::abs(closed.x - summed.x) < 1e-3 * size);
        CHECK(std::abs(closed.y - summed.y) < 1e-3 * size);
        CHECK(std::abs(closed.z - summed.z) < 1e-3 * size);
      }
    }
  }
}

// Of the load of a fluid pad the slipping part carries all, as the membrane that sticks carries
// none.
TEST_CASE("fluid beside elastic: contact of 1 N, and what sticks of it", "[elastic_gel]") {
  BallOnGel<> contact{GelPad{}};
  contact.drag(1, {0, 0});
  const double fluid_mm2 = 1 / 0.019, gel_mm2 = pi * square(contact.radius_mm());
  INFO("contact in mm^2: fluid at 19 kPa " << fluid_mm2 << ", gel of 0.2 MPa " << gel_mm2);
  CHECK(fluid_mm2 == Approx(52.6).epsilon(0.01));
  CHECK(gel_mm2 == Approx(29.1).epsilon(0.01));
  for (const auto& [load, on_gel] : {std::pair{0.5, 0.63}, {0.8, 0.34}, {0.95, 0.136}}) {
    // Q = mu P (1 - (c / a)^3), and the share that sticks is (c / a)^2 = 1 - d / max_pull
    const double stick = std::pow(1 - load, 2.0 / 3);
    contact.drag(1, {0, 0});
    contact.drag(1, {(1 - stick) * contact.max_pull_mm(), 0});
    INFO("of the friction " << load << ": sticks on fluid " << 1 - load << ", on gel "
                            << contact.stick_share());
    CHECK(contact.shear_n().x == Approx(load * 0.6));
    CHECK(contact.stick_share() == Approx(on_gel).margin(0.006));
    CHECK(1 - load < contact.stick_share());
  }
}
