// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Loads of a frame of 21 x 21 dots. "ns/pixel" is per frame. Errors are rms over seven membranes of
// known load (tests/data/traction_*.csv), per cent of the largest component of the force, of the
// pressure for dots whose neighbours all touch; noise is in x, y and z of each dot.
#include "fingerpad/traction.hpp"

#include <cmath>
#include <memory>
#include <string>

#include "../tests/support/traction_scenes.hpp"
#include "support/run.hpp"

using namespace fingerpad;

namespace {

struct Errors {
  double force_pct = 0;
  double pressure_pct = 0;
};

template <class Field>
Errors errors_of(const Field& field, double noise_mm, int frames) {
  Errors sum;
  for (const auto& s : test::traction_scenes()) {
    const test::TractionError e = traction_error(field, s, noise_mm, frames);
    for (const double f : e.force) {
      sum.force_pct += f * f;
    }
    sum.pressure_pct += e.pressure_rms * e.pressure_rms;
  }
  const auto count = static_cast<double>(test::traction_scenes().size());
  return {100 * std::sqrt(sum.force_pct / count / 3), 100 * std::sqrt(sum.pressure_pct / count)};
}

template <class Modulus, class S = double>
void add_frame(const std::string& name,
               const Modulus& modulus,
               const TractionOptions& options = {}) {
  struct Running {
    TractionField<Modulus, S> field;
    TractionMaps<S> maps;
    test::Cells<Point3<S>> dots;
    const test::TractionScene& scene;
  };
  const test::TractionScene& scene = test::traction_scenes()[1];
  const TractionField<Modulus, S> field(test::stress_free_dots(), modulus, options);
  const auto d = std::make_shared<Running>(
      Running{field, field.maps(), test::Cells<Point3<S>>(21, 21), scene});
  for (std::size_t k = 0; k < scene.dots.cells.size(); ++k) {
    const auto& p = scene.dots.cells[k];
    d->dots.cells[k] = {static_cast<S>(p.x), static_cast<S>(p.y), static_cast<S>(p.z)};
  }
  bench::add(
      "frame of 21x21 dots/" + name, 1,
      [d] {
        benchmark::DoNotOptimize(
            d->field(d->dots, d->scene.contact, static_cast<S>(d->scene.pressure_mpa), d->maps));
      },
      [d](auto& counters) {
        const Errors exact = errors_of(d->field, 0, 1), noisy = errors_of(d->field, 0.02, 40);
        counters["force_error_pct"] = exact.force_pct;
        counters["pressure_error_pct"] = exact.pressure_pct;
        counters["force_error_pct_at_20um"] = noisy.force_pct;
        counters["pressure_error_pct_at_20um"] = noisy.pressure_pct;
      });
}

}  // namespace

int main(int argc, char** argv) {
  add_frame("GivenModulus, double", GivenModulus{0.5});
  add_frame<GivenModulus<float>, float>("GivenModulus, float", GivenModulus{0.5F});
  add_frame("BalancedModulus, double, the default", BalancedModulus{});
  add_frame<BalancedModulus, float>("BalancedModulus, float", BalancedModulus{});
  add_frame("GivenModulus, abrupt end of the sums", GivenModulus{0.5}, {.fade_dots = 0});
  add_frame("GivenModulus, no ring, abrupt end", GivenModulus{0.5},
            {.ring_dots = 0, .fade_dots = 0});
  return bench::run(argc, argv);
}
