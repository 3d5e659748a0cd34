// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pad.hpp"
#include "support/slipping_dots.hpp"

using namespace fingerpad;
using test::Image;
using test::Random;

namespace {

using Points = Image<Point2<double>>;
using Flags = Image<unsigned char>;

constexpr double pitch_px = 19.5;

/// Gaussian up to the far tail, unlike a sum of uniform numbers.
Point2<double> gaussian_pair(Random& random) {
  const double length = std::sqrt(-2 * std::log(1 - random.uniform()));
  const double angle = 2 * std::numbers::pi * random.uniform();
  return {length * std::cos(angle), length * std::sin(angle)};
}

Points pattern(Index rows, Index cols) {
  Points dots(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      dots(i, j) = {100 + pitch_px * static_cast<double>(j),
                    50 + pitch_px * static_cast<double>(i)};
    }
  }
  return dots;
}

Points jittered(Points dots, double noise_px, Random& random) {
  for (auto& p : dots.cells) {
    const auto off = gaussian_pair(random);
    p = {p.x + noise_px * off.x, p.y + noise_px * off.y};
  }
  return dots;
}

Flags disc(Index rows, Index cols, double radius) {
  Flags contact(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double row = static_cast<double>(i) - static_cast<double>(rows - 1) / 2;
      const double col = static_cast<double>(j) - static_cast<double>(cols - 1) / 2;
      contact(i, j) = std::hypot(row, col) < radius;
    }
  }
  return contact;
}

/// An object that drags the membrane along while the stick disc shrinks from the whole contact to a
/// small rest. Dots outside the disc lag, the more the further they are from it.
struct Slipping {
  double noise_px = 0.06;
  double step_px = 0.5;
  int frames = 120;
  double last_radius = 2.5;  ///< of the stick disc, in pitches; 9: nothing slips
  std::uint64_t seed = 3;
};

struct Recording {
  std::vector<Points> dots;
  std::vector<double> truth;
  Flags contact = disc(21, 21, 8.2);
};

Recording record(const Slipping& s) {
  Recording recording;
  Random random(s.seed);
  Points dots = pattern(21, 21);
  for (int t = 0; t < s.frames; ++t) {
    const double share = std::clamp(4.0 * t / (3.0 * s.frames) - 0.2, 0.0, 1.0);
    const double radius = 9 + share * (s.last_radius - 9);
    double stick = 0, all = 0;
    for (Index i = 0; i < 21; ++i) {
      for (Index j = 0; j < 21; ++j) {
        const double from = std::hypot(static_cast<double>(i) - 10.3, static_cast<double>(j) - 9.8);
        const double lag = std::clamp((from - radius) / 1.5, 0.0, 0.9);
        dots(i, j).x += s.step_px * (1 - lag);
        dots(i, j).y += 0.3 * s.step_px * (1 - lag);
        all += recording.contact(i, j) ? 1 : 0;
        stick += recording.contact(i, j) && !(lag > 0) ? 1 : 0;
      }
    }
    recording.dots.push_back(jittered(dots, s.noise_px, random));
    recording.truth.push_back(stick / all);
  }
  return recording;
}

/// Mean error of the ratio over the frames with an update.
double mean_error(const Recording& recording, const StickOptions& options) {
  StickRatio<> stick(21, 21, options);
  double sum = 0, count = 0;
  for (std::size_t t = 0; t < recording.dots.size(); ++t) {
    const auto result = stick(recording.dots[t], recording.contact);
    if (result.updated()) {
      sum += std::abs(result.stick_ratio - recording.truth[t]);
      count += 1;
    }
  }
  return sum / count;
}

/// Share of independent noise that remains in the mean over a dot and its neighbours, of which
/// `sides` and `diagonals` are there.
double denoising_gain(int sides, int diagonals) {
  return std::sqrt(36.0 + 4 * sides + diagonals) / (6 + 2 * sides + diagonals);
}

}  // namespace

TEST_CASE("choice of U: the error hardly depends on it", "[stick]") {
  for (const double noise_px : {0.06, 0.14}) {
    const Recording recording = record({.noise_px = noise_px});
    const double slip_px = 2 * noise_px * denoising_gain(3, 2) * std::sqrt(-std::log(0.02));
    for (int k = noise_px < 0.1 ? 2 : 6; k < 13; k += 2) {
      const double reference_px = 0.5 * std::pow(2.0, k / 3.0);
      CAPTURE(noise_px, reference_px);
      CHECK(mean_error(recording, test::stick_options(reference_px, slip_px)) < 0.035);
    }
  }
}
