// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// stick_table [--each] RECORDING...: the stick ratio, by dots and friction, against the truth, by
// scene, noise and time between frames; with --each, frame by frame. A recording has
//   answer/  what replay wrote: dots.csv and frames.csv
//   truth/   dots.csv and on_object.csv, frame,row,col,x_mm,y_mm,z_mm of all dots and, in the
//            object's frame, of those in contact; forces.csv with frame, contact_area_mm2 and
//            stick_ratio, the share of the area that has not slipped since the frame before
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "answers.hpp"
#include "recording.hpp"

namespace {

using stick_table::Answers;
using stick_table::Conditions;
using stick_table::Recording;

void print(const std::string& scene, const Conditions& c, const Answers& a) {
  const auto share = [&](int count) { return a.told > 0 ? double(count) / a.told : 0.0; };
  std::printf(
      "| %-12s | %4.2f | %-3s | %2d | %5d | %5d | %.3f | %4d | %4d | %.3f | %.3f | %.2f |"
      " %.2f | %.2f |\n",
      scene.c_str(), c.noise_px, c.noise_is_given ? "yes" : "no", c.every, a.asked, a.told,
      a.mean_error(), a.missed, a.falsely, share(a.within_2_sd), share(a.within_5_sd), a.mean_sd(),
      share(a.kept), share(a.far_apart));
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: stick_table [--each] RECORDING...\n");
    return 2;
  }
  const bool each = std::string(argv[1]) == "--each";
  std::vector<Recording> recordings(argv + (each ? 2 : 1), argv + argc);
  if (each) {
    for (const Recording& r : recordings) {
      (void)answers(r, {.prints_each = true});
    }
    return 0;
  }
  std::printf(
      "| scene | noise, px | given | every | frames | told | mean error | missed | false |"
      " within 2 sd | within 5 sd | mean sd | kept | far apart |\n"
      "|---|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  const auto rows = [&](Conditions c) {
    Answers all;
    for (const Recording& r : recordings) {
      Answers of_scene;
      for (c.seed = 1; c.seed <= (c.noise_px > 0 ? 4U : 1U); ++c.seed) {
        of_scene += answers(r, c);
      }
      print(r.name, c, of_scene);
      all += of_scene;
    }
    print("**all**", c, all);
  };
  for (const bool given : {false, true}) {
    for (const double noise_px : {0.0, 0.03, 0.06, 0.12, 0.18}) {
      rows({.noise_px = noise_px, .noise_is_given = given});
    }
  }
  for (const double noise_px : {0.0, 0.06}) {
    for (const int every : {3, 5, 10}) {
      rows({.noise_px = noise_px, .every = every});
    }
  }
} catch (const std::exception& e) {
  std::fprintf(stderr, "stick_table: %s\n", e.what());
  return 1;
}
