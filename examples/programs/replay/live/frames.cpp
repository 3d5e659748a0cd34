// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/live/frames.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <thread>

#include "common/capture.hpp"
#include "common/failure.hpp"
#include "common/images.hpp"

namespace replay {

LiveFrames LiveFrames::of_camera(int number, cv::Size size, const PictureFormat& format) {
  LiveFrames frames;
  frames.name_ = "camera " + std::to_string(number);
  frames.size_ = size;
  frames.format_ = format;
  {
    const QuietCodecs quiet;
    frames.camera_.open(number);
  }
  if (!frames.camera_.isOpened()) {
    fail(frames.name_, "cannot be opened; try another number, or close the program that uses it");
  }
  frames.camera_.set(cv::CAP_PROP_FRAME_WIDTH, size.width);
  frames.camera_.set(cv::CAP_PROP_FRAME_HEIGHT, size.height);
  frames.camera_.set(cv::CAP_PROP_BUFFERSIZE, 1);  // a queue of frames would add latency
  frames.rate_hz_ = (std::max)(frames.camera_.get(cv::CAP_PROP_FPS), 0.0);
  return frames;
}

LiveFrames LiveFrames::of_video(const std::filesystem::path& file,
                                cv::Size size,
                                const PictureFormat& format,
                                bool in_real_time) {
  LiveFrames frames;
  frames.name_ = file;
  frames.size_ = size;
  frames.format_ = format;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    fail(file, "there is no such video");
  }
  frames.video_.emplace(file);
  const double rate = frames.video_->rate_hz();
  // A damaged header may hold any rate; the times of frames must fit into a clock.
  frames.rate_hz_ = rate >= 1e-3 && rate <= 1e6 ? rate : 30;
  const std::chrono::duration<double> period(1 / frames.rate_hz_);
  frames.period_ = std::chrono::duration_cast<Clock::duration>(period);
  frames.in_real_time_ = in_real_time;
  return frames;
}

bool LiveFrames::grab() {
  if (!(video_ ? video_->grab() : replay::grab(camera_))) {
    return false;
  }
  arrival_ = Clock::now();
  if (++number_ == 0) {
    start_ = arrival_;
  }
  return true;
}

void LiveFrames::skip() {
  if (grab()) {
    start_ = arrival_ - number_ * period_;
  }
}

bool LiveFrames::next(cv::Mat& frame) {
  if (in_real_time_ && number_ >= 0 && period_.count() > 0) {
    const auto next_is_due = start_ + (number_ + 1) * period_;
    // Skips only the frames that are late now: decoding may be slower than the video.
    for (auto late = (Clock::now() - next_is_due) / period_; late > 0 && grab(); --late) {
    }
    std::this_thread::sleep_until(next_is_due);
  }
  if (!grab()) {
    if (period_.count() == 0) {
      fail(name_, "delivers no more frames");
    }
    return false;
  }
  frame = video_ ? video_->retrieve() : retrieve(camera_);
  if (frame.empty()) {
    fail(name_, "frame " + std::to_string(number_) + " cannot be decoded");
  }
  const cv::Mat colours = linear_colours(frame, format_, name_);
  if (frame.size() != size_ || frame.depth() != CV_8U) {
    fail(name_, "delivers " + std::to_string(frame.cols) + " x " + std::to_string(frame.rows) +
                    " px of " + (frame.depth() == CV_8U ? "8" : "16") +
                    " bits, but live frames must have 8 bits and the size of the reference, " +
                    std::to_string(size_.width) + " x " + std::to_string(size_.height) + " px");
  }
  stored_ = frame;
  frame = colours;
  return true;
}

double LiveFrames::time_s() const {
  const auto time = period_.count() > 0 ? number_ * period_ : arrival_ - start_;
  return std::chrono::duration<double>(time).count();
}

}  // namespace replay
