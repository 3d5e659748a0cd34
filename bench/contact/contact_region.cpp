// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A contact region of a round pad from exact depths. The errors are of the area,
// relative to it, and of the center, over 30 contacts: areas within a fifth of the group's, up to 2
// mm off the axis, flat or bulging, level or tilted. They are the errors of the method without
// noise. "on scenes": finite-element membranes, from noisy frames.
#include "fingerpad/contact/contact_region.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"
#include "bench/support/scene_contact.hpp"
#include "fingerpad/published/contact_region.hpp"
#include "support/soap_film.hpp"

using namespace fingerpad;
using test::Image;

namespace {

constexpr Index rows = 480;
constexpr Index cols = 640;
constexpr std::size_t pixels = rows * cols;

cv::Mat as_mat(Image<std::uint8_t>& image) {
  return {int(rows), int(cols), CV_8U, image.cells.data()};
}

/// A contact and its depths as the camera sees them.
template <class S>
struct Scene {
  test::RoundContact contact;
  Image<S> depth;

  Scene(const Camera<double>& camera, const test::RoundContact& c)
      : contact(c), depth(test::depths_of<S>(camera, test::RoundFilm(c), rows, cols)) {}
};

double radius_of(double area_mm2) {
  return std::sqrt(area_mm2 / std::numbers::pi);
}

struct Bench {
  std::string group;
  double area_mm2;
  Camera<double> camera;
  std::shared_ptr<const Scene<float>> timed =
      std::make_shared<Scene<float>>(camera, test::RoundContact{.radius_mm = radius_of(area_mm2)});

  std::vector<Scene<float>> varied() const {
    std::vector<Scene<float>> scenes;
    test::Random random(3);
    for (int k = 0; k < 30; ++k) {
      test::RoundContact c;
      c.radius_mm = radius_of(area_mm2 * random.uniform(0.8, 1.2));
      c.object_per_mm = random.uniform(-0.01, 0);
      c.slope = random.uniform(0, 0.05);
      c.x_mm = random.uniform(-2, 2);
      c.y_mm = random.uniform(-2, 2);
      scenes.emplace_back(camera, c);
    }
    return scenes;
  }

  struct Errors {
    std::vector<double> area, center_mm;
  };

  template <class Region, class Scenes>
  static Errors errors_of(Region& region, const Scenes& scenes) {
    Image<std::uint8_t> mask(rows, cols);
    Errors errors;
    for (const auto& [contact, depth] : scenes) {
      const ContactResult r = region(depth, mask);
      errors.area.push_back((r.area_mm2 - contact.area_mm2()) / contact.area_mm2());
      errors.center_mm.push_back(
          std::hypot(r.center_mm.x - contact.x_mm, r.center_mm.y - contact.y_mm));
    }
    return errors;
  }

  template <class S = float, class Scenes>
  void add_region(const std::string& name,
                  const Scenes& scenes,
                  const ContactTest& test = {}) const {
    using Region = ContactRegion<S>;
    const bench::Memory memory;
    const auto region = std::make_shared<Region>(camera, rows, cols, test);
    const auto mask = std::make_shared<Image<std::uint8_t>>(rows, cols);
    const auto errors = bench::kept([=] { return errors_of(*region, scenes()); });
    bench::add(
        group + "/" + name, pixels, memory.bytes(),
        [=, from = timed] { benchmark::DoNotOptimize((*region)(from->depth, *mask)); },
        [=](auto& counters) {
          bench::note_area_on_scenes<Region>(counters, test);
          bench::note_errors(counters, "area", "share", errors().area);
          bench::note_errors(counters, "center", "mm", errors().center_mm);
        });
  }

  /// Plain loops over every fifth pixel.
  void add_published() const {
    const auto errors = bench::kept([this] {
      Image<std::uint8_t> mask(rows, cols);
      std::vector<double> area;
      for (const auto& [contact, depth] : varied()) {
        const double found_mm2 = published::contact_by_slides(depth, mask);
        area.push_back((found_mm2 - contact.area_mm2()) / contact.area_mm2());
      }
      return area;
    });
    bench::add(
        group + "/published test", pixels, static_cast<long>(pixels),
        [from = timed, mask = Image<std::uint8_t>(rows, cols)]() mutable {
          benchmark::DoNotOptimize(published::contact_by_slides(from->depth, mask));
        },
        [=](auto& counters) { bench::note_errors(counters, "area", "share", errors()); });
  }

  void add_opencv() const {
    const auto level = [from = timed, mask = Image<std::uint8_t>(rows, cols), above = cv::Mat(),
                        labels = cv::Mat(), values = cv::Mat(), centers = cv::Mat()]() mutable {
      const cv::Mat depth(int(rows), int(cols), CV_32F,
                          const_cast<float*>(from->depth.cells.data()));
      cv::threshold(depth, above, 9.98, 255, cv::THRESH_BINARY);
      cv::Mat to = as_mat(mask);
      above.convertTo(to, CV_8U);
      cv::connectedComponentsWithStats(to, labels, values, centers);
    };
    bench::add(group + "/cv::threshold and cv::connectedComponents of depths", pixels,
               static_cast<long>(pixels * (4 + 1 + 4)), level, [](auto&) {});
  }

  void add_all() const {
    const auto scenes = bench::kept([this] { return varied(); });
    add_published();
    add_region("default", scenes);
    add_region<double>("default, double", scenes);
    add_region("no placed edge", scenes, {.places_edge = false});
    bench::add_streaming(group, pixels);
    add_opencv();
  }
};

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const auto camera = test::pad_camera(480, 640, 0.0768);
  const Bench contact{"350 mm^2", 350, camera};  // outlives the rows
  contact.add_all();
  return bench::run(argc, argv);
}
