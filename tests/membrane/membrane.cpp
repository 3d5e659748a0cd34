// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The law of the rubber, the free pad and the march inward from the rim.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "fingerpad/membrane/annulus.hpp"
#include "fingerpad/membrane/free_pad.hpp"
#include "fingerpad/membrane/rubber.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::Digits50;
using Point = Point3<double>;

namespace {

/// Two directions of a sheet that is under tension across the second.
std::array<Point, 2> any_stretch() {
  const auto any = [](double from, double to) { return test::uniform(from, to); };
  return {Point{any(1.1, 1.6), any(-0.2, 0.2), any(-0.3, 0.3)},
          Point{any(-0.2, 0.2), any(1.05, 1.5), any(-0.3, 0.3)}};
}

double energy(const Point& a, const Point& b, double m) {
  const double sum = squared_norm(a) + squared_norm(b), j_sq = squared_norm(cross(a, b));
  return (1 - m) / 2 * (sum + 1 / j_sq - 3) + m / 2 * (sum / j_sq + j_sq - 3);
}

Point moved(Point p, std::size_t axis, double by) {
  (axis == 0 ? p.x : axis == 1 ? p.y : p.z) += by;
  return p;
}
std::array<double, 3> parts(const Point& p) {
  return {p.x, p.y, p.z};
}

/// Parameters at the rim of a free pad.
template <class S>
std::vector<S> free_parameters(const Annulus<S>& annulus, const S& load_per_mm) {
  using std::cos;
  using std::sin;
  const auto rim = FreePad<S>(annulus.cap()).rim(load_per_mm);
  REQUIRE(rim.has_value());
  std::vector<S> all(annulus.parameters(), S(0));
  all[0] = rim->stretch * cos(rim->slope_rad);
  all[2 * annulus.terms()] = rim->stretch * sin(rim->slope_rad);
  all.back() = load_per_mm;
  return all;
}

/// The same, dragged, turned and pressed on one side.
template <class S>
std::vector<S> loaded_parameters(const Annulus<S>& annulus, const S& load_per_mm) {
  auto all = free_parameters(annulus, load_per_mm);
  all[1] += S(0.06);
  all[annulus.terms()] += S(0.02);
  all[annulus.terms() + 2] += S(0.06);
  all[2 * annulus.terms() + 3] += S(0.02);
  return all;
}

}  // namespace

TEST_CASE("rubber: the pull is the slope of the energy", "[membrane]") {
  rc::prop("for any stretch", [] {
    const auto [a, b] = any_stretch();
    const double m = test::uniform(0, 0.6), h = 1e-5;
    const auto pull = parts(rubber_pull(a, b, m));
    for (std::size_t k = 0; k < 3; ++k) {
      const double slope = (energy(moved(a, k, h), b, m) - energy(moved(a, k, -h), b, m)) / (2 * h);
      RC_ASSERT(std::fabs(slope - pull[k]) < 1e-8);
    }
  });
}

TEST_CASE("rubber: the pull of two principal stretches", "[membrane]") {
  rc::prop("for any stretch", [] {
    const double a = test::uniform(0.5, 2), b = test::uniform(0.5, 2), m = test::uniform(0, 0.6);
    const auto pull = parts(rubber_pull(Point{0, a, 0}, Point{0, 0, b}, m));
    RC_ASSERT(std::fabs(rubber_pull(a, b, m) - pull[1]) < 1e-12);
    RC_ASSERT((pull[0] == 0 && pull[2] == 0));
  });
}

TEST_CASE("rubber: slopes of the pull", "[membrane]") {
  rc::prop("for any stretch", [] {
    const auto [a, b] = any_stretch();
    const double m = test::uniform(0, 0.6), h = 1e-5;
    const auto slopes = detail::membrane::pull_slopes(a, b, m);
    for (std::size_t j = 0; j < 3; ++j) {
      const auto by_a =
          parts((rubber_pull(moved(a, j, h), b, m) - rubber_pull(moved(a, j, -h), b, m)) / (2 * h));
      const auto by_b =
          parts((rubber_pull(a, moved(b, j, h), m) - rubber_pull(a, moved(b, j, -h), m)) / (2 * h));
      for (std::size_t i = 0; i < 3; ++i) {
        RC_ASSERT(std::fabs(by_a[i] - slopes.by_along[i][j]) < 1e-7);
        RC_ASSERT(std::fabs(by_b[i] - slopes.by_other[i][j]) < 1e-7);
      }
    }
  });
}

TEST_CASE("rubber: the stretch of a pull is its inverse", "[membrane]") {
  rc::prop("for any stretch", [] {
    const auto [a, b] = any_stretch();
    const double m = test::uniform(0, 0.6);
    double across = 1.1;
    const Point again = detail::membrane::stretch_of_pull(rubber_pull(a, b, m), b, m, across);
    RC_ASSERT(norm(again - a) < 1e-12);
  });
}

TEST_CASE("free pad: the apex of finite elements", "[membrane]") {
  struct Pad {
    StressFreeCap<double> cap;
    double load_per_mm, apex_mm;
  };
  const Pad pads[] = {{{18.734994, 10.2122}, 0.012 / 0.3, 13.0012},
                      {{18.734994, 11.0}, 0.016 / 0.5, 13.0263}};
  for (const Pad& p : pads) {
    const auto rim = FreePad<double>(p.cap).rim(p.load_per_mm);
    REQUIRE(rim.has_value());
    CHECK(std::fabs(rim->apex_mm - p.apex_mm) < 0.005);
    const auto meridian = FreePad<double>(p.cap).meridian(p.load_per_mm);
    REQUIRE(meridian.size() > 100);
    CHECK(std::fabs(meridian.front().y - rim->apex_mm) < 5e-4);  // 600 steps against 60
    CHECK(meridian.front().x == 0);
    CHECK(std::fabs(meridian.back().x - p.cap.base_radius_mm) < 5e-4);
    CHECK(meridian.back().y == 0);
    const auto along = meridian.back() - meridian[meridian.size() - 2];
    CHECK(std::fabs(std::atan2(-along.y, along.x) - rim->slope_rad) < 0.01);
  }
  CHECK(FreePad<double>({18.7, 11}).meridian(10.0).empty());
  CHECK_FALSE(FreePad<double>({18.7, 11}).rim(10.0).has_value());
}

TEST_CASE("annulus: nothing pulls at a free pad, whatever its pressure", "[membrane]") {
  for (const double height_mm : {6.0, 11.0, 18.0}) {
    for (const double load : {0.01, 0.03, 0.05}) {
      Annulus<double> annulus({18.7, height_mm, 0.2}, {});
      annulus.march(free_parameters(annulus, load));
      const auto rest = annulus.load_at_rim();
      CAPTURE(height_mm, load);
      CHECK(norm(rest.force) < 1e-5);  // of a pressure on the base of 10 to 50
      CHECK(norm(rest.moment) < 1e-6);
    }
  }
}

TEST_CASE("annulus: the load is the same through every circle", "[membrane]") {
  // Of the part further inward; what lies between carries pressure alone.
  const AnnulusOptions options = {.reach_mm = 9, .azimuths = 48, .steps = 24};
  const Point2<double> uneven = GENERATE(Point2<double>{0, 0}, Point2<double>{0.2, -0.1});
  Annulus<double> annulus({18.7, 11, 0, uneven.x, uneven.y}, options);
  const auto q = loaded_parameters(annulus, 0.032);
  annulus.march(q);
  const auto at_rim = annulus.load_at_rim();
  CHECK(norm(at_rim.force) > 1);
  constexpr int n = 360;
  std::vector<Point> circle;
  const double arc = 5, h = 1e-3;
  const double rho = annulus.cap().rho_mm(arc);
  const auto at = [&](double a, int k) {
    return annulus.at(annulus.place(a, k * 2 * 3.14159265358979 / n));
  };
  Point force = {0, 0, 0};
  for (int k = 0; k < n; ++k) {
    const double turn = 2 * 3.14159265358979 / n;
    const Point along = (at(arc + h, k) - at(arc - h, k)) / (2 * h);
    const Point around = (at(arc, k + 1) - at(arc, k - 1)) / (2 * turn);
    const double thick =
        1 + rho / 18.7 * (uneven.x * std::cos(k * turn) + uneven.y * std::sin(k * turn));
    force += turn * (rho * thick * rubber_pull(along, around / rho, 0.0) -
                     0.016 * cross(at(arc, k), around));
  }
  CHECK(norm(force - at_rim.force) < 2e-3 * norm(at_rim.force));
}

TEST_CASE("annulus: slopes by every parameter", "[membrane]") {
  Annulus<double> annulus({18.7, 11, 0.2, 0.1, -0.05}, {});
  auto q = loaded_parameters(annulus, 0.032);
  q[3 * annulus.terms()] = 0.1;
  q[3 * annulus.terms() + 1] = 0.05;
  annulus.march(q);
  const auto place = annulus.place(9.1, 1.234);
  std::vector<double> slopes(3 * annulus.width()), of_load(6 * annulus.width());
  annulus.slopes_at(place, slopes);
  annulus.slopes_of_load(of_load);
  for (std::size_t c = 0; c < annulus.parameters(); ++c) {
    const double h = c + 1 == annulus.parameters() ? 1e-8 : 1e-6;
    std::array<std::array<double, 9>, 2> ends;
    for (std::size_t side = 0; side < 2; ++side) {
      auto near = q;
      near[c] += side == 0 ? -h : h;
      annulus.march(near);
      const auto x = annulus.at(place);
      const auto l = annulus.load_at_rim();
      ends[side] = {x.x,       x.y,        x.z,        l.force.x, l.force.y,
                    l.force.z, l.moment.x, l.moment.y, l.moment.z};
    }
    for (std::size_t r = 0; r < 9; ++r) {
      const double slope = (ends[1][r] - ends[0][r]) / (2 * h);
      const double found =
          r < 3 ? slopes[r * annulus.width() + c] : of_load[(r - 3) * annulus.width() + c];
      CAPTURE(c, r, slope, found);
      CHECK(std::fabs(slope - found) < 1e-6 * (1 + std::fabs(slope)) + (h < 1e-7 ? 1e-4 : 0.0));
    }
  }
}

TEST_CASE("annulus: a scene that is turned about the axis", "[membrane]") {
  Annulus<double> annulus({18.7, 11, 0}, {});
  const double turn = 2 * 3.14159265358979 / 24 * 5;  // meridians lie on meridians
  auto q = loaded_parameters(annulus, 0.032);
  annulus.march(q);
  const Point before = annulus.at(annulus.place(7.3, 0.4));
  for (std::size_t part = 0; part < 4; ++part) {  // harmonics of the three parts and of the offset
    const std::size_t from = part * annulus.terms();
    for (std::size_t m = 1; m <= 5; ++m) {
      const double c = q[from + 2 * m - 1], s = q[from + 2 * m], a = static_cast<double>(m) * turn;
      q[from + 2 * m - 1] = c * std::cos(a) - s * std::sin(a);
      q[from + 2 * m] = s * std::cos(a) + c * std::sin(a);
    }
  }
  annulus.march(q);
  const Point after = annulus.at(annulus.place(7.3, 0.4 + turn));
  const Point expected = {before.x * std::cos(turn) - before.y * std::sin(turn),
                          before.x * std::sin(turn) + before.y * std::cos(turn), before.z};
  CHECK(norm(after - expected) < 1e-9);
}

TEST_CASE("annulus: half the base radius is marched without loss of digits", "[membrane]") {
  // The march is ill-posed: harmonic m of an error of rounding grows like exp(m a / R).
  for (const double radius_mm : {8.0, 11.0, 19.0}) {
    const double scale = radius_mm / 18.7;
    const AnnulusOptions options = {.reach_mm = 0.53 * radius_mm};
    Annulus<double> annulus({radius_mm, 11 * scale, 0}, options);
    Annulus<Digits50> exact({Digits50(radius_mm), Digits50(11 * scale), Digits50(0)}, options);
    const auto q = loaded_parameters(annulus, 0.032 / scale);
    annulus.march(q);
    exact.march(std::vector<Digits50>(q.begin(), q.end()));
    double worst = 0;
    for (double share = 0.1; share < 1; share += 0.2) {
      for (double azimuth = 0; azimuth < 6; azimuth += 0.7) {
        const double arc = share * options.reach_mm;
        const Point found = annulus.at(annulus.place(arc, azimuth));
        const auto truth = exact.at(exact.place(Digits50(arc), Digits50(azimuth)));
        worst = (std::max)(worst, std::fabs(found.x - static_cast<double>(truth.x)));
        worst = (std::max)(worst, std::fabs(found.z - static_cast<double>(truth.z)));
      }
    }
    CAPTURE(radius_mm, worst);
    CHECK(worst < 1e-11 * radius_mm);
  }
}

TEST_CASE("annulus: bad parameters are refused by name", "[membrane]") {
  const auto said = [](const AnnulusOptions& options, const StressFreeCap<double>& cap = {}) {
    return test::refusal([&] { return Annulus<double>(cap, options); });
  };
  CHECK(said({}) == "accepted");
  CHECK(said({.reach_mm = 0}) == "AnnulusOptions: reach_mm = 0, must be finite and > 0");
  CHECK(said({.azimuths = 8}) == "AnnulusOptions: azimuths = 8, must be in [12, 360]");
  CHECK(said({.steps = 0}) == "AnnulusOptions: steps = 0, must be in [1, 100]");
  CHECK(said({}, {20, -1}) == "StressFreeCap: height_mm = -1, must be finite and > 0");
  CHECK(said({}, {20, 11, 2}) == "StressFreeCap: mooney_share = 2, must be in [0, 1]");
}
