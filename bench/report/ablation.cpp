// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Worth of each effect in each scene: errors with the effect switched on and off, and its cost.
// This is no google-benchmark program: it prints Markdown tables, and with --csv FILE it writes the
// same numbers to a file. The scenes are described where their frames are made:
//   images  ablation/membranes.hpp, used by ablation/depth.hpp and ablation/contact.hpp
//   dots    ablation/dots.hpp for the stick ratio, ablation/slip.hpp for the same in space and with
//           friction, ablation/motion.hpp for the motion of the object
//   forces  ablation/loads.hpp by look-up, with the shift of the contact, traction and the shape of
//           the object
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "ablation/contact.hpp"
#include "ablation/depth.hpp"
#include "ablation/dots.hpp"
#include "ablation/loads.hpp"
#include "ablation/membranes.hpp"
#include "ablation/motion.hpp"
#include "ablation/slip.hpp"
#include "ablation/table.hpp"

namespace {

using namespace bench::ablation;

void append(std::vector<Effect>& all, const std::vector<Effect>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

std::vector<Effect> image_effects() {
  const test::Pad pad = test::published_pad();
  const Seen free(pad, shapes().front(), 1);
  const Seen press(pad, shapes()[1], 2);
  DepthEffects depth(pad, free.depth_mm);
  ContactEffects contact(pad, free.depth_mm, depth.estimator());
  for (std::size_t k = 0; k < shapes().size(); ++k) {
    const Seen seen(pad, shapes()[k], k + 1);
    contact.add(seen, depth.add(seen));
  }
  auto effects = depth.effects(press);
  append(effects, contact.effects(press));
  return effects;
}

}  // namespace

int main(int argc, char** argv) {
  const bool csv = argc == 3 && std::string(argv[1]) == "--csv";
  if (argc != 1 && !csv) {
    std::fprintf(stderr, "usage: ablation [--csv FILE]\n");
    return 2;
  }
  std::vector<Effect> effects = image_effects();
  append(effects, stick_effects());
  append(effects, slip_effects());
  append(effects, motion_effects());
  append(effects, load_effects());
  std::cout << "Median of the errors, with the effect / without it:\n\n";
  print_table(std::cout, effects, 0.5);
  std::cout << "\n99th percentile, with the effect / without it:\n\n";
  print_table(std::cout, effects, 0.99);
  std::cout << '\n';
  print_missing(std::cout, effects);
  print_policies(std::cout, effects);
  if (csv) {
    std::ofstream file(argv[2]);
    print_csv(file, effects);
    if (!file) {
      std::fprintf(stderr, "%s: cannot be written\n", argv[2]);
      return 1;
    }
  }
  return 0;
}
