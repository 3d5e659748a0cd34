// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a calibration says: its parameters with standard errors, what it leaves, and whether to
// trust it. Kept in sensor.json under "calibration", beside the sections that replay reads.
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace calibrate {

enum class Verdict { good, doubtful };  // what is refused has no report

/// A parameter; no standard error: NaN.
struct Parameter {
  std::string name;  ///< with its unit
  double value = 0;
  double standard_error = std::numeric_limits<double>::quiet_NaN();
};

struct Report {
  std::string what;  ///< of the calibration: "camera", "absorption", ...
  Verdict verdict = Verdict::good;
  std::string because = {};  ///< why it is doubtful
  double residual = 0;
  std::string residual_unit = {};
  std::vector<Parameter> parameters = {};
  std::vector<std::vector<double>> covariance =
      {};  ///< where there is one, in an order told in the page

  /// The first cause counts.
  void doubt(bool is_doubtful, const std::string& why) {
    if (is_doubtful && verdict == Verdict::good) {
      verdict = Verdict::doubtful;
      because = why;
    }
  }
};

/// One point of a plot of the fit.
struct PlotPoint {
  double x, measured, fitted;
};
struct Plot {
  std::string x, y;  ///< what the axes are, with units
  std::vector<PlotPoint> points;
  std::string measured = "measured", fitted = "fitted";  ///< what the numbers of a point are
};

/// A part of a calibration that its samples do not tell.
struct Refusal {
  std::string what, because;
};

/// What a sub-command hands back.
struct Outcome {
  std::vector<Report> reports;
  std::vector<Refusal> refusals;  ///< parts that are missing here; the others stand
  nlohmann::json sections = nlohmann::json::object();  ///< for sensor.json; replaces what is there
  std::vector<Plot> plots;                             ///< one a report
};

/// Prints a report, or why there is none, as people read it.
void print(const Report& report);
void print(const Refusal& refusal);

/// Both ways without loss. Reading refuses unknown keys; `file` names the culprit. Throws
/// replay::Failure.
nlohmann::json to_json(const Report& report);
Report report_of(const std::filesystem::path& file,
                 const std::string& what,
                 const nlohmann::json& entry);

/// Puts the outcome into `file`, whole or not at all. Throws replay::Failure.
void save(const Outcome& outcome, const std::filesystem::path& file);
/// All that earlier calibrations have said in `file`. Throws replay::Failure.
std::vector<Report> load_reports(const std::filesystem::path& file);

/// "PLACE/WHAT.csv" for plot.py. Throws replay::Failure.
void write_plot(const Plot& plot, const std::filesystem::path& file);

}  // namespace calibrate
