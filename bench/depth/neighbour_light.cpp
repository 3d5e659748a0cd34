// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Removal of the neighbouring membrane's light from a depth map, for small to large discs, and from
// its samples, as a fingertip does. The error is of each corrected pixel, against the sum over
// every pixel of the disc in long double.
#include "fingerpad/depth/neighbour_light.hpp"

#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"

using namespace fingerpad;
using bench::Image;

namespace {

/// A depth map as a frame gives it: round, smooth, NaN outside the pad.
Image<float> smooth_depths(const Image<double>& depth_mm) {
  Image<float> out(depth_mm.rows(), depth_mm.cols());
  std::copy(depth_mm.cells.begin(), depth_mm.cells.end(), out.cells.begin());
  return out;
}

struct Bench {
  Index radius_px;
  bench::Scene scene = bench::round_pad();
  Image<float> free = smooth_depths(scene.free_mm);
  Image<float> pressed = smooth_depths(scene.pressed_mm);

  std::string group() const { return "radius " + std::to_string(radius_px) + " px"; }

  template <class S>
  NeighbourLightCompensation<S> compensation() const {
    return {NeighbourLight<S>{.radius_px = radius_px}, S(scene.pad.camera.pitch_mm * 1.1), free};
  }

  /// Exact corrected depths; NaN where no light is to be removed.
  Image<long double> truth() const {
    auto compensate = compensation<long double>();
    Image<long double> out(scene.pad.rows, scene.pad.cols);
    (void)compensate(pressed, out);
    for (std::size_t k = 0; k < out.cells.size(); ++k) {
      if (out.cells[k] == static_cast<long double>(pressed.cells[k])) {
        out.cells[k] = not_a_number<long double>();
      }
    }
    return out;
  }

  template <class S, class Truth>
  void add(const std::string& name, const Truth& truth) const {
    const bench::Memory memory;
    const auto compensate = std::make_shared<NeighbourLightCompensation<S>>(compensation<S>());
    const auto out = std::make_shared<Image<S>>(scene.pad.rows, scene.pad.cols);
    bench::add(
        group() + "/" + name, scene.pixels(), memory.bytes(),
        [=, this] { (void)(*compensate)(pressed, *out); },
        [=](auto& counters) {
          bench::note_errors(counters, "depth", "mm", bench::errors_of(*out, truth()));
        });
  }

  void add_samples(int step) const {
    const auto samples = [&](const Image<float>& from) {
      Image<float> out(from.rows() / step, from.cols() / step);
      for (Index i = 0; i < out.rows(); ++i) {
        for (Index j = 0; j < out.cols(); ++j) {
          out(i, j) = from(step * i, step * j);
        }
      }
      return out;
    };
    const auto from = std::make_shared<Image<float>>(samples(pressed));
    const auto pitch_mm = static_cast<float>(scene.pad.camera.pitch_mm * 1.1 * step);
    const bench::Memory memory;
    const auto compensate = std::make_shared<NeighbourLightCompensation<>>(
        sampled(NeighbourLight<float>{.radius_px = radius_px}, step), pitch_mm, samples(free));
    const auto out = std::make_shared<Image<float>>(*from);
    bench::add(
        group() + "/float, of samples of " + std::to_string(step) + " x " + std::to_string(step),
        scene.pixels(), memory.bytes(), [=] { (void)(*compensate)(*from, *out); }, [](auto&) {});
  }

  /// `filter(from, to)` uses OpenCV.
  template <class Filter>
  void add_opencv(const std::string& name, Filter filter) const {
    const auto from = std::make_shared<Image<float>>(pressed);
    const bench::Memory memory;
    const auto out = std::make_shared<Image<float>>(scene.pad.rows, scene.pad.cols);
    const auto mat = [](Image<float>& image) {
      return cv::Mat(int(image.rows()), int(image.cols()), CV_32F, image.cells.data());
    };
    bench::add(
        group() + "/" + name, scene.pixels(), memory.bytes(),
        [=] {
          cv::Mat to = mat(*out);
          filter(mat(*from), to);
        },
        [](auto&) {});
  }

  void add_all() const {
    const auto exact = bench::kept([this] { return truth(); });
    const cv::Size window(int(2 * radius_px + 1), int(2 * radius_px + 1));
    add<double>("NeighbourLightCompensation, double", exact);
    add<float>("NeighbourLightCompensation, float, the default", exact);
    add_samples(3);
    bench::add_streaming(group(), scene.pixels());
    add_opencv("cv::boxFilter of the disc's size",
               [=](const cv::Mat& from, cv::Mat& to) { cv::boxFilter(from, to, CV_32F, window); });
    add_opencv("cv::GaussianBlur of the disc's size",
               [=](const cv::Mat& from, cv::Mat& to) { cv::GaussianBlur(from, to, window, 0); });
  }
};

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const Bench light{15};  // outlives the rows
  light.add_all();
  return bench::run(argc, argv);
}
