// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// All methods one after another, as bench/report/chain puts them together: results that are true, the same
// from run to run and from one thread and two.
#include <cmath>
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

template <class Recipe, class Crew = OneThread>
class Run {
 public:
  Run() : chain_(frames().finger()) {
    for (std::size_t k = 0; k < frames().size(); ++k) {
      results.push_back(chain_(frames()[k].view()));
    }
  }
  const WholeChain<Recipe, decltype(frames().finger().reference), Crew>& chain() const {
    return chain_;
  }
  std::vector<Results> results;

 private:
  WholeChain<Recipe, decltype(frames().finger().reference), Crew> chain_;
};

template <class A, class B>
void check_same(const A& a, const B& b) {
  const auto same = [](double x, double y) { return test::same_bits(x, y); };
  for (std::size_t k = 0; k < a.results.size(); ++k) {
    const Results &x = a.results[k], &y = b.results[k];
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
                   a.chain().mask()(i, j) == b.chain().mask()(i, j);
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
    const Results& r = run.results[k];
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
      CHECK(r.stick.stick_ratio > 0.95F);
    }
  }
}

TEMPLATE_TEST_CASE("the whole chain gives the same bits from run to run and from two threads",
                   "[chain]",
                   Lean,
                   ByDefault) {
  const Run<TestType> once, again;
  const Run<TestType, TwoThreads> shared;
  check_same(once, again);
  check_same(once, shared);
}
