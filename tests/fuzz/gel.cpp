// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Gel pads from any frames: contact by difference, its slide, and depth from brightness.
#include <cstdint>
#include <vector>

#include "fingerpad/contact/contact_by_difference.hpp"
#include "fingerpad/depth/intensity_depth.hpp"
#include "fingerpad/slip/contact_slide.hpp"
#include "fuzz/dots.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;

namespace {

DifferenceTest any_test(Input& in) {
  DifferenceTest test;
  test.cell_px = in.whole(1, 6);
  test.smoothing_px = in.number(1, 10);
  test.dot_px = in.number(0, 12);
  test.dot_contrast = in.number(0.05, 0.5);
  test.min_difference = in.number(0.01, 0.2);
  test.max_gap_px = in.number(0, 20);
  test.min_region_px = in.whole(0, 200);
  return test;
}

template <class Pixel>
void try_slide(Input& in) {
  const Index rows = in.side(0, 32), cols = in.side(0, 32);
  const Grid<Pixel> first(in, rows, cols, 50, 250);
  // two free frames that differ everywhere leave no difference to be seen
  const Grid<Pixel> second = in.flag() ? first : Grid<Pixel>(in, rows, cols, 50, 250);
  const std::vector free = {first.view(), second.view()};
  const ContactByDifference<1> contact(free, any_test(in));
  auto work = contact.workspace(), fresh = contact.workspace();
  const auto cells = work.difference();
  SlideTest test;
  test.pitch_px = in.number(2, 40);
  test.cell_px = in.number(1, 6);
  test.min_cells = in.whole(30, 60);
  const ContactSlide<> slide(cells.rows(), cells.cols(), 4, 5, test);
  auto state = slide.start();
  Grid<std::uint8_t> mask(rows, cols), again(rows, cols);
  const auto home = fuzz::any_dots<Point2<float>>(in, 4, 5);
  for (int frame = 0; frame < 4; ++frame) {
    Grid<Pixel> now = first;
    // a square is pressed somewhere, with odd pixels beside it
    const Index row = in.whole(0, rows - 1), col = in.whole(0, cols - 1), size = in.whole(0, 40);
    const Pixel pressed = in.cell<Pixel>(0, 250), odd = in.cell<Pixel>(0, 260);
    for (Index i = row; i < (std::min)(rows, row + size); ++i) {
      for (Index j = col; j < (std::min)(cols, col + size); ++j) {
        now.view()(i, j) = pressed;
      }
    }
    now.view()(in.whole(0, rows - 1), in.whole(0, cols - 1)) = odd;
    const auto r = fuzz::frame([&] { return contact(now.view(), mask.view(), work); });
    const auto same = contact(now.view(), again.view(), fresh);
    require(r.accepted(), "a frame of the right size is accepted");
    require(
        mask == again && fuzz::same_bits(r.area_mm2, same.area_mm2) && r.regions == same.regions,
        "the same frame gives the same bits, whatever came before");
    require(is_finite(r.area_mm2) && r.area_mm2 >= 0, "an area is finite and not negative");
    require(!r.in_contact() || (is_finite(r.center_mm.x) && is_finite(r.center_mm.y)),
            "a contact has a finite center");
    const auto dots = fuzz::moved_dots(in, home);
    auto copy = state;
    const auto slid =
        fuzz::frame([&] { return slide(work.imprint(), work.contact(), dots.view(), state); });
    const auto copied = slide(work.imprint(), work.contact(), dots.view(), copy);
    require(slid.accepted() && slid.status == copied.status &&
                fuzz::same_bits(slid.evidence, copied.evidence),
            "a copied state gives the same bits");
    require(is_finite(slid.slide_px) && slid.evidence >= 0 && slid.lost >= 0 && slid.lost <= 1,
            "a slide is finite and a share is in [0, 1]");
    require(slid.held() >= 0 && slid.held() <= 1, "the held share is in [0, 1]");
  }
}

template <class Pixel>
void try_intensity(Input& in) {
  const Index rows = in.side(0, 40), cols = in.side(0, 40);
  IntensityOptions options;
  options.smoothing_px = in.flag() ? in.number(0, 6) : 0;
  const Grid<Pixel> free(in, rows, cols, 0, 260);
  IntensityDepth<> estimate(free.view(), {in.number(0.1, 5), in.number(-1, 1), in.number(-1, 1)},
                            options);
  Grid<Pixel> now(in, rows, cols, 0, 260);
  Grid<float> depth(rows, cols), again(rows, cols);
  const auto r = fuzz::frame([&] { return estimate(now.view(), depth.view()); });
  require(r.accepted(), "a frame of the right size is accepted");
  Index valid = 0;
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      valid += is_finite(depth.view()(i, j)) ? 1 : 0;
    }
  }
  require(valid == r.valid_px, "valid_px is the number of depths");
  const Index row = in.whole(0, rows - 1), col = in.whole(0, cols - 1);
  now.view()(row, col) = in.cell<Pixel>(0, 260);
  (void)estimate(now.view(), again.view());
  const auto reach = static_cast<Index>(std::ceil(6 * options.smoothing_px)) + 1;
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      require((std::abs(i - row) <= reach && std::abs(j - col) <= reach) ||
                  fuzz::same_bits(depth.view()(i, j), again.view()(i, j)),
              "pixels beyond the mean are unchanged");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, [](Input& in) {
    switch (in.whole(0, 3)) {
      case 0:
        return try_slide<std::uint8_t>(in);
      case 1:
        return try_slide<float>(in);
      case 2:
        return try_intensity<std::uint8_t>(in);
      default:
        return try_intensity<float>(in);
    }
  });
}
