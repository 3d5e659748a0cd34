// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "replay/check/parts.hpp"

namespace replay {
namespace {

constexpr int most_frames = 300;     // at most this many are used
constexpr double free_share = 0.02;  // of a free pad that may differ from the reference

/// Mean of red and green, grey levels.
cv::Mat_<float> light_of(const cv::Mat& frame) {
  cv::Mat green, red;
  cv::extractChannel(frame, green, 1);
  cv::extractChannel(frame, red, 2);
  const double unit = frame.depth() == CV_16U ? 1.0 / 512 : 0.5;
  cv::Mat_<float> light;
  cv::addWeighted(green, unit, red, unit, 0, light, CV_32F);
  return light;
}

double median_within(const cv::Mat_<float>& values, const cv::Mat_<uchar>& pad) {
  std::vector<double> inside;
  for (int i = 0; i < values.rows; i += 2) {
    for (int j = 0; j < values.cols; j += 2) {
      if (pad(i, j) != 0 && std::isfinite(values(i, j))) {
        inside.push_back(static_cast<double>(values(i, j)));
      }
    }
  }
  return median_of(inside);
}

/// Light in a set of frames, compared with the reference and with the previous frame.
struct Light {
  double saturated = 0;              ///< largest share
  double brightest = 0;              ///< place of the pad, grey levels
  double level = 0;                  ///< median of the frames' medians, grey levels
  std::vector<double> of_reference;  ///< median of frame / reference
  double noise = std::numeric_limits<double>::infinity();  ///< least, grey levels
  double blocks = 1;              ///< median of the frames' steps between blocks
  int same = 0;                   ///< frames equal to the previous one
  std::map<int, double> touched;  ///< share of the pad that is lighter or darker, by frame
  DamagedFrames damaged;
  std::string gap;  ///< what is missing where names count on by one, as "after 0004.png"
  double dark = 1;  ///< least share of the pad with less than half of the reference's light
};

/// The number at the end of a name; -1 without one of at most nine digits.
long number_of(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  const std::string digits = name.substr(name.find_last_not_of("0123456789") + 1);
  return digits.empty() || digits.size() > 9 ? -1 : std::stol(digits);
}

/// Share of squares of 16 px in the pad whose light differs by more than 2 % from the reference's.
double touched_share(const cv::Mat_<float>& ratio, const cv::Mat_<uchar>& pad, double usual) {
  const cv::Size size = ratio.size() / 16;
  cv::Mat inside, mean;
  cv::Mat known = ratio.clone();
  known.setTo(0, ~pad);
  cv::resize(pad, inside, size, 0, 0, cv::INTER_AREA);
  cv::resize(known, mean, size, 0, 0, cv::INTER_AREA);
  const cv::Mat whole = inside == 255;
  cv::Mat off = cv::abs(mean - usual) > 0.02 * usual;
  return cv::countNonZero(off & whole) /
         (std::max)(1.0, static_cast<double>(cv::countNonZero(whole)));
}

Light light_in(FrameSource& frames, const cv::Mat& reference, const cv::Mat_<uchar>& pad) {
  Light seen;
  std::vector<double> levels, blocks;
  std::filesystem::path last;
  int by_one = 0, by_more = 0;
  cv::Mat_<float> before;
  cv::Mat_<float> free_light = light_of(reference);
  cv::max(free_light, 1, free_light);
  frames.seek(0);
  for (int k = 0; k < (std::min)(frames.size(), most_frames); ++k) {
    const cv::Mat frame = next_whole_frame(frames, reference.size(), seen.damaged);
    const long step = number_of(frames.last_file()) - number_of(k > 0 ? last : frames.last_file());
    by_one += step == 1 ? 1 : 0;
    by_more += step > 1 ? 1 : 0;
    seen.gap = seen.gap.empty() && step > 1 ? "after " + last.filename().string() : seen.gap;
    last = frames.last_file();
    if (frame.empty()) {
      continue;
    }
    const cv::Mat_<float> light = light_of(frame);
    cv::Mat_<float> ratio;
    cv::divide(light, free_light, ratio);
    seen.dark = std::fmin(seen.dark, cv::countNonZero((ratio < 0.5) & pad) /
                                         static_cast<double>(cv::countNonZero(pad)));
    levels.push_back(median_within(light, pad));
    cv::Mat smooth;
    double most = 0;
    cv::blur(light, smooth, {9, 9});
    cv::minMaxLoc(smooth, nullptr, &most, nullptr, nullptr, pad);
    seen.brightest = std::fmax(seen.brightest, most);
    seen.of_reference.push_back(median_within(ratio, pad));
    blocks.push_back(step_between_blocks(frame, pad));
    seen.saturated = std::fmax(seen.saturated, saturated_share(frame, pad));
    seen.touched[k] = touched_share(ratio, pad, seen.of_reference.back());
    if (!before.empty()) {
      const double off = cv::norm(light, before, cv::NORM_L1, pad) / cv::countNonZero(pad);
      seen.same += off > 0 ? 0 : 1;
      // The mean of |difference| of two noisy values is 2 / sqrt(pi) of their noise.
      seen.noise = off > 0 ? std::fmin(seen.noise, off * std::sqrt(CV_PI) / 2) : seen.noise;
    }
    before = light;
  }
  seen.gap = by_one > 2 * by_more ? seen.gap : "";
  seen.level = median_of(levels);
  seen.blocks = median_of(blocks);
  return seen;
}

std::string percent(double share) {
  return short_number(100 * share) + " %";
}

void tell_exposure(const std::string& place, const Light& light, Findings& findings) {
  if (!light.gap.empty()) {
    findings.push_back(
        {place,
         "a number is missing " + light.gap +
             ", and frames are counted in the order of their names",
         "Give the picture back, or number the frames of the tables by that order."});
  }
  for (const auto& [frame, why] : light.damaged) {
    findings.push_back({why, "it is left out", "Copy the picture again, or delete it."});
  }
  if (light.saturated > most_saturated) {
    findings.push_back({place, "up to " + percent(light.saturated) + " of the pad is saturated",
                        "Shorten the exposure or reduce the light."});
  }
  if (light.level < 16) {
    findings.push_back(
        {place, "the pad is too dark: the median level is " + short_number(light.level) + " of 255",
         "Lengthen the exposure or add light."});
  }
  if (light.noise < 1e9 && light.noise > 0.1 * light.level && light.level >= 16) {
    findings.push_back({place,
                        "the noise is " + short_number(light.noise) +
                            " grey levels at a median level of " + short_number(light.level),
                        "Lower the gain and add light, or average frames."});
  }
  if (light.same > 0) {
    findings.push_back({place,
                        std::to_string(light.same) + " of " +
                            std::to_string(light.of_reference.size()) +
                            " frames repeat the previous frame",
                        "Check whether the camera or the copying stalls."});
  }
}

void tell_lamp(const std::string& place,
               double ratio,
               const std::string& other,
               const std::string& remedy,
               Findings& findings) {
  constexpr double most = 0.05;
  if (!(std::abs(ratio - 1) <= most)) {
    findings.push_back({place,
                        "the pad is " + percent(std::abs(ratio - 1)) +
                            (ratio < 1 ? " darker" : " brighter") + " than in " + other,
                        remedy});
  }
}

/// Checks that some frame shows the free pad as in the reference.
void check_free_pad(const Recording& recording, const Light& frames, Findings& findings) {
  double least = 1;
  for (const auto& [frame, share] : frames.touched) {
    least = std::fmin(least, share);
  }
  if (recording.free_frames.size() == 0 && least > free_share) {
    findings.push_back(
        {recording.sensor.reference_frame,
         "no frame looks like it: at least " + percent(least) + " of the pad differs",
         "Check that it shows the free pad, and begin recordings with nothing in contact."});
  }
}

/// Checks the gauge's reading without contact: the smallest in frames that look free, because the
/// first touch is hardly visible.
void check_tare(const Recording& recording, const Light& frames, Findings& findings) {
  double free_n = std::numeric_limits<double>::infinity(), largest_n = 0;
  for (const auto& [frame, truth] : recording.true_forces) {
    const double n = norm(truth.force_n);
    largest_n = std::fmax(largest_n, n);
    const auto touched = frames.touched.find(frame);
    if (touched != frames.touched.end() && touched->second <= free_share / 4) {
      free_n = std::fmin(free_n, n);
    }
  }
  if (std::isfinite(free_n) && free_n > 0.1 * largest_n && free_n > 0.05) {
    findings.push_back({"forces.csv",
                        "the force is at least " + short_number(free_n) +
                            " N in all frames that show the free pad",
                        "Tare the gauge with nothing in contact."});
  }
}

}  // namespace

void check_light(Recording& recording, Findings& findings) {
  cv::Mat_<uchar> pad(recording.reference.size(), uchar{255});
  const bool has_reference = !recording.sensor.dots_only;
  if (has_reference) {
    pad = recording.reference_depth > 0;
    if (cv::countNonZero(pad) == 0) {
      return;
    }
  }
  const Light frames = light_in(recording.frames, recording.reference, pad);
  tell_exposure("frames", frames, findings);
  findings.push_back({"frames",
                      "where the pad is brightest, red and green use " +
                          percent(frames.brightest / 255) + " of the range",
                      has_reference ? "With more light depth errs less, in proportion."
                                    : "With more light dots are found more exactly.",
                      false});
  if (frames.touched.empty()) {
    return;  // no frame can be read
  }
  if (!has_reference) {
    return;
  }
  if (frames.dark > 0.1 && frames.level >= 16) {  // a press does not darken the pad
    findings.push_back({"frames",
                        "at least " + percent(frames.dark) +
                            " of the pad is less than half as bright as in the reference",
                        "Check that row padding is handled when frames are read, and that the "
                        "camera has not moved."});
  }
  if (frames.blocks > compressed_step) {
    findings.push_back({"frames",
                        "colours change between blocks of 16 px: the pictures were compressed, and "
                        "depth errs by a tenth of a millimetre",
                        "Store PNG or raw pictures, not JPEG or video."});
  }
  const std::string again = "Record the reference and the free frames again with this light.";
  if (recording.free_frames.size() > 0) {
    const Light free = light_in(recording.free_frames, recording.reference, pad);
    tell_exposure("free", free, findings);
    tell_lamp("free", median_of(free.of_reference), "the reference", again, findings);
    double touched = 0;
    for (const auto& [frame, share] : free.touched) {
      touched = std::fmax(touched, share);
    }
    if (touched > free_share) {
      findings.push_back({"free", percent(touched) + " of the pad differs from the reference",
                          "Remove the frames in which something touches the pad, or replace the "
                          "reference if it shows a contact."});
    }
  }
  check_free_pad(recording, frames, findings);
  check_tare(recording, frames, findings);
  tell_lamp("frames, first frame", frames.of_reference.front(), "the reference", again, findings);
  tell_lamp("frames, last frame", frames.of_reference.back() / frames.of_reference.front(),
            "the first frame",
            "Check whether the light or the exposure changes by itself, and fix both.", findings);
}

}  // namespace replay
