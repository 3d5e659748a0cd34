// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <cmath>
#include <set>

#include "fingerpad/core/check.hpp"
#include "replay/check/parts.hpp"
#include "replay/steps/fingertip_options.hpp"

namespace replay {
namespace {

/// What to do with pressures in another unit than MPa, by what the free pad needs: each unit in
/// which a gauge, relative or absolute, would give the least of them. "" if none would.
std::string remedy_of_unit(const Recording& recording, double least) {
  constexpr double air_mpa = 0.1013, alike = 0.1;
  const auto needed_mpa = free_pressure_mpa(recording);
  std::string all;
  for (const double absolute : {0.0, air_mpa}) {
    for (const auto& [unit, per_mpa] : {std::pair("bar", 10.0),
                                        {"psi", 145.04},
                                        {"kPa", 1e3},
                                        {"mmHg", 7500.6},
                                        {"mbar", 1e4},
                                        {"Pa", 1e6}}) {
      if (needed_mpa && std::abs(least / per_mpa / (*needed_mpa + absolute) - 1) < alike) {
        all += std::string(all.empty() ? "If the unit is " : "; if it is ") + unit +
               ", divide by " + fingerpad::detail::print("%.7g", per_mpa) +
               (absolute > 0 ? " and subtract 0.1013" : "");
      }
    }
  }
  return all.empty() ? "" : all + ".";
}

void check_pressure(const Recording& recording, Findings& findings) {
  const std::string place = "signals.csv, pressure_mpa";
  std::vector<double> values;
  for (const auto& [frame, value] : recording.signals.pressures_mpa) {
    values.push_back(value);
  }
  if (values.empty()) {
    return;
  }
  constexpr double max_plausible_mpa = 0.2;
  constexpr double air_mpa = 0.085;  // air pressure on a mountain
  const double usual = median_of(values);
  const double least = *std::min_element(values.begin(), values.end());
  const std::size_t before = findings.size();
  const std::string around = "the median is " + short_number(usual) + " MPa";
  if (const std::string remedy = remedy_of_unit(recording, least); !remedy.empty()) {
    findings.push_back({place, around, remedy});
  } else if (usual > max_plausible_mpa) {
    findings.push_back({place, around + ", more than a soft pad withstands",
                        usual > 1000 ? "If the unit is Pa, divide by 1,000,000."
                                     : "If the unit is kPa, divide by 1000."});
  } else if (least > air_mpa) {
    findings.push_back({place, around + " and no value is below atmospheric pressure",
                        "If the pressure is absolute, subtract the atmospheric pressure (about "
                        "0.1013). If the unit is bar, divide by 10."});
  } else if (least < 0) {
    findings.push_back(
        {place, "the minimum is " + short_number(least) + " MPa, below atmospheric pressure",
         "Tare the gauge with the pad open."});
  } else if (usual < 1e-4) {
    findings.push_back({place, around + ", almost zero",
                        "Check that the gauge is connected and that the unit is not GPa or bar."});
  }
  if (const std::string fault = fault_of_pressure(recording);
      !fault.empty() && least >= 0 && findings.size() == before) {
    findings.push_back(
        {place, fault,
         "Tare the gauge with the pad open: it was set to zero with the pad "
         "inflated, or the pad has lost fluid since the reference. Check its unit."});
  }
  if (values.size() >= 10 && std::set<double>(values.begin(), values.end()).size() == 1) {
    findings.push_back(
        {place, "the value never changes", "Check that the gauge is read at every frame."});
  }
}

void check_look_up(const Recording& recording, Findings& findings) {
  if (!recording.sensor.force) {
    return;
  }
  const ForceLookUp& force = *recording.sensor.force;
  const Pad& pad = recording.sensor.pad;
  const double base_mm2 = CV_PI * pad.base_radius_mm * pad.base_radius_mm;
  const auto outside = [&](const char* key, double to, double least, double most,
                           const char* unit) {
    if (!(to >= least && to <= most)) {
      findings.push_back(
          {std::string("sensor.json, force.") + key,
           "the value is " + short_number(to) + ", but must be " + short_number(least) + " to " +
               short_number(most) + " " + unit + " for a pad of this size",
           std::string("Give it in ") + unit + "; check the unit of the calibration."});
    }
  };
  if (force.by_area) {
    outside("by_area.to_mm2", force.by_area->to, 1e-3 * base_mm2, base_mm2, "mm^2");
  }
  if (force.by_depth) {
    outside("by_depth.to_mm", force.by_depth->to, 0.01 * pad.apex_height_mm, pad.apex_height_mm,
            "mm");
  }
  if (force.shear) {
    outside("shear.to_mm", force.shear->map.force.to, 0.001 * pad.base_radius_mm,
            pad.base_radius_mm, "mm");
    outside("shear.to_rad", force.shear->map.moment.to, 0.001, CV_PI, "rad");
  }
}

void check_true_forces(const Recording& recording, Findings& findings) {
  double largest_n = 0, largest_n_mm = 0, pull_n = 0, press_n = 0, along_n = 0;
  for (const auto& [frame, truth] : recording.true_forces) {
    const auto& f = truth.force_n;
    largest_n = std::fmax(largest_n, norm(f));
    largest_n_mm = std::fmax(largest_n_mm, std::abs(truth.moment_n_mm));
    along_n = std::fmax(along_n, std::hypot(f.x, f.y));
    pull_n = std::fmax(pull_n, f.z);
    press_n = std::fmax(press_n, -f.z);
  }
  if (pull_n > press_n && pull_n > 0.1) {
    findings.push_back(
        {"forces.csv, force_z_n", "the object pulls on the pad",
         "Give the force that the object exerts on the pad: a press has force_z_n < 0."});
  }
  constexpr double most_friction = 2;  // coefficient of a soft pad
  if (along_n > most_friction * std::fmax(press_n, pull_n) && along_n > 0.1) {
    findings.push_back(
        {"forces.csv",
         "the force along the plate reaches " + short_number(along_n) +
             " N, more than friction allows at a normal force of " +
             short_number(std::fmax(press_n, pull_n)) + " N",
         "Check whether the columns are exchanged; z points from the plate into the pad."});
  }
  if (largest_n_mm > 10 * recording.sensor.pad.base_radius_mm * largest_n) {
    findings.push_back(
        {"forces.csv, moment_z_nm",
         "the moment reaches " + short_number(largest_n_mm / 1000) + " N m, but the force only " +
             short_number(largest_n) + " N",
         "If the unit is N mm, divide by 1000. Check also whether the columns are exchanged."});
  }
}

}  // namespace

void check_clock(const std::string& place,
                 const std::string& what,
                 const std::vector<double>& times_s,
                 Findings& findings) {
  std::vector<double> steps;
  double before = std::numeric_limits<double>::quiet_NaN();
  std::size_t missing = 0, back = 0, longest = 0;
  double longest_s = 0;
  for (std::size_t k = 0; k < times_s.size(); ++k) {
    if (!std::isfinite(times_s[k])) {
      ++missing;
      continue;
    }
    const double step = times_s[k] - before;
    before = times_s[k];
    if (!std::isfinite(step)) {
      continue;
    }
    steps.push_back(step);
    back += step <= 0 ? 1 : 0;
    if (step > longest_s) {
      longest_s = step;
      longest = k;
    }
  }
  const double usual = median_of(steps);
  if (missing > 0) {
    findings.push_back({place,
                        "missing for " + std::to_string(missing) + " of " +
                            std::to_string(times_s.size()) + " " + what + "s",
                        "Give each " + what + " a time."});
  }
  if (back > 0) {
    findings.push_back({place, "the time decreases or repeats " + std::to_string(back) + " times",
                        "Sort by time, and check whether the clock wraps around."});
  }
  if (usual > 5) {
    findings.push_back({place, "the median interval is " + short_number(usual) + " s",
                        "If the unit is ms, divide by 1000."});
  } else if (usual > 0 && usual < 1e-3) {
    findings.push_back({place, "the median interval is " + short_number(usual) + " s",
                        "Check that the unit is s: if it is min, multiply by 60."});
  }
  if (usual > 0 && longest_s > 5 * usual && steps.size() > 5) {
    findings.push_back({place,
                        "a gap of " + short_number(longest_s) + " s before " + what + " " +
                            std::to_string(longest) + "; the median interval is " +
                            short_number(usual) + " s",
                        "Record without gaps, or split the recording there."});
  }
}

void check_numbers(const Recording& recording, Findings& findings) {
  check_pressure(recording, findings);
  check_look_up(recording, findings);
  check_true_forces(recording, findings);
}

}  // namespace replay
