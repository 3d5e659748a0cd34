// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Figures 14 to 16 of the look-up paper by steps of finite-element scenes: a plate dragged to slip
// and back (force, stick ratio), and a plate turned to slip (moment).
#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

#include "look_up.hpp"
#include "slippage.hpp"
#include "table.hpp"

namespace bench::papers {

/// The ratio of each step, with the sign of no answer where there is none.
template <class Ratio>
std::vector<std::string> ratios_by_step(Ratio stick, const test::StickScene& scene) {
  test::Random random(1);
  std::vector<std::string> ratios;
  for (fingerpad::Index k = 0; k < scene.steps(); ++k) {
    const auto r = stick(noisy(scene.dots(k), jitter_px, random), scene.contact(k));
    ratios.push_back(r.updated() ? number(static_cast<double>(r.stick_ratio)) : "none");
  }
  return ratios;
}

inline void print_courses(std::ostream& out) {
  using test::ContactDotsOf;
  constexpr auto area = test::ContactMeasure::area;
  const ShearErrors published_n = tangential({"drag"}, "drag", area, ContactDotsOf::center, 0.65);
  const ShearErrors ours_n = tangential({"mix"}, "drag", area, ContactDotsOf::edge, {});
  const ShearErrors published_n_mm = moment({"twist"}, "twist", area, ContactDotsOf::center, 1.7);
  const ShearErrors ours_n_mm = moment({"mix"}, "twist", area, ContactDotsOf::edge, {});
  const test::StickScene scene("drag");
  const auto published_ratio = ratios_by_step(printed_ratio(2), scene);
  const auto ratio = ratios_by_step(default_ratio(2), scene);
  const auto dragged = test::contact_records({"drag"}), turned = test::contact_records({"twist"});

  out << "### The courses of Figs. 14 to 16 [F]\n\n"
         "| Central dot, mm | Force, N: true | published | default | Stick ratio: true | published "
         "| "
         "default | Angle, rad | Moment, N mm: true | published | default |\n"
         "|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";
  constexpr std::size_t drag_steps[] = {6, 8, 10, 12, 16, 24, 28, 32, 36};
  std::size_t turn = 4;
  for (const std::size_t step : drag_steps) {
    const std::size_t at = step - 1, by = ++turn - 1;  // records begin with step 1, frames with 0
    const auto cell = [&](const std::string& text) { out << "| " << text << ' '; };
    cell(number(signed_length(dragged[at].central_mm)));
    cell(number(published_n.truth[at]));
    cell(number(published_n.found[at]));
    cell(number(ours_n.found[at]));
    cell(number(scene.stick_ratio(static_cast<fingerpad::Index>(step))));
    cell(published_ratio[step]);
    cell(ratio[step]);
    cell(number(turned[by].contact_rad));
    cell(number(published_n_mm.truth[by]));
    cell(number(published_n_mm.found[by]));
    cell(number(ours_n_mm.found[by]));
    out << "|\n";
  }
  out << '\n';
}

}  // namespace bench::papers
