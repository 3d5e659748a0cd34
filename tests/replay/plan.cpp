// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// What is planned for a finger is what the estimators say of one that is built.
#include <cmath>
#include <map>
#include <string>

#include "calibrate/calibrations.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "support/rim_marks.hpp"

namespace {

calibrate::Plan plan_of(const test::RimScene& scene) {
  calibrate::Plan plan;
  plan.base_radius_mm = scene.cap.base_radius_mm;
  plan.stress_free_height_mm = scene.cap.height_mm;
  plan.thickness_mm = 0.5;
  plan.shear_modulus_mpa = scene.modulus_n_per_mm / plan.thickness_mm;
  plan.pressure_mpa = scene.frames[0].pressure_mpa;
  return plan;
}

std::map<std::string, double> planned(const calibrate::Plan& plan) {
  std::map<std::string, double> numbers;
  const auto outcome = calibrate::plan(plan);
  for (const auto& p : outcome.reports.at(0).parameters) {
    numbers[p.name] = p.value;
  }
  return numbers;
}

}  // namespace

TEST_CASE("calibrate plan: standard deviations of finite-element pads", "[calibrate]") {
  for (const test::RimScene& scene : test::rim_scenes()) {
    if (scene.cap.mooney_share > 0) {
      continue;
    }
    const fingerpad::WrenchOptions options = {.cap = scene.cap,
                                              .modulus_n_per_mm = scene.modulus_n_per_mm};
    const test::SeenRim rim(scene, options, 0.06, 1);
    auto plan = plan_of(scene);
    for (const auto& mark : rim.marks) {
      plan.places.push_back({mark.arc_mm, mark.azimuth_rad});
    }
    const auto numbers = planned(plan);
    // nothing touches it, as in the plan; the mean over frames, each of which follows its residuals
    Eigen::Matrix<double, 6, 1> variance = Eigen::Matrix<double, 6, 1>::Zero();
    constexpr int frames = 8;
    for (int k = 0; k < frames; ++k) {
      const auto seen =
          test::SeenRim(scene, options, 0.06, 5 + static_cast<std::uint64_t>(k)).fit(0);
      REQUIRE(seen.has_force());
      variance += seen.covariance.diagonal() / frames;
    }
    const char* names[] = {"sd_f_x_n",    "sd_f_y_n",    "sd_f_z_n",
                           "sd_m_x_n_mm", "sd_m_y_n_mm", "sd_m_z_n_mm"};
    for (Eigen::Index k = 0; k < 6; ++k) {
      const double found = numbers.at(names[k]), told = std::sqrt(variance[k]);
      CAPTURE(scene.name, k, found, told);
      CHECK(std::fabs(found / told - 1) < 0.15);
    }
  }
}

TEST_CASE("calibrate plan: noise, light and dots tell", "[calibrate]") {
  auto plan = plan_of(test::rim_scenes().front());
  auto given = planned(plan);
  plan.dot_noise_px *= 2;
  plan.brightness /= 2;
  auto worse = planned(plan);
  CHECK(worse["sd_f_x_n"] == Approx(2 * given["sd_f_x_n"]).epsilon(0.1));
  CHECK(worse["sd_depth_at_apex_mm"] == Approx(2 * given["sd_depth_at_apex_mm"]).epsilon(0.15));
  CHECK(worse["smallest_press_n"] > given["smallest_press_n"]);
  plan.rows_mm = {2, 4, 6};
  CHECK(planned(plan)["dots_near_rim"] > 150);
  plan.rows_mm = {2};
  plan.dots_in_row = 12;
  const auto few = calibrate::plan(plan).reports.at(0);
  CHECK(few.because.find("more dots near the rim") != std::string::npos);
  plan.pressure_mpa = 1;
  CHECK(test::refusal([&] { (void)calibrate::plan(plan); }).find("pressure_mpa = 1") !=
        std::string::npos);
}
