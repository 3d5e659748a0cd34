// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Imitates the folders of xtensor 0.26 on a machine that has the flat layout.
#include <xtensor/xarray.hpp>
