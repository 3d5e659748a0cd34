// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/gel/gel.hpp"

#include <cstdio>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/table.hpp"
#include "fingerpad/core/check.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

constexpr const char* columns =
    "frame,time_s,contact_area_px,contact_center_x_px,contact_center_y_px,slide_status,"
    "dots_in_contact,slide_x_px,slide_y_px,slide_pitches,area_lost,"
    "slip_evidence,slip";

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
      step_(step_of(options, free_, dots)),
      file_(output.file("slide.csv")),
      table_(file_) {
  table_ << columns << '\n';
}

void GelReplay::operator()(int frame,
                           const std::string& time_s,
                           const cv::Mat& image,
                           const DotGrid& dots) {
  GelScene scene{frame, time_s, image, cv::Mat_<uchar>(image.size()), dots, {}};
  scene.seen = step_(image, dots, scene.contact_mask);
  write_row(scene);
  const bool is_known = scene.seen.contact.ok();
  touching_ += is_known && scene.seen.contact.in_contact() ? 1 : 0;
  unlike_ += is_known ? 0 : 1;
  if (scene.seen.slide.alarm && !slip_) {
    slip_ = frame;
  }
  if (options_.pictures) {
    write_picture(output_.file("pictures", numbered("slide_", frame, ".png")),
                  slide_picture(scene));
  }
}

void GelReplay::write_row(const GelScene& row) {
  const GelFrame& seen = row.seen;
  const std::string area = seen.contact.ok() ? std::to_string(seen.contact.contact_px) : "";
  table_ << row.frame << ',' << row.time_s << ',' << area << ','
         << cell_of(seen.contact.center_px.x) << ',' << cell_of(seen.contact.center_px.y) << ','
         << (seen.contact.ok() ? name_of(seen.slide.status) : name_of(seen.contact.status)) << ','
         << seen.slide.dots << ',' << cell_of(seen.slide.slide_px.x) << ','
         << cell_of(seen.slide.slide_px.y) << ',' << cell_of(seen.slide.slide) << ','
         << cell_of(seen.slide.lost) << ',' << cell_of(seen.slide.evidence) << ','
         << (seen.slide.alarm ? 1 : 0) << '\n';
}

void GelReplay::finish() {
  table_.close();
  if (!table_) {
    fail(file_, "cannot be written");
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
