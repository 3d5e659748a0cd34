// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: what became of a frame, for methods that answer whatever they are shown.
#include <cstdint>

namespace fingerpad {
inline namespace v0 {

enum class FrameStatus : std::uint8_t {
  ok,
  not_of_this_pad,  ///< written, but not to be trusted: another unit, lamp or layout than those of
                    ///< the free pad, or an object larger than what the camera sees
  refused,          ///< a grid or the memory given with it has another size: nothing was written
};

/// "ok", "not of this pad" or "refused".
constexpr const char* name_of(FrameStatus status) {
  return status == FrameStatus::ok                ? "ok"
         : status == FrameStatus::not_of_this_pad ? "not of this pad"
                                                  : "refused";
}

}  // namespace v0
}  // namespace fingerpad
