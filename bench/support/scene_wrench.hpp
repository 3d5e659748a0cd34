// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Errors of six-axis forces on finite-element membranes, from their exact shapes and side dots
// (tests/data/wrench_*). Errors are relative to the largest force of a frame's scene; a component
// that a scene lacks is not counted in it.
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "fingerpad/force/wrench.hpp"
#include "support/wrench_frames.hpp"

namespace bench {

/// The exact heights in another scalar.
template <class S>
const fingerpad::HeightMap<S>& scene_heights(const std::string& name) {
  static std::map<std::string, fingerpad::HeightMap<S>> all;
  const auto found = all.find(name);
  if (found != all.end()) {
    return found->second;
  }
  const auto& exact = test::exact_heights(name);
  fingerpad::HeightMap<S> map(S(19.5), S(0.5));
  const auto place = [&](fingerpad::Index k) { return exact.position_mm(k); };
  map.fill([&](auto i, auto j) { return S(exact(place(j), place(i)).height_mm); },
           [&](auto i, auto j, const auto&...) {
             return S(exact.in_contact(place(j), place(i)) ? 1 : 0);
           });
  return all.emplace(name, map).first->second;
}

/// Notes errors named "... on scenes" of `force_of(heights, side dots, pressure)`.
template <class S, class W>
void note_wrench_on_scenes(Counters& counters, W force_of) {
  std::vector<double> along, normal, tilting, turning;
  for (const test::WrenchFrame& f : test::wrench_frames()) {
    const auto exact = test::rows_of(f.dots, 1);
    test::Image<fingerpad::Point3<S>> dots(exact.rows(), exact.cols(), {S(0), S(0), S(0)});
    for (std::size_t k = 0; k < exact.cells.size(); ++k) {
      const auto& p = exact.cells[k];
      dots.cells[k] = {S(p.x), S(p.y), S(p.z)};
    }
    const auto r = force_of(scene_heights<S>(f.heights), dots, S(f.pressure_mpa));
    const auto add = [&](std::vector<double>& to, double error, double largest) {
      if (largest > 0.1) {
        to.push_back(r.ok() ? error / largest : std::nan(""));
      }
    };
    const auto &found = r.force_n, &turned = r.moment_n_mm;
    add(along, std::hypot(double(found.x) - f.force_n.x, double(found.y) - f.force_n.y),
        f.largest_fxy);
    add(normal, double(found.z) - f.force_n.z, f.largest_fz);
    add(tilting, std::hypot(double(turned.x) - f.moment_n_mm.x, double(turned.y) - f.moment_n_mm.y),
        f.largest_mxy);
    add(turning, double(turned.z) - f.moment_n_mm.z, f.largest_mz);
  }
  note_errors(counters, "F_xy on scenes", "of the largest", along);
  note_errors(counters, "F_z on scenes", "of the largest", normal);
  note_errors(counters, "M_xy on scenes", "of the largest", tilting);
  note_errors(counters, "M_z on scenes", "of the largest", turning);
}

}  // namespace bench
