// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The rim with its side dots: computes the pull on each of n equal segments of the rim.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/rim_traction.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// Pull of Mooney-Rivlin rubber across the direction of `other`, per mu t and stress-free length:
/// dW/d(along). `along` and `other` are derivatives of the position along two directions that are
/// perpendicular unit vectors without stress. Exchanged arguments give the pull across `along`.
template <scalar S>
Point3<S> rubber_pull(const Point3<S>& along, const Point3<S>& other, const S& mooney_share) {
  const S a = squared_norm(along), b = squared_norm(other), c = dot(along, other);
  const S inverse = S(1) / (a * b - c * c);
  const Point3<S> of_area = b * along + S(-c) * other;  // half of d(J^2)/d(along)
  const S neo_hookean = S(1) - mooney_share;
  const S by_area = mooney_share - (neo_hookean + mooney_share * (a + b)) * inverse * inverse;
  return S(neo_hookean + mooney_share * inverse) * along + by_area * of_area;
}

/// The strip between the rim and the middle of the chord to a side dot.
template <scalar S>
struct Strip {
  Point3<S> chord;   ///< divided by its stress-free length
  Point3<S> middle;  ///< of the chord, mm
  Point3<S> around;  ///< change of the middle with the angle, mm
  Point3<S> hoop;    ///< pull across the chord, per mu t
};

/// Pulls from the side dots of a frame, dot by dot in the order of the angle, and numbers of dots
/// with a defect.
template <scalar S>
struct RimPulls {
  std::vector<RimPull<S>> dots;
  std::vector<Point3<S>> along;     ///< d of each dot
  std::vector<Strip<S>> strips;     ///< between the rim and the middles of the chords
  std::vector<Point3<S>> segments;  ///< integral over each rim segment, mm times the unit of a pull
  Index missing = 0;                ///< not found
  Index unstretched = 0;            ///< stretched too little for a direction
  Index slack = 0;                  ///< shorter than without stress
  Index misplaced = 0;              ///< nearer to another border point, or far from their own
  Index below = 0;                  ///< below the base
  S carried_mm = S(0);              ///< mean displacement along the rim, without misplaced dots
  Index outward = 0;  ///< pulls that lean out of the pad, where the membrane bulges past the rim
};

/// Points of the rim in the order of their angle. Between them pulls are interpolated linearly.
template <scalar S>
class Rim {
 public:
  template <spatial_dot_grid Border, class Length>
  Rim(const Border& border_mm, const Length& length_mm, const S& radius_mm, Index segments)
      : radius_mm_(radius_mm), segments_(segments) {
    const auto border = as_view(border_mm);
    expects(border.rows() == 1 && border.cols() >= 6 && border.cols() <= 1000000, "Wrench",
            "border columns", static_cast<long long>(border.cols()), "in [6, 1000000], in one row");
    for (Index k = 0; k < border.cols(); ++k) {
      add(k, spatial_dot<S>(cell_t<Border>(border(0, k))), S(length_mm(k)));
    }
    std::sort(points_.begin(), points_.end(),
              [](const Place& a, const Place& b) { return value(a.angle) < value(b.angle); });
    for (std::size_t k = 0; k < points_.size(); ++k) {
      expects(gap_after(k) > S(1e-6), "Wrench", "angle between border points", gap_after(k), "> 0");
      add_weights(k);
    }
  }

  Index size() const { return static_cast<Index>(points_.size()); }
  RimPulls<S> pulls() const {
    RimPulls<S> out;
    out.dots.resize(points_.size());
    out.along.resize(points_.size());
    out.strips.resize(points_.size());
    out.segments.resize(static_cast<std::size_t>(segments_));
    return out;
  }
  const Point3<S>& border(Index k) const {
    return points_[static_cast<std::size_t>(k)].point.border;
  }
  const Point3<S>& tangent(Index k) const {
    return points_[static_cast<std::size_t>(k)].point.tangent;
  }
  const S& angle(Index k) const { return points_[static_cast<std::size_t>(k)].angle; }
  /// Column of the k-th point in the grid of dots.
  Index column(Index k) const { return points_[static_cast<std::size_t>(k)].column; }
  const S& length_mm(Index k) const { return points_[static_cast<std::size_t>(k)].point.length_mm; }
  /// Length of rim that the k-th point represents, mm.
  const S& share_mm(Index k) const { return points_[static_cast<std::size_t>(k)].share_mm; }

  /// Pulls from this frame's side dots (`Row::rows` rows of size() dots). `load_per_mm`:
  /// pressure / mu t, 0 if unknown.
  template <class Row, class Law, class Dots>
  void measure(const Dots& side_dots_mm,
               const Row& row,
               const Law& law,
               const S& load_per_mm,
               RimPulls<S>& out) const {
    out.missing = out.unstretched = out.slack = out.outward = 0;
    find_misplaced<Row>(side_dots_mm, out);
    for (std::size_t k = 0; k < points_.size(); ++k) {
      out.dots[k] = pull_at(points_[k], side_dots_mm, row, law, load_per_mm, out.along[k]);
      const RimPullStatus status = out.dots[k].status;
      out.missing += status == RimPullStatus::missing ? 1 : 0;
      out.unstretched += status == RimPullStatus::unstretched ? 1 : 0;
      out.slack += status == RimPullStatus::slack ? 1 : 0;
      const Point3<S>& pull = out.dots[k].pull;
      const Point3<S>& border = points_[k].point.border;
      out.outward += value(S(pull.x * border.x + pull.y * border.y)) > 0 ? 1 : 0;
    }
    if constexpr (requires {
                    row.stress_free_inclination_rad;
                    law.mooney_share;
                  }) {
      if (row.needs_modulus() && !(value(load_per_mm) == 0)) {
        balance_strips(side_dots_mm, *row.stress_free_inclination_rad, S(law.mooney_share),
                       load_per_mm, out);
      }
    }
  }

  /// Whether the side dots belong to these border points: at most a third is misplaced, and shear
  /// of the membrane displaces them along the rim by less than half the spacing of border points or
  /// a quarter of their length, whichever is larger.
  bool in_order(const RimPulls<S>& pulls) const {
    const S spacing = S(2 * std::numbers::pi) * radius_mm_ / S(static_cast<double>(size()));
    const S shear = points_.front().point.length_mm / S(4);
    const S most = spacing / S(2) > shear ? S(spacing / S(2)) : shear;
    const S& carried = pulls.carried_mm;
    return 3 * pulls.misplaced <= size() && carried < most && -carried < most;
  }

  /// Fills unknown pulls from the neighbours on both sides, and integrates over the segments. Needs
  /// at least one usable dot.
  void integrate(RimPulls<S>& pulls) const {
    fill_gaps(pulls.dots);
    for (Point3<S>& sum : pulls.segments) {
      sum = {S(0), S(0), S(0)};
    }
    for (const Weight& w : weights_) {
      Point3<S>& sum = pulls.segments[w.segment];
      sum = sum + w.mm * pulls.dots[w.point].pull;
    }
  }

 private:
  /// Replaces the rim's pull by that of the balance of the strip between the rim and the ring
  /// through the middles of the chords, per angle. With the ring's stress-free radius
  /// R = a - L cos(phi_0) / 2:
  ///   a P_rim = R dW/dd + L / 2 d(dW/dh)/dpsi + p / (mu t) area,   h = (dx/dpsi) / R
  /// OneRow ignores changes along the rim, 1.5 % of a drag; here neighbours provide them. A point
  /// without two known neighbours on each side keeps its pull.
  template <class Dots>
  void balance_strips(const Dots& side_dots_mm,
                      double stress_free_inclination_rad,
                      const S& mooney_share,
                      const S& load_per_mm,
                      RimPulls<S>& out) const {
    using std::cos;
    const std::size_t n = points_.size();
    const auto known = [&](std::size_t k) { return out.dots[k].status == RimPullStatus::ok; };
    const auto has_both = [&](std::size_t k) {
      return known(k) && known(after(k)) && known(before(k));
    };
    const auto ring_mm = [&](std::size_t k) {
      return S(radius_mm_ -
               points_[k].point.length_mm / S(2) * S(cos(S(stress_free_inclination_rad))));
    };
    for (std::size_t k = 0; k < n; ++k) {
      const RimPoint<S>& rim = points_[k].point;
      const Point3<S> chord = spatial_dot<S>(side_dots_mm(0, points_[k].column)) - rim.border;
      out.strips[k].chord = chord / rim.length_mm;
      out.strips[k].middle = rim.border + chord / S(2);
    }
    for (std::size_t k = 0; k < n; ++k) {
      Strip<S>& strip = out.strips[k];
      strip.around = change_around(k, [&](std::size_t j) { return out.strips[j].middle; });
      strip.hoop = rubber_pull(strip.around / ring_mm(k), strip.chord, mooney_share);
    }
    for (std::size_t k = 0; k < n; ++k) {
      if (!has_both(k) || !has_both(after(k)) || !has_both(before(k))) {
        continue;
      }
      const RimPoint<S>& rim = points_[k].point;
      const Strip<S>& strip = out.strips[k];
      const S half_mm = rim.length_mm / S(2);
      const Point3<S> across = rubber_pull(strip.chord, strip.around / ring_mm(k), mooney_share);
      const Point3<S> hoop = change_around(k, [&](std::size_t j) { return out.strips[j].hoop; });
      const Point3<S> mean_around = (radius_mm_ * rim.tangent + strip.around) / S(2);
      const Point3<S> area = half_mm * cross(strip.chord, mean_around);  // into the pad, mm^2
      out.dots[k].pull =
          (ring_mm(k) * across + half_mm * hoop + S(-load_per_mm) * area) / radius_mm_;
    }
  }

  /// Derivative by the angle of a vector known at each point, from its two neighbours in the frame
  /// that rotates with the angle.
  template <class VectorAt>
  Point3<S> change_around(std::size_t k, const VectorAt& at) const {
    const std::size_t left = before(k), right = after(k);
    const Point3<S> turning = (rotated(right, k, at(right)) - rotated(left, k, at(left))) /
                              S(gap_after(left) + gap_after(k));
    const Point3<S> here = at(k);
    return {S(turning.x - here.y), S(turning.y + here.x), turning.z};
  }

  struct Place {
    Index column;
    RimPoint<S> point;
    S angle;
    S share_mm = S(0);
  };
  struct Weight {
    std::size_t segment;
    std::size_t point;
    S mm;
  };

  void add(Index column, const Point3<S>& border, const S& length_mm) {
    using std::atan2;
    using std::sqrt;
    expects(is_finite(border), "Wrench", "border point", S(static_cast<double>(column)), "finite");
    expects(is_finite(length_mm) && value(length_mm) > 0, "Wrench", "side_dot_length_mm", length_mm,
            "finite and > 0");
    const S r = sqrt(S(border.x * border.x + border.y * border.y));
    const S off = r - radius_mm_;
    expects(value(off) < value(S(radius_mm_ / S(20))) && value(off) > value(S(-radius_mm_ / S(20))),
            "Wrench", "distance of a border point from the axis", r,
            "within 5 % of base_radius_mm");
    Place place{column,
                {border, {S(-border.y / r), S(border.x / r), S(0)}, length_mm, radius_mm_},
                S(atan2(border.y, border.x))};
    if (value(place.angle) < 0) {
      place.angle = place.angle + S(2 * std::numbers::pi);
    }
    points_.push_back(place);
  }

  std::size_t after(std::size_t k) const { return k + 1 == points_.size() ? 0 : k + 1; }
  std::size_t before(std::size_t k) const { return k == 0 ? points_.size() - 1 : k - 1; }
  S gap_after(std::size_t k) const {
    const S turn = S(k + 1 == points_.size() ? 2 * std::numbers::pi : 0.0);
    return S(points_[after(k)].angle + turn - points_[k].angle);
  }

  /// Weights of the points k and k + 1 in the segments between them.
  void add_weights(std::size_t k) {
    const S step = S(2 * std::numbers::pi) / S(static_cast<double>(segments_));
    const S gap = gap_after(k);
    S from = points_[k].angle;
    const S end = from + gap;
    for (Index segment = static_cast<Index>(value(S(from / step))); from < end; ++segment) {
      const S border = step * S(static_cast<double>(segment + 1));
      if (!(border > from)) {
        continue;
      }
      const S to = border < end ? border : end;
      // mean of the second point's share over [from, to]
      const S second = ((from + to) / S(2) - points_[k].angle) / gap;
      const S mm = (to - from) * radius_mm_;
      const std::size_t in = static_cast<std::size_t>(segment % segments_);
      weights_.push_back({in, k, S(mm * (S(1) - second))});
      weights_.push_back({in, after(k), S(mm * second)});
      from = to;
    }
    points_[k].share_mm = points_[k].share_mm + gap * radius_mm_ / S(2);
    points_[after(k)].share_mm = points_[after(k)].share_mm + gap * radius_mm_ / S(2);
  }

  template <class Row, class Dots>
  void find_misplaced(const Dots& side_dots_mm, RimPulls<S>& out) const {
    out.misplaced = out.below = 0;
    out.carried_mm = S(0);
    Index near = 0;
    for (const Place& place : points_) {
      const auto away = [&](Index row) {
        return spatial_dot<S>(side_dots_mm(row, place.column)) - place.point.border;
      };
      const Point3<S> first = away(0), last = away(Row::rows - 1);
      if (!is_finite(squared_norm(first)) || !is_finite(squared_norm(last))) {
        continue;  // missing
      }
      const S& length = place.point.length_mm;
      const S carried = dot(first, place.point.tangent);
      // no membrane stretches tenfold or is sheared by more than a half
      const S most = S(10) * length;
      const S aside = place.share_mm > length ? place.share_mm / S(2) : length / S(2);
      if (!(squared_norm(first) < most * most) || squared_norm(last) < squared_norm(first) ||
          carried > aside || -carried > aside) {
        ++out.misplaced;
        continue;
      }
      ++near;
      out.carried_mm += carried;
      out.below += value(first.z) < 0 ? 1 : 0;
    }
    out.carried_mm = near > 0 ? S(out.carried_mm / S(static_cast<double>(near))) : S(0);
  }

  template <class Row, class Law, class Dots>
  RimPull<S> pull_at(const Place& place,
                     const Dots& side_dots_mm,
                     const Row& row,
                     const Law& law,
                     const S& load_per_mm,
                     Point3<S>& along) const {
    Point3<S> dot[Row::rows];
    for (Index r = 0; r < Row::rows; ++r) {
      dot[r] = spatial_dot<S>(side_dots_mm(r, place.column));
      if (!is_finite(dot[r])) {
        return {};
      }
    }
    along = row.along(place.point, dot, load_per_mm, mooney_share_of<S>(law));
    // no membrane stretches tenfold: it is another dot
    if (!(value(squared_norm(along)) < 100)) {
      return {};
    }
    return law.pull(along, place.point.tangent);
  }

  void fill_gaps(std::vector<RimPull<S>>& dots) const {
    const std::size_t n = dots.size();
    for (std::size_t k = 0; k < n; ++k) {
      if (dots[k].status == RimPullStatus::ok) {
        continue;
      }
      std::size_t left = 1, right = 1;
      while (dots[(k + n - left) % n].status != RimPullStatus::ok && left < n) {
        ++left;
      }
      while (dots[(k + right) % n].status != RimPullStatus::ok && right < n) {
        ++right;
      }
      const std::size_t from = (k + n - left) % n, to = (k + right) % n;
      const Point3<S> a = rotated(from, k, dots[from].pull);
      const Point3<S> b = rotated(to, k, dots[to].pull);
      const S share = S(static_cast<double>(left)) / S(static_cast<double>(left + right));
      dots[k].pull = a + share * (b - a);
    }
  }

  /// A vector at point `from`, rotated about the axis to point `to`.
  Point3<S> rotated(std::size_t from, std::size_t to, const Point3<S>& p) const {
    const Point3<S>& e = points_[from].point.tangent;
    const Point3<S>& f = points_[to].point.tangent;
    const S along = dot(p, e);
    const S out = p.x * e.y - p.y * e.x;  // the radius is the tangent rotated by -90 degrees
    return {S(along * f.x + out * f.y), S(along * f.y - out * f.x), p.z};
  }

  S radius_mm_;
  Index segments_;
  std::vector<Place> points_;
  std::vector<Weight> weights_;
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
