// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A recording on disk: sensor.json, the free pad, the frames (a folder or a video) and the
// signals. open_recording() checks all that can be checked before the first frame.
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/images.hpp"
#include "common/sensor.hpp"
#include "common/signals.hpp"
#include "common/stress_free_dots.hpp"
#include "common/true_forces.hpp"
#include "common/video.hpp"

namespace replay {

/// Reads frames one after the other.
class FrameSource {
 public:
  /// Frames from the files of a folder, without hidden ones, in natural order (frame10 after
  /// frame2), or from a video file. Throws Failure.
  static FrameSource of_folder(const std::filesystem::path& folder, PictureFormat format = {});
  static FrameSource of_video(const std::filesystem::path& file, PictureFormat format = {});

  int size() const { return count_; }
  /// Moves to frame `first`, in [0, size()].
  void seek(int first);
  /// The next frame, 8- or 16-bit colour, linear in light; throws Failure.
  cv::Mat next();
  /// The next frame as it is stored; throws Failure.
  cv::Mat next_stored();
  /// The file of the last frame, for messages.
  std::filesystem::path last_file() const;
  /// The number of the last frame, counted from 0.
  int last_frame() const { return position_ - 1; }

 private:
  std::vector<std::filesystem::path> files_;  ///< one per frame, or the video alone
  std::optional<Video> video_;
  PictureFormat format_;
  int count_ = 0;
  int position_ = 0;
};

/// The next frame, which must be of `size`; throws Failure.
cv::Mat next_frame(FrameSource& frames, cv::Size size);

/// The numbers of damaged frames, and why each cannot be read.
using DamagedFrames = std::map<int, std::string>;
/// The same, but a damaged frame is added to `damaged`, and an empty one returned.
cv::Mat next_whole_frame(FrameSource& frames, cv::Size size, DamagedFrames& damaged);

struct Recording {
  Sensor sensor;
  cv::Mat reference;  ///< the free pad, 8- or 16-bit colour; if dots-only, maybe the first frame
  cv::Mat_<float> reference_depth;  ///< mm, NaN outside the pad; empty if dots-only
  FrameSource frames;
  int first_frame = 0;      ///< if dots-only: the first that is as light as those after it
  FrameSource free_frames;  ///< more frames of the free pad; may be empty
  Signals signals;
  std::map<int, TrueForce> true_forces;  ///< by frame; may be empty
  std::optional<SpaceGrid> stress_free_dots;
};

/// Opens and checks a recording; throws Failure. `sensor` is its sensor.json, by default the one in
/// the folder; what it names lies beside it.
Recording open_recording(const std::filesystem::path& folder,
                         const std::filesystem::path& sensor = {});

/// Opens only the sensor and the free pad, without frames.
Recording open_pad(const std::filesystem::path& folder, const std::filesystem::path& sensor = {});

}  // namespace replay
