// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Rows of depth from rows of colour, for each root finder.
#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "fingerpad/depth/depth_inverse.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/detail/scatter_polynomial.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

// Computes one image row of depths from a ScatterPolynomial, one vector register of pixels at a
// time. No allocation, no branch per pixel; a pixel without a depth gets NaN and the reason.

/// Improves a root s of sum f[j] s^{j+1} = target until its error is of the given order in the
/// error of the start: a Halley step for every factor 3 of Order, a Newton step for every 2.
template <int Order, std::size_t Degree, class V>
[[gnu::always_inline]] inline V refine(const V (&f)[Degree], V target, V s) noexcept {
  static_assert(Order == 1 || Order % 2 == 0 || Order % 3 == 0);
  if constexpr (Order == 1) {
    return s;
  } else {
    constexpr bool is_halley = Order % 3 == 0;
    V bend = f[Degree - 1];  // half the second derivative
    V slope = f[Degree - 1];
    V value = f[Degree - 1] * s + f[Degree - 2];
    slope = slope * s + value;
    for (int j = int(Degree) - 3; j >= 0; --j) {
      if constexpr (is_halley) {
        bend = bend * s + slope;
      }
      value = value * s + f[j];
      slope = slope * s + value;
    }
    value = value * s - target;
    if constexpr (is_halley) {
      return refine<Order / 3>(f, target, s - value * slope / (slope * slope - value * bend));
    } else {
      return refine<Order / 2>(f, target, s - value / slope);
    }
  }
}

/// A NaN that holds the reason in its last two bits; any other NaN reads as `not_a_number`.
template <class Scalar>
constexpr Scalar nan_because(PixelStatus why) {
  using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
  const Bits bits = std::bit_cast<Bits>(std::numeric_limits<Scalar>::quiet_NaN());
  return std::bit_cast<Scalar>(bits | Bits(3 - int(why)));
}

/// Reads the reasons back from `Count` depths.
template <std::size_t Count, class Scalar>
void write_status(const Scalar* depth_mm, PixelStatus* status) noexcept {
  using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
  Bits bits[Count];
  PixelStatus code[Count];
  std::memcpy(bits, depth_mm, sizeof bits);
  constexpr Bits infinity = std::bit_cast<Bits>(std::numeric_limits<Scalar>::infinity());
  for (std::size_t i = 0; i < Count; ++i) {
    code[i] = PixelStatus((bits[i] & ~Bits(0) >> 1) > infinity ? 3 - (bits[i] & 3) : 0);
  }
  std::memcpy(status, code, sizeof code);
}

/// Depth of one register of pixels, or a NaN with its reason. `gain` is a V, or nullptr if g is
/// folded into the table.
template <int Order, class Table, class V, class Gain>
[[gnu::always_inline]] inline V invert(
    const Table& table, V u, V red, V green, Gain gain) noexcept {
  using Scalar = decltype(Table::kappa);
  constexpr bool has_gain = !std::is_null_pointer_v<Gain>;
  constexpr std::size_t degree = sizeof(table.scatter) / sizeof(table.scatter[0]);
  V f[degree];
  V total = V{};
#pragma GCC unroll 16
  for (int j = int(degree) - 1; j >= 0; --j) {
    f[j] = polynomial(table.scatter[j], Table::scatter_radial(j), u);
    if constexpr (has_gain) {
      f[j] = f[j] * gain;
    }
    if (j < Table::exp_degree) {
      f[j] = f[j] + green * polynomial(table.exp_minus_1[j], Table::exp_radial(j), u);
    }
    total = j == int(degree) - 1 ? f[j] : total + f[j];
  }
  const V target = table.kappa * red - green;
  const V scaled = target * total;
  const V s = refine<Order>(f, target, scaled / (f[0] * (total - target) + scaled));
  auto inside = (target >= Scalar(0)) & (target <= total);
  if constexpr (has_gain) {
    inside = inside & (gain > Scalar(0));
  }
  const V nan = V{} + nan_because<Scalar>(PixelStatus::not_a_number);
  const V below = V{} + nan_because<Scalar>(PixelStatus::below_range);
  const V above = V{} + nan_because<Scalar>(PixelStatus::above_range);
  const V none = target < Scalar(0) ? below : target > total ? above : nan;
  return inside ? s * table.l_max_mm : none;
}

/// Columns [first, last) of a row that the table covers.
struct ColumnSpan {
  std::ptrdiff_t first, last;
};

template <class Table>
ColumnSpan covered_columns(const Table& table, std::ptrdiff_t row, std::ptrdiff_t cols) noexcept {
  const double scale = double(table.u_root_per_px);
  const double dy = (double(row) - double(table.center_row_px)) * scale;
  if (!(dy * dy <= 1)) {
    return {0, 0};
  }
  const double half_px = std::sqrt(1 - dy * dy) / scale;
  const auto clamp = [&](double col) {
    return col > 0 ? col < double(cols) ? std::ptrdiff_t(col) : cols : std::ptrdiff_t(0);
  };
  const std::ptrdiff_t first = clamp(std::ceil(double(table.center_col_px) - half_px));
  const std::ptrdiff_t last = clamp(std::floor(double(table.center_col_px) + half_px) + 1);
  return {first, last < first ? first : last};
}

/// Number of pixels that are inverted between two checks of their status.
inline constexpr std::ptrdiff_t inversion_block = 64;

/// Computes the depths of a block of pixels from column `first` on. Returns false if any of them
/// has none.
template <int Order, class V, class Table, class Scalar, class Gain>
[[gnu::always_inline]] inline bool invert_block(const Table& table,
                                                std::ptrdiff_t row,
                                                std::ptrdiff_t first,
                                                const Scalar* red,
                                                const Scalar* green,
                                                Gain gain,
                                                Scalar* depth_mm) noexcept {
  constexpr auto width = std::ptrdiff_t(sizeof(V) / sizeof(Scalar));
  Scalar steps[std::size_t(width)];
  for (std::ptrdiff_t i = 0; i < width; ++i) {
    steps[i] = Scalar(i) - table.center_col_px;
  }
  const V ramp = load_cells<V, Scalar>(steps);
  const Scalar dy = (Scalar(row) - table.center_row_px) * table.u_root_per_px;
  const Scalar dy_sq = dy * dy;
  auto bad = V{} != V{};
  for (std::ptrdiff_t i = 0; i < inversion_block; i += width) {
    const V dx = (ramp + Scalar(first + i)) * table.u_root_per_px;
    const V u = dx * dx + dy_sq;
    const V r = load_cells<V, Scalar>(red + i);
    const V b = load_cells<V, Scalar>(green + i);
    V l;
    if constexpr (std::is_null_pointer_v<Gain>) {
      l = invert<Order>(table, u, r, b, nullptr);
    } else {
      l = invert<Order>(table, u, r, b, load_cells<V, Scalar>(gain + i));
    }
    bad = bad | (l != l);
    store_cells<Scalar>(depth_mm + i, l);
  }
  return !any_lane(bad);
}

/// Depths of one image row. `gain` is a row of g, or nullptr when g is folded into the table; a
/// pixel whose g is not positive gets no depth. An output may be an input of the same column.
template <int Order, class Table, class Scalar, class Gain>
void invert_row(const Table& table,
                std::ptrdiff_t row,
                std::ptrdiff_t cols,
                const Scalar* red,
                const Scalar* green,
                Gain gain,
                Scalar* depth_mm,
                PixelStatus* status) noexcept {
  constexpr bool has_gain = !std::is_null_pointer_v<Gain>;
  constexpr auto block = inversion_block;
  using V = lanes<Scalar, row_lanes<Scalar>>;
  const Table local = table;  // cannot alias the outputs, so it can stay in registers
  const auto [begin, end] = covered_columns(table, row, cols);
  std::fill(depth_mm, depth_mm + begin, std::numeric_limits<Scalar>::quiet_NaN());
  std::fill(depth_mm + end, depth_mm + cols, std::numeric_limits<Scalar>::quiet_NaN());
  std::fill(status, status + begin, PixelStatus::outside_pad);
  std::fill(status + end, status + cols, PixelStatus::outside_pad);
  PixelStatus code[std::size_t(block)];
  std::ptrdiff_t first = begin;
  for (; first + block <= end; first += block) {
    Gain g = gain;
    if constexpr (has_gain) {
      g += first;
    }
    if (invert_block<Order, V>(local, row, first, red + first, green + first, g,
                               depth_mm + first)) {
      std::fill_n(status + first, block, PixelStatus::ok);
    } else {
      write_status<std::size_t(block)>(depth_mm + first, code);
      std::copy_n(code, block, status + first);
    }
  }
  if (const std::ptrdiff_t rest = end - first; rest > 0) {
    Scalar spare[4][std::size_t(block)] = {};
    std::copy_n(red + first, rest, spare[0]);
    std::copy_n(green + first, rest, spare[1]);
    if constexpr (has_gain) {
      std::copy_n(gain + first, rest, spare[2]);
      invert_block<Order, V>(local, row, first, spare[0], spare[1], spare[2], spare[3]);
    } else {
      invert_block<Order, V>(local, row, first, spare[0], spare[1], nullptr, spare[3]);
    }
    write_status<std::size_t(block)>(spare[3], code);
    std::copy_n(code, rest, status + first);
    std::copy_n(spare[3], rest, depth_mm + first);
  }
}

/// Pixel by pixel, with an `Inverse` that finds the root of one pixel.
template <class Inverse, class Heights, class S, class Scattering>
class DepthRows {
 public:
  DepthRows(const Camera<double>& camera,
            const Absorption<double>& fluid,
            const DepthReference<S, Scattering, Heights>& reference,
            const Inverse& find_root)
      : camera_(cast<S>(camera)),
        fluid_(cast<S>(fluid)),
        scattering_(reference.scattering),
        find_root_(find_root) {
    expects_valid(find_root);
  }

  void invert(
      Index row, Index cols, const S* red, const S* green, S* depth_mm, PixelStatus* status) const {
    for (Index j = 0; j < cols; ++j) {
      const Ray<S> ray =
          ray_at_pixel(camera_, S(static_cast<double>(row)), S(static_cast<double>(j)));
      const Pencil<S> pencil = pencil_of<Heights>(camera_, ray);
      const S g = scattering_(row, j, square(ray.plate_rho_mm));
      const DepthRoot<S> root = find_root_(fluid_, pencil, g, Colour<S>{red[j], green[j]});
      depth_mm[j] = root.depth_mm;
      status[j] = root.status;
    }
  }

 private:
  Camera<S> camera_;
  Absorption<S> fluid_;
  Scattering scattering_;
  Inverse find_root_;
};

template <int Order, int Degree, int Radial, class Heights, class S, class Scattering>
class DepthRows<ExponentialFree<Order, Degree, Radial>, Heights, S, Scattering> {
  static_assert(std::same_as<S, float> || std::same_as<S, double>,
                "ExponentialFree computes in float or double: use Newton for other scalars");
  using Table = ScatterPolynomial<Degree, S, Radial>;
  static constexpr bool folds_g = Scattering::is_radial;

 public:
  DepthRows(const Camera<double>& camera,
            const Absorption<double>& fluid,
            const DepthReference<S, Scattering, Heights>& reference,
            const ExponentialFree<Order, Degree, Radial>&)
      : scattering_(reference.scattering) {
    const auto pencil = [&](double rho_mm) {  // rho of a pinhole: radius in px times pitch
      const double tangent = rho_mm / camera.pitch_mm * tangent_per_px(camera);
      return pencil_of<Heights>(camera, ray_at_tangent(camera, tangent));
    };
    const auto g = [&](double rho_mm) {
      if constexpr (folds_g) {
        const double tangent = rho_mm / camera.pitch_mm * tangent_per_px(camera);
        const double on_plate = ray_at_tangent(camera, tangent).plate_rho_mm;
        return static_cast<double>(reference.scattering(0, 0, S(on_plate * on_plate)));
      } else {
        return 1.0;  // a row of g multiplies the table
      }
    };
    const double shallow = epsilon<double>() * fluid.max_depth_mm;  // W / l is smooth at 0
    const auto w_over_l = [&](double l, double rho_mm) {
      const double depth = (std::max)(l, shallow);
      return g(rho_mm) * scattered_light(depth, fluid.c_red_per_mm, pencil(rho_mm)) / depth;
    };
    const auto delta_k = [&](double rho_mm) {
      return (fluid.c_green_per_mm - fluid.c_red_per_mm) * pencil(rho_mm).path_factor;
    };
    const ScatterDomain domain{camera.center_y_px, camera.center_x_px, camera.pitch_mm,
                               (pad_radius_px(camera, reference) + 1) * camera.pitch_mm,
                               fluid.max_depth_mm};
    table_ = make_scatter_polynomial<Table>(domain, fluid.kappa, w_over_l, delta_k);
    double gain = 1;
    if constexpr (!folds_g) {
      gain = static_cast<double>(reference.scattering.largest());
    }
    const double bound = error_bound_mm(table_, domain, w_over_l, delta_k, 255.0, gain);
    expects(
        bound <= 0.005, "ExponentialFree", "error of the polynomials in mm", bound,
        "<= 0.005: is the reference of the free pad? If g or the angle of view really varies so "
        "much, take a higher Degree or Radial");
  }

  void invert(
      Index row, Index cols, const S* red, const S* green, S* depth_mm, PixelStatus* status) const {
    if constexpr (folds_g) {
      invert_row<Order>(table_, row, cols, red, green, nullptr, depth_mm, status);
    } else {
      invert_row<Order>(table_, row, cols, red, green, scattering_.row(row), depth_mm, status);
    }
  }

 private:
  static double pad_radius_px(const Camera<double>& camera,
                              const DepthReference<S, Scattering, Heights>& reference) {
    double radius_sq = 0;
    for (Index i = 0; i < reference.rows; ++i) {
      for (Index j = 0; j < reference.cols; ++j) {
        if (reference.in_pad(i, j)) {
          radius_sq =
              (std::max)(radius_sq, square(static_cast<double>(i) - camera.center_y_px) +
                                        square(static_cast<double>(j) - camera.center_x_px));
        }
      }
    }
    return std::sqrt(radius_sq);
  }

  Scattering scattering_;
  Table table_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
