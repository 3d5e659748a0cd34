// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Curvature along a row, one vector of pixels at a time. Rows have a margin of NaN as wide as the
// ring, so that no bounds are tested. A missing depth makes the result of the fast pass NaN; only
// then a second pass leaves out the incomplete sections.
#include <array>
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fingerpad/image/curvature.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// True if any lane is set in `wanted` but not in `found`.
template <class Mask>
[[gnu::always_inline]] inline bool lacks(const Mask& wanted, const Mask& found) {
  if constexpr (std::same_as<Mask, bool>) {
    return wanted && !found;
  } else {
    return any_lane(Mask(wanted & ~found));
  }
}

/// Mask of the lanes that have at least `least` sections.
template <class V>
[[gnu::always_inline]] inline auto at_least(const V& sections, int least) {
  if constexpr (scalar<V>) {
    return !(sections < V(least));
  } else {
    return sections >= whole<V>(least);
  }
}

/// The curvature of a pixel from its complete sections.
template <class V>
struct PartialCurvature {
  V curvature;  ///< NaN if there are too few
  V sections;   ///< number of complete sections
};

// Kernels: what a statistic computes per pixel. `cells` points to the center pixel; `shrink` is
// that of depth_units.hpp, 1 / (1 + c l). complete() is NaN if any depth is missing; partial() uses
// the complete sections and is NaN if there are fewer than `least`.

/// Kernel of (K1). Sections of equal radius form a group and share its factors.
template <class Statistic, class S>
class SectionKernel {
 public:
  static constexpr int directions = Statistic::directions;
  static_assert(directions >= 1);

  SectionKernel(const std::vector<RingOffset>& ring, Index stride, const S& pitch, const S& per_mm)
      : scale_(S(2 * Statistic::means) * per_mm) {
    using std::sqrt;
    Index last_sq = -1;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      step_[k] = ring[k].row * stride + ring[k].col;
      if (ring[k].radius_sq() != last_sq) {
        last_sq = ring[k].radius_sq();
        const S radius_px = sqrt(S(static_cast<double>(last_sq)));
        const S radius = radius_px * pitch;
        group_[groups_++] = {radius, S(radius * radius), 0};
      }
      ++group_[groups_ - 1].sections;
    }
  }

  template <class V>
  [[gnu::always_inline]] V complete(const S* cells, const V& shrink) const {
    V total = whole<V>(0);
    const auto add = [&](const Group& group, const Index* step, const V& radius_sq)
        __attribute__((always_inline)) {
      V sum = whole<V>(0);
      for (int k = 0; k < group.sections; ++k) {
        sum = sum + weighed(section_at<V>(cells, step[k], radius_sq));
      }
      total = total + sum * group.radius;
    };
    for_each_group<V>(shrink, add);
    return total * (shrink * shrink * shrink * (scale_ / S(directions)));
  }

  template <class V>
  [[gnu::always_inline]] PartialCurvature<V> partial(const S* cells,
                                                     const V& shrink,
                                                     int least) const {
    V total = whole<V>(0);
    V count = whole<V>(0);
    const auto add = [&](const Group& group, const Index* step, const V& radius_sq)
        __attribute__((always_inline)) {
      V sum = whole<V>(0);
      for (int k = 0; k < group.sections; ++k) {
        const V term = weighed(section_at<V>(cells, step[k], radius_sq));
        const auto complete = known<V>(term);
        sum = sum + (complete ? term : whole<V>(0));
        count = count + (complete ? whole<V>(1) : whole<V>(0));
      }
      total = total + sum * group.radius;
    };
    for_each_group<V>(shrink, add);
    const V mean = total * (shrink * shrink * shrink * scale_) / count;
    const V nan = every_lane<V>(not_a_number<S>());
    return {at_least<V>(count, least) ? mean : nan, count};
  }

 private:
  struct Group {
    S radius;
    S radius_sq;
    int sections;
  };

  template <class V, class Sections>
  [[gnu::always_inline]] void for_each_group(const V& shrink, const Sections& sections) const {
    const V shrink_sq = shrink * shrink;
    const Index* step = step_.data();
    for (std::size_t g = 0; g < groups_; ++g) {
      sections(group_[g], step, V(shrink_sq * group_[g].radius_sq));
      step += group_[g].sections;
    }
  }

  template <class V>
  [[gnu::always_inline]] static Section<V> section_at(const S* cells,
                                                      Index step,
                                                      const V& radius_sq) {
    return section<V>(radius_sq, load_cells<V, S>(cells - step), load_cells<V, S>(cells),
                      load_cells<V, S>(cells + step));
  }

  template <class V>
  [[gnu::always_inline]] static V weighed(const Section<V>& k) {
    if constexpr (Statistic::clamped) {
      return not_negative<V>(k.bend) * k.inverse_root;
    } else {
      return k.bend * k.inverse_root;
    }
  }

  std::array<Index, static_cast<std::size_t>(directions)> step_{};
  std::array<Group, static_cast<std::size_t>(directions)> group_{};
  std::size_t groups_ = 0;
  S scale_;
};

// Kernel linear in depth: (2 center - before - after) / radius^2 of each section.

template <class Statistic, class S>
class StencilKernel {
 public:
  static constexpr int directions = Statistic::directions;

  StencilKernel(const std::vector<RingOffset>& ring,
                Index stride,
                const S& pitch,
                const S& per_mm) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const S radius_sq = S(static_cast<double>(ring[k].radius_sq())) * pitch * pitch;
      section_[k] = {ring[k].row * stride + ring[k].col, S(per_mm / radius_sq)};
    }
  }

  template <class V>
  [[gnu::always_inline]] V complete(const S* cells, const V&) const {
    const V center = load_cells<V, S>(cells);
    V total = whole<V>(0);
    for (const Weighted& at : section_) {
      total = total + at.weight * bend_at<V>(cells, center, at.step);
    }
    return total * (S(1) / S(directions));
  }

  template <class V>
  [[gnu::always_inline]] PartialCurvature<V> partial(const S* cells, const V&, int least) const {
    const V center = load_cells<V, S>(cells);
    V total = whole<V>(0);
    V count = whole<V>(0);
    for (const Weighted& at : section_) {
      const V bend = bend_at<V>(cells, center, at.step);
      const auto complete = known<V>(bend);
      total = total + at.weight * (complete ? bend : whole<V>(0));
      count = count + (complete ? whole<V>(1) : whole<V>(0));
    }
    const V mean = total / count;
    const V nan = every_lane<V>(not_a_number<S>());
    return {at_least<V>(count, least) ? mean : nan, count};
  }

 private:
  struct Weighted {
    Index step;
    S weight;
  };

  template <class V>
  [[gnu::always_inline]] static V bend_at(const S* cells, const V& center, Index step) {
    const V before = load_cells<V, S>(cells - step);
    const V after = load_cells<V, S>(cells + step);
    return (center - before) - (after - center);
  }

  std::array<Weighted, static_cast<std::size_t>(directions)> section_;
};

template <class Statistic, class S>
struct CurvatureKernelOf {
  using type = SectionKernel<Statistic, S>;
};
template <class Statistic, class S>
  requires(Statistic::linear)
struct CurvatureKernelOf<Statistic, S> {
  using type = StencilKernel<Statistic, S>;
};
template <class Statistic, class S>
using CurvatureKernel = typename CurvatureKernelOf<Statistic, S>::type;

/// A strip of columns, processed from top to bottom. Each vector of a row takes the fast pass
/// first, unless none of its pixels had a complete ring in the row above. Pixels that come out as
/// NaN then take the second pass. A pixel gets the same bits in either pass.
template <class Kernel, class Units, class S>
class CurvatureStrip {
  static constexpr int n = row_lanes<S>;
  using V = typename RowVector<S, n>::type;

 public:
  static constexpr Index columns = 128;  ///< these and a ring around them fit the cache

  CurvatureStrip(const Kernel& kernel, const Units& units, int least)
      : kernel_(kernel), units_(units), least_(least) {}

  /// Writes the `count` <= columns curvatures from cells[0] on, rounded up to whole vectors.
  /// Returns true if all rings were complete.
  bool row(const S* cells, Index count, S* out) {
    const bool whole = all_whole(cells, count, out);
    if (!whole) {
      mend(cells, count, out);
    }
    return whole;
  }

 private:
  bool all_whole(const S* cells, Index count, S* out) const {
    bool tried = true;
    V sum = whole<V>(0);  // NaN if any curvature is
    for (Index j = 0; j < count; j += n) {
      if (ragged_[j / n]) {
        tried = false;
      } else {
        const V k = all_sections(cells + j);
        sum = sum + k;
        store_cells<S>(out + j, k);
      }
    }
    return tried && !lacks(known<V>(whole<V>(0)), known<V>(sum));
  }

  void mend(const S* cells, Index count, S* out) {
    const V nan = every_lane<V>(not_a_number<S>());
    for (Index j = 0; j < count; j += n) {
      bool& ragged = ragged_[j / n];
      const V zeta = load_cells<V, S>(cells + j);
      const auto here = known<V>(zeta);
      V k = ragged ? nan : load_cells<V, S>(out + j);
      if (!any_lane(here)) {
        ragged = true;
      } else if (ragged || lacks(here, known<V>(k))) {
        const PartialCurvature<V> rest =
            kernel_.template partial<V>(cells + j, units_.template shrink<V>(zeta), least_);
        if (ragged && any_lane(at_least<V>(rest.sections, Kernel::directions))) {
          k = all_sections(cells + j);
        }
        const auto found = known<V>(k);
        ragged = !any_lane(found);
        k = found ? k : rest.curvature;
      }
      store_cells<S>(out + j, k);
    }
  }

  [[gnu::always_inline]] V all_sections(const S* cells) const {
    const V zeta = load_cells<V, S>(cells);
    return kernel_.template complete<V>(cells, units_.template shrink<V>(zeta));
  }

  const Kernel& kernel_;
  const Units& units_;
  int least_;
  bool ragged_[static_cast<std::size_t>(columns / n)] = {};
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
