// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Rows of depth from rows of colour, for each root finder.
#include <algorithm>
#include <cmath>
#include <concepts>

#include "fingerpad/depth/depth_inverse.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/detail/invert_row.hpp"
#include "fingerpad/depth/detail/scatter_polynomial.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

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
