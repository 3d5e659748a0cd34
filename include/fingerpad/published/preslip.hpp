// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The rules of pre-slip as printed. Each finger has one vibrating location, that of its strongest
// vibration. At each sample both indices scan the whole stack. A sample without waves does not
// count as silent. docs/foam/preslip.md.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fingerpad/foam/preslip.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// Options as printed: no later sample counts as silent.
template <scalar S = double>
PreslipOptions<S> preslip_options() {
  PreslipOptions<S> options;
  options.min_waves = 0;
  return options;
}

/// First experiment: on all fingers another location vibrates, with the same number of waves.
struct GraspOptimise {
  static constexpr const char* name = "grasp_optimise";

  template <std::size_t Fingers>
  static bool holds(const detail::HandSides<Fingers>& older,
                    const detail::HandSides<Fingers>& later,
                    double) {
    bool on_all = true;
    for (std::size_t f = 0; f < Fingers; ++f) {
      const detail::PairSide &a = older[f], &b = later[f];
      on_all = on_all && a.is_vibrating && b.is_vibrating && a.location != b.location &&
               a.waves == b.waves;
    }
    return on_all;
  }
};

/// Second experiment: on any finger the centroid of force has moved and another location vibrates,
/// with more waves. An earlier sample without vibration has no location, which differs from every
/// location.
struct GraspLift {
  static constexpr const char* name = "grasp_lift";

  template <std::size_t Fingers>
  static bool holds(const detail::HandSides<Fingers>& older,
                    const detail::HandSides<Fingers>& later,
                    double tolerance_mm) {
    bool on_any = false;
    for (std::size_t f = 0; f < Fingers; ++f) {
      const detail::PairSide &a = older[f], &b = later[f];
      on_any = on_any || (b.is_vibrating && a.location != b.location && b.waves > a.waves &&
                          detail::has_moved(a, b, tolerance_mm));
    }
    return on_any;
  }
};

/// The scan of the stack: index 1 runs from the oldest sample up, and index 2 from the newest
/// sample down to index 1 (E042). The answers are those of fingerpad::Preslip. O(history^2).
template <class Rule, std::size_t Fingers = 2, scalar S = double>
class StackScan {
 public:
  class State {
   public:
    void reset() { stack_.clear(); }

   private:
    friend class StackScan;
    explicit State(Index history) : stack_(history) {}
    detail::SideHistory<Fingers> stack_;
  };

  explicit StackScan(const PreslipOptions<S>& options = preslip_options<S>()) : options_(options) {
    expects_valid(options);
  }
  const PreslipOptions<S>& options() const { return options_; }
  State start() const { return State(options_.history); }

  PreslipResult operator()(const std::array<FingerSample<S>, Fingers>& newest, State& state) const {
    PreslipResult result;
    auto& stack = state.stack_;
    if (stack.size() != options_.history) {
      return result;
    }
    stack.add(detail::hand_sides(newest, options_));
    const double tolerance = static_cast<double>(value(options_.centroid_tolerance_mm));
    const std::int64_t last = stack.newest();
    for (std::int64_t index_1 = stack.oldest(); index_1 < last; ++index_1) {
      for (std::int64_t index_2 = last; index_2 > index_1; --index_2) {
        if (Rule::holds(stack[index_1], stack[index_2], tolerance)) {
          result.alarm = true;
          result.is_fresh = result.is_fresh || index_2 == last;
          result.samples_ago = last - index_1;  // that of the latest index 1 remains
        }
      }
    }
    result.status = detail::preslip_status(newest, result.is_fresh);
    return result;
  }

 private:
  PreslipOptions<S> options_;
};

template <std::size_t Fingers = 2, scalar S = double>
StackScan<GraspOptimise, Fingers, S> grasp_optimise(
    const PreslipOptions<S>& options = preslip_options<S>()) {
  return StackScan<GraspOptimise, Fingers, S>(options);
}
template <std::size_t Fingers = 2, scalar S = double>
StackScan<GraspLift, Fingers, S> grasp_lift(
    const PreslipOptions<S>& options = preslip_options<S>()) {
  return StackScan<GraspLift, Fingers, S>(options);
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
