// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Dots and flags in every kind of grid: the same result to the bit. Points of two coordinates are
// in the image in every type, also where p[2] compiles.
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <type_traits>
#include <vector>
#if __has_include(<xtensor/containers/xtensor.hpp>)
#include <xtensor/containers/xarray.hpp>
#include <xtensor/containers/xtensor.hpp>
#include <xtensor/views/xview.hpp>
#else
#include <xtensor/xarray.hpp>
#include <xtensor/xtensor.hpp>
#include <xtensor/xview.hpp>
#endif

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/mdspan.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/adapt/xtensor.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/foreign_image.hpp"
#include "support/slipping_dots.hpp"
#include "support/test_mdspan.hpp"

using namespace fingerpad;

namespace {

constexpr Index n = 21;
constexpr int size = 21;
constexpr std::size_t cells = 21 * 21;

template <class T>
using RowMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
template <class T>
using ColMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

/// Three frames; the first two have been processed.
struct Case {
  test::Image<Point2<float>> dots{n, n};
  test::ContactFlags contact;
  StickRatio<> stick{n, n};
  StickRatio<> after = stick;  ///< the third frame
  StickResult<> result;

  Case() {
    test::SlippingDots truth;
    test::Random random(2);
    for (int k = 0; k < 3; ++k) {
      const auto noisy_dots = noisy(truth.dots, 0.1, random);
      for (std::size_t c = 0; c < cells; ++c) {
        const auto& p = noisy_dots.cells[c];
        dots.cells[c] = {static_cast<float>(p.x), static_cast<float>(p.y)};
      }
      dots(8, 9).y = static_cast<float>(test::nan);
      contact = truth.contact;
      if (k < 2) {
        (void)stick(dots, contact);
      }
      truth.step({.shift_px = 2.5, .direction_rad = 1, .turn_rad = 0.01, .stick_share = 0.6});
    }
    after = stick;
    result = after(dots, contact);
    REQUIRE(result.updated());
    REQUIRE((result.stick > 50 && result.slip > 50 && result.unknown == 1));
  }

  template <class Dots, class Contact>
  bool agrees(const Dots& from, const Contact& flags) const {
    auto copy = stick;
    const auto r = copy(from, flags);
    bool same = r.accepted() && r.status == result.status && r.stick_ratio == result.stick_ratio &&
                r.scale == result.scale && r.furthest == result.furthest;
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        same = same && copy.states()(i, j) == after.states()(i, j);
      }
    }
    return same;
  }
  template <class Dots>
  bool reads_dots(const Dots& from) const {
    return agrees(from, contact);
  }
  template <class Contact>
  bool reads_flags(const Contact& flags) const {
    return agrees(dots, flags);
  }
  template <class Grid, class Make>
  static Grid filled(Grid grid, const Make& make) {
    const auto view = as_view(grid);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        view(i, j) = make(i, j);
      }
    }
    return grid;
  }
};

}  // namespace

TEST_CASE("dots that stick are read from every grid", "[adapt][stick_ratio]") {
  const Case c;
  const auto as = [&](auto point) {
    using P = decltype(point);
    using X = std::remove_cvref_t<decltype(point_traits<P>::x(point))>;
    return [&](Index i, Index j) {
      return P{static_cast<X>(c.dots(i, j).x), static_cast<X>(c.dots(i, j).y)};
    };
  };
  CHECK(c.reads_dots(c.dots));
  CHECK(c.reads_dots(Case::filled(RowMajor<Eigen::Vector2f>(n, n), as(Eigen::Vector2f()))));
  CHECK(c.reads_dots(Case::filled(ColMajor<Eigen::Vector2f>(n, n), as(Eigen::Vector2f()))));
  CHECK(c.reads_dots(Case::filled(cv::Mat_<cv::Vec2f>(size, size), as(cv::Vec2f()))));
  CHECK(c.reads_dots(Case::filled(cv::Mat_<cv::Point2f>(size, size), as(cv::Point2f()))));
  CHECK(c.reads_dots(Case::filled(cv::Mat_<cv::Point2d>(size, size), as(cv::Point2d()))));
  CHECK(c.reads_dots(
      Case::filled(test::ForeignImage<std::array<float, 2>>(n, n), as(std::array<float, 2>()))));
  const std::array<std::size_t, 2> shape = {21, 21};
  CHECK(c.reads_dots(Case::filled(xt::xtensor<cv::Point2f, 2>(shape), as(cv::Point2f()))));
  const auto mapping =
      test::LayoutStride::right(static_cast<test::MdIndex>(n), static_cast<test::MdIndex>(n));
  CHECK(c.reads_dots(test::TestMdspan<const Point2<float>>(c.dots.cells.data(), mapping)));
  std::vector<Point2<float>> memory(4 * cells);
  const StridedView<Point2<float>> backward(&memory.back(), n, n, -4 * n, -2);
  CHECK(c.reads_dots(Case::filled(backward, as(Point2<float>()))));
  CHECK(c.reads_dots(LazyView(n, n, [&](Index i, Index j) { return c.dots(i, j); })));
}

TEST_CASE("dots in tensors and vectors are read without a copy", "[adapt][stick_ratio]") {
  const Case c;
  const auto x = [&](Index i, Index j) { return c.dots(i, j).x; };
  const auto y = [&](Index i, Index j) { return c.dots(i, j).y; };

  const std::array<std::size_t, 3> flat = {21, 21, 2}, deep = {21, 21, 3};
  xt::xtensor<float, 3> tensor(flat), spatial(deep);
  xt::xtensor<float, 3, xt::layout_type::column_major> column_major(flat);
  xt::xarray<float> array = xt::xarray<float>::from_shape({21, 21, 2});
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      tensor(i, j, 0) = column_major(i, j, 0) = array(i, j, 0) = spatial(i, j, 0) = x(i, j);
      tensor(i, j, 1) = column_major(i, j, 1) = array(i, j, 1) = spatial(i, j, 1) = y(i, j);
      spatial(i, j, 2) = 7;
    }
  }
  CHECK(c.reads_dots(dots_of_tensor(tensor)));
  CHECK(c.reads_dots(dots_of_tensor(column_major)));
  CHECK(c.reads_dots(dots_of_tensor(array)));
  CHECK(dots_of_tensor<3>(spatial)(2, 3).z == 7);
  CHECK(rows(dots_of_tensor(spatial)) == 0);
  const xt::xarray<float> line = xt::xarray<float>::from_shape({42});
  CHECK(rows(dots_of_tensor(line)) == 0);
  CHECK(c.reads_dots(grid_of(c.dots.cells, n, n)));
}

TEST_CASE("flags of contact are read from every grid", "[adapt][stick_ratio]") {
  const Case c;
  const auto flag = [&](auto yes, auto no) {
    return [&c, yes, no](Index i, Index j) { return c.contact(i, j) != 0 ? yes : no; };
  };
  CHECK(c.reads_flags(Case::filled(RowMajor<bool>(n, n), flag(true, false))));
  CHECK(c.reads_flags(Case::filled(ColMajor<float>(n, n), flag(-1.0F, 0.0F))));
  CHECK(c.reads_flags(
      Case::filled(cv::Mat_<std::uint8_t>(size, size), flag(std::uint8_t(255), std::uint8_t(0)))));
  CHECK(c.reads_flags(Case::filled(test::ForeignImage<double>(n, n), flag(1.0, test::nan))));
  CHECK(c.reads_flags(LazyView(n, n, flag(Touch::contact, Touch::unknown))));
  const std::array<std::size_t, 2> shape = {21, 21};
  CHECK(c.reads_flags(Case::filled(xt::xtensor<int, 2>(shape), flag(3, 0))));
}
