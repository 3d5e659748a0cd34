// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once

namespace test {
/// Number of heap allocations of this program so far.
long allocations();
/// Number of bytes allocated so far, whether or not they were freed.
long bytes_taken();
}  // namespace test
