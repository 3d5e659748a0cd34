// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Options and results of a fingertip (pipeline/fingertip.hpp).
#include <array>
#include <cstdint>
#include <optional>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/contact/equivalent_flat_area.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/neighbour_light.hpp"
#include "fingerpad/dots/dot_follower.hpp"
#include "fingerpad/dots/spatial_dots.hpp"
#include "fingerpad/force/look_up.hpp"
#include "fingerpad/force/wrench.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

namespace fingerpad {
inline namespace v1 {

/// Everything that is known of a fingertip before its first frame. A stage whose input is not given
/// does not exist: it takes no memory and no time.
struct FingertipOptions {
  Camera<double> camera;
  Absorption<double> fluid;
  DepthReference<float> reference;  ///< of the free pad, from fit_reference(); frames have its size
  /// Width and height of a sample in pixels, 1 to 16, less than a seventh of the smoothing window;
  /// 1: every pixel.
  int sampling = 3;
  int smoothing_px = 29;     ///< width of the smoothing window, odd, 3 to 109 step; 1: none
  bool depth_alone = false;  ///< no contact, and nothing that needs it
  std::optional<NeighbourLight<float>> neighbour_light = {};  ///< empty: not removed
  /// Depth of the free pad, for the neighbour light, from a fingertip without it.
  StridedView<const float> free_depth_mm = {};
  ContactTest contact = {};

  /// Printed dots of the free pad; NaN: missing; empty: no answer from dots.
  StridedView<const Point3<double>> free_dots_mm = {};
  /// Finds these dots in the mean_light() of red and green, on which it must be made; empty: they
  /// come with each frame.
  std::optional<DotFollower> dot_follower = {};
  double dot_radius_px = 0;  ///< a dot touches if its whole disc does; see contact_at_dots()
  StickOptions stick = {};   ///< noise of the dots in mm, and what counts as slip
  double dot_depth_noise_mm = 0.025;  ///< standard deviation of a dot's depth, for the motion
  FrictionLimitOptions friction = {};

  /// Whether to find the area of the flat plate that would press as hard, by which forces are
  /// looked up for objects of any shape, also where no look-up needs it.
  bool flat_area = false;
  /// Force by that area in mm^2, with errors; empty: not used.
  std::optional<NormalForce<>> force_of_area = {};
  /// Force by depth in mm, with errors; empty: not used.
  std::optional<NormalForce<>> force_of_depth = {};
  std::optional<Shear<>> shear = {};  ///< empty: not used
  bool shear_by_depth = false;        ///< looks up shear by mm of depth instead of mm^2 of area

  /// Six axes from the dots near the rim; the base radius, rubber and its modulus must be
  /// known; empty: not used. Needs the pressure, and begins with a frame that touches nothing.
  std::optional<WrenchOptions> wrench = {};
  double dot_sd_px = 0.06;  ///< of a printed dot's place in the picture, > 0
  Index side_dots = 0;      ///< dots of rows around the rim, which only the six axes take; >= 0
};

/// The worst of a frame; the flags of FingertipResult tell of which stages.
enum class FingertipStatus : std::uint8_t {
  ok,          ///< every stage has an answer
  no_contact,  ///< nothing touches the pad, and its depth can be trusted
  partial,     ///< a stage has no answer, or its answer is in doubt
  refused,     ///< frame or dots have another size: nothing was computed
};

/// "ok", "no contact", ...
constexpr const char* name_of(FingertipStatus status) {
  constexpr std::array<const char*, 4> names = {"ok", "no contact", "partial", "refused"};
  return names[static_cast<std::size_t>(status)];
}

/// The results of a frame. A stage that does not exist leaves the default of its result, which is
/// no answer.
struct [[nodiscard]] FingertipResult {
  FingertipStatus status = FingertipStatus::refused;
  // What is in doubt; several may be true. The reason is the status of the stage's own result.
  bool depth_in_doubt = false;    ///< depth or free_depth_mm is of another pad, light or unit, or
                                  ///< light_in_doubt()
  bool contact_in_doubt = false;  ///< whether it touches, or how far, is not certain
  bool lacks_motion = false;      ///< no pose
  /// Whether the rotation of the pose is; that of a doubtful pose is not, where only its place is.
  bool rotation_in_doubt = true;
  bool lacks_stick_ratio = false;
  bool lacks_look_up = false;  ///< no normal force by look-up
  bool lacks_wrench = false;   ///< no six axes

  DotFollowerResult dots;  ///< of the follower; refused without one
  DepthResult depth;
  /// Standard deviation of the depth, in mm, from light that may have changed since it was known.
  double depth_light_sd_mm = 0;
  FrameStatus neighbour_light = FrameStatus::ok;  ///< of its removal
  ContactResult contact;
  ObjectMotionResult<double> motion;
  StickResult<double> stick;         ///< from the dots
  SlipResult<double> slip;           ///< from dots and friction; the input of GripControl
  ShiftResult<double> shift;         ///< of the dots beside the contact's edge, for the look-up
  FlatAreaResult<double> flat_area;  ///< of the plate that would press as hard
  ForceResult<double> by_area, by_depth;  ///< from the curves
  /// From the area if that is known, because the curve by depth holds for one shape only; else by
  /// depth.
  ForceResult<double> normal;
  ShearResult<double> shear;  ///< from the curve
  WrenchResult wrench;        ///< six axes from the dots near the rim

  bool ok() const { return status == FingertipStatus::ok; }
  /// Whether light may put the depth wrong by more than 0.05 mm: what is seen of it is a fifth less.
  bool light_in_doubt() const { return !(depth_light_sd_mm <= 0.04); }
};

}  // namespace v1
}  // namespace fingerpad
