// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Pose of an object from all dots in contact, which goes beyond the papers. A map stores where each
// dot in contact sits on the object, in the object's own coordinates (those of the sensor in the
// frame of first contact). The pose of a frame is the rigid motion that best fits the map to the
// dots. Then dots new in contact are entered with that pose, those that stay refine their entry as
// a running mean, and those that have left are removed.
//
// A chain of 3x3 neighbourhoods adds the tilt noise of nine dots at each change of dot. A patch of
// about fifty dots has a tenth of that noise, and its memory is lost only when the contact has
// rolled over its whole width.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/math/rigid_fit.hpp"
#include "fingerpad/motion/detail/dot_frame.hpp"
#include "fingerpad/motion/motion_result.hpp"

namespace fingerpad {
inline namespace v0 {

/// Policy: pose from a map of the dots in contact.
///
/// Slipping dots must not bias the pose, so the fit is repeated with weights 1 / (1 + (r/c)^2)^2,
/// where r is a dot's residual and c twice the median residual (three times in the last pass, to
/// lower the noise). A dot with a residual of more than twice that c is entered again at its
/// present position, because after a slip it sticks elsewhere.
struct ContactMap {
  Index dots_to_begin = 9;  ///< dots in contact needed to begin an object, >= 3
  int robust_passes = 3;    ///< repetitions of the fit, in [0, 10]; 0: plain least squares

  template <scalar S>
  struct Entry {
    Point3<S> place_mm = {S(0), S(0), S(0)};
    S weight = S(0);  ///< of the mean; 0: not on the map
  };
  /// A dot in contact in this frame. `cell` is the index of its entry.
  template <scalar S>
  struct Observation {
    std::size_t cell = 0;
    Point3<S> place_mm = {S(0), S(0), S(0)};  ///< of the entry
    Point3<S> dot_mm = {S(0), S(0), S(0)};
    S prior = S(0);  ///< weight by the noise of its entry and its own: n / (n + 1)
    S trust = S(1);  ///< weight by its residual
    S residual_sq = S(0);
  };
  template <scalar S>
  struct Track : detail::motion::Track<S> {
    std::vector<Entry<S>> map;
    std::vector<Observation<S>> observations;  // those on the map first
    std::vector<std::size_t> leaving;  // cells of the map whose dots are found, but out of contact
    std::vector<scalar_real_t<S>> sorted;
    S pitch_sq = S(0);  // mean square distance of neighbours in contact at first, mm^2
  };

  template <scalar S>
  Track<S> track(Index rows, Index cols) const {
    expects(dots_to_begin >= 3, "ContactMap", "dots_to_begin",
            static_cast<long long>(dots_to_begin), ">= 3");
    expects(robust_passes >= 0 && robust_passes <= 10, "ContactMap", "robust_passes",
            static_cast<long long>(robust_passes), "in [0, 10]");
    const auto cells = static_cast<std::size_t>(rows * cols);
    Track<S> t;
    t.map.resize(cells);
    t.observations.resize(cells);
    t.leaving.resize(cells);
    t.sorted.resize(cells);
    return t;
  }

  template <scalar S, class Frame>
  MotionStatus begin(const Frame& frame, DotIndex reference, Track<S>& t) const {
    std::fill(t.map.begin(), t.map.end(), Entry<S>{});
    const Seen seen = look(frame, t);
    if (seen.fresh < dots_to_begin) {
      return MotionStatus::too_few_dots;
    }
    const Observation<S>* const s = t.observations.data() + t.observations.size() - seen.fresh;
    const auto dot = [s](Index k) { return s[k].dot_mm; };
    const auto one = [](Index) { return S(1); };
    if (!fit_rigid<S>(seen.fresh, dot, dot, one).determined) {
      return MotionStatus::collinear;
    }
    enter(seen, t);
    t.pitch_sq = pitch_sq<S>(frame);
    Point3<S> center = {S(0), S(0), S(0)};
    for (Index k = 0; k < seen.fresh; ++k) {
      center = center + dot(k);
    }
    t.start_mm = reference.exists() ? frame.dot(reference.row, reference.col)
                                    : (S(S(1) / S(static_cast<double>(seen.fresh))) * center);
    t.dots_used = seen.fresh;
    return MotionStatus::ok;
  }

  template <scalar S, class Frame>
  MotionStatus advance(const Frame& frame, DotIndex, Track<S>& t) const {
    const Seen seen = look(frame, t);
    if (seen.known < 3) {
      return seen.known == 0 && seen.fresh > 0 ? MotionStatus::lost : MotionStatus::too_few_dots;
    }
    RigidFit<S> fit = fit_map(seen, t);
    if (!fit.determined) {
      return MotionStatus::collinear;
    }
    const scalar_real_t<S> median_sq = distrust(fit, seen, t);
    const S residual_rms_mm = root_mean_square(seen, t);
    const bool apart = value(t.pitch_sq) < 16 * value(S(residual_rms_mm * residual_rms_mm));
    if (apart ||
        value(angle_between(t.pose.rotation, fit.pose.rotation)) > scalar_real_t<S>(max_step_rad)) {
      return MotionStatus::not_rigid;
    }
    t.pose = fit.pose;
    t.angles = zyx_angles(fit.pose.rotation);
    t.dots_used = seen.known;
    t.residual_rms_mm = residual_rms_mm;
    forget(seen, t);
    refine(median_sq, seen, t);
    enter(seen, t);
    return MotionStatus::ok;
  }

 private:
  /// No membrane rotates so far between two poses; exchanged rows and columns turn a flat patch
  /// over.
  static constexpr double max_step_rad = 2.5;

  /// Numbers of dots in contact that are on the map and that are new, and of dots that have left.
  struct Seen {
    Index known = 0;
    Index fresh = 0;
    Index left = 0;
  };

  /// Mean square distance of neighbours in contact; infinite if there are none.
  template <scalar S, class Frame>
  static S pitch_sq(const Frame& frame) {
    S sum = S(0);
    int count = 0;
    const auto add = [&](Index i, Index j, DotIndex next) {
      if (next.row < frame.rows() && next.col < frame.cols() && frame.in_contact({i, j}) &&
          frame.in_contact(next)) {
        sum = sum + squared_norm(frame.dot(next.row, next.col) - frame.dot(i, j));
        ++count;
      }
    };
    for (Index i = 0; i < frame.rows(); ++i) {
      for (Index j = 0; j < frame.cols(); ++j) {
        add(i, j, {i, j + 1});
        add(i, j, {i + 1, j});
      }
    }
    return count > 0 ? S(sum / S(count)) : S(std::numeric_limits<scalar_real_t<S>>::infinity());
  }

  /// A new entry has the error of the pose besides that of its dot, so it counts as half an
  /// observation.
  template <scalar S>
  static S first_weight() {
    return S(1) / S(2);
  }

  /// Lists the dots in contact: those on the map from the front, new ones from the back. Also lists
  /// the dots of the map that are found out of contact; missing ones may still be in contact.
  template <scalar S, class Frame>
  static Seen look(const Frame& frame, Track<S>& t) {
    Seen seen;
    const std::size_t end = t.observations.size();
    std::size_t cell = 0;
    for (Index i = 0; i < frame.rows(); ++i) {
      for (Index j = 0; j < frame.cols(); ++j, ++cell) {
        const Entry<S>& entry = t.map[cell];
        const bool known = value(entry.weight) > 0;
        const bool flagged = frame.flagged(i, j);
        if ((!known && !flagged) || !frame.found(i, j)) {
          continue;
        }
        if (!flagged) {
          t.leaving[static_cast<std::size_t>(seen.left++)] = cell;
          continue;
        }
        const std::size_t at = known ? static_cast<std::size_t>(seen.known++)
                                     : end - static_cast<std::size_t>(++seen.fresh);
        const S prior = entry.weight / (entry.weight + S(1));
        t.observations[at] = {cell, entry.place_mm, frame.dot(i, j), prior, S(1), S(0)};
      }
    }
    return seen;
  }

  template <scalar S>
  static RigidFit<S> fit_map(const Seen& seen, const Track<S>& t) {
    const Observation<S>* const s = t.observations.data();
    return fit_rigid<S>(
        seen.known, [=](Index k) -> const Point3<S>& { return s[k].place_mm; },
        [=](Index k) -> const Point3<S>& { return s[k].dot_mm; },
        [=](Index k) { return S(s[k].prior * s[k].trust); });
  }

  template <scalar S>
  static void residuals(const Pose<S>& pose, const Seen& seen, Track<S>& t) {
    for (Index k = 0; k < seen.known; ++k) {
      Observation<S>& s = t.observations[static_cast<std::size_t>(k)];
      s.residual_sq = squared_norm(s.dot_mm - pose(s.place_mm));
    }
  }

  template <scalar S>
  static scalar_real_t<S> median_residual_sq(const Seen& seen, Track<S>& t) {
    for (Index k = 0; k < seen.known; ++k) {
      const auto at = static_cast<std::size_t>(k);
      t.sorted[at] = value(t.observations[at].residual_sq);
    }
    const auto middle = t.sorted.begin() + seen.known / 2;
    std::nth_element(t.sorted.begin(), middle, t.sorted.begin() + seen.known);
    return *middle;
  }

  template <scalar S>
  static void weigh(const S& bound_sq, const Seen& seen, Track<S>& t) {
    for (Index k = 0; k < seen.known; ++k) {
      Observation<S>& s = t.observations[static_cast<std::size_t>(k)];
      const S ratio = bound_sq / (bound_sq + s.residual_sq);
      s.trust = ratio * ratio;
    }
  }

  /// Repeats the fit with less and less weight on dots that do not follow the others. Returns the
  /// median squared residual that the last weights are based on.
  template <scalar S>
  scalar_real_t<S> distrust(RigidFit<S>& fit, const Seen& seen, Track<S>& t) const {
    scalar_real_t<S> median_sq = scalar_real_t<S>(0);
    residuals(fit.pose, seen, t);
    for (int pass = 1; pass <= robust_passes; ++pass) {
      median_sq = median_residual_sq(seen, t);
      if (!(median_sq > 0)) {
        break;  // most dots fit exactly
      }
      weigh(S((pass < robust_passes ? 4 : 9) * median_sq), seen, t);
      const RigidFit<S> again = fit_map(seen, t);
      if (!again.determined) {
        break;  // the weights leave dots on a line: keep the fit before
      }
      fit = again;
      residuals(fit.pose, seen, t);
    }
    return median_sq;
  }

  template <scalar S>
  static S root_mean_square(const Seen& seen, const Track<S>& t) {
    using std::sqrt;
    S sum = S(0);
    S mass = S(0);
    for (Index k = 0; k < seen.known; ++k) {
      const Observation<S>& s = t.observations[static_cast<std::size_t>(k)];
      sum = sum + s.trust * s.residual_sq;
      mass = mass + s.trust;
    }
    return value(sum) > 0 ? S(sqrt(S(sum / mass))) : S(0);
  }

  template <scalar S>
  static void forget(const Seen& seen, Track<S>& t) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(seen.left); ++k) {
      t.map[t.leaving[k]].weight = S(0);
    }
  }

  template <scalar S>
  void refine(const scalar_real_t<S>& median_sq, const Seen& seen, Track<S>& t) const {
    const Pose<S> back = inverse(t.pose);
    for (Index k = 0; k < seen.known; ++k) {
      const Observation<S>& s = t.observations[static_cast<std::size_t>(k)];
      Entry<S>& entry = t.map[s.cell];
      const Point3<S> place = back(s.dot_mm);
      if (value(s.residual_sq) > 36 * median_sq && robust_passes > 0) {
        entry = {place, first_weight<S>()};
        continue;
      }
      entry.weight = entry.weight + s.trust;
      const S share = s.trust / entry.weight;
      const Point3<S> step = share * (place - entry.place_mm);
      entry.place_mm += step;
    }
  }

  template <scalar S>
  static void enter(const Seen& seen, Track<S>& t) {
    const Pose<S> back = inverse(t.pose);
    const std::size_t first = t.observations.size() - static_cast<std::size_t>(seen.fresh);
    for (std::size_t k = first; k < t.observations.size(); ++k) {
      t.map[t.observations[k].cell] = {back(t.observations[k].dot_mm), first_weight<S>()};
    }
  }
};

}  // namespace v0
}  // namespace fingerpad
