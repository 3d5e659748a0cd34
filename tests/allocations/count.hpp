// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once

namespace test {
/// How often this program has taken memory from the heap so far.
long allocations();
}  // namespace test
