// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Forces by look-up, from any curve and any measure: a normal force is finite and not negative
// where it is told, a variance is not negative, and NaN stands where nothing is told.
#include <cstdint>

#include "fingerpad/force/normal_force.hpp"
#include "fingerpad/force/shear.hpp"
#include "fuzz/input.hpp"

using namespace fingerpad;
using fuzz::Input;
using fuzz::require;

namespace {

PolynomialForce<> any_polynomial(Input& in) {
  return {{in.flag() ? in.number(-1, 1) : 0, in.number(0, 0.1), in.number(0, 0.001)},
          in.number(0, 100),
          in.number(100, 400)};
}
PowerLawForce<> any_power_law(Input& in) {
  return {in.number(0.5, 5), in.number(0.1, 1), in.number(0, 2), in.number(2, 10)};
}

template <class Result>
void require_force(const Result& r) {
  require(r.has_force() ? is_finite(r.force_n) && r.force_n >= 0 : std::isnan(r.force_n),
          "a force is finite and not negative, or NaN");
  require(std::isnan(r.variance_n2) || r.variance_n2 >= 0, "a variance is not negative");
}

template <class Curve>
void try_normal(Input& in, const Curve& curve) {
  CurveErrors<Curve::parameters> errors;
  errors.residual_sd_n = in.number(0, 1);
  errors.measure_sd = in.number(0, 1);
  const ScaledCompensation<> compensation{in.number(-0.1, 0.1), in.number(-1, 1)};
  const NormalForce plain(curve, NoCompensation(), errors);
  const NormalForce compensated(curve, compensation, errors);
  for (int frame = 0; frame < 8; ++frame) {
    const double measure = in.number(-10, 500);
    const Point2<double> moved{in.number(-5, 5), in.number(-5, 5)};
    const double turned = in.number(-1, 1);
    const auto a = fuzz::frame([&] { return plain(measure); });
    const auto b = fuzz::frame([&] { return compensated(measure, moved, turned); });
    require_force(a);
    require_force(b);
    require(!a.ok() || measure <= curve.to, "a force beyond the range is not ok");
    const auto both = fused(a, b, in.number(0.1, 5));
    require_force(both);
    require(both.sources <= int(a.has_force()) + int(b.has_force()),
            "there are at most as many sources as forces");
  }
}

template <class Map>
void try_shear(Input& in, const Map& map) {
  const Shear<Map> shear({in.number(1, 200), in.number(0, 2), in.number(0, 3)}, map);
  for (int frame = 0; frame < 8; ++frame) {
    const double measure = in.number(-10, 500), turned = in.number(-1, 1);
    const Point2<double> moved{in.number(-5, 5), in.number(-5, 5)};
    const auto r = fuzz::frame([&] { return shear(measure, moved, turned); });
    require(r.has_force() == is_finite(r.tangential_force_n),
            "a force is reported exactly if it is finite");
    require(r.has_moment() == is_finite(r.moment_n_mm),
            "a moment is reported exactly if it is finite");
    require(!r.ok() || (r.has_force() && r.has_moment()), "an ok result has a force and a moment");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, [](Input& in) {
    switch (in.whole(0, 3)) {
      case 0:
        return try_normal(in, any_polynomial(in));
      case 1:
        return try_normal(in, any_power_law(in));
      case 2:
        return try_shear(in, RadialShear<2>{{{in.number(0, 3), in.number(-1, 1)}, in.number(1, 5)},
                                            {{in.number(0, 60), in.number(-9, 9)}, 1}});
      default:
        return try_shear(in, LinearShear<>{.x_by_x = in.number(0, 3),
                                           .x_by_y = in.number(-1, 1),
                                           .y_by_x = in.number(-1, 1),
                                           .y_by_y = in.number(0, 3),
                                           .moment_n_mm_per_rad = in.number(0, 60)});
    }
  });
}
