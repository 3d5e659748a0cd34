// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Random numbers that are the same on every machine and for every order of the work.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace trials {

class Chance {
 public:
  explicit Chance(std::uint64_t seed) : state_(seed) {}

  /// SplitMix64 (Steele, Lea and Flood 2014), which is good even for a few numbers per seed.
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
  double uniform(double from, double to) { return from + (to - from) * uniform(); }
  double normal() {
    const double length = std::sqrt(-2 * std::log(1 - uniform()));
    return length * std::cos(2 * std::numbers::pi * uniform());
  }
  std::size_t below(std::size_t size) {
    return static_cast<std::size_t>(uniform() * static_cast<double>(size));
  }
  /// Draws as many elements as `all` has, with replacement.
  template <class T>
  std::vector<T> drawn_from(const std::vector<T>& all) {
    std::vector<T> drawn;
    for (std::size_t k = 0; k < all.size(); ++k) {
      drawn.push_back(all[below(all.size())]);
    }
    return drawn;
  }

 private:
  std::uint64_t state_;
};

}  // namespace trials
