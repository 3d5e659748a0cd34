// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "bench/report/chain/pressed_frames.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"

using namespace chain;

TEMPLATE_TEST_CASE("the whole chain: a frame allocates nothing", "[chain]", OneThread, TwoThreads) {
  const PressedFrames frames(240, 320, 2);
  const auto finger = frames.finger();
  WholeChain<ByDefault, decltype(finger.reference), TestType> chain(finger);
  const Frame first = frames[0].view(), second = frames[1].view();
  const long before = test::allocations();
  const auto a = chain(first);
  const auto b = chain(second);
  CHECK(test::allocations() == before);
  CHECK(a.wrench.accepted);
  CHECK(b.wrench.accepted);
}
