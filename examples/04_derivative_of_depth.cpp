// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Computes the derivatives of a depth with respect to the colour and the calibration. With dual
// numbers as the scalar type, each kernel also returns its exact derivatives.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>

#include "fingerpad/adapt/dual.hpp"
#include "fingerpad/depth/depth.hpp"

namespace {

/// Depth of one pixel, 10 mm from the axis, for any scalar type.
template <fingerpad::scalar S>
S depth_of(const S& red, const S& green, const S& c_red, const S& kappa, const S& scattering) {
  const fingerpad::Camera<S> camera;
  fingerpad::Absorption<S> fluid;
  fluid.c_green_per_mm = fluid.c_green_per_mm - fluid.c_red_per_mm + c_red;
  fluid.c_red_per_mm = c_red;
  fluid.kappa = kappa;
  const auto ray = fingerpad::ray_at_tangent(camera, S(0.2));
  return fingerpad::newton_depth(fluid, ray, scattering, {red, green}).depth_mm;
}

}  // namespace

int main() {
  constexpr std::size_t n = 5;
  const char* names[n] = {"red", "green", "c_red", "kappa", "scattering"};
  const std::array<double, n> at = {58.0, 39.0, 0.0290, 0.9924, 0.0163};

  const auto [red, green, c_red, kappa, scattering] = fingerpad::seeded(at);
  const fingerpad::Dual<n> depth = depth_of(red, green, c_red, kappa, scattering);
  std::printf("depth %.4f mm\n", depth.value);

  bool right = true;
  for (std::size_t i = 0; i < n; ++i) {
    const double h = 1e-5 * at[i];
    const auto moved = [&](double by) {
      auto v = at;
      v[i] += by;
      return depth_of(v[0], v[1], v[2], v[3], v[4]);
    };
    const double difference = (moved(h) - moved(-h)) / (2 * h);
    const double derivative = depth.slopes[i];
    std::printf("  d depth / d %-10s %12.6f mm, by finite differences %12.6f mm\n", names[i],
                derivative, difference);
    right = right && std::abs(derivative - difference) < 1e-6 * std::abs(derivative);
  }
  return right ? 0 : 1;
}
