// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Answers that nobody meant to change, of every room on frames with noise (support/digest.hpp).
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/report/chain/pressed_frames.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/contact/equivalent_flat_area.hpp"
#include "fingerpad/contact/surface.hpp"
#include "fingerpad/depth/neighbour_light.hpp"
#include "fingerpad/dots/dot_finder.hpp"
#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"
#include "fingerpad/published/contact_region.hpp"
#include "fingerpad/published/object_motion.hpp"
#include "fingerpad/published/segment_equilibrium.hpp"
#include "fingerpad/published/stick_ratio.hpp"
#include "fingerpad/slip/grip_control.hpp"
#include "support/catch.hpp"
#include "support/contact_records.hpp"
#include "support/digest.hpp"
#include "support/foam_signals.hpp"
#include "support/gel_frames.hpp"
#include "support/printed_dots.hpp"
#include "support/rim_marks.hpp"
#include "support/slipping_patch.hpp"
#include "support/spatial_scene.hpp"
#include "support/traction_scenes.hpp"
#include "support/wrench_frames.hpp"

using namespace fingerpad;
using test::Digest;
using test::Image;
using test::Random;
using test::same;
using test::SpatialScene;

namespace {

/// Dots of a step as a camera finds them: with noise, and some are lost.
test::DotsMm seen(const test::SpatialStep& step, double noise_mm, Random& random) {
  auto dots = test::noisy(step.dots, noise_mm, 2 * noise_mm, random);
  for (auto& dot : dots.cells) {
    dot = random.uniform() < 0.02 ? detail::missing_point<double>() : dot;
  }
  return dots;
}
Image<Point2<double>> in_plan(const test::DotsMm& dots) {
  Image<Point2<double>> plan(dots.rows(), dots.cols());
  for (std::size_t k = 0; k < plan.cells.size(); ++k) {
    plan.cells[k] = {dots.cells[k].x, dots.cells[k].y};
  }
  return plan;
}

void add(Digest& d, const StickResult<>& r) {
  d.all(r.status, r.stick, r.slip, r.unknown, r.out_of_place, r.back_ratio, r.back_sd,
        r.stick_ratio, r.ratio_sd, r.furthest, r.reference_age, r.motion.translation_mm, r.scale);
}
void add(Digest& d, const SlipResult<>& r) {
  d.all(r.status, r.evidence, r.stick_ratio, r.ratio_sd, r.update, r.dots_ratio, r.reference_age,
        r.falls_back, r.may_slide, r.in_doubt, r.friction, r.limit, r.margin);
}
void add(Digest& d, const ObjectMotionResult<>& r) {
  d.all(r.status, r.object, r.begun, r.dots_used, r.angles.x_rad, r.angles.y_rad, r.angles.z_rad,
        r.position_mm, r.displacement_mm, r.residual_rms_mm, r.position_sd_mm, r.rotation_sd_rad);
}
void add(Digest& d, const ShiftResult<>& r) {
  d.all(r.status, r.dots, r.displacement, r.rotation_rad, r.residual_rms);
}
void add(Digest& d, const ContactResult& r) {
  d.all(r.status, r.contact_px, r.unknown_px, r.regions, r.area_mm2, r.area_sd_mm2, r.pressed_mm2,
        r.center_mm, r.depth_mm);
}
void add(Digest& d, const WrenchResult& r) {
  d.all(r.status, r.force_n, r.moment_n_mm, r.pressure_mpa, r.pressure_sd_mpa, r.misfit, r.marks);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) {
      d.add(r.covariance(i, j));
    }
  }
}

}  // namespace

TEST_CASE("unchanged: stick ratio, friction and grip", "[unchanged]") {
  const auto [name, expected] = GENERATE(table<std::string, double>({{"drag", 157446.696},
                                                                     {"twist", 73579.986},
                                                                     {"roll", -22629.367},
                                                                     {"ball_slip", -31331.855},
                                                                     {"rod_turn", 17147.948}}));
  INFO(name);
  const SpatialScene scene(name);
  const Index across = scene.dots_across();
  StickRatio<> space(across, across), plan(across, across, {.noise = 0.004});
  FrictionLimit<> limit;
  GripControl<> grip({}, 2);
  Random random(5);
  Digest d;
  for (Index k = 0; k < scene.size(); ++k) {
    const auto& step = scene[k];
    const auto dots = seen(step, 0.004, random);
    const double time_s = 0.1 * static_cast<double>(k);
    const auto r = space(dots, step.contact, time_s);
    const auto slip = limit(contact_load(step.force_n, step.moment_n_mm, dots, step.contact), r);
    const auto hold = grip(slip.stick_ratio, slip.update, 0.1);
    add(d, r);
    add(d, plan(in_plan(dots), step.contact, time_s));
    add(d, slip);
    d.all(hold.force_n, hold.why, hold.at_limit, space.noise(), space.states(), space.slips());
  }
  CHECK(d.sum() == same(expected));
}

TEST_CASE("unchanged: motion of the object, and shift of its dots", "[unchanged]") {
  const auto [name, expected] = GENERATE(table<std::string, double>(
      {{"drag", 9919.96}, {"roll", 9011.765}, {"tilt", 5333.875}, {"rod_turn", 11562.8830}}));
  INFO(name);
  const SpatialScene scene(name);
  const Index across = scene.dots_across();
  ObjectMotion<> motion(across, across);
  Random random(7);
  ContactShift<> all(in_plan(scene[0].dots)), robust(in_plan(scene[0].dots), {.robust_passes = 3});
  StickRatio<> stick(across, across);
  Digest d;
  for (Index k = 0; k < scene.size(); ++k) {
    const auto dots = seen(scene[k], 0.006, random);
    const auto& contact = scene[k].contact;
    (void)stick(dots, contact);
    const LazyView slips(across, across,
                         [&](Index i, Index j) { return stick.states()(i, j) == DotState::slip; });
    add(d, motion(dots, contact, slips, 0.012));
    add(d, all(in_plan(dots), contact));
    add(d, robust(in_plan(dots), contact));
  }
  CHECK(d.sum() == same(expected));
}

TEST_CASE("unchanged: printed stick ratio and motion", "[unchanged]") {
  const auto [name, expected] = GENERATE(
      table<std::string, double>({{"drag", 24420.644}, {"twist", 14975.411}, {"roll", 9390.298}}));
  INFO(name);
  const SpatialScene scene(name);
  const Index across = scene.dots_across();
  published::StickRatio<> slides(across, across),
      plain(across, across, published::conventional_stick_ratio);
  published::ObjectMotion<> motion(scene[0].dots);
  Random random(9);
  Digest d;
  for (Index k = 0; k < scene.size(); ++k) {
    auto dots = test::noisy(scene[k].dots, 0.004, 0.008, random);
    auto px = in_plan(dots);
    for (auto& p : px.cells) {
      p = {320 + p.x / 0.077, 240 + p.y / 0.077};
    }
    for (auto* ratio : {&slides, &plain}) {
      const auto r = (*ratio)(px, scene[k].contact);
      d.all(r.updated, r.stick_ratio, r.reference_age, r.furthest_px, r.reference_dot.row,
            r.reference_dot.col, r.angle_rad, r.scale);
    }
    const auto m = motion(dots, scene[k].contact);
    d.all(m.updated, m.begun, m.reference.row, m.reference.col, m.angles.x_rad, m.angles.y_rad,
          m.angles.z_rad, m.displacement_mm, m.pose.translation_mm);
  }
  CHECK(d.sum() == same(expected));
}

TEST_CASE("unchanged: six axes from the dots near the rim", "[unchanged]") {
  Digest d;
  for (const auto& scene : test::rim_scenes()) {
    for (const bool has_gauge : {true, false}) {
      auto options = test::SeenRim::options_of(scene, true);
      options.modulus_sd_share = 0.01;
      options.pressure_sd_share = has_gauge ? 0.002 : 1;
      options.thickness_mm = has_gauge ? 0 : 0.5;
      test::SeenRim pad(scene, options, 0.06, 3);
      for (std::size_t k = 0; k < scene.frames.size(); ++k) {
        pad.show(k);
        pad.marks[7].px.x += 5;  // a wrong label
        add(d, pad.wrench(pad.marks, scene.frames[k].pressure_mpa, 16));
      }
    }
  }
  CHECK(d.sum() == same(17070.073));
}

TEST_CASE("unchanged: traction", "[unchanged]") {
  Digest d;
  TractionField<> field(test::stress_free_dots()),
      given(test::stress_free_dots(), {.mu_t_n_per_mm = 0.5});
  test::Gauss gauss(4);
  for (const auto& scene : test::traction_scenes()) {
    const auto dots = test::noisy(scene.dots, 0.004, gauss);
    for (auto* of : {&field, &given}) {
      const auto r = (*of)(dots, scene.contact, scene.pressure_mpa);
      d.all(r.status, r.modulus_differs, r.is_pulled, r.force_n, r.moment_n_mm, r.mu_t_n_per_mm,
            r.free_mu_t_n_per_mm, r.free_load_rms_mpa, r.free_dots, r.dots_left_out,
            of->pressure_mpa());
    }
  }
  CHECK(d.sum() == same(40410.300));
}

TEST_CASE("unchanged: look-up of forces and its fits", "[unchanged]") {
  Digest d;
  const auto records = test::contact_records({"press", "drag", "twist", "mix"});
  for (const auto measure : {test::ContactMeasure::area, test::ContactMeasure::depth}) {
    const auto samples = test::force_samples(records, measure);
    const auto fit = fit_normal_force<double>(samples, 3, false);
    const auto shear = fit_tangential_force<double>(samples, 200);
    const auto turn = fit_moment<double>(samples, 200);
    NormalForce<> force(fit.curve);
    d.all(fit.explained, shear.law.slope, shear.residual_sd, shear.explained, turn.residual_sd,
          shear.gauge_angle_rad, shear.gauge_angle_sd_rad, turn.law.slope, turn.explained);
    for (const auto& m : {shear.covariance, turn.covariance}) {
      d.all(m[0][0], m[1][0], m[1][1]);
    }
    const double from = fit.curve.from, to = fit.curve.to;
    for (const double at : {0.3 * from, 0.8 * from, (from + to) / 2, to, 1.5 * to}) {
      const auto r = force(at, 0.4);
      const auto s = Shear<>({200, shear.law, turn.law})(at, {0.3, -0.2}, 0.02);
      d.all(r.status, r.force_n, r.variance_n2, s.status, s.tangential_force_n, s.moment_n_mm);
    }
  }
  CHECK(d.sum() == same(2601.964));
}

TEST_CASE("unchanged: printed six axes", "[unchanged]") {
  Digest d;
  published::SegmentEquilibrium<> printed(test::rim_border());
  for (std::size_t k = 0; k < 6; ++k) {
    const auto& frame = test::wrench_frames()[k];
    const auto r = printed(test::exact_heights(frame.heights), test::rows_of(frame.dots, 1),
                           frame.pressure_mpa);
    d.all(r.force_n, r.moment_n_mm);
    for (Index i = 0; i < printed.lines(); i += 9) {
      d.all(printed.node(i, 3), printed.f_h(i, 2), printed.f_h(i, 20), printed.f_h(i, 40));
    }
  }
  CHECK(d.sum() == same(3285.802));
}

TEST_CASE("unchanged: contact, surface, flat area and neighbouring light", "[unchanged]") {
  const chain::PressedFrames pad(240, 320, 3);
  const auto options = pad.options();
  Digest d;
  ContactRegion<float> placed(options.camera, 240, 320, options.contact);
  auto rough_test = options.contact;
  rough_test.places_edge = false;
  ContactRegion<double> rough(options.camera, 240, 320, rough_test);
  EquivalentFlatArea<> flat(options.camera, 240, 320);
  NeighbourLightCompensation<float> light({.radius_px = 8}, 0.15F, pad[0].depth_mm);
  Random random(2);
  for (std::size_t k = 0; k < pad.size(); ++k) {
    Image<float> depth(240, 320);
    for (std::size_t p = 0; p < depth.cells.size(); ++p) {
      depth.cells[p] = static_cast<float>(pad[k].depth_mm.cells[p] + 0.01 * random.normal());
    }
    Image<Touch> mask(240, 320), rough_mask(240, 320);
    add(d, placed(depth, mask));
    add(d, rough(depth, rough_mask));
    const auto surface = fit_surface(options.camera, depth, mask);
    d.all(surface.pixels, surface.curvature_1_per_mm, surface.curvature_2_per_mm,
          surface.curvature_1_sd_per_mm, surface.curvature_2_sd_per_mm, surface.direction_1,
          surface.point_mm, surface.normal, surface.rms_mm);
    const auto area = flat(mask, depth);
    d.all(area.area_mm2, area.variance_mm4);
    d.all(published::contact_by_slides(depth, rough_mask));
    Image<float> without(240, 320);
    d.add(light(depth, without));
    for (std::size_t p = 0; p < without.cells.size(); p += 97) {
      d.add(without.cells[p]);
    }
  }
  CHECK(d.sum() == same(60318.755));
}

TEST_CASE("unchanged: the whole chain", "[unchanged]") {
  const auto [sampling, expected] = GENERATE(table<int, double>({{1, 129973.91}, {3, 129468.317}}));
  CAPTURE(sampling);
  const chain::PressedFrames pad(240, 320, 5);
  auto options = chain::in_samples(pad.options(), sampling);
  options.flat_area = true;
  chain::Fingertip tip(options);
  Digest d;
  for (std::size_t k = 0; k < pad.size(); ++k) {
    const auto r = touch_of(tip, pad[k].view());
    d.all(r.status, r.depth_in_doubt, r.contact_in_doubt, r.lacks_motion, r.rotation_in_doubt,
          r.depth_light_sd_mm, r.neighbour_light, r.flat_area.area_mm2, r.normal.force_n,
          r.normal.variance_n2, r.by_depth.force_n, r.shear.tangential_force_n,
          r.shear.moment_n_mm);
    for (const Index count : r.depth.count) {
      d.add(static_cast<double>(count));
    }
    add(d, r.contact);
    add(d, r.motion);
    add(d, r.stick);
    add(d, r.slip);
    add(d, r.shift);
    for (Index i = 5; i < 240; i += 17) {
      for (Index j = 3; j < 320; j += 19) {
        d.all(tip.depth_mm()(i, j), tip.contact_mask()(i, j));
      }
    }
    d.add(tip.dots_mm());
  }
  CHECK(d.sum() == same(expected));
}

TEST_CASE("unchanged: foam fingers", "[unchanged]") {
  test::FoamScene scene;
  scene.patches[0] = {{.row = 3, .col = 1, .begin_s = 2},
                      {.row = 9, .begin_s = 3, .frequency_hz = 9}};
  scene.patches[1] = {{.row = 5, .col = 2, .begin_s = 2.5, .frequency_hz = 3}};
  Digest d;
  for (const PreslipRule rule : {PreslipRule::grasp_lift, PreslipRule::grasp_optimise}) {
    test::FoamSignal signal(scene, 3);
    const std::vector fingers(2, TaxelFeatures<>(16, 4, {.noise = 4, .saturated_at = 900}));
    FoamHand<> hand(fingers, {.rule = rule});
    LoosenUntilPreslip<> loosen;
    LiftWithRegrip<> lift;
    Random random(8);
    for (int k = 0; k < 200; ++k) {
      const double time_s = k / 30.0 + 0.004 * random.uniform();
      std::array readings = {signal.finger(0, time_s), signal.finger(1, time_s)};
      readings[0](7, 3) = k % 40 < 2 ? 0 : readings[0](7, 3);  // a loose contact
      readings[1](2, 2) = 950;                                 // at full scale
      readings[1](0, 0) = 333;                                 // stuck
      const auto status = hand(readings, time_s);
      const auto down = loosen(status);
      const auto up = lift(status);
      d.all(status, down.force_n, down.phase, down.preslip_force_n, up.force_n, up.height_mm,
            up.phase);
      for (const auto& f : hand.fingers()) {
        d.all(f.status, f.center_x_mm, f.center_y_mm, f.sum, f.location, f.waves, f.frequency_hz,
              f.deviation, f.left_out, f.vibration_count);
      }
    }
  }
  CHECK(d.sum() == same(363080.261));
}

TEST_CASE("unchanged: dots in pictures", "[unchanged]") {
  const test::Print print{.rotation_rad = 0.03, .noise = 2};
  const auto places = test::places_of(print);
  const cv::Mat free = test::picture_of(print, places);
  DotFinder finder(free);
  REQUIRE(finder.ok());
  DotFollower follower(channel<std::uint8_t>(free, 1), finder.free_px());
  Digest d;
  d.all(finder.pattern().pitch_px, finder.free_px());
  for (int k = 0; k < 6; ++k) {
    auto moved = test::moved(places, {0.9 * k, -0.5 * k});
    moved(2, 3) = {test::nan, test::nan};
    const cv::Mat picture =
        test::picture_of(print, moved, {{60.0 + k, 90}}, static_cast<unsigned long long>(k + 2));
    Image<Point2<double>> found(print.rows, print.cols), followed(print.rows, print.cols);
    const auto r = finder(picture, found);
    const auto f = follower(channel<std::uint8_t>(picture, 1), followed);
    d.all(r.status, r.found, r.expected, r.spots, found, f.status, f.found, followed);
  }
  CHECK(d.sum() == same(121457.848));
}

TEST_CASE("unchanged: contact and slide on a gel", "[unchanged]") {
  const test::GelCamera camera;
  const test::BallOnGel<> untouched(test::GelPad{});
  auto ball = untouched;
  Random random(6);
  std::vector<cv::Mat> free;
  for (int k = 0; k < 4; ++k) {
    free.push_back(test::mat_of(camera.frame(untouched, random)));
  }
  const GelOptions options{.dot_px = camera.dot_mm / camera.mm_per_px};
  GelContact gel(free, options);
  const auto home = camera.true_dots(untouched);
  GelSlide slide(gel.mask().rows, gel.mask().cols, home,
                 {.cell_px = static_cast<double>(options.cell_px)});
  Digest d;
  for (int k = 0; k < 14; ++k) {
    ball.drag(3, {0.09 * k, 0.02 * k});
    const auto r = gel(test::mat_of(camera.frame(ball, random)));
    const auto s = slide(cv::Mat_<float>(gel.imprint()), cv::Mat_<std::uint8_t>(gel.mask()),
                         camera.dots(ball, random));
    d.all(r.status, r.contact_px, r.center_px, s.status, s.dots, s.imprint_px, s.imprint_sd_px,
          s.slide_px, s.slide, s.lost, s.evidence, s.alarm);
  }
  CHECK(d.sum() == same(6951.486));
}
