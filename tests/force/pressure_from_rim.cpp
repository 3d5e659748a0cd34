// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/pressure_from_rim.hpp"

#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "support/wrench_frames.hpp"

using namespace fingerpad;
using test::exact_heights;
using test::rows_of;
using test::WrenchFrame;

namespace {

const WrenchFrame& frame() {
  return test::wrench_frames()[2];
}

template <class W>
WrenchResult<double> found_by(const W& wrench, double modulus) {
  auto work = wrench.workspace();
  return pressure_from_rim(wrench, exact_heights(frame().heights), rows_of(frame().dots, 1),
                           modulus, work);
}

}  // namespace

TEST_CASE("pressure from the rim: what the wrench says at a pressure is undone", "[wrench]") {
  const auto rim = test::rim_border();
  const auto check = [&](const auto& wrench) {
    for (const double mpa : {0.002, 0.02, 0.12}) {
      auto work = wrench.workspace();
      const auto told = wrench(exact_heights(frame().heights), rows_of(frame().dots, 1), mpa, work);
      REQUIRE(told.ok());
      CHECK(told.pressure_mpa == mpa);
      const auto found = found_by(wrench, told.modulus_n_per_mm);
      REQUIRE(found.ok());
      CHECK(found.pressure_mpa == Approx(mpa).epsilon(1e-4));
      CHECK(found.force_n.x == Approx(told.force_n.x).epsilon(1e-4));
      CHECK(found.moment_n_mm.z == Approx(told.moment_n_mm.z).epsilon(1e-4).margin(1e-6));
    }
  };
  check(Wrench<BalancedRim>(rim));
  check(Wrench<BalancedRim>(rim, {}, {}, OneRow{1.0623}));
  check(Wrench<LeastSquares>(rim));
}

TEST_CASE("pressure from the rim: a calibrated modulus far from the first guess", "[wrench]") {
  const auto rim = test::rim_border();
  for (const double modulus : {0.05, 0.5, 2.0}) {
    const Wrench<BalancedRim> wrench(rim, {.calibrated_modulus_n_per_mm = modulus});
    const auto found = found_by(wrench, modulus);
    CAPTURE(modulus);
    REQUIRE(found.ok());
    CHECK(found.pressure_mpa == Approx(frame().pressure_mpa * modulus / 0.5).epsilon(0.05));
  }
}

TEST_CASE("pressure from the rim: a free pad has no force, and its pressure is not known",
          "[wrench]") {
  struct FreePad {
    decltype(exact_heights(frame().heights)) heights = exact_heights(frame().heights);
    auto operator()(double x, double y) const { return heights(x, y); }
    bool in_contact(double, double) const { return false; }
  };
  const Wrench<BalancedRim> wrench(test::rim_border());
  auto work = wrench.workspace();
  const auto found = pressure_from_rim(wrench, FreePad{}, rows_of(frame().dots, 1), 0.5, work);
  CHECK(found.status == WrenchStatus::no_contact);
  CHECK(found.force_n.z == 0);
  CHECK(found.moment_n_mm.x == 0);
  CHECK(std::isnan(found.pressure_mpa));
}

TEST_CASE("pressure from the rim: what cannot be is said", "[wrench]") {
  const auto rim = test::rim_border();
  const Wrench<BalancedRim> wrench(rim);
  for (const double modulus :  // also in N/m
       {0.0, -0.5, 500.0, std::numeric_limits<double>::infinity(), not_a_number<double>()}) {
    CHECK(found_by(wrench, modulus).status == WrenchStatus::refused);
  }
  // a pressure above max_pressure_mpa
  const auto stiff = found_by(wrench, 50);
  CHECK(stiff.status == WrenchStatus::pressure_not_in_mpa);
  CHECK(std::isnan(stiff.pressure_mpa));
  CHECK(std::isnan(stiff.force_n.x));
  // a wrench calibrated with another modulus than the one given
  CHECK(found_by(Wrench<BalancedRim>(rim, {.calibrated_modulus_n_per_mm = 0.5}), 2.0).status ==
        WrenchStatus::modulus_not_as_calibrated);
}
