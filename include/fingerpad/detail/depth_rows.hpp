// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Rows of depth from rows of colour, by each of the inverse policies.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/detail/colour_rows.hpp"
#include "fingerpad/detail/depth_inverse.hpp"
#include "fingerpad/detail/depth_reference.hpp"
#include "fingerpad/detail/pixel_status.hpp"
#include "fingerpad/detail/scatter_polynomial.hpp"

namespace fingerpad {
inline namespace v0 {

/// Where an iteration starts: from the colours alone, or from the depth that the output grid holds.
enum class Start { cold, previous_frame };

/// The published bisection, in any scalar; `halvings` in 2..100.
struct Bisection {
  static constexpr Start start = Start::cold;
  int halvings = 16;
};

/// Newton's method on the exact equation, to the roundoff of any scalar; the reference for the
/// others, and the way to derivatives.
template <Start From = Start::cold>
struct Newton {
  static constexpr Start start = From;
};

/// Polynomials in the place of the exponentials: float and double, whole vectors at a time.
///   Order   the error of the start is raised to this power (2: a Newton step, 3: a Halley step,
///           4, 6, ...: several)
///   Degree  of the polynomial in depth
template <int Order = 3, int Degree = 6>
struct ExponentialFree {
  static constexpr Start start = Start::cold;
};

namespace detail {

/// Pixel by pixel with a function that finds one root.
template <class Heights, class S, class Scattering>
class PixelwiseRows {
 public:
  PixelwiseRows(const Camera<double>& camera,
                const Absorption<double>& fluid,
                const DepthReference<S, Scattering>& reference)
      : camera_(cast<S>(camera)), fluid_(cast<S>(fluid)), scattering_(reference.scattering) {}

  template <class FindRoot>
  void invert(Index row,
              Index cols,
              const S* red,
              const S* green,
              S* depth_mm,
              std::uint8_t* status,
              const FindRoot& find_root) const {
    for (Index j = 0; j < cols; ++j) {
      const Ray<S> ray =
          ray_at_pixel(camera_, S(static_cast<double>(row)), S(static_cast<double>(j)));
      const Pencil<S> pencil = pencil_of<Heights>(camera_, ray);
      const S g = scattering_(row, j, square(ray.plate_rho_mm));
      const DepthRoot<S> root =
          find_root(fluid_, pencil, g, Colour<S>{red[j], green[j]}, depth_mm[j]);
      depth_mm[j] = root.depth_mm;
      status[j] = static_cast<std::uint8_t>(root.status);
    }
  }

 private:
  Camera<S> camera_;
  Absorption<S> fluid_;
  Scattering scattering_;
};

template <class Inverse, class Heights, class S, class Scattering>
class DepthRows;

template <class Heights, class S, class Scattering>
class DepthRows<Bisection, Heights, S, Scattering> {
 public:
  DepthRows(const Camera<double>& camera,
            const Absorption<double>& fluid,
            const DepthReference<S, Scattering>& reference,
            const Bisection& policy)
      : rows_(camera, fluid, reference), halvings_(policy.halvings) {
    expects(halvings_ >= 2 && halvings_ <= 100, "Bisection", "halvings",
            static_cast<long long>(halvings_), "in 2..100");
  }
  void invert(Index row,
              Index cols,
              const S* red,
              const S* green,
              S* depth_mm,
              std::uint8_t* status) const {
    rows_.invert(row, cols, red, green, depth_mm, status,
                 [this](const auto& fluid, const auto& pencil, const S& g, const auto& colour,
                        const S&) { return bisect_depth(fluid, pencil, g, colour, halvings_); });
  }

 private:
  PixelwiseRows<Heights, S, Scattering> rows_;
  int halvings_;
};

template <Start From, class Heights, class S, class Scattering>
class DepthRows<Newton<From>, Heights, S, Scattering> {
 public:
  DepthRows(const Camera<double>& camera,
            const Absorption<double>& fluid,
            const DepthReference<S, Scattering>& reference,
            const Newton<From>&)
      : rows_(camera, fluid, reference) {}
  void invert(Index row,
              Index cols,
              const S* red,
              const S* green,
              S* depth_mm,
              std::uint8_t* status) const {
    rows_.invert(
        row, cols, red, green, depth_mm, status,
        [](const auto& fluid, const auto& pencil, const S& g, const auto& colour, const S& before) {
          const S start = From == Start::cold ? S(0) : before;
          return newton_depth(fluid, pencil, g, colour, start);
        });
  }

 private:
  PixelwiseRows<Heights, S, Scattering> rows_;
};

template <int Order, int Degree, class Heights, class S, class Scattering>
class DepthRows<ExponentialFree<Order, Degree>, Heights, S, Scattering> {
  static_assert(std::same_as<S, float> || std::same_as<S, double>,
                "ExponentialFree computes in float or double: use Newton for other scalars");
  using Table = ScatterPolynomial<Degree, S>;
  static constexpr bool folds_g = !std::same_as<Scattering, PixelScattering<S>>;

 public:
  DepthRows(const Camera<double>& camera,
            const Absorption<double>& fluid,
            const DepthReference<S, Scattering>& reference,
            const ExponentialFree<Order, Degree>&)
      : scattering_(reference.scattering) {
    double radius_sq_px = 1;
    for (Index i = 0; i < reference.rows; ++i) {
      for (Index j = 0; j < reference.cols; ++j) {
        if (reference.in_pad(i, j)) {
          radius_sq_px =
              (std::max)(radius_sq_px, square(static_cast<double>(i) - camera.center_y_px) +
                                           square(static_cast<double>(j) - camera.center_x_px));
        }
      }
    }
    const double radius_mm = (std::sqrt(radius_sq_px) + 1) * camera.pitch_mm;
    const auto ray = [&](double rho_mm) {
      return ray_at_tangent(camera, rho_mm / camera.pitch_mm * tangent_per_px(camera));
    };
    const auto w_over_l = [&](double l, double rho_mm) {
      const auto pencil = pencil_of<Heights>(camera, ray(rho_mm));
      const double tiny = epsilon<double>() * fluid.max_depth_mm;
      const double depth = (std::max)(l, tiny);  // W / l is smooth at 0
      const double w = scattered_light(depth, fluid.c_red_per_mm, pencil) / depth;
      if constexpr (folds_g) {
        return w *
               static_cast<double>(reference.scattering(0, 0, S(square(ray(rho_mm).plate_rho_mm))));
      } else {
        return w;
      }
    };
    const auto delta_k = [&](double rho_mm) {
      return (fluid.c_green_per_mm - fluid.c_red_per_mm) * ray(rho_mm).path_factor;
    };
    const ScatterDomain domain{camera.center_y_px, camera.center_x_px, camera.pitch_mm, radius_mm,
                               fluid.max_depth_mm};
    table_ = make_scatter_polynomial<Table>(domain, fluid.kappa, w_over_l, delta_k);
  }

  void invert(Index row,
              Index cols,
              const S* red,
              const S* green,
              S* depth_mm,
              std::uint8_t* status) const {
    if constexpr (folds_g) {
      invert_row<Order>(table_, row, cols, red, green, nullptr, depth_mm, status);
    } else {
      const S* g = scattering_.plane.data() + row * cols;
      invert_row<Order>(table_, row, cols, red, green, g, depth_mm, status);
    }
  }

 private:
  Scattering scattering_;
  Table table_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
