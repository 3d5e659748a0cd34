// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
#include "fingerpad/core/grid.hpp"

// The sum over an image, from a library with fingerpad in its interface.
float sum_over(fingerpad::StridedView<const float> image);
