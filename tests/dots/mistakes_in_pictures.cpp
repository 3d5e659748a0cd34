// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Mistakes in the pictures of printed dots, and the response to each: a status, the message of a
// refusal, "right" or "another motion". docs/mistakes.md has the reason of each that is not told.
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/dots/dot_finder.hpp"
#include "support/catch.hpp"
#include "support/mistakes.hpp"
#include "support/printed_dots.hpp"

using namespace fingerpad;
using test::check;
using test::Mistake;

namespace {

/// An image of the free pad, and one of the displaced pad.
struct Pictures {
  test::Print print;
  DotFinderOptions options;
  cv::Vec2d by{4, -3};
  cv::Mat free, now;

  Pictures() {
    print.noise = 1;
    const auto places = test::places_of(print);
    free = test::picture_of(print, places);
    now = test::picture_of(print, test::moved(places, by));
  }
};

/// Row i begins i pixels late.
cv::Mat with_padding(const cv::Mat& picture) {
  cv::Mat out = picture.clone();
  for (int i = 0; i < out.rows; ++i) {
    for (int j = 0; j < out.cols; ++j) {
      out.at<cv::Vec3b>(i, j) = picture.at<cv::Vec3b>(i, (j + i) % out.cols);
    }
  }
  return out;
}

std::string said_of_finder(const Pictures& pictures) {
  DotFinder finder(pictures.free, pictures.options);
  if (!finder.ok()) {
    return finder.refusal();
  }
  test::DotPlaces dots(static_cast<int>(finder.rows()), static_cast<int>(finder.cols()));
  const DotResult result = finder(pictures.now, dots);
  if (!result.ok()) {
    return name_of(result.status);
  }
  int count = 0, right = 0;
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      const auto from = finder.free_px()(i, j);
      const cv::Vec2d by = dots(i, j) - cv::Vec2d(from.x, from.y);
      if (is_present(by)) {
        ++count;
        right += cv::norm(by - pictures.by) < 0.5 ? 1 : 0;
      }
    }
  }
  return right > 0 && right == count ? "right" : "another motion";
}

}  // namespace

TEST_CASE("mistakes: printed dots in pictures", "[mistakes][figures]") {
  const Mistake<Pictures> mistakes[] = {
      {"none", [](Pictures&) {}, "right"},
      {"now transposed", [](Pictures& p) { cv::transpose(p.now, p.now); }, "refused"},
      {"both transposed",
       [](Pictures& p) {
         cv::transpose(p.now, p.now);
         cv::transpose(p.free, p.free);
       },
       "another motion"},
      {"now mirrored", [](Pictures& p) { cv::flip(p.now, p.now, 1); }, "another motion"},
      {"now upside down", [](Pictures& p) { cv::flip(p.now, p.now, 0); }, "another motion"},
      {"both mirrored",
       [](Pictures& p) {
         cv::flip(p.now, p.now, 1);
         cv::flip(p.free, p.free, 1);
       },
       "another motion"},
      {"the pad a pitch on, which is followed",
       [](Pictures& p) {
         p.by = {24, 0};
         p.now = test::picture_of(p.print, test::moved(test::places_of(p.print), p.by));
       },
       "right"},
      {"padded rows now", [](Pictures& p) { p.now = with_padding(p.now); }, "lost"},
      {"padded rows in both",
       [](Pictures& p) { p.now = with_padding(p.now), p.free = with_padding(p.free); },
       "beside them"},
      {"negative now", [](Pictures& p) { p.now = 255 - p.now; }, "lost"},
      {"constant now", [](Pictures& p) { p.now.setTo(100); }, "lost"},
      {"black now", [](Pictures& p) { p.now.setTo(0); }, "lost"},
      {"half black now", [](Pictures& p) { p.now.rowRange(0, 120).setTo(0); }, "ambiguous"},
      {"halves exchanged now",
       [](Pictures& p) {
         cv::Mat w;
         cv::hconcat(p.now.colRange(160, 320), p.now.colRange(0, 160), w);
         p.now = w;
       },
       "lost"},
      {"a tenth of the light", [](Pictures& p) { p.now = p.now / 10; }, "right"},
      {"saturated", [](Pictures& p) { p.now = p.now * 9; }, "lost"},
      {"channels exchanged", [](Pictures& p) { cv::cvtColor(p.now, p.now, cv::COLOR_BGR2RGB); },
       "right"},
      {"12 bits in 16", [](Pictures& p) { p.now.convertTo(p.now, CV_16U, 16); }, "right"},
      {"8 bits in 16", [](Pictures& p) { p.now.convertTo(p.now, CV_16U, 1); }, "lost"},
      {"floating point", [](Pictures& p) { p.now.convertTo(p.now, CV_32F); }, "refused"},
      {"another size", [](Pictures& p) { p.now = p.now.colRange(0, 319).clone(); }, "refused"},
      {"half size now", [](Pictures& p) { p.now = p.now.rowRange(0, 120).clone(); }, "refused"},
      {"zoomed",
       [](Pictures& p) {
         cv::Mat z;
         cv::resize(p.now, z, {}, 2, 2);
         p.now = z(cv::Rect(160, 120, 320, 240)).clone();
       },
       "lost"},
      {"another pad's free frame",
       [](Pictures& p) {
         auto o = p.print;
         o.pitch_px = 17;
         o.radius_px = 4;
         p.free = test::picture_of(o, test::places_of(o));
       },
       "lost"},
      {"free and now exchanged", [](Pictures& p) { std::swap(p.free, p.now); }, "another motion"},
      {"rows and cols exchanged",
       [](Pictures& p) {
         p.options.pattern.rows = 11;
         p.options.pattern.cols = 8;
       },
       "8 rows and 11 columns of dots, not 11 and 8"},
      {"fewer rows than there are",
       [](Pictures& p) {
         p.options.pattern.rows = 5;
         p.options.pattern.cols = 5;
       },
       "8 rows and 11 columns of dots, not 5 and 5"},
      {"more rows than there are",
       [](Pictures& p) {
         p.options.pattern.rows = 12;
         p.options.pattern.cols = 14;
       },
       "8 rows and 11 columns of dots, not 12 and 14"},
      {"radius in mm",
       [](Pictures& p) {
         p.options.pattern.radius_px = 0.4;
         p.options.pattern.pitch_px = 2;
       },
       "radius_px = 0.4"},
      {"radius times 1000",
       [](Pictures& p) {
         p.options.pattern.radius_px = 5000;
         p.options.pattern.pitch_px = 24000;
       },
       "radius_px = 5000"},
      {"radius twice",
       [](Pictures& p) {
         p.options.pattern.radius_px = 10;
         p.options.pattern.pitch_px = 24;
       },
       "no grid of 9 or more dots"},
      {"pitch twice",
       [](Pictures& p) {
         p.options.pattern.radius_px = 5;
         p.options.pattern.pitch_px = 48;
       },
       "px apart, not 48"},
      {"bright for dark", [](Pictures& p) { p.options.pattern.bright = true; },
       "no grid of 9 or more dots"},
  };
  check(mistakes, said_of_finder);
}
