// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: points of the plane and of space, with the arithmetic of vectors, for every scalar.
#include <cmath>
#include <type_traits>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// A point in the image (px) or on the plate (mm). x is along columns, y along rows.
template <scalar S>
struct Point2 {
  S x;
  S y;
};

/// A point in mm in the sensor's frame: origin at the center of the plate's inner face, z into the
/// pad, toward the object.
template <scalar S>
struct Point3 {
  S x;
  S y;
  S z;
};
/// The same point in another scalar.
template <scalar To, scalar From>
constexpr Point3<To> cast(const Point3<From>& p) {
  return {To(p.x), To(p.y), To(p.z)};
}

template <scalar S>
constexpr Point2<S> operator+(const Point2<S>& a, const Point2<S>& b) {
  return {a.x + b.x, a.y + b.y};
}
template <scalar S>
constexpr Point2<S> operator-(const Point2<S>& a, const Point2<S>& b) {
  return {a.x - b.x, a.y - b.y};
}
template <scalar S>
constexpr Point2<S> operator*(const std::type_identity_t<S>& factor, const Point2<S>& a) {
  return {factor * a.x, factor * a.y};
}
template <scalar S>
constexpr Point2<S> operator/(const Point2<S>& a, const std::type_identity_t<S>& divisor) {
  return {a.x / divisor, a.y / divisor};
}
template <scalar S>
constexpr Point2<S>& operator+=(Point2<S>& a, const Point2<S>& b) {
  return a = a + b;
}

template <scalar S>
constexpr Point3<S> operator+(const Point3<S>& a, const Point3<S>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <scalar S>
constexpr Point3<S> operator-(const Point3<S>& a, const Point3<S>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <scalar S>
constexpr Point3<S> operator-(const Point3<S>& a) {
  return {-a.x, -a.y, -a.z};
}
template <scalar S>
constexpr Point3<S> operator*(const std::type_identity_t<S>& factor, const Point3<S>& a) {
  return {factor * a.x, factor * a.y, factor * a.z};
}
template <scalar S>
constexpr Point3<S> operator/(const Point3<S>& a, const std::type_identity_t<S>& divisor) {
  return {a.x / divisor, a.y / divisor, a.z / divisor};
}
template <scalar S>
constexpr Point3<S>& operator+=(Point3<S>& a, const Point3<S>& b) {
  return a = a + b;
}

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

/// Whether all coordinates are finite.
template <scalar S>
constexpr bool is_finite(const Point2<S>& p) {
  return is_finite(p.x) && is_finite(p.y);
}
template <scalar S>
constexpr bool is_finite(const Point3<S>& p) {
  return is_finite(p.x) && is_finite(p.y) && is_finite(p.z);
}

/// Whether all coordinates can be measurements: below a million in magnitude.
template <scalar S>
constexpr bool is_plausible(const Point2<S>& p) {
  return is_plausible(p.x) && is_plausible(p.y);
}
template <scalar S>
constexpr bool is_plausible(const Point3<S>& p) {
  return is_plausible(p.x) && is_plausible(p.y) && is_plausible(p.z);
}

namespace detail {
template <scalar S>
constexpr Point3<S> missing_point() {
  return {not_a_number<S>(), not_a_number<S>(), not_a_number<S>()};
}
}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
