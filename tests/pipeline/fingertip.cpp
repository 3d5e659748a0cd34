// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// All methods in sequence: correct results that are the same from run to run and from a copy,
// stages that do not exist, and refused inputs.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/report/chain/pressed_frames.hpp"
#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"
#include "support/rim_marks.hpp"

using namespace chain;

namespace {

/// Frames small enough for a test, with a contact wider than the ring. Each is made when it is
/// asked for: a test case is a process of its own.
class Frames {
 public:
  static constexpr std::size_t size = 4;
  FingertipOptions options() const { return pad_.options(); }
  const PressedFrame& operator[](std::size_t k) const {
    if (!made_[k]) {
      made_[k].emplace(pad_.frame(static_cast<int>(k), static_cast<int>(size)));
    }
    return *made_[k];
  }

 private:
  PressedFrames pad_{240, 320, 0};
  mutable std::array<std::optional<PressedFrame>, size> made_;
};
const Frames& frames() {
  static const Frames all;
  return all;
}

/// A fingertip, and what it says of the first frames.
struct Run {
  Fingertip tip;
  std::vector<FingertipResult> results = {};

  explicit Run(const FingertipOptions& options, std::size_t count = Frames::size)
      : Run(Fingertip(options), count) {}
  explicit Run(const Fingertip& from, std::size_t count = Frames::size) : tip(from) {
    for (std::size_t k = 0; k < count; ++k) {
      results.push_back(touch_of(tip, frames()[k].view()));
    }
  }
};

void check_same(const Run& a, const Run& b) {
  const auto same = [](double x, double y) { return test::same_bits(x, y); };
  for (std::size_t k = 0; k < a.results.size(); ++k) {
    const FingertipResult &x = a.results[k], &y = b.results[k];
    CHECK(x.depth.count == y.depth.count);
    CHECK(x.contact.contact_px == y.contact.contact_px);
    CHECK(same(x.contact.area_mm2, y.contact.area_mm2));
    CHECK(same(x.motion.angles.z_rad, y.motion.angles.z_rad));
    CHECK(same(x.motion.position_mm.x, y.motion.position_mm.x));
    CHECK(test::same_bits(x.stick.stick_ratio, y.stick.stick_ratio));
    CHECK(same(x.normal.force_n, y.normal.force_n));
    CHECK(same(x.shear.moment_n_mm, y.shear.moment_n_mm));
  }
  const auto p = a.tip.depth_mm(), q = b.tip.depth_mm();
  const auto in_contact = a.tip.contact_mask(), in_contact_too = b.tip.contact_mask();
  bool same_depth = true;
  for (Index i = 0; i < p.rows(); ++i) {
    for (Index j = 0; j < p.cols(); ++j) {
      same_depth = same_depth && test::same_bits(p(i, j), q(i, j)) &&
                   in_contact(i, j) == in_contact_too(i, j);
    }
  }
  CHECK(same_depth);
}

}  // namespace

TEST_CASE("the whole chain tells what the plate does", "[chain]") {
  const Run run(in_samples(frames().options(), 2));  // windows are half the default width
  const auto& first = frames()[0];
  for (std::size_t k = 0; k < run.results.size(); ++k) {
    CAPTURE(k);
    const FingertipResult& r = run.results[k];
    const PressedFrame& f = frames()[k];
    // depths are averaged over 15 px
    CHECK(r.contact.area_mm2 == Approx(f.contact_area_mm2()).epsilon(0.13));
    CHECK(r.contact.area_mm2 + r.contact.area_sd_mm2 > f.contact_area_mm2());
    CHECK(r.contact.depth_mm == Approx(13 - f.membrane.height(0)).margin(0.03));
    CHECK(r.motion.angles.z_rad == Approx(f.plate.turn_rad - first.plate.turn_rad).margin(0.0005));
    if (k > 0) {
      CHECK(r.stick.stick_ratio > 0.95);
    }
  }
}

TEST_CASE("the whole chain gives the same bits from run to run and from a copy", "[chain]") {
  const bool is_lean = GENERATE(false, true);
  const auto options = is_lean ? lean(frames().options()) : frames().options();
  const Fingertip fingertip(options);
  const Run once(options, 3), again(options, 3), copied(fingertip, 3);
  check_same(once, again);
  check_same(once, copied);
}

namespace {

FingertipOptions contact_and_depth(int step) {
  FingertipOptions options = in_samples(frames().options(), step);
  options.free_dots_mm = {};
  options.force_of_area = options.force_of_depth = {};
  options.shear = {};
  return options;
}
FingertipOptions depth_alone(int step) {
  FingertipOptions options = in_samples(frames().options(), step);
  options.depth_alone = true;
  return options;
}

test::Image<float> depth_of(Fingertip& tip, const Inputs& in) {
  (void)touch_of(tip, in);
  test::Image<float> out(tip.rows(), tip.cols(), 0.0F);
  const auto depth_mm = tip.depth_mm();
  for (Index i = 0; i < out.rows(); ++i) {
    for (Index j = 0; j < out.cols(); ++j) {
      out(i, j) = depth_mm(i, j);
    }
  }
  return out;
}

}  // namespace

TEST_CASE("a fingertip without stages gives the same depth and contact", "[chain]") {
  const Run whole(frames().options(), 1);
  Fingertip contact(contact_and_depth(3)), depth(depth_alone(3));
  const Inputs in = frames()[0].view();
  const auto c = contact(in.red, in.green);
  const auto d = depth(in.red, in.green);
  CHECK(c.ok());
  CHECK(d.ok());
  CHECK(c.contact.contact_px == whole.results.back().contact.contact_px);
  CHECK(d.depth.count == whole.results.back().depth.count);
  CHECK_FALSE(c.wrench.ok());
  CHECK_FALSE(c.lacks_wrench);  // nobody has asked for it
  CHECK_FALSE(c.flat_area.ok());
  CHECK(contact.dot_states().rows() == 0);
  CHECK(contact.dot_slips().rows() == 0);
}

TEST_CASE("at every pixel the depth is that of the estimator, bit for bit", "[chain]") {
  const auto options = depth_alone(1);
  Fingertip tip(options);
  const Inputs in = frames()[1].view();
  const auto found = depth_of(tip, in);
  fingerpad::DepthEstimator<float> estimate(options.camera, options.fluid, options.reference,
                                            {.window_px = options.smoothing_px});
  test::Image<float> expected(tip.rows(), tip.cols(), 0.0F);
  CHECK(estimate(in.red, in.green, expected).ok());
  bool same = true;
  for (std::size_t k = 0; k < found.cells.size(); ++k) {
    same = same && test::same_bits(found.cells[k], expected.cells[k]);
  }
  CHECK(same);
}

TEST_CASE("the flat area can be asked for without a curve", "[chain]") {
  const Run whole(frames().options(), 1);
  FingertipOptions options = contact_and_depth(3);
  options.flat_area = true;
  Fingertip tip(options);
  const auto touch = touch_of(tip, frames()[0].view());
  CHECK(test::same_bits(touch.flat_area.area_mm2, whole.results[0].flat_area.area_mm2));
}

TEST_CASE("frames of 16 bit", "[chain]") {
  Fingertip one(contact_and_depth(3)), other(contact_and_depth(3));
  const Inputs in = frames()[0].view();
  const auto times_256 = [](const auto& view) {
    return fingerpad::LazyView(view.rows(), view.cols(), [view](Index i, Index j) {
      return static_cast<std::uint16_t>(256 * view(i, j));
    });
  };
  const auto expected = one(in.red, in.green);
  const auto touch = other(times_256(in.red), times_256(in.green));
  CHECK(touch.ok());
  CHECK(touch.contact.contact_px == expected.contact.contact_px);
  CHECK(touch.contact.area_mm2 == expected.contact.area_mm2);
}

TEST_CASE("without six axes friction is that of the look-up", "[chain]") {
  auto options = frames().options();
  Fingertip tip(options);
  for (std::size_t k = 0; k < 2; ++k) {
    const Inputs in = frames()[k].view();
    const FingertipResult touch = tip(in.red, in.green, in.dots_px);
    REQUIRE(touch.normal.has_force());
    const auto load =
        fingerpad::contact_load(touch.normal.force_n, touch.shear.tangential_force_n,
                                touch.shear.moment_n_mm, tip.dots_mm(), tip.dots_in_contact());
    CHECK(touch.slip.friction == friction_of(load));
    if (k == 1) {  // rotated most
      CHECK(std::abs(touch.shear.moment_n_mm) > 0.1);
    }
  }
}

TEST_CASE("sampled frames say what whole ones do", "[chain]") {
  // rows that the samples do not fill completely
  static const PressedFrames wide(481, 642, 1);
  Fingertip every(in_samples(wide.options(), 1)), third(wide.options());
  const PressedFrame& f = wide[0];
  const auto a = touch_of(every, f.view()), b = touch_of(third, f.view());
  CHECK(b.contact.area_mm2 == Approx(a.contact.area_mm2).epsilon(0.02));
  CHECK(b.contact.depth_mm == Approx(a.contact.depth_mm).margin(0.003));
  const auto p = every.depth_mm(), q = third.depth_mm();
  const auto in_contact = every.contact_mask(), in_contact_too = third.contact_mask();
  double worst[2] = {0, 0}, differ = 0, touching = 0;
  Index unknown = 0;
  for (Index i = 0; i < p.rows(); ++i) {
    for (Index j = 0; j < p.cols(); ++j) {
      const double truth = f.depth_mm(i, j);
      if (truth == truth) {
        worst[0] = (std::max)(worst[0], std::abs(static_cast<double>(p(i, j)) - truth));
        worst[1] = (std::max)(worst[1], std::abs(static_cast<double>(q(i, j)) - truth));
        unknown += q(i, j) == q(i, j) ? 0 : 1;
      }
      touching += in_contact(i, j) != 0 ? 1 : 0;
      differ += in_contact(i, j) != in_contact_too(i, j) ? 1 : 0;
    }
  }
  CHECK(unknown == 0);
  CHECK(worst[1] < 1.1 * worst[0]);
  CHECK(differ < 0.04 * touching);
}

TEST_CASE("the least region in pixels counts whole samples", "[chain]") {
  auto options = frames().options();
  options.contact.places_edge = false;
  const Inputs in = frames()[0].view();
  Fingertip any(options);
  const Index samples = touch_of(any, in).contact.contact_px;
  REQUIRE(samples > 100);
  options.contact.min_region_px = 9 * static_cast<int>(samples);
  Fingertip just(options);
  CHECK(touch_of(just, in).contact.contact_px == samples);
  ++options.contact.min_region_px;
  Fingertip less(options);
  CHECK(touch_of(less, in).contact.contact_px == 0);
}

TEST_CASE("bad pixels leave a sampled frame as it was farther away than windows reach", "[chain]") {
  Fingertip tip(contact_and_depth(GENERATE(1, 2, 3)));
  const PressedFrame& f = frames()[0];
  (void)touch_of(tip, f.view());
  const auto shown = tip.depth_mm();
  const test::Image<float> before = [&] {
    test::Image<float> copy(shown.rows(), shown.cols());
    for (Index i = 0; i < copy.rows(); ++i) {
      for (Index j = 0; j < copy.cols(); ++j) {
        copy(i, j) = shown(i, j);
      }
    }
    return copy;
  }();
  test::Frame<std::uint8_t> bad = f.image;
  const Index row = 101, col = 133;
  for (Index k = 0; k < 9; ++k) {
    bad.red(row + k / 3, col + k % 3) = k % 2 == 0 ? std::uint8_t(255) : std::uint8_t(0);
  }
  (void)tip(bad.red, bad.green);
  const auto after = tip.depth_mm();
  bool same = true;
  double change = 0;
  for (Index i = 0; i < after.rows(); ++i) {
    for (Index j = 0; j < after.cols(); ++j) {
      const double far = (std::max)(std::abs(static_cast<double>(i - row)),
                                    std::abs(static_cast<double>(j - col)));
      same = same && (far < 24 || test::same_bits(after(i, j), before(i, j)));
      const double moved = std::abs(static_cast<double>(after(i, j) - before(i, j)));
      change = moved > change ? moved : change;
    }
  }
  CHECK(same);
  CHECK(change > 0);
  CHECK(change < 0.05);
}

TEST_CASE("what the options lack has no answer, and the rest is the same", "[chain]") {
  const Run whole(frames().options(), 1);
  auto options = frames().options();
  options.free_dots_mm = {};
  options.force_of_depth = {};
  options.shear = {};
  Fingertip tip(options);
  const FingertipResult touch = touch_of(tip, frames()[0].view());
  const FingertipResult& expected = whole.results[0];
  CHECK(touch.ok());
  CHECK(touch.contact.contact_px == expected.contact.contact_px);
  CHECK(touch.normal.has_force());
  CHECK(test::same_bits(touch.normal.force_n, expected.by_area.force_n));
  CHECK_FALSE(touch.shear.has_force());
  CHECK_FALSE(touch.wrench.ok());
  CHECK_FALSE(touch.motion.ok());
  CHECK(touch.stick.status == fingerpad::StickStatus::refused);
  CHECK(touch.slip.status == fingerpad::SlipResult<double>().status);
  CHECK(tip.dots_mm().rows() == 0);
  tip.reset();
}

namespace {

/// A pad that a plate drags, with discs of 5 px printed on it.
struct PrintedFrames {
  static constexpr int count = 24;
  PressedFrames pad{240, 320, 0};

  PressedFrame operator[](int k) const {
    PressedFrame f = pad.frame(k, count);
    for (auto* channel : {&f.image.red, &f.image.green}) {  // of the pad's own dark squares, none
      for (Index i = 0; i < channel->rows(); i += 7) {
        for (Index j = 0; j < channel->cols(); ++j) {
          const bool is_last = i + 2 >= channel->rows();
          (*channel)(i, j) = (*channel)(is_last ? i - 1 : i + 2, j);
          (*channel)((std::min)(i + 1, channel->rows() - 1), j) = (*channel)(i, j);
        }
      }
    }
    for (const Point2<double>& dot : f.dots_px.cells) {
      if (!is_finite(dot)) {
        continue;
      }
      const auto x0 = static_cast<Index>(dot.x), y0 = static_cast<Index>(dot.y);
      for (Index i = y0 - 5; i <= y0 + 6; ++i) {
        for (Index j = x0 - 5; j <= x0 + 6; ++j) {
          const double r =
              std::hypot(static_cast<double>(j) - dot.x, static_cast<double>(i) - dot.y);
          const double ink = 0.3 * std::clamp((3.5 - r) / 2, 0.0, 1.0);
          for (auto* channel : {&f.image.red, &f.image.green}) {
            std::uint8_t& cell = (*channel)(i, j);
            cell = static_cast<std::uint8_t>(std::lround((1 - ink) * static_cast<double>(cell)));
          }
        }
      }
    }
    return f;
  }
  FingertipOptions options(const PressedFrame& first) const {
    FingertipOptions o = in_samples(pad.options(), 2);
    o.dot_follower.emplace(fingerpad::mean_light(first.image.red, first.image.green), first.dots_px,
                           fingerpad::DotFollowerOptions{.radius_px = 2.5});
    return o;
  }
};

}  // namespace

TEST_CASE("a fingertip with a follower needs no dots, and says what one with dots says",
          "[chain]") {
  const PrintedFrames printed;
  const PressedFrame first = printed[0];
  const FingertipOptions options = printed.options(first);
  FingertipOptions without = options;
  without.dot_follower.reset();
  Fingertip tip(options), told(without);
  bool begins = false;
  fingerpad::Point2<double> from_mm = {0, 0};  // of either
  for (int k = 0; k < 5; ++k) {
    CAPTURE(k);
    const PressedFrame f = printed[k];
    const auto touch = tip(f.image.red, f.image.green, pressure_mpa, 0.1 * k);
    const auto expected = told(f.image.red, f.image.green, f.dots_px, pressure_mpa, 0.1 * k);
    REQUIRE(touch.dots.ok());
    CHECK(touch.dots.found == touch.dots.expected);
    CHECK_FALSE(expected.dots.ok());
    for (Index i = 0; i < f.dots_px.rows(); ++i) {
      for (Index j = 0; j < f.dots_px.cols(); ++j) {
        const auto& found = tip.dots_px()(i, j);
        CHECK((!is_finite(found) || norm(found - f.dots_px(i, j)) < 0.3));
      }
    }
    CHECK(touch.stick.status == expected.stick.status);
    const bool is_vague = 4 * touch.contact.expected_one_minus_iou() > 1;
    CHECK(is_vague == touch.contact_in_doubt);
    begins = begins || !is_vague;  // where the edge is vague, no object begins
    REQUIRE(touch.motion.has_pose() == begins);
    REQUIRE(expected.motion.has_pose() == begins);
    if (touch.motion.begun) {
      from_mm = {touch.motion.position_mm.x, expected.motion.position_mm.x};
    }
    if (begins) {
      CHECK(touch.motion.angles.z_rad == Approx(expected.motion.angles.z_rad).margin(0.002));
      CHECK(touch.motion.position_mm.x - from_mm.x ==
            Approx(expected.motion.position_mm.x - from_mm.y).margin(0.02));
    }
    CHECK(test::same_bits(touch.contact.area_mm2, expected.contact.area_mm2));
  }
  CHECK(begins);
  CHECK(told.dots_px().rows() == 0);
}

TEST_CASE("a follower that has lost the dots restarts at those that are given", "[chain]") {
  const PrintedFrames printed;
  const PressedFrame first = printed[0], other = printed[12], next = printed[13];
  Fingertip tip(printed.options(first));
  const auto status = [&](const PressedFrame& f) {
    return tip(f.image.red, f.image.green, pressure_mpa).dots.status;
  };
  using fingerpad::DotFollowerStatus;
  REQUIRE(status(first) == DotFollowerStatus::ok);
  const test::Image<std::uint8_t> black(240, 320, 0);
  CHECK(tip(black, black, pressure_mpa).dots.status == DotFollowerStatus::lost);
  CHECK(fingerpad::count_present(tip.dots_px()) == 0);
  // the print has jumped by 1 mm, two thirds of its pitch
  CHECK(tip(other.image.red, other.image.green, other.dots_px, pressure_mpa).dots.ok());
  CHECK(norm(tip.dots_px()(10, 10) - other.dots_px(10, 10)) < 0.3);
  CHECK(status(next) == DotFollowerStatus::ok);
  // where there are none, those given hold
  const auto blind = tip(black, black, next.dots_px, pressure_mpa);
  CHECK(blind.dots.status == DotFollowerStatus::lost);
  CHECK(tip.dots_px()(10, 10).x == next.dots_px(10, 10).x);
  CHECK(tip(first.image.red, first.image.green, test::Image<Point2<double>>(3, 3)).status ==
        fingerpad::FingertipStatus::refused);
  CHECK(fingerpad::name_of(DotFollowerStatus::lost) == std::string("lost"));
}

TEST_CASE("a follower of another frame or print is refused, and a frame with one allocates nothing",
          "[chain]") {
  const PrintedFrames printed;
  const PressedFrame first = printed[0], next = printed[1];
  const FingertipOptions options = printed.options(first);
  Fingertip tip(options);
  Fingertip copy = tip;
  const long before = test::allocations();
  const auto touch = tip(next.image.red, next.image.green, pressure_mpa);
  const auto again = copy(next.image.red, next.image.green, pressure_mpa);
  CHECK(test::allocations() == before);
  CHECK(touch.dots.ok());
  CHECK(test::same_bits(touch.motion.position_mm.x, again.motion.position_mm.x));

  FingertipOptions bad = options;
  bad.free_dots_mm = {};
  CHECK(test::refusal([&] { Fingertip refused(bad); }) ==
        "FingertipOptions: rows of dot_follower = 21, must be the size of free_dots_mm");
  bad = options;
  bad.dot_follower.emplace(
      fingerpad::LazyView(239, 320, [&](Index i, Index j) { return first.image.green(i, j); }),
      first.dots_px, fingerpad::DotFollowerOptions{.radius_px = 2.5});
  CHECK(test::refusal([&] { Fingertip refused(bad); }) ==
        "FingertipOptions: image_rows of dot_follower = 239, must be the size of the frame");
}

TEST_CASE("a free apex that is not that of the reference is refused", "[chain]") {
  auto options = frames().options();
  const double apex_mm = options.contact.free_apex_mm;
  const auto with = [&](double share) {
    options.contact.free_apex_mm = share * apex_mm;
    return test::refusal([&] { Fingertip tip(options); });
  };
  for (const double share : {0.96, 1.0, 1.04}) {
    CHECK(with(share) == "accepted");
  }
  for (const double share : {0.001, 0.9, 1.1, 1000.0}) {
    CHECK(with(share).find("FingertipOptions: contact.free_apex_mm = ") == 0);
    CHECK(with(share).find("within 5 % of the highest point of the reference's shape") !=
          std::string::npos);
  }
  // the same if the shape is wrong
  options.contact.free_apex_mm = apex_mm;
  for (auto& depth_mm : options.reference.depth_mm) {
    depth_mm = depth_mm * 9 / 10;
  }
  CHECK(with(1) != "accepted");
}

TEST_CASE("a fingertip takes the neighbour light off as that method does", "[chain]") {
  auto options = depth_alone(1);
  options.camera.pixel_aspect = 1.25;
  Fingertip free(options), plain(options);
  const Inputs in = frames()[1].view();
  const auto free_mm = depth_of(free, frames()[0].view());
  (void)touch_of(plain, in);
  options.neighbour_light = fingerpad::NeighbourLight<float>{.radius_px = 12};
  CHECK(test::refusal([&] { Fingertip without(options); }) ==
        "FingertipOptions: rows of free_depth_mm = 0, must be the size of the frame");
  options.free_depth_mm = fingerpad::as_view(free_mm);
  Fingertip tip(options);
  (void)touch_of(tip, in);

  // pitch of a pixel on the membrane at the pad's mean depth
  double sum = 0, count = 0;
  for (Index i = 0; i < tip.rows(); ++i) {
    for (Index j = 0; j < tip.cols(); ++j) {
      const double depth = static_cast<double>(free_mm(i, j));
      sum += depth == depth ? depth : 0;
      count += depth == depth ? 1 : 0;
    }
  }
  const double center = options.camera.center_x_px;
  const double pitch =
      point_at(options.camera, options.camera.center_y_px, center + 1, sum / count).x;
  auto light = *options.neighbour_light;
  light.pixel_aspect = 1.25F;
  fingerpad::NeighbourLightCompensation<> compensate(light, static_cast<float>(pitch), free_mm);
  test::Image<float> expected(tip.rows(), tip.cols(), 0.0F);
  CHECK(compensate(plain.depth_mm(), expected) == fingerpad::FrameStatus::ok);
  double largest = 0, moved = 0;
  bool as_many = true;
  for (Index i = 0; i < tip.rows(); ++i) {
    for (Index j = 0; j < tip.cols(); ++j) {
      const auto got = static_cast<double>(tip.depth_mm()(i, j));
      const auto wanted = static_cast<double>(expected(i, j));
      as_many = as_many && (got == got) == (wanted == wanted);
      largest = std::fmax(largest, std::abs(got - wanted));
      moved = std::fmax(moved, std::abs(got - static_cast<double>(plain.depth_mm()(i, j))));
    }
  }
  CHECK(as_many);
  CHECK(largest < 1e-5);
  CHECK(moved > 0.01);
}

TEST_CASE("a fingertip says that the neighbour light's free depth is not this pad's", "[chain]") {
  Fingertip free(depth_alone(1));
  auto in_m = depth_of(free, frames()[0].view());
  for (float& depth : in_m.cells) {
    depth /= 1000;
  }
  auto options = depth_alone(3);
  options.neighbour_light = fingerpad::NeighbourLight<float>{.radius_px = 12};
  options.free_depth_mm = fingerpad::as_view(std::as_const(in_m));
  Fingertip tip(options);
  const auto touch = touch_of(tip, frames()[1].view());
  CHECK(touch.depth.ok());
  CHECK(touch.neighbour_light == fingerpad::FrameStatus::not_of_this_pad);
  CHECK(touch.depth_in_doubt);
  CHECK(touch.status == fingerpad::FingertipStatus::partial);
}

TEST_CASE("a fingertip refuses frames and dots of another size", "[chain]") {
  Fingertip tip(frames().options());
  const Inputs in = frames()[0].view();
  const auto cut = fingerpad::region(in.red, 0, 0, in.red.rows(), in.red.cols() - 1);
  const auto few = fingerpad::region(in.dots_px, 0, 0, in.dots_px.rows() - 1, in.dots_px.cols());
  const auto refused = [&](const auto& red, const auto& green, const auto& dots) {
    const auto touch = tip(red, green, dots, in.pressure_mpa);
    return touch.status == fingerpad::FingertipStatus::refused && !touch.ok();
  };
  CHECK(refused(cut, in.green, in.dots_px));
  CHECK(refused(in.red, cut, in.dots_px));
  CHECK(refused(in.red, in.green, few));
  CHECK(touch_of(tip, in).status != fingerpad::FingertipStatus::refused);
}

namespace {

/// The pad of frames() without contact.
test::Frame<std::uint8_t> free_frame() {
  test::Pad pad;
  pad.rows = frames().options().reference.rows;
  pad.cols = frames().options().reference.cols;
  pad.camera = frames().options().camera;
  return pad.frame<std::uint8_t>(pad.free_depths(), 1, 9);
}

using Levels = test::Frame<std::uint8_t>;

Levels copy_of(const Inputs& in) {
  Levels out(in.red.rows(), in.red.cols());
  for (Index i = 0; i < out.red.rows(); ++i) {
    for (Index j = 0; j < out.red.cols(); ++j) {
      out.red(i, j) = in.red(i, j);
      out.green(i, j) = in.green(i, j);
    }
  }
  return out;
}
Levels times(Levels levels, double factor) {
  for (auto* channel : {&levels.red, &levels.green}) {
    for (std::uint8_t& level : channel->cells) {
      level = static_cast<std::uint8_t>(std::fmin(factor * level, 255));
    }
  }
  return levels;
}

}  // namespace

TEST_CASE("a fingertip says that nothing touches", "[chain]") {
  Fingertip tip(frames().options());
  const Inputs in = frames()[0].view();
  const auto free = free_frame();
  const auto touch = tip(free.red, free.green, in.dots_px, in.pressure_mpa);
  CHECK(touch.status == fingerpad::FingertipStatus::no_contact);
  CHECK(std::string(name_of(touch.status)) == "no contact");
}

TEST_CASE("a pose that may be off by more than what counts as wrong is doubtful", "[chain]") {
  for (const double noise_mm : {0.025, 0.3}) {
    FingertipOptions options = frames().options();
    options.dot_depth_noise_mm = noise_mm;
    const Run run(options);
    int poses = 0, sure = 0, turns = 0;
    for (const FingertipResult& touch : run.results) {
      poses += touch.motion.has_pose() ? 1 : 0;
      sure += touch.motion.ok() ? 1 : 0;
      turns += touch.rotation_in_doubt || touch.motion.begun ? 0 : 1;
      CHECK((touch.rotation_in_doubt || touch.motion.has_pose()));
      // where the object begins, its place is as uncertain as later, and its rotation is none
      CHECK((touch.motion.begun ? !touch.rotation_in_doubt
                                : touch.motion.ok() <= !touch.rotation_in_doubt));
    }
    CAPTURE(noise_mm, poses, sure, turns);
    CHECK(poses > 0);
    // what the dots leave over is more than the usual noise, but too little to turn the object far
    CHECK((turns > 0) == (noise_mm > 0.1));
    CHECK((sure > 0) == (noise_mm < 0.1));
  }
}

TEST_CASE("the place of a soft object is doubtful, its rotation need not be", "[chain]") {
  FingertipOptions options = frames().options();
  options.friction.soft_object = true;
  int poses = 0, sure_rotations = 0;
  for (const FingertipResult& touch : Run(options).results) {
    poses += touch.motion.has_pose() ? 1 : 0;
    sure_rotations += touch.rotation_in_doubt ? 0 : 1;
    CHECK_FALSE(touch.motion.ok());
  }
  CHECK(poses > 0);
  CHECK(sure_rotations > 0);
}

TEST_CASE("six axes from printed dots begin with a frame that touches nothing", "[chain]") {
  FingertipOptions options = frames().options();
  options.wrench.emplace();
  options.wrench->cap = {18.735, 11};
  options.wrench->modulus_n_per_mm = 0.5;
  // a force that is too uncertain for a small press tells no less of a contact
  options.wrench->full_scale_n = GENERATE(20.0, 0.001);
  const auto expected = options.wrench->full_scale_n < 1 ? fingerpad::WrenchStatus::uncertain
                                                         : fingerpad::WrenchStatus::ok;
  Fingertip tip(options);
  const Inputs in = frames()[0].view();
  const auto free = free_frame();
  const auto untouched = [&](double mpa) {
    return tip(free.red, free.green, in.dots_px, mpa).wrench;
  };
  const auto first = touch_of(tip, in);
  CHECK(first.wrench.status == fingerpad::WrenchStatus::too_few_marks);
  REQUIRE(first.contact.in_contact());
  CHECK_FALSE(first.contact_in_doubt);
  // another law's load does not stand in for the six axes
  REQUIRE(first.normal.has_force());
  CHECK(first.slip.status == fingerpad::FrictionLimitStatus::no_load);
  Fingertip by_look_up(frames().options());
  CHECK(touch_of(by_look_up, in).slip.status == fingerpad::FrictionLimitStatus::no_limit);
  CHECK(untouched(test::nan).status == fingerpad::WrenchStatus::no_pressure);
  // whatever the dots show in a free frame, it is no force
  const auto none = untouched(0.016);
  REQUIRE(none.status == expected);
  CHECK(none.marks >= 20);
  CHECK(std::fabs(none.force_n.z) < 0.02);
  CHECK(std::hypot(none.force_n.x, none.force_n.y) < 0.01);
  // the picture shows a contact, but the dots near the rim feel no press
  const auto unfelt = tip(in.red, in.green, in.dots_px, 0.016);
  CAPTURE(name_of(unfelt.wrench.status), unfelt.wrench.marks, in.pressure_mpa);
  REQUIRE(unfelt.wrench.status == expected);
  CHECK(unfelt.contact.in_contact());
  CHECK(unfelt.contact_in_doubt);
  // a ratio between all and nothing depends on which dots touch
  fingerpad::SlipResult<double> slip;
  for (const double step :
       {1.0, 2.0}) {  // half a row stays behind; the dots near the rim do not move
    const fingerpad::LazyView moved(in.dots_px.rows(), in.dots_px.cols(), [&](Index i, Index j) {
      const auto& p = in.dots_px(i, j);
      const bool inner = std::abs(i - 10) < 6 && std::abs(j - 10) < 6;
      return fingerpad::Point2<double>{p.x + (inner ? 4 * (i < 8 && j < 10 ? 1 : step) : 0), p.y};
    });
    const auto touch = tip(in.red, in.green, moved, 0.016);
    CHECK(touch.contact_in_doubt);
    slip = touch.slip;
    CAPTURE(step, slip.stick_ratio, name_of(slip.status), slip.ratio_sd);
    CHECK(slip.in_doubt == (slip.stick_ratio < 1));
  }
  CHECK(slip.stick_ratio > 0.8);  // not in doubt by itself
  CHECK(slip.stick_ratio < 1);
}

namespace {

/// Dots of a finite-element membrane before a fingertip's six axes, with noise of 0.06 px, beside a
/// printed lattice that only the free pad shows. The camera's axis is taken to lie `beside_px`
/// beside the pad's.
class FreeThenPressed {
 public:
  explicit FreeThenPressed(const char* name, double beside_px = 0)
      : scene_(*std::find_if(test::rim_scenes().begin(),
                             test::rim_scenes().end(),
                             [&](const auto& one) { return one.name == name; })),
        lattice_mm_(size * size),
        wrench(options(beside_px)) {
    const fingerpad::FreePad<double> pad(scene_.cap);
    const auto meridian = pad.meridian(free_mpa() / scene_.modulus_n_per_mm);
    for (std::size_t k = 0; k < lattice_mm_.size(); ++k) {
      const double half = size / 2;
      const double x = static_cast<double>(k % size) / half - 1;
      const double y = static_cast<double>(k / size) / half - 1;
      const double r = std::hypot(x, y);
      const auto at = static_cast<std::size_t>(r * static_cast<double>(meridian.size()));
      lattice_mm_[k] = r > 0.95 || r == 0
                           ? fingerpad::Point3<double>{test::nan, test::nan, test::nan}
                           : fingerpad::Point3<double>{meridian[at].x * x / r,
                                                       meridian[at].x * y / r, meridian[at].y};
    }
  }

  double free_mpa() const { return scene_.frames.front().pressure_mpa; }
  const std::array<double, 6>& load() const { return scene_.frames[1].load; }
  double press_n() const { return load()[2]; }

  /// Part `share` of the way from the free pad to its first press, all dots moved by `shift_px`.
  fingerpad::WrenchResult show(double share, double shift_px, bool finds_contact) {
    const auto &free = scene_.frames.front(), &pressed = scene_.frames[1];
    const auto seen = [&](const fingerpad::Point3<double>& at, double by_px) {
      const auto px = pixel_of(scene_.camera(), at);
      return fingerpad::Point2<double>{px.x + by_px + 0.06 * random_.normal(),
                                       px.y + 0.06 * random_.normal()};
    };
    std::vector<fingerpad::Mark> marks;
    for (std::size_t k = 0; k < free.dots_mm.size(); ++k) {
      const auto at = free.dots_mm[k] + share * (pressed.dots_mm[k] - free.dots_mm[k]);
      marks.push_back({.px = seen(at, shift_px + (k == 0 ? stray_px : 0)), .sd_px = 0.06});
    }
    std::vector<fingerpad::Point2<double>> lattice(size * size, {test::nan, test::nan});
    for (std::size_t k = 0; k < lattice.size() && share == 0; ++k) {
      lattice[k] = seen(lattice_mm_[k], shift_px);
    }
    const fingerpad::StridedView<const fingerpad::Point2<double>> dots(lattice.data(), size, size,
                                                                       size);
    wrench.read(dots, marks, {}, 1);
    const double mpa = free.pressure_mpa + share * (pressed.pressure_mpa - free.pressure_mpa);
    auto result = wrench(mpa);
    if (!finds_contact) {
      wrench.tare(mpa, result);
    }
    return result;
  }

 private:
  FingertipOptions options(double beside_px) {
    FingertipOptions o = frames().options();
    o.camera = scene_.camera();
    o.camera.center_x_px += beside_px;
    o.free_dots_mm = {lattice_mm_.data(), size, size, size};
    o.side_dots = static_cast<fingerpad::Index>(scene_.frames.front().dots_mm.size());
    o.wrench = test::SeenRim::options_of(scene_, true);
    o.wrench->pressure_sd_share = 0.002;
    o.wrench->full_scale_n = 4;  // dots so noisy tell no smaller press
    return o;
  }

  static constexpr fingerpad::Index size = 21;
  const test::RimScene& scene_;
  std::vector<fingerpad::Point3<double>> lattice_mm_;
  test::Random random_{7};

 public:
  static constexpr std::size_t first_dot = size * size;  // of the finite elements
  double stray_px = 0;                                   // of that dot
  fingerpad::detail::FingertipWrench wrench;
};

}  // namespace

TEST_CASE("an axis beside the camera's is seen in the free printed grid", "[chain]") {
  for (const char* name : {"bowl", "drag", "small_pad"}) {
    for (const double beside_px : {0.0, 0.5, -2.0}) {
      FreeThenPressed pad(name, beside_px);
      for (int frame = 0; frame < 16; ++frame) {
        CHECK(pad.show(0, 0, false).ok());
      }
      CAPTURE(name, beside_px, pad.wrench.axis_px.x, pad.wrench.axis_px.y);
      CHECK(std::fabs(pad.wrench.axis_px.x + beside_px) < 0.15);
      CHECK(std::fabs(pad.wrench.axis_px.y) < 0.15);
      CHECK((beside_px == 0) == (pad.wrench.axis_px.x == 0));
      const auto seen = pad.show(1, 0, true);
      REQUIRE(seen.has_force());
      const auto &f = seen.force_n, &m = seen.moment_n_mm;
      const double found[] = {f.x, f.y, f.z, m.x, m.y, m.z};
      for (std::size_t k = 0; k < 6; ++k) {
        const auto i = static_cast<Eigen::Index>(k);
        CAPTURE(k, found[k], pad.load()[k]);
        CHECK(std::fabs(found[k] - pad.load()[k]) < 4 * std::sqrt(seen.covariance(i, i)));
      }
    }
  }
}

TEST_CASE("a press that begins slowly is not taken for the free pad", "[chain]") {
  struct Case {
    double growth_sd;  // a frame
    int frames;        // 16 make the first tare
  };
  double last_sd_n = 0.02;
  for (const Case& c : {Case{0.1, 20}, Case{0.3, 20}, Case{1, 20}, Case{3, 20}, Case{0.05, 160}}) {
    FreeThenPressed pad("bowl");
    const double per_frame = c.growth_sd * last_sd_n / std::fabs(pad.press_n());
    double lost_n = 0, sd_n = 0;
    for (int frame = 0; frame < c.frames; ++frame) {
      const double share = (std::min)(per_frame * frame, 1.0);
      const auto seen = pad.show(share, 0, false);
      REQUIRE(seen.ok());
      if (frame > 0) {
        sd_n = std::sqrt(seen.covariance(2, 2));
        lost_n = seen.force_n.z - share * pad.press_n();
      }
    }
    CAPTURE(c.growth_sd, lost_n, sd_n);
    CHECK(lost_n < 4 * sd_n);
    last_sd_n = sd_n;
  }
}

TEST_CASE("later free frames move the tare a little, and say when it no longer holds", "[chain]") {
  using Status = fingerpad::WrenchStatus;
  FreeThenPressed pad("bowl");
  for (int frame = 0; frame < 30; ++frame) {
    CHECK(pad.show(0, 0, false).ok());
  }
  const auto before = pad.wrench.dots;
  const double most_mm = 4 * 0.06 * pad.wrench.camera.pitch_mm;
  const auto moved_mm = [&](std::size_t k) {
    const auto& dot = pad.wrench.dots[k];
    CHECK(dot.first.arc_mm == before[k].first.arc_mm);
    return std::fabs(dot.now.arc_mm - dot.first.arc_mm);
  };
  SECTION("a slow drift of the picture is learnt") {
    double sum_mm = 0;
    for (int frame = 0; frame < 60; ++frame) {
      (void)pad.show(0, 0.002 * frame, false);
    }
    for (std::size_t k = 0; k < before.size(); ++k) {
      sum_mm += moved_mm(k);
    }
    CHECK(sum_mm > 0);
  }
  SECTION("a dot that wanders is followed no further than four of its deviations") {
    int at_end = 0;
    for (int frame = 0; frame < 60; ++frame) {
      pad.stray_px = 0.1 * frame;
      CHECK(pad.show(0, 0, false).ok());
      const double mm = moved_mm(pad.first_dot);
      at_end += mm > 0.99 * most_mm ? 1 : 0;
      CHECK(mm < 1.001 * most_mm);
    }
    CHECK(at_end > 10);
  }
  SECTION("a picture that jumps sideways without a press is no touch") {
    for (int frame = 0; frame < 3; ++frame) {
      CHECK(pad.show(0, 0.5, false).status == (frame == 0 ? Status::ok : Status::not_tared));
    }
    const auto touched = pad.show(1, 0.5, true);
    CHECK(touched.status == Status::not_tared);
    CHECK(touched.has_force());
    // back where it was
    for (int frame = 0; frame < 4; ++frame) {
      (void)pad.show(0, 0, false);
    }
    CHECK(pad.show(0, 0, false).ok());
  }
  SECTION("a press that no region shows is a touch") {
    for (int frame = 0; frame < 5; ++frame) {
      const auto seen = pad.show(1, 0, false);
      CHECK(seen.ok());
      CHECK(std::fabs(seen.force_n.z - pad.press_n()) < 5 * std::sqrt(seen.covariance(2, 2)));
    }
  }
}

TEST_CASE("six axes from rows of dots around the rim, without a grid", "[chain]") {
  FingertipOptions options = frames().options();
  options.free_dots_mm = {};
  options.wrench.emplace();
  options.wrench->cap = {18.735, 11};
  options.wrench->modulus_n_per_mm = 0.5;
  options.wrench->loose_rim = false;  // which two rows cannot tell from a press
  options.side_dots = 144;
  const auto rows = [&](double out_px, std::size_t lost) {  // `out_px` further out than when free
    std::vector<fingerpad::Mark> dots;
    for (int k = 0; k < 144; ++k) {
      const double angle = 2 * std::numbers::pi * k / 72;
      const double rho_px = (k < 72 ? 17.2 : 15.4) / options.camera.pitch_mm + out_px;
      dots.push_back({.px = {options.camera.center_x_px + rho_px * std::cos(angle),
                             options.camera.center_y_px + rho_px * std::sin(angle)},
                      .sd_px = 0.02});
    }
    std::fill_n(dots.begin(), lost,
                fingerpad::Mark{.px = {test::nan, test::nan}, .sd_px = test::nan});
    return dots;
  };
  Fingertip tip(options);
  const auto free = free_frame();
  const auto wrench_of = [&](const std::vector<fingerpad::Mark>& dots) {
    return tip(free.red, free.green, fingerpad::StridedView<const fingerpad::Point2<double>>(),
               0.016, test::nan, dots)
        .wrench;
  };
  CHECK(wrench_of({}).status == fingerpad::WrenchStatus::too_few_marks);
  const auto none = wrench_of(rows(0, 0));
  REQUIRE(none.ok());
  CHECK(none.marks == 144);
  CHECK(norm(none.force_n) < 0.02);
  CHECK(wrench_of(rows(0, 30)).marks == 114);
  // the wall bulges: the rim tells of a press, which is not learnt as the free pad, though no
  // region of contact is seen
  const auto first = wrench_of(rows(0.3, 0)), second = wrench_of(rows(0.3, 0));
  REQUIRE(first.ok());
  CHECK(first.force_n.z < -4 * std::sqrt(first.covariance(2, 2)));
  CHECK(second.force_n.z == Approx(first.force_n.z).epsilon(1e-3));
}

TEST_CASE("mistakes with a fingertip's frames: neither an answer nor that nothing touches",
          "[chain][mistakes]") {
  struct Mistake {
    const char* name;
    Levels (*make)(Levels);
    const char* said;
  };
  const Mistake mistakes[] = {
      {"none", [](Levels f) { return f; }, "ok"},
      {"lamp off", [](Levels f) { return times(f, 0); }, "partial"},
      {"lamp 10 % darker", [](Levels f) { return times(f, 0.9); }, "partial"},
      {"lens saturated", [](Levels f) { return times(f, 9); }, "partial"},
      {"red and green exchanged",
       [](Levels f) {
         std::swap(f.red, f.green);
         return f;
       },
       "partial"},
      {"row stride without padding",
       [](Levels f) {
         const Levels from = f;
         const Index cols = f.red.cols();
         for (Index k = 0; k < f.red.rows() * cols; ++k) {
           const auto at = static_cast<std::size_t>(std::max(k - k / cols * 5, Index(0)));
           f.red.cells[static_cast<std::size_t>(k)] = from.red.cells[at];
           f.green.cells[static_cast<std::size_t>(k)] = from.green.cells[at];
         }
         return f;
       },
       "partial"},
  };
  auto options = frames().options();  // by pixels only
  options.free_dots_mm = {};
  options.force_of_depth = {};
  options.shear = {};
  Fingertip tip(options);
  Fingertip every_pixel(depth_alone(1));
  const Inputs in = frames()[0].view();
  const auto said = [&](Fingertip& one, const Levels& seen) {
    one.reset();
    const auto touch = one(seen.red, seen.green, in.dots_px, in.pressure_mpa);
    CHECK((touch.depth_in_doubt || touch.contact_in_doubt) ==
          (touch.status == fingerpad::FingertipStatus::partial));
    return std::string(name_of(touch.status));
  };
  const Levels free = free_frame();
  for (const Mistake& mistake : mistakes) {
    const Levels seen = mistake.make(copy_of(in));
    INFO(mistake.name);
    CHECK(said(tip, seen) == mistake.said);
    CHECK(said(every_pixel, seen) == mistake.said);
    if (mistake.said == std::string("partial")) {
      CHECK(said(tip, mistake.make(free)) == "partial");
    }
  }
}

namespace {

/// What has a number has its standard deviation, and what is refused has neither.
void check_numbers(const FingertipResult& r) {
  const auto known = [](auto... numbers) { return (std::isfinite(numbers) && ...); };
  const auto none = [](auto... numbers) { return (std::isnan(numbers) && ...); };
  const auto& [c, m, w] = std::tie(r.contact, r.motion, r.wrench);
  CHECK((c.ok() ? known(c.area_mm2, c.area_sd_mm2, c.pressed_mm2)
                : none(c.area_mm2, c.area_sd_mm2, c.pressed_mm2, c.center_mm.x, c.depth_mm)));
  CHECK((m.has_pose()
             ? known(m.position_mm.x, m.position_sd_mm, m.angles.z_rad, m.rotation_sd_rad)
             : none(m.position_mm.x, m.position_sd_mm, m.angles.z_rad, m.rotation_sd_rad)));
  CHECK((!r.stick.updated() || known(r.stick.stick_ratio, r.stick.ratio_sd)));
  CHECK((!r.slip.ok() || known(r.slip.ratio_sd)));
  CHECK((!r.normal.has_force() || known(r.normal.variance_n2)));
  CHECK((w.has_force() ? known(w.force_n.x, w.covariance(0, 0), w.pressure_mpa)
                       : none(w.force_n.x, w.covariance(0, 0), w.pressure_mpa)));
}

}  // namespace

TEST_CASE("a number has its standard deviation, and what is refused has none",
          "[chain][mistakes]") {
  auto options = frames().options();
  options.wrench.emplace();
  options.wrench->cap = {18.735, 11};
  const double light = GENERATE(1.0, 0.0, 0.9, 9.0);
  const auto spoil = GENERATE(
      as<void (*)(Point2<double>&)>(), [](Point2<double>&) {},
      [](Point2<double>& p) { p.x = test::nan; },
      [](Point2<double>& p) {
        p = {0, 0};
      },
      [](Point2<double>& p) {
        p = {p.y * 0.08, p.x * 0.08};
      });
  for (const double mpa : {pressure_mpa, test::nan, -0.01}) {
    Fingertip tip(options);
    for (std::size_t k = 0; k < 3; ++k) {
      const Levels seen = times(copy_of(frames()[k].view()), k == 2 ? light : 1);
      auto dots = frames()[k].dots_px;
      for (auto& dot : dots.cells) {
        k == 0 ? void() : spoil(dot);
      }
      check_numbers(tip(seen.red, seen.green, dots, mpa, 0.1 * static_cast<double>(k)));
    }
  }
}

TEST_CASE("a fingertip that has forgotten begins anew", "[chain]") {
  Fingertip tip(frames().options());
  const auto first = touch_of(tip, frames()[0].view());
  (void)touch_of(tip, frames()[1].view());
  tip.reset();
  const auto again = touch_of(tip, frames()[0].view());
  CHECK(test::same_bits(first.motion.angles.z_rad, again.motion.angles.z_rad));
  CHECK(first.stick.status == again.stick.status);
}

TEST_CASE("the whole chain: a frame allocates nothing", "[chain]") {
  FingertipOptions options = frames().options();
  options.wrench.emplace();
  Fingertip fingertip(options);
  const Inputs first = frames()[0].view(), second = frames()[1].view();
  const long before = test::allocations();
  const auto a = touch_of(fingertip, first);
  const auto b = touch_of(fingertip, second);
  (void)fingertip.depth_mm()(120, 160);
  (void)fingertip.contact_mask()(120, 160);
  CHECK(test::allocations() == before);
  CHECK(a.contact.ok());
  CHECK(b.contact.ok());
}
