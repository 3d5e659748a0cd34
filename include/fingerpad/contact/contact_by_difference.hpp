// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Contact region of a pad without depth, from the difference between a frame and the free pad. It
// suits gel pads lit from the side (GelSight, DIGIT and similar), with or without printed dots, and
// gels that darken where they are pressed.
//
// The difference is relative, (now / gain) / free - 1, so that lamps may be uneven. The gain of
// each channel is the median of now / free, so that exposure and white balance may change. The
// median is taken over the frame or, if more than half of the frame differs, over its border. Dots
// are left out: they move with the gel beside a contact as well as under it, and would be taken for
// contact.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/contact/detail/frame_difference.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/cell_filter.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/regions.hpp"

namespace fingerpad {
inline namespace v0 {

/// Options of the contact test. Lengths are in px of the frame.
struct DifferenceTest {
  Index cell_px = 4;        ///< side of a cell; contact is decided per cell; 1..16
  double smoothing_px = 7;  ///< sd of the Gaussian that averages the difference, about half a dot;
                            ///< in [cell_px / 2, 16 cell_px]
  double dot_px = 14;       ///< diameter of the printed dots, at most 16 cell_px; 0: no dots
  double dot_contrast = 0.1;  ///< a cell darker than its surroundings by this fraction belongs to a
                              ///< dot; in (0, 1)
  double min_difference = 0.02;  ///< smallest threshold, as a fraction of the free brightness,
                                 ///< however low the noise of the free frames; in (0, 1)
  double noise_factor = 1;  ///< threshold / 99th percentile of the difference in free frames; >= 1
  double max_gap_px = 28;   ///< gaps in a contact up to this width are closed, by default two dots;
                            ///< in [0, 32 cell_px]
  Index min_region_px = 800;  ///< smaller regions are dropped; >= 0
  double saturated = 254;     ///< cells as bright as this in a channel are ignored; > 0
  double mm_per_px = 0.05;    ///< scale of area and center; finite, > 0
};
inline void expects_valid(const DifferenceTest& test) {
  constexpr const char* owner = "DifferenceTest";
  expects(test.cell_px >= 1 && test.cell_px <= 16, owner, "cell_px",
          static_cast<long long>(test.cell_px), "in [1, 16]");
  const double cell = static_cast<double>(test.cell_px);
  expects(test.smoothing_px >= cell / 2 && test.smoothing_px <= 16 * cell, owner, "smoothing_px",
          test.smoothing_px, "in [cell_px / 2, 16 cell_px]");
  expects(test.dot_px >= 0 && test.dot_px <= 16 * cell, owner, "dot_px", test.dot_px,
          "in [0, 16 cell_px]");
  expects(test.dot_contrast > 0 && test.dot_contrast < 1, owner, "dot_contrast", test.dot_contrast,
          "in (0, 1)");
  expects(test.min_difference > 0 && test.min_difference < 1, owner, "min_difference",
          test.min_difference, "in (0, 1)");
  expects(is_finite(test.noise_factor) && test.noise_factor >= 1, owner, "noise_factor",
          test.noise_factor, "finite and >= 1");
  expects(test.max_gap_px >= 0 && test.max_gap_px <= 32 * cell, owner, "max_gap_px",
          test.max_gap_px, "in [0, 32 cell_px]");
  expects(test.min_region_px >= 0, owner, "min_region_px",
          static_cast<long long>(test.min_region_px), ">= 0");
  expects(test.saturated > 0, owner, "saturated", test.saturated, "> 0");
  expects(is_finite(test.mm_per_px) && test.mm_per_px > 0, owner, "mm_per_px", test.mm_per_px,
          "finite and > 0");
}

/// Finds the contact in frames of one size. A pixel is a number (Channels = 1) or gives its
/// channels as pixel[c] (cv::Vec3b, std::array). Threads may share one object, each with its own
/// workspace. A frame takes bounded time and allocates nothing; O(rows cols), fastest for a strided
/// view of packed bytes. Valid while the object touches less than half of the frame or less than
/// half of its border, because the majority is taken to be free.
template <int Channels = 3, scalar S = float>
class ContactByDifference {
  static_assert(Channels >= 1);
  using Difference = detail::FrameDifference<Channels, S>;
  using Colours = detail::CellColours<Channels, S>;

 public:
  /// Learns the free pad from `free_frames`, a range of grids. With two or more frames their noise
  /// is measured and may raise the threshold. Refuses an empty range, frames of different sizes and
  /// bad parameters (parameter_error).
  template <class FreeFrames>
  explicit ContactByDifference(const FreeFrames& free_frames, const DifferenceTest& test = {})
      : test_(checked(test)), layout_(layout_of(free_frames, test)), free_(colours()) {
    learn(free_frames);
  }

  /// Scratch memory for a frame; one per thread.
  class Workspace {
   public:
    explicit Workspace(const ContactByDifference& contact)
        : difference_(contact.layout_),
          opening_(contact.layout_.cell_rows(), contact.layout_.cell_cols(), 1),
          closing_(contact.layout_.cell_rows(), contact.layout_.cell_cols(), contact.half_gap()),
          mask_(contact.layout_.cell_rows(), contact.layout_.cell_cols(), 1),
          regions_({contact.layout_.cell_rows(), contact.layout_.cell_cols()}),
          line_(static_cast<std::size_t>(contact.layout_.cell_cols() * contact.layout_.cell_px)) {}

    /// The last frame's difference from the free pad, cell by cell, to which the threshold applies.
    /// It is the root mean square over the channels, as a fraction of the free brightness; NaN
    /// where it is unknown.
    StridedView<const S> difference() const { return difference_.length().view(); }
    /// The same, with the areas hidden by dots filled in from the gel beside them. ContactSlide
    /// reads it.
    StridedView<const S> imprint() const { return difference_.imprint().view(); }
    /// The last frame's contact, cell by cell: 1, else 0.
    StridedView<const S> contact() const { return mask_.view(); }

   private:
    friend class ContactByDifference;
    Difference difference_;
    detail::CellMorphology<S> opening_;
    detail::CellClosing<S> closing_;
    detail::PaddedCells<S> mask_;
    detail::Regions regions_;
    std::vector<Touch> line_;  // a row of the mask
  };
  Workspace workspace() const { return Workspace(*this); }

  /// Finds the contact of a frame and writes it to `mask` as ContactRegion does: a Touch, or 255 in
  /// contact and 0 elsewhere. The area is the number of pixels times mm_per_px^2, and the center is
  /// relative to the middle of the image. Depths are NaN.
  template <grid Frame, class Mask>
  ContactResult operator()(const Frame& frame, Mask&& mask, Workspace& w) const {
    detail::writes_to<Mask>();
    ContactResult result;
    const auto from = as_view(frame);
    const auto to = as_view(mask);
    if (!has_size(from) || !has_size(to) || w.difference_.layout() != layout_) {
      return result;
    }
    w.difference_.read(from);
    result = found(detail::GainFrom::frame, w);
    const bool is_mostly_free = 2 * result.contact_px < rows() * cols() - result.unknown_px;
    if (result.in_contact() && !is_mostly_free) {
      // a contact leaves most of the border free; another lamp changes the border most
      result = found(detail::GainFrom::border, w);
      result.status = is_border_free(w) ? FrameStatus::ok : FrameStatus::not_of_this_pad;
    } else if (result.unknown_px == rows() * cols()) {
      result.status = FrameStatus::not_of_this_pad;
    }
    write(w, to);
    return result;
  }

  Index rows() const { return layout_.rows; }
  Index cols() const { return layout_.cols; }
  /// Cells whose difference exceeds it are contact.
  double threshold() const { return threshold_; }

 private:
  static const DifferenceTest& checked(const DifferenceTest& test) {
    expects_valid(test);
    return test;
  }
  template <class FreeFrames>
  static detail::CellLayout layout_of(const FreeFrames& frames, const DifferenceTest& test) {
    Index height = 0;
    Index width = 0;
    long long count = 0;
    for (const auto& frame : frames) {
      const auto view = as_view(frame);
      height = count == 0 ? view.rows() : height;
      width = count == 0 ? view.cols() : width;
      expects(view.rows() == height && view.cols() == width, "ContactByDifference",
              "free_frames of another size, number", count, "of the size of the first");
      ++count;
    }
    expects(count > 0, "ContactByDifference", "free_frames", count, "one or more");
    expects_grid_size("ContactByDifference", height, width);
    return {height,        width, test.cell_px, test.smoothing_px, test.dot_px, test.dot_contrast,
            test.saturated};
  }

  Index pad() const { return Difference(layout_).pad(); }
  Colours colours() const { return {layout_.cell_rows(), layout_.cell_cols(), pad()}; }
  Index half_gap() const {
    return static_cast<Index>(std::lround(layout_.in_cells(test_.max_gap_px / 2)));
  }
  template <class G>
  bool has_size(const G& g) const {
    return g.rows() == layout_.rows && g.cols() == layout_.cols;
  }
  template <class Visit>
  void for_cells(const Visit& visit) const {
    for (Index i = 0; i < layout_.cell_rows(); ++i) {
      for (Index j = 0; j < layout_.cell_cols(); ++j) {
        visit(i, j);
      }
    }
  }

  /// Sets the free pad to the mean of the frames, and the threshold from their noise. The noise is
  /// the difference of each frame from the mean of the others.
  template <class FreeFrames>
  void learn(const FreeFrames& frames) {
    Difference difference(layout_);
    std::vector<Colours> seen;
    for (const auto& frame : frames) {
      difference.read(as_view(frame));
      seen.push_back(difference.now());
    }
    std::vector<double> noise;
    std::size_t k = 0;
    for (const auto& frame : frames) {
      if (seen.size() > 1) {
        set_free(seen, k);
        difference.read(as_view(frame));
        difference.compare(free_, detail::GainFrom::frame);
        noise.push_back(exceeded_in_a_hundredth(difference.length()));
      }
      ++k;
    }
    set_free(seen, seen.size());
    threshold_ = test_.min_difference;
    if (!noise.empty()) {  // the median, since one frame may not be free after all
      const auto middle = noise.begin() + static_cast<std::ptrdiff_t>(noise.size() / 2);
      std::nth_element(noise.begin(), middle, noise.end());
      threshold_ = (std::max)(threshold_, test_.noise_factor * *middle);
    }
  }

  /// Sets the free pad to the mean of the frames except number `without`; seen.size() excludes
  /// none. A cell counts only if all of these frames know it.
  void set_free(const std::vector<Colours>& seen, std::size_t without) {
    const S share = S(1.0 / static_cast<double>(seen.size() - (without < seen.size() ? 1 : 0)));
    for_cells([&](Index i, Index j) {
      S weight = S(1);
      S known = S(1);
      S mean[std::size_t(Channels)] = {};
      for (std::size_t k = 0; k < seen.size(); ++k) {
        if (k != without) {
          weight = S(weight * seen[k].weight(i, j));
          known = S(known * seen[k].known(i, j));
          for (std::size_t c = 0; c < std::size_t(Channels); ++c) {
            mean[c] = S(mean[c] + seen[k].mean[c](i, j) * share);
          }
        }
      }
      free_.weight(i, j) = weight;
      free_.known(i, j) = known;
      for (std::size_t c = 0; c < std::size_t(Channels); ++c) {
        free_.mean[c](i, j) = mean[c];
      }
    });
  }

  double exceeded_in_a_hundredth(const detail::PaddedCells<S>& length) const {
    std::vector<double> known;
    for_cells([&](Index i, Index j) {
      if (is_finite(length(i, j))) {
        known.push_back(static_cast<double>(value(length(i, j))));
      }
    });
    if (known.empty()) {
      return 0;
    }
    const auto at = known.begin() + static_cast<std::ptrdiff_t>(known.size() * 99 / 100);
    std::nth_element(known.begin(), at, known.end());
    return *at;
  }

  /// Finds the contact in the frame that was read last.
  ContactResult found(detail::GainFrom from, Workspace& w) const {
    w.difference_.compare(free_, from);
    mark(w);
    ContactResult result;
    result.status = FrameStatus::ok;
    result.regions = fill_and_drop(w);
    measure(w, result);
    return result;
  }

  /// Whether less than half of the known border cells differ.
  bool is_border_free(const Workspace& w) const {
    const detail::PaddedCells<S>& length = w.difference_.length();
    Index differs = 0;
    Index known = 0;
    detail::for_border(length.rows(), length.cols(), [&](Index i, Index j) {
      differs += S(threshold_) < length(i, j) ? 1 : 0;
      known += is_finite(length(i, j)) ? 1 : 0;
    });
    return 2 * differs < known;
  }

  /// Marks the cells above the threshold, then opens and closes the mask.
  void mark(Workspace& w) const {
    const S threshold = S(threshold_);
    const detail::PaddedCells<S>& length = w.difference_.length();
    for (Index i = 0; i < length.rows(); ++i) {
      detail::for_each_cell<S>(length.cols(), [&]<class V>(Index j) {
        const V d = detail::load_cells<V, S>(length.row(i) + j);
        detail::store_cells<S>(w.mask_.row(i) + j, d > V{} + threshold ? V(V{} + S(1)) : V{});
      });
    }
    w.opening_.shrink(w.mask_);
    w.opening_.grow(w.mask_);
    w.closing_(w.mask_);
  }

  /// Fills holes (regions without contact that do not reach the image's edge) and drops small
  /// regions. Returns the number of regions left.
  Index fill_and_drop(Workspace& w) const {
    using detail::Mark;
    using Region = detail::Regions::Region;
    const auto paint = [&](Mark contact, Mark other) {
      const auto marks = w.regions_.marks();
      for_cells([&](Index i, Index j) { marks(i, j) = S(0) < w.mask_(i, j) ? contact : other; });
    };
    const auto set = [&](const Region& region, const S& to) {
      const Index stride = w.regions_.image().stride();
      for (const Index* at = w.regions_.begin(region); at != w.regions_.end(region); ++at) {
        w.mask_(*at / stride - 1, *at % stride - 1) = to;
      }
    };
    const auto is_hole = [&](const Region& region) { return !reaches_edge(w.regions_, region); };
    paint(Mark::free, Mark::seed);
    w.regions_.for_each(is_hole, [&](const Region& region) { set(region, S(1)); });
    paint(Mark::seed, Mark::free);
    const auto is_large = [&](const Region& region) {
      const bool large = region.pixels() * layout_.cell_px * layout_.cell_px >= test_.min_region_px;
      if (!large) {
        set(region, S(0));
      }
      return large;
    };
    return w.regions_.for_each(is_large, [](const Region&) {});
  }

  bool reaches_edge(const detail::Regions& regions, const detail::Regions::Region& region) const {
    const Index stride = regions.image().stride();
    return std::any_of(regions.begin(region), regions.end(region), [&](Index at) {
      const Index row = at / stride;
      const Index col = at % stride;
      return row == 1 || row == layout_.cell_rows() || col == 1 || col == layout_.cell_cols();
    });
  }

  /// Writes the mask: expands each row of cells to a row of pixels in the workspace, and copies
  /// this to every row of pixels that the cells cover.
  template <class To>
  void write(Workspace& w, const To& to) const {
    using Cell = cell_t<To>;
    const Index size = layout_.cell_px;
    for (Index i = 0; i < layout_.cell_rows(); ++i) {
      for (Index j = 0; j < layout_.cell_cols(); ++j) {
        const Touch other = is_finite(w.difference_.length()(i, j)) ? Touch::none : Touch::unknown;
        const Touch cell = S(0) < w.mask_(i, j) ? Touch::contact : other;
        for (Index col = j * size; col < (j + 1) * size; ++col) {
          w.line_[static_cast<std::size_t>(col)] = cell;
        }
      }
      for (Index row = i * size; row < (std::min)((i + 1) * size, rows()); ++row) {
        for (Index col = 0; col < cols(); ++col) {
          const Touch touch = w.line_[static_cast<std::size_t>(col)];
          if constexpr (std::is_same_v<Cell, Touch>) {
            to(row, col) = touch;
          } else {
            to(row, col) = static_cast<Cell>(touch == Touch::contact ? 255 : 0);
          }
        }
      }
    }
  }

  void measure(const Workspace& w, ContactResult& result) const {
    double x = 0;
    double y = 0;
    const auto add = [&](Index first_row, Index width, Index cells, Index places) {
      const Index height = (std::min)(layout_.cell_px, rows() - first_row);
      const double pixels = static_cast<double>(cells * height * width);
      result.contact_px += cells * height * width;
      // `places`: sum of the cells' first columns
      x += static_cast<double>(places * height * width) +
           pixels * static_cast<double>(width - 1) / 2;
      y += pixels * (static_cast<double>(first_row) + static_cast<double>(height - 1) / 2);
    };
    const Index size = layout_.cell_px;
    const Index last = layout_.cell_cols() - 1;  // may be narrower
    for (Index i = 0; i < layout_.cell_rows(); ++i) {
      const S* mask = w.mask_.row(i);
      Index cells = 0;
      Index places = 0;
      for (Index j = 0; j < last; ++j) {
        const Index touches = S(0) < mask[j] ? 1 : 0;
        cells += touches;
        places += touches * j;
      }
      add(i * size, size, cells, places * size);
      const Index touches = S(0) < mask[last] ? 1 : 0;
      add(i * size, cols() - last * size, touches, touches * last * size);
    }
    result.unknown_px = unknown_px(w);
    if (result.in_contact()) {
      const double count = static_cast<double>(result.contact_px);
      result.area_mm2 = count * test_.mm_per_px * test_.mm_per_px;
      result.center_mm.x = (x / count - static_cast<double>(cols() - 1) / 2) * test_.mm_per_px;
      result.center_mm.y = (y / count - static_cast<double>(rows() - 1) / 2) * test_.mm_per_px;
    }
  }

  Index unknown_px(const Workspace& w) const {
    const Index size = layout_.cell_px;
    Index pixels = 0;
    for_cells([&](Index i, Index j) {
      if (!is_finite(w.difference_.length()(i, j)) && !(S(0) < w.mask_(i, j))) {
        pixels += (std::min)(size, rows() - i * size) * (std::min)(size, cols() - j * size);
      }
    });
    return pixels;
  }

  DifferenceTest test_;
  detail::CellLayout layout_;
  Colours free_;
  double threshold_ = 0;
};

}  // namespace v0
}  // namespace fingerpad
