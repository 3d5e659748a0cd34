// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// One depth map in every kind of grid gives the same contact, and every kind of grid receives the
// mask.
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>
#if __has_include(<xtensor/containers/xtensor.hpp>)
#include <xtensor/containers/xtensor.hpp>
#else
#include <xtensor/xtensor.hpp>
#endif

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/mdspan.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/adapt/xtensor.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/catch.hpp"
#include "support/foreign_image.hpp"
#include "support/soap_film.hpp"
#include "support/test_mdspan.hpp"

using namespace fingerpad;
using test::fill_from;
using test::Image;

namespace {

constexpr Index rows_of_map = 50;
constexpr Index cols_of_map = 54;

template <class T>
using RowMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
template <class T>
using ColMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

struct Case {
  Image<float> depth;
  ContactRegion<> region;
  Image<std::uint8_t> mask{rows_of_map, cols_of_map};
  ContactResult result;

  Case()
      : depth(test::depths_of<float>(camera(), test::RoundFilm({}), rows_of_map, cols_of_map)),
        region(camera(), rows_of_map, cols_of_map, {.ring_px = 5}) {
    depth(20, 20) = static_cast<float>(test::nan);
    result = region(depth, mask);
    REQUIRE(result.contact_px > 900);
  }
  static OrthographicCamera<double> camera() {
    return test::height_map(rows_of_map, cols_of_map, 0.32);
  }

  template <class Depth>
  bool reads(const Depth& from) {
    Image<std::uint8_t> out(rows_of_map, cols_of_map, 3);
    const ContactResult r = region(from, out);
    return r.ok() && out.cells == mask.cells && r.area_mm2 == result.area_mm2 &&
           r.depth_mm == result.depth_mm && r.unknown_px == result.unknown_px;
  }
  template <class Depth>
  bool reads_filled(Depth from) {
    fill_from(from, depth);
    return reads(from);
  }
  template <class Mask>
  bool writes(Mask&& to) {
    const auto view = as_view(to);
    using Cell = cell_t<Mask>;
    if (!region(depth, to).ok()) {
      return false;
    }
    for (Index i = 0; i < rows_of_map; ++i) {
      for (Index j = 0; j < cols_of_map; ++j) {
        if (static_cast<Cell>(view(i, j)) != static_cast<Cell>(mask(i, j))) {
          return false;
        }
      }
    }
    return true;
  }
};

}  // namespace

TEST_CASE("contact is read from every grid", "[adapt][contact_region]") {
  Case c;
  const auto r = static_cast<int>(rows_of_map);
  const auto k = static_cast<int>(cols_of_map);
  CHECK(c.reads_filled(RowMajor<float>(rows_of_map, cols_of_map)));
  CHECK(c.reads_filled(ColMajor<float>(rows_of_map, cols_of_map)));
  CHECK(c.reads_filled(RowMajor<double>(rows_of_map, cols_of_map)));
  CHECK(c.reads_filled(cv::Mat_<float>(r, k)));
  CHECK(c.reads_filled(test::ForeignImage<float>(rows_of_map, cols_of_map)));
  const std::array<std::size_t, 2> shape = {rows_of_map, cols_of_map};
  CHECK(c.reads_filled(xt::xtensor<float, 2>(shape)));
  CHECK(c.reads_filled(xt::xtensor<float, 2, xt::layout_type::column_major>(shape)));
  const auto mapping = test::LayoutStride::right(static_cast<test::MdIndex>(rows_of_map),
                                                 static_cast<test::MdIndex>(cols_of_map));
  CHECK(c.reads(test::TestMdspan<const float>(c.depth.cells.data(), mapping)));
  std::vector<float> rotated(static_cast<std::size_t>(4 * rows_of_map * cols_of_map));
  const StridedView<float> back(&rotated.back(), rows_of_map, cols_of_map, -4 * cols_of_map, -2);
  fill_from(back, c.depth);
  CHECK(c.reads(back));
  CHECK(
      c.reads(LazyView(rows_of_map, cols_of_map, [&](Index i, Index j) { return c.depth(i, j); })));
}

TEST_CASE("contact is written into every grid", "[adapt][contact_region]") {
  Case c;
  CHECK(c.writes(RowMajor<std::uint8_t>(rows_of_map, cols_of_map)));
  CHECK(c.writes(ColMajor<float>(rows_of_map, cols_of_map)));
  CHECK(c.writes(RowMajor<bool>(rows_of_map, cols_of_map)));
  CHECK(c.writes(
      cv::Mat_<std::uint8_t>(static_cast<int>(rows_of_map), static_cast<int>(cols_of_map))));
  CHECK(c.writes(test::ForeignImage<std::uint8_t>(rows_of_map, cols_of_map)));
  const std::array<std::size_t, 2> shape = {rows_of_map, cols_of_map};
  CHECK(c.writes(xt::xtensor<std::uint8_t, 2>(shape)));
  std::vector<std::uint8_t> memory(static_cast<std::size_t>(rows_of_map * cols_of_map));
  CHECK(c.writes(
      StridedView<std::uint8_t>(&memory.back(), rows_of_map, cols_of_map, -cols_of_map, -1)));
}
