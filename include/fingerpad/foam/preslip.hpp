// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Warns before a held object slips, from the readings of foam fingers and without a friction
// coefficient. Source: "Pre-Slip Sensing Using Tactile Sensor" (2007), the rule sets of its two
// experiments. The samples T_1, T_2, ... of all fingers are kept in a stack. Two of them, the older
// a (index 1) and the later b (index 2), show pre-slip if
//
//   grasp-optimise  location(a) != location(b) and waves(a) == waves(b)      on all fingers
//   grasp-lift      centroid(a) != centroid(b) and location(a) != location(b)
//                   and waves(b) > waves(a)                                  on any finger
//
// As printed, each finger has one vibrating location, that of its strongest vibration. But "if
// there exist some tactile elements having the same frequency, then pre-slip can be recognized":
// the default grasp-optimise takes any element that vibrates, those of a also on another finger.
// Each pair is compared once (docs/errata.md, E042): the newest sample with those before it.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

enum class TaxelStatus : std::uint8_t {
  vibrating,  ///< a taxel varies by more than its noise: location and waves are known
  quiet,      ///< none does, although some taxel that can be judged is pressed enough to
  filling,    ///< too few samples since the start or since a new clock
  no_taxels,  ///< all taxels are dead, saturated, stuck, flickering or missing
  frozen,     ///< no reading has changed for long, or ever: a dead array, nothing touches it, or
              ///< an object is held still
  /// All readings are below what counts as vibration: nothing presses, or the noise is given in
  /// another unit.
  too_weak,
  /// Windows do not fill, or more than half of the clock's steps are gaps: time not in seconds?
  clock_jumps,
  /// The array has another size, or its time is missing or not later than the last one: nothing was
  /// done.
  refused,
};

/// "vibrating", "quiet", ...
constexpr const char* name_of(TaxelStatus status) {
  constexpr std::array<const char*, 8> names = {"vibrating", "quiet",    "filling",     "no taxels",
                                                "frozen",    "too weak", "clock jumps", "refused"};
  const auto k = static_cast<std::size_t>(status);
  return k < names.size() ? names[k] : "unknown";
}

/// Sample of one foam finger at one time, as the paper stores it at each location T_i of its stack.
template <scalar S = double>
struct FingerSample {
  static constexpr Index no_location = -1;

  /// The taxels that vibrate with the same number of waves.
  struct Vibration {
    Index waves = 0;
    Index location = no_location;  ///< of one of them
    bool is_several = false;       ///< there are others
  };

  TaxelStatus status = TaxelStatus::filling;
  /// Centroid of the force; x is along columns; NaN: nothing presses.
  S center_x_mm = not_a_number<S>();
  S center_y_mm = not_a_number<S>();
  S sum = S(0);                  ///< sum of the readings, in their unit
  Index location = no_location;  ///< row * cols + col of the taxel that vibrates most
  Index waves = 0;               ///< number of its waves in the window, 0 if nothing vibrates
  S frequency_hz = S(0);         ///< its waves per second, by the clock
  S deviation = S(0);            ///< its rms, in the unit of the readings
  Index left_out = 0;            ///< taxels that do not count in this sample
  /// Whether a window was quiet since the start, so that a present vibration has begun after it.
  bool has_rested = true;
  Index vibration_count = 0;
  /// All vibrations, by their number of waves.
  std::array<Vibration, 16> vibrations = {};

  /// Adds a vibrating taxel; the first is that of `location`. Numbers of waves beyond the size of
  /// `vibrations` are left out.
  void add_vibration(Index at, Index with_waves) {
    if (vibration_count == 0) {
      location = at;
      waves = with_waves;
    }
    for (Index k = 0; k < vibration_count; ++k) {
      Vibration& known = vibrations[static_cast<std::size_t>(k)];
      if (known.waves == with_waves) {
        known.is_several = known.is_several || known.location != at;
        return;
      }
    }
    if (vibration_count < static_cast<Index>(vibrations.size())) {
      vibrations[static_cast<std::size_t>(vibration_count++)] = {with_waves, at};
    }
  }

  /// Whether slip can be judged. A finger that has vibrated ever since the start may have noise or
  /// swapped bytes.
  bool can_tell() const {
    return has_rested && (status == TaxelStatus::vibrating || status == TaxelStatus::quiet);
  }
  /// The vibrations by which slip is judged; none if it cannot be.
  std::span<const Vibration> judged() const {
    return {vibrations.data(), can_tell() ? static_cast<std::size_t>(vibration_count) : 0};
  }
  bool is_pressed() const { return is_finite(center_x_mm) && is_finite(center_y_mm); }
  bool is_vibrating() const { return location != no_location && waves > 0; }
};

enum class PreslipRule : std::uint8_t {
  /// Second experiment, and the rule for all other cases.
  grasp_lift,
  /// First experiment. Use it when an object hangs between fingers that press alike and the grip is
  /// loosened.
  grasp_optimise,
  printed_grasp_optimise,  ///< by the strongest vibration of each finger alone
};

/// "grasp_lift", "grasp_optimise", ...
constexpr const char* name_of(PreslipRule rule) {
  constexpr std::array<const char*, 3> names = {"grasp_lift", "grasp_optimise",
                                                "printed_grasp_optimise"};
  return names[static_cast<std::size_t>(rule)];
}

enum class PreslipStatus : std::uint8_t {
  steady,      ///< all fingers can be judged, and nothing slips
  preslip,     ///< part of the contact begins to slip
  slipped,     ///< the whole object slips or is gone; set by callers, never by a rule
  cannot_tell  ///< a finger cannot be judged, and no other shows pre-slip
};

/// "steady", "preslip", ...
constexpr const char* name_of(PreslipStatus status) {
  constexpr std::array<const char*, 4> names = {"steady", "preslip", "slipped", "cannot tell"};
  const auto k = static_cast<std::size_t>(status);
  return k < names.size() ? names[k] : "unknown";
}

/// The rule and its thresholds, of which the paper prints no values.
struct PreslipOptions {
  PreslipRule rule = PreslipRule::grasp_lift;
  Index history = 100;  ///< number of samples compared, in [2, 100000]
  /// A later sample with fewer waves counts as silent, >= 0. 0 as published: no waves in both
  /// samples are then an equal frequency.
  Index min_waves = 1;
  /// Noise of a centroid, >= 0: centroids differ if they are farther apart along an axis.
  double centroid_tolerance_mm = 0.1;
};

/// Says which option has no meaning; "" if all have one.
inline std::string check(const PreslipOptions& o) {
  return check("PreslipOptions",
               {{"history", o.history, within(2, 100000)},
                {"min_waves", o.min_waves, not_negative},
                {"centroid_tolerance_mm", o.centroid_tolerance_mm, not_negative}});
}

namespace detail {

/// Whether the centroids of a finger differ by more than the tolerance along an axis.
template <scalar S>
bool has_moved(const FingerSample<S>& a, const FingerSample<S>& b, const PreslipOptions& options) {
  const auto differ = [&](const S& p, const S& q) {
    const S tolerance = S(options.centroid_tolerance_mm);
    return tolerance < p - q || tolerance < q - p;
  };
  return a.is_pressed() && b.is_pressed() &&
         (differ(a.center_x_mm, b.center_x_mm) || differ(a.center_y_mm, b.center_y_mm));
}

/// Whether a finger has a vibrating location.
template <scalar S>
bool vibrates(const FingerSample<S>& sample) {
  return sample.can_tell() && sample.location >= 0;
}

/// Whether the taxels of two vibrations include two different ones.
template <class Vibration>
bool at_another(const Vibration& a, const Vibration& b) {
  return a.is_several || b.is_several || a.location != b.location;
}

/// Finger f: a taxel vibrates with as many waves as another taxel, of this or another finger, did.
template <class Fingers, scalar S>
bool grasp_optimise(const Fingers& older,
                    const FingerSample<S>& later,
                    std::size_t f,
                    const PreslipOptions& options) {
  for (std::size_t g = 0; g < older.size(); ++g) {
    for (const auto& a : older[g].judged()) {
      for (const auto& b : later.judged()) {
        if (a.waves == b.waves && b.waves >= options.min_waves && (g != f || at_another(a, b))) {
          return true;
        }
      }
    }
  }
  return false;
}

/// Another location vibrates, with the same number of waves.
template <scalar S>
bool printed_grasp_optimise(const FingerSample<S>& a,
                            const FingerSample<S>& b,
                            const PreslipOptions& options) {
  return vibrates(a) && vibrates(b) && a.location != b.location && a.waves == b.waves &&
         b.waves >= options.min_waves;
}

/// The centroid has moved and another location vibrates, with more waves. An older sample without
/// vibration has no location, which differs from every location.
template <scalar S>
bool grasp_lift(const FingerSample<S>& a, const FingerSample<S>& b, const PreslipOptions& options) {
  return a.can_tell() && vibrates(b) && has_moved(a, b, options) && a.location != b.location &&
         b.waves > a.waves && b.waves >= options.min_waves;
}

}  // namespace detail

/// Whether one older and one later sample of all fingers fulfil the rule: the predicate alone,
/// without a history. Both are arrays, vectors or spans of as many FingerSample.
template <class Fingers>
bool is_preslip(const Fingers& older, const Fingers& later, const PreslipOptions& options = {}) {
  const PreslipRule rule = options.rule;
  const bool on_any = rule == PreslipRule::grasp_lift;
  for (std::size_t f = 0; f < later.size(); ++f) {
    const auto &a = older[f], &b = later[f];
    const bool holds = on_any ? detail::grasp_lift(a, b, options)
                       : rule == PreslipRule::grasp_optimise
                           ? detail::grasp_optimise(older, b, f, options)
                           : detail::printed_grasp_optimise(a, b, options);
    if (holds == on_any) {
      return on_any;
    }
  }
  return !on_any;
}

/// Applies a rule to the last samples of a hand, which it keeps: copy it to return to this sample
/// later. A sample takes O(history) time, allocates nothing and throws nothing.
template <scalar S = double>
class Preslip {
 public:
  /// For a hand of `fingers` fingers, in [1, 100]. Refuses bad parameters (parameter_error).
  explicit Preslip(Index fingers, const PreslipOptions& options = {})
      : options_(checked(fingers, options)),
        fingers_(static_cast<std::size_t>(fingers)),
        samples_(fingers_ * static_cast<std::size_t>(options.history)) {}

  /// Forgets all samples.
  void reset() { count_ = 0; }

  /// Adds the newest sample of all fingers to the history. `preslip`: it makes a pair with an older
  /// one. A finger that cannot be judged forms no pair, never hides the pairs of other fingers, and
  /// never counts as steady. A sample that a finger has refused, or of another number of fingers,
  /// is not added: `cannot_tell`.
  PreslipStatus operator()(std::span<const FingerSample<S>> newest) {
    const auto any = [&](const auto& is) { return std::any_of(newest.begin(), newest.end(), is); };
    if (newest.size() != fingers_ ||
        any([](const auto& finger) { return finger.status == TaxelStatus::refused; })) {
      return PreslipStatus::cannot_tell;
    }
    std::copy(newest.begin(), newest.end(), sample(count_).begin());
    const bool is_silent = !any([](const auto& finger) { return detail::vibrates(finger); });
    const std::size_t kept = is_silent ? 0 : (std::min)(count_, samples_.size() / fingers_ - 1);
    ++count_;
    for (std::size_t age = 1; age <= kept; ++age) {
      if (is_preslip(std::span<const FingerSample<S>>(sample(count_ - 1 - age)), newest,
                     options_)) {
        return PreslipStatus::preslip;
      }
    }
    return any([](const auto& finger) { return !finger.can_tell(); }) ? PreslipStatus::cannot_tell
                                                                      : PreslipStatus::steady;
  }

 private:
  static const PreslipOptions& checked(Index fingers, const PreslipOptions& options) {
    require(options);
    require("Preslip", {{"fingers", fingers, within(1, 100)}});
    return options;
  }

  /// All fingers at one time, numbered from the start.
  std::span<FingerSample<S>> sample(std::size_t number) {
    return {&samples_[number * fingers_ % samples_.size()], fingers_};
  }

  PreslipOptions options_;
  std::size_t fingers_;
  std::vector<FingerSample<S>> samples_;  // history x fingers, a ring
  std::size_t count_ = 0;                 // samples since the start
};

}  // namespace v1
}  // namespace fingerpad
