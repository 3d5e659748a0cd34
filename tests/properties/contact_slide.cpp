// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// What must hold for every gel, every pitch and every noise: balls on the gel of sim/, seen by a
// camera, found by contact_by_difference, followed by contact_slide.
#include "fingerpad/slip/contact_slide.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "fingerpad/contact/contact_by_difference.hpp"
#include "fingerpad/slip/recoil.hpp"
#include "support/catch.hpp"
#include "support/gel_frames.hpp"
#include "support/generators.hpp"

using namespace fingerpad;
using test::GelCamera;
using test::Image;
using test::Random;

namespace {

/// A sensor and an object, any: from soft to firm, from fine to coarse dots.
struct AnyGel {
  GelPad pad;
  GelCamera camera;
  double force_n;

  AnyGel() {
    camera.rows = 112;
    camera.cols = 140;
    camera.mm_per_px = 0.17;
    camera.pitch_mm = test::uniform(1.9, 3.5);
    camera.noise = test::uniform(0, 2);
    camera.jitter_px = test::uniform(0, 0.1);
    camera.contrast = test::uniform(0.4, 1);
    pad.young_mpa = test::log_uniform(0.1, 0.5);
    pad.ball_mm = test::uniform(6, 16);
    // a contact of 2.5 to 4 mm, whose gel gives way by a third of its radius before all slides
    const double a = test::uniform(2.5, 4);
    force_n = a * a * a * 4 * pad.young_mpa / 0.75 / (3 * pad.ball_mm);
    pad.friction = 1;
    GelContact<> contact(pad);
    contact.drag(force_n, {0, 0});
    pad.friction = a * test::uniform(0.2, 0.4) / contact.max_pull_mm();
  }

  double pull_mm() const {
    GelContact<> contact(pad);
    contact.drag(force_n, {0, 0});
    return contact.max_pull_mm();
  }
  /// How far, in pitches, the ball gets ahead of the gel under it before all of it slides: the
  /// mean of eq. 3.91 over the contact is three quarters of what it is in the middle.
  double slide_at_slip() const { return 0.25 * pull_mm() / camera.pitch_mm; }
};

struct Step {
  double force_n;
  Point2<double> ball_mm;
};

struct Seen {
  std::vector<SlideResult<float>> slide;
  std::vector<RecoilResult<float>> recoil;
  std::vector<double> sticks;  ///< the truth: the share that does
  std::vector<bool> slides;    ///< the truth: all of the contact slides

  /// The first frame with an alarm; none: past the end.
  std::size_t alarm() const {
    const auto is_alarm = [](const auto& result) { return result.alarm; };
    return std::size_t(std::find_if(slide.begin(), slide.end(), is_alarm) - slide.begin());
  }
  std::size_t slip() const {
    return std::size_t(std::find(slides.begin(), slides.end(), true) - slides.begin());
  }
};

Seen watch(const AnyGel& gel,
           const std::vector<Step>& steps,
           SlideTest test,
           bool all_touch = false) {
  Random random(static_cast<std::uint64_t>(test::whole(1, 1000)));
  GelContact<> contact(gel.pad);
  const GelCamera& camera = gel.camera;
  const std::vector free = {camera.frame(contact, random), camera.frame(contact, random)};
  DifferenceTest difference;
  difference.cell_px = 2;
  difference.dot_px = 1.2 * camera.dot_mm / camera.mm_per_px;
  difference.max_gap_px = 2 * difference.dot_px;
  difference.smoothing_px = 3;
  difference.min_region_px = 100;
  const ContactByDifference<> region(free, difference);
  auto workspace = region.workspace();
  const auto cells = workspace.difference();
  const auto home = camera.true_dots(contact);
  test.pitch_px = camera.pitch_px();
  test.cell_px = 2;
  const ContactSlide<> slide(cells.rows(), cells.cols(), home.rows(), home.cols(), test);
  auto state = slide.start();
  const Recoil<> recoil(home, {.pitch_px = camera.pitch_px()});
  auto recoil_state = recoil.start();
  Image<std::uint8_t> mask(camera.rows, camera.cols);
  const Image<std::uint8_t> all(cells.rows(), cells.cols(), 1);
  Seen seen;
  for (const Step& step : steps) {
    contact.drag(step.force_n, step.ball_mm);
    const auto dots = camera.dots(contact, random);
    // ok or, of these small frames, more than half touched
    RC_ASSERT(region(camera.frame(contact, random), mask, workspace).status !=
              FrameStatus::refused);
    seen.slide.push_back(all_touch
                             ? slide(workspace.difference(), all, dots, state)
                             : slide(workspace.difference(), workspace.contact(), dots, state));
    seen.recoil.push_back(recoil(dots, recoil_state));
    seen.sticks.push_back(contact.stick_share());
    seen.slides.push_back(contact.slides());
  }
  return seen;
}

Point2<double> any_direction() {
  const double angle = test::uniform(0, 6.28);
  return {std::cos(angle), std::sin(angle)};
}

/// Pressed, then dragged `far_mm` in steps of a tenth of what friction carries.
std::vector<Step> dragged(const AnyGel& gel, double far_mm) {
  const auto along = any_direction();
  std::vector<Step> steps(3, {gel.force_n, {0, 0}});
  for (double at = 0; at < far_mm; at += gel.pull_mm() / 10) {
    steps.push_back({gel.force_n, at * along});
  }
  return steps;
}

}  // namespace

TEST_CASE("contact slide: partial slip is told before gross slip", "[contact_slide]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    SlideTest test;
    test.max_slide = 0.6 * gel.slide_at_slip();
    test.min_slide = test.max_slide;
    const Seen seen = watch(gel, dragged(gel, 1.6 * gel.pull_mm()), test);
    RC_ASSERT(seen.slip() < seen.slides.size());
    RC_ASSERT(seen.alarm() <= seen.slip());
    // not before any of it slips
    RC_ASSERT(seen.sticks[seen.alarm()] < 0.95);
  });
}

TEST_CASE("contact slide: a slide is as long as the ball's way past the gel", "[contact_slide]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    const Seen seen = watch(gel, dragged(gel, 2.5 * gel.pull_mm()), {});
    const double way = 2.4 * gel.pull_mm();
    const double expected = (way - 0.75 * gel.pull_mm()) / gel.camera.pitch_mm;
    RC_LOG() << seen.slide.back().slide << " for " << expected << "\n";
    RC_ASSERT(std::abs(double(seen.slide.back().slide) - expected) < 0.1 + 0.25 * expected);
  });
}

TEST_CASE("contact slide: loading and unloading in place is no slip", "[contact_slide]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    std::vector<Step> steps;
    for (const double share : {0.4, 0.6, 0.8, 1.0, 1.0, 0.8, 0.6, 0.4, 0.3, 0.2}) {
      steps.push_back({share * gel.force_n, {0, 0}});
    }
    const Seen seen = watch(gel, steps, {});
    RC_ASSERT(seen.alarm() == seen.slide.size());
    RC_ASSERT(seen.slide.back().lost > 0.25F);
  });
}

TEST_CASE("contact slide: a mask that is true everywhere gives no false warning",
          "[contact_slide]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    const Seen seen = watch(gel, dragged(gel, 0.8 * gel.pull_mm()), {}, true);
    RC_ASSERT(seen.alarm() == seen.slide.size());
    RC_ASSERT(seen.slide.back().status == SlideStatus::no_edge);
  });
}

TEST_CASE("contact slide: what is held does not wander", "[contact_slide]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    const auto at = 0.3 * gel.pull_mm() * any_direction();
    const Seen seen = watch(gel, std::vector<Step>(12, {gel.force_n, at}), {});
    for (const auto& result : seen.slide) {
      RC_ASSERT(result.slide < 0.05F);
      RC_ASSERT(result.lost < 0.1F);
      RC_ASSERT(std::abs(result.rotation_rad) < 0.05F);
    }
  });
}

TEST_CASE("recoil: a gel that springs back is told, one that is pulled is not", "[recoil]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    auto steps = dragged(gel, 0.9 * gel.pull_mm());
    const std::size_t pulled = steps.size();
    steps.push_back({0, {0, 0}});
    const Seen seen = watch(gel, steps, {});
    for (std::size_t k = 0; k < pulled; ++k) {
      RC_ASSERT(!seen.recoil[k].alarm);
    }
    const auto& last = seen.recoil.back();
    RC_ASSERT(last.displaced < 0.1F);
    RC_ASSERT(last.recoil > 0.8F * seen.recoil[pulled - 1].displaced);
  });
}
