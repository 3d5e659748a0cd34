// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Depth from smoothed planes of red and green by every inverse. The error is of each pixel against
// the root in long double of the same equation with the same inputs; that of the published method
// has one height in both directions of a pencil. Quantities that depend only on the pixel (its
// pencil and g) are computed before the clock starts, for every inverse.
#include "fingerpad/depth/depth.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"
#include "fingerpad/published/depth.hpp"

using namespace fingerpad;
using bench::Image;

namespace {

/// Inputs of every inverse in its own scalar; all hold the same numbers, those of float.
template <class S>
struct Inputs {
  Absorption<S> fluid;
  std::vector<S> red;
  std::vector<S> green;
  std::vector<Ray<S>> pencils;
  std::vector<S> g;

  explicit Inputs(const bench::Scene& scene) : fluid(cast<S>(scene.pad.fluid)) {
    const auto colours = scene.pad.frame<float>(scene.free_mm);
    red.assign(colours.red.cells.begin(), colours.red.cells.end());
    green.assign(colours.green.cells.begin(), colours.green.cells.end());
    const auto reference = scene.pad.reference<float>();
    g.assign(reference.scattering.begin(), reference.scattering.end());
    const auto camera = cast<S>(scene.pad.camera);
    for (Index i = 0; i < scene.pad.rows; ++i) {
      for (Index j = 0; j < scene.pad.cols; ++j) {
        pencils.push_back(ray_at_pixel(camera, S(i), S(j)));
      }
    }
  }
};

/// The same as pointers, which a store to a byte cannot change.
template <class S>
struct Planes {
  Absorption<S> fluid;
  std::size_t size;
  const S* red;
  const S* green;
  const Ray<S>* pencils;
  const S* g;

  Planes(const Inputs<S>& in)
      : fluid(in.fluid),
        size(in.g.size()),
        red(in.red.data()),
        green(in.green.data()),
        pencils(in.pencils.data()),
        g(in.g.data()) {}
  Colour<S> colour(std::size_t k) const { return {red[k], green[k]}; }
};

Image<double> exact_depths(const bench::Scene& scene, bool one_height) {
  const Inputs<long double> inputs(scene);
  const Planes<long double> in(inputs);
  Image<double> depth(scene.pad.rows, scene.pad.cols);
  for (std::size_t k = 0; k < depth.cells.size(); ++k) {
    auto pencil = in.pencils[k];
    pencil.sagittal_mm = one_height ? pencil.meridional_mm : pencil.sagittal_mm;
    const auto root = newton_depth(in.fluid, pencil, in.g[k], in.colour(k));
    depth.cells[k] = static_cast<double>(root.depth_mm);
  }
  return depth;
}

struct Bench {
  bench::Scene scene;
  Inputs<float> single{scene};
  Inputs<double> full{scene};
  Image<double> exact = exact_depths(scene, false);
  Image<double> exact_of_one_height = exact_depths(scene, true);

  template <class S>
  const Inputs<S>& inputs() const {
    if constexpr (std::is_same_v<S, float>) {
      return single;
    } else {
      return full;
    }
  }

  std::string group() const {
    return scene.name + ", depths up to " + std::to_string(int(scene.pad.fluid.max_depth_mm)) +
           " mm";
  }

  /// `work(inputs, depth, status)` fills the two outputs. `memory` is made before everything that
  /// `work` holds. A row without a truth is a yardstick.
  template <class S, class Work>
  void add(const std::string& name,
           Work work,
           const Image<double>* truth = nullptr,
           const bench::Memory& memory = {}) const {
    const auto depth = std::make_shared<Image<S>>(scene.pad.rows, scene.pad.cols);
    const auto status = std::make_shared<Image<PixelStatus>>(scene.pad.rows, scene.pad.cols);
    bench::add(
        group() + "/" + name, scene.pixels(), memory.bytes(),
        [=, this] { work(inputs<S>(), depth->cells.data(), status->cells.data()); },
        [=](auto& counters) {
          if (truth != nullptr) {
            bench::note_errors(counters, "depth", "mm", bench::errors_of(*depth, *truth));
          }
        });
  }

  /// `find_root(inputs, k)` is called for every pixel k.
  template <class S, class FindRoot>
  void each_pixel(const std::string& name, FindRoot find_root) const {
    add<S>(
        name,
        [=](Planes<S> in, S* depth, PixelStatus* status) {
          for (std::size_t k = 0; k < in.size; ++k) {
            const DepthRoot<S> root = find_root(in, k);
            depth[k] = root.depth_mm;
            status[k] = root.status;
          }
        },
        &exact);
  }

  template <class S>
  void add_rows(const std::string& name) const {
    using Polynomial = detail::DepthPolynomial<S>;
    const bench::Memory memory;
    const auto& camera = scene.pad.camera;
    const auto& g = inputs<S>().g;
    const auto polynomial = std::make_shared<const Polynomial>(
        camera, scene.pad.fluid, std::hypot(camera.center_x_px, camera.center_y_px) + 1,
        *std::min_element(g.begin(), g.end()));
    const auto per_g = std::make_shared<std::vector<S>>(g);
    std::for_each(per_g->begin(), per_g->end(), [](S& x) { x = 1 / x; });
    const auto work = [=, rows = int(scene.pad.rows), cols = int(scene.pad.cols)](
                          Planes<S> in, S* depth, PixelStatus* status) {
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < cols; j += int(Polynomial::block)) {
          const int k = i * cols + j;
          polynomial->invert(i, j, in.red + k, in.green + k, per_g->data() + k, depth + k,
                             status + k);
        }
      }
    };
    add<S>(name, work, &exact, memory);
  }

  void add_baselines() const {
    add<double>(
        "published bisection, double",
        [](Planes<double> in, double* depth, PixelStatus*) {
          const published::Fluid<double> fluid{in.fluid.c_red_per_mm, in.fluid.c_green_per_mm,
                                               in.fluid.kappa};
          for (std::size_t k = 0; k < in.size; ++k) {
            depth[k] =
                published::bisect(fluid, in.pencils[k].path_factor, in.pencils[k].meridional_mm,
                                  in.g[k], in.red[k], in.green[k], in.fluid.max_depth_mm);
          }
        },
        &exact_of_one_height);
    add<float>("streaming pass over two planes",
               [](Planes<float> in, float* depth, PixelStatus* status) {
                 for (std::size_t k = 0; k < in.size; ++k) {
                   depth[k] = in.red[k] + in.green[k];
                   status[k] = PixelStatus::ok;
                 }
               });
    add<float>("streaming pass over three planes",
               [](Planes<float> in, float* depth, PixelStatus* status) {
                 for (std::size_t k = 0; k < in.size; ++k) {
                   depth[k] = in.red[k] + in.green[k] + in.g[k];
                   status[k] = PixelStatus::ok;
                 }
               });
    bench::add_streaming(group(), scene.pixels());
    add_opencv();
  }

  void add_opencv() const {
    const bench::Memory memory;
    const auto out = std::make_shared<bench::Frame<float>>(scene.pad.rows, scene.pad.cols);
    const auto log = [size = int(scene.pixels())](const std::vector<float>& in, Image<float>& to) {
      cv::log(cv::Mat(1, size, CV_32F, const_cast<float*>(in.data())),
              cv::Mat(1, size, CV_32F, to.cells.data()));
    };
    bench::add(
        group() + "/cv::log of both planes", scene.pixels(), memory.bytes(),
        [=, this] {
          log(single.red, out->red);
          log(single.green, out->green);
        },
        [](auto&) {});
  }

  void add_pixelwise() const {
    each_pixel<double>("newton_depth, double, cold", [](const auto& in, std::size_t k) {
      return newton_depth(in.fluid, in.pencils[k], in.g[k], in.colour(k));
    });
    each_pixel<float>("newton_depth, float, cold", [](const auto& in, std::size_t k) {
      return newton_depth(in.fluid, in.pencils[k], in.g[k], in.colour(k));
    });
  }
};

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const Bench published{bench::full_pad(14)};
  published.add_baselines();
  published.add_pixelwise();
  published.add_rows<float>("exponential-free float <3, 6>");
  published.add_rows<double>("exponential-free double <9, 12, 8>");
  return bench::run(argc, argv);
}
