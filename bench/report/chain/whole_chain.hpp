// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Frame in, all results out: how the methods meet, through plain views. Everything is taken at
// construction; a frame takes nothing.
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "crew.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/force/normal_force.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/force/shear.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "fingerpad/force/wrench.hpp"
#include "plane.hpp"

namespace chain {

using fingerpad::Point2;
using fingerpad::Point3;

enum class Stage { depth, contact, motion, stick, look_up, heights, wrench };
constexpr std::array<const char*, 7> stage_names = {
    "smoothing, depth", "contact region",  "object motion", "stick ratio",
    "look-up forces",   "heights in plan", "wrench"};

/// Told when a stage has ended. This one costs nothing.
struct NoWatch {
  void operator()(Stage) const {}
};

/// What is known of a finger before its first frame.
template <class Reference>
struct Finger {
  fingerpad::Camera<double> camera;
  fingerpad::Absorption<double> fluid;
  Reference reference;
  Index rows = 0;
  Index cols = 0;
  Plane<Point3<double>> free_dots_mm;
  Plane<Point3<double>> border_mm;
  int smoothing_px = 29;
  fingerpad::ContactTest contact_test = {};
  fingerpad::StickTest stick_test = {};
  fingerpad::UpdatedReference<> stick_reference = {};
  fingerpad::PolynomialForce<> force_of_area = {};
  fingerpad::PolynomialForce<> force_of_depth = {};
  double look_up_error_n = 0.1;
  fingerpad::RadialShear<> shear = {};
  fingerpad::WrenchOptions<double> wrench = {};
};

/// What a camera, a dot finder and a pressure gauge say of a frame.
struct Frame {
  fingerpad::StridedView<const std::uint8_t> red;
  fingerpad::StridedView<const std::uint8_t> green;
  fingerpad::StridedView<const Point2<double>> dots_px;
  fingerpad::StridedView<const Point3<double>> side_dots_mm;
  double pressure_mpa = 0;
};

struct Results {
  fingerpad::DepthResult depth;
  fingerpad::ContactResult contact;
  fingerpad::ObjectMotionResult<double> motion;
  fingerpad::StickRatioResult<float> stick;
  fingerpad::FusedForce<double> normal;
  fingerpad::ShearResult<double> shear;
  fingerpad::WrenchResult<double> wrench;
};

/// The policies by default, but the solver that the chain's budget is for.
struct ByDefault {
  using Smoothing = fingerpad::Anchored<fingerpad::BiasFreeMean>;
  using Inverse = fingerpad::ExponentialFree<>;
  using Statistic = fingerpad::ClampedMean<>;
  using Edge = fingerpad::HalfLevelEdge;
  using Solver = fingerpad::PublishedIteration;
};
struct WithLeastSquares : ByDefault {
  using Solver = fingerpad::LeastSquares;
};
/// The least that a flat contact on a pad with dark dots needs.
struct Lean : ByDefault {
  using Smoothing = fingerpad::Anchored<fingerpad::BoxMean>;
  using Inverse = fingerpad::ExponentialFree<2, 5>;
  using Statistic = fingerpad::RingStencil<9>;
  using Edge = fingerpad::AtThreshold;
};

template <class Recipe, class ReferenceType, class Crew = OneThread>
class WholeChain {
 public:
  explicit WholeChain(const Finger<ReferenceType>& finger)
      : finger_(finger),
        depth_(finger.camera, finger.fluid, finger.reference, {{finger.smoothing_px}}),
        depth_mm_(finger.rows, finger.cols),
        status_(finger.rows, finger.cols),
        contact_(finger.camera, finger.rows, finger.cols, finger.contact_test),
        contact_work_(contact_.workspace()),
        mask_(finger.rows, finger.cols),
        motion_(finger.free_dots_mm.view()),
        motion_state_(motion_.start()),
        dots_mm_(finger.free_dots_mm.rows, finger.free_dots_mm.cols),
        touching_(dots_mm_.rows, dots_mm_.cols),
        stick_(dots_mm_.rows, dots_mm_.cols, finger.stick_test, {}, finger.stick_reference),
        stick_state_(stick_.start()),
        dot_states_(dots_mm_.rows, dots_mm_.cols),
        shift_(finger.free_dots_mm.view()),
        shift_work_(shift_.workspace()),
        by_area_(finger.force_of_area, {}, {.residual_sd_n = finger.look_up_error_n}),
        by_depth_(finger.force_of_depth, {}, {.residual_sd_n = finger.look_up_error_n}),
        shear_(fingerpad::published_shear_by_area(), finger.shear),
        heights_(finger.rows, finger.cols, finger.camera),
        map_(heights_.map()),
        wrench_(finger.border_mm.view(), finger.wrench),
        wrench_work_(wrench_.workspace()) {
    for (int k = 0; k < Crew::threads; ++k) {
      depth_work_.push_back(depth_.template workspace<std::uint8_t>());
    }
  }

  template <class Watch = NoWatch>
  Results operator()(const Frame& frame, Watch&& watch = {}) {
    Results r;
    measure_depth(frame, r);
    watch(Stage::depth);
    r.contact = contact_(depth_mm_.view(), mask_.view(), contact_work_);
    watch(Stage::contact);
    crew_.both([&] { follow_dots(frame, r, watch); }, [&] { balance(frame, r, watch); });
    return r;
  }

  fingerpad::StridedView<const float> depth_mm() const { return depth_mm_.view(); }
  fingerpad::StridedView<const std::uint8_t> mask() const { return mask_.view(); }

 private:
  using Depth = fingerpad::DepthEstimator<typename Recipe::Smoothing,
                                          typename Recipe::Inverse,
                                          fingerpad::AstigmaticHeights,
                                          float>;
  using Contact = fingerpad::ContactRegion<typename Recipe::Statistic, typename Recipe::Edge>;
  using Wrench = fingerpad::Wrench<typename Recipe::Solver>;
  using NormalForce = fingerpad::NormalForce<fingerpad::PolynomialForce<>,
                                             fingerpad::NoCompensation,
                                             fingerpad::CurveErrors<3>>;

  void measure_depth(const Frame& frame, Results& r) {
    std::array<fingerpad::DepthResult, Crew::threads> parts;
    crew_.bands(finger_.rows, [&](int thread, Index first, Index last) {
      const auto k = static_cast<std::size_t>(thread);
      parts[k] = depth_.band(first, last, frame.red, frame.green, depth_mm_.view(), status_.view(),
                             depth_work_[k]);
    });
    r.depth = parts[0];
    for (std::size_t k = 1; k < parts.size(); ++k) {
      r.depth.accepted = r.depth.accepted && parts[k].accepted;
      for (std::size_t s = 0; s < r.depth.count.size(); ++s) {
        r.depth.count[s] += parts[k].count[s];
      }
    }
  }

  template <class Watch>
  void follow_dots(const Frame& frame, Results& r, Watch& watch) {
    fingerpad::spatial_dots(finger_.camera, frame.dots_px, depth_mm_.view(), dots_mm_.view());
    fingerpad::contact_at_dots(frame.dots_px, mask_.view(), touching_.view());
    r.motion = motion_(dots_mm_.view(), touching_.view(), motion_state_);
    watch(Stage::motion);
    r.stick = stick_(frame.dots_px, touching_.view(), dot_states_.view(), stick_state_);
    watch(Stage::stick);
    const auto shift = shift_(dots_mm_.view(), touching_.view(), shift_work_);
    r.normal = fused(by_area_(r.contact.area_mm2), by_depth_(r.contact.depth_mm));
    r.shear = shear_(r.contact.area_mm2, shift.displacement, shift.rotation_rad);
    watch(Stage::look_up);
  }

  template <class Watch>
  void balance(const Frame& frame, Results& r, Watch& watch) {
    heights_(depth_mm_.view(), mask_.view(), map_);
    watch(Stage::heights);
    r.wrench = wrench_(map_, frame.side_dots_mm, frame.pressure_mpa, wrench_work_);
    watch(Stage::wrench);
  }

  Finger<ReferenceType> finger_;
  Crew crew_;
  Depth depth_;
  std::vector<typename Depth::template Workspace<std::uint8_t>> depth_work_;
  Plane<float> depth_mm_;
  Plane<fingerpad::PixelStatus> status_;
  Contact contact_;
  typename Contact::Workspace contact_work_;
  Plane<std::uint8_t> mask_;
  fingerpad::ObjectMotion<> motion_;
  fingerpad::ObjectMotion<>::State motion_state_;
  Plane<Point3<double>> dots_mm_;
  Plane<std::uint8_t> touching_;
  fingerpad::StickRatio<> stick_;
  fingerpad::StickRatio<>::State stick_state_;
  Plane<fingerpad::DotState> dot_states_;
  fingerpad::ContactShift<> shift_;
  fingerpad::ContactShift<>::Workspace shift_work_;
  NormalForce by_area_;
  NormalForce by_depth_;
  fingerpad::Shear<> shear_;
  fingerpad::PadHeights<> heights_;
  fingerpad::HeightMap<double> map_;
  Wrench wrench_;
  typename Wrench::Workspace wrench_work_;
};

}  // namespace chain
