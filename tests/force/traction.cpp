// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every membrane, every load and every grid.
#include "fingerpad/force/traction.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/membrane_triangle.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"
#include "support/rolling.hpp"
#include "support/traction_scenes.hpp"

using namespace fingerpad;
using test::Corners;
using test::Digits50;
using test::Dots;
using test::Flags;
using test::FreeTriangle;

using Vector = Point3<double>;

namespace {

const double missing = std::numeric_limits<double>::quiet_NaN();

/// Dots `pitch` apart, placed by place(x, y).
template <class Place>
Dots sheet(Index n, double pitch, const Place& place) {
  Dots dots(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      dots(i, j) = place(pitch * (static_cast<double>(j) - static_cast<double>(n - 1) / 2),
                         pitch * (static_cast<double>(i) - static_cast<double>(n - 1) / 2));
    }
  }
  return dots;
}
Dots flat(Index n, double pitch) {
  return sheet(n, pitch, [](double x, double y) { return Vector{x, y, 0}; });
}
Dots cap(Index n, double pitch, double radius, double stretch) {
  return sheet(n, pitch, [=](double x, double y) {
    return stretch * Vector{x, y, std::sqrt(radius * radius - x * x - y * y)};
  });
}

double size(const Vector& a) {
  return std::sqrt(squared_norm(a));
}
double distance(const Vector& a, const Vector& b) {
  return size(a - b);
}

/// Number of dots with a load.
int loaded(const TractionField<>& field) {
  int count = 0;
  for (Index i = 0; i < field.rows(); ++i) {
    for (Index j = 0; j < field.cols(); ++j) {
      count += is_finite(field.pressure_mpa()(i, j)) ? 1 : 0;
    }
  }
  return count;
}

Flags touch(Index n, Index first, Index last) {
  Flags flags(n, n, 0);
  for (Index i = first; i <= last; ++i) {
    for (Index j = first; j <= last; ++j) {
      flags(i, j) = 1;
    }
  }
  return flags;
}

/// The uniformly stretched cap and the pressure that it holds.
struct Balloon {
  double radius = 20, stretch = 1.2, mu_t = 0.5;

  double tension() const { return mu_t * (1 - std::pow(stretch, -6)); }
  double pressure() const { return 2 * tension() / (radius * stretch); }
  /// rms load relative to the pressure, of dots `pitch` apart
  double load_rms(double pitch) const {
    const Index n = 2 * static_cast<Index>(9 / pitch) + 1;
    TractionField field(cap(n, pitch, radius, 1), {.mu_t_n_per_mm = mu_t});
    return field(cap(n, pitch, radius, stretch), Flags(n, n, 0), pressure()).free_load_rms_mpa /
           pressure();
  }
};

const Corners<double> some_triangle = {Vector{0.1, -0.2, 0.3}, Vector{1.6, 0.1, 0.2},
                                       Vector{0.4, 1.3, -0.1}};
const Corners<double> pulled_triangle = {Vector{0.0, -0.3, 0.2}, Vector{1.8, 0.4, 0.5},
                                         Vector{0.2, 1.7, 0.1}};

}  // namespace

TEST_CASE("membrane triangle: forces are the slope of the energy", "[traction]") {
  using D = test::Tangent<double>;
  const auto reference = test::stress_free(some_triangle);
  const auto force = test::corner_forces(reference, pulled_triangle);
  FreeTriangle<D> dual;
  dual.area_mm2 = reference.area_mm2;
  for (std::size_t k = 0; k < 3; ++k) {
    dual.half_cotangent[k] = reference.half_cotangent[k];
  }
  Vector sum{0, 0, 0}, moment{0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto slope = [&](int axis) {
      Corners<D> x;
      for (std::size_t c = 0; c < 3; ++c) {
        x[c] = {pulled_triangle[c].x, pulled_triangle[c].y, pulled_triangle[c].z};
      }
      (axis == 0 ? x[k].x : axis == 1 ? x[k].y : x[k].z).d = 1;
      return test::stored_energy(dual, x).d;
    };
    CHECK(force[k].x == Approx(-slope(0)).margin(1e-13));
    CHECK(force[k].y == Approx(-slope(1)).margin(1e-13));
    CHECK(force[k].z == Approx(-slope(2)).margin(1e-13));
    sum = sum + force[k];
    moment = moment + cross(pulled_triangle[k], force[k]);
  }
  CHECK(size(sum) < 1e-14);
  CHECK(size(moment) < 1e-14);
  for (const Vector& f : test::corner_forces(reference, some_triangle)) {
    CHECK(size(f) < 1e-14);
  }
}

TEST_CASE("membrane triangle: the pull of the library", "[traction]") {
  const detail::traction::Triangle<double> free(some_triangle[0], some_triangle[1],
                                                some_triangle[2]);
  const auto force = test::corner_forces(test::stress_free(some_triangle), pulled_triangle);
  std::array<Vector, 3> pulls;
  Vector normal;
  REQUIRE(free.pull(pulled_triangle[0], pulled_triangle[1], pulled_triangle[2], 0, pulls, normal));
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(distance(pulls[k], force[k]) < 1e-14);
  }
  CHECK(distance(normal, test::twice_area_vector(pulled_triangle)) < 1e-14);
}

TEST_CASE("membrane triangle: a stretch above 5 or below 1 / 5 is refused", "[traction]") {
  const detail::traction::Triangle<double> free({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  std::array<Vector, 3> pulls;
  Vector normal;
  const auto taken = [&](double a, double b) {
    return free.pull({0, 0, 0}, {a, 0, 0}, {0, b, 0}, 0, pulls, normal);
  };
  for (const double b : {0.21, 0.5, 1.0, 2.0, 4.9}) {
    CAPTURE(b);
    for (const double a : {0.21, 1.0, 4.9}) {
      CHECK(taken(a, b));
    }
    for (const double a : {-0.1, 0.0, 0.19, 5.1, 1e3, 1e150, missing}) {
      CHECK(!taken(a, b));
      CHECK(!taken(b, a));
    }
  }
  using Triangle = detail::traction::Triangle<double>;
  CHECK(Triangle({0, 0, 0}, {1, 0, 0}, {0.5, 2e-3, 0}).height_mm == Approx(2e-3));
  CHECK_FALSE(Triangle({0, 0, 0}, {1, 0, 0}, {0.5, 5e-4, 0}).is_known());
  CHECK_FALSE(Triangle({0, 0, 0}, {1, 0, 0}, {0.5, missing, 0}).is_known());
}

TEST_CASE("traction: an inflated cap carries no load", "[traction]") {
  const Balloon b;
  const double coarse = b.load_rms(1.5), fine = b.load_rms(0.75), finer = b.load_rms(0.375);
  INFO("rms load by pressure: " << coarse << ", " << fine << ", " << finer);
  CHECK(coarse < 2e-3);
  CHECK(coarse / fine == Approx(4).epsilon(0.15));  // second order in the pitch
  CHECK(fine / finer == Approx(4).epsilon(0.15));

  TractionField field(cap(13, 1.5, b.radius, 1));
  const auto r = field(cap(13, 1.5, b.radius, b.stretch), Flags(13, 13, 0), b.pressure());
  CHECK(r.status == TractionStatus::no_contact);
  CHECK(r.mu_t_n_per_mm == Approx(b.mu_t).epsilon(1e-3));
  CHECK(b.tension() == Approx(b.pressure() * b.radius * b.stretch / 2));
  CHECK(size(r.force_n) == 0);
  CHECK(size(r.moment_n_mm) == 0);

  // rubber with a second constant holds more
  const double share = 0.3, sq = b.stretch * b.stretch;
  TractionField other(cap(13, 1.5, b.radius, 1), {.mooney_share = share});
  const auto held = other(cap(13, 1.5, b.radius, b.stretch), Flags(13, 13, 0), b.pressure());
  CHECK(held.mu_t_n_per_mm == Approx(b.mu_t / (1 - share + share * sq)).epsilon(1e-3));
}

TEST_CASE("traction: a stretched sheet on a plate is pressed by p", "[traction]") {
  const Index n = 9;
  TractionField field(flat(n, 1.5), {.mu_t_n_per_mm = 0.4, .fade_dots = 0});
  const double p = 0.02;
  const auto on_plate = sheet(n, 1.5, [](double x, double y) {
    return Vector{1.2 * x + 0.1 * y, 1.1 * y, 9};
  });
  const auto r = field(on_plate, touch(n, 3, 5), p);
  REQUIRE(r.status == TractionStatus::ok);
  CHECK(loaded(field) == 49);
  for (Index i = 1; i + 1 < n; ++i) {
    for (Index j = 1; j + 1 < n; ++j) {
      CHECK(field.pressure_mpa()(i, j) == Approx(p));
      CHECK(size(field.shear_mpa()(i, j)) < 1e-14);
      CHECK(distance(field.load_mpa()(i, j), Vector{0, 0, -p}) < 1e-14);
      CHECK(field.area_mm2()(i, j).z == Approx(1.2 * 1.1 * 2.25));
    }
  }
  CHECK(distance(r.force_n, Vector{0, 0, -p * 25 * 1.2 * 1.1 * 2.25}) < 1e-12);
  CHECK(std::isnan(field.pressure_mpa()(0, 3)));  // dots at the edge of the grid have no load
}

TEST_CASE("traction: shear that grows along x is held by the object", "[traction]") {
  // u_y = a x^2 / 2: T_xy = mu t a x, so q_y = -mu t a; the area stays
  const double a = 0.02, mu_t = 0.5, p = 0.02;
  const Index n = 9;
  TractionField field(flat(n, 1.5), {.mu_t_n_per_mm = mu_t});
  const auto dots = sheet(n, 1.5, [&](double x, double y) {
    return Vector{x, y + a * x * x / 2, 9};
  });
  const auto r = field(dots, touch(n, 2, 6), p);
  REQUIRE(r.ok());
  for (Index i = 1; i + 1 < n; ++i) {
    for (Index j = 1; j + 1 < n; ++j) {
      CHECK(distance(field.shear_mpa()(i, j), Vector{0, -mu_t * a, 0}) < 1e-14);
      CHECK(field.pressure_mpa()(i, j) == Approx(p));
    }
  }
}

TEST_CASE("traction: the ring and what fades out", "[traction]") {
  // loads are equal everywhere, so the force counts weights: 1 in contact and in the ring, then 2/3
  // and 1/3
  const Index n = 15;
  const double p = 0.01;
  TractionField field(flat(n, 1), {.mu_t_n_per_mm = 0.4, .ring_dots = 1, .fade_dots = 2});
  auto dots = flat(n, 1);
  for (auto& x : dots.cells) {
    x.z = 9;
  }
  auto r = field(dots, touch(n, 7, 7), p);
  REQUIRE(r.has_force());
  CHECK(-r.force_n.z / p == Approx(9 + 16 * 2.0 / 3 + 24 * 1.0 / 3));
  CHECK(r.free_dots == 169 - 9);
  r = field(dots, touch(n, 1, 1), p);  // its ring touches the edge of the grid
  CHECK(r.status == TractionStatus::incomplete);
  CHECK(r.dots_left_out == 5);
  r = field(dots, touch(n, 2, 2), p);  // only the fading part would lie there
  CHECK(r.status == TractionStatus::free_part_loaded);
  CHECK(r.modulus_differs);
}

TEST_CASE("traction: each of several contacts", "[traction]") {
  // on a plate every dot bears p times its area: a contact those of its dots and its ring, and
  // where rings meet each those that are nearer; two corners on each side are as near to both
  const Index n = 15;
  const double p = 0.01;
  TractionField field(flat(n, 1), {.mu_t_n_per_mm = 0.4, .ring_dots = 3, .fade_dots = 0});
  auto dots = flat(n, 1);
  for (auto& x : dots.cells) {
    x.z = 9;
  }
  Flags left(n, n, 0), right(n, n, 0), both(n, n, 0);
  left(7, 4) = right(7, 9) = both(7, 4) = both(7, 9) = 1;
  CHECK(!field.part(left).has_force());  // no frame yet
  const auto all = field(dots, both, p);
  REQUIRE(all.has_force());
  const auto a = field.part(left), b = field.part(right), none = field.part(Flags(n, n, 0));
  CHECK(-a.force_n.z / p == Approx(7 * 6 + 2));
  CHECK(-b.force_n.z / p == Approx(7 * 6 + 2));
  CHECK(-all.force_n.z / p == Approx(7 * 12));
  CHECK(a.moment_n_mm.y + b.moment_n_mm.y == Approx(0.5 * (a.force_n.z + b.force_n.z)));
  CHECK(none.status == TractionStatus::no_contact);
  CHECK(size(none.force_n) == 0);
  CHECK(distance(field.part(both).force_n, all.force_n) == 0);
  CHECK(!field.part(Flags(n, n - 1, 0)).has_force());
}

TEST_CASE("traction: two balls on a finite-element membrane, each with its force", "[traction]") {
  // forces of the nodes of each ball, N, and their moments about the middle of the base, N mm
  const Vector forces[2] = {{0.0801, 0.2195, -1.1859}, {-0.2105, 0.8343, -1.1298}};
  const Vector moments[2] = {{-3.344, -5.557, 0.050}, {-11.021, 3.894, 5.110}};
  const auto scene = test::traction_scene("two_balls");
  TractionField field(test::stress_free_dots("two_balls_stress_free"), {.mu_t_n_per_mm = 0.3});
  test::Gauss gauss(5);
  for (const double noise_mm : {0.0, 0.005}) {
    CAPTURE(noise_mm);
    REQUIRE(
        field(test::noisy(scene.dots, noise_mm, gauss), scene.contact, scene.pressure_mpa).ok());
    for (unsigned char ball = 1; ball <= 2; ++ball) {
      Flags dots(21, 21, 0);
      for (std::size_t k = 0; k < dots.cells.size(); ++k) {
        dots.cells[k] = scene.contact.cells[k] == ball;
      }
      const auto r = field.part(dots);
      CHECK(distance(r.force_n, forces[ball - 1]) < 0.02 * 1.2 + 3 * noise_mm);
      CHECK(distance(r.moment_n_mm, moments[ball - 1]) < 0.02 * 12 + 30 * noise_mm);
    }
  }
}

TEST_CASE("traction: a dot that is not found", "[traction]") {
  const auto s = test::traction_scene("drag");
  const auto free = test::stress_free_dots();
  TractionField field(free, {.mu_t_n_per_mm = 0.5});
  const auto whole = field(s.dots, s.contact, s.pressure_mpa);
  REQUIRE(whole.ok());
  const auto before = field;

  auto holed = s.dots;
  holed(10, 11).y = missing;
  const auto r = field(holed, s.contact, s.pressure_mpa);
  CHECK(r.ok());
  CHECK(loaded(field) == loaded(before) - 9);
  for (Index i = 0; i < 21; ++i) {
    for (Index j = 0; j < 21; ++j) {
      const bool near = std::abs(i - 10) <= 1 && std::abs(j - 11) <= 1;
      CAPTURE(i, j);
      CHECK(is_finite(field.pressure_mpa()(i, j)) ==
            (is_finite(before.pressure_mpa()(i, j)) && !near));
      if (is_finite(field.pressure_mpa()(i, j))) {
        CHECK(field.pressure_mpa()(i, j) == before.pressure_mpa()(i, j));
        CHECK(distance(field.load_mpa()(i, j), before.load_mpa()(i, j)) == 0);
      }
    }
  }
  // the position of a dot inside the contact does not matter
  CHECK(distance(r.force_n, whole.force_n) < 1e-13);
  CHECK(distance(r.moment_n_mm, whole.moment_n_mm) < 1e-12);

  // two adjacent missing dots are interpolated from the dots across; four by four leave a hole
  holed(10, 12).y = missing;
  const auto two = field(holed, s.contact, s.pressure_mpa);
  CHECK(two.ok());
  CHECK(distance(two.force_n, whole.force_n) < 1e-13);
  for (Index i = 9; i <= 12; ++i) {
    for (Index j = 9; j <= 12; ++j) {
      holed(i, j).x = missing;
    }
  }
  const auto hole = field(holed, s.contact, s.pressure_mpa);
  CHECK(hole.status == TractionStatus::incomplete);
  CHECK(hole.dots_left_out > 0);

  // on the free part it leaves no significant gap in the sums
  auto free_hole = s.dots;
  free_hole(3, 10).x = missing;
  const auto outside = field(free_hole, s.contact, s.pressure_mpa);
  CHECK(outside.ok());
  CHECK(distance(outside.force_n, whole.force_n) < 0.01 * size(whole.force_n));
}

TEST_CASE("traction: a dot that is not found lies between opposite neighbours", "[traction]") {
  // its neighbours have no load of their own, but the sum over the patch around does not change
  const Index n = 9;
  TractionField field(flat(n, 1.5),
                      {.mu_t_n_per_mm = 0.4, .min_free_dots = 100, .ring_dots = 2, .fade_dots = 0});
  const Dots whole = sheet(n, 1.5, [](double x, double y) {
    return Vector{1.1 * x, 1.1 * y, 9 + 0.02 * x * y - 0.01 * x * x};
  });
  const Vector force = field(whole, touch(n, 4, 4), 0.02).force_n;
  for (const bool corners : {false, true}) {  // pairs beside the dot, or at its corners alone
    Dots dots = whole;
    dots(4, 4).x = missing;
    for (const auto& [i, j] : {std::pair<Index, Index>{3, 4}, {5, 4}, {4, 3}, {4, 5}}) {
      dots(i, j).x = corners ? missing : dots(i, j).x;
    }
    CAPTURE(corners);
    const auto r = field(dots, touch(n, 4, 4), 0.02);
    CHECK(r.ok());
    CHECK(distance(r.force_n, force) < 1e-12);
  }
  Dots dots = whole;  // one of each pair is missing
  for (const auto& [i, j] : {std::pair<Index, Index>{4, 4}, {3, 4}, {4, 3}, {3, 3}, {3, 5}}) {
    dots(i, j).x = missing;
  }
  CHECK(field(dots, touch(n, 4, 4), 0.02).status == TractionStatus::incomplete);
}

TEST_CASE("traction: dots that are no membrane", "[traction]") {
  const Index n = 9;
  TractionField field(flat(n, 1.5), {.mu_t_n_per_mm = 0.4});
  auto dots = flat(n, 1.5);
  for (auto& x : dots.cells) {
    x = {1.1 * x.x, 1.1 * x.y, 9};
  }
  const Flags contact = touch(n, 4, 4);
  const auto good = field(dots, contact, 0.02);
  REQUIRE(good.has_force());
  CHECK(loaded(field) == 49);
  SECTION("two exchanged") {
    std::swap(dots(4, 4), dots(4, 5));
    const auto r = field(dots, contact, 0.02);
    CHECK(r.status == TractionStatus::incomplete);
    CHECK(std::isnan(field.pressure_mpa()(4, 4)));
    CHECK(field.pressure_mpa()(1, 1) == Approx(0.02));
  }
  SECTION("two rows exchanged: no cell is folded, but the membrane is") {
    for (Index j = 0; j < n; ++j) {
      std::swap(dots(4, j), dots(5, j));
    }
    const auto r = field(dots, contact, 0.02);
    CHECK(r.status == TractionStatus::incomplete);
    CHECK(std::isnan(field.pressure_mpa()(4, 4)));
    CHECK(std::isnan(field.pressure_mpa()(5, 4)));
  }
  SECTION("two at the same place") {
    dots(4, 4) = dots(4, 5);
    dots(5, 4) = dots(5, 5);
    CHECK(field(dots, contact, 0.02).status == TractionStatus::incomplete);
    CHECK(std::isnan(field.pressure_mpa()(4, 4)));
  }
  SECTION("far away") {
    dots(4, 4).z = 60;
    (void)field(dots, contact, 0.02);
    CHECK(loaded(field) == 49 - 9);
  }
  SECTION("beyond measure") {
    dots(4, 4).z = 1e200;
    CHECK(norm(field(dots, contact, 0.02).force_n - good.force_n) < 1e-12);
  }
}

TEST_CASE("traction: statuses", "[traction]") {
  const Index n = 9;
  const Dots free = flat(n, 1.5);
  Dots dots = sheet(n, 1.5, [](double x, double y) {
    return Vector{1.1 * x, 1.1 * y, 9 - 0.02 * (x * x + y * y)};
  });
  TractionField balanced(free);
  const Flags none(n, n, 0);
  const Flags middle = touch(n, 4, 4);
  const double mu_t = balanced(dots, middle, 0.02).mu_t_n_per_mm;
  TractionField given(free, {.mu_t_n_per_mm = mu_t});

  for (const double p : {0.0, -0.01, missing, std::numeric_limits<double>::infinity()}) {
    const auto r = given(dots, middle, p);
    CHECK(r.status == TractionStatus::bad_pressure);
    CHECK(!r.has_force());
    CHECK(std::isnan(r.force_n.x));
    CHECK(std::isnan(given.pressure_mpa()(4, 4)));
  }
  CHECK(given(dots, none, 0.02).status == TractionStatus::no_contact);
  CHECK(given(dots, middle, 0.02).status == TractionStatus::ok);
  for (const auto& [share, said] : {std::pair{0.88, TractionStatus::free_part_loaded},
                                    {0.95, TractionStatus::ok},
                                    {1.05, TractionStatus::ok},
                                    {1.13, TractionStatus::free_part_loaded}}) {
    TractionField off(free, {.mu_t_n_per_mm = share * mu_t});
    CHECK(off(dots, middle, 0.02).status == said);
    CHECK(off(dots, middle, 0.02).has_force());
  }
  CHECK(balanced(dots, middle, 0.02).status == TractionStatus::ok);
  CHECK(balanced(dots, touch(n, 2, 6), 0.02).status == TractionStatus::no_balance);
  CHECK(std::isnan(balanced.pressure_mpa()(4, 4)));
  const Dots hollow = sheet(n, 1.5, [](double x, double y) {
    return Vector{1.1 * x, 1.1 * y, 9 + 0.02 * (x * x + y * y)};
  });
  CHECK(balanced(hollow, none, 0.02).status == TractionStatus::no_balance);
  CHECK(given(test::no_dots(n, n), middle, 0.02).status == TractionStatus::bad_dots);

  CHECK(given(flat(8, 1.5), middle, 0.02).status == TractionStatus::refused);
  CHECK(given(dots, touch(10, 4, 4), 0.02).status == TractionStatus::refused);

  CHECK(name_of(TractionStatus::ok) == std::string("ok"));
  CHECK(name_of(TractionStatus::free_part_loaded) == std::string("free part loaded"));
  CHECK(name_of(TractionStatus::refused) == std::string("refused"));
}

TEST_CASE("traction: bad parameters are refused", "[traction]") {
  const Dots free = flat(5, 1.5);
  const auto with = [&](const TractionOptions<>& options) {
    return test::refusal([&] { TractionField(free, options); });
  };
  CHECK(with({}) == "accepted");
  CHECK(test::begins_with(with({.ring_dots = -1}), "TractionOptions: ring_dots = -1, must be"));
  CHECK(test::begins_with(with({.ring_dots = 6}), "TractionOptions: ring_dots = 6, must be"));
  CHECK(test::begins_with(with({.fade_dots = -1}), "TractionOptions: fade_dots = -1, must be"));
  CHECK(test::begins_with(with({.fade_dots = 21}), "TractionOptions: fade_dots = 21, must be"));
  const auto modulus = [&](double mu_t) {
    return test::refusal([&] { TractionField(free, {.mu_t_n_per_mm = mu_t}); });
  };
  CHECK(modulus(0.5) == "accepted");
  CHECK(test::begins_with(modulus(0), "TractionOptions: mu_t_n_per_mm = 0, must be"));
  CHECK(test::begins_with(modulus(missing), "TractionOptions: mu_t_n_per_mm = "));
  CHECK(
      test::begins_with(with({.mooney_share = 1.1}), "TractionOptions: mooney_share = 1.1, must"));
  CHECK(test::begins_with(with({.min_free_dots = 0}), "TractionOptions: min_free_dots = 0, must"));
  CHECK(test::begins_with(test::refusal([] { TractionField(Dots(2, 5)); }),
                          "TractionField: rows = 2, must be"));
  CHECK(test::begins_with(test::refusal([] { TractionField(Dots(5, 2)); }),
                          "TractionField: cols = 2, must be"));
}

using Vector = Point3<double>;

namespace {

Vector any_vector(double largest) {
  return {test::uniform(-largest, largest), test::uniform(-largest, largest),
          test::uniform(-largest, largest)};
}

/// A membrane that is stretched and loaded at random.
struct Pad {
  Dots free{0, 0};
  Dots dots{0, 0};
  Flags contact{0, 0};
  double pressure = 0.02;
  double mu_t = 0.5;

  static Pad any() {
    const Index rows = test::whole(6, 10), cols = test::whole(6, 10);
    Pad pad{Dots(rows, cols), Dots(rows, cols), Flags(rows, cols, 0), test::log_uniform(1e-3, 0.1),
            test::log_uniform(0.05, 5)};
    const double stretch_x = test::uniform(1, 1.4), stretch_y = test::uniform(1, 1.4);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const double x = 1.5 * static_cast<double>(j - cols / 2);
        const double y = 1.5 * static_cast<double>(i - rows / 2);
        pad.free(i, j) = Vector{x, y, 12 - (x * x + y * y) / 40} + any_vector(0.1);
        const Vector& f = pad.free(i, j);
        pad.dots(i, j) = Vector{stretch_x * f.x, stretch_y * f.y, 1.1 * f.z} + any_vector(0.1);
        pad.contact(i, j) = std::hypot(x - 1, y + 1) < 3 ? 1 : 0;
      }
    }
    return pad;
  }
};

struct Seen {
  TractionResult<double> result;
  TractionField<> maps;
};

Seen look_with(const Pad& pad, const TractionOptions<>& options) {
  Seen seen{{}, TractionField<>(pad.free, options)};
  seen.result = seen.maps(pad.dots, pad.contact, pad.pressure);
  return seen;
}
Seen look(const Pad& pad, TractionOptions<> options = {}) {
  options.mu_t_n_per_mm = pad.mu_t;
  return look_with(pad, options);
}

/// Scale of the loads, for comparison.
double typical_load(const Pad& pad) {
  return pad.pressure + pad.mu_t;
}

template <class Map>
Dots mapped(Dots dots, const Map& map) {
  for (auto& p : dots.cells) {
    p = map(p);
  }
  return dots;
}

/// Asserts that the maps of b are those of a with map(load), `factor` times the contact pressure,
/// and dot (i, j) of a at place(i, j) in b.
template <class Map, class Place>
void assert_same(const Seen& a,
                 const Seen& b,
                 double tolerance,
                 const Map& map,
                 const Place& place,
                 double factor = 1) {
  for (Index i = 0; i < a.maps.rows(); ++i) {
    for (Index j = 0; j < a.maps.cols(); ++j) {
      const DotIndex at = place(i, j);
      const double p = a.maps.pressure_mpa()(i, j);
      const double q = b.maps.pressure_mpa()(at.row, at.col);
      RC_ASSERT(is_finite(p) == is_finite(q));
      if (is_finite(p)) {
        RC_ASSERT(std::abs(factor * p - q) <= tolerance);
        RC_ASSERT(distance(map(a.maps.load_mpa()(i, j)), b.maps.load_mpa()(at.row, at.col)) <=
                  tolerance);
      }
    }
  }
}
const auto same_place = [](Index i, Index j) { return DotIndex{i, j}; };

/// Asserts that all known values are finite and that the counts are those of the maps.
template <class S = double, class Field>
void assert_valid(const Pad& pad, Field field) {
  const auto r = field(pad.dots, pad.contact, static_cast<S>(pad.pressure));
  RC_ASSERT((r.status != TractionStatus::refused));
  const bool has_force = r.has_force();
  RC_ASSERT(has_force == is_finite(r.mu_t_n_per_mm));
  RC_ASSERT(is_finite(r.force_n) == has_force);
  RC_ASSERT(is_finite(r.moment_n_mm) == has_force);
  RC_ASSERT(is_finite(r.free_load_rms_mpa) == (has_force && r.free_dots > 0));
  Index loaded = 0;
  for (Index i = 0; i < pad.dots.rows(); ++i) {
    for (Index j = 0; j < pad.dots.cols(); ++j) {
      const bool known = is_finite(field.pressure_mpa()(i, j));
      RC_ASSERT(is_finite(field.load_mpa()(i, j)) == known);
      RC_ASSERT(is_finite(field.shear_mpa()(i, j)) == known);
      loaded += known ? 1 : 0;
    }
  }
  RC_ASSERT((loaded > 0) == has_force);
}

}  // namespace

TEST_CASE("traction turns and shifts with the dots", "[traction][law]") {
  rc::prop("load, force and moment", [] {
    const Pad pad = Pad::any();
    const Seen before = look(pad);
    RC_PRE(before.result.has_force());
    const Rotation<double> turn = test::turned_by(any_vector(1.5));
    const Vector shift = any_vector(20);
    Pad moved = pad;
    moved.dots = mapped(pad.dots, [&](const Vector& x) { return turn(x) + shift; });
    // the stress-free shape may lie anywhere: only its side toward +z matters
    const Rotation<double> other = test::turned_by(any_vector(0.5));
    moved.free = mapped(pad.free, [&](const Vector& x) { return other(x) + shift; });
    const Seen after = look(moved);
    const double small = 1e-11 * typical_load(pad);
    assert_same(
        before, after, small, [&](const Vector& q) { return turn(q); }, same_place);
    const Vector force = turn(before.result.force_n);
    const Vector moment = turn(before.result.moment_n_mm) + cross(shift, force);
    RC_ASSERT(distance(after.result.force_n, force) <= 1000 * small);
    RC_ASSERT(distance(after.result.moment_n_mm, moment) <= 1e5 * small);
  });
}

TEST_CASE("traction of a mirror image is the mirror image", "[traction][law]") {
  rc::prop("load, force and moment", [] {
    const Pad pad = Pad::any();
    const Seen before = look(pad);
    RC_PRE(before.result.has_force());
    const auto mirror = [](const Vector& x) { return Vector{-x.x, x.y, x.z}; };
    Pad image = pad;
    image.dots = mapped(pad.dots, mirror);
    image.free = mapped(pad.free, mirror);
    const Seen after = look(image);
    const double small = 1e-11 * typical_load(pad);
    assert_same(before, after, small, mirror, same_place);
    const Vector m = before.result.moment_n_mm;
    RC_ASSERT(distance(after.result.moment_n_mm, {m.x, -m.y, -m.z}) <= 1e5 * small);
  });
}

TEST_CASE("traction does not care how rows and columns run", "[traction][law]") {
  rc::prop("transposed, or last row first", [] {
    const Pad pad = Pad::any();
    const Seen before = look(pad);
    RC_PRE(before.result.has_force());
    const bool transposed = test::whole(0, 1) == 1;
    const Index rows = pad.dots.rows(), cols = pad.dots.cols();
    const auto place = [&](Index i, Index j) {
      return transposed ? DotIndex{j, i} : DotIndex{rows - 1 - i, j};
    };
    Pad other{transposed ? Dots(cols, rows) : Dots(rows, cols),
              transposed ? Dots(cols, rows) : Dots(rows, cols),
              transposed ? Flags(cols, rows) : Flags(rows, cols), pad.pressure, pad.mu_t};
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const DotIndex at = place(i, j);
        other.free(at.row, at.col) = pad.free(i, j);
        other.dots(at.row, at.col) = pad.dots(i, j);
        other.contact(at.row, at.col) = pad.contact(i, j);
      }
    }
    const Seen after = look(other);
    const double small = 1e-11 * typical_load(pad);
    assert_same(
        before, after, small, [](const Vector& q) { return q; }, place);
    RC_ASSERT(distance(after.result.force_n, before.result.force_n) <= 1000 * small);
    RC_ASSERT(distance(after.result.moment_n_mm, before.result.moment_n_mm) <= 1e5 * small);
    RC_ASSERT(after.result.status == before.result.status);
  });
}

TEST_CASE("traction is linear in pressure and mu t together", "[traction][law]") {
  rc::prop("the sum of two is the traction of the sums", [] {
    const Pad pad = Pad::any();
    Pad other = pad, both = pad;
    other.pressure = test::log_uniform(1e-3, 0.1);
    other.mu_t = test::log_uniform(0.05, 5);
    both.pressure += other.pressure;
    both.mu_t += other.mu_t;
    const Seen one = look(pad), two = look(other), sum = look(both);
    RC_PRE(one.result.has_force());
    const double small = 1e-11 * typical_load(both);
    for (Index i = 0; i < pad.dots.rows(); ++i) {
      for (Index j = 0; j < pad.dots.cols(); ++j) {
        const Vector& q = sum.maps.load_mpa()(i, j);
        RC_ASSERT(!is_finite(q.x) ||
                  distance(q, one.maps.load_mpa()(i, j) + two.maps.load_mpa()(i, j)) <= small);
      }
    }
    RC_ASSERT(distance(sum.result.force_n, one.result.force_n + two.result.force_n) <=
              1000 * small);
  });
}

TEST_CASE("the balanced mu t goes with the pressure", "[traction][law]") {
  rc::prop("and with it all loads", [] {
    const Pad pad = Pad::any();
    const TractionOptions<> balanced{.min_free_dots = 1, .max_pressure_mpa = 100};
    const Seen before = look_with(pad, balanced);
    RC_PRE(before.result.has_force());
    const double f = test::log_uniform(0.1, 10);
    Pad scaled = pad;
    scaled.pressure *= f;
    const Seen after = look_with(scaled, balanced);
    const double mu_t = before.result.mu_t_n_per_mm;
    RC_ASSERT(std::abs(after.result.mu_t_n_per_mm - f * mu_t) <= 1e-12 * f * mu_t);
    assert_same(
        before, after, 1e-10 * f * (pad.pressure + mu_t), [&](const Vector& q) { return f * q; },
        same_place, f);
    // with that mu t given, the result is the same
    const Seen given = look_with(pad, {.mu_t_n_per_mm = mu_t, .max_pressure_mpa = 100});
    RC_ASSERT(distance(given.result.force_n, before.result.force_n) <=
              1e-9 * (pad.pressure + mu_t));
  });
}

TEST_CASE("the sum of the loads is what crosses the border", "[traction][law]") {
  rc::prop("wherever the dots inside lie: action is reaction", [] {
    const Pad pad = Pad::any();
    const TractionOptions<> abrupt{.ring_dots = 1, .fade_dots = 0};
    const Seen before = look(pad, abrupt);
    RC_PRE(before.result.has_force() && before.result.dots_left_out == 0);
    Pad other = pad;
    Index moved = 0;
    for (Index i = 1; i + 1 < pad.dots.rows(); ++i) {
      for (Index j = 1; j + 1 < pad.dots.cols(); ++j) {
        if (pad.contact(i, j) != 0) {  // contact and ring include all its neighbours
          other.dots(i, j) = other.dots(i, j) + any_vector(0.2);
          ++moved;
        }
      }
    }
    RC_PRE(moved > 0);
    const Seen after = look(other, abrupt);
    RC_PRE(after.result.dots_left_out == 0);
    const double small = 1e-9 * typical_load(pad);
    RC_ASSERT(distance(after.result.force_n, before.result.force_n) <= small);
    RC_ASSERT(distance(after.result.moment_n_mm, before.result.moment_n_mm) <= 100 * small);
    RC_ASSERT(distance(after.maps.load_mpa()(pad.dots.rows() / 2, pad.dots.cols() / 2),
                       before.maps.load_mpa()(pad.dots.rows() / 2, pad.dots.cols() / 2)) > small);
  });
}

TEST_CASE("traction of anything at all", "[traction][law][fuzz]") {
  const double infinity = std::numeric_limits<double>::infinity();
  const double odd[] = {0,        -0.0,      1e-300,
                        1e300,    -1e15,     5e5,
                        infinity, -infinity, std::numeric_limits<double>::quiet_NaN(),
                        1e-12};
  rc::prop("valid fields are finite, and the counts agree", [&] {
    Pad pad = Pad::any();
    const auto spoil = [&](Dots& dots) {
      for (Index k = test::whole(0, 12); k > 0; --k) {
        Vector& p = dots(test::whole(0, dots.rows() - 1), test::whole(0, dots.cols() - 1));
        double& c = *(test::whole(0, 2) == 0 ? &p.x : test::whole(0, 1) == 0 ? &p.y : &p.z);
        c = test::whole(0, 2) == 0 ? test::uniform(-20, 20) : odd[test::whole(0, 9)];
      }
    };
    spoil(pad.dots);
    if (test::whole(0, 1) == 0) {
      spoil(pad.free);
    }
    for (auto& flag : pad.contact.cells) {
      flag = test::whole(0, 9) == 0 ? !flag : flag;
    }
    pad.pressure = test::whole(0, 4) == 0 ? odd[test::whole(0, 9)] : pad.pressure;
    const bool given = test::whole(0, 1) == 0;
    const auto options = [&, ring = test::whole(0, 5), fade = test::whole(0, 20)]<class S>(S) {
      TractionOptions<S> o{.min_free_dots = 1, .ring_dots = ring, .fade_dots = fade};
      if (given) {
        o.mu_t_n_per_mm = static_cast<S>(pad.mu_t);
      }
      return o;
    };
    assert_valid(pad, TractionField(pad.free, options(0.0)));
    assert_valid<float>(pad, TractionField<float>(pad.free, options(0.0F)));
  });
}

namespace {

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

TEST_CASE("traction: a frame allocates nothing", "[traction]") {
  const auto free = test::stress_free_dots();
  auto s = test::traction_scene("drag");
  TractionField given(free, {.mu_t_n_per_mm = 0.5});
  TractionField balanced(free);
  long taken = 0;
  for (int k = 0; k < 5; ++k) {
    s.dots(8 + k, 9).x = not_a_number<double>();
    const long before = test::allocations();
    (void)given(s.dots, s.contact, k == 3 ? -1.0 : s.pressure_mpa);
    (void)balanced(s.dots, s.contact, s.pressure_mpa);
    taken += test::allocations() - before;
  }
  CHECK(taken == 0);
}
