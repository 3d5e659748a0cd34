// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// All methods in sequence: correct results that are the same from run to run and with one and two
// threads, disabled stages, and refused inputs.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/report/chain/pressed_frames.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"

using namespace chain;

namespace {

/// Small enough for a test, with a contact wider than the ring.
const PressedFrames& frames() {
  static const PressedFrames all(240, 320, 4);
  return all;
}

template <class Methods>
class Run {
 public:
  using Chain = fingerpad::Fingertip<Methods>;

  Run() : chain_(frames().options()) {
    for (std::size_t k = 0; k < frames().size(); ++k) {
      results.push_back(touch_of(chain_, frames()[k].view()));
    }
  }
  Chain& chain() { return chain_; }
  std::vector<FingertipResult> results;

 private:
  Chain chain_;
};

template <class A, class B>
void check_same(A& a, B& b) {
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
    CHECK(same(x.wrench.force_n.x, y.wrench.force_n.x));
    CHECK(same(x.wrench.moment_n_mm.z, y.wrench.moment_n_mm.z));
  }
  const auto p = a.chain().depth_mm(), q = b.chain().depth_mm();
  bool same_depth = true;
  for (Index i = 0; i < p.rows(); ++i) {
    for (Index j = 0; j < p.cols(); ++j) {
      same_depth = same_depth && test::same_bits(p(i, j), q(i, j)) &&
                   a.chain().contact_mask()(i, j) == b.chain().contact_mask()(i, j);
    }
  }
  CHECK(same_depth);
}

}  // namespace

TEMPLATE_TEST_CASE("the whole chain tells what the plate does",
                   "[chain]",
                   (InSamples<ByDefault, 2>)) {  // windows are half the default width
  const Run<TestType> run;
  const auto& first = frames()[0];
  for (std::size_t k = 0; k < run.results.size(); ++k) {
    CAPTURE(k);
    const FingertipResult& r = run.results[k];
    const PressedFrame& f = frames()[k];
    // a gap of 20 um counts as touching, and depths are averaged over 15 px
    CHECK(r.contact.area_mm2 > f.contact_area_mm2());
    CHECK(r.contact.area_mm2 == Approx(f.contact_area_mm2()).epsilon(0.25));
    CHECK(r.contact.depth_mm == Approx(13 - f.membrane.height(0)).margin(0.03));
    CHECK(r.motion.angles.z_rad == Approx(f.plate.turn_rad - first.plate.turn_rad).margin(0.0005));
    CHECK(r.wrench.ok());
    CHECK(r.wrench.force_n.z == Approx(f.wrench.force_n.z).epsilon(0.15));
    CHECK(r.wrench.force_n.x == Approx(f.wrench.force_n.x).margin(0.08));
    CHECK(r.wrench.moment_n_mm.z == Approx(f.wrench.moment_n_mm.z).margin(0.7));
    if (k > 0) {
      CHECK(r.stick.stick_ratio > 0.95);
    }
  }
}

TEMPLATE_TEST_CASE("the whole chain gives the same bits from run to run and from two threads",
                   "[chain]",
                   Lean,
                   ByDefault) {
  Run<TestType> once, again;
  Run<Shared<TestType>> shared;
  check_same(once, again);
  check_same(once, shared);
}

namespace {

struct DepthAndContact : fingerpad::FingertipMethods {
  static constexpr bool has_dots = false, has_wrench = false;
};
struct WithoutLookUp : fingerpad::FingertipMethods {
  static constexpr bool has_look_up = false;
};
struct WithoutWrench : fingerpad::FingertipMethods {
  static constexpr bool has_wrench = false;
};
struct DepthAlone : fingerpad::FingertipMethods {
  static constexpr bool has_contact = false;
};
template <int Step>
struct Sampled : DepthAndContact {
  static constexpr int sampling = Step;
};
struct EveryPixel : DepthAlone {
  static constexpr int sampling = 1;
};
struct WithLight : EveryPixel {
  static constexpr bool has_neighbour_light = true;
};
struct SampledWithLight : DepthAlone {
  static constexpr bool has_neighbour_light = true;
};
template <class Methods>
using TipOf = fingerpad::Fingertip<Methods>;

}  // namespace

TEST_CASE("a fingertip without stages gives the same depth and contact", "[chain]") {
  Run<fingerpad::FingertipMethods> whole;
  TipOf<DepthAndContact> contact(frames().options());
  TipOf<DepthAlone> depth(frames().options());
  const Inputs in = frames()[frames().size() - 1].view();
  const auto c = contact(in.image, in.dots_px, in.pressure_mpa);
  const auto d = depth(in.image, in.dots_px, in.pressure_mpa);
  CHECK(c.ok());
  CHECK(d.ok());
  CHECK(c.contact.contact_px == whole.results.back().contact.contact_px);
  CHECK(d.depth.count == whole.results.back().depth.count);
  CHECK_FALSE(c.wrench.ok());
  CHECK(sizeof(contact) < sizeof(whole.chain()) / 2);
}

TEST_CASE("without look-up no curve is needed, and the rest is the same", "[chain]") {
  Run<fingerpad::FingertipMethods> whole;
  auto options = frames().options();
  options.force_of_area = {};
  options.force_of_depth = {};
  TipOf<WithoutLookUp> tip(options);
  for (std::size_t k = 0; k < frames().size(); ++k) {
    const FingertipResult touch = touch_of(tip, frames()[k].view());
    const FingertipResult& expected = whole.results[k];
    CHECK(test::same_bits(touch.stick.stick_ratio, expected.stick.stick_ratio));
    CHECK(test::same_bits(touch.slip.stick_ratio, expected.slip.stick_ratio));
    CHECK(test::same_bits(touch.wrench.force_n.x, expected.wrench.force_n.x));
    CHECK_FALSE(touch.normal.has_force());
    CHECK(touch.status == expected.status);
  }
}

TEST_CASE("without the six-axis force friction is that of the look-up", "[chain]") {
  // The moment of a contact with uniform pressure acts at the mean distance from its middle: 2/3 of
  // the radius.
  TipOf<WithoutWrench> tip(frames().options());
  for (std::size_t k = 0; k < frames().size(); ++k) {
    const Inputs in = frames()[k].view();
    const FingertipResult touch = tip(in.image, in.dots_px, 0.0);
    REQUIRE(touch.normal.has_force());
    const double radius_mm = std::sqrt(touch.contact.area_mm2 / std::numbers::pi);
    const double load_n = std::hypot(norm(touch.shear.tangential_force_n),
                                     touch.shear.moment_n_mm / (2.0 / 3 * radius_mm));
    CHECK(touch.slip.friction == Approx(load_n / touch.normal.force_n));
    if (k == 1) {  // rotated most
      CHECK(std::abs(touch.shear.moment_n_mm) > 0.1);
    }
  }
}

TEST_CASE("samples beside the pad are not taken", "[chain]") {
  constexpr int step = 2;
  const auto reference = frames().options().reference;
  const auto pad = sampled(reference, step);
  fingerpad::detail::FrameSamples<std::uint8_t, step, 1> samples(reference);
  test::Frame<std::uint8_t> bright(reference.rows, reference.cols);
  for (auto* channel : {&bright.red, &bright.green}) {
    std::fill(channel->cells.begin(), channel->cells.end(), std::uint8_t(200));
  }
  fingerpad::detail::OneThread executor;
  const auto taken = samples(fingerpad::ColorFrame(bright.red, bright.green), executor);
  Index beside = 0;
  for (Index i = 0; i < pad.rows; ++i) {
    Index first = pad.cols, last = -1;
    for (Index j = 0; j < pad.cols; ++j) {
      first = pad.in_pad(i, j) ? std::min(first, j) : first;
      last = pad.in_pad(i, j) ? j : last;
    }
    for (Index j = 0; j < pad.cols; ++j) {
      const bool within = first <= j && j <= last;
      beside += within ? 0 : 1;
      CHECK((taken.red(i, j) > 0) == within);
      CHECK((taken.green(i, j) > 0) == within);
    }
  }
  CHECK(beside > 100);
}

TEST_CASE("sampled frames say what whole ones do", "[chain]") {
  // rows that the samples do not fill completely
  static const PressedFrames wide(481, 642, 1);
  TipOf<Sampled<1>> every(wide.options());
  TipOf<Sampled<3>> third(wide.options());
  const PressedFrame& f = wide[0];
  const Inputs in = f.view();
  const auto a = every(in.image, in.dots_px, 0.0), b = third(in.image, in.dots_px, 0.0);
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
  TipOf<Sampled<3>> any(options);
  const Index samples = any(in.image, in.dots_px, 0.0).contact.contact_px;
  REQUIRE(samples > 100);
  options.contact.min_region_px = 9 * static_cast<int>(samples);
  TipOf<Sampled<3>> just(options);
  CHECK(just(in.image, in.dots_px, 0.0).contact.contact_px == samples);
  ++options.contact.min_region_px;
  TipOf<Sampled<3>> less(options);
  CHECK(less(in.image, in.dots_px, 0.0).contact.contact_px == 0);
}

TEMPLATE_TEST_CASE("bad pixels leave a sampled frame as it was farther away than windows reach",
                   "[chain]",
                   Sampled<1>,
                   Sampled<2>,
                   Sampled<3>) {
  TipOf<TestType> tip(frames().options());
  const PressedFrame& f = frames()[0];
  const Inputs in = f.view();
  (void)tip(in.image, in.dots_px, 0.0);
  const auto shown = tip.depth_mm();
  const test::Image<float> before = [&] {
    test::Image<float> copy(shown.rows(), shown.cols());
    for (std::size_t k = 0; k < copy.cells.size(); ++k) {
      copy.cells[k] = shown.data()[k];
    }
    return copy;
  }();
  test::Frame<std::uint8_t> bad = f.image;
  const Index row = 101, col = 133;
  for (Index k = 0; k < 9; ++k) {
    bad.red(row + k / 3, col + k % 3) = k % 2 == 0 ? std::uint8_t(255) : std::uint8_t(0);
  }
  (void)tip(fingerpad::ColorFrame(bad.red, bad.green), in.dots_px, 0.0);
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
  const Run<fingerpad::FingertipMethods> whole;
  auto options = frames().options();
  options.free_dots_mm = {};
  options.rim_mm = {};
  options.force_of_depth = {};
  options.shear = {};
  TipOf<fingerpad::FingertipMethods> tip(options);
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

TEST_CASE("an unknown shift counts as none", "[chain]") {
  auto options = frames().options();
  options.free_dots_mm = {};
  auto curve = options.force_of_depth->curve();
  curve.per_mm_sq = 0.02;
  curve.per_rad_sq = 0.5;
  options.force_of_depth.emplace(curve);
  TipOf<fingerpad::FingertipMethods> tip(options);
  const FingertipResult touch = touch_of(tip, frames()[0].view());
  const auto unmoved = (*options.force_of_depth)(touch.contact.depth_mm, {0, 0}, 0.0);
  REQUIRE(unmoved.force_n > 0);
  CHECK(touch.by_depth.force_n == unmoved.force_n);
}

TEST_CASE("the size of frames has no default", "[chain]") {
  const decltype(frames().options()) options{};
  CHECK(options.rows == 0);
  CHECK(options.cols == 0);
}

TEST_CASE("a free apex that is not that of the reference is refused", "[chain]") {
  auto options = frames().options();
  const double apex_mm = options.contact.free_apex_mm;
  const auto with = [&](double share) {
    options.contact.free_apex_mm = share * apex_mm;
    return test::refusal([&] { TipOf<Sampled<3>> tip(options); });
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
  auto options = frames().options();
  options.camera.pixel_aspect = 1.25;
  TipOf<EveryPixel> free(options), plain(options);
  const Inputs in = frames()[1].view();
  (void)touch_of(free, frames()[0].view());
  (void)touch_of(plain, in);
  options.neighbour_light = fingerpad::NeighbourLight<float>{.radius_px = 12};
  CHECK(test::refusal([&] { TipOf<WithLight> without(options); }) ==
        "FingertipOptions: rows of free_depth_mm = 0, must be the size of the frame");
  options.free_depth_mm = free.depth_mm();
  TipOf<WithLight> tip(options);
  (void)touch_of(tip, in);

  // pitch of a pixel on the membrane at the pad's mean depth
  double sum = 0, count = 0;
  for (Index i = 0; i < options.rows; ++i) {
    for (Index j = 0; j < options.cols; ++j) {
      const double depth = static_cast<double>(free.depth_mm()(i, j));
      sum += depth == depth ? depth : 0;
      count += depth == depth ? 1 : 0;
    }
  }
  const double center = options.camera.center_x_px;
  const double pitch =
      point_at(options.camera, options.camera.center_y_px, center + 1, sum / count).x;
  auto light = *options.neighbour_light;
  light.pixel_aspect = 1.25F;
  fingerpad::NeighbourLightCompensation<> compensate(light, static_cast<float>(pitch),
                                                     free.depth_mm());
  test::Image<float> expected(options.rows, options.cols, 0.0F);
  CHECK(compensate(plain.depth_mm(), expected) == fingerpad::FrameStatus::ok);
  double largest = 0, moved = 0;
  bool as_many = true;
  for (Index i = 0; i < options.rows; ++i) {
    for (Index j = 0; j < options.cols; ++j) {
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

TEST_CASE("a fingertip takes as much neighbour light off samples", "[chain]") {
  auto options = frames().options();
  const auto taken_off = [&]<class Plain, class Lit>(TipOf<Plain> tip, std::type_identity<Lit>) {
    (void)touch_of(tip, frames()[0].view());
    test::Image<float> free_mm(options.rows, options.cols, 0.0F);
    const auto copy = [](const auto& from, test::Image<float>& to) {
      for (Index i = 0; i < to.rows(); ++i) {
        std::copy_n(from.row(i), to.cols(), &to(i, 0));
      }
    };
    copy(tip.depth_mm(), free_mm);
    options.neighbour_light = fingerpad::NeighbourLight<float>{.radius_px = 12};
    options.free_depth_mm = fingerpad::as_view(std::as_const(free_mm));
    TipOf<Lit> lit(options);
    CHECK(touch_of(tip, frames()[1].view()).ok());
    CHECK(touch_of(lit, frames()[1].view()).ok());
    test::Image<float> taken(options.rows, options.cols, 0.0F);
    for (Index i = 0; i < options.rows; ++i) {
      for (Index j = 0; j < options.cols; ++j) {
        taken(i, j) = tip.depth_mm()(i, j) - lit.depth_mm()(i, j);
      }
    }
    return taken;
  };
  const auto every_pixel = taken_off(TipOf<EveryPixel>(options), std::type_identity<WithLight>{});
  const auto samples =
      taken_off(TipOf<DepthAlone>(options), std::type_identity<SampledWithLight>{});
  double product = 0, taken_sq = 0, count = 0;
  for (std::size_t k = 0; k < samples.cells.size(); ++k) {
    const auto found = static_cast<double>(samples.cells[k]);
    const auto wanted = static_cast<double>(every_pixel.cells[k]);
    if (found == found && wanted == wanted) {
      product += found * wanted;
      taken_sq += wanted * wanted;
      ++count;
    }
  }
  CHECK(count > 10000);
  CHECK(taken_sq > 1e-5 * count);
  CHECK(product / taken_sq == Approx(1).margin(0.1));
}

TEST_CASE("a fingertip says that the neighbour light's free depth is not this pad's", "[chain]") {
  auto options = frames().options();
  TipOf<EveryPixel> free(options);
  (void)touch_of(free, frames()[0].view());
  test::Image<float> in_m(options.rows, options.cols, 0.0F);
  for (Index i = 0; i < options.rows; ++i) {
    for (Index j = 0; j < options.cols; ++j) {
      in_m(i, j) = free.depth_mm()(i, j) / 1000;
    }
  }
  options.neighbour_light = fingerpad::NeighbourLight<float>{.radius_px = 12};
  options.free_depth_mm = fingerpad::as_view(std::as_const(in_m));
  TipOf<SampledWithLight> tip(options);
  const auto touch = touch_of(tip, frames()[1].view());
  CHECK(touch.depth.ok());
  CHECK(touch.neighbour_light == fingerpad::FrameStatus::not_of_this_pad);
  CHECK(touch.status == fingerpad::FingertipStatus::partial);
}

TEST_CASE("a fingertip refuses frames and dots of another size", "[chain]") {
  TipOf<fingerpad::FingertipMethods> tip(frames().options());
  const Inputs in = frames()[0].view();
  const auto cut =
      fingerpad::region(in.image.red, 0, 0, in.image.red.rows(), in.image.red.cols() - 1);
  const auto few = fingerpad::region(in.dots_px, 0, 0, in.dots_px.rows() - 1, in.dots_px.cols());
  const auto refused = [&](const auto& image, const auto& dots) {
    const auto touch = tip(image, dots, in.side_dots_mm, in.pressure_mpa);
    return touch.status == fingerpad::FingertipStatus::refused && !touch.ok();
  };
  CHECK(refused(fingerpad::ColorFrame(cut, in.image.green), in.dots_px));
  CHECK(refused(fingerpad::ColorFrame(in.image.red, cut), in.dots_px));
  CHECK(refused(in.image, few));
  CHECK(touch_of(tip, in).status != fingerpad::FingertipStatus::refused);
}

namespace {

/// The pad of frames() without contact.
test::Frame<std::uint8_t> free_frame() {
  test::Pad pad;
  pad.rows = frames().options().rows;
  pad.cols = frames().options().cols;
  pad.camera = frames().options().camera;
  return pad.frame<std::uint8_t>(pad.free_depths(), 1, 9);
}

using Levels = test::Frame<std::uint8_t>;

Levels copy_of(const Inputs& in) {
  Levels out(in.image.red.rows(), in.image.red.cols());
  for (Index i = 0; i < out.red.rows(); ++i) {
    for (Index j = 0; j < out.red.cols(); ++j) {
      out.red(i, j) = in.image.red(i, j);
      out.green(i, j) = in.image.green(i, j);
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
  TipOf<fingerpad::FingertipMethods> tip(frames().options());
  const Inputs in = frames()[0].view();
  const auto free = free_frame();
  const auto touch = tip(fingerpad::ColorFrame(free.red, free.green), in.dots_px, in.side_dots_mm,
                         in.pressure_mpa);
  CHECK(touch.status == fingerpad::FingertipStatus::no_contact);
  CHECK(std::string(name_of(touch.status)) == "no contact");
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
  options.rim_mm = {};
  options.force_of_depth = {};
  options.shear = {};
  TipOf<fingerpad::FingertipMethods> tip(options);
  TipOf<EveryPixel> every_pixel(options);
  const Inputs in = frames()[0].view();
  const auto said = [&](auto& one, const Levels& seen) {
    one.reset();
    return std::string(name_of(one(fingerpad::ColorFrame(seen.red, seen.green), in.dots_px,
                                   in.side_dots_mm, in.pressure_mpa)
                                   .status));
  };
  for (const Mistake& mistake : mistakes) {
    const Levels seen = mistake.make(copy_of(in));
    INFO(mistake.name);
    CHECK(said(tip, seen) == mistake.said);
    CHECK(said(every_pixel, seen) == mistake.said);
    if (mistake.said == std::string("partial")) {
      CHECK(said(tip, mistake.make(free_frame())) == "partial");
    }
  }
}

TEST_CASE("a fingertip that has forgotten begins anew", "[chain]") {
  TipOf<fingerpad::FingertipMethods> tip(frames().options());
  const auto first = touch_of(tip, frames()[0].view());
  (void)touch_of(tip, frames()[1].view());
  tip.reset();
  const auto again = touch_of(tip, frames()[0].view());
  CHECK(test::same_bits(first.motion.angles.z_rad, again.motion.angles.z_rad));
  CHECK(first.stick.status == again.stick.status);
}
