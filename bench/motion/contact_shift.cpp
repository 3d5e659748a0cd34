// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Displacement and rotation of a contact from 21 x 21 dots, 69 of them in contact, with 0.005 mm of
// noise ("ns/pixel" is per dot of the grid). In "stuck" rows every seventh dot stays where it was.
// Errors: over 1000 contacts of 4 to 9 mm, displaced by up to 1 mm and rotated by up to 0.1 rad.
#include "fingerpad/motion/contact_shift.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "bench/support/run.hpp"

using namespace fingerpad;

namespace {

constexpr Index side = 21;
constexpr std::size_t all_dots = side * side;
constexpr double pitch_mm = 1.5;

struct Motion {
  double contact_mm = 7;
  Point2<double> moved_mm{0.7, -0.4};
  double angle_rad = 0.05;
};

template <class S>
struct Scene {
  Motion motion;
  std::vector<Point2<S>> from, to;
  std::vector<unsigned char> touch;

  Scene(const Motion& m, bool stuck, std::mt19937& random) : motion(m) {
    std::normal_distribution<double> noise(0, 0.005);
    for (Index k = 0; k < side * side; ++k) {
      const double x = pitch_mm * static_cast<double>(k % side - side / 2);
      const double y = pitch_mm * static_cast<double>(k / side - side / 2);
      const bool stays = stuck && k % 7 == 0;
      const double c = stays ? 1 : std::cos(m.angle_rad), s = stays ? 0 : std::sin(m.angle_rad);
      const Point2<double> shift = stays ? Point2<double>{0, 0} : m.moved_mm;
      from.push_back({S(x), S(y)});
      to.push_back(
          {S(c * x - s * y + shift.x + noise(random)), S(s * x + c * y + shift.y + noise(random))});
      touch.push_back(std::hypot(x, y) < m.contact_mm ? 1 : 0);
    }
  }
  static auto grid(const auto& cells) { return StridedView(cells.data(), side, side, side); }
};

/// Notes the errors of shift(scene) over 1000 scenes.
template <class S, class Shift>
void note(bench::Counters& counters, bool stuck, const Shift& shift) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> share(-1, 1);
  std::vector<double> moved_mm, turned_deg;
  for (int k = 0; k < 1000; ++k) {
    const Scene<S> scene({6.5 + 2.5 * share(random),
                          {0.7 * share(random), 0.7 * share(random)},
                          0.1 * share(random)},
                         stuck, random);
    const ShiftResult<S> r = shift(scene);
    moved_mm.push_back(std::hypot(static_cast<double>(r.displacement.x) - scene.motion.moved_mm.x,
                                  static_cast<double>(r.displacement.y) - scene.motion.moved_mm.y));
    turned_deg.push_back((static_cast<double>(r.rotation_rad) - scene.motion.angle_rad) * 180 /
                         std::numbers::pi);
  }
  bench::note_errors(counters, "displacement", "mm", moved_mm);
  bench::note_errors(counters, "angle", "deg", turned_deg);
}

template <class S>
std::shared_ptr<Scene<S>> timed_scene(bool stuck) {
  std::mt19937 random(1);
  return std::make_shared<Scene<S>>(Motion(), stuck, random);
}

template <class S>
void add(const std::string& name, bool stuck, const ShiftOptions& options) {
  const auto scene = timed_scene<S>(stuck);
  const bench::Memory memory;
  const auto shift = std::make_shared<ContactShift<S>>(Scene<S>::grid(scene->from), options);
  const auto of = [=](const Scene<S>& s) { return (*shift)(s.grid(s.to), s.grid(s.touch)); };
  bench::add(
      name, all_dots, memory.bytes(), [=] { benchmark::DoNotOptimize(of(*scene)); },
      [=](auto& counters) { note<S>(counters, stuck, of); });
}

/// The displacement of the central dot, and the angle of all dots in contact.
void add_central_dot(const std::string& name, bool stuck) {
  const auto scene = timed_scene<double>(stuck);
  const bench::Memory memory;
  const auto shift = std::make_shared<ContactShift<double>>(Scene<double>::grid(scene->from),
                                                            ShiftOptions{.edge_dots = false});
  const auto of = [=](const Scene<double>& s) {
    auto result = (*shift)(s.grid(s.to), s.grid(s.touch));
    result.displacement = s.to[all_dots / 2] - s.from[all_dots / 2];
    return result;
  };
  bench::add(
      name, all_dots, memory.bytes(), [=] { benchmark::DoNotOptimize(of(*scene)); },
      [=](auto& counters) { note<double>(counters, stuck, of); });
}

/// Least squares of rotation, scale and displacement; no dot is far enough off to be an outlier.
void add_opencv(const std::string& name, bool stuck) {
  struct Pairs {
    std::vector<cv::Point2f> from, to;
  };
  const auto scene = timed_scene<float>(stuck);
  const bench::Memory memory;
  const auto pairs = std::make_shared<Pairs>();
  const auto of = [=](const Scene<float>& s) {
    pairs->from.clear();
    pairs->to.clear();
    for (std::size_t k = 0; k < s.to.size(); ++k) {
      if (s.touch[k] != 0) {
        pairs->from.push_back({s.from[k].x, s.from[k].y});
        pairs->to.push_back({s.to[k].x, s.to[k].y});
      }
    }
    const cv::Mat m =
        cv::estimateAffinePartial2D(pairs->from, pairs->to, cv::noArray(), cv::RANSAC, 1e6);
    ShiftResult<float> result;
    result.displacement = {static_cast<float>(m.at<double>(0, 2)),
                           static_cast<float>(m.at<double>(1, 2))};
    result.rotation_rad = static_cast<float>(std::atan2(m.at<double>(1, 0), m.at<double>(0, 0)));
    return result;
  };
  bench::add(
      name, all_dots, memory.bytes(), [=] { benchmark::DoNotOptimize(of(*scene)); },
      [=](auto& counters) { note<float>(counters, stuck, of); });
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  for (const bool stuck : {false, true}) {
    const std::string group = stuck ? "stuck dots" : "noise only";
    add_central_dot(group + "/central dot, published", stuck);
    add<double>(group + "/dots in contact", stuck, {.edge_dots = false});
    add<double>(group + "/dots in contact, robust", stuck,
                {.edge_dots = false, .robust_passes = 10});
    add<double>(group + "/dots of the edge, the default", stuck, {});
    add<float>(group + "/dots of the edge, the default, float", stuck, {});
    add<double>(group + "/dots of the edge, robust", stuck, {.robust_passes = 10});
    bench::add_streaming(group, all_dots);
    add_opencv(group + "/cv::estimateAffinePartial2D of the dots in contact", stuck);
  }
  return bench::run(argc, argv);
}
