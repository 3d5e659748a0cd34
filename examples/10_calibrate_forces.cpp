// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Calibrates forces by look-up from contacts that a force gauge and the camera measured together.
// Prints the fits, their errors for loads that were left out, and a "force" section for the
// sensor.json of a recording. data/README.md describes the columns.
// Usage: 10_calibrate_forces [CONTACTS.csv]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/force/look_up.hpp"

using Sample = fingerpad::ForceSample<double>;
using Samples = std::span<const Sample>;
using LeftOut = fingerpad::CrossValidation<double>;
constexpr std::size_t curve_degree = 3;  // of the normal force's polynomial

/// A measure of the contact's size, by which forces are looked up.
struct Measure {
  const char *name, *column, *unit;
  double reference;  // a typical contact, to which shear is normalised
};
constexpr Measure area{"area", "flat_area_mm2", "mm2", 100};
constexpr Measure depth{"depth", "contact_depth_mm", "mm", 2};

std::vector<Sample> read(const char* file, const Measure& measure) {
  const auto split = [](const std::string& line) {
    std::istringstream stream(line.substr(0, line.find('\r')));
    std::vector<std::string> cells;
    for (std::string cell; std::getline(stream, cell, ',');) {
      cells.push_back(cell);
    }
    return cells;
  };
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  const auto names = split(line);
  std::map<std::string, int> loads;
  std::vector<Sample> samples;
  while (std::getline(stream, line)) {
    const auto cells = split(line);
    std::map<std::string, std::string> at;
    for (std::size_t k = 0; k < names.size() && k < cells.size(); ++k) {
      at[names[k]] = cells[k];
    }
    const auto number = [&](const char* name) {  // NaN where nothing was measured
      return at[name].empty() ? std::nan("") : std::strtod(at[name].c_str(), nullptr);
    };
    Sample sample;
    sample.measure = number(measure.column);
    sample.displacement_mm = {number("shift_x_mm"), number("shift_y_mm")};
    sample.rotation_rad = number("shift_rad");
    sample.normal_force_n = -number("force_z_n");
    sample.tangential_force_n = {number("force_x_n"), number("force_y_n")};
    sample.moment_n_mm = 1000 * number("moment_z_nm");
    sample.load = loads.emplace(at["load"], static_cast<int>(loads.size())).first->second;
    samples.push_back(sample);
  }
  return samples;
}

void print(const char* name, double fitted, double standard_error) {
  std::printf("  %-22s %10.5g +- %.2g\n", name, fitted, standard_error);
}
void print(const char* unit, double residual, const LeftOut& left_out) {
  std::printf("  %-22s %10.3g %s\n", "residual", residual, unit);
  std::printf("  %-22s %10.3g %s, at most %.3g, over %d loads\n", "error of unseen load",
              left_out.mean_abs, unit, left_out.worst, left_out.loads);
}

/// Prints a warning for a fit to suspicious samples; the fit is still used.
template <class Fit>
void warn(const char* what, const char* by, const Fit& fit) {
  if (!fit.ok()) {
    std::fprintf(stderr, "warning: %s by %s: %s\n", what, by, fit.cause);
  }
}

struct Normal {
  fingerpad::NormalForceFit<> fit;
  LeftOut left_out;
};

Normal fit_normal(Samples samples, const Measure& by) {
  const auto fit = [](Samples some) {
    return fingerpad::fit_normal_force(some, {.degree = curve_degree});
  };
  const auto error = [](const auto& model, const Sample& s) {
    return fingerpad::NormalForce(model.curve)(s.measure).force_n - s.normal_force_n;
  };
  const Normal best{fit(samples), fingerpad::leave_one_load_out(samples, fit, error)};
  warn("normal force", by.name, best.fit);
  const auto& curve = best.fit.curve;
  std::printf("normal force by %s: c1 m + c2 m^2 + c3 m^3 N, m from %.4g to %.4g %s\n", by.name,
              curve.from, curve.to, by.unit);
  for (std::size_t k = 1; k <= curve_degree; ++k) {
    const char name[] = {'c', static_cast<char>('0' + k), '\0'};
    print(name, curve.coefficients[k], std::sqrt(best.fit.curve.covariance[k][k]));
  }
  print("N", best.fit.curve.residual_sd_n, best.left_out);
  return best;
}

struct Shear {
  fingerpad::ShearFit<> force, moment;
  LeftOut force_left_out, moment_left_out;
};

/// The exponents need loads of many sizes, so they are fitted to all loads and kept while one load
/// is left out.
Shear fit_shear(Samples samples, const Measure& by) {
  using fingerpad::fit_moment, fingerpad::fit_tangential_force;
  Shear all;
  all.force = fit_tangential_force(samples, by.reference);
  all.moment = fit_moment(samples, by.reference);
  warn("tangential force", by.name, all.force);
  warn("moment", by.name, all.moment);
  const auto fit = [&](Samples some) {
    const auto force = fit_tangential_force(some, by.reference, all.force.law.exponent);
    const auto moment = fit_moment(some, by.reference, all.moment.law.exponent);
    return fingerpad::Shear<>({by.reference, force.law, moment.law});
  };
  all.force_left_out = leave_one_load_out(samples, fit, [](const auto& shear, const Sample& s) {
    const auto told = shear(s.measure, s.displacement_mm, s.rotation_rad).tangential_force_n;
    return std::hypot(told.x - s.tangential_force_n.x, told.y - s.tangential_force_n.y);
  });
  all.moment_left_out = leave_one_load_out(samples, fit, [](const auto& shear, const Sample& s) {
    return shear(s.measure, s.displacement_mm, s.rotation_rad).moment_n_mm - s.moment_n_mm;
  });
  std::printf("tangential force by displacement and %s over %g %s\n", by.name, by.reference,
              by.unit);
  print("N/mm", all.force.law.slope, std::sqrt(all.force.covariance[0][0]));
  print("exponent", all.force.law.exponent, std::sqrt(all.force.covariance[1][1]));
  print("N", all.force.residual_sd, all.force_left_out);
  std::printf("moment by rotation and %s over %g %s\n", by.name, by.reference, by.unit);
  print("N mm/rad", all.moment.law.slope, std::sqrt(all.moment.covariance[0][0]));
  print("exponent", all.moment.law.exponent, std::sqrt(all.moment.covariance[1][1]));
  print("N mm", all.moment.residual_sd, all.moment_left_out);
  return all;
}

void print_section(const Normal& normal, const Measure& by) {
  const auto& fit = normal.fit;
  std::printf("  \"by_%s\": { \"coefficients\": [", by.name);
  for (std::size_t k = 0; k <= curve_degree; ++k) {
    std::printf("%s%.6g", k == 0 ? "" : ", ", fit.curve.coefficients[k]);
  }
  std::printf("], \"from_%s\": %.4g, \"to_%s\": %.4g,\n", by.unit, fit.curve.from, by.unit,
              fit.curve.to);
  std::printf("    \"residual_n\": %.3g },\n", fit.curve.residual_sd_n);
}

void print_section(const Shear& shear, const Measure& by) {
  std::printf("  \"shear\": { \"by\": \"%s\", \"reference\": %g,\n", by.name, by.reference);
  std::printf("    \"displacement_exponent\": %.4f, \"force_n_per_mm\": [%.5g], \"to_mm\": %.4g,\n",
              shear.force.law.exponent, shear.force.law.slope, shear.force.law.to);
  std::printf(
      "    \"rotation_exponent\": %.4f, \"moment_n_mm_per_rad\": [%.5g], \"to_rad\": %.4g }",
      shear.moment.law.exponent, shear.moment.law.slope, shear.moment.law.to);
}

int main(int argc, char** argv) {
  try {
    const char* const file = argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING "/../contacts.csv";
    const auto by_area = read(file, area), by_depth = read(file, depth);
    const Normal of_area = fit_normal(by_area, area), of_depth = fit_normal(by_depth, depth);
    const Shear of_shear_by_area = fit_shear(by_area, area),
                of_shear_by_depth = fit_shear(by_depth, depth);
    const bool deep =
        of_shear_by_depth.force_left_out.mean_abs < of_shear_by_area.force_left_out.mean_abs;
    std::printf("\"force\": {\n");
    print_section(of_area, area);
    print_section(of_depth, depth);
    print_section(deep ? of_shear_by_depth : of_shear_by_area, deep ? depth : area);
    std::printf("\n}\n");
    const double largest_n = of_depth.fit.curve.force_n(of_depth.fit.curve.to);
    const double error_n = std::fmax(of_area.left_out.mean_abs, of_depth.left_out.mean_abs);
    if (error_n < 0.02 * largest_n) {
      return 0;
    }
    std::fprintf(stderr,
                 "the error of the normal force, %.2g N, is too large for forces up to %.2g N\n",
                 error_n, largest_n);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return 1;
}
