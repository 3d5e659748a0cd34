// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A number type without limits of its own must define its epsilon.
// message: specialise fingerpad::scalar_traits
#include "fingerpad/core/scalar.hpp"

struct Number {  // arithmetic, but no std::numeric_limits
  double v;
  explicit Number(double x) : v(x) {}
  explicit Number(int x) : v(x) {}
  friend Number operator+(Number a, Number b) { return Number(a.v + b.v); }
  friend Number operator-(Number a, Number b) { return Number(a.v - b.v); }
  friend Number operator*(Number a, Number b) { return Number(a.v * b.v); }
  friend Number operator/(Number a, Number b) { return Number(a.v / b.v); }
  friend Number operator-(Number a) { return Number(-a.v); }
  friend bool operator<(Number a, Number b) { return a.v < b.v; }
};
#ifdef FINGERPAD_MUST_NOT_COMPILE

#else
template <>
struct fingerpad::scalar_traits<Number> {
  using real = double;
  static constexpr double epsilon() { return (std::numeric_limits<double>::epsilon)(); }
  static const double& value(const Number& x) { return x.v; }
};
#endif
int main() {
  return fingerpad::is_finite(Number(1.0)) ? 0 : 1;
}
