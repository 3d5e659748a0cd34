// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Two smoothed planes from one noisy frame, compared with OpenCV's box filter. The error is of each
// pixel's depth, computed from these planes by Newton's method in double.
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"
#include "fingerpad/depth/depth.hpp"

using namespace fingerpad;
using bench::Image;

namespace {

template <class T>
cv::Mat as_mat(Image<T>& image) {
  return cv::Mat(int(image.rows()), int(image.cols()), cv::DataType<T>::type, image.cells.data());
}

struct Bench {
  bench::Scene scene;
  bench::Frame<std::uint8_t> planar = scene.pressed_frame<std::uint8_t>();
  std::vector<Ray<double>> pencils;

  explicit Bench(const bench::Scene& which) : scene(which) {
    for (Index i = 0; i < scene.pad.rows; ++i) {
      for (Index j = 0; j < scene.pad.cols; ++j) {
        pencils.push_back(scene.pad.pencil(i, j));
      }
    }
  }

  template <class S>
  std::vector<double> errors(const bench::Frame<S>& smooth) const {
    Image<double> depth(scene.pad.rows, scene.pad.cols, test::nan);
    for (std::size_t k = 0; k < pencils.size(); ++k) {
      const Index row = Index(k) / scene.pad.cols;
      const Index col = Index(k) % scene.pad.cols;
      const Colour<double> colour{double(smooth.red.cells[k]), double(smooth.green.cells[k])};
      depth.cells[k] =
          newton_depth(scene.pad.fluid, pencils[k], scene.pad.g(row, col), colour).depth_mm;
    }
    return bench::errors_of(depth, scene.pressed_mm);
  }

  /// `work(smooth)` fills both planes. `memory` is made before everything that `work` holds.
  template <class S = float, class Work>
  void add(const std::string& name, Work work, const bench::Memory& memory = {}) const {
    const auto smooth = std::make_shared<bench::Frame<S>>(scene.pad.rows, scene.pad.cols);
    const auto made = bench::kept([=, this] { return errors(*smooth); });
    bench::add(
        scene.name + ", two planes/" + name, scene.pixels(), memory.bytes(),
        [=]() mutable { work(*smooth); },
        [=](auto& counters) { bench::note_errors(counters, "depth", "mm", made()); });
  }

  template <class S, class Red, class Green>
  void add_ours(const std::string& name, const Red& red, const Green& green, int window_px) const {
    const auto reference = scene.pad.reference<S>();
    const bench::Memory memory;
    const auto rows = std::make_shared<detail::ColourRows<S>>(
        scene.pad.camera, scene.pad.fluid, reference,
        detail::PadArea{0, 0, scene.pad.rows, scene.pad.cols}, window_px, 1);
    const auto work = [=, r = as_view(red), g = as_view(green)](bench::Frame<S>& smooth) {
      rows->start(r, g);
      for (Index i = 0; i < r.rows(); ++i) {  // 640 columns are whole blocks of 64
        rows->next(r, g, &smooth.red(i, 0), &smooth.green(i, 0));
      }
    };
    add<S>(name, work, memory);
  }

  template <class Red, class Green>
  void add_all_ours(const Red& red, const Green& green) const {
    add_ours<float>("NoSmoothing", red, green, 1);
    add_ours<float>("BiasFreeMean, the default", red, green, DepthOptions().window_px);
    add_ours<double>("BiasFreeMean, double", red, green, DepthOptions().window_px);
    bench::add_streaming(scene.name + ", two planes", scene.pixels());
  }

  void add_all() {
    const cv::Mat red = as_mat(planar.red);
    const cv::Mat green = as_mat(planar.green);
    add("cv::boxFilter to float", [=](bench::Frame<float>& smooth) {
      cv::boxFilter(red, as_mat(smooth.red), CV_32F, window);
      cv::boxFilter(green, as_mat(smooth.green), CV_32F, window);
    });
    cv::Mat small[2];
    add("cv::blur to 8 bit, then to float", [=](bench::Frame<float>& smooth) mutable {
      cv::blur(red, small[0], window);
      cv::blur(green, small[1], window);
      small[0].convertTo(as_mat(smooth.red), CV_32F);
      small[1].convertTo(as_mat(smooth.green), CV_32F);
    });
    add_all_ours(planar.red, planar.green);
  }

  static inline const cv::Size window{29, 29};
};

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  Bench(bench::full_pad()).add_all();
  return bench::run(argc, argv);
}
