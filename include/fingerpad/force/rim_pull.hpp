// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The clamped rim with its side dots: the pull of the membrane at each border point, per mu t.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/membrane/rubber.hpp"

namespace fingerpad {
inline namespace v0 {

/// Numbers of side dots with a defect.
struct SideDotFaults {
  Index missing = 0;      ///< not found
  Index unstretched = 0;  ///< stretched too little to give the direction of the pull
  Index misplaced = 0;    ///< below the base, or nearer to another border point than to their own
};

namespace detail::membrane {

/// Border points in the order of their angle, and the chords to the side dots of a frame. All
/// memory is taken in the constructor.
template <scalar S>
class Rim {
 public:
  /// Refuses bad parameters in the name of `owner`.
  template <spatial_dot_grid Border, class Length>
  Rim(const char* owner, const Border& border_mm, const Length& length_mm, const S& radius_mm)
      : radius_mm_(radius_mm) {
    using std::atan2;
    const auto border = as_view(border_mm);
    expects(border.rows() == 1 && border.cols() >= 6 && border.cols() <= 1000000, owner,
            "border columns", border.cols(), "in [6, 1000000], in one row");
    for (Index column = 0; column < border.cols(); ++column) {
      const auto at = spatial_dot<S>(cell_t<Border>(border(0, column)));
      expects(is_finite(at), owner, "border point", column, "finite");
      const S length = S(length_mm(column)), r = norm(Point2<S>{at.x, at.y});
      expects(is_finite(length) && value(length) > 0, owner, "side_dot_length_mm", length,
              "finite and > 0");
      expects(r * S(20) > radius_mm * S(19) && r * S(20) < radius_mm * S(21), owner,
              "distance of a border point from the axis", r, "within 5 % of base_radius_mm");
      const S angle = atan2(at.y, at.x);
      places_.push_back({column, at, {-at.y / r, at.x / r, S(0)}, length, angle, S(0)});
    }
    std::sort(places_.begin(), places_.end(),
              [](const Place& a, const Place& b) { return value(a.angle) < value(b.angle); });
    place_.resize(size());
    for (std::size_t k = 0; k < size(); ++k) {
      place_[static_cast<std::size_t>(places_[k].column)] = k;
      expects(gap_after(k) > S(1e-6), owner, "angle between border points", gap_after(k), "> 0");
      places_[k].gap = (gap_after(before(k)) + gap_after(k)) / S(2);
    }
    const std::vector<Point3<S>> none(size(), missing_point<S>());
    chord_ = middle_ = around_ = hoop_ = pull_ = none;
    known_.assign(size(), 0);
  }

  std::size_t size() const { return places_.size(); }
  const S& radius_mm() const { return radius_mm_; }
  std::size_t after(std::size_t k) const { return k + 1 == size() ? 0 : k + 1; }
  std::size_t before(std::size_t k) const { return k == 0 ? size() - 1 : k - 1; }
  const Point3<S>& border(std::size_t k) const { return places_[k].border; }
  const Point3<S>& tangent(std::size_t k) const { return places_[k].tangent; }
  Index column(std::size_t k) const { return places_[k].column; }
  /// Place of the border point of a column.
  std::size_t place(Index column) const { return place_[static_cast<std::size_t>(column)]; }
  /// Angle of the rim that the k-th point stands for.
  const S& gap_rad(std::size_t k) const { return places_[k].gap; }
  /// From the k-th point to the next.
  S gap_after(std::size_t k) const {
    const S turn = S(k + 1 == size() ? 2 * std::numbers::pi : 0.0);
    return places_[after(k)].angle + turn - places_[k].angle;
  }
  void set_length(std::size_t k, const S& mm) { places_[k].length = mm; }

  /// The pull on the base at the k-th point, per mu t: T / (mu t).
  const Point3<S>& pull(std::size_t k) const { return pull_[k]; }

  /// Reads the side dots of a frame, one row in the columns of the border. The chord of a dot with
  /// a defect is that of its neighbours. False if more than a third have one, or all are displaced
  /// along the rim by half their spacing: shifted, mirrored, or rows exchanged.
  template <class Dots>
  bool read(const Dots& side_dots_mm, SideDotFaults& faults) {
    const S spacing = S(2 * std::numbers::pi) * radius_mm_ / S(static_cast<double>(size()));
    S carried = S(0), length = S(0);
    faults = {};
    for (std::size_t k = 0; k < size(); ++k) {
      const Place& at = places_[k];
      const auto seen = spatial_dot<S>(side_dots_mm(0, at.column));
      chord_[k] = (seen - at.border) / at.length;
      const S shear = dot(chord_[k], at.tangent), sq = squared_norm(chord_[k]);
      // no membrane stretches tenfold or is sheared by more than a half
      const S most = larger(spacing / at.length, S(1)) / S(2);
      const bool missing = !is_plausible(seen);
      const bool misplaced =
          missing || !(value(sq) < 100) || shear > most || -shear > most || value(chord_[k].z) < 0;
      const bool stretched = !(sq - shear * shear < S(1.005 * 1.005));
      known_[k] = !misplaced && stretched;
      faults.missing += missing ? 1 : 0;
      faults.misplaced += misplaced && !missing ? 1 : 0;
      faults.unstretched += !misplaced && !stretched ? 1 : 0;
      carried += misplaced ? S(0) : shear * at.length;
      length += at.length / S(static_cast<double>(size()));
    }
    const auto count = static_cast<Index>(size());
    const Index placed = count - faults.missing - faults.misplaced;
    const S most = larger(spacing / S(2), length / S(4)) * S(static_cast<double>(placed));
    if (3 * (count - placed + faults.unstretched) > count || !(carried < most && -carried < most)) {
      return false;
    }
    fill(known_, chord_);
    return true;
  }

  /// Sets the chords to chord_mm(k); the chord of a point where it is NaN is that of its
  /// neighbours.
  template <class Chord>
  void set_chords(const Chord& chord_mm) {
    for (std::size_t k = 0; k < size(); ++k) {
      chord_[k] = chord_mm(k) / places_[k].length;
      known_[k] = is_finite(chord_[k]) ? 1 : 0;
    }
    fill(known_, chord_);
  }

  /// Finds the pulls. Without the inclination of the stress-free rim, or with load 0 (p / (mu t),
  /// 1/mm, not known yet), d is the chord: pull = dW/dd. Else from the balance of the strip between
  /// the rim and the ring through the middles of the chords, whose stress-free radius is
  /// R = a - L cos(phi_0) / 2, per angle and with h = (dx/dpsi) / R:
  ///   a pull = R dW/dd + L / 2 d(dW/dh)/dpsi - p / (mu t) area.
  void find_pulls(const std::optional<double>& inclination_rad,
                  const S& mooney_share,
                  const S& load_per_mm) {
    using std::cos;
    const bool by_strip = inclination_rad.has_value() && !(value(load_per_mm) == 0);
    for (std::size_t k = 0; k < size(); ++k) {
      const Place& at = places_[k];
      pull_[k] = rubber_pull(chord_[k], at.tangent, mooney_share);
      middle_[k] = at.border + (at.length / S(2)) * chord_[k];
    }
    if (!by_strip) {
      return;
    }
    const S cosine = cos(S(*inclination_rad));
    const auto ring = [&](std::size_t k) { return radius_mm_ - places_[k].length / S(2) * cosine; };
    for (std::size_t k = 0; k < size(); ++k) {
      around_[k] = change_around(middle_, k);
      hoop_[k] = rubber_pull(around_[k] / ring(k), chord_[k], mooney_share);
    }
    for (std::size_t k = 0; k < size(); ++k) {
      const Place& at = places_[k];
      const S half = at.length / S(2);
      const Point3<S> across = rubber_pull(chord_[k], around_[k] / ring(k), mooney_share);
      const Point3<S> area =
          half * cross(chord_[k], (radius_mm_ * at.tangent + around_[k]) / S(2));  // into the pad
      pull_[k] =
          (ring(k) * across + half * change_around(hoop_, k) - load_per_mm * area) / radius_mm_;
    }
  }

  /// Replaces the vectors at unknown points by those between the nearest known ones on both sides,
  /// rotated about the axis. One at least must be known.
  void fill(const std::vector<unsigned char>& known, std::vector<Point3<S>>& vectors) const {
    const std::size_t n = size();
    for (std::size_t k = 0; k < n; ++k) {
      if (known[k] != 0) {
        continue;
      }
      std::size_t left = 1, right = 1;
      while (known[(k + n - left) % n] == 0) {
        ++left;
      }
      while (known[(k + right) % n] == 0) {
        ++right;
      }
      const std::size_t from = (k + n - left) % n, to = (k + right) % n;
      const Point3<S> a = rotated(from, k, vectors[from]), b = rotated(to, k, vectors[to]);
      const S share = S(static_cast<double>(left)) / S(static_cast<double>(left + right));
      vectors[k] = a + share * (b - a);
    }
  }

 private:
  struct Place {
    Index column;
    Point3<S> border;
    Point3<S> tangent;  ///< unit vector along the rim, in the direction of growing angle
    S length;           ///< from here to the side dot, along the stress-free membrane, mm
    S angle;
    S gap;
  };

  static S larger(const S& a, const S& b) { return a < b ? b : a; }

  /// Derivative by the angle of a vector known at each point, from its two neighbours in the frame
  /// that rotates with the angle.
  Point3<S> change_around(const std::vector<Point3<S>>& vectors, std::size_t k) const {
    const std::size_t left = before(k), right = after(k);
    const Point3<S> turning =
        (rotated(right, k, vectors[right]) - rotated(left, k, vectors[left])) /
        (S(2) * places_[k].gap);
    return turning + Point3<S>{-vectors[k].y, vectors[k].x, S(0)};
  }

  /// A vector at point `from`, rotated about the axis to point `to`.
  Point3<S> rotated(std::size_t from, std::size_t to, const Point3<S>& p) const {
    const Point3<S>&e = places_[from].tangent, &f = places_[to].tangent;
    const S along = dot(p, e);
    const S out = p.x * e.y - p.y * e.x;  // the radius is the tangent rotated by -90 degrees
    return {along * f.x + out * f.y, along * f.y - out * f.x, p.z};
  }

  S radius_mm_;
  std::vector<Place> places_;
  std::vector<std::size_t> place_;  ///< of each column
  std::vector<Point3<S>> chord_;    ///< from the rim to the side dot, per stress-free length
  std::vector<Point3<S>> middle_;   ///< of the chord, mm
  std::vector<Point3<S>> around_;   ///< change of the middle with the angle, mm
  std::vector<Point3<S>> hoop_;     ///< pull across the chord, per mu t
  std::vector<Point3<S>> pull_;
  std::vector<unsigned char> known_;
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
