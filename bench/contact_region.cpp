// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Contact regions of a round pad from exact depths, a small and a large one. The error is that of
// the area, as a share of it: what the method leaves, without noise.
#include "fingerpad/contact_region.hpp"

#include <cmath>
#include <memory>
#include <string>

#include "../tests/support/soap_film.hpp"
#include "support/run.hpp"

using namespace fingerpad;
using bench::add;
using test::Image;

namespace {

struct Bench {
  static constexpr Index rows = 480;
  static constexpr Index cols = 640;
  Camera<double> camera = test::pad_camera(rows, cols, 0.0768);
  test::RoundFilm film;
  std::shared_ptr<const Image<float>> depth;
  std::string group;

  explicit Bench(double area_mm2)
      : film({.radius_mm = std::sqrt(area_mm2 / 3.14159265358979323846)}),
        depth(std::make_shared<Image<float>>(test::depths_of<float>(camera, film, rows, cols))),
        group(std::to_string(static_cast<int>(area_mm2)) + " mm^2/") {}

  static std::size_t pixels() { return static_cast<std::size_t>(rows * cols); }

  template <class Statistic, class Edge = HalfLevelEdge, class Cleaning = WithoutSpecks>
  void add_region(const std::string& name,
                  const ContactTest& test = {},
                  const Edge& edge = {},
                  const Cleaning& cleaning = {}) const {
    using Region = ContactRegion<Statistic, Edge, Cleaning>;
    const auto region = std::make_shared<Region>(camera, rows, cols, test, edge, cleaning);
    const auto workspace = std::make_shared<typename Region::Workspace>(*region);
    const auto mask = std::make_shared<Image<std::uint8_t>>(rows, cols);
    const auto result = std::make_shared<ContactResult>();
    add(
        group + name, pixels(),
        [=, from = depth] { *result = (*region)(*from, *mask, *workspace); },
        [=, truth = film.area_mm2()](auto& counters) {
          counters["share_wrong_area"] = std::abs(result->area_mm2 - truth) / truth;
        });
  }

  void add_growth() const {
    const auto mask = std::make_shared<Image<std::uint8_t>>(rows, cols);
    const auto out = std::make_shared<Image<std::uint8_t>>(rows, cols);
    const auto middle = point_at(camera, 239.5, 319.5, film.top_mm);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const auto p =
            point_at(camera, static_cast<double>(i), static_cast<double>(j), film.top_mm);
        (*mask)(i, j) = film.touches(p.x - middle.x, p.y - middle.y) ? 255 : 0;
      }
    }
    const MaskGrowth growth(rows, cols);
    const auto workspace = std::make_shared<MaskGrowth::Workspace>(growth.workspace());
    add(
        group + "MaskGrowth by 22.5 px", pixels(), [=] { growth(*mask, 22.5, *out, *workspace); },
        [](auto&) {});
  }

  void add_all() const {
    const HalfLevelEdge no_gap{0};
    ContactTest near_zero;
    near_zero.threshold_per_mm = 0.001;
    add_region<PublishedTwiceMean<>, AtThreshold, NoCleaning>("published test",
                                                              published_contact_test());
    add_region<ClampedMean<>>("default, with its gap");
    add_region<ClampedMean<>>("default, no gap", {}, no_gap);
    add_region<ClampedMean<>, HalfLevelEdge, Hysteresis>("Hysteresis, no gap", {}, no_gap);
    add_region<ClampedMean<>, AtThreshold>("AtThreshold, half of the free pad");
    add_region<ClampedMean<>, WidenedByRing>("WidenedByRing, threshold near 0", near_zero);
    add_region<ClampedHessian<>, AtThreshold>("AtThreshold, ClampedHessian");
    add_growth();
  }
};

}  // namespace

int main(int argc, char** argv) {
  Bench(110).add_all();
  Bench(350).add_all();
  return bench::run(argc, argv);
}
