// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Normal force from the dots alone: under a load they move apart, or together. The measure is the
// divergence of their displacements, integrated over the contact. On an elastic half-space it is
// -(1 - 2 nu) F / (2 G) for every shape of contact, because the divergence of Boussinesq's surface
// displacements is -(1 - 2 nu) / (2 G) times the pressure, point by point (K. L. Johnson, "Contact
// Mechanics", 1985, eq. 3.18). Gel that comes closer to the camera, and thin gel that is squeezed
// aside, make it positive. So the constant is calibrated: calibrate/dot_divergence.hpp fits a curve
// of normal_force.hpp over the measure.
//
// The integral is the area between the dots minus the same area on the free pad. Cells that share a
// side share its dots, so only the noise of the dots around the contact counts. Shift and rotation
// of the pad do not change areas. Shear removes as much divergence behind the object as it adds in
// front of it. A remainder is left because the cells do not lie evenly about the object; it is
// included in the variance.
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/core/status.hpp"
#include "fingerpad/force/normal_force.hpp"

namespace fingerpad {
inline namespace v0 {

struct DivergenceOptions {
  double noise_mm = 0.005;  ///< sd of a dot's position, per axis, > 0; default: 0.06 px of 0.08 mm
  Index free_frames = 1;    ///< number of frames of which the free dots are the mean, >= 1
  bool parts = true;        ///< false: a load draws the dots together; the area is negated
  /// Largest share of dots missing or misplaced, in [0, 1); beyond it there is no measure.
  double max_filled = 0.2;
};
inline void expects_valid(const DivergenceOptions& options) {
  constexpr const char* owner = "DivergenceOptions";
  expects(is_finite(options.noise_mm) && options.noise_mm > 0, owner, "noise_mm", options.noise_mm,
          "finite and > 0");
  expects(options.free_frames >= 1, owner, "free_frames",
          static_cast<long long>(options.free_frames), ">= 1");
  expects(options.max_filled >= 0 && options.max_filled < 1, owner, "max_filled",
          options.max_filled, "in [0, 1)");
}

/// The outcome of a frame. The status is not_of_this_pad if the area of the contact's cells has
/// changed by more than half: the dots are in another unit or order than those of the free pad.
template <scalar S = double>
struct [[nodiscard]] DivergenceResult {
  FrameStatus status = FrameStatus::refused;
  /// Area by which the load moves the dots apart; 0 without contact. NaN if too many dots are
  /// missing, or if not_of_this_pad.
  S area_mm2 = not_a_number<S>();
  S variance_mm4 = not_a_number<S>();  ///< variance of area_mm2, by noise of the dots and by shear
  Index dots = 0;                      ///< dots in the contact and around it
  Index filled = 0;  ///< of these, missing or misplaced: they move like their neighbours

  bool ok() const { return status == FrameStatus::ok && is_finite(area_mm2); }
};

/// Measures the divergence over a contact. Threads may share one object, each with its own
/// workspace. A frame allocates nothing, throws nothing, and takes O(rows cols) time.
template <scalar S = double>
class DotDivergence {
 public:
  /// Takes the free pad's dots in mm (NaN: not found). Refuses bad parameters (parameter_error).
  template <dot_grid Dots>
  explicit DotDivergence(const Dots& free_mm, const DivergenceOptions& options = {})
      : rows_(as_view(free_mm).rows()), cols_(as_view(free_mm).cols()), options_(options) {
    expects_valid(options);
    expects_grid_size("DotDivergence", rows_, cols_, 2);
    free_.resize(static_cast<std::size_t>(rows_ * cols_));
    read(as_view(free_mm), free_);
    shape_ = free_;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      shape_[k] = is_finite(free_[k]) ? free_[k] : between(k);
    }
    S sum = S(0), area = S(0);
    int count = 0;
    for_cells([&](const Cell& at) {
      const S twice = cross(shape_[at[2]] - shape_[at[0]], shape_[at[3]] - shape_[at[1]]);
      area = is_finite(twice) ? S(area + twice) : area;
      const S sq = squared_norm(shape_[at[1]] - shape_[at[0]]);
      sum = is_finite(sq) ? S(sum + sq) : sum;
      count += is_finite(sq) ? 1 : 0;
    });
    max_off_sq_ = S(sum / S(4 * (std::max)(count, 1)));
    is_mirrored_ = area < S(0);
  }

  /// Scratch memory for a frame; one per thread.
  class Workspace {
   public:
    explicit Workspace(const DotDivergence& divergence)
        : moves_(divergence.free_.size()), dots_(divergence.free_.size()) {}

   private:
    friend class DotDivergence;
    struct Dot {
      bool counts = false;  // a corner of a cell that touches
      bool filled = false;
      Point2<S> moved;  // displacement from the free pad
      S variance;       // of the displacement, per axis
      Point2<S> slope;  // derivative of the area by its position
    };
    std::vector<Point2<S>> moves_;  // displacements of the dots found
    std::vector<Dot> dots_;
  };
  Workspace workspace() const { return Workspace(*this); }

  /// The divergence in a frame with dots `dots_mm` (NaN: not found). A true `contact` marks the
  /// dots that touch the object. The area is summed over the cells of four dots of which at least
  /// one touches.
  template <dot_grid Dots, contact_mask Contact>
  DivergenceResult<S> operator()(const Dots& dots_mm,
                                 const Contact& contact,
                                 Workspace& workspace) const {
    const auto dots = as_view(dots_mm);
    const auto touch = as_view(contact);
    if (dots.rows() != rows_ || dots.cols() != cols_ || !same_size(dots, touch) ||
        workspace.dots_.size() != free_.size()) {
      return {};
    }
    read(dots, workspace.moves_);
    const auto touches = [&](std::size_t k) {
      const Index i = static_cast<Index>(k) / cols_;
      return is_contact(cell_t<Contact>(touch(i, static_cast<Index>(k) - i * cols_)));
    };
    place(workspace);
    for_cells([&](const Cell& at) {
      if (std::any_of(at.begin(), at.end(), touches)) {
        for (const std::size_t k : at) {
          workspace.dots_[k].counts = true;
        }
      }
    });
    return area_of(touches, workspace);
  }

 private:
  using Cell = std::array<std::size_t, 4>;  // its dots, in order around the cell

  template <class View>
  static void read(const View& dots, std::vector<Point2<S>>& to) {
    using Traits = point_traits<cell_t<View>>;
    std::size_t k = 0;
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j, ++k) {
        const cell_t<View> p = dots(i, j);
        const Point2<S> place = {S(Traits::x(p)), S(Traits::y(p))};
        to[k] = is_plausible(place) ? place : Point2<S>{not_a_number<S>(), not_a_number<S>()};
      }
    }
  }
  template <class Visit>
  void for_cells(const Visit& visit) const {
    const auto cols = static_cast<std::size_t>(cols_);
    for (std::size_t first = 0; first + cols < free_.size(); ++first) {
      if ((first + 1) % cols != 0) {
        visit(Cell{first, first + 1, first + cols + 1, first + cols});
      }
    }
  }

  /// Free position of a dot that was not found on the free pad: the middle of its two neighbours in
  /// the row, else of those in the column.
  Point2<S> between(std::size_t k) const {
    const auto cols = static_cast<std::size_t>(cols_);
    const S half = S(S(1) / S(2));
    const bool in_row = k % cols > 0 && (k + 1) % cols > 0;
    const bool in_col = k >= cols && k + cols < free_.size();
    const Point2<S> row = in_row ? half * (free_[k - 1] + free_[k + 1]) : free_[k];
    return is_finite(row) || !in_col ? row : half * (free_[k - cols] + free_[k + cols]);
  }

  /// Displacements of the dots. A dot that is missing, or moves unlike its neighbours, gets their
  /// median displacement.
  void place(Workspace& workspace) const {
    std::vector<Point2<S>>& moves = workspace.moves_;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      moves[k] = moves[k] - free_[k];
    }
    const Point2<S> none = {S(0), S(0)};
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const Beside beside = beside_of(k, moves);
      const bool alone = beside.count < 3;
      const bool found =
          is_finite(moves[k]) && (alone || squared_norm(moves[k] - beside.moved) < max_off_sq_);
      workspace.dots_[k] = {false, !found, found || alone ? moves[k] : beside.moved,
                            found ? S(square(options_.noise_mm)) : beside.variance, none};
    }
  }

  struct Beside {
    int count = 0;
    Point2<S> moved = {S(0), S(0)};
    S variance = S(0);
  };
  /// Median displacement of the up to eight neighbours of a dot, and their scatter about it.
  Beside beside_of(std::size_t k, const std::vector<Point2<S>>& moves) const {
    std::array<S, 8> x, y;
    Beside beside;
    const Index row = static_cast<Index>(k) / cols_;
    const Index col = static_cast<Index>(k) - row * cols_;
    for (Index i = (std::max)(Index(0), row - 1); i <= (std::min)(rows_ - 1, row + 1); ++i) {
      for (Index j = (std::max)(Index(0), col - 1); j <= (std::min)(cols_ - 1, col + 1); ++j) {
        const Point2<S>& moved = moves[static_cast<std::size_t>(i * cols_ + j)];
        if ((i != row || j != col) && is_finite(moved)) {
          x[static_cast<std::size_t>(beside.count)] = moved.x;
          y[static_cast<std::size_t>(beside.count)] = moved.y;
          ++beside.count;
        }
      }
    }
    if (beside.count > 0) {
      beside.moved = {median(x, beside.count), median(y, beside.count)};
      for (std::size_t n = 0; n < static_cast<std::size_t>(beside.count); ++n) {
        beside.variance = S(beside.variance + square(S(x[n] - beside.moved.x)) +
                            square(S(y[n] - beside.moved.y)));
      }
      beside.variance = S(beside.variance / S(2 * beside.count));
    }
    return beside;
  }
  static S median(std::array<S, 8>& values, int count) {
    const auto middle = values.begin() + count / 2;
    std::nth_element(values.begin(), middle, values.begin() + count);
    return *middle;
  }

  template <class Touches>
  DivergenceResult<S> area_of(const Touches& touches, Workspace& workspace) const {
    DivergenceResult<S> result{FrameStatus::ok, S(0), S(0)};
    S twice_free = S(0);
    for_cells([&](const Cell& at) {
      if (std::any_of(at.begin(), at.end(), touches)) {
        result.area_mm2 = S(result.area_mm2 + parted(at, workspace.dots_));
        twice_free += cross(shape_[at[2]] - shape_[at[0]], shape_[at[3]] - shape_[at[1]]);
      }
    });
    const S free_variance =
        S(square(options_.noise_mm) / static_cast<double>(options_.free_frames));
    Mean inside, outside;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const auto& dot = workspace.dots_[k];
      if (dot.counts) {
        ++result.dots;
        result.filled += dot.filled ? 1 : 0;
        result.variance_mm4 =
            S(result.variance_mm4 + squared_norm(dot.slope) * (dot.variance + free_variance));
      }
      if (!dot.counts || touches(k)) {
        (dot.counts ? inside : outside).add(dot.moved);
      }
    }
    // the center of the cells is off that of the load by up to half a pitch, a variance of
    // pitch^2 / 12; shear shifts the contact and so turns this offset into area
    const S sheared_sq = squared_norm(inside.mean() - outside.mean());
    result.variance_mm4 = S(result.variance_mm4 + sheared_sq * max_off_sq_ / S(3));
    const double allowed = options_.max_filled * static_cast<double>(result.dots);
    if (S(square(twice_free)) < S(16) * S(square(result.area_mm2))) {
      result.status = FrameStatus::not_of_this_pad;
    }
    if (static_cast<double>(result.filled) > allowed || result.status != FrameStatus::ok) {
      result.area_mm2 = result.variance_mm4 = not_a_number<S>();
    }
    result.area_mm2 = options_.parts == is_mirrored_ ? S(-result.area_mm2) : result.area_mm2;
    return result;
  }
  struct Mean {
    Point2<S> sum = {S(0), S(0)};
    int count = 0;

    void add(const Point2<S>& moved) {
      if (is_finite(moved)) {
        sum += moved;
        ++count;
      }
    }
    Point2<S> mean() const { return count > 0 ? sum / S(count) : sum; }
  };

  /// Growth of a cell's area, which is half the cross product of its diagonals. Adds its
  /// derivatives to the slopes of the dots.
  S parted(const Cell& at, std::vector<typename Workspace::Dot>& dots) const {
    const auto change = [&](std::size_t to, std::size_t from) {
      return dots[at[to]].moved - dots[at[from]].moved;
    };
    const Point2<S> p = shape_[at[2]] - shape_[at[0]], dp = change(2, 0);
    const Point2<S> q = shape_[at[3]] - shape_[at[1]], dq = change(3, 1);
    const S half = S(S(1) / S(2));
    const Point2<S> by_p = half * Point2<S>{S(q.y + dq.y), S(-q.x - dq.x)};
    const Point2<S> by_q = half * Point2<S>{S(-p.y - dp.y), S(p.x + dp.x)};
    dots[at[2]].slope += by_p;
    dots[at[0]].slope += S(-1) * by_p;
    dots[at[3]].slope += by_q;
    dots[at[1]].slope += S(-1) * by_q;
    return S(half * (cross(p, dq) + cross(dp, q) + cross(dp, dq)));
  }
  static S cross(const Point2<S>& a, const Point2<S>& b) { return S(a.x * b.y - a.y * b.x); }

  Index rows_ = 0, cols_ = 0;
  DivergenceOptions options_;
  std::vector<Point2<S>> free_;   // NaN where not found
  std::vector<Point2<S>> shape_;  // free_ with missing dots filled in
  S max_off_sq_ = S(0);           // (pitch / 2)^2
  bool is_mirrored_ = false;      // y points up, or columns count to the left
};

/// The normal force from a curve over the divergence. Its variance is that of the curve plus that
/// of the dots. Without a divergence there is no force (not_finite).
template <class Curve, class Compensation, scalar S>
NormalForceResult<S> normal_force(const NormalForce<Curve, Compensation>& curve,
                                  const DivergenceResult<S>& divergence) {
  NormalForceResult<S> result = curve(divergence.area_mm2);
  const S slope = curve.curve().slope(divergence.area_mm2);
  result.variance_n2 = S(result.variance_n2 + square(slope) * divergence.variance_mm4);
  return result;
}

}  // namespace v0
}  // namespace fingerpad
