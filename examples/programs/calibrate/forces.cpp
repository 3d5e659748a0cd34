// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Calibrates the membrane, and the curves for forces by look-up.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibrate/calibrations.hpp"
#include "common/failure.hpp"
#include "common/signals.hpp"
#include "common/table.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/calibrate/rim.hpp"
#include "replay/dots/dots.hpp"
#include "replay/steps/fingertip_options.hpp"

namespace calibrate {
namespace {

constexpr int any_frame = 1 << 24;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

using Sample = fingerpad::ForceSample<double>;
using Samples = std::span<const Sample>;
using NormalFit = fingerpad::NormalForceFit<>;

/// A table accessed by column names; NaN for an empty cell or a missing column.
class Columns {
 public:
  explicit Columns(const Path& file) : file_(file) {
    replay::Table table(file, replay::Table::Lines::may_end_early);
    for (names_ = table.header(); table.next();) {
      rows_.push_back(table.cells());
      lines_.push_back(table.line());
    }
  }

  std::size_t rows() const { return rows_.size(); }
  bool has(const std::string& name) const { return column(name) < names_.size(); }
  std::string text(std::size_t row, const std::string& name) const {
    return has(name) ? rows_[row][column(name)] : "";
  }
  double number(std::size_t row, const std::string& name) const {
    double value = none;
    if (!replay::read_number(text(row, name), value)) {
      replay::fail(file_, "line " + std::to_string(lines_[row]) + ": " + name + " '" +
                              text(row, name) + "' is not a number");
    }
    return value;
  }

 private:
  std::size_t column(const std::string& name) const {
    return static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
  }
  Path file_;
  std::vector<std::string> names_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<int> lines_;
};

/// A measure of the contact's size, by which forces are looked up.
struct Measure {
  const char *name, *column, *unit;
  double reference;  ///< a typical contact
};
constexpr Measure area{"area", "flat_area_mm2", "mm2", 100};
constexpr Measure depth{"depth", "contact_depth_mm", "mm", 2};

/// Joins contacts with the gauge's rows of the same frames.
std::vector<Sample> samples_of(const Columns& contacts,
                               const std::optional<Columns>& gauge,
                               const Measure& measure) {
  std::map<std::string, std::size_t> row_of_frame;
  for (std::size_t k = 0; gauge && k < gauge->rows(); ++k) {
    row_of_frame[gauge->text(k, "frame")] = k;
  }
  std::map<std::string, int> loads;
  std::vector<Sample> samples;
  for (std::size_t k = 0; k < contacts.rows(); ++k) {
    const auto row = row_of_frame.find(contacts.text(k, "frame"));
    if (gauge && row == row_of_frame.end()) {
      continue;  // the gauge has no row for this frame
    }
    const Columns& forces = gauge ? *gauge : contacts;
    const std::size_t at = gauge ? row->second : k;
    const auto shift = [&](const char* name) {
      const double moved = contacts.number(k, name);
      return std::isfinite(moved) || contacts.has(name) ? moved : 0;
    };
    Sample sample;
    sample.measure = contacts.number(k, measure.column);
    sample.displacement_mm = {shift("shift_x_mm"), shift("shift_y_mm")};
    sample.rotation_rad = shift("shift_rad");
    sample.normal_force_n = -forces.number(at, "force_z_n");
    sample.tangential_force_n = {forces.number(at, "force_x_n"), forces.number(at, "force_y_n")};
    sample.moment_n_mm = 1000 * forces.number(at, "moment_z_nm");
    const std::string load = contacts.has("load") ? contacts.text(k, "load") : std::to_string(k);
    sample.load = loads.emplace(load, static_cast<int>(loads.size())).first->second;
    samples.push_back(sample);
  }
  return samples;
}

/// Mean absolute error for loads left out of the fit, N or N mm; NaN if too few loads remain.
template <class Fit, class ErrorOf>
double unseen(Samples samples, const Fit& fit, const ErrorOf& error_of) {
  try {
    return leave_one_load_out(samples, fit, error_of).mean_abs;
  } catch (const fingerpad::parameter_error&) {
    return none;
  }
}

void add_normal(Samples samples, const Measure& by, Outcome& outcome) {
  const auto fit_of = [](Samples some) { return fingerpad::fit_normal_force(some, 3); };
  const NormalFit fit = fit_of(samples);
  const double unseen_n = unseen(samples, fit_of, [](const NormalFit& model, const Sample& s) {
    return model.curve.force_n(s.measure) - s.normal_force_n;
  });
  Report report{.what = std::string("force_by_") + by.name,
                .residual = fit.curve.residual_sd_n,
                .residual_unit = "N"};
  nlohmann::json coefficients = nlohmann::json::array();
  for (std::size_t k = 0; k <= 3; ++k) {
    coefficients.push_back(fit.curve.coefficients[k]);
    report.parameters.push_back({"coefficient_" + std::to_string(k), fit.curve.coefficients[k],
                                 std::sqrt(fit.curve.covariance[k][k])});
    const auto& row = fit.curve.covariance[k];
    report.covariance.push_back({row.begin(), row.end()});
  }
  const double largest_n = fit.curve.force_n(fit.curve.to);
  report.parameters.push_back({std::string("from_") + by.unit, fit.curve.from});
  report.parameters.push_back({std::string("to_") + by.unit, fit.curve.to});
  report.parameters.push_back({"error_of_an_unseen_load_n", unseen_n});
  report.doubt(!fit.ok(), text_of(fit));
  report.doubt(
      std::isfinite(unseen_n) && unseen_n > 0.05 * largest_n,
      "loads left out of the fit are predicted with an error above 5 % of the largest force");
  report.doubt(!std::isfinite(unseen_n), "there are too few loads to leave one out of the fit");
  outcome.sections["force"][std::string("by_") + by.name] = {
      {"coefficients", coefficients},
      {std::string("from_") + by.unit, fit.curve.from},
      {std::string("to_") + by.unit, fit.curve.to},
      {"residual_n", fit.curve.residual_sd_n},
      {"covariance", report.covariance}};
  Plot plot{std::string("contact ") + by.name + " [" + by.unit + "]", "normal force [N]", {}};
  for (const Sample& s : samples) {
    if (s.measure > 0 && std::isfinite(s.normal_force_n)) {
      plot.points.push_back({s.measure, s.normal_force_n, fit.curve.force_n(s.measure)});
    }
  }
  outcome.reports.push_back(report);
  outcome.plots.push_back(plot);
}

void add_shear(Samples samples, const Measure& by, Outcome& outcome) {
  const auto fit_of = [&](Samples some) {
    return fingerpad::fit_tangential_force(some, by.reference);
  };
  const auto force = fit_of(samples);
  const double unseen_n = unseen(samples, fit_of, [&](const auto& model, const Sample& s) {
    const double gain = model.law.slope * std::pow(s.measure / by.reference, model.law.exponent);
    return norm(gain * s.displacement_mm - s.tangential_force_n);
  });
  const auto moment = fingerpad::fit_moment(samples, by.reference);
  Report report{.what = "shear", .residual = force.residual_sd, .residual_unit = "N"};
  report.parameters = {
      {"force_n_per_mm", force.law.slope, std::sqrt(force.covariance[0][0])},
      {"displacement_exponent", force.law.exponent, std::sqrt(force.covariance[1][1])},
      {"moment_n_mm_per_rad", moment.law.slope, std::sqrt(moment.covariance[0][0])},
      {"rotation_exponent", moment.law.exponent, std::sqrt(moment.covariance[1][1])},
      {"residual_of_the_moment_n_mm", moment.residual_sd}};
  if (std::isfinite(unseen_n)) {
    report.parameters.push_back({"error_of_an_unseen_shear_n", unseen_n});
  }
  if (std::isfinite(force.gauge_angle_sd_rad)) {
    constexpr double degrees = 57.29577951308232;
    report.parameters.push_back({"angle_of_the_gauge_degrees", degrees * force.gauge_angle_rad,
                                 degrees * force.gauge_angle_sd_rad});
  }
  report.doubt(!force.ok(), std::string("for the force, ") + text_of(force));
  report.doubt(!moment.ok(), std::string("for the moment, ") + text_of(moment));
  outcome.sections["force"]["shear"] = {{"by", by.name},
                                        {"reference", by.reference},
                                        {"displacement_exponent", force.law.exponent},
                                        {"force_n_per_mm", {force.law.slope}},
                                        {"to_mm", force.law.to},
                                        {"rotation_exponent", moment.law.exponent},
                                        {"moment_n_mm_per_rad", {moment.law.slope}},
                                        {"to_rad", moment.law.to}};
  Plot plot{"displacement of the contact [mm]", "tangential force (x and y) [N]", {}};
  for (const Sample& s : samples) {
    const double gain = force.law.slope * std::pow(s.measure / by.reference, force.law.exponent);
    const auto &d = s.displacement_mm, &f = s.tangential_force_n;
    if (s.measure > 0 && is_finite(d) && is_finite(f)) {
      plot.points.push_back({d.x, f.x, gain * d.x});
      plot.points.push_back({d.y, f.y, gain * d.y});
    }
  }
  outcome.reports.push_back(report);
  outcome.plots.push_back(plot);
}

std::vector<fingerpad::FreeApex> read_apexes(const Path& recording, double noise_mm) {
  const Columns table(recording / "apex.csv");
  if (!table.has("frame") || !table.has("apex_mm")) {
    replay::fail(recording / "apex.csv", "must have the columns frame and apex_mm");
  }
  const auto signals = replay::read_signals(recording / "signals.csv", any_frame);
  std::vector<fingerpad::FreeApex> apexes;
  for (std::size_t k = 0; k < table.rows(); ++k) {
    const int frame = static_cast<int>(table.number(k, "frame"));
    const double pressure_mpa = signals.pressure_mpa(frame);
    if (!(pressure_mpa > 0)) {
      replay::fail(recording / "signals.csv",
                   "frame " + std::to_string(frame) + " has no pressure above 0");
    }
    apexes.push_back({pressure_mpa, table.number(k, "apex_mm"), noise_mm});
  }
  return apexes;
}

/// Leaves out where something touches the pad: its apex is lower than at a lower pressure. Returns
/// how many that are.
std::size_t drop_touched(std::vector<fingerpad::FreeApex>& apexes) {
  const std::vector<fingerpad::FreeApex> all = apexes;
  return std::erase_if(apexes, [&](const auto& apex) {
    return std::any_of(all.begin(), all.end(), [&](const auto& other) {
      return other.pressure_mpa <= apex.pressure_mpa &&
             other.apex_mm > apex.apex_mm + 5 * (apex.sd_mm + other.sd_mm);
    });
  });
}

/// Means of frames whose pressures differ by less than 2 %.
std::vector<fingerpad::FreeApex> means_by_pressure(const std::vector<fingerpad::FreeApex>& apexes) {
  std::vector<fingerpad::FreeApex> levels;
  std::vector<double> frames;
  for (const auto& apex : apexes) {
    const auto same = std::find_if(levels.begin(), levels.end(), [&](const auto& level) {
      return std::abs(apex.pressure_mpa / level.pressure_mpa - 1) < 0.02;
    });
    const auto at = static_cast<std::size_t>(same - levels.begin());
    if (same == levels.end()) {
      levels.push_back({apex.pressure_mpa, 0});
      frames.push_back(0);
    }
    frames[at] += 1;
    levels[at].pressure_mpa += (apex.pressure_mpa - levels[at].pressure_mpa) / frames[at];
    levels[at].apex_mm += (apex.apex_mm - levels[at].apex_mm) / frames[at];
    levels[at].sd_mm = apex.sd_mm / std::sqrt(frames[at]);
  }
  return levels;
}

}  // namespace

Outcome rim(const Path& recording, const RimNoise& noise) {
  auto frames = read_apexes(recording, noise.apex_noise_mm);
  const std::size_t touched = drop_touched(frames);
  const auto apexes = means_by_pressure(frames);
  const fingerpad::StressFreeCap<double> cap{noise.base_radius_mm, noise.stress_free_height_mm};
  fingerpad::RimFitOptions options{noise.pressure_noise_share, noise.height_sd_mm};
  options.mooney_sd = noise.finds_rubber ? 0.3 : 0;
  const auto fit = fingerpad::fit_rim(cap, apexes, options);
  Report report{.what = "rim", .residual = fit.residual_mm, .residual_unit = "mm"};
  report.parameters = {{"membrane_modulus_n_per_mm", fit.modulus_n_per_mm, fit.modulus_sd_n_per_mm},
                       {"stress_free_height_mm", fit.height_mm, fit.height_sd_mm}};
  if (noise.finds_rubber) {
    report.parameters.push_back({"mooney_share", fit.mooney_share, fit.mooney_sd});
  }
  report.doubt(touched > 0, "frames whose apex is lower than at a lower pressure are left out (" +
                                std::to_string(touched) + "): nothing must touch the pad");
  report.doubt(!fit.ok(), text_of(fit));
  Outcome outcome;
  outcome.sections["rim"] = {
      {"membrane_modulus_n_per_mm", fit.modulus_n_per_mm},
      {"membrane_modulus_sd_n_per_mm", fit.modulus_sd_n_per_mm},
      {"stress_free_inclination_rad", 2 * std::atan(fit.height_mm / noise.base_radius_mm)}};
  if (noise.finds_rubber) {
    outcome.sections["rim"]["mooney_share"] = fit.mooney_share;
  }
  Plot plot{"pressure [MPa]", "height of the apex [mm]", {}};
  const fingerpad::FreePad<double> pad({noise.base_radius_mm, fit.height_mm, fit.mooney_share});
  for (const auto& level : apexes) {
    const auto at = pad.rim(level.pressure_mpa / fit.modulus_n_per_mm);
    plot.points.push_back({level.pressure_mpa, level.apex_mm, at ? at->apex_mm : none});
  }
  outcome.reports = {report};
  outcome.plots = {plot};
  return outcome;
}

Outcome rim_by_weight(const Path& recording,
                      const Path& sensor_file,
                      const RimNoise& noise,
                      double weight_n) {
  double modulus = 0, sd = 0;
  for (int round = 0; round < 4; ++round) {  // forces are nearly proportional to the modulus
    replay::Recording seen = replay::open_recording(recording, sensor_file);
    if (round == 0) {
      const fingerpad::FreeApex apex{seen.signals.pressure_mpa(0), seen.sensor.pad.apex_height_mm};
      modulus = fingerpad::fit_rim({noise.base_radius_mm, noise.stress_free_height_mm}, {&apex, 1})
                    .modulus_n_per_mm;
    }
    replay::Rim& rim = seen.sensor.rim ? *seen.sensor.rim : seen.sensor.rim.emplace();
    rim.membrane_modulus_n_per_mm = modulus;
    rim.membrane_modulus_sd_n_per_mm = 1e-6 * modulus;
    rim.stress_free_inclination_rad =
        2 * std::atan(noise.stress_free_height_mm / noise.base_radius_mm);
    if (const auto lacking = replay::lacking_for_wrench(seen); !lacking.empty()) {
      replay::fail(recording, lacking);
    }
    replay::DotSource dots(recording, seen.sensor, seen.reference, seen.reference_depth,
                           seen.frames.size());
    const auto settings = replay::fingertip_settings(seen, dots.initial());
    replay::RecordedFingertip fingertip(settings.options);
    double press_n = 0, frames = 0;
    for (int k = 0; k < seen.frames.size(); ++k) {
      const cv::Mat frame = seen.frames.next();
      const auto touch =
          fingertip(frame, dots.of(k, frame), seen.signals.pressure_mpa(k), 0.1 * k, dots.side());
      if (touch.contact.in_contact() && touch.wrench.has_force()) {
        press_n -= touch.wrench.force_n.z;
        sd = std::sqrt(touch.wrench.covariance(2, 2)) / weight_n;
        frames += 1;
      }
    }
    if (!(press_n > 0)) {
      replay::fail(recording, "no frame has a contact and a force: does the weight press?");
    }
    modulus *= weight_n * frames / press_n;
  }
  Report report{.what = "rim, by a weight", .residual_unit = "N"};
  report.parameters = {{"membrane_modulus_n_per_mm", modulus, sd * modulus}};
  report.doubt(sd > 0.05, "the weight gives the modulus to no better than 5 %: use a heavier one");
  Outcome outcome;
  outcome.sections["rim"] = {{"membrane_modulus_n_per_mm", modulus},
                             {"membrane_modulus_sd_n_per_mm", sd * modulus},
                             {"stress_free_inclination_rad",
                              2 * std::atan(noise.stress_free_height_mm / noise.base_radius_mm)}};
  outcome.reports = {report};
  return outcome;
}

Outcome force(const Path& contacts_file, const Path& gauge_file) {
  const Columns contacts(contacts_file);
  std::optional<Columns> gauge;
  if (!gauge_file.empty()) {
    gauge.emplace(gauge_file);
  }
  const Columns& forces = gauge ? *gauge : contacts;
  if (!forces.has("force_z_n") || !contacts.has("flat_area_mm2") ||
      (gauge && !(gauge->has("frame") && contacts.has("frame")))) {
    replay::fail(contacts_file,
                 "the contacts must have flat_area_mm2 and, where depth is known, contact_depth_mm "
                 "(as frames.csv of replay), and the table of the gauge "
                 "frame,force_x_n,force_y_n,force_z_n,moment_z_nm");
  }
  const std::vector<Sample> by_area = samples_of(contacts, gauge, area);
  const bool has_depth = contacts.has(depth.column);  // a gel without fluid has none
  const Measure& shear_by = has_depth ? depth : area;
  const auto by_depth = has_depth ? samples_of(contacts, gauge, depth) : by_area;
  Outcome outcome;
  add_normal(by_area, area, outcome);
  if (has_depth) {
    add_normal(by_depth, depth, outcome);
  }
  const bool dragged = std::any_of(by_depth.begin(), by_depth.end(), [](const Sample& s) {
    return std::isfinite(s.tangential_force_n.x) && norm(s.displacement_mm) > 0.01;
  });
  if (dragged) {
    try {
      add_shear(by_depth, shear_by, outcome);
    } catch (const fingerpad::parameter_error& error) {
      outcome.refusals.push_back({"shear", error.what()});
    }
  }
  return outcome;
}

}  // namespace calibrate
