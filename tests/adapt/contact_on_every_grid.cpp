// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// One depth map in every kind of grid gives the same contact, and every kind of grid receives the
// mask.
#include <cstdint>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/catch.hpp"
#include "support/every_grid.hpp"
#include "support/soap_film.hpp"

using namespace fingerpad;
using test::Image;

namespace {

constexpr Index rows_of_map = 50;
constexpr Index cols_of_map = 54;

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
  test::from_every_grid<float>(c.depth, [&](const auto& from) { CHECK(c.reads(from)); });
  test::from_every_grid<double>(c.depth, [&](const auto& from) { CHECK(c.reads(from)); });
}

TEST_CASE("contact is written into every grid", "[adapt][contact_region]") {
  Case c;
  const auto writes = [&](auto&& to) { CHECK(c.writes(to)); };
  test::on_every_grid<std::uint8_t>(rows_of_map, cols_of_map, writes);
  test::on_every_grid<float>(rows_of_map, cols_of_map, writes);
  test::on_every_grid<bool>(rows_of_map, cols_of_map, writes);
}
