// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Everything but the adapters, which bring their libraries with them (see adapt/).
#include "fingerpad/calibrate/contact_region.hpp"
#include "fingerpad/calibrate/depth.hpp"
#include "fingerpad/calibrate/neighbour_light.hpp"
#include "fingerpad/calibrate/stick_ratio.hpp"
#include "fingerpad/contact_region.hpp"
#include "fingerpad/depth.hpp"
#include "fingerpad/dots.hpp"
#include "fingerpad/expects.hpp"
#include "fingerpad/friction_ratio.hpp"
#include "fingerpad/grid.hpp"
#include "fingerpad/grip_control.hpp"
#include "fingerpad/neighbour_light.hpp"
#include "fingerpad/object_motion.hpp"
#include "fingerpad/object_surface.hpp"
#include "fingerpad/optics.hpp"
#include "fingerpad/scalar.hpp"
#include "fingerpad/stick_ratio.hpp"
#include "fingerpad/version.hpp"
