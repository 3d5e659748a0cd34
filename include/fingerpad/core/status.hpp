// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: the outcome of one frame. Every status except `refused` comes with a written result.
#include <cstdint>

namespace fingerpad {
inline namespace v1 {

enum class FrameStatus : std::uint8_t {
  ok,
  not_of_this_pad,  ///< the result is unreliable: the sensor unit, lamp or layout is not that of
                    ///< the free pad, or the object is larger than the camera's view
  refused,          ///< a grid or the memory given with it has the wrong size: nothing was written
};

/// "ok", "not of this pad" or "refused".
constexpr const char* name_of(FrameStatus status) {
  return status == FrameStatus::ok                ? "ok"
         : status == FrameStatus::not_of_this_pad ? "not of this pad"
                                                  : "refused";
}

}  // namespace v1
}  // namespace fingerpad
