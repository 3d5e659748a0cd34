// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties of the shift of every contact, for any dots.
#include "fingerpad/motion/contact_shift.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"
#include "support/shift_ways.hpp"

using namespace fingerpad;
using test::ContactDots;
using test::Digits50;
using test::EdgeDots;
using test::HuberMean;
using test::Image;
using test::PlainMean;
using test::shift_by;

namespace test {

template <class Real>
Tangent<Real> atan2(const Tangent<Real>& y, const Tangent<Real>& x) {
  using std::atan2;
  return {Real(atan2(y.v, x.v)), Real((x.v * y.d - y.v * x.d) / (x.v * x.v + y.v * y.v))};
}

}  // namespace test

namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
using Points = Image<Point2<double>>;
using Mask = Image<std::uint8_t>;

/// A rotation followed by a shift.
struct Rigid {
  double angle_rad = 0;
  double x = 0;
  double y = 0;
  Point2<double> rotated(const Point2<double>& p) const {
    const double c = std::cos(angle_rad), s = std::sin(angle_rad);
    return {c * p.x - s * p.y, s * p.x + c * p.y};
  }
  Point2<double> operator()(const Point2<double>& p) const {
    const auto t = rotated(p);
    return {t.x + x, t.y + y};
  }
};
Points moved(Points dots, const Rigid& motion) {
  for (auto& p : dots.cells) {
    p = motion(p);
  }
  return dots;
}

/// Dots every 1.5 mm about the origin, with a small jitter of each.
Points printed(Index rows = 21, Index cols = 21, double jitter_mm = 0.05) {
  Points dots(rows, cols);
  test::Random random(1);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      dots(i, j) = {1.5 * static_cast<double>(j - cols / 2) + jitter_mm * random.uniform(-1, 1),
                    1.5 * static_cast<double>(i - rows / 2) + jitter_mm * random.uniform(-1, 1)};
    }
  }
  return dots;
}
/// Dots within `radius` steps of the middle.
Mask disc(Index rows = 21, Index cols = 21, double radius = 5.2) {
  Mask mask(rows, cols, 0);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double r =
          std::hypot(static_cast<double>(i - rows / 2), static_cast<double>(j - cols / 2));
      mask(i, j) = r < radius ? 1 : 0;
    }
  }
  return mask;
}
constexpr Index in_disc = 89;

/// Shift of one frame.
template <class Dots, class Mean = PlainMean, class S = double, class Free, class Grid, class Flags>
ShiftResult<S> shift(const Free& free, const Grid& dots, const Flags& contact) {
  ContactShift<S> estimator(free, shift_by<Dots, Mean>());
  return estimator(dots, contact);
}

bool has_no_answer(const ShiftResult<double>& r) {
  return !r.has_displacement() && std::isnan(r.displacement.x) && std::isnan(r.displacement.y) &&
         std::isnan(r.rotation_rad) && std::isnan(r.residual_rms) && r.dots == 0;
}

}  // namespace

TEMPLATE_TEST_CASE("contact shift: angles near half a turn do not wrap",
                   "[contact_shift]",
                   EdgeDots,
                   ContactDots) {
  const Points free = printed();
  for (const double angle : {pi - 1e-7, pi - 0.01, -pi + 1e-7, -pi + 0.01, 3.0, -3.0}) {
    // noise that moves some of the dots across the cut and not others
    Points dots = moved(free, {angle, 1, 2});
    test::Random random(2);
    for (auto& p : dots.cells) {
      p = {p.x + 0.02 * random.normal(), p.y + 0.02 * random.normal()};
    }
    const double plain = shift<TestType>(free, dots, disc()).rotation_rad;
    const double robust = shift<TestType, HuberMean>(free, dots, disc()).rotation_rad;
    CHECK(std::abs(std::remainder(plain - angle, 2 * pi)) < 2e-3);
    CHECK(std::abs(std::remainder(robust - angle, 2 * pi)) < 2e-3);
    CHECK(std::abs(plain) <= pi);
  }
  const auto r = shift<TestType>(free, moved(free, {pi, 0, 0}), disc());
  CHECK(std::abs(r.rotation_rad) == Approx(pi));
}

TEST_CASE("contact shift: of dots in space only the plane counts, in float or double",
          "[contact_shift]") {
  const Points free = printed(9, 9), dots = moved(free, {0.05, 0.5, -1});
  const Mask contact = disc(9, 9, 3);
  const auto expected = shift<EdgeDots, HuberMean>(free, dots, contact);
  const auto in_space = [](const Points& from) {
    Image<Point3<float>> to(9, 9);
    for (std::size_t k = 0; k < to.cells.size(); ++k) {
      to.cells[k] = {static_cast<float>(from.cells[k].x), static_cast<float>(from.cells[k].y),
                     static_cast<float>(test::nan)};
    }
    return to;
  };
  const auto r = shift<EdgeDots, HuberMean>(in_space(free), in_space(dots), contact);
  CHECK(r.status == expected.status);
  CHECK(r.dots == expected.dots);
  CHECK(std::abs(r.displacement.x - expected.displacement.x) < 1e-5);
  CHECK(std::abs(r.rotation_rad - expected.rotation_rad) < 1e-6);
}

TEMPLATE_TEST_CASE("contact shift: dots that are missing do not count",
                   "[contact_shift]",
                   PlainMean,
                   HuberMean) {
  const Points free = printed();
  const Rigid motion{0.1, 0.5, -0.25};
  const Points dots = moved(free, motion);
  const Mask contact = disc();
  for (const double gone : {test::nan, infinity, -infinity, 1e300, -1e300, 1e7}) {
    Points gaps = dots, holes = free;
    Index left = in_disc;
    for (Index k = 0; k < 21; ++k) {  // along two lines
      gaps(k, 10).x = gone;
      holes(10, k).y = gone;
      left -= contact(k, 10) + contact(10, k);
    }
    left += 1;  // the middle is on both
    CAPTURE(gone);
    for (const auto& r : {shift<ContactDots, TestType>(holes, gaps, contact),
                          shift<EdgeDots, TestType>(holes, gaps, contact)}) {
      REQUIRE(r.status == ShiftStatus::measured);
      CHECK(r.rotation_rad == Approx(0.1).epsilon(1e-13));
      CHECK(r.residual_rms < 1e-13);
    }
    CHECK(shift<ContactDots, TestType>(holes, gaps, contact).dots == left);
    const auto in_float = shift<ContactDots, TestType, float>(holes, gaps, contact);
    REQUIRE(in_float.status == ShiftStatus::measured);
    CHECK(in_float.dots == left);
    CHECK(static_cast<double>(in_float.rotation_rad) == Approx(0.1).margin(1e-6));
  }
}

TEMPLATE_TEST_CASE("contact shift: too few dots for an angle, or for anything",
                   "[contact_shift]",
                   PlainMean,
                   HuberMean) {
  const Points free = printed(5, 5, 0);
  Points dots = moved(free, {0, 1, 2});
  Mask contact(5, 5, 0);
  SECTION("one") {
    contact(1, 3) = 1;
    const auto r = shift<ContactDots, TestType>(free, dots, contact);
    CHECK(r.status == ShiftStatus::one_place_only);
    CHECK(r.has_displacement());
    CHECK(r.dots == 1);
    CHECK(r.displacement.x == 1);
    CHECK(r.displacement.y == 2);
    CHECK(std::isnan(r.rotation_rad));
    CHECK(r.residual_rms == 0);
    // beside it are eight that are not in contact
    CHECK(shift<EdgeDots, TestType>(free, dots, contact).dots == 9);
  }
  SECTION("two") {
    contact(1, 3) = contact(4, 0) = 1;
    const auto r = shift<ContactDots, TestType>(free, moved(free, {0.7, 0, 0}), contact);
    CHECK(r.status == ShiftStatus::measured);
    CHECK(r.dots == 2);
    CHECK(r.rotation_rad == Approx(0.7).epsilon(1e-14));
  }
  SECTION("all in one place, in the frame or in the reference") {
    test::Random random(4);
    for (int k = 0; k < 50; ++k) {
      // the rounded sum of 25 equal positions, over 25, is not the position
      const Point2<double> place = {random.uniform(-20, 20), random.uniform(-20, 20)};
      const Points heap(5, 5, place);
      for (const auto& r : {shift<ContactDots, TestType>(free, heap, Mask(5, 5, 1)),
                            shift<ContactDots, TestType>(heap, free, Mask(5, 5, 1)),
                            shift<ContactDots, TestType>(heap, heap, Mask(5, 5, 1))}) {
        CHECK(r.status == ShiftStatus::one_place_only);
        CHECK(r.dots == 25);
        CHECK(std::isnan(r.rotation_rad));
        CHECK(is_finite(r.residual_rms));
      }
      const auto moved = shift<ContactDots, TestType>(free, heap, Mask(5, 5, 1)).displacement;
      CHECK(std::abs(moved.x - place.x) < 1e-13);
      CHECK(std::abs(moved.y - place.y) < 1e-13);
    }
  }
  SECTION("none") {
    for (auto& p : dots.cells) {
      p.y = test::nan;
    }
    CHECK(shift<ContactDots, TestType>(free, dots, Mask(5, 5, 1)).status == ShiftStatus::no_dots);
    CHECK(has_no_answer(shift<ContactDots, TestType>(free, dots, Mask(5, 5, 1))));
    CHECK(has_no_answer(shift<ContactDots, TestType>(dots, free, Mask(5, 5, 1))));
    CHECK(has_no_answer(shift<EdgeDots, TestType>(free, dots, disc(5, 5, 2))));
    CHECK(has_no_answer(shift<ContactDots, TestType>(free, free, contact)));
    const Points empty(0, 0);
    const auto r = shift<ContactDots, TestType>(empty, empty, Mask(0, 0));
    CHECK(r.status == ShiftStatus::no_dots);
  }
}

TEST_CASE("contact shift: grids of another size, and copies", "[contact_shift]") {
  const Points free = printed(5, 6);
  ContactShift estimator(free, shift_by<ContactDots>());
  CHECK(estimator.rows() == 5);
  CHECK(estimator.cols() == 6);
  const auto refused = [&](const Points& dots, const Mask& mask) {
    const auto r = estimator(dots, mask);
    return r.status == ShiftStatus::refused && has_no_answer(r);
  };
  CHECK(refused(printed(6, 5), Mask(6, 5, 1)));
  CHECK(refused(printed(5, 5), Mask(5, 5, 1)));
  CHECK(refused(printed(4, 6), Mask(5, 6, 1)));
  CHECK(refused(free, Mask(6, 5, 1)));
  CHECK(refused(free, Mask(5, 7, 1)));
  CHECK(refused(Points(), Mask()));
  CHECK(!refused(free, Mask(5, 6, 1)));
  auto copy = estimator;
  CHECK(copy(free, Mask(5, 6, 1)).dots == 30);
}

TEST_CASE("contact shift: a pair in a row or in a column is pulled apart as far",
          "[contact_shift]") {
  // 10 apart at first. The best rigid motion leaves half of the stretch at each dot, and more than
  // 3/4 of the pitch is not rigid.
  for (const bool in_row : {true, false}) {
    const auto pair = [&](double distance) {
      const Point2<double> end = in_row ? Point2<double>{distance, 0} : Point2<double>{0, distance};
      Points dots(in_row ? 1 : 2, in_row ? 2 : 1, {7, 8});
      dots.cells[1] = dots.cells[0] + end;
      return dots;
    };
    const auto status = [&](double distance) {
      const Points free = pair(10);
      return shift<ContactDots>(free, pair(distance), Mask(free.rows(), free.cols(), 1)).status;
    };
    CAPTURE(in_row);
    CHECK(status(24.9) == ShiftStatus::measured);
    CHECK(status(25.1) == ShiftStatus::not_rigid);
  }
}

TEST_CASE("contact shift: bad parameters are refused by name", "[contact_shift]") {
  const Points free = printed(5, 6);
  const auto huber = [&](double threshold, int passes) {
    return test::refusal(
        [&] { ContactShift(free, {.robust_passes = passes, .threshold = threshold}); });
  };
  CHECK(huber(1.5, 0) == "accepted");
  CHECK(huber(1.5, 100) == "accepted");
  CHECK(huber(0, 10) == "ContactShift: threshold = 0, must be finite and > 0");
  CHECK(test::begins_with(huber(test::nan, 10), "ContactShift: threshold = "));
  CHECK(huber(1.5, -1) == "ContactShift: robust_passes = -1, must be in [0, 100]");
  CHECK(huber(1.5, 101) == "ContactShift: robust_passes = 101, must be in [0, 100]");
}

namespace {

/// The same dots in another number.
template <class S>
Image<std::array<S, 2>> as(const Points& dots) {
  Image<std::array<S, 2>> out(dots.rows(), dots.cols());
  for (std::size_t k = 0; k < dots.cells.size(); ++k) {
    out.cells[k] = {S(dots.cells[k].x), S(dots.cells[k].y)};
  }
  return out;
}
/// Dots rounded to float.
Points rounded(Points dots) {
  for (auto& p : dots.cells) {
    p = {static_cast<double>(static_cast<float>(p.x)),
         static_cast<double>(static_cast<float>(p.y))};
  }
  return dots;
}

/// Errors against 50 digits over angles from 1e-9 to 3.
template <class S, class Mean>
std::array<double, 2> errors(double away, bool in_float) {
  const Mask contact = disc();
  std::array<double, 2> worst{};
  for (const double angle : {0.0, 1e-9, -1e-7, 1e-5, 1e-3, -0.1, 1.0, -3.0}) {
    const Points printed_there = moved(printed(), {0, away, -0.75 * away});
    Points free = printed_there;
    Points dots = moved(printed(), {angle, away + 0.25, -0.75 * away - 0.5});
    test::Random random(5);
    for (auto& p : dots.cells) {
      p = {p.x + 0.01 * random.normal(), p.y + 0.01 * random.normal()};
    }
    if (in_float) {
      free = rounded(free);
      dots = rounded(dots);
    }
    const auto exact =
        shift<EdgeDots, Mean, Digits50>(as<Digits50>(free), as<Digits50>(dots), contact);
    const auto r = shift<EdgeDots, Mean, S>(as<S>(free), as<S>(dots), contact);
    REQUIRE(r.status == exact.status);
    const auto off = [](const S& a, const Digits50& b) {
      return std::abs(static_cast<double>(Digits50(Digits50(a) - b)));
    };
    worst[0] = (std::max)({worst[0], off(r.displacement.x, exact.displacement.x),
                           off(r.displacement.y, exact.displacement.y)});
    worst[1] = (std::max)(worst[1], off(r.rotation_rad, exact.rotation_rad));
  }
  return worst;
}

}  // namespace

TEMPLATE_TEST_CASE("contact shift: follows 50 digits", "[contact_shift]", PlainMean, HuberMean) {
  // The weights of a robust mean follow residuals of 0.01, of which roundoff is a larger share.
  constexpr bool robust = TestType::is_robust;
  SECTION("in double, about the origin, in a corner of an image, and far away") {
    const auto [near_mm, near_rad] = errors<double, TestType>(0, false);
    const auto [px, rad] = errors<double, TestType>(600, false);
    const auto [far_mm, far_rad] = errors<double, TestType>(1e5, false);
    INFO(near_mm << ' ' << near_rad << ", " << px << ' ' << rad << ", " << far_mm << ' '
                 << far_rad);
    CHECK(near_mm < (robust ? 1e-12 : 2e-14));
    CHECK(near_rad < 2e-15);
    CHECK(px < (robust ? 1e-10 : 1e-11));
    CHECK(rad < (robust ? 1e-13 : 2e-15));
    CHECK(far_mm < 1e-8);
    CHECK(far_rad < (robust ? 1e-11 : 1e-13));
  }
  SECTION("in float, whose sums of places far from the origin are coarse") {
    const auto [near_mm, near_rad] = errors<float, TestType>(0, true);
    const auto [px, rad] = errors<float, TestType>(600, true);
    INFO(near_mm << ' ' << near_rad << ", " << px << ' ' << rad);
    CHECK(near_mm < (robust ? 5e-4 : 1e-5));
    CHECK(near_rad < 1e-6);
    CHECK(px < (robust ? 0.05 : 0.01));
    CHECK(rad < 2e-5);
  }
}

TEMPLATE_TEST_CASE("contact shift: derivatives are those of differences",
                   "[contact_shift]",
                   EdgeDots,
                   ContactDots) {
  const Points free = printed(9, 9);
  test::Random random(5);
  Points dots = moved(free, {0.2, 0.5, -1});
  for (auto& p : dots.cells) {
    p = {p.x + 0.05 * random.normal(), p.y + 0.05 * random.normal()};
  }
  const Mask contact = disc(9, 9, 3);
  for (const auto& [row, col] : {std::pair<Index, Index>{4, 4}, {2, 3}, {6, 5}, {4, 7}}) {
    const auto at = [&, row = row, col = col]<class S>(const S& change) {
      auto pushed = as<S>(dots);
      pushed(row, col)[0] = S(pushed(row, col)[0] + change);
      const auto r = shift<TestType, PlainMean, S>(as<S>(free), pushed, contact);
      return std::array<S, 3>{r.displacement.x, r.displacement.y, r.rotation_rad};
    };
    using Tangent = test::Tangent<Digits50>;
    const Digits50 h("1e-15");
    const auto dual = at(Tangent(Digits50(0), Digits50(1)));
    const auto above = at(h), below = at(Digits50(-h));
    for (std::size_t k = 0; k < 3; ++k) {
      const Digits50 slope = (above[k] - below[k]) / (2 * h);
      CHECK(std::abs(static_cast<double>(Digits50(dual[k].d - slope))) < 1e-20);
    }
  }
}

namespace {

using TouchMask = Image<Touch>;

template <class Map>
Points mapped(Points dots, const Map& map) {
  for (auto& p : dots.cells) {
    p = map(p);
  }
  return dots;
}
Rigid any_motion(double turn_rad = pi) {
  return {test::uniform(-turn_rad, turn_rad), test::uniform(-20, 20), test::uniform(-20, 20)};
}

Points any_dots(Index rows, Index cols) {
  Points dots(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      dots(i, j) = {1.5 * static_cast<double>(j) + test::uniform(-0.2, 0.2),
                    1.5 * static_cast<double>(i) + test::uniform(-0.2, 0.2)};
    }
  }
  return dots;
}
Points shaken(Points dots, double mm) {
  for (auto& p : dots.cells) {
    p = {p.x + test::uniform(-mm, mm), p.y + test::uniform(-mm, mm)};
  }
  return dots;
}

/// Any mask, with a few unknown dots.
TouchMask any_contact(Index rows, Index cols) {
  TouchMask mask(rows, cols, Touch::none);
  for (Touch& touch : mask.cells) {
    const auto what = test::whole(0, 9);
    touch = what < 5 ? Touch::contact : what < 9 ? Touch::none : Touch::unknown;
  }
  return mask;
}

/// Frames of dots that move rigidly except for some noise, with enough dots to determine the
/// motion.
struct Scene {
  Points free;
  Points dots;
  TouchMask contact;
};
Scene any_scene(double noise_mm = 0.05) {
  const Index rows = test::whole(3, 8), cols = test::whole(3, 8);
  Scene s{any_dots(rows, cols), {}, any_contact(rows, cols)};
  for (Index i = 0; i < 2; ++i) {  // ensures an edge
    s.contact(0, i) = Touch::contact;
    s.contact(2, i) = Touch::none;
    s.contact(1, i) = Touch::contact;
  }
  s.dots = shaken(mapped(s.free, any_motion(3)), noise_mm);
  return s;
}

template <class Dots, class Mean>
ShiftResult<double> shift(const Scene& s, const Mean& mean = {}) {
  ContactShift estimator(s.free, shift_by<Dots>(mean));
  return estimator(s.dots, s.contact);
}

/// Distance of two angles, modulo a full turn.
double apart(double a, double b) {
  return std::abs(std::remainder(a - b, 2 * pi));
}
double apart(const Point2<double>& a, const Point2<double>& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

template <class Dots_, class Mean_>
struct SceneWay {
  using Dots = Dots_;
  using Mean = Mean_;
  static ShiftResult<double> of(const Scene& s) { return shift<Dots>(s, Mean()); }
};

/// Roundoff, and for a robust mean its effect on the weights.
template <class SceneWay>
constexpr double tolerance = SceneWay::Mean::is_robust ? 1e-9 : 1e-12;

}  // namespace

TEMPLATE_TEST_CASE("contact shift: the axes are a matter of choice",
                   "[contact_shift][law]",
                   (SceneWay<EdgeDots, PlainMean>),
                   (SceneWay<EdgeDots, HuberMean>),
                   (SceneWay<ContactDots, PlainMean>),
                   (SceneWay<ContactDots, HuberMean>)) {
  rc::prop("rotated and shifted with all dots of both frames, the shift turns with them", [] {
    const Scene s = any_scene();
    const Rigid view = any_motion();
    const auto a = TestType::of(s);
    const auto b = TestType::of({mapped(s.free, view), mapped(s.dots, view), s.contact});
    RC_ASSERT(a.status == ShiftStatus::measured && b.status == a.status && a.dots == b.dots);
    RC_ASSERT(apart(b.displacement, view.rotated(a.displacement)) < tolerance<TestType>);
    RC_ASSERT(apart(a.rotation_rad, b.rotation_rad) < tolerance<TestType>);
    RC_ASSERT(std::abs(a.residual_rms - b.residual_rms) < tolerance<TestType>);
  });
  rc::prop("in a mirror the turn has the other sign", [] {
    const Scene s = any_scene();
    const auto mirror = [](const Point2<double>& p) { return Point2<double>{p.x, -p.y}; };
    const auto a = TestType::of(s);
    const auto b = TestType::of({mapped(s.free, mirror), mapped(s.dots, mirror), s.contact});
    RC_ASSERT(b.displacement.x == a.displacement.x && b.displacement.y == -a.displacement.y);
    RC_ASSERT(b.rotation_rad == -a.rotation_rad);
    RC_ASSERT(b.residual_rms == a.residual_rms);
  });
}

TEST_CASE("contact shift: no rigid motion is nearer to the dots", "[contact_shift][law]") {
  rc::prop("than the plain one", [] {
    const Scene s = any_scene(0.3);
    const auto r = shift<ContactDots, PlainMean>(s);
    // the displacement is measured at the middle of the dots in contact
    Point2<double> middle{0, 0};
    for (std::size_t k = 0; k < s.free.cells.size(); ++k) {
      if (s.contact.cells[k] == Touch::contact) {
        middle.x += s.free.cells[k].x / static_cast<double>(r.dots);
        middle.y += s.free.cells[k].y / static_cast<double>(r.dots);
      }
    }
    const auto misfit = [&](double angle, double x, double y) {
      const Rigid turn{angle, middle.x + x, middle.y + y};
      double sum = 0;
      for (std::size_t k = 0; k < s.free.cells.size(); ++k) {
        if (s.contact.cells[k] == Touch::contact) {
          const auto& p = s.free.cells[k];
          sum += square(apart(turn({p.x - middle.x, p.y - middle.y}), s.dots.cells[k]));
        }
      }
      return std::sqrt(sum / static_cast<double>(r.dots));
    };
    const double best = misfit(r.rotation_rad, r.displacement.x, r.displacement.y);
    RC_ASSERT(std::abs(best - r.residual_rms) < 1e-12);
    const double size = test::log_uniform(1e-5, 1);
    RC_ASSERT(misfit(r.rotation_rad + size * test::uniform(-1, 1),
                     r.displacement.x + size * test::uniform(-1, 1),
                     r.displacement.y + size * test::uniform(-1, 1)) > best - 1e-15);
  });
}

TEST_CASE("contact shift: which dots take part", "[contact_shift][law]") {
  rc::prop("those beside the other side of the edge, and no others, whatever the mask", [] {
    const Index rows = test::whole(1, 6), cols = test::whole(1, 6);
    Scene s{any_dots(rows, cols), {}, any_contact(rows, cols)};
    s.dots = s.free;
    Image<int> placed(rows, cols, 1), in_reference(rows, cols, 1);
    for (std::size_t k = 0; k < placed.cells.size(); ++k) {
      if (test::whole(0, 9) == 0) {
        placed.cells[k] = 0;
        s.dots.cells[k].y = test::nan;
      }
      if (test::whole(0, 9) == 0) {
        in_reference.cells[k] = 0;
        s.free.cells[k].x = -test::nan;
      }
    }
    const auto side = [&](Index i, Index j) {  // 0: of neither side
      const Touch touch = s.contact(i, j);
      return placed(i, j) == 0 || touch == Touch::unknown ? 0 : touch == Touch::contact ? 1 : -1;
    };
    Index edge = 0, inside = 0;
    Point2<double> push{0, 0};
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        bool beside = false;
        for (Index k = 0; k < rows; ++k) {
          for (Index l = 0; l < cols; ++l) {
            beside = beside || (std::abs(i - k) <= 1 && std::abs(j - l) <= 1 &&
                                side(i, j) * side(k, l) == -1);
          }
        }
        inside += side(i, j) == 1 && in_reference(i, j) != 0 ? 1 : 0;
        const bool counts = beside && in_reference(i, j) != 0;
        edge += counts ? 1 : 0;
        if (test::whole(0, 1) == 1) {  // random: its position shows whether it counts
          const double x = std::ldexp(1.0, static_cast<int>(test::whole(-12, -3)));
          s.dots(i, j).x += x;
          push.x += counts ? x : 0;
        }
      }
    }
    RC_ASSERT((shift<ContactDots, PlainMean>(s).dots == inside));
    const auto r = shift<EdgeDots, PlainMean>(s);
    RC_ASSERT(r.dots == edge);
    RC_ASSERT(r.has_displacement() == (edge > 0));
    if (edge > 0) {
      const double expected = push.x / static_cast<double>(edge);
      RC_ASSERT(std::abs(r.displacement.x - expected) < 1e-10);
    }
  });
}

TEST_CASE("contact shift: mistaken dots", "[contact_shift][law]") {
  // The other dots move rigidly to roundoff, so leaving out the mistaken ones loses nothing.
  rc::prop("a few, however far off, do not move a robust mean", [] {
    Scene s{any_dots(8, 8), {}, TouchMask(8, 8, Touch::contact)};
    const Rigid motion = any_motion(0.5);
    s.dots = mapped(s.free, motion);
    const auto wrong = test::whole(1, 8);
    for (Index k = 0; k < wrong; ++k) {
      const double far = test::log_uniform(0.1, 100), angle = test::uniform(-pi, pi);
      auto& p = s.dots(test::whole(0, 7), test::whole(0, 7));
      p = {p.x + far * std::cos(angle), p.y + far * std::sin(angle)};
    }
    const auto robust = shift<ContactDots>(s, HuberMean{.passes = 100});
    RC_ASSERT(robust.status == ShiftStatus::measured);
    RC_ASSERT(apart(robust.rotation_rad, motion.angle_rad) < 1e-6);
  });
}

TEMPLATE_TEST_CASE("contact shift: whatever the dots, the answer says what it is worth",
                   "[contact_shift][law]",
                   double,
                   float) {
  using S = TestType;
  rc::prop("statuses, counts and finite numbers agree, and nothing throws", [] {
    const Index rows = test::whole(0, 5), cols = test::whole(0, 5);
    const auto any_coordinate = [] {
      const S odd[] = {S(0),
                       std::numeric_limits<S>::quiet_NaN(),
                       std::numeric_limits<S>::infinity(),
                       -std::numeric_limits<S>::infinity(),
                       std::numeric_limits<S>::max(),
                       std::numeric_limits<S>::denorm_min(),
                       S(999999),
                       S(-999999),
                       S(1e6)};
      const auto k = test::whole(0, 29);
      return k < 9 ? odd[k] : static_cast<S>(test::uniform(-20, 20));
    };
    Image<Point2<S>> free(rows, cols), dots(rows, cols);
    const TouchMask contact = any_contact(rows, cols);
    for (auto* image : {&free, &dots}) {
      for (auto& p : image->cells) {
        p = {any_coordinate(), any_coordinate()};
      }
    }
    const auto check = [&](const ShiftOptions& options) {
      ContactShift<S> estimator(free, options);
      const auto r = estimator(dots, contact);
      RC_ASSERT(r.status != ShiftStatus::refused);
      RC_ASSERT(r.dots >= 0 && r.dots <= rows * cols);
      RC_ASSERT(is_finite(r.displacement.x) == r.has_displacement());
      RC_ASSERT(is_finite(r.displacement.y) == r.has_displacement());
      if (r.status == ShiftStatus::measured) {
        RC_ASSERT(is_finite(r.rotation_rad));
        RC_ASSERT(std::abs(static_cast<double>(r.rotation_rad)) < pi + 1e-6);
        RC_ASSERT(is_finite(r.residual_rms) && r.residual_rms >= 0);
        RC_ASSERT(r.dots >= 2);
      }
      if (r.status == ShiftStatus::one_place_only) {
        RC_ASSERT(!is_finite(r.rotation_rad));
      }
    };
    check(shift_by<EdgeDots, PlainMean>());
    check(shift_by<EdgeDots, HuberMean>());
    check(shift_by<ContactDots, PlainMean>());
    check(shift_by<ContactDots, HuberMean>());
  });
}
