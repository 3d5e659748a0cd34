// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/optics/orthographic_camera.hpp"
#include "fingerpad/published/contact_region.hpp"
#include "support/catch.hpp"
#include "support/digest.hpp"
#include "support/refusal.hpp"
#include "support/soap_film.hpp"

using namespace fingerpad;
using test::begins_with;
using test::Image;
using test::refusal;
using test::RoundFilm;

namespace {

using Plan = OrthographicCamera<double>;

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
    const auto camera = test::pad_camera(70, 80, 0.16);
    const std::vector heights(3, test::depths_of<float>(plan, free_pad(curvature), 70, 80));
    const std::vector depths(3, test::depths_of<double>(camera, free_pad(curvature), 70, 80));
    // vertical sections cause a few per cent on the slopes, as many as a camera does
    for (const ThresholdFit<>& pad :
         {fit_contact_threshold(plan, heights, 8), fit_contact_threshold(camera, depths, 8)}) {
      CHECK(pad.ok());
      CHECK(pad.median_per_mm == Approx(curvature).epsilon(0.08));
      CHECK(pad.threshold_per_mm == Approx(pad.median_per_mm / 2));
      CHECK(pad.noise_per_mm < 1e-6);
    }
  }
}

TEST_CASE("calibration: the rules by definition", "[contact_region]") {
  const Index rows = 60, cols = 66, region_px = 30;
  const auto camera = test::height_map(rows, cols, 0.16);
  CurvatureMap<float> map(camera, rows, cols, 8);
  // The largest region of neighbours below a level, by repeated passes over the image.
  const auto largest = [&](const Image<double>& curvature, double level) {
    Image<int> label(rows, cols);
    for (int k = 0; k < static_cast<int>(rows * cols); ++k) {
      label.cells[static_cast<std::size_t>(k)] =
          curvature.cells[static_cast<std::size_t>(k)] < level ? k + 1 : 0;
    }
    for (bool is_changed = true; is_changed;) {
      is_changed = false;
      for (Index i = 0; i < rows; ++i) {
        for (Index j = 0; j < cols; ++j) {
          for (const auto& [r, c] : {std::pair{i, j + 1}, std::pair{i + 1, j}}) {
            if (r < rows && c < cols && label(i, j) != label(r, c) &&
                label(i, j) * label(r, c) > 0) {
              label(i, j) = label(r, c) = (std::max)(label(i, j), label(r, c));
              is_changed = true;
            }
          }
        }
      }
    }
    std::map<int, Index> pixels;
    for (const int l : label.cells) {
      pixels[l] += l > 0 ? 1 : 0;
    }
    Index most = 0;
    for (const auto& [l, count] : pixels) {
      most = (std::max)(most, count);
    }
    return most;
  };
  for (const double noise_mm :
       {0.001, 0.03, 0.08}) {  // the threshold is set by the level, by the noise
    for (const int count : noise_mm > 0.05 ? std::vector{6} : std::vector{6, 20}) {
      test::Random random(5);
      std::vector<Image<double>> frames;
      double median = 0, mean = 0, squares = 0;
      const ThresholdFit<> pad = [&] {
        for (int k = 0; k < count; ++k) {
          auto depth = test::depths_of<double>(camera, free_pad(0.05), rows, cols);
          add_noise(depth, noise_mm, random);
          depth(30, 30) = k == 2 ? test::nan : depth(30, 30);  // does not count
          frames.push_back(depth);
        }
        return fit_contact_threshold(camera, frames, 8, 18, region_px);
      }();
      std::vector<double> levels;
      for (auto curvature : frames) {
        (void)map(curvature, curvature);
        std::vector<double> known;
        std::copy_if(curvature.cells.begin(), curvature.cells.end(), std::back_inserter(known),
                     [](double k) { return k == k; });
        std::sort(known.begin(), known.end());
        median += known[known.size() / 2] / count;
        std::size_t low = 0, high = known.size() / 2;  // pixels below
        while (high - low > 1) {
          const std::size_t middle = (low + high) / 2;
          (largest(curvature, known[middle]) >= region_px ? high : low) = middle;
        }
        levels.push_back(known[high - 1]);
        mean += levels.back() / count;
      }
      for (const double level : levels) {
        squares += square(level - mean) / (count - 1);
      }
      // 6.731: -(0.57722 + ln 1e-4) sqrt(6) / pi; its standard error by the moments of Gumbel's law
      const double sds =
          count < 16 ? 2 : 6.731 + std::sqrt((1 + 1.1396 * 6.731 + 1.1 * 6.731 * 6.731) / count);
      const double low = mean - sds * std::sqrt(squares);
      CHECK((median / 2 < low) == (noise_mm < (count < 16 ? 0.05 : 0.01)));
      CHECK(pad.median_per_mm == Approx(median).epsilon(1e-9));
      CHECK(pad.region_per_mm == Approx(mean).epsilon(1e-4));
      CHECK(pad.noise_per_mm == Approx(std::sqrt(squares)).epsilon(1e-3));
      CHECK(pad.threshold_per_mm == Approx((std::min)(median / 2, low)).epsilon(2e-3));
      CHECK(pad.faint_per_mm == Approx(count < 16 ? 0 : low).epsilon(2e-3));
    }
  }
}

TEST_CASE("calibration: free frames seem touched as rarely as the threshold says",
          "[contact_region]") {
  // smooth noise over a pad of some hundred places; one in 100 running frames is counted instead of
  // one in 10,000, by two frames of which one alone is in contact in a hundred
  const Index rows = 60, cols = 66;
  const auto camera = test::height_map(rows, cols, 0.16);
  for (const double noise_mm : {0.04, 0.02}) {  // the threshold is set by the noise, by the level
    test::Random random(3);
    const auto frame = [&] {
      auto depth = test::depths_of<float>(camera, free_pad(0.05), rows, cols);
      add_noise(depth, noise_mm, random);
      return depth;
    };
    std::vector<Image<float>> frames;
    for (int k = 0; k < 300; ++k) {
      frames.push_back(frame());
    }
    ContactTest test;
    test.ring_px = 8;
    test.min_region_px = 30;
    const auto fit = [&](int running) {
      return fit_contact_threshold(camera, frames, test.ring_px, test.directions,
                                   test.min_region_px, running);
    };
    const auto alone = fit(1), two = fit(2);
    test.threshold_per_mm = two.threshold_per_mm;
    test.faint_per_mm = two.faint_per_mm;
    CHECK(alone.faint_per_mm < test.faint_per_mm);
    CHECK((test.threshold_per_mm < 0.024) == (noise_mm > 0.03));
    CHECK((test.threshold_per_mm < test.faint_per_mm) == (noise_mm < 0.03));
    Image<std::uint8_t> mask(rows, cols);
    ContactRegion<> find(camera, rows, cols, test);
    int touched = 0;
    for (int k = 0; k < 2000; ++k) {
      touched += find(frame(), mask).in_contact() ? 1 : 0;
    }
    CAPTURE(touched, alone.faint_per_mm, test.threshold_per_mm, test.faint_per_mm);
    CHECK(touched <= 20);
    CHECK(touched >= 1);
  }
}

TEST_CASE("calibration: the smallest press that is found, and false contact", "[contact_region]") {
  const Index rows = 160, cols = 160;
  const auto camera = test::height_map(rows, cols, 0.15);
  const auto limit_of = [&](double noise_mm, double ring_px) {
    test::Random random(4);
    std::vector<Image<float>> frames(10,
                                     test::depths_of<float>(camera, free_pad(0.05), rows, cols));
    for (auto& frame : frames) {
      add_noise(frame, noise_mm, random);
    }
    ContactTest test;
    test.ring_px = ring_px;
    test.min_region_px = 20;
    return detection_limit(camera, frames, test, 0.05, 12);
  };
  const auto exact = limit_of(0, 12), noisy = limit_of(0.1, 12), small = limit_of(0, 6);
  CHECK(exact.free_frames == 10);
  CHECK(exact.false_frames == 0);
  // (a/r)^2 (ln(r/a) + 1/2) = 1/4 at the pixel in the middle, of a ring of radius r
  CHECK(exact.radius_mm > 0.43 * 12 * 0.15);
  CHECK(exact.radius_mm < 12 * 0.15);
  CHECK(exact.depth_mm ==
        Approx(0.05 * square(exact.radius_mm) * (std::log(12 / exact.radius_mm) + 0.5)));
  CHECK(small.radius_mm < 0.7 * exact.radius_mm);
  CHECK(noisy.false_frames > 0);
  CHECK(std::isnan(limit_of(test::nan, 12).radius_mm));  // no depth at all
  const std::vector<Image<float>> none;
  CHECK(begins_with(refusal([&] { (void)detection_limit(camera, none, {}, 0.05, 12); }),
                    "detection_limit: number of frames = 0"));
  const std::vector<Image<float>> two = {Image<float>(9, 9, 5), Image<float>(9, 8, 5)};
  CHECK(begins_with(refusal([&] { (void)detection_limit(camera, two, {}, 0.05, 12); }),
                    "detection_limit: rows of a frame"));
}

TEST_CASE("calibration: the standard error of the median is how far medians scatter",
          "[contact_region]") {
  const int pads = 60;
  const auto camera = test::height_map(50, 50, 0.2);
  const auto still = test::depths_of<float>(camera, free_pad(0.05), 50, 50);
  CHECK(std::isnan(fit_contact_threshold(camera, std::array{still}, 6).median_error_per_mm));
  test::Random random(26);
  double sum = 0, squares = 0, said = 0;
  for (int k = 0; k < pads; ++k) {
    std::vector<Image<float>> frames(6, still);
    for (auto& frame : frames) {
      add_noise(frame, 0.002, random);
    }
    const ThresholdFit pad = fit_contact_threshold(camera, frames, 6);
    sum += pad.median_per_mm;
    squares += pad.median_per_mm * pad.median_per_mm;
    said += pad.median_error_per_mm * pad.median_error_per_mm / pads;
  }
  const double scatter = std::sqrt((squares - sum * sum / pads) / (pads - 1));
  // 60 pads determine the scatter to 9 % and the mean of their errors to 4 %
  CHECK(std::sqrt(said) == Approx(scatter).epsilon(0.3));
}

TEST_CASE("calibration: one bad pixel sets the published threshold, but not the default",
          "[contact_region]") {
  const Index rows = 180, cols = 200;
  const auto camera = test::height_map(rows, cols, 0.1);
  const auto depth = test::depths_of<float>(camera, free_pad(0.05), rows, cols);
  std::vector<Image<float>> good(4, depth), spoilt;
  test::Random random(6);
  for (auto& frame : good) {
    add_noise(frame, 2e-4, random);
    spoilt.push_back(frame);
    spoilt.back()(90, 100) -= 0.02F;  // this pixel and the 36 pixels that see it
  }
  CHECK(fit_contact_threshold(camera, spoilt, 8).threshold_per_mm ==
        Approx(fit_contact_threshold(camera, good, 8).threshold_per_mm).epsilon(0.01));
  const auto published = [](const std::vector<Image<float>>& frames) {
    return published::threshold_by_slides(
        frames, {.clamps = true, .radius_px = 8, .pitch_mm = 0.1, .step_px = 1});
  };
  CHECK(published(good) > 0.04);
  CHECK(published(spoilt) <= 0);
}

TEST_CASE("calibration: what it refuses", "[contact_region]") {
  const auto camera = test::height_map(40, 44, 0.16);
  const auto free = test::depths_of<float>(camera, free_pad(0.05), 40, 44);
  using Frames = std::vector<Image<float>>;
  const auto fit = [&](const Frames& frames, double ring = 4, Index region = 200, int running = 1) {
    return refusal([&] { (void)fit_contact_threshold(camera, frames, ring, 18, region, running); });
  };
  CHECK(fit({free}) == "accepted");
  CHECK(begins_with(fit({free}, 4, 0), "fit_contact_threshold: region_px = 0"));
  CHECK(begins_with(fit({free}, 4, 200, 4), "fit_contact_threshold: running = 4"));
  CHECK(fit({}) == "fit_contact_threshold: number of frames = 0, must be >= 1");
  CHECK(fit({free, Image<float>(40, 43)}) ==
        "fit_contact_threshold: rows of a frame = 40, must be of the same size as the first frame");
  CHECK(begins_with(fit({Image<float>(40, 44, static_cast<float>(test::nan))}),
                    "fit_contact_threshold: pixels = 0"));
  CHECK(begins_with(fit({Image<float>(40, 44, 9.0F)}),
                    "fit_contact_threshold: threshold_per_mm = 0"));
  CHECK(begins_with(fit({Image<float>(0, 44)}), "CurvatureMap: rows = 0"));
  CHECK(begins_with(fit({free}, 0), "CurvatureMap: ring_px = 0"));
  auto bad = camera;
  bad.pitch_mm = -1;
  CHECK(begins_with(refusal([&] { (void)fit_contact_threshold(bad, Frames{free}); }),
                    "OrthographicCamera: pitch_mm = -1"));
}

TEST_CASE("unchanged: threshold and smallest dent of noisy free frames", "[unchanged]") {
  const auto camera = test::pad_camera(70, 80, 0.16);
  test::Random random(3);
  std::vector<Image<float>> free(20, test::depths_of<float>(camera, free_pad(0.05), 70, 80));
  for (Image<float>& frame : free) {
    add_noise(frame, 0.004, random);
  }
  const auto fit = fit_contact_threshold(camera, free, 8);
  ContactTest test;
  test.threshold_per_mm = fit.threshold_per_mm;
  test.ring_px = 8;
  const auto limit = detection_limit(camera, free, test, fit.median_per_mm, 6.0);
  test::Digest d;
  d.all(fit.threshold_per_mm, fit.median_per_mm, fit.median_error_per_mm, fit.region_per_mm,
        fit.noise_per_mm, limit.free_frames, limit.false_frames, limit.depth_mm, limit.radius_mm);
  CHECK(d.sum() == test::same(184.478));
}
