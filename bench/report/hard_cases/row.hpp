// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A row of the table of hard cases: the loss of accuracy of a naive form and of fingerpad's form
// over a sweep of inputs, in float and in double, against 50 digits of the same rounded inputs.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "fingerpad/core/scalar.hpp"
#include "support/numbers.hpp"

namespace hard {

using test::Digits50;

/// Results of a sweep.
struct Tally {
  double worst = 0;  ///< error of the finite answers
  int cases = 0;
  int nan = 0;
  int infinite = 0;
  int wrong = 0;    ///< an answer where none exists
  int refused = 0;  ///< a status instead of an answer

  /// Adds an answer with the error |answer - exact| / size.
  template <class S>
  void add(const S& answer, const Digits50& exact, const Digits50& size) {
    ++cases;
    const double number = static_cast<double>(answer);
    if (std::isnan(number)) {
      ++nan;
    } else if (std::isinf(number)) {
      ++infinite;
    } else {
      const Digits50 off = abs(Digits50(Digits50(answer) - exact)) / size;
      worst = (std::max)(worst, static_cast<double>(off));
    }
  }
  template <class S>
  void add_absolute(const S& answer, const Digits50& exact) {
    add(answer, exact, Digits50(1));
  }
  template <class S>
  void add_relative(const S& answer, const Digits50& exact) {
    add(answer, exact, Digits50(abs(exact)));
  }
  void answer_none(bool refuses) {
    ++cases;
    ++(refuses ? refused : wrong);
  }

  /// The worst error; infinite if an answer is NaN, infinite or wrong.
  double loss() const { return nan + infinite + wrong > 0 ? HUGE_VAL : worst; }
};

struct Forms {
  Tally naive, stable;
};

struct Row {
  std::string method;
  std::string hard_case;  ///< with the sweep and the kind of error
  std::string how;        ///< name of the stable form
  Forms in_float, in_double;
};

/// `measure` is a template over the number type: `Forms measure(S())`.
template <class Measure>
Row row(const char* method, const char* hard_case, const char* how, const Measure& measure) {
  return {method, hard_case, how, measure(0.0F), measure(0.0)};
}

/// "1.6e-2"
inline std::string brief(double number) {
  if (number == 0) {
    return "0";
  }
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", number);
  std::string out = text;
  const std::size_t sign = out.find('e') + 1;
  out.erase(out[sign] == '+' ? sign : sign + 1, out[sign] == '+' ? 1 : 0);
  const std::size_t digits = out[sign] == '-' ? sign + 1 : sign;
  while (out[digits] == '0' && digits + 1 < out.size()) {
    out.erase(digits, 1);
  }
  return out;
}

/// "NaN in 3 of 40, else 1.6e-2"
inline std::string text_of(const Tally& t) {
  std::string text;
  const auto say = [&](int count, const char* what) {
    if (count > 0) {
      text += text.empty() ? "" : ", ";
      text += what;
      text += " ";
      text += std::to_string(count);
      text += " of ";
      text += std::to_string(t.cases);
    }
  };
  say(t.nan, "NaN in");
  say(t.infinite, "inf in");
  say(t.wrong, "wrong in");
  say(t.refused, "refuses");
  if (t.nan + t.infinite + t.wrong + t.refused < t.cases) {
    text += text.empty() ? "" : ", else ";
    text += brief(t.worst);
  }
  return text;
}

/// A line of a Markdown table.
inline std::string line_of(const Row& r) {
  std::string line = "| ";
  line += r.method;
  for (const std::string& cell :
       {r.hard_case, text_of(r.in_float.naive), text_of(r.in_double.naive),
        text_of(r.in_float.stable), text_of(r.in_double.stable), r.how}) {
    line += " | ";
    line += cell;
  }
  line += " |";
  return line;
}

/// Numbers from `low` to `high`, each `factor` times the previous one.
inline std::vector<double> sweep(double low, double high, double factor) {
  std::vector<double> numbers;
  for (double x = low; x < high * 1.0001; x *= factor) {
    numbers.push_back(x);
  }
  return numbers;
}

}  // namespace hard
