// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Printed forms that no other table has: the error of each and the time of a call, with those of
// the default beside them.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numbers>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/scene_frames.hpp"
#include "fingerpad/calibrate/neighbour_light.hpp"
#include "fingerpad/published/contact_region.hpp"
#include "fingerpad/published/friction_ratio.hpp"
#include "fingerpad/published/look_up.hpp"
#include "fingerpad/published/neighbour_light.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fluid.hpp"
#include "look_up.hpp"
#include "rates.hpp"
#include "shape.hpp"
#include "support/spatial_scene.hpp"
#include "table.hpp"

namespace bench::papers {

/// Best time of a call of `work`, which makes `calls` of them.
template <class Work>
std::string time_of(const Work& work, double calls = 1) {
  const double s = 1 / best_rate(work, calls);
  const auto [unit, of_s] = s < 1e-6   ? std::pair{"ns", 1e9}
                            : s < 1e-3 ? std::pair{"us", 1e6}
                            : s < 1    ? std::pair{"ms", 1e3}
                                       : std::pair{"s", 1.0};
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %s", of_s * s, unit);
  return text;
}

struct Form {
  std::string printed, figure, error, time, default_error, default_time, experiment;
};

/// Contact tests of the slides on the scenes, each with the threshold of free frames.
inline void add_contact_forms(std::vector<Form>& forms) {
  using namespace fingerpad;
  SceneFrames& frames = SceneFrames::instance();
  const test::Pad& pad = frames.pad();
  std::vector<test::Image<float>> free, inner;  // of the whole pad; within 15 mm of the axis
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    free.push_back(frames("free", seed).measured_mm);
    inner.push_back(free.back());
    for (Index i = 0; i < pad.rows; ++i) {
      for (Index j = 0; j < pad.cols; ++j) {
        const auto p = point_at(pad.camera, static_cast<double>(i), static_cast<double>(j),
                                frames.free_mm()(i, j));
        inner.back()(i, j) =
            std::hypot(p.x, p.y) < 15 ? inner.back()(i, j) : static_cast<float>(test::nan);
      }
    }
  }
  test::Image<std::uint8_t> mask(pad.rows, pad.cols);
  const std::vector<std::string> scenes = {"press", "tilt", "cylinder", "roll"};
  std::string by_default;
  for (const std::string& name : scenes) {
    by_default +=
        (by_default.empty() ? "" : ", ") + overlap(frames(name), frames(name).measured, name);
  }
  ContactTest test;
  test.threshold_per_mm = frames.contact_threshold_per_mm();
  ContactRegion<> region(pad.camera, pad.rows, pad.cols, test);
  const auto& press = frames("press").measured_mm;
  const std::string default_time = time_of([&] { (void)region(press, mask); });
  const auto add = [&](const std::string& printed, published::SlidesContactOptions o,
                       const std::vector<test::Image<float>>* from, const std::string& where) {
    o.pitch_mm = pad.camera.pitch_mm;
    if (from != nullptr) {
      o.threshold_per_mm = published::threshold_by_slides(*from, o);
    }
    std::string found;
    for (const std::string& name : scenes) {
      (void)published::contact_by_slides(frames(name).measured_mm, mask, o);
      found += (found.empty() ? "" : ", ") + overlap(frames(name), mask, name);
    }
    char threshold[64];
    std::snprintf(threshold, sizeof threshold, "threshold %.3g per mm", o.threshold_per_mm);
    forms.push_back({printed, "intersection over union: plate, tilted plate, cylinder, sphere",
                     found, time_of([&] { (void)published::contact_by_slides(press, mask, o); }),
                     by_default, default_time, threshold + where});
  };
  const std::string whole = ", of 16 free frames, whole pad", middle = ", of their inner 15 mm";
  const published::SlidesContactOptions mean = {.clamps = true, .radius_px = 25};
  const published::SlidesContactOptions every = {
      .clamps = true, .every_direction = true, .radius_px = 25};
  add("contact: twice the mean of 36, r = 10 px (eq. 12)", {}, nullptr, ", as printed");
  add("the same, min(E - 2 sigma)", {}, &inner, middle);
  add("contact: mean of 18, r = 25 px, below delta_f [S]", mean, &free, whole);
  add("", mean, &inner, middle);
  add("contact: every direction, r = 25 px, below delta_R [S]", every, &free, whole);
  add("", every, &inner, middle);
}

/// A press whose depths contain neighbouring light of r = 8 px, and 0.02 mm of noise.
inline void add_light_fit(std::vector<Form>& forms) {
  using namespace fingerpad;
  constexpr Index size = 48, radius = 8;
  constexpr double pitch_mm = 0.25, m0 = 2e-3, n = 0.224;
  test::Image<double> free(size, size), pressed(size, size), actual(size, size);
  test::Random random(4);
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      const double x = pitch_mm * static_cast<double>(j - 22);
      const double y = pitch_mm * static_cast<double>(i - 26);
      free(i, j) = 8 - 0.02 * (x * x + y * y);
      pressed(i, j) = free(i, j) - 2 * std::exp(-(x * x + 0.7 * y * y) / 6);
    }
  }
  const auto change = published::inclination_change(pressed, free, pitch_mm);
  const auto removed = [&](Index r, double m0_r, double n_r) {
    test::Image<double> out(size, size);
    for (Index i = 0; i < size; ++i) {
      for (Index j = 0; j < size; ++j) {
        out(i, j) = published::without_neighbour_light(
            pressed(i, j), free(i, j), published::disc_sum(change, size, r, i, j), m0_r, n_r);
      }
    }
    return out;
  };
  const auto truth = removed(radius, m0, n);
  for (std::size_t k = 0; k < actual.cells.size(); ++k) {
    actual.cells[k] = truth.cells[k] + 0.02 * random.normal();
  }
  const auto said = [&](Index r, double m0_found, double n_found) {
    const auto depth = removed(r, m0_found, n_found);
    std::vector<double> errors;
    for (std::size_t k = 0; k < depth.cells.size(); ++k) {
      errors.push_back(depth.cells[k] - truth.cells[k]);
    }
    return Spread(errors).mean_and_worst() + "; r = " + std::to_string(r) + " px";
  };
  const auto printed = published::identify_neighbour_light(pressed, actual, free, pitch_mm);
  const std::array<test::Image<double>, 1> measured = {pressed}, known = {actual};
  const auto ours = fit_neighbour_light(pitch_mm, free, measured, known);
  std::vector<double> before;
  for (std::size_t k = 0; k < truth.cells.size(); ++k) {
    before.push_back(pressed.cells[k] - truth.cells[k]);
  }
  forms.push_back({"neighbouring light: fit of ln against ln, r = 1..50 [S]",
                   "error of depth that is left, mean / largest, mm",
                   said(printed.radius_px, printed.m0_mm_per_rad, printed.n_per_mm), time_of([&] {
                     (void)published::identify_neighbour_light(pressed, actual, free, pitch_mm);
                   }),
                   said(ours.light.radius_px, ours.light.m0_mm_per_rad, ours.light.n_per_mm),
                   time_of([&] { (void)fit_neighbour_light(pitch_mm, free, measured, known); }),
                   "a press of 48 x 48 px, light of r = 8 px, true depths to 0.02 mm; before: " +
                       Spread(before).mean_and_worst()});
}

inline void add_fluid_fit(std::vector<Form>& forms) {
  using namespace fingerpad;
  test::Pad pad;
  pad.one_height = true;
  const auto pencil = pad.pencil(24, 28);
  test::Random random(3);
  const auto known = [&](double depth_mm) {
    const auto c = noisy_colour(pad, depth_mm, random);
    return published::KnownPixel<double>{pencil.path_factor, pencil.meridional_mm, depth_mm, c.red,
                                         c.green};
  };
  std::vector<double> printed, ours;
  const auto reference = known(12);
  const std::array measured = {known(1), known(4), known(8)};
  std::vector<DepthSample<double>> samples;
  for (int draw = 0; draw < 200; ++draw) {
    const auto fluid =
        published::identify_fluid(known(12), std::array{known(1), known(4), known(8)});
    if (fluid) {
      printed.push_back(std::abs(fluid->c_R / 0.029 - 1));
    }
    samples.clear();
    for (int k = 0; k < 60; ++k) {
      const double depth_mm = 0.5 + 11.5 * k / 59;
      samples.push_back({pencil, {0, 0}, depth_mm, noisy_colour(pad, depth_mm, random)});
    }
    ours.push_back(std::abs(
        fit_absorption(std::span<const DepthSample<double>>(samples)).fluid.c_red_per_mm / 0.029 -
        1));
  }
  const auto median = [](std::vector<double> x) {
    std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
    return percent(x[x.size() / 2]);
  };
  forms.push_back(
      {"fluid: c_R, c_G, kappa from three equations [S]", "error of c_R, median", median(printed),
       time_of([&] { (void)published::identify_fluid(reference, measured); }), median(ours),
       time_of([&] { (void)fit_absorption(std::span<const DepthSample<double>>(samples)); }),
       "200 draws with 0.034 grey levels of noise; 4 depths, default 60"});
}

inline void add_force_forms(std::vector<Form>& forms) {
  using namespace fingerpad;
  constexpr double full_n = 9.93;
  const Samples press = samples_of(plates_but(""), test::ContactMeasure::area);
  const NormalForce by_area(fit_normal_force(span_of(press), 3).curve);
  double sum = 0;
  const auto of = [&](const auto& force) {
    return time_of(
        [&] {
          for (int k = 0; k < 1000; ++k) {
            sum += force(100.0 + k);
          }
        },
        1000);
  };
  const std::string default_time = of([&](double area) { return by_area(area).force_n; });
  const auto area_of = [](const test::WrenchFrame& f) {  // of the step with this force
    double area_mm2 = 0, nearest_n = 1e9;
    for (const test::ContactRecord& r : test::contact_records({f.scene})) {
      const double off_n = norm(r.force_n - f.force_n);
      area_mm2 = off_n < nearest_n ? r.area_mm2 : area_mm2;
      nearest_n = (std::min)(nearest_n, off_n);
    }
    test::require_data(nearest_n < 0.01, "contacts.csv has no step of " + f.name);
    return area_mm2;
  };
  for (const bool curved : {false, true}) {
    std::vector<double> printed, ours;
    for (const test::WrenchFrame& f : test::wrench_frames()) {
      if ((f.scene == "tilt" || f.scene == "roll" || f.scene == "cylinder") == curved) {
        const double area_mm2 = area_of(f);
        printed.push_back(published::flat_contact_force_n(f.pressure_mpa, area_mm2) + f.force_n.z);
        ours.push_back(by_area(area_mm2).force_n + f.force_n.z);
      }
    }
    forms.push_back({curved ? "" : "force: p S_c of a flat contact (eq. 2)",
                     "error of F_z, mean / largest, of the full scale",
                     Spread(printed).shares(full_n),
                     of([](double area) { return published::flat_contact_force_n(0.02, area); }),
                     Spread(ours).shares(full_n), default_time,
                     curved ? "tilted plate, cylinder, sphere; true areas; default: look-up by "
                              "area, calibrated on plates"
                            : "plates pressed, dragged, turned; areas are of F_z over pressure"});
  }
  const auto rest = [&](const std::string& printed, const published::Quadratic<double>& plain,
                        const published::AffineForce<double>& moved, const std::string& where) {
    std::vector<double> left;
    for (int k = 0; k <= 100; ++k) {
      const double n = plain(plain.from + (plain.to - plain.from) * k / 100);
      left.push_back(moved(n, 0) - n);
    }
    forms.push_back(
        {printed, "change of F_z without motion, mean / largest, N", Spread(left).mean_and_worst(),
         of([&](double m) { return moved(plain(m), 3); }), "0 / 0", default_time, where});
  };
  const auto area = published::normal_force_by_area(), depth = published::normal_force_by_depth();
  const auto first_area = published::first_normal_force_by_area();
  const auto with_0 = published::first_normal_force_by_depth();
  const auto with_8 = published::first_normal_force_by_depth(8.2);
  const std::string range = "the printed pad, 1 to 28 N; it should be 0";
  rest("force: eq. 19 by area, and eq. 21", area.plain, first_area.displaced, range);
  rest("eq. 19 by depth, constant 0.2", depth.plain, with_0.displaced, range);
  rest("eq. 19 by depth, constant 8.2", depth.plain, with_8.displaced, range);
  rest("eq. 21 by depth", depth.plain, depth.displaced, range);
  rest("eq. 20 by area", area.plain, first_area.rotated, range);
  rest("eq. 20 by depth", depth.plain, with_0.rotated, range);
  rest("eq. 22 by area", area.plain, area.rotated, range);
  rest("eq. 22 by depth", depth.plain, depth.rotated, range);
  benchmark::DoNotOptimize(sum);
}

/// Angle of dots that turn as one body, against the reference that each answer has.
inline void add_angles(std::vector<Form>& forms) {
  using namespace fingerpad;
  constexpr double step_rad = 0.01;
  const auto errors = [](const auto& ratio, const auto& angle_of) {
    std::vector<double> all;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      auto stick = ratio;
      test::SlippingDots dots;
      test::Random random(seed);
      for (int k = 0; k < 30; ++k) {
        const auto r = stick(noisy(dots.dots, jitter_px, random), dots.contact);
        if (r.updated()) {
          const double truth = step_rad * static_cast<double>(r.reference_age);
          all.push_back((angle_of(r) - truth) * 180 / std::numbers::pi);
        }
        dots.step({.turn_rad = step_rad});
      }
    }
    return Spread(all).mean_and_worst();
  };
  const auto of = [](const auto& ratio) {
    return of_stick_ratio(ratio,
                          [](const auto& work, double calls) { return time_of(work, calls); });
  };
  const StickRatio<> by_default(21, 21);
  const std::string ours = errors(by_default, [](const auto& r) {
    return static_cast<double>(zyx_angles(r.motion.rotation).z_rad);
  });
  const std::string our_time = of(by_default);
  for (const bool wraps : {false, true}) {
    const test::PublishedStick printed = {.ratio = {21, 21, {.wraps = wraps}}};
    forms.push_back(
        {wraps ? "the same, as differences of two directions"
               : "rotation: theta_0, the mean of four angles [R]",
         "error of the angle, mean / largest, degrees",
         errors(printed, [](const auto& r) { return static_cast<double>(r.printed.angle_rad); }),
         of(printed), ours, our_time,
         "21 x 21 dots turn as one body by 0.01 rad a frame, 0.06 px of noise; time of "
         "the whole ratio"});
  }
}

/// Margins to the friction of the last slip: a plate dragged to slip, and back, with true loads.
inline void add_friction(std::vector<Form>& forms) {
  using namespace fingerpad;
  constexpr double sliding = 0.05;  // stick ratio
  const test::SpatialScene drag("drag");
  published::FrictionRatio<> printed;
  FrictionLimit<double> ours;
  std::array<std::array<double, 2>, 2> margins = {{{1, -1}, {1, -1}}};  // held, sliding
  bool learnt = false;
  ContactLoad<double> load;
  for (Index k = 0; k < drag.size(); ++k) {
    const auto& step = drag[k];
    const bool slides = step.stick_ratio < sliding, learns = slides && step.phase == "drag";
    load = contact_load(step.force_n, step.moment_n_mm, step.dots, step.contact);
    const double margin =
        printed(std::hypot(step.force_n.x, step.force_n.y), -step.force_n.z, learns);
    const double our_margin = ours(load, learns ? 0.0 : 1.0, RatioUpdate::fresh).margin;
    if (learnt && step.phase == "back") {
      for (const auto& [of, now] : {std::pair{0, margin}, {1, our_margin}}) {
        auto& [held, slid] = margins[static_cast<std::size_t>(of)];
        held = slides ? held : (std::min)(held, now);
        slid = slides ? (std::max)(slid, now) : slid;
      }
    }
    learnt = learnt || learns;
  }
  double sum = 0;
  const auto of = [&](const auto& margin) {
    return time_of(
        [&] {
          for (int k = 0; k < 1000; ++k) {
            sum += margin(1 + 1e-4 * k);
          }
        },
        1000);
  };
  const auto told = [&](std::size_t k) {
    return number(margins[k][0]) + " / " + number(margins[k][1]);
  };
  forms.push_back({"slip: F / N against F_0 / N_0 of the last slip [R]",
                   "least margin while it holds / largest while it slides", told(0),
                   of([&](double f) { return printed(f, 4.0, false); }), told(1), of([&](double f) {
                     load.tangential_n = f;
                     return ours(load, 1.0, RatioUpdate::fresh).margin;
                   }),
                   "true loads of a plate dragged to slip and back"});
  benchmark::DoNotOptimize(sum);
}

inline void print_forms(std::ostream& out) {
  std::vector<Form> forms;
  add_contact_forms(forms);
  add_light_fit(forms);
  add_fluid_fit(forms);
  add_force_forms(forms);
  add_angles(forms);
  add_friction(forms);
  out << "### Other printed forms: error and time of a call\n\n| Printed form | Figure | Error | "
         "Time "
         "| Default: error | Time | The experiment here |\n|---|---|--:|--:|--:|--:|---|\n";
  for (const Form& f : forms) {
    out << "| " << f.printed << " | " << f.figure << " | " << f.error << " | " << f.time << " | "
        << f.default_error << " | " << f.default_time << " | " << f.experiment << " |\n";
  }
  out << '\n';
}

}  // namespace bench::papers
