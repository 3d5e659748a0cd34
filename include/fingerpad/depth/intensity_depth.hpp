// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Depth of one-channel pads (DTact, 9DTact). Such a pad is a translucent gel over a dark back,
// which darkens where an object presses the gel thin. The indentation follows from the logarithm of
// the ratio of the free pad's brightness to the present brightness,
//   depth = a l + b l^2 + c l^3,   l = ln(free / now),
// where the first term alone is the law of Beer and Lambert (Lin et al., "9DTact", 2023, use a
// table instead). The ratio cancels the lamp pixel by pixel; a difference does not.
// calibrate/intensity.hpp finds a from presses of a ball.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v1 {

/// Coefficients of the law in mm: depth as a polynomial of the logarithm.
template <scalar S = double>
struct IntensityLaw {
  S linear_mm = S(3);  ///< a, factor of the logarithm, > 0
  S square_mm = S(0);  ///< b, factor of its square, finite
  S cube_mm = S(0);    ///< c, factor of its cube, finite
};
template <scalar S>
std::string check(const IntensityLaw<S>& law) {
  return check("IntensityLaw", {{"linear_mm", law.linear_mm, positive},
                                {"square_mm", law.square_mm, finite_number},
                                {"cube_mm", law.cube_mm, finite_number}});
}

/// The depth in mm at ln(free / now); negative where the gel bulges.
template <scalar L, scalar S>
constexpr S pressed_depth_mm(const IntensityLaw<L>& law, const S& log_ratio) {
  const S upper = S(law.square_mm) + S(law.cube_mm) * log_ratio;
  return log_ratio * (S(law.linear_mm) + log_ratio * upper);
}

struct IntensityOptions {
  double smoothing_px = 2;  ///< sd of the Gaussian mean of the logarithms, in [0, 20]; 0: none
  double dark = 5;          ///< pixels as dark as this carry no information, >= 0
  double saturated =
      255;  ///< pixels as bright as this carry no information, > dark; infinity: none
};
inline std::string check(const IntensityOptions& options) {
  const double saturated = (std::min)(options.saturated, (std::numeric_limits<double>::max)());
  return check("IntensityOptions",
               {{"smoothing_px", options.smoothing_px, within(0, 20)},
                {"dark", options.dark, not_negative},
                {"saturated", saturated, {.min = options.dark, .above_min = true}}});
}

/// Computes the indentation in frames of one size, whose pixels are numbers: a grey image, or one
/// channel of a colour image. Use one object a thread. A frame takes bounded time and allocates
/// nothing; O(rows cols).
template <scalar S = float>
class IntensityDepth {
 public:
  /// Takes a frame of the free pad. Refuses bad parameters (parameter_error).
  template <grid Free, scalar L = double>
  IntensityDepth(const Free& free, const IntensityLaw<L>& law, const IntensityOptions& options = {})
      : law_(checked(law, options, as_view(free))),
        options_(options),
        rows_(as_view(free).rows()),
        cols_(as_view(free).cols()),
        reach_(static_cast<Index>(std::ceil(3 * options.smoothing_px))),
        log_(static_cast<std::size_t>((rows_ + 2 * reach_) * (cols_ + 2 * reach_)), S(0)),
        weight_(log_),
        between_(log_),
        mean_(log_),
        share_(log_),
        edge_(static_cast<std::size_t>(2 * (rows_ + cols_))) {
    for (Index k = 0; k <= reach_; ++k) {
      const double x = k == 0 ? 0 : static_cast<double>(k) / options.smoothing_px;
      kernel_.push_back(S(std::exp(-x * x / 2)));
    }
    for (std::size_t level = 0; level < log_of_byte_.size(); ++level) {
      log_of_byte_[level] = log_of(static_cast<int>(level));
    }
    const auto from = as_view(free);
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        free_.push_back(log_of(from(i, j)));
      }
    }
  }

  /// Writes the indentation of the gel in mm; NaN where it is unknown. The height of the surface is
  /// the thickness of the gel minus the indentation. Grids of another size are refused. Not of this
  /// pad: along half of the frame's edge, the light differs from that of the free pad by more than
  /// 5 %. The cause is another lamp, exposure, channel or unit of grey, or an object as large as
  /// the frame.
  template <grid Frame, class Depth>
  [[nodiscard]] FrameStatus operator()(const Frame& frame, Depth&& depth_mm) {
    detail::writes_to<Depth, S>();
    const auto from = as_view(frame);
    const auto to = as_view(depth_mm);
    if (from.rows() != rows_ || from.cols() != cols_ || !same_size(from, to)) {
      return FrameStatus::refused;
    }
    read(from);
    smooth(log_, mean_);
    smooth(weight_, share_);
    for (Index i = 0; i < rows_; ++i) {
      const Index row = cell(i, 0);
      for (Index j = 0; j < cols_; ++j) {
        const auto k = static_cast<std::size_t>(row + j);
        const S depth = pressed_depth_mm(law_, mean_[k] / share_[k]);
        // no depth without information, even if the neighbours have some, or if the law overflows
        const bool is_known = S(0) < weight_[k] && is_finite(depth);
        to(i, j) = static_cast<cell_t<Depth>>(is_known ? depth : not_a_number<S>());
      }
    }
    return is_free_at_edge() ? FrameStatus::ok : FrameStatus::not_of_this_pad;
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

 private:
  template <scalar L, class View>
  static IntensityLaw<S> checked(const IntensityLaw<L>& law,
                                 const IntensityOptions& options,
                                 const View& free) {
    require(law);
    require(options);
    expects_grid_size("IntensityDepth", free.rows(), free.cols());
    return {S(law.linear_mm), S(law.square_mm), S(law.cube_mm)};
  }

  /// NaN for levels without information.
  template <class Level>
  S log_of(const Level& level) const {
    using std::log;
    if constexpr (std::is_same_v<Level, std::uint8_t>) {
      return log_of_byte_[level];
    } else {
      const S plain = S(level);
      const bool tells = S(options_.dark) < plain && plain < S(options_.saturated);
      return tells ? log(plain) : not_a_number<S>();
    }
  }

  /// Offset of a pixel in images with a border of zeros as wide as the kernel reaches.
  Index cell(Index row, Index col) const {
    return (row + reach_) * (cols_ + 2 * reach_) + col + reach_;
  }

  /// Sets log_ to the logarithms of free over now, and weight_ to 1 where they are known, else 0.
  template <class View>
  void read(const View& from) {
    const S* free = free_.data();
    for (Index i = 0; i < rows_; ++i) {
      S *log = log_.data() + cell(i, 0), *weight = weight_.data() + cell(i, 0);
      for (Index j = 0; j < cols_; ++j, ++free) {
        const S ratio = *free - log_of(from(i, j));
        const bool known = is_finite(ratio);
        log[j] = known ? ratio : S(0);
        weight[j] = S(known ? 1 : 0);
      }
    }
  }

  /// Sums weighted with the kernel, along rows and then along columns.
  void smooth(const std::vector<S>& from, std::vector<S>& to) {
    smooth(from, 1, between_);
    smooth(between_, cols_ + 2 * reach_, to);
  }
  void smooth(const std::vector<S>& from, Index step, std::vector<S>& to) const {
    for (Index i = 0; i < rows_; ++i) {
      const S* row = from.data() + cell(i, 0);
      S* sums = to.data() + cell(i, 0);
      detail::for_each_cell<S>(cols_, [&]<class V>(Index j) {
        V sum = detail::load_cells<V, S>(row + j) * kernel_[0];
        for (Index k = 1; k <= reach_; ++k) {
          const V both = detail::load_cells<V, S>(row + j - k * step) +
                         detail::load_cells<V, S>(row + j + k * step);
          sum = sum + both * kernel_[static_cast<std::size_t>(k)];
        }
        detail::store_cells<S>(sums + j, sum);
      });
    }
  }

  /// Whether the frame's edge is as bright as on the free pad. The median decides, because the
  /// object may reach the edge somewhere.
  bool is_free_at_edge() {
    edge_.clear();
    const auto add = [&](Index i, Index j) {
      const auto k = static_cast<std::size_t>(cell(i, j));
      if (S(0) < weight_[k]) {
        edge_.push_back(log_[k]);
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
    const auto count = static_cast<std::ptrdiff_t>(edge_.size());
    if (count < rows_ + cols_) {
      return false;
    }
    const auto middle = edge_.begin() + count / 2;
    std::nth_element(edge_.begin(), middle, edge_.end());
    const S change = S(0.05);
    return -change < *middle && *middle < change;
  }

  IntensityLaw<S> law_;
  IntensityOptions options_;
  Index rows_, cols_;
  std::vector<S> free_;  // logarithms of the free pad
  std::array<S, 256> log_of_byte_;
  Index reach_;  // of the kernel
  std::vector<S> kernel_;
  std::vector<S> log_, weight_;  // of free over now; 1 where it is known
  std::vector<S> between_, mean_, share_;
  detail::ReservedVector<S> edge_;
};

}  // namespace v1
}  // namespace fingerpad
