// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Prints results of methods on one synthetic scene with all digits. tests/modes compares the output
// of different compilers, options and machines. Two threads compute them at once, with the same
// estimators where a call does not change them, and must agree to the bit.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fingerpad/fingerpad.hpp>
#include <string>
#include <thread>
#include <vector>

#include "support/pad.hpp"

namespace {

using namespace fingerpad;

class Results {
 public:
  void operator()(const char* name, double x) {
    char line[80];
    std::snprintf(line, sizeof line, "%-24s %.17g\n", name, x);
    lines_ += line;
  }
  const std::string& lines() const { return lines_; }

 private:
  std::string lines_;
};

/// Mean of the known cells.
template <class Image>
double mean(const Image& image) {
  double sum = 0, known = 0;
  for (const auto cell : image.cells) {
    sum += is_finite(static_cast<double>(cell)) ? static_cast<double>(cell) : 0;
    known += is_finite(static_cast<double>(cell)) ? 1 : 0;
  }
  return sum / known;
}

void tell_depth_and_contact(Results& tell) {
  const test::Pad pad;
  const auto frame = pad.frame<std::uint8_t>(pad.pressed_depths(3));
  auto estimate = pad.estimator<float>({.window_px = 5});
  test::Image<float> depth(pad.rows, pad.cols);
  test::Image<PixelStatus> status(pad.rows, pad.cols);
  const auto result = estimate(frame.red, frame.green, depth, status);
  tell("depth accepted", result.ok() ? 1 : 0);
  tell("depth pixels", static_cast<double>(result.valid_pixels()));
  tell("depth mean mm", mean(depth));
  tell("depth in the middle mm", static_cast<double>(depth(24, 28)));
  ContactTest test;
  test.ring_px = 4;
  test.min_region_px = 10;
  ContactRegion<> region(pad.camera, pad.rows, pad.cols, test);
  test::Image<std::uint8_t> mask(pad.rows, pad.cols);
  const auto contact = region(depth, mask);
  tell("contact pixels", static_cast<double>(contact.contact_px));
  tell("contact area mm2", contact.area_mm2);
}

template <class Frame>
void tell_samples(Results& tell, const char* name, const Frame& frame, int step) {
  const Index rows = frame.red.rows() / step, cols = frame.red.cols() / step;
  test::Image<std::uint16_t> red(rows, cols), green(rows, cols);
  const bool done = sample_frame(frame.red, frame.green, step, as_view(red), as_view(green));
  tell(name, done ? mean(red) + mean(green) : -1);
}

/// Methods with vector code of their own, other than depth and contact.
void tell_images(Results& tell) {
  const test::Pad pad;
  const auto free_mm = pad.pressed_depths(0), pressed_mm = pad.pressed_depths(3);
  const auto frame = pad.frame<std::uint8_t>(pressed_mm);
  tell_samples(tell, "samples of 2 x 2", frame, 2);
  tell_samples(tell, "samples of 3 x 3", frame, 3);
  tell_samples(tell, "samples of 4 x 4", frame, 4);
  auto estimate = pad.estimator<float>({.window_px = 1});
  test::Image<float> depth(pad.rows, pad.cols);
  test::Image<PixelStatus> status(pad.rows, pad.cols);
  tell("depth without smoothing",
       estimate(frame.red, frame.green, depth, status).ok() ? mean(depth) : -1);
  test::Image<float> from(pad.rows, pad.cols), to(pad.rows, pad.cols);
  for (std::size_t k = 0; k < from.cells.size(); ++k) {
    from.cells[k] = static_cast<float>(free_mm.cells[k]);
  }
  NeighbourLightCompensation<> compensate({.radius_px = 6}, static_cast<float>(pad.camera.pitch_mm),
                                          from);
  for (std::size_t k = 0; k < from.cells.size(); ++k) {
    from.cells[k] = static_cast<float>(pressed_mm.cells[k]);
  }
  (void)compensate(from, to);
  tell("without neighbour light", mean(to));
}

template <class Point>
std::vector<Point> dots_moved(double shift, double turn) {
  std::vector<Point> dots(81);
  for (std::size_t k = 0; k < dots.size(); ++k) {
    const double x = 1.5 * (static_cast<double>(k % 9) - 4),
                 y = 1.5 * (static_cast<double>(k / 9) - 4);
    const double share = 1 / (1 + 0.05 * (x * x + y * y));
    dots[k].x = static_cast<decltype(dots[k].x)>(x + share * (shift - turn * y));
    dots[k].y = static_cast<decltype(dots[k].x)>(y + share * (turn * x));
    if constexpr (requires { dots[k].z; }) {
      dots[k].z = 12 - 0.02 * (x * x + y * y);
    }
  }
  return dots;
}

void tell_dots(Results& tell) {
  using Point = Point3<double>;
  const auto view = [](std::vector<Point>& dots) {
    return StridedView<const Point>(dots.data(), 9, 9, 9);
  };
  auto free = dots_moved<Point>(0, 0);
  std::vector<std::uint8_t> touch(81, 0);
  for (std::size_t k = 0; k < 81; ++k) {
    touch[k] = std::hypot(free[k].x, free[k].y) < 4 ? 1 : 0;
  }
  const StridedView<const std::uint8_t> contact(touch.data(), 9, 9, 9);
  ObjectMotion<> motion(9, 9);
  ContactShift<> shift(view(free));
  TractionField field(view(free), TractionOptions<double>{.mu_t_n_per_mm = 0.5});
  StickRatio<> stick(9, 9, {.noise = 0.005});
  for (int frame = 0; frame < 8; ++frame) {
    auto now = dots_moved<Point>(0.1 * frame, 0.02 * frame);
    const auto moved = motion(view(now), contact);
    const auto shifted = shift(view(now), contact);
    const auto ratio = stick(view(now), contact);
    const auto load = field(view(now), contact, 0.01);
    if (frame == 7) {
      tell("motion ok", moved.ok() ? 1 : 0);
      tell("shift x mm", shifted.displacement.x);
      tell("shift rotation rad", shifted.rotation_rad);
      tell("stick ratio in space", is_finite(ratio.stick_ratio) ? ratio.stick_ratio : -1);
      tell("traction x N", load.force_n.x);
      tell("traction z N", load.force_n.z);
    }
  }
}

void tell_forces(Results& tell) {
  static const NormalForce<> force(ForceCurve<>{{0, 0.02, 0.0001}, 10, 400});
  tell("normal force N", force(123.4).force_n);
  static const Shear<> shear({100, {2, 0.65}, {30, 1.7}});
  const auto sheared = shear(80, {0.4, -0.3}, 0.1);
  tell("shear x N", sheared.tangential_force_n.x);
  tell("shear moment N mm", sheared.moment_n_mm);
  GripControl<> control({}, 3);
  GripResult<> held;
  for (int k = 0; k < 1000; ++k) {
    held = control(0.5 + 0.0005 * k, RatioUpdate::fresh, 0.01);
  }
  tell("grip N", held.force_n);
}

}  // namespace

int main() {
  Results results, others;
  const auto tell_all = [](Results& tell) {
    tell_depth_and_contact(tell);
    tell_images(tell);
    tell_dots(tell);
    tell_forces(tell);
  };
  std::thread thread([&] { tell_all(others); });
  tell_all(results);
  thread.join();
  std::fputs(results.lines().c_str(), stdout);
  return results.lines() == others.lines() ? 0 : 1;
}
