// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <array>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/intensity_depth.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/gel_frames.hpp"

using namespace fingerpad;

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
    CHECK(is_finite(slid.recoil));
    CHECK(after == before);
  }
}

TEST_CASE("intensity depth: a frame allocates nothing", "[intensity_depth]") {
  const test::Image<std::uint8_t> free(40, 50, 140);
  const test::Image<std::uint8_t> now(40, 50, 120);
  test::Image<float> depth(40, 50);
  IntensityDepth<> pressed(free, {});
  const long before = test::allocations();
  const auto result = pressed(now, depth);
  const long after = test::allocations();
  CHECK(result == FrameStatus::not_of_this_pad);
  CHECK(after == before);
}
