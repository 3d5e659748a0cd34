// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The stick ratio, word for word as in the slides: Ito, Kim, Obinata, "Robust slippage degree
// estimation based on reference update of vision-based tactile sensor", the talk and its backup
// slides; plain loops over all stored frames. published/stick_ratio.hpp repairs the cases without
// an answer (docs/errata.md, E032-E036). This file keeps the mean of four angles, which wraps, and
// the stages of the talk: a fixed delta, no scale or the plain scale, and the two conditions for an
// answer. Every dot must be found.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/published/stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// "Calculation of scale parameter alpha".
enum class SlidesScale : std::uint8_t {
  none,    ///< before Case 3
  plain,   ///< sums of all distances between neighbours
  across,  ///< "elimination of parallel component": only the part perpendicular to the motion
};

/// "Detail of delta".
enum class SlidesDelta : std::uint8_t {
  fixed,         ///< the conventional method
  proportional,  ///< delta_0 d_max / U
};

/// "phi estimation timing": phi is estimated only if d_max > U, where d_max is the largest
/// displacement ...
enum class AnswerWhen : std::uint8_t {
  contact_moved,       ///< ... of a dot in contact
  stick_region_moved,  ///< ... of a dot "in stick region" of the last answer
};

/// "Reference dot": d_0 is the displacement of ...
enum class SlidesReference : std::uint8_t {
  central,          ///< ... the dot in the middle of the grid, the conventional method
  of_stick_region,  ///< ... the dot nearest to the center of the stick region of the last answer;
                    ///< before the first answer, to the center of the contact
};

struct SlidesOptions {
  StickTest test = stick_test_px;  ///< U, U_min and delta_0, in px; the rest is not used
  DotWeights weights = {};         ///< S1, S2, S3
  bool cancels_rotation = true;
  SlidesReference reference = SlidesReference::of_stick_region;
  SlidesScale scale = SlidesScale::across;
  SlidesDelta delta = SlidesDelta::proportional;
  AnswerWhen answers = AnswerWhen::contact_moved;
  Index capacity = 64;  ///< stored frames, in [1, 1e6]; the slides keep all
};

/// theta_0 = (theta_1 + theta_2 + theta_3 + theta_4) / 4, the mean angle by which four neighbours
/// have rotated about the reference dot. Each angle is a difference of two directions, not wrapped.
/// The mean is wrong by pi/2 or pi if a neighbour's direction passes that of -x: E034.
template <scalar S>
S mean_of_four_angles(const std::array<Point2<S>, 4>& then, const std::array<Point2<S>, 4>& now) {
  using std::atan2;
  S sum = S(0);
  for (std::size_t k = 0; k < 4; ++k) {
    sum += S(atan2(now[k].y, now[k].x)) - S(atan2(then[k].y, then[k].x));
  }
  return S(sum / S(4));
}

struct [[nodiscard]] SlidesResult {
  bool accepted = false;        ///< false: a grid of another size, or a dot missing or implausible
  bool updated = false;         ///< this frame has an answer
  double stick_ratio = 1;       ///< N_s / N_c; without a new answer, the last one
  Index reference_age = 0;      ///< frames from the reference to this one; 0: none
  double furthest_px = 0;       ///< d_max from the reference
  DotIndex reference_dot = {};  ///< whose displacement is d_0
  double angle_rad = 0;         ///< theta_0
  double scale = 1;             ///< alpha

  bool ok() const { return accepted && updated; }
};

/// The stick ratio of a grid of dots, as in the talk. Const; each recording has its own state. A
/// frame takes O(capacity dots) and allocates nothing.
class SlidesStickRatio {
  using Point = Point2<double>;
  using Points = std::vector<Point>;

 public:
  class State {
   private:
    friend class SlidesStickRatio;
    State(std::size_t dots, std::size_t capacity)
        : stored(capacity, Points(dots)),
          frames(capacity),
          furthest(capacity),
          given(dots),
          now(dots),
          moved(dots),
          touches(dots),
          sticks(dots) {}
    std::vector<Points> stored;  // oldest first, `size` of them
    std::vector<std::int64_t> frames;
    std::vector<double> furthest;
    std::size_t size = 0;
    std::int64_t frame = 0;
    Points given, now, moved;
    std::vector<char> touches, sticks;
    bool has_sticks = false;
    Point stick_center = {0, 0};
    SlidesResult result;
  };

  /// For a grid of rows x cols dots, both >= 3. Refuses bad parameters (parameter_error).
  SlidesStickRatio(Index rows, Index cols, const SlidesOptions& options = {})
      : rows_(rows), cols_(cols), options_(options) {
    const char* const owner = "SlidesStickRatio";
    expects(options.capacity >= 1 && options.capacity <= 1000000, owner, "capacity",
            static_cast<long long>(options.capacity), "in [1, 1000000]");
    expects_grid_size(owner, rows, cols, 3, options.capacity);
    expects_valid(options.test);
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  State start() const { return State(cells(), static_cast<std::size_t>(options_.capacity)); }

  template <dot_grid Dots, contact_mask Contact>
  SlidesResult operator()(const Dots& dots_px, const Contact& contact, State& state) const {
    state.result.accepted = state.result.updated = false;
    if (!read(dots_px, contact, state)) {
      return state.result;
    }
    state.result.accepted = true;
    ++state.frame;
    denoise(state);
    const std::size_t none = state.size;
    const std::size_t reference = reference_of(state);
    state.result.reference_age = 0;
    if (reference != none) {
      state.result.furthest_px = state.furthest[reference];
      state.result.reference_age = static_cast<Index>(state.frame - state.frames[reference]);
      answer(state.stored[reference], state);
    }
    if (none == 0 || state.furthest[none - 1] > options_.test.store) {
      store(state);
    }
    return state.result;
  }

 private:
  std::size_t cells() const { return static_cast<std::size_t>(rows_ * cols_); }
  std::size_t at(Index row, Index col) const { return static_cast<std::size_t>(row * cols_ + col); }

  template <class Dots, class Contact>
  bool read(const Dots& dots_px, const Contact& contact, State& state) const {
    const auto from = as_view(dots_px);
    const auto flags = as_view(contact);
    if (from.rows() != rows_ || from.cols() != cols_ || !same_size(from, flags) ||
        state.now.size() != cells()) {
      return false;
    }
    bool found = true;
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        const cell_t<Dots> p = from(i, j);
        using Traits = point_traits<cell_t<Dots>>;
        const Point q{static_cast<double>(value(Traits::x(p))),
                      static_cast<double>(value(Traits::y(p)))};
        found = found && is_plausible(q);
        state.given[at(i, j)] = q;
        state.touches[at(i, j)] = is_contact(cell_t<Contact>(flags(i, j))) ? 1 : 0;
      }
    }
    return found;
  }

  /// "Weighted average of target dot and the adjacent 8 dots"; border dots stay as they are.
  void denoise(State& state) const {
    state.now = state.given;
    const DotWeights& w = options_.weights;
    for (Index i = 1; i + 1 < rows_; ++i) {
      for (Index j = 1; j + 1 < cols_; ++j) {
        Point sum{0, 0};
        double weights = 0;
        for (Index m = -1; m <= 1; ++m) {
          for (Index n = -1; n <= 1; ++n) {
            const double weight = m == 0 && n == 0   ? w.self
                                  : m == 0 || n == 0 ? w.side
                                                     : w.diagonal;
            sum = sum + weight * state.given[at(i + m, j + n)];
            weights += weight;
          }
        }
        state.now[at(i, j)] = (1 / weights) * sum;
      }
    }
  }

  static double distance(const Point& a, const Point& b) {
    return std::hypot(a.x - b.x, a.y - b.y);
  }

  /// i_ref = sup{i: d_max(i) > U, i_C <= i <= N}; state.size if there is none.
  std::size_t reference_of(State& state) const {
    const bool in_sticks = options_.answers == AnswerWhen::stick_region_moved && state.has_sticks;
    const std::vector<char>& followed = in_sticks ? state.sticks : state.touches;
    for (std::size_t i = 0; i < state.size; ++i) {
      state.furthest[i] = 0;
      for (std::size_t k = 0; k < cells(); ++k) {
        if (followed[k] != 0) {
          state.furthest[i] =
              (std::max)(state.furthest[i], distance(state.now[k], state.stored[i][k]));
        }
      }
    }
    std::size_t changed = state.size > 0 ? state.size - 1 : 0;  // i_C
    while (changed > 0 && state.furthest[changed - 1] > state.furthest[changed]) {
      --changed;
    }
    for (std::size_t i = state.size; i-- > changed;) {
      if (state.furthest[i] > options_.test.reference) {
        return i;
      }
    }
    return state.size;
  }

  /// The reference dot among the dots with four neighbours; the central dot if none is in contact.
  DotIndex reference_dot(const State& state) const {
    DotIndex best{rows_ / 2, cols_ / 2};
    if (options_.reference == SlidesReference::central) {
      return best;
    }
    const std::vector<char>& among = state.has_sticks ? state.sticks : state.touches;
    Point center = state.stick_center;
    if (!state.has_sticks) {
      center = centroid(state.now, state.touches);
    }
    double nearest = -1;
    for (Index i = 1; i + 1 < rows_; ++i) {
      for (Index j = 1; j + 1 < cols_; ++j) {
        const double away = distance(state.now[at(i, j)], center);
        const bool counts = among[at(i, j)] != 0 && state.touches[at(i, j)] != 0;
        if (counts && (nearest < 0 || away < nearest)) {
          nearest = away;
          best = {i, j};
        }
      }
    }
    return best;
  }

  static Point centroid(const Points& dots, const std::vector<char>& of) {
    Point sum{0, 0};
    double count = 0;
    for (std::size_t k = 0; k < dots.size(); ++k) {
      if (of[k] != 0) {
        sum = sum + dots[k];
        count += 1;
      }
    }
    return (1 / count) * sum;
  }

  void answer(const Points& then, State& state) const {
    SlidesResult& result = state.result;
    result.reference_dot = reference_dot(state);
    const std::size_t center = at(result.reference_dot.row, result.reference_dot.col);
    state.moved = state.now;
    result.angle_rad = 0;
    if (options_.cancels_rotation) {
      rotate_back(then, result.reference_dot, state);
    }
    result.scale = scale_of(then, state);
    // the center of scaling cancels in differences: use the position of the reference dot
    const Point middle = state.moved[center];
    for (std::size_t k = 0; k < cells(); ++k) {
      state.moved[k] = result.scale * (state.moved[k] - middle) + middle - then[k];
    }
    count(center, state);
  }

  void rotate_back(const Points& then, const DotIndex& reference, State& state) const {
    const std::size_t center = at(reference.row, reference.col);
    std::array<Point, 4> before, after;
    constexpr std::array<std::pair<int, int>, 4> steps = {{{0, -1}, {0, 1}, {-1, 0}, {1, 0}}};
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t beside =
          at(reference.row + steps[k].first, reference.col + steps[k].second);
      before[k] = then[beside] - then[center];
      after[k] = state.now[beside] - state.now[center];
    }
    const double angle = state.result.angle_rad = mean_of_four_angles(before, after);
    const double c = std::cos(angle), s = std::sin(angle);
    const Point about = state.now[center];
    for (Point& p : state.moved) {
      const Point e = p - about;
      p = Point{c * e.x + s * e.y, -s * e.x + c * e.y} + about;
    }
  }

  /// |d_0 - d_k| < delta over all dots in contact, the reference dot included.
  void count(std::size_t center, State& state) const {
    SlidesResult& result = state.result;
    const bool grows = options_.delta == SlidesDelta::proportional;
    const double delta =
        options_.test.slip * (grows ? result.furthest_px / options_.test.reference : 1.0);
    double sticking = 0, touching = 0;
    for (std::size_t k = 0; k < cells(); ++k) {
      const bool touches = state.touches[k] != 0;
      const bool sticks = touches && distance(state.moved[k], state.moved[center]) < delta;
      state.sticks[k] = sticks ? 1 : 0;
      sticking += sticks ? 1 : 0;
      touching += touches ? 1 : 0;
    }
    result.updated = touching > 0;
    state.has_sticks = sticking > 0;
    if (state.has_sticks) {
      state.stick_center = centroid(state.now, state.sticks);
    }
    result.stick_ratio = result.updated ? sticking / touching : result.stick_ratio;
  }

  /// alpha over pairs of neighbours in contact at (x, y) = (-1, 1), (0, 1), (1, 1), (1, 0); 1 if
  /// there is no such pair.
  double scale_of(const Points& then, const State& state) const {
    if (options_.scale == SlidesScale::none) {
      return 1;
    }
    double sum_then = 0, sum_now = 0;
    constexpr std::array<std::pair<int, int>, 4> steps = {{{1, -1}, {1, 0}, {1, 1}, {0, 1}}};
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        for (const auto& [down, right] : steps) {
          const bool inside = i + down < rows_ && j + right >= 0 && j + right < cols_;
          if (!inside || state.touches[at(i, j)] == 0 ||
              state.touches[at(i + down, j + right)] == 0) {
            continue;
          }
          const std::size_t a = at(i, j), b = at(i + down, j + right);
          add_pair(then[a] - then[b], state.moved[a] - state.moved[b],
                   (state.moved[a] - then[a]) + (state.moved[b] - then[b]), sum_then, sum_now);
        }
      }
    }
    return sum_now > 0 ? sum_then / sum_now : 1;
  }

  void add_pair(const Point& then,
                const Point& now,
                const Point& motion,
                double& sum_then,
                double& sum_now) const {
    if (options_.scale == SlidesScale::plain) {
      sum_then += std::hypot(then.x, then.y);
      sum_now += std::hypot(now.x, now.y);
      return;
    }
    const double size = std::hypot(motion.x, motion.y);
    if (size > 1e-9) {  // q does not exist where nothing moves: E036
      sum_then += std::abs(then.x * motion.y - then.y * motion.x) / size;
      sum_now += std::abs(now.x * motion.y - now.y * motion.x) / size;
    }
  }

  static void store(State& state) {
    if (state.size == state.stored.size()) {
      std::rotate(state.stored.begin(), state.stored.begin() + 1, state.stored.end());
      std::rotate(state.frames.begin(), state.frames.begin() + 1, state.frames.end());
      --state.size;
    }
    std::copy(state.now.begin(), state.now.end(), state.stored[state.size].begin());
    state.frames[state.size] = state.frame;
    ++state.size;
  }

  Index rows_, cols_;
  SlidesOptions options_;
};

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
