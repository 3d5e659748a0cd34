// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "bench/report/chain/pressed_frames.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"

using namespace chain;

TEST_CASE("the whole chain: a frame allocates nothing", "[chain]") {
  const PressedFrames frames(240, 320, 2);
  FingertipOptions options = frames.options();
  options.wrench.emplace();
  Fingertip fingertip(options);
  const Inputs first = frames[0].view(), second = frames[1].view();
  const long before = test::allocations();
  const auto a = touch_of(fingertip, first);
  const auto b = touch_of(fingertip, second);
  (void)fingertip.depth_mm()(120, 160);
  (void)fingertip.contact_mask()(120, 160);
  CHECK(test::allocations() == before);
  CHECK(a.contact.ok());
  CHECK(b.contact.ok());
}
