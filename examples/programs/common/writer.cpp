// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/writer.hpp"

#include <string>
#include <utility>

#include "common/images.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

constexpr int montage_columns = 6;

}  // namespace

Writer::Writer(const Recording& recording,
               const Options& options,
               const DotGrid& initial_dots,
               int total)
    : options_(options),
      brightest_(brightest_level(recording.reference)),
      initial_dots_(initial_dots),
      total_(total),
      output_(options.out),
      table_(output_.file("frames.csv"), frame_columns()) {
  if (!recording.sensor.dots_only) {
    painter_.emplace(recording.sensor, recording.reference_depth, brightest_);
  }
  if (!initial_dots.empty()) {
    dots_.emplace(output_.file("dots.csv"), dot_columns());
  }
}

void Writer::operator()(Scene scene) {
  rows_.push_back(scene);
  table_.write(rows_.back());
  if (dots_) {
    for (int i = 0; i < scene.dots.dots_px.rows; ++i) {
      for (int j = 0; j < scene.dots.dots_px.cols; ++j) {
        if (is_present(scene.dots.dots_px(i, j))) {
          dots_->write({scene.frame, i, j, scene.dots});
        }
      }
    }
  }
  if (options_.raw && painter_) {
    write_depth_image(file("depth", "", scene, ".tiff"), scene.depth_mm);
    write_png(file("contact", "", scene, ".png"), scene.contact_mask);
  }
  if (options_.pictures) {
    if (painter_) {
      scene.section = painter_->find_section(scene.depth_mm);
    }
    write_pictures(scene);
    if (painter_ && is_chosen(static_cast<int>(rows_.size()) - 1, total_, montage_columns)) {
      columns_.push_back(std::move(scene));
    }
  }
}

void Writer::write_pictures(const Scene& scene) {
  if (painter_) {
    write_picture(file("pictures", "depth_", scene, ".png"), painter_->depth(scene));
    write_picture(file("pictures", "side_", scene, ".png"), painter_->side(scene));
    write_picture(file("pictures", "contact_", scene, ".png"),
                  painter_->contact(scene, initial_dots_));
    if (scene.traction.present()) {
      write_picture(file("pictures", "traction_", scene, ".png"), painter_->traction(scene));
    }
  }
  if (dots_) {
    // Without a free pad each frame sets its own level; a camera's first frames may be dark.
    const double brightest = painter_ ? brightest_ : brightest_level(scene.image);
    write_picture(file("pictures", "stick_", scene, ".png"), stick_picture(scene, brightest));
  }
}

void Writer::finish() {
  if (options_.pictures && painter_) {
    const std::string name = std::filesystem::canonical(options_.recording).filename().string();
    const std::string title = name + ": " + std::to_string(rows_.size()) + " frames";
    write_picture(output_.file("pictures", "montage.png"), painter_->montage(title, columns_));
  }
  table_.close();
  if (dots_) {
    dots_->close();
  }
  output_.publish();
}

std::filesystem::path Writer::file(const char* folder,
                                   const char* stem,
                                   const Scene& scene,
                                   const char* extension) const {
  return output_.file(folder, numbered(stem, scene.frame, extension));
}

}  // namespace replay
