// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "bench/report/chain/pressed_frames.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"

using namespace chain;

TEMPLATE_TEST_CASE("the whole chain: a frame allocates nothing",
                   "[chain]",
                   ByDefault,
                   Shared<ByDefault>) {
  const PressedFrames frames(240, 320, 2);
  const auto options = frames.options();
  fingerpad::Fingertip<TestType> fingertip(options);
  const Inputs first = frames[0].view(), second = frames[1].view();
  const long before = test::allocations();
  const auto a = touch_of(fingertip, first);
  const auto b = touch_of(fingertip, second);
  (void)fingertip.depth_mm();
  (void)fingertip.contact_mask();
  CHECK(test::allocations() == before);
  CHECK(a.wrench.ok());
  CHECK(b.wrench.ok());
}
