// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A user whose own headers define min and max as macros, as <windows.h> does, and variables with
// names of the library. The standard library and the foreign libraries come first, because some of
// them do not compile with such macros.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>
#if __has_include(<xtensor/containers/xarray.hpp>)
#include <xtensor/containers/xarray.hpp>
#else
#include <xtensor/xarray.hpp>
#endif

#define min(a, b) this does not compile
#define max(a, b) this does not compile
int dot, cross, chain, is_finite, is_plausible, pixel_of, point_at, as_view, normalized, name_of,
    squared_norm, same_size, fit_rigid, contact_load;
#include "fingerpad/adapt/dual.hpp"
#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/mdspan.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/adapt/xtensor.hpp"
#include "fingerpad/fingerpad.hpp"
#if !defined(min) || !defined(max)
#error "The user's macros are gone."
#endif

int main() {}
