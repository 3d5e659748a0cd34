// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Maps of curvature of a pressed pad, compared with the published circle through three points and
// with OpenCV's filters. "curvature" is the error against the mean normal curvature, at each pixel
// whose ring sees the free sphere alone. "rounding" is the error of all pixels against the same
// mean in long double; for the published circle, against the mean of sections.
#include "fingerpad/image/curvature.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "fingerpad/published/contact_region.hpp"

using namespace fingerpad;
using bench::Image;

namespace {

constexpr int directions = 18;

template <class S, class T>
Image<S> as(const Image<T>& depth_mm) {
  Image<S> out(depth_mm.rows(), depth_mm.cols());
  std::copy(depth_mm.cells.begin(), depth_mm.cells.end(), out.cells.begin());
  return out;
}

struct Bench {
  bench::Scene scene;
  Index radius_px;
  Image<float> depth = as<float>(scene.pressed_mm);
  Image<double> truth = true_curvatures();

  double pitch_mm() const { return scene.pad.camera.pitch_mm; }
  OrthographicCamera<double> from_afar() const { return {.pitch_mm = pitch_mm()}; }
  std::string group() const { return scene.name + ", radius " + std::to_string(radius_px) + " px"; }

  /// 1 / radius where the ring sees the free sphere alone; NaN elsewhere.
  Image<double> true_curvatures() const {
    const double plate_mm = scene.pressed_mm(scene.pad.rows / 2, scene.pad.cols / 2);
    const auto ring = detail::ring_offsets(double(radius_px), directions);
    Image<double> curvature(depth.rows(), depth.cols(), test::nan);
    for (Index i = radius_px; i < depth.rows() - radius_px; ++i) {
      for (Index j = radius_px; j < depth.cols() - radius_px; ++j) {
        const bool is_free =
            std::all_of(ring.begin(), ring.end(), [&](const detail::RingOffset& o) {
              return scene.pressed_mm(i - o.row, j - o.col) < plate_mm &&
                     scene.pressed_mm(i + o.row, j + o.col) < plate_mm;
            });
        curvature(i, j) = is_free ? 1 / scene.pad.sphere_radius_mm : test::nan;
      }
    }
    return curvature;
  }

  /// The same mean of the same depths in long double.
  template <class CameraType>
  Image<long double> exact(const CameraType& camera, bool clamped) const {
    CurvatureMap<long double> map(camera, depth.rows(), depth.cols(), double(radius_px));
    Image<long double> out(depth.rows(), depth.cols()), plain = out;
    (void)map(depth, out, plain);
    return clamped ? out : plain;
  }

  /// Adds a row that times work(), which fills `out`.
  template <class Image, class CameraType, class Work>
  void add_map(const std::string& name,
               const CameraType& camera,
               bool clamped,
               const std::shared_ptr<Image>& out,
               long bytes,
               const Work& work) const {
    const auto same = bench::kept([=, this] { return exact(camera, clamped); });
    bench::add(group() + "/" + name, scene.pixels(), bytes, work, [=, this](auto& counters) {
      bench::note_errors(counters, "curvature", "1/mm", bench::errors_of(*out, truth));
      bench::note_errors(counters, "rounding", "1/mm", bench::errors_of(*out, same()));
    });
  }

  template <class S, class CameraType>
  void add(const std::string& name, const CameraType& camera) const {
    using Map = CurvatureMap<S>;
    const auto from = std::make_shared<Image<S>>(as<S>(depth));
    const bench::Memory memory;
    const auto map = std::make_shared<Map>(camera, depth.rows(), depth.cols(), double(radius_px));
    const auto out = std::make_shared<Image<S>>(depth.rows(), depth.cols());
    add_map(name, camera, true, out, memory.bytes(), [=] { (void)(*map)(*from, *out); });
  }

  /// Eqs. 10 and 11 with nearest pixels and their true distances.
  template <class S>
  void add_published(const std::string& name) const {
    const auto from = std::make_shared<Image<S>>(as<S>(depth));
    const bench::Memory memory;
    const auto out =
        std::make_shared<Image<S>>(depth.rows(), depth.cols(), std::numeric_limits<S>::quiet_NaN());
    const auto ring = detail::ring_offsets(double(radius_px), directions);
    std::vector<S> radius_mm;
    for (const detail::RingOffset& o : ring) {
      radius_mm.push_back(S(std::sqrt(o.distance_sq()) * pitch_mm()));
    }
    const auto work = [=, r = radius_px] {
      const Image<S>& l = *from;
      for (Index i = r; i < l.rows() - r; ++i) {
        for (Index j = r; j < l.cols() - r; ++j) {
          S sum = S(0);
          for (std::size_t k = 0; k < ring.size(); ++k) {
            const auto [row, col] = ring[k];
            sum += published::circle_center_curvature(radius_mm[k], l(i - row, j - col), l(i, j),
                                                      l(i + row, j + col));
          }
          (*out)(i, j) = sum / S(directions);
        }
      }
    };
    add_map(name, from_afar(), false, out, memory.bytes(), work);
  }

  void add_opencv() const {
    const int size = int(2 * radius_px + 1);
    cv::Mat kernel = cv::Mat::zeros(size, size, CV_32F);
    for (const detail::RingOffset& o : detail::ring_offsets(double(radius_px), directions)) {
      const double weight = 1 / (o.distance_sq() * pitch_mm() * pitch_mm() * directions);
      const int center = int(radius_px);
      kernel.at<float>(center + int(o.row), center + int(o.col)) -= float(weight);
      kernel.at<float>(center - int(o.row), center - int(o.col)) -= float(weight);
      kernel.at<float>(center, center) += float(2 * weight);
    }
    add_filter("cv::filter2D, center less ring",
               [=](const cv::Mat& l, cv::Mat& k) { cv::filter2D(l, k, CV_32F, kernel); });
    add_filter("cv::Laplacian, 5 x 5",
               [=](const cv::Mat& l, cv::Mat& k) { cv::Laplacian(l, k, CV_32F, 5); });
  }

  template <class Filter>
  void add_filter(const std::string& name, const Filter& filter) const {
    const auto from = std::make_shared<Image<float>>(depth);
    const bench::Memory memory;
    const auto out = std::make_shared<Image<float>>(depth.rows(), depth.cols());
    bench::add(
        group() + "/" + name, scene.pixels(), memory.bytes(),
        [=] {
          const cv::Mat l(int(from->rows()), int(from->cols()), CV_32F, from->cells.data());
          cv::Mat k(int(out->rows()), int(out->cols()), CV_32F, out->cells.data());
          filter(l, k);
        },
        [](auto&) {});
  }

  void add_all() const {
    const auto plate = from_afar();
    const Camera<double>& camera = scene.pad.camera;
    add_published<double>("published circle, double");
    add_opencv();
    bench::add_streaming(group(), scene.pixels());
    add<double>("clamped mean, double", plate);
    add<float>("clamped mean, float", plate);
    add<double>("clamped mean, double, through a camera", camera);
    add<float>("clamped mean, float, through a camera, the default", camera);
  }
};

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const Bench pad{bench::round_pad(), 10};  // outlives the rows
  pad.add_all();
  return bench::run(argc, argv);
}
