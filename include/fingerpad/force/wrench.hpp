// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Force and moment in six axes, from the pressure in the pad, the shape of its membrane and the
// side dots near the rim. Source: Ito, Kim, Obinata, "Multi-axis force measurement based on
// vision-based fluid-type hemispherical tactile sensor" (2011); published and corrected forms in
// docs/errata.md, E025-E027 and E043-E046.
//
// The membrane pulls on the base along the rim, and the pressure acts on its area (eqs. 1, 2):
//   F = integral of T ds - p S_base z,    M = integral of b x T ds.
// F and M are what the object exerts on the pad, M about Q, the center of the base: a press gives
// F_z < 0. The side dots give the direction of the membrane's pull (force/rim_traction.hpp). Its
// magnitude follows from the balance of the membrane between the rim and the line A_g where it
// touches the object or is level: below that line only tension and pressure act.
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/compartments.hpp"
#include "fingerpad/force/detail/noise.hpp"
#include "fingerpad/force/detail/rim.hpp"
#include "fingerpad/force/detail/segments.hpp"
#include "fingerpad/force/detail/tensions.hpp"
#include "fingerpad/force/least_squares.hpp"
#include "fingerpad/force/rim_balance.hpp"
#include "fingerpad/force/rim_traction.hpp"
#include "fingerpad/force/wrench_options.hpp"

namespace fingerpad {
inline namespace v0 {

/// Finds the six-axis force.
///   Solver  LeastSquares  use it if you also need the tensions inside the membrane
///           BalancedRim   use it for force and moment only: as good, 15 times as fast
///   Row     OneRow        use it for one row of side dots
///           TwoRows       use it for two rows, which give d at the rim itself
/// ClampedRim is the pull of a clamped rubber rim. StraightLines do not crowd together on a summit
/// that is not level. published/wrench.hpp has other laws and lines, and the whole method as
/// printed. If the shape is not known, use by_modulus().
///
/// Threads may share one estimator, each with its own workspace. A frame allocates nothing, throws
/// nothing, and takes O(columns rows) time, with LeastSquares O((columns rows)^1.5).
template <class Solver = LeastSquares,
          class Row = OneRow,
          class Law = ClampedRim,
          class Lines = StraightLines,
          scalar S = double>
class Wrench {
  static_assert(
      !scalar<Solver>,
      "the scalar comes last: Wrench<LeastSquares, OneRow, ClampedRim, StraightLines, double>");

 public:
  /// Scratch memory for a frame; one per thread. After a frame it holds the mesh and the tensions
  /// from which the forces were computed.
  class Workspace {
   public:
    /// Points of the rim, in the order of the angle, and the membrane's pull on the base there in
    /// N/mm; NaN without contact, and where the status of the frame gives no force.
    Index rim_points() const { return static_cast<Index>(tension_.size()); }
    const Point3<S>& rim_tension(Index k) const { return tension_[static_cast<std::size_t>(k)]; }
    /// Nodes of the mesh: line 0 ... columns - 1, row 0 (rim) ... rows (A_g).
    const Point3<S>& node(Index line, Index row) const { return nodes_.node(line, row); }

   private:
    friend class Wrench;
    Workspace(const Wrench& wrench)
        : pulls_(wrench.rim_.pulls()),
          nodes_(wrench.options_.columns,
                 wrench.options_.rows,
                 wrench.options_.base_radius_mm,
                 {wrench.options_.line_step_mm, wrench.options_.blur_mm, wrench.options_.reach_mm}),
          segments_(wrench.options_.columns, wrench.options_.rows),
          tensions_(wrench.options_.columns, wrench.options_.rows),
          work_(wrench.solver_, wrench.options_.columns, wrench.options_.rows),
          tension_(static_cast<std::size_t>(wrench.rim_.size())) {}

    detail::membrane::RimPulls<S> pulls_;
    detail::membrane::Compartments<S> nodes_;
    detail::membrane::Segments<S> segments_;
    detail::membrane::Tensions<S> tensions_;
    typename Solver::template Work<S> work_;
    std::vector<Point3<S>> tension_;
  };

  /// `border_mm`: one row of 6 or more points of the rim, one for each column of side dots, in any
  /// order, at most 5 % off the circle. Refuses bad parameters (parameter_error).
  template <spatial_dot_grid Border>
  explicit Wrench(const Border& border_mm,
                  const WrenchOptions<S>& options = {},
                  const Solver& solver = {},
                  const Row& row = {},
                  const Law& law = {})
      : Wrench(
            border_mm,
            [&](Index) { return options.side_dot_length_mm; },
            options,
            solver,
            row,
            law) {}

  /// The same with the stress-free length of each side dot in mm, side_dot_length_mm(column), as
  /// from calibrate/rim.hpp.
  template <spatial_dot_grid Border, class Length>
    requires(std::invocable<const Length&, Index>)
  Wrench(const Border& border_mm,
         const Length& side_dot_length_mm,
         const WrenchOptions<S>& options = {},
         const Solver& solver = {},
         const Row& row = {},
         const Law& law = {})
      : options_(checked(options, solver, row, law)),
        solver_(solver),
        row_(row),
        law_(law),
        rim_(border_mm, side_dot_length_mm, options.base_radius_mm, options.columns) {
    if constexpr (requires { S(side_dot_length_mm.modulus_n_per_mm); }) {
      if (!options_.calibrated_modulus_n_per_mm) {
        options_.calibrated_modulus_n_per_mm = S(side_dot_length_mm.modulus_n_per_mm);
      }
    }
    expects(!options_.falls_back_on_modulus || options_.calibrated_modulus_n_per_mm,
            "WrenchOptions", "falls_back_on_modulus", 1LL,
            "false without calibrated_modulus_n_per_mm");
  }

  Index side_dots() const { return rim_.size(); }
  const WrenchOptions<S>& options() const { return options_; }
  Workspace workspace() const { return Workspace(*this); }

  /// Force and moment of a frame. `shape` is the membrane (the map of PadHeights, or any
  /// membrane_shape). `side_dots_mm` has Row::rows rows, the one nearer to the rim first, and a
  /// column for each border point; NaN: not found. `pressure_mpa` is the pressure above that of the
  /// air. With `noise` the result has a covariance.
  template <class Shape, spatial_dot_grid Dots>
    requires(membrane_shape<Shape, S>)
  WrenchResult<S>
  operator()(const Shape& shape,
             const Dots& side_dots_mm,
             const S& pressure_mpa,
             Workspace& work,
             const WrenchNoise<S>& noise = {}) const {
    const auto dots = as_view(side_dots_mm);
    WrenchResult<S> result;
    if (!fits(dots, work)) {
      return result;
    }
    forget(work);
    result.status = solve(shape, dots, pressure_mpa, work, result);
    if (result.has_force() && result.status != WrenchStatus::no_contact) {
      add_up<Solver::magnitude>(pressure_mpa, work, noise, result);
    } else if (result.status == WrenchStatus::no_contact) {
      result.force_n = result.moment_n_mm = {S(0), S(0), S(0)};
      result.summit_area_mm2 = S(0);
    } else if (result.status == WrenchStatus::no_level_line ||
               result.status == WrenchStatus::no_shape) {
      if constexpr (Law::tells_magnitude) {
        if (options_.falls_back_on_modulus) {
          return by_modulus(dots, pressure_mpa, work, noise, result);
        }
      }
    }
    return result;
  }

  /// The same without a shape: calibrated_modulus_n_per_mm turns the pulls at the rim into forces;
  /// without it the frame is refused. F_z is the small difference of pull and pressure, so one row
  /// of side dots must have its stress-free inclination. O(columns).
  template <spatial_dot_grid Dots>
    requires(Law::tells_magnitude)
  WrenchResult<S> by_modulus(const Dots& side_dots_mm,
                             const S& pressure_mpa,
                             Workspace& work,
                             const WrenchNoise<S>& noise = {})
  const { return by_modulus(as_view(side_dots_mm), pressure_mpa, work, noise, WrenchResult<S>()); }

 private:
  static constexpr bool balances_all =
      Solver::magnitude == detail::membrane::Magnitude::of_all && Solver::finds_tensions;

  template <class Dots>
  bool fits(const Dots& dots, const Workspace& work) const {
    return dots.rows() == Row::rows && dots.cols() == rim_.size() &&
           work.rim_points() == rim_.size() && work.segments_.columns() == options_.columns &&
           work.segments_.rows() == options_.rows;
  }

  static const WrenchOptions<S>& checked(const WrenchOptions<S>& options,
                                         const Solver& solver,
                                         const Row& row,
                                         const Law& law) {
    expects_valid(options);
    expects_valid(solver);
    expects_valid(row);
    expects_valid(law);
    return options;
  }

  static void forget(Workspace& work) {
    for (Point3<S>& tension : work.tension_) {
      tension = detail::missing_point<S>();
    }
  }

  template <class Shape, class Dots>
  WrenchStatus solve(const Shape& shape,
                     const Dots& dots,
                     const S& pressure_mpa,
                     Workspace& work,
                     WrenchResult<S>& result) const {
    const WrenchStatus pressed = check(pressure_mpa);
    if (pressed != WrenchStatus::ok) {
      return pressed;
    }
    const WrenchStatus shaped = lay_mesh(shape, work, result);
    if (shaped != WrenchStatus::ok) {
      return shaped;
    }
    const S pressure = pressure_mpa * chord_factor();
    WrenchStatus pulled = measure_rim(dots, S(0), work, result);
    if (row_.needs_modulus() && pulled == WrenchStatus::ok) {
      const S modulus = detail::membrane::balanced_modulus(
          work.segments_, work.pulls_.segments, pressure);  // from chords, not at the rim yet
      if (value(modulus) > 0) {
        pulled = measure_rim(dots, S(pressure_mpa / modulus), work, result);
      }
    }
    if (pulled != WrenchStatus::ok) {
      return pulled;
    }
    bool solved = solver_.template solve<Law::tells_magnitude>(
        work.segments_, work.nodes_, work.pulls_.segments, pressure, work.work_, work.tensions_);
    S residual = not_a_number<S>();
    if constexpr (Solver::finds_tensions) {
      residual = detail::membrane::residual(work.segments_, work.tensions_, pressure);
      solved = solved && is_plausible(residual);
    }
    if constexpr (Solver::magnitude == detail::membrane::Magnitude::of_all) {
      solved = solved && detail::membrane::carry_load(work.segments_, pressure, work.tensions_.rim);
    }
    if (!solved) {
      return WrenchStatus::not_solved;
    }
    if (balances_all && !(residual <= options_.max_residual)) {
      return WrenchStatus::unbalanced;
    }
    result.residual = residual;
    return compare_modulus(work);
  }

  /// `result` holds what is known from the shape.
  template <class Dots>
  WrenchResult<S> by_modulus(const Dots& dots,
                             const S& pressure_mpa,
                             Workspace& work,
                             const WrenchNoise<S>& noise,
                             WrenchResult<S> result) const {
    result.status = WrenchStatus::refused;
    if (!fits(dots, work) || !options_.calibrated_modulus_n_per_mm) {
      return result;
    }
    forget(work);
    result.by_modulus = true;
    result.status = check(pressure_mpa);
    if (result.status != WrenchStatus::ok) {
      return result;
    }
    const S& modulus = *options_.calibrated_modulus_n_per_mm;
    result.status = measure_rim(dots, S(pressure_mpa / modulus), work, result);
    if (result.status == WrenchStatus::ok) {
      for (std::size_t k = 0; k < work.tensions_.rim.size(); ++k) {
        work.tensions_.rim[k] = modulus * work.pulls_.segments[k];
      }
      add_up<detail::membrane::Magnitude::given>(pressure_mpa, work, noise, result);
    }
    return result;
  }

  WrenchStatus check(const S& pressure_mpa) const {
    if (!(value(pressure_mpa) > 0) || !is_finite(pressure_mpa)) {
      return WrenchStatus::bad_pressure;
    }
    return pressure_mpa > options_.max_pressure_mpa ? WrenchStatus::pressure_not_in_mpa
                                                    : WrenchStatus::ok;
  }

  /// Compares mu t with the calibrated one. A factor of 1.5 is far above the noise: 0.02 mm in each
  /// side dot change mu t by 3 % in the mean.
  WrenchStatus compare_modulus(const Workspace& work) const {
    if (!Law::tells_magnitude || !options_.calibrated_modulus_n_per_mm) {
      return WrenchStatus::ok;
    }
    const S ratio = detail::membrane::mean_factor(work.tensions_.rim, work.pulls_.segments) /
                    *options_.calibrated_modulus_n_per_mm;
    const auto is_within = [&](const S& times) { return ratio < times && S(1) < times * ratio; };
    return is_within(S(3) / S(2)) ? WrenchStatus::ok
           : is_within(S(3))      ? WrenchStatus::pad_has_changed
                                  : WrenchStatus::modulus_not_as_calibrated;
  }

  template <class Shape>
  WrenchStatus lay_mesh(const Shape& shape, Workspace& work, WrenchResult<S>& result) const {
    Point3<S> center;
    if (!detail::membrane::find_contact(shape, options_.base_radius_mm, center)) {
      return detail::membrane::has_height(shape, options_.base_radius_mm) ? WrenchStatus::no_contact
                                                                          : WrenchStatus::no_shape;
    }
    work.nodes_.template lay<Lines>(shape, center);
    result.broken_lines = work.nodes_.broken();
    result.level_lines = work.nodes_.level();
    if (3 * result.broken_lines > options_.columns) {
      return WrenchStatus::no_shape;
    }
    if (result.level_lines == 0) {
      return WrenchStatus::no_level_line;
    }
    const S top = work.nodes_.top_mm();
    if (!(top > options_.side_dot_length_mm / S(2)) || top > S(2) * options_.base_radius_mm) {
      return WrenchStatus::shape_not_in_mm;
    }
    work.segments_.measure(work.nodes_);
    return WrenchStatus::ok;
  }

  template <class Dots>
  WrenchStatus measure_rim(const Dots& dots,
                           const S& load_per_mm,
                           Workspace& work,
                           WrenchResult<S>& result) const {
    rim_.measure(dots, row_, law_, load_per_mm, work.pulls_);
    result.missing = work.pulls_.missing;
    result.slack = work.pulls_.slack;
    result.unstretched = work.pulls_.unstretched + work.pulls_.slack;
    result.outward = work.pulls_.outward;
    if (!rim_.in_order(work.pulls_)) {
      return WrenchStatus::side_dots_in_another_order;
    }
    if (3 * work.pulls_.below > rim_.size()) {
      return WrenchStatus::side_dots_below_base;
    }
    if (3 * result.missing > rim_.size()) {
      return WrenchStatus::too_few_side_dots;
    }
    if (3 * (result.missing + result.unstretched) > rim_.size()) {
      return WrenchStatus::unstretched;
    }
    rim_.integrate(work.pulls_);
    return WrenchStatus::ok;
  }

  /// Area of a circle over that of the polygon with one corner for each line. The mesh has chords
  /// where rim and A_g are round, so the pressure on it is slightly too small; this factor corrects
  /// it.
  S chord_factor() const {
    using std::sin;
    const S turn = S(2 * std::numbers::pi) / S(static_cast<double>(options_.columns));
    return S(turn / S(sin(turn)));
  }

  S base_area_mm2() const {
    return S(std::numbers::pi) * options_.base_radius_mm * options_.base_radius_mm;
  }

  /// Sums force and moment over the rim, eqs. 4 and 5.
  template <detail::membrane::Magnitude Fixed>
  void add_up(const S& pressure_mpa,
              Workspace& work,
              const WrenchNoise<S>& noise,
              WrenchResult<S>& result) const {
    const auto [force, moment] =
        detail::membrane::sum_of_rim(work.tensions_.rim, options_.base_radius_mm);
    const S modulus = detail::membrane::mean_factor(work.tensions_.rim, work.pulls_.segments);
    result.force_n = {force.x, force.y, S(force.z - pressure_mpa * base_area_mm2())};
    result.moment_n_mm = moment;
    result.pressure_mpa = pressure_mpa;
    if (Law::tells_magnitude) {
      result.modulus_n_per_mm = modulus;
    }
    S edge_mm2 = S(0);
    if constexpr (Fixed != detail::membrane::Magnitude::given) {
      result.summit_area_mm2 = chord_factor() * work.nodes_.summit_area(edge_mm2);
    }
    keep_tensions(work);
    if (value(noise.side_dot_mm) > 0 || value(noise.edge_mm) > 0 || value(noise.pressure_mpa) > 0) {
      result.covariance = detail::membrane::covariance_of<Fixed, Row>(
          rim_, work.pulls_, law_,
          detail::membrane::RimSolution<S>{force, moment, modulus, base_area_mm2(),
                                           result.summit_area_mm2, edge_mm2, pressure_mpa},
          noise);
    }
    bool is_possible = is_plausible(result.force_n) && is_plausible(moment);
    for (std::size_t k = 0; k < 6; ++k) {
      is_possible = is_possible && is_finite(result.covariance[k][k]);
    }
    if (!is_possible) {
      result = failed(result);
      forget(work);
    }
  }

  static WrenchResult<S> failed(const WrenchResult<S>& from) {
    WrenchResult<S> out;
    out.status = WrenchStatus::not_solved;
    out.missing = from.missing;
    out.unstretched = from.unstretched;
    out.slack = from.slack;
    out.outward = from.outward;
    out.broken_lines = from.broken_lines;
    out.level_lines = from.level_lines;
    return out;
  }

  /// Stores the tension at each border point: its own pull, scaled by the ratio of tension to pull
  /// in its segment.
  void keep_tensions(Workspace& work) const {
    using std::sqrt;
    const S step = S(2 * std::numbers::pi) / S(static_cast<double>(options_.columns));
    for (Index k = 0; k < rim_.size(); ++k) {
      const Index in = static_cast<Index>(value(S(rim_.angle(k) / step))) % options_.columns;
      const std::size_t segment = static_cast<std::size_t>(in);
      const S factor = sqrt(S(squared_norm(work.tensions_.rim[segment]) /
                              squared_norm(work.pulls_.segments[segment])));
      work.tension_[static_cast<std::size_t>(k)] =
          factor * work.pulls_.dots[static_cast<std::size_t>(k)].pull;
    }
  }

  WrenchOptions<S> options_;
  Solver solver_;
  Row row_;
  Law law_;
  detail::membrane::Rim<S> rim_;
};

}  // namespace v0
}  // namespace fingerpad
