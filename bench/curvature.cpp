// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Maps of curvature of a pressed pad, beside the published circle through three points and beside
// OpenCV's filter2D with the ring as its kernel. The error is the largest against the same
// statistic in double; of the published form, against the mean of sections.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "fingerpad/detail/contact/curvature_map.hpp"
#include "support/run.hpp"
#include "support/scene.hpp"

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

  double pitch_mm() const { return scene.pad.camera.pitch_mm; }
  std::string group() const {
    return scene.name + ", radius " + std::to_string(radius_px) + " px/";
  }

  template <class Statistic, class Projection, class S>
  Image<S> curvatures(const Projection& projection) const {
    const CurvatureMap<Statistic, Projection, S> map({radius_px}, projection, depth.rows(),
                                                     depth.cols());
    auto workspace = map.workspace();
    Image<S> out(depth.rows(), depth.cols());
    map(depth, out, workspace);
    return out;
  }

  template <class Statistic, class S, class Projection>
  void add(const std::string& name, const Projection& projection) const {
    using Map = CurvatureMap<Statistic, Projection, S>;
    const auto map =
        std::make_shared<Map>(CurvatureRing{radius_px}, projection, depth.rows(), depth.cols());
    const auto workspace = std::make_shared<typename Map::Workspace>(map->workspace());
    const auto out = std::make_shared<Image<S>>(depth.rows(), depth.cols());
    const auto from = std::make_shared<Image<S>>(as<S>(depth));
    bench::add(
        group() + name, scene.pixels(), [=] { (*map)(*from, *out, *workspace); },
        [=, this](auto& counters) {
          counters["max_error_1/mm"] =
              test::largest_error(*out, curvatures<Statistic, Projection, double>(projection));
        });
  }

  /// Eqs. 10 and 11, with nearest pixels and their true distances.
  template <class S>
  void add_published(const std::string& name) const {
    const auto out =
        std::make_shared<Image<S>>(depth.rows(), depth.cols(), std::numeric_limits<S>::quiet_NaN());
    const auto from = std::make_shared<Image<S>>(as<S>(depth));
    const auto ring = ring_offsets(radius_px, directions);
    std::vector<S> radius_mm;
    for (const RingOffset& o : ring) {
      radius_mm.push_back(S(std::sqrt(double(o.radius_sq())) * pitch_mm()));
    }
    bench::add(
        group() + name, scene.pixels(),
        [=, r = radius_px] {
          const Image<S>& l = *from;
          for (Index i = r; i < l.rows() - r; ++i) {
            for (Index j = r; j < l.cols() - r; ++j) {
              S sum = S(0);
              for (std::size_t k = 0; k < ring.size(); ++k) {
                const auto [row, col] = ring[k];
                sum += circle_center_curvature(radius_mm[k], l(i - row, j - col), l(i, j),
                                               l(i + row, j + col));
              }
              (*out)(i, j) = sum / S(directions);
            }
          }
        },
        [=, this](auto& counters) {
          const auto whole = curvatures<SectionMean<>, PlatePitch, double>(PlatePitch{pitch_mm()});
          double known = 0, found = 0, worst = 0;
          for (Index i = radius_px; i < whole.rows() - radius_px; ++i) {
            for (Index j = radius_px; j < whole.cols() - radius_px; ++j) {
              const double error = std::abs(double((*out)(i, j)) - whole(i, j));
              known += std::isnan(whole(i, j)) ? 0 : 1;
              found += std::isnan(error) ? 0 : 1;
              worst = error > worst ? error : worst;
            }
          }
          counters["max_error_1/mm"] = worst;
          counters["share_found"] = found / known;
        });
  }

  void add_opencv() const {
    const int size = int(2 * radius_px + 1);
    cv::Mat kernel = cv::Mat::zeros(size, size, CV_32F);
    for (const RingOffset& o : ring_offsets(radius_px, directions)) {
      const double weight = 1 / (double(o.radius_sq()) * pitch_mm() * pitch_mm() * directions);
      const int center = int(radius_px);
      kernel.at<float>(center + int(o.row), center + int(o.col)) -= float(weight);
      kernel.at<float>(center - int(o.row), center - int(o.col)) -= float(weight);
      kernel.at<float>(center, center) += float(2 * weight);
    }
    const auto from = std::make_shared<Image<float>>(depth);
    const auto out = std::make_shared<Image<float>>(depth.rows(), depth.cols());
    bench::add(
        group() + "cv::filter2D, RingStencil", scene.pixels(),
        [=] {
          const cv::Mat l(int(from->rows()), int(from->cols()), CV_32F, from->cells.data());
          cv::Mat k(int(out->rows()), int(out->cols()), CV_32F, out->cells.data());
          cv::filter2D(l, k, CV_32F, kernel);
        },
        [](auto&) {});
  }

  void add_all() const {
    const PlatePitch plate{pitch_mm()};
    add_published<double>("published circle, double");
    add_published<float>("published circle, float");
    add_opencv();
    add<PublishedTwiceMean<>, float>("PublishedTwiceMean<36>, float", plate);
    add<SectionMean<>, float>("SectionMean<18>, float", plate);
    add<ClampedMean<>, double>("ClampedMean<18>, double", plate);
    add<ClampedMean<>, float>("ClampedMean<18>, float", plate);
    add<ClampedMean<>, float>("ClampedMean<18>, float, PitchAtDepth, the default",
                              PitchAtDepth(scene.pad.camera));
    add<HessianFit<>, double>("HessianFit<18>, double", plate);
    add<HessianFit<>, float>("HessianFit<18>, float", plate);
    add<HessianFit<9>, float>("HessianFit<9>, float", plate);
    add<ClampedHessian<>, float>("ClampedHessian<18>, float", plate);
    add<RingStencil<>, float>("RingStencil<18>, float", plate);
  }
};

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const Bench benches[] = {{bench::full_pad(), 10},
                           {bench::full_pad(), 25},
                           {bench::round_pad(), 10},
                           {bench::round_pad(), 25}};
  for (const Bench& b : benches) {
    b.add_all();
  }
  return bench::run(argc, argv);
}
