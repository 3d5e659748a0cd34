// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Options and results of a fingertip (pipeline/fingertip.hpp).
#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/contact/equivalent_flat_area.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/neighbour_light.hpp"
#include "fingerpad/depth/sampling.hpp"
#include "fingerpad/force/look_up.hpp"
#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/force/wrench.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/motion/spatial_dots.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/spatial_stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

/// Does the work of a frame in the calling thread. A custom executor has the same members;
/// bench/report/chain has one with two threads.
struct OneThread {
  static constexpr int threads = 1;

  /// Calls work(thread, first, last) until all rows are done.
  template <class Work>
  void bands(Index rows, const Work& work) {
    work(0, 0, rows);
  }
  /// Calls both, in any order or at the same time.
  template <class First, class Second>
  void both(const First& first, const Second& second) {
    first();
    second();
  }
};

/// A watch that ignores the stages reported to it.
struct NoWatch {
  template <class Stage>
  void operator()(Stage) const {}
};

}  // namespace detail

/// The stages of a fingertip and their methods. Derive from it and override what differs. A stage
/// that is false is not instantiated and costs nothing; all stages after contact need contact. A
/// stage that is true gives no answer if the options lack its inputs.
///   struct DepthAndContact : FingertipMethods {
///     static constexpr bool has_dots = false, has_wrench = false;
///   };
struct FingertipMethods {
  /// Removes the neighbour light from the depth.
  static constexpr bool has_neighbour_light = false;
  static constexpr bool has_contact = true;  ///< contact region
  static constexpr bool has_dots = true;     ///< object motion, stick ratio, friction limit
  static constexpr bool has_look_up = true;  ///< forces from calibrated curves; needs the dots
  /// Forces from curves use the area of the flat plate that would press as hard, for objects of any
  /// shape; false: the area of the contact.
  static constexpr bool has_flat_area = true;
  static constexpr bool has_wrench = true;  ///< six-axis force from pressure and side dots

  /// Width and height of a sample in pixels, less than a seventh of the smoothing window; 1: every
  /// pixel.
  static constexpr int sampling = 3;

  using Pixel = std::uint8_t;          ///< cell of the frame's channels
  using Executor = detail::OneThread;  ///< runs the work of a frame
};

/// Everything that is known of a fingertip before its first frame. Settings of a stage that is
/// switched off are ignored.
struct FingertipOptions {
  Camera<double> camera;
  Absorption<double> fluid;
  DepthReference<float> reference;  ///< of the free pad, from fit_reference()
  Index rows = 0;                   ///< of a frame, px
  Index cols = 0;
  int smoothing_px = 29;  ///< width of the smoothing window, odd, 3 to 109 step; 1: none
  std::optional<NeighbourLight<float>> neighbour_light = {};  ///< empty: not removed
  /// Depth of the free pad, for the neighbour light, from a fingertip without it.
  StridedView<const float> free_depth_mm = {};
  ContactTest contact = {};

  /// Printed dots of the free pad; NaN: missing; empty: no answer from dots.
  StridedView<const Point3<double>> free_dots_mm = {};
  double dot_radius_px = 0;     ///< a dot touches if its whole disc does; see contact_at_dots()
  SpatialStickTest stick = {};  ///< noise of the dots in space, and what counts as slip
  FrictionLimitOptions friction = {};

  FlatAreaOptions flat_area = {};
  /// Force by contact area in mm^2, with errors; empty: not used.
  std::optional<NormalForce<>> force_of_area = {};
  /// Force by depth in mm, with errors; empty: not used.
  std::optional<NormalForce<>> force_of_depth = {};
  std::optional<Shear<>> shear = {};  ///< empty: not used
  bool shear_by_depth = false;        ///< looks up shear by mm of depth instead of mm^2 of area

  /// Positions at which the side dots are fixed; one row; empty: no six-axis force.
  StridedView<const Point3<double>> rim_mm = {};
  /// With modulus_n_per_mm, frames whose pressure is NaN are answered too.
  WrenchOptions<double> wrench = {};
};

/// Red and green channel of a frame, as views.
template <class Red, class Green>
struct ColorFrame {
  Red red;
  Green green;

  template <grid R, grid G>
  ColorFrame(const R& of_red, const G& of_green) : red(as_view(of_red)), green(as_view(of_green)) {}
};
template <class R, class G>
ColorFrame(const R&, const G&) -> ColorFrame<decltype(as_view(std::declval<const R&>())),
                                             decltype(as_view(std::declval<const G&>()))>;

enum class FingertipStatus : std::uint8_t {
  ok,  ///< every stage that has its inputs has an answer
  /// A stage has no answer, or depth or contact do not fit this pad; the result of the stage gives
  /// the reason.
  partial,
  no_contact,  ///< nothing touches the pad, and its depth can be trusted
  refused,     ///< frame or dots have another size: nothing was computed
};

/// "ok", "partial", ...
constexpr const char* name_of(FingertipStatus status) {
  constexpr std::array<const char*, 4> names = {"ok", "partial", "no contact", "refused"};
  return names[static_cast<std::size_t>(status)];
}

/// The results of a frame. A stage that is switched off leaves the default of its result, which is
/// no answer.
struct [[nodiscard]] FingertipResult {
  FingertipStatus status = FingertipStatus::refused;
  DepthResult depth;
  /// Of the neighbour light's removal; not_of_this_pad: free_depth_mm is of another pad or unit.
  FrameStatus neighbour_light = FrameStatus::ok;
  ContactResult contact;
  ObjectMotionResult<double> motion;
  SpatialStickResult<double> stick;  ///< from the dots
  SlipResult<double> slip;           ///< from dots and friction; the input of GripControl
  ShiftResult<double> shift;         ///< of the dots beside the contact's edge, for the look-up
  FlatAreaResult<double> flat_area;  ///< of the plate that would press as hard
  ForceResult<double> by_area, by_depth;  ///< from the curves
  /// Both combined; from the flat area alone if that is known, because the curve by depth holds for
  /// one shape only.
  ForceResult<double> normal;
  ShearResult<double> shear;    ///< from the curve
  WrenchResult<double> wrench;  ///< six axes

  bool ok() const { return status == FingertipStatus::ok; }
};

/// The stages of a frame, as reported to a watch.
enum class FingertipStage : std::uint8_t {
  depth,
  contact,
  motion,
  stick,
  look_up,
  heights,
  wrench
};

}  // namespace v0
}  // namespace fingerpad
