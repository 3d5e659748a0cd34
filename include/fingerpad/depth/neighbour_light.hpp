// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Compensation of light from the neighbouring membrane. This light brightens a pixel and so shifts
// its depth. The shift grows with the change of the inclination psi of the surrounding membrane
// since the reference frame.
// Source: Ito, Kim, Obinata, "Shape sensing by vision-based tactile sensor" (slides), compensation
// for approximation error; order of the values, names and psi corrected as in E008-E010.
//
//   psi = atan|grad l|,   psi_sum = sum over the disc of radius r of [psi(t) - psi(t0)]
//   m = m0 exp(n [l(t) - l(t0)]),   l' = max(l - m psi_sum, 0)
//
// l must be the smoothed depth: atan of the gradient of a noisy depth measures the noise.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/core/status.hpp"
#include "fingerpad/image/detail/disc_sums.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/quick_math.hpp"

namespace fingerpad {
inline namespace v0 {

/// Parameters of the neighbouring light. The defaults are the published values, in the order that
/// their units require (E008). All three are fit parameters (E009): see
/// calibrate/neighbour_light.hpp.
template <scalar S = double>
struct NeighbourLight {
  Index radius_px = 30;                   ///< r, radius of the disc, in [1, 1000]; published 1..50
  S m0_mm_per_rad = S(886) / S(1000000);  ///< m0, mm of depth per rad summed over the disc, finite
  S n_per_mm = S(224) / S(1000);          ///< n, growth of m with depth, finite
};

template <scalar S>
std::string check(const NeighbourLight<S>& light) {
  return check("NeighbourLight", {{"radius_px", light.radius_px, within(1, 1000)},
                                  {"m0_mm_per_rad", light.m0_mm_per_rad, finite_number},
                                  {"n_per_mm", light.n_per_mm, finite_number}});
}

/// The same light for samples of step x step pixels: the disc has the nearest radius, and m0 makes
/// up for its fewer pixels.
template <scalar S>
NeighbourLight<S> sampled(const NeighbourLight<S>& light, int step) {
  NeighbourLight<S> out = light;
  out.radius_px = (std::max)((light.radius_px + step / 2) / step, Index(1));
  out.m0_mm_per_rad = S(light.m0_mm_per_rad * S(detail::disc_pixels(light.radius_px)) /
                        S(detail::disc_pixels(out.radius_px)));
  return out;
}

namespace detail {

/// The equation for one pixel, or for each lane of a vector: the depth minus the effect of the
/// neighbours' light, at least 0. A depth of NaN or +infinity stays as it is; a reference of NaN
/// means that there is no such light.
template <class V, scalar S>
[[gnu::always_inline]] inline V without_light_of(const V& depth_mm,
                                                 const V& reference_depth_mm,
                                                 const V& psi_sum_rad,
                                                 const NeighbourLight<S>& light) {
  const V none = every_lane<V>(S(0));
  const V risen = depth_mm - reference_depth_mm;
  const V m = light.m0_mm_per_rad * quick_exp(V(light.n_per_mm * risen));
  const auto is_membrane = known<V>(reference_depth_mm);
  const V compensated = depth_mm - V(is_membrane ? V(m * psi_sum_rad) : none);
  return compensated < none ? none : compensated;
}

}  // namespace detail

/// Removes the effect of neighbouring light from depth maps, computed in the scalar S. Use one
/// object a thread. A frame takes O(rows cols r) and allocates nothing.
///
/// Gradients are central differences, one-sided beside a missing pixel (not finite). A pixel that
/// is missing in the frame but not in the reference is membrane that was not seen: it counts with
/// the mean change of the disc's other pixels. A pixel that is missing in the reference is not
/// membrane and adds nothing.
template <scalar S = float>
class NeighbourLightCompensation {
 public:
  /// `pitch_mm` is the distance on the membrane between the points that neighbouring pixels see,
  /// because the gradient is taken there. It is about 1 + l / h times the pitch on the plate, with
  /// h the virtual height of optics/camera.hpp. One number, for the mean depth of the pad, is
  /// enough: m0 is fitted with the same number and absorbs a common factor. `reference_depth_mm` is
  /// smoothed like the frames; NaN outside the pad. Refuses bad parameters (parameter_error).
  template <grid Reference>
  NeighbourLightCompensation(const NeighbourLight<S>& light,
                             const S& pitch_mm,
                             const Reference& reference_depth_mm)
      : light_(checked(light, pitch_mm, as_view(reference_depth_mm))),
        rows_(as_view(reference_depth_mm).rows()),
        cols_(as_view(reference_depth_mm).cols()),
        per_mm_(S(1) / pitch_mm),
        steps_per_rad_(steps_per_rad(static_cast<double>(2 * light.radius_px + 1))),
        depth_mm_(static_cast<std::size_t>((rows_ + 2) * (cols_ + 2)), not_a_number<S>()),
        psi0_(static_cast<std::size_t>(rows_ * cols_), S(0)),
        count_(psi0_),
        change_(rows_, cols_, light.radius_px),
        lost_(change_),
        row_(static_cast<std::size_t>(cols_), S(0)),
        lost_row_(row_),
        sum_(row_) {
    load(as_view(reference_depth_mm));
    reference_mm_ = depth_mm_;
    for (Index i = 0; i < rows_; ++i) {
      S* psi0 = psi0_.data() + i * cols_;
      find_psi(i, psi0);
      for (Index j = 0; j < cols_; ++j) {
        row_[static_cast<std::size_t>(j)] = S(detail::known<S>(psi0[j]) ? 1 : 0);
      }
      lost_.set(i, row_.data());
    }
    for (Index i = 0; i < rows_; ++i) {
      lost_.sum(i, S(1), count_.data() + i * cols_);
    }
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

  /// Writes the compensated `depth_mm` to `out`, which may be the same grid. NaN where the input is
  /// NaN and nowhere else. Not of this pad: the depths are, on average, a twentieth of the
  /// reference's or less, or twenty times or more, for example because they are in m. A grid of
  /// another size than the reference is refused before anything is written.
  template <grid Depth, class Out>
  [[nodiscard]] FrameStatus operator()(const Depth& depth_mm, Out&& out) {
    return each_row(depth_mm, std::forward<Out>(out), [this](Index i, const auto& from) {
      S* to = row_.data();
      const S* l = detail::row_of<S>(from, i, to);
      const S* l0 = padded_row(reference_mm_, i);
      const S* psi_sum_rad = sum_.data();
      const NeighbourLight<S> light = light_;
      detail::for_each_cell<S, lanes>(
          cols_, [=]<class V>(Index j) __attribute__((always_inline)) {
            const auto at = [j](const S* cells) { return detail::load_cells<V, S>(cells + j); };
            const V without = detail::without_light_of<V>(at(l), at(l0), at(psi_sum_rad), light);
            detail::store_cells<S>(to + j, without);
          });
      return to;
    });
  }

  /// Writes psi_sum in rad to `out`, for fits of m0 and n. Sizes and status as above.
  template <grid Depth, class Out>
  [[nodiscard]] FrameStatus inclination_sums(const Depth& depth_mm, Out&& out) {
    return each_row(depth_mm, std::forward<Out>(out),
                    [this](Index, const auto&) { return sum_.data(); });
  }

 private:
  /// Lanes of a vector; 1 unless inclination() and quick_exp() have a vector form for S.
  static constexpr int lanes = std::same_as<S, float> ? detail::row_lanes<S> : 1;
  static constexpr bool by_steps = std::same_as<S, float> || std::same_as<S, double>;

  static constexpr const char* owner = "NeighbourLightCompensation";
  template <class View>
  static const NeighbourLight<S>& checked(const NeighbourLight<S>& light,
                                          const S& pitch_mm,
                                          const View& reference) {
    require(light);
    if (const std::string text = check(owner, {{"pitch_mm", pitch_mm, positive}}); !text.empty()) {
      refuse(text);
    }
    expects_grid_size(owner, reference.rows(), reference.cols());
    return light;
  }

  /// Angles in whole steps have exact sums. A power of two, with which a square of right angles
  /// stays below the limit of DiscSums.
  static S steps_per_rad(double side_px) {
    if constexpr (by_steps) {
      const double most = detail::DiscSums<S>::limit / (1.6 * side_px * side_px);
      const double exact = 1 / static_cast<double>((std::numeric_limits<S>::epsilon)());
      return static_cast<S>((std::min)(std::exp2(std::floor(std::log2(most))), exact));
    } else {
      return S(1);
    }
  }

  /// Calls result(row, view of the depths) with sum_ computed and writes the row that it returns.
  template <class Depth, class Out, class Result>
  FrameStatus each_row(const Depth& depth_mm, Out&& out, const Result& result) {
    static_assert(detail::takes_numbers<Out, S>,
                  "this grid is written to: its cells must be assignable and able to hold NaN");
    const auto from = as_view(depth_mm);
    const auto to = as_view(std::forward<Out>(out));
    if (from.rows() != rows_ || from.cols() != cols_ || !same_size(from, to)) {
      return FrameStatus::refused;
    }
    load(from);
    is_any_lost_ = false;
    for (Index i = 0; i < rows_; ++i) {
      find_psi(i, row_.data());
      compare(i);
    }
    for (Index i = 0; i < rows_; ++i) {
      find_sum(i);
      detail::store_row(result(i, from), to, i);
    }
    return is_in_unit_of_reference() ? FrameStatus::ok : FrameStatus::not_of_this_pad;
  }

  /// First cell of a row in a map with a border of one missing cell.
  template <class Cells>
  auto* padded_row(Cells& cells, Index row) const {
    return cells.data() + (row + 1) * (cols_ + 2) + 1;
  }

  /// Sets depth_mm_: NaN where missing.
  template <class View>
  void load(const View& depth) {
    for (Index i = 0; i < rows_; ++i) {
      S* to = padded_row(depth_mm_, i);
      const S* from = detail::row_of<S>(depth, i, to);
      detail::for_each_cell<S>(cols_, [=]<class V>(Index j) {
        const V depth_mm = detail::load_cells<V, S>(from + j);
        const V nothing = depth_mm - depth_mm;  // 0, or NaN if the depth is NaN or infinite
        detail::store_cells<S>(to + j, V(depth_mm - nothing));
      });
    }
  }

  /// psi of a row in steps; NaN where missing.
  void find_psi(Index row, S* psi) const {
    const S* l = padded_row(depth_mm_, row);
    const Index next = cols_ + 2;
    const S per_mm = per_mm_, half_per_mm = per_mm_ / S(2), steps_per_rad = steps_per_rad_;
    const S missing = not_a_number<S>();
    detail::for_each_cell<S, lanes>(
        cols_, [=]<class V>(Index j) __attribute__((always_inline)) {
          const auto at = [l, j](Index k) { return detail::load_cells<V, S>(l + j + k); };
          const auto slope = [&](Index step) __attribute__((always_inline)) {
            const V none = detail::every_lane<V>(S(0)), center = at(0);
            const V after = at(step) - center, before = center - at(-step);
            const auto has_after = detail::known<V>(after), has_before = detail::known<V>(before);
            const V rise = V(has_after ? after : none) + V(has_before ? before : none);
            const auto both = has_after & has_before, any = has_after | has_before;
            const V per_step =
                both ? detail::every_lane<V>(half_per_mm) : detail::every_lane<V>(per_mm);
            return V(any ? V(rise * per_step) : detail::every_lane<V>(missing));
          };
          const V across = slope(1), down = slope(next);
          const V slope_sq = V(across * across + down * down);
          V steps = V(detail::inclination(slope_sq) * steps_per_rad);
          if constexpr (by_steps) {
            using Word = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;
            using Ints = detail::lanes<Word, detail::lanes_in<V, S>>;
            steps = detail::each_as<V>(detail::each_as<Ints>(V(steps + S(0.5))));
          }
          detail::store_cells<S>(psi + j, V(steps + (slope_sq - slope_sq)));
        });
  }

  /// Sets the row of change_, 0 where psi is missing in row_ or in the reference, and of lost_.
  void compare(Index row) {
    const S* psi0 = psi0_.data() + row * cols_;
    S* psi = row_.data();
    S* lost = lost_row_.data();
    bool is_any_lost = false;
    detail::for_each_cell<S>(cols_, [=, &is_any_lost]<class V>(Index j) {
      const V none = detail::every_lane<V>(S(0)), one = detail::every_lane<V>(S(1));
      const V before = detail::load_cells<V, S>(psi0 + j);
      const V change = detail::load_cells<V, S>(psi + j) - before;
      const auto is_seen = detail::known<V>(change);
      const V gone = is_seen ? none : V(detail::known<V>(before) ? one : none);
      detail::store_cells<S>(psi + j, V(is_seen ? change : none));
      detail::store_cells<S>(lost + j, gone);
      is_any_lost = is_any_lost || detail::any_lane(none < gone);
    });
    change_.set(row, psi);
    if (is_any_lost && !is_any_lost_) {
      lost_.clear();
      is_any_lost_ = true;
    }
    if (is_any_lost_) {
      lost_.set(row, lost);
    }
  }

  /// Sets sum_ to psi_sum of a row in rad.
  void find_sum(Index row) {
    change_.sum(row, S(S(1) / steps_per_rad_), sum_.data());
    if (is_any_lost_) {
      lost_.sum(row, S(1), lost_row_.data());
      const S* count = count_.data() + row * cols_;
      for (std::size_t j = 0; j < sum_.size(); ++j) {
        const S seen = S(count[j] - lost_row_[j]);
        if (value(seen) > 0) {
          sum_[j] = S(sum_[j] * S(count[j] / seen));
        }
      }
    }
  }

  /// Judged from every eighth pixel of every eighth row.
  bool is_in_unit_of_reference() const {
    S here = S(0), there = S(0);
    for (Index i = 0; i < rows_; i += 8) {
      for (Index j = 0; j < cols_; j += 8) {
        const S l = padded_row(depth_mm_, i)[j];
        const S reference = padded_row(reference_mm_, i)[j];
        if (is_finite(l) && S(0) < reference) {
          here = S(here + l);
          there = S(there + reference);
        }
      }
    }
    return !(S(0) < there) || (there < S(20) * here && here < S(20) * there);
  }

  NeighbourLight<S> light_;
  Index rows_, cols_;
  S per_mm_, steps_per_rad_;
  std::vector<S> depth_mm_, reference_mm_;  // NaN where missing, with a border of one cell
  std::vector<S> psi0_;                     // of the reference; NaN where missing
  std::vector<S> count_;                    // of the pixels that have psi0, in each disc
  detail::DiscSums<S> change_, lost_;       // of psi in steps; of pixels
  std::vector<S> row_, lost_row_, sum_;
  bool is_any_lost_ = false;
};

}  // namespace v0
}  // namespace fingerpad
