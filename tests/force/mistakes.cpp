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

#include "fingerpad/force/look_up.hpp"
#include "fingerpad/force/traction.hpp"
#include "fingerpad/force/wrench.hpp"
#include "fingerpad/published/friction_ratio.hpp"
#include "fingerpad/published/look_up.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "support/catch.hpp"
#include "support/curves.hpp"
#include "support/refusal.hpp"
#include "support/rim_marks.hpp"
#include "support/traction_scenes.hpp"

using namespace fingerpad;
using test::Image;
using Vector = Point3<double>;

namespace {

/// A frame of a drag, with its estimator, for mistakes to change.
struct Frame {
  const test::RimScene& scene = test::rim_scenes().front();
  WrenchOptions options = test::SeenRim::options_of(scene, true);
  double free_mpa = scene.frames.front().pressure_mpa, mpa = scene.frames.back().pressure_mpa;
  std::vector<Point2<double>> free_px = seen(scene.frames.front()), px = seen(scene.frames.back());

  std::vector<Point2<double>> seen(const test::RimFrame& frame) const {
    test::Random random(3);
    std::vector<Point2<double>> all;
    for (std::size_t k = 0; k < frame.dots_mm.size(); k += 2) {  // half of them are enough
      const auto at = pixel_of(scene.camera(), frame.dots_mm[k]);
      all.push_back({at.x + 0.02 * random.normal(), at.y + 0.02 * random.normal()});
    }
    return all;
  }
  void each_dot(const std::function<Point2<double>(const Point2<double>&)>& change) {
    std::transform(px.begin(), px.end(), px.begin(), change);
  }
};

WrenchResult seen(const Frame& frame) {
  Wrench<> wrench(frame.scene.camera(), frame.options);
  std::vector<Mark> marks;
  (void)wrench.begin(frame.free_mpa);
  for (std::size_t k = 0; k < frame.free_px.size(); ++k) {
    if (auto mark = wrench.place_in_free_picture(frame.free_px[k])) {
      mark->px = frame.px[k];
      mark->sd_px = 0.03;
      marks.push_back(*mark);
    }
  }
  return wrench(marks, frame.mpa);
}

struct WrenchMistake {
  std::string mistake;
  std::function<void(Frame&)> make;
  std::string said;
};

const std::vector<WrenchMistake> wrench_mistakes = {
    {"none", [](Frame&) {}, "ok"},
    {"pressure below that of the air", [](Frame& f) { f.mpa = -0.01; }, "no pressure"},
    {"no pressure", [](Frame& f) { f.mpa = test::nan; }, "no pressure"},
    {"pressure in kPa", [](Frame& f) { f.mpa *= 1e3, f.free_mpa *= 1e3; }, "no pressure"},
    {"absolute pressure", [](Frame& f) { f.mpa += 0.101325, f.free_mpa += 0.101325; },
     "no pressure"},
    {"modulus in N/m", [](Frame& f) { f.options.modulus_n_per_mm *= 1e3; }, "no pressure"},
    {"dots labelled the other way round", [](Frame& f) { std::reverse(f.px.begin(), f.px.end()); },
     "not solved"},
    {"dots shifted by one",
     [](Frame& f) { std::rotate(f.px.begin(), f.px.begin() + 1, f.px.end()); }, "not solved"},
    {"x and y of the dots exchanged",
     [](Frame& f) { f.each_dot([](const Point2<double>& p) {
                      return Point2<double>{p.y, p.x};
                    }); },
     "not solved"},
    {"dots in mm", [](Frame& f) { f.each_dot([](const Point2<double>& p) { return 0.08 * p; }); },
     "not solved"},
    {"dots as (0, 0) where they are lost",
     [](Frame& f) {
       std::fill(f.px.begin(), f.px.begin() + 45, Point2<double>{0, 0});
     },
     "not solved"},
    {"dots of a picture of another size",
     [](Frame& f) { f.each_dot([](const Point2<double>& p) { return 0.5 * p; }); }, "not solved"},
    {"hardly any dots", [](Frame& f) { f.px.resize(15), f.free_px.resize(15); }, "too few marks"},
    {"a dot as far away as numbers go", [](Frame& f) { f.px[7].x = 1.7e308; }, "ok"},
};

}  // namespace

TEST_CASE("mistakes with the six-axis force", "[mistakes]") {
  for (const WrenchMistake& m : wrench_mistakes) {
    INFO(m.mistake);
    Frame frame;
    m.make(frame);
    const auto r = seen(frame);
    CHECK(name_of(r.status) == m.said);
    CHECK(r.ok() == is_finite(r.force_n));
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
     "measured", "measured", "measured", implausible},
    {"displacement as the place of the dot",
     [](Contact& c) {
       c.displacement_mm = {320, 240};
     },
     "measured", "measured", "measured", implausible},
    {"rotation in degrees", [](Contact& c) { c.rotation_rad *= 57.3; }, "measured", "measured",
     "measured", implausible},
    {"rotation of more than half a turn", [](Contact& c) { c.rotation_rad = 3.2; }, "measured",
     "measured", "measured", implausible},
    {"lost dots as 1e30", [](Contact& c) { c.displacement_mm.x = 1e30; }, "measured", "measured",
     "measured", implausible},
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
    const auto by_area = area(c.area_mm2);
    const auto by_depth = depth(c.depth_mm);
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
  const ForceCurve<> curve{{0, 0.02, 0.0001}, 20, 350, 0.08};
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

/// Each dot is taken for the one before it in its row or, if `in_columns`, in its column.
void shift_by_one(test::TractionScene& s, bool in_columns = false) {
  for (Index i = 0; i < 21; ++i) {
    for (Index j = 0; j < 21; ++j) {
      const Index row = i + (in_columns ? 1 : 0), col = j + (in_columns ? 0 : 1);
      s.dots(i, j) = row < 21 && col < 21 ? s.dots(row, col) : detail::missing_point<double>();
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
    {"shifted by one", [](auto& s) { shift_by_one(s); }, "free part loaded"},
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
  for (const bool in_columns : {false, true}) {
    for (test::TractionScene aside : test::traction_scenes()) {
      shift_by_one(aside, in_columns);
      INFO(aside.name);
      const auto r = field(aside.dots, aside.contact, aside.pressure_mpa);
      CHECK(r.status == TractionStatus::free_part_loaded);
      CHECK(r.is_pulled);
    }
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
  CHECK(seen(Frame()).force_n.z < 0);
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

TEST_CASE("mistakes with forces: membranes larger than any", "[mistakes]") {
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
}
