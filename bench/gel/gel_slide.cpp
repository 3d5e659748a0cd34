// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Slide of a contact on a gel, from imprints of 120 x 160 cells (frames of 640 x 480 pixels) and
// their dots. Error: of the imprint's travel, in px, over 10 recordings in which a ball is dragged
// until it slides.
#include "fingerpad/gel/gel_slide.hpp"

#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "support/gel_frames.hpp"

using namespace fingerpad;
using test::Image;

namespace {

struct Frame {
  Image<float> imprint{120, 160};
  Image<std::uint8_t> contact{120, 160};
  test::GelDots dots;
  Point2<double> ball_px;
};

/// A ball is pressed, then dragged in one direction by 0.2 mm a frame.
std::vector<Frame> recording(std::uint64_t seed) {
  const test::GelCamera camera{.rows = 480, .cols = 640, .mm_per_px = 0.04};
  test::Random random(seed);
  test::BallOnGel<> contact(test::GelPad{});
  GelContact gel(std::vector{test::mat_of(camera.frame(contact, random))});
  const double angle = random.uniform(0, 6.28);
  std::vector<Frame> frames;
  for (int k = 0; k < 12; ++k) {
    contact.drag(1.2, {0.2 * k * std::cos(angle), 0.2 * k * std::sin(angle)});
    Frame& frame = frames.emplace_back();
    (void)gel(test::mat_of(camera.frame(contact, random)));
    std::copy(gel.imprint().begin(), gel.imprint().end(), frame.imprint.cells.begin());
    std::copy(gel.mask().begin(), gel.mask().end(), frame.contact.cells.begin());
    frame.dots = camera.dots(contact, random);
    frame.ball_px = camera.px_of(contact.ball_mm());
  }
  return frames;
}

std::vector<double> errors() {
  std::vector<double> errors;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto frames = recording(seed);
    GelSlide slide(120, 160, frames[0].dots);
    for (const Frame& frame : frames) {
      const SlideResult result = slide(frame.imprint, frame.contact, frame.dots);
      errors.push_back(norm(result.imprint_px - (frame.ball_px - frames[0].ball_px)));
    }
  }
  return errors;
}

void add_slide() {
  const auto frames = std::make_shared<const std::vector<Frame>>(recording(99));
  const bench::Memory memory;
  const auto slide = std::make_shared<GelSlide>(120, 160, (*frames)[0].dots);
  bench::add(
      "imprint 120x160/default", 120 * 160, memory.bytes(),
      [=, first = *slide, at = std::size_t{0}]() mutable {
        const Frame& frame = (*frames)[at];
        benchmark::DoNotOptimize((*slide)(frame.imprint, frame.contact, frame.dots));
        at = (at + 1) % frames->size();
        if (at == 0) {
          *slide = first;
        }
      },
      [](auto& counters) { bench::note_errors(counters, "imprint's way", "px", errors()); });
}

/// Translation only, of the whole image.
void add_opencv() {
  const auto frames = std::make_shared<const std::vector<Frame>>(recording(99));
  const auto as_mat = [](const Image<float>& image) {
    cv::Mat mat(120, 160, CV_32F, const_cast<float*>(image.cells.data()));
    cv::patchNaNs(mat);
    return mat;
  };
  bench::add(
      "imprint 120x160/cv::phaseCorrelate", 120 * 160, 0,
      [=, at = std::size_t{0}]() mutable {
        const Frame& from = (*frames)[at];
        const Frame& to = (*frames)[at + 1];
        benchmark::DoNotOptimize(cv::phaseCorrelate(as_mat(from.imprint), as_mat(to.imprint)));
        at = (at + 1) % (frames->size() - 1);
      },
      [](auto&) {});
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  add_slide();
  add_opencv();
  bench::add_streaming("imprint 120x160", 120 * 160);
  return bench::run(argc, argv);
}
