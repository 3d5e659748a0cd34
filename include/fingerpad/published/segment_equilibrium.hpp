// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The six-axis force as printed. Source: Ito, Kim, Obinata, "Multi-axis force measurement based on
// vision-based fluid-type hemispherical tactile sensor" (2011), III.C to III.F; misprints:
// docs/errata.md, E025-E027; what the method loses: E043-E046.
//
// n lines B(i) run from the rim up the membrane, perpendicular to its contour lines, to A_g, where
// it touches the object or is level. Contour lines at every delta_z cut them into m'(i) parts; the
// last ends at A_g. So M(i, j) lies between B(i) and B(i + 1), from contour j to j + 1. On its
// borders act f_v and tau_v (below and above, across and along the contour), f_h and tau_h (left
// and right), and on its area the pressure. Of each pass:
//   1. eq. 12 for the lines i_0 that end level (eq. 11): f_v(i_0, 1)
//   2. eq. 6 on M(i_0, j) in order of j: f_v(i_0, j + 1), then f_h(i_0, j) and f_h(i_0 + 1, j)
//   3. eq. 6 on M(i, j) of the other lines, from i_0 around, with the level part of f_h (eq. 10):
//      f_h(i + 1, j) from f_h(i, j)
//   4. eq. 9 with these f_h: f_v(i, 1) of the other lines
//   5. eq. 3: the pull at the rim has the direction of the side dots: tau_v(i, 1); then upward
//      eq. 8, tau_h = (tau_v left + tau_v right) / 2, and eq. 7, tau_v of the next contour
//      = tau_h left + tau_h right - tau_v
// The paper leaves open how many passes there are, how long a step along a line is, and where the
// inclination of the object is read: the options of these names. Where lines do not end level, the
// error of f_h propagates from line to line: over tilted or curved objects the result is far off or
// diverges.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace published {

template <scalar S = double>
struct SegmentEquilibriumOptions {
  S base_radius_mm = S(18.735);  ///< > 0
  S delta_z_mm = S(0.2);         ///< height between contour lines, > 0
  Index contours = 70;           ///< in [2, 1000]; the last part of a longer line takes the rest
  int passes = 5;                ///< in [1, 100]
  S step_mm = S(0.1);            ///< along a line, in [radius / 10000, radius]
  S inside_mm = S(1);  ///< the inclination of the object is read this far inside the contact, >= 0
};

/// The refusal of the first value that is out of range; "" if all are good.
template <scalar S>
std::string check(const SegmentEquilibriumOptions<S>& o) {
  const double radius = static_cast<double>(value(o.base_radius_mm));
  return fingerpad::check("published::SegmentEquilibriumOptions",
                          {{"base_radius_mm", o.base_radius_mm, positive},
                           {"delta_z_mm", o.delta_z_mm, positive},
                           {"contours", o.contours, within(2, 1000)},
                           {"passes", o.passes, within(1, 100)},
                           {"step_mm", o.step_mm, within(radius / 10000, radius)},
                           {"inside_mm", o.inside_mm, not_negative}});
}

/// What the object exerts on the pad, the moment about the center of the base; 0 where the membrane
/// touches nothing. NaN where the grid of side dots has another size, a side dot is missing or not
/// above the base, the pressure is not above 0, a line runs into a hole and does not leave it, no
/// line ends level, or the iteration diverges.
template <scalar S = double>
struct [[nodiscard]] SegmentResult {
  Point3<S> force_n = detail::missing_point<S>();
  Point3<S> moment_n_mm = detail::missing_point<S>();

  bool ok() const { return is_finite(force_n) && is_finite(moment_n_mm); }
};

/// One object per thread. A frame allocates nothing, and takes O(lines contours passes) time.
template <scalar S = double>
class SegmentEquilibrium {
 public:
  /// `border_mm`: one row of 6 or more points of the rim in the order of the angle, one for each
  /// side dot; a line starts at each (72 in the paper). Refuses bad parameters (parameter_error).
  template <spatial_dot_grid Border>
  explicit SegmentEquilibrium(const Border& border_mm,
                              const SegmentEquilibriumOptions<S>& options = {})
      : o_((require(options), options)), m_(options.contours) {
    const auto border = as_view(border_mm);
    expects(border.rows() == 1 && border.cols() >= 6 && border.cols() <= 100000,
            "published::SegmentEquilibrium", "border columns", border.cols(),
            "in [6, 100000], in one row");
    n_ = border.cols();
    for (Index i = 0; i < n_; ++i) {
      border_.push_back(detail::spatial_dot<S>(cell_t<Border>(border(0, i))));
      expects(is_finite(border_.back()), "published::SegmentEquilibrium", "border point", i,
              "finite");
    }
    const auto count = static_cast<std::size_t>(n_ * (m_ + 1));
    node_.resize(count);
    out_.resize(count);
    area_.resize(count);
    around_.resize(count);
    upward_.resize(count);
    pull_.resize(border_.size());
    end_normal_.resize(border_.size());
    f_v_ = tau_v_ = f_h_ = tau_h_ = std::vector<S>(count, S(0));
  }

  Index lines() const { return n_; }
  /// Node of line i on contour j of the last frame; from j = m'(i) on, its end on A_g.
  const Point3<S>& node(Index i, Index j) const { return node_[at(i, j)]; }
  /// Tension across the left border of M(i, j) in the last frame, N/mm.
  const S& f_h(Index i, Index j) const { return f_h_[at(i, j)]; }

  /// Force and moment of a frame. shape(x, y) has height_mm, along_x and along_y,
  /// shape.in_contact(x, y) says whether the membrane touches the object. `side_dots_mm` has one
  /// row with the columns of the border.
  template <class Shape, spatial_dot_grid Dots>
  SegmentResult<S> operator()(const Shape& shape, const Dots& side_dots_mm, const S& pressure_mpa) {
    const auto dots = as_view(side_dots_mm);
    bool good = dots.rows() == 1 && dots.cols() == n_ && value(pressure_mpa) > 0 &&
                is_plausible(pressure_mpa);
    for (Index i = 0; good && i < n_; ++i) {
      const auto a = detail::spatial_dot<S>(dots(0, i)),
                 b = detail::spatial_dot<S>(dots(0, next(i)));
      // the direction of the pull on M(i, 1): mean of those on both sides
      pull_[index(i)] = (a - border_[index(i)]) + (b - border_[index(next(i))]);
      good = good && is_plausible(a) && value(pull_[index(i)].z) > 0;
    }
    if (!good) {
      return {};
    }
    const Point2<S> middle = middle_of_contact(shape);
    if (!is_finite(middle)) {
      const Point3<S> none = {S(0), S(0), S(0)};
      return {none, none};
    }
    for (Index i = 0; i < n_; ++i) {
      if (!draw_line(shape, middle, i)) {
        return {};
      }
    }
    measure_segments();
    return iterate(pressure_mpa) ? add_up(pressure_mpa) : SegmentResult<S>();
  }

 private:
  /// A border of two segments; both vectors are as long as it.
  struct Border2 {
    Point3<S> along;   ///< from line i to i + 1, or from contour j to j + 1
    Point3<S> normal;  ///< in the membrane, upward or toward line i + 1
  };

  static std::size_t index(Index i) { return static_cast<std::size_t>(i); }
  std::size_t at(Index i, Index j) const { return static_cast<std::size_t>(j * n_ + i); }
  Index next(Index i) const { return i + 1 == n_ ? 0 : i + 1; }
  Index previous(Index i) const { return i == 0 ? n_ - 1 : i - 1; }

  // III.C: the segments

  /// NaN without contact.
  template <class Shape>
  Point2<S> middle_of_contact(const Shape& shape) const {
    constexpr int places = 64;
    Point2<S> middle = {S(0), S(0)};
    int touching = 0;
    for (int k = 0; k < places * places; ++k) {
      const auto place = [&](int of) {
        return (S(2 * of + 1) / S(places) - S(1)) * o_.base_radius_mm;
      };
      const Point2<S> here = {place(k % places), place(k / places)};
      if (shape.in_contact(here.x, here.y)) {
        middle += here;
        ++touching;
      }
    }
    return middle / S(touching);
  }

  /// Follows the gradient from border point i, cutting the line at each contour. Where the shape is
  /// not known the line goes straight on.
  template <class Shape>
  bool draw_line(const Shape& shape, const Point2<S>& middle, Index i) {
    using std::sqrt;
    Point3<S> here = border_[index(i)], last = here;
    Point2<S> way = middle - Point2<S>{here.x, here.y};
    way = way / norm(way);
    Index j = 0;
    node_[at(i, j++)] = here;
    S rise = S(1);
    const S most = S(10) * o_.base_radius_mm / o_.step_mm;
    for (S step = S(0); step < most; step = step + S(1)) {
      const S plan = o_.step_mm / sqrt(S(1) + rise * rise);
      here = {last.x + plan * way.x, last.y + plan * way.y, last.z};
      const auto seen = shape(here.x, here.y);
      const Point2<S> slope = {S(seen.along_x), S(seen.along_y)};
      const bool known = is_finite(seen.height_mm) && is_finite(slope);
      here.z = known ? S(seen.height_mm) : last.z;
      const bool over = dot(way, middle - Point2<S>{here.x, here.y}) < S(0);
      const bool touches = known && shape.in_contact(here.x, here.y);
      if (over || touches || (known && here.z < last.z)) {
        const Point2<S> inside = Point2<S>{here.x, here.y} + o_.inside_mm * way;
        const auto object = shape(inside.x, inside.y);
        const Point3<S> normal = {-S(object.along_x), -S(object.along_y), S(1)};
        end_normal_[index(i)] =
            touches && is_finite(normal) ? normalized(normal) : Point3<S>{S(0), S(0), S(1)};
        here = here.z < last.z ? last : here;
        for (; j <= m_; ++j) {
          node_[at(i, j)] = here;
        }
        return known;
      }
      for (; j < m_ && S(static_cast<double>(j)) * o_.delta_z_mm < here.z; ++j) {
        const S share = (S(static_cast<double>(j)) * o_.delta_z_mm - last.z) / (here.z - last.z);
        node_[at(i, j)] = last + share * (here - last);
      }
      rise = known ? norm(slope) : rise;
      way = known && value(rise) > 0 ? slope / rise : way;
      last = here;
    }
    return false;
  }

  void measure_segments() {
    for (Index j = 0; j < m_; ++j) {
      for (Index i = 0; i < n_; ++i) {
        const Index right = next(i);
        area_[at(i, j)] =
            cross(node(right, j + 1) - node(i, j), node(i, j + 1) - node(right, j)) / S(2);
        const S sq = squared_norm(area_[at(i, j)]);
        out_[at(i, j)] = value(sq) > 0 ? normalized(area_[at(i, j)]) : Point3<S>{S(0), S(0), S(0)};
      }
    }
    for (Index i = 0; i < n_; ++i) {
      for (Index j = 0; j <= m_; ++j) {
        // the membrane's normal at a border is the mean of both sides
        const Point3<S> along = node(next(i), j) - node(i, j);
        const Point3<S> out = j == 0   ? out_[at(i, 0)]
                              : j < m_ ? out_[at(i, j)] + out_[at(i, j - 1)]
                                       : end_normal_[index(i)] + end_normal_[index(next(i))];
        around_[at(i, j)] = {along, as_long(cross(out, along), along)};
      }
      for (Index j = 0; j < m_; ++j) {
        const Point3<S> along = node(i, j + 1) - node(i, j);
        const Point3<S> out = out_[at(i, j)] + out_[at(previous(i), j)];
        upward_[at(i, j)] = {along, as_long(cross(along, out), along)};
      }
    }
  }

  /// `direction` scaled to the length of `like`; 0 stays 0.
  static Point3<S> as_long(const Point3<S>& direction, const Point3<S>& like) {
    using std::sqrt;
    const S from = squared_norm(direction);
    return value(from) > 0 ? sqrt(squared_norm(like) / from) * direction
                           : Point3<S>{S(0), S(0), S(0)};
  }

  // III.D to III.F: the iteration

  bool iterate(const S& p) {
    for (std::vector<S>* tensions : {&f_v_, &tau_v_, &f_h_, &tau_h_}) {
      tensions->assign(tensions->size(), S(0));
    }
    Index first = 0;
    while (first < n_ && !ends_level(first)) {
      ++first;
    }
    for (int pass = 0; pass < o_.passes && first < n_; ++pass) {
      for (Index k = 0; k < n_; ++k) {
        const Index i = (first + k) % n_;
        ends_level(i) ? balance_level(i, p) : balance_other(i, p);
      }
      for (Index i = 0; i < n_; ++i) {  // eq. 3
        const Point3<S>& pull = pull_[index(i)];
        tau_v_[at(i, 0)] = f_v_[at(i, 0)] * dot(pull, around_[at(i, 0)].along) /
                           dot(pull, around_[at(i, 0)].normal);
      }
      for (Index j = 0; j < m_; ++j) {
        for (Index i = 0; i < n_; ++i) {  // eq. 8
          tau_h_[at(i, j)] = (tau_v_[at(previous(i), j)] + tau_v_[at(i, j)]) / S(2);
        }
        for (Index i = 0; i < n_; ++i) {  // eq. 7
          tau_v_[at(i, j + 1)] = tau_h_[at(i, j)] + tau_h_[at(next(i), j)] - tau_v_[at(i, j)];
        }
      }
    }
    return first < n_;
  }

  /// Whether f_v has no vertical part at the end of column i, up to a tenth (eq. 11).
  bool ends_level(Index i) const {
    const Point3<S>& up = around_[at(i, m_)].normal;
    return S(100) * up.z * up.z < squared_norm(up);
  }

  /// Force on M(i, j) of what is known: pressure and shear (eq. 6).
  Point3<S> known(Index i, Index j, const S& p) const {
    return p * area_[at(i, j)] + tau_v_[at(i, j + 1)] * around_[at(i, j + 1)].along -
           tau_v_[at(i, j)] * around_[at(i, j)].along +
           tau_h_[at(next(i), j)] * upward_[at(next(i), j)].along -
           tau_h_[at(i, j)] * upward_[at(i, j)].along;
  }

  /// Steps 1 and 2.
  void balance_level(Index i, const S& p) {
    S load = S(0);
    for (Index j = 0; j < m_; ++j) {
      load += known(i, j, p).z;
    }
    f_v_[at(i, 0)] = load / around_[at(i, 0)].normal.z;
    climb(i, p);
    for (Index j = 0; j < m_; ++j) {
      const Point3<S>&a = upward_[at(i, j)].normal, &b = upward_[at(next(i), j)].normal;
      const Point3<S> r = f_v_[at(i, j + 1)] * around_[at(i, j + 1)].normal -
                          f_v_[at(i, j)] * around_[at(i, j)].normal + known(i, j, p);
      // f_h(i) a - f_h(i + 1) b = r, along x and y
      const S determinant = a.y * b.x - a.x * b.y;
      const S left = (r.y * b.x - r.x * b.y) / determinant;
      const S right = (r.y * a.x - r.x * a.y) / determinant;
      f_h_[at(i, j)] = is_finite(left) ? left : S(0);
      f_h_[at(next(i), j)] = is_finite(right) ? right : S(0);
    }
  }

  /// Step 2, f_v(i, j + 1) from f_v(i, j): eq. 6 along z in order of j.
  void climb(Index i, const S& p) {
    S load = f_v_[at(i, 0)] * around_[at(i, 0)].normal.z;
    for (Index j = 0; j < m_; ++j) {
      load = load - known(i, j, p).z;
      f_v_[at(i, j + 1)] = load / around_[at(i, j + 1)].normal.z;
    }
  }

  /// Steps 3 and 4.
  void balance_other(Index i, const S& p) {
    const auto level = [](const Point3<S>& v) { return Point3<S>{v.x, v.y, S(0)}; };  // eq. 10
    Point3<S> sum = {S(0), S(0), S(0)};
    for (Index j = 0; j < m_; ++j) {
      if (!(value(squared_norm(area_[at(i, j)])) > 0)) {
        continue;
      }
      const S left = f_h_[at(i, j)];
      const Point3<S> r = known(i, j, p) - left * level(upward_[at(i, j)].normal);
      const Point3<S> b = level(upward_[at(next(i), j)].normal);
      // f_v(i, j + 1) up - f_v(i, j) low + f_h(i + 1, j) b = -r, without both f_v
      const Point3<S> axis = cross(around_[at(i, j + 1)].normal, around_[at(i, j)].normal);
      const S found = -dot(r, axis) / dot(b, axis);
      f_h_[at(next(i), j)] = is_finite(found) ? found : left;
      sum += r + f_h_[at(next(i), j)] * b;
    }
    // eq. 9: f_v(i, 1) low - f_v(i, m' + 1) up = sum
    const Point3<S>&low = around_[at(i, 0)].normal, &up = around_[at(i, m_)].normal;
    const S ll = squared_norm(low), lu = dot(low, up), uu = squared_norm(up);
    f_v_[at(i, 0)] = (uu * dot(sum, low) - lu * dot(sum, up)) / (ll * uu - lu * lu);
    climb(i, p);
  }

  /// Eqs. 3 to 5: the vertical part of each pull is that of f_v, its direction that of the dots.
  SegmentResult<S> add_up(const S& p) const {
    S all = S(0);
    for (const Point3<S>& area : area_) {
      all += p * area.z;
    }
    Point3<S> force = {S(0), S(0), S(0)}, moment = force;
    for (Index i = 0; i < n_; ++i) {
      const S load = f_v_[at(i, 0)] * around_[at(i, 0)].normal.z;
      if (!(load < all && -load < all)) {  // a single line cannot carry the load of all
        return {};
      }
      const Point3<S> pull = load / pull_[index(i)].z * pull_[index(i)];
      force += pull;
      moment += cross((border_[index(i)] + border_[index(next(i))]) / S(2), pull);
    }
    force.z = force.z - p * S(std::numbers::pi) * o_.base_radius_mm * o_.base_radius_mm;
    return is_plausible(force) && is_plausible(moment) ? SegmentResult<S>{force, moment}
                                                       : SegmentResult<S>();
  }

  SegmentEquilibriumOptions<S> o_;
  Index n_ = 0, m_;
  std::vector<Point3<S>> border_, pull_, end_normal_;  ///< of each line
  std::vector<Point3<S>> node_, out_, area_;           ///< of M(i, j): first corner, unit normal
  std::vector<Border2> around_, upward_;               ///< lower and left border of M(i, j)
  std::vector<S> f_v_, tau_v_, f_h_, tau_h_;           ///< on them, N/mm
};

}  // namespace published
}  // namespace v1
}  // namespace fingerpad
