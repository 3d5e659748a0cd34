// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Catch2, version 2 or 3, and RapidCheck's rc::prop for it. Under version 3 the build puts
// catch2_3/ in the include path, whose catch2/catch.hpp is a forwarding header.
#include <rapidcheck.h>
#include <rapidcheck/catch.h>

#include <catch2/catch.hpp>
