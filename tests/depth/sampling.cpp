// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Sampled frames: means against a naive mean, bad pixels affect only their sample, a sample lies
// where its pixels are, and conversion from samples back to pixels.
#include "fingerpad/depth/sampling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "fingerpad/pipeline/fingertip.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::Image;

namespace {

/// Mean of the valid pixels of a sample, or the mark of the reason why there are none.
template <class Pixel>
double naive(const Image<Pixel>& of, const Image<Pixel>& beside, Index i, Index j, int step) {
  const double top = grey_scale_of<Pixel>().saturated;
  double sum = 0, count = 0;
  bool saturated = false;
  for (Index r = i * step; r < (i + 1) * step; ++r) {
    for (Index c = j * step; c < (j + 1) * step; ++c) {
      const auto x = static_cast<double>(of(r, c)), y = static_cast<double>(beside(r, c));
      saturated = saturated || x >= top || y >= top;
      if (x > 0 && y > 0 && x < top && y < top) {
        sum += x;
        count += 1;
      }
    }
  }
  const double units = std::is_same_v<Pixel, std::uint8_t> ? 256 : 1;
  return count > 0 ? sum / count * units : saturated ? top * units : 0;
}

/// Mostly grey, with invalid pixels of each kind, in patches and alone.
template <class Pixel>
Image<Pixel> any_channel(Index rows, Index cols) {
  Image<Pixel> image(rows, cols);
  const double top = grey_scale_of<Pixel>().saturated;
  const int bad_percent = static_cast<int>(test::whole(0, 3)) * 20;
  for (Pixel& x : image.cells) {
    const auto kind = test::whole(0, 99);
    const double grey = test::uniform(0.004, 0.996) * top;
    x = static_cast<Pixel>(kind >= bad_percent ? grey : kind % 3 == 0 ? 0.0 : top);
  }
  const Index dark_from = test::whole(0, cols), dark_to = test::whole(0, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = dark_from; j < dark_to; ++j) {
      image(i, j) = Pixel(0);
    }
  }
  return image;
}

template <class Pixel>
auto samples_of(const Image<Pixel>& red, const Image<Pixel>& green, int step) {
  const Image<std::uint16_t> samples(red.rows() / step, red.cols() / step);
  std::pair out(samples, samples);
  REQUIRE(sample_frame(red, green, step, as_view(out.first), as_view(out.second)));
  return out;
}

}  // namespace

TEMPLATE_TEST_CASE("samples are the means of what their pixels say",
                   "[sampling]",
                   std::uint8_t,
                   std::uint16_t) {
  using Pixel = TestType;
  rc::prop("one by one", [] {
    const int step = static_cast<int>(test::whole(1, 6));
    const Index rows = test::whole(step, 9), cols = test::whole(step, 80 * step);
    const auto red = any_channel<Pixel>(rows, cols), green = any_channel<Pixel>(rows, cols);
    const auto [r, g] = samples_of(red, green, step);
    for (Index i = 0; i < r.rows(); ++i) {
      for (Index j = 0; j < r.cols(); ++j) {
        const double expected[2] = {naive(red, green, i, j, step), naive(green, red, i, j, step)};
        const double found[2] = {static_cast<double>(r(i, j)), static_cast<double>(g(i, j))};
        for (int k = 0; k < 2; ++k) {
          RC_ASSERT(std::abs(found[k] - expected[k]) <= 0.5);
        }
      }
    }
  });
}

TEMPLATE_TEST_CASE("a block has the samples of a million pixels one by one",
                   "[sampling]",
                   std::uint8_t,
                   std::uint16_t) {
  using Pixel = TestType;
  using Sample = std::uint16_t;
  constexpr double top = grey_scale_of<Pixel>().saturated;
  test::Random random(53);
  const double odd[] = {0, top, static_cast<double>((std::numeric_limits<Pixel>::max)())};
  const auto any = [&] {
    return static_cast<Pixel>(random.uniform() < 0.1 ? odd[random.whole(0, 2)]
                                                     : random.uniform(0.01, 0.99) * top);
  };
  Image<Pixel> red(400, 500), green(400, 500);
  Index empty = 0;
  for (const int step : {1, 2, 3, 4, 7}) {
    for (std::size_t k = 0; k < red.cells.size(); ++k) {
      red.cells[k] = any();
      green.cells[k] = any();
    }
    const auto [r, g] = samples_of(red, green, step);
    for (Index i = 0; i < r.rows(); ++i) {
      for (Index j = 0; j < r.cols(); ++j) {
        const Sample expected[] = {static_cast<Sample>(naive(red, green, i, j, step) + 0.5),
                                   static_cast<Sample>(naive(green, red, i, j, step) + 0.5)},
                     found[] = {r(i, j), g(i, j)};
        empty += expected[0] == 0 ? 1 : 0;
        for (const std::size_t k : {0U, 1U}) {
          if (found[k] != expected[k]) {
            CAPTURE(step, i, j, k, found[k], expected[k]);
            FAIL("a block differs from its law");
          }
        }
      }
    }
  }
  CHECK(empty > 1000);
}

TEST_CASE("a sampled frame of another size is refused", "[sampling]") {
  const Image<std::uint8_t> frame(6, 8, std::uint8_t(9));
  Image<std::uint16_t> out(3, 4, std::uint16_t(7)), small(3, 3, std::uint16_t(7));
  CHECK_FALSE(sample_frame(frame, frame, 2, as_view(small), as_view(small)));
  CHECK_FALSE(sample_frame(frame, frame, 2, as_view(out), as_view(small)));
  CHECK_FALSE(sample_frame(frame, frame, 3, as_view(out), as_view(out)));
  CHECK_FALSE(sample_frame(frame, frame, 0, as_view(out), as_view(out)));
  CHECK(out(0, 0) == 7);
  CHECK(sample_frame(frame, frame, 2, as_view(out), as_view(out)));
  CHECK(out(2, 3) == 9 * 256);
}

// A row of a frame may contain no pixel of a round pad.
TEST_CASE("rows without a column are read into nothing", "[sampling]") {
  const std::vector<std::uint8_t> bgr(12, std::uint8_t(9));
  const StridedView<const std::uint8_t> red(bgr.data() + 5, 1, 0, 12, 3);
  const StridedView<const std::uint8_t> green(bgr.data() + 4, 1, 0, 12, 3);
  std::vector<std::uint8_t> to_red(3, std::uint8_t(5)), to_green = to_red;
  detail::load_pixels(red, green, 0, 0, 0, to_red.data() + 1, to_green.data() + 1);
  CHECK(to_red == std::vector<std::uint8_t>(3, std::uint8_t(5)));
  CHECK(to_green == to_red);
}

TEST_CASE("a sample's ray is that of the place between its pixels", "[sampling]") {
  rc::prop("at every step", [] {
    test::Pad pad;
    pad.camera.pixel_aspect = test::uniform(0.5, 1.5);
    const int step = static_cast<int>(test::whole(1, 6));
    const double row = test::uniform(0, 47), col = test::uniform(0, 55);
    const auto direct = point_at(pad.camera, row, col, 5.0);
    const auto by_samples =
        point_at(sampled(pad.camera, step), sampled_px(row, step), sampled_px(col, step), 5.0);
    RC_ASSERT(std::abs(direct.x - by_samples.x) < 1e-12);
    RC_ASSERT(std::abs(direct.y - by_samples.y) < 1e-12);
  });
}

TEST_CASE("what changes linearly over the free pad is right between samples", "[sampling]") {
  const test::Pad pad;
  const auto free = pad.reference<double>();
  const int step = GENERATE(2, 3, 4);
  const detail::SampledPad<double> pad_in_samples(free, step);
  const auto& free_samples = pad_in_samples.samples;
  Image<double> samples(free_samples.rows, free_samples.cols);
  Image<PixelStatus> sample_status(samples.rows(), samples.cols(), PixelStatus::ok);
  const auto moved = [](double row, double col) { return -1 + 0.03 * row - 0.02 * col; };
  const auto center = [&](Index k) { return static_cast<double>(step * k) + (step - 1) / 2.0; };
  for (Index i = 0; i < samples.rows(); ++i) {
    for (Index j = 0; j < samples.cols(); ++j) {
      samples(i, j) = free_samples.depth(i, j) + moved(center(i), center(j));
      sample_status(i, j) = std::isnan(samples(i, j)) ? PixelStatus::outside_pad : PixelStatus::ok;
    }
  }
  const Index hole = samples.rows() / 2;
  const bool has_hole = GENERATE(false, true);
  if (has_hole) {
    samples(hole, hole) = test::nan;
    sample_status(hole, hole) = PixelStatus::saturated;
  }
  Image<double> depth(free.rows, free.cols);
  for (Index i = 0; i < free.rows; ++i) {
    for (Index j = 0; j < free.cols; ++j) {
      depth(i, j) = detail::pixel_depth<double>(pad_in_samples, as_view(samples),
                                                as_view(sample_status), i, j);
    }
  }
  Index found = 0;
  double worst = 0;
  for (Index i = 0; i < depth.rows(); ++i) {
    for (Index j = 0; j < depth.cols(); ++j) {
      const bool in_hole = has_hole && i / step == hole && j / step == hole;
      CHECK((std::isnan(depth(i, j)) || (free.in_pad(i, j) && !in_hole)));
      if (!std::isnan(depth(i, j))) {
        ++found;
        const double truth =
            free.depth(i, j) + moved(static_cast<double>(i), static_cast<double>(j));
        worst = (std::max)(worst, std::abs(depth(i, j) - truth));
      }
    }
  }
  const Index in_pad = static_cast<Index>(
      std::count_if(free.depth_mm.begin(), free.depth_mm.end(), [](double l) { return l == l; }));
  CHECK(found >= in_pad - (has_hole ? step * step : 0) - in_pad / 50);
  CHECK(worst < 1e-9);
}

// A frame may hold a single row or column of samples: nothing beside it may be read.
TEST_CASE("what moves a single row or column of samples moves every pixel", "[sampling]") {
  const auto [rows, cols] = GENERATE(std::pair(5, 5), std::pair(5, 12), std::pair(12, 5));
  DepthReference<float> free;
  free.rows = rows;
  free.cols = cols;
  free.depth_mm.assign(static_cast<std::size_t>(rows * cols), 5.0F);
  const detail::SampledPad<float> pad(free, 3);
  const Image<float> samples(pad.samples.rows, pad.samples.cols, 6.0F);
  const Image<PixelStatus> status(samples.rows(), samples.cols(), PixelStatus::ok);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const auto found = detail::pixel_depth(pad, as_view(samples), as_view(status), i, j);
      CHECK(found == 6.0F);
    }
  }
}

TEST_CASE("each plane of a sampled reference holds the means of blocks", "[sampling]") {
  DepthReference<double> free;
  free.rows = 5;
  free.cols = 6;
  for (int k = 0; k < 30; ++k) {
    free.depth_mm.push_back(k);
    free.scattering.push_back(100 + k);
  }
  CHECK(sampled(free, 2).red_gain.empty());
  free.red_gain.assign(30, 1.0);
  free.red_gain[2] = 3;
  free.depth_mm[9] = test::nan;
  const auto half = sampled(free, 2);
  CHECK(half.rows == 2);
  CHECK(half.cols == 3);
  CHECK(half.scattering == std::vector<double>{103.5, 105.5, 107.5, 115.5, 117.5, 119.5});
  CHECK(half.red_gain == std::vector<double>{1, 1.5, 1, 1, 1, 1});
  // a sample is of the pad where all its pixels are
  CHECK(half.depth_mm[0] == 3.5);
  CHECK(std::isnan(half.depth_mm[1]));
  CHECK(half.depth_mm[2] == 7.5);
}

TEST_CASE("sampling refuses steps that no image has", "[sampling]") {
  const auto free = test::Pad().reference<float>();
  CHECK(test::refusal([&] { (void)sampled(free, 0); }) == "sampled: step = 0, must be in 1..16");
  CHECK(test::refusal([&] { (void)sampled(free, 17); }) == "sampled: step = 17, must be in 1..16");
}
