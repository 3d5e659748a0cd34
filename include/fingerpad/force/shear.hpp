// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Tangential force and moment about the contact's normal by look-up: from how far the dots were
// carried along and rotated, counted by how large the contact is. Source: Ito, Kim and Obinata,
// "Acquisition of Contact Force and Slippage ...", "Method for measuring tangential force" and
// "... moment around normal direction":
//
//   d_nor     = (S_c / S_ref)^T_S d     or (D / D_ref)^T_D d          (4)
//   theta_nor = (S_c / S_ref)^R_S theta or (D / D_ref)^R_D theta      (5)
//
// with (5) corrected (docs/errata.md, E031), then a map from these to force and moment. Forces are
// what the object exerts on the pad: a pad that is dragged along x is pushed along x. The moment is
// about the normal through the middle of the contact.
//
// Which dots: contact_shift.hpp. The paper takes the central one.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/force_status.hpp"
#include "fingerpad/force/sample_block.hpp"
#include "fingerpad/force/shear_map.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// Two powers of each number of a row, which share one logarithm. For float and double vector code
// in double: x^t = exp(t log x), with log from the odd series of (m - 1)/(m + 1) for m within
// [1/sqrt 2, sqrt 2], and exp from its series within half a doubling. Every other scalar uses its
// own functions.

#if defined(FINGERPAD_HAS_VECTORS)
/// A whole number in a double as an integer lane, and back, by the place where a double's last bit
/// counts 1: without AVX-512 there is no instruction for it.
constexpr double whole_shift = 6755399441055744.0;  // 1.5 * 2^52

/// log x for normal x > 0; relative error 1e-15 but near 1, where it is absolute.
template <class V>
[[gnu::always_inline]] inline V log_of(const V& x) {
  using Bits = lanes<std::int64_t, static_cast<int>(sizeof(V) / 8)>;
  const Bits root_half = Bits{} + std::int64_t{0x3FE6A09E667F3BCD};
  const Bits doublings = (Bits(x) - root_half) >> 52;
  const V m = V(Bits(x) - (doublings << 52));
  const V exponent = V(doublings + Bits(V{} + whole_shift)) - whole_shift;
  const V t = (m - 1.0) / (m + 1.0);
  const V u = t * t;
  V p = V{} + 2.0 / 21;
  p = p * u + 2.0 / 19;
  p = p * u + 2.0 / 17;
  p = p * u + 2.0 / 15;
  p = p * u + 2.0 / 13;
  p = p * u + 2.0 / 11;
  p = p * u + 2.0 / 9;
  p = p * u + 2.0 / 7;
  p = p * u + 2.0 / 5;
  p = p * u + 2.0 / 3;
  p = p * u + 2.0;
  return exponent * 0.69314718055994530942 + t * p;
}

/// exp y, with y held within [-700, 700]; relative error 1e-15 and what y itself is off by.
template <class V>
[[gnu::always_inline]] inline V exp_of(const V& y) {
  using Bits = lanes<std::int64_t, static_cast<int>(sizeof(V) / 8)>;
  const V low = V{} - 700.0, high = V{} + 700.0;
  const V above = choose(Bits(y > low), y, low);
  const V held = choose(Bits(above < high), above, high);
  const V shifted = held * 1.44269504088896340736 + whole_shift;
  const V doublings = shifted - whole_shift;
  const V f = (held - doublings * 0.693147180369123816490) - doublings * 1.90821492927058770002e-10;
  V p = V{} + 1.0 / 479001600;
  p = p * f + 1.0 / 39916800;
  p = p * f + 1.0 / 3628800;
  p = p * f + 1.0 / 362880;
  p = p * f + 1.0 / 40320;
  p = p * f + 1.0 / 5040;
  p = p * f + 1.0 / 720;
  p = p * f + 1.0 / 120;
  p = p * f + 1.0 / 24;
  p = p * f + 1.0 / 6;
  p = p * f + 0.5;
  p = p * f + 1.0;
  p = p * f + 1.0;
  return V(Bits(p) + (Bits(shifted) << 52));
}

/// Powers of Bytes / 8 numbers; 0 for those that are not > 0, and none beyond exp(700).
template <int Bytes, class S>
[[gnu::always_inline]] inline void power_lanes(
    const S* x, double factor, double s, double t, S* power_s, S* power_t) {
  constexpr int n = Bytes / 8;
  using V = lanes<double, n>;
  using Bits = lanes<std::int64_t, n>;
  const V number = convert<double, n>(load<S, n>(x));
  const V given = number * factor;
  const V least = V{} + 1e-290, zero{};
  const Bits positive = Bits(number > zero);
  const V log_x = log_of<V>(choose(Bits(given > least), given, least));
  store(power_s, convert<S, n>(choose(positive, exp_of<V>(log_x * s), zero)));
  store(power_t, convert<S, n>(choose(positive, exp_of<V>(log_x * t), zero)));
}
#endif

/// power_s[i] = (x[i] factor)^s and power_t[i] likewise, 0 where x[i] is not > 0, for i < n.
template <scalar S>
void power_rows(
    const S* x, std::size_t n, const S& factor, const S& s, const S& t, S* power_s, S* power_t) {
  using std::exp;
  using std::log;
  std::size_t i = 0;
#if defined(FINGERPAD_HAS_VECTORS)
  if constexpr (std::is_same_v<S, double> || std::is_same_v<S, float>) {
    constexpr std::size_t step = native_vector_bytes / 8;
    for (; i + step <= n; i += step) {
      power_lanes<native_vector_bytes>(x + i, static_cast<double>(factor), static_cast<double>(s),
                                       static_cast<double>(t), power_s + i, power_t + i);
    }
  }
#endif
  for (; i < n; ++i) {
    const bool positive = value(x[i]) > 0;
    const S given = positive ? S(x[i] * factor) : S(1);
    const S log_x = log(given);
    power_s[i] = positive ? S(exp(S(s * log_x))) : S(0);
    power_t[i] = positive ? S(exp(S(t * log_x))) : S(0);
  }
}

}  // namespace detail

/// (measure / reference)^exponent; 0 without contact, so that nothing is amplified there.
template <scalar S>
S shear_factor(const S& measure, const S& reference, const S& exponent) {
  using std::exp;
  using std::log;
  if (!(value(measure) > 0)) {
    return S(0);
  }
  const S ratio = measure / reference;
  const S log_ratio = log(ratio);
  return S(exp(S(exponent * log_ratio)));
}

/// About the sensor's origin: that about the contact's middle at `center_mm`, and what the force
/// there adds.
template <scalar S>
S moment_about_origin(const S& moment_n_mm, const Point2<S>& force_n, const Point2<S>& center_mm) {
  return S(moment_n_mm + S(S(center_mm.x * force_n.y) - S(center_mm.y * force_n.x)));
}

template <scalar S = double>
struct [[nodiscard]] ShearResult {
  ForceStatus force_status = ForceStatus::not_finite;
  ForceStatus moment_status = ForceStatus::not_finite;
  Point2<S> tangential_force_n = {not_a_number<S>(), not_a_number<S>()};
  S moment_n_mm = not_a_number<S>();
  Point2<S> normalised_displacement_mm = {not_a_number<S>(), not_a_number<S>()};
  S normalised_rotation_rad = not_a_number<S>();

  bool has_force() const { return force_status != ForceStatus::not_finite; }
  bool has_moment() const { return moment_status != ForceStatus::not_finite; }
};

/// `Map` RadialShear<Degree> (published with Degree 1) or LinearShear. Const, O(1), no memory from
/// the heap.
template <class Map = RadialShear<>>
class Shear {
 public:
  using S = typename Map::number;

  /// Refuses bad parameters (parameter_error).
  Shear(const ShearNormalisation<S>& normalisation, const Map& map)
      : normalisation_(normalisation), map_(map) {
    expects_valid(normalisation);
    expects_valid(map);
  }

  /// One frame. Force and moment fail each by itself: NaN where the measure or what it comes from
  /// is not finite; 0 without contact.
  ShearResult<S> operator()(const S& measure,
                            const Point2<S>& displacement_mm,
                            const S& rotation_rad) const {
    using std::exp;
    using std::log;
    ShearResult<S> result;
    if (!is_finite(measure)) {
      return result;
    }
    const bool contact = value(measure) > 0;
    const S ratio = contact ? S(measure / normalisation_.reference) : S(1);
    const S log_ratio = log(ratio);
    if (is_finite(displacement_mm.x) && is_finite(displacement_mm.y)) {
      const S factor = contact ? S(exp(S(normalisation_.displacement_exponent * log_ratio))) : S(0);
      fill_force({S(factor * displacement_mm.x), S(factor * displacement_mm.y)}, contact, result);
    }
    if (is_finite(rotation_rad)) {
      const S factor = contact ? S(exp(S(normalisation_.rotation_exponent * log_ratio))) : S(0);
      fill_moment(S(factor * rotation_rad), contact, result);
    }
    return result;
  }

  /// Many frames: a row of `samples` for each, with columns measure, displacement's x and y, angle;
  /// a row of `shear` with force's x and y in N and the moment in N mm. NaN as in a single frame,
  /// and where one of them is; `not_finite` counts samples without force or without moment.
  /// O(rows), vector code where the compiler can. Powers in double within 2 (1 + T log(measure /
  /// reference)) units in the last place.
  template <grid Samples, writable_grid<S> Results>
  SampleCounts for_samples(const Samples& samples, Results&& shear) const {
    const auto in = as_view(samples);
    const auto out = as_view(shear);
    SampleCounts counts;
    if (in.cols() < 4 || out.cols() != 3 || out.rows() != in.rows()) {
      return counts;
    }
    counts.status = FrameStatus::ok;
    const S one_over_reference = S(1) / normalisation_.reference;
    detail::for_each_block<S, 4, 3>(in, out, [&](const auto& block, auto& results) {
      std::array<S, detail::block_samples> by_displacement, by_rotation;
      detail::power_rows(block.column[0].data(), block.size, one_over_reference,
                         normalisation_.displacement_exponent, normalisation_.rotation_exponent,
                         by_displacement.data(), by_rotation.data());
      int not_finite = 0, beyond = 0;
      for (std::size_t k = 0; k < block.size; ++k) {
        const bool known = is_finite(block.column[0][k]);
        const bool contact = value(block.column[0][k]) > 0;
        const Point2<S> d{S(by_displacement[k] * block.column[1][k]),
                          S(by_displacement[k] * block.column[2][k])};
        const S theta = by_rotation[k] * block.column[3][k];
        const Point2<S> force = map_.force_n(d);
        const S moment = map_.moment_n_mm(theta);
        const bool has_force = known & is_finite(S(S(d.x + d.y) + S(force.x + force.y)));
        const bool has_moment = known & is_finite(S(theta + moment));
        const S none = not_a_number<S>();
        results.column[0][k] = has_force ? (contact ? force.x : S(0)) : none;
        results.column[1][k] = has_force ? (contact ? force.y : S(0)) : none;
        results.column[2][k] = has_moment ? (contact ? moment : S(0)) : none;
        const int answered = static_cast<int>(has_force) & static_cast<int>(has_moment);
        const int within = static_cast<int>(map_.within(d)) & static_cast<int>(map_.within(theta));
        not_finite += 1 - answered;
        beyond += answered & (1 - within);
      }
      counts.not_finite += not_finite;
      counts.beyond_range += beyond;
    });
    return counts;
  }

 private:
  void fill_force(const Point2<S>& normalised, bool contact, ShearResult<S>& result) const {
    const Point2<S> force = contact ? map_.force_n(normalised) : Point2<S>{S(0), S(0)};
    if (!is_finite(S(force.x + force.y))) {
      return;  // too large for a number
    }
    result.normalised_displacement_mm = normalised;
    result.tangential_force_n = force;
    result.force_status = status_of(contact, map_.within(normalised));
  }
  void fill_moment(const S& normalised, bool contact, ShearResult<S>& result) const {
    const S moment = contact ? map_.moment_n_mm(normalised) : S(0);
    if (!is_finite(moment)) {
      return;
    }
    result.normalised_rotation_rad = normalised;
    result.moment_n_mm = moment;
    result.moment_status = status_of(contact, map_.within(normalised));
  }
  static ForceStatus status_of(bool contact, bool within) {
    return !contact ? ForceStatus::no_contact
           : within ? ForceStatus::measured
                    : ForceStatus::beyond_range;
  }

  ShearNormalisation<S> normalisation_;
  Map map_;
};

}  // namespace v0
}  // namespace fingerpad
