// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Reads video files, with one error line for each.
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

namespace replay {

/// Opens a video file; throws Failure. Only decoders of files are tried, not drivers of cameras,
/// and only files that hold their frames themselves: a playlist is refused, because it names other
/// files. Frames are limited to 2^26 px, as images are. FFmpeg's options are set in
/// OPENCV_FFMPEG_CAPTURE_OPTIONS; a value that the user has set stays.
cv::VideoCapture open_video(const std::filesystem::path& file);

/// Moves to the next frame; false at the end, or where a frame is damaged.
bool grab(cv::VideoCapture& video);

/// The frame moved to, or an empty one if it cannot be decoded.
cv::Mat retrieve(cv::VideoCapture& video);

}  // namespace replay
