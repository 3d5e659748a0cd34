// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The report of a calibration: parameters with standard errors, residual, and a verdict. Reports
// are kept in sensor.json under "calibration", beside the sections that replay reads.
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace calibrate {

enum class Verdict { good, doubtful };  // a refused calibration has no report

/// A parameter; its standard error is NaN if unknown.
struct Parameter {
  std::string name;  ///< with its unit
  double value = 0;
  double standard_error = std::numeric_limits<double>::quiet_NaN();
};

struct Report {
  std::string what;  ///< name of the calibration: "camera", "absorption", ...
  Verdict verdict = Verdict::good;
  std::string because = {};  ///< why it is doubtful
  double residual = 0;
  std::string residual_unit = {};
  std::vector<Parameter> parameters = {};
  std::vector<std::vector<double>> covariance =
      {};  ///< may be empty; the documentation gives the order

  /// Marks the report as doubtful; the first reason is kept.
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
  std::string x, y;  ///< axis labels, with units
  std::vector<PlotPoint> points;
  std::string measured = "measured", fitted = "fitted";  ///< labels of the two values
};

/// A part of a calibration that its samples do not determine.
struct Refusal {
  std::string what, because;
};

/// The result of a sub-command.
struct Outcome {
  std::vector<Report> reports;
  std::vector<Refusal> refusals;  ///< parts without a result; the others are valid
  nlohmann::json sections = nlohmann::json::object();  ///< for sensor.json; replaces existing ones
  std::vector<Plot> plots;                             ///< one per report
};

/// Prints a report, or why there is none, for people.
void print(const Report& report);
void print(const Refusal& refusal);

/// A report as sensor.json keeps it, without loss; null stands for an unknown value.
nlohmann::json to_json(const Report& report);

/// Writes the outcome into `file` atomically. Throws replay::Failure.
void save(const Outcome& outcome, const std::filesystem::path& file);

/// Writes a plot as a .csv file for plot.py. Throws replay::Failure.
void write_plot(const Plot& plot, const std::filesystem::path& file);

}  // namespace calibrate
