// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Curvature of the membrane and shape of the object.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>
#include <utility>

#include "fingerpad/contact/object_surface.hpp"
#include "fingerpad/image/curvature.hpp"
#include "fingerpad/published/contact_region.hpp"
#include "row.hpp"
#include "support/pad.hpp"

namespace hard {

/// Random sections, as those of a pad: depth 5 to 13 mm, slope up to 1.5.
inline Row flat_section() {
  return row(
      "curvature", "sections of curvature 1.5e-4/mm, ring of 0.768 mm; 1/mm",
      "(K1), Menger's form: no center, no radius", []<class S>(S) {
        Forms f;
        test::Random random(7);
        for (int k = 0; k < 2000; ++k) {
          const S r = S(0.768);
          const double middle = random.uniform(5, 13), rise = 0.768 * random.uniform(-1.5, 1.5);
          const double bend = 1.5e-4 * 0.768 * 0.768 / 2;
          const S before = S(middle - rise - bend), center = S(middle);
          const S after = S(middle + rise - bend);
          const Digits50 exact = fingerpad::section_curvature(Digits50(r), Digits50(before),
                                                              Digits50(center), Digits50(after));
          f.naive.add_absolute(
              fingerpad::published::circle_center_curvature(r, before, center, after), exact);
          f.stable.add_absolute(fingerpad::section_curvature(r, before, center, after), exact);
        }
        return f;
      });
}

inline Row flat_contact() {
  return row("curvature",
             "mean of 18 sections on a flat contact that is tilted by 0 to 0.02, "
             "depths on the grid of a bisection; 1/mm",
             "the same", []<class S>(S) {
               Forms f;
               test::Random random(7);
               const double grid = 14.0 / 32768;
               for (int k = 0; k < 400; ++k) {
                 const double along_x = k < 40 ? 0 : random.uniform(-0.02, 0.02);
                 const double along_y = k < 40 ? 0 : random.uniform(-0.02, 0.02);
                 const double center = random.uniform(5, 13);
                 const auto depth = [&](double x, double y) {
                   return S(grid * std::round((center + along_x * x + along_y * y) / grid));
                 };
                 S circle = S(0), menger = S(0);
                 Digits50 exact(0);
                 for (int n = 0; n < 18; ++n) {
                   const double at = std::numbers::pi * n / 18;
                   const double x = 0.0768 * std::round(10 * std::cos(at));
                   const double y = 0.0768 * std::round(10 * std::sin(at));
                   const S r = S(std::hypot(x, y));
                   const S before = depth(-x, -y), middle = depth(0, 0), after = depth(x, y);
                   circle +=
                       fingerpad::published::circle_center_curvature(r, before, middle, after) /
                       S(18);
                   menger += fingerpad::section_curvature(r, before, middle, after) / S(18);
                   exact += fingerpad::section_curvature(Digits50(r), Digits50(before),
                                                         Digits50(middle), Digits50(after)) /
                            18;
                 }
                 f.naive.add_absolute(circle, exact);
                 f.stable.add_absolute(menger, exact);
               }
               return f;
             });
}

/// Solves a x = b by Gaussian elimination with pivots.
template <class S, std::size_t N>
std::array<S, N> solved(std::array<std::array<S, N + 1>, N> a) {
  using std::abs;
  for (std::size_t j = 0; j < N; ++j) {
    std::size_t pivot = j;
    for (std::size_t i = j + 1; i < N; ++i) {
      pivot = abs(a[i][j]) > abs(a[pivot][j]) ? i : pivot;
    }
    std::swap(a[j], a[pivot]);
    for (std::size_t i = 0; i < N; ++i) {
      const S factor = a[i][j] / a[j][j];
      for (std::size_t k = j; i != j && k <= N; ++k) {
        a[i][k] = a[i][k] - factor * a[j][k];
      }
    }
  }
  std::array<S, N> x;
  for (std::size_t k = 0; k < N; ++k) {
    x[k] = a[k][N] / a[k][k];
  }
  return x;
}

/// Least squares of terms . x = right over all pixels, by normal equations.
template <class S, std::size_t N, class Terms>
std::array<S, N> normal_equations(const test::Image<S>& depth,
                                  const fingerpad::OrthographicCamera<S>& camera,
                                  const Terms& terms) {
  std::array<std::array<S, N + 1>, N> a;
  for (auto& line : a) {
    line.fill(S(0));
  }
  for (fingerpad::Index i = 0; i < depth.rows(); ++i) {
    for (fingerpad::Index j = 0; j < depth.cols(); ++j) {
      const auto p =
          fingerpad::point_at(camera, S(static_cast<int>(i)), S(static_cast<int>(j)), depth(i, j));
      const std::array<S, N + 1> t = terms(p);  // the last one is the right side
      for (std::size_t m = 0; m < N; ++m) {
        for (std::size_t n = 0; n <= N; ++n) {
          a[m][n] = a[m][n] + t[m] * t[n];
        }
      }
    }
  }
  return solved<S, N>(a);
}

/// Curvature of the sphere x^2 + y^2 + z^2 = 2 a x + 2 b y + 2 c z + d that fits the points best.
template <class S>
S curvature_by_center(const test::Image<S>& depth, const fingerpad::OrthographicCamera<S>& camera) {
  using std::sqrt;
  const auto x = normal_equations<S, 4>(depth, camera, [](const auto& p) {
    return std::array<S, 5>{S(p.x + p.x), S(p.y + p.y), S(p.z + p.z), S(1),
                            S(p.x * p.x + p.y * p.y + p.z * p.z)};
  });
  const S radius = sqrt(S(x[0] * x[0] + x[1] * x[1] + x[2] * x[2] + x[3]));
  return S(S(1) / radius);
}

template <class To, class From>
test::Image<To> in(const test::Image<From>& image) {
  test::Image<To> out(image.rows(), image.cols());
  std::transform(image.cells.begin(), image.cells.end(), out.cells.begin(),
                 [](const From& cell) { return To(cell); });
  return out;
}
template <class To, class S>
fingerpad::OrthographicCamera<To> in(const fingerpad::OrthographicCamera<S>& c) {
  return {To(c.center_x_px), To(c.center_y_px), To(c.pitch_mm)};
}

/// Sums over float depths use double, like the numbers of the camera.
template <class S>
using wide_t = std::conditional_t<std::is_same_v<S, float>, double, S>;

template <class Model, class S>
auto shape_of(const test::Image<S>& depth, const fingerpad::OrthographicCamera<S>& camera) {
  using Wide = fingerpad::OrthographicCamera<wide_t<S>>;
  const fingerpad::SurfaceFit<Model, Wide> fit(depth.rows(), depth.cols(), in<wide_t<S>>(camera),
                                               {.min_px = 10});
  return fit(depth, test::Image<unsigned char>(depth.rows(), depth.cols(), 1));
}

inline Row nearly_flat_sphere() {
  return row(
      "object surface",
      "sphere through a patch of 4 mm, radius 100 mm to 1e6 mm; each form against itself, "
      "1/mm",
      "point, normal and curvature for a center; moments about the centroid, in double",
      []<class S>(S) {
        Forms f;
        const fingerpad::Index size = 21;
        const fingerpad::OrthographicCamera<S> camera{S(10), S(10), S(0.2)};
        for (const double radius : {1e2, 1e3, 1e4, 1e5, 1e6}) {
          test::Image<S> depth(size, size);
          for (fingerpad::Index i = 0; i < size; ++i) {
            for (fingerpad::Index j = 0; j < size; ++j) {
              const double y = 0.2 * static_cast<double>(i - 10);
              const double x = 0.2 * static_cast<double>(j - 10);
              depth(i, j) = S(9 + (x * x + y * y) / (2 * radius));
            }
          }
          const auto exact_depth = in<Digits50>(depth);
          const auto exact_camera = in<Digits50>(camera);
          f.naive.add_absolute(curvature_by_center(depth, camera),
                               curvature_by_center(exact_depth, exact_camera));
          f.stable.add_absolute(
              shape_of<fingerpad::Sphere<>>(depth, camera).shape.curvature_per_mm,
              shape_of<fingerpad::Sphere<>>(exact_depth, exact_camera).shape.curvature_per_mm);
        }
        return f;
      });
}

inline Row patch_far_away() {
  return row("object surface",
             "plane through a patch, 10 to 1e5 px from the axis; each form against itself, slope",
             "moments about the first point, then the centroid, in double", []<class S>(S) {
               Forms f;
               const fingerpad::Index size = 12;
               for (const double away : {1e1, 1e2, 1e3, 1e4, 1e5}) {
                 const fingerpad::OrthographicCamera<S> camera{S(-away), S(2 * away), S(0.0625)};
                 test::Image<S> depth(size, size);
                 test::Random random(3);
                 for (fingerpad::Index i = 0; i < size; ++i) {
                   for (fingerpad::Index j = 0; j < size; ++j) {
                     depth(i, j) = S(9 + 0.02 * static_cast<double>(i) -
                                     0.01 * static_cast<double>(j) + 0.01 * random.normal());
                   }
                 }
                 const auto slope_x = []<class T>(const test::Image<T>& d, const auto& c) {
                   return normal_equations<T, 3>(d, c, [](const auto& p) {
                     return std::array<T, 4>{p.x, p.y, T(1), p.z};
                   })[0];
                 };
                 const auto along_x = []<class T>(const test::Image<T>& d, const auto& c) {
                   const auto n = shape_of<fingerpad::Plane<>>(d, c).shape.normal;
                   return wide_t<T>(-n.x / n.z);
                 };
                 const auto exact_depth = in<Digits50>(depth);
                 const auto exact_camera = in<Digits50>(camera);
                 f.naive.add_absolute(slope_x(depth, camera), slope_x(exact_depth, exact_camera));
                 f.stable.add_absolute(along_x(depth, camera), along_x(exact_depth, exact_camera));
               }
               return f;
             });
}

}  // namespace hard
