// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The reference of the depth model, a set of planes over the image: the depth of the free pad, how
// strongly the fluid scatters light there, g(x, y), and the gain of red, kappa(x, y) / kappa.
// depth/fit_reference.hpp finds them from one frame of the free pad. The light over a pad is a
// polynomial of the place on the plate, because a lamp lights no pad evenly. The depth equation
//   green exp(delta k l) - kappa(x, y) red + g(x, y) W(l) = 0
// is linear in all its coefficients.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

/// Relation of stored intensities to grey levels 0..255, and the limits beyond which they carry no
/// information. A pixel counts only if both its channels lie strictly between the two limits. Bits
/// of a 10- or 12-bit camera must be shifted to the top of 16.
struct GreyScale {
  double units_per_level = 1;  ///< stored units in one grey level: 1 for 8 bit, 256 for 16 bit
  double dark = 0;             ///< in stored units
  double saturated = 255;      ///< in stored units

  /// Whether an intensity carries information. False for NaN.
  template <scalar S>
  constexpr bool counts(const S& x) const {
    return value(x) > scalar_real_t<S>(dark) && value(x) < scalar_real_t<S>(saturated);
  }
};

/// The scale of a cell type: 16-bit images hold 256 times the grey level, all others the grey
/// level.
template <class Cell>
constexpr GreyScale grey_scale_of() {
  return std::is_same_v<Cell, std::uint16_t> ? GreyScale{256, 0, 255 * 256} : GreyScale{};
}

/// The free pad, as the depth estimator needs it. Planes have rows x cols elements.
template <scalar S>
struct DepthReference {
  Index rows = 0;
  Index cols = 0;
  std::vector<S> depth_mm;    ///< of the free pad along each pixel's ray; NaN outside
  std::vector<S> scattering;  ///< g, grey levels per mm^2; a pixel with g <= 0 or NaN is not used
  std::vector<S> red_gain;    ///< kappa of the pixel over that of the fluid; a pixel with a gain
                              ///< <= 0 or NaN is not used; empty: 1 everywhere
  Index pixels_used = 0;
  S residual_rms = S(0);  ///< of the depth equation at the known depths, grey levels
  std::vector<S> green;  ///< of the frame, grey levels; NaN where it is dark, saturated or outside.
                         ///< Frames are compared with it to detect changed light. Empty: unknown

  const S& depth(Index row, Index col) const { return depth_mm[at(row, col)]; }
  const S& g(Index row, Index col) const { return scattering[at(row, col)]; }
  S gain(Index row, Index col) const { return red_gain.empty() ? S(1) : red_gain[at(row, col)]; }
  bool in_pad(Index row, Index col) const { return is_finite(depth(row, col)); }

 private:
  std::size_t at(Index row, Index col) const { return static_cast<std::size_t>(row * cols + col); }
};

/// A polynomial of the place on the plate, with x and y in units of scale_mm.
template <scalar S, int Degree>
struct PlanePolynomial {
  static constexpr std::size_t terms = static_cast<std::size_t>((Degree + 1) * (Degree + 2) / 2);

  std::array<S, terms> coefficient = none();  ///< of 1; x, y; x^2, x y, y^2; ...
  S scale_mm = S(1);                          ///< > 0

  static std::array<S, terms> monomials(const S& x, const S& y) {
    std::array<S, terms> m = none();
    m[0] = S(1);
    std::size_t at = 1;
    for (std::size_t n = 1; n <= static_cast<std::size_t>(Degree); ++n, at += n) {
      for (std::size_t j = 0; j < n; ++j) {
        m[at + j] = m[at + j - n] * x;
      }
      m[at + n] = m[at - 1] * y;
    }
    return m;
  }
  S at(const Point2<S>& plate_mm) const {
    const auto m = monomials(plate_mm.x / scale_mm, plate_mm.y / scale_mm);
    S sum = S(0);
    for (std::size_t k = 0; k < terms; ++k) {
      sum = sum + coefficient[k] * m[k];
    }
    return sum;
  }

 private:
  static std::array<S, terms> none() {
    std::array<S, terms> all;
    all.fill(S(0));
    return all;
  }
};

/// The light over a pad. A lamp's colours vary less than its brightness.
template <scalar S = double, int Degree = 6>
struct PadLight {
  PlanePolynomial<S, Degree> scattering;           ///< g, grey levels per mm^2
  PlanePolynomial<S, (Degree > 0 ? 1 : 0)> kappa;  ///< alpha_G beta_G / (alpha_R beta_R)
};

/// The light of a frame over that of the reference: 1, 1 if it is the same.
struct LightGains {
  double green = 1;  ///< > 0
  double red = 1;    ///< > 0
};

namespace detail {

/// Calls visit(row, col) for every pixel.
template <class Visit>
void each_pixel(Index rows, Index cols, const Visit& visit) {
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      visit(i, j);
    }
  }
}

/// Depth up to which a pixel of the free pad counts as near the rim, where a press hardly moves it.
inline double rim_depth_mm(double deepest_mm) {
  return 0.2 * deepest_mm;
}

/// `rows` x `cols` pixels from (row, col) on.
struct PadArea {
  Index row = 0;
  Index col = 0;
  Index rows = 0;
  Index cols = 0;
};

/// The smallest area with all pixels that have a depth; empty if there are none.
template <scalar S>
PadArea area_of(const DepthReference<S>& reference) {
  Index first_row = reference.rows, last_row = 0, first_col = reference.cols, last_col = 0;
  each_pixel(reference.rows, reference.cols, [&](Index i, Index j) {
    if (reference.in_pad(i, j)) {
      first_row = (std::min)(first_row, i);
      last_row = i + 1;
      first_col = (std::min)(first_col, j);
      last_col = (std::max)(last_col, j + 1);
    }
  });
  return {first_row, first_col, last_row - first_row, last_col - first_col};
}

/// A view of the area in a frame.
template <class T>
StridedView<T> crop(const StridedView<T>& frame, const PadArea& area) {
  return region(frame, area.row, area.col, area.rows, area.cols);
}
template <class View>
auto crop(const View& frame, const PadArea& area) {
  return LazyView(area.rows, area.cols, [frame, area](Index i, Index j) -> decltype(auto) {
    return frame(area.row + i, area.col + j);
  });
}

/// At most 1024 pixels near the rim. A press hardly moves the rim, so that a change of its light
/// shows another lamp or membrane.
class Rim {
 public:
  template <scalar S>
  explicit Rim(const DepthReference<S>& reference) {
    if (reference.green.empty()) {
      return;
    }
    double deepest_mm = 0;
    for (const S& l : reference.depth_mm) {
      deepest_mm = l > S(deepest_mm) ? static_cast<double>(l) : deepest_mm;
    }
    std::vector<std::array<Index, 2>> rim;
    each_pixel(reference.rows, reference.cols, [&](Index i, Index j) {
      if (reference.depth(i, j) <= S(rim_depth_mm(deepest_mm))) {
        rim.push_back({i, j});
      }
    });
    double sum = 0, count = 0;
    for (const auto& [row, col] : rim) {
      const auto g = reference.green[static_cast<std::size_t>(row * reference.cols + col)];
      if (is_finite(g)) {
        sum += static_cast<double>(value(g));
        count += 1;
      }
    }
    reference_ = sum / count;
    for (std::size_t k = 0; reference_ > 0 && k < rim.size(); k += rim.size() / 1024 + 1) {
      pixels_.push_back(rim[k]);
    }
  }

  /// Whether green is more than 5 % lighter or darker than in the reference under a light of gain
  /// `expected`, or mostly dark or saturated. Displaced printed dots change the light by 1 % with a
  /// thousand samples and by 4 % with 64; fewer tell nothing.
  template <class Red, class Green>
  bool has_changed(const Red& red, const Green& green, double expected) const {
    constexpr GreyScale scale = grey_scale_of<cell_t<Red>>();
    double used = 0, sum = 0;
    for (const auto& [row, col] : pixels_) {
      const auto g = static_cast<double>(green(row, col));
      if (scale.counts(static_cast<double>(red(row, col))) && scale.counts(g)) {
        used += 1;
        sum += g / (scale.units_per_level * reference_ * expected);
      }
    }
    const bool mostly_used = 2 * used >= static_cast<double>(pixels_.size());
    return pixels_.size() >= 64 && !(mostly_used && std::abs(sum / used - 1) <= 0.05);
  }

 private:
  double reference_ = 0;
  std::vector<std::array<Index, 2>> pixels_;  // row and column
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
