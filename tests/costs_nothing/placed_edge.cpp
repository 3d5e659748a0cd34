// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The placed edge of a contact: without it, pixels below the threshold touch.
#include "fingerpad/contact/contact_region.hpp"

using namespace fingerpad;
using namespace fingerpad::detail;
using Finder = EdgeFinder<AtThreshold, float>;
constexpr auto keep_all = [](const Regions::Region&) { return true; };

extern "C" Index switched_off(const Finder& finder,
                              const StridedView<const float>& depth_mm,
                              const float* statistic,
                              CurvatureMap<>& map,
                              Regions& regions) {
  Finder::Workspace none;
  return finder(depth_mm, statistic, map, keep_all, regions, none);
}

extern "C" Index without_effect(const Finder&,
                                const StridedView<const float>&,
                                const float*,
                                CurvatureMap<>&,
                                Regions& regions) {
  return regions.for_each(keep_all, [](const Regions::Region&) {});
}
