// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// One function a calibration. Each reads `recording`, and of `sensor` (sensor.json, which need not
// be there) what earlier ones found. What is refused throws replay::Failure or
// fingerpad::parameter_error.
#include <filesystem>
#include <optional>

#include "calibrate/report.hpp"

namespace calibrate {

using Path = std::filesystem::path;

/// A plate with a grid of printed dots on the inner face of the pad's plate, without fluid, its
/// middle dot on the pad's axis: plate/, and plate_raised/ with it lifted straight up.
struct DotPlate {
  int rows = 0, cols = 0;  ///< of its dots, odd, so that one is the middle
  double pitch_mm = 0;
  double raised_mm = 0;  ///< 0: no plate_raised/, and the distance is as given
  double plate_distance_mm = 50;
  double refractive_index = 1.33;  ///< of the fluid that will be there
};
Outcome camera(const Path& recording, const DotPlate& plate);

/// The free pad: reference.png as the mean of free/ where it is not there, and its depth as that of
/// a spherical cap, written to the recording. With `ball_radius_mm`, the cap is fitted to
/// touches.csv: x_mm,y_mm,z_mm of the lowest point of a ball that just touches the pad.
struct CapSize {
  double base_radius_mm = 0;
  double apex_height_mm = 0;
  double ball_radius_mm = 0;
};
Outcome shape(const Path& recording, const Path& sensor, const CapSize& size);

/// The fluid, from the free pad and from frames/ of known depth (presses.csv or true_depth/).
Outcome absorption(const Path& recording, const Path& sensor);

/// Light from neighbouring membrane, from the same; no radius larger than `max_radius_px`.
Outcome neighbour_light(const Path& recording, const Path& sensor, int max_radius_px);

/// The threshold of contact, from free/.
Outcome contact(const Path& recording, const Path& sensor);

/// Noise of the dots from free/ and thresholds of slip; with `slips`, how far dots go between
/// answers is chosen by frames/, in which a contact begins sticking and slips at last.
Outcome dots(const Path& recording, bool slips);

/// The rim, from side_dots.csv and signals.csv of the free pad at two pressures or more; at one, if
/// the length is given.
struct RimNoise {
  double base_radius_mm = 0;
  std::optional<double> length_mm;
  std::optional<double> inclination_rad;  ///< of the membrane without stress
  double dot_noise_mm = 0;                ///< 0 both: errors from what the fit leaves
  double pressure_noise_mpa = 0;
  double stress_free_height_mm = 0;  ///< of the pad's apex; > 0: the rubber is found, too, from
                                     ///< apex.csv (frame,apex_mm)
  double apex_noise_mm = 0;
};
Outcome rim(const Path& recording, const RimNoise& noise);

/// Force curves, from contacts (frames.csv of replay, or any table with its columns) and a gauge's
/// table with the columns of forces.csv; `gauge` may be empty if `contacts` has them.
Outcome force(const Path& contacts, const Path& gauge);

/// Noise of taxels, from taxels.csv of an array at rest.
Outcome taxels(const Path& recording);

/// Writes recordings of a sensor that exists only as numbers, to try all this on.
void write_practice(const Path& folder);

}  // namespace calibrate
