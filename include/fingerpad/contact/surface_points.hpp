// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The object's surface as points in mm, as a view that computes them when they are asked for; and
// the pixels that see it.
#include <concepts>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/pixel_box.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// The point that each pixel in contact sees, as a grid of Point3 computed on demand; NaN where
/// there is no contact or no depth. Depth and mask must outlive it. Without rows and columns where
/// their sizes differ.
template <template <class> class CameraType, scalar S, grid Depth, grid Mask>
auto surface_points(const CameraType<S>& camera, const Depth& depth_mm, const Mask& contact) {
  const auto depth = as_view(depth_mm);
  const auto mask = as_view(contact);
  const auto point = [camera, depth, mask](Index i, Index j) {
    const S l = static_cast<bool>(mask(i, j)) ? S(depth(i, j)) : not_a_number<S>();
    if (!is_depth(l)) {
      return Point3<S>{not_a_number<S>(), not_a_number<S>(), not_a_number<S>()};
    }
    return point_at(camera, S(static_cast<double>(i)), S(static_cast<double>(j)), l);
  };
  const bool fits = same_size(depth, mask);
  return LazyView(fits ? depth.rows() : Index(0), fits ? depth.cols() : Index(0), point);
}

namespace detail {

// The pixels that see the object: in contact, with a depth, and not within the strip along the
// contact's border that is left out.

/// Masks of bytes in plain memory, of which eight zeros are passed over at a time.
template <class View>
inline constexpr bool is_byte_mask = false;
template <class T>
inline constexpr bool is_byte_mask<StridedView<T>> = std::is_integral_v<T> && sizeof(T) == 1;

template <class View>
bool is_set(const View& mask, Index row, Index col) {
  return is_contact(cell_t<View>(mask(row, col)));
}

/// First column of [col, last) that is set, or a column before it; `last` if there is none.
template <class View>
Index skip_unset(const View& mask, Index row, Index col, Index last) {
  if constexpr (is_byte_mask<View>) {
    if (mask.col_stride() == 1) {
      const auto* cells = mask.row(row);
      std::uint64_t eight = 0;
      while (col + 8 <= last) {
        std::memcpy(&eight, cells + col, sizeof eight);
        if (eight != 0) {
          break;
        }
        col += 8;
      }
    }
  }
  while (col < last && !is_set(mask, row, col)) {
    ++col;
  }
  return col;
}

template <scalar S, class DepthView, class MaskView>
class ContactPixels {
 public:
  ContactPixels(const DepthView& depth_mm, const MaskView& mask, Index border_px)
      : depth_(depth_mm), mask_(mask), border_(border_px), diagonal_((border_px * 7 + 5) / 10) {}

  PixelBox whole() const { return {0, mask_.rows(), 0, mask_.cols()}; }

  /// Calls visit(col, depth_mm) for each pixel of the row, in [first, last), from left to right.
  template <class Visit>
  void for_each_in_row(Index row, Index first, Index last, const Visit& visit) const {
    for (Index col = first; col < last; ++col) {
      if (!is_set(mask_, row, col)) {
        col = skip_unset(mask_, row, col, last);
        if (col == last) {
          return;
        }
      }
      const S depth = S(depth_(row, col));
      if (is_depth(depth) && (border_ == 0 || is_inner(row, col))) {
        visit(col, depth);
      }
    }
  }

 private:
  /// The eight pixels at the border's width are in contact too; what the image does not show may
  /// be.
  bool is_inner(Index row, Index col) const {
    const bool far_from_edges = row >= border_ && row + border_ < mask_.rows() && col >= border_ &&
                                col + border_ < mask_.cols();
    if (far_from_edges) {
      return surrounded(row, col, [&](Index i, Index j) { return is_set(mask_, i, j); });
    }
    return surrounded(row, col, [&](Index i, Index j) {
      const bool inside = i >= 0 && i < mask_.rows() && j >= 0 && j < mask_.cols();
      return !inside || is_set(mask_, i, j);
    });
  }

  /// All eight are looked at: they seldom differ, and no branch has to be guessed.
  template <class InContact>
  bool surrounded(Index row, Index col, const InContact& in_contact) const {
    const Index b = border_;
    const Index d = diagonal_;
    const int sides = int{in_contact(row, col - b)} & int{in_contact(row, col + b)} &
                      int{in_contact(row - b, col)} & int{in_contact(row + b, col)};
    const int corners = int{in_contact(row - d, col - d)} & int{in_contact(row - d, col + d)} &
                        int{in_contact(row + d, col - d)} & int{in_contact(row + d, col + d)};
    return (sides & corners) != 0;
  }

  DepthView depth_;
  MaskView mask_;
  Index border_;
  Index diagonal_;
};

}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
