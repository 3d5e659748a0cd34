// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: points of the plane and of space, with the arithmetic of vectors, for every scalar.
#include <cmath>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

/// A point in the image (px) or on the plate (mm). x is along columns, y along rows.
template <scalar S>
struct Point2 {
  S x;
  S y;

  friend constexpr Point2 operator+(const Point2& a, const Point2& b) {
    return {a.x + b.x, a.y + b.y};
  }
  friend constexpr Point2 operator-(const Point2& a, const Point2& b) {
    return {a.x - b.x, a.y - b.y};
  }
  friend constexpr Point2 operator*(const S& factor, const Point2& a) {
    return {factor * a.x, factor * a.y};
  }
  friend constexpr Point2 operator/(const Point2& a, const S& divisor) {
    return {a.x / divisor, a.y / divisor};
  }
  friend constexpr Point2& operator+=(Point2& a, const Point2& b) { return a = a + b; }
  /// Whether both coordinates are finite.
  friend constexpr bool is_finite(const Point2& p) { return is_finite(p.x) && is_finite(p.y); }
  /// Whether both can be measurements: below a million in magnitude.
  friend constexpr bool is_plausible(const Point2& p) {
    return is_plausible(p.x) && is_plausible(p.y);
  }
};

/// A point in mm in the sensor's frame: origin at the center of the plate's inner face, z into the
/// pad, toward the object.
template <scalar S>
struct Point3 {
  S x;
  S y;
  S z;

  friend constexpr Point3 operator+(const Point3& a, const Point3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend constexpr Point3 operator-(const Point3& a, const Point3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr Point3 operator-(const Point3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Point3 operator*(const S& factor, const Point3& a) {
    return {factor * a.x, factor * a.y, factor * a.z};
  }
  friend constexpr Point3 operator/(const Point3& a, const S& divisor) {
    return {a.x / divisor, a.y / divisor, a.z / divisor};
  }
  friend constexpr Point3& operator+=(Point3& a, const Point3& b) { return a = a + b; }
  friend constexpr bool is_finite(const Point3& p) {
    return is_finite(p.x) && is_finite(p.y) && is_finite(p.z);
  }
  friend constexpr bool is_plausible(const Point3& p) {
    return is_plausible(p.x) && is_plausible(p.y) && is_plausible(p.z);
  }
};

template <scalar S>
constexpr S dot(const Point2<S>& a, const Point2<S>& b) {
  return a.x * b.x + a.y * b.y;
}
template <scalar S>
constexpr S dot(const Point3<S>& a, const Point3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <scalar S>
constexpr Point3<S> cross(const Point3<S>& a, const Point3<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// |a|^2.
template <class Point>
constexpr auto squared_norm(const Point& a) -> decltype(dot(a, a)) {
  return dot(a, a);
}

/// |a|. The squares of the coordinates must not overflow.
template <class Point>
auto norm(const Point& a) -> decltype(dot(a, a)) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

/// a / |a|; a must not be 0.
template <class Point>
Point normalized(const Point& a) {
  return a / norm(a);
}

namespace detail {
template <scalar S>
constexpr Point3<S> missing_point() {
  return {not_a_number<S>(), not_a_number<S>(), not_a_number<S>()};
}
}  // namespace detail

}  // namespace v1
}  // namespace fingerpad
