// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A lift by the foam contact model; the time is that of the whole lift. "printed": both integrals
// of eq. 10 by the trapezoidal rule, from 0. Errors: mm, at ten times up to 40.
#include "fingerpad/sim/foam_contact.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "bench/support/run.hpp"

using namespace fingerpad;

namespace {

/// Eq. 10 as printed, with a lower limit of 0: two integrals by the trapezoidal rule.
double printed_lift(const LiftLoad<double>& load, double time, int steps) {
  const double w = std::sqrt(3.0) / 2, h = time / steps;
  double with_sine = 0, with_cosine = 0;
  for (int k = 0; k <= steps; ++k) {
    const double t = h * k, weight = k == 0 || k == steps ? h / 2 : h;
    const double grown = weight * std::exp(t / 2) * load(t);
    with_sine += grown * std::sin(w * t);
    with_cosine += grown * std::cos(w * t);
  }
  return std::exp(-time / 2) / w *
         (std::sin(w * time) * with_cosine - std::cos(w * time) * with_sine);
}

/// The causal integral by 4-point Gauss quadrature in steps of 0.01. At 40 it is 2.8009407050775539
/// (50 digits).
double true_lift(const LiftLoad<double>& load, double time) {
  const double w = std::sqrt(3.0) / 2, half = 0.005;
  double sum = 0;
  for (int k = 0; k < std::lround(time / (2 * half)); ++k) {
    const double middle = (2 * k + 1) * half;
    for (const auto& [at, weight] : {std::array{0.8611363115940526, 0.3478548451374538},
                                     {0.3399810435848563, 0.6521451548625461}}) {
      for (const double u : {middle - half * at, middle + half * at}) {
        sum += weight * half * std::exp((u - time) / 2) * std::sin(w * (time - u)) * load(u);
      }
    }
  }
  return sum / w;
}

/// `of(load, time, steps)` is the position.
template <class Lift>
void add_lift(const std::string& name, int steps, const Lift& of) {
  const LiftLoad<double> load{2, 0.5, 3, {0.3, 0.05}};
  bench::add(
      "lift, " + std::to_string(steps) + " steps/" + name, 1, sizeof(load),
      [=] { benchmark::DoNotOptimize(of(load, 40.0, steps)); },
      [=](auto& counters) {
        std::vector<double> errors;
        for (int k = 1; k <= 10; ++k) {
          const double time = 4.0 * k;
          errors.push_back(of(load, time, steps * k / 10) - true_lift(load, time));
        }
        bench::note_errors(counters, "position", "mm", errors);
      });
}

void add_causal(const std::string& name, int steps) {
  add_lift(name, steps, [](const LiftLoad<double>& load, double time, int count) {
    return causal_response(MassSpringDamper<double>{}, load, time, count).position_mm;
  });
}

void add_lifts(int steps) {
  add_lift("published: printed, trapezoidal rule", steps, &printed_lift);
  add_causal("causal_response, the default", steps);
}

}  // namespace

int main(int argc, char** argv) {
  add_lifts(2000);
  return bench::run(argc, argv);
}
