// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The fraction of the contact that sticks to the object, from the dots in space. When an object
// rolls, tilts or presses deeper, its dots move by different amounts in the image although all
// stick; in space one rigid motion describes them all. The slip of a dot is its residual from that
// motion along the surface. Reference frame and relative threshold are those of stick_ratio.hpp.
// Measured figures are in docs/slip/spatial_stick_ratio.md.
//
// Use it if depth is known, otherwise use stick_ratio.hpp. Neither detects an object that slides as
// a whole while the membrane is at rest; friction_limit.hpp does.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/slip/detail/dot_doubts.hpp"
#include "fingerpad/slip/detail/dot_places.hpp"
#include "fingerpad/slip/detail/rigid_consensus.hpp"
#include "fingerpad/slip/detail/spatial_doubts.hpp"
#include "fingerpad/slip/detail/spatial_state.hpp"
#include "fingerpad/slip/stick_result.hpp"

namespace fingerpad {
inline namespace v0 {

/// Noise of a dot's position, and what counts as slip. All thresholds follow from the noise:
///   delta_0 = 2 gain lateral_mm sqrt(ln(1 / false_slip)), gain 0.416 by averaging over neighbours,
///   U = delta_0 / slip_share: the reference is the newest stored frame from which a dot in contact
///   has moved further; a frame is stored when a dot has moved U / 4 from the newest stored one.
/// The noise is measured in frames without contact; the given values apply until then. Errors of
/// depth move with the dots, so along z the larger of the given and the measured value applies.
struct SpatialStickTest {
  /// Standard deviation along x and along y, > 0. The default is 0.06 px for a pixel of 0.08 mm.
  double lateral_mm = 0.005;
  /// Standard deviation along z, > 0; counts where the surface is inclined.
  double depth_mm = 0.025;
  Index free_frames = 8;  ///< free frames that measure the noise, >= 0; 0: never measured
  /// A dot slips if its slip exceeds this fraction of the longest displacement, in (0, 0.5].
  double slip_share = 1.0 / 18;
  /// Fraction of sticking dots that noise makes appear to slip, in (0, 0.5].
  double false_slip = 0.01;
  Index min_dots = 6;  ///< needed to compare two frames, >= 6; with fewer there is no ratio
  /// A contact lost and found again within this time is the same one, and a clock may go back by as
  /// much. In s, >= 0.
  double hold_s = 0.2;
  Index capacity = 64;  ///< stored frames, in [1, 4096]; when full, the oldest is dropped
  /// Whether the object is known to be larger than the dot pattern. If not, a contact that contains
  /// all dots has no ratio once more than a tenth of them slip.
  bool covers_pattern = false;
};
inline void expects_valid(const SpatialStickTest& test) {
  const auto check = [](bool good, const char* name, double given, const char* range) {
    expects(good && is_finite(given), "SpatialStickTest", name, given, range);
  };
  check(test.lateral_mm > 0, "lateral_mm", test.lateral_mm, "finite and > 0");
  check(test.depth_mm > 0, "depth_mm", test.depth_mm, "finite and > 0");
  check(test.slip_share > 0 && test.slip_share <= 0.5, "slip_share", test.slip_share,
        "in (0, 0.5]");
  check(test.false_slip > 0 && test.false_slip <= 0.5, "false_slip", test.false_slip,
        "in (0, 0.5]");
  check(test.hold_s >= 0, "hold_s", test.hold_s, "finite and >= 0");
  expects(test.min_dots >= 6, "SpatialStickTest", "min_dots", static_cast<long long>(test.min_dots),
          ">= 6");
  expects(test.free_frames >= 0, "SpatialStickTest", "free_frames",
          static_cast<long long>(test.free_frames), ">= 0");
  expects(test.capacity >= 1 && test.capacity <= 4096, "SpatialStickTest", "capacity",
          static_cast<long long>(test.capacity), "in [1, 4096]");
}

/// Stick ratio of a pad whose dots are known in space, frame by frame. Threads may share one
/// estimator, each with its own state. A frame takes O(rows cols) time, plus O(dots in contact) for
/// each of at most `capacity` stored frames that it examines. It allocates nothing and throws
/// nothing.
template <scalar S = double>
class SpatialStickRatio {
 public:
  /// A value: copy it to return to this frame later. It holds all memory that frames need.
  using State = detail::stick::SpatialState<S>;

  /// For a grid of rows x cols dots. Refuses bad parameters (parameter_error).
  SpatialStickRatio(Index rows, Index cols, const SpatialStickTest& test = {}) : test_(test) {
    expects_grid_size("SpatialStickRatio", rows, cols, 1, test.capacity);
    expects_valid(test);
    layout_ = {rows, cols};
    const double gain = detail::stick::neighbour_gain();
    slip_quantile_ = 4 * gain * gain * std::log(1 / test.false_slip);
  }

  Index rows() const { return layout_.rows; }
  Index cols() const { return layout_.cols; }
  /// U in mm for dots with this noise.
  double reference_mm(double lateral_mm) const {
    return lateral_mm * std::sqrt(slip_quantile_) / test_.slip_share;
  }
  double reference_mm() const { return reference_mm(test_.lateral_mm); }

  /// The state before any frame, with all the memory that frames will need.
  State start() const { return State(layout_, test_.capacity, {test_.lateral_mm, test_.depth_mm}); }

  /// Processes a frame with the dots `dots_mm` (NaN: not found), of which those with a true
  /// `contact` touch the object, at a time in s (NaN: unknown). Writes the state of each dot to
  /// `states`.
  template <spatial_dot_grid Dots, contact_mask Contact, class States>
  SpatialStickResult<S> operator()(const Dots& dots_mm,
                                   const Contact& contact,
                                   States&& states,
                                   State& state,
                                   double time_s = not_a_number<double>()) const {
    static_assert(writable_grid<States>,
                  "this grid of states is written to: its cells must be assignable");
    const auto dots = as_view(dots_mm);
    const auto touch = as_view(contact);
    const auto to = as_view(states);
    if (dots.rows() != rows() || dots.cols() != cols() || !same_size(dots, touch) ||
        !same_size(dots, to) || !(state.layout == layout_) ||
        state.repository.capacity() != test_.capacity) {
      return {};
    }
    const bool back = state.clock.goes_back(time_s, test_.hold_s);
    if (back) {
      state.forget();
      state.frame = 0;
    }
    ++state.frame;
    state.given.read(dots, touch);
    measure_noise(state);
    const StickStatus status = look(state);
    state.result.status = back ? StickStatus::restarted : status;
    detail::stick::settle_marks(state.layout, state.given.touching, state.marks, state.result, to);
    if (status == StickStatus::updated && !test_.covers_pattern &&
        detail::stick::lacks_outline(state.result, layout_, state.given)) {
      state.result.status = StickStatus::no_outline;
      state.result.stick_ratio = state.result.ratio_sd = not_a_number<S>();
    }
    return state.result;
  }

 private:
  /// Measures the noise in frames without contact.
  void measure_noise(State& state) const {
    if (!state.given.touching.empty() || test_.free_frames == 0) {
      state.free_dots.interrupt();
    } else if (state.given.count > 0 && !state.clock.touched_within(test_.hold_s)) {
      state.free_dots.add(state.given.found);
      if (state.free_dots.frames() >= test_.free_frames) {
        state.noise = {state.free_dots.lateral(),
                       (std::max)(state.free_dots.depth(), test_.depth_mm)};
      }
    }
  }

  /// Noise along the axes. Along the pad it is at least a 2000th of a pitch, because no camera
  /// finds dots better and some files repeat them.
  detail::stick::DotNoiseMm noise_of(const State& state) const {
    const double pitch_mm = std::sqrt(static_cast<double>(value(state.pitch_sq)));
    return {(std::max)(state.noise.lateral_mm, pitch_mm / 2000), state.noise.depth_mm};
  }

  /// Status of this frame. Fills all of the result but the counts.
  StickStatus look(State& state) const {
    using namespace detail::stick;
    state.result.out_of_place = 0;
    state.result.back = {};
    if (state.given.touching.empty()) {
      if (state.given.count == 0) {
        return StickStatus::no_dots;
      }
      if (!state.clock.touched_within(test_.hold_s)) {
        state.forget();
        state.free = state.given.found;
      }
      return StickStatus::no_contact;
    }
    state.clock.touch();
    const PlacedDots placed = place_dots(state.given, layout_, state.now);
    state.result.out_of_place = placed.out_of_place;
    if (is_not_in_order(placed)) {
      return StickStatus::not_in_order;
    }
    if (placed.dots < test_.min_dots) {
      return state.given.count > 0 ? StickStatus::too_few_dots : StickStatus::no_dots;
    }
    state.pitch_sq = mean_pitch_sq(state.given.touching, state.now.data(), layout_);
    const DotNoiseMm noise = noise_of(state);
    const double reference = reference_mm(noise.lateral_mm);
    if (is_wrong_scale(state.pitch_sq, reference, reference * test_.slip_share)) {
      return StickStatus::wrong_scale;
    }
    const S reference_sq = S(reference * reference);
    const Choice<S> choice = choose(reference_sq, state);
    const bool leap = S(4) * reference_sq < choice.newest_sq;
    if (leap &&
        has_jumped(state.given.touching, state.now.data(), state.repository.dots(0), layout_)) {
      return StickStatus::jumped;
    }
    const StickStatus status = choice.age >= 0   ? answer(choice, noise, state)
                               : choice.standing ? StickStatus::standing
                                                 : StickStatus::no_reference;
    if (!choice.standing) {
      state.repository.store(state.now, state.frame);
    }
    return status;
  }

  /// As UpdatedReference, but a frame at rest is compared too. Afterwards the pairs are those of
  /// the chosen frame.
  detail::stick::Choice<S> choose(const S& reference_sq, State& state) const {
    using namespace detail::stick;
    Choice<S> choice;
    S before = S(-1);
    for (Index age = 0; age < state.repository.size(); ++age) {
      collect(state.repository.dots(age), state);
      const S sq = furthest_rigid_sq(state.pairs);
      if (age == 0) {
        choice.newest_sq = sq;
        choice.standing = !(sq < S(0)) && !(reference_sq / S(16) < sq);
      }
      if (sq < before) {
        break;
      }
      if (reference_sq < sq) {
        choice.age = age;
        choice.furthest_sq = sq;
        break;
      }
      before = sq;
    }
    return choice;
  }

  StickStatus answer(const detail::stick::Choice<S>& choice,
                     const detail::stick::DotNoiseMm& noise_mm,
                     State& state) const {
    using namespace detail::stick;
    using std::sqrt;
    const AxisNoise<S> noise = {S(1 / square(noise_mm.lateral_mm)),
                                S(1 / square(noise_mm.depth_mm))};
    if (state.pairs.size() < test_.min_dots) {
      return StickStatus::too_few_dots;
    }
    SpatialStickResult<S>& result = state.result;
    const S relative = S(choice.furthest_sq / S(square(reference_mm(noise_mm.lateral_mm))));
    const S limit = S(slip_quantile_) * relative;
    const Point3<S> from = state.has_center ? state.stick_center : middle_of(state.pairs);
    Pose<S> motion;
    auto covariance = fingerpad::detail::zero_matrix<S, 6>();
    if (!consensus(from, noise, limit, state, motion, covariance)) {
      return StickStatus::too_few_dots;
    }
    const Index age = static_cast<Index>(state.frame - state.repository.frame(choice.age));
    if (falls_back(state.given.touching, state.now.data(), state.repository.dots(choice.age),
                   state.free)) {
      Index stick = 0;
      state.pairs.for_each(
          [&](const PairBlock<S>& b, std::size_t k) { stick += b.mean_sq[k] < limit ? 1 : 0; });
      result.back = {S(static_cast<double>(stick)) / S(static_cast<double>(state.pairs.size())),
                     age};
      return StickStatus::falls_back;
    }
    mark(limit, S(std::sqrt(2.0) * noise_mm.lateral_mm), state);
    const S variance = stick_variance(state.pairs, limit, covariance, from, state.doubts);
    result.ratio_sd = ratio_sd_of(variance, S(static_cast<double>(state.pairs.size())));
    result.furthest_mm = S(sqrt(choice.furthest_sq));
    result.reference_age = age;
    result.motion = motion;
    return StickStatus::updated;
  }

  /// Collects the dots found in both frames.
  void collect(const Point3<S>* then, State& state) const {
    using namespace detail::stick;
    state.pairs.clear();
    const Point3<S>* const now = state.now.data();
    DotWalk walk(layout_);
    for (const Index k : state.given.touching) {
      const Point3<S> moved = now[k] - then[k];
      if (is_finite(S(moved.x + moved.y + moved.z))) {
        state.pairs.add(k, state.padded(walk.to(k)), state.spare(), then[k], now[k]);
      }
    }
  }

  /// Finds the rigid motion of the dots around `from` and of those that follow it. Dots within the
  /// limit are taken and the motion is fitted to them, until their number no longer changes.
  /// Weights by the averaged slip then reduce the influence of dots that slip a little. A dot of
  /// weight w enters the covariance of the motion with 1 / w of the noise: the less it follows, the
  /// more doubtful it is that it belongs to the object. False if the dots do not determine a
  /// motion.
  bool consensus(const Point3<S>& from,
                 const detail::stick::AxisNoise<S>& noise,
                 const S& limit,
                 State& state,
                 Pose<S>& motion,
                 detail::SmallMatrix<S, 6>& covariance) const {
    using namespace detail::stick;
    SpatialPairs<S>& pairs = state.pairs;
    set_surface(noise, pairs);
    weigh_around(from, state.pitch_sq, pairs);
    set_slips(motion, pairs);
    auto fit = refine_motion(pairs, noise, from, motion);
    if (!fit.good) {
      return false;
    }
    set_slips(motion, pairs);
    S before = S(-1);
    for (int pass = 0; pass < max_passes; ++pass) {
      const S followers = weigh_followers(limit, pairs);
      if (followers < S(min_followers)) {
        weigh_nearest(min_followers, state.sorted, pairs);
      }
      fit = refine_motion(pairs, noise, from, motion);
      if (!fit.good) {
        return false;
      }
      set_slips(motion, pairs);
      if (!(followers < before) && !(before < followers)) {
        break;
      }
      before = followers;
    }
    // noise gives averaged slips a mean square of 4 gain^2; at twice that the weight is 1/4
    const double gain = neighbour_gain();
    const S quarter = S(8 * gain * gain), gate = S(36) * limit;
    const auto average = [&] {
      average_slips(gate, noise, layout_.cols + 2, state.small_slips, pairs);
    };
    std::fill(state.small_slips.begin(), state.small_slips.end(),
              SmallSlip<S>{S(0), S(0), S(0), S(0)});
    for (int pass = 0; pass < 3; ++pass) {
      average();
      weigh_by_mean(quarter, pairs);
      fit = refine_motion(pairs, noise, from, motion);
      if (!fit.good) {
        return false;
      }
      set_slips(motion, pairs);
    }
    average();
    set_total_weights(state.small_slips, layout_.cols + 2, pairs);
    covariance = fit.inverse();
    for (auto& row : covariance) {
      for (S& c : row) {
        c = S(2) * c;  // both positions of a dot have noise
      }
    }
    return true;
  }

  /// Marks each dot found in both frames and writes its slip. `sd_mm`: standard deviation of the
  /// difference of two positions.
  void mark(const S& limit, const S& sd_mm, State& state) const {
    using namespace detail::stick;
    state.clear_answer();
    Point3<S> center = {S(0), S(0), S(0)};
    int stick = 0;
    state.pairs.for_each([&](const PairBlock<S>& b, std::size_t k) {
      const Index cell = b.cell[k];
      const bool sticks = b.mean_sq[k] < limit;
      at(state.marks, cell) = sticks ? DotState::stick : DotState::slip;
      at(state.dot_slips, cell) = {b.mean_slip[k], sd_mm};
      stick += sticks ? 1 : 0;
      center = sticks ? center + b.now[k] : center;
    });
    if (stick > 0) {
      state.stick_center = center / S(stick);
      state.has_center = true;
    }
    state.result.stick_ratio = S(stick) / S(static_cast<double>(state.pairs.size()));
  }

  static constexpr int max_passes = 6;
  static constexpr Index min_followers = 4;

  SpatialStickTest test_;
  detail::stick::DotLayout layout_;
  /// Quantile of the squared slip of a sticking dot, in variances of a position.
  double slip_quantile_ = 0;
};

}  // namespace v0
}  // namespace fingerpad
