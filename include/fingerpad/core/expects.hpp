// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: how bad parameters are refused. Constructors check every parameter and refuse a bad
// one with a message that names the parameter, its value and its range. They call the installed
// handler, if any, and throw parameter_error. A program compiled without exceptions prints the
// message on standard error if there is no handler, and calls std::abort. Only constructors and
// calibration refuse; per-frame calls report a status. Compile a whole program either with
// exceptions or without.
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// What a constructor throws for a bad parameter: "Camera: refractive_index = 0.9, must be >= 1".
class parameter_error : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Called with the message before a bad parameter is refused; it may log, throw or not return.
using refusal_handler = void (*)(const char* message);

namespace detail {
inline refusal_handler installed_refusal_handler = nullptr;
}

/// Installs `handler` (nullptr: none) and returns the previous one. Not synchronised: install it
/// before other threads construct anything.
inline refusal_handler set_refusal_handler(refusal_handler handler) noexcept {
  const refusal_handler before = detail::installed_refusal_handler;
  detail::installed_refusal_handler = handler;
  return before;
}

/// Refuses with `message`; never returns.
[[noreturn]] inline void refuse(const std::string& message) {
  const refusal_handler handler = detail::installed_refusal_handler;
  if (handler != nullptr) {
    handler(message.c_str());
  }
#if defined(__cpp_exceptions)
  throw parameter_error(message);
#else
  if (handler == nullptr) {
    std::fprintf(stderr, "fingerpad: %s\n", message.c_str());
  }
  std::abort();
#endif
}

/// Refuses parameter `name` of `owner` unless `good`; `range` says in words what is allowed.
template <scalar S>
void expects(bool good, const char* owner, const char* name, const S& given, const char* range) {
  if (good) {
    return;
  }
  char number[64];
  std::snprintf(number, sizeof number, "%.9g", static_cast<double>(value(given)));
  refuse(std::string(owner) + ": " + name + " = " + number + ", must be " + range);
}

/// The same for a whole-number parameter.
inline void expects(
    bool good, const char* owner, const char* name, long long given, const char* range) {
  if (!good) {
    refuse(std::string(owner) + ": " + name + " = " + std::to_string(given) + ", must be " + range);
  }
}

}  // namespace v0
}  // namespace fingerpad
