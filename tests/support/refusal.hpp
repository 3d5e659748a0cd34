// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What constructors say of bad parameters.
#include <string>

#include "fingerpad/core/expects.hpp"

namespace test {

/// The message with which `construct` is refused, or "accepted".
template <class F>
std::string refusal(const F& construct) {
  try {
    (void)construct();
  } catch (const fingerpad::parameter_error& error) {
    return error.what();
  }
  return "accepted";
}

inline bool begins_with(const std::string& text, const std::string& begin) {
  return text.compare(0, begin.size(), begin) == 0;
}

}  // namespace test
