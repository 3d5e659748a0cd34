// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// All methods one after another: results that are true, the same from run to run and from one
// thread and two; stages that are off; inputs that are refused.
#include <cmath>
#include <string>
#include <vector>

#include "bench/report/chain/pressed_frames.hpp"
#include "support/catch.hpp"

using namespace chain;

namespace {

/// Small, so that a test can afford it; the contact is still wider than the ring.
const PressedFrames& frames() {
  static const PressedFrames all(240, 320, 4);
  return all;
}

template <class Methods>
class Run {
 public:
  using Chain = fingerpad::Fingertip<decltype(frames().options().reference), Methods>;

  Run() : chain_(frames().options()) {
    for (std::size_t k = 0; k < frames().size(); ++k) {
      results.push_back(touch_of(chain_, frames()[k].view()));
    }
  }
  const Chain& chain() const { return chain_; }
  std::vector<FingertipResult> results;

 private:
  Chain chain_;
};

template <class A, class B>
void check_same(const A& a, const B& b) {
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
                   ByDefault,
                   WithLeastSquares) {
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
  const Run<TestType> once, again;
  const Run<Shared<TestType>> shared;
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
struct DepthAlone : fingerpad::FingertipMethods {
  static constexpr bool has_contact = false;
};
template <class Methods>
using TipOf = fingerpad::Fingertip<decltype(frames().options().reference), Methods>;

}  // namespace

TEST_CASE("a fingertip without stages gives the same depth and contact", "[chain]") {
  const Run<fingerpad::FingertipMethods> whole;
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
  const Run<fingerpad::FingertipMethods> whole;
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

TEST_CASE("a fingertip says that nothing touches", "[chain]") {
  TipOf<fingerpad::FingertipMethods> tip(frames().options());
  const Inputs in = frames()[0].view();
  const auto dark = fingerpad::LazyView(in.image.red.rows(), in.image.red.cols(),
                                        [](Index, Index) { return std::uint8_t(0); });
  const auto touch =
      tip(fingerpad::ColorFrame(dark, dark), in.dots_px, in.side_dots_mm, in.pressure_mpa);
  CHECK(touch.status == fingerpad::FingertipStatus::no_contact);
  CHECK(std::string(name_of(touch.status)) == "no contact");
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
