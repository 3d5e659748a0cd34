// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// sensor.json of a recording: what is known about the camera, the fluid and the pad. Unknown keys
// are refused with their name, missing ones with what they are for, wrong values with their range.
// A recording of which only the dots are looked at names no camera, no fluid, no pad and no depth.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/force/normal_force.hpp"
#include "fingerpad/force/rim_traction.hpp"
#include "fingerpad/force/shear.hpp"
#include "fingerpad/optics/camera.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

namespace replay {

struct Pad {
  double base_radius_mm = 0;
  double apex_height_mm = 0;
};

struct Dots {
  int rows = 0;
  int cols = 0;
  double pitch_mm = 0;
  double diameter_mm = 0;
};

/// What is known of the dots of a dots-only recording; what is not is found in the frames.
struct DotPattern {
  int rows = 0;  ///< 0: counted
  int cols = 0;
  double diameter_px = 0;      ///< 0: measured
  std::optional<bool> bright;  ///< brighter than the ground around them, or darker
};

struct Rim {
  double side_dot_length_mm = 0;
  std::optional<double> membrane_modulus_n_per_mm;
  std::optional<double> stress_free_inclination_rad;  ///< of the membrane at the rim
  fingerpad::ClampedRim law;                          ///< of its rubber
};

/// What of a contact a force is looked up by.
enum class ContactMeasure { area, depth };

/// Normal force by area or depth.
struct NormalForceLookUp {
  using Curve = fingerpad::PolynomialForce<5>;  ///< higher powers than given count nothing
  Curve curve;
  fingerpad::ScaledCompensation<> compensation;
  fingerpad::CurveErrors<Curve::parameters> errors;
};

/// Tangential force and moment.
struct ShearLookUp {
  using Map = fingerpad::RadialShear<4>;
  ContactMeasure by = ContactMeasure::area;
  fingerpad::ShearNormalisation<> normalisation;
  Map map;
};

/// Forces by look-up: curves from an earlier calibration, at least one.
struct ForceLookUp {
  std::optional<NormalForceLookUp> by_area;  ///< mm^2
  std::optional<NormalForceLookUp> by_depth;
  std::optional<ShearLookUp> shear;
};

struct NeighbourLight {
  int radius_px = 0;
  double m0_mm_per_rad = 0;
  double n_per_mm = 0;
};

struct Sensor {
  fingerpad::Camera<double> camera;
  fingerpad::Absorption<double> absorption;
  Pad pad;
  std::string reference_frame;  ///< paths as written, relative to the recording; dots only: may
                                ///< be empty
  std::string reference_depth;
  std::optional<std::string> video;  ///< in the place of the folder frames/
  std::optional<int> smoothing_px;   ///< width of the window, odd; none: colours as they are
  std::optional<Dots> dots;
  bool dots_only = false;  ///< then camera, absorption, pad and dots are empty
  DotPattern pattern;      ///< of a dots-only recording
  fingerpad::StickTest stick;
  std::optional<double> contact_threshold_per_mm;  ///< none: from free/
  std::optional<ForceLookUp> force;
  std::optional<Rim> rim;
  std::optional<NeighbourLight> neighbour_light;
};

/// Of sensor.json: files without "version" are of this one, others are refused.
constexpr int sensor_version = 1;

/// Reads and checks `file`; throws Failure.
Sensor read_sensor(const std::filesystem::path& file);
/// The same of what was read from `file`, or stands in for it.
Sensor read_sensor(const std::filesystem::path& file, const nlohmann::json& content);
/// Throws Failure where "version" is not that of this program.
void expects_known_version(const std::filesystem::path& file, const nlohmann::json& content);

}  // namespace replay
