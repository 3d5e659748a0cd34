// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// sensor.json of a recording: the description of camera, fluid and pad. An unknown key is refused
// with its name, a missing key with its purpose, a wrong value with its range. A dots-only
// recording describes no camera, fluid, pad or depth.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/images.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/dots/side_dots.hpp"
#include "fingerpad/force/look_up.hpp"
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

/// Dots of a dots-only recording; unknown properties are found in the frames.
struct DotPattern {
  int rows = 0;  ///< 0: counted in the frames
  int cols = 0;
  double diameter_px = 0;      ///< 0: measured in the frames
  std::optional<bool> bright;  ///< brighter than their background, or darker; empty: found
};

struct Rim {
  std::optional<double> membrane_modulus_n_per_mm;
  std::optional<double> membrane_modulus_sd_n_per_mm;
  std::optional<double> stress_free_inclination_rad;  ///< of the membrane at the rim
  double mooney_share = 0;                            ///< C2 / (C1 + C2) of its rubber
  double membrane_thickness_mm = 0;                   ///< 0: not known
  double full_scale_n = 0;                            ///< the largest press to expect; 0: not known
  std::vector<fingerpad::SideRow> side_rows;          ///< of dots around the rim; may be empty
};

/// The measure of a contact by which a force is looked up.
enum class ContactMeasure { area, depth };

/// Tangential force and moment.
struct ShearLookUp {
  ContactMeasure by = ContactMeasure::area;
  fingerpad::ShearMap<> map;
};

/// Curves of forces by look-up from an earlier calibration; at least one is set.
struct ForceLookUp {
  std::optional<fingerpad::ForceCurve<>> by_area;  ///< mm^2
  std::optional<fingerpad::ForceCurve<>> by_depth;
  std::optional<ShearLookUp> shear;
};

/// What `calibrate contact` found in frames of the free pad.
struct Contact {
  double threshold_per_mm = 0, faint_per_mm = 0;
  double ring_px = fingerpad::ContactTest().ring_px;
  std::optional<double> depth_noise_mm = {};  ///< standard deviation of a smoothed depth
};

struct NeighbourLight {
  int radius_px = 0;
  double m0_mm_per_rad = 0;
  double n_per_mm = 0;
};

struct Sensor {
  fingerpad::Camera<double> camera;
  PictureFormat pictures;
  fingerpad::Absorption<double> absorption;
  std::optional<fingerpad::PadLight<double>> light;  ///< empty: fitted to the reference frame
  Pad pad;
  std::string reference_frame;  ///< paths as written, relative to the recording; may be empty
                                ///< if dots-only
  std::string reference_depth;
  std::optional<std::string> video;  ///< instead of the folder frames/
  std::optional<int> smoothing_px;   ///< window width, odd; empty: replay does not smooth
  std::optional<Dots> dots;
  bool dots_only = false;          ///< if true, camera, absorption, pad and dots are empty
  DotPattern pattern;              ///< only of a dots-only recording
  fingerpad::StickOptions stick;   ///< lengths in px
  bool soft_object = false;        ///< for the friction limit
  std::optional<Contact> contact;  ///< empty: threshold from the free pad
  std::optional<ForceLookUp> force;
  std::optional<Rim> rim;
  std::optional<NeighbourLight> neighbour_light;
};

/// Version of sensor.json. Files without "version" have this one; other versions are refused.
constexpr int sensor_version = 1;

/// Reads and checks `file`; throws Failure.
Sensor read_sensor(const std::filesystem::path& file);
/// The same for content that was read from `file` or replaces it.
Sensor read_sensor(const std::filesystem::path& file, const nlohmann::json& content);
/// Throws Failure if "version" is not sensor_version.
void expects_known_version(const std::filesystem::path& file, const nlohmann::json& content);

}  // namespace replay
