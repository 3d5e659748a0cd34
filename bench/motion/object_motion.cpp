// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Motion of an object from the dots in contact; "ns/pixel" is per frame or per dot. Errors of a
// frame: of attitude and place in all frames of ten balls that roll 30 mm. Errors of dots in space:
// against the rays. Noise: 0.02 mm in the plane, 0.05 mm in depth. "on scenes": a finite-element
// ball that rolls by 20 degrees, from noisy frames.
#include "fingerpad/motion/object_motion.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene_motion.hpp"
#include "fingerpad/published/object_motion.hpp"
#include "support/pad.hpp"
#include "support/rolling.hpp"

using namespace fingerpad;

namespace {

constexpr double degrees = 180 / std::numbers::pi;

template <class S>
Rotation<double> in_double(const Rotation<S>& r) {
  Rotation<double> out;
  for (int i = 0; i < 9; ++i) {
    out.m[i / 3][i % 3] = static_cast<double>(r.m[i / 3][i % 3]);
  }
  return out;
}

/// A roll of 30 mm along a circle, in 300 frames.
struct Roll {
  explicit Roll(std::uint64_t seed) : initial(test::RollingBall().initial()) {
    test::Gauss gauss(seed);
    const auto x = [](int k) { return 4.8 * std::cos(k * 0.0208) + 0.2; };
    const auto y = [](int k) { return 4.8 * std::sin(k * 0.0208) - 0.1; };
    test::Rolling roll(test::RollingBall(), x(0), y(0));
    for (int k = 0; k < 300; ++k) {
      roll.step(x(k), y(k));
      dots.push_back(noisy(roll.dots, roll.contact, gauss));
      contact.push_back(roll.contact);
      truth.push_back(roll.pose);
    }
  }

  test::Dots initial;
  std::vector<test::Dots> dots;
  std::vector<test::Flags> contact;
  std::vector<Pose<double>> truth;
};

const std::vector<Roll>& rolls() {
  static const std::vector<Roll> all = [] {
    std::vector<Roll> r;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      r.emplace_back(seed);
    }
    return r;
  }();
  return all;
}

struct RollErrors {
  std::vector<double> attitude_deg, place_mm;
};

/// `make` makes the method from the dots of the free pad.
template <class Make>
RollErrors roll_errors(const Make& make) {
  RollErrors errors;
  const Point3<double> touched{5, 0, 10};  // first contact point of the ball
  for (const Roll& roll : rolls()) {
    auto motion = make(roll.initial);
    for (std::size_t k = 0; k < roll.dots.size(); ++k) {
      const auto r = motion(roll.dots[k], roll.contact[k]);
      if (!r.ok()) {
        errors.attitude_deg.push_back(std::nan(""));
        errors.place_mm.push_back(std::nan(""));
        continue;
      }
      const Rotation<double> turn = in_double(r.pose.rotation);
      const Point3<double> shift{static_cast<double>(r.pose.translation_mm.x),
                                 static_cast<double>(r.pose.translation_mm.y),
                                 static_cast<double>(r.pose.translation_mm.z)};
      errors.attitude_deg.push_back(degrees * angle_between(turn, roll.truth[k].rotation));
      const auto off = (Pose<double>{turn, shift}(touched)) - roll.truth[k](touched);
      errors.place_mm.push_back(std::sqrt(squared_norm(off)));
    }
  }
  return errors;
}

template <class Make>
void add_frame(const std::string& name, const Make& make) {
  const Roll& roll = rolls().front();
  struct Running {
    decltype(make(roll.initial)) fresh, motion;
    std::size_t k = 0;
  };
  const bench::Memory memory;
  const auto d = std::make_shared<Running>(Running{make(roll.initial), make(roll.initial)});
  bench::add(
      "frame of 21x21 dots/" + name, 1, memory.bytes(),
      [d, &roll] {
        if (d->k == roll.dots.size()) {
          d->k = 0;
          d->motion = d->fresh;
        }
        benchmark::DoNotOptimize(d->motion(roll.dots[d->k], roll.contact[d->k]));
        ++d->k;
      },
      [=, errors = RollErrors()](auto& counters) mutable {
        errors = errors.place_mm.empty() ? roll_errors(make) : errors;
        bench::note_motion_on_scene(counters, make);
        bench::note_errors(counters, "attitude", "deg", errors.attitude_deg);
        bench::note_errors(counters, "place", "mm", errors.place_mm);
      });
}

/// Umeyama's closed form for the dots in contact, from frame 0 to frame 10.
void add_opencv_frame() {
  struct Data {
    std::vector<cv::Point3d> from, to;
    cv::Mat motion;
  };
  const Roll& roll = rolls().front();
  const auto d = std::make_shared<Data>();
  for (std::size_t k = 0; k < roll.dots[0].cells.size(); ++k) {
    if (roll.contact[0].cells[k] != 0 && roll.contact[10].cells[k] != 0) {
      const auto &p = roll.dots[0].cells[k], &q = roll.dots[10].cells[k];
      d->from.emplace_back(p.x, p.y, p.z);
      d->to.emplace_back(q.x, q.y, q.z);
    }
  }
  bench::add(
      "frame of 21x21 dots/cv::estimateAffine3D, rigid", 1, 12 * sizeof(double),
      [d] {
        double scale = 1;
        d->motion = cv::estimateAffine3D(d->from, d->to, &scale, true);
        benchmark::DoNotOptimize(d->motion.data);
      },
      [](auto&) {});
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  add_frame("published: ObjectMotion",
            [](const test::Dots& free) { return published::ObjectMotion(free); });
  add_frame("ObjectMotion, double, the default",
            [](const test::Dots& free) { return ObjectMotion<>(free.rows(), free.cols()); });
  add_frame("ObjectMotion, float",
            [](const test::Dots& free) { return ObjectMotion<float>(free.rows(), free.cols()); });
  add_opencv_frame();
  bench::add_streaming("frame of 21x21 dots");
  return bench::run(argc, argv);
}
