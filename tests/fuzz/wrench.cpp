// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Six-axis force from any marks and pressure, and the printed method from any shape, side dots and
// pressure: what is told is finite, what is not is NaN, and the printed method gives the same bits
// after any other frame.
#include "fingerpad/force/wrench.hpp"

#include <cstdint>
#include <numbers>
#include <vector>

#include "fingerpad/published/segment_equilibrium.hpp"
#include "fuzz/input.hpp"
#include "support/height_map.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;
using SideDots = Grid<Point3<double>>;

namespace {

constexpr double radius_mm = 18.735;

SideDots around(Input& in, Index count, double out_mm, double up_mm) {
  SideDots dots(1, count);
  for (Index k = 0; k < count; ++k) {
    const double at = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
    const double r = radius_mm - out_mm;
    dots.view()(0, k) = {r * std::cos(at), r * std::sin(at), up_mm};
  }
  for (Index k = in.whole(0, 8); k > 0 && count > 0; --k) {
    Point3<double>& dot = dots.view()(0, in.whole(0, count - 1));
    dot = {dot.x + in.number(-0.3, 0.3), dot.y + in.number(-0.3, 0.3), in.number(0, 2)};
  }
  return dots;
}

/// A dome with a level summit, and strange heights in it.
test::HeightMap<double> any_shape(Input& in) {
  test::HeightMap<double> map(radius_mm + 1, 1 + in.byte() / 85.0);
  const double top = in.number(2, 12), steep = in.number(0, 0.3), reach_mm = in.number(0, 10);
  const Index row = in.whole(0, map.side() - 1), col = in.whole(0, map.side() - 1);
  const double odd = in.number(-5, 15);
  const auto radius = [&](Index i, Index j) {
    return std::hypot(map.position_mm(j), map.position_mm(i));
  };
  map.fill(
      [&](Index i, Index j) {
        const double height = (std::max)(top - steep * (std::max)(radius(i, j) - 3, 0.0), 0.0);
        return i == row && j >= col && j < col + 4 ? odd : height;
      },
      [&](Index i, Index j, double) { return radius(i, j) < reach_mm ? 1.0 : 0.0; });
  return map;
}

template <class Result>
void require_sound(const Result& r) {
  require(r.ok() ? is_finite(r.force_n) && is_finite(r.moment_n_mm)
                 : is_finite(r.force_n) == is_finite(r.moment_n_mm),
          "a force is finite, or NaN");
}

void try_published(Input& in) {
  const Index count = in.whole(4, 40);
  published::SegmentEquilibriumOptions<double> options;
  options.delta_z_mm = in.number(0.1, 2);
  options.contours = in.whole(2, 8);
  options.step_mm = in.number(0.5, 1.5);
  options.inside_mm = in.number(0, 2);
  published::SegmentEquilibrium<> used(around(in, count, 0, 0).view(), options), fresh = used;
  for (int frame = 0; frame < 2; ++frame) {
    const auto map = any_shape(in);
    const SideDots dots = around(in, count, in.number(0.1, 0.5), in.number(0.5, 1.5));
    const double pressure_mpa = in.number(0, 0.05);
    const auto r = fuzz::frame([&] { return used(map, dots.view(), pressure_mpa); });
    auto other = fresh;
    const auto again = other(map, dots.view(), pressure_mpa);
    require(fuzz::same_bits(r.force_n, again.force_n) &&
                fuzz::same_bits(r.moment_n_mm, again.moment_n_mm),
            "the same frame gives the same bits, whatever came before");
    require_sound(r);
  }
}

void try_wrench(Input& in) {
  static const Camera<double> camera;
  static const Wrench<> start(camera, {});
  Wrench<> wrench = start;
  (void)wrench.begin(in.number(0.005, 0.03));
  std::vector<Mark> marks;
  for (Index k = in.whole(0, 60); k > 0; --k) {
    const Point2<double> px = {in.number(0, 640), in.number(0, 480)};
    if (auto mark = wrench.place_in_free_picture(px)) {
      mark->px = {px.x + in.number(-20, 20), px.y + in.number(-20, 20)};
      mark->sd_px = in.number(0, 0.5);
      marks.push_back(*mark);
    }
  }
  for (int frame = 0; frame < 2; ++frame) {
    require_sound(fuzz::frame([&] { return wrench(marks, in.number(0, 0.05)); }));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, [](Input& in) {
    return (in.byte() & 1) != 0 ? try_wrench(in) : try_published(in);
  });
}
