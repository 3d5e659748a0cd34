// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <string>
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

struct MeanOfSeeds {
  double sum = 0, squares = 0, count = 0;
  void add(double x) { sum += x, squares += x * x, count += 1; }
  double mean() const { return sum / count; }
  double sd() const { return std::sqrt((squares - sum * sum / count) / (count - 1)); }
};

/// An object that drags the membrane along while the stick disc shrinks from the whole contact to a
/// small rest. Dots outside the disc lag, the more the further they are from it.
struct Slipping {
  double noise_px = 0.06;
  double step_px = 0.5;
  int frames = 120;
  double last_radius = 2.5;  ///< of the stick disc, in pitches; 9: nothing slips
  int turns_at = 1000;       ///< frame from which it moves back
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
    const double step_px = t < s.turns_at ? s.step_px : -s.step_px;
    double stick = 0, all = 0;
    for (Index i = 0; i < 21; ++i) {
      for (Index j = 0; j < 21; ++j) {
        const double from = std::hypot(static_cast<double>(i) - 10.3, static_cast<double>(j) - 9.8);
        const double lag = std::clamp((from - radius) / 1.5, 0.0, 0.9);
        dots(i, j).x += step_px * (1 - lag);
        dots(i, j).y += 0.3 * step_px * (1 - lag);
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
  MeanOfSeeds errors;
  for (std::size_t t = 0; t < recording.dots.size(); ++t) {
    const auto result = stick(recording.dots[t], recording.contact);
    if (result.updated()) {
      errors.add(std::abs(result.stick_ratio - recording.truth[t]));
    }
  }
  return errors.mean();
}

/// Share of independent noise that remains in the mean over a dot and its neighbours, of which
/// `sides` and `diagonals` are there.
double denoising_gain(int sides, int diagonals) {
  return std::sqrt(36.0 + 4 * sides + diagonals) / (6 + 2 * sides + diagonals);
}

/// sigma as published: the largest standard deviation, over dots and axes, of a position relative
/// to the central dot.
double published_noise_px(const std::vector<Points>& frames) {
  double largest = 0;
  for (std::size_t k = 0; k < frames[0].cells.size(); ++k) {
    MeanOfSeeds x, y;
    for (const Points& dots : frames) {
      const auto off = dots.cells[k] - dots.cells[frames[0].cells.size() / 2];
      x.add(off.x);
      y.add(off.y);
    }
    largest = std::max({largest, k == frames[0].cells.size() / 2 ? 0 : x.sd(), y.sd()});
  }
  return largest;
}

std::vector<Points> standing(Index rows, Index cols, int frames, double noise_px, Random& random) {
  std::vector<Points> all;
  for (int t = 0; t < frames; ++t) {
    all.push_back(jittered(pattern(rows, cols), noise_px, random));
  }
  return all;
}

}  // namespace

TEST_CASE("noise of the dots: published is the noise of two dots", "[stick]") {
  Random random(1);
  const auto frames = standing(7, 7, 2000, 0.1, random);
  // the largest of 98 numbers, each known to 1.6 %
  CHECK(published_noise_px(frames) == Approx(0.1 * std::sqrt(2.0)).epsilon(0.06));
  StickRatio<> stick(7, 7);
  for (const Points& dots : frames) {
    (void)stick(dots, Flags(7, 7));
  }
  CHECK(stick.noise() == Approx(0.1).epsilon(0.1));  // of the latest 32
}

TEST_CASE("false slip: as often as drawn", "[stick]") {
  // sigma of one position; the difference of two frames; 4 sigma, as published
  Random random(11);
  const int draws = 400000;
  double beyond = 0, along_x = 0;
  for (int k = 0; k < draws; ++k) {
    const auto then = gaussian_pair(random), now = gaussian_pair(random);
    beyond += std::hypot(now.x - then.x, now.y - then.y) > 4 ? 1 : 0;
    along_x += std::abs(now.x) > 2 ? 1 : 0;
  }
  const double p = std::exp(-4.0);  // Rayleigh: exp(-r^2 / (4 sigma^2))
  CHECK(std::abs(beyond / draws - p) < 3 * std::sqrt(p / draws));
  // 95.44 % refers to one axis of one position
  CHECK(std::abs(along_x / draws - 0.0455) < 3 * std::sqrt(0.0455 / draws));
}

TEST_CASE("choice of U: the error hardly depends on it", "[stick]") {
  for (const double noise_px : {0.06, 0.14}) {
    const Recording recording = record({.noise_px = noise_px});
    const double slip_px = 2 * noise_px * denoising_gain(3, 2) * std::sqrt(-std::log(0.02));
    std::string table = "\n    U   error of the ratio\n";
    for (int k = noise_px < 0.1 ? 2 : 6; k < 13; k += 2) {
      const double reference_px = 0.5 * std::pow(2.0, k / 3.0);
      const double error = mean_error(recording, test::stick_options(reference_px, slip_px));
      char line[80];
      std::snprintf(line, sizeof line, "%5.2f  %.3f\n", reference_px, error);
      table += line;
      CHECK(error < 0.035);
    }
    INFO(noise_px << table);
    CHECK(true);
  }
}
