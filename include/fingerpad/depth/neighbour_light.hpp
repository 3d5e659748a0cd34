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
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/quick_math.hpp"

namespace fingerpad {
inline namespace v1 {

/// Parameters of the neighbouring light. The defaults are the published values, in the order that
/// their units require (E008). r, m0 and n are fit parameters (E009): see
/// calibrate/neighbour_light.hpp.
template <scalar S = double>
struct NeighbourLight {
  Index radius_px = 30;  ///< r, radius of the disc in widths of a pixel, in [1, 1000]
  S m0_mm_per_rad = S(886) / S(1000000);  ///< m0, mm of depth per rad summed over the disc, finite
  S n_per_mm = S(224) / S(1000);          ///< n, growth of m with depth, finite
  S pixel_aspect = S(1);  ///< height of a pixel over its width, as of the camera, in [0.1, 10]
};

template <scalar S>
std::string check(const NeighbourLight<S>& light) {
  return check("NeighbourLight", {{"radius_px", light.radius_px, within(1, 1000)},
                                  {"m0_mm_per_rad", light.m0_mm_per_rad, finite_number},
                                  {"n_per_mm", light.n_per_mm, finite_number},
                                  {"pixel_aspect", light.pixel_aspect, within(0.1, 10)}});
}

namespace detail {

/// Half widths of a disc in its middle row, the next one and so on: the largest w with
/// w^2 + (pixel_aspect row)^2 <= radius^2, in widths of a pixel.
template <scalar S>
std::vector<Index> disc_half_widths(const NeighbourLight<S>& light) {
  const double radius_sq = static_cast<double>(light.radius_px * light.radius_px);
  std::vector<Index> half_widths;
  double left_sq = radius_sq;
  for (double row = 1; left_sq >= 0; ++row) {
    half_widths.push_back(static_cast<Index>(std::sqrt(left_sq)));
    left_sq = radius_sq - square(static_cast<double>(value(light.pixel_aspect)) * row);
  }
  return half_widths;
}
template <scalar S>
double disc_pixels(const NeighbourLight<S>& light) {
  Index pixels = -2 * light.radius_px - 1;  // the middle row is there once
  for (const Index w : disc_half_widths(light)) {
    pixels += 2 * (2 * w + 1);
  }
  return static_cast<double>(pixels);
}

/// Sums over a disc, from the running sums along each row: two of them for each row of the disc.
template <scalar S>
class DiscSums {
 public:
  DiscSums(Index rows, Index cols, const NeighbourLight<S>& light)
      : rows_(rows),
        cols_(cols),
        margin_(light.radius_px + 1),
        half_widths_(disc_half_widths(light)),
        sums_(static_cast<std::size_t>(rows * (cols + 2 * margin_)), S(0)) {}

  /// Sets the cells of row i.
  void set(Index i, const S* cells) {
    S* row = sums_.data() + i * (cols_ + 2 * margin_) + margin_;
    S sum = S(0);
    for (Index j = 0; j < cols_; ++j) {
      sum = sum + cells[j];
      row[j] = sum;
    }
    std::fill_n(row + cols_, margin_, sum);
  }

  /// to[j] = the sum over the disc around row i and column j. Cells beyond the image count as 0.
  void sum(Index i, S* to) const {
    const Index reach = static_cast<Index>(half_widths_.size()) - 1, stride = cols_ + 2 * margin_;
    const Index top = (std::max)(-i, -reach), bottom = (std::min)(rows_ - 1 - i, reach);
    const Index* half_widths = half_widths_.data();
    const S* row = sums_.data() + i * stride + margin_;
    for_each_cell<S>(cols_, [=]<class V>(Index j) {
      V sum = every_lane<V>(S(0));
      for (Index y = top; y <= bottom; ++y) {
        const S* center = row + y * stride + j;
        const Index w = half_widths[y < 0 ? -y : y];
        sum = sum + V(load_cells<V, S>(center + w) - load_cells<V, S>(center - w - 1));
      }
      store_cells<S>(to + j, sum);
    });
  }

 private:
  Index rows_, cols_, margin_;
  std::vector<Index> half_widths_;
  std::vector<S> sums_;  // along each row, with a margin on both sides
};

/// Slope along one axis: a central difference, one-sided beside a pixel that is not finite; NaN
/// beside two, or if the pixel itself is not.
template <class V, scalar S>
[[gnu::always_inline]] inline V slope_at(const V& before,
                                         const V& here,
                                         const V& after,
                                         const S& per_mm) {
  const V none = every_lane<V>(S(0)), up = after - here, down = here - before;
  const auto has_up = known<V>(up - up), has_down = known<V>(down - down);
  const V rise = V(has_up ? up : none) + V(has_down ? down : none);
  const V per_step = (has_up & has_down) ? every_lane<V>(per_mm / S(2)) : every_lane<V>(per_mm);
  return (has_up | has_down) ? V(rise * per_step) : every_lane<V>(not_a_number<S>());
}

/// The equation for one pixel, or for each lane of a vector: the depth minus the effect of the
/// neighbours' light, at least 0. A depth of NaN or +infinity stays as it is; a reference of NaN
/// means that there is no such light.
template <class V, scalar S>
[[gnu::always_inline]] inline V without_light_of(const V& depth_mm,
                                                 const V& reference_depth_mm,
                                                 const V& psi_sum_rad,
                                                 const NeighbourLight<S>& light) {
  const V none = every_lane<V>(S(0)), risen_mm = depth_mm - reference_depth_mm;
  const V m = light.m0_mm_per_rad * quick_exp(V(light.n_per_mm * risen_mm));
  const V l = depth_mm - (known<V>(reference_depth_mm) ? V(m * psi_sum_rad) : none);
  return l < none ? none : l;
}

}  // namespace detail

/// The same light for samples of step x step pixels: the disc has the nearest radius, and m0 makes
/// up for its fewer pixels.
template <scalar S>
NeighbourLight<S> sampled(const NeighbourLight<S>& light, int step) {
  NeighbourLight<S> out = light;
  out.radius_px = (std::max)((light.radius_px + step / 2) / step, Index(1));
  out.m0_mm_per_rad =
      light.m0_mm_per_rad * S(detail::disc_pixels(light) / detail::disc_pixels(out));
  return out;
}

/// Removes the effect of neighbouring light from depth maps, computed in the scalar S. Use one
/// object a thread. A frame takes O(rows cols r) and allocates nothing.
///
/// A pixel that is missing (not finite) in the frame but not in the reference is membrane that was
/// not seen: it counts with the mean change of the disc's other pixels. A pixel that is missing in
/// the reference is not membrane and adds nothing.
template <scalar S = float>
class NeighbourLightCompensation {
 public:
  /// `pitch_mm` is the distance on the membrane between the points that pixels side by side see,
  /// because the gradient is taken there. It is about 1 + l / h times the pitch on the plate, with
  /// h the virtual height of optics/camera.hpp. One number, for the mean depth of the pad, is
  /// enough: m0 is fitted with the same number and absorbs a common factor. `reference_depth_mm` is
  /// smoothed like the frames; NaN outside the pad. Refuses bad parameters (parameter_error).
  template <grid Reference>
  NeighbourLightCompensation(const NeighbourLight<S>& light,
                             const S& pitch_mm,
                             const Reference& reference_depth_mm)
      : light_(checked(light, pitch_mm, as_view(reference_depth_mm))),
        per_mm_{S(1) / pitch_mm, S(1) / (pitch_mm * light.pixel_aspect)},
        rows_(as_view(reference_depth_mm).rows()),
        cols_(as_view(reference_depth_mm).cols()),
        depth_mm_(static_cast<std::size_t>((rows_ + 2) * (cols_ + 2)), not_a_number<S>()),
        psi0_(static_cast<std::size_t>(rows_ * cols_), S(0)),
        membrane_(psi0_.size(), S(0)),
        change_(rows_, cols_, light),
        lost_(change_),
        row_(static_cast<std::size_t>(cols_), S(0)),
        lost_row_(row_),
        sum_(row_) {
    load(as_view(reference_depth_mm));
    reference_mm_ = depth_mm_;
    for (S& l : reference_mm_) {
      l = is_finite(l) ? l : not_a_number<S>();
    }
    for (Index i = 0; i < rows_; ++i) {
      S *psi0 = psi0_.data() + i * cols_, *has_psi = row_.data();
      detail::for_each_cell<S>(
          cols_, [ =, this ]<class V>(Index j) __attribute__((always_inline)) {
            const V psi = this->template psi_at<V>(i, j), one = detail::every_lane<V>(S(1));
            detail::store_cells<S>(psi0 + j, psi);
            detail::store_cells<S>(has_psi + j, V(detail::known<V>(psi) ? one : one - one));
          });
      change_.set(i, has_psi);
    }
    for (Index i = 0; i < rows_; ++i) {
      change_.sum(i, membrane_.data() + i * cols_);
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
    return each_row(depth_mm, std::forward<Out>(out), [this](Index i) {
      const S *l = padded_row(depth_mm_, i), *l0 = padded_row(reference_mm_, i);
      S* sum = sum_.data();
      detail::for_each_cell<S>(
          cols_, [ =, this ]<class V>(Index j) __attribute__((always_inline)) {
            const auto at = [j](const S* cells) { return detail::load_cells<V, S>(cells + j); };
            const V without = detail::without_light_of<V>(at(l), at(l0), at(sum), light_);
            detail::store_cells<S>(sum + j, without);
          });
    });
  }

  /// Writes psi_sum in rad to `out`, for fits of m0 and n. Sizes and status as above.
  template <grid Depth, class Out>
  [[nodiscard]] FrameStatus inclination_sums(const Depth& depth_mm, Out&& out) {
    return each_row(depth_mm, std::forward<Out>(out), [](Index) {});
  }

 private:
  template <class View>
  static const NeighbourLight<S>& checked(const NeighbourLight<S>& light,
                                          const S& pitch_mm,
                                          const View& reference) {
    static constexpr const char* owner = "NeighbourLightCompensation";
    require(light);
    require(owner, {{"pitch_mm", pitch_mm, positive}});
    expects_grid_size(owner, reference.rows(), reference.cols());
    return light;
  }

  /// Finds sum_ of each row and writes what finish(row) makes of it.
  template <class Depth, class Out, class Finish>
  FrameStatus each_row(const Depth& depth_mm, Out&& out, const Finish& finish) {
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
      compare(i);
    }
    for (Index i = 0; i < rows_; ++i) {
      find_sum(i);
      finish(i);
      detail::store_row(sum_.data(), to, i);
    }
    return is_in_unit_of_reference() ? FrameStatus::ok : FrameStatus::not_of_this_pad;
  }

  /// First cell of a row in a map with a border of one missing cell.
  template <class Cells>
  auto* padded_row(Cells& cells, Index row) const {
    return cells.data() + (row + 1) * (cols_ + 2) + 1;
  }

  template <class View>
  void load(const View& depth) {
    for (Index i = 0; i < rows_; ++i) {
      S* to = padded_row(depth_mm_, i);
      const S* from = detail::row_of<S>(depth, i, to);
      std::copy_n(from, from == to ? 0 : cols_, to);
    }
  }

  /// psi of a pixel or a vector of them; NaN where missing.
  template <class V>
  [[gnu::always_inline]] V psi_at(Index row, Index col) const {
    const S* l = padded_row(depth_mm_, row) + col;
    const auto at = [l](Index k) { return detail::load_cells<V, S>(l + k); };
    const V x = detail::slope_at<V>(at(-1), at(0), at(1), per_mm_.x);
    const V y = detail::slope_at<V>(at(-cols_ - 2), at(0), at(cols_ + 2), per_mm_.y);
    const V slope_sq = x * x + y * y;
    return V(detail::inclination(slope_sq) + (slope_sq - slope_sq));
  }

  /// Sets the row of change_, 0 where psi is missing here or in the reference, and of lost_.
  void compare(Index row) {
    const S* psi0 = psi0_.data() + row * cols_;
    S *to = row_.data(), *lost = lost_row_.data();
    bool is_any_lost = false;
    detail::for_each_cell<S>(
        cols_, [ =, this, &is_any_lost ]<class V>(Index j) __attribute__((always_inline)) {
          const V none = detail::every_lane<V>(S(0)), one = detail::every_lane<V>(S(1));
          const V before = detail::load_cells<V, S>(psi0 + j);
          const V change = this->template psi_at<V>(row, j) - before;
          const auto is_seen = detail::known<V>(change);
          const V gone = is_seen ? none : V(detail::known<V>(before) ? one : none);
          detail::store_cells<S>(to + j, V(is_seen ? change : none));
          detail::store_cells<S>(lost + j, gone);
          is_any_lost = is_any_lost || detail::any_lane(none < gone);
        });
    is_any_lost_ = is_any_lost_ || is_any_lost;
    change_.set(row, to);
    lost_.set(row, lost);
  }

  /// Sets sum_ to psi_sum of a row in rad.
  void find_sum(Index row) {
    change_.sum(row, sum_.data());
    if (!is_any_lost_) {
      return;
    }
    lost_.sum(row, lost_row_.data());
    const S* membrane = membrane_.data() + row * cols_;
    for (std::size_t j = 0; j < sum_.size(); ++j) {
      const S seen = membrane[j] - lost_row_[j];
      sum_[j] = S(0) < seen ? sum_[j] * (membrane[j] / seen) : sum_[j];
    }
  }

  /// Judged from every eighth pixel of every eighth row.
  bool is_in_unit_of_reference() const {
    S here = S(0), there = S(0);
    for (Index i = 0; i < rows_; i += 8) {
      for (Index j = 0; j < cols_; j += 8) {
        const S l = padded_row(depth_mm_, i)[j], reference = padded_row(reference_mm_, i)[j];
        if (is_finite(l) && S(0) < reference) {
          here += l;
          there += reference;
        }
      }
    }
    return !(S(0) < there) || (there < S(20) * here && here < S(20) * there);
  }

  NeighbourLight<S> light_;
  Point2<S> per_mm_;  // pixels along x and along y
  Index rows_, cols_;
  std::vector<S> depth_mm_, reference_mm_;  // with a border of one cell, which is missing
  detail::SharedVector<S> psi0_;            // of the reference; NaN where missing
  detail::SharedVector<S> membrane_;        // pixels of each disc that have psi0
  detail::DiscSums<S> change_, lost_;       // of psi in rad; of pixels
  std::vector<S> row_, lost_row_, sum_;
  bool is_any_lost_ = false;
};

}  // namespace v1
}  // namespace fingerpad
