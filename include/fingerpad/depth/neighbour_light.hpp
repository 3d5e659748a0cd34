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
#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/core/status.hpp"
#include "fingerpad/depth/detail/inclination_sums.hpp"
#include "fingerpad/image/detail/quick_math.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"

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

/// Refuses values out of range (parameter_error).
template <scalar S>
void expects_valid(const NeighbourLight<S>& light) {
  expects(light.radius_px >= 1 && light.radius_px <= 1000, "NeighbourLight", "radius_px",
          static_cast<long long>(light.radius_px), "in [1, 1000]");
  expects(is_finite(light.m0_mm_per_rad), "NeighbourLight", "m0_mm_per_rad", light.m0_mm_per_rad,
          "finite");
  expects(is_finite(light.n_per_mm), "NeighbourLight", "n_per_mm", light.n_per_mm, "finite");
}

namespace detail {

/// The equation for one pixel, or for each lane of a vector: the depth minus the effect of the
/// neighbours' light, at least 0. A depth of NaN or +infinity stays as it is; the reference depth
/// must be finite.
template <class V, scalar S>
[[gnu::always_inline]] inline V without_light_of(const V& depth_mm,
                                                 const V& reference_depth_mm,
                                                 const V& psi_sum_rad,
                                                 const V& m0_mm_per_rad,
                                                 const S& n_per_mm) {
  const V risen = depth_mm - reference_depth_mm;
  const V m = m0_mm_per_rad * quick_exp(V(n_per_mm * risen));
  const V compensated = depth_mm - m * psi_sum_rad;
  const V none = every_lane<V>(S(0));
  return compensated < none ? none : compensated;
}

}  // namespace detail

/// The outcome of a frame. The status is not_of_this_pad if the depths are, on average, a twentieth
/// of the reference's or less, or twenty times or more, for example because they are in m.
struct [[nodiscard]] NeighbourLightResult {
  FrameStatus status = FrameStatus::refused;
  Index lost_px = 0;  ///< pixels of the reference whose inclination this frame does not show

  bool ok() const { return status == FrameStatus::ok; }
};

/// Removes the effect of neighbouring light from depth maps, computed in the scalar S. The time
/// does not depend on r, because the disc is approximated by five nested rectangles with its area
/// and second moment. published::ExactDisc sums every pixel of the disc.
///
/// Missing pixels (not finite) are left out of the disc, and their neighbours use a one-sided
/// difference. If the reference has such a pixel, the membrane is there and was only not seen: the
/// disc's sum is scaled up to the number of pixels that the reference has in it. Elsewhere there is
/// no membrane, and nothing is added.
///
/// Threads may share one object, each with its own workspace. A frame takes bounded time and
/// allocates nothing. Frames in which pixels of the reference are missing take twice the work.
template <class Disc = detail::SteppedDisc, scalar S = float>
class NeighbourLightCompensation {
 public:
  /// Scratch memory for a frame; one per thread.
  using Workspace = typename detail::InclinationSums<Disc, S>::Workspace;

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
        sums_(light.radius_px, pitch_mm, as_view(reference_depth_mm)) {
    const auto reference = as_view(reference_depth_mm);
    for (Index i = 0; i < rows(); ++i) {
      for (Index j = 0; j < cols(); ++j) {
        const S l = S(reference(i, j));
        reference_.push_back(is_finite(l) ? l : S(0));
        m0_.push_back(is_finite(l) ? light.m0_mm_per_rad : S(0));
      }
    }
  }

  Index rows() const { return sums_.rows(); }
  Index cols() const { return sums_.cols(); }
  Workspace workspace() const { return sums_.workspace(); }

  /// Writes the compensated `depth_mm` to `out`, which may be the same grid. NaN where the input is
  /// NaN and nowhere else. A grid of another size than the reference is refused before anything is
  /// written.
  template <grid Depth, class Out>
  NeighbourLightResult operator()(const Depth& depth_mm, Out&& out, Workspace& workspace) const {
    static_assert(detail::takes_numbers<Out, S>,
                  "this grid is written to: its cells must be assignable and able to hold NaN");
    const auto from = as_view(depth_mm);
    const auto to = as_view(std::forward<Out>(out));
    if (from.rows() != rows() || from.cols() != cols() || to.rows() != rows() ||
        to.cols() != cols() || !sums_.fits(workspace)) {
      return {};
    }
    const bool is_unit = is_in_unit_of_reference(from);  // before `out`, which may be `from`
    sums_.scan(from, workspace);
    for (Index i = 0; i < rows(); ++i) {
      sums_.sum_row(i, workspace);
      S* row_mm = workspace.row_mm.data();
      compensate_row(i, detail::row_of<S>(from, i, row_mm), workspace.sum.data(), row_mm);
      detail::store_row(row_mm, to, i);
    }
    return {is_unit ? FrameStatus::ok : FrameStatus::not_of_this_pad, workspace.lost_px};
  }

 private:
  /// Whether the depths are in the unit of the reference, judged from every eighth pixel of every
  /// eighth row.
  template <class View>
  bool is_in_unit_of_reference(const View& from) const {
    S here = S(0), there = S(0);
    for (Index i = 0; i < rows(); i += 8) {
      for (Index j = 0; j < cols(); j += 8) {
        const S l = S(from(i, j));
        const S reference = reference_[static_cast<std::size_t>(i * cols() + j)];
        if (is_finite(l) && S(0) < reference) {
          here = here + l;
          there = there + reference;
        }
      }
    }
    return !(S(0) < there) || (there < S(20) * here && here < S(20) * there);
  }

  template <class View>
  static const NeighbourLight<S>& checked(const NeighbourLight<S>& light,
                                          const S& pitch_mm,
                                          const View& reference) {
    expects_valid(light);
    expects(is_finite(pitch_mm) && value(pitch_mm) > 0, "NeighbourLightCompensation", "pitch_mm",
            pitch_mm, "finite and > 0");
    expects_grid_size("NeighbourLightCompensation", reference.rows(), reference.cols());
    return light;
  }

  /// `to` may equal `depth_mm`.
  void compensate_row(Index row, const S* depth_mm, const S* psi_sum_rad, S* to) const {
    const auto span = sums_.span(row);
    const S* reference_mm = reference_.data() + row * cols();
    const S* m0_mm_per_rad = m0_.data() + row * cols();
    const auto copy = [=](Index first, Index last) {
      detail::for_each_cell<S>(last - first, [=]<class V>(Index j) {
        const V l = detail::load_cells<V, S>(depth_mm + first + j);
        const V none = detail::every_lane<V>(S(0));
        detail::store_cells<S>(to + first + j, V(l < none ? none : l));
      });
    };
    copy(0, span.first);
    constexpr int bytes = decltype(sums_)::bytes;
    const S n_per_mm = light_.n_per_mm;
    detail::for_each_cell<S, bytes>(
        span.last - span.first, [=]<class V>(Index k) __attribute__((always_inline)) {
          const Index j = span.first + k;
          const auto at = [j](const S* cells) { return detail::load_cells<V, S>(cells + j); };
          const V l = detail::without_light_of<V>(at(depth_mm), at(reference_mm), at(psi_sum_rad),
                                                  at(m0_mm_per_rad), n_per_mm);
          detail::store_cells<S>(to + j, l);
        });
    copy(span.last, cols());
  }

  NeighbourLight<S> light_;
  detail::InclinationSums<Disc, S> sums_;
  std::vector<S> reference_;  // 0 where missing
  std::vector<S> m0_;         // per pixel; 0 where the reference is missing
};

}  // namespace v0
}  // namespace fingerpad
