// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/slip.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/published/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::begins_with;
using test::Digits50;
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

template <class Calibration>
void add(const Recording& recording, Calibration& calibration) {
  bool all = true;
  for (const Points& dots : recording.dots) {
    all = calibration.add(dots, recording.contact) && all;
  }
  CHECK(all);
}

const StickTestFit::Row& chosen_row(const StickTestFit& choice) {
  for (const StickTestFit::Row& row : choice.table) {
    if (row.chosen) {
      return row;
    }
  }
  throw std::string("no row is chosen");
}

/// Mean error of the ratio over the frames with an update.
double mean_error(const Recording& recording, const StickTest& test) {
  const StickRatio<> estimator(21, 21, test);
  auto state = estimator.start();
  Image<DotState> states(21, 21);
  MeanOfSeeds errors;
  for (std::size_t t = 0; t < recording.dots.size(); ++t) {
    const auto result = estimator(recording.dots[t], recording.contact, states, state);
    if (result.updated()) {
      errors.add(std::abs(static_cast<double>(result.stick_ratio) - recording.truth[t]));
    }
  }
  return errors.mean();
}

published::RatioMeasures measures(const std::vector<double>& ratios) {
  return published::measures_of(std::span<const double>(ratios));
}

}  // namespace

TEST_CASE("dot noise: found again, whatever is lost and however the camera shakes", "[stick]") {
  for (const double noise_px : {0.03, 0.14}) {
    for (const double lost : {0.0, 0.3}) {
      for (const Index size : {Index(5), Index(21)}) {
        MeanOfSeeds noise, inner, edge, claimed, claimed_edge;
        for (std::uint64_t seed = 1; seed <= 12; ++seed) {
          Random random(seed);
          DotNoiseCalibration calibration(size, size + 1);
          for (int t = 0; t < 12; ++t) {
            auto dots = jittered(pattern(size, size + 1), noise_px, random);
            dots = moved(dots, random.uniform(-3, 3), random.uniform(-3, 3));
            lose(dots, lost, random);
            CHECK(calibration.add(dots));
          }
          const DotNoise found = calibration.fit();
          CHECK(found.frames == 12);
          CHECK(found.out_of_place == 0);
          CHECK(found.dots == size * (size + 1));
          CHECK(std::abs(found.slow_share) < 0.25);
          noise.add(found.noise_px);
          claimed.add(found.noise_error_px);
          claimed_edge.add(found.edge_error_px);
          if (lost == 0) {
            inner.add(found.inner_px);
            edge.add(found.edge_px);
          }
        }
        CAPTURE(noise_px, lost, size, noise.mean(), noise.error(), claimed.mean());
        CHECK(std::abs(noise.mean() - noise_px) < 2 * claimed.mean() / std::sqrt(12.0));
        // the spread over 12 seeds is itself known only to 21 %
        CHECK(noise.sd() / claimed.mean() < 1.6);
        CHECK(noise.sd() / claimed.mean() > 0.5);
        if (lost == 0) {
          CHECK(edge.sd() / claimed_edge.mean() < 1.6);
          CHECK(edge.sd() / claimed_edge.mean() > 0.5);
          CHECK(std::abs(inner.mean() - noise_px * denoising_gain({})) < 2.5 * inner.error());
          const double sides =
              static_cast<double>(4 * size - 6);  // of the pattern, without corners
          const double at_edge = (sides * std::pow(denoising_gain({}, 3, 2), 2) +
                                  4 * std::pow(denoising_gain({}, 2, 1), 2)) /
                                 (sides + 4);
          CHECK(std::abs(edge.mean() - noise_px * std::sqrt(at_edge)) < 2.5 * edge.error());
        }
      }
    }
  }
}

TEST_CASE("dot noise: a few dots in a few frames have no bias", "[stick]") {
  // of 9 dots in 3 frames, positions and motion take 11 of 27 numbers
  for (const bool lost : {false, true}) {
    MeanOfSeeds noise, inner, edge, largest;
    for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
      Random random(seed);
      DotNoiseCalibration calibration(3, 3);
      for (int t = 0; t < 3; ++t) {
        auto dots = moved(jittered(pattern(3, 3), 0.1, random), random.uniform(-3, 3), 0);
        dots(t, 0).x = lost ? test::nan : dots(t, 0).x;
        dots(2, 2).y = lost && t > 0 ? test::nan : dots(2, 2).y;  // seen once: no information
        calibration.add(dots);
      }
      const DotNoise found = calibration.fit();
      noise.add(found.noise_px * found.noise_px);
      inner.add(found.inner_px * found.inner_px);
      edge.add(found.edge_px * found.edge_px);
      largest.add(found.largest_px * found.largest_px);
    }
    CAPTURE(lost, noise.mean(), noise.error());
    CHECK(std::abs(noise.mean() - 0.01) < 2.5 * noise.error());
    if (!lost) {
      const auto variance = [](int sides, int diagonals) {
        return 0.01 * std::pow(denoising_gain({}, sides, diagonals), 2);
      };
      CHECK(std::abs(inner.mean() - variance(4, 4)) < 2.5 * inner.error());
      CHECK(std::abs(edge.mean() - (variance(3, 2) + variance(2, 1)) / 2) < 2.5 * edge.error());
    }
    CHECK(largest.mean() > noise.mean());
  }
}

TEST_CASE("dot noise: what averaging leaves", "[stick]") {
  CHECK(denoising_gain({6, 2, 1}) == Approx(std::sqrt(36.0 + 16 + 4) / 18));
  CHECK(denoising_gain({1, 1, 1}) == Approx(1.0 / 3));
  CHECK(denoising_gain({1, 0, 0}) == 1);
  CHECK(denoising_gain({6, 2, 1}, 0, 0) == 1);
  CHECK(denoising_gain({6, 2, 1}, 3, 2) == Approx(std::sqrt(36.0 + 12 + 2) / 14));
  CHECK(independent_dot_noise(0.1).gain() == Approx(denoising_gain({})));

  // noise shared by neighbours averages out less: of a mean over three dots in a row, a mean over
  // nine keeps 9 sqrt(19 3) / 81 of 1/sqrt(3)
  Random random(4);
  DotNoiseCalibration calibration(40, 40, {1, 1, 1});
  for (int t = 0; t < 20; ++t) {
    const auto source = jittered(Points(40, 42), 0.2, random);
    Points dots = pattern(40, 40);
    for (Index i = 0; i < 40; ++i) {
      for (Index j = 0; j < 40; ++j) {
        for (Index k = 0; k < 3; ++k) {
          dots(i, j).x += source(i, j + k).x / 3;
          dots(i, j).y += source(i, j + k).y / 3;
        }
      }
    }
    calibration.add(dots);
  }
  const DotNoise noise = calibration.fit();
  CHECK(noise.noise_px == Approx(0.2 / std::sqrt(3.0)).epsilon(0.01));
  CHECK(noise.gain() == Approx(std::sqrt(3.0 * 19) / 27 * std::sqrt(3.0)).epsilon(0.02));
}

TEST_CASE("dot noise: averages along an edge share noise", "[stick]") {
  // correlation of two averages `apart` dots apart: the products of the weights that both have
  const auto shared = [](const DotWeights& w) {
    const auto weight = [&](int row, int col) {
      const bool near = (row == 0 || row == 1) && col >= -1 && col <= 1;
      return !near                  ? 0.0
             : row == 0 && col == 0 ? w.self
             : row == 0 || col == 0 ? w.side
                                    : w.diagonal;
    };
    const auto product = [&](int apart) {
      double sum = 0;
      for (int row = 0; row <= 1; ++row) {
        for (int col = -1; col <= 1; ++col) {
          sum += weight(row, col) * weight(row, col - apart);
        }
      }
      return sum;
    };
    double squares = 0;
    for (int apart = -3; apart <= 3; ++apart) {
      squares += square(product(apart) / product(0));
    }
    return squares;
  };
  for (const DotWeights& w : {DotWeights{6, 2, 1}, DotWeights{1, 1, 1}, DotWeights{3, 0, 2},
                              DotWeights{5, 2, 0}, DotWeights{1, 0, 0}}) {
    CHECK(detail::stick::shared_along_edge(w) == Approx(shared(w)).epsilon(1e-14));
  }
}

TEST_CASE("dot noise: the published measure holds the noise of two dots", "[stick]") {
  // noise of the central dot and of the worst of the others, here the corners
  MeanOfSeeds published, largest;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    DotNoiseCalibration calibration(7, 7);
    for (int t = 0; t < 400; ++t) {
      auto dots = jittered(pattern(7, 7), 0.1, random);
      for (const Index i : {0, 6}) {
        for (const Index j : {0, 6}) {
          const auto more = gaussian_pair(random);
          dots(i, j).x += 0.3 * more.x;
          dots(i, j).y += 0.3 * more.y;
        }
      }
      calibration.add(moved(dots, random.uniform(-1, 1), 0));
    }
    published.add(calibration.fit().published_px);
    largest.add(calibration.fit().largest_px);
  }
  // the largest of eight numbers, each known to 3.5 %
  CHECK(published.mean() == Approx(1.05 * std::sqrt(0.01 + 0.1)).epsilon(0.04));
  CHECK(largest.mean() == Approx(1.025 * std::sqrt(0.01 + 0.09)).epsilon(0.04));

  Random random(1);
  DotNoiseCalibration alike(7, 7);
  for (int t = 0; t < 2000; ++t) {
    alike.add(jittered(pattern(7, 7), 0.1, random));
  }
  CHECK(alike.fit().published_px == Approx(0.1 * std::sqrt(2.0)).epsilon(0.05));
  CHECK(alike.fit().published_px / alike.fit().largest_px > 1.3);
}

TEST_CASE("dot noise: the central dot is one found in more than half of the frames", "[stick]") {
  // The middle dot and a corner shake, the others hardly. Relative to the middle dot, both add up.
  const auto published = [](int found) {
    Random random(12);
    DotNoiseCalibration calibration(3, 3);
    for (int t = 0; t < 400; ++t) {
      Points dots = jittered(pattern(3, 3), 0.01, random);
      for (Point2<double>* dot : {&dots(0, 0), &dots(1, 1)}) {
        const auto off = gaussian_pair(random);
        *dot = {dot->x + 0.3 * off.x, dot->y + 0.3 * off.y};
      }
      dots(1, 1).x = t < found ? dots(1, 1).x : test::nan;
      calibration.add(dots);
    }
    return calibration.fit().published_px;
  };
  // the largest of four or two numbers, each known to 5 %
  CHECK(published(201) == Approx(1.03 * 0.3 * std::sqrt(2.0)).epsilon(0.08));
  CHECK(published(200) == Approx(1.03 * 0.3).epsilon(0.08));
}

TEST_CASE("dot noise: units do not matter", "[stick]") {
  const auto noise_in = [](double unit) {
    Random random(3);
    DotNoiseCalibration calibration(7, 7);
    for (int t = 0; t < 50; ++t) {
      auto dots = jittered(pattern(7, 7), 0.1, random);
      for (auto& p : dots.cells) {
        p = {unit * p.x, unit * p.y};
      }
      calibration.add(dots);
    }
    return calibration.fit();
  };
  const auto in_px = noise_in(1);
  for (const double unit : {1.0 / 64, 64.0}) {
    const auto fit = noise_in(unit);
    CHECK(fit.published_px == Approx(unit * in_px.published_px).epsilon(1e-9));
    CHECK(fit.largest_px == Approx(unit * in_px.largest_px).epsilon(1e-9));
  }
}

TEST_CASE("dot noise: a dot out of place is found in a single row or column as well", "[stick]") {
  for (const bool row : {false, true}) {
    Random random(4);
    const Index rows = row ? 1 : 8, cols = row ? 8 : 1;
    DotNoiseCalibration calibration(rows, cols);
    for (int t = 0; t < 50; ++t) {
      auto dots = jittered(pattern(rows, cols), 0.1, random);
      if (t == 20) {
        dots.cells[3].x += 0.4 * pitch_px;
      }
      calibration.add(dots);
    }
    CHECK(calibration.fit().out_of_place == 1);
  }
}

TEST_CASE("dot noise: exchanged dots are left out, slow motion is said", "[stick]") {
  const auto measured = [](bool exchange, double drift_px, bool only_contact) {
    Random random(8);
    DotNoiseCalibration calibration(15, 15);
    const Flags contact = disc(15, 15, 5);
    for (int t = 0; t < 30; ++t) {
      auto dots = jittered(pattern(15, 15), 0.1, random);
      for (Index j = 0; j < 15; ++j) {
        dots(2, j).x += drift_px * t * static_cast<double>(j);
      }
      if (exchange && t % 10 == 3) {
        std::swap(dots(4, 4), dots(9, 9));
        dots(7, 7) = {infinity, 0};
        dots(8, 7) = {1e30, 1e30};
      }
      CHECK((only_contact ? calibration.add(dots, contact) : calibration.add(dots)));
    }
    return calibration.fit();
  };
  const DotNoise good = measured(false, 0, false), bad = measured(true, 0, false);
  CHECK(good.out_of_place == 0);
  CHECK(bad.out_of_place == 6);  // two in three frames; an invalid position counts as not found
  CHECK(bad.noise_px == Approx(good.noise_px).epsilon(0.01));
  CHECK(bad.largest_px < 1.3 * 0.1);
  CHECK(std::abs(good.slow_share) < 0.05);
  const DotNoise creeping = measured(false, 0.005, false);
  CHECK(creeping.noise_px > 1.2 * good.noise_px);
  CHECK(creeping.slow_share ==
        Approx(1 - std::pow(good.noise_px / creeping.noise_px, 2)).margin(0.05));
  CHECK(measured(false, 0.005, true).noise_px == Approx(0.1).epsilon(0.05));  // row 2 is outside
  CHECK(measured(false, 0, true).dots == 69);
}

TEST_CASE("dot noise: what it refuses", "[stick]") {
  CHECK(begins_with(refusal([] { DotNoiseCalibration<>(0, 3); }), "DotNoiseCalibration: rows = 0"));
  CHECK(
      begins_with(refusal([] { DotNoiseCalibration<>(3, -1); }), "DotNoiseCalibration: cols = -1"));
  CHECK(begins_with(refusal([] {
                      DotNoiseCalibration<>(3, 3, {0, 1, 1});
                    }),
                    "DotNoiseCalibration: weights.self = 0"));
  DotNoiseCalibration calibration(3, 3);
  const auto said = [&] { return refusal([&] { (void)calibration.fit(); }); };
  CHECK(begins_with(said(), "DotNoiseCalibration: frames = 0"));
  CHECK_FALSE(calibration.add(Points(3, 4)));
  CHECK_FALSE(calibration.add(Points(3, 3), Flags(3, 4, 1)));
  CHECK(begins_with(said(), "DotNoiseCalibration: frames = 0"));
  Random random(1);
  const Points found = jittered(pattern(3, 3), 0.1, random);
  calibration.add(found);
  CHECK(begins_with(said(), "DotNoiseCalibration: frames = 1"));
  const Points nothing(3, 3, {test::nan, test::nan});
  for (int k = 0; k < 3; ++k) {
    calibration.add(nothing);
    calibration.add(found, Flags(3, 3, 0));
  }
  CHECK(begins_with(said(), "DotNoiseCalibration: dots = 0"));
  calibration.add(found);
  CHECK(begins_with(said(),
                    "DotNoiseCalibration: noise_px = 0, must be > 0: the frames are identical"));
  calibration.add(jittered(found, 0.1, random));
  CHECK(said() == "accepted");

  // two dots that are never in the same frame cannot be compared
  DotNoiseCalibration apart(1, 2);
  for (int t = 0; t < 6; ++t) {
    Points dots = jittered(pattern(1, 2), 0.1, random);
    dots(0, t % 2).y = test::nan;
    apart.add(dots);
  }
  CHECK(begins_with(refusal([&] { (void)apart.fit(); }),
                    "DotNoiseCalibration: degrees of freedom of the positions = "));
}

TEST_CASE("false slip: against fifty digits, however rare", "[stick]") {
  const auto check = [](auto tag, double largest_exponent) {
    using S = decltype(tag);
    const S eps = std::numeric_limits<S>::epsilon();
    for (double ratio = 0.01; ratio * ratio / 4 < largest_exponent; ratio *= 1.37) {
      const S noise = S(0.0637), slip = S(ratio) * noise;
      const Digits50 exact_ratio = Digits50(slip) / Digits50(noise);
      const Digits50 x = exact_ratio * exact_ratio / 4;
      const Digits50 p = exp(-x);
      const S here = false_slip_probability(slip, noise);
      CHECK(test::relative_error(Digits50(here), p) < (4 * x + 2) * Digits50(eps));
      const S back = slip_threshold_for(noise, here);
      const Digits50 exact_back = 2 * Digits50(noise) * sqrt(-log(Digits50(here)));
      CHECK(test::relative_error(Digits50(back), exact_back) < 4 * Digits50(eps));
      for (const Index dots : {Index(1), Index(7), Index(441), Index(100000)}) {
        if (here < S(1)) {
          const Digits50 n = Digits50(static_cast<double>(dots));
          const Digits50 each = -expm1(log1p(-Digits50(here)) / n);
          CHECK(test::relative_error(Digits50(false_slip_of_each(here, dots)), each) <
                4 * Digits50(eps));
        }
      }
    }
  };
  check(float(), 80);
  check(double(), 700);
  check(static_cast<long double>(0), 11000);
}

TEST_CASE("false slip: ends of the range, units, slopes", "[stick]") {
  CHECK(false_slip_probability(0.0, 0.1) == 1);
  CHECK(false_slip_probability(0.1, 0.0) == 0);
  CHECK(false_slip_probability(100.0, 0.1) == 0);
  CHECK(std::isnan(false_slip_probability(0.0, 0.0)));
  CHECK(std::isnan(false_slip_probability(test::nan, 0.1)));
  CHECK(slip_threshold_for(0.1, 1.0) == 0);
  CHECK_FALSE(std::signbit(slip_threshold_for(0.1, 1.0)));
  CHECK(slip_threshold_for(0.1, 0.0) == infinity);
  CHECK(std::isnan(slip_threshold_for(0.1, 1.01)));
  CHECK(false_slip_of_each(0.0, 441) == 0);
  CHECK(false_slip_of_each(441e-300, 441) == Approx(1e-300).epsilon(1e-14));
  CHECK(false_slip_of_each(0.01, 1) == Approx(0.01).epsilon(1e-14));
  rc::prop("only the quotient counts, and p falls with it", [] {
    const double noise = test::log_uniform(1e-3, 1e3), slip = noise * test::uniform(0, 20);
    const double unit = std::ldexp(1.0, static_cast<int>(test::whole(-20, 20)));
    RC_ASSERT(false_slip_probability(slip * unit, noise * unit) ==
              false_slip_probability(slip, noise));
    RC_ASSERT(false_slip_probability(slip * 1.001 + noise * 1e-3, noise) <
              false_slip_probability(slip, noise));
    const double p = test::log_uniform(1e-300, 1);
    RC_ASSERT(std::abs(std::log(false_slip_probability(slip_threshold_for(noise, p), noise) / p)) <
              1e-11);
  });
  const auto by_slip = [](const auto& slip) {
    return false_slip_probability(slip, std::remove_cvref_t<decltype(slip)>(0.06));
  };
  CHECK(test::slope_by_dual(by_slip, 0.2) ==
        Approx(-0.2 / (2 * 0.06 * 0.06) * by_slip(0.2)).epsilon(1e-13));
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
  const double p = false_slip_probability(4.0, 1.0);
  CHECK(p == Approx(0.0183156).epsilon(1e-5));
  CHECK(std::abs(beyond / draws - p) < 3 * std::sqrt(p / draws));
  // 95.44 % refers to one axis of one position
  CHECK(std::abs(along_x / draws - 0.0455) < 3 * std::sqrt(0.0455 / draws));

  for (const Index dots : {Index(1), Index(12), Index(300)}) {
    const int frames = dots == 300 ? 4000 : 40000;
    const double limit = slip_threshold_for(0.1, false_slip_of_each(0.05, dots));
    double beyond_limit = 0;
    for (int t = 0; t < frames; ++t) {
      double sq = 0;
      for (Index k = 0; k < dots; ++k) {
        const auto off = gaussian_pair(random);
        sq = std::max(sq, 0.02 * (off.x * off.x + off.y * off.y));
      }
      beyond_limit += sq > limit * limit ? 1 : 0;
    }
    CAPTURE(dots);
    CHECK(std::abs(beyond_limit / frames - 0.05) < 3 * std::sqrt(0.05 / frames));
  }
}

TEST_CASE("false slip: as often as the stick ratio says", "[stick]") {
  // Everything sticks, so every slip is false. d_max is the largest of many displacements,
  // therefore it exceeds the motion by noise, which widens the threshold in proportion.
  const double noise_px = 0.05;
  StickTest test = published::stick_test_px;
  test.slip = slip_threshold_for(noise_px, 0.05);
  const StickRatio<StickConsensus<Freedom::translation>, UpdatedReference, NoDenoising, double>
      estimator(41, 41, test);
  auto state = estimator.start();
  Image<DotState> states(41, 41);
  const Flags contact(41, 41, 1);
  Random random(2);
  double slip = 0, expected = 0, dots = 0;
  for (int t = 0; t < 40; ++t) {
    const auto now = jittered(moved(pattern(41, 41), 2.5 * t, 0), noise_px, random);
    const auto result = estimator(now, contact, states, state);
    if (result.updated()) {
      const double widened_px = test.slip * result.furthest_px / test.reference;
      slip += static_cast<double>(result.slip);
      expected += static_cast<double>(result.dots_in_contact()) *
                  false_slip_probability(widened_px, noise_px);
      dots += static_cast<double>(result.dots_in_contact());
    }
  }
  CAPTURE(slip, expected, dots);
  CHECK(dots > 39 * 1600);
  CHECK(std::abs(slip - expected) < 3 * std::sqrt(expected));
}

TEST_CASE("thresholds from noise: no sticking dot slips more often than was asked", "[stick]") {
  const auto share_of = [](const auto& motion, const auto& denoising, double share) {
    const DotNoise noise = independent_dot_noise(0.06);
    StickTestOptions search;
    search.false_slip = share;
    const StickTest test = stick_test_for(441, noise, 2.0, search, motion, denoising);
    const StickRatio estimator(21, 21, test, motion, UpdatedReference(), denoising);
    Random random(5);
    const Flags contact = disc(21, 21, 8.2);
    Image<DotState> states(21, 21);
    double slip = 0, dots = 0;
    for (int t = 0; t < 300; ++t) {
      auto state = estimator.start();
      const auto then = jittered(pattern(21, 21), 0.06, random);
      (void)estimator(then, contact, states, state);
      const auto now = jittered(moved(pattern(21, 21), 2.0, 1.0), 0.06, random);
      const auto result = estimator(now, contact, states, state);
      REQUIRE(result.updated());
      slip += static_cast<double>(result.slip);
      dots += static_cast<double>(result.dots_in_contact());
    }
    return slip / dots;
  };
  using Consensus = StickConsensus<Freedom::translation>;
  using OneDot = published::ReferenceDotMotion<Freedom::translation>;
  for (const double share : {0.02, 0.2}) {
    // d_max exceeds U by some 15 %, and only the edge has the assumed noise
    for (const double got :
         {share_of(Consensus(), NoDenoising(), share), share_of(Consensus(), ResidualMean(), share),
          share_of(OneDot(), NoDenoising(), share)}) {
      CHECK(got < share);
      CHECK(got > share / 40);
    }
  }
}

TEST_CASE("thresholds from noise: which noise counts", "[stick]") {
  DotNoise noise = independent_dot_noise(0.1);
  const double nats = std::sqrt(-std::log(0.02));
  const double placed = std::sqrt(-std::log(-std::expm1(std::log1p(-0.01) / 300)));
  const StickTest plain = stick_test_for(300, noise, 3.0, {}, StickConsensus<>(), NoDenoising());
  CHECK(plain.slip == Approx(2 * 0.1 * nats));
  CHECK(plain.store == Approx(2 * 0.1 * placed));
  CHECK(plain.reference == 3.0);
  const StickTest mean =
      stick_test_for(300, noise, 3.0, {}, StickConsensus<>(), published::DotMean());
  CHECK(mean.slip == Approx(plain.slip * denoising_gain({})));
  CHECK(mean.store == Approx(plain.store * denoising_gain({})));
  const StickTest usual = stick_test_for(300, noise);
  CHECK(usual.slip == Approx(plain.slip * denoising_gain({}, 3, 2)));
  CHECK(usual.store == Approx(plain.store));
  CHECK(usual.reference == 2.0);
  CHECK(stick_test_for(300, noise, 3.0, {}, published::ReferenceDotMotion<>()).slip ==
        Approx(std::sqrt(2.0) * usual.slip));

  // a narrow pattern has no inner dots, an endless one no edge
  noise.inner_px = test::nan;
  CHECK(stick_test_for(300, noise).slip == Approx(usual.slip));
  noise = independent_dot_noise(0.1);
  noise.edge_px = test::nan;
  CHECK(stick_test_for(300, noise).slip == Approx(mean.slip));

  const auto said = [](const DotNoise<>& n, double reference_px,
                       const StickTestOptions& search = {}) {
    return refusal([&] { stick_test_for(300, n, reference_px, search); });
  };
  CHECK(begins_with(said(independent_dot_noise(0.0), 2), "stick_test_for: noise of a dot = 0"));
  CHECK(begins_with(said(independent_dot_noise(infinity), 2),
                    "stick_test_for: noise of a dot = inf"));
  noise.inner_px = test::nan;
  CHECK(begins_with(said(noise, 2), "stick_test_for: noise of an averaged dot = nan"));
  noise = independent_dot_noise(0.1);
  CHECK(said(noise, 1) == "accepted");
  for (const double bad : {usual.store, 0.0, test::nan, infinity}) {
    CHECK(begins_with(said(noise, bad), "stick_test_for: reference_px = "));
  }
  CHECK(begins_with(refusal([&] { stick_test_for(0, noise); }), "stick_test_for: dots = 0"));
}

TEST_CASE("choice of U: a recording that slips", "[stick]") {
  for (const double noise_px : {0.02, 0.06, 0.14}) {
    const Recording recording = record({.noise_px = noise_px});
    StickTestCalibration<> calibration(21, 21, independent_dot_noise(noise_px));
    add(recording, calibration);
    const StickTestFit choice = calibration.fit();
    const StickTestFit::Row& row = chosen_row(choice);
    CAPTURE(noise_px, row.test.reference);
    REQUIRE(choice.table.size() == 13);
    CHECK(choice.test.reference == row.test.reference);
    CHECK(choice.test.slip ==
          Approx(slip_threshold_for(noise_px * denoising_gain({}, 3, 2), 0.02)));
    CHECK(choice.furthest_px > choice.test.store);

    // the rule, from the table: the smallest U that is not worse than the best
    double best = infinity;
    for (const auto& c : choice.table) {
      best = c.updates >= 10 ? std::min(best, c.cost) : best;
    }
    bool passed = false;
    for (std::size_t k = 0; k < choice.table.size(); ++k) {
      const auto& c = choice.table[k];
      CHECK(c.test.reference == Approx(0.5 * std::pow(2.0, static_cast<double>(k) / 3)));
      if (c.test.reference <= std::max(c.test.slip, c.test.store)) {
        CHECK_FALSE(c.chosen);
        CHECK(c.updates == 0);
        continue;
      }
      CHECK(c.behind == Approx(c.cost - best).margin(1e-9));
      const bool as_good = !(c.behind > 2 * c.behind_error);
      CHECK(c.chosen == (as_good && !passed));
      passed = passed || as_good;
    }

    // with it the ratio is right
    CHECK(mean_error(recording, choice.test) < 0.1);
    for (const auto& c : choice.table) {  // and a refused one is worse
      if (c.behind > 2 * c.behind_error && c.test.reference < choice.test.reference / 1.5) {
        CHECK(mean_error(recording, c.test) > mean_error(recording, choice.test));
      }
    }
  }
}

TEST_CASE("choice of U: the table is what the stick ratio says", "[stick]") {
  const Recording recording = record({.turns_at = 80});
  StickTestOptions search;
  search.candidates = 3;
  search.smallest_px = 1;
  search.largest_px = 4;
  StickTestCalibration<> calibration(21, 21, independent_dot_noise(0.06), search);
  add(recording, calibration);
  const StickTestFit choice = calibration.fit();
  std::vector<std::vector<double>> costs_of;
  bool kept = false;
  for (const StickTestFit::Row& c : choice.table) {
    const StickRatio<> estimator(21, 21, c.test);
    auto state = estimator.start();
    Image<DotState> states(21, 21);
    std::vector<double> ratios, costs;
    Index updates = 0;
    for (const Points& dots : recording.dots) {
      const auto result = estimator(dots, recording.contact, states, state);
      if (result.status == StickStatus::standing) {
        continue;
      }
      const auto ratio = static_cast<double>(result.stick_ratio);
      ratios.push_back(std::isnan(ratio) ? 1 : ratio);
      costs.push_back(result.updated() ? ratio : 1);
      kept = kept || (!result.updated() && ratio < 0.9);
      const double before = ratios.size() > 1 ? ratios[ratios.size() - 2] : 1;
      costs.back() += before < ratio ? ratio - before : 0;
      updates += result.updated() ? 1 : 0;
    }
    CHECK(c.updates == updates);
    // unknown counts as sticking
    CHECK(c.cost >= measures(ratios).sum + measures(ratios).rises - 1e-9);
    CHECK(c.cost == Approx(measures(costs).sum));
    costs_of.push_back(costs);
  }
  CHECK(kept);  // at the turning point
  std::size_t best = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    best = choice.table[k].cost < choice.table[best].cost ? k : best;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    MeanOfSeeds differences;
    for (std::size_t t = 0; t < costs_of[k].size(); ++t) {
      differences.add(costs_of[k][t] - costs_of[best][t]);
    }
    CHECK(choice.table[k].behind == Approx(differences.sum));
    CHECK(choice.table[k].behind_error ==
          Approx(differences.sd() * std::sqrt(differences.count)).margin(1e-9));
  }
}

TEST_CASE("choice of U: the table of a recording", "[stick]") {
  for (const double noise_px : {0.06, 0.14}) {
    const Recording recording = record({.noise_px = noise_px});
    StickTestCalibration<> calibration(21, 21, independent_dot_noise(noise_px));
    add(recording, calibration);
    const StickTestFit choice = calibration.fit();
    std::string table = "\n    U delta_0  U_min    cost +- error updates error\n";
    double chosen_error = 1, smallest_error = 1;
    for (const StickTestFit::Row& c : choice.table) {
      char line[200];
      double error = test::nan;
      if (c.updates > 0) {
        error = mean_error(recording, c.test);
        smallest_error = std::min(smallest_error, error);
        chosen_error = c.chosen ? error : chosen_error;
      }
      std::snprintf(line, sizeof line, "%5.2f  %.3f  %.3f  %6.2f +- %5.2f  %4d   %.3f  %s\n",
                    c.test.reference, c.test.slip, c.test.store, c.cost, c.behind_error,
                    static_cast<int>(c.updates), error, c.chosen ? "chosen" : "");
      table += line;
    }
    INFO(noise_px << table);
    CHECK(chosen_error < smallest_error + 0.05);
  }
}

TEST_CASE("choice of U: one that hardly ever answers is not considered", "[stick]") {
  StickTestOptions search;
  search.smallest_px = 1;
  search.largest_px = 55;
  StickTestCalibration<> calibration(21, 21, independent_dot_noise(0.06), search);
  add(record({}), calibration);  // 60 px in total
  const StickTestFit choice = calibration.fit();
  int rare = 0;
  for (const StickTestFit::Row& c : choice.table) {
    CHECK((c.updates >= 10 || !c.chosen));
    rare += c.updates < 10 ? 1 : 0;
  }
  CHECK(rare >= 1);
}

TEST_CASE("choice of U: how long the pad stands, and lost contact, change nothing", "[stick]") {
  const Recording recording = record({});
  StickTestCalibration<> plain(21, 21, independent_dot_noise(0.06));
  StickTestCalibration<> standing(21, 21, independent_dot_noise(0.06));
  const Flags no_contact(21, 21, 0);
  add(recording, plain);
  standing.add(recording.dots[0], no_contact);
  for (std::size_t t = 0; t < recording.dots.size(); ++t) {
    for (int k = t % 20 == 7 ? 15 : 0; k >= 0; --k) {
      CHECK(standing.add(recording.dots[t], recording.contact));
    }
  }
  CHECK(standing.add(recording.dots[0], no_contact));
  const StickTestFit a = plain.fit(), b = standing.fit();
  CHECK(a.steps == b.steps);
  CHECK(a.test.reference == b.test.reference);
  for (std::size_t k = 0; k < a.table.size(); ++k) {
    const bool tried = a.table[k].updates > 0;
    CHECK((!tried || a.table[k].cost == b.table[k].cost));
    CHECK(a.table[k].updates == b.table[k].updates);
    CHECK(a.table[k].chosen == b.table[k].chosen);
  }

  // the same contact twice: everything doubles, and the choice stays or gets finer
  StickTestCalibration<> twice(21, 21, independent_dot_noise(0.06));
  add(recording, twice);
  twice.add(recording.dots[0], no_contact);
  add(recording, twice);
  const StickTestFit c = twice.fit();
  CHECK(c.steps == 2 * a.steps);
  for (std::size_t k = 0; k < a.table.size(); ++k) {
    CHECK((a.table[k].updates == 0 || c.table[k].cost == Approx(2 * a.table[k].cost)));
    CHECK(c.table[k].updates == 2 * a.table[k].updates);
  }
  // the same where time marks the start of another recording
  StickTestCalibration<> timed(21, 21, independent_dot_noise(0.06));
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t t = 0; t < recording.dots.size(); ++t) {
      timed.add(recording.dots[t], recording.contact, static_cast<double>(t));
    }
  }
  const StickTestFit d = timed.fit();
  for (std::size_t k = 0; k < a.table.size(); ++k) {
    // minus the first frame of the other: no step
    CHECK((a.table[k].updates == 0 || d.table[k].cost == Approx(2 * a.table[k].cost - 1)));
    CHECK(d.table[k].updates == 2 * a.table[k].updates);
  }
}

TEST_CASE("choice of U: other policies", "[stick]") {
  const Recording recording = record({.noise_px = 0.02});
  using Published = published::ReferenceDotMotion<Freedom::translation>;
  StickTestCalibration<Published, UpdatedReference, published::DotMean, double> published(
      21, 21, independent_dot_noise(0.02));
  add(recording, published);
  CHECK(chosen_row(published.fit()).updates > 20);
  StickTestCalibration<StickConsensus<>, published::FirstReference, NoDenoising> conventional(
      21, 21, independent_dot_noise(0.02));
  add(recording, conventional);
  CHECK(chosen_row(conventional.fit()).updates > 80);
}

TEST_CASE("choice of U: what it refuses", "[stick]") {
  const DotNoise noise = independent_dot_noise(0.06);
  const auto make = [&](const StickTestOptions& search) {
    return refusal([&] { const StickTestCalibration<> none(21, 21, noise, search); });
  };
  CHECK(make({}) == "accepted");
  CHECK(begins_with(make({.smallest_px = 0}), "StickTestOptions: smallest_px = 0"));
  CHECK(begins_with(make({.smallest_px = test::nan}), "StickTestOptions: smallest_px = "));
  CHECK(begins_with(make({.largest_px = 0.5}), "StickTestOptions: largest_px = 0.5"));
  CHECK(begins_with(make({.largest_px = infinity}), "StickTestOptions: largest_px = inf"));
  CHECK(begins_with(make({.candidates = 1}), "StickTestOptions: candidates = 1"));
  CHECK(begins_with(make({.candidates = 1001}), "StickTestOptions: candidates = 1001"));
  for (const double bad : {0.0, 1.0, test::nan}) {
    CHECK(begins_with(make({.false_slip = bad}), "StickTestOptions: false_slip = "));
    CHECK(begins_with(make({.false_motion = bad}), "StickTestOptions: false_motion = "));
  }
  CHECK(begins_with(refusal([&] { const StickTestCalibration<> none(0, 21, noise); }),
                    "StickTestCalibration: rows = 0"));
  CHECK(begins_with(refusal([&] { const StickTestCalibration<> none(21, 0, noise); }),
                    "StickTestCalibration: cols = 0"));
  // the largest U, just above the threshold, is tried even where powers round
  const double min_px = stick_test_for(441, noise, 8).store;
  for (double smallest_px = 0.1; smallest_px < min_px; smallest_px += 0.0137) {
    StickTestCalibration<> barely(
        21, 21, noise,
        {.smallest_px = smallest_px, .largest_px = std::nextafter(min_px, 1.0), .candidates = 2});
    CHECK(barely.add(pattern(21, 21), Flags(21, 21, 1)));
  }
  const DotNoise loud = independent_dot_noise(2);
  CHECK(begins_with(refusal([&] { const StickTestCalibration<> none(21, 21, loud); }),
                    "stick_test_for: reference_px = 8"));

  const auto choose = [&](const Recording& recording, const StickTestOptions& search = {}) {
    StickTestCalibration<> calibration(21, 21, noise, search);
    add(recording, calibration);
    return refusal([&] { (void)calibration.fit(); });
  };
  const std::string owner = "StickTestCalibration: ";
  CHECK(choose(record({})) == "accepted");
  CHECK(begins_with(choose(Recording()), owner + "frames with contact and motion = 0"));
  CHECK(begins_with(choose(record({.frames = 15})), owner + "frames with contact and motion = 15"));
  Recording free = record({});
  free.contact = Flags(21, 21, 0);
  CHECK(begins_with(choose(free), owner + "frames with contact and motion = 0"));
  Recording lost = record({});
  for (Points& dots : lost.dots) {
    dots = Points(21, 21, {test::nan, test::nan});
  }
  CHECK(begins_with(choose(lost), owner + "largest displacement in px = 0"));
  const Recording still = record({.step_px = 0, .frames = 60});
  CHECK(begins_with(choose(still), owner + "frames with contact and motion = "));
  // noise that was measured too small makes steps, but no displacement
  Recording shaken = record({.noise_px = 0.1, .step_px = 0, .frames = 60});
  CHECK(begins_with(choose(shaken, {.smallest_px = 1}), owner + "largest displacement in px = 0."));
  // twenty frames of motion, fewer than ten of them beyond the smallest tried U
  CHECK(begins_with(choose(record({.frames = 24}), {.smallest_px = 8, .largest_px = 9.5}),
                    owner + "updated answers = "));
  CHECK(begins_with(choose(record({.last_radius = 9})), owner + "answers that slip = "));
  Recording slips = record({.frames = 240});
  slips.dots.erase(slips.dots.begin(), slips.dots.begin() + 190);
  CHECK(begins_with(choose(slips), owner + "answers that stick = "));
  // recordings that begin earlier by one frame each have one more answer that sticks: three suffice
  const auto from_frame = [&](int first) {
    Recording late = record({.frames = 240});
    late.dots.erase(late.dots.begin(), late.dots.begin() + first);
    return choose(late);
  };
  CHECK(begins_with(from_frame(121), owner + "answers that stick = 1"));
  CHECK(begins_with(from_frame(120), owner + "answers that stick = 2"));
  CHECK(from_frame(119) == "accepted");

  // grids of another size change nothing
  StickTestCalibration<> calibration(21, 21, noise);
  CHECK_FALSE(calibration.add(Points(21, 20), Flags(21, 20, 1)));
  CHECK_FALSE(calibration.add(Points(21, 21), Flags(20, 21, 1)));
  CHECK(begins_with(refusal([&] { (void)calibration.fit(); }),
                    owner + "frames with contact and motion = 0"));
}

TEST_CASE("choice of U: frames without dots are no harm", "[stick]") {
  Recording recording = record({});
  Random random(6);
  for (std::size_t t = 0; t < recording.dots.size(); ++t) {
    lose(recording.dots[t], t % 17 == 5 ? 1.0 : 0.1, random);
  }
  StickTestCalibration<> calibration(21, 21, independent_dot_noise(0.06));
  add(recording, calibration);
  const StickTestFit choice = calibration.fit();
  CHECK(choice.test.reference > 0.5);
  CHECK(choice.test.reference < 8);
}
