// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Which of the regions that the threshold found are contact: prepare() changes the seeds where that
// depends on all of them, keeps() judges each region.
#include "fingerpad/contact/contact_policies.hpp"
#include "fingerpad/image/detail/regions.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

constexpr auto keep_all = [](const Regions::Region&) { return true; };

template <class Cleaning, class S>
void prepare(const Cleaning&, const S*, Regions&) {}

template <class S>
void prepare(const LargestRegion&, const S*, Regions& regions) {
  Regions::Region largest;
  regions.for_each(keep_all, [&](const Regions::Region& region) {
    const bool larger = region.pixels() > largest.pixels();
    regions.set(larger ? largest : region, Mark::free);
    largest = larger ? region : largest;
  });
  regions.set(largest, Mark::seed);
}

/// `statistic` has the image's border.
template <class S>
void prepare(const Hysteresis& cleaning, const S* statistic, Regions& regions) {
  const S loose = S(cleaning.loose_per_mm);
  regions.for_each(keep_all, [&](Regions::Region& region) {
    regions.grow(region, regions.image().size(), [&](Index at) { return statistic[at] < loose; });
  });
  regions.reseed();
}

template <class Cleaning>
bool keeps(const Cleaning&, const Regions::Region&) {
  return true;
}
inline bool keeps(const WithoutSpecks& cleaning, const Regions::Region& region) {
  return region.pixels() >= cleaning.min_px;
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
