// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/published/object_motion.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "support/catch.hpp"
#include "support/rolling.hpp"

using namespace fingerpad;
using fingerpad::detail::motion::common_dots;
using fingerpad::detail::motion::CommonDots;
using fingerpad::detail::motion::grid_directions;
using fingerpad::detail::motion::Neighbourhood;
using fingerpad::detail::motion::published_basis;
using fingerpad::published::AnchoredComposition;
using fingerpad::published::PublishedBasis;
using fingerpad::published::SumOfAngles;
using fingerpad::published::SymmetricFrame;
using test::Dots;
using test::Flags;

namespace {

constexpr double degree = std::numbers::pi / 180;
using Vector = Point3<double>;

Neighbourhood<double> rotated(Neighbourhood<double> n, const Rotation<double>& r) {
  for (auto& p : n.dot) {
    p = r(p);
  }
  return n;
}

Dots rotated(Dots dots, const Pose<double>& pose) {
  for (auto& p : dots.cells) {
    p = pose(p);
  }
  return dots;
}

Dots small_grid() {
  return test::RollingBall{.rows = 7, .cols = 7}.initial();
}

double error_deg(const Rotation<double>& a, const Rotation<double>& b) {
  return angle_between(a, b) / degree;
}

/// Error of a method after 300 small rotations of an object that carries all dots. turn(k) is the
/// rotation vector of step k.
template <class Way, class Turn>
double path_error_deg(const Turn& turn) {
  const Dots free = small_grid();
  const Flags contact(7, 7, 1);
  const ObjectMotion<Way> motion(free);
  auto state = motion.start();
  Pose<double> pose;
  auto result = motion(free, contact, state);
  for (int k = 0; k < 300; ++k) {
    pose = Pose<double>{test::turned_by(turn(k)), {0, 0, 0}} * pose;
    result = motion(rotated(free, pose), contact, state);
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

TEST_CASE("object motion: the published basis as printed and as repaired (E021, E022, E023)") {
  const auto k = test::nine_dots();
  const Rotation<double> true_turn =
      rotation_of(Angles<double>{20.6 * degree, 8.9 * degree, 6.7 * degree});
  const auto l = rotated(k, true_turn);
  CHECK(error_deg(PublishedBasis::turn(k, l).rotation, true_turn) < 1e-12);

  // Eq. 17 with the vectors as rows: N_l^T = R N_k^T. It holds only for an upright frame and gives
  // the inverse rotation.
  const auto rows_of = [](const Neighbourhood<double>& n) {
    const auto b = published_basis(grid_directions(n, common_dots(n, n)));
    Eigen::Matrix3d m;
    m << b.n1.x, b.n1.y, b.n1.z, b.n2.x, b.n2.y, b.n2.z, b.n3.x, b.n3.y, b.n3.z;
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
    for (auto& p : sheared.dot) {
      p.x += shear * p.y;
    }
    // the nearest rotation to such a shear is by atan(shear / 2)
    const Rotation<double> nearest = test::turned_by({0, 0, -std::atan(shear / 2)});
    CAPTURE(shear);
    CHECK(error_deg(SymmetricFrame::turn(k, sheared).rotation, nearest) < 0.06);
    const auto published = PublishedBasis::turn(k, sheared).rotation;
    CHECK(error_deg(rotation_of(zyx_angles(published)), nearest) ==
          Approx(basis_deg).epsilon(0.05));
    const Rotation<double> square = inverse(published) * published;
    double off = 0;
    for (int i = 0; i < 9; ++i) {
      off += fingerpad::square(square.m[i / 3][i % 3] - (i % 4 == 0 ? 1 : 0));
    }
    CHECK(std::sqrt(off) == Approx(1.41 * shear).epsilon(0.1));
  }
}

TEST_CASE("object motion: summed angles err as the table says, composed rotations do not (E024)") {
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
    const double summed = path_error_deg<SumOfAngles<>>(path.turn);
    CAPTURE(path.error_deg, summed);
    CHECK(prints_as(summed, path.error_deg));
    CHECK(path_error_deg<AnchoredComposition>(path.turn) * degree < 1e-12);
    CHECK(path_error_deg<ContactMap>(path.turn) * degree < 1e-12);
  }
}

TEST_CASE("object motion: the angles are those of the published convention") {
  // E.g. the slides' matrix: R31 = -sin y, R21 / R11 = tan z, R32 / R33 = tan x.
  const auto r = rotation_of(Angles<double>{0.3, -0.4, 0.5});
  CHECK(r(2, 0) == Approx(-std::sin(-0.4)));
  CHECK(r(1, 0) / r(0, 0) == Approx(std::tan(0.5)));
  CHECK(r(2, 1) / r(2, 2) == Approx(std::tan(0.3)));
  // A quarter turn about z carries x (columns) to y (rows).
  const auto quarter = rotation_of(Angles<double>{0, 0, std::numbers::pi / 2});
  CHECK(quarter(Vector{1, 0, 0}).y == Approx(1));
}

TEST_CASE("object motion: a rolled ball, without noise") {
  const test::RollingBall ball;
  test::Rolling roll(ball, -6, 1);
  const auto run = [&](auto way) {
    using Way = decltype(way);
    test::Rolling r(ball, -6, 1);
    const ObjectMotion<Way> motion(ball.initial());
    auto state = motion.start();
    CHECK(motion(r.dots, r.contact, state).begun);
    ObjectMotionResult<double> result;
    int changes = 0;
    for (int k = 1; k <= 60; ++k) {
      r.step(-6 + 0.2 * k, 1 + 0.1 * k);
      result = motion(r.dots, r.contact, state);
      REQUIRE(result.ok());
      CHECK(!result.begun);
      changes += result.reference_changed ? 1 : 0;
    }
    CHECK(changes >= 8);
    CHECK(result.residual_rms_mm < 1e-12);
    const Vector center{-6, 1, ball.depth_mm + ball.radius_mm};
    const Vector moved = result.pose(center) - center;
    return std::pair{error_deg(result.pose.rotation, r.pose.rotation),
                     norm(moved - Vector{12, 6, 0})};
  };
  const auto [map_deg, map_mm] = run(ContactMap());
  CHECK(map_deg < 1e-10);
  CHECK(map_mm < 1e-11);
  const auto [chain_deg, chain_mm] = run(AnchoredComposition());
  CHECK(chain_deg < 1e-10);
  CHECK(chain_mm < 1e-11);
  CHECK(run(SumOfAngles<>()).first > 0.1);
}

TEMPLATE_TEST_CASE("object motion: dots that come into contact again sit elsewhere on the object",
                   "[object_motion]",
                   ContactMap,
                   AnchoredComposition) {
  // Twice around a circle: the ball has spun meanwhile, so earlier positions of a dot are useless.
  const test::RollingBall ball{.patch_mm = 4};
  const ObjectMotion<TestType> motion(ball.initial());
  auto state = motion.start();
  test::Rolling roll(ball, 5, 0);
  auto result = motion(roll.dots, roll.contact, state);
  for (int k = 1; k <= 200; ++k) {
    const double phi = 4 * std::numbers::pi * k / 200;
    roll.step(5 * std::cos(phi), 5 * std::sin(phi));
    result = motion(roll.dots, roll.contact, state);
    REQUIRE(result.ok());
    REQUIRE(result.residual_rms_mm < 1e-11);
  }
  CHECK(error_deg(roll.pose.rotation, {}) > 10);
  CHECK(error_deg(result.pose.rotation, roll.pose.rotation) < 1e-10);
}

TEST_CASE("object motion: noise after a roll with twenty changes of the reference dot", "[noise]") {
  // 30 mm over dots 1.5 mm apart, with 0.02 mm of noise in the plane and 0.05 mm in depth; rms of
  // twenty rolls.
  const auto rms_deg = [](auto way, double patch_mm, int frames, double margin_mm = 0) {
    const test::RollingBall ball{.rows = 11, .cols = 31, .patch_mm = patch_mm};
    const std::uint64_t rolls = frames == 300 ? 20 : 100;
    double sum_sq = 0;
    for (std::uint64_t seed = 1; seed <= rolls; ++seed) {
      test::Gauss gauss(seed);
      const ObjectMotion<decltype(way)> motion(ball.initial(), {margin_mm});
      auto state = motion.start();
      test::Rolling roll(ball, -15, 0.3);
      auto result = motion(noisy(roll.dots, roll.contact, gauss), roll.contact, state);
      for (int k = 1; k <= frames; ++k) {
        roll.step(-15 + 30.0 * k / frames, 0.3);
        result = motion(noisy(roll.dots, roll.contact, gauss), roll.contact, state);
        REQUIRE(result.ok());
      }
      sum_sq += square(error_deg(result.pose.rotation, roll.pose.rotation));
    }
    return std::sqrt(sum_sq / static_cast<double>(rolls));
  };
  SECTION("a map of the contact") {
    CHECK(rms_deg(ContactMap(), 4, 300) < 1.5);
    CHECK(rms_deg(ContactMap(), 5, 300) < 1);
    CHECK(rms_deg(ContactMap(), 6, 300) < 0.6);
    CHECK(rms_deg(ContactMap(), 4, 60) < 2.5);  // too small and too fast for 1.5
    CHECK(rms_deg(ContactMap(), 5, 60) < 1.5);
    CHECK(rms_deg(ContactMap(), 6, 60) < 0.8);
  }
  SECTION("a chain of nine dots has their noise at every change") {
    CHECK(rms_deg(AnchoredComposition(), 5, 300, 0.2) < 8);
    CHECK(rms_deg(AnchoredComposition(), 5, 60, 0.2) < 8);
  }
  SECTION("and the more so when noise makes the dot flicker, as published") {
    CHECK(rms_deg(SumOfAngles<>(), 5, 300) > 10);
    CHECK(rms_deg(SumOfAngles<>(), 5, 60) > 6);
    CHECK(rms_deg(AnchoredComposition(), 5, 300) > 10);
  }
}

TEST_CASE("object motion: dots that slip do not drag the pose") {
  const test::RollingBall ball;
  test::Rolling roll(ball, 0, 0);
  const auto run = [&](ContactMap way) {
    const ObjectMotion<ContactMap> motion(ball.initial(), {}, way);
    auto state = motion.start();
    (void)motion(roll.dots, roll.contact, state);
    Dots slipped = roll.dots;
    for (Index i = 7; i < 9; ++i) {
      for (Index j = 0; j < 21; ++j) {
        slipped(i, j).x += 0.5;  // nine of the thirty-seven
      }
    }
    const auto first = motion(slipped, roll.contact, state);
    const auto second = motion(slipped, roll.contact, state);
    REQUIRE(second.ok());
    return std::pair{error_deg(first.pose.rotation, {}), error_deg(second.pose.rotation, {})};
  };
  const auto [plain, plain_later] = run({.robust_passes = 0});
  const auto [robust, robust_later] = run({});
  CAPTURE(plain, plain_later, robust, robust_later);
  CHECK(plain > 1);
  CHECK(robust < 0.01);
  CHECK(robust_later < 0.01);
}

TEST_CASE("object motion: the contact reference dot") {
  const Dots free = small_grid();
  Flags contact(7, 7, 1);
  const ObjectMotion<> motion(free);
  auto state = motion.start();
  Dots dots = free;
  for (auto& p : dots.cells) {
    p.z -= 1;
  }
  SECTION("of equal displacements the first in the order of rows") {
    CHECK(motion(dots, contact, state).reference == DotIndex{1, 1});
  }
  SECTION("never on the border of the grid, which lacks neighbours") {
    dots(0, 3).z -= 1;
    dots(3, 6).z -= 1;
    CHECK(motion(dots, contact, state).reference == DotIndex{1, 1});
  }
  SECTION("only in contact, and with all neighbours found, now and at first") {
    dots(3, 3).z -= 1;
    CHECK(motion(dots, contact, state).reference == DotIndex{3, 3});
    contact(3, 3) = 0;
    CHECK(motion(dots, contact, state).reference == DotIndex{1, 1});
    contact(3, 3) = 1;
    dots(2, 4).x = std::nan("");
    const auto result = motion(dots, contact, state);
    CHECK(result.reference == DotIndex{1, 1});
    Dots holes = free;
    holes(2, 2).y = std::nan("");
    const ObjectMotion<> with_holes(holes);
    auto other = with_holes.start();
    dots = rotated(free, {{}, {0, 0, -1}});
    CHECK(with_holes(dots, contact, other).reference == DotIndex{1, 4});
  }
  SECTION("it stays within the margin, and changes are reported") {
    const ObjectMotion<> calm(free, {.reference_margin_mm = 0.2});
    dots(3, 3).z -= 0.1;
    auto result = calm(dots, contact, state);
    CHECK(result.reference == DotIndex{3, 3});
    CHECK(!result.reference_changed);
    dots(4, 4).z -= 0.25;
    result = calm(dots, contact, state);
    CHECK(result.reference == DotIndex{3, 3});
    CHECK(!result.reference_changed);
    auto copy = state;
    CHECK(motion(dots, contact, copy).reference_changed);
    dots(4, 4).z -= 0.1;
    result = calm(dots, contact, state);
    CHECK(result.reference == DotIndex{4, 4});
    CHECK(result.reference_changed);
  }
}

TEMPLATE_TEST_CASE(
    "object motion: statuses", "[object_motion]", ContactMap, AnchoredComposition, SumOfAngles<>) {
  const Dots free = small_grid();
  const Flags all(7, 7, 1), none(7, 7, 0);
  const ObjectMotion<TestType> motion(free);
  auto state = motion.start();
  const Pose<double> pose{rotation_of(Angles<double>{0.1, 0.2, 0.3}), {1, 2, -1}};
  Dots blank = free;
  for (auto& p : blank.cells) {
    p.y = std::nan("");
  }

  auto result = motion(free, none, state);
  CHECK(result.accepted());
  CHECK(result.status == MotionStatus::no_contact);
  CHECK(!is_finite(result.position_mm.x));
  CHECK(norm(result.displacement_mm) == 0);
  result = motion(free, all, state);
  CHECK(result.ok());
  CHECK(result.begun);
  CHECK(result.position_mm.x == free(1, 1).x);
  const Dots moved = rotated(free, pose);
  result = motion(moved, all, state);
  CHECK(result.ok());
  CHECK(result.position_mm.x == Approx(pose(free(1, 1)).x));
  CHECK(result.displacement_mm.y == Approx(pose(free(1, 1)).y - free(1, 1).y));
  CHECK(result.angles.z_rad == Approx(0.3));
  CHECK(inverse(result.pose)(pose({1, 2, 3})).z == Approx(3));

  SECTION("frames without dots leave the pose standing") {
    for (const Flags& flags : {none, all}) {
      const auto held = motion(blank, flags, state);
      CHECK(held.status == (&flags == &none || flags.cells[0] == 0 ? MotionStatus::no_dots
                                                                   : MotionStatus::too_few_dots));
      CHECK(held.pose.rotation(2, 0) == result.pose.rotation(2, 0));
      CHECK(held.position_mm.x == result.position_mm.x);
      CHECK(held.dots_used == 0);
    }
    const auto again = motion(rotated(free, pose * pose), all, state);
    CHECK(again.ok());
    CHECK(!again.begun);
    if (!std::is_same_v<TestType, SumOfAngles<>>) {
      CHECK(error_deg(again.pose.rotation, (pose * pose).rotation) < 1e-10);
    }
  }
  SECTION("a line of dots determines nothing") {
    Dots line = blank;
    for (Index j = 0; j < 7; ++j) {
      line(1, j) = moved(1, j);
    }
    result = motion(line, all, state);
    CHECK(result.status == MotionStatus::collinear);
    CHECK(motion(moved, all, state).ok());
  }
  SECTION("nothing known is in contact any more") {
    Flags elsewhere = none;
    for (Index i = 0; i < 7; ++i) {
      elsewhere(i, 6) = elsewhere(i, 5) = elsewhere(i, 4) = 1;
    }
    elsewhere(result.reference.row, result.reference.col) = 0;
    if (std::is_same_v<TestType, ContactMap>) {
      Flags first = none;
      for (Index i = 0; i < 7; ++i) {
        first(i, 0) = first(i, 1) = first(i, 2) = 1;
      }
      auto other = motion.start();
      (void)motion(free, first, other);
      CHECK(motion(moved, elsewhere, other).status == MotionStatus::lost);
      CHECK(motion(moved, first, other).ok());
    } else {
      Flags edge = none;  // no dot at the border of the grid can be the reference dot
      edge(0, 6) = 1;
      CHECK(motion(moved, edge, state).status == MotionStatus::no_reference_dot);
      CHECK(motion(moved, elsewhere, state).status == MotionStatus::lost);
      CHECK(motion(moved, all, state).ok());
    }
  }
  SECTION("contact lost is an object lost") {
    result = motion(moved, none, state);
    CHECK(result.status == MotionStatus::no_contact);
    CHECK(!state.has_object());
    CHECK(result.pose.rotation(2, 0) == 0);
    result = motion(moved, all, state);
    CHECK(result.begun);
    const DotIndex at = result.reference;
    CHECK(result.position_mm.x == moved(at.row, at.col).x);
    CHECK(result.pose.rotation(2, 0) == 0);
  }
  SECTION("a copy of the state goes its own way") {
    auto copy = state;
    (void)motion(blank, none, copy);
    (void)motion(rotated(free, pose * pose), all, copy);
    CHECK(error_deg(motion(moved, all, state).pose.rotation, pose.rotation) < 1e-10);
  }
}

TEST_CASE("object motion: names of statuses") {
  CHECK(std::string(name_of(MotionStatus::ok)) == "ok");
  CHECK(std::string(name_of(MotionStatus::collinear)) == "collinear");
  CHECK(std::string(name_of(MotionStatus::lost)) == "lost");
}

TEST_CASE("object motion: a neighbourhood uses the dots that remain") {
  const auto k = test::nine_dots();
  const Rotation<double> turn = rotation_of(Angles<double>{0.2, -0.3, 0.4});
  const auto check = [&](std::vector<std::size_t> kept, MotionStatus expected) {
    auto l = rotated(k, turn);
    l.found = {};
    for (const std::size_t at : kept) {
      l.found[at] = true;
    }
    for (std::size_t at = 0; at < 9; ++at) {
      l.dot[at] = l.found[at] ? l.dot[at] : detail::missing_point<double>();
    }
    const auto one = [&](auto local) {
      const auto result = decltype(local)::turn(k, l);
      CHECK(result.status == expected);
      CHECK((result.status != MotionStatus::ok || error_deg(result.rotation, turn) < 1e-12));
    };
    one(PublishedBasis());
    one(SymmetricFrame());
  };
  check({0, 1, 2, 3, 5, 6, 7, 8}, MotionStatus::ok);  // without the middle
  check({0, 2, 6}, MotionStatus::ok);
  check({4, 5, 7}, MotionStatus::ok);
  check({1, 3}, MotionStatus::too_few_dots);
  check({}, MotionStatus::too_few_dots);
  check({0, 1, 2}, MotionStatus::collinear);
  check({2, 4, 6}, MotionStatus::collinear);
}

TEST_CASE("object motion: what remains of an affine grid has its directions") {
  const Vector q1{1.5, 0.1, 0.2}, q2{-0.3, 1.4, -0.1}, origin{5, -3, 11};
  Neighbourhood<double> n;
  for (std::size_t k = 0; k < 9; ++k) {
    const double u = static_cast<double>(k % 3), v = static_cast<double>(k / 3);
    n.dot[k] = {origin.x + u * q1.x + v * q2.x, origin.y + u * q1.y + v * q2.y,
                origin.z + u * q1.z + v * q2.z};
  }
  int determined = 0;
  for (unsigned mask = 0; mask < 512; ++mask) {
    for (std::size_t k = 0; k < 9; ++k) {
      n.found[k] = (mask >> k & 1U) != 0;
    }
    const CommonDots all = common_dots(n, n);
    if (all.count < 3 || !published_basis(grid_directions(n, all)).determined) {
      continue;
    }
    const auto basis = published_basis(grid_directions(n, all));
    const auto parallel = [](const Vector& a, const Vector& b) {
      return Approx(1).margin(1e-14) == dot(a, normalized(b));
    };
    CHECK((parallel(basis.n1, q1) && parallel(basis.n2, q2)));
    ++determined;
  }
  CHECK(determined == 512 - 1 - 9 - 36 - 8);  // none, one, two, and the eight lines of three
}

TEST_CASE("object motion: the same on every grid of dots and of flags") {
  const Dots free = small_grid();
  const Dots moved = rotated(free, {rotation_of(Angles<double>{0.1, 0.2, 0.3}), {1, 2, -1}});
  Eigen::Matrix<Eigen::Vector3d, Eigen::Dynamic, Eigen::Dynamic> eigen(7, 7);
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> flags(7, 7);
  cv::Mat_<cv::Vec3d> image(7, 7);
  cv::Mat_<float> mask(7, 7);
  for (Index i = 0; i < 7; ++i) {
    for (Index j = 0; j < 7; ++j) {
      const auto& p = moved(i, j);
      eigen(i, j) = {p.x, p.y, p.z};
      image(static_cast<int>(i), static_cast<int>(j)) = {p.x, p.y, p.z};
      flags(i, j) = i + j != 5;
      mask(static_cast<int>(i), static_cast<int>(j)) = i + j != 5 ? 255.0F : 0.0F;
    }
  }
  const LazyView lazy_flags(7, 7, [](Index i, Index j) { return i + j != 5; });
  const ObjectMotion<> motion(free);
  auto state = motion.start();
  (void)motion(free, lazy_flags, state);
  auto second = state, third = state;
  const auto a = motion(moved, lazy_flags, state);
  const auto b = motion(eigen, flags, second);
  const auto c = motion(image, mask, third);
  REQUIRE(a.ok());
  CHECK(a.dots_used == 43);
  for (int i = 0; i < 9; ++i) {
    CHECK(a.pose.rotation.m[i / 3][i % 3] == b.pose.rotation.m[i / 3][i % 3]);
    CHECK(a.pose.rotation.m[i / 3][i % 3] == c.pose.rotation.m[i / 3][i % 3]);
  }
}

TEST_CASE("object motion: other sizes are refused and the state stays as it is") {
  const Dots free = small_grid();
  const ObjectMotion<> motion(free);
  auto state = motion.start();
  (void)motion(free, Flags(7, 7, 1), state);
  CHECK(!motion(Dots(7, 8), Flags(7, 8, 1), state).accepted());
  CHECK(!motion(free, Flags(8, 7, 1), state).accepted());
  CHECK(!motion(Dots(0, 0), Flags(0, 0, 1), state).accepted());
  CHECK(state.has_object());
  const ObjectMotion<> other(Dots(8, 7));
  auto foreign = other.start();
  CHECK(!motion(free, Flags(7, 7, 1), foreign).accepted());
  // nothing has moved
  const auto refused = motion(free, Flags(8, 7, 1), state);
  CHECK(norm(refused.displacement_mm) == 0);
  CHECK(norm(refused.pose.translation_mm) == 0);
  CHECK(refused.residual_rms_mm == 0);
}

TEST_CASE("object motion: a single dot at the end of a row is found, and may touch or slip") {
  const Dots free = test::RollingBall{.rows = 4, .cols = 6}.initial();
  const ObjectMotion<> motion(free);
  for (const DotIndex at : {DotIndex{0, 5}, DotIndex{3, 0}, DotIndex{3, 5}}) {
    const auto only = [&](Index i, Index j) { return DotIndex{i, j} == at; };
    const LazyView dots(4, 6, [&](Index i, Index j) {
      return only(i, j) ? free(i, j) : detail::missing_point<double>();
    });
    const LazyView flags(4, 6, only);
    const Flags none(4, 6, 0), all(4, 6, 1);
    const Dots lost(4, 6, detail::missing_point<double>());
    auto state = motion.start();
    CHECK(motion(dots, none, state).status == MotionStatus::no_contact);
    CHECK(motion(lost, none, state).status == MotionStatus::no_dots);
    CHECK(motion(free, flags, state).status != MotionStatus::no_contact);
    CHECK(motion(free, flags, none, state).status != MotionStatus::slipping);
    CHECK(motion(free, flags, all, state).status == MotionStatus::slipping);
    CHECK(motion(dots, all, all, state).status == MotionStatus::slipping);
  }
}

TEST_CASE("object motion: bad parameters are refused by name") {
  const auto refusal = [](double margin_mm, ContactMap way) {
    try {
      const ObjectMotion<> motion(small_grid(), {margin_mm}, way);
    } catch (const parameter_error& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK(refusal(0, {}) == "accepted");
  CHECK(refusal(-1, {}) == "ObjectMotion: reference_margin_mm = -1, must be finite and >= 0");
  CHECK(refusal(std::nan(""), {}).find("reference_margin_mm") != std::string::npos);
  CHECK(refusal(0, {.dots_to_begin = 2}) == "ContactMap: dots_to_begin = 2, must be >= 3");
  CHECK(refusal(0, {.robust_passes = 11}) == "ContactMap: robust_passes = 11, must be in [0, 10]");
}

TEST_CASE("object motion: the unit is judged by the dots that are found") {
  const auto accepts = [](const Dots& dots) {
    try {
      const ObjectMotion<> motion(dots);
    } catch (const parameter_error&) {
      return false;
    }
    return true;
  };
  CHECK(accepts(Dots(0, 0)));
  const double nan = std::nan("");
  // one pair of neighbours, anywhere in the grid
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; j < 4; ++j) {
      for (const double step_mm : {0.001, 1.5, 1500.0}) {
        Dots dots(3, 5, {nan, nan, nan});
        dots(i, j) = {1, 2, 10};
        dots(i, j + 1) = {1 + step_mm, 2, 10};
        CAPTURE(i, j, step_mm);
        CHECK(accepts(dots) == (step_mm == 1.5));
      }
    }
  }
}

TEST_CASE("spatial dots: depth is read between pixels, at the dot's own pixel (E020)") {
  const Camera<double> camera;
  test::Image<double> depth(4, 5);
  for (Index i = 0; i < 4; ++i) {
    for (Index j = 0; j < 5; ++j) {
      depth(i, j) = 10 + 0.5 * static_cast<double>(i) - 0.25 * static_cast<double>(j);
    }
  }
  depth(3, 4) = std::nan("");
  test::Image<Point2<double>> dots(1, 7);
  dots(0, 0) = {1.25, 2.5};
  dots(0, 1) = {0, 0};
  dots(0, 2) = {3, 3};      // needs no missing pixel
  dots(0, 3) = {3.5, 2.5};  // needs one
  dots(0, 4) = {-0.01, 1};  // outside
  dots(0, 5) = {std::nan(""), 1};
  dots(0, 6) = {4, 2};  // the last column
  Dots out(1, 7);
  const auto result = spatial_dots(camera, dots, depth, out);
  CHECK(result.ok());
  CHECK(result.found == 4);
  const auto expected = point_at(camera, 2.5, 1.25, 10 + 1.25 - 0.3125);
  CHECK(out(0, 0).x == Approx(expected.x));
  CHECK(out(0, 0).y == Approx(expected.y));
  CHECK(out(0, 0).z == Approx(expected.z));
  CHECK(out(0, 2).z == Approx(10.75));
  CHECK(out(0, 6).z == Approx(10));
  for (const Index missing : {3, 4, 5}) {
    CHECK(std::isnan(out(0, missing).x));
    CHECK(std::isnan(out(0, missing).z));
  }
  Dots other_size(2, 7);
  CHECK(!spatial_dots(camera, dots, depth, other_size).ok());
  cv::Mat_<cv::Vec3f> image(1, 7);
  CHECK(spatial_dots(camera, dots, depth, image).found == 4);
  CHECK(static_cast<double>(image(0, 0)[2]) == Approx(expected.z));

  test::Flags mask(4, 5, 0);
  mask(3, 1) = 255;
  mask(0, 0) = 1;
  test::Flags touching(1, 7, 9);
  CHECK(contact_at_dots(dots, mask, touching));
  CHECK(touching.cells == std::vector<unsigned char>{1, 1, 0, 0, 0, 0, 0});
  Flags turned_size(7, 1);
  CHECK(!contact_at_dots(dots, mask, turned_size));
}

TEST_CASE("contact at dots: with a radius, all of a dot must touch") {
  // a half plane from column 10 on, and a hole in it
  test::Flags mask(20, 40, 0);
  for (Index i = 0; i < 20; ++i) {
    for (Index j = 10; j < 40; ++j) {
      mask(i, j) = 255;
    }
  }
  mask(10, 30) = 0;
  test::Image<Point2<double>> dots(1, 7);
  dots(0, 0) = {13.0, 10.0};
  dots(0, 1) = {12.4, 10.0};  // its pixel is 12
  dots(0, 2) = {39.4, 0.0};   // pixels outside the mask do not count
  dots(0, 3) = {32.0, 12.0};  // sqrt(8) from the hole
  dots(0, 4) = {33.0, 10.0};
  dots(0, 5) = {32.0, 11.0};
  dots(0, 6) = {-2.0, 10.0};
  test::Flags touching(1, 7, 9);
  CHECK(contact_at_dots(dots, mask, touching, 2.5));
  CHECK(touching.cells == std::vector<unsigned char>{1, 1, 1, 1, 1, 0, 0});
  CHECK(contact_at_dots(dots, mask, touching, 3.0));
  CHECK(touching.cells == std::vector<unsigned char>{1, 0, 1, 0, 0, 0, 0});
  CHECK(contact_at_dots(dots, mask, touching, 4.0));
  CHECK(touching.cells == std::vector<unsigned char>{0, 0, 1, 0, 0, 0, 0});
  for (const double bad : {-1.0, 1e9, not_a_number<double>()}) {
    touching(0, 0) = 9;
    CHECK(!contact_at_dots(dots, mask, touching, bad));
    CHECK(touching(0, 0) == 9);
  }
}

TEST_CASE("contact at dots: a dot touches if its nearest pixel does") {
  test::Flags mask(6, 9, 0);
  mask(3, 5) = 1;
  test::Image<Point2<double>> dots(2, 4);
  const double inside[] = {-0.48, 0.48}, outside[] = {-0.52, 0.52};
  for (Index k = 0; k < 2; ++k) {
    dots(0, k) = {5 + inside[k], 3};
    dots(0, k + 2) = {5, 3 + inside[k]};
    dots(1, k) = {5 + outside[k], 3};
    dots(1, k + 2) = {5, 3 + outside[k]};
  }
  test::Flags touching(2, 4, 9);
  CHECK(contact_at_dots(dots, mask, touching));
  CHECK(touching.cells == std::vector<unsigned char>{1, 1, 1, 1, 0, 0, 0, 0});
}

TEST_CASE("object motion: dots that slip do not count, and are entered anew") {
  // Half of the dots stay behind, too many for a robust fit.
  const Dots free = small_grid();
  const Flags contact(7, 7, 1);
  const ObjectMotion motion(free);
  auto state = motion.start(), blind = motion.start();
  Flags slips(7, 7, 0);
  (void)motion(free, contact, slips, state);
  (void)motion(free, contact, blind);
  const Pose<double> pose = {test::turned_by({0, 0, 0.1}), {0.4, 0.1, 0}};
  Dots dots = rotated(free, pose);
  for (Index i = 0; i < 7; ++i) {
    for (Index j = 0; j < 4; ++j) {
      dots(i, j) = free(i, j);
      slips(i, j) = 1;
    }
  }
  const auto seen = motion(dots, contact, slips, state);
  REQUIRE(seen.ok());
  CHECK(seen.dots_used == 21);
  CHECK(error_deg(seen.pose.rotation, pose.rotation) < 1e-9);
  CHECK(norm(seen.pose({1, 2, 10}) - pose({1, 2, 10})) < 1e-9);
  CHECK(error_deg(motion(dots, contact, blind).pose.rotation, pose.rotation) > 1);
  // they stick again at their current positions
  const Dots later = rotated(dots, pose);
  const auto all = motion(later, contact, Flags(7, 7, 0), state);
  REQUIRE(all.ok());
  (void)motion(rotated(later, pose), contact, Flags(7, 7, 0), state);
  const auto after = motion(rotated(rotated(later, pose), pose), contact, Flags(7, 7, 0), state);
  CHECK(after.dots_used == 49);
  CHECK(error_deg(after.pose.rotation, test::turned_by({0, 0, 0.4})) < 1e-6);
}

TEST_CASE(
    "object motion: while the object slides nothing is known of it, after that it is another") {
  const Dots free = small_grid();
  const Flags contact(7, 7, 1);
  const ObjectMotion motion(free);
  auto state = motion.start();
  (void)motion(free, contact, Flags(7, 7, 0), state);
  const Pose<double> pose = {test::turned_by({0, 0, 0.1}), {0.4, 0.1, 0}};
  const auto moved = motion(rotated(free, pose), contact, Flags(7, 7, 0), state);
  REQUIRE(moved.ok());
  Flags slips(7, 7, 1);
  for (Index j = 0; j < 7; ++j) {
    slips(0, j) = 0;  // 7 of 49 are fewer than a fifth
  }
  const auto slides = motion(free, contact, slips, state);
  CHECK(slides.status == MotionStatus::slipping);
  CHECK(std::string(name_of(slides.status)) == "slipping");
  CHECK_FALSE(slides.ok());
  CHECK(error_deg(slides.pose.rotation, pose.rotation) < 1e-9);  // the last known rotation
  CHECK_FALSE(state.has_object());
  const auto next = motion(free, contact, Flags(7, 7, 0), state);
  CHECK(next.ok());
  CHECK(next.begun);
  // missing contact is no slide; other sizes are refused
  CHECK(motion(free, Flags(7, 7, 0), slips, state).status == MotionStatus::no_contact);
  CHECK_FALSE(motion(free, contact, Flags(6, 7, 0), state).accepted());
}

TEST_CASE("object motion: after a slide an object begins once more than half of the dots stick") {
  const Dots free = small_grid();
  const Flags contact(7, 7, 1);
  const ObjectMotion motion(free);
  auto state = motion.start();
  Flags few(7, 7, 1), half(7, 7, 1), most(7, 7, 1);
  for (std::size_t k = 0; k < 25; ++k) {
    few.cells[k] = k < 7 ? 0 : 1;
    half.cells[k] = k < 24 ? 0 : 1;
    most.cells[k] = 0;  // 25 of 49
  }
  CHECK(motion(free, contact, half, state).begun);  // nothing has slid
  CHECK(motion(free, contact, few, state).status == MotionStatus::slipping);
  CHECK(motion(free, contact, half, state).status == MotionStatus::slipping);
  CHECK_FALSE(state.has_object());
  SECTION("then half are enough again") {
    CHECK(motion(free, contact, most, state).begun);
    CHECK(motion(free, contact, half, state).ok());
  }
  SECTION("missing dots do not end the slide") {
    const Dots missing(7, 7, {std::nan(""), std::nan(""), std::nan("")});
    CHECK(motion(missing, contact, most, state).status == MotionStatus::too_few_dots);
    CHECK(motion(missing, Flags(7, 7, 0), most, state).status == MotionStatus::no_dots);
    CHECK(motion(free, contact, half, state).status == MotionStatus::slipping);
  }
  SECTION("another contact has not slid") {
    CHECK(motion(free, Flags(7, 7, 0), most, state).status == MotionStatus::no_contact);
    CHECK(motion(free, contact, half, state).begun);
  }
}
