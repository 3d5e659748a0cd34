// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a fingertip is told once, and what it says of a frame: pipeline/fingertip.hpp.
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
#include "fingerpad/force/normal_force.hpp"
#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/force/pressure_from_rim.hpp"
#include "fingerpad/force/shear.hpp"
#include "fingerpad/force/wrench.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/pipeline/detail/one_thread.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/spatial_stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {

/// Which stages a fingertip has, and by which methods. Derive from it and change what differs: a
/// stage that is false is not instantiated and costs nothing. Contact is needed by all that follow.
/// A stage that is true has no answer where the options lack what it needs.
///   struct DepthAndContact : FingertipMethods {
///     static constexpr bool has_dots = false, has_wrench = false;
///   };
struct FingertipMethods {
  static constexpr bool has_neighbour_light = false;  ///< taken off the depth; sampling 1
  static constexpr bool has_contact = true;           ///< contact region
  static constexpr bool has_dots = true;       ///< object motion, stick ratio, friction limit
  static constexpr bool has_look_up = true;    ///< forces by calibrated curves; needs the dots
  static constexpr bool has_flat_area = true;  ///< forces by area are looked up by that of the
                                               ///< plate that would press as hard, for objects of
                                               ///< any shape; false: by that of the contact
  static constexpr bool has_wrench = true;     ///< six-axis force from pressure and side dots

  static constexpr int sampling = 3;  ///< pixels of a sample, along rows and along columns: less
                                      ///< than a seventh of the window; 1: every pixel

  using Smoothing = BiasFreeMean;
  using Inverse = ExponentialFree<>;
  using Statistic = ClampedMean<>;
  using Edge = HalfLevelEdge;
  using Solver = LeastSquares;
  using Pixel = std::uint8_t;          ///< cell of the frame's channels
  using Executor = detail::OneThread;  ///< who works on a frame
};

/// All that is known of a fingertip before its first frame. What a stage needs that is switched off
/// is not read.
template <class Reference>
struct FingertipOptions {
  Camera<double> camera;
  Absorption<double> fluid;
  Reference reference;  ///< of the free pad, from fit_reference()
  Index rows = 0;       ///< of a frame, px
  Index cols = 0;
  int smoothing_px = 29;  ///< width of the smoothing window, odd, 3 to 109
  std::optional<NeighbourLight<float>> neighbour_light = {};  ///< empty: not taken off
  StridedView<const float> free_depth_mm = {};  ///< of the free pad, for the neighbour light: found
                                                ///< as a frame's, by a fingertip without it
  ContactTest contact = {};

  StridedView<const Point3<double>> free_dots_mm = {};  ///< printed dots of the free pad, NaN:
                                                        ///< none; empty: no answer by dots
  double dot_radius_px = 0;     ///< a dot touches if all of it does, as contact_at_dots() has it
  SpatialStickTest stick = {};  ///< noise of the dots in space, and what counts as slip
  FrictionLimitOptions friction = {};

  using NormalLookUp = NormalForce<PolynomialForce<5>, ScaledCompensation<>>;
  using ShearLookUp = Shear<RadialShear<4>>;
  FlatAreaOptions flat_area = {};
  std::optional<NormalLookUp> force_of_area = {};   ///< by mm^2, with errors; empty: not looked up
  std::optional<NormalLookUp> force_of_depth = {};  ///< by mm, with errors; empty: not looked up
  std::optional<ShearLookUp> shear = {};            ///< empty: not looked up
  bool shear_by_depth = false;  ///< its measure is mm of depth, not mm^2 of area

  StridedView<const Point3<double>> rim_mm = {};  ///< where side dots are fixed; one row; empty: no
                                                  ///< six-axis force
  OneRow side_dot_row = {};
  ClampedRim rim_law = {};            ///< of the membrane's rubber
  WrenchOptions<double> wrench = {};  ///< with calibrated_modulus_n_per_mm a frame whose pressure
                                      ///< is NaN is answered by pressure_from_rim()
};
template <class Reference>
FingertipOptions(const Camera<double>&, const Absorption<double>&, const Reference&, Index, Index)
    -> FingertipOptions<Reference>;

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
  ok,          ///< every stage that has what it needs has an answer
  partial,     ///< a stage has none, or depth or contact are not of this pad; its own result says
               ///< why
  no_contact,  ///< nothing touches the pad, and its depth is to be trusted
  refused,     ///< a frame or dots of another size: nothing was computed
};

/// "ok", "partial", ...
constexpr const char* name_of(FingertipStatus status) {
  constexpr std::array<const char*, 4> names = {"ok", "partial", "no contact", "refused"};
  return names[static_cast<std::size_t>(status)];
}

/// What a frame says. The result of a stage that is switched off is its own default: no answer.
struct [[nodiscard]] FingertipResult {
  FingertipStatus status = FingertipStatus::refused;
  DepthResult depth;
  ContactResult contact;
  ObjectMotionResult<double> motion;
  SpatialStickResult<double> stick;  ///< by the dots
  SlipResult<double> slip;           ///< by the dots and friction; feed it to GripControl
  ShiftResult<double> shift;         ///< of the dots beside the contact's edge, for the look-up
  FlatAreaResult<double> flat_area;  ///< of the plate that would press as hard
  NormalForceResult<double> by_area, by_depth;  ///< by look-up,
  FusedForce<double> normal;    ///< and both together; by the flat area alone where that is known,
                                ///< since the depth's curve holds for one shape only
  ShearResult<double> shear;    ///< by look-up
  WrenchResult<double> wrench;  ///< six axes

  bool ok() const { return status == FingertipStatus::ok; }
};

/// Stages of a frame, as they are told to a watch.
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
