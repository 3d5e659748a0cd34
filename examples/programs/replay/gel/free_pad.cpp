// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/gel/free_pad.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/median.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "replay/gel/slide_step.hpp"

namespace replay {
namespace {

using Frames = std::vector<cv::Mat>;

constexpr int first_frames = 3;  // at most this many may show the free pad

/// Up to `most` whole frames from `first` on.
Frames read(FrameSource& source, cv::Size size, int first, int most, DamagedFrames& damaged) {
  Frames frames;
  source.seek(first);
  for (int k = first; k < source.size() && static_cast<int>(frames.size()) < most; ++k) {
    const cv::Mat frame = next_whole_frame(source, size, damaged);
    if (!frame.empty()) {
      frames.push_back(frame);
    }
  }
  return frames;
}

/// The frames up to the first that shows a contact relative to the first of them.
Frames without_contact(Frames frames, const fingerpad::GelOptions& options) {
  fingerpad::GelContact contact(Frames{frames.front()}, options);
  const auto touched = std::find_if(frames.begin(), frames.end(), [&](const cv::Mat& frame) {
    return contact(frame).in_contact();
  });
  frames.erase(touched, frames.end());
  return frames;
}

/// How much the brightness of a frame changes within some dots, relative to it: the dots are taken
/// out, and what the lamps change over the frame. A contact adds to it.
double roughness(const cv::Mat& frame, int cell_px) {
  cv::Mat cells, smooth;
  cv::resize(frame, cells, frame.size() / cell_px, 0, 0, cv::INTER_AREA);
  cells.convertTo(cells, CV_8U, frame.depth() == CV_16U ? 1.0 / 256 : 1);
  cv::medianBlur(cells, cells, 7);  // a dot is 3.5 cells wide
  cells.convertTo(cells, CV_32F);
  cv::GaussianBlur(cells, smooth, {}, 8);
  cv::divide(cells, cv::max(smooth, 1), cells);
  const cv::Mat inner = cells({4, 4, cells.cols - 8, cells.rows - 8});
  return cv::norm(inner, cv::Mat(inner.size(), inner.type(), cv::Scalar::all(1))) /
         std::sqrt(inner.total());
}

/// The smoothest of some frames of the recording and those after it, if the first ones differ from
/// it and are rougher: they show a contact then.
std::optional<Frames> free_later(Recording& recording,
                                 const Frames& first,
                                 const fingerpad::GelOptions& options,
                                 DamagedFrames& damaged) {
  const int most = (std::min)(recording.frames.size(), 300), step = 1 + most / 25;
  constexpr double clearly = 1.05;
  const cv::Size size = recording.reference.size();
  if ((std::min)(size.width, size.height) < 16 * options.cell_px) {
    return std::nullopt;
  }
  double least = std::numeric_limits<double>::infinity();
  int smoothest = 0;
  recording.frames.seek(0);
  for (int k = 0; k < most; ++k) {
    const cv::Mat frame = next_whole_frame(recording.frames, size, damaged);
    if (k > recording.first_frame && k % step == 0 && !frame.empty() &&
        usually_exposed({first.front(), frame, frame})[0]) {
      const double seen = roughness(frame, options.cell_px);
      smoothest = seen < least ? k : smoothest;
      least = std::fmin(seen, least);
    }
  }
  if (!(roughness(first.front(), options.cell_px) > clearly * least)) {
    return std::nullopt;
  }
  const Frames later =
      without_contact(read(recording.frames, size, smoothest, first_frames, damaged), options);
  const fingerpad::GelResult seen = fingerpad::GelContact(later, options)(first.front());
  return seen.ok() && !seen.in_contact() ? std::nullopt : std::optional(later);
}

/// How far the dots of a frame are from a smooth grid, as a fraction of their pitch: the root mean
/// square over the dots after a fit of second degree. Infinite where no grid is found.
double unevenness(const cv::Mat& frame, bool bright) {
  fingerpad::DotFinderOptions options;
  options.pattern.bright = bright;
  options.max_off = 0.3;
  const fingerpad::DotFinder finder(frame, options);
  if (!finder.ok()) {
    return std::numeric_limits<double>::infinity();
  }
  const auto dots = finder.free_px();
  cv::Mat_<double> terms(0, 6), places(0, 2);
  for (fingerpad::Index i = 0; i < dots.rows(); ++i) {
    for (fingerpad::Index j = 0; j < dots.cols(); ++j) {
      const auto dot = dots(i, j);
      if (std::isfinite(dot.x + dot.y)) {
        const double u = static_cast<double>(i), v = static_cast<double>(j);
        terms.push_back(cv::Mat(cv::Matx<double, 1, 6>(1, u, v, u * u, u * v, v * v)));
        places.push_back(cv::Mat(cv::Matx<double, 1, 2>(dot.x, dot.y)));
      }
    }
  }
  cv::Mat_<double> fit;
  cv::solve(terms, places, fit, cv::DECOMP_SVD);
  const cv::Mat off = terms * fit - places;
  return cv::norm(off) / std::sqrt(terms.rows) / finder.pattern().pitch_px;
}

double unevenness(const Frames& frames, bool bright) {
  std::vector<double> all;
  for (std::size_t k = 0; k < frames.size() && k < 5; ++k) {
    all.push_back(unevenness(frames[k], bright));
  }
  return median_of(all);
}

/// The order of channels in which `frame` is most like `free`, "bgr" where it is as it should be.
/// Each is scaled as a whole; another order must fit twice as well.
std::string channels_of(const cv::Mat& frame, const cv::Mat& free) {
  cv::Mat free_small, small;
  cv::resize(free, free_small, {64, 48}, 0, 0, cv::INTER_AREA);
  cv::resize(frame, small, {64, 48}, 0, 0, cv::INTER_AREA);
  free_small.convertTo(free_small, CV_32F);
  small.convertTo(small, CV_32F);
  std::string best = "bgr";
  double usual = 0, least = 0;
  for (const char* order : {"bgr", "rgb", "brg", "gbr", "grb", "rbg"}) {
    std::vector<int> pairs;
    for (int c = 0; c < 3; ++c) {
      pairs.push_back(static_cast<int>(std::string("bgr").find(order[c])));
      pairs.push_back(c);
    }
    cv::Mat ordered(small.size(), CV_32FC3);
    cv::mixChannels(Frames{small}, Frames{ordered}, pairs);
    const double scale = ordered.dot(free_small) / std::fmax(ordered.dot(ordered), 1);
    const double off = cv::norm(scale * ordered, free_small, cv::NORM_L1);
    if (std::string(order) == "bgr") {
      usual = least = off;
    } else if (off < 0.5 * usual && off < least) {
      least = off;
      best = order;
    }
  }
  return best;
}

/// With the number of bits of `like`.
cv::Mat in_depth_of(const cv::Mat& like, const cv::Mat& frame) {
  cv::Mat same = frame;
  if (frame.depth() != like.depth()) {
    frame.convertTo(same, like.depth(), like.depth() == CV_16U ? 256 : 1.0 / 256);
  }
  return same;
}

/// Leaves out the frames of `place` that are much lighter or darker than most of them.
void leave_out_unlike(FreePad& pad, const std::string& place) {
  const std::vector<bool> usual = usually_exposed(pad.frames);
  Frames kept;
  for (std::size_t k = 0; k < usual.size(); ++k) {
    if (usual[k]) {
      kept.push_back(pad.frames[k]);
    }
  }
  if (kept.size() < pad.frames.size()) {
    pad.told.push_back({place,
                        std::to_string(pad.frames.size() - kept.size()) + " of " +
                            std::to_string(pad.frames.size()) +
                            " frames are darker or lighter than the others by a quarter or more, "
                            "and are left out",
                        "Fix the exposure, and let the camera run before you record."});
  }
  pad.frames = std::move(kept);
}

Finding begins_with_contact() {
  return {"frames, first frame", "the recording begins with a contact",
          "Begin with nothing in contact, if the dots are to be followed from the free pad on.",
          false};
}

/// Leaves out the frames of `place` that show a contact, by comparison with the first frames.
void leave_out_touched(FreePad& pad,
                       const std::string& place,
                       const Frames& first,
                       const fingerpad::GelOptions& options) {
  fingerpad::GelContact contact(first, options);
  Frames alike, different;
  for (const cv::Mat& frame : pad.frames) {
    const fingerpad::GelResult seen = contact(frame);
    (seen.ok() && !seen.in_contact() ? alike : different).push_back(frame);
  }
  if (different.empty()) {
    return;
  }
  const double of_first = unevenness(first, options.bright_dots);
  const double of_different = unevenness(different, options.bright_dots);
  constexpr double clearly = 1.3;
  const std::string count =
      std::to_string(different.size()) + " of " + std::to_string(pad.frames.size()) + " frames ";
  if (of_different > clearly * of_first) {
    pad.told.push_back({place,
                        count + "show a contact, since their dots are off the grid of the others",
                        "They are left out; record the free pad again with nothing in contact."});
    pad.source = alike.empty() ? "the start of the recording, because " + place + " shows a contact"
                               : place + ", without those that show a contact";
    pad.frames = alike.empty() ? first : alike;
  } else if (of_first > clearly * of_different) {
    pad.told.push_back(begins_with_contact());
    pad.frames = different;
  } else {
    pad.told.push_back({place, count + "differ from the first frames of the recording",
                        "Record the free pad again, in the same light and with nothing in contact, "
                        "and begin the recording with nothing in contact."});
  }
}

}  // namespace

FreePad free_pad_of(Recording& recording, const DotSource& dots) {
  const cv::Size size = recording.reference.size();
  const fingerpad::GelOptions options =
      gel_options_of(size.width, dots.diameter_px(), dots.bright());
  DamagedFrames damaged, damaged_free;
  const Frames first = without_contact(
      read(recording.frames, size, recording.first_frame, first_frames, damaged), options);
  FreePad pad;
  if (recording.free_frames.size() > 0) {
    pad = {read(recording.free_frames, size, 0, recording.free_frames.size(), damaged_free),
           "free/",
           {}};
    if (pad.frames.empty()) {
      fail(recording.free_frames.last_file(), "no frame of the free pad can be read");
    }
  } else if (!recording.sensor.reference_frame.empty()) {
    pad = {{recording.reference}, "the reference in sensor.json", {}};
  } else if (auto later = free_later(recording, first, options, damaged)) {
    return {*later, "the smoothest frames of the recording", {begins_with_contact()}};
  } else {
    return {first, "the start of the recording, where nothing may touch the pad", {}};
  }
  for (const auto& [frame, why] : damaged_free) {
    pad.told.push_back({why, "it is left out", "Copy the picture again, or delete it."});
  }
  for (cv::Mat& frame : pad.frames) {
    frame = in_depth_of(first.front(), frame);
  }
  const std::string place =
      recording.free_frames.size() > 0 ? "free" : recording.sensor.reference_frame;
  leave_out_unlike(pad, place);
  const std::string order = channels_of(first.front(), pad.frames.front());
  if (order == "bgr") {
    leave_out_touched(pad, place, first, options);
  } else {
    pad.told.push_back({place,
                        "the channels of its frames are those of frames/ in another order: blue, "
                        "green, red there are " +
                            order,
                        "Write both by the same program: OpenCV writes blue, green, red."});
  }
  return pad;
}

}  // namespace replay
