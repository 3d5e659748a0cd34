// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties of the shift of every contact, for any dots.
#include "fingerpad/motion/contact_shift.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <type_traits>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pad.hpp"
#include "support/shift_ways.hpp"

using namespace fingerpad;
using test::ContactDots;
using test::EdgeDots;
using test::HuberMean;
using test::Image;
using test::PlainMean;
using test::shift_by;

namespace {

constexpr double pi = std::numbers::pi;
using Points = Image<Point2<double>>;
using Mask = Image<Touch>;

/// A rotation followed by a shift.
struct Rigid {
  double angle_rad;
  double x;
  double y;
  Point2<double> rotated(const Point2<double>& p) const {
    const double c = std::cos(angle_rad), s = std::sin(angle_rad);
    return {c * p.x - s * p.y, s * p.x + c * p.y};
  }
  Point2<double> operator()(const Point2<double>& p) const {
    const auto t = rotated(p);
    return {t.x + x, t.y + y};
  }
};
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
Mask any_contact(Index rows, Index cols) {
  Mask mask(rows, cols, Touch::none);
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
  Mask contact;
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
struct Way {
  using Dots = Dots_;
  using Mean = Mean_;
  static ShiftResult<double> of(const Scene& s) { return shift<Dots>(s, Mean()); }
};

/// Roundoff, and for a robust mean its effect on the weights.
template <class Way>
constexpr double tolerance = Way::Mean::is_robust ? 1e-9 : 1e-12;

}  // namespace

TEMPLATE_TEST_CASE("contact shift: the axes are a matter of choice",
                   "[contact_shift][law]",
                   (Way<EdgeDots, PlainMean>),
                   (Way<EdgeDots, HuberMean>),
                   (Way<ContactDots, PlainMean>),
                   (Way<ContactDots, HuberMean>)) {
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
  rc::prop("in another unit the angle is the same", [] {
    const Scene s = any_scene();
    const double unit = std::ldexp(1.0, static_cast<int>(test::whole(-10, 10)));
    const auto scale = [=](const Point2<double>& p) {
      return Point2<double>{unit * p.x, unit * p.y};
    };
    const auto a = TestType::of(s);
    const auto b = TestType::of({mapped(s.free, scale), mapped(s.dots, scale), s.contact});
    RC_ASSERT(b.rotation_rad == a.rotation_rad);
    RC_ASSERT(b.displacement.x == unit * a.displacement.x);
    RC_ASSERT(b.residual_rms == unit * a.residual_rms);
  });
  rc::prop("seen the other way round, the motion is the one back", [] {
    const Scene s = any_scene();
    const auto a = TestType::of(s), b = TestType::of({s.dots, s.free, s.contact});
    RC_ASSERT(apart(a.rotation_rad, -b.rotation_rad) < tolerance<TestType>);
    RC_ASSERT(std::abs(a.residual_rms - b.residual_rms) < tolerance<TestType>);
    RC_ASSERT(TestType::Mean::is_robust ||  // otherwise positions with unequal weights
              apart(a.displacement, {-b.displacement.x, -b.displacement.y}) < 1e-12);
  });
}

TEMPLATE_TEST_CASE("contact shift: motions add",
                   "[contact_shift][law]",
                   (Way<EdgeDots, PlainMean>),
                   (Way<EdgeDots, HuberMean>),
                   (Way<ContactDots, PlainMean>),
                   (Way<ContactDots, HuberMean>)) {
  rc::prop("a rigid motion has its angle, and carries the dots' middle along", [] {
    Scene s = any_scene();
    const Rigid motion = any_motion();
    s.dots = mapped(s.free, motion);
    const auto r = TestType::of(s);
    RC_ASSERT(r.status == ShiftStatus::measured);
    RC_ASSERT(apart(r.rotation_rad, motion.angle_rad) < 1e-13);
    RC_ASSERT(r.residual_rms < 1e-13);
  });
  rc::prop("a further rigid motion adds its angle to that of any dots", [] {
    Scene s = any_scene();
    const Rigid motion = any_motion();
    const auto a = TestType::of(s);
    s.dots = mapped(s.dots, motion);
    const auto b = TestType::of(s);
    RC_ASSERT(apart(b.rotation_rad, a.rotation_rad + motion.angle_rad) < tolerance<TestType>);
    RC_ASSERT(std::abs(a.residual_rms - b.residual_rms) < tolerance<TestType>);
  });
  rc::prop("and a further shift its displacement", [] {
    Scene s = any_scene();
    const Rigid motion{0, test::uniform(-20, 20), test::uniform(-20, 20)};
    const auto a = TestType::of(s);
    s.dots = mapped(s.dots, motion);
    const auto b = TestType::of(s);
    RC_ASSERT(apart(b.rotation_rad, a.rotation_rad) < tolerance<TestType>);
    RC_ASSERT(apart(b.displacement, {a.displacement.x + motion.x, a.displacement.y + motion.y}) <
              tolerance<TestType>);
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
  rc::prop("what the others do is no matter", [] {
    Scene s = any_scene();
    const auto a = shift<ContactDots, HuberMean>(s);
    for (std::size_t k = 0; k < s.dots.cells.size(); ++k) {
      if (s.contact.cells[k] != Touch::contact) {
        s.dots.cells[k] = {test::uniform(-1e3, 1e3), test::nan};
        s.free.cells[k] = {test::uniform(-1e3, 1e3), test::uniform(-1e3, 1e3)};
      }
    }
    const auto b = shift<ContactDots, HuberMean>(s);
    RC_ASSERT(a.displacement.x == b.displacement.x && a.rotation_rad == b.rotation_rad);
    RC_ASSERT(a.dots == b.dots);
  });
  rc::prop("contact and its opposite have the same edge", [] {
    Scene s = any_scene();
    const auto a = shift<EdgeDots, PlainMean>(s);
    for (Touch& touch : s.contact.cells) {
      touch = touch == Touch::contact ? Touch::none
              : touch == Touch::none  ? Touch::contact
                                      : Touch::unknown;
    }
    const auto b = shift<EdgeDots, PlainMean>(s);
    RC_ASSERT(a.dots == b.dots && a.rotation_rad == b.rotation_rad);
    RC_ASSERT(a.displacement.x == b.displacement.x);
  });
}

TEST_CASE("contact shift: mistaken dots", "[contact_shift][law]") {
  // The other dots move rigidly to roundoff, so leaving out the mistaken ones loses nothing.
  rc::prop("a few, however far off, do not move a robust mean", [] {
    Scene s{any_dots(8, 8), {}, Mask(8, 8, Touch::contact)};
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
    const Mask contact = any_contact(rows, cols);
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
