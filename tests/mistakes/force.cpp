// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Responses to mistakes with the forces: each line has a mistake and its response. No mistake gets
// the status ok. Mistakes that a frame does not show come last, with the reason.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "fingerpad/calibrate/rim.hpp"
#include "fingerpad/force/look_up.hpp"
#include "fingerpad/force/traction.hpp"
#include "fingerpad/force/wrench.hpp"
#include "fingerpad/published/friction_ratio.hpp"
#include "fingerpad/published/look_up.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "support/catch.hpp"
#include "support/curves.hpp"
#include "support/pressed_pad.hpp"
#include "support/refusal.hpp"
#include "support/traction_scenes.hpp"

using namespace fingerpad;
using test::Image;
using Vector = Point3<double>;

namespace {

using Pad = test::RoundPad<test::FilmSide>;

/// The shape as a caller might pass it: heights and slopes times factors, with the contact
/// unchanged.
struct Shape {
  Pad pad;
  double height = 1, slope = 1;
  bool touches = true;

  MembranePoint<double> operator()(double x, double y) const {
    const auto true_one = pad(x, y);
    return {height * true_one.height_mm, slope * true_one.along_x, slope * true_one.along_y};
  }
  bool in_contact(double x, double y) const { return touches && pad.in_contact(x, y); }
};

/// A frame of a drag and a twist at 10 kPa, with its estimator, for mistakes to change.
struct Frame {
  Pad pad;
  test::RimOfDots rim = test::rim_of(pad);
  Image<Vector> border = rim.borders();
  Image<Vector> dots;
  Shape shape{pad};
  double pressure_mpa = test::pressed_mpa;
  WrenchOptions<double> options;

  Frame() {
    const double tension = pad.tension(pad.radius_mm, pressure_mpa);
    dots = rim.dots([&](double at) {
      return test::RimLoad{tension * (1 + 0.05 * std::cos(at)),
                           tension * (0.1 - 0.1 * std::sin(at))};
    });
    options.blur_mm = 0;
    options.reach_mm = 1.6;
  }

  /// Column k takes the dot of column from(k).
  template <class From>
  void reorder(const From& from) {
    const Image<Vector> as_it_was = dots;
    for (Index k = 0; k < dots.cols(); ++k) {
      dots(0, k) = as_it_was(0, (from(k) + dots.cols()) % dots.cols());
    }
  }
  void each_dot(const std::function<Vector(const Vector&)>& change) {
    for (Vector& dot : dots.cells) {
      dot = change(dot);
    }
  }
};

WrenchResult<double> seen(const Frame& frame) {
  Wrench<> wrench(frame.border, frame.options);
  return wrench(frame.shape, frame.dots, frame.pressure_mpa);
}

struct WrenchMistake {
  std::string mistake;
  std::function<void(Frame&)> make;
  std::string said;
};

const std::vector<WrenchMistake> wrench_mistakes = {
    {"none", [](Frame&) {}, "ok"},
    {"pressure in kPa", [](Frame& f) { f.pressure_mpa *= 1e3; }, "bad pressure"},
    {"pressure in Pa", [](Frame& f) { f.pressure_mpa *= 1e6; }, "bad pressure"},
    {"pressure in bar", [](Frame& f) { f.pressure_mpa *= 10; }, "pad has changed"},
    {"absolute pressure", [](Frame& f) { f.pressure_mpa += 0.101325; }, "pad has changed"},
    {"pressure below that of the air", [](Frame& f) { f.pressure_mpa = -0.01; }, "bad pressure"},
    {"no pressure and no modulus",
     [](Frame& f) { f.pressure_mpa = test::nan, f.options.modulus_n_per_mm.reset(); },
     "bad pressure"},
    {"side dots shifted by one", [](Frame& f) { f.reorder([](Index k) { return k + 1; }); },
     "bad side dots"},
    {"side dots the other way round", [](Frame& f) { f.reorder([](Index k) { return -k; }); },
     "bad side dots"},
    {"two halves of the side dots exchanged",
     [](Frame& f) { f.reorder([](Index k) { return k + 36; }); }, "bad side dots"},
    {"neighbouring side dots exchanged",
     [](Frame& f) { f.reorder([](Index k) { return k % 2 == 0 ? k + 1 : k - 1; }); },
     "bad side dots"},
    {"side dots below the base",
     [](Frame& f) { f.each_dot([](const Vector& p) {
                      return Vector{p.x, p.y, -p.z};
                    }); },
     "bad side dots"},
    {"x and y of the side dots exchanged",
     [](Frame& f) { f.each_dot([](const Vector& p) {
                      return Vector{p.y, p.x, p.z};
                    }); },
     "bad side dots"},
    {"side dots in metres", [](Frame& f) { f.each_dot([](const Vector& p) { return 1e-3 * p; }); },
     "bad side dots"},
    {"side dots in px",
     [](Frame& f) {
       f.each_dot([](const Vector& p) { return Vector{320 + 12 * p.x, 240 + 12 * p.y, p.z}; });
     },
     "bad side dots"},
    {"side dots as (0, 0, 0) where they are lost",
     [](Frame& f) {
       for (Index k = 0; k < 30; ++k) {
         f.dots(0, k) = {0, 0, 0};
       }
     },
     "bad side dots"},
    {"side dots of the free pad without pressure",
     [](Frame& f) { f.dots = f.rim.dots([](double) {
                      return test::RimLoad{0, 0};
                    }); },
     "bad side dots"},
    {"a side dot as far away as numbers go", [](Frame& f) { f.dots(0, 7).x = 1.7e308; }, "ok"},
    {"side dots times 1e300",
     [](Frame& f) { f.each_dot([](const Vector& p) { return 1e300 * p; }); }, "bad side dots"},
    {"pressure of 1e300", [](Frame& f) { f.pressure_mpa = 1e300; }, "bad pressure"},
    {"length of the side dots in metres", [](Frame& f) { f.options.side_dot_length_mm *= 1e-3; },
     "bad side dots"},
    {"length of the side dots twice as long", [](Frame& f) { f.options.side_dot_length_mm *= 2; },
     "bad side dots"},
    {"length of the side dots half as long", [](Frame& f) { f.options.side_dot_length_mm /= 2; },
     "pad has changed"},
    {"depth in metres", [](Frame& f) { f.shape.height = f.shape.slope = 1e-3; }, "no shape"},
    {"depth in um", [](Frame& f) { f.shape.height = f.shape.slope = 1e3; }, "no shape"},
    {"no depth anywhere",
     [](Frame& f) {
       f.shape.height = f.shape.slope = test::nan;
       f.shape.touches = false;
     },
     "no shape"},
    {"depth upside down", [](Frame& f) { f.shape.height = f.shape.slope = -1; }, "no shape"},
    {"another frame's size",
     [](Frame& f) {
       f.dots = Image<Vector>(1, 71, {0, 0, 0});
     },
     "refused"},
    {"rows and columns of the side dots exchanged",
     [](Frame& f) {
       f.dots = Image<Vector>(72, 1, {0, 0, 0});
     },
     "refused"},
};

}  // namespace

TEST_CASE("mistakes with the six-axis force", "[mistakes]") {
  for (const WrenchMistake& m : wrench_mistakes) {
    INFO(m.mistake);
    Frame frame;
    // the modulus is that of calibrate/rim.hpp
    frame.options.modulus_n_per_mm = frame.rim.modulus_n_per_mm;
    m.make(frame);
    const auto r = seen(frame);
    CHECK(name_of(r.status) == m.said);
    CHECK(r.ok() == (m.said == "ok"));
    CHECK(is_finite(r.force_n) == r.ok());
  }
}

TEST_CASE("mistakes with the six-axis force: a calibrated modulus", "[mistakes]") {
  Frame frame;
  frame.options.modulus_n_per_mm = frame.rim.modulus_n_per_mm;
  Wrench<> wrench(frame.border, frame.options);
  const auto at = [&](double pressure_mpa) {
    return wrench(frame.shape, frame.dots, pressure_mpa).status;
  };
  CHECK(at(0.01) == WrenchStatus::ok);
  CHECK(at(0.01 + 0.101325) == WrenchStatus::pad_has_changed);
  // undetectable without a calibration: a stiffer membrane at a higher pressure looks the same
  frame.options.modulus_n_per_mm.reset();
  Wrench<> knows_no_modulus(frame.border, frame.options);
  CHECK(knows_no_modulus(frame.shape, frame.dots, 0.01 + 0.101325).ok());
}

TEST_CASE("mistakes with the six-axis force: what the modulus tells", "[mistakes]") {
  const auto solved = [](const std::function<void(Frame&)>& change) {
    Frame frame;
    frame.options.modulus_n_per_mm = frame.rim.modulus_n_per_mm;
    change(frame);
    return seen(frame);
  };
  const auto right = solved([](Frame&) {});
  REQUIRE(right.ok());
  const auto aged = [](double stiffer, double longer) {
    return [=](Frame& frame) {
      frame.rim.modulus_n_per_mm *= stiffer;
      frame.rim.length_mm *= longer;
      const double tension = frame.pad.tension(frame.pad.radius_mm, frame.pressure_mpa);
      frame.dots = frame.rim.dots([&](double at) {
        return test::RimLoad{tension * (1 + 0.05 * std::cos(at)),
                             tension * (0.1 - 0.1 * std::sin(at))};
      });
    };
  };
  const auto modulus = [&](const WrenchResult<double>& r) {
    return r.modulus_n_per_mm / right.modulus_n_per_mm;
  };
  const auto shifted = [&](const WrenchResult<double>& r) {
    return norm(r.force_n - right.force_n) / norm(right.force_n);
  };
  // stiffer and softer: forces come from pressure and shape, and the modulus shows the change
  for (const double stiffer : {1.4, 1 / 1.4, 2.0, 0.5}) {
    const auto r = solved(aged(stiffer, 1));
    const bool little = stiffer < 1.5 && 1 < 1.5 * stiffer;
    CHECK(r.status == (little ? WrenchStatus::ok : WrenchStatus::pad_has_changed));
    CHECK(r.has_force());
    CHECK(shifted(r) < 1e-6);
    CHECK(modulus(r) == Approx(stiffer).epsilon(1e-6));
  }
  // a rim that has become longer without stress: 5 % halve F_xy and the modulus
  const auto longer = solved(aged(1, 1.05));
  CHECK(longer.status == WrenchStatus::pad_has_changed);
  CHECK(longer.has_force());
  CHECK(longer.force_n.z == Approx(right.force_n.z).epsilon(1e-6));
  CHECK(longer.force_n.x / right.force_n.x == Approx(0.54).margin(0.01));
  CHECK(modulus(longer) == Approx(0.5).margin(0.01));
  const auto longest = solved(aged(1, 1.2));
  CHECK(longest.status == WrenchStatus::pad_has_changed);
  CHECK_FALSE(longest.has_force());
  // undetected: the error of F_xy is within the bound
  for (const double length : {0.96, 0.97, 0.98, 0.99, 1.01, 1.02, 1.03, 1.04}) {
    const auto r = solved(aged(1, length));
    INFO(length << ": mu t " << modulus(r) << ", F_x " << r.force_n.x / right.force_n.x << ", "
                << name_of(r.status));
    CHECK(r.ok() == (modulus(r) < 1.5 && 1 < 1.5 * modulus(r)));
    CHECK((r.ok() || std::abs(length - 1) > 0.015));
    CHECK((!r.ok() || std::abs(std::log(r.force_n.x / right.force_n.x)) < std::log(1.5)));
  }
  // a gauge that reads a fifth too much
  const auto pressed = solved([](Frame& f) { f.pressure_mpa *= 1.2; });
  CHECK(modulus(pressed) == Approx(1.2).epsilon(1e-3));
  // slopes with an error of a fifth have almost no effect; heights have a little, undetected
  for (const double off : {0.8, 1.2}) {
    CHECK(shifted(solved([=](Frame& f) { f.shape.slope = off; })) < 0.001);
    const auto r = solved([=](Frame& f) { f.shape.height = f.shape.slope = off; });
    CHECK(shifted(r) < 0.03);
    CHECK(modulus(r) == Approx(1).epsilon(0.002));
  }
}

TEST_CASE("mistakes with the six-axis force: by the modulus alone an aged membrane is not told",
          "[mistakes]") {
  // the same frame with its pressure and shape shows it: pad_has_changed
  Frame frame;
  frame.options.modulus_n_per_mm = frame.rim.modulus_n_per_mm;
  const auto loaded = [&](double stiffer, double longer) {
    auto rim = frame.rim;
    rim.modulus_n_per_mm *= stiffer;
    rim.length_mm *= longer;
    const double tension = frame.pad.tension(frame.pad.radius_mm, frame.pressure_mpa);
    return rim.dots([&](double at) {
      return test::RimLoad{tension * (1 + 0.05 * std::cos(at)),
                           tension * (0.1 - 0.1 * std::sin(at))};
    });
  };
  Wrench<> wrench(frame.border, frame.options);
  const auto told = [&](double stiffer, double longer) {
    const auto dots = loaded(stiffer, longer);
    const auto by_modulus = wrench.by_modulus(dots, frame.pressure_mpa);
    const auto by_rim = wrench(frame.shape, dots, test::nan);  // without a gauge
    CHECK(by_modulus.ok());
    CHECK(by_rim.ok());
    CHECK(wrench(frame.shape, dots, frame.pressure_mpa).ok() == (stiffer * longer == 1));
    return std::array{by_modulus.force_n.x, by_rim.force_n.x, by_rim.pressure_mpa};
  };
  const auto right = told(1, 1), stiffer = told(2, 1), longer = told(1, 1.05);
  CHECK(stiffer[0] / right[0] == Approx(0.5).margin(0.05));  // shear of half the stretch
  CHECK(stiffer[2] / right[2] == Approx(0.5).margin(0.01));
  CHECK(stiffer[1] / right[1] == Approx(0.5).margin(0.01));
  CHECK(longer[0] / right[0] == Approx(1).margin(0.1));
  CHECK(longer[2] / right[2] == Approx(2).margin(0.1));
}

TEST_CASE("mistakes with the six-axis force: a modulus of another unit", "[mistakes]") {
  const Frame frame;
  for (const double modulus : {500.0, 0.0005, 0.5e6}) {  // N/m, kN/mm, N/km
    WrenchOptions<double> options = frame.options;
    options.modulus_n_per_mm = modulus;
    CHECK(test::begins_with(test::refusal([&] { const Wrench<> r(frame.border, options); }),
                            "WrenchOptions: modulus_n_per_mm = "));
  }
}

namespace {

/// A contact that is pressed, displaced and rotated.
struct Contact {
  double area_mm2 = 225, depth_mm = 3;
  Point2<double> displacement_mm = {0.4, -0.2};
  double rotation_rad = 0.08;
};

struct LookUpMistake {
  std::string mistake;
  std::function<void(Contact&)> make;
  std::string said_by_area, said_by_depth, fused, shear;
};

const char* const implausible = "implausible: not in mm, rad?";

const std::vector<LookUpMistake> look_up_mistakes = {
    {"none", [](Contact&) {}, "measured", "measured", "measured", "measured"},
    {"area in m^2", [](Contact& c) { c.area_mm2 *= 1e-6; }, "below range", "measured",
     "disagreeing", "below range"},
    {"area in um^2", [](Contact& c) { c.area_mm2 *= 1e6; }, implausible, "measured", implausible,
     implausible},
    {"area of 1e300", [](Contact& c) { c.area_mm2 = 1e300; }, implausible, "measured", implausible,
     "not finite"},
    {"depth of 1e300", [](Contact& c) { c.depth_mm = 1e300; }, "measured", implausible, implausible,
     "measured"},
    {"depth in um", [](Contact& c) { c.depth_mm *= 1e3; }, "measured", "beyond range",
     "beyond range", "measured"},
    {"no area", [](Contact& c) { c.area_mm2 = test::nan; }, "not finite", "measured", "measured",
     "not finite"},  // the force by depth alone
    {"area in px", [](Contact& c) { c.area_mm2 *= 150; }, "beyond range", "measured",
     "beyond range", "beyond range"},
    {"depth in m", [](Contact& c) { c.depth_mm *= 1e-3; }, "measured", "below range", "disagreeing",
     "measured"},
    {"area and depth exchanged", [](Contact& c) { std::swap(c.area_mm2, c.depth_mm); },
     "below range", "beyond range", "beyond range", "measured"},
    {"a contact of another shape", [](Contact& c) { c.area_mm2 /= 2; }, "measured", "measured",
     "disagreeing", "measured"},
    {"a membrane that has become longer: a fifth deeper over the same area",
     [](Contact& c) { c.depth_mm *= 1.2; }, "measured", "measured", "disagreeing", "measured"},
    {"a softer gel: as a contact of more force",
     [](Contact& c) { c.area_mm2 *= 1.2, c.depth_mm *= 1.2; }, "measured", "measured", "measured",
     "measured"},
    {"displacement in um", [](Contact& c) { c.displacement_mm = 1e3 * c.displacement_mm; },
     implausible, implausible, implausible, implausible},
    {"displacement as the place of the dot",
     [](Contact& c) {
       c.displacement_mm = {320, 240};
     },
     implausible, implausible, implausible, implausible},
    {"rotation in degrees", [](Contact& c) { c.rotation_rad *= 57.3; }, implausible, implausible,
     implausible, implausible},
    {"rotation of more than half a turn", [](Contact& c) { c.rotation_rad = 3.2; }, implausible,
     implausible, implausible, implausible},
    {"lost dots as 1e30", [](Contact& c) { c.displacement_mm.x = 1e30; }, implausible, implausible,
     implausible, implausible},
    {"beyond what was calibrated", [](Contact& c) { c.area_mm2 = 600, c.depth_mm = 6.88; },
     "beyond range", "beyond range", "beyond range", "beyond range"},
    {"no number", [](Contact& c) { c.area_mm2 = c.depth_mm = test::nan; }, "not finite",
     "not finite", "not finite", "not finite"},
};

}  // namespace

TEST_CASE("mistakes with the look-ups", "[mistakes]") {
  ForceCurve<> by_area_curve = test::curve_of_area(), by_depth_curve = test::curve_of_depth();
  for (ForceCurve<>* curve : {&by_area_curve, &by_depth_curve}) {
    curve->residual_sd_n = 0.3;
    curve->per_mm_sq = 0.02;
    curve->per_rad_sq = 0.5;
  }
  const NormalForce area(by_area_curve), depth(by_depth_curve);
  ShearMap<> map = test::map_of(published::shear_by_area(2.0, 60.0));
  map.force.to = 8;
  map.moment.to = 1;
  const Shear shear(map);
  for (const LookUpMistake& m : look_up_mistakes) {
    INFO(m.mistake);
    Contact c;
    m.make(c);
    const auto by_area = area(c.area_mm2, c.displacement_mm, c.rotation_rad);
    const auto by_depth = depth(c.depth_mm, c.displacement_mm, c.rotation_rad);
    const auto both = fused(by_area, by_depth);
    const auto aside = shear(c.area_mm2, c.displacement_mm, c.rotation_rad);
    CHECK(name_of(by_area.status) == m.said_by_area);
    CHECK(name_of(by_depth.status) == m.said_by_depth);
    CHECK(name_of(both.status) == m.fused);
    CHECK(name_of(aside.status) == m.shear);
    CHECK(both.ok() == (m.fused == "measured"));
  }
}

TEST_CASE("mistakes with the look-ups: the variance belongs to the curve that answers",
          "[mistakes]") {
  // 28.2 N if a quadratic up to 20 N continues, 25.4 N along its tangent
  const ForceCurve<> curve{{0, 0.02, 0.0001}, 20, 350, 0, 0, 0.08};
  const NormalForce force(curve);
  const auto r = force(450);
  const double tangent = curve.force_n(350) + 100 * curve.slope(350);
  CHECK(r.force_n == Approx(tangent));
  CHECK(std::sqrt(r.variance_n2) > 0.99 * (curve.force_n(450) - tangent));
  CHECK_FALSE(r.ok());
}

TEST_CASE("mistakes with the look-ups: moments in N m", "[mistakes]") {
  const auto with = [](double force, double moment) {
    return test::refusal(
        [&] { (void)Shear(test::map_of(published::shear_by_area(force, moment))); });
  };
  const std::string said = "ShearMap: size of the contact from moment over force";
  CHECK(with(2, 60) == "accepted");
  CHECK(test::begins_with(with(2, 60e-3), said));  // N m
  CHECK(test::begins_with(with(2, 60e6), said));   // uN m
}

TEST_CASE("mistakes with the friction ratio", "[mistakes]") {
  published::FrictionRatio<> friction;
  const Vector on_pad = {0.8, 0, -1};  // as in WrenchResult: a press
  CHECK(friction(0.8, -on_pad.z, true) == 0);
  CHECK(std::isnan(friction(0.8, on_pad.z, false)));  // the other sign
  // forces that no gauge reports, after a slide without friction
  for (const double absurd : {1e6, 1e30, 1.7e308}) {
    published::FrictionRatio<> slid;
    (void)slid(1e-300, 1.0, true);
    CHECK(std::isnan(slid(absurd, 1.0, false)));
    CHECK(std::isnan(slid(1.0, absurd, false)));
    FrictionLimit<> limit;
    CHECK(limit({1, 1e-300}, 0.1, RatioUpdate::fresh).margin != 0);
    CHECK(limit({1, absurd}, 0.9, RatioUpdate::fresh).status == FrictionLimitStatus::no_load);
    CHECK_FALSE(std::isinf(limit({1, 0.5}, 0.9, RatioUpdate::fresh).margin));
  }
  WrenchResult<double> wrench;
  wrench.force_n = on_pad;
  CHECK(wrench.normal_force_n() == 1);
  CHECK(wrench.tangential_force_n().x == 0.8);
}

namespace {

struct TractionMistake {
  std::string mistake;
  std::function<void(test::TractionScene&)> make;
  std::string said;
};

template <class Change>
void each_dot(test::TractionScene& s, const Change& change) {
  for (Vector& dot : s.dots.cells) {
    dot = change(dot);
  }
}

/// Dot (i, j) takes the place of the one at from(i, j).
template <class From>
std::function<void(test::TractionScene&)> renamed(const From& from) {
  return [=](test::TractionScene& s) {
    const auto as_it_was = s.dots;
    for (Index i = 0; i < 21; ++i) {
      for (Index j = 0; j < 21; ++j) {
        const DotIndex d = from(i, j);
        s.dots(i, j) = as_it_was(d.row % 21, d.col % 21);
      }
    }
  };
}

void shift_by_one(test::TractionScene& s) {
  for (Index i = 0; i < 21; ++i) {
    for (Index j = 0; j < 21; ++j) {
      s.dots(i, j) = j < 20 ? s.dots(i, j + 1) : detail::missing_point<double>();
    }
  }
}

const std::vector<TractionMistake> traction_mistakes = {
    {"none", [](auto&) {}, "ok"},
    {"pressure in kPa", [](auto& s) { s.pressure_mpa *= 1e3; }, "bad pressure"},
    {"pressure in Pa", [](auto& s) { s.pressure_mpa *= 1e6; }, "bad pressure"},
    {"no pressure", [](auto& s) { s.pressure_mpa = test::nan; }, "bad pressure"},
    {"dots in m", [](auto& s) { each_dot(s, [](const Vector& p) { return 1e-3 * p; }); },
     "bad dots"},
    {"dots in px",
     [](auto& s) { each_dot(s, [](const Vector& p) {
                     return Vector{12 * p.x, 12 * p.y, p.z};
                   }); },
     "bad dots"},
    {"dots column by column instead of row by row",
     [](auto& s) {
       const auto as_it_was = s.dots;
       for (Index i = 0; i < 21; ++i) {
         for (Index j = 0; j < 21; ++j) {
           s.dots(i, j) = as_it_was.cells[static_cast<std::size_t>((i * 5 + j * 17) % 441)];
         }
       }
     },
     "bad dots"},
    {"no dots", [](auto& s) { s.dots = test::no_dots(21, 21); }, "bad dots"},
    {"rows from the other end", renamed([](Index i, Index j) {
       return DotIndex{20 - i, j};
     }),
     "no balance"},
    {"shifted by one", shift_by_one, "free part loaded"},
    {"two halves exchanged", renamed([](Index i, Index j) {
       return DotIndex{i, j + 10};
     }),
     "incomplete"},
    {"neighbours exchanged", renamed([](Index i, Index j) {
       return DotIndex{i, j == 20 ? j : j % 2 == 0 ? j + 1 : j - 1};
     }),
     "bad dots"},
    {"dots of the free pad", [](auto& s) { s.dots = test::traction_scene("free").dots; }, "ok"},
    {"half of the dots missing",
     [](auto& s) {
       for (Index k = 0; k < 21 * 10; ++k) {
         s.dots.cells[static_cast<std::size_t>(k)].x = test::nan;
       }
     },
     "incomplete"},
    {"a dot as far away as numbers go", [](auto& s) { s.dots(10, 10).z = 1.7e308; }, "ok"},
    {"dots times 1e300", [](auto& s) { each_dot(s, [](const Vector& p) { return 1e300 * p; }); },
     "bad dots"},
    {"another frame's size", [](auto& s) { s.dots = test::Dots(20, 21); }, "refused"},
};

}  // namespace

TEST_CASE("mistakes with the traction field", "[mistakes]") {
  TractionField field(test::stress_free_dots());
  for (const TractionMistake& m : traction_mistakes) {
    INFO(m.mistake);
    auto scene = test::traction_scene("tilt");
    m.make(scene);
    const auto r = field(scene.dots, scene.contact, scene.pressure_mpa);
    INFO(norm(r.force_n - scene.force_n) / norm(scene.force_n));
    CHECK(name_of(r.status) == m.said);
    CHECK(r.ok() == (m.said == "ok"));
    CHECK((!r.has_force() || is_finite(r.force_n)));
  }
  // dots that are off by one pitch would give a force with an error of its own size
  for (test::TractionScene aside : test::traction_scenes()) {
    shift_by_one(aside);
    INFO(aside.name);
    const auto r = field(aside.dots, aside.contact, aside.pressure_mpa);
    CHECK(r.status == TractionStatus::free_part_loaded);
    CHECK(r.is_pulled);
  }
  // the free pad's dots with contact flags: no force
  auto free = test::traction_scene("tilt");
  free.dots = test::traction_scene("free").dots;
  CHECK(norm(field(free.dots, free.contact, free.pressure_mpa).force_n) <
        0.05 * norm(free.force_n));
}

TEST_CASE("mistakes with the traction field: an aged membrane", "[mistakes]") {
  // The field's assumption over the true value: modulus and stress-free length of the pad.
  struct Aged {
    std::optional<double> modulus;
    double length;
    const char* said;
  };
  const Aged all[] = {
      {1.0, 1.0, "ok"},
      {1.5, 1.0, "free part loaded"},
      {1 / 1.5, 1.0, "free part loaded"},
      {1.0, 1.1, "free part loaded"},
      {1.0, 0.9, "free part loaded"},
      {1.0, 1.02, "free part loaded"},
      {1.0, 0.98, "free part loaded"},
      {1.15, 1.0, "free part loaded"},
      {1000.0, 1.0, "free part loaded"},  // as in N/m
      {std::nullopt, 1.0, "ok"},
  };
  for (const char* name : {"press", "drag", "tilt"}) {
    const auto scene = test::traction_scene(name);
    for (const Aged& aged : all) {
      auto free = test::stress_free_dots();
      for (Vector& dot : free.cells) {
        dot = aged.length * dot;
      }
      TractionOptions<double> options;
      if (aged.modulus) {
        options.mu_t_n_per_mm = 0.5 * *aged.modulus;
      }
      TractionField field(free, options);
      const auto r = field(scene.dots, scene.contact, scene.pressure_mpa);
      CAPTURE(name, aged.modulus.value_or(0), aged.length);
      CHECK(name_of(r.status) == std::string(aged.said));
      CHECK(r.modulus_differs == !r.ok());
      CHECK((!r.ok() || norm(r.force_n - scene.force_n) < 0.05 * norm(scene.force_n)));
    }
  }
  // noise of the dots is not taken for age and does not hide it
  for (const test::TractionScene& scene : test::traction_scenes()) {
    test::Gauss gauss(7);
    for (const double length : {0.97, 1.0, 1.03}) {
      auto free = test::stress_free_dots();
      for (Vector& dot : free.cells) {
        dot = length * dot;
      }
      TractionField field(free, {.mu_t_n_per_mm = 0.5});
      for (const double noise_mm : {0.02, length == 1 ? 0.05 : 0.02}) {
        const auto r =
            field(test::noisy(scene.dots, noise_mm, gauss), scene.contact, scene.pressure_mpa);
        CAPTURE(scene.name, length, noise_mm, r.free_mu_t_n_per_mm);
        const char* of_another_length = "free part loaded";
        CHECK(name_of(r.status) == std::string(length == 1 ? "ok" : of_another_length));
      }
    }
  }
  // undetected errors are small: 1 % changes F_z by a tenth in the worst frame
  for (const test::TractionScene& scene : test::traction_scenes()) {
    for (const double length : {0.99, 1.01}) {
      auto free = test::stress_free_dots();
      for (Vector& dot : free.cells) {
        dot = length * dot;
      }
      TractionField field(free, {.mu_t_n_per_mm = 0.5});
      const auto r = field(scene.dots, scene.contact, scene.pressure_mpa);
      CAPTURE(scene.name, length);
      CHECK((!r.ok() || norm(r.force_n - scene.force_n) < 0.11 * norm(scene.force_n)));
      CHECK((r.ok() || std::string(name_of(r.status)) == "free part loaded"));
    }
  }
}

TEST_CASE(
    "mistakes with the traction field: without a given modulus a longer membrane is a softer one",
    "[mistakes]") {
  // 3 % change F_xy by half with status ok, because a stiffer membrane with less stretch holds as
  // much. But the modulus of the frame is 1.5 times that of the new pad.
  auto free = test::stress_free_dots();
  for (Vector& dot : free.cells) {
    dot = 1.03 * dot;
  }
  TractionField field(free);
  const auto scene = test::traction_scene("drag");
  const auto r = field(scene.dots, scene.contact, scene.pressure_mpa);
  CHECK(r.ok());
  CHECK(r.force_n.x / scene.force_n.x == Approx(1.51).margin(0.02));
  CHECK(r.mu_t_n_per_mm / 0.5 == Approx(1.53).margin(0.01));
}

TEST_CASE("one convention of signs: a press", "[mistakes]") {
  // a vector is the force of the object on the pad, z toward the object; a normal force > 0 presses
  const auto wrench = seen(Frame());
  CHECK(wrench.force_n.z < 0);
  CHECK(wrench.normal_force_n() == -wrench.force_n.z);
  const auto scene = test::traction_scene("press");
  TractionField field(test::stress_free_dots());
  const Vector on_pad = field(scene.dots, scene.contact, scene.pressure_mpa).force_n;
  CHECK(on_pad.z < 0);
  const auto load = contact_load(on_pad, {0, 0, 0}, scene.dots, scene.contact);
  CHECK(load.normal_n == Approx(-on_pad.z).epsilon(0.01));
  CHECK(NormalForce(test::curve_of_area())(225.0).force_n > 0);
  // the other sign is reported where a normal force is passed
  FrictionLimit<> limit;
  ContactLoad<> pulls = load;
  pulls.normal_n = on_pad.z;
  CHECK(limit(load, 1, RatioUpdate::fresh).status != FrictionLimitStatus::no_load);
  CHECK(limit(pulls, 1, RatioUpdate::fresh).status == FrictionLimitStatus::no_load);
  published::FrictionRatio<> ratio;
  CHECK(ratio(0.5, -on_pad.z, true) == 0);
  CHECK(std::isnan(ratio(0.5, on_pad.z, false)));
}

TEST_CASE("mistakes with forces: rims and membranes larger than any", "[mistakes]") {
  const auto said = [](Index rows, Index cols) {
    const LazyView dots(rows, cols, [](Index i, Index j) {
      return Vector{1.5 * static_cast<double>(j), 1.5 * static_cast<double>(i), 9};
    });
    return test::refusal([&] { TractionField<> r(dots); });
  };
  constexpr Index enormous = std::numeric_limits<Index>::max();
  CHECK(test::begins_with(said(enormous, 9), "TractionField: rows = "));
  CHECK(test::begins_with(said(9, enormous), "TractionField: cols = "));
  CHECK(test::begins_with(said(1000000, 1000000), "TractionField: rows times cols = "));
  const LazyView border(1, enormous, [](Index, Index) { return Vector{18, 0, 0}; });
  CHECK(test::begins_with(test::refusal([&] { const Wrench<> r(border); }),
                          "Wrench: border columns = "));
}
