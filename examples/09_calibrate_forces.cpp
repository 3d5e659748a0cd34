// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Fits the forces by look-up to contacts that a force gauge and the camera measured together, and
// looks one of them up. `calibrate force` does the same for a sensor.json, by area and by depth.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/force/look_up.hpp"

using Sample = fingerpad::ForceSample<double>;

/// data/README.md describes the columns.
std::vector<Sample> read(const std::string& file) {
  std::ifstream stream(file);
  std::string line, load, cell;
  std::getline(stream, line);
  std::map<std::string, int> loads;
  std::vector<Sample> samples;
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    std::getline(cells, load, ',');
    std::vector<double> at;
    while (std::getline(cells, cell, ',')) {
      at.push_back(cell.empty() ? std::nan("") : std::stod(cell));  // NaN: not measured
    }
    at.resize(9, std::nan(""));
    samples.push_back({.measure = at[0],
                       .displacement_mm = {at[2], at[3]},
                       .rotation_rad = at[4],
                       .normal_force_n = -at[7],
                       .tangential_force_n = {at[5], at[6]},
                       .moment_n_mm = 1000 * at[8],
                       .load = loads.emplace(load, static_cast<int>(loads.size())).first->second});
  }
  return samples;
}

int main(int argc, char** argv) {
  constexpr double reference_mm2 = 100;  // a typical contact
  const auto samples = read(argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING "/../contacts.csv");
  const std::span<const Sample> all(samples);

  const auto fit = [](std::span<const Sample> some) {
    return fingerpad::fit_normal_force(some, 3);
  };
  const auto normal = fit(all);
  const auto unseen = leave_one_load_out(all, fit, [](const auto& model, const Sample& s) {
    return fingerpad::NormalForce(model.curve)(s.measure).force_n - s.normal_force_n;
  });
  const auto force = fit_tangential_force(all, reference_mm2);
  const auto moment = fit_moment(all, reference_mm2);

  std::printf("normal force: residual %.3f N, error of loads left out %.3f N, at most %.3f N\n",
              normal.curve.residual_sd_n, unseen.mean_abs, unseen.worst);
  std::printf("tangential force: %.3f +- %.3f N/mm, residual %.3f N\n", force.law.slope,
              std::sqrt(force.covariance[0][0]), force.residual_sd);
  std::printf("moment: %.1f +- %.1f N mm/rad, residual %.2f N mm\n", moment.law.slope,
              std::sqrt(moment.covariance[0][0]), moment.residual_sd);

  // Every frame: area, displacement and rotation of the contact in, force out.
  const fingerpad::NormalForce press(normal.curve);
  const fingerpad::Shear shear({reference_mm2, force.law, moment.law});
  const Sample& last = samples.back();
  const auto seen = shear(last.measure, last.displacement_mm, last.rotation_rad);
  std::printf(
      "last contact: %.2f N pressed, (%.2f, %.2f) N along the pad; the gauge: %.2f N, "
      "(%.2f, %.2f) N\n",
      press(last.measure).force_n, seen.tangential_force_n.x, seen.tangential_force_n.y,
      last.normal_force_n, last.tangential_force_n.x, last.tangential_force_n.y);
  return unseen.mean_abs < 0.02 * normal.curve.force_n(normal.curve.to) ? 0 : 1;
}
