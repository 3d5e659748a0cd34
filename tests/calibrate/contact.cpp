// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fingerpad/contact/contact_region.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "support/soap_film.hpp"

using namespace fingerpad;
using test::begins_with;
using test::Image;
using test::refusal;
using test::RoundFilm;

namespace {

using Plan = OrthographicCamera<double>;
using Calibration = FreePadCalibration<>;
constexpr ThresholdRule slides{1, 2, 0, false};  // the minimum of E - 2 sigma

RoundFilm free_pad(double curvature_per_mm) {
  test::RoundContact none;
  none.radius_mm = 0;
  none.free_per_mm = curvature_per_mm;
  return RoundFilm(none);
}

template <class S>
void add_noise(Image<S>& depth, double noise_mm, test::Random& random) {
  for (S& l : depth.cells) {
    l += static_cast<S>(noise_mm * random.normal());
  }
}

}  // namespace

TEST_CASE("calibration: half of the free pad's curvature", "[contact_region]") {
  for (const double curvature : {0.02, 0.05, 0.1}) {
    const auto plan = test::height_map(70, 80, 0.16);
    Calibration by_plan(plan, 70, 80, {8});
    const auto camera = test::pad_camera(70, 80, 0.16);
    FreePadCalibration<double> by_camera(camera, 70, 80, {8});
    for (int frame = 0; frame < 3; ++frame) {
      CHECK(by_plan.add(test::depths_of<float>(plan, free_pad(curvature), 70, 80)));
      CHECK(by_camera.add(test::depths_of<double>(camera, free_pad(curvature), 70, 80)));
    }
    // vertical sections cause a few per cent on the slopes, as many as a camera does
    for (const FreePadCurvature<>& pad : {by_plan.fit(), by_camera.fit()}) {
      CHECK(pad.median_per_mm == Approx(curvature).epsilon(0.08));
      CHECK(pad.threshold_per_mm == Approx(pad.median_per_mm / 2));
      CHECK(pad.noise_per_mm < 1e-6);
      CHECK(pad.edge_noise_mm < 1e-4);
      CHECK(pad.frames == 3);
      CHECK(pad.pixels > 60 * 64);
      CHECK(pad.pixels < 70 * 80);
    }
  }
}

TEST_CASE("calibration: the rules by definition", "[contact_region]") {
  const Index rows = 60, cols = 66;
  const auto camera = test::height_map(rows, cols, 0.16);
  CurvatureMap<double> map(camera, rows, cols, {8});
  FreePadCalibration<double> calibration(camera, rows, cols, {8});
  test::Random random(5);
  std::vector<Image<double>> frames;
  for (int k = 0; k < 6; ++k) {
    auto depth = test::depths_of<double>(camera, free_pad(0.05), rows, cols);
    add_noise(depth, 0.001, random);
    CHECK(calibration.add(depth));
    (void)map(depth, depth);
    frames.push_back(depth);
  }
  std::vector<double> lows, means;
  double variance = 0;
  for (std::size_t k = 0; k < frames[0].cells.size(); ++k) {
    double mean = 0, squares = 0;
    for (const auto& f : frames) {
      mean += f.cells[k] / 6;
    }
    for (const auto& f : frames) {
      squares += (f.cells[k] - mean) * (f.cells[k] - mean) / 5;
    }
    if (mean == mean) {
      means.push_back(mean);
      lows.push_back(mean - 2 * std::sqrt(squares));
      variance += squares;
    }
  }
  std::sort(lows.begin(), lows.end());
  std::sort(means.begin(), means.end());
  const FreePadCurvature published = calibration.fit(slides);
  CHECK(published.threshold_per_mm == Approx(lows.front()).epsilon(1e-12));
  CHECK(published.median_per_mm == Approx(means[(means.size() - 1) / 2]).epsilon(1e-12));
  CHECK(published.noise_per_mm ==
        Approx(std::sqrt(variance / static_cast<double>(means.size()))).epsilon(1e-12));
  CHECK(published.pixels == static_cast<Index>(means.size()));
  const auto at = [&](double share) {
    return lows[static_cast<std::size_t>(share * static_cast<double>(lows.size() - 1))];
  };
  CHECK(calibration.fit({1, 2, 0.1, false}).threshold_per_mm == Approx(at(0.1)).epsilon(1e-12));
  CHECK(calibration.fit({1, 2, 0.5, false}).threshold_per_mm == Approx(at(0.5)).epsilon(1e-12));
  CHECK(calibration.fit({0.5, 2, 0.1}).threshold_per_mm ==
        Approx(published.median_per_mm / 2).epsilon(1e-12));
  CHECK(calibration.fit({1, 0, 0.5}).threshold_per_mm ==
        Approx(published.median_per_mm).epsilon(1e-12));
  CHECK(calibration.fit({1, 3, 0.1}).threshold_per_mm ==
        Approx(means[static_cast<std::size_t>(0.1 * static_cast<double>(means.size() - 1))] -
               3 * published.noise_per_mm)
            .epsilon(1e-12));
}

TEST_CASE("calibration: two frames are enough for half of the level", "[contact_region]") {
  const Index rows = 180, cols = 200;
  const auto camera = test::height_map(rows, cols, 0.1);
  test::Random random(9);
  Calibration calibration(camera, rows, cols, {8});
  for (int frame = 0; frame < 2; ++frame) {
    auto depth = test::depths_of<float>(camera, free_pad(0.05), rows, cols);
    add_noise(depth, 0.002, random);
    calibration.add(depth);
  }
  const FreePadCurvature pad = calibration.fit();
  CHECK(pad.noise_per_mm > 0.003);
  CHECK(pad.threshold_per_mm == Approx(pad.median_per_mm / 2));
  // a pixel's own sigma from two frames is sometimes many times too large
  CHECK(calibration.fit({0.5, 2, 0.001, false}).threshold_per_mm < pad.threshold_per_mm);
}

TEST_CASE("calibration: the standard error of the median is how far medians scatter",
          "[contact_region]") {
  const Index rows = 50, cols = 50;
  const int pads = 60;
  const auto camera = test::height_map(rows, cols, 0.2);
  const auto still = test::depths_of<float>(camera, free_pad(0.05), rows, cols);
  test::Random random(26);
  double sum = 0, squares = 0, said = 0;
  for (int k = 0; k < pads; ++k) {
    Calibration calibration(camera, rows, cols, {6});
    for (int frame = 0; frame < 6; ++frame) {
      CHECK((frame != 1 || std::isnan(calibration.fit().median_error_per_mm)));
      auto depth = still;
      add_noise(depth, 0.002, random);
      calibration.add(depth);
    }
    const FreePadCurvature pad = calibration.fit();
    sum += pad.median_per_mm;
    squares += pad.median_per_mm * pad.median_per_mm;
    said += pad.median_error_per_mm * pad.median_error_per_mm / pads;
    // not the error of a single pixel
    CHECK(pad.median_error_per_mm < pad.noise_per_mm / std::sqrt(6.0) / 3);
  }
  const double scatter = std::sqrt((squares - sum * sum / pads) / (pads - 1));
  // 60 pads determine the scatter to 9 % and the mean of their errors to 4 %
  CHECK(std::sqrt(said) == Approx(scatter).epsilon(0.3));
}

TEST_CASE("calibration: one bad pixel sets the published threshold, but no quantile",
          "[contact_region]") {
  const Index rows = 180, cols = 200;
  const auto camera = test::height_map(rows, cols, 0.1);
  Calibration good(camera, rows, cols, {8}), spoilt(camera, rows, cols, {8});
  const auto depth = test::depths_of<float>(camera, free_pad(0.05), rows, cols);
  test::Random random(6);
  for (int frame = 0; frame < 4; ++frame) {
    auto noisy = depth;
    add_noise(noisy, 2e-4, random);
    good.add(noisy);
    noisy(90, 100) -= 0.02F;  // this pixel and the 36 pixels that see it
    spoilt.add(noisy);
  }
  CHECK(spoilt.fit().threshold_per_mm == Approx(good.fit().threshold_per_mm).epsilon(0.01));
  const ThresholdRule robust{1, 2, 0.005, false};
  CHECK(spoilt.fit(robust).threshold_per_mm ==
        Approx(good.fit(robust).threshold_per_mm).epsilon(0.01));
  const ThresholdRule published = slides;
  CHECK(good.fit(published).threshold_per_mm > 0.04);
  CHECK(refusal([&] { (void)spoilt.fit(published); }) != "accepted");
}

TEST_CASE("calibration: pixels that are once missing do not count", "[contact_region]") {
  const auto camera = test::height_map(60, 66, 0.16);
  Calibration calibration(camera, 60, 66, {6});
  auto depth = test::depths_of<float>(camera, free_pad(0.05), 60, 66);
  calibration.add(depth);
  const Index all = calibration.fit().pixels;
  depth(30, 30) = std::numeric_limits<float>::quiet_NaN();
  depth(31, 40) = std::numeric_limits<float>::infinity();
  calibration.add(depth);
  CHECK(calibration.fit().pixels == all - 2);
  calibration.add(test::depths_of<float>(camera, free_pad(0.05), 60, 66));
  CHECK(calibration.fit().pixels == all - 2);
  CHECK(calibration.fit().threshold_per_mm == Approx(0.025).epsilon(0.1));
}

TEST_CASE("calibration: the noise of the edge", "[contact_region]") {
  // Edges of many noisy frames, straight and round, along the rows that cross them: the mean
  // curvature there, followed from inside to where it crosses the level of the edge.
  const Index rows = 96, cols = 128, ring = 12;
  const auto camera = test::height_map(rows, cols, 0.08);
  const double noise_mm = 3e-4;
  test::Random random(7);
  Calibration calibration(camera, rows, cols, {ring});
  const auto free = test::depths_of<float>(camera, free_pad(0.05), rows, cols);
  for (int frame = 0; frame < 8; ++frame) {
    auto noisy = free;
    add_noise(noisy, noise_mm, random);
    calibration.add(noisy);
  }
  const FreePadCurvature pad = calibration.fit();
  CurvatureMap<> map(camera, rows, cols, {ring});
  const auto mean = [&](const Image<float>& depth, Image<float>& out) {
    (void)map(depth, out);
    map.mean(0, rows, 0, cols, out);
  };
  const auto spread = [&](const auto& film) {
    const auto exact = test::depths_of<float>(camera, film, rows, cols);
    double squares = 0, count = 0;
    Image<float> k(rows, cols), clean(rows, cols);
    mean(exact, clean);
    const auto crossing = [&](const Image<float>& of, Index i) {
      Index j = cols / 2;
      while (of(i, j) < 0.025F) {
        ++j;
      }
      const double step = static_cast<double>(of(i, j) - of(i, j - 1));
      return static_cast<double>(j) - static_cast<double>(of(i, j) - 0.025F) / step;
    };
    for (int frame = 0; frame < 12; ++frame) {
      auto noisy = exact;
      add_noise(noisy, noise_mm, random);
      mean(noisy, k);
      for (Index i = rows / 2 - 12; i <= rows / 2 + 12; i += 3) {
        const double moved_mm = 0.08 * (crossing(k, i) - crossing(clean, i));
        squares += moved_mm * moved_mm;
        count += 1;
      }
    }
    return std::sqrt(squares / count);
  };
  test::StripFilm strip;
  strip.half_mm = 2.5;
  test::RoundContact round;
  round.radius_mm = 2.5;
  const double straight_mm = spread(strip), round_mm = spread(RoundFilm(round));
  CAPTURE(pad.edge_noise_mm, straight_mm, round_mm, pad.noise_per_mm);
  CHECK(straight_mm / pad.edge_noise_mm < 1.3);
  CHECK(straight_mm / pad.edge_noise_mm > 1 / 1.3);
  CHECK(round_mm / pad.edge_noise_mm < 1.3);
  CHECK(round_mm / pad.edge_noise_mm > 1 / 1.3);
}

TEST_CASE("calibration: what it refuses", "[contact_region]") {
  const auto camera = test::height_map(40, 44, 0.16);
  Calibration calibration(camera, 40, 44, {4});
  const auto fit = [&](const ThresholdRule& rule) {
    return refusal([&] { (void)calibration.fit(rule); });
  };
  CHECK(fit({}) == "FreePadCalibration: frames = 0, must be >= 1");
  CHECK_FALSE(calibration.add(Image<float>(40, 43)));
  CHECK(fit({}) == "FreePadCalibration: frames = 0, must be >= 1");
  calibration.add(test::depths_of<float>(camera, free_pad(0.05), 40, 44));
  CHECK(fit({}) == "accepted");
  for (const double bad : {0.0, 1.1, test::nan}) {
    CHECK(begins_with(fit({bad, 2, 0}), "ThresholdRule: level_share = "));
  }
  for (const double bad : {-1.0, test::nan, std::numeric_limits<double>::infinity()}) {
    CHECK(begins_with(fit({0.5, bad, 0}), "ThresholdRule: sigmas = "));
  }
  for (const double bad : {-0.1, 0.51, test::nan}) {
    CHECK(begins_with(fit({0.5, 2, bad}), "ThresholdRule: quantile = "));
  }

  Calibration nothing(camera, 40, 44, {4});
  nothing.add(Image<float>(40, 44, static_cast<float>(test::nan)));
  CHECK(begins_with(refusal([&] { (void)nothing.fit(); }), "FreePadCalibration: pixels = 0"));
  Calibration level(camera, 40, 44, {4});
  level.add(Image<float>(40, 44, 9.0F));
  CHECK(
      begins_with(refusal([&] { (void)level.fit(); }), "FreePadCalibration: threshold_per_mm = 0"));

  CHECK(begins_with(refusal([&] { const Calibration none(camera, 0, 44); }),
                    "FreePadCalibration: rows = 0"));
  CHECK(begins_with(refusal([&] { const Calibration none(camera, 40, 44, {0}); }),
                    "CurvatureRing: radius_px = 0"));
  auto bad = camera;
  bad.pitch_mm = -1;
  CHECK(begins_with(refusal([&] { const Calibration none(bad, 40, 44); }),
                    "OrthographicCamera: pitch_mm = -1"));
}
