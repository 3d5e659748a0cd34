// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// OpenCV's decoders of videos and drivers of cameras, without their exceptions and messages. A
// decoder may crash on a hostile file: replay reads files as Video, in a process of its own.
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

namespace replay {

/// The most pixels that a video's frame may have: as for images, 2^26, or what
/// OPENCV_IO_MAX_IMAGE_PIXELS says.
double max_frame_pixels();

/// Opens a video file; throws Failure. Only decoders of files are tried, not drivers of cameras,
/// and only files that hold their frames themselves: a playlist is refused, because it names other
/// files. Frames of more than max_frame_pixels() are refused. FFmpeg's options are set in
/// OPENCV_FFMPEG_CAPTURE_OPTIONS; a value that the user has set stays.
cv::VideoCapture open_video(const std::filesystem::path& file);

/// Moves to the next frame; false at the end, or where a frame is damaged.
bool grab(cv::VideoCapture& source);

/// The frame moved to, or an empty one if it cannot be decoded.
cv::Mat retrieve(cv::VideoCapture& source);

}  // namespace replay
