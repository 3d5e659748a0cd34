// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Effects on forces by look-up, on the shift of the contact used for shear, on traction and on the
// shape of the object: contacts, dots and measured depths of finite-element membranes (tests/data).
//   press, twist, rolling, tilted   the scenes of these names, all steps
//   drag, reversal                  the drag up to its turning point, and the rest of it
//   normal force change             drag, rotation and depth at once
//   wedge                           cylinder, pressed and dragged
//   noisy                           the drag with twice the noise: dots 0.12 px instead of 0.06,
//                                   areas and depths 4 % instead of 2
//   dots lost                       the drag, one dot in twenty: taken for its neighbour (shift of
//                                   the contact) or missing (traction)
// The test plate is not among those that calibrate the normal force. Shear is calibrated on "mix"
// ("mix" itself on "drag" and "cylinder"). Areas and displacements are exact except for the noise
// above.
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/support/scene_frames.hpp"
#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/contact/equivalent_flat_area.hpp"
#include "fingerpad/contact/surface.hpp"
#include "fingerpad/force/look_up.hpp"
#include "fingerpad/force/traction.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "membranes.hpp"
#include "support/contact_measures.hpp"
#include "support/contact_records.hpp"
#include "support/traction_scenes.hpp"
#include "support/wrench_frames.hpp"
#include "table.hpp"

namespace bench::ablation {

using LoadSample = fingerpad::ForceSample<double>;
using test::ContactDotsOf;
using test::ContactMeasure;

inline Scene scene_of_load(const std::string& name) {
  return name == "press"   ? Scene::press
         : name == "drag"  ? Scene::drag
         : name == "twist" ? Scene::twist
         : name == "mix"   ? Scene::normal_force_change
         : name == "roll"  ? Scene::rolling
         : name == "tilt"  ? Scene::tilted
                           : Scene::wedge;
}

inline constexpr std::array<const char*, 7> load_scenes = {"press", "drag", "twist",   "mix",
                                                           "roll",  "tilt", "cylinder"};

/// Samples of recorded scenes; `noise` of the measure is relative to it.
inline std::vector<LoadSample> load_samples(const std::vector<std::string>& scenes,
                                            ContactMeasure measure,
                                            ContactDotsOf dots = ContactDotsOf::edge,
                                            double noise = 0) {
  auto samples = test::force_samples(test::contact_records(scenes), measure, dots);
  test::Random random(3);
  for (LoadSample& s : samples) {
    s.measure *= 1 + noise * random.normal();
  }
  return samples;
}

/// Whether a step of the drag is on its way back.
inline bool has_turned(const std::vector<LoadSample>& samples, std::size_t k) {
  double furthest = 0;
  for (std::size_t i = 0; i <= k; ++i) {
    const auto& d = samples[i].displacement_mm;
    furthest = (std::max)(furthest, std::hypot(d.x, d.y));
  }
  const auto& d = samples[k].displacement_mm;
  return std::hypot(d.x, d.y) < 0.98 * furthest;
}

/// Notes the errors of the function `calibrate(scene)` in all scenes; `where(scene)` receives them.
template <class Calibrate, class Where>
void note_loads(const Calibrate& calibrate,
                ContactMeasure measure,
                ContactDotsOf dots,
                const Where& where) {
  for (const std::string scene : load_scenes) {
    const auto force_error = calibrate(scene);
    const auto samples = load_samples({scene}, measure, dots, 0.02);
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const bool back = scene == "drag" && has_turned(samples, k);
      where(back ? Scene::reversal : scene_of_load(scene)).add(force_error(samples[k]));
    }
    if (scene == "drag") {
      for (const LoadSample& s : load_samples({scene}, measure, dots, 0.04)) {
        where(Scene::noisy).add(force_error(s));
      }
    }
  }
}

// ---- shear

inline std::vector<std::string> shear_calibration(const std::string& scene) {
  return scene == "mix" ? std::vector<std::string>{"drag", "cylinder"}
                        : std::vector<std::string>{"mix"};
}

/// Error of the tangential force in N. Without `divides` the size of the contact is ignored.
inline auto tangential_force_of(ContactMeasure measure, ContactDotsOf dots, bool divides) {
  using namespace fingerpad;
  return [=](const std::string& scene) {
    const double reference = measure == ContactMeasure::depth ? 10 : 100;
    const auto samples = load_samples(shear_calibration(scene), measure, dots);
    const auto fit = fit_tangential_force(std::span<const LoadSample>(samples), reference,
                                          divides ? std::optional<double>() : 0.0);
    ShearMap<> map{reference, fit.law, {}};
    map.moment.slope = 100;
    return [shear = Shear(map)](const LoadSample& s) {
      const auto f = shear(s.measure, s.displacement_mm, 0).tangential_force_n;
      return std::hypot(f.x - s.tangential_force_n.x, f.y - s.tangential_force_n.y);
    };
  };
}

inline std::vector<Effect> look_up_effects() {
  std::vector<Effect> effects;
  const auto add = [&](Effect e, ContactMeasure measure, ContactDotsOf dots_with,
                       ContactDotsOf dots_without, const auto& with, const auto& without) {
    note_loads(with, measure, dots_with, [&](Scene s) -> Errors& { return e.with_in(s); });
    note_loads(without, measure, dots_without, [&](Scene s) -> Errors& { return e.without_in(s); });
    effects.push_back(e);
  };
  constexpr auto edge = ContactDotsOf::edge, center = ContactDotsOf::center;
  for (const auto measure : {ContactMeasure::area, ContactMeasure::depth}) {
    const std::string by = measure == ContactMeasure::area ? "by area" : "by depth";
    add({.name = "size of the contact",
         .quantity = "tangential force " + by,
         .unit = "N",
         .on = "`Shear` with a fitted exponent",
         .off = "with an exponent of 0"},
        measure, edge, edge, tangential_force_of(measure, edge, true),
        tangential_force_of(measure, edge, false));
  }
  add({.name = "dots of the edge",
       .quantity = "tangential force by area",
       .unit = "N",
       .on = "`ShiftOptions::edge_dots`",
       .off = "the central dot"},
      ContactMeasure::area, edge, center, tangential_force_of(ContactMeasure::area, edge, true),
      tangential_force_of(ContactMeasure::area, center, true));
  return effects;
}

// ---- shift of the contact, traction

using PlaneDots = Image<fingerpad::Point2<double>>;

inline PlaneDots in_plan(const test::Dots& dots) {
  PlaneDots plane(dots.rows(), dots.cols());
  for (std::size_t k = 0; k < plane.cells.size(); ++k) {
    plane.cells[k] = {dots.cells[k].x, dots.cells[k].y};
  }
  return plane;
}

/// Replaces one dot in twenty by its neighbour to the right.
inline void confuse(PlaneDots& dots, test::Random& random) {
  for (Index i = 0; i < dots.rows(); ++i) {
    for (Index j = 0; j + 1 < dots.cols(); ++j) {
      if (random.uniform() < 0.05) {
        dots(i, j) = dots(i, j + 1);
      }
    }
  }
}

/// Errors are against the shift of the exact dots.
inline Effect huber_effect() {
  using namespace fingerpad;
  Effect e{.name = "robust mean",
           .quantity = "displacement of the contact",
           .unit = "mm",
           .on = "`ShiftOptions::robust_passes` 10",
           .off = "0"};
  const auto free = in_plan(test::traction_scene("free").dots);
  ContactShift robust(free, {.robust_passes = 10});
  ContactShift plain(free);
  PlaneDots timed = free;
  const auto note = [&](const test::TractionScene& s, Scene where, double noise_mm, bool mistakes) {
    const auto exact = in_plan(s.dots);
    const auto truth = plain(exact, s.contact).displacement;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      test::Random random(seed);
      PlaneDots seen = exact;
      for (auto& p : seen.cells) {
        const double x = random.normal(), y = random.normal();
        p = {p.x + noise_mm * x, p.y + noise_mm * y};
      }
      if (mistakes) {
        confuse(seen, random);
      }
      const auto off = [&](const auto& r) {
        return std::hypot(r.displacement.x - truth.x, r.displacement.y - truth.y);
      };
      e.with_in(where).add(off(robust(seen, s.contact)));
      e.without_in(where).add(off(plain(seen, s.contact)));
      timed = seen;
    }
  };
  for (const test::TractionScene& s : test::traction_scenes()) {
    note(s, scene_of_load(s.name), 0.005, false);
    if (s.name == "drag") {
      note(s, Scene::noisy, 0.01, false);
      note(s, Scene::dots_lost, 0.005, true);
    }
  }
  const auto contact = test::traction_scene("drag").contact;
  e.cost_us = cost_us([&] { (void)robust(timed, contact); }, [&] { (void)plain(timed, contact); });
  return e;
}

inline std::vector<Effect> traction_effects() {
  using namespace fingerpad;
  const auto effect = [](const std::string& quantity, const std::string& unit) {
    return Effect{.name = "calibrated membrane",
                  .quantity = quantity,
                  .unit = unit,
                  .on = "`TractionOptions::mu_t_n_per_mm`",
                  .off = "empty: from the free part of each frame"};
  };
  Effect force = effect("force by traction", "N");
  Effect faded{.name = "faded sums",
               .quantity = "force by traction",
               .unit = "N",
               .on = "`TractionOptions::fade_dots` 3",
               .off = "0"};
  const auto free = test::stress_free_dots();
  TractionField calibrated(free, {.mu_t_n_per_mm = 0.5});
  TractionField balanced(free);
  TractionField abrupt(free, {.mu_t_n_per_mm = 0.5, .fade_dots = 0});
  const auto note = [&](const test::TractionScene& s, Scene where, double noise_mm, double lost) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      test::Gauss gauss(seed);
      test::Random random(seed);
      auto seen = test::noisy(s.dots, noise_mm, gauss);
      for (auto& p : seen.cells) {
        if (random.uniform() < lost) {
          p = fingerpad::detail::missing_point<double>();
        }
      }
      const auto off = [&](auto& field) {
        return norm(field(seen, s.contact, s.pressure_mpa).force_n - s.force_n);
      };
      force.with_in(where).add(off(calibrated));
      force.without_in(where).add(off(balanced));
      faded.with_in(where).add(off(calibrated));
      faded.without_in(where).add(off(abrupt));
    }
  };
  for (const test::TractionScene& s : test::traction_scenes()) {
    note(s, scene_of_load(s.name), 0.005, 0);
    if (s.name == "drag") {
      note(s, Scene::noisy, 0.01, 0);
      note(s, Scene::dots_lost, 0.005, 0.05);
    }
  }
  const test::TractionScene drag = test::traction_scene("drag");
  const auto run = [&](auto& field) {
    return [&] { (void)field(drag.dots, drag.contact, drag.pressure_mpa); };
  };
  force.cost_us = cost_us(run(calibrated), run(balanced));
  faded.cost_us = cost_us(run(calibrated), run(abrupt));
  return {force, faded};
}

// ---- shape of the object

/// Plates: the angle to the true normal. Ball and cylinder: the largest curvature.
inline std::vector<Effect> surface_effects() {
  using namespace fingerpad;
  SceneFrames& frames = SceneFrames::instance();
  const test::Pad& pad = frames.pad();
  const OrthographicCamera<double> from_afar{pad.camera.center_x_px, pad.camera.center_y_px,
                                             pad.camera.pitch_mm};
  constexpr double degrees = 180 / std::numbers::pi;
  const auto effect = [](const std::string& name, bool plate, const std::string& on,
                         const std::string& off) {
    return Effect{.name = name,
                  .quantity = plate ? "normal of the object" : "curvature of the object",
                  .unit = plate ? "degrees" : "1/mm",
                  .on = on,
                  .off = off};
  };
  const std::string rays_on = "`fit_surface` with a `Camera`",
                    rays_off = "with an `OrthographicCamera`";
  Effect rays_plate = effect("rays", true, rays_on, rays_off);
  Effect rays_round = effect("rays", false, rays_on, rays_off);

  const auto normal_error = [&](const auto& camera, const SceneFrame& f, double tilt_rad) {
    const auto r = fit_surface(camera, f.measured_mm, f.measured);
    // the plate is tilted about x, by either sign
    const double along =
        r.normal.z * std::cos(tilt_rad) + std::abs(r.normal.y) * std::sin(tilt_rad);
    return degrees * std::acos((std::min)(1.0, along));
  };
  const auto bend_error = [&](const auto& camera, const SceneFrame& f, double per_mm) {
    return std::abs(fit_surface(camera, f.measured_mm, f.measured).curvature_1_per_mm) - per_mm;
  };
  for (const ShapeOfScene& shape : shapes()) {
    if (shape.scene == Scene::free || shape.scene == Scene::noisy) {
      continue;
    }
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      const SceneFrame& f = frames(shape.heights, seed);
      const bool is_round = shape.scene == Scene::rolling || shape.scene == Scene::wedge;
      if (is_round) {
        const double per_mm = shape.scene == Scene::rolling ? 1.0 / 18 : 1.0 / 12;
        rays_round.with_in(shape.scene).add(bend_error(pad.camera, f, per_mm));
        rays_round.without_in(shape.scene).add(bend_error(from_afar, f, per_mm));
      } else {
        const double tilt = shape.scene == Scene::tilted ? 8 / degrees : 0;
        rays_plate.with_in(shape.scene).add(normal_error(pad.camera, f, tilt));
        rays_plate.without_in(shape.scene).add(normal_error(from_afar, f, tilt));
      }
    }
  }
  const SceneFrame& press = frames("press");
  const auto run = [&](const auto& camera) {
    return [&] { (void)fit_surface(camera, press.measured_mm, press.measured); };
  };
  rays_plate.cost_us = rays_round.cost_us = cost_us(run(pad.camera), run(from_afar));
  return {rays_plate, rays_round};
}

/// p S against the true force without a fitted curve. S is the area of the contact or the
/// equivalent flat area. Depths and contacts are measured, three frames a shape.
inline Effect flat_area_effect() {
  using namespace fingerpad;
  SceneFrames& frames = SceneFrames::instance();
  const test::Pad& pad = frames.pad();
  Effect e{.name = "equivalent flat area",
           .quantity = "normal force as p S",
           .unit = "N",
           .on = "`EquivalentFlatArea`",
           .off = "the contact's own area"};
  EquivalentFlatArea<> flat_area(pad.camera, pad.rows, pad.cols);
  for (const test::WrenchFrame& f : test::wrench_frames()) {
    const Scene scene = f.name == "drag_c" ? Scene::reversal : scene_of_load(f.scene);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const SceneFrame& seen = frames(f.heights, seed);
      const double pressure = f.pressure_mpa;
      e.with_in(scene).add(pressure * flat_area(seen.measured, seen.measured_mm).area_mm2 +
                           f.force_n.z);
      e.without_in(scene).add(
          pressure * test::contact_measures(pad.camera, seen.measured, seen.measured_mm).area_mm2 +
          f.force_n.z);
    }
  }
  const SceneFrame& press = frames("press");
  e.cost_us = cost_us([&] { (void)flat_area(press.measured, press.measured_mm); }, [] {});
  return e;
}

inline std::vector<Effect> load_effects() {
  std::vector<Effect> effects = look_up_effects();
  effects.push_back(flat_area_effect());
  effects.push_back(huber_effect());
  for (const auto& more : {traction_effects(), surface_effects()}) {
    effects.insert(effects.end(), more.begin(), more.end());
  }
  return effects;
}

}  // namespace bench::ablation
