// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// What a finger will measure that is not yet built: the library's own estimators on its free pad,
// with the noise of the camera.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "calibrate/calibrations.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/force/wrench.hpp"
#include "fingerpad/membrane/annulus.hpp"
#include "fingerpad/membrane/free_pad.hpp"

namespace calibrate {
namespace {

using fingerpad::Point2;
using Noise = std::normal_distribution<double>;

/// A camera whose picture's height the pad fills.
fingerpad::Camera<double> camera_of(const Plan& plan) {
  fingerpad::Camera<double> camera;
  camera.pitch_mm *= plan.base_radius_mm / 18.735 * 480 / plan.picture_rows;
  camera.center_y_px = (plan.picture_rows - 1) / 2.0;
  camera.center_x_px = (plan.picture_rows * 4.0 / 3 - 1) / 2;
  return camera;
}

/// Arc from the rim and azimuth of the dots on the membrane without stress.
std::vector<Point2<double>> print_of(const Plan& plan,
                                     const fingerpad::StressFreeCap<double>& cap) {
  std::vector<Point2<double>> places = plan.places;
  for (std::size_t row = 0; row < plan.rows_mm.size(); ++row) {
    for (int k = 0; k < plan.dots_in_row; ++k) {
      places.push_back({plan.rows_mm[row], 2 * std::numbers::pi * (k + (row % 2 == 1 ? 0.5 : 0.0)) /
                                               plan.dots_in_row});
    }
  }
  const int reach = static_cast<int>(cap.base_radius_mm / plan.grid_pitch_mm);
  for (int i = -reach; plan.rows_mm.empty() && plan.places.empty() && i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      const double x = j * plan.grid_pitch_mm, y = i * plan.grid_pitch_mm;
      const double share = std::hypot(x, y) / cap.radius_mm();
      if (share < cap.rho_mm(0) / cap.radius_mm()) {
        places.push_back({cap.arc_mm() - cap.radius_mm() * std::asin(share), std::atan2(y, x)});
      }
    }
  }
  return places;
}

/// Adds the six axes of the free pad.
void plan_axes(const Plan& plan, Report& report) {
  fingerpad::WrenchOptions options;
  options.cap = {plan.base_radius_mm, plan.stress_free_height_mm};
  options.modulus_n_per_mm = plan.shear_modulus_mpa * plan.thickness_mm;
  const auto camera = camera_of(plan);
  fingerpad::Wrench<> wrench(camera, options);
  const auto rim =
      fingerpad::FreePad<double>(options.cap).rim(plan.pressure_mpa / options.modulus_n_per_mm);
  fingerpad::expects(rim.has_value() && wrench.begin(plan.pressure_mpa), "plan", "pressure_mpa",
                     plan.pressure_mpa, "one that inflates the pad without bursting it");
  fingerpad::Annulus<double> membrane(options.cap,
                                      {.reach_mm = wrench.reach_mm(), .slopes = false});
  std::vector<double> free(membrane.parameters(), 0.0);
  free[0] = rim->stretch * std::cos(rim->slope_rad);
  free[2 * membrane.terms()] = rim->stretch * std::sin(rim->slope_rad);
  free.back() = plan.pressure_mpa / options.modulus_n_per_mm;
  membrane.march(free);
  std::vector<fingerpad::Mark> seen;
  for (const auto& [arc_mm, azimuth] : print_of(plan, options.cap)) {
    if (arc_mm > 0 && arc_mm < wrench.reach_mm()) {
      const auto px = pixel_of(camera, membrane.at(membrane.place(arc_mm, azimuth)));
      if (auto mark = wrench.place_in_free_picture(px)) {
        mark->sd_px = plan.dot_noise_px * std::sqrt(1 + 1.0 / 16);  // places: of 16 pictures
        seen.push_back(*mark);
      }
    }
  }
  std::mt19937_64 bits(20110801);
  Noise noise;
  constexpr int draws = 16;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  fingerpad::WrenchResult result;
  for (int k = 0; k < draws; ++k) {
    auto marks = seen;
    for (fingerpad::Mark& mark : marks) {
      mark.px += Point2<double>{mark.sd_px * noise(bits), mark.sd_px * noise(bits)};
    }
    result = wrench(marks, plan.pressure_mpa);
    covariance += result.covariance / draws;
  }
  report.residual = result.misfit;
  report.doubt(!covariance.allFinite(),
               std::string("six axes need more dots near the rim: ") + name_of(result.status));
  report.parameters.push_back({"dots_near_rim", static_cast<double>(seen.size())});
  const char* names[] = {"sd_f_x_n",    "sd_f_y_n",    "sd_f_z_n",
                         "sd_m_x_n_mm", "sd_m_y_n_mm", "sd_m_z_n_mm"};
  for (int k = 0; k < 6; ++k) {
    report.parameters.push_back({names[k], std::sqrt(covariance(k, k))});
  }
  report.parameters.push_back({"smallest_press_n", 4 * std::sqrt(covariance(2, 2))});
}

/// Standard deviation of a depth in one picture, near the axis.
double depth_sd_mm(const Plan& plan, double depth_mm) {
  auto camera = camera_of(plan);
  fingerpad::Absorption<double> fluid;
  fluid.max_depth_mm = depth_mm + 4;
  constexpr int patches = 12, frames = 16;
  const int width = plan.window_px + 1;
  fingerpad::DepthReference<float> reference;
  reference.rows = 2 * width + 1;
  reference.cols = patches * width;
  camera.center_x_px = patches * width / 2.0;
  camera.center_y_px = width;
  const auto size = static_cast<std::size_t>(reference.rows * reference.cols);
  const double g = 0.044 / 140 * plan.brightness;  // as red fluids scatter
  reference.depth_mm.assign(size, static_cast<float>(depth_mm));
  reference.scattering.assign(size, static_cast<float>(g));
  reference.pixels_used = static_cast<fingerpad::Index>(size);
  const auto ray = ray_at_pixel(camera, camera.center_y_px, camera.center_x_px);
  const auto colour = colour_at_depth(fluid, ray, plan.brightness, g, depth_mm);
  fingerpad::DepthEstimator<float> estimate(camera, fluid, reference,
                                            {.window_px = plan.window_px});
  std::vector<std::uint8_t> red(size), green(size);
  std::vector<float> depth(size);
  const auto view = [&](auto& cells) {
    return fingerpad::StridedView<std::remove_reference_t<decltype(cells[0])>>(
        cells.data(), reference.rows, reference.cols, reference.cols);
  };
  std::mt19937_64 bits(20110801);
  Noise noise(0, plan.grey_noise);
  std::vector<double> sum(patches, 0.0);
  double sum_sq = 0;
  for (int k = 0; k < frames; ++k) {
    for (std::size_t i = 0; i < size; ++i) {
      const auto level = [&](double ideal) {
        return static_cast<std::uint8_t>(std::fmin(std::fmax(ideal + noise(bits) + 0.5, 0), 255));
      };
      red[i] = level(colour.red);
      green[i] = level(colour.green);
    }
    (void)estimate(view(red), view(green), view(depth));
    for (int patch = 0; patch < patches; ++patch) {
      const auto at = static_cast<std::size_t>(width * reference.cols + patch * width + width / 2);
      const double off = static_cast<double>(depth[at]) - depth_mm;
      sum[static_cast<std::size_t>(patch)] += off;
      sum_sq += off * off;
    }
  }
  for (const double of_patch : sum) {  // their means differ, because rays lean
    sum_sq -= of_patch * of_patch / frames;
  }
  return std::sqrt(sum_sq / (patches * (frames - 1)));
}

}  // namespace

Outcome plan(const Plan& plan) {
  using fingerpad::at_least;
  using fingerpad::positive;
  fingerpad::require("plan", {{"thickness_mm", plan.thickness_mm, positive},
                              {"shear_modulus_mpa", plan.shear_modulus_mpa, positive},
                              {"pressure_mpa", plan.pressure_mpa, positive},
                              {"grid_pitch_mm", plan.grid_pitch_mm, at_least(0.3)},
                              {"dots_in_row", plan.dots_in_row, at_least(1)},
                              {"dot_noise_px", plan.dot_noise_px, positive},
                              {"brightness", plan.brightness, fingerpad::within(10, 250)},
                              {"grey_noise", plan.grey_noise, positive},
                              {"picture_rows", plan.picture_rows, at_least(60)}});
  Report report{.what = "plan", .residual_unit = "(misfit of the dots)"};
  plan_axes(plan, report);
  const auto rim = fingerpad::FreePad<double>({plan.base_radius_mm, plan.stress_free_height_mm})
                       .rim(plan.pressure_mpa / (plan.shear_modulus_mpa * plan.thickness_mm));
  const double apex_sd_mm = depth_sd_mm(plan, rim->apex_mm);
  report.parameters.push_back({"apex_mm", rim->apex_mm});
  report.parameters.push_back({"sd_depth_at_apex_mm", apex_sd_mm});
  report.parameters.push_back({"sd_depth_half_way_mm", depth_sd_mm(plan, rim->apex_mm / 2)});
  report.parameters.push_back({"smallest_dent_mm", 4 * apex_sd_mm});
  Outcome outcome;
  outcome.reports = {report};
  return outcome;
}

}  // namespace calibrate
