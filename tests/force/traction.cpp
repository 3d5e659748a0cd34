// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/traction.hpp"

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <string>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "support/catch.hpp"
#include "support/membrane_triangle.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"
#include "support/traction_scenes.hpp"

using namespace fingerpad;
using test::Dots;
using test::Flags;
using test::StressFreeTriangle;
using test::Triangle;
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
    const TractionField field(cap(n, pitch, radius, 1), {.mu_t_n_per_mm = mu_t});
    auto maps = field.maps();
    return field(cap(n, pitch, radius, stretch), Flags(n, n, 0), pressure(), maps)
               .free_load_rms_mpa /
           pressure();
  }
};

const Triangle<double> some_triangle = {Vector{0.1, -0.2, 0.3}, Vector{1.6, 0.1, 0.2},
                                        Vector{0.4, 1.3, -0.1}};
const Triangle<double> pulled_triangle = {Vector{0.0, -0.3, 0.2}, Vector{1.8, 0.4, 0.5},
                                          Vector{0.2, 1.7, 0.1}};

}  // namespace

TEST_CASE("membrane triangle: energy of a known deformation", "[traction]") {
  // stretched by a along x and b along y, then sheared, then placed anywhere in space
  const double a = 1.3, b = 0.9, shear = 0.4;
  const auto put = [&](double x, double y) {
    return Vector{a * x + shear * y, 0.6 * b * y, 0.8 * b * y};
  };
  const Triangle<double> free = {Vector{0, 0, 0}, Vector{1.5, 0, 0}, Vector{0.5, 1, 0}};
  const Triangle<double> now = {put(0, 0), put(1.5, 0), put(0.5, 1)};
  const auto reference = test::stress_free(free);
  CHECK(reference.area_mm2 == Approx(0.75));
  const double sq_sum = a * a + b * b + shear * shear;
  CHECK(test::stretch_sq_sum(reference, now) == Approx(sq_sum));
  CHECK(test::stored_energy(reference, now) ==
        Approx(0.75 * 0.5 * (sq_sum + 1 / (a * b * a * b) - 3)));
  CHECK(std::abs(test::stored_energy(reference, free)) < 1e-14);
}

TEST_CASE("membrane triangle: forces are the slope of the energy", "[traction]") {
  using D = test::Dual<double>;
  const auto reference = test::stress_free(some_triangle);
  const auto force = test::corner_forces(reference, pulled_triangle);
  StressFreeTriangle<D> dual;
  dual.area_mm2 = reference.area_mm2;
  for (std::size_t k = 0; k < 3; ++k) {
    dual.half_cotangent[k] = reference.half_cotangent[k];
  }
  Vector sum{0, 0, 0}, moment{0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto slope = [&](int axis) {
      Triangle<D> x;
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

TEST_CASE("dot cell: the pull is the mean over both diagonals", "[traction]") {
  using namespace detail::traction;
  const Corners<double> free = {Vector{0, 0, 0}, Vector{1.4, 0.1, 0.1}, Vector{1.5, 1.6, 0.3},
                                Vector{-0.1, 1.3, 0.2}};
  const Corners<double> now = {Vector{0, 0.1, 0.3}, Vector{1.8, 0.2, 0.1}, Vector{1.9, 1.6, 0.5},
                               Vector{-0.4, 1.6, 0.2}};
  const StressFreeCell<double> cell(free);
  REQUIRE(cell.usable);
  const auto pull = cell_pull(cell, now, StretchLimits<double>(5));
  REQUIRE(pull.sound);
  Corners<double> force{}, area{};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto corners = ear(now, k);
    const auto f = test::corner_forces(test::stress_free(ear(free, k)), corners);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = (k + 3 + c) % 4;
      force[at] = force[at] + 0.5 * f[c];
      area[at] = area[at] + 1.0 / 12 * twice_area_vector(corners);
    }
  }
  Vector sum{0, 0, 0};
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(distance(pull.force[k], force[k]) < 1e-14);
    CHECK(distance(pull.area[k], area[k]) < 1e-14);
    sum = sum + pull.area[k];
  }
  CHECK(distance(sum, pull.whole_area) < 1e-14);
}

TEST_CASE("dot cell: tension of known deformations", "[traction]") {
  using namespace detail::traction;
  const Corners<double> free = {Vector{0, 0, 0}, Vector{1.5, 0, 0}, Vector{2.0, 1.2, 0},
                                Vector{0.5, 1.2, 0}};
  const StressFreeCell<double> cell(free);
  const auto after = [&](const auto& map) {
    Corners<double> x;
    for (std::size_t k = 0; k < 4; ++k) {
      x[k] = map(free[k].x, free[k].y);
    }
    return cell_tension(cell, x);
  };
  SECTION("two stretches") {
    const double a = 1.2, b = 1.5, j = a * b;
    const auto t = after([&](double x, double y) { return Vector{a * x, 0, b * y}; });
    CHECK(t.larger == Approx((b * b - 1 / (j * j)) / j));
    CHECK(t.smaller == Approx((a * a - 1 / (j * j)) / j));
    CHECK(std::abs(t.direction.z) == Approx(1));
  }
  SECTION("simple shear: T = [[0, g], [g, g^2]]") {
    const double g = 0.3;
    const auto t = after([&](double x, double y) { return Vector{x, y + g * x, 0}; });
    const double root = std::sqrt(g * g + g * g * g * g / 4);
    CHECK(t.larger == Approx(g * g / 2 + root));
    CHECK(t.smaller == Approx(g * g / 2 - root));
    CHECK(t.smaller < 0);  // slack
    // the eigenvector of T
    CHECK(t.direction.y * g == Approx(t.larger * t.direction.x));
  }
  SECTION("alike in all directions") {
    const auto t = after([&](double x, double y) { return Vector{1.1 * x, 1.1 * y, 3}; });
    CHECK(t.larger == Approx(1 - std::pow(1.1, -6)));
    CHECK(t.smaller == Approx(t.larger));
    CHECK(size(t.direction) == Approx(1));
  }
}

TEST_CASE("traction: an inflated cap carries no load", "[traction]") {
  const Balloon b;
  const double coarse = b.load_rms(1.5), fine = b.load_rms(0.75), finer = b.load_rms(0.375);
  INFO("rms load by pressure: " << coarse << ", " << fine << ", " << finer);
  CHECK(coarse < 2e-3);
  CHECK(coarse / fine == Approx(4).epsilon(0.15));  // second order in the pitch
  CHECK(fine / finer == Approx(4).epsilon(0.15));

  const TractionField field(cap(13, 1.5, b.radius, 1));
  auto maps = field.maps();
  const auto r = field(cap(13, 1.5, b.radius, b.stretch), Flags(13, 13, 0), b.pressure(), maps);
  CHECK(r.status == TractionStatus::no_contact);
  CHECK(r.mu_t_n_per_mm == Approx(b.mu_t).epsilon(1e-3));
  CHECK(r.smallest_tension_n_per_mm == Approx(b.tension()).epsilon(1e-3));
  CHECK(maps.tension_n_per_mm()(6, 6).larger == Approx(b.tension()).epsilon(1e-3));
  CHECK(b.tension() == Approx(b.pressure() * b.radius * b.stretch / 2));
  CHECK(size(r.force_n) == 0);
  CHECK(size(r.moment_n_mm) == 0);
  CHECK(r.cells_slack == 0);
}

TEST_CASE("traction: a stretched sheet on a plate is pressed by p", "[traction]") {
  const Index n = 9;
  const TractionField field(flat(n, 1.5), {.mu_t_n_per_mm = 0.4, .fade_dots = 0});
  auto maps = field.maps();
  const double p = 0.02;
  const auto on_plate = sheet(n, 1.5, [](double x, double y) {
    return Vector{1.2 * x + 0.1 * y, 1.1 * y, 9};
  });
  const auto r = field(on_plate, touch(n, 3, 5), p, maps);
  REQUIRE(r.status == TractionStatus::ok);
  CHECK(r.dots_loaded == 49);
  CHECK(r.dots_summed == 25);
  for (Index i = 1; i + 1 < n; ++i) {
    for (Index j = 1; j + 1 < n; ++j) {
      CHECK(maps.pressure_mpa()(i, j) == Approx(p));
      CHECK(size(maps.shear_mpa()(i, j)) < 1e-14);
      CHECK(distance(maps.load_mpa()(i, j), Vector{0, 0, -p}) < 1e-14);
      CHECK(maps.area_mm2()(i, j).z == Approx(1.2 * 1.1 * 2.25));
    }
  }
  CHECK(distance(r.force_n, Vector{0, 0, -p * 25 * 1.2 * 1.1 * 2.25}) < 1e-12);
  CHECK(std::isnan(maps.pressure_mpa()(0, 3)));  // dots at the edge of the grid have no load

  // a cell's tension is that of the four dots around it, up to the last cell
  auto corner = on_plate;
  corner(n - 1, n - 1) = corner(n - 1, n - 1) + Vector{0.3, 0.3, 0};
  (void)field(corner, touch(n, 3, 5), p, maps);
  const auto tension = maps.tension_n_per_mm();
  REQUIRE(tension.rows() == n - 1);
  REQUIRE(tension.cols() == n - 1);
  const double even = tension(0, 0).larger;
  for (Index i = 0; i + 1 < n; ++i) {
    for (Index j = 0; j + 1 < n; ++j) {
      const bool is_last = i + 2 == n && j + 2 == n;
      CAPTURE(i, j);
      CHECK((std::abs(tension(i, j).larger - even) < 1e-12) == !is_last);
    }
  }
}

TEST_CASE("traction: shear that grows along x is held by the object", "[traction]") {
  // u_y = a x^2 / 2: T_xy = mu t a x, so q_y = -mu t a; the area stays
  const double a = 0.02, mu_t = 0.5, p = 0.02;
  const Index n = 9;
  const TractionField field(flat(n, 1.5), {.mu_t_n_per_mm = mu_t});
  auto maps = field.maps();
  const auto dots = sheet(n, 1.5, [&](double x, double y) {
    return Vector{x, y + a * x * x / 2, 9};
  });
  const auto r = field(dots, touch(n, 2, 6), p, maps);
  REQUIRE(r.ok());
  for (Index i = 1; i + 1 < n; ++i) {
    for (Index j = 1; j + 1 < n; ++j) {
      CHECK(distance(maps.shear_mpa()(i, j), Vector{0, -mu_t * a, 0}) < 1e-14);
      CHECK(maps.pressure_mpa()(i, j) == Approx(p));
    }
  }
}

TEST_CASE("traction: moment about the origin", "[traction]") {
  const Index n = 9;
  const TractionField field(flat(n, 1), {.mu_t_n_per_mm = 0.4, .ring_dots = 0, .fade_dots = 0});
  auto maps = field.maps();
  auto dots = flat(n, 1);
  for (auto& p : dots.cells) {
    p = p + Vector{3, 5, 10};
  }
  const double p = 0.02;
  const auto r = field(dots, touch(n, 4, 4), p, maps);
  REQUIRE(r.has_force());
  CHECK(distance(r.force_n, Vector{0, 0, -p}) < 1e-14);
  CHECK(distance(r.moment_n_mm, Vector{-5 * p, 3 * p, 0}) < 1e-14);
}

TEST_CASE("traction: the ring and what fades out", "[traction]") {
  // loads are equal everywhere, so the force counts weights: 1 in contact and in the ring, then 2/3
  // and 1/3
  const Index n = 15;
  const double p = 0.01;
  const TractionField field(flat(n, 1), {.mu_t_n_per_mm = 0.4, .ring_dots = 1, .fade_dots = 2});
  auto maps = field.maps();
  auto dots = flat(n, 1);
  for (auto& x : dots.cells) {
    x.z = 9;
  }
  auto r = field(dots, touch(n, 7, 7), p, maps);
  REQUIRE(r.has_force());
  CHECK(-r.force_n.z / p == Approx(9 + 16 * 2.0 / 3 + 24 * 1.0 / 3));
  CHECK(r.dots_summed == 49);
  CHECK(r.balance.dots == 169 - 9);
  r = field(dots, touch(n, 1, 1), p, maps);  // its ring touches the edge of the grid
  CHECK(r.status == TractionStatus::incomplete);
  CHECK(r.dots_left_out == 5);
  r = field(dots, touch(n, 2, 2), p, maps);  // only the fading part would lie there
  CHECK(r.status == TractionStatus::modulus_not_of_this_pad);
}

TEST_CASE("traction: a dot that is not found", "[traction]") {
  const auto s = test::traction_scene("drag");
  const auto free = test::stress_free_dots();
  const TractionField field(free, {.mu_t_n_per_mm = 0.5});
  auto maps = field.maps();
  const auto whole = field(s.dots, s.contact, s.pressure_mpa, maps);
  REQUIRE(whole.ok());
  const auto before = maps;

  auto holed = s.dots;
  holed(10, 11).y = missing;
  const auto r = field(holed, s.contact, s.pressure_mpa, maps);
  CHECK(r.ok());
  CHECK(r.dots_bridged == 1 + whole.dots_bridged);
  CHECK(r.dots_loaded == whole.dots_loaded - 9);
  for (Index i = 0; i < 21; ++i) {
    for (Index j = 0; j < 21; ++j) {
      const bool near = std::abs(i - 10) <= 1 && std::abs(j - 11) <= 1;
      CAPTURE(i, j);
      CHECK(is_finite(maps.pressure_mpa()(i, j)) ==
            (is_finite(before.pressure_mpa()(i, j)) && !near));
      if (is_finite(maps.pressure_mpa()(i, j))) {
        CHECK(maps.pressure_mpa()(i, j) == before.pressure_mpa()(i, j));
        CHECK(distance(maps.load_mpa()(i, j), before.load_mpa()(i, j)) == 0);
      }
    }
  }
  // the position of a dot inside the contact does not matter
  CHECK(distance(r.force_n, whole.force_n) < 1e-13);
  CHECK(distance(r.moment_n_mm, whole.moment_n_mm) < 1e-12);

  // two adjacent missing dots are interpolated from the dots across; four by four leave a hole
  holed(10, 12).y = missing;
  const auto two = field(holed, s.contact, s.pressure_mpa, maps);
  CHECK(two.ok());
  CHECK(distance(two.force_n, whole.force_n) < 1e-13);
  for (Index i = 9; i <= 12; ++i) {
    for (Index j = 9; j <= 12; ++j) {
      holed(i, j).x = missing;
    }
  }
  const auto hole = field(holed, s.contact, s.pressure_mpa, maps);
  CHECK(hole.status == TractionStatus::incomplete);
  CHECK(hole.dots_left_out > 0);

  // on the free part it leaves no significant gap in the sums
  auto free_hole = s.dots;
  free_hole(3, 10).x = missing;
  const auto outside = field(free_hole, s.contact, s.pressure_mpa, maps);
  CHECK(outside.ok());
  CHECK(distance(outside.force_n, whole.force_n) < 0.01 * size(whole.force_n));
}

TEST_CASE("traction: a dot that is not found lies between opposite neighbours", "[traction]") {
  const auto at = [](Index i, Index j) {
    return Vector{static_cast<double>(j), static_cast<double>(i), static_cast<double>(i * j)};
  };
  for (const auto& [i, j] : {std::pair<Index, Index>{0, 1}, {1, 0}, {1, 1}, {1, -1}}) {
    for (int found = 0; found < 4; ++found) {  // on either side
      const auto is_found = [&, i = i, j = j](Index row, Index col) {
        return (row == 5 + i && col == 7 + j && (found & 1) != 0) ||
               (row == 5 - i && col == 7 - j && (found & 2) != 0);
      };
      const auto dot = detail::traction::bridged_dot<double>(5, 7, is_found, at);
      CAPTURE(i, j, found);
      if (found == 3) {
        CHECK(dot.x == 7);
        CHECK(dot.y == 5);
      } else {
        CHECK(std::isnan(dot.x));
      }
    }
  }
}

TEST_CASE("traction: dots that are no membrane", "[traction]") {
  const Index n = 9;
  const TractionField field(flat(n, 1.5), {.mu_t_n_per_mm = 0.4});
  auto maps = field.maps();
  auto dots = flat(n, 1.5);
  for (auto& x : dots.cells) {
    x = {1.1 * x.x, 1.1 * x.y, 9};
  }
  const Flags contact = touch(n, 4, 4);
  const auto good = field(dots, contact, 0.02, maps);
  REQUIRE(good.has_force());
  CHECK(good.cells_refused == 0);
  SECTION("two exchanged") {
    std::swap(dots(4, 4), dots(4, 5));
    const auto r = field(dots, contact, 0.02, maps);
    CHECK(r.cells_refused >= 2);
    CHECK(r.status == TractionStatus::incomplete);
    CHECK(std::isnan(maps.pressure_mpa()(4, 4)));
    CHECK(maps.pressure_mpa()(1, 1) == Approx(0.02));
  }
  SECTION("two rows exchanged: no cell is folded, but the membrane is") {
    for (Index j = 0; j < n; ++j) {
      std::swap(dots(4, j), dots(5, j));
    }
    const auto r = field(dots, contact, 0.02, maps);
    CHECK(r.cells_refused == 0);
    CHECK(r.status == TractionStatus::incomplete);
    CHECK(std::isnan(maps.pressure_mpa()(4, 4)));
    CHECK(std::isnan(maps.pressure_mpa()(5, 4)));
  }
  SECTION("two at the same place") {
    dots(4, 4) = dots(4, 5);
    dots(5, 4) = dots(5, 5);
    const auto r = field(dots, contact, 0.02, maps);
    CHECK(r.cells_refused >= 1);
    CHECK(std::isnan(maps.pressure_mpa()(4, 4)));
  }
  SECTION("far away") {
    dots(4, 4).z = 60;
    const auto r = field(dots, contact, 0.02, maps);
    CHECK(r.cells_refused == 4);
    CHECK(r.dots_loaded == 49 - 9);
    CHECK(std::isnan(maps.tension_n_per_mm()(3, 3).larger));
  }
  SECTION("beyond measure") {
    dots(4, 4).z = 1e200;
    CHECK(field(dots, contact, 0.02, maps).dots_bridged == 1);
  }
}

TEST_CASE("traction: statuses", "[traction]") {
  const Index n = 9;
  const Dots free = flat(n, 1.5);
  Dots dots = sheet(n, 1.5, [](double x, double y) {
    return Vector{1.1 * x, 1.1 * y, 9 - 0.02 * (x * x + y * y)};
  });
  const TractionField balanced(free);
  auto maps = balanced.maps();
  const Flags none(n, n, 0);
  const Flags middle = touch(n, 4, 4);
  const double mu_t = balanced(dots, middle, 0.02, maps).mu_t_n_per_mm;
  const TractionField given(free, {.mu_t_n_per_mm = mu_t});

  for (const double p : {0.0, -0.01, missing, std::numeric_limits<double>::infinity()}) {
    const auto r = given(dots, middle, p, maps);
    CHECK(r.status == TractionStatus::bad_pressure);
    CHECK(!r.has_force());
    CHECK(std::isnan(r.force_n.x));
    CHECK(std::isnan(maps.pressure_mpa()(4, 4)));
    CHECK(std::isnan(maps.tension_n_per_mm()(4, 4).larger));
  }
  CHECK(given(dots, none, 0.02, maps).status == TractionStatus::no_contact);
  CHECK(given(dots, middle, 0.02, maps).status == TractionStatus::ok);
  for (const auto& [share, said] : {std::pair{0.88, TractionStatus::modulus_not_of_this_pad},
                                    {0.95, TractionStatus::ok},
                                    {1.05, TractionStatus::ok},
                                    {1.13, TractionStatus::modulus_not_of_this_pad}}) {
    const TractionField off(free, {.mu_t_n_per_mm = share * mu_t});
    CHECK(off(dots, middle, 0.02, maps).status == said);
    CHECK(off(dots, middle, 0.02, maps).has_force());
  }
  CHECK(balanced(dots, middle, 0.02, maps).status == TractionStatus::ok);
  CHECK(balanced(dots, touch(n, 2, 6), 0.02, maps).status == TractionStatus::no_balance);
  CHECK(std::isnan(maps.pressure_mpa()(4, 4)));
  const Dots hollow = sheet(n, 1.5, [](double x, double y) {
    return Vector{1.1 * x, 1.1 * y, 9 + 0.02 * (x * x + y * y)};
  });
  CHECK(balanced(hollow, none, 0.02, maps).status == TractionStatus::no_balance);
  CHECK(given(test::no_dots(n, n), middle, 0.02, maps).status == TractionStatus::too_few_dots);

  CHECK(given(flat(8, 1.5), middle, 0.02, maps).status == TractionStatus::refused);
  CHECK(given(dots, touch(10, 4, 4), 0.02, maps).status == TractionStatus::refused);
  auto other = TractionField(flat(8, 1.5)).maps();
  CHECK(given(dots, middle, 0.02, other).status == TractionStatus::refused);

  CHECK(name_of(TractionStatus::ok) == std::string("ok"));
  CHECK(name_of(TractionStatus::no_contact) == std::string("no contact"));
  CHECK(name_of(TractionStatus::incomplete) == std::string("incomplete"));
  CHECK(name_of(TractionStatus::bad_pressure) == std::string("bad pressure"));
  CHECK(name_of(TractionStatus::too_few_dots) == std::string("too few dots"));
  CHECK(name_of(TractionStatus::no_balance) == std::string("no balance"));
  CHECK(name_of(static_cast<TractionStatus>(77)) == std::string("unknown"));
}

TEST_CASE("traction: slack membrane is reported", "[traction]") {
  const Index n = 9;
  const TractionField field(flat(n, 1.5), {.mu_t_n_per_mm = 0.4});
  auto maps = field.maps();
  const auto dots = sheet(n, 1.5, [](double x, double y) { return Vector{1.2 * x, 0.8 * y, 9}; });
  const auto r = field(dots, touch(n, 4, 4), 0.02, maps);
  CHECK(r.has_force());
  CHECK(r.cells_slack == 64);
  CHECK(r.smallest_tension_n_per_mm < 0);
  CHECK(maps.tension_n_per_mm()(2, 2).larger > 0);
  CHECK(std::abs(maps.tension_n_per_mm()(2, 2).direction.x) == Approx(1));
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
  CHECK(test::begins_with(with({.largest_stretch = 1}), "TractionOptions: largest_stretch = 1,"));
  CHECK(
      test::begins_with(with({.largest_stretch = missing}), "TractionOptions: largest_stretch ="));
  const auto modulus = [&](double mu_t) {
    return test::refusal([&] { TractionField(free, {.mu_t_n_per_mm = mu_t}); });
  };
  CHECK(modulus(0.5) == "accepted");
  CHECK(test::begins_with(modulus(0), "TractionOptions: mu_t_n_per_mm = 0, must be"));
  CHECK(test::begins_with(modulus(missing), "TractionOptions: mu_t_n_per_mm = "));
  CHECK(test::begins_with(with({.min_free_dots = 0}), "TractionOptions: min_free_dots = 0, must"));
  CHECK(test::begins_with(test::refusal([] { TractionField(Dots(2, 5)); }),
                          "TractionField: rows = 2, must be"));
  CHECK(test::begins_with(test::refusal([] { TractionField(Dots(5, 2)); }),
                          "TractionField: cols = 2, must be"));
}

TEST_CASE("traction: derivatives with respect to the pressure", "[traction]") {
  using D = test::Dual<double>;
  const auto s = test::traction_scene("tilt");
  const TractionField<D> field(test::stress_free_dots(), {.mu_t_n_per_mm = D(0.5)});
  auto maps = field.maps();
  const auto r = field(s.dots, s.contact, D(s.pressure_mpa, 1), maps);
  REQUIRE(r.ok());
  const TractionField plain(test::stress_free_dots(), {.mu_t_n_per_mm = 0.5});
  auto m = plain.maps();
  const auto up = plain(s.dots, s.contact, s.pressure_mpa + 1e-3, m);
  const auto down = plain(s.dots, s.contact, s.pressure_mpa - 1e-3, m);
  CHECK(r.force_n.z.d == Approx((up.force_n.z - down.force_n.z) / 2e-3));
  CHECK(maps.pressure_mpa()(10, 10).d == Approx(1));
}

TEST_CASE("traction: least squares would err where the balance does not", "[traction]") {
  // Noise adds to the square of the pulls, but not to the pulls along the normals, which the
  // balance uses.
  const Balloon b;
  const Index n = 13;
  const TractionField field(cap(n, 1.5, b.radius, 1), {.mu_t_n_per_mm = b.mu_t});
  auto maps = field.maps();
  test::Gauss gauss(2);
  double along = 0, square_sum = 0;
  detail::traction::ModulusBalance<double> balance;
  for (int k = 0; k < 30; ++k) {
    const auto dots = test::noisy(cap(n, 1.5, b.radius, b.stretch), 0.02, gauss);
    balance += field(dots, Flags(n, n, 0), b.pressure(), maps).balance;
    for (Index i = 1; i + 1 < n; ++i) {
      for (Index j = 1; j + 1 < n; ++j) {
        // pull for mu t = 1 N/mm: the load without the pressure
        const Vector& area = maps.area_mm2()(i, j);
        const Vector pull =
            -1 / b.mu_t * (size(area) * maps.load_mpa()(i, j) + b.pressure() * area);
        along -= b.pressure() * dot(pull, area);
        square_sum += squared_norm(pull);
      }
    }
  }
  INFO("least squares " << along / square_sum << ", balance " << balance.mu_t_n_per_mm());
  CHECK(along / square_sum < 0.7 * b.mu_t);
  CHECK(balance.mu_t_n_per_mm() == Approx(b.mu_t).epsilon(0.02));
}
