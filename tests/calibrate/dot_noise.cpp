// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/dot_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"
#include "support/slipping_dots.hpp"

using namespace fingerpad;
using test::begins_with;
using test::Image;
using test::Random;
using test::refusal;

namespace {

using Points = Image<Point2<double>>;
using Flags = Image<unsigned char>;

constexpr double pitch_px = 19.5;
constexpr double infinity = std::numeric_limits<double>::infinity();

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

Points moved(Points dots, double x_px, double y_px) {
  for (auto& p : dots.cells) {
    p = {p.x + x_px, p.y + y_px};
  }
  return dots;
}

void lose(Points& dots, double share, Random& random) {
  for (auto& p : dots.cells) {
    p.x = random.uniform() < share ? test::nan : p.x;
  }
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
  double error() const { return sd() / std::sqrt(count); }
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

TEST_CASE("dot noise: found again, whatever is lost and however the camera shakes", "[stick]") {
  for (const double noise_px : {0.03, 0.14}) {
    for (const double lost : {0.0, 0.3}) {
      for (const Index size : {Index(5), Index(21)}) {
        MeanOfSeeds noise, claimed;
        for (std::uint64_t seed = 1; seed <= 12; ++seed) {
          Random random(seed);
          std::vector<Points> frames;
          for (int t = 0; t < 12; ++t) {
            auto dots = jittered(pattern(size, size + 1), noise_px, random);
            dots = moved(dots, random.uniform(-3, 3), random.uniform(-3, 3));
            lose(dots, lost, random);
            frames.push_back(dots);
          }
          const DotNoise<> found = dot_noise(frames);
          CHECK(found.ok());
          CHECK(found.dots == size * (size + 1));
          CHECK(std::abs(found.slow_share) < 0.25);
          noise.add(found.noise_px);
          claimed.add(found.noise_error_px);
        }
        CAPTURE(noise_px, lost, size, noise.mean(), noise.error(), claimed.mean());
        CHECK(std::abs(noise.mean() - noise_px) < 2 * claimed.mean() / std::sqrt(12.0));
        // the spread over 12 seeds is itself known only to 21 %
        CHECK(noise.sd() / claimed.mean() < 1.6);
        CHECK(noise.sd() / claimed.mean() > 0.5);
      }
    }
  }
}

TEST_CASE("dot noise: a few dots in a few frames have no bias", "[stick]") {
  // of 9 dots in 3 frames, positions and motion take 11 of 27 numbers
  for (const bool lost : {false, true}) {
    MeanOfSeeds noise;
    for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
      Random random(seed);
      std::vector<Points> frames;
      for (int t = 0; t < 3; ++t) {
        auto dots = moved(jittered(pattern(3, 3), 0.1, random), random.uniform(-3, 3), 0);
        dots(t, 0).x = lost ? test::nan : dots(t, 0).x;
        dots(2, 2).y = lost && t > 0 ? test::nan : dots(2, 2).y;  // seen once: no information
        frames.push_back(dots);
      }
      noise.add(square(dot_noise(frames).noise_px));
    }
    CAPTURE(lost, noise.mean(), noise.error());
    CHECK(std::abs(noise.mean() - 0.01) < 2.5 * noise.error());
  }
}

TEST_CASE("dot noise: its standard error is the scatter, with many frames as well", "[stick]") {
  MeanOfSeeds noise, claimed;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const DotNoise<> found = dot_noise(standing(4, 5, 40, 0.1, random));
    noise.add(found.noise_px);
    claimed.add(found.noise_error_px);
  }
  CAPTURE(noise.sd(), claimed.mean());
  CHECK(noise.sd() / claimed.mean() == Approx(1).margin(0.12));  // known to 4 %
}

TEST_CASE("dot noise: published is the noise of two dots", "[stick]") {
  Random random(1);
  const auto frames = standing(7, 7, 2000, 0.1, random);
  // the largest of 98 numbers, each known to 1.6 %
  CHECK(published_noise_px(frames) == Approx(0.1 * std::sqrt(2.0)).epsilon(0.06));
  CHECK(dot_noise(frames).noise_px == Approx(0.1).epsilon(0.005));
}

TEST_CASE("dot noise: units do not matter", "[stick]") {
  const auto noise_in = [](double unit) {
    Random random(3);
    auto frames = standing(7, 7, 50, 0.1, random);
    for (auto& dots : frames) {
      for (auto& p : dots.cells) {
        p = unit * p;
      }
    }
    return dot_noise(frames).noise_px;
  };
  for (const double unit : {1.0 / 64, 64.0}) {
    CHECK(noise_in(unit) == Approx(unit * noise_in(1)).epsilon(1e-9));
  }
}

TEST_CASE("dot noise: a dot out of place is left out, in a single row or column as well",
          "[stick]") {
  for (const bool row : {false, true}) {
    const auto noise_with = [&](double off_px) {
      Random random(4);
      auto frames = standing(row ? 1 : 8, row ? 8 : 1, 50, 0.1, random);
      frames[20].cells[3].x += off_px;
      return dot_noise(frames).noise_px;
    };
    CHECK(noise_with(0.4 * pitch_px) == Approx(noise_with(0)).epsilon(0.01));
  }
}

TEST_CASE("dot noise: exchanged dots are left out, slow motion is said", "[stick]") {
  const auto measured = [](bool exchange, double drift_px, bool only_contact) {
    Random random(8);
    auto frames = standing(15, 15, 30, 0.1, random);
    const Flags contact = disc(15, 15, 5);
    for (std::size_t t = 0; t < frames.size(); ++t) {
      Points& dots = frames[t];
      for (Index j = 0; j < 15; ++j) {
        dots(2, j).x += drift_px * static_cast<double>(t) * static_cast<double>(j);
      }
      if (exchange && t % 10 == 3) {
        std::swap(dots(4, 4), dots(9, 9));
        dots(7, 7) = {infinity, 0};
        dots(8, 7) = {1e30, 1e30};
      }
      for (std::size_t k = 0; only_contact && k < dots.cells.size(); ++k) {
        dots.cells[k].x = contact.cells[k] ? dots.cells[k].x : test::nan;
      }
    }
    return dot_noise(frames);
  };
  const DotNoise<> good = measured(false, 0, false), bad = measured(true, 0, false);
  CHECK(bad.noise_px == Approx(good.noise_px).epsilon(0.01));
  CHECK(std::abs(good.slow_share) < 0.05);
  const DotNoise<> creeping = measured(false, 0.005, false);
  CHECK(creeping.noise_px > 1.15 * good.noise_px);
  CHECK(creeping.slow_share ==
        Approx(1 - std::pow(good.noise_px / creeping.noise_px, 2)).margin(0.05));
  CHECK(measured(false, 0.005, true).noise_px == Approx(0.1).epsilon(0.05));  // row 2 is outside
  CHECK(measured(false, 0, true).dots == 69);
}

TEST_CASE("dot noise: what it refuses", "[stick]") {
  const auto said = [](const std::vector<Points>& frames) {
    return refusal([&] { (void)dot_noise(frames); });
  };
  Random random(1);
  const Points found = jittered(pattern(3, 3), 0.1, random);
  const Points nothing(3, 3, {test::nan, test::nan});
  CHECK(begins_with(said({}), "dot_noise: frames = 0"));
  CHECK(begins_with(said({found}), "dot_noise: frames = 1"));
  CHECK(begins_with(said({found, Points(3, 4)}), "dot_noise: rows = 3, must be those of the"));
  CHECK(begins_with(said({Points(0, 3), Points(0, 3)}), "dot_noise: rows = 0"));
  CHECK(begins_with(said({Points(3, 0), Points(3, 0)}), "dot_noise: cols = 0"));
  CHECK(begins_with(said({nothing, nothing, nothing}), "dot_noise: dots = 0"));
  CHECK(begins_with(said({found, nothing, nothing}),
                    "dot_noise: degrees of freedom of the positions = "));
  CHECK(begins_with(said({found, nothing, found}),
                    "dot_noise: noise_px = 0, must be > 0: the frames are identical"));
  CHECK(said({found, jittered(found, 0.1, random)}) == "accepted");

  // two dots that are never in the same frame cannot be compared
  std::vector<Points> apart;
  for (int t = 0; t < 6; ++t) {
    apart.push_back(jittered(pattern(1, 2), 0.1, random));
    apart.back()(0, t % 2).y = test::nan;
  }
  CHECK(begins_with(said(apart), "dot_noise: degrees of freedom of the positions = "));
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
