// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/dot_divergence.hpp"

#include <cmath>
#include <vector>

#include "fingerpad/calibrate/dot_divergence.hpp"
#include "support/catch.hpp"
#include "support/elastic_gel.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::BallOnGel;
using test::GelPad;
using test::Image;
using test::Random;
using test::uniform;
using Point = Point2<double>;
using Dots = Image<Point>;
using Mask = Image<std::uint8_t>;

namespace {

/// A gel with dots and a ball that presses it.
struct Gel {
  GelPad pad{.young_mpa = 0.2, .poisson = 0.4, .ball_mm = 10, .friction = 0.6};
  double pitch_mm = 2;
  double noise_mm = 0.005;
  Index across = 15;
  Point ball_mm = {0, 0};

  Dots free() const { return moved(BallOnGel<>(pad, ball_mm)); }
  Dots moved(const BallOnGel<>& contact) const {
    Dots dots(across, across);
    for (Index i = 0; i < across; ++i) {
      for (Index j = 0; j < across; ++j) {
        const double middle = static_cast<double>(across - 1) / 2;
        const Point at = {(static_cast<double>(j) - middle) * pitch_mm,
                          (static_cast<double>(i) - middle) * pitch_mm};
        const auto u = contact.displacement_mm(at);
        dots(i, j) = {at.x + u.x, at.y + u.y};
      }
    }
    return dots;
  }
  Mask touched(const BallOnGel<>& contact) const {
    const Dots home = free();
    Mask mask(across, across, 0);
    for (std::size_t k = 0; k < mask.cells.size(); ++k) {
      mask.cells[k] =
          contact.touches() && norm(home.cells[k] - contact.ball_mm()) < contact.radius_mm();
    }
    return mask;
  }
  BallOnGel<> pressed(double force_n) const {
    BallOnGel<> contact(pad, ball_mm);
    contact.drag(force_n, ball_mm);
    return contact;
  }
  double force_for(double radius_mm) const {
    const double modulus = pad.young_mpa / (1 - pad.poisson * pad.poisson);
    return radius_mm * radius_mm * radius_mm * 4 * modulus / (3 * pad.ball_mm);
  }
  /// |area| per N for the half-space.
  double area_per_n() const { return (1 - 2 * pad.poisson) * (1 + pad.poisson) / pad.young_mpa; }
  DotDivergence<> divergence() const {
    return DotDivergence<>(free(), {.noise_mm = noise_mm, .free_frames = 10000, .parts = false});
  }
  DivergenceResult<> seen(const BallOnGel<>& contact, Random* random = nullptr) const {
    const auto divergence = this->divergence();
    auto workspace = divergence.workspace();
    Dots dots = moved(contact);
    if (random != nullptr) {
      dots = noisy(dots, *random);
    }
    return divergence(dots, touched(contact), workspace);
  }
  Dots noisy(Dots dots, Random& random) const {
    for (Point& p : dots.cells) {
      p.x += noise_mm * random.normal();
      p.y += noise_mm * random.normal();
    }
    return dots;
  }
};

Gel any_gel() {
  Gel gel;
  gel.pad.young_mpa = test::log_uniform(0.05, 1);
  gel.pad.poisson = uniform(0.2, 0.45);
  gel.pad.ball_mm = uniform(8, 30);
  gel.pitch_mm = uniform(1, 2.5);
  gel.across = static_cast<Index>(30 / gel.pitch_mm);
  gel.ball_mm = {uniform(-2, 2), uniform(-2, 2)};
  return gel;
}

Dots rotated(Dots dots, double angle, const Point& shift) {
  for (Point& p : dots.cells) {
    p = {std::cos(angle) * p.x - std::sin(angle) * p.y + shift.x,
         std::sin(angle) * p.x + std::cos(angle) * p.y + shift.y};
  }
  return dots;
}

}  // namespace

TEST_CASE("dot divergence: the half-space's, whatever the pad, the pitch and the place",
          "[dot_divergence]") {
  rc::prop("area = (1 - 2 nu) F / (2 G)", [] {
    const Gel gel = any_gel();
    const double force = gel.force_for(uniform(2.5, 5));
    const auto seen = gel.seen(gel.pressed(force));
    RC_ASSERT(seen.ok());
    // error of a few per cent from the squares of displacements and the corners of the cells
    RC_ASSERT(std::abs(seen.area_mm2 / (gel.area_per_n() * force) - 1) < 0.06);
  });
}

TEST_CASE("dot divergence: it rises with the load", "[dot_divergence]") {
  rc::prop("for every gel", [] {
    const Gel gel = any_gel();
    double before = 0;
    for (const double radius : {2.0, 2.5, 3.0, 4.0, 5.0}) {
      const double area = gel.seen(gel.pressed(gel.force_for(radius))).area_mm2;
      RC_ASSERT(area > before);
      before = area;
    }
  });
}

TEST_CASE("dot divergence: shift and rotation of the pad leave it as it is", "[dot_divergence]") {
  rc::prop("for every gel, load and pull", [] {
    const Gel gel = any_gel();
    auto contact = gel.pressed(gel.force_for(uniform(2, 5)));
    contact.drag(gel.force_for(uniform(2, 5)), gel.ball_mm + Point{uniform(0, 0.3), 0});
    const auto divergence = gel.divergence();
    auto workspace = divergence.workspace();
    const Dots dots = gel.moved(contact);
    const Mask mask = gel.touched(contact);
    const auto there = divergence(dots, mask, workspace);
    const double angle = uniform(-0.03, 0.03);
    const Point shift = {uniform(-0.3, 0.3), uniform(-0.3, 0.3)};
    const auto moved = divergence(rotated(dots, angle, shift), mask, workspace);
    RC_ASSERT(moved.filled == 0);
    RC_ASSERT(std::abs(moved.area_mm2 - there.area_mm2) < 1e-10);
    const auto still = divergence(rotated(gel.free(), angle, shift), mask, workspace);
    RC_ASSERT(std::abs(still.area_mm2) < 1e-10);
  });
}

TEST_CASE("dot divergence: the variance is that of noise, of shear and of lost dots",
          "[dot_divergence]") {
  for (const double pull : {0.0, 0.8}) {
    for (const int lost : {0, 2}) {
      double within = 0, frames = 0;
      Random random(5);
      for (int k = 0; k < 400; ++k) {
        Gel gel;
        gel.noise_mm = 0.02;
        gel.ball_mm = {2 * random.uniform(), 2 * random.uniform()};
        const double force = gel.force_for(3 + 2 * random.uniform());
        auto contact = gel.pressed(force);
        const double exact = gel.seen(contact).area_mm2;
        const double angle = 6.28 * random.uniform();
        contact.drag(force, gel.ball_mm + pull * contact.max_pull_mm() *
                                              Point{std::cos(angle), std::sin(angle)});
        const DotDivergence<> divergence(gel.noisy(gel.free(), random),
                                         {.noise_mm = gel.noise_mm, .parts = false});
        auto workspace = divergence.workspace();
        Dots dots = gel.noisy(gel.moved(contact), random);
        for (int n = 0; n < lost; ++n) {
          const double row = 5 + 5 * random.uniform(), col = 5 + 5 * random.uniform();
          dots(static_cast<Index>(row), static_cast<Index>(col)).x += 5;
        }
        const auto seen = divergence(dots, gel.touched(contact), workspace);
        REQUIRE(seen.ok());
        within += std::abs(seen.area_mm2 - exact) < 1.96 * std::sqrt(seen.variance_mm4) ? 1 : 0;
        frames += 1;
      }
      CAPTURE(pull, lost);
      INFO(within / frames);
      CHECK(within / frames > 0.93);
      CHECK(within / frames < (pull > 0 ? 1.01 : 0.97));
    }
  }
}

TEST_CASE("dot divergence: a force by a gauge's calibration, with its variance",
          "[dot_divergence]") {
  double within = 0, frames = 0, worst = 0;
  Random random(9);
  for (const double young_mpa : {0.1, 0.4}) {
    for (const double pitch_mm : {1.2, 2.0, 2.4}) {
      Gel gel;
      gel.pad.young_mpa = young_mpa;
      gel.pitch_mm = pitch_mm;
      gel.across = static_cast<Index>(30 / pitch_mm);
      gel.noise_mm = 0.015;
      const auto frame = [&] {
        gel.ball_mm = {2 * random.uniform(), 2 * random.uniform()};
        return gel.force_for(2 + 3 * random.uniform());
      };
      std::vector<DivergenceResult<>> seen;
      std::vector<double> forces;
      for (int k = 0; k < 40; ++k) {
        forces.push_back(frame());
        seen.push_back(gel.seen(gel.pressed(forces.back()), &random));
      }
      const auto fit = fit_divergence<1>(seen, forces);
      REQUIRE(fit.ok());
      CHECK(fit.curve.coefficients[1] == Approx(1 / gel.area_per_n()).epsilon(0.05));
      const NormalForce force(fit.curve, NoCompensation(), fit.errors);
      for (int k = 0; k < 200; ++k) {
        const double truth = frame();
        const auto told = normal_force(force, gel.seen(gel.pressed(truth), &random));
        const double error = std::abs(told.force_n - truth);
        within += error < 1.96 * std::sqrt(told.variance_n2) ? 1 : 0;
        worst = std::max(worst, error / gel.force_for(5));
        frames += 1;
      }
    }
  }
  INFO(within / frames << ", worst of the full scale " << worst);
  CHECK(within / frames > 0.93);
  CHECK(within / frames < 0.97);
  CHECK(worst < 0.1);
}

TEST_CASE("dot divergence: a free dot that was not found lies between its neighbours",
          "[dot_divergence]") {
  // pitch 2 mm by 3 mm, stretched by 2 % and 5 %, the dots around (3, 4) count
  Dots home(6, 8), stretched(6, 8);
  for (Index i = 0; i < 6; ++i) {
    for (Index j = 0; j < 8; ++j) {
      const Point at = {2 * static_cast<double>(j) - 5, 3 * static_cast<double>(i) + 1};
      home(i, j) = at;
      stretched(i, j) = {1.02 * at.x, 1.05 * at.y};
    }
  }
  Mask mask(6, 8, 0);
  mask(3, 4) = 1;
  const double growth = (1.02 * 1.05 - 1) * 4 * 6;
  // between those in the row; without these, between those in the column
  for (const Index row : {2, 3, 4}) {
    for (const int lost : {0, 1, 2}) {
      for (const Index col : {3, 4, 5}) {
        Dots some = home;
        for (Index k = 0; k < lost; ++k) {
          some(row, col + k) = {test::nan, test::nan};
        }
        const DotDivergence<> divergence(some, {.max_filled = 0.5});
        auto workspace = divergence.workspace();
        CAPTURE(row, col, lost);
        CHECK(divergence(stretched, mask, workspace).area_mm2 == Approx(growth).epsilon(1e-12));
      }
    }
  }
  // of two below one another, each lies between its neighbours in the row
  for (const Index row : {2, 3}) {
    Dots some = home;
    some(row, 4) = some(row + 1, 4) = {test::nan, test::nan};
    const DotDivergence<> divergence(some, {.max_filled = 0.5});
    auto workspace = divergence.workspace();
    CAPTURE(row);
    CHECK(divergence(stretched, mask, workspace).area_mm2 == Approx(growth).epsilon(1e-12));
  }
}

TEST_CASE("dot divergence: a fit leaves the noise of its dots to the frames", "[dot_divergence]") {
  // a line with slope 3, scatter +-0.2 that a line does not explain, and noise unlike between dots
  std::vector<DivergenceResult<>> seen;
  std::vector<double> forces;
  double noise_mm4 = 0;
  for (int k = 0; k < 8; ++k) {
    DivergenceResult<> d;
    d.status = FrameStatus::ok;
    d.area_mm2 = 1 + (k / 2) % 2;
    d.variance_mm4 = 1e-4 * (1 + k);
    noise_mm4 += d.variance_mm4;
    seen.push_back(d);
    forces.push_back(3 * d.area_mm2 + (k % 2 == 0 ? 0.2 : -0.2));
  }
  const auto fit = fit_divergence<1>(seen, forces);
  CHECK(fit.curve.coefficients[1] == Approx(3));
  // 8 samples less the slope; a line through 0
  CHECK(square(fit.errors.residual_sd_n) == Approx(8 * 0.04 / 7 - 9 * noise_mm4 / 8));
}

TEST_CASE("dot divergence: missing, wild and mistaken input", "[dot_divergence]") {
  const Gel gel;
  const auto contact = gel.pressed(gel.force_for(4));
  const auto divergence = gel.divergence();
  auto workspace = divergence.workspace();
  const Mask mask = gel.touched(contact);
  const Dots dots = gel.moved(contact);
  const double area = divergence(dots, mask, workspace).area_mm2;

  // the position of a dot inside does not matter; a dot at the border is replaced by its neighbours
  for (const Index row : {7, 5, 4}) {
    for (const double bad : {test::nan, 0.0, 1e9}) {
      Dots some = dots;
      some(row, 7) = {bad, bad};
      const auto seen = divergence(some, mask, workspace);
      CAPTURE(row, bad);
      CHECK(seen.area_mm2 == Approx(area).epsilon(0.1));
    }
  }
  Dots few = dots;
  for (Index j = 0; j < 15; ++j) {
    few(6, j) = few(8, j) = {test::nan, 1};
  }
  const auto unknown = divergence(few, mask, workspace);
  CHECK(!unknown.ok());
  CHECK(std::isnan(unknown.area_mm2));
  CHECK(unknown.filled > 4);
  const NormalForce force(PolynomialForce<1>{.coefficients = {0, 2}, .from = 0, .to = 9});
  CHECK(normal_force(force, unknown).status == ForceStatus::not_finite);

  // y points up
  const auto mirrored = [](Dots some) {
    for (Point& p : some.cells) {
      p.y = -p.y;
    }
    return some;
  };
  const DotDivergence<> upward(mirrored(gel.free()), {.parts = false});
  CHECK(upward(mirrored(dots), mask, workspace).area_mm2 == Approx(area).epsilon(1e-9));

  const auto none = divergence(dots, Mask(15, 15, 0), workspace);
  CHECK(none.ok());
  CHECK(none.area_mm2 == 0);
  CHECK(normal_force(force, none).status == ForceStatus::no_contact);

  // a free dot that was not found
  Dots home = gel.free();
  home(6, 7) = {test::nan, test::nan};
  const DotDivergence<> without(home, {.parts = false});
  CHECK(without(dots, mask, workspace).area_mm2 == Approx(area).epsilon(1e-9));

  CHECK(divergence(Dots(15, 14), mask, workspace).status == FrameStatus::refused);
  CHECK(divergence(dots, Mask(14, 15), workspace).status == FrameStatus::refused);
  auto other = DotDivergence<>(Dots(3, 3)).workspace();
  CHECK(divergence(dots, mask, other).status == FrameStatus::refused);

  const auto refused = [&](const DivergenceOptions& options) {
    return test::refusal([&] { DotDivergence<>(home, options); });
  };
  CHECK(refused({.noise_mm = 0}) == "DivergenceOptions: noise_mm = 0, must be finite and > 0");
  CHECK(refused({.free_frames = 0}) == "DivergenceOptions: free_frames = 0, must be >= 1");
  CHECK(refused({.max_filled = 1}) == "DivergenceOptions: max_filled = 1, must be in [0, 1)");
  CHECK(test::refusal([] { DotDivergence<>(Dots(1, 9)); }) ==
        "DotDivergence: rows = 1, must be in [2, 1000000]");
  CHECK(test::begins_with(test::refusal([] {
                            (void)fit_divergence<1>(std::vector<DivergenceResult<>>(3),
                                                    std::vector<double>(2));
                          }),
                          "fit_divergence: forces_n.size() = 2"));
}
