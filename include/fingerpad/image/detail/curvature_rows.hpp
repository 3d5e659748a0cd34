// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The ring of a curvature map, and the mean curvature of its sections, a vector of pixels at a time
// in one pass. Rows have a margin of NaN as wide as the ring, so that no bounds are tested.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/quick_math.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The integer n as a scalar, or in every lane of a vector.
template <class V>
[[gnu::always_inline]] inline V whole(int n) {
  if constexpr (scalar<V>) {
    return V(n);
  } else {
    return V{} + static_cast<std::remove_cvref_t<decltype(V{}[0])>>(n);
  }
}

/// (K1) of curvature.hpp over 2 r, for scalars and vectors.
template <class V>
[[gnu::always_inline]] inline V section(const V& radius_sq,
                                        const V& before,
                                        const V& center,
                                        const V& after) {
  const V a = center - before;
  const V b = after - center;
  const V rise = after - before;
  const V ends = (radius_sq + a * a) * (radius_sq + b * b);
  const V twice = radius_sq + radius_sq;
  return (a - b) * inverse_sqrt<V>(ends * (twice + twice + rise * rise));
}

/// One end of a section as an offset from the center pixel; the other end is its negative.
struct RingOffset {
  Index row;
  Index col;

  /// Squared distance in widths of a pixel, which is `aspect` widths high.
  constexpr double distance_sq(double aspect = 1) const {
    return static_cast<double>(col * col) + aspect * aspect * static_cast<double>(row * row);
  }
  friend constexpr bool operator==(const RingOffset&, const RingOffset&) = default;
};

/// One end of each section in the directions pi k / directions, sorted from shortest to longest.
/// For pixels `aspect` times as high as wide; the radius is in widths. The set is its own mirror
/// image and, for square pixels and an even number of directions, stays the same under exchange of
/// rows and columns: ties round toward the center, whatever the rounding of sine and cosine.
inline std::vector<RingOffset> ring_offsets(double radius_px, int directions, double aspect = 1) {
  const auto nearest = [](double px) { return static_cast<Index>(std::ceil(px - 0.5 - 1e-9)); };
  std::vector<RingOffset> offsets;
  for (int k = 0; k < directions; ++k) {
    const double angle = std::numbers::pi * k / directions, along = std::cos(angle);
    const Index col = nearest(radius_px * std::abs(along));
    offsets.push_back({nearest(radius_px * std::sin(angle) / aspect), along < 0 ? -col : col});
  }
  std::stable_sort(offsets.begin(), offsets.end(), [&](const RingOffset& a, const RingOffset& b) {
    return a.distance_sq(aspect) < b.distance_sq(aspect);
  });
  return offsets;
}

/// A count in every lane of V.
template <class V>
struct LaneCount {
  using type = int;
};
template <class V>
  requires(!scalar<V>)
struct LaneCount<V> {
  using type = decltype(V{} == V{});
};
template <class V>
using lane_count = typename LaneCount<V>::type;

/// The counts, one higher where x is not NaN.
template <class V>
[[gnu::always_inline]] inline lane_count<V> plus_known(const lane_count<V>& count, const V& x) {
  if constexpr (scalar<V>) {
    return count + (known<V>(x) ? 1 : 0);
  } else {
    return count - (x == x);  // true is -1
  }
}
template <class V>
Index sum_of(const lane_count<V>& count) {
  if constexpr (scalar<V>) {
    return count;
  } else {
    Index sum = 0;
    for (int k = 0; k < lanes_in<V, std::remove_cvref_t<decltype(V{}[0])>>; ++k) {
      sum += count[k];
    }
    return sum;
  }
}

/// The sections of a ring. Those of equal length form a group and share its factors.
template <scalar S>
class RingSections {
 public:
  RingSections() = default;
  RingSections(const std::vector<RingOffset>& ring,
               Index stride,
               const S& pitch_mm,
               double aspect) {
    using std::sqrt;
    double last_sq = 0;
    for (const RingOffset& end : ring) {
      steps_.push_back(end.row * stride + end.col);
      const double distance_sq = end.distance_sq(aspect);
      if (distance_sq != last_sq) {
        last_sq = distance_sq;
        const S radius = sqrt(S(distance_sq)) * pitch_mm;
        groups_.push_back({S(2) * radius, radius * radius, 0});
      }
      ++groups_.back().sections;
    }
  }

  /// Mean curvature of the complete sections through the pixels from cells[0] on, in 1/mm; NaN
  /// where fewer than `least` are complete. `Clamped`: negative curvatures count as 0. `shrink` is
  /// 1 / (1 + c l), see curvature.hpp.
  template <bool Clamped, class V>
  [[gnu::always_inline]] V mean(const S* cells, const V& shrink, int least) const {
    const V center = load_cells<V, S>(cells);
    const V shrink_sq = shrink * shrink;
    V total = whole<V>(0);
    lane_count<V> complete{};
    const Index* step = steps_.data();
    for (const Group& group : groups_) {
      const V radius_sq = shrink_sq * group.radius_sq;
      V sum = whole<V>(0);
      for (int k = 0; k < group.sections; ++k, ++step) {
        const V term = section<V>(radius_sq, load_cells<V, S>(cells - *step), center,
                                  load_cells<V, S>(cells + *step));
        complete = plus_known<V>(complete, term);
        if constexpr (scalar<V>) {
          sum = known<V>(term) && (!Clamped || value(term) > 0) ? sum + term : sum;
        } else {
          sum = sum + ((Clamped ? term > whole<V>(0) : term == term) ? term : whole<V>(0));
        }
      }
      total = total + sum * group.twice_radius;
    }
    const V mean = total * (shrink_sq * shrink) / each_as<V>(complete);
    const V nan = every_lane<V>(not_a_number<S>());
    if constexpr (scalar<V>) {
      return complete >= least ? mean : nan;
    } else {
      return complete >= whole<lane_count<V>>(least) ? mean : nan;
    }
  }

 private:
  struct Group {
    S twice_radius;
    S radius_sq;
    int sections;
  };

  std::vector<Index> steps_;
  std::vector<Group> groups_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
