// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/capture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/videoio/registry.hpp>
#include <string>

#include "common/failure.hpp"
#include "common/images.hpp"

namespace replay {
namespace {

/// FFmpeg may read these formats, by its own names: containers, raw H.264 as cameras write it, and
/// images in a row. Its threads print after a call has ended, when QuietCodecs has gone.
void set_options() {
  static const int done = ::setenv("OPENCV_FFMPEG_CAPTURE_OPTIONS",
                                   "format_whitelist;"
                                   "avi,mov,matroska,mpeg,mpegts,h264,mjpeg,ogg,asf,flv,ivf,nut,"
                                   "mxf,dv,cine,gif,apng,yuv4mpegpipe,png_pipe,jpeg_pipe,bmp_pipe,"
                                   "tiff_pipe",
                                   0) |
                          ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  (void)done;
}

/// Left to itself, OpenCV asks all it has: for a file that no decoder reads it would look for USB
/// cameras and for a series of images with similar names.
bool decodes_files(cv::VideoCaptureAPIs backend) {
  const auto decoders = {cv::CAP_FFMPEG, cv::CAP_GSTREAMER,    cv::CAP_INTEL_MFX,
                         cv::CAP_MSMF,   cv::CAP_AVFOUNDATION, cv::CAP_OPENCV_MJPEG};
  return std::find(decoders.begin(), decoders.end(), backend) != decoders.end();
}

}  // namespace

double max_frame_pixels() {
  const char* const limit = std::getenv("OPENCV_IO_MAX_IMAGE_PIXELS");
  const double pixels = limit != nullptr ? std::atof(limit) : 0;
  return pixels >= 1 ? pixels : 1 << 26;
}

cv::VideoCapture open_video(const std::filesystem::path& file) {
  set_options();
  cv::VideoCapture video;
  {
    const QuietCodecs quiet;
    for (const auto backend : cv::videoio_registry::getStreamBackends()) {
      try {
        if (decodes_files(backend) && video.open(file.string(), backend)) {
          break;
        }
      } catch (const cv::Exception&) {
        video.release();
      }
    }
  }
  if (!video.isOpened()) {
    fail(file,
         "cannot be read as a video (the file is damaged or a playlist, or no decoder is "
         "installed)");
  }
  const double width = video.get(cv::CAP_PROP_FRAME_WIDTH);
  const double height = video.get(cv::CAP_PROP_FRAME_HEIGHT);
  if (width * height > max_frame_pixels()) {
    fail(file, "has frames of " + std::to_string(std::lround(width)) + " x " +
                   std::to_string(std::lround(height)) + " px, but at most " +
                   std::to_string(std::lround(max_frame_pixels())) +
                   " px are read (OPENCV_IO_MAX_IMAGE_PIXELS)");
  }
  return video;
}

bool grab(cv::VideoCapture& source) {
  const QuietCodecs quiet;
  try {
    return source.grab();
  } catch (const cv::Exception&) {
    return false;
  }
}

cv::Mat retrieve(cv::VideoCapture& source) {
  const QuietCodecs quiet;
  cv::Mat frame;
  try {
    source.retrieve(frame);
  } catch (const cv::Exception&) {
    frame.release();
  }
  return frame;
}

}  // namespace replay
