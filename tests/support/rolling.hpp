// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A ball that rolls over a grid of dots without slip. A dot sticks to the ball where the ball comes
// near it and moves rigidly with it until the contact has passed. The true pose is known exactly
// for any path.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "fingerpad/math/rigid_fit.hpp"
#include "fingerpad/math/rotation.hpp"
#include "image.hpp"

namespace test {

/// Gaussian numbers, the same on every platform.
class Gauss {
 public:
  explicit Gauss(std::uint64_t seed) : bits_(seed) {}
  double operator()() {
    const double u = std::ldexp(static_cast<double>(bits_() >> 11) + 1, -53);
    const double v = std::ldexp(static_cast<double>(bits_() >> 11), -53);
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }

 private:
  std::mt19937_64 bits_;
};

using Dots = Image<fingerpad::Point3<double>>;
using Flags = Image<unsigned char>;

/// The rotation by the vector `turn` (axis times angle).
inline fingerpad::Rotation<double> turned_by(const fingerpad::Point3<double>& turn) {
  const double angle = std::sqrt(squared_norm(turn));
  const double half = angle / 2;
  const double s = angle > 0 ? std::sin(half) / angle : 0.5;
  return fingerpad::detail::motion::rotation_of_quaternion<double>(
      {std::cos(half), s * turn.x, s * turn.y, s * turn.z});
}

struct RollingBall {
  std::ptrdiff_t rows = 21;
  std::ptrdiff_t cols = 21;
  double pitch_mm = 1.5;
  double radius_mm = 18;  ///< of the ball
  double patch_mm = 5;    ///< radius of the contact
  double depth_mm = 10;   ///< of the contact's center
  double free_mm = 12.5;  ///< depth of the free membrane

  Dots initial() const {
    Dots dots(rows, cols);
    for (std::ptrdiff_t i = 0; i < rows; ++i) {
      for (std::ptrdiff_t j = 0; j < cols; ++j) {
        dots(i, j) = {pitch_mm * static_cast<double>(j - cols / 2),
                      pitch_mm * static_cast<double>(i - rows / 2), free_mm};
      }
    }
    return dots;
  }
};

/// The rolling ball; step() moves the center of the contact to (x, y).
class Rolling {
 public:
  Rolling(const RollingBall& ball, double x_mm, double y_mm)
      : dots(ball.initial()),
        contact(ball.rows, ball.cols, 0),
        ball_(ball),
        free_(ball.initial()),
        on_ball_(ball.initial()),
        x_(x_mm),
        y_(y_mm) {
    touch();
  }

  void step(double x_mm, double y_mm) {
    using namespace fingerpad;
    const double dx = x_mm - x_;
    const double dy = y_mm - y_;
    // The ball lies above the membrane: its lowest point rests while its center moves on.
    const Rotation<double> turn = turned_by({-dy / ball_.radius_mm, dx / ball_.radius_mm, 0});
    const Point3<double> center{x_, y_, ball_.depth_mm + ball_.radius_mm};
    const Point3<double> next{x_mm, y_mm, ball_.depth_mm + ball_.radius_mm};
    const Pose<double> motion{turn, next - turn(center)};
    pose = motion * pose;
    x_ = x_mm;
    y_ = y_mm;
    touch();
  }

  Dots dots;
  Flags contact;
  fingerpad::Pose<double> pose;  ///< of the ball since the start

 private:
  void touch() {
    for (std::ptrdiff_t i = 0; i < dots.rows(); ++i) {
      for (std::ptrdiff_t j = 0; j < dots.cols(); ++j) {
        const auto& f = free_(i, j);
        const double d_sq = (f.x - x_) * (f.x - x_) + (f.y - y_) * (f.y - y_);
        const bool touches = d_sq < ball_.patch_mm * ball_.patch_mm;
        const double r = ball_.radius_mm;
        if (touches && contact(i, j) == 0) {
          const fingerpad::Point3<double> surface{f.x, f.y,
                                                  ball_.depth_mm + r - std::sqrt(r * r - d_sq)};
          on_ball_(i, j) = inverse(pose)(surface);
        }
        contact(i, j) = touches ? 1 : 0;
        dots(i, j) = touches ? pose(on_ball_(i, j)) : f;
      }
    }
  }

  RollingBall ball_;
  Dots free_;
  Dots on_ball_;
  double x_;
  double y_;
};

/// Dots with the noise of a camera. Dots without a flag have none, because nothing reads them.
inline Dots noisy(
    Dots dots, const Flags& flags, Gauss& gauss, double plane_mm = 0.02, double depth_mm = 0.05) {
  for (std::size_t k = 0; k < dots.cells.size(); ++k) {
    if (flags.cells[k] != 0) {
      auto& p = dots.cells[k];
      p = {p.x + plane_mm * gauss(), p.y + plane_mm * gauss(), p.z + depth_mm * gauss()};
    }
  }
  return dots;
}

inline constexpr double degree = std::numbers::pi / 180;

inline double error_deg(const fingerpad::Rotation<double>& a,
                        const fingerpad::Rotation<double>& b) {
  return angle_between(a, b) / degree;
}

inline Dots rotated(Dots dots, const fingerpad::Pose<double>& pose) {
  for (auto& p : dots.cells) {
    p = pose(p);
  }
  return dots;
}

/// 7 x 7 dots of a free pad.
inline Dots small_grid() {
  return RollingBall{.rows = 7, .cols = 7}.initial();
}

}  // namespace test
