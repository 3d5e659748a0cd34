// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Messages of constructors for bad parameters.
#include <string>

#include "fingerpad/core/check.hpp"

namespace test {

/// The message with which `construct` throws, or "accepted".
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
