// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every gel, every pitch and every noise: balls on a gel, seen by a camera, detected
// by GelContact, tracked by GelSlide.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/gel_frames.hpp"
#include "support/generators.hpp"

using namespace fingerpad;
using test::BallOnGel;
using test::GelCamera;
using test::GelPad;
using test::Image;
using test::Random;

namespace {

/// Any sensor and object: soft to firm, with fine to coarse dots.
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
    // a contact of 2.5 to 4 mm, whose gel yields by a third of its radius before all of it slides
    const double a = test::uniform(2.5, 4);
    force_n = a * a * a * 4 * pad.young_mpa / 0.75 / (3 * pad.ball_mm);
    pad.friction = 1;
    BallOnGel<> contact(pad);
    contact.drag(force_n, {0, 0});
    pad.friction = a * test::uniform(0.2, 0.4) / contact.max_pull_mm();
  }

  double pull_mm() const {
    BallOnGel<> contact(pad);
    contact.drag(force_n, {0, 0});
    return contact.max_pull_mm();
  }
  /// Lead of the ball over the gel under it, in pitches, before all of it slides. The mean of eq.
  /// 3.91 over the contact is three quarters of its value in the middle.
  double slide_at_slip() const { return 0.25 * pull_mm() / camera.pitch_mm; }
};

struct Step {
  double force_n;
  Point2<double> ball_mm;
};

struct Seen {
  std::vector<SlideResult> slide;
  std::vector<double> displaced;  ///< true displacement that 95 % of the dots stay below, pitches
  std::vector<double> sticks;     ///< true stick ratio
  std::vector<bool> slides;       ///< truth: the whole contact slides
  double true_slide = 0;          ///< in pitches, at the end

  /// The first frame with an alarm; past the end if there is none.
  std::size_t alarm() const {
    const auto is_alarm = [](const auto& result) { return result.alarm; };
    return std::size_t(std::find_if(slide.begin(), slide.end(), is_alarm) - slide.begin());
  }
  std::size_t slip() const {
    return std::size_t(std::find(slides.begin(), slides.end(), true) - slides.begin());
  }
};

GelOptions options_of(const GelCamera& camera) {
  const double dot_px = 1.2 * camera.dot_mm / camera.mm_per_px;
  return {.cell_px = 2,
          .smoothing_px = 3,
          .dot_px = dot_px,
          .max_gap_px = 2 * dot_px,
          .min_region_px = 100};
}

/// Radius in mm within which a ball's dent differs by more than `threshold`. The slope beyond the
/// contact is that of eq. 3.42 of Johnson, and the lamps see its root mean square.
double dent_mm(const AnyGel& gel, double threshold) {
  BallOnGel<> contact(gel.pad);
  contact.drag(gel.force_n, {0, 0});
  const double a = contact.radius_mm();
  const double at_edge = gel.camera.contrast * a / gel.pad.ball_mm / std::sqrt(2.0);
  double rho = 1;
  while (2 / 3.14159265358979 * (rho * std::asin(1 / rho) - std::sqrt(1 - 1 / (rho * rho))) >
         threshold / at_edge) {
    rho += 1e-3;
  }
  return rho * a;
}

/// Lead of a ball over the gel under its dent: the median of the dots in the dent, step by step, by
/// the gel's own equations.
class TrueSlide {
 public:
  TrueSlide(const GelCamera& camera, double dent_mm) : camera_(camera), dent_mm_(dent_mm) {}

  /// Adds another step of the ball.
  void add(const BallOnGel<>& contact) {
    const auto dots = camera_.true_dots(contact);
    std::vector<bool> in;
    std::vector<double> x;
    std::vector<double> y;
    for (std::size_t k = 0; k < dots.cells.size(); ++k) {
      const auto from_ball = dots.cells[k] - camera_.px_of(contact.ball_mm());
      in.push_back(norm(from_ball) * camera_.mm_per_px < dent_mm_);
      if (in[k] && !in_.empty() && in_[k]) {
        x.push_back(dots.cells[k].x - dots_.cells[k].x);
        y.push_back(dots.cells[k].y - dots_.cells[k].y);
      }
    }
    if (!x.empty()) {
      const Point2<double> dots_mm = {median(x), median(y)};
      slide_mm_ += contact.ball_mm() - ball_mm_ - camera_.mm_per_px * dots_mm;
    }
    dots_ = dots;
    in_ = in;
    ball_mm_ = contact.ball_mm();
  }
  double pitches() const { return norm(slide_mm_) / camera_.pitch_mm; }

 private:
  static double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  GelCamera camera_;
  double dent_mm_;
  test::GelDots dots_{0, 0};
  std::vector<bool> in_;
  Point2<double> ball_mm_ = {0, 0};
  Point2<double> slide_mm_ = {0, 0};
};

/// The displacement in px that 95 % of the dots stay below.
double displaced(const test::GelDots& now, const test::GelDots& free) {
  std::vector<double> lengths;
  for (std::size_t k = 0; k < now.cells.size(); ++k) {
    lengths.push_back(norm(now.cells[k] - free.cells[k]));
  }
  std::sort(lengths.begin(), lengths.end());
  return lengths[static_cast<std::size_t>(0.95 * static_cast<double>(lengths.size() - 1))];
}

Seen watch(const AnyGel& gel,
           const std::vector<Step>& steps,
           SlideOptions options,
           bool all_touch = false) {
  Random random(static_cast<std::uint64_t>(test::whole(1, 1000)));
  BallOnGel<> contact(gel.pad);
  const GelCamera& camera = gel.camera;
  const auto frame = [&] { return test::mat_of(camera.frame(contact, random)); };
  const std::vector free = {frame(), frame()};
  GelContact region(free, options_of(camera));
  const Index rows = region.mask().rows, cols = region.mask().cols;
  const auto home = camera.true_dots(contact);
  options.cell_px = 2;
  GelSlide slide(rows, cols, home, options);
  const Image<std::uint8_t> all(rows, cols, 1);
  Seen seen;
  TrueSlide true_slide(camera, dent_mm(gel, region.threshold()));
  for (const Step& step : steps) {
    contact.drag(step.force_n, step.ball_mm);
    true_slide.add(contact);
    const auto dots = camera.dots(contact, random);
    seen.displaced.push_back(displaced(camera.true_dots(contact), home) / camera.pitch_px());
    // ok or, in these small frames, more than half in contact
    RC_ASSERT(region(frame()).status != FrameStatus::refused);
    seen.slide.push_back(all_touch ? slide(region.imprint(), all, dots)
                                   : slide(region.imprint(), region.mask(), dots));
    seen.sticks.push_back(contact.stick_share());
    seen.slides.push_back(contact.slides());
  }
  seen.true_slide = true_slide.pitches();
  return seen;
}

Point2<double> any_direction() {
  const double angle = test::uniform(0, 6.28);
  return {std::cos(angle), std::sin(angle)};
}

/// The ball is pressed, then dragged `far_mm` in steps of a tenth of the displacement that friction
/// carries.
std::vector<Step> dragged(const AnyGel& gel, double far_mm) {
  const auto along = any_direction();
  std::vector<Step> steps(3, {gel.force_n, {0, 0}});
  for (double at = 0; at < far_mm; at += gel.pull_mm() / 10) {
    steps.push_back({gel.force_n, at * along});
  }
  return steps;
}

/// A gel and a ball whose dent covers at least half of the frame and at most a quarter of its
/// border.
struct LargeContact {
  AnyGel gel;
  Random random{static_cast<std::uint64_t>(test::whole(1, 1000))};
  double dent_px = test::uniform(0.46, 0.56) * static_cast<double>(gel.camera.rows);

  LargeContact() {
    gel.camera.noise = test::uniform(0, 1);
    gel.camera.mm_per_px = dent_mm(gel, GelOptions().min_difference) / dent_px;
  }
  GelContact region() {
    const BallOnGel<> none(gel.pad);
    const auto frame = [&] { return test::mat_of(gel.camera.frame(none, random)); };
    return GelContact(std::vector{frame(), frame()}, options_of(gel.camera));
  }
};

}  // namespace

TEST_CASE("gel contact: a contact of half the frame is found in any exposure", "[gel_contact]") {
  rc::prop("for every gel", [] {
    LargeContact large;
    GelCamera& camera = large.gel.camera;
    GelContact region = large.region();
    camera.exposure = test::uniform(0.8, 1.1);
    BallOnGel<> ball(large.gel.pad);
    const auto off = 0.05 * static_cast<double>(camera.rows) * camera.mm_per_px * any_direction();
    ball.drag(large.gel.force_n, off);
    const GelResult seen = region(test::mat_of(camera.frame(ball, large.random)));
    RC_ASSERT(seen.ok());
    Index expected = 0;
    for (Index i = 0; i < camera.rows; ++i) {
      for (Index j = 0; j < camera.cols; ++j) {
        const auto at = camera.mm_of(static_cast<double>(i), static_cast<double>(j));
        expected += norm(at - off) < large.dent_px * camera.mm_per_px ? 1 : 0;
      }
    }
    RC_LOG() << seen.contact_px << " for " << expected << " px\n";
    // the dent's tail reaches the border and shifts the gain there
    RC_ASSERT(std::abs(double(seen.contact_px) / double(expected) - 1) < 0.25);
  });
}

TEST_CASE("gel contact: other lamps are told from a large contact", "[gel_contact]") {
  rc::prop("for every gel", [] {
    LargeContact large;
    const GelCamera& camera = large.gel.camera;
    GelContact region = large.region();
    BallOnGel<> ball(large.gel.pad);
    if (test::whole(0, 1) == 1) {
      ball.drag(large.gel.force_n, {0, 0});
    }
    auto frame = camera.frame(ball, large.random);
    // brighter toward one side, in a different direction for each channel
    const double change = test::uniform(0.15, 0.4);
    const std::array directions = {any_direction(), any_direction(), any_direction()};
    for (Index i = 0; i < camera.rows; ++i) {
      for (Index j = 0; j < camera.cols; ++j) {
        const Point2<double> at = {static_cast<double>(j) / static_cast<double>(camera.cols) - 0.5,
                                   static_cast<double>(i) / static_cast<double>(camera.rows) - 0.5};
        for (std::size_t c = 0; c < 3; ++c) {
          auto& level = frame(i, j)[c];
          level = static_cast<std::uint8_t>(
              (std::min)(253.0, level * (1 + change * dot(directions[c], at))));
        }
      }
    }
    RC_ASSERT(region(test::mat_of(frame)).status == FrameStatus::not_of_this_pad);
  });
}

TEST_CASE("gel slide: partial slip is told before gross slip", "[gel_slide]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    SlideOptions options;
    options.max_slide = 0.6 * gel.slide_at_slip();
    options.min_slide = options.max_slide;
    const Seen seen = watch(gel, dragged(gel, 1.6 * gel.pull_mm()), options);
    RC_ASSERT(seen.slip() < seen.slides.size());
    RC_ASSERT(seen.alarm() <= seen.slip());
    // not before some of it slips
    RC_ASSERT(seen.sticks[seen.alarm()] < 0.95);
  });
}

TEST_CASE("gel slide: the imprint goes as far as the ball, whatever the dots do", "[gel_slide]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    const Seen seen = watch(gel, dragged(gel, 1.05 * gel.pull_mm()), {});
    const auto& last = seen.slide.back();
    const double way = double(norm(last.imprint_px)) * gel.camera.mm_per_px;
    const double sd = double(last.imprint_sd_px) * gel.camera.mm_per_px;
    RC_LOG() << way << " +- " << sd << " mm for " << gel.pull_mm() << "\n";
    // filled-in dots leave up to 4 %
    RC_ASSERT(std::abs(way - gel.pull_mm()) < 0.04 * gel.pull_mm() + 4 * sd);
    RC_ASSERT(sd < 0.5 * gel.camera.mm_per_px);
  });
}

TEST_CASE("gel slide: a slide is as long as the ball's way past the gel of its dent",
          "[gel_slide]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    const Seen seen = watch(gel, dragged(gel, 2.5 * gel.pull_mm()), {});
    const auto& last = seen.slide.back();
    RC_LOG() << last.slide << " for " << seen.true_slide << "\n";
    const double way_px = 2.5 * gel.pull_mm() / gel.camera.mm_per_px;
    const double imprint_px = 0.04 * way_px + 4 * double(last.imprint_sd_px);
    // and a dot on the dent's edge may count or not
    const double allowed = 0.05 + imprint_px / gel.camera.pitch_px();
    RC_ASSERT(std::abs(double(last.slide) - seen.true_slide) < allowed);
  });
}

TEST_CASE("gel slide: loading and unloading in place is no slip", "[gel_slide]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    std::vector<Step> steps;
    for (const double share : {0.4, 0.6, 0.8, 1.0, 1.0, 0.8, 0.6, 0.4, 0.3, 0.2}) {
      steps.push_back({share * gel.force_n, {0, 0}});
    }
    const Seen seen = watch(gel, steps, {});
    RC_ASSERT(seen.alarm() == seen.slide.size());
    RC_ASSERT(seen.slide.back().lost > 0.25);
  });
}

TEST_CASE("gel slide: a mask that is true everywhere gives no false warning", "[gel_slide]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    const Seen seen = watch(gel, dragged(gel, 0.8 * gel.pull_mm()), {}, true);
    RC_ASSERT(seen.alarm() == seen.slide.size());
    RC_ASSERT(seen.slide.back().status == SlideStatus::no_edge);
  });
}

TEST_CASE("gel slide: what is held does not wander", "[gel_slide]") {
  rc::prop("for every gel", [] {
    const AnyGel gel;
    const auto at = 0.3 * gel.pull_mm() * any_direction();
    const Seen seen = watch(gel, std::vector<Step>(12, {gel.force_n, at}), {});
    for (const auto& result : seen.slide) {
      RC_ASSERT(result.slide < 0.05);
      RC_ASSERT(result.lost < 0.1);
      RC_ASSERT(norm(result.imprint_px) <= 5 * result.imprint_sd_px);
    }
  });
}

TEST_CASE("gel contact: its images stay; gel slide: a frame allocates nothing",
          "[gel_contact][gel_slide]") {
  const test::GelCamera camera;
  test::Random random(5);
  test::BallOnGel<> contact(test::GelPad{});
  GelContact gel(std::vector{test::mat_of(camera.frame(contact, random))});
  const auto images = [&] {
    return std::array<const void*, 3>{gel.mask().data, gel.difference().data, gel.imprint().data};
  };
  const auto first = images();
  const auto home = camera.dots(contact, random);
  GelSlide slide(gel.mask().rows, gel.mask().cols, home);
  for (int frame = 0; frame < 5; ++frame) {
    contact.drag(0.5 + 0.1 * frame, {0.5 * frame, 0.1 * frame});
    const GelResult found = gel(test::mat_of(camera.frame(contact, random)));
    const cv::Mat_<float>& imprint = gel.imprint();
    CHECK(images() == first);
    const auto dots = camera.dots(contact, random);
    const long before = test::allocations();
    const auto slid = slide(imprint, gel.mask(), dots);
    const long after = test::allocations();
    CHECK(before > 0);
    CHECK(found.in_contact());
    CHECK(slid.ok());
    CHECK(after == before);
  }
}
