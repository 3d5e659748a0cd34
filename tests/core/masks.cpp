// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Contact masks, which every method reads in the same way.
#include <limits>
#include <string>
#include <vector>

#include "fingerpad/contact/surface.hpp"
#include "fingerpad/dots/spatial_dots.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

static_assert(contact_mask<Image<unsigned char>> && contact_mask<Image<float>> &&
              contact_mask<Image<Touch>>);
static_assert(!contact_mask<Image<std::string>> && !contact_mask<int>);

TEST_CASE("a cell says contact by being anything but nothing") {
  CHECK(is_contact(255));
  CHECK(is_contact(true));
  CHECK(is_contact(static_cast<signed char>(-1)));
  CHECK(is_contact(-0.5F));
  CHECK_FALSE(is_contact(0));
  CHECK_FALSE(is_contact(false));
  CHECK_FALSE(is_contact(-0.0));
  CHECK_FALSE(is_contact(std::numeric_limits<double>::quiet_NaN()));
}

TEST_CASE("what is unknown is no contact, for any method") {
  CHECK(is_contact(Touch::contact));
  CHECK_FALSE(is_contact(Touch::unknown));
  CHECK_FALSE(is_contact(Touch::none));

  // Three pixels in a row: contact, unknown, none.
  Image<Touch> mask(1, 3, Touch::none);
  mask(0, 0) = Touch::contact;
  mask(0, 1) = Touch::unknown;
  Image<Point2<double>> dots(1, 3);
  for (Index j = 0; j < 3; ++j) {
    dots(0, j) = {static_cast<double>(j), 0};
  }
  Image<unsigned char> in_contact(1, 3, 7);
  REQUIRE(contact_at_dots(dots, mask, in_contact));
  CHECK(in_contact.cells == std::vector<unsigned char>{1, 0, 0});

  Image<Touch> patch(20, 30, Touch::unknown);
  for (Index i = 4; i < 16; ++i) {
    for (Index j = 5; j < 20; ++j) {
      patch(i, j) = Touch::contact;
    }
  }
  const Image<float> depth(20, 30, 9.0F);
  CHECK(fit_surface(OrthographicCamera<double>(), depth, patch).pixels == 12 * 15);
}
