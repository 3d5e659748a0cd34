// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/sensor.hpp"

#include <string>

#include "common/failure.hpp"
#include "common/json_section.hpp"
#include "common/sensor.hpp"

namespace replay {
namespace {

FingerPlace read_finger(const JsonSection& section) {
  return {section.integer("first_row", 0), section.positive_integer("rows"),
          section.integer("first_col", 0), section.positive_integer("cols")};
}

std::vector<FingerPlace> read_fingers(const std::filesystem::path& file, const JsonSection& foam) {
  const nlohmann::json& list = foam.at("fingers");
  if (!list.is_array() || list.empty() || list.size() > max_fingers) {
    foam.refuse("fingers must be a list [...] of 1 to " + std::to_string(max_fingers) + " fingers");
  }
  std::vector<FingerPlace> fingers;
  for (const nlohmann::json& entry : list) {
    const std::string name = "foam.fingers[" + std::to_string(fingers.size()) + "]";
    fingers.push_back(read_finger(
        JsonSection(file, name, entry,
                    {{"first_row", "first row of the finger in the array, counted from 0"},
                     {"rows", "number of rows of the finger"},
                     {"first_col", "first column of the finger in the array, counted from 0"},
                     {"cols", "number of columns of the finger"}})));
  }
  return fingers;
}

std::vector<double> read_newtons(const JsonSection& foam) {
  const nlohmann::json& given = foam.at("newton_per_unit");
  const nlohmann::json list = given.is_array() ? given : nlohmann::json::array({given});
  std::vector<double> numbers;
  for (const nlohmann::json& one : list) {
    if (!one.is_number() || !(one.get<double>() > 0)) {
      foam.refuse("newton_per_unit must be a number > 0, or a list of one for each taxel");
    }
    numbers.push_back(one.get<double>());
  }
  return numbers;
}

std::vector<fingerpad::Point2<double>> read_places(const JsonSection& foam) {
  const nlohmann::json& list = foam.at("places_mm");
  std::vector<fingerpad::Point2<double>> places;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const nlohmann::json& one = list.is_array() ? list[k] : list;
    if (!one.is_array() || one.size() != 2 || !one[0].is_number() || !one[1].is_number()) {
      foam.refuse("places_mm must be a list of [x, y] for each taxel");
    }
    places.push_back({one[0].get<double>(), one[1].get<double>()});
  }
  return places;
}

/// Section "foam" with its known keys.
JsonSection foam_section(const JsonSection& root) {
  return root.section(
      "foam",
      {{"fingers", "position of each finger in the array"},
       {"pitch_mm", "distance between neighbouring taxels, mm"},
       {"places_mm", "[x, y] of each taxel, row by row, mm"},
       {"newton_per_unit", "newtons for one unit of a reading, of all taxels or a list of each"},
       {"window", "number of samples over which vibration is measured"},
       {"sample_period_s", "nominal time between samples, s"},
       {"noise", "standard deviation of a taxel at rest, in the unit of the readings"},
       {"free_until_s", "time until which nothing touches the array, s"},
       {"quiet_until_s", "time until which nothing is touched and nothing slips, s"},
       {"noise_factor", "threshold of vibration, as a multiple of the noise"},
       {"saturated_at", "readings at or above this value are ignored"},
       {"stuck_after",
        "number of equal readings in a row after which a taxel that should change is stuck"},
       {"longest_gap_s", "a longer time between two samples starts a new window, s"},
       {"history", "number of samples that are compared"},
       {"least_waves", "a sample with fewer waves counts as silent"},
       {"centroid_tolerance_mm", "motion of the centroid that noise can cause, mm"},
       {"rule", "grasp_lift, grasp_optimise or both"}});
}

void read_options(const JsonSection& foam, FoamSensor& sensor) {
  const auto number = [&](const char* key, auto& target) {
    if (foam.has(key)) {
      target = foam.number(key);
    }
  };
  const auto integer = [&](const char* key, auto& target) {
    if (foam.has(key)) {
      target = foam.integer(key, 0);
    }
  };
  number("pitch_mm", sensor.taxels.pitch_mm);
  integer("window", sensor.taxels.window);
  number("sample_period_s", sensor.sample_period_s);
  number("noise", sensor.noise);
  number("free_until_s", sensor.free_until_s);
  number("quiet_until_s", sensor.quiet_until_s);
  number("noise_factor", sensor.taxels.noise_factor);
  number("saturated_at", sensor.taxels.saturated_at);
  integer("stuck_after", sensor.taxels.stuck_after);
  number("longest_gap_s", sensor.longest_gap_s);
  integer("history", sensor.rules.history);
  integer("least_waves", sensor.rules.min_waves);
  number("centroid_tolerance_mm", sensor.rules.centroid_tolerance_mm);
  if (foam.has("newton_per_unit")) {
    sensor.newton_per_unit = read_newtons(foam);
  }
  if (foam.has("places_mm")) {
    sensor.places_mm = read_places(foam);
  }
  if (foam.has("rule")) {
    const std::string rule = foam.one_of("rule", {"grasp_lift", "grasp_optimise", "both"});
    sensor.grasp_lift = rule != "grasp_optimise";
    sensor.grasp_optimise = rule != "grasp_lift";
  }
  fingerpad::TaxelOptions all = sensor.taxels;
  all.noise = sensor.noise.value_or(all.noise);
  all.sample_period_s = sensor.sample_period_s.value_or(all.sample_period_s);
  all.longest_gap_s = sensor.longest_gap_s.value_or(all.longest_gap_s);
  foam.check([&] { require(all); });
  foam.check([&] { require(sensor.rules); });
}

/// Throws Failure for sections of other recordings: they indicate mixed-up files.
void refuse_other_sections(const std::filesystem::path& file, const nlohmann::json& content) {
  for (const char* other : {"camera", "absorption", "pad", "reference", "video", "smoothing_px",
                            "dots", "rim", "neighbour_light", "force", "stick", "contact"}) {
    if (content.is_object() && content.contains(other)) {
      fail(file, std::string("has section ") + other +
                     ", which a recording with taxels.csv cannot have; put the frames of a camera "
                     "into a separate recording");
    }
  }
}

}  // namespace

FoamSensor read_foam_sensor(const std::filesystem::path& file) {
  FoamSensor sensor;
  if (!std::filesystem::exists(file)) {
    return sensor;
  }
  const nlohmann::json content = parse_json(file);
  refuse_other_sections(file, content);
  expects_known_version(file, content);
  const JsonSection root(file, "", content,
                         {{"version", "version of the file format"},
                          {"calibration", "reports of the calibrations"},
                          {"foam", "a foam array"}});
  if (root.has("foam")) {
    const JsonSection foam = foam_section(root);
    if (foam.has("fingers")) {
      sensor.fingers = read_fingers(file, foam);
    }
    read_options(foam, sensor);
  }
  return sensor;
}

}  // namespace replay
