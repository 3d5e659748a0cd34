// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The stick ratio as the slides state it, step by step over vectors of points in double: what the
// library's speed and error are compared with. All dots are there.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace bench {

struct NaivePoint {
  double x, y;
};

class NaiveStickRatio {
 public:
  /// `contact`: which dots touch the object, in all frames; the central one must.
  NaiveStickRatio(int rows, int cols, int capacity, std::vector<bool> contact)
      : rows_(rows), cols_(cols), capacity_(capacity), contact_(std::move(contact)) {}

  /// How many frames ago the reference of the last answer was; 0: the last frame had none.
  int reference_age() const { return age_; }

  /// The ratio, or the last one where no stored frame will do.
  double operator()(const std::vector<NaivePoint>& given) {
    const std::vector<NaivePoint> now = denoised(given);
    std::vector<double> furthest;
    for (const auto& stored : repository_) {
      double d_max = 0;
      for (std::size_t k = 0; k < now.size(); ++k) {
        d_max = contact_[k] ? std::max(d_max, distance(now[k], stored.dots[k])) : d_max;
      }
      furthest.push_back(d_max);
    }
    ++frame_;
    age_ = 0;
    const int newest = static_cast<int>(furthest.size()) - 1;
    int rotated = std::max(newest, 0);  // i_C
    while (rotated > 0 && at(furthest, rotated - 1) > at(furthest, rotated)) {
      --rotated;
    }
    for (int i = newest; i >= rotated; --i) {
      if (at(furthest, i) > 2.0) {
        const Stored& reference = repository_[static_cast<std::size_t>(i)];
        ratio_ = ratio_against(now, reference.dots);
        age_ = frame_ - reference.frame;
        break;
      }
    }
    if (newest < 0 || at(furthest, newest) > 0.5) {
      repository_.push_back({frame_, now});
      if (static_cast<int>(repository_.size()) > capacity_) {
        repository_.erase(repository_.begin());
      }
    }
    return ratio_;
  }

 private:
  struct Stored {
    int frame;
    std::vector<NaivePoint> dots;
  };

  static double at(const std::vector<double>& v, int i) { return v[static_cast<std::size_t>(i)]; }
  static double distance(const NaivePoint& a, const NaivePoint& b) {
    return std::hypot(a.x - b.x, a.y - b.y);
  }
  std::size_t cell(int row, int col) const { return static_cast<std::size_t>(row * cols_ + col); }

  std::vector<NaivePoint> denoised(const std::vector<NaivePoint>& p) const {
    std::vector<NaivePoint> out = p;
    for (int i = 1; i + 1 < rows_; ++i) {
      for (int j = 1; j + 1 < cols_; ++j) {
        NaivePoint sum{0, 0};
        double weights = 0;
        for (int m = -1; m <= 1; ++m) {
          for (int n = -1; n <= 1; ++n) {
            const double w = m == 0 && n == 0 ? 6 : m == 0 || n == 0 ? 2 : 1;
            sum.x += w * p[cell(i + m, j + n)].x;
            sum.y += w * p[cell(i + m, j + n)].y;
            weights += w;
          }
        }
        out[cell(i, j)] = {sum.x / weights, sum.y / weights};
      }
    }
    return out;
  }

  double ratio_against(std::vector<NaivePoint> now, const std::vector<NaivePoint>& then) const {
    const int row = rows_ / 2, col = cols_ / 2;
    const std::size_t center = cell(row, col);
    double theta = 0;
    for (const auto& [m, n] : {std::pair{0, -1}, {0, 1}, {-1, 0}, {1, 0}}) {
      const std::size_t k = cell(row + m, col + n);
      const double angle_now = std::atan2(now[k].y - now[center].y, now[k].x - now[center].x);
      const double angle_then = std::atan2(then[k].y - then[center].y, then[k].x - then[center].x);
      theta += std::remainder(angle_now - angle_then, 2 * std::numbers::pi) / 4;
    }
    const NaivePoint about = now[center];
    for (auto& p : now) {
      const double x = p.x - about.x, y = p.y - about.y;
      p = {std::cos(theta) * x + std::sin(theta) * y + about.x,
           -std::sin(theta) * x + std::cos(theta) * y + about.y};
    }
    double across_then = 0, across_now = 0;
    for (int i = 0; i + 1 < rows_; ++i) {
      for (int j = 1; j + 1 < cols_; ++j) {
        for (const auto& [n, m] : {std::pair{-1, 1}, {0, 1}, {1, 1}, {1, 0}}) {
          const std::size_t a = cell(i, j), b = cell(i + m, j + n);
          NaivePoint q{now[a].x - then[a].x + now[b].x - then[b].x,
                       now[a].y - then[a].y + now[b].y - then[b].y};
          const double length = std::hypot(q.x, q.y);
          if (contact_[a] && contact_[b] && length > 1e-9) {
            q = {q.x / length, q.y / length};
            across_then += std::abs((then[a].x - then[b].x) * q.y - (then[a].y - then[b].y) * q.x);
            across_now += std::abs((now[a].x - now[b].x) * q.y - (now[a].y - now[b].y) * q.x);
          }
        }
      }
    }
    const double alpha = across_now > 0 ? across_then / across_now : 1;
    std::vector<NaivePoint> moved;
    double d_max = 0;
    for (std::size_t k = 0; k < now.size(); ++k) {
      moved.push_back(
          {alpha * (now[k].x - 320) + 320 - then[k].x, alpha * (now[k].y - 240) + 240 - then[k].y});
      d_max = contact_[k] ? std::max(d_max, std::hypot(moved[k].x, moved[k].y)) : d_max;
    }
    int sticking = 0, touching = 0;
    for (std::size_t k = 0; k < moved.size(); ++k) {
      const bool sticks = distance(moved[k], moved[center]) < 0.24 * d_max / 2.0;
      sticking += contact_[k] && sticks ? 1 : 0;
      touching += contact_[k] ? 1 : 0;
    }
    return static_cast<double>(sticking) / touching;
  }

  int rows_, cols_, capacity_;
  std::vector<bool> contact_;
  double ratio_ = 1;
  int frame_ = 0;
  int age_ = 0;
  std::vector<Stored> repository_;
};

}  // namespace bench
