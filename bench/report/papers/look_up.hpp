// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Forces by look-up on the contacts of finite-element scenes (tests/data/contacts.csv). Published:
// quadratic curves with a constant, fitted to a press; equations like 21 and 22, fitted to and
// tested on the same drag or twist, as in the paper; for shear, the central dot and straight lines
// with the published exponents. Default: cubics through 0, and shear from the edge dots with fitted
// exponents, each tested on a scene that was not fitted.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/force/look_up.hpp"
#include "support/contact_records.hpp"
#include "table.hpp"

namespace bench::papers {

using Samples = std::vector<fingerpad::ForceSample<double>>;

inline Samples samples_of(const std::vector<std::string>& scenes,
                          test::ContactMeasure measure,
                          test::ContactDotsOf dots = test::ContactDotsOf::edge) {
  return test::force_samples(test::contact_records(scenes), measure, dots);
}
inline std::span<const fingerpad::ForceSample<double>> span_of(const Samples& samples) {
  return samples;
}
inline double reference_of(test::ContactMeasure measure) {
  return measure == test::ContactMeasure::depth ? 10 : 100;  // as published
}

/// F = a F_plain + b |x| + c on a scene, by least squares; F_plain is the quadratic of the press.
inline std::vector<double> published_normal(const std::string& scene,
                                            test::ContactMeasure measure) {
  using namespace fingerpad;
  const Samples press = samples_of({"press"}, measure, test::ContactDotsOf::center);
  const auto curve = fit_normal_force(span_of(press), 2, false).curve;
  const Samples on = samples_of({scene}, measure, test::ContactDotsOf::center);
  std::vector<double> errors;
  if (scene == "press") {
    for (const auto& s : on) {
      errors.push_back(curve.force_n(s.measure) - s.normal_force_n);
    }
    return errors;
  }
  const auto count = static_cast<Eigen::Index>(on.size());
  Eigen::MatrixX3d terms(count, 3);
  Eigen::VectorXd forces(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto& s = on[static_cast<std::size_t>(k)];
    const double size = scene == "twist" ? std::abs(s.rotation_rad)
                                         : std::hypot(s.displacement_mm.x, s.displacement_mm.y);
    terms.row(k) << curve.force_n(s.measure), size, 1;
    forces(k) = s.normal_force_n;
  }
  const Eigen::VectorXd fitted = terms * terms.colPivHouseholderQr().solve(forces);
  for (Eigen::Index k = 0; k < count; ++k) {
    errors.push_back(fitted(k) - forces(k));
  }
  return errors;
}

inline std::vector<std::string> plates_but(const std::string& scene) {
  std::vector<std::string> scenes = {"press", "drag", "twist", "mix"};
  std::erase(scenes, scene);
  return scenes;
}

/// Errors of the default curve, calibrated on the other plates.
inline std::vector<double> default_normal(const std::string& scene, test::ContactMeasure measure) {
  using namespace fingerpad;
  const Samples others = samples_of(plates_but(scene), measure);
  const auto curve = fit_normal_force(span_of(others), 3).curve;
  std::vector<double> errors;
  for (const auto& s : samples_of({scene}, measure)) {
    errors.push_back(NormalForce(curve)(s.measure).force_n - s.normal_force_n);
  }
  return errors;
}

/// Errors of the force along the plate (lengths), or of the moment, and the largest true value.
struct ShearErrors {
  std::vector<double> errors;
  double largest = 0;
  std::vector<double> found, truth;  ///< of each step; a force with the sign of its x
};
inline double signed_length(const fingerpad::Point2<double>& p) {
  return std::copysign(std::hypot(p.x, p.y), p.x);
}
inline ShearErrors tangential(const std::vector<std::string>& from,
                              const std::string& on,
                              test::ContactMeasure measure,
                              test::ContactDotsOf dots,
                              std::optional<double> exponent) {
  using namespace fingerpad;
  const Samples seen = samples_of(from, measure, dots);
  const auto fit = fit_tangential_force(span_of(seen), reference_of(measure), exponent);
  ShearMap<> map{reference_of(measure), fit.law, {}};
  map.moment.slope = 0;
  const Shear shear(map);
  ShearErrors out;
  for (const auto& s : samples_of({on}, measure, dots)) {
    const auto f = shear(s.measure, s.displacement_mm, 0).tangential_force_n;
    const auto& truth = s.tangential_force_n;
    out.errors.push_back(std::hypot(f.x - truth.x, f.y - truth.y));
    out.largest = (std::max)(out.largest, std::hypot(truth.x, truth.y));
    out.found.push_back(signed_length(f));
    out.truth.push_back(signed_length(truth));
  }
  return out;
}
inline ShearErrors moment(const std::vector<std::string>& from,
                          const std::string& on,
                          test::ContactMeasure measure,
                          test::ContactDotsOf dots,
                          std::optional<double> exponent) {
  using namespace fingerpad;
  const Samples seen = samples_of(from, measure, dots);
  const auto fit = fit_moment(span_of(seen), reference_of(measure), exponent);
  ShearMap<> map{reference_of(measure), {}, fit.law};
  map.force.slope = 0;
  const Shear shear(map);
  ShearErrors out;
  for (const auto& s : samples_of({on}, measure, dots)) {
    out.found.push_back(shear(s.measure, {0, 0}, s.rotation_rad).moment_n_mm);
    out.truth.push_back(s.moment_n_mm);
    out.errors.push_back(out.found.back() - s.moment_n_mm);
    out.largest = (std::max)(out.largest, std::abs(s.moment_n_mm));
  }
  return out;
}

inline Section look_up_section() {
  using test::ContactDotsOf, test::ContactMeasure;
  constexpr double full_n = 9.93;  // the largest normal force of the plates
  Section section{"Forces by look-up [F]", {}};
  const auto normal = [&](const std::string& experiment, const std::string& scene,
                          const std::array<std::string, 2>& printed, const std::string& nearest) {
    for (const auto measure : {ContactMeasure::area, ContactMeasure::depth}) {
      const bool by_area = measure == ContactMeasure::area;
      section.rows.push_back({experiment + (by_area ? ", by area" : ", by depth"),
                              "error of F_z, mean / largest, of the full scale",
                              printed[by_area ? 0 : 1],
                              Spread(published_normal(scene, measure)).shares(full_n),
                              Spread(default_normal(scene, measure)).shares(full_n), nearest});
    }
  };
  normal("pressed", "press", {"curves of Fig. 11", "curves of Fig. 11"}, "plate pressed");
  normal("dragged (eq. 21)", "drag",
         {"1.9 % / 5.3 % (0.54 / 1.49 N)", "1.0 % / 2.5 % (0.27 / 0.72 N)"}, "plate dragged");
  normal("turned (eq. 22)", "twist",
         {"0.7 % / 1.7 % (0.20 / 0.49 N)", "0.6 % / 1.5 % (0.16 / 0.43 N)"}, "plate turned");
  const auto cell = [](const ShearErrors& e) { return Spread(e.errors).shares(e.largest); };
  for (const auto measure : {ContactMeasure::area, ContactMeasure::depth}) {
    const bool by_area = measure == ContactMeasure::area;
    const std::string by = by_area ? ", by area" : ", by depth";
    section.rows.push_back(
        {"force along the plate" + by, "error, mean / largest, of the largest",
         "\"almost linear\" (Fig. 14)",
         cell(tangential({"drag"}, "drag", measure, ContactDotsOf::center, by_area ? 0.65 : 0.75)),
         cell(tangential({"mix"}, "drag", measure, ContactDotsOf::edge, {})),
         "plate dragged to slip and back; published fitted to it, default to another scene"});
    section.rows.push_back(
        {"moment" + by, "error, mean / largest, of the largest", "\"linear\" (Fig. 15)",
         cell(moment({"twist"}, "twist", measure, ContactDotsOf::center, by_area ? 1.7 : 2.2)),
         cell(moment({"mix"}, "twist", measure, ContactDotsOf::edge, {})),
         "plate turned to slip; the same"});
  }
  return section;
}

}  // namespace bench::papers
