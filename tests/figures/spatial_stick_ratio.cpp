// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Stick ratio in space, without and with the friction limit, on finite-element membranes.
// test_figures "[spatial_stick]" -s prints all figures, "[spatial_noise]" those of the page.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/slipping_patch.hpp"
#include "support/spatial_scene.hpp"

using namespace fingerpad;
using test::SpatialScene;
using test::SpatialStep;

namespace {

constexpr double lateral_mm = 0.005, depth_mm = 0.025;  // 0.06 px, and depth from rendered frames

struct SceneErrors {
  double dots = 0;     ///< mean absolute error over all frames in contact, kept answers included
  double told = 0;     ///< the same over the frames with an answer from the dots
  double fused = 0;    ///< over all frames, with the friction limit
  double on_ball = 0;  ///< as `told`; the truth is the slip along a ball about the object's origin
  double lifted = 0;   ///< difference of these two truths
};

/// As truth_between, for the slip along the ball: the normal motion of a dot that meets or leaves
/// the ball at the edge is not slip.
double truth_on_ball(const SpatialStep& then, const SpatialStep& now) {
  const Pose<double> motion = now.object * inverse(then.object);
  const double limit = test::slip_share * test::longest_move(then, now);
  double stick = 0, all = 0;
  for (std::size_t k = 0; k < now.dots.cells.size(); ++k) {
    if (then.contact.cells[k] != 0 && now.contact.cells[k] != 0) {
      const auto slip = now.dots.cells[k] - motion(then.dots.cells[k]);
      const auto normal = normalized(now.dots.cells[k] - now.object.translation_mm);
      all += 1;
      stick += norm(slip - dot(slip, normal) * normal) < limit ? 1 : 0;
    }
  }
  return stick / all;
}

/// `noise` is a factor of the usual noise of dots, depth and forces. Each `every`-th row and column
/// of dots is kept.
SceneErrors errors_of(const std::string& name,
                      int recordings = 6,
                      double noise = 1,
                      Index every = 1) {
  const SpatialScene scene(name, every);
  const double along = noise * lateral_mm, deep = noise * depth_mm;
  const StickRatio<> fresh(scene.dots_across(), scene.dots_across(), {.noise = along});
  SceneErrors e;
  double frames = 0, answered = 0;
  for (int seed = 1; seed <= recordings; ++seed) {
    test::Random random(static_cast<std::uint64_t>(seed));
    StickRatio<> stick = fresh;
    FrictionLimit<double> limit;
    for (Index k = 0; k < scene.size(); ++k) {
      auto dots = scene[k].dots;
      for (auto& p : dots.cells) {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        p = {p.x + along * x, p.y + along * y, p.z + deep * z};
      }
      const auto r = stick(dots, scene[k].contact);
      const auto load = contact_load(test::noisy(scene[k].force_n, noise * 0.015, random),
                                     test::noisy(scene[k].moment_n_mm, noise * 0.02, random), dots,
                                     scene[k].contact);
      const auto fused = limit(load, r);
      if (k < 2 || test::dots_of_both(scene[k], scene[k]) < 6) {
        continue;
      }
      const double truth = test::spatial_truth(scene, k, r);
      const double error = std::abs((r.ok() ? r.stick_ratio : 1) - truth);
      e.dots += error;
      e.told += r.updated() ? error : 0;
      if (r.updated()) {
        const double along_ball = truth_on_ball(scene[k - r.reference_age], scene[k]);
        e.on_ball += std::abs(r.stick_ratio - along_ball);
        e.lifted += std::abs(truth - along_ball);
      }
      answered += r.updated() ? 1 : 0;
      e.fused += std::abs((fused.ok() ? fused.stick_ratio : 1) - truth);
      frames += 1;
    }
  }
  e.dots /= frames;
  e.told /= answered;
  e.on_ball /= answered;
  e.lifted /= answered;
  e.fused /= frames;
  return e;
}

void check(const std::string& name, double max_dots, double max_told, double max_fused) {
  const SceneErrors e = errors_of(name);
  INFO(name << ": dots in space " << e.dots << ", where they answer " << e.told
            << ", with the friction limit " << e.fused);
  CHECK(e.dots < max_dots);
  CHECK(e.told < max_told);
  CHECK(e.fused < max_fused);
}

}  // namespace

TEST_CASE("stick ratio in space on finite-element membranes", "[spatial_stick]") {
  // Goal of the fused answer: 0.05, mix 0.10. Where the dots fall back, the last answer is kept and
  // not reported as one of this frame.
  check("drag", 0.16, 0.09, 0.05);
  check("twist", 0.05, 0.05, 0.05);
  check("tilt", 0.09, 0.09, 0.05);
  check("mix", 0.06, 0.06, 0.10);
  check("rubber", 0.15, 0.04, 0.05);
}

TEST_CASE("stick ratio in space of what rolls, and what slides as a whole", "[spatial_stick]") {
  check("roll", 0.12, 0.125, 0.12);  // 0.035 along the ball, see below
  check("cylinder", 0.14, 0.13, 0.06);
  check("slide", 0.14, 0.1, 0.035);
  check("ball_slip", 0.15, 0.11, 0.08);
  check("rod_turn", 0.15, 0.115, 0.06);
  check("press", 0.08, 0.08, 0.08);
}

namespace {

/// Dots in contact in both steps.
bool in_both(const SpatialStep& then, const SpatialStep& now, Index row, Index col) {
  const bool inside = row >= 0 && col >= 0 && row < now.contact.rows() && col < now.contact.cols();
  return inside && then.contact(row, col) != 0 && now.contact(row, col) != 0;
}
bool is_at_edge(const SpatialStep& then, const SpatialStep& now, Index row, Index col) {
  return !in_both(then, now, row - 1, col) || !in_both(then, now, row + 1, col) ||
         !in_both(then, now, row, col - 1) || !in_both(then, now, row, col + 1);
}

/// The dots of a rolling ball that approach or leave it by more than the limit of the truth, per
/// frame with an answer, and the error of ratios that use the outline of the contact.
struct EdgeOfBall {
  double dots = 0, at_edge = 0, lifted = 0, lifted_inside = 0;
  double lift_mm = 0;  ///< mean of the lifted dots
  double edge_slips = 0, edge_left_out = 0;

  explicit EdgeOfBall(int recordings) {
    double frames = 0;
    for (int seed = 1; seed <= recordings; ++seed) {
      test::Random random(static_cast<std::uint64_t>(seed));
      stick_.reset();
      for (Index k = 0; k < scene_.size(); ++k) {
        const auto r =
            stick_(noisy(scene_[k].dots, lateral_mm, depth_mm, random), scene_[k].contact);
        if (k >= 2 && test::dots_of_both(scene_[k], scene_[k]) >= 6 && r.updated()) {
          add(scene_[k - r.reference_age], scene_[k]);
          frames += 1;
        }
      }
    }
    lift_mm /= lifted;
    for (double* mean : {&dots, &at_edge, &lifted, &lifted_inside, &edge_slips, &edge_left_out}) {
      *mean /= frames;
    }
  }

 private:
  void add(const SpatialStep& then, const SpatialStep& now) {
    const Pose<double> motion = now.object * inverse(then.object);
    const double limit = test::slip_share * test::longest_move(then, now);
    double all = 0, inside = 0, stick_inside = 0;
    for (Index i = 0; i < now.dots.rows(); ++i) {
      for (Index j = 0; j < now.dots.cols(); ++j) {
        if (!in_both(then, now, i, j) || stick_.states()(i, j) < DotState::slip) {
          continue;
        }
        const bool edge = is_at_edge(then, now, i, j);
        const auto normal = normalized(now.dots(i, j) - now.object.translation_mm);
        const double lift = std::abs(dot(now.dots(i, j) - motion(then.dots(i, j)), normal));
        all += 1;
        inside += edge ? 0 : 1;
        stick_inside += !edge && stick_.states()(i, j) == DotState::stick ? 1 : 0;
        lifted += lift > limit ? 1 : 0;
        lifted_inside += lift > limit && !edge ? 1 : 0;
        lift_mm += lift > limit ? lift : 0;
      }
    }
    const double truth = test::truth_between(then, now);
    dots += all;
    at_edge += all - inside;
    edge_slips += std::abs(stick_inside / all - truth);
    edge_left_out += std::abs((inside > 0 ? stick_inside / inside : 1) - truth);
  }

  SpatialScene scene_{"roll"};
  StickRatio<> stick_{scene_.dots_across(), scene_.dots_across(), {.noise = lateral_mm}};
};

}  // namespace

TEST_CASE("stick ratio in space of a rolling ball: what is off are dots that lift",
          "[spatial_stick]") {
  // The truth counts the whole motion of a dot relative to the object as slip, also at the edge of
  // the contact, where an eighth of the dots meet or leave the ball by 0.02 mm. Measured: 0.110 and
  // 0.035.
  const SceneErrors e = errors_of("roll");
  INFO("roll: where the dots answer " << e.told << ", along the ball " << e.on_ball
                                      << "; the exact slip along the ball " << e.lifted);
  CHECK(e.on_ball < 0.045);
  CHECK(e.told > 2 * e.on_ball);
}

TEST_CASE("stick ratio in space of a rolling ball: the outline does not tell which dots lift",
          "[spatial_stick]") {
  // The dots that lift are at the edge, but most dots at the edge do not lift. Measured: 3.1 of 24
  // lift, 13 are at the edge; errors of 0.11, 0.44 and 0.14.
  const EdgeOfBall edge(6);
  const double told = errors_of("roll").told;
  INFO("roll: " << edge.lifted << " of " << edge.dots << " dots lift, by " << edge.lift_mm
                << " mm, of these inside " << edge.lifted_inside << "; at the edge " << edge.at_edge
                << "; error " << told << ", edge counted as slip " << edge.edge_slips
                << ", edge left out " << edge.edge_left_out);
  CHECK(edge.lifted_inside < 0.1 * edge.lifted);
  CHECK(edge.at_edge > 3 * edge.lifted);
  CHECK(edge.edge_slips > 1.2 * told);
  CHECK(edge.edge_left_out > 1.2 * told);
}

namespace {

/// How many answers lie within two and within five of their standard deviations, and their mean.
struct Coverage {
  double two = 0, five = 0, answers = 0, mean_sd = 0;

  void add(double error, double sd) {
    ++answers;
    mean_sd += (sd - mean_sd) / answers;
    two += error <= 2 * sd ? 1 : 0;
    five += error <= 5 * sd ? 1 : 0;
  }
};

}  // namespace

TEST_CASE("stick ratio in space: its standard deviation covers the error",
          "[spatial_stick][spatial_sd]") {
  for (const Index every : {1, 2}) {
    Coverage all;
    std::ostringstream table;
    for (const char* name : {"drag", "twist", "tilt", "roll", "cylinder", "mix", "slide",
                             "ball_slip", "rod_turn", "rubber", "press"}) {
      const SpatialScene scene(name, every);
      const Index across = scene.dots_across();
      Coverage of_scene;
      for (const double noise : {0.5, 1.0, 2.0}) {
        const double along = noise * lateral_mm, deep = noise * depth_mm;
        for (int seed = 1; seed <= 4; ++seed) {
          test::Random random(static_cast<std::uint64_t>(seed));
          StickRatio<> stick(across, across, {.noise = along});
          for (Index k = 0; k < scene.size(); ++k) {
            const auto r = stick(noisy(scene[k].dots, along, deep, random), scene[k].contact);
            if (k >= 2 && test::dots_of_both(scene[k], scene[k]) >= 6 && r.updated()) {
              const double truth = test::truth_between(scene[k - r.reference_age], scene[k]);
              of_scene.add(std::abs(r.stick_ratio - truth), r.ratio_sd);
              all.add(std::abs(r.stick_ratio - truth), r.ratio_sd);
            }
          }
        }
      }
      table << name << ' ' << of_scene.two / of_scene.answers << " (" << of_scene.answers << "), ";
    }
    INFO((every == 2 ? "dots twice as far apart: " : "") << table.str());
    CAPTURE(all.answers, all.two / all.answers, all.five / all.answers, all.mean_sd);
    CHECK(all.two > 0.97 * all.answers);
    CHECK(all.five > 0.999 * all.answers);
    CHECK(all.mean_sd < (every == 1 ? 0.2 : 0.31));  // or any error would be covered
  }
}

TEST_CASE("stick ratio in space by the noise of dots and forces, and by their pitch",
          "[.][spatial_noise]") {
  for (const Index every : {1, 2}) {
    for (const char* name : {"drag", "twist", "tilt", "roll", "cylinder", "mix", "slide",
                             "ball_slip", "rod_turn", "rubber"}) {
      const SceneErrors e = errors_of(name, 12, 1, every), half = errors_of(name, 12, 0.5, every),
                        twice = errors_of(name, 12, 2, every);
      WARN(name << " | " << e.dots << " | " << e.told << " | " << e.fused << " | " << half.fused
                << " | " << twice.fused << (every == 2 ? " | dots twice as far apart" : ""));
      if (every == 1 && std::string(name) == "roll") {
        WARN("roll, exact slip along the ball: " << e.lifted << ", half the noise " << half.lifted
                                                 << ", twice " << twice.lifted);
      }
    }
  }
}
