// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Forces by look-up on finite-element membranes: calibrated on some scenes, tested on others.
// test_figures "[force]" -s prints all figures.
#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/contact/equivalent_flat_area.hpp"
#include "fingerpad/force/look_up.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/catch.hpp"
#include "support/contact_records.hpp"
#include "support/wrench_frames.hpp"

using namespace fingerpad;
using test::ContactDotsOf;
using test::ContactMeasure;
using test::Image;

namespace {

using Samples = std::vector<ForceSample<double>>;
using Scenes = std::vector<std::string>;

const Scenes plates = {"press", "drag", "twist", "mix"};
const Scenes others = {"roll", "tilt", "cylinder"};

Scenes without(Scenes scenes, const std::string& left_out) {
  scenes.erase(std::find(scenes.begin(), scenes.end(), left_out));
  return scenes;
}

Samples samples_of(const Scenes& scenes,
                   ContactMeasure measure,
                   ContactDotsOf dots = ContactDotsOf::edge) {
  return test::force_samples(test::contact_records(scenes), measure, dots);
}

/// Absolute errors over samples, and the largest measured force.
struct Errors {
  double mean = 0, worst = 0, bias = 0, largest = 0;
  int count = 0;

  void add(double error, double measured) {
    ++count;
    mean += (std::abs(error) - mean) / count;
    bias += (error - bias) / count;
    worst = (std::max)(worst, std::abs(error));
    largest = (std::max)(largest, std::abs(measured));
  }
};

std::string rounded(double x, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << x;
  return text.str();
}

/// Table with one line per test: errors in the unit and in per cent of a full scale.
class Table {
 public:
  Table(const std::string& title, const std::string& unit, const std::string& note) {
    text_ << '\n' << title << '\n' << std::setw(33) << ("mean/" + unit) << std::setw(9) << "worst";
    text_ << std::setw(9) << "mean %" << std::setw(9) << "worst %" << std::setw(12) << note << '\n';
  }
  /// Returns the mean error relative to the full scale.
  double add(const std::string& name, const Errors& e, double full_scale, const std::string& note) {
    text_ << std::left << std::setw(24) << name << std::right << std::setw(9) << rounded(e.mean, 3)
          << std::setw(9) << rounded(e.worst, 3) << std::setw(9)
          << rounded(100 * e.mean / full_scale, 1) << std::setw(9)
          << rounded(100 * e.worst / full_scale, 1) << std::setw(12) << note << '\n';
    return e.mean / full_scale;
  }
  void show() const {
    INFO(text_.str());
    SUCCEED();
  }

 private:
  std::ostringstream text_;
};

const char* name_of(ContactMeasure measure) {
  return measure == ContactMeasure::depth ? "depth" : "area";
}

double largest_force(const Samples& samples) {
  double largest = 0;
  for (const auto& s : samples) {
    largest = (std::max)(largest, s.normal_force_n);
  }
  return largest;
}

/// Full scale of normal forces: the largest one of all plate scenes, in N.
double full_scale_n() {
  return largest_force(samples_of(plates, ContactMeasure::area));
}

NormalForce<> calibrated(const Scenes& scenes, ContactMeasure measure, int degree = 3) {
  const Samples samples = samples_of(scenes, measure);
  const auto fit = fit_normal_force(std::span<const ForceSample<double>>(samples), degree);
  CHECK(fit.ok());
  return NormalForce<>(fit.curve);
}

template <class AnyForce>
Errors normal_errors(const AnyForce& force, const Scenes& scenes, ContactMeasure measure) {
  Errors e;
  for (const auto& s : samples_of(scenes, measure)) {
    e.add(force(s.measure).force_n - s.normal_force_n, s.normal_force_n);
  }
  return e;
}

/// Mean errors of each plate scene, calibrated with the other three.
std::vector<double> add_left_out(ContactMeasure measure, int degree, Table& table) {
  std::vector<double> shares;
  for (const std::string& scene : plates) {
    const auto force = calibrated(without(plates, scene), measure, degree);
    const Errors e = normal_errors(force, {scene}, measure);
    const std::string name =
        std::string(name_of(measure)) + ", degree " + std::to_string(degree) + ", " + scene;
    shares.push_back(table.add(name, e, full_scale_n(), rounded(e.bias, 3)));
  }
  return shares;
}

bool all_below(const std::vector<double>& shares, double bound) {
  return std::all_of(shares.begin(), shares.end(), [&](double share) { return share <= bound; });
}

/// Fused forces by area and by depth, with cubic curves.
struct FusedErrors {
  Errors errors;
  double flagged = 0;  ///< share of contacts whose two forces have a disagreement above 3
};
FusedErrors fused_errors(const Scenes& calibration, const std::string& scene) {
  const auto by_area = calibrated(calibration, ContactMeasure::area);
  const auto by_depth = calibrated(calibration, ContactMeasure::depth);
  const Samples areas = samples_of({scene}, ContactMeasure::area);
  const Samples depths = samples_of({scene}, ContactMeasure::depth);
  FusedErrors result;
  bool complete = true;
  for (std::size_t k = 0; k < areas.size(); ++k) {
    const auto r = fused(by_area(areas[k].measure), by_depth(depths[k].measure));
    complete = complete && is_finite(r.disagreement);
    result.errors.add(r.force_n - areas[k].normal_force_n, areas[k].normal_force_n);
    result.flagged +=
        (std::abs(r.disagreement) > 3 ? 1.0 : 0.0) / static_cast<double>(areas.size());
  }
  CHECK(complete);
  return result;
}

}  // namespace

TEST_CASE("normal force of plates, calibrated on other scenes", "[force]") {
  // Errors are relative to the largest normal force of all plate scenes, 9.93 N in `press`; without
  // `press` the calibration ends at 9.10 N.
  CHECK(full_scale_n() == Approx(9.93).margin(0.01));
  Table table("Normal force of a plate, calibrated on the other three scenes", "N", "bias/N");
  const auto depth_2 = add_left_out(ContactMeasure::depth, 2, table);
  const auto depth_3 = add_left_out(ContactMeasure::depth, 3, table);
  const auto area_2 = add_left_out(ContactMeasure::area, 2, table);
  const auto area_3 = add_left_out(ContactMeasure::area, 3, table);
  std::vector<double> both;
  double flagged = 0;
  for (const std::string& scene : plates) {
    const auto f = fused_errors(without(plates, scene), scene);
    both.push_back(table.add("fused, degree 3, " + scene, f.errors, full_scale_n(),
                             rounded(f.errors.bias, 3)));
    flagged = (std::max)(flagged, f.flagged);
  }
  table.show();
  CHECK(all_below(depth_3, 0.01));   // goal 0.02; 0.007 measured
  CHECK(all_below(area_3, 0.005));   // goal 0.03; 0.002
  CHECK(all_below(both, 0.005));     // 0.002
  CHECK(all_below(area_2, 0.012));   // 0.008
  CHECK(all_below(depth_2, 0.027));  // 0.021: as published, misses the goal on `press` only
  CHECK(flagged <= 0.051);           // one frame of `press`
}

TEST_CASE("normal force of other shapes from curves of plates", "[force]") {
  // A sphere or a cylinder with the same area presses harder. The disagreement of area and depth
  // detects this; the equivalent flat area, below, corrects it.
  Table table("Other shapes, calibrated on all four scenes of plates, degree 3", "N", "bias/N");
  Table disagree("Contacts of which area and depth disagree beyond 3", "N", "flagged");
  for (const std::string& scene : others) {
    for (const auto measure : {ContactMeasure::depth, ContactMeasure::area}) {
      const Errors e = normal_errors(calibrated(plates, measure), {scene}, measure);
      const double share = table.add(std::string(name_of(measure)) + ", " + scene, e,
                                     full_scale_n(), rounded(e.bias, 3));
      CAPTURE(scene, name_of(measure));
      CHECK(share < 0.13);  // up to 0.109 measured
      const bool plate_by_area = scene == "tilt" && measure == ContactMeasure::area;
      CHECK((share < 0.007) == plate_by_area);  // an area does not show a tilt
      // a curved object goes deeper and touches less
      CHECK((e.bias > 0) == (measure == ContactMeasure::depth));
    }
    const auto f = fused_errors(plates, scene);
    disagree.add("fused, " + scene, f.errors, full_scale_n(), rounded(100 * f.flagged, 0) + " %");
    CHECK(f.flagged > 0.9);
  }
  table.show();
  disagree.show();
}

namespace {

/// A height map of the finite elements with its contact and its true load.
struct PressedMembrane {
  OrthographicCamera<double> camera{79.5, 79.5, 0.24};
  std::string scene;
  double force_n = 0;  ///< along z, negative
  double area_mm2 = 0;
  Image<double> height = Image<double>(160, 160, test::nan);
  Image<std::uint8_t> mask = Image<std::uint8_t>(160, 160);

  explicit PressedMembrane(const test::WrenchFrame& frame) : scene(frame.scene) {
    const test::Membrane membrane(frame.heights);
    const test::TrueContact contact(frame.heights);
    for (Index i = 0; i < 160; ++i) {
      for (Index j = 0; j < 160; ++j) {
        const auto p = point_at(camera, double(i), double(j), 0.0);
        mask(i, j) = contact(p.x, p.y) ? 255 : 0;
        if (std::hypot(p.x, p.y) < test::base_radius_mm) {
          height(i, j) = membrane(p.x, p.y);
        }
      }
    }
    for (const auto& r : test::contact_records({scene})) {
      if (std::abs(r.force_n.z - frame.force_n.z) < std::abs(force_n - frame.force_n.z)) {
        area_mm2 = r.area_mm2;
        force_n = r.force_n.z;
      }
    }
  }
};

}  // namespace

TEST_CASE("normal force of any shape from a curve of plates, by the equivalent flat area",
          "[force]") {
  // The curve is calibrated on level plates only. Its error is relative to 9.93 N.
  const auto force = calibrated(plates, ContactMeasure::area);
  Table table("All shapes, calibrated on all four scenes of plates, degree 3", "N", "by area");
  std::map<std::string, std::array<Errors, 2>> found;
  int within_two_sd = 0;
  double sd_squares = 0;
  for (const auto& frame : test::wrench_frames()) {
    const PressedMembrane pressed(frame);
    EquivalentFlatArea<> flat(pressed.camera, 160, 160);
    const auto equivalent = flat(pressed.mask, pressed.height);
    REQUIRE(equivalent.ok());
    // p S against the truth, without a fitted curve
    const double sds = (frame.pressure_mpa * equivalent.area_mm2 + frame.force_n.z) /
                       (frame.pressure_mpa * std::sqrt(equivalent.variance_mm4));
    within_two_sd += std::abs(sds) <= 2 ? 1 : 0;
    sd_squares += sds * sds / 15;
    auto& [by_equivalent, by_area] = found[pressed.scene];
    by_equivalent.add(force(equivalent.area_mm2).force_n + pressed.force_n, pressed.force_n);
    by_area.add(force(pressed.area_mm2).force_n + pressed.force_n, pressed.force_n);
  }
  for (const auto& [scene, errors] : found) {
    table.add(scene, errors[0], full_scale_n(), rounded(errors[1].worst, 3));
    CAPTURE(scene, errors[0].worst, errors[1].worst);
    CHECK(errors[0].worst < 0.04 * full_scale_n());  // the goal; 0.039 measured, mix
    const bool round_object = scene == "roll" || scene == "cylinder";
    CHECK((errors[1].worst > 0.09 * full_scale_n()) == round_object);
  }
  table.show();
  INFO("within two standard deviations: " << within_two_sd << " of 15; rms "
                                          << std::sqrt(sd_squares) << " of one");
  CHECK(within_two_sd >= 14);           // 95 %
  CHECK(std::sqrt(sd_squares) > 0.25);  // and not because the deviations are too large
}

namespace {

/// Values for the half of the map that is not tested.
ShearLaw<> any_law(double coefficient) {
  return {coefficient, 0, 1};
}

double reference_of(ContactMeasure measure) {
  return measure == ContactMeasure::depth ? 10 : 100;  // as published
}

/// Published exponents of rotation.
double rotation_exponent_of(ContactMeasure measure) {
  return measure == ContactMeasure::depth ? 2.2 : 1.7;
}

/// Errors are lengths of difference vectors.
Errors tangential_errors(const ShearFit<>& fit, double reference, const Samples& samples) {
  const Shear<> shear({reference, fit.law, any_law(100 * fit.law.slope)});
  Errors e;
  for (const auto& s : samples) {
    const auto found = shear(s.measure, s.displacement_mm, 0).tangential_force_n;
    const auto& truth = s.tangential_force_n;
    e.add(std::hypot(found.x - truth.x, found.y - truth.y), std::hypot(truth.x, truth.y));
  }
  return e;
}

Errors moment_errors(const ShearFit<>& fit, double reference, const Samples& samples) {
  const Shear<> shear({reference, any_law(fit.law.slope / 100), fit.law});
  Errors e;
  for (const auto& s : samples) {
    e.add(shear(s.measure, {0, 0}, s.rotation_rad).moment_n_mm - s.moment_n_mm, s.moment_n_mm);
  }
  return e;
}

ShearFit<> tangential_fit(const Samples& samples, double reference) {
  const auto fit = fit_tangential_force(std::span<const ForceSample<double>>(samples), reference);
  CHECK(fit.ok());
  return fit;
}

/// Mean errors of one measure and one choice of dots, relative to the largest force of each scene.
struct TangentialShares {
  double drag, tilt, cylinder;  ///< calibrated on mix
  double mix;                   ///< calibrated on drag and cylinder
};
TangentialShares add_tangential(ContactMeasure measure, ContactDotsOf dots, Table& table) {
  const double reference = reference_of(measure);
  const auto of = [&](const Scenes& scenes) { return samples_of(scenes, measure, dots); };
  const std::string name =
      std::string(dots == ContactDotsOf::edge ? "edge, " : "center, ") + name_of(measure) + ", ";
  const auto share = [&](const auto& fit, const std::string& scene) {
    const Errors e = tangential_errors(fit, reference, of({scene}));
    return table.add(name + scene, e, e.largest, rounded(fit.law.exponent, 2));
  };
  const auto from_mix = tangential_fit(of({"mix"}), reference);
  const auto from_drags = tangential_fit(of({"drag", "cylinder"}), reference);
  return {share(from_mix, "drag"), share(from_mix, "tilt"), share(from_mix, "cylinder"),
          share(from_drags, "mix")};
}

}  // namespace

TEST_CASE("tangential force, calibrated on other scenes", "[force]") {
  // Exponents are fitted; the published 0.65 and 0.75 belong to another pad.
  Table table("drag, tilt, cylinder: calibrated on mix; mix: on drag and cylinder", "N",
              "exponent");
  const auto depth = add_tangential(ContactMeasure::depth, ContactDotsOf::edge, table);
  const auto area = add_tangential(ContactMeasure::area, ContactDotsOf::edge, table);
  const auto central = add_tangential(ContactMeasure::depth, ContactDotsOf::center, table);
  const auto central_area = add_tangential(ContactMeasure::area, ContactDotsOf::center, table);
  table.show();
  // the goal is 0.04
  CHECK(depth.drag <= 0.02);
  CHECK(depth.tilt <= 0.035);
  CHECK(depth.cylinder <= 0.04);
  CHECK(depth.mix <= 0.04);
  CHECK(area.drag <= 0.025);
  CHECK(area.tilt <= 0.04);
  CHECK(area.cylinder <= 0.07);  // 0.055: the cylinder's contact is a strip
  CHECK(area.mix <= 0.025);
  // The central dot, as published, misses the goal in every scene where the direction of motion
  // changes.
  for (const auto& published : {central, central_area}) {
    CHECK(published.drag > 0.06);
    CHECK(published.tilt > 0.06);
    CHECK(published.cylinder <= 0.04);
    CHECK(published.mix > 0.05);
  }
}

TEST_CASE("moment, calibrated on other scenes", "[force]") {
  // Errors are relative to the largest moment of the scene. `twist` alone does not determine an
  // exponent, because it rotates at one depth.
  Table table("twist: calibrated on mix; mix: on twist, exponent as published", "N mm", "exponent");
  const auto share = [&](const std::string& name, const auto& fit, ContactMeasure measure,
                         const Samples& samples) {
    const Errors e = moment_errors(fit, reference_of(measure), samples);
    return table.add(name, e, e.largest, rounded(fit.law.exponent, 2));
  };
  for (const auto measure : {ContactMeasure::depth, ContactMeasure::area}) {
    const double reference = reference_of(measure);
    const double published = rotation_exponent_of(measure);
    const bool by_depth = measure == ContactMeasure::depth;
    for (const auto dots : {ContactDotsOf::edge, ContactDotsOf::center}) {
      const Samples mix = samples_of({"mix"}, measure, dots);
      const Samples twist = samples_of({"twist"}, measure, dots);
      const std::span<const ForceSample<double>> of_mix(mix), of_twist(twist);
      const bool edge = dots == ContactDotsOf::edge;
      const std::string name = std::string(edge ? "edge, " : "all, ") + name_of(measure) + ", ";
      const auto fit = fit_moment(of_mix, reference);
      CHECK(fit.ok());
      const double forth = share(name + "1, twist", fit, measure, twist);
      const double given =
          share(name + "1 p., twist", fit_moment(of_mix, reference, published), measure, twist);
      const double back =
          share(name + "1 p., mix", fit_moment(of_twist, reference, published), measure, mix);
      CAPTURE(name_of(measure), edge);
      // the goal is 0.05
      CHECK(forth <= (edge ? 0.015 : 0.06));  // 0.009 and 0.010; all dots 0.049 and 0.050
      // The published exponents are too large for this pad, whose moment grows as depth^1.6 and
      // area^1.0.
      CHECK(given <= (by_depth ? 0.1 : 0.2));     // 0.082 and 0.158
      CHECK(back <= (by_depth ? 0.045 : 0.075));  // 0.028 and 0.057; all dots 0.035 and 0.062
    }
    const Samples twist = samples_of({"twist"}, ContactMeasure::depth);
    CHECK_THROWS_AS(fit_moment(std::span<const ForceSample<double>>(twist), 10.0), parameter_error);
  }
  table.show();
}
