// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Everything but the adapters, which bring their libraries with them (see adapt/).
#include "fingerpad/depth.hpp"
#include "fingerpad/dots.hpp"
#include "fingerpad/expects.hpp"
#include "fingerpad/grid.hpp"
#include "fingerpad/optics.hpp"
#include "fingerpad/scalar.hpp"
#include "fingerpad/version.hpp"
