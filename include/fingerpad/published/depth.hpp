// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The RGB depth model as printed: Ito, Kim, Obinata, "Shape sensing by vision-based tactile sensor"
// (slides), and Ito, Kim, Nagai, Obinata 2011, III.A and eq. 13. Means over 29 x 29 px of the frame
// and of the reference, a quotient g for each pixel, one height in both directions of a pencil,
// bisection in 16 halvings, and three equations for the fluid. With the repairs without which there
// is no number (docs/errata.md, E001-E006) and no others; docs/depth/depth.md says what the default
// does instead.
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// The camera above the fluid; the slides neglect the plate.
template <scalar S = double>
struct Pinhole {
  S h1_mm = S(50);         ///< from the camera to the fluid, > 0
  S n = S(133) / S(100);   ///< refractive index of the fluid, >= 1
  S center_row_px = S(0);  ///< pixel on the axis
  S center_col_px = S(0);
  S pitch_mm = S(8) / S(100);  ///< of pixels on the fluid's surface, > 0
};

/// The properties of the fluid; the defaults are the published values.
template <scalar S = double>
struct Fluid {
  S c_R = S(290) / S(10000);     ///< absorption of red per mm, > 0
  S c_G = S(336) / S(10000);     ///< absorption of green per mm, > 0
  S kappa = S(9924) / S(10000);  ///< of light source and camera, > 0
};

/// What a pixel's ray gives to the equations.
template <scalar S = double>
struct PixelRay {
  S cos_phi1;  ///< in the fluid
  S cos_phi2;  ///< in air
  S k;         ///< 1 + 1/cos(phi1): the light goes k l to depth l and back
  S h2_mm;     ///< of the point in the fluid from which the light seems to come
};

/// The ray of the pixel at (row, col). h2 = n h1 cos^3(phi1) / cos^3(phi2) is the closed form of
/// the slides' chain of differentials; it holds in the plane of the ray only (E007).
template <scalar S>
PixelRay<S> ray_of(const Pinhole<S>& camera, const S& row, const S& col) {
  using std::sqrt;
  const S x = (col - camera.center_col_px) * camera.pitch_mm;
  const S y = (row - camera.center_row_px) * camera.pitch_mm;
  const S tan_sq = (x * x + y * y) / square(camera.h1_mm);
  const S cos2 = S(1) / sqrt(S(1) + tan_sq);
  const S sin1_sq = tan_sq * cos2 * cos2 / square(camera.n);
  const S cos1 = sqrt(S(1) - sin1_sq);
  const S ratio = cos1 / cos2;
  return {cos1, cos2, S(1) + S(1) / cos1, camera.n * camera.h1_mm * ratio * ratio * ratio};
}

/// Eq. 13 of Ito et al. 2011 as printed, with the sine. It is right only if depth_mm is a length
/// along the ray. With a depth along z it is at most 0.026 mm short on a pad 50 mm from the camera,
/// and 0.39 mm at 30 degrees and a depth of 13 mm (E019).
template <scalar S>
Point3<S> point_at(const Pinhole<S>& camera, const S& row, const S& col, const S& depth_mm) {
  using std::sqrt;
  const S x = (col - camera.center_col_px) * camera.pitch_mm;
  const S y = (row - camera.center_row_px) * camera.pitch_mm;
  const S cos2 = S(1) / sqrt(S(1) + (x * x + y * y) / square(camera.h1_mm));
  const S stretch = S(1) + depth_mm * cos2 / (camera.n * camera.h1_mm);  // sin1 / tan2 = cos2 / n
  return {x * stretch, y * stretch, depth_mm};
}

/// The quotient f(l) = g at the depth l > 0 of a pixel, with the repairs E003-E005:
/// (b_G e^{c_G k l} - kappa b_R e^{c_R k l}) / (Q1 (1 - e^{c_R k l}) + Q2). It is 0/0 at l = 0.
/// Colours are grey levels.
template <scalar S>
S quotient(
    const Fluid<S>& fluid, const S& k, const S& h2_mm, const S& b_R, const S& b_G, const S& l) {
  using std::exp;
  const S ck = fluid.c_R * k;
  const S q1 = (h2_mm * h2_mm + (S(2) * h2_mm + S(2) / ck) / ck) / k;
  const S q2 = (l * l + S(2) * h2_mm * l + S(2) * l / ck) / k;
  const S e_R = exp(ck * l);
  const S e_G = exp(fluid.c_G * k * l);
  return (b_G * e_G - fluid.kappa * b_R * e_R) / (q1 * (S(1) - e_R) + q2);
}

/// The depth in (0, max_depth_mm) at which f(l) = g. Each halving moves l by half as much as the
/// one before: by 0.43 um at the last of 16 for 14 mm. As printed it starts at l = 0, where f is
/// 0/0, and every pixel ends at the wrong end of the range (E006); so the first step goes to the
/// middle. Where there is no root, it ends at an end of the range.
template <scalar S>
S bisect(const Fluid<S>& fluid,
         const S& k,
         const S& h2_mm,
         const S& g,
         const S& b_R,
         const S& b_G,
         const S& max_depth_mm,
         int halvings = 16) {
  S l = max_depth_mm / S(2);
  S step = l / S(2);
  for (int i = 2; i < halvings; ++i) {
    const bool root_is_deeper = !(quotient(fluid, k, h2_mm, b_R, b_G, l) < g);
    l = root_is_deeper ? l + step : l - step;
    step = step / S(2);
  }
  return l;
}

template <scalar S = double>
struct DepthOptions {
  Pinhole<S> camera = {};
  Fluid<S> fluid = {};
  int window_px = 29;        ///< width of the window of both means, odd, 1..255
  int halvings = 16;         ///< in 2..100
  S max_depth_mm = S(14);    ///< > 0
  S units_per_level = S(1);  ///< of the frames: 1 for 8 bit, 256 for 16 bit
};

/// Says which value is out of range; "" if none is.
template <scalar S>
std::string check(const DepthOptions<S>& o) {
  return fingerpad::check("published::DepthOptions",
                          {{"camera.h1_mm", o.camera.h1_mm, positive},
                           {"camera.n", o.camera.n, at_least(1)},
                           {"camera.center_row_px", o.camera.center_row_px, finite_number},
                           {"camera.center_col_px", o.camera.center_col_px, finite_number},
                           {"camera.pitch_mm", o.camera.pitch_mm, positive},
                           {"fluid.c_R", o.fluid.c_R, positive},
                           {"fluid.c_G", o.fluid.c_G, positive},
                           {"fluid.kappa", o.fluid.kappa, positive},
                           {"window_px", o.window_px, odd_within(1, 255)},
                           {"halvings", o.halvings, within(2, 100)},
                           {"max_depth_mm", o.max_depth_mm, positive},
                           {"units_per_level", o.units_per_level, positive}});
}

/// Depth of frames of one pad. A mean is one over the pixels of the window that lie in the pad and
/// are neither 0 nor 255 in a channel. A call allocates nothing; O(rows cols halvings).
template <scalar S = double>
class DepthEstimator {
 public:
  /// From a frame of the free pad and its depth l0 along each pixel's ray; NaN outside the pad. g
  /// is the quotient of its averaged colours; it is useless near the rim, where l0 vanishes.
  /// Refuses bad options and grids of different sizes (parameter_error).
  template <grid Red, grid Green, grid Depth>
  DepthEstimator(const DepthOptions<S>& options,
                 const Red& red,
                 const Green& green,
                 const Depth& free_depth_mm)
      : options_(options), rows_(fingerpad::rows(red)), cols_(fingerpad::cols(red)) {
    require(options);
    expects_grid_size("published::DepthEstimator", rows_, cols_);
    expects(has_size(green) && has_size(free_depth_mm), "published::DepthEstimator",
            "rows of free_depth_mm", static_cast<long long>(fingerpad::rows(free_depth_mm)),
            "of the same size as the red and green image");
    const auto depth = as_view(free_depth_mm);
    for (auto* plane : {&g_, &ones_, &red_, &green_, &sum_}) {
      plane->assign(static_cast<std::size_t>(rows_ * cols_), S(0));
    }
    for_each([&](Index i, Index j, std::size_t at) {
      in_pad_.push_back(value(static_cast<S>(depth(i, j))) >= 0);
      const PixelRay<S> ray =
          ray_of(options_.camera, S(static_cast<double>(i)), S(static_cast<double>(j)));
      k_.push_back(ray.k);
      h2_mm_.push_back(ray.h2_mm);
      g_[at] = not_a_number<S>();
    });
    average(as_view(red), as_view(green));
    for_each([&](Index i, Index j, std::size_t at) {
      const S l0 = static_cast<S>(depth(i, j));
      if (value(l0) > 0) {
        g_[at] = quotient(options_.fluid, k_[at], h2_mm_[at], red_[at], green_[at], l0);
      }
    });
  }

  /// Depth of a frame; NaN where g is unknown or no pixel of the window counts. False, and nothing
  /// written, where a grid has another size.
  template <grid Red, grid Green, class Depth>
  bool operator()(const Red& red, const Green& green, Depth&& depth_mm) {
    if (!(has_size(red) && has_size(green) && has_size(depth_mm))) {
      return false;
    }
    average(as_view(red), as_view(green));
    const auto to = as_view(depth_mm);
    for_each([&](Index i, Index j, std::size_t at) {
      const bool known = is_finite(g_[at]) && is_finite(red_[at]);
      to(i, j) = static_cast<cell_t<Depth>>(known ? bisect(options_.fluid, k_[at], h2_mm_[at],
                                                           g_[at], red_[at], green_[at],
                                                           options_.max_depth_mm, options_.halvings)
                                                  : not_a_number<S>());
    });
    return true;
  }

 private:
  using Plane = std::vector<S>;

  template <class G>
  bool has_size(const G& g) const {
    return fingerpad::rows(g) == rows_ && fingerpad::cols(g) == cols_;
  }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        visit(i, j, static_cast<std::size_t>(i * cols_ + j));
      }
    }
  }

  /// red_ and green_: the means of a frame in grey levels.
  template <class Red, class Green>
  void average(const Red& red, const Green& green) {
    for_each([&](Index i, Index j, std::size_t at) {
      const S r = static_cast<S>(red(i, j)) / options_.units_per_level;
      const S b = static_cast<S>(green(i, j)) / options_.units_per_level;
      const auto has_light = [](const S& x) { return value(x) > 0 && value(x) < 255; };
      const bool counts = in_pad_[at] && has_light(r) && has_light(b);
      ones_[at] = S(counts ? 1 : 0);
      red_[at] = counts ? r : S(0);
      green_[at] = counts ? b : S(0);
    });
    for (Plane* plane : {&ones_, &red_, &green_}) {
      sum_over_window(*plane);
    }
    for (std::size_t at = 0; at < ones_.size(); ++at) {
      red_[at] = red_[at] / ones_[at];  // 0 / 0: no pixel counts
      green_[at] = green_[at] / ones_[at];
    }
  }

  /// Sums along columns, then along rows.
  void sum_over_window(Plane& plane) {
    const Index r = options_.window_px / 2;
    sum_lines(plane, sum_, cols_, 1, rows_, cols_, r);
    sum_lines(sum_, plane, rows_, cols_, cols_, 1, r);
  }
  static void sum_lines(const Plane& from,
                        Plane& to,
                        Index lines,
                        Index line_stride,
                        Index count,
                        Index stride,
                        Index r) {
    for (Index line = 0; line < lines; ++line) {
      const auto at = [&](Index k) {
        return static_cast<std::size_t>(line * line_stride + k * stride);
      };
      S sum = S(0);
      for (Index k = -r; k < count; ++k) {
        sum = k + r < count ? sum + from[at(k + r)] : sum;
        sum = k - r - 1 >= 0 ? sum - from[at(k - r - 1)] : sum;
        if (k >= 0) {
          to[at(k)] = sum;
        }
      }
    }
  }

  DepthOptions<S> options_;
  Index rows_, cols_;
  std::vector<bool> in_pad_;
  Plane k_, h2_mm_, g_;             // of each pixel
  Plane ones_, red_, green_, sum_;  // of a frame
};

/// A colour at a known depth.
template <scalar S = double>
struct KnownPixel {
  S k;         ///< of the pixel's ray
  S h2_mm;     ///< of the pixel's ray
  S depth_mm;  ///< l along z, > 0
  S b_R;       ///< grey levels, > 0
  S b_G;
};

template <scalar S = double>
struct [[nodiscard]] Identification {
  Fluid<S> fluid = {};  ///< parameters after the last step
  S residual = S(0);    ///< largest of |f(l_i) - f(l_0)| over |f(l_0)|
  int iterations = 0;
  bool converged = false;

  bool ok() const { return converged; }
};

/// c_R, c_G and kappa from three measurements at known depths and a reference: f(l_i) = f(l_0), i =
/// 1, 2, 3, "solving by numerical analytical approach such as Newton method". Newton's method from
/// `guess`, with derivatives by central differences; each step is halved until the residual falls.
/// This hardly determines the parameters (docs/papers.md). Never throws, bounded time.
template <scalar S>
Identification<S> identify_fluid(const KnownPixel<S>& reference,
                                 const std::array<KnownPixel<S>, 3>& measured,
                                 const Fluid<S>& guess = {},
                                 int max_iterations = 100) {
  using std::sqrt;
  const auto f = [](const Point3<S>& p, const KnownPixel<S>& at) {
    return quotient(Fluid<S>{p.x, p.y, p.z}, at.k, at.h2_mm, at.b_R, at.b_G, at.depth_mm);
  };
  const auto residuals = [&](const Point3<S>& p) {
    const S g = f(p, reference);
    return Point3<S>{f(p, measured[0]) / g - S(1), f(p, measured[1]) / g - S(1),
                     f(p, measured[2]) / g - S(1)};
  };
  const auto size = [](const Point3<S>& r) {
    S largest = S(0);
    for (const S& x : {r.x, r.y, r.z}) {
      const S magnitude = value(x) < 0 ? -x : x;
      largest = !is_finite(x) || value(magnitude) > value(largest) ? magnitude : largest;
    }
    return largest;
  };
  Identification<S> out;
  Point3<S> p = {guess.c_R, guess.c_G, guess.kappa};
  Point3<S> r = residuals(p);
  const S step = sqrt(S(epsilon<S>()));
  for (; out.iterations < max_iterations; ++out.iterations) {
    std::array<Point3<S>, 3> slope = {};
    for (std::size_t j = 0; j < 3; ++j) {
      S Point3<S>::*const of = std::array{&Point3<S>::x, &Point3<S>::y, &Point3<S>::z}[j];
      Point3<S> up = p, down = p;
      up.*of += step * p.*of;
      down.*of -= step * p.*of;
      slope[j] = (S(1) / (up.*of - down.*of)) * (residuals(up) - residuals(down));
    }
    // Cramer's rule; not finite if the depths do not determine the parameters
    const S volume = dot(slope[0], cross(slope[1], slope[2]));
    const Point3<S> change = {dot(r, cross(slope[1], slope[2])) / volume,
                              dot(r, cross(slope[2], slope[0])) / volume,
                              dot(r, cross(slope[0], slope[1])) / volume};
    if (!is_finite(size(change))) {
      break;
    }
    const S before = size(r);
    S share = S(1);
    bool falls = false;
    for (int half = 0; half < 30 && !falls; ++half, share = share / S(2)) {
      const Point3<S> next = p - share * change;
      const Point3<S> there = residuals(next);
      falls = value(next.x) > 0 && value(next.y) > 0 && value(next.z) > 0 &&
              value(size(there)) < value(before);
      if (falls) {
        p = next;
        r = there;
      }
    }
    if (!falls) {  // converged to roundoff, or stuck
      out.converged = value(before) < value(S(1000) * step * step);
      break;
    }
  }
  out.fluid = {p.x, p.y, p.z};
  out.residual = size(r);
  return out;
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
