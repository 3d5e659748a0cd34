// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every object, every motion and every method.
#include "fingerpad/motion/object_motion.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "fingerpad/dots/spatial_dots.hpp"
#include "fingerpad/published/object_motion.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/rolling.hpp"

using namespace fingerpad;
using test::degree;
using test::Dots;
using test::error_deg;
using test::Flags;
using test::rotated;
using test::small_grid;

namespace {

using Vector = Point3<double>;

/// No pose, and no number that could be taken for one.
bool says_nothing(const ObjectMotionResult<double>& r) {
  const double numbers[] = {
      r.pose.translation_mm.x, r.pose.translation_mm.y, r.pose.translation_mm.z,
      r.angles.x_rad,          r.angles.y_rad,          r.angles.z_rad,
      r.position_mm.x,         r.position_mm.y,         r.position_mm.z,
      r.displacement_mm.x,     r.displacement_mm.y,     r.displacement_mm.z,
      r.residual_rms_mm,       r.position_sd_mm,        r.rotation_sd_rad};
  const auto is_nan = [](double number) { return std::isnan(number); };
  bool all = !r.has_pose() && r.dots_used == 0 &&
             std::all_of(std::begin(numbers), std::end(numbers), is_nan);
  for (const auto& row : r.pose.rotation.m) {
    all = all && std::all_of(std::begin(row), std::end(row), is_nan);
  }
  return all;
}

}  // namespace

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

TEST_CASE("object motion: dots that come into contact again sit elsewhere on the object") {
  // Twice around a circle: the ball has spun meanwhile, so earlier positions of a dot are useless.
  const test::RollingBall ball{.patch_mm = 4};
  ObjectMotion<> motion(21, 21);
  test::Rolling roll(ball, 5, 0);
  auto result = motion(roll.dots, roll.contact);
  for (int k = 1; k <= 200; ++k) {
    const double phi = 4 * std::numbers::pi * k / 200;
    roll.step(5 * std::cos(phi), 5 * std::sin(phi));
    result = motion(roll.dots, roll.contact);
    REQUIRE(result.ok());
    REQUIRE(result.residual_rms_mm < 1e-11);
  }
  CHECK(error_deg(roll.pose.rotation, {}) > 10);
  CHECK(error_deg(result.pose.rotation, roll.pose.rotation) < 1e-10);
}

TEST_CASE("object motion: statuses") {
  const Dots free = small_grid();
  const Flags all(7, 7, 1), none(7, 7, 0);
  ObjectMotion<> motion(7, 7);
  const Pose<double> pose{rotation_of(Angles<double>{0.1, 0.2, 0.3}), {1, 2, -1}};
  const Dots blank(7, 7, {std::nan(""), std::nan(""), std::nan("")});

  auto result = motion(free, none);
  CHECK(result.status == MotionStatus::no_contact);
  CHECK(result.object == 0);
  CHECK(says_nothing(result));
  result = motion(free, all);
  CHECK(result.ok());
  CHECK(result.begun);
  CHECK(result.object == 1);
  const Vector middle = free(3, 3);
  CHECK(norm(result.position_mm - middle) < 1e-12);
  const Dots moved = rotated(free, pose);
  result = motion(moved, all);
  CHECK(result.ok());
  CHECK(!result.begun);
  CHECK(result.object == 1);
  CHECK(norm(result.position_mm - pose(middle)) < 1e-12);
  CHECK(result.displacement_mm.y == Approx(pose(middle).y - middle.y));
  CHECK(result.angles.z_rad == Approx(0.3));
  CHECK(inverse(result.pose)(pose({1, 2, 3})).z == Approx(3));

  SECTION("frames without dots have no pose, and the object is found again") {
    for (const Flags& flags : {none, all}) {
      const auto held = motion(blank, flags);
      CHECK(held.status == MotionStatus::no_pose);
      CHECK(held.object == 1);
      CHECK(says_nothing(held));
    }
    const auto again = motion(rotated(free, pose * pose), all);
    CHECK(again.ok());
    CHECK(!again.begun);
    CHECK(error_deg(again.pose.rotation, (pose * pose).rotation) < 1e-10);
  }
  SECTION("a line of dots determines nothing") {
    Dots line = blank;
    for (Index j = 0; j < 7; ++j) {
      line(1, j) = moved(1, j);
    }
    CHECK(motion(line, all).status == MotionStatus::no_pose);
    CHECK(motion(moved, all).ok());
  }
  SECTION("nothing known is in contact any more, for a frame") {
    Flags first = none, elsewhere = none;
    for (Index i = 0; i < 7; ++i) {
      first(i, 0) = first(i, 1) = first(i, 2) = 1;
      elsewhere(i, 6) = elsewhere(i, 5) = elsewhere(i, 4) = 1;
    }
    ObjectMotion<> other(7, 7);
    (void)other(free, first);
    CHECK(other(moved, elsewhere).status == MotionStatus::no_pose);
    CHECK(other(moved, first).ok());
    CHECK(other(moved, first).object == 1);
  }
  SECTION("contact lost is an object lost, and the next has the next number") {
    result = motion(moved, none);
    CHECK(result.status == MotionStatus::no_contact);
    CHECK(result.object == 1);
    result = motion(moved, all);
    CHECK(result.begun);
    CHECK(result.object == 2);
    CHECK(norm(result.position_mm - pose(middle)) < 1e-12);
    CHECK(norm(result.displacement_mm) == 0);
    CHECK(result.pose.rotation(2, 0) == 0);
  }
  SECTION("too few dots begin no object") {
    Flags eight = none;
    for (std::size_t k = 0; k < 8; ++k) {
      eight.cells[k] = 1;
    }
    (void)motion(moved, none);
    CHECK(motion(moved, eight).status == MotionStatus::no_pose);
    eight.cells[8] = 1;
    CHECK(motion(moved, eight).begun);
  }
  SECTION("dots beyond a quarter of a pitch, or turned over, are not one body") {
    Dots apart = moved, over = free;
    for (std::size_t k = 0; k < apart.cells.size(); ++k) {
      apart.cells[k].z += k % 2 == 0 ? 0.5 : -0.5;
    }
    for (auto& p : over.cells) {
      p = {-p.x, p.y, 2 * free(0, 0).z - p.z};
    }
    for (const Dots& bad : {apart, over}) {
      const auto held = motion(bad, all);
      CHECK(held.status == MotionStatus::no_pose);
      CHECK(says_nothing(held));
    }
    CHECK(motion(moved, all).ok());
  }
  SECTION("a copy goes its own way") {
    auto copy = motion;
    (void)copy(blank, none);
    (void)copy(rotated(free, pose * pose), all);
    CHECK(error_deg(motion(moved, all).pose.rotation, pose.rotation) < 1e-10);
  }
}

TEST_CASE("object motion: standard deviations cover the error of a roll, and are no wider",
          "[noise]") {
  const test::RollingBall ball{.rows = 11, .cols = 31, .patch_mm = 5};
  const Flags none(11, 31, 0);
  int known = 0, beyond = 0;
  int off_beyond = 0;
  double error_sq = 0, sd_sq = 0, off_sq = 0, off_sd_sq = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    test::Gauss gauss(seed);
    ObjectMotion<> motion(11, 31);
    test::Rolling roll(ball, -10, 0.3);
    auto result =
        motion(noisy(roll.dots, roll.contact, gauss, 0.005, 0.025), roll.contact, none, 0.025);
    CHECK(result.rotation_sd_rad == 0);  // it begins
    const auto begun = result.position_mm;
    const auto start = roll.pose;
    for (int k = 1; k <= 40; ++k) {
      roll.step(-10 + 20.0 * k / 40, 0.3);
      result =
          motion(noisy(roll.dots, roll.contact, gauss, 0.005, 0.025), roll.contact, none, 0.025);
      const double sd_deg = result.rotation_sd_rad * 180 / 3.14159265358979;
      const double error = error_deg(result.pose.rotation, roll.pose.rotation);
      ++known;
      beyond += error > 2 * sd_deg ? 1 : 0;
      error_sq += square(error);
      sd_sq += square(sd_deg);
      // the point that the dots lay about at first, which rolls away from those that touch
      const double off = norm(result.position_mm - (roll.pose * inverse(start))(begun));
      off_beyond += off > 2 * result.position_sd_mm ? 1 : 0;
      off_sq += square(off);
      off_sd_sq += square(result.position_sd_mm);
    }
  }
  CHECK(20 * beyond <= known);
  CHECK(sd_sq < square(3.0) * error_sq);  // each dot errs alone here, not four in common
  CHECK(20 * off_beyond <= known);
  CHECK(off_sd_sq < square(3.0) * off_sq);
  const auto unknown = ObjectMotion<>(11, 31)(test::Rolling(ball, 0, 0).dots, none);
  CHECK(!is_finite(unknown.rotation_sd_rad));
}

TEST_CASE("object motion: standard deviations of dots at rest, by hand") {
  // 4 x 5 dots 2 mm apart, wherever they lie: four have one error, and so had they at first
  const double pitch_mm = 2, noise_mm = 0.02;
  const bool aside = GENERATE(false, true);
  const auto first = aside ? Point2<double>{5, -9} : Point2<double>{-4, -3};
  test::Image<Vector> dots(4, 5);
  for (Index i = 0; i < 4; ++i) {
    for (Index j = 0; j < 5; ++j) {
      dots(i, j) = {first.x + pitch_mm * double(j), first.y + pitch_mm * double(i), 10};
    }
  }
  const double spread_sq = square(pitch_mm) * (4 * 10 + 5 * 5);  // about their middle
  const Flags all(4, 5, 1), none(4, 5, 0);
  ObjectMotion<> motion(4, 5);
  (void)motion(dots, all, none, noise_mm);
  auto r = motion(dots, all, none, noise_mm);
  // the dots fit; 0.009 mm of their depth may be the window's
  CHECK(r.rotation_sd_rad == Approx(0.009 * std::sqrt(2 * 16 / spread_sq)));
  CHECK(r.position_sd_mm == Approx(noise_mm * std::sqrt(2 * 4 / 20.0)));
  // up and down, alike on both sides of the middle: no rotation fits, and six of 60 numbers are
  for (Index i = 0; i < 4; ++i) {
    for (Index j = 0; j < 5; ++j) {
      dots(i, j).z += (i == 0 || i == 3 ? 1 : -1) * 0.03;
    }
  }
  r = motion(dots, all, none, noise_mm);
  const double wider_sq = spread_sq + 20 * square(0.03);
  CHECK(r.residual_rms_mm == Approx(0.03));
  CHECK(r.rotation_sd_rad == Approx(std::hypot(0.03 * std::sqrt(60 / 54.0), 0.009) *
                                    std::sqrt(16 / spread_sq + 16 / wider_sq)));
}

TEST_CASE("object motion: a pose whose residual exceeds the noise is doubtful") {
  const test::RollingBall ball{.rows = 11, .cols = 11, .patch_mm = 6};
  const Flags none(11, 11, 0);
  test::Rolling roll(ball, 0, 0);
  test::Gauss gauss(2);
  for (const double times : {1.0, 2.5}) {
    ObjectMotion<> motion(11, 11);
    int doubtful = 0;
    for (int k = 0; k < 40; ++k) {
      const auto dots = noisy(roll.dots, roll.contact, gauss, 0.005 * times, 0.025 * times);
      const auto r = motion(dots, roll.contact, none, 0.025);
      CHECK(r.has_pose());
      CHECK(r.ok() == (r.residual_rms_mm <= 1.4 * 0.025));
      doubtful += r.status == MotionStatus::doubtful ? 1 : 0;
      CHECK(motion(dots, roll.contact).ok());  // without a noise it is not judged
    }
    CHECK((times > 2 ? doubtful > 35 : doubtful == 0));
  }
}

TEST_CASE("object motion: other sizes do nothing") {
  const Dots free = small_grid();
  ObjectMotion<> motion(7, 7);
  (void)motion(free, Flags(7, 7, 1));
  for (const auto& r :
       {motion(Dots(7, 8), Flags(7, 8, 1)), motion(free, Flags(8, 7, 1)),
        motion(Dots(0, 0), Flags(0, 0, 1)), motion(free, Flags(7, 7, 1), Flags(6, 7, 0))}) {
    CHECK(r.status == MotionStatus::no_pose);
    CHECK(r.object == 1);
    CHECK(says_nothing(r));
  }
  CHECK(motion(free, Flags(7, 7, 1)).ok());
}

TEST_CASE("object motion: a single dot at the end of a row is found, and may touch or slip") {
  const Dots free = test::RollingBall{.rows = 4, .cols = 6}.initial();
  ObjectMotion<> motion(4, 6);
  for (const DotIndex at : {DotIndex{0, 5}, DotIndex{3, 0}, DotIndex{3, 5}}) {
    const auto only = [&](Index i, Index j) { return DotIndex{i, j} == at; };
    const LazyView dots(4, 6, [&](Index i, Index j) {
      return only(i, j) ? free(i, j) : detail::missing_point<double>();
    });
    const LazyView flags(4, 6, only);
    const Flags none(4, 6, 0), all(4, 6, 1);
    const Dots lost(4, 6, detail::missing_point<double>());
    CHECK(motion(dots, none).status == MotionStatus::no_contact);
    CHECK(motion(lost, none).status == MotionStatus::no_pose);
    CHECK(motion(free, flags).status == MotionStatus::no_pose);
    CHECK(motion(free, flags, none).status != MotionStatus::slipping);
    CHECK(motion(free, flags, all).status == MotionStatus::slipping);
    CHECK(motion(dots, all, all).status == MotionStatus::slipping);
  }
}

TEST_CASE("object motion: dots that are not in mm begin no object") {
  const Flags all(7, 7, 1);
  for (const double unit : {1e-3, 1e-2, 1.0, 100.0}) {
    Dots dots = small_grid();
    for (auto& p : dots.cells) {
      p = unit * p;
    }
    ObjectMotion<> motion(7, 7);
    CHECK(motion(dots, all).ok() == (unit == 1));
  }
  // no membrane lies at or behind the plate; some software marks lost dots by (0, 0, 0)
  Dots dots = small_grid();
  dots(3, 3) = {0, 0, 0};
  dots(3, 4) = {-1, -1, -1};
  ObjectMotion<> motion(7, 7);
  CHECK(motion(dots, all).dots_used == 47);
}

TEST_CASE("object motion: dots that slip do not count, and are entered anew") {
  // Half of the dots stay behind, too many for a robust fit.
  const Dots free = small_grid();
  const Flags contact(7, 7, 1);
  ObjectMotion<> motion(7, 7), blind(7, 7);
  Flags slips(7, 7, 0);
  (void)motion(free, contact, slips);
  (void)blind(free, contact);
  const Pose<double> pose = {test::turned_by({0, 0, 0.1}), {0.4, 0.1, 0}};
  Dots dots = rotated(free, pose);
  for (Index i = 0; i < 7; ++i) {
    for (Index j = 0; j < 4; ++j) {
      dots(i, j) = free(i, j);
      slips(i, j) = 1;
    }
  }
  const auto seen = motion(dots, contact, slips);
  REQUIRE(seen.ok());
  CHECK(seen.dots_used == 21);
  CHECK(error_deg(seen.pose.rotation, pose.rotation) < 1e-9);
  CHECK(norm(seen.pose({1, 2, 10}) - pose({1, 2, 10})) < 1e-9);
  CHECK(error_deg(blind(dots, contact).pose.rotation, pose.rotation) > 1);
  // they stick again at their current positions
  const Dots later = rotated(dots, pose);
  const auto all = motion(later, contact, Flags(7, 7, 0));
  REQUIRE(all.ok());
  (void)motion(rotated(later, pose), contact, Flags(7, 7, 0));
  const auto after = motion(rotated(rotated(later, pose), pose), contact, Flags(7, 7, 0));
  CHECK(after.dots_used == 49);
  CHECK(error_deg(after.pose.rotation, test::turned_by({0, 0, 0.4})) < 1e-6);
}

TEST_CASE(
    "object motion: while the object slides nothing is known of it, after that it is another") {
  const Dots free = small_grid();
  const Flags contact(7, 7, 1);
  ObjectMotion<> motion(7, 7);
  (void)motion(free, contact, Flags(7, 7, 0));
  const Pose<double> pose = {test::turned_by({0, 0, 0.1}), {0.4, 0.1, 0}};
  const auto moved = motion(rotated(free, pose), contact, Flags(7, 7, 0));
  REQUIRE(moved.ok());
  Flags slips(7, 7, 1);
  for (Index j = 0; j < 7; ++j) {
    slips(0, j) = 0;  // 7 of 49 are fewer than a fifth
  }
  const auto slides = motion(free, contact, slips);
  CHECK(slides.status == MotionStatus::slipping);
  CHECK(std::string(name_of(slides.status)) == "slipping");
  CHECK_FALSE(slides.ok());
  CHECK(says_nothing(slides));
  CHECK(slides.object == 1);
  const auto next = motion(free, contact, Flags(7, 7, 0));
  CHECK(next.ok());
  CHECK(next.begun);
  CHECK(next.object == 2);
  // missing contact is no slide
  CHECK(motion(free, Flags(7, 7, 0), slips).status == MotionStatus::no_contact);
}

TEST_CASE("object motion: after a slide an object begins once more than half of the dots stick") {
  const Dots free = small_grid();
  const Flags contact(7, 7, 1);
  ObjectMotion<> motion(7, 7);
  Flags few(7, 7, 1), half(7, 7, 1), most(7, 7, 1);
  for (std::size_t k = 0; k < 25; ++k) {
    few.cells[k] = k < 7 ? 0 : 1;
    half.cells[k] = k < 24 ? 0 : 1;
    most.cells[k] = 0;  // 25 of 49
  }
  CHECK(motion(free, contact, half).begun);  // nothing has slid
  CHECK(motion(free, contact, few).status == MotionStatus::slipping);
  CHECK(motion(free, contact, half).status == MotionStatus::slipping);
  SECTION("then half are enough again") {
    CHECK(motion(free, contact, most).begun);
    CHECK(motion(free, contact, half).ok());
  }
  SECTION("missing dots do not end the slide") {
    const Dots missing(7, 7, {std::nan(""), std::nan(""), std::nan("")});
    CHECK(motion(missing, contact, most).status == MotionStatus::no_pose);
    CHECK(motion(missing, Flags(7, 7, 0), most).status == MotionStatus::no_pose);
    CHECK(motion(free, contact, half).status == MotionStatus::slipping);
  }
  SECTION("another contact has not slid") {
    CHECK(motion(free, Flags(7, 7, 0), most).status == MotionStatus::no_contact);
    CHECK(motion(free, contact, half).begun);
  }
}

namespace {

Pose<double> any_motion(double turn_rad, double shift_mm) {
  const auto any = [](double size) {
    return Vector{test::uniform(-size, size), test::uniform(-size, size),
                  test::uniform(-size, size)};
  };
  return {test::turned_by(any(turn_rad)), any(shift_mm)};
}

/// Dots on a bumpy cap.
Dots any_dots(Index rows, Index cols) {
  Dots dots(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double x = 1.5 * static_cast<double>(j - cols / 2);
      const double y = 1.5 * static_cast<double>(i - rows / 2);
      dots(i, j) = {x + test::uniform(-0.1, 0.1), y + test::uniform(-0.1, 0.1),
                    12 - (x * x + y * y) / 40 + test::uniform(-0.1, 0.1)};
    }
  }
  return dots;
}

Flags any_contact(Index rows, Index cols) {
  Flags flags(rows, cols, 0);
  const double i0 = test::uniform(2, static_cast<double>(rows) - 3);
  const double j0 = test::uniform(2, static_cast<double>(cols) - 3);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      flags(i, j) =
          std::hypot(static_cast<double>(i) - i0, static_cast<double>(j) - j0) < 2.9 ? 1 : 0;
    }
  }
  return flags;
}

Dots moved(Dots dots, const Pose<double>& pose) {
  for (auto& p : dots.cells) {
    p = pose(p);
  }
  return dots;
}

Dots shaken(Dots dots, double mm) {
  for (auto& p : dots.cells) {
    p = {p.x + test::uniform(-mm, mm), p.y + test::uniform(-mm, mm), p.z + test::uniform(-mm, mm)};
  }
  return dots;
}

template <class S>
double distance(const Pose<S>& a, const Pose<S>& b) {
  double worst = 0;
  for (int i = 0; i < 9; ++i) {
    const S d = a.rotation.m[i / 3][i % 3] - b.rotation.m[i / 3][i % 3];
    worst = (std::max)(worst, std::abs(static_cast<double>(d)));
  }
  const Point3<S> t = a.translation_mm - b.translation_mm;
  return worst + std::sqrt(static_cast<double>(squared_norm(t)));
}

struct Scene {
  Dots free;
  std::vector<Dots> dots;
  std::vector<Flags> contact;
};

/// A few frames of a rigidly moving object with some noise.
Scene any_scene(double noise_mm) {
  const Index rows = test::whole(7, 10), cols = test::whole(7, 10);
  Scene s{any_dots(rows, cols), {}, {}};
  const Flags contact = any_contact(rows, cols);
  Dots dots = s.free;
  for (int k = 0; k < 4; ++k) {
    dots = moved(dots, any_motion(0.2, 0.5));
    s.dots.push_back(shaken(dots, noise_mm));
    s.contact.push_back(contact);
  }
  return s;
}

Pose<double> pose_after(const Scene& s) {
  ObjectMotion<> motion(s.free.rows(), s.free.cols());
  Pose<double> pose;
  for (std::size_t k = 0; k < s.dots.size(); ++k) {
    const auto result = motion(s.dots[k], s.contact[k]);
    RC_ASSERT(result.ok());
    pose = result.pose;
  }
  return pose;
}

template <class Map>
Scene mapped(const Scene& s, const Map& map) {
  Scene out{map(s.free), {}, {}};
  for (std::size_t k = 0; k < s.dots.size(); ++k) {
    out.dots.push_back(map(s.dots[k]));
    out.contact.push_back(map(s.contact[k]));
  }
  return out;
}

bool finite(const ObjectMotionResult<double>& r) {
  if (!r.has_pose()) {
    return says_nothing(r);
  }
  bool all = is_finite(r.residual_rms_mm) && is_finite(r.angles.x_rad) &&
             is_finite(r.angles.y_rad) && is_finite(r.angles.z_rad) &&
             is_plausible(r.pose.translation_mm);
  for (int i = 0; i < 9; ++i) {
    all = all && is_finite(r.pose.rotation.m[i / 3][i % 3]);
  }
  return all && (!r.ok() || (is_finite(r.position_mm.x) && is_finite(r.displacement_mm.z)));
}

}  // namespace

TEST_CASE("a rigid motion of all dots is found", "[object_motion][law]") {
  rc::prop("to roundoff, through any number of frames", [] {
    const Dots free = any_dots(9, 9);
    const Flags contact = any_contact(9, 9);
    ObjectMotion<> motion(9, 9);
    const Dots first = moved(free, any_motion(0.1, 1));
    RC_ASSERT(motion(first, contact).begun);
    Pose<double> pose;
    for (int k = 0; k < 6; ++k) {
      pose = any_motion(0.3, 1) * pose;
      const auto result = motion(moved(first, pose), contact);
      RC_ASSERT(result.ok());
      RC_ASSERT(distance(result.pose, pose) < 2e-12);
      RC_ASSERT(result.residual_rms_mm < 1e-12);
      const auto again = rotation_of(result.angles);
      RC_ASSERT(distance(Pose<double>{again, {}}, Pose<double>{pose.rotation, {}}) < 1e-12);
    }
    // and back
    RC_ASSERT(distance(motion(first, contact).pose, Pose<double>()) < 2e-12);
  });
}

TEST_CASE("a scene seen mirrored, transposed or rotated gives that motion",
          "[object_motion][law]") {
  rc::prop("with noise", [] {
    const Scene scene = any_scene(0.05);
    const Pose<double> pose = pose_after(scene);
    const auto seen = [&](const auto& place, const auto& point, bool swaps) {
      const auto map = [&](const auto& grid) {
        auto out = grid;
        out = std::decay_t<decltype(grid)>(swaps ? grid.cols() : grid.rows(),
                                           swaps ? grid.rows() : grid.cols());
        for (Index i = 0; i < grid.rows(); ++i) {
          for (Index j = 0; j < grid.cols(); ++j) {
            const auto [r, c] = place(i, j, grid.rows(), grid.cols());
            if constexpr (std::is_same_v<std::decay_t<decltype(grid)>, Dots>) {
              out(r, c) = point(grid(i, j));
            } else {
              out(r, c) = grid(i, j);
            }
          }
        }
        return out;
      };
      const Pose<double> other = pose_after(mapped(scene, map));
      for (const Vector& p : {Vector{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
        const Vector off = other(point(p)) - point(pose(p));
        RC_ASSERT(squared_norm(off) < 1e-20);
      }
    };
    using At = std::pair<Index, Index>;
    seen([](Index i, Index j, Index, Index cols) { return At(i, cols - 1 - j); },
         [](const Vector& p) {
           return Vector{-p.x, p.y, p.z};
         },
         false);
    seen([](Index i, Index j, Index rows, Index) { return At(rows - 1 - i, j); },
         [](const Vector& p) {
           return Vector{p.x, -p.y, p.z};
         },
         false);
    seen([](Index i, Index j, Index, Index) { return At(j, i); },
         [](const Vector& p) {
           return Vector{p.y, p.x, p.z};
         },
         true);
    // deeper, because a dot that the turn puts above the plate is a missing one
    const Pose<double> turn{rotation_of(Angles<double>{0.3, 0.5, -0.7}), {0, 0, 30}};
    seen([](Index i, Index j, Index, Index) { return At(i, j); },
         [&](const Vector& p) { return turn(p); }, false);
  });
}

TEST_CASE("dots that come and go never give a wrong or a meaningless pose",
          "[object_motion][law]") {
  rc::prop("of a rigid motion", [] {
    const Dots free = any_dots(9, 9);
    const Flags contact = any_contact(9, 9);
    ObjectMotion<> motion(9, 9);
    RC_ASSERT(motion(free, contact).begun);
    Pose<double> pose;
    const auto share = test::whole(0, 90);
    for (int k = 0; k < 12; ++k) {
      pose = any_motion(0.1, 0.5) * pose;
      Dots dots = moved(free, pose);
      Flags flags = contact;
      for (std::size_t c = 0; c < dots.cells.size(); ++c) {
        if (test::whole(0, 99) < share) {
          dots.cells[c].z = std::nan("");
          flags.cells[c] = test::whole(0, 1) == 0 ? flags.cells[c] : 0;
        }
      }
      const auto result = motion(dots, flags);
      RC_ASSERT(finite(result));
      if (result.ok()) {
        RC_ASSERT(distance(result.pose, pose) < 1e-10);
      }
      if (result.status == MotionStatus::no_contact) {
        break;  // all remaining dots were out of contact, so the object counts as gone
      }
    }
  });
}

TEST_CASE("no pose spans a slide, and none begins in one", "[object_motion][law]") {
  rc::prop("whichever dots slip", [] {
    const Dots free = any_dots(9, 9);
    const Flags contact = any_contact(9, 9);
    ObjectMotion<> motion(9, 9);
    Index touching = 0;
    for (const auto flag : contact.cells) {
      touching += flag != 0 ? 1 : 0;
    }
    bool slid = false, has_object = false;
    Index objects = 0;
    for (int k = 0; k < 20; ++k) {
      Flags slips(9, 9, 0);
      const auto share = test::whole(0, 100);
      Index steady = 0;
      for (std::size_t c = 0; c < slips.cells.size(); ++c) {
        slips.cells[c] = test::whole(1, 100) <= share ? 1 : 0;
        steady += contact.cells[c] != 0 && slips.cells[c] == 0 ? 1 : 0;
      }
      const auto result = motion(free, contact, slips);
      const bool slides = 5 * steady < touching || (slid && 2 * steady <= touching);
      RC_ASSERT((result.status == MotionStatus::slipping) == slides);
      RC_ASSERT(result.object == objects + (result.begun ? 1 : 0));
      RC_ASSERT(!result.begun || !has_object);
      objects = result.object;
      has_object = !slides && (has_object || result.begun);
      slid = slides || (slid && !result.begun);
    }
  });
}

TEST_CASE("nothing is worse than a status", "[object_motion][law]") {
  rc::prop("whatever the dots, the flags and the sizes", [] {
    const Index rows = test::whole(0, 7), cols = test::whole(0, 7);
    const auto bad = [](double good) {
      const double infinity = std::numeric_limits<double>::infinity();
      const double max = std::numeric_limits<double>::max();
      return *rc::gen::element(good, good, good, good, good, good, 0.0, 1e-310, 1e5, max, -max,
                               std::nan(""), infinity, -infinity);
    };
    const auto any = [&](Index r, Index c) {
      Dots dots(r, c);
      const auto kind = test::whole(0, 3);
      for (Index i = 0; i < r; ++i) {
        for (Index j = 0; j < c; ++j) {
          const double x = static_cast<double>(j), y = static_cast<double>(i);
          dots(i, j) = kind == 0   ? Vector{3, 4, 5}
                       : kind == 1 ? Vector{x, x, x}
                       : kind == 2 ? Vector{x, y, test::uniform(9, 10)}
                                   : Vector{bad(x), bad(y), bad(9)};
        }
      }
      return dots;
    };
    ObjectMotion<> motion(rows, cols);
    ObjectMotion<float> in_float(rows, cols);
    for (int k = 0; k < 5; ++k) {
      const bool other = test::whole(0, 9) == 0;
      const Dots dots = any(rows + (other ? 1 : 0), cols);
      Flags flags(dots.rows(), cols, 0);
      const auto share = test::whole(0, 120);
      for (auto& f : flags.cells) {
        f = test::whole(0, 99) < share ? 1 : 0;
      }
      const auto result = motion(dots, flags);
      RC_ASSERT(!other || !result.has_pose());
      RC_ASSERT(finite(result));
      RC_ASSERT(!result.ok() || (result.dots_used >= 3 && result.residual_rms_mm >= 0));
      const auto single = in_float(dots, flags);
      RC_ASSERT(!single.ok() || is_finite(single.pose.rotation(0, 0)));
      RC_ASSERT(!single.ok() || is_finite(single.position_mm.z));
    }
  });
}

TEST_CASE("object motion: follows in 50 digits", "[object_motion]") {
  using S = test::Digits50;
  const test::RollingBall ball;
  test::Rolling roll(ball, -3, 1);
  ObjectMotion<S> digits(21, 21);
  ObjectMotion<> in_double(21, 21);
  test::Gauss gauss(3);
  for (int k = 0; k < 8; ++k) {
    const auto dots = noisy(roll.dots, roll.contact, gauss);
    const auto exact = digits(dots, roll.contact);
    const auto close = in_double(dots, roll.contact);
    REQUIRE(exact.ok());
    for (int i = 0; i < 9; ++i) {
      const S error = exact.pose.rotation.m[i / 3][i % 3] - S(close.pose.rotation.m[i / 3][i % 3]);
      CHECK(std::abs(static_cast<double>(error)) < 1e-12);
    }
    roll.step(-3 + 0.5 * (k + 1), 1);
  }
}
