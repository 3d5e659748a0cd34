// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "calibrate/report.hpp"

#include <cmath>
#include <cstdio>

#include "common/failure.hpp"
#include "common/json_section.hpp"
#include "common/sensor.hpp"
#include "common/whole_files.hpp"

namespace calibrate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json number_or_null(double value) {
  return std::isfinite(value) ? json(value) : json();
}

}  // namespace

void print(const Report& report) {
  std::printf("%s\n", report.what.c_str());
  for (const Parameter& p : report.parameters) {
    if (std::isfinite(p.standard_error)) {
      std::printf("  %-28s %11.5g +- %.2g\n", p.name.c_str(), p.value, p.standard_error);
    } else {
      std::printf("  %-28s %11.5g\n", p.name.c_str(), p.value);
    }
  }
  std::printf("  %-28s %11.3g %s\n", "residual", report.residual, report.residual_unit.c_str());
  if (report.verdict == Verdict::good) {
    std::printf("  good\n");
  } else {
    std::printf("  doubtful, because %s\n", report.because.c_str());
  }
}

void print(const Refusal& refusal) {
  std::fprintf(stderr, "%s\n  refused, because %s\n", refusal.what.c_str(),
               refusal.because.c_str());
}

json to_json(const Report& report) {
  json parameters = json::object();
  for (const Parameter& p : report.parameters) {
    parameters[p.name] = {number_or_null(p.value), number_or_null(p.standard_error)};
  }
  json entry = {{"verdict", report.verdict == Verdict::good ? "good" : "doubtful"},
                {"residual", number_or_null(report.residual)},
                {"residual_unit", report.residual_unit},
                {"parameters", parameters}};
  if (!report.because.empty()) {
    entry["because"] = report.because;
  }
  if (!report.covariance.empty()) {
    entry["covariance"] = report.covariance;
  }
  return entry;
}

void save(const Outcome& outcome, const fs::path& file) {
  json content = fs::exists(file) ? replay::parse_json(file) : json::object();
  replay::expects_known_version(file, content);
  content["version"] = replay::sensor_version;
  for (const auto& item : outcome.sections.items()) {
    if (item.value().is_object() && content.contains(item.key())) {
      content[item.key()].update(item.value());  // keeps keys of other calibrations
    } else {
      content[item.key()] = item.value();
    }
  }
  for (const Report& report : outcome.reports) {
    content["calibration"][report.what] = to_json(report);
  }
  replay::write_file(file, content.dump(2) + "\n");
}

void write_plot(const Plot& plot, const fs::path& file) {
  std::string text =
      plot.x + "," + plot.y + " " + plot.measured + "," + plot.y + " " + plot.fitted + "\n";
  char line[96];
  for (const PlotPoint& p : plot.points) {
    std::snprintf(line, sizeof line, "%.7g,%.7g,%.7g\n", p.x, p.measured, p.fitted);
    text += line;
  }
  replay::write_file(file, text);
}

}  // namespace calibrate
