// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/published/object_motion.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/rolling.hpp"

using namespace fingerpad;
using published::basis_around;
using published::rotation_between;
using test::degree;
using test::Digits50;
using test::Dots;
using test::error_deg;
using test::Flags;
using test::rotated;
using test::small_grid;

namespace {

using Vector = Point3<double>;

template <class S>
using Nine = std::array<Point3<S>, 9>;

template <class S>
Rotation<S> basis(const Nine<S>& dots) {
  return basis_around<S>(
      [&](Index i, Index j) { return dots[static_cast<std::size_t>(3 * i + j)]; });
}
template <class S>
Rotation<S> turn(const Nine<S>& before, const Nine<S>& now) {
  return rotation_between(basis(before), basis(now));
}

/// Nine dots 1.5 mm apart on a ball of 18 mm.
Nine<double> nine_dots() {
  Nine<double> n;
  for (std::size_t k = 0; k < 9; ++k) {
    const double x = 1.5 * static_cast<double>(k % 3) - 1.5;
    const double y = 1.5 * static_cast<double>(k / 3) - 1.5;
    n[k] = {x, y, 10 + (x * x + y * y) / 36};
  }
  return n;
}
Nine<double> rotated(Nine<double> n, const Rotation<double>& r) {
  for (auto& p : n) {
    p = r(p);
  }
  return n;
}

/// Error after 300 small rotations of an object that carries all dots. turn(k) is the
/// rotation vector of step k.
template <class Turn>
double path_error_deg(const Turn& turn) {
  const Dots free = small_grid();
  const Flags contact(7, 7, 1);
  published::ObjectMotion motion(free);
  Pose<double> pose;
  auto result = motion(free, contact);
  for (int k = 0; k < 300; ++k) {
    pose = Pose<double>{test::turned_by(turn(k)), {0, 0, 0}} * pose;
    result = motion(rotated(free, pose), contact);
  }
  return error_deg(result.pose.rotation, pose.rotation);
}

/// Whether the error prints with these digits, to slightly more than half a unit of the last one.
bool prints_as(double error, const char* digits) {
  const std::string text(digits);
  const auto point = text.find('.');
  const double unit = std::pow(10.0, -static_cast<double>(text.size() - point - 1));
  return std::abs(error - std::stod(text)) <= 0.51 * unit;
}

}  // namespace

TEST_CASE("published object motion: each dot around counts as much as the others (eqs. 14, 15)") {
  rc::prop("a step of any dot turns the two columns by its share of the side's length", [] {
    const auto dots = nine_dots();
    const auto at = static_cast<std::size_t>(test::whole(0, 8));
    const Index row = static_cast<Index>(at / 3) - 1, col = static_cast<Index>(at % 3) - 1;
    const Vector step = {0, 0, test::uniform(-0.3, 0.3)};
    auto moved = dots;
    moved[at] += step;
    const auto b = basis(moved);
    // the sides of the free dots are 9 mm long: 3 rows, each over two pitches of 1.5 mm
    const Vector n_1 = normalized(Vector{9, 0, static_cast<double>(col) * step.z});
    const Vector n_2 = normalized(Vector{0, 9, static_cast<double>(row) * step.z});
    RC_ASSERT(norm(Vector{b.m[0][0], b.m[1][0], b.m[2][0]} - n_1) < 1e-12);
    RC_ASSERT(norm(Vector{b.m[0][1], b.m[1][1], b.m[2][1]} - n_2) < 1e-12);
  });
}

TEST_CASE("published object motion: the basis as printed and as repaired (E021, E022, E023)") {
  const auto k = nine_dots();
  const Rotation<double> true_turn =
      rotation_of(Angles<double>{20.6 * degree, 8.9 * degree, 6.7 * degree});
  const auto l = rotated(k, true_turn);
  CHECK(error_deg(turn(k, l), true_turn) < 1e-12);

  // Eq. 17 with the vectors as rows: N_l^T = R N_k^T. It holds only for an upright frame and gives
  // the inverse rotation.
  const auto rows_of = [](const Nine<double>& n) {
    const auto b = basis(n);
    Eigen::Matrix3d m;
    for (int i = 0; i < 9; ++i) {
      m(i / 3, i % 3) = b.m[i % 3][i / 3];
    }
    return m;
  };
  const Eigen::Matrix3d printed = rows_of(l) * rows_of(k).inverse();
  Rotation<double> rows_form;
  for (int i = 0; i < 9; ++i) {
    rows_form.m[i / 3][i % 3] = printed(i / 3, i % 3);
  }
  CHECK(error_deg(rows_form, inverse(true_turn)) < 1e-12);
  CHECK(error_deg(rows_form, true_turn) > 40);

  // A shear of the neighbourhood, as in a skin under traction.
  for (const auto& [shear, basis_deg] :
       {std::pair{0.02, 0.58}, {0.05, 1.45}, {0.1, 2.9}, {0.2, 5.7}}) {
    auto sheared = k;
    for (auto& p : sheared) {
      p.x += shear * p.y;
    }
    // the nearest rotation to such a shear is by atan(shear / 2)
    const Rotation<double> nearest = test::turned_by({0, 0, -std::atan(shear / 2)});
    CAPTURE(shear);
    const auto found = turn(k, sheared);
    CHECK(error_deg(rotation_of(zyx_angles(found)), nearest) == Approx(basis_deg).epsilon(0.05));
    const Rotation<double> square = inverse(found) * found;
    double off = 0;
    for (int i = 0; i < 9; ++i) {
      off += fingerpad::square(square.m[i / 3][i % 3] - (i % 4 == 0 ? 1 : 0));
    }
    CHECK(std::sqrt(off) == Approx(1.41 * shear).epsilon(0.1));
  }
}

TEST_CASE("published object motion: summed angles err as the table says (E024)") {
  struct Path {
    const char* error_deg;
    std::function<Vector(int)> turn;
  };
  const auto about = [](Vector axis, double angle_deg) {
    const double s = angle_deg * degree / 300 / std::sqrt(squared_norm(axis));
    return [=](int) { return s * axis; };
  };
  const auto then = [](Vector first, Vector second, double angle_deg) {
    return [=](int k) { return angle_deg * degree / 150 * (k < 150 ? first : second); };
  };
  const auto circle = [](double radius_deg) {
    return [=](int k) {
      const double step = 2 * std::numbers::pi / 300;
      const double phi = step * (k + 0.5);
      return Vector{-radius_deg * degree * step * std::sin(phi),
                    radius_deg * degree * step * std::cos(phi), 0};
    };
  };
  const Vector x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const std::vector<Path> paths = {{"0.000", about(x, 90)},
                                   {"0.000", about(y, 80)},
                                   {"0.000", about(z, 90)},
                                   {"0.44", then(y, x, 5)},
                                   {"1.74", then(y, x, 10)},
                                   {"6.91", then(y, x, 20)},
                                   {"15.4", then(y, x, 30)},
                                   {"26.9", then(y, x, 40)},
                                   {"0.000", then(x, y, 40)},
                                   {"0.43", about({1, 1, 0}, 10)},
                                   {"3.9", about({1, 1, 0}, 30)},
                                   {"15.2", about({1, 1, 0}, 60)},
                                   {"0.51", about({1, 1, 1}, 10)},
                                   {"4.6", about({1, 1, 1}, 30)},
                                   {"18.5", about({1, 1, 1}, 60)},
                                   {"1.37", circle(5)},
                                   {"5.4", circle(10)},
                                   {"21.3", circle(20)},
                                   {"46.4", circle(30)}};
  for (const Path& path : paths) {
    const double summed = path_error_deg(path.turn);
    CAPTURE(path.error_deg, summed);
    CHECK(prints_as(summed, path.error_deg));
  }
}

TEST_CASE("published object motion: the contact reference dot") {
  const Dots free = small_grid();
  Flags contact(7, 7, 1);
  published::ObjectMotion motion(free);
  Dots dots = rotated(free, {{}, {0, 0, -1}});
  SECTION("of equal displacements the first in the order of rows") {
    CHECK(motion(dots, contact).reference == DotIndex{1, 1});
  }
  SECTION("the one that has moved most, whichever it is") {
    for (Index k = 0; k < 25; ++k) {
      const DotIndex most = {1 + k / 5, 1 + k % 5};
      auto moved = dots;
      moved(most.row, most.col).z -= 1;
      published::ObjectMotion fresh(free);
      CHECK(fresh(moved, contact).reference == most);
    }
  }
  SECTION("never on the border of the grid, which lacks neighbours") {
    dots(0, 3).z -= 1;
    dots(3, 6).z -= 1;
    CHECK(motion(dots, contact).reference == DotIndex{1, 1});
  }
  SECTION("only in contact, and with all neighbours found") {
    dots(3, 3).z -= 1;
    for (Index i = 0; i < 7; ++i) {  // further ones may be missing
      for (Index j = 0; j < 7; ++j) {
        const bool neighbour = std::abs(i - 3) < 2 && std::abs(j - 3) < 2;
        auto few = dots;
        few(i, j).x = neighbour ? few(i, j).x : std::nan("");
        published::ObjectMotion fresh(free);
        CAPTURE(i, j);
        CHECK(fresh(few, contact).reference == DotIndex{3, 3});
      }
    }
    CHECK(motion(dots, contact).reference == DotIndex{3, 3});
    contact(3, 3) = 0;
    CHECK(motion(dots, contact).reference == DotIndex{1, 1});
    contact(3, 3) = 1;
    dots(2, 4).x = std::nan("");
    CHECK(motion(dots, contact).reference == DotIndex{1, 1});
  }
}

TEST_CASE("published object motion: the displacement is that of the contact reference dot") {
  const Dots free = small_grid();
  const Flags contact(7, 7, 1);
  const auto corner_moved = [&](const Vector& by) {
    Dots dots = free;
    for (Index k = 0; k < 9; ++k) {
      dots(k / 3, k % 3) = dots(k / 3, k % 3) + by;
    }
    return dots;
  };
  published::ObjectMotion motion(free);
  REQUIRE(motion(corner_moved({0, 0, -1}), contact).reference == DotIndex{1, 1});
  const auto result = motion(corner_moved({0.3, 0.1, -1.2}), contact);
  REQUIRE(result.ok());
  CHECK(norm(result.displacement_mm - Vector{0.3, 0.1, -0.2}) < 1e-12);
}

TEST_CASE("published object motion: n_3 is the plain product of n_1 and n_2") {
  Nine<double> sheared;  // rows and columns that meet at 60 degrees
  for (std::size_t k = 0; k < 9; ++k) {
    const double col = static_cast<double>(k % 3), row = static_cast<double>(k / 3);
    sheared[k] = {1.5 * (col + row / 2), 1.5 * std::sqrt(0.75) * row, 0};
  }
  const auto n = basis(sheared);
  CHECK(norm(Vector{n.m[0][2], n.m[1][2], n.m[2][2]}) == Approx(std::sqrt(0.75)));
}

TEST_CASE("published object motion: a rolled ball, and what ends an object") {
  const test::RollingBall ball;
  test::Rolling roll(ball, -6, 1);
  published::ObjectMotion motion(ball.initial());
  const auto begin = motion(roll.dots, roll.contact);
  CHECK(begin.begun);
  const Vector start = roll.dots(begin.reference.row, begin.reference.col);
  int changes = 0;
  DotIndex before;
  published::ObjectMotionResult<double> result;
  for (int k = 1; k <= 60; ++k) {
    roll.step(-6 + 0.2 * k, 1 + 0.1 * k);
    result = motion(roll.dots, roll.contact);
    REQUIRE(result.ok());
    CHECK(!result.begun);
    // the pose turns about the first reference dot and carries it along
    CHECK(norm(result.pose(start) - start - result.displacement_mm) < 1e-12);
    changes += result.reference == before ? 0 : 1;
    before = result.reference;
  }
  CHECK(changes >= 8);
  CHECK(error_deg(result.pose.rotation, roll.pose.rotation) > 0.1);
  CHECK(error_deg(result.pose.rotation, roll.pose.rotation) < 10);
  // it waits for the nine dots, of which one is missing
  auto dots = roll.dots;
  dots(before.row, before.col + 1).x = std::nan("");
  CHECK_FALSE(motion(dots, roll.contact).ok());
  CHECK(motion(roll.dots, roll.contact).ok());
  // without contact the object is gone
  CHECK_FALSE(motion(roll.dots, Flags(21, 21, 0)).ok());
  const auto next = motion(roll.dots, roll.contact);
  CHECK(next.begun);
  CHECK(next.angles.x_rad == 0);
  CHECK_FALSE(motion(Dots(20, 21), Flags(20, 21, 1)).ok());
  auto copy = motion;
  roll.step(6.2, 7.1);
  CHECK(motion(roll.dots, roll.contact).angles.y_rad == copy(roll.dots, roll.contact).angles.y_rad);
}

TEST_CASE("published object motion: noise makes the dot flicker") {
  const test::RollingBall ball{.rows = 11, .cols = 31, .patch_mm = 5};
  double sum_sq = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::Gauss gauss(seed);
    published::ObjectMotion motion(ball.initial());
    test::Rolling roll(ball, -15, 0.3);
    auto result = motion(noisy(roll.dots, roll.contact, gauss), roll.contact);
    for (int k = 1; k <= 300; ++k) {
      roll.step(-15 + 30.0 * k / 300, 0.3);
      result = motion(noisy(roll.dots, roll.contact, gauss), roll.contact);
    }
    sum_sq += square(error_deg(result.pose.rotation, roll.pose.rotation));
  }
  CHECK(std::sqrt(sum_sq / 20) > 10);
}

TEST_CASE("published object motion: the rotation of nine dots", "[law]") {
  const auto any = [] {
    Nine<double> n;
    const double x0 = test::uniform(-15, 15), y0 = test::uniform(-15, 15);
    for (std::size_t k = 0; k < 9; ++k) {
      const double u = static_cast<double>(k % 3) - 1, v = static_cast<double>(k / 3) - 1;
      n[k] = {x0 + 1.5 * u + test::uniform(-0.2, 0.2), y0 + 1.5 * v + test::uniform(-0.2, 0.2),
              10 + 0.06 * (u * u + v * v) + test::uniform(-0.1, 0.1)};
    }
    return n;
  };
  const auto as = []<class To>(const Nine<double>& n, To) {
    Nine<To> out;
    for (std::size_t k = 0; k < 9; ++k) {
      out[k] = {To(n[k].x), To(n[k].y), To(n[k].z)};
    }
    return out;
  };
  rc::prop("there and back is the identity, and it follows 50 digits", [&] {
    const auto a = any(), b = any();
    const auto both = turn(b, a) * turn(a, b);
    const auto exact = turn(as(a, Digits50()), as(b, Digits50()));
    const auto found = turn(a, b);
    for (int i = 0; i < 9; ++i) {
      RC_ASSERT(std::abs(both.m[i / 3][i % 3] - (i % 4 == 0 ? 1 : 0)) < 1e-12);
      const Digits50 off = Digits50(found.m[i / 3][i % 3]) - exact.m[i / 3][i % 3];
      RC_ASSERT(std::abs(static_cast<double>(off)) < 1e-12);
    }
  });
}
