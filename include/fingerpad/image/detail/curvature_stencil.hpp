// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Curvature linear in depth: what each section lacks of its center, over the radius squared.
#include <array>
#include <cstddef>
#include <vector>

#include "fingerpad/image/detail/curvature_rows.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

template <int Directions, class S>
class CurvatureKernel<RingStencil<Directions>, S> {
 public:
  static constexpr int directions = Directions;

  CurvatureKernel(const std::vector<RingOffset>& ring,
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
    V total{};
    for (const Weighted& at : section_) {
      total = total + at.weight * bend_at<V>(cells, center, at.step);
    }
    return total * (S(1) / S(Directions));
  }

  template <class V>
  [[gnu::always_inline]] PartialCurvature<V> partial(const S* cells, const V&, int least) const {
    const V center = load_cells<V, S>(cells);
    V total{};
    V count{};
    for (const Weighted& at : section_) {
      const V bend = bend_at<V>(cells, center, at.step);
      const auto complete = known<V>(bend);
      total = total + at.weight * (complete ? bend : V{});
      count = count + (complete ? whole<V>(1) : V{});
    }
    const V mean = total / count;
    const V nan = V{} + not_a_number<S>();
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

  std::array<Weighted, static_cast<std::size_t>(Directions)> section_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
