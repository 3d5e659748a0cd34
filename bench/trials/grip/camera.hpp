// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The camera of the simulated fingertip: noisy dots in px, and which of them are in contact.
#include <cstddef>
#include <random>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "slipping_load.hpp"

namespace grip {

class Camera {
 public:
  explicit Camera(int dots, unsigned seed = 1) : n_(dots), bits_(seed) {
    const auto cells = static_cast<std::size_t>(dots * dots);
    dots_.resize(cells);
    touch_.resize(cells);
  }

  void look_at(const SlippingLoad& load) {
    constexpr double px_per_mm = 12.5;
    std::normal_distribution<double> noise_px(0, 0.06);
    for (int k = 0; k < n_ * n_; ++k) {
      const auto to = static_cast<std::size_t>(k);
      const double x_mm = load.x_mm(k / n_, k % n_), y_mm = load.y_mm(k / n_, k % n_);
      dots_[to] = {static_cast<float>(320 + px_per_mm * x_mm + noise_px(bits_)),
                   static_cast<float>(240 + px_per_mm * y_mm + noise_px(bits_))};
      touch_[to] = load.touches(k / n_, k % n_) ? 255 : 0;
    }
  }

  fingerpad::StridedView<const fingerpad::Point2<float>> dots() const {
    return {dots_.data(), n_, n_, n_};
  }
  fingerpad::StridedView<const unsigned char> touch() const { return {touch_.data(), n_, n_, n_}; }

 private:
  int n_;
  std::mt19937 bits_;
  std::vector<fingerpad::Point2<float>> dots_;
  std::vector<unsigned char> touch_;
};

}  // namespace grip
