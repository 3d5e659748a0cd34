// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Window means at the limits of their arithmetic: largest windows of largest values, running sums
// over long columns, images smaller than the window.
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/depth/depth.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Frame;
using test::Image;

namespace {

template <class Mean>
struct Means {
  Image<Mean> red, green, outer_red;
};

/// Pixels between two levels count.
struct Limits {
  double dark, saturated;
};

/// All means of a frame, over a window and one that is 2 px wider.
template <class Pixel, class Mean = float>
Means<Mean> means_of(const Frame<Pixel>& frame,
                     const Image<std::uint8_t>& inside,
                     int window,
                     const Limits& limits) {
  const Index rows = frame.red.rows();
  const Index cols = frame.red.cols();
  Means<Mean> out{Image<Mean>(rows, cols), Image<Mean>(rows, cols), Image<Mean>(rows, cols)};
  const auto counts = [&](Pixel x) {
    return static_cast<double>(x) > limits.dark && static_cast<double>(x) < limits.saturated;
  };
  using Number = std::conditional_t<sizeof(Pixel) == 8, std::uint64_t, std::uint32_t>;
  const auto load = [&](Index row, Number* red, Number* green, std::uint32_t* valid) {
    for (Index j = 0; j < cols; ++j) {
      valid[j] = inside(row, j) != 0 && counts(frame.red(row, j)) && counts(frame.green(row, j));
      red[j] = valid[j] != 0 ? static_cast<Number>(frame.red(row, j)) : Number(0);
      green[j] = valid[j] != 0 ? static_cast<Number>(frame.green(row, j)) : Number(0);
    }
  };
  detail::WindowMeans<Number, Mean> sums(rows, cols, {window, window + 2});
  const auto blocks = static_cast<std::size_t>((cols + 63) / 64 * 64);
  std::vector<Mean> red(blocks), green(blocks), outer(blocks);
  sums.start(load);
  for (Index i = 0; i < rows; ++i) {
    sums.advance(load, red.data(), green.data(), outer.data());
    std::copy_n(red.data(), cols, &out.red(i, 0));
    std::copy_n(green.data(), cols, &out.green(i, 0));
    std::copy_n(outer.data(), cols, &out.outer_red(i, 0));
  }
  return out;
}

}  // namespace

TEST_CASE("the largest window of the largest 16-bit numbers", "[window]") {
  const int level = GENERATE(-32768, 32768);
  Frame<std::int32_t> frame(256, 270, level);
  frame.green = Image<std::int32_t>(256, 270, 65535);
  const Image<std::uint8_t> all(256, 270, 1);
  const auto means = means_of(frame, all, 253, {-40000, 70000});
  // 65025 * 32768 fits into 31 bits and is rounded to float once, times a rounded reciprocal
  CHECK(means.outer_red(127, 140) == Approx(level).epsilon(2e-7));
  CHECK(means.green(0, 269) == Approx(65535).epsilon(2e-7));
  CHECK(means.green(127, 140) == Approx(65535).epsilon(2e-7));
}

TEST_CASE("whole numbers have exact sums, rounded as a box filter does", "[window]") {
  rc::prop("in any frame", [] {
    using Pixel = std::int32_t;
    const Index rows = test::whole(1, 30);
    const Index cols = test::whole(1, 150);
    test::Random random(static_cast<std::uint64_t>(test::whole(0, 1 << 30)));
    Frame<Pixel> frame(rows, cols);
    Image<std::uint8_t> inside(rows, cols);
    const double share = test::uniform(0, 1);
    const bool bytes = test::whole(0, 1) == 0;
    const Index top = bytes ? 255 : 32768, lowest = bytes ? 0 : -32768;
    for (std::size_t k = 0; k < frame.red.cells.size(); ++k) {
      frame.red.cells[k] = static_cast<Pixel>(random.whole(lowest, top));
      frame.green.cells[k] = static_cast<Pixel>(random.whole(0, top - lowest));
      inside.cells[k] = random.uniform() < share ? 0 : 1;
    }
    const double dark = static_cast<double>(test::whole(lowest - 1, top / 4)) + 0.5;
    const double saturated = static_cast<double>(test::whole(top / 2, 2 * top));
    const int window = 3 + 2 * static_cast<int>(test::whole(0, 20));
    const auto means = means_of(frame, inside, window, {dark, saturated});
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        for (const Index r : {Index(window / 2), Index(window / 2 + 1)}) {
          std::int32_t red = 0, green = 0, count = 0;
          for (Index p = (std::max)(i - r, Index(0)); p <= (std::min)(i + r, rows - 1); ++p) {
            for (Index q = (std::max)(j - r, Index(0)); q <= (std::min)(j + r, cols - 1); ++q) {
              const auto good = [&](Pixel x) { return x > dark && x < saturated; };
              if (inside(p, q) != 0 && good(frame.red(p, q)) && good(frame.green(p, q))) {
                red += frame.red(p, q);
                green += frame.green(p, q);
                ++count;
              }
            }
          }
          const auto mean = [&](std::int32_t sum) {
            return count == 0 ? std::numeric_limits<float>::quiet_NaN()
                              : float(sum) * (1.0f / float(count));
          };
          if (r == window / 2) {
            RC_ASSERT(test::same_bits(means.red(i, j), mean(red)));
            RC_ASSERT(test::same_bits(means.green(i, j), mean(green)));
          } else {
            RC_ASSERT(test::same_bits(means.outer_red(i, j), mean(red)));
          }
        }
      }
    }
  });
}

TEMPLATE_TEST_CASE("a block has the means of a million pixels one by one",
                   "[window]",
                   float,
                   double) {
  using S = TestType;
  using Pixel = std::conditional_t<std::is_same_v<S, float>, std::int32_t, std::int64_t>;
  const Index rows = 1000, cols = 1003;
  const double top = std::is_same_v<S, float> ? 32767 : 0x1p47;
  const int window = 7;
  test::Random random(9);
  Frame<Pixel> frame(rows, cols);
  Image<std::uint8_t> inside(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      frame.red(i, j) = static_cast<Pixel>(random.uniform(-top, top));
      frame.green(i, j) = static_cast<Pixel>(random.uniform(0, top));
      // patches without a pixel that counts are wider than the window
      inside(i, j) = (i / 16 + j / 16) % 3 == 0 || random.uniform() < 0.1 ? 0 : 1;
    }
  }
  const auto means = means_of<Pixel, S>(frame, inside, window, {-2 * top, 2 * top});
  // Sums over all pixels above and to the left, modulo 2^64: their differences over a window are
  // exact.
  const auto sums_of = [&](const auto& value) {
    Image<std::uint64_t> sums(rows + 1, cols + 1);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        sums(i + 1, j + 1) = static_cast<std::uint64_t>(std::int64_t(inside(i, j)) * value(i, j)) +
                             sums(i, j + 1) + sums(i + 1, j) - sums(i, j);
      }
    }
    return sums;
  };
  const auto reds = sums_of([&](Index i, Index j) { return std::int64_t(frame.red(i, j)); });
  const auto greens = sums_of([&](Index i, Index j) { return std::int64_t(frame.green(i, j)); });
  const auto counts = sums_of([](Index, Index) { return std::int64_t(1); });
  Index missing = 0;
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      for (const Index r : {Index(window / 2), Index(window / 2 + 1)}) {
        const Index top_row = (std::max)(i - r, Index(0)), left = (std::max)(j - r, Index(0));
        const Index below = (std::min)(i + r + 1, rows), right = (std::min)(j + r + 1, cols);
        const auto within = [&](const Image<std::uint64_t>& sums) {
          return static_cast<std::int64_t>(sums(below, right) - sums(top_row, right) -
                                           sums(below, left) + sums(top_row, left));
        };
        const std::int64_t red = within(reds), green = within(greens), count = within(counts);
        missing += count == 0 ? 1 : 0;
        const auto law = [&](std::int64_t sum) {
          return count == 0 ? std::numeric_limits<S>::quiet_NaN() : S(sum) / S(count);
        };
        const bool is_inner = r == window / 2;
        const S found = is_inner ? means.red(i, j) : means.outer_red(i, j);
        if (!test::within_ulps(found, law(red), 2) ||
            (is_inner && !test::within_ulps(means.green(i, j), law(green), 2))) {
          CAPTURE(i, j, r, count, found, law(red), means.green(i, j), law(green));
          FAIL("a block differs from its law");
        }
      }
    }
  }
  CHECK(missing > 1000);
}

TEMPLATE_TEST_CASE("rounding does not pile up down a long image", "[window]", float, double) {
  // A bright band followed by 400 rows of 1e-3 of it: a remainder of the band would be visible.
  using S = TestType;
  const Index rows = 440;
  Frame<std::int64_t> frame(rows, 9);
  const Image<std::uint8_t> all(rows, 9, 1);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < 9; ++j) {
      const double wave = 1 + 0.3 * std::sin(static_cast<double>(3 * i + 5 * j));
      const double red = i < 40 ? 250 * wave / 1.3 : 0.25 * wave;
      frame.red(i, j) = static_cast<std::int64_t>(red * 0x1p38);
      frame.green(i, j) = static_cast<std::int64_t>(100 * wave * 0x1p38);
    }
  }
  const auto means = means_of<std::int64_t, S>(frame, all, 5, {0, 255 * 0x1p38});
  double worst = 0;
  for (Index i = 50; i < rows - 2; ++i) {
    std::int64_t sum = 0;
    for (Index p = i - 2; p <= i + 2; ++p) {
      for (Index q = 2; q <= 6; ++q) {
        sum += frame.red(p, q);
      }
    }
    const S mean = S(sum) / S(25);
    worst = (std::max)(worst, static_cast<double>(test::relative_error(means.red(i, 4), mean)));
  }
  CHECK(worst <= 2 * static_cast<double>(epsilon<S>()));  // the sum, the reciprocal, the product
}

TEST_CASE("windows and images that cannot be are refused", "[window]") {
  using Sums = detail::WindowMeans<std::uint32_t>;
  CHECK_NOTHROW(Sums(1, 1, {3, 255}));
  CHECK_THROWS_AS(Sums(0, 1, {3, 5}), parameter_error);
  CHECK_THROWS_AS(Sums(1, 0, {3, 5}), parameter_error);
  CHECK_THROWS_AS(Sums(9, 9, {5, 5}), parameter_error);
  CHECK_THROWS_AS(Sums(9, 9, {5, 3}), parameter_error);
  CHECK_THROWS_AS(Sums(9, 9, {1, 3}), parameter_error);
  CHECK_THROWS_AS(Sums(9, 9, {4, 7}), parameter_error);
  CHECK_THROWS_AS(Sums(9, 9, {3, 257}), parameter_error);
}

TEST_CASE("interleaved rows come apart", "[window]") {
  rc::prop("for two to five channels and any length", [] {
    const auto check = [](auto channels, auto pixel) {
      using Pixel = decltype(pixel);
      constexpr int c = decltype(channels)::value;
      const Index n = test::whole(0, 100);
      std::vector<Pixel> from(static_cast<std::size_t>(c * n));
      for (std::size_t k = 0; k < from.size(); ++k) {
        from[k] = static_cast<Pixel>(k * 7 + 1);
      }
      const int r = static_cast<int>(test::whole(0, c - 1));
      const int g = static_cast<int>(test::whole(0, c - 1));
      std::vector<Pixel> red(static_cast<std::size_t>(n)), green(red.size());
      const StridedView<const Pixel> reds(from.data() + r, 1, n, c * n, c);
      const StridedView<const Pixel> greens(from.data() + g, 1, n, c * n, c);
      const Index half = n / 2;  // in two pieces, as blocks are read
      detail::load_pixels(reds, greens, 0, 0, half, red.data(), green.data());
      detail::load_pixels(reds, greens, 0, half, n - half, red.data() + half, green.data() + half);
      for (std::size_t k = 0; k < red.size(); ++k) {
        RC_ASSERT(red[k] == from[k * c + static_cast<std::size_t>(r)]);
        RC_ASSERT(green[k] == from[k * c + static_cast<std::size_t>(g)]);
      }
    };
    check(std::integral_constant<int, 2>{}, std::uint8_t{});
    check(std::integral_constant<int, 3>{}, std::uint8_t{});
    check(std::integral_constant<int, 4>{}, std::uint8_t{});
    check(std::integral_constant<int, 5>{}, std::uint8_t{});
    check(std::integral_constant<int, 3>{}, std::uint16_t{});
  });
}

TEST_CASE("black and saturated pixels do not count, all between them do", "[window]") {
  // A row with one pixel of each level, without smoothing: the first and the last that counts.
  const auto range_of = [](auto pixel, double units) {
    using Pixel = decltype(pixel);
    const Index n = Index((std::numeric_limits<Pixel>::max)()) + 1;
    DepthReference<float> reference;
    reference.rows = 1;
    reference.cols = reference.pixels_used = n;
    reference.depth_mm.assign(std::size_t(n), 1.0F);
    reference.scattering.assign(std::size_t(n), 0.02F);
    detail::ColourRows<float> rows({}, {}, reference, {0, 0, 1, n}, 1, 1);
    const LazyView level(1, n, [](Index, Index j) { return static_cast<Pixel>(j); });
    std::vector<float> red(std::size_t(n + 64)), green = red;
    rows.start(level, level);
    rows.next(level, level, red.data(), green.data());
    std::pair<Index, Index> range(1, 0);
    for (Index j = n - 1; j >= 0; --j) {
      const float x = red[std::size_t(j)];
      REQUIRE(std::isnan(x) == std::isnan(green[std::size_t(j)]));
      if (!std::isnan(x)) {
        CHECK(x == Approx(double(j) / units));
        range = {j, range == std::pair<Index, Index>(1, 0) ? j : range.second};
      }
    }
    return range;
  };
  using Range = std::pair<Index, Index>;
  CHECK(range_of(std::uint8_t(), 1) == Range(1, 254));
  CHECK(range_of(std::uint16_t(), 256) == Range(1, 65279));
}
