// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// One function for each calibration. Each reads `recording`, and the results of earlier
// calibrations from `sensor` (sensor.json, which may be missing). Invalid input throws
// replay::Failure or fingerpad::parameter_error.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/report.hpp"
#include "common/images.hpp"
#include "fingerpad/core/point.hpp"

namespace calibrate {

using Path = std::filesystem::path;

/// The camera, from images of a plate with a grid of printed dots. The plate lies on the inner face
/// of the pad's plate, without fluid, with its center dot on the pad's axis (plate/), and is then
/// lifted straight up (plate_raised/), or tilted in three pictures or more (plate_tilted/).
struct DotPlate {
  int rows = 0, cols = 0;  ///< of dots; odd, so that there is a center dot
  double pitch_mm = 0;
  double raised_mm = 0;  ///< 0: no plate_raised/; plate_distance_mm is used
  double plate_distance_mm = 50;
  double refractive_index = 1.33;  ///< of the fluid that is filled in later
  bool is_srgb = false;            ///< how the camera writes light; else linear
  std::string mosaic;              ///< of raw pictures, "rggb"; empty: colour pictures
  replay::PictureFormat format() const {
    return {is_srgb ? replay::srgb_response() : std::vector<double>{}, mosaic};
  }
};
Outcome camera(const Path& recording, const DotPlate& plate);

/// The shape of the free pad. Writes to the recording reference.png, the mean of free/, unless it
/// exists, and its depth. With `ball_radius_mm` the shape is that of an inflated rubber
/// (membrane/free_pad.hpp), or a cap with three even terms, fitted to touches.csv: x_mm,y_mm,z_mm
/// of the lowest point of a ball that just touches the pad. Else it is a spherical cap.
struct PadSize {
  double base_radius_mm = 0;  ///< 0: found
  double apex_height_mm = 0;  ///< of the spherical cap
  double ball_radius_mm = 0;
  double stress_free_height_mm = 0;  ///< of the rubber's apex before it is inflated; 0: found
  bool no_rubber = false;
};
Outcome shape(const Path& recording, const Path& sensor, const PadSize& size);

/// The fluid, from the free pad and from frames/ of known depth (presses.csv or true_depth/).
Outcome absorption(const Path& recording, const Path& sensor);

/// Light from neighbouring membrane, from the same data, with radii up to `max_radius_px`.
Outcome neighbour_light(const Path& recording, const Path& sensor, int max_radius_px);

/// The contact threshold, from free/, and the smallest press that is found: in N with the pad's
/// pressure, else (0) per MPa.
Outcome contact(const Path& recording, const Path& sensor, double pressure_mpa);

/// Noise of the dots, from free/, and the thresholds of slip that follow from it, to read.
Outcome dots(const Path& recording, const Path& sensor);

/// The membrane, from apex.csv (frame,apex_mm) and signals.csv of the free pad at several
/// pressures.
struct RimNoise {
  double base_radius_mm = 0;
  double stress_free_height_mm = 0;  ///< of the pad's apex, as the mould says
  double height_sd_mm = 0.1;
  double apex_noise_mm = 0.01;  ///< of a frame
  double pressure_noise_share = 0.002;
  bool finds_rubber = false;  ///< also fits the Mooney share
};
Outcome rim(const Path& recording, const RimNoise& noise);
/// The modulus with which a fingertip gives a known weight in the frames of `recording` in which
/// something touches; the first is of the free pad, all have a pressure.
Outcome rim_by_weight(const Path& recording,
                      const Path& sensor,
                      const RimNoise& noise,
                      double weight_n);

/// Force curves, from contacts (frames.csv of replay, or any table with its columns) and a table of
/// a gauge with the columns of forces.csv. `gauge` may be empty if `contacts` has these columns.
Outcome force(const Path& contacts, const Path& gauge);

/// The noise of taxels, from taxels.csv of an array at rest.
Outcome taxels(const Path& recording);

/// What a finger will measure that is not yet built: standard deviations of the six axes and of the
/// depth of its free pad, and the smallest press and dent, four of them. Nothing is read or
/// written.
struct Plan {
  double base_radius_mm = 0, stress_free_height_mm = 0, thickness_mm = 0;
  double shear_modulus_mpa = 0;      ///< of the rubber
  double pressure_mpa = 0;           ///< of the free pad
  double grid_pitch_mm = 1.5;        ///< of the printed grid, in plan
  std::vector<double> rows_mm = {};  ///< arcs of rows of dots from the rim; else the grid
  std::vector<fingerpad::Point2<double>> places = {};  ///< or any print: arc, mm; azimuth, rad
  int dots_in_row = 72;
  double dot_noise_px = 0.06;
  double brightness = 180;  ///< grey levels of the membrane without fluid
  double grey_noise = 1;    ///< of a pixel, grey levels
  int picture_rows = 480;   ///< which the pad fills
  int window_px = 29;       ///< over which depth is smoothed
};
Outcome plan(const Plan& plan);

/// Everything that `folder` has pictures of: camera, shape, absorption, contact and rim, with what
/// about.json knows without measuring. Writes sensor.json to the folder and prints one table; what
/// is missing or refused is named and left out. Whether all is there.
bool all(const Path& folder);

/// Compares `pictures` of the pad today, with nothing in contact, with the reference of the
/// calibrated sensor in `folder`, and prints what has changed, by how much, and what must be done
/// again. Whether nothing has.
bool today(const Path& folder, const Path& pictures);

/// Writes recordings of a simulated sensor to practise the calibrations on.
void write_practice(const Path& folder);

}  // namespace calibrate
