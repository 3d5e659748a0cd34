// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finds and grows the connected regions of a mask (neighbours share a side) one after the other, in
// memory allocated up front. A pixel is in the queue at most once, and a region is a contiguous
// part of the queue. Where a region ends: the share of the jump of the mean curvature, from the
// object's to the free membrane's, that a ring measures (docs/contact/contact_region.md, the edge).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// State of a pixel while regions are found; `gap`: in contact only by the touching gap.
enum class Mark : std::uint8_t { free, unknown, seed, contact, gap };

/// The first mark equal to `which` in [first, last), or last.
inline const Mark* find_mark(const Mark* first, const Mark* last, Mark which) {
  const auto count = static_cast<std::size_t>(last - first);
  const void* found = std::memchr(first, static_cast<int>(which), count);
  return found == nullptr ? last : static_cast<const Mark*>(found);
}

/// Marks a row of curvatures: seed below the threshold, unknown where the curvature is NaN, else
/// free.
template <class S>
void mark_below(const S& threshold, const S* curvature, Index count, Mark* marks) {
  for_each_cell<S>(count, [&]<class V>(Index j) {
    const V k = load_cells<V, S>(curvature + j);
    const V known =
        k == k ? every_lane<V>(S(0)) : every_lane<V>(S(static_cast<int>(Mark::unknown)));
    const V mark =
        k < every_lane<V>(threshold) ? every_lane<V>(S(static_cast<int>(Mark::seed))) : known;
    store_cells<S>(reinterpret_cast<std::uint8_t*>(marks + j), mark);
  });
}

/// Layout of an image with a border of at least one pixel. The border always stays `unknown`, so
/// that no bounds are tested.
struct BorderedImage {
  Index rows;
  Index cols;
  Index border = 1;

  constexpr Index stride() const { return cols + 2 * border; }
  constexpr Index size() const { return (rows + 2 * border) * stride(); }
  /// Offset of the pixel (row, col).
  constexpr Index at(Index row, Index col) const {
    return (row + border) * stride() + col + border;
  }
  /// View of the image without its border, in memory of size() cells.
  template <class T>
  constexpr StridedView<T> view(T* cells) const {
    return {cells + at(0, 0), rows, cols, stride()};
  }
};

class Regions {
 public:
  explicit Regions(const BorderedImage& image)
      : image_(image),
        mark_(static_cast<std::size_t>(image.size()), Mark::unknown),
        queue_(static_cast<std::size_t>(image.rows * image.cols)) {}

  const BorderedImage& image() const { return image_; }
  Mark& mark(Index at) { return mark_[static_cast<std::size_t>(at)]; }
  StridedView<Mark> marks() { return image_.view(mark_.data()); }

  /// The first seed from a pixel on; image().size() if there is none.
  Index next_seed(Index from) const {
    const Mark* marks = mark_.data();
    return find_mark(marks + from, marks + image_.size(), Mark::seed) - marks;
  }

  /// A region: the pixels queue[begin, end).
  struct Region {
    Index begin = 0;
    Index end = 0;
    Index pixels() const { return end - begin; }
  };
  Index pixel(Index k) const { return queue_[static_cast<std::size_t>(k)]; }

  /// Finds the connected regions of seeds and marks them as contact. Drops those for which
  /// keep(region) is false, calls visit(region) for the others and returns how many of these are
  /// not empty afterwards. A region that visit() grows may absorb others before they are found.
  template <class Keep, class Visit>
  Index for_each(const Keep& keep, const Visit& visit) {
    Index count = 0;
    tail_ = 0;
    for (Index at = next_seed(0); at < image_.size(); at = next_seed(at + 1)) {
      Region region{tail_, tail_};
      push(at);
      spread(region.begin, image_.size(), [&](Index pixel) { return mark(pixel) == Mark::seed; });
      region.end = tail_;
      if (keep(region)) {
        visit(region);
        count += region.pixels() > 0 ? 1 : 0;
      } else {
        trim(region, [](Index) { return false; });
      }
    }
    return count;
  }

  /// Grows the region found last by up to `layers` layers of adjacent pixels that fulfil `belongs`.
  template <class Belongs>
  void grow(Region& region, Index layers, const Belongs& belongs) {
    spread(region.begin, layers, [&](Index pixel) {
      return (mark(pixel) == Mark::free || mark(pixel) == Mark::seed) && belongs(pixel);
    });
    region.end = tail_;
  }

  /// Frees the pixels of the region found last that do not fulfil `belongs`. They leave the queue,
  /// because a pixel that several regions take in turn must not be in it twice.
  template <class Belongs>
  void trim(Region& region, const Belongs& belongs) {
    tail_ = region.begin;
    for (Index k = region.begin; k < region.end; ++k) {
      const Index at = pixel(k);
      if (belongs(at)) {
        queue_[static_cast<std::size_t>(tail_)] = at;
        ++tail_;
      } else {
        mark(at) = Mark::free;
      }
    }
    region.end = tail_;
  }

  /// Marks the pixels of a region that do not fulfil `bears` as gap, unless none does.
  template <class Bears>
  void mark_gap(const Region& region, const Bears& bears) {
    const auto begin = queue_.begin() + region.begin, end = queue_.begin() + region.end;
    if (std::any_of(begin, end, bears)) {
      std::for_each(begin, end, [&](Index at) { mark(at) = bears(at) ? mark(at) : Mark::gap; });
    }
  }

 private:
  void push(Index at) {
    mark(at) = Mark::contact;
    queue_[static_cast<std::size_t>(tail_)] = at;
    ++tail_;
  }

  template <class Belongs>
  void spread(Index head, Index layers, const Belongs& belongs) {
    for (Index layer = 0; layer < layers && head < tail_; ++layer) {
      for (const Index layer_end = tail_; head < layer_end; ++head) {
        const Index at = queue_[static_cast<std::size_t>(head)];
        for (const Index beside : {at - 1, at + 1, at - image_.stride(), at + image_.stride()}) {
          if (belongs(beside)) {
            push(beside);
          }
        }
      }
    }
  }

  BorderedImage image_;
  std::vector<Mark> mark_;
  std::vector<Index> queue_;
  Index tail_ = 0;
};

/// q: the share of the jump that a ring measures if its center lies `offset` ring radii outside a
/// straight edge. For a center inside, q(-offset) = 1 - q(offset).
template <scalar S>
S edge_share(const S& offset) {
  using std::acos;
  using std::sqrt;
  if (value(offset) < 0) {
    return S(1) - edge_share(-offset);
  }
  if (!(value(offset) < 1)) {
    return S(1);
  }
  const S sine = sqrt((S(1) - offset) * (S(1) + offset));
  const S angle = acos(offset);
  const S bracket = S(3) / S(2) * offset * sine - angle * (S(1) / S(2) + offset * offset);
  return S(1) + bracket * S(0.63661977236758134308);
}

/// The share of the jump, > 0, at which the contact region ends. Membrane nearer than `gap_mm` to
/// the object then counts as contact. Radii of ring and patch in mm, > 0. `spread_mm` is the
/// distance between the pixels of mean_of_nine(); 0: no averaging.
template <scalar S>
S share_at_end(const S& jump_per_mm,
               const S& gap_mm,
               const S& ring_mm,
               const S& patch_mm,
               const S& spread_mm = S(0)) {
  using std::sqrt;
  const S ratio = gap_mm / jump_per_mm;
  const S offset = value(ratio) > 0 ? sqrt(ratio) : S(0);
  const S here = edge_share(offset / ring_mm);
  const S inward = edge_share((offset - spread_mm) / ring_mm);
  const S outward = edge_share((offset + spread_mm) / ring_mm);
  const S share = (here + inward + outward) / S(3);
  const S round = share + S(0.070735530263064590) * ring_mm / patch_mm;
  return value(round) < 1 ? round : S(1);
}

/// Mean of three values; the middle one if another is missing (NaN).
template <class V, class S>
[[gnu::always_inline]] inline V mean_of_three(const V& before, const V& middle, const V& after) {
  const V sum = before + middle + after;
  return sum == sum ? V(sum * S(1.0 / 3)) : middle;
}

/// Writes the mean of nine pixels (3 x 3), `rows` and `cols` apart: if the map's noise is smooth
/// over this distance, nearly as good as the mean over the whole window and several times cheaper.
/// The map has a border as wide, of NaN.
template <class S>
void mean_of_nine(const StridedView<S>& map, Index rows, Index cols, const StridedView<S>& out) {
  const Index down = rows * map.row_stride();
  for (Index i = 0; i < map.rows(); ++i) {
    const S* from = map.row(i);
    S* to = out.row(i);
    for_each_cell<S>(map.cols(), [=]<class V>(Index j) {
      const auto along = [=](const S* row) {
        return mean_of_three<V, S>(load_cells<V, S>(row - cols), load_cells<V, S>(row),
                                   load_cells<V, S>(row + cols));
      };
      const S* at = from + j;
      store_cells<S>(to + j, mean_of_three<V, S>(along(at - down), along(at), along(at + down)));
    });
  }
}

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
