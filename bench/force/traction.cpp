// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Loads of a frame of 21 x 21 dots; "ns/pixel" is per frame. Errors over seven membranes of known
// load (tests/data/traction_*.csv): of the pressure at each dot whose neighbours all touch,
// relative to the pad's pressure, and of each component of force and moment, relative to the
// largest (of the moment where there is one); exact, and with noise of 0.02 mm in x, y and z of
// each dot.
#include "fingerpad/force/traction.hpp"

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "support/traction_scenes.hpp"

using namespace fingerpad;
using test::as;

namespace {

struct Errors {
  std::vector<double> pressure, force, moment;

  void note(bench::Counters& counters, const std::string& noise) const {
    bench::note_errors(counters, "pressure" + noise, "share", pressure);
    bench::note_errors(counters, "force" + noise, "share", force);
    bench::note_errors(counters, "moment" + noise, "share", moment);
  }

  /// Errors of the components, relative to the largest true one.
  template <class P>
  static void add(const P& found, const Point3<double>& truth, double of, std::vector<double>& to) {
    to.push_back((static_cast<double>(found.x) - truth.x) / of);
    to.push_back((static_cast<double>(found.y) - truth.y) / of);
    to.push_back((static_cast<double>(found.z) - truth.z) / of);
  }
};

template <class S, class Field>
Errors errors_of(Field& field, double noise_mm, int frames) {
  Errors errors;
  for (const test::TractionScene& s : test::traction_scenes()) {
    test::Gauss gauss(11);
    for (int k = 0; k < frames; ++k) {
      const auto r =
          field(as<S>(noisy(s.dots, noise_mm, gauss)), s.contact, static_cast<S>(s.pressure_mpa));
      Errors::add(r.force_n, s.force_n, s.largest_force_n(), errors.force);
      if (s.largest_moment_n_mm() > 0) {
        Errors::add(r.moment_n_mm, s.moment_n_mm, s.largest_moment_n_mm(), errors.moment);
      }
      for (Index i = 0; i < 21; ++i) {
        for (Index j = 0; j < 21; ++j) {
          if (s.inside_contact(i, j, 1)) {
            const auto found = static_cast<double>(field.pressure_mpa()(i, j));
            errors.pressure.push_back((found - s.contact_pressure_mpa(i, j)) / s.pressure_mpa);
          }
        }
      }
    }
  }
  return errors;
}

template <class S = double>
void add_frame(const std::string& name, const TractionOptions<S>& options = {}) {
  const test::TractionScene& scene = test::traction_scenes()[1];
  const auto dots = as<S>(scene.dots);
  const test::Dots stress_free = test::stress_free_dots();
  const bench::Memory memory;
  const auto d = std::make_shared<TractionField<S>>(stress_free, options);
  bench::add(
      "frame of 21x21 dots/" + name, 1, memory.bytes(),
      [d, dots, &scene] {
        benchmark::DoNotOptimize((*d)(dots, scene.contact, static_cast<S>(scene.pressure_mpa)));
      },
      [d, errors = std::array<Errors, 2>()](auto& counters) mutable {
        if (errors[0].force.empty()) {
          errors = {errors_of<S>(*d, 0, 1), errors_of<S>(*d, 0.02, 40)};
        }
        errors[0].note(counters, "");
        errors[1].note(counters, ", 20 um noise");
      });
}

/// A membrane of 21 x 21 dots has 800 triangles with one deformation gradient each to invert.
void add_opencv() {
  const auto triangles = std::make_shared<std::vector<cv::Matx22d>>(800, cv::Matx22d(2, 1, 1, 3));
  const bench::Memory memory;
  const auto inverse = std::make_shared<std::vector<cv::Matx22d>>(800);
  bench::add(
      "frame of 21x21 dots/cv::invert of 800 2x2", 1, memory.bytes(),
      [=] {
        for (std::size_t k = 0; k < triangles->size(); ++k) {
          cv::invert((*triangles)[k], (*inverse)[k]);
        }
        benchmark::DoNotOptimize(inverse->data());
      },
      [](auto&) {});
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  add_frame("mu t given, double", {.mu_t_n_per_mm = 0.5});
  add_frame<float>("mu t given, float", {.mu_t_n_per_mm = 0.5F});
  add_frame("mu t from the balance, double, the default");
  add_frame<float>("mu t from the balance, float");
  add_frame("mu t given, abrupt end of the sums", {.mu_t_n_per_mm = 0.5, .fade_dots = 0});
  add_frame("mu t given, no ring, abrupt end",
            {.mu_t_n_per_mm = 0.5, .ring_dots = 0, .fade_dots = 0});
  add_opencv();
  bench::add_streaming("frame of 21x21 dots");
  return bench::run(argc, argv);
}
