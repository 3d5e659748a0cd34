// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Depth from smoothed planes of red and green by every inverse. The error is of each pixel against
// the root in long double of the same equation with the same inputs. Quantities that depend only on
// the pixel (its pencil and g) are computed before the clock starts, for every inverse.
#include "fingerpad/published/depth.hpp"

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"
#include "fingerpad/depth/depth.hpp"

using namespace fingerpad;
using bench::Image;

namespace {

/// Inputs of every inverse in its own scalar; all hold the same numbers, those of float.
template <class S>
struct Inputs {
  Absorption<S> fluid;
  DepthReference<S> reference;
  std::vector<S> red;
  std::vector<S> green;
  std::vector<Pencil<S>> pencils;
  std::vector<S> g;

  explicit Inputs(const bench::Scene& scene) : fluid(cast<S>(scene.pad.fluid)) {
    const auto colours = scene.pad.frame<float>(scene.free_mm);
    red.assign(colours.red.cells.begin(), colours.red.cells.end());
    green.assign(colours.green.cells.begin(), colours.green.cells.end());
    const auto fitted = scene.pad.reference<float>();
    reference.rows = fitted.rows;
    reference.cols = fitted.cols;
    reference.pixels_used = fitted.pixels_used;
    reference.depth_mm.assign(fitted.depth_mm.begin(), fitted.depth_mm.end());
    reference.scattering.rho_max_mm = S(fitted.scattering.rho_max_mm);
    std::copy(fitted.scattering.coefficient.begin(), fitted.scattering.coefficient.end(),
              reference.scattering.coefficient.begin());
    const auto camera = cast<S>(scene.pad.camera);
    for (Index i = 0; i < reference.rows; ++i) {
      for (Index j = 0; j < reference.cols; ++j) {
        const auto ray = ray_at_pixel(camera, S(i), S(j));
        pencils.push_back(pencil_of(camera, ray));
        g.push_back(reference.scattering(i, j, S(ray.plate_rho_mm * ray.plate_rho_mm)));
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
  const Pencil<S>* pencils;
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

Image<double> exact_depths(const bench::Scene& scene) {
  const Inputs<long double> inputs(scene);
  const Planes<long double> in(inputs);
  Image<double> depth(scene.pad.rows, scene.pad.cols);
  for (std::size_t k = 0; k < depth.cells.size(); ++k) {
    const auto root = newton_depth(in.fluid, in.pencils[k], in.g[k], in.colour(k));
    depth.cells[k] = static_cast<double>(root.depth_mm);
  }
  return depth;
}

/// The published bisection at its fastest: without range checks and without a status.
double bisection(const Absorption<double>& fluid,
                 const Pencil<double>& pencil,
                 double g,
                 const Colour<double>& colour) {
  double depth = fluid.max_depth_mm / 2;
  double step = depth / 2;
  for (int i = 2; i < 16; ++i) {
    depth += published::quotient(fluid, pencil, colour, depth) < g ? -step : step;
    step /= 2;
  }
  return depth;
}

struct Bench {
  bench::Scene scene;
  Inputs<float> single{scene};
  Inputs<double> full{scene};
  Image<double> exact = exact_depths(scene);

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
  /// `work` holds.
  template <class S, class Work>
  void add(const std::string& name, Work work, const bench::Memory& memory = {}) const {
    const auto depth = std::make_shared<Image<S>>(scene.pad.rows, scene.pad.cols);
    const auto status = std::make_shared<Image<PixelStatus>>(scene.pad.rows, scene.pad.cols);
    const bool is_yardstick = name.starts_with("streaming");
    bench::add(
        group() + "/" + name, scene.pixels(), memory.bytes(),
        [=, this] { work(inputs<S>(), depth->cells.data(), status->cells.data()); },
        [=, this](auto& counters) {
          if (!is_yardstick) {
            bench::note_errors(counters, "depth", "mm", bench::errors_of(*depth, exact));
          }
        });
  }

  /// `find_root(inputs, k)` is called for every pixel k.
  template <class S, class FindRoot>
  void each_pixel(const std::string& name, FindRoot find_root) const {
    add<S>(name, [=](Planes<S> in, S* depth, PixelStatus* status) {
      for (std::size_t k = 0; k < in.size; ++k) {
        const DepthRoot<S> root = find_root(in, k);
        depth[k] = root.depth_mm;
        status[k] = root.status;
      }
    });
  }

  template <class S, int Order, int Degree, int Radial, class Scattering>
  void add_rows(const std::string& name, const DepthReference<S, Scattering>& reference) const {
    using Policy = ExponentialFree<Order, Degree, Radial>;
    using Rows = detail::DepthRows<Policy, AstigmaticHeights, S, Scattering>;
    const bench::Memory memory;
    const auto rows =
        std::make_shared<const Rows>(scene.pad.camera, scene.pad.fluid, reference, Policy());
    const auto work = [=, height = scene.pad.rows, width = scene.pad.cols](Planes<S> in, S* depth,
                                                                           PixelStatus* status) {
      for (Index i = 0; i < height; ++i) {
        const Index k = i * width;
        rows->invert(i, width, in.red + k, in.green + k, depth + k, status + k);
      }
    };
    add<S>(name, work, memory);
  }

  /// Rows with g folded into the polynomials and with g as a plane of its own.
  template <int Order, int Degree, int Radial = 3>
  void add_single() const {
    const std::string name = "exponential-free float <" + std::to_string(Order) + ", " +
                             std::to_string(Degree) +
                             (Radial == 3 ? ">" : ", " + std::to_string(Radial) + ">");
    add_rows<float, Order, Degree, Radial>(name, single.reference);
    DepthReference<float, published::PixelScattering<float>> planar;
    planar.rows = single.reference.rows;
    planar.cols = single.reference.cols;
    planar.depth_mm = single.reference.depth_mm;
    planar.pixels_used = single.reference.pixels_used;
    planar.scattering = {planar.cols, single.g};
    add_rows<float, Order, Degree, Radial>(name + ", plane of g", planar);
  }

  void add_baselines() const {
    add<double>("published bisection, double", [](Planes<double> in, double* depth, PixelStatus*) {
      for (std::size_t k = 0; k < in.size; ++k) {
        depth[k] = bisection(in.fluid, in.pencils[k], in.g[k], in.colour(k));
      }
    });
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
    each_pixel<double>("bisect_depth, double", [](const auto& in, std::size_t k) {
      return published::bisect_depth(in.fluid, in.pencils[k], in.g[k], in.colour(k));
    });
    each_pixel<float>("bisect_depth, float", [](const auto& in, std::size_t k) {
      return published::bisect_depth(in.fluid, in.pencils[k], in.g[k], in.colour(k));
    });
    each_pixel<double>("newton_depth, double, cold", [](const auto& in, std::size_t k) {
      return newton_depth(in.fluid, in.pencils[k], in.g[k], in.colour(k));
    });
    each_pixel<double>("newton_depth, double, warm by 0.05 mm", [this](const auto& in,
                                                                       std::size_t k) {
      return newton_depth(in.fluid, in.pencils[k], in.g[k], in.colour(k), exact.cells[k] + 0.05);
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
  published.add_single<2, 5>();
  published.add_single<2, 6>();
  published.add_single<3, 5>();
  published.add_single<3, 6>();
  published.add_single<3, 6, 4>();
  published.add_single<4, 5>();
  published.add_single<4, 6>();
  published.add_rows<double, 3, 6, 3>("exponential-free double <3, 6>", published.full.reference);
  published.add_rows<double, 9, 12, 8>("exponential-free double <9, 12, 8>",
                                       published.full.reference);
  const Bench deep{bench::full_pad(18)};
  deep.add_baselines();
  deep.add_single<2, 5>();
  deep.add_single<3, 6>();
  return bench::run(argc, argv);
}
