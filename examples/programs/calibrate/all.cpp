// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// calibrate all: everything that a folder of one's own finger has pictures of, as one table.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibrate/calibrations.hpp"
#include "common/failure.hpp"
#include "common/json_section.hpp"

namespace calibrate {
namespace {

using nlohmann::json;

/// What a person knows of a finger without measuring.
struct About {
  DotPlate plate;
  PadSize pad;
  RimNoise rim;
  double pressure_mpa = 0;  ///< of the free pad; 0: not told
  json dots;                ///< of the printed grid, for sensor.json; null if there is none
  json side_dots;           ///< of the rows around the rim, likewise
};

About read_about(const Path& file) {
  const json content = replay::parse_json(file);
  About about;
  try {
    const json& target = content.at("target");
    about.plate.rows = target.at("rows").get<int>();
    about.plate.cols = target.at("cols").get<int>();
    about.plate.pitch_mm = target.at("pitch_mm").get<double>();
    about.plate.raised_mm = target.at("raised_mm").get<double>();
    about.plate.refractive_index = content.at("refractive_index").get<double>();
    about.pad.base_radius_mm = content.at("base_radius_mm").get<double>();
    about.pad.ball_radius_mm = content.at("touch_ball_radius_mm").get<double>();
    about.pad.stress_free_height_mm = content.value("mould_cap_height_mm", 0.0);
    about.rim.base_radius_mm = about.pad.base_radius_mm;
    about.rim.stress_free_height_mm = about.pad.stress_free_height_mm;
    about.pressure_mpa = content.value("working_pressure_mpa", 0.0);
    about.dots = content.value("dots", json());
    about.side_dots = content.value("side_dots", json());
    const json camera = content.value("camera", json::object());
    about.plate.is_srgb = camera.value("response", "linear") == "srgb";
    const std::string mosaic = camera.value("mosaic", "none");
    about.plate.mosaic = mosaic == "none" || mosaic == "interpolated" ? "" : mosaic;
  } catch (const json::exception& error) {
    replay::fail(file, std::string("does not describe the finger: ") + error.what());
  }
  return about;
}

/// A calibration, and what it needs of the folder.
struct Step {
  const char* name;
  std::vector<const char*> needs;
  std::function<Outcome()> run;
};

/// What was found, its standard deviation, and whether it is good.
void print_rows(const char* step, const Report& report) {
  for (const Parameter& p : report.parameters) {
    std::printf("%-11s %-27s %11.5g", step, p.name.c_str(), p.value);
    if (std::isfinite(p.standard_error)) {
      std::printf(" +- %.2g", p.standard_error);
    }
    std::printf("\n");
  }
  const bool is_good = report.verdict == Verdict::good;
  std::printf("%-11s %s%s\n", step, is_good ? "good" : "doubtful, because ",
              report.because.c_str());
}

/// The step's missing parts; "" if there are none.
std::string missing_in(const Path& folder, const Step& step) {
  std::string missing;
  for (const char* part : step.needs) {
    missing += std::filesystem::exists(folder / part) ? "" : std::string(" ") + part;
  }
  return missing;
}

}  // namespace

bool all(const Path& folder) {
  const About about = read_about(folder / "about.json");
  const Path pad = folder / "pad", sensor = folder / "sensor.json";
  const Step steps[] = {
      {"camera",
       {"plate",
        std::filesystem::exists(folder / "plate_tilted") ? "plate_tilted" : "plate_raised"},
       [&] { return camera(folder, about.plate); }},
      {"shape", {"pad/free", "pad/touches.csv"}, [&] { return shape(pad, sensor, about.pad); }},
      {"absorption",
       {"pad/free", "pad/frames", "pad/presses.csv"},
       [&] { return absorption(pad, sensor); }},
      {"contact", {"pad/free"}, [&] { return contact(pad, sensor, about.pressure_mpa); }},
      {"rim", {"rim/apex.csv", "rim/signals.csv"}, [&] { return rim(folder / "rim", about.rim); }}};
  std::filesystem::remove(sensor);
  std::filesystem::remove(pad / "reference.png");
  bool is_whole = true;
  for (const Step& step : steps) {
    const std::string missing = missing_in(folder, step);
    if (!missing.empty()) {
      std::printf("%-11s left out: there is no%s\n", step.name, missing.c_str());
      is_whole = false;
      continue;
    }
    try {
      const Outcome outcome = step.run();
      save(outcome, sensor);
      for (const Report& report : outcome.reports) {
        print_rows(step.name, report);
      }
    } catch (const std::exception& error) {
      std::printf("%-11s refused, because %s\n", step.name, error.what());
      is_whole = false;
    }
  }
  Outcome known;  // the reference lies in pad/
  known.sections["reference"] = {{"frame", "pad/reference.png"},
                                 {"depth", "pad/reference_depth.tiff"}};
  if (about.dots.is_object()) {
    known.sections["dots"] = about.dots;
  }
  if (about.side_dots.is_object()) {
    known.sections["rim"]["side_dots"] = about.side_dots;
  }
  save(known, sensor);
  std::printf("written     %s\n", sensor.c_str());
  return is_whole;
}

}  // namespace calibrate
