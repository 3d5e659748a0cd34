// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: how bad parameters are refused. Every options type has `check(options)`: a table of
// its parameters and their ranges, which gives the text of the refusal, or "" if all are good, so
// that a program can ask before it constructs. Only constructors and calibration refuse: they call
// the installed handler, if any, and throw parameter_error, or abort if the program is compiled
// without exceptions. Compile a whole program either with exceptions or without.
#include <cmath>
#include <concepts>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

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
  std::abort();
#endif
}

/// The finite numbers that a parameter may have.
struct Range {
  double min = -(std::numeric_limits<double>::infinity)();
  double max = (std::numeric_limits<double>::infinity)();
  bool above_min = false;  ///< min itself is refused
  bool odd = false;
  bool below_max = false;  ///< max itself is refused
};
inline constexpr Range finite_number = {};
inline constexpr Range positive = {.min = 0, .above_min = true};
inline constexpr Range not_negative = {.min = 0};
constexpr Range at_least(double min) {
  return {.min = min};
}
constexpr Range within(double min, double max) {
  return {.min = min, .max = max};
}
constexpr Range odd_within(double min, double max) {
  return {.min = min, .max = max, .odd = true};
}

/// One line of a table of parameters.
struct Parameter {
  template <scalar S>
  Parameter(const char* label, const S& given, const Range& allowed)
      : name(label), number(static_cast<double>(value(given))), range(allowed) {}
  template <std::integral I>
  Parameter(const char* label, I given, const Range& allowed)
      : name(label), number(static_cast<double>(given)), range(allowed), whole(true) {}

  const char* name;
  double number;
  Range range;
  bool whole = false;

  bool good() const {
    return std::isfinite(number) && number >= range.min && number <= range.max &&
           !(range.above_min && number == range.min) && !(range.below_max && number == range.max) &&
           !(range.odd && std::fmod(std::fabs(number), 2) != 1);
  }
};

namespace detail {

/// The text that printf makes of its arguments, at most 511 characters: a chain of strings that are
/// added takes a second to compile.
template <class... Arguments>
std::string print(const char* format, const Arguments&... arguments) {
  char text[512];
  std::snprintf(text, sizeof text, format, arguments...);
  return text;
}

/// "0.025", or all digits of a whole number.
inline std::string written(double number, bool whole = false) {
  return print(whole ? "%.0f" : "%.9g", number);
}

/// "finite and > 0", "<= 1", "in [0, 1]", "in (0, 1)", "odd, in [3, 109]".
inline std::string written(const Range& range, bool whole) {
  const char* odd = range.odd ? "odd, " : "";
  const bool has_min = std::isfinite(range.min), has_max = std::isfinite(range.max);
  if (has_min && has_max) {
    return print("%sin %c%.9g, %.9g%c", odd, range.above_min ? '(' : '[', range.min, range.max,
                 range.below_max ? ')' : ']');
  }
  if (has_max) {
    return print("%s<= %.9g", odd, range.max);
  }
  if (has_min) {
    return print("%s%s%s %.9g", odd, whole ? "" : "finite and ",
                 range.above_min ? ">" : ">=", range.min);
  }
  return print("%s%s", odd, whole ? "" : "finite");
}

}  // namespace detail

/// The refusal of the first parameter of `owner` that is out of its range; "" if all are good.
inline std::string check(const char* owner, std::initializer_list<Parameter> parameters) {
  for (const Parameter& p : parameters) {
    if (!p.good()) {
      return detail::print("%s: %s = %s, must be %s", owner, p.name,
                           detail::written(p.number, p.whole).c_str(),
                           detail::written(p.range, p.whole).c_str());
    }
  }
  return "";
}

/// Refuses options whose check(options) is not "".
template <class Options>
void require(const Options& options) {
  const std::string refusal = check(options);
  if (!refusal.empty()) {
    refuse(refusal);
  }
}

/// Refuses the first parameter of `owner` that is out of its range.
inline void require(const char* owner, std::initializer_list<Parameter> parameters) {
  const std::string refusal = check(owner, parameters);
  if (!refusal.empty()) {
    refuse(refusal);
  }
}

/// Refuses parameter `name` of `owner` unless `good`; `range` says in words what is allowed.
template <class Number>
void expects(
    bool good, const char* owner, const char* name, const Number& given, const char* range) {
  if (!good) {
    const Parameter p(name, given, finite_number);
    refuse(detail::print("%s: %s = %s, must be %s", owner, name,
                         detail::written(p.number, p.whole).c_str(), range));
  }
}

}  // namespace v1
}  // namespace fingerpad
