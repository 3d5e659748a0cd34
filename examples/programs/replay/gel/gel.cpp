// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/gel/gel.hpp"

#include <cstdio>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "fingerpad/core/check.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

SlideStep step_of(const Options& options, const FreePad& free, const DotSource& dots) {
  try {
    return {free.frames, dots.initial(), dots.diameter_px(), dots.bright()};
  } catch (const fingerpad::parameter_error& error) {
    fail(options.recording, error.what());
  }
}

}  // namespace

GelReplay::GelReplay(Recording& recording,
                     const Options& options,
                     const DotSource& dots,
                     const OutputFolder& output)
    : options_(options),
      output_(output),
      free_(free_pad_of(recording, dots)),
      step_(step_of(options, free_, dots)) {}

void GelReplay::operator()(Scene& scene) {
  scene.gel = step_(scene.image, scene.dots.dots_px, scene.contact_mask);
  const GelFrame& seen = *scene.gel;
  const bool is_known = seen.contact.ok();
  touching_ += is_known && seen.contact.in_contact() ? 1 : 0;
  unlike_ += is_known ? 0 : 1;
  if (seen.slide.alarm && !slip_) {
    slip_ = scene.frame;
  }
  if (options_.pictures) {
    write_picture(output_.file("pictures", numbered("slide_", scene.frame, ".png")),
                  slide_picture(scene));
  }
}

void GelReplay::print_summary() const {
  std::printf("free pad     %zu %s from %s\n", free_.frames.size(),
              free_.frames.size() == 1 ? "frame" : "frames", free_.source.c_str());
  for (const Finding& finding : free_.told) {
    std::printf("%-12s %s: %s. %s\n", finding.is_wrong ? "wrong" : "note", finding.place.c_str(),
                finding.what.c_str(), finding.remedy.c_str());
  }
  std::printf("contact      in %d frames\n", touching_);
  if (unlike_ > 0) {
    std::printf("cannot tell  in %d frames: most of the picture differs from the free pad\n",
                unlike_);
  }
  if (slip_) {
    std::printf("slip         first detected in frame %d\n", *slip_);
  } else {
    std::printf("slip         none\n");
  }
  std::printf("slide step   %.2f ms per frame (median, including the contact)\n",
              step_.median_ms());
}

}  // namespace replay
