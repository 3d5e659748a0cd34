// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Six-axis force by every solver. "ns/pixel" is per frame: mesh, side dots, forces; the shape is
// given. Truth: a film pressed flat, dragged and turned, whose force, moment and side dots are
// known in closed form (tests/support/pressed_pad.hpp). Errors: of F_x and F_y together, F_z, M_x
// and M_y together and M_z, in shares of the truth; "residual": of eqs. 6 and 7, rms, as a share of
// the pressure's. "height map": heights at nodes of 0.5 mm as a frame has them, with the blur of
// one.
#include "fingerpad/wrench.hpp"

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include "../tests/support/pressed_pad.hpp"
#include "fingerpad/detail/membrane/pad_heights.hpp"
#include "support/run.hpp"

using namespace fingerpad;
using test::Image;
using test::RimLoad;

namespace {

/// A lateral force at the height of the object, a torque, and a press.
struct Load {
  double normal, lean, shear, turning;

  template <class Pad>
  explicit Load(const Pad& pad) {
    const double sine = pad.sine(pad.radius_mm), cosine = std::sqrt(1 - sine * sine);
    const double high = pad.height(0);
    normal = pad.tension(pad.radius_mm, test::pressed_mpa);
    shear = 0.1 * normal;
    turning = 0.1 * normal;
    lean = -high * shear / (pad.radius_mm * sine - high * cosine);
  }
  RimLoad operator()(double at) const {
    return {normal + lean * std::cos(at), turning - shear * std::sin(at)};
  }
};

template <class S>
Image<Point3<S>> as(const Image<Point3<double>>& from) {
  Image<Point3<S>> to(from.rows(), from.cols(), {S(0), S(0), S(0)});
  for (std::size_t k = 0; k < from.cells.size(); ++k) {
    to.cells[k] = {S(from.cells[k].x), S(from.cells[k].y), S(from.cells[k].z)};
  }
  return to;
}

template <class S>
HeightMap<S> heights_of(const test::RoundPad<test::FilmSide>& pad) {
  HeightMap<S> map(S(19.5), S(0.5));
  map.fill([&](Index i, Index j) { return pad(map.position_mm(j), map.position_mm(i)).height_mm; },
           [&](Index i, Index j, const auto&...) {
             return S(pad.in_contact(map.position_mm(j), map.position_mm(i)) ? 1 : 0);
           });
  return map;
}

template <class W, class S>
struct Frame {
  test::RoundPad<test::FilmSide> pad;
  test::RimOfDots rim = rim_of(pad);
  Load load{pad};
  W wrench;
  typename W::Workspace work;
  HeightMap<S> map = heights_of<S>(pad);
  Image<Point3<S>> dots;
  WrenchResult<S> result;

  template <class Solver, class Row, class Law>
  Frame(const WrenchOptions<S>& options, const Solver& solver, const Row& row, const Law& law)
      : wrench(as<S>(rim.borders()), options, solver, row, law),
        work(wrench.workspace()),
        dots(as<S>(rim.dots(load, Row::rows))) {}
};

template <class Solver,
          class Row = OneRow,
          class Law = ClampedRim,
          class Lines = StraightLines,
          class S = double>
void add_frame(const std::string& group,
               const std::string& name,
               Index columns,
               Index rows,
               const Row& row = {}) {
  using W = Wrench<Solver, Row, Law, Lines, S>;
  WrenchOptions<S> options;
  options.columns = columns;
  options.rows = rows;
  options.blur_mm = S(0.6);
  const auto d = std::make_shared<Frame<W, S>>(options, Solver{}, row, Law{});
  bench::add(
      group + "/" + name, 1,
      [d] {
        d->result = d->wrench(d->map, d->dots, S(test::pressed_mpa), d->work);
        benchmark::DoNotOptimize(d->result);
      },
      [d](auto& counters) {
        const auto truth = wrench_of(d->rim, d->load, test::pressed_mpa);
        const auto share = [](double x, double y, double of) { return std::hypot(x, y) / of; };
        const auto& r = d->result;
        const double fx = double(r.force_n.x) - truth.force_n.x;
        const double fy = double(r.force_n.y) - truth.force_n.y;
        const double mx = double(r.moment_n_mm.x) - truth.moment_n_mm.x;
        const double my = double(r.moment_n_mm.y) - truth.moment_n_mm.y;
        counters["F_xy_error"] = share(fx, fy, std::hypot(truth.force_n.x, truth.force_n.y));
        counters["F_z_error"] = std::abs(double(r.force_n.z) / truth.force_n.z - 1);
        counters["M_xy_error"] =
            share(mx, my, std::hypot(truth.moment_n_mm.x, truth.moment_n_mm.y));
        counters["M_z_error"] = std::abs(double(r.moment_n_mm.z) / truth.moment_n_mm.z - 1);
        if (Solver::finds_tensions) {
          counters["residual"] = double(r.residual);
        }
      });
}

/// Lines and segments alone.
template <class Lines, class S>
void add_mesh(const std::string& group, const std::string& name, Index columns, Index rows) {
  struct Mesh {
    test::RoundPad<test::FilmSide> pad;
    HeightMap<S> map = heights_of<S>(pad);
    detail::membrane::Compartments<S> nodes;
    detail::membrane::Segments<S> segments;
    Mesh(Index c, Index r) : nodes(c, r, S(18.735), {S(0.4), S(0.6), S(4)}), segments(c, r) {}
  };
  const auto d = std::make_shared<Mesh>(columns, rows);
  bench::add(
      group + "/" + name, 1,
      [d] {
        d->nodes.template lay<Lines>(d->map, {S(0), S(0), S(0)});
        d->segments.measure(d->nodes);
        benchmark::DoNotOptimize(d->segments);
      },
      [](auto&) {});
}

void add_all(Index columns, Index rows) {
  const std::string group = std::to_string(columns) + "x" + std::to_string(rows) + " segments";
  using std::string;
  add_frame<PublishedIteration, OneRow, PublishedDirection, SteepestLines>(
      group, "published iteration and rim", columns, rows);
  add_mesh<StraightLines, double>(group, "mesh alone", columns, rows);
  add_mesh<SteepestLines, double>(group, "mesh alone, SteepestLines", columns, rows);
  add_frame<PublishedIteration>(group, "PublishedIteration", columns, rows);
  add_frame<ClosedForm>(group, "ClosedForm", columns, rows);
  add_frame<BalancedRim>(group, "BalancedRim", columns, rows);
  add_frame<BalancedRim, ExtrapolatedRow>(group, "BalancedRim, ExtrapolatedRow", columns, rows,
                                          {1.06});
  add_frame<BalancedRim, TwoRows>(group, "BalancedRim, TwoRows", columns, rows);
  add_frame<KnownModulus>(group, "KnownModulus", columns, rows);
  add_frame<LeastSquares>(group, "LeastSquares, the default", columns, rows);
  add_frame<BalancedRim, OneRow, ClampedRim, StraightLines, float>(group, "BalancedRim, float",
                                                                   columns, rows);
  add_frame<PublishedIteration, OneRow, ClampedRim, StraightLines, float>(
      group, "PublishedIteration, float", columns, rows);
  add_frame<LeastSquares, OneRow, ClampedRim, StraightLines, float>(group, "LeastSquares, float",
                                                                    columns, rows);
}

/// Heights in plan from a depth map of 640 x 480.
template <class S>
void add_heights(const std::string& name) {
  struct Picture {
    test::RoundPad<test::FilmSide> pad;
    Camera<S> camera;
    PadHeights<Camera<S>> heights{480, 640, camera};
    HeightMap<S> map = heights.map();
    Image<float> depth{480, 640, 0.0F};
    Image<std::uint8_t> mask{480, 640};
  };
  const auto d = std::make_shared<Picture>();
  for (Index i = 0; i < 480; ++i) {
    for (Index j = 0; j < 640; ++j) {
      // the ray is below the membrane, then above
      double z = 0, high = 20;
      Point3<double> p{0, 0, 0};
      for (int step = 0; step < 40; ++step) {
        const double middle = (z + high) / 2;
        p = point_at(Camera<double>(), static_cast<double>(i), static_cast<double>(j), middle);
        const double r = std::hypot(p.x, p.y);
        (r < d->pad.radius_mm && d->pad.height(r) > middle ? z : high) = middle;
      }
      d->depth(i, j) = static_cast<float>(z);
      d->mask(i, j) = d->pad.touches(std::hypot(p.x, p.y)) ? 1 : 0;
    }
  }
  bench::add(
      "heights in plan from 640x480/" + name, 1,
      [d] {
        d->heights(d->depth, d->mask, d->map);
        benchmark::DoNotOptimize(d->map);
      },
      [d](auto& counters) {
        double sum = 0, count = 0, known = 0;
        for (Index i = 0; i < d->map.side(); ++i) {
          for (Index j = 0; j < d->map.side(); ++j) {
            const double x = double(d->map.position_mm(j)), y = double(d->map.position_mm(i));
            const double off =
                double(d->map(S(x), S(y)).height_mm) - d->pad.height(std::hypot(x, y));
            if (std::hypot(x, y) < 18) {
              known += 1;
              sum += off == off ? std::abs(off) : 0;
              count += off == off ? 1 : 0;
            }
          }
        }
        counters["mean_error_mm"] = sum / count;
        counters["share_found"] = count / known;
      });
}

}  // namespace

int main(int argc, char** argv) {
  add_all(36, 30);
  add_all(72, 65);
  add_heights<double>("double");
  add_heights<float>("float");
  return bench::run(argc, argv);
}
