// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What an anchored mean is anchored at: the colours that the free pad's known shape predicts.
#include <cmath>
#include <vector>

#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/smoothing.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Per pixel, what an anchored mean needs of the free pad's depth l0: the residual
/// r = rise green - kappa red + scattered is F(l0), 0 where the membrane is where it was.
template <class S>
struct Anchor {
  std::vector<S> rise;       ///< exp(delta k l0)
  std::vector<S> scattered;  ///< g W(l0), grey levels
  S kappa = S(1);
};

template <class Smoothing>
inline constexpr bool is_anchored = false;
template <class Mean>
inline constexpr bool is_anchored<Anchored<Mean>> = true;

/// The anchor at the free pad of `reference`. Outside the pad, where nothing is averaged, it holds
/// harmless numbers.
template <class S, class Scattering, class Heights>
Anchor<S> anchor_of(const Camera<double>& camera,
                    const Absorption<double>& fluid,
                    const DepthReference<S, Scattering, Heights>& reference) {
  const double delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
  Anchor<S> anchor;
  anchor.kappa = S(fluid.kappa);
  for (Index i = 0; i < reference.rows; ++i) {
    for (Index j = 0; j < reference.cols; ++j) {
      S rise = S(1);
      S scattered = S(0);
      if (reference.in_pad(i, j)) {
        const auto ray = ray_at_pixel(camera, static_cast<double>(i), static_cast<double>(j));
        const auto pencil = pencil_of<Heights>(camera, ray);
        const auto l = static_cast<double>(value(reference.depth(i, j)));
        const S g = reference.scattering(i, j, S(square(ray.plate_rho_mm)));
        rise = S(std::exp(delta * pencil.path_factor * l));
        scattered = g * S(scattered_light(l, fluid.c_red_per_mm, pencil));
      }
      anchor.rise.push_back(rise);
      anchor.scattered.push_back(scattered);
    }
  }
  return anchor;
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
