// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: what became of a frame, for methods that answer whatever they are shown.
#include <cstdint>

namespace fingerpad {
inline namespace v0 {

enum class FrameStatus : std::uint8_t {
  ok,
  refused,  ///< a grid or the memory given with it has another size: nothing was written
};

/// "ok" or "refused".
constexpr const char* name_of(FrameStatus status) {
  return status == FrameStatus::ok ? "ok" : "refused";
}

}  // namespace v0
}  // namespace fingerpad
