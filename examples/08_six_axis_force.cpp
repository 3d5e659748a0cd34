// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Computes six-axis force and moment from the pixels of printed dots near the rim and the fluid's
// pressure. The membrane of this program is inflated, then leaned, dragged and twisted at its rim.
#include <cmath>
#include <cstdio>
#include <vector>

#include "fingerpad/force/wrench.hpp"

int main() {
  const fingerpad::Camera<double> camera;
  const fingerpad::WrenchOptions options{.cap = {.base_radius_mm = 18, .height_mm = 11},
                                         .modulus_n_per_mm = 0.5};
  const double free_mpa = 0.016, pressed_mpa = 0.019;

  // The truth: how the membrane leaves the rim, as harmonics of its three directions.
  fingerpad::Annulus<double> membrane(options.cap, {.reach_mm = 9, .offset_harmonics = -1});
  std::vector<double> rim(membrane.parameters(), 0.0);
  const auto seen = [&] {
    std::vector<fingerpad::Point2<double>> px;
    membrane.march(rim);
    for (int k = 0; k < 150; ++k) {
      const auto place = membrane.place(1 + k % 7, 2.4 * k);
      px.push_back(pixel_of(camera, membrane.at(place)));
    }
    return px;
  };
  const auto free = fingerpad::FreePad<double>(options.cap).rim(free_mpa / 0.5);
  rim[0] = free->stretch * std::cos(free->slope_rad);
  rim[2 * membrane.terms()] = free->stretch * std::sin(free->slope_rad);
  rim.back() = free_mpa / 0.5;
  const auto free_px = seen();
  rim[1] += 0.05;                     // dragged along x
  rim[membrane.terms()] += 0.03;      // twisted
  rim[2 * membrane.terms()] -= 0.02;  // pressed
  rim.back() = pressed_mpa / 0.5;
  const auto px = seen();
  const auto truth = membrane.load_at_rim();

  fingerpad::Wrench<> wrench(camera, options);  // once
  (void)wrench.begin(free_mpa);                 // a picture of the free pad
  std::vector<fingerpad::Mark> marks;
  for (std::size_t k = 0; k < free_px.size(); ++k) {
    if (auto mark = wrench.place_in_free_picture(free_px[k])) {
      mark->px = px[k];
      marks.push_back(*mark);
    }
  }
  const auto felt = wrench(marks, pressed_mpa);  // every frame

  const auto f = 0.5 * truth.force, m = 0.5 * truth.moment;
  std::printf("%s, %d dots: force (%.3f, %.3f, %.3f) N, moment (%.2f, %.2f, %.2f) N mm\n",
              name_of(felt.status), static_cast<int>(felt.marks), felt.force_n.x, felt.force_n.y,
              felt.force_n.z, felt.moment_n_mm.x, felt.moment_n_mm.y, felt.moment_n_mm.z);
  std::printf("true: force (%.3f, %.3f, %.3f) N, moment (%.2f, %.2f, %.2f) N mm\n", f.x, f.y, f.z,
              m.x, m.y, m.z);
  return felt.ok() && norm(felt.force_n - f) < 0.02 * norm(f) ? 0 : 1;
}
