// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Writes all results of a recording into a folder that appears when it is complete.
#include <filesystem>
#include <optional>
#include <vector>

#include "common/frame_table.hpp"
#include "common/output.hpp"
#include "common/recording.hpp"
#include "replay/pictures/pictures.hpp"
#include "replay/pictures/stick_picture.hpp"
#include "replay/replay.hpp"

namespace replay {

class Writer {
 public:
  /// For `total` frames of a recording; `initial_dots` are the free pad's dots, maybe empty. The
  /// options must outlive the writer. Throws Failure, as do the functions below.
  Writer(const Recording& recording,
         const Options& options,
         const DotGrid& initial_dots,
         int total);

  void operator()(Scene scene);
  /// Writes the results over all frames and moves the folder to its place.
  void finish();

  const std::vector<FrameRow>& rows() const { return rows_; }
  const Doubts& doubts() const { return table_.doubts(); }
  const OutputFolder& output() const { return output_; }
  const std::filesystem::path& place() const { return output_.place(); }

 private:
  std::filesystem::path file(const char* folder,
                             const char* stem,
                             const Scene& scene,
                             const char* extension) const;
  void write_pictures(const Scene& scene);

  const Options& options_;
  std::optional<Painter> painter_;  ///< empty for a dots-only recording
  double brightest_;
  DotGrid initial_dots_;
  int total_;
  OutputFolder output_;
  TableWriter<FrameRow> table_;
  std::optional<TableWriter<DotRow>> dots_;
  std::vector<FrameRow> rows_;
  std::vector<Scene> columns_;  ///< of the montage
};

}  // namespace replay
