// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the forces by look-up, from contacts that a force gauge measured beside the
// camera: the curves and compensations of normal_force.hpp and the maps of shear.hpp. Least squares
// by QR, on demand with Huber's weights; with each parameter its covariance, with each fit what it
// leaves. Samples that do not determine a parameter are refused with its name (parameter_error), as
// are samples that contradict each other. docs/calibrate/calibration.md tells how to take samples.
//
// The standard errors hold for samples with independent errors in the force. Errors in the measure
// or the displacement bias the fit toward smaller slopes, and samples of one load have common
// errors: leave_one_load_out tells what to expect of forces that were not calibrated.
#include "fingerpad/calibrate/normal_force.hpp"
#include "fingerpad/calibrate/shear.hpp"
