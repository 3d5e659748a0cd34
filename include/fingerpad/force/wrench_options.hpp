// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Options and result of the six-axis force, and the concept of a membrane shape.
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {

/// Straight lines (in plan) toward the center of the contact, divided into equal steps.
struct StraightLines {
  static constexpr bool straight = true;
  static constexpr bool by_height = false;
};

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
  S base_radius_mm = S(18735) / S(1000);  ///< of the clamped rim, around Q, > 0
  S side_dot_length_mm = S(4) / S(5);     ///< from the rim to its side dot along the stress-free
                                          ///< membrane, > 0, short against the radius
  Index columns = 36;  ///< n, lines from the rim to A_g, in [8, 720]; published 72
  Index rows = 30;     ///< m, segments of a column, in [2, 1000]; published steps of 0.2 mm: 65
  S line_step_mm = S(2) / S(5);  ///< step along a line, in [radius / 1000, radius / 10]
  /// Membrane nearer than this to the edge of the contact is ignored, >= 0. Choose a node of the
  /// height map plus a quarter of the width over which the depth map was averaged. A larger value
  /// makes the edge less certain.
  S blur_mm = S(3) / S(5);
  S reach_mm = S(4);  ///< how far beyond blur_mm the inclination is read, >= 4 line_step_mm
  // limits beyond which a frame is refused as implausible
  S max_pressure_mpa = S(2) / S(10);  ///< > 0; a higher pressure is taken for kPa or Pa
  /// Largest residual of eq. 6 where the solver balances all equations, > 0; above it shape and
  /// side dots contradict each other.
  S max_residual = S(1) / S(10);
  /// mu t from calibrate/rim.hpp, in [0.005, 50]. A frame whose mu t differs by more than a factor
  /// of 1.5 is pad_has_changed, by more than a factor of 3 modulus_not_as_calibrated. Empty: that
  /// of the fit which gives the lengths of the side dots, if there is one.
  std::optional<S> calibrated_modulus_n_per_mm = {};
  /// Whether the calibrated modulus answers frames whose shape does not show how much the membrane
  /// pulls (no_level_line, no_shape), as Wrench::by_modulus() does.
  bool falls_back_on_modulus = false;
};

namespace detail::membrane {

/// Whether this can be mu t of rubber: 0.02 to 5 MPa, 0.25 to 10 mm thick.
template <scalar S>
bool is_modulus(const S& n_per_mm) {
  return !(n_per_mm < S(5e-3)) && !(S(50) < n_per_mm) && is_finite(n_per_mm);
}

}  // namespace detail::membrane

template <scalar S>
void expects_valid(const WrenchOptions<S>& o) {
  const char* const owner = "WrenchOptions";
  const auto expect_positive = [&](const S& x, const char* name) {
    expects(is_finite(x) && value(x) > 0, owner, name, x, "finite and > 0");
  };
  expect_positive(o.base_radius_mm, "base_radius_mm");
  expect_positive(o.side_dot_length_mm, "side_dot_length_mm");
  expects(o.columns >= 8 && o.columns <= 720, owner, "columns", static_cast<long long>(o.columns),
          "in [8, 720]");
  expects(o.rows >= 2 && o.rows <= 1000, owner, "rows", static_cast<long long>(o.rows),
          "in [2, 1000]");
  const S steps = o.base_radius_mm / o.line_step_mm;
  expects(is_finite(steps) && value(steps) >= 10 && value(steps) <= 1000, owner, "line_step_mm",
          o.line_step_mm, "in [base_radius_mm / 1000, base_radius_mm / 10]");
  expects(is_finite(o.reach_mm) && !(o.reach_mm < S(4) * o.line_step_mm), owner, "reach_mm",
          o.reach_mm, "finite and >= 4 line_step_mm");
  expect_positive(o.max_pressure_mpa, "max_pressure_mpa");
  expect_positive(o.max_residual, "max_residual");
  const S modulus = o.calibrated_modulus_n_per_mm.value_or(S(1));
  expects(detail::membrane::is_modulus(modulus), owner, "calibrated_modulus_n_per_mm", modulus,
          "in [0.005, 50]: N/mm?");
  expects(is_finite(o.blur_mm) && value(o.blur_mm) >= 0, owner, "blur_mm", o.blur_mm,
          "finite and >= 0");
}

// Force and moment of a frame, and their uncertainty.

enum class WrenchStatus : std::uint8_t {
  ok,
  no_contact,         ///< the membrane touches nothing: force and moment are 0
  bad_pressure,       ///< not finite or not above 0
  too_few_side_dots,  ///< more than a third were not found
  unstretched,    ///< more than a third give no direction: missing, slack or stretched too little
  no_shape,       ///< more than a third of the lines run into holes, or no height is known
  no_level_line,  ///< nowhere between rim and contact is the membrane level, so its shape does not
                  ///< show how much it pulls (by_modulus() needs no such line)
  not_solved,     ///< no solution, one that pulls downward, or tensions beyond any measure
  // likely mistakes
  pressure_not_in_mpa,  ///< above max_pressure_mpa: kPa, Pa?
  shape_not_in_mm,      ///< lower than the side dots, or higher than the base is wide: m, um?
  side_dots_in_another_order,  ///< more than a third lie nearer to another border point than to
                               ///< their own, or far from it, or on average all are displaced along
                               ///< the rim by half their spacing: shifted, mirrored, rows
                               ///< exchanged, in px?
  side_dots_below_base,        ///< more than a third: does z point into the pad?
  modulus_not_as_calibrated,  ///< mu t is off by more than a factor of 3: absolute pressure instead
                              ///< of that above the air's, or dots of another pad?
  pad_has_changed,  ///< mu t is off by more than a factor of 1.5: the membrane or its rim has aged,
                    ///< or the gauge is off. F_z follows from pressure and shape; F_xy and M are
                    ///< off by as much as mu t if the rim has become longer, and right if the
                    ///< membrane has become stiffer
  unbalanced,  ///< the residual of eq. 6 exceeds max_residual: shape and side dots are not of the
               ///< same frame, pad or unit
  refused,     ///< a grid or workspace has another size, or by_modulus() has no modulus: nothing
               ///< was done
};

/// "ok", "no contact", ...
constexpr const char* name_of(WrenchStatus status) {
  switch (status) {
    case WrenchStatus::ok:
      return "ok";
    case WrenchStatus::no_contact:
      return "no contact";
    case WrenchStatus::bad_pressure:
      return "bad pressure";
    case WrenchStatus::too_few_side_dots:
      return "too few side dots";
    case WrenchStatus::unstretched:
      return "unstretched";
    case WrenchStatus::no_shape:
      return "no shape";
    case WrenchStatus::no_level_line:
      return "no level line";
    case WrenchStatus::not_solved:
      return "not solved";
    case WrenchStatus::pressure_not_in_mpa:
      return "pressure not in MPa";
    case WrenchStatus::shape_not_in_mm:
      return "shape not in mm";
    case WrenchStatus::side_dots_in_another_order:
      return "side dots in another order";
    case WrenchStatus::side_dots_below_base:
      return "side dots below the base";
    case WrenchStatus::modulus_not_as_calibrated:
      return "modulus not as calibrated: absolute pressure?";
    case WrenchStatus::pad_has_changed:
      return "pad has changed";
    case WrenchStatus::unbalanced:
      return "unbalanced";
    case WrenchStatus::refused:
      return "refused";
  }
  return "unknown";
}

/// Standard deviations of the inputs of a wrench, whose errors are independent.
template <scalar S = double>
struct WrenchNoise {
  S side_dot_mm = S(0);   ///< of each coordinate of each side dot
  S edge_mm = S(0);       ///< of the position of A_g on each line
  S pressure_mpa = S(0);  ///< of the pressure
};

/// The six-axis force of a frame. Force and moment are finite where there is a force (see
/// has_force), and NaN elsewhere.
template <scalar S = double>
struct [[nodiscard]] WrenchResult {
  WrenchStatus status = WrenchStatus::refused;
  Point3<S> force_n = {not_a_number<S>(), not_a_number<S>(), not_a_number<S>()};
  Point3<S> moment_n_mm = {not_a_number<S>(), not_a_number<S>(), not_a_number<S>()};  ///< about Q
  /// Covariance of (F_x, F_y, F_z, M_x, M_y, M_z), in N and N mm, to first order in the noise; 0
  /// without. It assumes that all pulls have one common factor (with the published solvers: one for
  /// each column). LeastSquares averages the noise of the side dots, so its true deviations are
  /// smaller, those of M_x and M_y much smaller. But it spreads the noise of A_g further than
  /// stated.
  std::array<std::array<S, 6>, 6> covariance = detail::zero_matrix<S, 6>();
  S summit_area_mm2 = not_a_number<S>();   ///< area within A_g, in plan; NaN if by_modulus
  S pressure_mpa = not_a_number<S>();      ///< of the frame: given, or found by pressure_from_rim
  S modulus_n_per_mm = not_a_number<S>();  ///< mu t by this frame alone: mean of tension over pull;
                                           ///< NaN for published::Direction
  S residual = not_a_number<S>();  ///< of eq. 6, rms over the segments, relative to the force of
                                   ///< the pressure; NaN if the solver finds no inner tensions
  bool by_modulus = false;         ///< the calibrated modulus was used, not the shape
  Index missing = 0;               ///< side dots that were not found
  Index unstretched = 0;           ///< side dots that give no direction, slack ones included
  Index slack = 0;                 ///< side dots shorter than without stress
  Index outward = 0;       ///< rim points where the membrane bulges past the rim: the camera
                           ///< does not see it there
  Index broken_lines = 0;  ///< lines that ran into holes and were placed between their neighbours
  Index level_lines = 0;   ///< lines along which the membrane is level at A_g

  bool ok() const { return status == WrenchStatus::ok || status == WrenchStatus::no_contact; }
  bool has_force() const { return ok() || status == WrenchStatus::pad_has_changed; }
  /// The force with which the object presses, positive as in the look-ups, and the force along the
  /// pad.
  S normal_force_n() const { return -force_n.z; }
  Point2<S> tangential_force_n() const { return {force_n.x, force_n.y}; }
};

}  // namespace v0
}  // namespace fingerpad
