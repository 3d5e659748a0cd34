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

#include "fingerpad/depth/depth_inverse.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/detail/invert_row.hpp"
#include "fingerpad/depth/detail/scatter_polynomial.hpp"

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
///   Order   the error of the start, 0.03 to 0.06 mm, is raised to this power by a Newton step for
///           each factor 2 and a Halley step for each factor 3
///   Degree  of the polynomials in depth, Radial of those in rho^2
/// For depths up to 14 mm of the published fluid <2, 5> stays below 1e-4 mm and is the fastest; the
/// default stays below 1e-5 mm; <3, 6, 4> suits wide-angle cameras and strongly varying g; <9, 12,
/// 8> in double stays below 1e-12 mm. A sensor for which the polynomials miss 0.005 mm is refused.
template <int Order = 3, int Degree = 6, int Radial = 3>
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
                const DepthReference<S, Scattering, Heights>& reference)
      : camera_(cast<S>(camera)), fluid_(cast<S>(fluid)), scattering_(reference.scattering) {}

  template <class FindRoot>
  void invert(Index row,
              Index cols,
              const S* red,
              const S* green,
              S* depth_mm,
              PixelStatus* status,
              const FindRoot& find_root) const {
    for (Index j = 0; j < cols; ++j) {
      const Ray<S> ray =
          ray_at_pixel(camera_, S(static_cast<double>(row)), S(static_cast<double>(j)));
      const Pencil<S> pencil = pencil_of<Heights>(camera_, ray);
      const S g = scattering_(row, j, square(ray.plate_rho_mm));
      const DepthRoot<S> root =
          find_root(fluid_, pencil, g, Colour<S>{red[j], green[j]}, depth_mm[j]);
      depth_mm[j] = root.depth_mm;
      status[j] = root.status;
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
            const DepthReference<S, Scattering, Heights>& reference,
            const Bisection& policy)
      : rows_(camera, fluid, reference), halvings_(policy.halvings) {
    expects(halvings_ >= 2 && halvings_ <= 100, "Bisection", "halvings",
            static_cast<long long>(halvings_), "in 2..100");
  }
  void invert(
      Index row, Index cols, const S* red, const S* green, S* depth_mm, PixelStatus* status) const {
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
            const DepthReference<S, Scattering, Heights>& reference,
            const Newton<From>&)
      : rows_(camera, fluid, reference) {}
  void invert(
      Index row, Index cols, const S* red, const S* green, S* depth_mm, PixelStatus* status) const {
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

template <int Order, int Degree, int Radial, class Heights, class S, class Scattering>
class DepthRows<ExponentialFree<Order, Degree, Radial>, Heights, S, Scattering> {
  static_assert(std::same_as<S, float> || std::same_as<S, double>,
                "ExponentialFree computes in float or double: use Newton for other scalars");
  using Table = ScatterPolynomial<Degree, S, Radial>;
  static constexpr bool folds_g = !std::same_as<Scattering, PixelScattering<S>>;

 public:
  DepthRows(const Camera<double>& camera,
            const Absorption<double>& fluid,
            const DepthReference<S, Scattering, Heights>& reference,
            const ExponentialFree<Order, Degree, Radial>&)
      : scattering_(reference.scattering) {
    const auto pencil = [&](double rho_mm) {  // rho as a pinhole has it: radius in px times pitch
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
    const double gain = folds_g ? 1.0 : largest(reference.scattering);
    const double bound = error_bound_mm(table_, domain, w_over_l, delta_k, 255.0, gain);
    expects(bound <= 0.005, "ExponentialFree", "error of the polynomials in mm", bound,
            "<= 0.005: take a higher Degree or Radial, or Newton");
  }

  void invert(
      Index row, Index cols, const S* red, const S* green, S* depth_mm, PixelStatus* status) const {
    if constexpr (folds_g) {
      invert_row<Order>(table_, row, cols, red, green, nullptr, depth_mm, status);
    } else {
      const S* g = scattering_.plane.data() + row * cols;
      invert_row<Order>(table_, row, cols, red, green, g, depth_mm, status);
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

  static double largest(const PixelScattering<S>& g) {
    double found = 0;
    for (const S& x : g.plane) {
      found = is_finite(x) ? (std::max)(found, static_cast<double>(x)) : found;
    }
    return found;
  }
  static double largest(const auto&) { return 1; }

  Scattering scattering_;
  Table table_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
