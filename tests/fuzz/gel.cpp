// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Gel pads from any frames: contact, its slide, and depth from brightness.
// with: -lopencv_core -lopencv_imgproc
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/intensity_depth.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "fuzz/dots.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;

namespace {

GelOptions any_options(Input& in) {
  GelOptions options;
  options.cell_px = static_cast<int>(in.whole(1, 6));
  options.smoothing_px = in.number(options.cell_px / 2.0, 10);
  options.dot_px = in.number(0, 12);
  options.dot_contrast = in.number(0.05, 0.5);
  options.min_difference = in.number(0.01, 0.2);
  options.max_gap_px = in.number(0, 20);
  options.min_region_px = static_cast<int>(in.whole(0, 200));
  return options;
}

template <class Pixel>
cv::Mat_<Pixel> any_frame(Input& in, int rows, int cols, double scale) {
  const Grid<Pixel> cells(in, rows, cols, 50 * scale, 250 * scale);
  cv::Mat_<Pixel> frame(rows, cols);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) {
      frame(i, j) = cells.view()(i, j);
    }
  }
  return frame;
}

/// `scale`: of the grey levels.
template <class Pixel>
void try_slide(Input& in, double scale) {
  const GelOptions options = any_options(in);
  const int rows = options.cell_px * static_cast<int>(in.whole(3, 32)) + in.flag();
  const int cols = options.cell_px * static_cast<int>(in.whole(3, 32)) + in.flag();
  const cv::Mat_<Pixel> first = any_frame<Pixel>(in, rows, cols, scale);
  // two free frames that differ everywhere leave no difference to be seen
  const cv::Mat_<Pixel> second = in.flag() ? first : any_frame<Pixel>(in, rows, cols, scale);
  const std::vector<cv::Mat> free = {first, second};
  GelContact gel(free, options), fresh(free, options);
  SlideOptions slide_options;
  slide_options.cell_px = in.number(0.1, 2);
  slide_options.min_cells = in.whole(30, 60);
  const auto home = fuzz::any_dots<Point2<float>>(in, 4, 5);
  GelSlide slide(gel.mask().rows, gel.mask().cols, home.view(), slide_options);
  for (int frame = 0; frame < 4; ++frame) {
    cv::Mat_<Pixel> now = first.clone();
    // a square is pressed somewhere, with odd pixels beside it
    const cv::Rect square(static_cast<int>(in.whole(0, cols - 1)),
                          static_cast<int>(in.whole(0, rows - 1)),
                          static_cast<int>(in.whole(0, 40)), static_cast<int>(in.whole(0, 40)));
    now(square & cv::Rect({0, 0}, now.size())) = in.cell<Pixel>(0, 250 * scale);
    now(static_cast<int>(in.whole(0, rows - 1)), static_cast<int>(in.whole(0, cols - 1))) =
        in.cell<Pixel>(0, 260 * scale);
    const GelResult r = gel(now), same = fresh(now);
    require(r.status != FrameStatus::refused, "a frame of the right size is accepted");
    require(cv::norm(gel.mask(), fresh.mask(), cv::NORM_INF) == 0 &&
                r.contact_px == same.contact_px && fuzz::same_bits(r.center_px.x, same.center_px.x),
            "the same frame gives the same bits, whatever came before");
    require(r.contact_px == cv::countNonZero(gel.mask()) * options.cell_px * options.cell_px,
            "the area is that of the mask");
    require(!r.in_contact() || is_finite(r.center_px), "a contact has a finite center");
    const auto dots = fuzz::moved_dots(in, home);
    const cv::Mat_<float> imprint = gel.imprint();
    GelSlide copy = slide;
    const auto slid = fuzz::frame([&] { return slide(imprint, gel.mask(), dots.view()); });
    const auto copied = copy(imprint, gel.mask(), dots.view());
    require(slid.status != SlideStatus::refused && slid.status == copied.status &&
                fuzz::same_bits(slid.evidence, copied.evidence),
            "a copy gives the same bits");
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
  require(r != FrameStatus::refused, "a frame of the right size is accepted");
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
        return try_slide<std::uint8_t>(in, 1);
      case 1:
        return try_slide<std::uint16_t>(in, 256);
      case 2:
        return try_intensity<std::uint8_t>(in);
      default:
        return try_intensity<float>(in);
    }
  });
}
