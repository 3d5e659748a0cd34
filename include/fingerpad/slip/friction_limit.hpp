// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Detects gross slip by comparing force and moment of the contact with their limit at the last
// slide. Dots cannot show an object that slides over a membrane at rest, or that carries all dots
// along equally. The load of a contact is
//
//   L = hypot(F_t / F_n, M_n / (arm F_n)),
//
// with F_n normal and F_t tangential to the contact, M_n the moment about the normal through its
// center, and `arm` the mean distance of the contact from its center. While the object slides under
// uniform pressure, L is the friction coefficient. The true limit curve of force and moment is
// replaced by an ellipse that meets it on both axes (Howe, Cutkosky, "Practical force-motion models
// for sliding manipulation", 1996). The published form has forces only, "F / N ~ F0 / N0":
// published/friction_ratio.hpp.
#include <cmath>
#include <cstdint>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/detail/dot_surface.hpp"
#include "fingerpad/slip/detail/peak_loads.hpp"
#include "fingerpad/slip/grip_law.hpp"

namespace fingerpad {
inline namespace v0 {

/// Load of a contact. NaN and values of a million or more mean unknown; an unknown moment counts as
/// zero.
template <scalar S = double>
struct ContactLoad {
  S normal_n = not_a_number<S>();      ///< F_n, positive under pressure
  S tangential_n = not_a_number<S>();  ///< F_t
  S moment_n_mm = S(0);                ///< M_n
  S arm_mm = S(0);                     ///< the moment counts only if this is > 0
};

/// Computes the load from the six-axis force and moment, which the object exerts on the pad, about
/// Q, and from the dots in contact. The forces are NaN with fewer than three dots. Allocates
/// nothing, O(rows cols).
template <scalar S, spatial_dot_grid Dots, contact_mask Contact>
ContactLoad<S> contact_load(const Point3<S>& force_n,
                            const Point3<S>& moment_n_mm,
                            const Dots& dots_mm,
                            const Contact& contact) {
  using namespace detail::stick;
  const auto dots = as_view(dots_mm);
  const auto touch = as_view(contact);
  ContactLoad<S> load;
  if (!same_size(dots, touch) || !is_plausible(force_n)) {
    return load;
  }
  const auto for_each = [&](const auto& visit) {
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j) {
        const Point3<S> p = detail::spatial_dot<S>(cell_t<Dots>(dots(i, j)));
        if (is_contact(cell_t<Contact>(touch(i, j))) && is_finite(p)) {
          visit(p);
        }
      }
    }
  };
  const auto surface = quadric_through<S>(for_each);
  if (surface.dots < 3) {
    return load;
  }
  Point3<S> sum = {S(0), S(0), S(0)};
  for_each([&](const Point3<S>& p) { sum += surface.normal(p); });
  const Point3<S> normal = normalized(sum);
  S arms = S(0);
  for_each([&](const Point3<S>& p) {
    const Point3<S> arm = p - surface.middle;
    arms = arms + norm(arm - dot(arm, normal) * normal);
  });
  load.normal_n = -dot(force_n, normal);
  load.tangential_n = norm(force_n + load.normal_n * normal);
  load.moment_n_mm = dot(moment_n_mm - cross(surface.middle, force_n), normal);
  load.arm_mm = arms / S(static_cast<double>(surface.dots));
  return load;
}

/// L; NaN unless the normal force is > 0 and both forces are known.
template <scalar S>
S friction_of(const ContactLoad<S>& load) {
  using std::sqrt;
  if (!is_plausible(load.normal_n) || !is_plausible(load.tangential_n)) {
    return not_a_number<S>();
  }
  const S along = load.tangential_n / load.normal_n;
  const bool turns =
      is_plausible(load.moment_n_mm) && is_plausible(load.arm_mm) && value(load.arm_mm) > 0;
  const S about = turns ? S(load.moment_n_mm / (load.arm_mm * load.normal_n)) : S(0);
  const S sq = along * along + about * about;
  return value(load.normal_n) > 0 ? (value(sq) > 0 ? S(sqrt(sq)) : sq) : not_a_number<S>();
}

struct FrictionLimitOptions {
  /// Fraction of the limit above which the object counts as sliding, in (0, 1]. The default is 1
  /// less 2.4 times the noise of L. With both forces known to 1.5 %, L is known to 2.1 %.
  double slide_fraction = 0.95;
  double learn_below = 0.2;  ///< stick ratio of the dots below which the limit is learnt, in (0, 1)
  /// Largest factor by which the limit rises or falls in a frame, > 1. An object that exceeds the
  /// limit by this factor while more than half of it sticks makes the limit unknown again.
  double max_rise = 1.15;
  double min_normal_n = 0.05;  ///< N, > 0: L is unknown with a smaller normal force
};
inline void expects_valid(const FrictionLimitOptions& o) {
  const auto check = [](bool good, const char* name, double given, const char* range) {
    expects(good && is_finite(given), "FrictionLimitOptions", name, given, range);
  };
  check(o.slide_fraction > 0 && o.slide_fraction <= 1, "slide_fraction", o.slide_fraction,
        "in (0, 1]");
  check(o.learn_below > 0 && o.learn_below < 1, "learn_below", o.learn_below, "in (0, 1)");
  check(o.max_rise > 1, "max_rise", o.max_rise, "finite and > 1");
  check(o.min_normal_n > 0, "min_normal_n", o.min_normal_n, "finite and > 0");
}

enum class FrictionLimitStatus : std::uint8_t {
  held,      ///< L is at most slide_fraction of the limit
  sliding,   ///< L is above it: the stick ratio is 0, whatever the dots report
  no_limit,  ///< no slide so far: the answer is that of the dots alone
  no_load,   ///< no normal force, or a force is not finite: the answer is that of the dots alone
};

/// "held", "sliding", ...
constexpr const char* name_of(FrictionLimitStatus status) {
  switch (status) {
    case FrictionLimitStatus::held:
      return "held";
    case FrictionLimitStatus::sliding:
      return "sliding";
    case FrictionLimitStatus::no_limit:
      return "no limit";
    case FrictionLimitStatus::no_load:
      return "no load";
  }
  return "unknown";
}

/// What an answer is based on.
enum class SlipEvidence : std::uint8_t {
  none,
  dots,      ///< the stick ratio of the dots
  imprint,   ///< on a gel: slide of the imprint, lost area, or recoil
  friction,  ///< the friction limit alone
  both,      ///< friction, and dots or imprint
};

/// Result with evidence for slip on a gel: SlideResult, or RecoilResult if only the dots are known.
template <class T> concept imprint_result = requires(const T& seen) {
  seen.ok();
  seen.held();
  seen.touches();
};

/// The stick ratio by dots, or by the imprint on a gel, combined with friction.
template <scalar S = double>
struct [[nodiscard]] SlipResult {
  FrictionLimitStatus status = FrictionLimitStatus::no_load;
  SlipEvidence evidence = SlipEvidence::none;
  /// In [0, 1]; NaN: unknown. With an imprint it is 1 - the imprint's evidence for slip.
  S stick_ratio = not_a_number<S>();
  RatioUpdate update = RatioUpdate::missing;  ///< how current it is, for GripControl
  S dots_ratio = not_a_number<S>();           ///< of dots or imprint alone in this frame; NaN: none
  Index reference_age = 0;  ///< frames since the reference of the dots; 0: unknown
  /// The dots move back toward their free positions: the load falls, or the object slides because
  /// friction has fallen.
  bool falls_back = false;
  S normal_n = not_a_number<S>();  ///< F_n; NaN where L is unknown
  S friction = not_a_number<S>();  ///< L
  S limit = not_a_number<S>();     ///< L at the last slide; NaN: none so far
  S margin = not_a_number<S>();    ///< 1 - L / limit; NaN if unknown

  bool ok() const { return is_finite(stick_ratio); }
};

/// Combines the dots, or the imprint on a gel, with friction. Const, O(1), allocates nothing,
/// throws nothing.
template <scalar S = double>
class FrictionLimit {
 public:
  /// A value: copy it to return to this frame later.
  class State {
   public:
    const S& limit() const { return limit_; }
    void reset() { *this = State(); }

   private:
    friend class FrictionLimit;
    State() = default;
    S limit_ = not_a_number<S>();
    detail::stick::PeakLoads<S> loads_;
  };

  /// Refuses bad parameters (parameter_error).
  explicit FrictionLimit(const FrictionLimitOptions& options = {}) : options_(options) {
    expects_valid(options);
  }

  State start() const { return State(); }

  /// `stick_ratio` (NaN: none) and `update` are those of the dots. `reference_age`, the number of
  /// frames since their reference, is needed to detect that the limit has fallen (0: unknown; the
  /// limit is then not lowered far). The limit is a property of the object and outlives a contact,
  /// so reset the state when another object is grasped.
  SlipResult<S> operator()(const ContactLoad<S>& load,
                           const S& stick_ratio,
                           RatioUpdate update,
                           State& state,
                           Index reference_age = 0) const {
    return fuse(load, stick_ratio, update, SlipEvidence::dots, reference_age, state);
  }

  /// The same for the result of a stick ratio, whose reference_age tells GripControl whether it is
  /// new. If dots in space fall back, their ratio is used only if the load shows that the object
  /// carries them.
  template <class Stick>
    requires requires(const Stick& seen) {
      seen.stick_ratio;
      seen.reference_age;
      update_of(seen.status);
    }
  SlipResult<S> operator()(const ContactLoad<S>& load, const Stick& seen, State& state) const {
    if constexpr (requires { seen.back.reference_age; }) {
      if (is_finite(seen.back.stick_ratio)) {
        return of_falling_back(load, seen, state);
      }
    }
    return (*this)(load, S(seen.stick_ratio), update_of(seen.status), state, seen.reference_age);
  }

  /// The same for a gel, where `imprint`, the result of ContactSlide or Recoil, replaces the dots.
  /// The limit is learnt while held() is below learn_below, and is used where the imprint is not
  /// found.
  template <imprint_result Imprint>
  SlipResult<S> operator()(const ContactLoad<S>& load, const Imprint& imprint, State& state) const {
    const RatioUpdate update = imprint.ok()        ? RatioUpdate::fresh
                               : imprint.touches() ? RatioUpdate::missing
                                                   : RatioUpdate::no_contact;
    const S held = imprint.ok() ? S(imprint.held()) : not_a_number<S>();
    return fuse(load, held, update, SlipEvidence::imprint, 0, state);
  }

 private:
  /// `ratio` is that of `source`.
  SlipResult<S> fuse(const ContactLoad<S>& load,
                     const S& ratio,
                     RatioUpdate update,
                     SlipEvidence source,
                     Index reference_age,
                     State& state) const {
    SlipResult<S> result;
    const bool known = value(ratio) >= 0 && value(ratio) <= 1;
    result.stick_ratio = known ? ratio : not_a_number<S>();
    result.dots_ratio = update == RatioUpdate::fresh ? result.stick_ratio : not_a_number<S>();
    result.update = update;
    result.evidence = known ? source : SlipEvidence::none;
    result.friction = known_friction(load);
    result.limit = state.limit_;
    result.reference_age = reference_age;
    state.loads_.add(result.friction);
    if (!is_finite(result.friction)) {
      return result;
    }
    result.normal_n = load.normal_n;
    const bool slides = known && update == RatioUpdate::fresh && ratio < S(options_.learn_below);
    if (slides) {
      learn(result, state);
    } else if (known && update == RatioUpdate::fresh && 2 * value(ratio) > 1 &&
               result.friction > S(options_.max_rise) * state.limit_) {
      // The object holds at more than the limit, so the limit was wrong.
      state.limit_ = not_a_number<S>();
    }
    judge(slides, state, result);
    return result;
  }

  /// An object that sticks carries a membrane back only while its load falls, here by more than 2.5
  /// times the noise of the difference of two L, 3.0 % for forces known to 1.5 %. Under an object
  /// that slides, the membrane springs back while the load stays. If no limit is known yet, such a
  /// slide is learnt, provided that less than half stuck in the last ratio of the dots.
  template <class Stick>
  SlipResult<S> of_falling_back(const ContactLoad<S>& load, const Stick& seen, State& state) const {
    const Index age = seen.back.reference_age;
    const S friction = known_friction(load), highest = state.loads_.since(age - 1);
    const bool carried = friction < S(1 - 1.5 * (1 - options_.slide_fraction)) * highest;
    const bool stays = friction > S(options_.slide_fraction) * highest;
    const bool slides = stays && !is_finite(state.limit_) && 2 * value(seen.stick_ratio) < 1;
    SlipResult<S> result =
        carried  ? (*this)(load, S(seen.back.stick_ratio), RatioUpdate::fresh, state, age)
        : slides ? (*this)(load, S(0), RatioUpdate::fresh, state, age)
                 : (*this)(load, S(seen.stick_ratio), update_of(seen.status), state, age);
    result.falls_back = true;
    return result;
  }

  /// L; NaN if the normal force is below min_normal_n.
  S known_friction(const ContactLoad<S>& load) const {
    return !(load.normal_n < S(options_.min_normal_n)) ? friction_of(load) : not_a_number<S>();
  }

  void learn(const SlipResult<S>& seen, State& state) const {
    if (!is_finite(state.limit_)) {
      // a smaller L is no friction
      state.limit_ = seen.friction > S(1e-6) ? seen.friction : state.limit_;
      return;
    }
    if (seen.friction < S(options_.slide_fraction) * state.limit_) {
      follow_fall(seen, state);
      return;
    }
    const S top = S(options_.max_rise) * state.limit_;
    const S toward = value(seen.friction) < value(top) ? seen.friction : top;
    // rises fast and falls slowly: noise makes the mean slightly too high, never too low
    const S share = value(toward) > value(state.limit_) ? S(1) / S(2) : S(1) / S(10);
    state.limit_ = state.limit_ + share * S(toward - state.limit_);
  }

  /// Lowers a limit that has fallen. Whatever slid since the reference did so under no larger load
  /// than the largest since then. If a fraction s sticks, that load is (1 - s^(3/2)) of the limit
  /// (Cattaneo, Mindlin). A limit above this by more than the noise of L has fallen.
  void follow_fall(const SlipResult<S>& seen, State& state) const {
    using std::sqrt;
    if (seen.reference_age <= 0) {
      return;
    }
    const S stick = seen.stick_ratio;
    const S slips = S(1) - (value(stick) > 0 ? S(stick * S(sqrt(stick))) : S(0));
    const S highest =
        state.loads_.since(seen.reference_age) / S(S(options_.slide_fraction) * slips);
    if (highest < state.limit_) {
      const S least = state.limit_ / S(options_.max_rise);
      state.limit_ = highest < least ? least : highest;
    }
  }

  void judge(bool slides, const State& state, SlipResult<S>& result) const {
    result.limit = state.limit_;
    if (!is_finite(state.limit_)) {
      result.status = FrictionLimitStatus::no_limit;
      return;
    }
    result.margin = S(1) - result.friction / state.limit_;
    if (!(result.friction > S(options_.slide_fraction) * state.limit_)) {
      result.status = FrictionLimitStatus::held;
      return;
    }
    result.status = FrictionLimitStatus::sliding;
    result.evidence = slides ? SlipEvidence::both : SlipEvidence::friction;
    result.stick_ratio = S(0);
    result.update = RatioUpdate::fresh;
  }

  FrictionLimitOptions options_;
};

}  // namespace v0
}  // namespace fingerpad
