// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Header name of Catch2 version 2, in version 3; RapidCheck's glue includes it by that name.
#include <catch2/catch_all.hpp>

using Catch::Approx;
