// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Input of the object motion from a frame: the dots in space, and whether each is in contact.
// Source: Ito, Kim, Nagai, Obinata 2011, eq. 13, with E019 and E020 corrected: the depth is that at
// the dot's pixel.
#include <algorithm>
#include <concepts>
#include <type_traits>
#include <utility>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

namespace detail::dots {

/// Depth between pixel centers by bilinear interpolation; NaN outside of the map and where a pixel
/// with a weight is missing.
template <scalar S, grid Depth>
S depth_between_pixels(const Depth& depth_mm, const S& row, const S& col) {
  const S last_row = S(static_cast<double>(rows(depth_mm) - 1));
  const S last_col = S(static_cast<double>(cols(depth_mm) - 1));
  const bool inside = value(row) >= 0 && value(col) >= 0 && value(row) <= value(last_row) &&
                      value(col) <= value(last_col);  // false for NaN
  if (!inside) {
    return not_a_number<S>();
  }
  const Index i = static_cast<Index>(value(row));
  const Index j = static_cast<Index>(value(col));
  const S down = row - S(static_cast<double>(i));
  const S right = col - S(static_cast<double>(j));
  const auto share = [&](Index r, Index c, const S& weight) {
    // a pixel with weight 0 may be missing or outside of the map
    return value(weight) == 0 ? S(0) : weight * S(grid_traits<Depth>::at(depth_mm, r, c));
  };
  const S up = S(1) - down;
  const S left = S(1) - right;
  const S depth = share(i, j, up * left) + share(i, j + 1, up * right) +
                  share(i + 1, j, down * left) + share(i + 1, j + 1, down * right);
  return is_finite(depth) ? depth : not_a_number<S>();
}

/// A point of type P with these coordinates.
template <class P, scalar S>
P point_from(const Point3<S>& p) {
  P out = P();
  if constexpr (requires { out.x = out.y = out.z; }) {
    using C = std::remove_cvref_t<decltype(out.x)>;
    out.x = static_cast<C>(p.x);
    out.y = static_cast<C>(p.y);
    out.z = static_cast<C>(p.z);
  } else {
    using C = std::remove_cvref_t<decltype(out[0])>;
    out[0] = static_cast<C>(p.x);
    out[1] = static_cast<C>(p.y);
    out[2] = static_cast<C>(p.z);
  }
  return out;
}
}  // namespace detail::dots

/// Dots of a frame in space, in mm, from their positions in the image (px) and the depth map (mm,
/// along each pixel's ray). NaN where a dot was not found or has no depth. Returns how many
/// have a place; -1, and nothing is written, if the grids differ in size. Allocates nothing.
template <scalar S, dot_grid Dots, grid Depth, spatial_dot_grid Out>
Index spatial_dots(const Camera<S>& camera,
                   const Dots& dots_px,
                   const Depth& depth_mm,
                   Out&& out_mm) {
  const auto from = as_view(dots_px);
  const auto depth = as_view(depth_mm);
  const auto to = as_view(std::forward<Out>(out_mm));
  if (!same_size(from, to)) {
    return -1;
  }
  Index count = 0;
  for (Index i = 0; i < from.rows(); ++i) {
    for (Index j = 0; j < from.cols(); ++j) {
      const cell_t<Dots> p = from(i, j);
      using Traits = point_traits<cell_t<Dots>>;
      const S row = S(Traits::y(p));
      const S col = S(Traits::x(p));
      const S l = detail::dots::depth_between_pixels(depth, row, col);
      const bool known = is_depth(l);
      to(i, j) = detail::dots::point_from<cell_t<Out>>(known ? point_at(camera, row, col, l)
                                                             : detail::missing_point<S>());
      count += known ? 1 : 0;
    }
  }
  return count;
}

namespace detail {

/// Whether all pixels of the mask within radius_px of (row, col) are in contact.
template <class Mask>
bool disc_in_contact(const Mask& mask, Index row, Index col, double radius_px) {
  const auto reach = static_cast<Index>(radius_px);
  const Index top = (std::max)(row - reach, Index{0}), left = (std::max)(col - reach, Index{0});
  const Index bottom = (std::min)(row + reach, mask.rows() - 1);
  const Index right = (std::min)(col + reach, mask.cols() - 1);
  for (Index i = top; i <= bottom; ++i) {
    for (Index j = left; j <= right; ++j) {
      const auto away_sq = static_cast<double>((i - row) * (i - row) + (j - col) * (j - col));
      if (away_sq <= radius_px * radius_px && !is_contact(mask(i, j))) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace detail

/// Computes which dots are in contact: those for which all pixels of the mask within
/// `dot_radius_px`, in [0, 1000], of the dot's nearest pixel are in contact. Pixels outside of the
/// mask do not count. With 0 only the nearest pixel counts. A dot on the edge of the contact is
/// about to separate, or has not been touched yet, so use the radius of the dots for their motion.
/// A dot that was not found or lies outside of the mask is not in contact. Returns false and writes
/// nothing if `out` has another size than the dot grid or the radius is invalid. Allocates nothing;
/// O(dots radius^2).
template <dot_grid Dots, contact_mask Mask, class Out>
bool contact_at_dots(const Dots& dots_px, const Mask& mask, Out&& out, double dot_radius_px = 0) {
  static_assert(writable_grid<Out, bool>, "this grid is written to: its cells must be assignable");
  const auto from = as_view(dots_px);
  const auto flags = as_view(mask);
  const auto to = as_view(std::forward<Out>(out));
  if (!same_size(from, to) || !(dot_radius_px >= 0 && dot_radius_px <= 1000)) {
    return false;
  }
  const double last_row = static_cast<double>(flags.rows()) - 0.5;
  const double last_col = static_cast<double>(flags.cols()) - 0.5;
  for (Index i = 0; i < from.rows(); ++i) {
    for (Index j = 0; j < from.cols(); ++j) {
      const cell_t<Dots> p = from(i, j);
      using Traits = point_traits<cell_t<Dots>>;
      const auto row = static_cast<double>(value(Traits::y(p)));
      const auto col = static_cast<double>(value(Traits::x(p)));
      const bool inside = row > -0.5 && col > -0.5 && row < last_row && col < last_col;
      const bool set =
          inside && detail::disc_in_contact(flags, static_cast<Index>(row + 0.5),
                                            static_cast<Index>(col + 0.5), dot_radius_px);
      to(i, j) = static_cast<cell_t<Out>>(set);
    }
  }
  return true;
}

}  // namespace v1
}  // namespace fingerpad
