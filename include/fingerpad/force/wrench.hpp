// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Force and moment in six axes, from the pressure in the pad, the shape of its membrane and one row
// of side dots near the rim. Source: Ito, Kim, Obinata, "Multi-axis force measurement based on
// vision-based fluid-type hemispherical tactile sensor" (2011); the method as printed is
// published/segment_equilibrium.hpp, what differs is in docs/errata.md, E025-E027 and E043-E046.
//
// The membrane pulls on the base along the rim, and the pressure acts on its area (eqs. 1, 2):
//   F = integral of T ds - p S_base z,    M = integral of b x T ds.
// F and M are what the object exerts on the pad, M about Q, the center of the base: a press gives
// F_z < 0. The side dots give the pull at the rim up to one factor, T = mu t pull. Below the line
// A_g, where the membrane touches the object or is level, only tension and pressure act, so
//   mu t = p (S_base - S_g) / (integral of pull_z ds - lift at A_g).
// Pressure, shape and mu t determine each other: any two of them give the forces. M_x and M_y are
// weighed with those of the force in the middle of A_g, which the noise of the side dots does not
// reach.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/rim_pull.hpp"

namespace fingerpad {
inline namespace v0 {

/// A shape of the membrane, as a function of the position in mm about Q, the center of the base:
///   shape(x, y)             a struct with height_mm and its slopes along_x and along_y, all
///                           finite, or the height NaN
///   shape.in_contact(x, y)  whether the membrane touches the object
template <class T, class S>
concept membrane_shape = requires(const T& shape, const S& x, const S& y) {
  S(shape(x, y).height_mm);
  S(shape(x, y).along_x);
  S(shape(x, y).along_y);
  { shape.in_contact(x, y) } -> std::convertible_to<bool>;
};

template <scalar S = double>
struct WrenchOptions {
  S base_radius_mm = S(18.735);   ///< of the clamped rim, around Q, > 0
  S side_dot_length_mm = S(0.8);  ///< from the rim to its side dot along the stress-free membrane,
                                  ///< > 0, short against the radius
  /// Inclination of the stress-free membrane at the rim, in [0, pi / 2]; of a spherical cap
  /// 2 atan(height / radius). Empty: the pull at the rim is taken for that of the chord to the side
  /// dot, which takes F_xy and M_z by some per cent too small.
  std::optional<double> stress_free_inclination_rad = {};
  S mooney_share = S(0);  ///< C2 / (C1 + C2) of the rubber, in [0, 1]; 0: neo-Hookean
  /// mu t from calibrate/rim.hpp, in [0.005, 50]. Checks that of each frame, and answers frames
  /// whose pressure is not known or whose shape has no level line.
  std::optional<S> modulus_n_per_mm = {};
  S line_step_mm = S(0.4);  ///< step along a line up the membrane, in [radius / 1000, radius / 10]
  /// Membrane nearer than this to the edge of the contact is ignored, >= 0. Choose a node of the
  /// height map plus a quarter of the width over which the depth map was averaged.
  S blur_mm = S(0.6);
  S reach_mm = S(4);  ///< how far beyond blur_mm the inclination is read, >= 4 line_step_mm
  S max_pressure_mpa = S(0.2);  ///< > 0; a higher pressure is taken for kPa or Pa
};

/// The refusal of the first value that is out of range; "" if all are good.
template <scalar S>
std::string check(const WrenchOptions<S>& o) {
  const double radius = static_cast<double>(value(o.base_radius_mm));
  const double step = static_cast<double>(value(o.line_step_mm));
  return check("WrenchOptions",
               {{"base_radius_mm", o.base_radius_mm, positive},
                {"side_dot_length_mm", o.side_dot_length_mm, positive},
                {"stress_free_inclination_rad", o.stress_free_inclination_rad.value_or(0),
                 within(0, 1.5707964)},
                {"mooney_share", o.mooney_share, within(0, 1)},
                {"modulus_n_per_mm", o.modulus_n_per_mm.value_or(S(1)), within(0.005, 50)},
                {"line_step_mm", o.line_step_mm, within(radius / 1000, radius / 10)},
                {"blur_mm", o.blur_mm, not_negative},
                {"reach_mm", o.reach_mm, at_least(4 * step)},
                {"max_pressure_mpa", o.max_pressure_mpa, positive}});
}

enum class WrenchStatus : std::uint8_t {
  ok,
  no_contact,     ///< the membrane touches nothing: force and moment are 0
  bad_pressure,   ///< not above 0, above max_pressure_mpa (in kPa?), or not known and no modulus
  bad_side_dots,  ///< more than a third are missing, unstretched or misplaced (in px? another
                  ///< order?), or together they do not pull upward
  no_shape,       ///< more than a third of the lines up the membrane run into holes, or it is lower
                  ///< than the side dots or higher than the base is wide: not in mm?
  no_level_line,  ///< nowhere between rim and contact is the membrane level, so its shape does not
                  ///< show how much it pulls
  pad_has_changed,  ///< mu t differs from modulus_n_per_mm by more than a factor of 1.5: the
                    ///< membrane or its rim has aged, or the gauge is off; by more than a factor of
                    ///< 3 (absolute pressure? another pad?) there is no force
  refused,          ///< the grid of side dots has another size: nothing was done
};

/// "ok", "no contact", ...
constexpr const char* name_of(WrenchStatus status) {
  constexpr std::array<const char*, 8> names = {
      "ok",       "no contact",    "bad pressure",    "bad side dots",
      "no shape", "no level line", "pad has changed", "refused"};
  return names[static_cast<std::size_t>(status)];
}

/// The six-axis force of a frame. Force and moment are finite where there is a force (see
/// has_force), and NaN elsewhere.
template <scalar S = double>
struct [[nodiscard]] WrenchResult {
  WrenchStatus status = WrenchStatus::refused;
  Point3<S> force_n = detail::missing_point<S>();
  Point3<S> moment_n_mm = detail::missing_point<S>();  ///< about Q
  S pressure_mpa = not_a_number<S>();                  ///< given, or found from shape and modulus
  S modulus_n_per_mm = not_a_number<S>();  ///< mu t, found from shape and pressure, or given
  S summit_area_mm2 = not_a_number<S>();   ///< area within A_g, in plan; NaN if by_modulus
  bool by_modulus = false;  ///< from the given modulus and pressure, without the shape
  SideDotFaults faults;     ///< of the side dots; 0 if they were not looked at

  bool ok() const { return status == WrenchStatus::ok || status == WrenchStatus::no_contact; }
  bool has_force() const { return is_finite(force_n); }
  /// The force with which the object presses, positive as in the look-ups, and the force along the
  /// pad.
  S normal_force_n() const { return -force_n.z; }
  Point2<S> tangential_force_n() const { return {force_n.x, force_n.y}; }
};

/// Finds the six-axis force of a pad. One object per thread: a frame changes its memory. A frame
/// allocates nothing, throws nothing, and takes O(side dots radius / line_step_mm) time.
template <scalar S = double>
class Wrench {
 public:
  /// `border_mm`: one row of 6 or more points of the rim, one for each side dot, in any order, at
  /// most 5 % off the circle. Refuses bad parameters (parameter_error).
  template <spatial_dot_grid Border>
  explicit Wrench(const Border& border_mm, const WrenchOptions<S>& options = {})
      : Wrench(
            border_mm, [&](Index) { return options.side_dot_length_mm; }, options) {}

  /// The same with the stress-free length of each side dot in mm, side_dot_length_mm(column), as
  /// from calibrate/rim.hpp.
  template <spatial_dot_grid Border, class Length>
    requires(std::invocable<const Length&, Index>)
  Wrench(const Border& border_mm,
         const Length& side_dot_length_mm,
         const WrenchOptions<S>& options = {})
      : options_((require(options), options)),
        rim_("Wrench", border_mm, side_dot_length_mm, options.base_radius_mm),
        lines_(rim_.size()),
        whole_(rim_.size()),
        summit_(rim_.size(), detail::missing_point<S>()),
        normal_(summit_),
        rough_(rim_.size()) {}

  Index side_dots() const { return static_cast<Index>(rim_.size()); }
  const WrenchOptions<S>& options() const { return options_; }
  /// Pull of the membrane on the base at the border point of a column in the last frame, N/mm; NaN
  /// if it had no force.
  Point3<S> rim_tension(Index column) const { return modulus_ * rim_.pull(rim_.place(column)); }

  /// Force and moment of a frame. `shape` is the membrane (the map of PadHeights, or any
  /// membrane_shape). `side_dots_mm` has one row with the columns of the border; NaN: not found.
  /// `pressure_mpa` is the pressure above that of the air; NaN: not known, found by the modulus.
  template <class Shape, spatial_dot_grid Dots>
    requires(membrane_shape<Shape, S>)
  WrenchResult<S>
  operator()(const Shape& shape, const Dots& side_dots_mm, const S& pressure_mpa) {
    return solved(as_view(side_dots_mm), pressure_mpa, [&] { return find_summit(shape); });
  }

  /// The same without a shape: the modulus of the options turns the pulls at the rim into forces;
  /// without it the frame is refused. F_z is the small difference of pull and pressure, so the
  /// modulus must be fresh and the inclination of the stress-free rim given.
  template <spatial_dot_grid Dots>
  WrenchResult<S> by_modulus(const Dots& side_dots_mm, const S& pressure_mpa) {
    if (!options_.modulus_n_per_mm) {
      modulus_ = not_a_number<S>();
      return {};
    }
    const S given = pressure_mpa == pressure_mpa ? pressure_mpa : S(0);
    return solved(as_view(side_dots_mm), given, [] { return WrenchStatus::no_level_line; });
  }

 private:
  /// A line from the rim toward the middle of the contact, and the free membrane beside the edge of
  /// the contact in sums for a fit of its lean: r sin(inclination) less that of the object at the
  /// edge. The rows are (1, rho, rho beside, lean), rho = r^2 - edge^2, beside = r - edge.
  struct Line {
    Point2<S> outward;  ///< unit vector from the middle to the rim
    S length, edge;     ///< from the middle to the rim, to where the contact begins; 0: a summit
    S sums[4][4], lean_beside;
  };

  /// Solves the frame from two of shape, pressure and modulus. `find` finds the line A_g.
  template <class Dots, class Find>
  WrenchResult<S> solved(const Dots& dots, const S& pressure_mpa, const Find& find) {
    WrenchResult<S> result;
    modulus_ = not_a_number<S>();
    if (dots.rows() != 1 || dots.cols() != side_dots()) {
      return result;
    }
    const bool gauged = !(pressure_mpa != pressure_mpa), calibrated(options_.modulus_n_per_mm);
    result.status = WrenchStatus::bad_pressure;
    if (gauged ? !is_pressure(pressure_mpa) : !calibrated) {
      return result;
    }
    result.status = find();
    result.by_modulus = result.status == WrenchStatus::no_level_line && gauged && calibrated;
    if (result.status == WrenchStatus::no_contact) {
      result.force_n = result.moment_n_mm = {S(0), S(0), S(0)};
    }
    if (result.status != WrenchStatus::ok && !result.by_modulus) {
      return result;
    }
    result.status = WrenchStatus::bad_side_dots;
    if (!rim_.read(dots, result.faults)) {
      return result;
    }
    if (result.by_modulus) {
      find_pulls(pressure_mpa / *options_.modulus_n_per_mm);
      add_up(pressure_mpa, *options_.modulus_n_per_mm, result);
      return result;
    }
    result.summit_area_mm2 = summit_area_;
    const S load = balanced_load();
    if (value(load) > 0) {
      const S modulus = gauged ? pressure_mpa / load : *options_.modulus_n_per_mm;
      add_up(gauged ? pressure_mpa : modulus * load, modulus, result);
    }
    return result;
  }

  bool is_pressure(const S& mpa) const {
    return value(mpa) > 0 && !(mpa > options_.max_pressure_mpa);
  }
  void find_pulls(const S& load_per_mm) {
    rim_.find_pulls(options_.stress_free_inclination_rad, options_.mooney_share, load_per_mm);
  }
  S base_area_mm2() const {
    return S(std::numbers::pi) * options_.base_radius_mm * options_.base_radius_mm;
  }

  /// p / (mu t) at which the rim carries the pressure on the membrane below A_g. Where A_g is not
  /// level, the membrane above pulls up or down with about the tension of the rim.
  S balanced_load() {
    const S free_area = base_area_mm2() - summit_area_;
    S load = S(0);
    for (int pass = 0; pass < (options_.stress_free_inclination_rad ? 2 : 1); ++pass) {
      find_pulls(load);
      S lift = S(0);
      for (std::size_t k = 0; k < rim_.size(); ++k) {
        const Point3<S> along = (summit_[rim_.after(k)] - summit_[rim_.before(k)]) / S(2);
        const Point3<S> inward = cross(normal_[k], along);
        const S flat = squared_norm(inward);
        const Point3<S>& pull = rim_.pull(k);
        lift += options_.base_radius_mm * rim_.gap_rad(k) * pull.z;
        if (value(flat) > 0) {
          lift = lift - norm(pull) * norm(along) / norm(inward) * inward.z;
        }
      }
      load = value(free_area) > 0 ? lift / free_area : S(0);
      if (!(value(load) > 0)) {
        break;
      }
    }
    return load;
  }

  /// Sums force and moment over the rim, eqs. 4 and 5.
  void add_up(const S& pressure_mpa, const S& modulus, WrenchResult<S>& result) {
    Point3<S> force = {S(0), S(0), -pressure_mpa * base_area_mm2()}, moment = {S(0), S(0), S(0)};
    for (std::size_t k = 0; k < rim_.size(); ++k) {
      const Point3<S> pull = (modulus * options_.base_radius_mm * rim_.gap_rad(k)) * rim_.pull(k);
      force += pull;
      moment += cross(rim_.border(k), pull);
    }
    if (!is_pressure(pressure_mpa) || !is_plausible(force) || !is_plausible(moment)) {
      result.status =
          is_pressure(pressure_mpa) ? WrenchStatus::bad_side_dots : WrenchStatus::bad_pressure;
      return;
    }
    const S ratio = options_.modulus_n_per_mm ? modulus / *options_.modulus_n_per_mm : S(1);
    const auto is_within = [&](double times) {
      return ratio < S(times) && S(1) < S(times) * ratio;
    };
    result.status = is_within(1.5) ? WrenchStatus::ok : WrenchStatus::pad_has_changed;
    result.modulus_n_per_mm = modulus;
    result.pressure_mpa = pressure_mpa;
    if (is_within(3)) {
      modulus_ = modulus;
      result.force_n = force;
      result.moment_n_mm = result.by_modulus ? moment : weighed_moment(force, moment);
    }
  }

  /// M_x and M_y of the rim, weighed with those of the force in the middle of the patch inside A_g,
  /// which also turns it about its normal. The lever of the patch is wrong by about a fifth of its
  /// length and 0.008 of the radius. The noise of the rim follows from the third differences of its
  /// upward pulls: their median, so that a contact near the rim does not count.
  Point3<S> weighed_moment(const Point3<S>& force, const Point3<S>& of_rim) {
    using std::sqrt;
    const std::size_t n = rim_.size();
    Point3<S> area = {S(0), S(0), S(0)}, middle = area;
    for (std::size_t k = 0; k < n; ++k) {
      const Point3<S>&a = summit_[k], &b = summit_[rim_.after(k)];
      const S corner = a.x * b.y - a.y * b.x;
      area += cross(a, b) / S(2);
      middle += corner * Point3<S>{(a.x + b.x) / S(3), (a.y + b.y) / S(3), (a.z + b.z) / S(2)};
      const std::size_t next = rim_.after(rim_.after(k));
      rough_[k] = rim_.pull(k).z - rim_.pull(rim_.after(next)).z +
                  S(3) * (rim_.pull(next).z - rim_.pull(rim_.after(k)).z);
      rough_[k] = value(rough_[k]) < 0 ? -rough_[k] : rough_[k];
    }
    if (!(value(area.z) > 0)) {
      return of_rim;
    }
    middle = middle / (S(2) * area.z);
    Point3<S> of_patch = cross(middle, force);
    of_patch = of_patch + ((of_rim.z - of_patch.z) / area.z) * area;
    const auto median = rough_.begin() + static_cast<std::ptrdiff_t>(n / 2);
    std::nth_element(rough_.begin(), median, rough_.end(),
                     [](const S& a, const S& b) { return value(a) < value(b); });
    // of normal noise the median is 0.6745 sd, and the third difference has sqrt(20) times its sd
    const S noise = *median / S(0.6745 * std::sqrt(20.0));
    const S radius = options_.base_radius_mm;
    const S rim_sq = square(modulus_ * square(radius) * S(2 * std::numbers::pi) * noise) /
                     S(2 * static_cast<double>(n));
    const S patch_sq = squared_norm(force) * (S(0.04) * (square(middle.x) + square(middle.y)) +
                                              square(S(0.008) * radius));
    const S share = patch_sq + rim_sq > S(0) ? patch_sq / (patch_sq + rim_sq) : S(1);
    return {of_patch.x + share * (of_rim.x - of_patch.x),
            of_patch.y + share * (of_rim.y - of_patch.y), of_rim.z};
  }

  // The line A_g.

  /// Finds A_g on the line from each border point to the middle of the contact, and its area.
  template <class Shape>
  WrenchStatus find_summit(const Shape& shape) {
    Point2<S> middle = {S(0), S(0)};
    bool has_height = false;
    const int touching = find_contact(shape, middle, has_height);
    if (touching == 0) {  // without any height, it is not known whether there is a contact
      return has_height ? WrenchStatus::no_contact : WrenchStatus::no_shape;
    }
    S bend = S(0), rise = S(0);
    std::size_t whole = 0, level = 0;
    for (std::size_t k = 0; k < rim_.size(); ++k) {
      whole_[k] = climb(shape, middle, k);
      whole += whole_[k];
      level += whole_[k] != 0 && is_level(k) ? 1U : 0U;
      if (whole_[k] != 0) {
        add_growth(lines_[k], bend, rise);
      }
    }
    if (3 * whole < 2 * rim_.size()) {
      return WrenchStatus::no_shape;
    }
    if (level == 0) {
      return WrenchStatus::no_level_line;
    }
    // the tension grows outward by g per mm, the same on all lines; more is noise
    const S most = S(0.05);
    S growth = value(rise) == 0 ? S(0) : -bend / rise;
    growth = growth > most ? most : growth < -most ? -most : growth;
    S top = S(0);
    for (std::size_t k = 0; k < rim_.size(); ++k) {
      if (whole_[k] != 0 && value(lines_[k].edge) > 0) {
        const Point3<S> end = point_on(shape, middle, lines_[k], edge_of(lines_[k], growth));
        summit_[k] = is_finite(end) ? end : summit_[k];
      }
      top = whole_[k] != 0 && summit_[k].z > top ? summit_[k].z : top;
    }
    if (!(top > options_.side_dot_length_mm / S(2)) || top > S(2) * options_.base_radius_mm) {
      return WrenchStatus::no_shape;
    }
    rim_.fill(whole_, summit_);
    rim_.fill(whole_, normal_);
    using std::sin;
    S polygon = S(0), circle = S(0);  // A_g and rim are round: chords miss a part of both
    for (std::size_t k = 0; k < rim_.size(); ++k) {
      const Point3<S>&a = summit_[k], &b = summit_[rim_.after(k)];
      polygon += (a.x * b.y - a.y * b.x) / S(2);
      circle += sin(rim_.gap_after(k));
    }
    summit_area_ = S(2 * std::numbers::pi) / circle * polygon;
    return WrenchStatus::ok;
  }

  /// Follows the membrane from border point k to the middle of the contact until it is level or
  /// touches. False if it runs into a hole.
  template <class Shape>
  bool climb(const Shape& shape, const Point2<S>& middle, std::size_t k) {
    using std::sqrt;
    Line& line = lines_[k];
    line = {};
    const Point2<S> out = Point2<S>{rim_.border(k).x, rim_.border(k).y} - middle;
    line.length = norm(out);
    if (!(line.length > S(1e-6))) {
      return false;
    }
    line.outward = out / line.length;
    const auto at = [&](const S& r) {
      return shape(middle.x + r * line.outward.x, middle.y + r * line.outward.y);
    };
    const auto touches = [&](const S& r) {
      return shape.in_contact(middle.x + r * line.outward.x, middle.y + r * line.outward.y);
    };
    // a map has no slope at its border
    S r = line.length - options_.line_step_mm / S(4);
    for (int step = 0; step < 40 && !is_finite(at(r).along_x); ++step) {
      r = r - options_.line_step_mm / S(4);
    }
    S outer = line.length, outer_rise = S(0);
    const S most = S(8) * options_.base_radius_mm / options_.line_step_mm;
    for (S step = S(0); step < most; step += S(1)) {
      const auto here = at(r);
      if (!is_finite(here.height_mm)) {
        return false;
      }
      const Point2<S> slope = known_slope(here);
      const S rise = -dot(slope, line.outward);
      if (value(r) >= 0 && touches(r)) {
        line.edge = r;
        summit_[k] = point_on(shape, middle, line, r);
        const S inside = r - options_.blur_mm - S(1);
        const Point2<S> object = known_slope(at(value(inside) > 0 ? inside : S(0)));
        normal_[k] = {-object.x, -object.y, S(1)};
        add_samples(at, touches, -dot(object, line.outward), line);
        return true;
      }
      if (value(rise) < 0 || value(r) < 0) {  // a summit: cut where the rise is 0
        const S share = outer_rise / (outer_rise - rise);
        const bool between = share >= S(0) && share <= S(1) && value(outer_rise) != 0;
        summit_[k] = point_on(shape, middle, line, between ? outer + share * (r - outer) : r);
        normal_[k] = {-(slope.x + rise * line.outward.x), -(slope.y + rise * line.outward.y), S(1)};
        return is_finite(summit_[k]);
      }
      outer = r;
      outer_rise = rise;
      r = r - options_.line_step_mm / sqrt(S(1) + rise * rise);
    }
    return false;
  }

  template <class Slopes>
  static Point2<S> known_slope(const Slopes& here) {
    const Point2<S> slope = {S(here.along_x), S(here.along_y)};
    return is_finite(slope) ? slope : Point2<S>{S(0), S(0)};
  }
  static S sine(const S& rise) {
    using std::sqrt;
    return rise / sqrt(S(1) + rise * rise);
  }
  template <class Shape>
  static Point3<S> point_on(const Shape& shape,
                            const Point2<S>& middle,
                            const Line& line,
                            const S& r) {
    const Point2<S> at = middle + r * line.outward;
    return {at.x, at.y, S(shape(at.x, at.y).height_mm)};
  }

  /// Whether the membrane is level at the end of line k, along the line: at a summit, or at the
  /// edge of an object that is.
  bool is_level(std::size_t k) const {
    const S rise = dot(Point2<S>{normal_[k].x, normal_[k].y}, lines_[k].outward);
    return rise * rise < S(0.01);
  }

  template <class At, class Touches>
  void add_samples(const At& at, const Touches& touches, const S& object_rise, Line& line) const {
    const S step = options_.line_step_mm / S(2), end = options_.blur_mm + options_.reach_mm;
    for (S beside = options_.blur_mm + step / S(2);
         beside < end && line.edge + beside < line.length; beside = beside + step) {
      const S r = line.edge + beside, rho = beside * (r + line.edge);
      const auto here = at(r);
      const Point2<S> slope = {S(here.along_x), S(here.along_y)};
      if (!is_finite(here.height_mm) || !is_finite(slope) || touches(r)) {
        continue;
      }
      const S lean = r * sine(-dot(slope, line.outward)) - line.edge * sine(object_rise);
      const S row[4] = {S(1), rho, rho * beside, lean};
      for (std::size_t n = 0; n < 16; ++n) {
        line.sums[n / 4][n % 4] += row[n / 4] * row[n % 4];
      }
      line.lean_beside += lean * beside;
    }
  }

  /// Adds the fit lean = a + b rho + c rho beside of a line to the sums of c and b: g = - c / b.
  static void add_growth(const Line& l, S& bend, S& rise) {
    const S n = l.sums[0][0];
    if (value(n) < 6) {
      return;
    }
    const auto about_mean = [&](std::size_t i, std::size_t j) {
      return l.sums[i][j] - l.sums[0][i] * l.sums[0][j] / n;
    };
    const S xx = about_mean(1, 1), xy = about_mean(1, 2), yy = about_mean(2, 2);
    const S x = about_mean(1, 3), y = about_mean(2, 3);
    const S determinant = xx * yy - xy * xy;
    if (determinant > S(1e-10) * xx * yy) {
      rise += (x * yy - y * xy) / determinant;
      bend += (y * xx - x * xy) / determinant;
    }
  }

  /// Where the contact ends: a smoothed depth map blurs its edge, so it is extrapolated from the
  /// free membrane beside it. The vertical balance between the edge r_g and r is
  ///   p (r^2 - r_g^2) / 2 = T r sin(inclination),   T growing as 1 + g (r - r_g),
  /// so lean (1 + g beside) is a straight line over r^2 that is 0 at r_g^2. The lean is noisy and
  /// r^2 is exact, so lean is fitted over r^2. The visible edge where both differ by too much.
  S edge_of(const Line& l, const S& growth) const {
    using std::sqrt;
    const S n = l.sums[0][0], rho = l.sums[0][1], rho_sq = l.sums[1][1];
    const S lean = l.sums[0][3] + growth * l.lean_beside;
    const S lean_rho = l.sums[1][3] + growth * l.sums[2][3];
    const S found_sq =
        square(l.edge) - (rho_sq * lean - rho * lean_rho) / (n * lean_rho - rho * lean);
    const S found = value(n) >= 3 && value(found_sq) > 0 ? sqrt(found_sq) : l.edge;
    const S most = options_.blur_mm + S(1);
    const bool near = found > l.edge - most && found < l.edge + most && found < l.length;
    return near ? found : l.edge;
  }

  /// Number of positions in contact of a 64 x 64 mesh over the base, their middle, and whether the
  /// shape is known at any.
  template <class Shape>
  int find_contact(const Shape& shape, Point2<S>& middle, bool& has_height) const {
    const S step = options_.base_radius_mm / S(32);
    int count = 0;
    for (int k = 0; k < 64 * 64; ++k) {
      const Point2<S> at = {(S(k % 64) - S(31.5)) * step, (S(k / 64) - S(31.5)) * step};
      has_height = has_height || is_finite(shape(at.x, at.y).height_mm);
      if (shape.in_contact(at.x, at.y)) {
        middle += at;
        ++count;
      }
    }
    middle = middle / S(count > 0 ? count : 1);
    return count;
  }

  WrenchOptions<S> options_;
  detail::membrane::Rim<S> rim_;
  std::vector<Line> lines_;
  std::vector<unsigned char> whole_;  ///< lines without a hole
  std::vector<Point3<S>> summit_;     ///< where each line ends
  std::vector<Point3<S>> normal_;     ///< there: of the object at an edge, else of the membrane
  std::vector<S> rough_;              ///< third differences of the pulls, unordered
  S summit_area_ = S(0);
  S modulus_ = not_a_number<S>();  ///< of the last frame with a force
};

template <spatial_dot_grid Border>
Wrench(const Border&) -> Wrench<double>;

}  // namespace v0
}  // namespace fingerpad
