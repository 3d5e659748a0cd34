// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Calibrations: time of a fit ("ns/pixel" is per fit).
// "... on scenes": curves and maps from contacts of finite-element membranes
// (tests/data/contacts.csv). Error: of the method, on a scene that the fit does not use. Published
// rows: a quadratic with a constant, from the press alone; the central dot, straight lines and the
// printed exponents, from "mix".
// "reference of a free pad": 480 x 640 pixels. Error: of the depth under a flat plate from exact
// colours, with the reference of a free frame with one grey level of noise; it is therefore the
// error of the reference alone.
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"
#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/force/look_up.hpp"
#include "fingerpad/published/depth.hpp"
#include "support/contact_records.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::ContactDotsOf;
using test::ContactMeasure;

namespace {

using Samples = std::vector<ForceSample<double>>;

std::span<const ForceSample<double>> span_of(const Samples& samples) {
  return samples;
}

/// An estimator without smoothing from what a fit returns.
DepthEstimator<double> estimator_of(const bench::Scene& scene, const DepthReference<double>& of) {
  return {scene.pad.camera, scene.pad.fluid, of, {.window_px = 1}};
}
published::DepthEstimator<> estimator_of(const bench::Scene&,
                                         const published::DepthEstimator<>& of) {
  return of;
}

/// `fit(scene, free frame)` returns a reference, or the published estimator, which holds its own.
template <class Fit>
void add_reference(const std::string& name, const bench::Scene& of, const Fit& fit) {
  const auto scene = std::make_shared<bench::Scene>(of);
  const auto free =
      std::make_shared<test::Frame<double>>(scene->pad.frame<double>(scene->free_mm, scene->noise));
  const bench::Memory memory;
  const auto reference = fit(*scene, *free);
  bench::add(
      "reference of a free pad/" + name, 1, memory.bytes(),
      [=] { benchmark::DoNotOptimize(fit(*scene, *free)); },
      [=](auto& counters) {
        auto estimate = estimator_of(*scene, reference);
        const auto seen = scene->pad.frame<double>(scene->pressed_mm);
        test::Image<double> depth_mm(scene->pad.rows, scene->pad.cols);
        (void)estimate(seen.red, seen.green, depth_mm);
        bench::note_errors(counters, "depth", "mm", bench::errors_of(depth_mm, scene->pressed_mm));
      });
}

void add_references() {
  const auto published = [](int window_px) {
    return [=](const bench::Scene& s, const test::Frame<double>& free) {
      return published::DepthEstimator<>(s.pad.published(window_px), free.red, free.green,
                                         s.free_mm);
    };
  };
  bench::Scene one_height = bench::round_pad();
  one_height.pad.one_height = true;
  add_reference("published: quotients of a smoothed frame", one_height, published(29));
  add_reference("quotients of a frame as it is", one_height, published(1));
  add_reference("fit_reference", bench::round_pad(),
                [](const bench::Scene& s, const test::Frame<double>& free) {
                  return fit_reference<double>(s.pad.camera, s.pad.fluid, free.red, free.green,
                                               s.free_mm);
                });
}

Samples samples_of(const std::vector<std::string>& scenes,
                   ContactMeasure measure,
                   ContactDotsOf dots = ContactDotsOf::edge) {
  return test::force_samples(test::contact_records(scenes), measure, dots);
}
/// `fit(samples)` uses the scenes of the calibration; `error(fit, sample)` is evaluated on another
/// scene.
template <class Fit, class Error>
struct OnScenes {
  ContactMeasure measure;
  ContactDotsOf dots;
  Fit fit;
  Error error;
};

/// Pairs of the scenes to fit and the scene to test.
using Pairs = std::vector<std::pair<std::vector<std::string>, std::string>>;

template <class Fit, class Error>
void add_look_up(const std::string& name,
                 const std::string& quantity,
                 const std::string& unit,
                 const Pairs& pairs,
                 const OnScenes<Fit, Error>& of) {
  const bench::Memory memory;
  const auto samples =
      std::make_shared<Samples>(samples_of(pairs.front().first, of.measure, of.dots));
  bench::add(
      quantity + " on scenes/" + name, 1, memory.bytes(),
      [=] { benchmark::DoNotOptimize(of.fit(*samples)); },
      [=](auto& counters) {
        std::vector<double> errors;
        for (const auto& [from, on] : pairs) {
          const auto fit = of.fit(samples_of(from, of.measure, of.dots));
          for (const auto& s : samples_of({on}, of.measure, of.dots)) {
            errors.push_back(of.error(fit, s));
          }
        }
        bench::note_errors(counters, quantity, unit, errors);
      });
}

void add_normal(const std::string& name,
                ContactMeasure measure,
                const Pairs& pairs,
                int degree = 2,
                bool through_zero = true) {
  const auto fit = [=](const Samples& samples) {
    return fit_normal_force(span_of(samples), degree, through_zero);
  };
  const auto error = [](const auto& found, const ForceSample<double>& s) {
    const NormalForce force(found.curve);
    return force(s.measure).force_n - s.normal_force_n;
  };
  add_look_up(name, "normal force", "N", pairs,
              OnScenes<decltype(fit), decltype(error)>{measure, ContactDotsOf::edge, fit, error});
}

void add_tangential(const std::string& name,
                    ContactMeasure measure,
                    ContactDotsOf dots,
                    const std::optional<double>& exponent = {}) {
  const double reference = measure == ContactMeasure::depth ? 10 : 100;
  const auto fit = [=](const Samples& samples) {
    return fit_tangential_force(span_of(samples), reference, exponent);
  };
  const auto error = [=](const auto& found, const ForceSample<double>& s) {
    const Shear<> shear({reference, found.law, found.law});
    const auto f = shear(s.measure, s.displacement_mm, 0).tangential_force_n;
    return std::hypot(f.x - s.tangential_force_n.x, f.y - s.tangential_force_n.y);
  };
  add_look_up(name, "tangential force", "N",
              {{{"mix"}, "drag"}, {{"mix"}, "tilt"}, {{"mix"}, "cylinder"}},
              OnScenes<decltype(fit), decltype(error)>{measure, dots, fit, error});
}

void add_moment(const std::string& name,
                ContactDotsOf dots,
                const std::optional<double>& exponent = {}) {
  const auto fit = [=](const Samples& samples) {
    return fit_moment(span_of(samples), 100.0, exponent);
  };
  const auto error = [](const auto& found, const ForceSample<double>& s) {
    const Shear<> shear({100.0, found.law, found.law});
    return shear(s.measure, {0, 0}, s.rotation_rad).moment_n_mm - s.moment_n_mm;
  };
  add_look_up(name, "moment", "N mm", {{{"mix"}, "twist"}},
              OnScenes<decltype(fit), decltype(error)>{ContactMeasure::area, dots, fit, error});
}

}  // namespace

int main(int argc, char** argv) {
  (void)test::contact_records({});  // read the file now: its memory does not belong to a fit
  add_references();
  const Pairs plates = {{{"drag", "twist", "mix"}, "press"},
                        {{"press", "twist", "mix"}, "drag"},
                        {{"press", "drag", "mix"}, "twist"},
                        {{"press", "drag", "twist"}, "mix"}};
  const Pairs press = {{{"press"}, "drag"}, {{"press"}, "twist"}, {{"press"}, "mix"}};
  constexpr auto area = ContactMeasure::area, depth = ContactMeasure::depth;
  constexpr auto edge = ContactDotsOf::edge, center = ContactDotsOf::center;
  add_normal("area, degree 2, published", area, press, 2, false);
  add_normal("depth, degree 2, published", depth, press, 2, false);
  add_normal("area, degree 2", area, plates);
  add_normal("area, degree 3", area, plates, 3);
  add_normal("depth, degree 3", depth, plates, 3);
  add_tangential("central dot, published", area, center, 0.65);
  add_tangential("edge dots, area", area, edge);
  add_tangential("edge dots, depth", depth, edge);
  add_moment("central dot, published", center, 1.7);
  add_moment("edge dots", edge);
  return bench::run(argc, argv);
}
