// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The stick ratio as printed, in plain loops over all stored frames. Source: Ito, Kim, Obinata,
// "Robust slippage degree estimation based on reference update of vision-based tactile sensor", the
// talk and its backup slides; "Acquisition of contact force and slippage using a vision-based
// tactile sensor with a fluid-type touchpad", eqs. 6-8, is the conventional method. A dot that
// was not found counts nowhere. docs/errata.md, E032-E038.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"

namespace fingerpad {
inline namespace v1 {
namespace published {

/// "Calculation of scale parameter alpha".
enum class StickScale : std::uint8_t {
  none,    ///< before Case 3
  plain,   ///< sums of all distances between neighbours
  across,  ///< "elimination of parallel component": only the part perpendicular to the motion
};

/// The printed values and steps, for dots in px; each step can be left out.
struct StickRatioOptions {
  double U = 2;                   ///< >= 0
  double U_min = 0.5;             ///< >= 0, not printed
  double delta_0 = 0.24;          ///< > 0
  double S1 = 6, S2 = 2, S3 = 1;  ///< weights of a dot, of its 4 and its 4 diagonal neighbours, not
                                  ///< printed, S1 > 0; without denoising S2 = S3 = 0
  bool updates = true;            ///< false: the reference is the first frame with contact
  bool cancels_rotation = true;
  bool wraps = false;  ///< whether theta_1 to theta_4 are differences of two directions (E034), or
                       ///< the angles between them; the slides do not say
  StickScale scale = StickScale::across;
  bool delta_grows = true;        ///< delta = delta_0 d_max / U; false: delta = delta_0
  bool follows_stick = true;      ///< the reference dot is that nearest to the center of the stick
                                  ///< region; false: the central dot
  bool moves_with_stick = false;  ///< d_max is that of a dot "in stick region" of the last answer,
                                  ///< as on one slide; false: of a dot in contact
  Index capacity = 64;            ///< stored frames, in [1, 1e6]; the slides keep all
};

/// The conventional method: the displacement from the first frame against that of the central dot.
inline constexpr StickRatioOptions conventional_stick_ratio = {.U = 0,
                                                               .S2 = 0,
                                                               .S3 = 0,
                                                               .updates = false,
                                                               .cancels_rotation = false,
                                                               .scale = StickScale::none,
                                                               .delta_grows = false,
                                                               .follows_stick = false};

/// The first parameter without meaning, or "".
inline std::string check(const StickRatioOptions& o) {
  return fingerpad::check("published::StickRatio",
                          {{"U", o.U, o.delta_grows ? positive : not_negative},
                           {"U_min", o.U_min, not_negative},
                           {"delta_0", o.delta_0, positive},
                           {"S1", o.S1, positive},
                           {"S2", o.S2, not_negative},
                           {"S3", o.S3, not_negative},
                           {"capacity", o.capacity, within(1, 1e6)}});
}

template <scalar S = double>
struct [[nodiscard]] StickRatioResult {
  bool accepted = false;        ///< false: a grid of another size
  bool updated = false;         ///< this frame has an answer
  S stick_ratio = S(1);         ///< phi; without a new answer, the last one
  Index reference_age = 0;      ///< frames from the reference to this one; 0: none
  S furthest_px = S(0);         ///< d_max
  DotIndex reference_dot = {};  ///< whose displacement is d_0
  S angle_rad = S(0);           ///< theta_0
  S scale = S(1);               ///< alpha

  bool ok() const { return updated; }
};

/// The stick ratio of a grid of rows x cols dots, both >= 3. The object is the state: copy it to
/// return to a frame. A frame takes O(capacity dots) and allocates nothing.
template <scalar S = double>
class StickRatio {
  using Points = std::vector<Point2<S>>;
  using Flags = std::vector<char>;
  struct Image {
    Points dots;
    std::int64_t frame = 0;
    S d_max = S(0);  ///< from it to the current frame
  };

 public:
  /// Refuses bad parameters (parameter_error).
  StickRatio(Index rows, Index cols, const StickRatioOptions& options = {})
      : rows_(rows), cols_(cols), o_(options) {
    require(options);
    expects_grid_size("published::StickRatio", rows, cols, 3, options.capacity);
    pre_.resize(static_cast<std::size_t>(rows * cols));
    current_ = post_ = pre_;
    touches_.resize(pre_.size());
    sticks_ = touches_;
    repository_.assign(static_cast<std::size_t>(options.capacity), {pre_});
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

  /// Looks at a frame of dots in px, of which those with a true `contact` touch the object. A frame
  /// without contact ends the contact: the stored frames are forgotten.
  template <dot_grid Dots, contact_mask Contact>
  StickRatioResult<S> operator()(const Dots& dots_px, const Contact& contact) {
    result_.updated = false;
    result_.accepted = read(dots_px, contact);
    if (!result_.accepted) {
      return result_;
    }
    ++frame_;
    if (std::find(touches_.begin(), touches_.end(), 1) == touches_.end()) {
      stored_ = 0;
      has_sticks_ = false;
      return result_;
    }
    denoise();
    for (std::size_t i = 0; i < stored_; ++i) {
      repository_[i].d_max = furthest(repository_[i].dots);
    }
    const std::size_t i_ref = reference_image();
    result_.reference_age = 0;
    if (i_ref < stored_) {
      const Image& reference = repository_[i_ref];
      result_.reference_age = static_cast<Index>(frame_ - reference.frame);
      result_.furthest_px = reference.d_max;
      estimate(reference.dots);
    }
    if (stored_ == 0 || (o_.updates && S(o_.U_min) < repository_[stored_ - 1].d_max)) {
      store();
    }
    return result_;
  }

 private:
  std::size_t at(Index k, Index l) const { return static_cast<std::size_t>(k * cols_ + l); }

  template <class Dots, class Contact>
  bool read(const Dots& dots_px, const Contact& contact) {
    const auto from = as_view(dots_px);
    const auto flags = as_view(contact);
    if (from.rows() != rows_ || from.cols() != cols_ || !same_size(from, flags)) {
      return false;
    }
    for (Index k = 0; k < rows_; ++k) {
      for (Index l = 0; l < cols_; ++l) {
        const cell_t<Dots> p = from(k, l);
        const Point2<S> dot = {S(point_traits<cell_t<Dots>>::x(p)),
                               S(point_traits<cell_t<Dots>>::y(p))};
        const bool found = is_plausible(dot);
        pre_[at(k, l)] = found ? dot : Point2<S>{not_a_number<S>(), not_a_number<S>()};
        touches_[at(k, l)] = found && is_contact(cell_t<Contact>(flags(k, l))) ? 1 : 0;
      }
    }
    return true;
  }

  /// "Weighted average of target dot and the adjacent 8 dots"; border dots stay as they are. A
  /// neighbour that was not found is left out with the one opposite.
  void denoise() {
    constexpr std::array<std::pair<Index, Index>, 4> steps = {{{0, 1}, {1, 0}, {1, -1}, {1, 1}}};
    current_ = pre_;
    for (Index k = 1; k + 1 < rows_; ++k) {
      for (Index l = 1; l + 1 < cols_; ++l) {
        Point2<S> sum = S(o_.S1) * pre_[at(k, l)];
        double weights = o_.S1;
        for (const auto& [m, n] : steps) {
          const double w = m == 0 || n == 0 ? o_.S2 : o_.S3;
          const Point2<S> both = pre_[at(k + m, l + n)] + pre_[at(k - m, l - n)];
          if (is_finite(both)) {
            sum += S(w) * both;
            weights += 2 * w;
          }
        }
        current_[at(k, l)] = sum / S(weights);
      }
    }
  }

  /// d_max(i): the largest displacement of a dot from a stored frame.
  S furthest(const Points& stored) const {
    const Flags& among = o_.moves_with_stick && has_sticks_ ? sticks_ : touches_;
    S most = S(0);
    for (std::size_t k = 0; k < current_.size(); ++k) {
      const S d = among[k] != 0 ? norm(current_[k] - stored[k]) : S(0);
      most = most < d ? d : most;
    }
    return most;
  }

  /// i_ref = sup{i: d_max(i) > U, i_C <= i <= N}; the number of stored frames if there is none.
  std::size_t reference_image() const {
    std::size_t i_C = stored_ > 0 ? stored_ - 1 : 0;
    while (i_C > 0 && repository_[i_C].d_max < repository_[i_C - 1].d_max) {
      --i_C;
    }
    for (std::size_t i = stored_; i-- > i_C;) {
      if (S(o_.U) < repository_[i].d_max) {
        return i;
      }
    }
    return stored_;
  }

  /// The reference dot, one with four neighbours; the central dot if none of those counts.
  DotIndex reference_dot(const Points& ref) const {
    DotIndex best = {rows_ / 2, cols_ / 2};
    if (!o_.follows_stick) {
      return best;
    }
    const Flags& among = has_sticks_ ? sticks_ : touches_;
    const Point2<S> center = has_sticks_ ? stick_center_ : center_of(touches_);
    S nearest = S(-1);
    for (Index k = 1; k + 1 < rows_; ++k) {
      for (Index l = 1; l + 1 < cols_; ++l) {
        const S away = norm(current_[at(k, l)] - center);
        const bool counts =
            among[at(k, l)] != 0 && touches_[at(k, l)] != 0 && is_finite(ref[at(k, l)]);
        if (counts && (nearest < S(0) || away < nearest)) {
          nearest = away;
          best = {k, l};
        }
      }
    }
    return best;
  }

  Point2<S> center_of(const Flags& region) const {
    Point2<S> sum = {S(0), S(0)};
    double count = 0;
    for (std::size_t k = 0; k < current_.size(); ++k) {
      if (region[k] != 0) {
        sum += current_[k];
        count += 1;
      }
    }
    return sum / S(count);
  }

  /// phi against a reference image, and the stick region.
  void estimate(const Points& ref) {
    result_.reference_dot = reference_dot(ref);
    const std::size_t k0 = at(result_.reference_dot.row, result_.reference_dot.col);
    post_ = current_;
    result_.angle_rad = S(0);
    if (o_.cancels_rotation) {
      cancel_rotation(ref, k0);
    }
    const S alpha = result_.scale = scale_from(ref);
    const Point2<S> d_0 = alpha * post_[k0] - ref[k0];  // the center of the scale cancels (E035)
    const S delta = o_.delta_grows ? S(o_.delta_0) * result_.furthest_px / S(o_.U) : S(o_.delta_0);
    double N_s = 0, N_c = 0;
    for (std::size_t k = 0; k < current_.size(); ++k) {
      const S off = norm(d_0 - (alpha * post_[k] - ref[k]));  // NaN: not found in one of the frames
      sticks_[k] = touches_[k] != 0 && off < delta ? 1 : 0;
      N_s += sticks_[k];
      N_c += touches_[k] != 0 && is_finite(off) ? 1 : 0;
    }
    has_sticks_ = N_s > 0;
    if (has_sticks_) {
      stick_center_ = center_of(sticks_);
    }
    result_.updated = N_c > 0;
    result_.stick_ratio = result_.updated ? S(N_s / N_c) : result_.stick_ratio;
  }

  /// Turns all dots back by theta_0 = (theta_1 + theta_2 + theta_3 + theta_4) / 4.
  void cancel_rotation(const Points& ref, std::size_t k0) {
    using std::atan2;
    using std::cos;
    using std::sin;
    const auto row = static_cast<std::size_t>(cols_);
    S sum = S(0);
    double count = 0;
    for (const std::size_t k : {k0 - 1, k0 + 1, k0 - row, k0 + row}) {
      const Point2<S> a = ref[k] - ref[k0], b = current_[k] - current_[k0];
      const S theta =
          o_.wraps ? atan2(b.y, b.x) - atan2(a.y, a.x) : atan2(a.x * b.y - a.y * b.x, dot(a, b));
      if (is_finite(theta)) {
        sum += theta;
        count += 1;
      }
    }
    const S theta_0 = result_.angle_rad = count > 0 ? sum / S(count) : S(0);
    const S c = cos(theta_0), s = sin(theta_0);
    for (std::size_t k = 0; k < current_.size(); ++k) {
      const Point2<S> e = current_[k] - current_[k0];
      post_[k] = current_[k0] + Point2<S>{c * e.x + s * e.y, c * e.y - s * e.x};
    }
  }

  /// alpha, over pairs of neighbours in contact; 1 if there is no such pair. q does not exist for a
  /// pair that has not moved, which then does not count (E036).
  S scale_from(const Points& ref) const {
    S sum_ref = S(0), sum_cur = S(0);
    const auto across = [](const Point2<S>& e, const Point2<S>& q) {
      const S part = e.x * q.y - e.y * q.x;
      return part < S(0) ? -part : part;
    };
    constexpr std::array<std::pair<Index, Index>, 4> steps = {{{1, -1}, {1, 0}, {1, 1}, {0, 1}}};
    for (Index k = 0; k < rows_ && o_.scale != StickScale::none; ++k) {
      for (Index l = 0; l < cols_; ++l) {
        for (const auto& [down, right] : steps) {
          const bool inside = k + down < rows_ && l + right >= 0 && l + right < cols_;
          if (!inside || touches_[at(k, l)] == 0 || touches_[at(k + down, l + right)] == 0) {
            continue;
          }
          const std::size_t a = at(k, l), b = at(k + down, l + right);
          const Point2<S> e_ref = ref[a] - ref[b], e_cur = post_[a] - post_[b];
          const Point2<S> d = (post_[a] - ref[a]) + (post_[b] - ref[b]);
          if (o_.scale == StickScale::plain && is_finite(e_ref)) {
            sum_ref += norm(e_ref);
            sum_cur += norm(e_cur);
          } else if (const S size = norm(d); S(1e-9) < size) {
            sum_ref += across(e_ref, d / size);
            sum_cur += across(e_cur, d / size);
          }
        }
      }
    }
    return S(0) < sum_cur ? sum_ref / sum_cur : S(1);
  }

  /// Appends the frame; beyond the capacity the oldest one is forgotten.
  void store() {
    if (stored_ == repository_.size()) {
      std::rotate(repository_.begin(), repository_.begin() + 1, repository_.end());
      --stored_;
    }
    repository_[stored_].dots = current_;
    repository_[stored_].frame = frame_;
    ++stored_;
  }

  Index rows_, cols_;
  StickRatioOptions o_;
  std::vector<Image> repository_;  ///< I_R(i), oldest first, of which `stored_` are valid
  std::size_t stored_ = 0;         ///< N
  std::int64_t frame_ = 0;
  Points pre_, current_, post_;  ///< dots before denoising, after it, and rotated back
  Flags touches_, sticks_;
  bool has_sticks_ = false;
  Point2<S> stick_center_ = {S(0), S(0)};
  StickRatioResult<S> result_;
};

}  // namespace published
}  // namespace v1
}  // namespace fingerpad
