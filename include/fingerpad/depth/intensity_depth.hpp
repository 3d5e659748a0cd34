// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Depth of one-channel pads (DTact, 9DTact). Such a pad is a translucent gel over a dark back,
// which darkens where an object presses the gel thin. The indentation follows from the logarithm of
// the ratio of the free pad's brightness to the present brightness,
//   depth = a l + b l^2 + c l^3,   l = ln(free / now),
// where the first term alone is the law of Beer and Lambert (Lin et al., "9DTact", 2023, use a
// table instead). The ratio cancels the lamp pixel by pixel; a difference does not.
// calibrate/intensity.hpp finds a, b and c from presses of a ball.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/core/status.hpp"
#include "fingerpad/image/detail/cell_filter.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v0 {

/// Coefficients of the law in mm: depth as a polynomial of the logarithm.
template <scalar S = double>
struct IntensityLaw {
  S linear_mm = S(3);  ///< a, factor of the logarithm, > 0
  S square_mm = S(0);  ///< b, factor of its square, finite
  S cube_mm = S(0);    ///< c, factor of its cube, finite
};
template <scalar S>
void expects_valid(const IntensityLaw<S>& law) {
  expects(is_finite(law.linear_mm) && S(0) < law.linear_mm, "IntensityLaw", "linear_mm",
          law.linear_mm, "finite and > 0");
  expects(is_finite(law.square_mm), "IntensityLaw", "square_mm", law.square_mm, "finite");
  expects(is_finite(law.cube_mm), "IntensityLaw", "cube_mm", law.cube_mm, "finite");
}

/// The depth in mm at ln(free / now); negative where the gel bulges.
template <scalar L, scalar S>
constexpr S pressed_depth_mm(const IntensityLaw<L>& law, const S& log_ratio) {
  const S upper = S(S(law.square_mm) + S(law.cube_mm) * log_ratio);
  return S(log_ratio * (S(law.linear_mm) + log_ratio * upper));
}

struct IntensityOptions {
  double smoothing_px = 2;  ///< sd of the Gaussian mean of the logarithms, in [0, 20]; 0: none
  double dark = 5;          ///< pixels as dark as this carry no information, >= 0
  double saturated = 255;   ///< pixels as bright as this carry no information, > dark
};
inline void expects_valid(const IntensityOptions& options) {
  constexpr const char* owner = "IntensityOptions";
  expects(options.smoothing_px >= 0 && options.smoothing_px <= 20, owner, "smoothing_px",
          options.smoothing_px, "in [0, 20]");
  expects(options.dark >= 0, owner, "dark", options.dark, ">= 0");
  expects(options.saturated > options.dark, owner, "saturated", options.saturated, "> dark");
}

/// The outcome of a frame. The status is not_of_this_pad if, along half of the frame's edge, the
/// light differs from that of the free pad by more than 5 %. The cause is another lamp, exposure,
/// channel or unit of grey, or an object as large as the frame.
struct [[nodiscard]] IntensityDepthResult {
  FrameStatus status = FrameStatus::refused;
  Index valid_px = 0;  ///< pixels with a depth

  bool accepted() const { return status != FrameStatus::refused; }
  bool ok() const { return status == FrameStatus::ok; }
};

/// Computes the indentation in frames of one size, whose pixels are numbers: a grey image, or one
/// channel of a colour image. Threads may share one object, each with its own workspace. A frame
/// takes bounded time and allocates nothing; O(rows cols).
template <scalar S = float>
class IntensityDepth {
 public:
  /// Takes a frame of the free pad. Refuses bad parameters (parameter_error).
  template <grid Free, scalar L = double>
  IntensityDepth(const Free& free, const IntensityLaw<L>& law, const IntensityOptions& options = {})
      : law_(checked(law, options)),
        options_(options),
        rows_(as_view(free).rows()),
        cols_(as_view(free).cols()) {
    expects_grid_size("IntensityDepth", rows_, cols_);
    const auto from = as_view(free);
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        free_.push_back(log_of(from(i, j)));
      }
    }
    for (std::size_t level = 0; level < log_of_byte_.size(); ++level) {
      log_of_byte_[level] = log_of(static_cast<int>(level));
    }
  }

  /// Scratch memory for a frame; one per thread.
  class Workspace {
   public:
    explicit Workspace(const IntensityDepth& depth)
        : kernel_(detail::EvenKernel<S>::gaussian((std::max)(depth.options_.smoothing_px, 1e-3))),
          log_(depth.rows_, depth.cols_, kernel_.reach()),
          weight_(log_),
          between_(log_),
          mean_(log_),
          share_(log_),
          edge_(static_cast<std::size_t>(2 * (depth.rows_ + depth.cols_))) {}

   private:
    friend class IntensityDepth;
    detail::EvenKernel<S> kernel_;
    detail::PaddedCells<S> log_, weight_, between_, mean_, share_;
    detail::ReservedVector<S> edge_;
  };
  Workspace workspace() const { return Workspace(*this); }

  /// Writes the indentation of the gel in mm; NaN where it is unknown. The height of the surface is
  /// the thickness of the gel minus the indentation.
  template <grid Frame, class Depth>
  IntensityDepthResult operator()(const Frame& frame, Depth&& depth_mm, Workspace& w) const {
    detail::writes_to<Depth, S>();
    IntensityDepthResult result;
    const auto from = as_view(frame);
    const auto to = as_view(depth_mm);
    if (from.rows() != rows_ || from.cols() != cols_ || !same_size(from, to) ||
        w.log_.rows() != rows_ || w.log_.cols() != cols_) {
      return result;
    }
    read(from, w);
    result.status = is_free_at_edge(w) ? FrameStatus::ok : FrameStatus::not_of_this_pad;
    const bool smooth = options_.smoothing_px > 0;
    if (smooth) {
      w.kernel_(w.log_, w.between_, w.mean_);
      w.kernel_(w.weight_, w.between_, w.share_);
    }
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        // a pixel without information has no depth, even if its neighbours have one
        S depth = not_a_number<S>();
        if (S(0) < w.weight_(i, j)) {
          const S l = smooth ? S(w.mean_(i, j) / w.share_(i, j)) : w.log_(i, j);
          depth = pressed_depth_mm(law_, l);
        }
        const bool is_known = is_finite(depth);  // an extreme law overflows
        result.valid_px += is_known ? 1 : 0;
        to(i, j) = static_cast<cell_t<Depth>>(is_known ? depth : not_a_number<S>());
      }
    }
    return result;
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

 private:
  template <scalar L>
  static IntensityLaw<S> checked(const IntensityLaw<L>& law, const IntensityOptions& options) {
    expects_valid(law);
    expects_valid(options);
    return {S(law.linear_mm), S(law.square_mm), S(law.cube_mm)};
  }

  /// NaN for levels without information.
  template <class Level>
  S log_of(const Level& level) const {
    using std::log;
    const S plain = S(level);
    const bool tells = S(options_.dark) < plain && plain < S(options_.saturated);
    return tells ? S(log(plain)) : not_a_number<S>();
  }

  template <class View>
  void read(const View& from, Workspace& w) const {
    const S* free = free_.data();
    for (Index i = 0; i < rows_; ++i) {
      S* log_ratio = w.log_.row(i);
      S* weight = w.weight_.row(i);
      for (Index j = 0; j < cols_; ++j, ++free) {
        S now;
        if constexpr (std::is_same_v<cell_t<View>, std::uint8_t>) {
          now = log_of_byte_[from(i, j)];
        } else {
          now = log_of(from(i, j));
        }
        const S ratio = S(*free - now);
        const bool known = is_finite(ratio);
        log_ratio[j] = known ? ratio : S(0);
        weight[j] = S(known ? 1 : 0);
      }
    }
  }

  /// Whether the frame's edge is as bright as on the free pad. The median decides, because the
  /// object may reach the edge somewhere.
  bool is_free_at_edge(Workspace& w) const {
    w.edge_.clear();
    const auto add = [&](Index i, Index j) {
      if (S(0) < w.weight_(i, j)) {
        w.edge_.push_back(w.log_(i, j));
      }
    };
    for (Index j = 0; j < cols_; ++j) {
      add(0, j);
      add(rows_ - 1, j);
    }
    for (Index i = 0; i < rows_; ++i) {
      add(i, 0);
      add(i, cols_ - 1);
    }
    const auto count = static_cast<std::ptrdiff_t>(w.edge_.size());
    if (count < rows_ + cols_) {
      return false;
    }
    const auto middle = w.edge_.begin() + count / 2;
    std::nth_element(w.edge_.begin(), middle, w.edge_.end());
    constexpr double change = 0.05;
    return S(-change) < *middle && *middle < S(change);
  }

  IntensityLaw<S> law_;
  IntensityOptions options_;
  Index rows_;
  Index cols_;
  std::vector<S> free_;  ///< logarithms of the free pad
  std::array<S, 256> log_of_byte_;
};

}  // namespace v0
}  // namespace fingerpad
