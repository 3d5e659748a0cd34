// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Every row of the table of docs/hard_cases.md: fingerpad's form keeps its digits in float and in
// double, and the naive form loses them on the same inputs. A row in which the naive form does well
// would be no hard case.
#include <cmath>
#include <cstddef>
#include <vector>

#include "bench/report/hard_cases/all.hpp"
#include "support/catch.hpp"

namespace {

/// The naive form gives NaN or inf, or an answer where none exists.
constexpr double none = HUGE_VAL;

struct Bounds {
  hard::MakeRow make;
  double naive_float, naive_double;    ///< loses at least
  double stable_float, stable_double;  ///< at most
};

const std::vector<Bounds> depth = {
    {hard::small_depth, 0.1, 1e-10, 5e-7, 1e-15},
    {hard::small_absorption, 20, 1e-7, 5e-7, 1e-15},
    {hard::equal_absorption, none, none, 1e-4, 1e-12},
    {hard::grazing_rays, 0.2, 2e-8, 1.2e-6, 2.5e-15},
    {hard::first_halving, 25, 25, 1e-5, 2e-14},
    {hard::no_depth, none, none, 0, 0},
    {hard::saturated_pixels, 1, 1, 1e-5, 1e-12},
    {hard::scattering_at_rim, none, none, 1e-6, 1e-12},
};
const std::vector<Bounds> surface = {
    {hard::flat_section, 2e-7, 3e-16, 1e-10, 2e-19},
    {hard::flat_contact, none, none, 1e-9, 2e-18},
    {hard::center_pixel, none, none, 1e-5, 2e-14},
};
const std::vector<Bounds> motion = {
    {hard::gimbal_lock, none, none, 8e-6, 1e-14},
    {hard::small_angle, 5e-5, 1e-9, 3e-7, 6e-16},
};
const std::vector<Bounds> membrane = {
    {hard::thin_triangle, 0.5, 0.5, 3e-7, 6e-16},
};
const std::vector<Bounds> stick = {
    {hard::half_a_turn, 1, 1, 5e-7, 1e-15},
    {hard::plain_press, none, none, 3e-6, 3e-15},
    {hard::nothing_moved, none, none, 0, 0},
};
const std::vector<Bounds> foam = {
    {hard::long_times, none, none, 1.2e-6, 2.6e-15},
    {hard::short_step, 0.5, 1e-5, 2e-7, 5e-16},
    {hard::no_load, none, none, 2e-6, 2e-15},
};
const std::vector<Bounds> look_up = {
    {hard::no_area, none, none, 3e-7, 1e-15},
    {hard::below_range, 2, 2, 0, 0},
};
const std::vector<Bounds> sums = {
    {hard::long_image, 5e-5, 1e-13, 1.2e-7, 1.1e-11},
    {hard::small_vibration, none, 1e-9, 1e-6, 2e-15},
};

void check(const std::vector<Bounds>& rows) {
  for (const Bounds& b : rows) {
    const hard::Row row = b.make();
    INFO(hard::line_of(row));
    CHECK(row.in_float.naive.loss() >= b.naive_float);
    CHECK(row.in_double.naive.loss() >= b.naive_double);
    CHECK(row.in_float.stable.loss() <= b.stable_float);
    CHECK(row.in_double.stable.loss() <= b.stable_double);
    // a refusal is no answer: some answers must remain, unless no input has one
    const hard::Tally& answers = row.in_double.stable;
    CHECK((answers.refused < answers.cases || b.stable_double == 0));
  }
}

}  // namespace

TEST_CASE("every row of the page of hard cases has bounds", "[naive]") {
  const std::vector<hard::MakeRow> page = hard::all_rows();
  std::vector<hard::MakeRow> bounded;
  for (const auto& rows : {depth, surface, motion, membrane, stick, foam, look_up, sums}) {
    for (const Bounds& b : rows) {
      bounded.push_back(b.make);
    }
  }
  CHECK(bounded == page);
}

TEST_CASE("naive forms of depth and optics lose what the stable ones keep", "[naive]") {
  check(depth);
}
TEST_CASE("naive forms of surfaces and places lose what the stable ones keep", "[naive]") {
  check(surface);
}
TEST_CASE("naive forms of rotations lose what the stable ones keep", "[naive]") {
  check(motion);
}
TEST_CASE("naive forms of the membrane's balance lose what the stable ones keep", "[naive]") {
  check(membrane);
}
TEST_CASE("naive forms of the dots' motion lose what the stable ones keep", "[naive]") {
  check(stick);
}
TEST_CASE("naive forms of the foam's oscillator lose what the stable ones keep", "[naive]") {
  check(foam);
}
TEST_CASE("naive forms of forces by look-up lose what the stable ones keep", "[naive]") {
  check(look_up);
}
TEST_CASE("naive forms of running sums lose what the stable ones keep", "[naive]") {
  check(sums);
}
