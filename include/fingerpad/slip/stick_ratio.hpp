// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The fraction of the contact that sticks to the object, from the dots printed in the membrane, in
// the image or in space: 1 when nothing slips, 0 when the whole object slips. It falls before gross
// slip, because slip starts at the edge of the contact and spreads inward. Source: Ito, Kim,
// Obinata, "Robust slippage degree estimation based on reference update of vision-based tactile
// sensor", the talk with its backup slides. Printed forms: published/stick_ratio.hpp.
//
// A dot sticks if it has moved with the object since a reference frame, a stored one from which the
// dots have moved far enough in one direction to decide. The object is a rigid motion of the dots;
// in the image it may also appear larger or smaller. When an object rolls, tilts or presses deeper,
// its dots move by different amounts in the image although all stick: use dots in space if depth is
// known. Dots do not show an object that slides as a whole while the membrane is at rest;
// friction_limit.hpp does. Measured figures are in docs/slip/stick_ratio.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/rigid_fit.hpp"
#include "fingerpad/math/rotation.hpp"
#include "fingerpad/slip/detail/dot_surface.hpp"
#include "fingerpad/slip/detail/dots_in_order.hpp"
#include "fingerpad/slip/detail/frame_noise.hpp"

namespace fingerpad {
inline namespace v1 {

/// State of a dot.
enum class DotState : std::uint8_t {
  none = 0,     ///< not in contact
  unknown = 1,  ///< in contact, but missing now or in the reference
  slip = 2,     ///< it has not moved with the object since the reference
  stick = 3,    ///< it has moved with the object
};

enum class StickStatus : std::uint8_t {
  updated,  ///< the ratio is that of this frame
  /// No stored frame is far enough away in the direction of motion or, in the image, the dots rest.
  unmoved,
  /// The dots move back toward their free positions by more than they move sideways. Either an
  /// object that reverses carries them, or one that slides lets them go. The dots do not show
  /// which; the force does (friction_limit.hpp).
  falls_back,
  too_few_dots,  ///< fewer than six to compare, or in space on a line; nothing is dropped
  /// More than a fifth of the dots in contact are not between their neighbours, or all dots are
  /// labelled differently than before: shifted by one place, rows and columns exchanged, two
  /// halves exchanged. Or U is more than half a pitch, so that the noise was given in another unit.
  /// The frame is skipped.
  not_in_order,
  /// Every dot that was found is in contact, up to all sides of the pattern, and more than a tenth
  /// have not followed the object. Either they slip, or they lie outside of the contact on a gel
  /// that is dragged along around it. The ratio is NaN. Give the true contact, or set
  /// covers_pattern.
  no_outline,
  no_contact,  ///< nothing touches; after 0.2 s all stored frames are dropped
  refused,     ///< a grid has another size: nothing was done
};

/// "updated", "unmoved", ...
constexpr const char* name_of(StickStatus status) {
  constexpr std::array<const char*, 8> names = {"updated",      "unmoved",      "falls back",
                                                "too few dots", "not in order", "no outline",
                                                "no contact",   "refused"};
  return names[static_cast<std::size_t>(status)];
}

/// Noise of the dots, and what counts as slip. Lengths are in the unit of the dots, whatever it is.
/// The thresholds follow from the noise, 1 % of sticking dots being taken for slipping:
///   delta_0 = 2 gain noise sqrt(ln(1 / 0.01)), gain 0.416 by averaging over neighbours,
///   U = delta_0 / slip_share: the reference is the newest stored frame from which a dot in contact
///   has moved further, else in space by U / 2; a frame is stored when a dot has moved U / 4 from
///   the newest stored one. The last 64 are kept.
struct StickOptions {
  /// Standard deviation of a dot along x and along y, >= 0; 0: measured between successive frames.
  double noise = 0;
  /// A dot slips if its slip exceeds this fraction of the longest displacement, in (0, 0.5].
  double slip_share = 1.0 / 18;
  /// Whether the object is known to be larger than the dot pattern. If not, a contact that contains
  /// all dots has no ratio once more than a tenth of them slip.
  bool covers_pattern = false;
};

/// Says which value is out of range; "" if none is.
inline std::string check(const StickOptions& o) {
  return check("StickOptions",
               {{"noise", o.noise, not_negative},
                {"slip_share", o.slip_share, {.min = 0, .max = 0.5, .above_min = true}}});
}

/// Result of a frame. If the status is neither `updated` nor `no_outline`, all from stick_ratio on
/// is that of the last frame with an answer in this contact; while nothing touches, the ratio is
/// NaN.
template <scalar S = double>
struct [[nodiscard]] StickResult {
  StickStatus status = StickStatus::refused;
  Index stick = 0, slip = 0, unknown = 0;  ///< dots in contact, by their state
  Index out_of_place = 0;  ///< dots in contact that are not between their neighbours: left out
  /// If the status is falls_back: the ratio of this frame if the object carries the dots back, its
  /// standard deviation, and the frames since its reference.
  S back_ratio = not_a_number<S>(), back_sd = not_a_number<S>();
  Index back_age = 0;
  /// Since the frame before, a dot in contact has moved by more than half a pitch: the frames are
  /// too far apart. A slide can begin and end between them, and the ratio may come too late.
  bool far_apart = false;
  S stick_ratio = not_a_number<S>();  ///< sticking dots / known dots, in [0, 1]; NaN: none yet
  /// Its standard deviation: sqrt(0.065^2 + 0.9^2 / n + q^2 + c^2 / 3) with n dots in contact, the
  /// share q of dots that slip by one to two times what counts as slip, as on a soft object or with
  /// noise, and the change c since the last answer, before the first one since 1, which may be any
  /// part of a larger one when the steps between frames are large. A kept ratio has 0.05 more with
  /// each frame, up to 0.5.
  S ratio_sd = not_a_number<S>();
  S furthest = not_a_number<S>();  ///< d_max, the largest displacement from the reference
  Index reference_age = 0;         ///< frames from the reference to the answer
  /// Of the object since the reference, in the unit of the dots: a sticking dot has moved from p to
  /// scale * rotation(p) + translation. In the image the rotation is about z.
  Pose<S> motion = {};
  S scale = S(1);  ///< the object appears this much larger than in the reference; in space 1

  bool accepted() const { return status != StickStatus::refused; }
  /// Whether the ratio may be used: of this frame, or still that of the last answer.
  bool ok() const { return accepted() && is_finite(stick_ratio); }
  bool updated() const { return status == StickStatus::updated; }
  Index dots_in_contact() const { return stick + slip + unknown; }
  /// What the number of dots alone leaves of ratio_sd.
  S least_sd() const {
    using std::sqrt;
    return sqrt(S(square(0.065)) + S(square(0.9)) / detail::number<S>(dots_in_contact()));
  }
};

/// Stick ratio of a pad, frame by frame. The object is the state: copy it to return to a frame
/// later. A frame takes O(rows cols) time, plus O(dots in contact) for each stored frame that it
/// examines. It allocates nothing and throws nothing.
template <scalar S = double>
class StickRatio {
  using P = Point3<S>;

 public:
  /// For a grid of rows x cols dots. Refuses bad parameters (parameter_error).
  StickRatio(Index rows, Index cols, const StickOptions& options = {})
      : options_(
            (expects_grid_size("StickRatio", rows, cols, 1, capacity), require(options), options)),
        frame_{rows, cols},
        now_(frame_.found),
        free_(frame_.found),
        in_order_(frame_.found),
        measured_noise_(now_.size(), frame_.width),
        states_(now_.size(), DotState::none),
        slips_(now_.size(), no_slip()),
        small_(now_.size()),
        stored_(now_.size() * static_cast<std::size_t>(capacity)),
        stored_at_(static_cast<std::size_t>(capacity)),
        placed_(now_.size()),
        pairs_(now_.size()) {}

  Index rows() const { return frame_.rows; }
  Index cols() const { return frame_.cols; }

  /// Returns to the state before the first frame.
  void reset() {
    forget();
    measured_noise_.reset();
    std::fill(free_.begin(), free_.end(), detail::missing_point<S>());
    latest_s_ = contact_s_ = never;
  }

  /// Processes a frame with the dots `dots` (NaN: not found; so are two or more at exactly 0 or
  /// exactly -1), of which those with a true `contact` touch the object, at a time in s (NaN:
  /// unknown). Points with a z are in space, others in the image. A recording has one kind. A
  /// contact lost and found again within 0.2 s is the same one, and a clock may go back by as much;
  /// beyond that another recording has begun.
  template <dot_grid Dots, contact_mask Contact>
  StickResult<S> operator()(const Dots& dots,
                            const Contact& contact,
                            double time_s = not_a_number<double>()) {
    const auto from = as_view(dots);
    const auto touch = as_view(contact);
    if (from.rows() != rows() || from.cols() != cols() || !same_size(from, touch)) {
      return {};
    }
    if (time_s < latest_s_ - hold_s) {
      forget();
      latest_s_ = contact_s_ = never;
    }
    latest_s_ = (std::max)(latest_s_, time_s);  // latest_s_ if the time is NaN
    ++count_;
    frame_.read(from);
    if (!(options_.noise > 0)) {
      measured_noise_.add(frame_.found);
    }
    read_contact(touch);
    result_.back_ratio = result_.back_sd = not_a_number<S>();
    result_.far_apart = false;
    result_.status = touching_ > 0 ? with_contact(time_s) : without_contact(time_s);
    count_states();
    const S sd = sqrt_of(square(result_.least_sd()) + doubt_sq_);
    if (result_.updated()) {
      result_.ratio_sd = sd;
    } else if (result_.ratio_sd < S(0.5)) {
      result_.ratio_sd = (std::min)(result_.ratio_sd + S(0.05), S(0.5));
    }
    result_.back_sd = is_finite(result_.back_ratio) ? sd : not_a_number<S>();
    const bool slips = 10 * result_.slip > result_.stick + result_.slip;
    if (result_.updated() && slips && !has_outline_ && !options_.covers_pattern) {
      result_.status = StickStatus::no_outline;
      result_.stick_ratio = result_.ratio_sd = not_a_number<S>();
    }
    StickResult<S> result = result_;
    if (result.status == StickStatus::no_contact) {
      result.stick_ratio = result.ratio_sd = not_a_number<S>();
    }
    return result;
  }

  /// State of each dot in the last frame.
  StridedView<const DotState> states() const { return inside(states_); }
  /// Slip along x and y of each dot since the reference of the last answer, averaged over
  /// neighbours; NaN if unknown.
  StridedView<const Point2<S>> slips() const { return inside(slips_); }
  /// Standard deviation of a dot along x and along y, as given or as measured; 0: not yet known.
  double noise() const { return options_.noise > 0 ? options_.noise : measured_noise_.sd(); }

 private:
  static constexpr double never = -std::numeric_limits<double>::infinity();
  static constexpr double hold_s = 0.2;
  static constexpr Index capacity = 64, min_dots = 6, min_followers = 4;
  static constexpr double gain = 0.41573970964154905;  // sqrt(6^2 + 4 2^2 + 4 1^2) / 18
  static constexpr double ln_100 = 4.605170185988092;  // of 1 / 0.01

  /// A dot that was found in both frames.
  struct Pair {
    Index k;
    P then, now;
    S weight;              // in the fit of the motion
    Point2<S> slip, mean;  // of itself, and averaged over neighbours
  };
  bool sticks(const Pair& p) const { return value(squared_norm(p.mean)) < value(limit_sq_); }
  template <class T>
  using Grid = detail::Bordered<T>;
  template <class T>
  StridedView<const T> inside(const Grid<T>& grid) const {
    return {&grid[frame_.cell(0, 0)], rows(), cols(), frame_.width};
  }

  /// Drops the contact: its frames cannot be compared with those of the next one.
  void forget() {
    stored_count_ = 0;
    center_ = detail::missing_point<S>();
    result_ = {};
    std::fill(in_order_.begin(), in_order_.end(), detail::missing_point<S>());
    std::fill(states_.begin(), states_.end(), DotState::none);
    std::fill(slips_.begin(), slips_.end(), no_slip());
  }

  /// Reads which dots touch, and keeps in `now` those of them that lie between their neighbours.
  template <class View>
  void read_contact(const View& contact) {
    touching_ = crossed_ = result_.out_of_place = 0;
    placed_.clear();
    std::fill(now_.begin(), now_.end(), detail::missing_point<S>());
    int sides = 0;  // that the dots found reach
    bool all_touch = true;
    for (Index i = 0; i < rows(); ++i) {
      for (Index j = 0, k = frame_.cell(i, 0); j < cols(); ++j, ++k) {
        const bool touches = is_contact(cell_t<View>(contact(i, j)));
        states_[k] = touches ? (std::max)(states_[k], DotState::unknown) : DotState::none;
        touching_ += touches ? 1 : 0;
        if (is_finite(frame_.found[k])) {
          all_touch = all_touch && touches;
          sides |= (i == 0 ? 1 : 0) | (i == rows() - 1 ? 2 : 0);
          sides |= (j == 0 ? 4 : 0) | (j == cols() - 1 ? 8 : 0);
          if (touches) {
            place(k, frame_.is_out_of_line(k, j, cols(), 1),
                  frame_.is_out_of_line(k, i, rows(), frame_.width));
          }
        }
      }
    }
    has_outline_ = !all_touch || sides != 15;
  }
  /// A single wrong neighbour does not put a dot out of line in its row and in its column.
  void place(Index k, bool out_of_row, bool out_of_col) {
    crossed_ += out_of_row && out_of_col ? 1 : 0;
    if (out_of_row || out_of_col) {
      ++result_.out_of_place;
    } else {
      placed_.push_back(k);
      now_[k] = frame_.found[k];
    }
  }

  StickStatus without_contact(double time_s) {
    if (frame_.count == 0) {
      return StickStatus::too_few_dots;
    }
    if (!(time_s - contact_s_ <= hold_s)) {
      forget();
      std::copy(frame_.found.begin(), frame_.found.end(), free_.begin());
    }
    return StickStatus::no_contact;
  }

  /// Status of this frame. Fills all of the result but the counts.
  StickStatus with_contact(double time_s) {
    contact_s_ = is_finite(time_s) ? time_s : contact_s_;
    if (5 * crossed_ > detail::size_of(placed_) + result_.out_of_place) {
      return StickStatus::not_in_order;
    }
    if (detail::size_of(placed_) < min_dots) {
      return StickStatus::too_few_dots;
    }
    if (!frame_.in_image) {
      smooth_depths();
    }
    pitch_sq_ = detail::mean_pitch_sq(placed_, now_.data(), frame_.width);
    const S pitch = sqrt_of(pitch_sq_), known = S(noise());
    // no camera finds dots better than a 2000th of a pitch
    sd_ = value(known) > 0 ? (std::max)(known, pitch / S(2000)) : pitch / S(150);
    const S reference = sd_ * S(2 * gain * std::sqrt(ln_100) / options_.slip_share);
    return 2 * value(reference) > value(pitch) && value(pitch) > 0 ? StickStatus::not_in_order
                                                                   : compare(reference * reference);
  }

  /// Depth is several times as noisy as x and y: it is taken from the quadric through all dots.
  void smooth_depths() {
    const auto surface = detail::stick::quadric_through<S>([&](const auto& visit) {
      for (const Index k : placed_) {
        visit(now_[k]);
      }
    });
    for (const Index k : placed_) {
      now_[k].z = surface.height(now_[k]);
    }
  }

  /// Searches the reference, answers by it, and stores the frame unless the dots rest.
  StickStatus compare(const S& reference_sq) {
    const S moved_sq = stored_count_ > 0 ? furthest_sq_from(stored(0)) : S(-1);
    for (Index k = 0; k < detail::size_of(now_); ++k) {  // of those in contact, the ones in place
      frame_.found[k] = states_[k] == DotState::none ? frame_.found[k] : now_[k];
    }
    result_.far_apart =
        value(pitch_sq_) > 0 && 4 * value(furthest_sq_from(in_order_.data())) > value(pitch_sq_);
    if (result_.far_apart && detail::is_renumbered(frame_, in_order_, pitch_sq_)) {
      return StickStatus::not_in_order;
    }
    std::copy(frame_.found.begin(), frame_.found.end(), in_order_.begin());
    const bool rests = value(moved_sq) >= 0 && 16 * value(moved_sq) <= value(reference_sq);
    // At rest the image is not compared again: a membrane that creeps under a sliding object would
    // seem to stick more and more. In space, forces tell of the slide.
    const Index age = rests && frame_.in_image ? -1 : age_of_reference(reference_sq);
    StickStatus status = StickStatus::unmoved;
    if (age >= 0) {
      furthest_sq_ = furthest_sq_from(stored(age));
      limit_sq_ = S(square(options_.slip_share)) * (std::max)(furthest_sq_, reference_sq);
      status = answer(stored(age), static_cast<Index>(count_ - stored_at_[slot(age)]));
    }
    if (!rests) {
      newest_ = (newest_ + 1) % capacity;
      stored_count_ = (std::min)(stored_count_ + 1, capacity);
      stored_at_[newest_] = count_;
      std::copy(now_.begin(), now_.end(), stored_.begin() + newest_ * detail::size_of(now_));
    }
    return status;
  }
  /// The newest stored frame further than U, else in space the newest one further than U / 2, which
  /// will do with the limit of U; -1: none. The search goes back as long as the distance grows.
  /// Where it begins to shrink, the object has reversed, and older frames are not examined. Of a
  /// rolling object, which no motion in the image describes, U / 2 would make dots slip.
  Index age_of_reference(const S& reference_sq) const {
    Index near = -1;
    S before = S(-1);
    for (Index age = 0; age < stored_count_; ++age) {
      const S sq = furthest_sq_from(stored(age));
      if (value(sq) < value(before)) {
        break;
      }
      if (value(sq) > value(reference_sq)) {
        return age;
      }
      near = near < 0 && !frame_.in_image && 4 * value(sq) > value(reference_sq) ? age : near;
      before = sq;
    }
    return near;
  }
  Index slot(Index age) const { return (newest_ + capacity - age) % capacity; }
  const P* stored(Index age) const { return stored_.data() + slot(age) * detail::size_of(now_); }
  /// d_max^2; -1 if no dot was found then as well.
  S furthest_sq_from(const P* then) const {
    S furthest_sq = S(-1);
    for (const Index k : placed_) {
      const S sq = squared_norm(now_[k] - then[k]);
      furthest_sq = value(sq) > value(furthest_sq) ? sq : furthest_sq;
    }
    return furthest_sq;
  }

  /// Compares the frame with its reference.
  StickStatus answer(const P* then, Index age) {
    collect(then);
    if (detail::size_of(pairs_) < min_dots || !find_object()) {
      return StickStatus::too_few_dots;
    }
    const Index stick =
        std::count_if(pairs_.begin(), pairs_.end(), [&](const Pair& p) { return sticks(p); });
    const Index near = std::count_if(pairs_.begin(), pairs_.end(), [&](const Pair& p) {
      return value(squared_norm(p.mean)) < 4 * value(limit_sq_);
    });
    const S known = detail::number<S>(detail::size_of(pairs_));
    const S ratio = detail::number<S>(stick) / known;
    const S change = ratio - (is_finite(result_.stick_ratio) ? result_.stick_ratio : S(1));
    doubt_sq_ = square(detail::number<S>(near - stick) / known) + change * change / S(3);
    if (falls_back()) {
      result_.back_ratio = ratio;
      result_.back_age = age;
      return StickStatus::falls_back;
    }
    for (DotState& state : states_) {
      state = (std::min)(state, DotState::unknown);
    }
    std::fill(slips_.begin(), slips_.end(), no_slip());
    for (Pair& p : pairs_) {
      states_[p.k] = sticks(p) ? DotState::stick : DotState::slip;
      slips_[p.k] = p.mean;
      p.weight = S(sticks(p) ? 1 : 0);
    }
    center_ = stick > 0 ? mean_of([](const Pair& p) { return p.now; }) : center_;
    result_.stick_ratio = ratio;
    result_.furthest = sqrt_of(furthest_sq_);
    result_.reference_age = age;
    result_.motion = motion_;
    result_.scale = scale_;
    return StickStatus::updated;
  }

  void collect(const P* then) {
    pairs_.clear();
    for (const Index k : placed_) {
      if (is_finite(then[k])) {
        pairs_.push_back({k, then[k], now_[k], S(1), {}, {}});
      }
    }
  }

  /// Finds the motion of the object from the dots around the last ones that stuck. No dot that the
  /// object drags can outrun it: if one has, the dots found so far only stand still together, and
  /// the search starts again there. If these stand still too and most dots slipped in the last
  /// answer, the object has moved on with the furthest dot. Weights by the averaged slip then
  /// reduce the influence of dots that slip a little. False if the dots do not determine a motion.
  bool find_object() {
    const auto now = [](const Pair& p) { return p.now; };
    const P from = is_finite(center_) ? center_ : mean_of(now);
    bool found = follow(from);
    const Pair* const ahead = found ? outrunner() : nullptr;
    if (ahead != nullptr) {
      move_with(*ahead);
      found = gather();
      if (has_hardly_moved() && result_.stick < result_.slip) {
        move_with(*ahead);
        average();
        return true;
      }
      found = has_hardly_moved() ? follow(from) : found;
    }
    // noise gives averaged slips a mean square of 4 gain^2; at twice that the weight is 1/4
    const S quarter_sq = S(8 * gain * gain) * sd_ * sd_;
    for (int pass = 0; pass < 3; ++pass) {
      average();
      for (Pair& p : pairs_) {
        p.weight = square(quarter_sq / (quarter_sq + squared_norm(p.mean)));
      }
      found = found && fit();
    }
    average();
    return found;
  }
  /// Fits the motion to the dots around a place, then to those that follow it.
  bool follow(const P& from) {
    using std::exp;
    const S wide_sq = value(pitch_sq_) > 0 ? S(1.4) * pitch_sq_ : S(1e12);
    for (Pair& p : pairs_) {
      p.weight = exp(-squared_norm(p.now - from) / wide_sq);
    }
    return fit() && gather();
  }
  void move_with(const Pair& p) {
    motion_ = {.translation_mm = p.now - p.then};
    scale_ = S(1);
    set_slips();
  }
  /// Extends the fit to the dots that follow within the limit, until their number no longer
  /// changes, but only three times: then it walks into dots that slip. A slip has more noise than
  /// its mean over neighbours.
  bool gather() {
    bool found = true;
    for (Index pass = 0, before = -1; pass < 3; ++pass) {
      const auto follows = [&](const Pair& p) {
        return value(squared_norm(p.slip)) < 2 * value(limit_sq_);
      };
      const Index followers = std::count_if(pairs_.begin(), pairs_.end(), follows);
      if (followers < min_followers || followers == before) {
        break;
      }
      for (Pair& p : pairs_) {
        p.weight = S(follows(p) ? 1 : 0);
      }
      found = found && fit();
      before = followers;
    }
    return found;
  }
  /// The mean of a place of the dots over the weights of the fit.
  template <class Place>
  P mean_of(const Place& place) const {
    P sum = {S(0), S(0), S(0)};
    S weight = S(0);
    for (const Pair& p : pairs_) {
      sum += p.weight * place(p);
      weight = weight + p.weight;
    }
    return sum / weight;
  }
  /// Whether the dots of the fit have moved by less than half of d_max.
  bool has_hardly_moved() const {
    const P moved = mean_of([](const Pair& p) { return p.now - p.then; });
    return 4 * value(squared_norm(moved)) < value(furthest_sq_);
  }
  /// If the dots of the fit have hardly moved, the dot that is ahead of them by more than half of
  /// its displacement and has moved furthest, more than half of d_max; nullptr: there is none. The
  /// scale must not explain more than a quarter of the displacement; that of a few dots, which may
  /// be standing and moving ones by chance, explains nothing.
  const Pair* outrunner() const {
    const Pair* ahead = nullptr;
    S ahead_sq = furthest_sq_ / S(4);
    const P center = mean_of([](const Pair& p) { return p.now; });
    const Index fitted = std::count_if(pairs_.begin(), pairs_.end(),
                                       [](const Pair& p) { return value(p.weight) > 0; });
    const S growth = 8 * fitted < detail::size_of(pairs_) ? S(0) : (scale_ - S(1)) / scale_;
    for (const Pair& p : pairs_) {
      const Point2<S> moved = {p.now.x - p.then.x, p.now.y - p.then.y};
      const Point2<S> arm = {p.now.x - center.x, p.now.y - center.y};
      const S sq = squared_norm(moved), grown = growth * dot(arm, moved);
      if (value(sq) > value(ahead_sq) && 2 * value(dot(p.slip, moved)) > value(sq) &&
          4 * value(grown) <= value(sq)) {
        ahead = &p;
        ahead_sq = sq;
      }
    }
    return has_hardly_moved() ? ahead : nullptr;
  }

  /// Fits the motion to the weighted pairs and sets their slips. False: not determined.
  bool fit() {
    const auto at = [&](Index k) -> const Pair& { return pairs_.data()[k]; };
    bool determined = true;
    if (frame_.in_image) {
      determined = fit_similar();
    } else {
      const auto rigid = fit_rigid<S>(
          detail::size_of(pairs_), [&](Index k) { return at(k).then; },
          [&](Index k) { return at(k).now; }, [&](Index k) { return at(k).weight; });
      determined = rigid.has_value();
      motion_ = rigid.value_or(motion_);
      scale_ = S(1);
    }
    set_slips();
    return determined;
  }
  /// Rotation about z, scale and shift of least squares.
  bool fit_similar() {
    const P then = mean_of([](const Pair& p) { return p.then; });
    const P now = mean_of([](const Pair& p) { return p.now; });
    S along = S(0), across = S(0), spread = S(0);
    for (const Pair& p : pairs_) {
      const P t = p.then - then, n = p.now - now;
      along = along + p.weight * dot(t, n);
      across = across + p.weight * cross(t, n).z;
      spread = spread + p.weight * dot(t, t);
    }
    const S size = sqrt_of(along * along + across * across);
    const bool determined = value(size) > 0 && value(spread) > 0;
    scale_ = determined ? size / spread : S(1);
    const S c = determined ? along / size : S(1), s = determined ? across / size : S(0);
    motion_.rotation = {{{c, -s, S(0)}, {s, c, S(0)}, {S(0), S(0), S(1)}}};
    motion_.translation_mm = now - scale_ * motion_.rotation(then);
    return determined;
  }
  void set_slips() {
    for (Pair& p : pairs_) {
      const P slip = p.now - scale_ * motion_.rotation(p.then) - motion_.translation_mm;
      p.slip = {slip.x, slip.y};
    }
  }

  /// Averages slips over 3 x 3 neighbours with the weights 6, 2, 1. Slips beyond the gate do not
  /// count, so that they do not affect the sticking dots beside them, and stay as they are.
  void average() {
    const S gate_sq = S(36) * limit_sq_;
    std::fill(small_.begin(), small_.end(), P{S(0), S(0), S(0)});
    for (const Pair& p : pairs_) {
      if (value(squared_norm(p.slip)) < value(gate_sq)) {
        small_[p.k] = {p.slip.x, p.slip.y, S(1)};  // z counts
      }
    }
    const Index w = frame_.width;
    for (Pair& p : pairs_) {
      P sum = S(6) * small_[p.k];
      for (const Index beside : {Index(-1), Index(1), -w, w}) {
        sum += S(2) * small_[p.k + beside];
      }
      for (const Index across : {-w - 1, 1 - w, w - 1, w + 1}) {
        sum += small_[p.k + across];
      }
      p.mean = value(small_[p.k].z) > 0 ? Point2<S>{sum.x / sum.z, sum.y / sum.z} : p.slip;
    }
  }

  /// Whether the dots have moved back toward their free positions, to within 45 degrees; false if
  /// these are not known. Only x and y count, because the depth of a contact depends on its load.
  bool falls_back() const {
    S then = S(0), now = S(0), moved = S(0);
    const auto apart_sq = [](const P& a, const P& b) {
      return square(a.x - b.x) + square(a.y - b.y);
    };
    for (const Pair& p : pairs_) {
      if (is_finite(free_[p.k])) {
        then = then + apart_sq(p.then, free_[p.k]);
        now = now + apart_sq(p.now, free_[p.k]);
        moved = moved + apart_sq(p.now, p.then);
      }
    }
    const S nearer = sqrt_of(then) - sqrt_of(now);
    return value(nearer) > 0 && value(moved) < value(S(2) * nearer * nearer);
  }

  void count_states() {
    const auto count = [&](DotState state) {
      return static_cast<Index>(std::count(states_.begin(), states_.end(), state));
    };
    result_.unknown = count(DotState::unknown);
    result_.slip = count(DotState::slip);
    result_.stick = count(DotState::stick);
  }

  static Point2<S> no_slip() { return {not_a_number<S>(), not_a_number<S>()}; }
  static S sqrt_of(const S& sq) {
    using std::sqrt;
    return value(sq) > 0 ? sqrt(sq) : S(0);
  }

  StickOptions options_;
  detail::FrameOfDots<S> frame_;
  Grid<P> now_;       // of it, the dots in contact and in place
  Grid<P> free_;      // their positions without contact
  Grid<P> in_order_;  // all dots of the last frame that was compared
  detail::FrameNoise<S> measured_noise_;
  Grid<DotState> states_;
  Grid<Point2<S>> slips_;
  Grid<P> small_;          // slips that count in the mean of their neighbours
  std::vector<P> stored_;  // a ring of frames
  Grid<std::int64_t> stored_at_;
  detail::ReservedVector<Index> placed_;
  detail::ReservedVector<Pair> pairs_;
  Index touching_ = 0, crossed_ = 0, newest_ = 0, stored_count_ = 0;
  bool has_outline_ = false;
  std::int64_t count_ = 0;                 // of frames
  P center_ = detail::missing_point<S>();  // of the dots that stuck in the last answer
  S pitch_sq_ = S(0), sd_ = S(0);
  S furthest_sq_ = S(0), limit_sq_ = S(0);  // d_max and the limit of this frame
  S doubt_sq_ = S(0);                       // variance of the last ratio beyond that of its dots
  Pose<S> motion_ = {};                     // of the object since the reference
  S scale_ = S(1);
  double latest_s_ = never, contact_s_ = never;
  StickResult<S> result_;
};

}  // namespace v1
}  // namespace fingerpad
