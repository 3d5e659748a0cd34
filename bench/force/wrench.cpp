// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Six-axis force; "ns/pixel" is per frame: lines, side dots, forces. The shape is given.
// Truth: 24 films pressed flat, dragged and rotated by forces of every direction and size at 5 to
// 20 kPa. Their force, moment and side dots are known in closed form
// (tests/support/pressed_pad.hpp), by the law of a clamped rim. "on scenes":
// finite-element membranes, which do not follow this law.
// Errors: of F_z, of F_x and F_y together, M_x and M_y together and M_z, relative to the truth;
// "heights in plan": all heights in a disc of 18 mm, with the blur of a frame.
#include "fingerpad/force/wrench.hpp"

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene_wrench.hpp"
#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/published/segment_equilibrium.hpp"
#include "support/pressed_pad.hpp"

using namespace fingerpad;
using test::as;
using test::Image;
using test::RimLoad;

namespace {

using Film = test::RoundPad<test::FilmSide>;

/// A pressed pad with its pressure, a lateral force at the height of the object and a torque.
struct Load {
  Film pad;
  double pressure_mpa, shear_share, turning_share, direction_rad;

  test::Wrench6 truth() const { return wrench_of(rim_of(pad), *this, pressure_mpa); }

  RimLoad operator()(double at) const {
    const double sine = pad.sine(pad.radius_mm), cosine = std::sqrt(1 - sine * sine);
    const double high = pad.height(0), normal = pad.tension(pad.radius_mm, pressure_mpa);
    const double shear = shear_share * normal, turning = turning_share * normal;
    const double lean = -high * shear / (pad.radius_mm * sine - high * cosine);
    return {normal + lean * std::cos(at - direction_rad),
            turning - shear * std::sin(at - direction_rad)};
  }
};

/// The first load is the timed one.
const std::vector<Load>& loads() {
  static const std::vector<Load> all = [] {
    std::vector<Load> list;
    for (int k = 0; k < 24; ++k) {
      Film pad;
      pad.contact_mm = 8 + k % 3 - (k % 2 == 0 ? 0 : 1.5);
      pad.rim_sine = 0.9 - 0.05 * (k % 4);
      const double pressure_mpa = 0.01 * std::pow(2, (k * 5 % 9 - 4 * (k != 0)) / 4.0);
      const double shear = 0.1 - 0.08 * (k * 7 % 10) / 9.0;
      const double turning = (k % 2 == 0 ? 0.1 : -0.1) * (1 - 0.1 * (k % 8));
      list.push_back({pad, pressure_mpa, shear, turning, k * std::numbers::pi * 0.37});
    }
    return list;
  }();
  return all;
}

template <class S>
HeightMap<S> heights_of(const Film& pad) {
  HeightMap<S> map(S(19.5), S(0.5));
  map.fill([&](Index i, Index j) { return pad(map.position_mm(j), map.position_mm(i)).height_mm; },
           [&](Index i, Index j, const auto&...) {
             return S(pad.in_contact(map.position_mm(j), map.position_mm(i)) ? 1 : 0);
           });
  return map;
}

/// The shapes of all loads.
template <class S>
const std::vector<HeightMap<S>>& shapes() {
  static const std::vector<HeightMap<S>> all = [] {
    std::vector<HeightMap<S>> list;
    for (const Load& load : loads()) {
      list.push_back(heights_of<S>(load.pad));
    }
    return list;
  }();
  return all;
}

struct WrenchErrors {
  std::vector<double> force_z, force_xy, moment_xy, moment_z;

  template <class Result>
  void add(const Result& found, const test::Wrench6& truth) {
    const auto share = [](double x, double y, double true_x, double true_y) {
      return std::hypot(x - true_x, y - true_y) / std::hypot(true_x, true_y);
    };
    const auto &f = found.force_n, &m = found.moment_n_mm;
    const auto &tf = truth.force_n, &tm = truth.moment_n_mm;
    force_z.push_back(double(f.z) / tf.z - 1);
    force_xy.push_back(share(double(f.x), double(f.y), tf.x, tf.y));
    moment_xy.push_back(share(double(m.x), double(m.y), tm.x, tm.y));
    moment_z.push_back(double(m.z) / tm.z - 1);
  }
  void note(bench::Counters& counters) const {
    bench::note_errors(counters, "F_z", "share", force_z);
    bench::note_errors(counters, "F_xy", "share", force_xy);
    bench::note_errors(counters, "M_xy", "share", moment_xy);
    bench::note_errors(counters, "M_z", "share", moment_z);
  }
};

/// `make(border, length of the side dots in mm, inclination)` gives
/// force_of(heights, side dots, pressure). The films have no inclination: their rim follows the
/// chord exactly.
template <class S, class Make>
void add_frame(const std::string& group, const std::string& name, const Make& make) {
  std::vector<Image<Point3<S>>> dots;
  for (const Load& load : loads()) {
    dots.push_back(as<S>(rim_of(load.pad).dots(load)));
  }
  const auto border = as<S>(rim_of(loads().front().pad).borders());
  const auto& shape = shapes<S>();
  const bench::Memory memory;
  using ForceOf = decltype(make(border, 0.8, std::optional<double>()));
  const auto force_of = std::make_shared<ForceOf>(make(border, 0.8, std::nullopt));
  bench::add(
      group + "/" + name, 1, memory.bytes(),
      [force_of, dots, &shape] {
        auto result = (*force_of)(shape[0], dots[0], S(loads()[0].pressure_mpa));
        benchmark::DoNotOptimize(result);
      },
      [=, &shape](auto& counters) {
        bench::note_wrench_on_scenes<S>(counters, make(as<S>(test::rim_border()), 0.79995, 1.0623));
        WrenchErrors errors;
        for (std::size_t k = 0; k < loads().size(); ++k) {
          const Load& load = loads()[k];
          errors.add((*force_of)(shape[k], dots[k], S(load.pressure_mpa)), load.truth());
        }
        errors.note(counters);
      });
}

template <class S>
WrenchOptions<S> options_of(double length_mm, const std::optional<double>& inclination) {
  return {.side_dot_length_mm = S(length_mm), .stress_free_inclination_rad = inclination};
}

void add_all(const std::string& group) {
  const auto by_shape = [](const auto& border, double length, std::optional<double> inclination) {
    using S = decltype(border(0, 0).x + 0);
    return Wrench<S>(border, options_of<S>(length, inclination));
  };
  const auto by_modulus = [](const auto& border, double length, std::optional<double> inclination) {
    auto options = options_of<double>(length, inclination);
    options.modulus_n_per_mm = 0.5;
    return [w = Wrench<>(border, options)](const auto&, const auto&... frame) mutable {
      return w.by_modulus(frame...);
    };
  };
  const auto printed = [](const auto& border, double, const auto&) {
    return published::SegmentEquilibrium<>(border);
  };
  add_frame<double>(group, "published: segments", printed);
  add_frame<double>(group, "by_modulus()", by_modulus);
  add_frame<double>(group, "double, the default", by_shape);
  add_frame<float>(group, "float", by_shape);
}

/// Heights in plan from a depth map of 640 x 480 pixels.
template <class S>
void add_heights(const std::string& name) {
  struct Picture {
    Film pad;
    Image<float> depth{480, 640, 0.0F};
    Image<std::uint8_t> mask{480, 640};
  };
  struct InPlan {
    PadHeights<Camera<S>> heights{480, 640, Camera<S>()};
    HeightMap<S> map = heights.map();
  };
  const auto picture = std::make_shared<Picture>();
  const Film& pad = picture->pad;
  for (Index i = 0; i < 480; ++i) {
    for (Index j = 0; j < 640; ++j) {
      // bisection: the ray is below the membrane, then above
      double z = 0, high = 20;
      Point3<double> p{0, 0, 0};
      for (int step = 0; step < 40; ++step) {
        const double middle = (z + high) / 2;
        p = point_at(Camera<double>(), static_cast<double>(i), static_cast<double>(j), middle);
        const double r = std::hypot(p.x, p.y);
        (r < pad.radius_mm && pad.height(r) > middle ? z : high) = middle;
      }
      picture->depth(i, j) = static_cast<float>(z);
      picture->mask(i, j) = pad.touches(std::hypot(p.x, p.y)) ? 1 : 0;
    }
  }
  const bench::Memory memory;
  const auto d = std::make_shared<InPlan>();
  bench::add(
      "heights in plan from 640x480/" + name, 1, memory.bytes(),
      [=] {
        d->heights(picture->depth, picture->mask, d->map);
        benchmark::DoNotOptimize(d->map);
      },
      [=](auto& counters) {
        std::vector<double> errors;
        for (Index i = 0; i < d->map.side(); ++i) {
          for (Index j = 0; j < d->map.side(); ++j) {
            const double x = double(d->map.position_mm(j)), y = double(d->map.position_mm(i));
            if (std::hypot(x, y) < 18) {
              errors.push_back(double(d->map(S(x), S(y)).height_mm) -
                               picture->pad.height(std::hypot(x, y)));
            }
          }
        }
        bench::note_errors(counters, "height", "mm", errors);
      });
}

/// An image of 640 x 480 pixels resampled at as many positions.
void add_opencv_heights() {
  struct Picture {
    cv::Mat depth{480, 640, CV_32F, cv::Scalar(8)}, column, row, plan;
  };
  const int side =
      static_cast<int>(PadHeights<Camera<float>>(480, 640, Camera<float>()).map().side());
  const auto d = std::make_shared<Picture>();
  d->column = cv::Mat(side, side, CV_32F);
  d->row = cv::Mat(side, side, CV_32F);
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      d->row.at<float>(i, j) = 479.3F * static_cast<float>(i) / static_cast<float>(side);
      d->column.at<float>(i, j) = 639.3F * static_cast<float>(j) / static_cast<float>(side);
    }
  }
  bench::add(
      "heights in plan from 640x480/cv::remap to as many places", 1,
      static_cast<long>(sizeof(float)) * 3 * side * side,
      [d] {
        cv::remap(d->depth, d->plan, d->column, d->row, cv::INTER_LINEAR);
        benchmark::DoNotOptimize(d->plan.data);
      },
      [](auto&) {});
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  add_all("72 side dots");
  bench::add_streaming("72 side dots");
  add_heights<double>("double");
  add_heights<float>("float");
  add_opencv_heights();
  return bench::run(argc, argv);
}
