// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/contact_slide.hpp"

#include <vector>

#include "fingerpad/contact/contact_by_difference.hpp"
#include "fingerpad/depth/intensity_depth.hpp"
#include "fingerpad/slip/recoil.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/gel_frames.hpp"

using namespace fingerpad;

TEST_CASE("contact by difference, slide and recoil: a frame allocates nothing",
          "[contact_by_difference][contact_slide][recoil]") {
  const test::GelCamera camera;
  test::Random random(5);
  GelContact<> contact(GelPad{});
  const std::vector free = {camera.frame(contact, random)};
  const ContactByDifference<> region(free);
  auto workspace = region.workspace();
  const auto cells = workspace.difference();
  const auto home = camera.dots(contact, random);
  const ContactSlide<> slide(cells.rows(), cells.cols(), home.rows(), home.cols());
  auto state = slide.start();
  const Recoil<> recoil(home);
  auto recoil_state = recoil.start();
  test::Image<std::uint8_t> mask(camera.rows, camera.cols);
  for (int frame = 0; frame < 5; ++frame) {
    contact.drag(0.5 + 0.1 * frame, {0.5 * frame, 0.1 * frame});
    const auto image = camera.frame(contact, random);
    const auto dots = camera.dots(contact, random);
    const long before = test::allocations();
    const ContactResult found = region(image, mask, workspace);
    const auto slid = slide(workspace.imprint(), workspace.contact(), dots, state);
    const auto sprung = recoil(dots, recoil_state);
    const long after = test::allocations();
    CHECK(before > 0);
    CHECK(found.in_contact());
    CHECK(slid.ok());
    CHECK(sprung.ok());
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
  CHECK(result.valid_px == 2000);
  CHECK(after == before);
}
