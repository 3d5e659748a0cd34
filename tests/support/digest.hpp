// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// One number for many, by which a test notices that any of them has changed. It says nothing about
// what is right: laws, references and scenes do.
#include <cmath>
#include <type_traits>

#include "support/catch.hpp"

namespace test {

/// Each number counts by the logarithm of its size, from 1e-6 on, and by its place.
class Digest {
 public:
  /// A number, a truth value, or a word of an enumeration.
  template <class T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>)
  void add(T number) {
    const auto v = static_cast<double>(number);
    const double size = std::isfinite(v) ? std::copysign(std::log1p(1e6 * std::fabs(v)), v) : -1.0;
    sum_ += (1 + 0.618 * (place_ % 7)) * size;
    ++place_;
  }
  template <class P>
    requires requires(const P& p) {
      p.x + p.y;
    }
  void add(const P& p) {
    add(p.x);
    add(p.y);
    if constexpr (requires { p.z; }) {
      add(p.z);
    }
  }
  /// Row by row.
  template <class Grid>
    requires requires(const Grid& grid) {
      grid(grid.rows() - 1, grid.cols() - 1);
    }
  void add(const Grid& grid) {
    for (auto i = 0 * grid.rows(); i < grid.rows(); ++i) {
      for (auto j = 0 * grid.cols(); j < grid.cols(); ++j) {
        add(grid(i, j));
      }
    }
  }
  template <class... Parts>
  void all(const Parts&... parts) {
    (add(parts), ...);
  }

  double sum() const { return sum_; }

 private:
  double sum_ = 0;
  int place_ = 0;
};

/// The sum of a digest, to what compilers differ by.
inline Approx same(double sum) {
  return Approx(sum).epsilon(0).margin(1e-3);
}

}  // namespace test
