// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/steps/force_step.hpp"

#include <memory>
#include <optional>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/force/normal_force.hpp"
#include "fingerpad/force/shear.hpp"
#include "fingerpad/motion/object_motion.hpp"

namespace replay {
namespace {

using Result = fingerpad::NormalForceResult<double>;
using Normal = fingerpad::NormalForce<NormalForceLookUp::Curve, fingerpad::ScaledCompensation<>>;
using Shift = fingerpad::ContactShift<>;

std::optional<Normal> normal_of(const std::optional<NormalForceLookUp>& given) {
  if (!given) {
    return {};
  }
  Normal::Errors errors;
  errors.residual_sd_n = given->residual_n;
  return Normal(given->curve, given->compensation, errors);
}

/// The dots beside the contact's edge against those of the free pad.
class ShiftMeter {
 public:
  ShiftMeter(const Recording& recording, const DotGrid& initial_px)
      : shift_(in_space(recording, initial_px)), workspace_(shift_.workspace()) {}

  fingerpad::ShiftResult<double> operator()(const FrameDots& dots) {
    return shift_(dots.dots_mm, dots.in_contact, workspace_);
  }

 private:
  static cv::Mat_<cv::Vec3d> in_space(const Recording& recording, const DotGrid& initial_px) {
    cv::Mat_<cv::Vec3d> dots_mm(initial_px.size());
    (void)fingerpad::spatial_dots(recording.sensor.camera, initial_px, recording.reference_depth,
                                  dots_mm);
    return dots_mm;
  }

  Shift shift_;
  Shift::Workspace workspace_;
};

/// Everything that lives as long as the frames come.
class LookUp {
 public:
  LookUp(const Recording& recording, const DotGrid& initial_px) {
    if (!initial_px.empty()) {
      meter_.emplace(recording, initial_px);
    }
    if (const auto& given = recording.sensor.force) {
      looks_up_ = true;
      by_area_ = normal_of(given->by_area);
      by_depth_ = normal_of(given->by_depth);
      if (given->shear) {
        shear_by_ = given->shear->by;
        shear_.emplace(given->shear->normalisation, given->shear->map);
      }
    }
  }

  ForceFrame operator()(const ContactResult& contact, const FrameDots& dots) {
    ForceFrame frame;
    if (!contact.ok()) {
      return frame;
    }
    if (meter_) {
      frame.shift = (*meter_)(dots);
    }
    frame.looked_up = looks_up_;
    look_up_normal(contact, frame);
    if (shear_) {
      look_up_shear(contact, frame);
    }
    return frame;
  }

 private:
  static double measure_of(const ContactResult& contact, ContactMeasure by) {
    return !contact.in_contact()        ? 0.0
           : by == ContactMeasure::area ? contact.area_mm2
                                        : contact.depth_mm;
  }
  static double known_or_zero(double number) { return fingerpad::is_finite(number) ? number : 0; }

  /// A contact whose dots do not tell its shift counts as one that is only pressed: the
  /// compensation is small beside the force.
  static Result force_by(const std::optional<Normal>& normal,
                         double measure,
                         const fingerpad::ShiftResult<double>& shift) {
    return normal ? (*normal)(
                        measure,
                        {known_or_zero(shift.displacement.x), known_or_zero(shift.displacement.y)},
                        known_or_zero(shift.rotation_rad))
                  : Result{};
  }

  void look_up_normal(const ContactResult& contact, ForceFrame& frame) const {
    const Result by_area =
        force_by(by_area_, measure_of(contact, ContactMeasure::area), frame.shift);
    const Result by_depth =
        force_by(by_depth_, measure_of(contact, ContactMeasure::depth), frame.shift);
    const auto force = fused(by_area, by_depth);
    frame.normal_n = force.force_n;
    frame.disagreement = force.disagreement;
    frame.beyond_range = by_area.status == fingerpad::ForceStatus::beyond_range ||
                         by_depth.status == fingerpad::ForceStatus::beyond_range;
  }

  void look_up_shear(const ContactResult& contact, ForceFrame& frame) const {
    const double measure = measure_of(contact, shear_by_);
    // without contact there is no shift to know
    const bool pressed = measure > 0;
    const fingerpad::Point2<double> still{0, 0};
    const auto shear = (*shear_)(measure, pressed ? frame.shift.displacement : still,
                                 pressed ? frame.shift.rotation_rad : 0.0);
    frame.tangential_n = shear.tangential_force_n;
    frame.moment_n_mm = shear.moment_n_mm;
    frame.beyond_range = frame.beyond_range ||
                         shear.force_status == fingerpad::ForceStatus::beyond_range ||
                         shear.moment_status == fingerpad::ForceStatus::beyond_range;
  }

  std::optional<ShiftMeter> meter_;
  bool looks_up_ = false;
  std::optional<Normal> by_area_;
  std::optional<Normal> by_depth_;
  ContactMeasure shear_by_ = ContactMeasure::area;
  std::optional<fingerpad::Shear<ShearLookUp::Map>> shear_;
};

}  // namespace

ForceStep make_force_step(const Recording& recording, const DotGrid& initial_px) {
  // Shared, because a std::function is copied and a workspace should not be.
  const auto chain = std::make_shared<LookUp>(recording, initial_px);
  return [chain](const ContactResult& contact, const FrameDots& dots) {
    return (*chain)(contact, dots);
  };
}

}  // namespace replay
