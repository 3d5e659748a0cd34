// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Points in space as vectors, for every scalar.
#include <cmath>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

template <scalar S>
Point3<S> sum(const Point3<S>& a, const Point3<S>& b) {
  return {S(a.x + b.x), S(a.y + b.y), S(a.z + b.z)};
}
template <scalar S>
Point3<S> difference(const Point3<S>& a, const Point3<S>& b) {
  return {S(a.x - b.x), S(a.y - b.y), S(a.z - b.z)};
}
template <scalar S>
Point3<S> scaled(const S& factor, const Point3<S>& a) {
  return {S(factor * a.x), S(factor * a.y), S(factor * a.z)};
}
/// a + s b.
template <scalar S>
Point3<S> moved(const Point3<S>& a, const S& s, const Point3<S>& b) {
  return {S(a.x + s * b.x), S(a.y + s * b.y), S(a.z + s * b.z)};
}
template <scalar S>
S length_sq(const Point3<S>& a) {
  return dot(a, a);
}
/// a / |a|; a must not be 0.
template <scalar S>
Point3<S> unit(const Point3<S>& a) {
  using std::sqrt;
  const S length = sqrt(length_sq(a));
  return {S(a.x / length), S(a.y / length), S(a.z / length)};
}
template <scalar S>
bool is_finite_point(const Point3<S>& p) {
  return is_finite(p.x) && is_finite(p.y) && is_finite(p.z);
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
