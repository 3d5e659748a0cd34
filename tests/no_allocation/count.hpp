// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once

namespace test {
/// How often this program has taken memory from the heap so far.
long allocations();
/// How many bytes it has asked for, whether or not it gave them back.
long bytes_taken();
}  // namespace test
