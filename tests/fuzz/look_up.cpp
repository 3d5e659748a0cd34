// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Forces by look-up, from any curve and any measure: a normal force is finite and not negative
// where it is told, a variance is not negative, and NaN stands where nothing is told.
#include "fingerpad/force/look_up.hpp"

#include <cstdint>

#include "fuzz/input.hpp"

using namespace fingerpad;
using fuzz::Input;
using fuzz::require;

namespace {

ForceCurve<> any_curve(Input& in) {
  ForceCurve<> curve;
  curve.coefficients = {in.flag() ? in.number(-1, 1) : 0, in.number(0, 0.1), in.number(0, 0.001),
                        in.number(0, 1e-6)};
  curve.from = in.number(0, 100);
  curve.to = in.number(100, 400);
  curve.residual_sd_n = in.number(0, 1);
  for (std::size_t k = 0; k < 3; ++k) {
    curve.covariance[k][k] = in.number(0, 1);
  }
  curve.covariance[0][1] = in.number(-0.1, 0.1);
  return curve;
}

template <class Result>
void require_force(const Result& r) {
  require(r.has_force() ? is_finite(r.force_n) && r.force_n >= 0 : std::isnan(r.force_n),
          "a force is finite and not negative, or NaN");
  require(std::isnan(r.variance_n2) || r.variance_n2 >= 0, "a variance is not negative");
}

void try_normal(Input& in) {
  const ForceCurve<> curve = any_curve(in);
  const NormalForce force(curve), other(any_curve(in));
  for (int frame = 0; frame < 8; ++frame) {
    const double measure = in.number(-10, 500);
    const auto a = fuzz::frame([&] { return force(measure); });
    const auto b = fuzz::frame([&] { return other(measure, in.number(0, 1)); });
    require_force(a);
    require_force(b);
    require(!a.ok() || measure <= curve.to, "a force beyond the range is not ok");
    require_force(fused(a, b));
  }
}

void try_shear(Input& in) {
  ShearMap<> map;
  map.reference = in.number(1, 200);
  map.force = {in.number(0, 3), in.number(0, 2), 1};
  map.moment = {in.number(0, 60), in.number(0, 3), 1};
  const Shear shear(map);
  for (int frame = 0; frame < 8; ++frame) {
    const double measure = in.number(-10, 500), turned = in.number(-1, 1);
    const Point2<double> moved{in.number(-5, 5), in.number(-5, 5)};
    const auto r = fuzz::frame([&] { return shear(measure, moved, turned); });
    require(r.has_force() || std::isnan(r.tangential_force_n.x), "a force is finite or NaN");
    require(r.has_moment() || std::isnan(r.moment_n_mm), "a moment is finite or NaN");
    require(!r.ok() || (r.has_force() && r.has_moment()), "an ok result has a force and a moment");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, [](Input& in) { in.flag() ? try_normal(in) : try_shear(in); });
}
