// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The placed edge of a contact and the cleaning of its mask: what is below the threshold touches.
#include "fingerpad/contact/contact_region.hpp"

using namespace fingerpad;
using namespace fingerpad::detail;
using Finder = EdgeFinder<AtThreshold, SectionMean<>, PlatePitch, float>;

extern "C" Index switched_off(const Finder& finder,
                              const StridedView<const float>& depth_mm,
                              const float* statistic,
                              Regions& regions) {
  const NoCleaning cleaning;
  Finder::Workspace none;
  prepare(cleaning, statistic, regions);
  const auto keep = [&](const auto& region) { return keeps(cleaning, region); };
  return finder(depth_mm, statistic, keep, regions, none);
}

extern "C" Index without_effect(const Finder&,
                                const StridedView<const float>&,
                                const float*,
                                Regions& regions) {
  return regions.for_each(keep_all, [](const Regions::Region&) {});
}
