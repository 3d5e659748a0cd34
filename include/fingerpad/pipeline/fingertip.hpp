// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Frame, dots and pressure in, touch out. One object computes depth, contact region, motion of the
// object, stick ratio, forces by look-up and the six-axis force of one fluid-filled fingertip. It
// only combines the methods; to use a single method, include that method's header.
//
//   Fingertip fingertip(options);                    // takes all memory, refuses bad parameters
//   auto touch = fingertip(red, green, dots_px, pressure_mpa, time_s);
//   auto touch = fingertip(red, green, pressure_mpa, time_s);  // with a dot follower
//   if (touch.ok()) { ... touch.wrench.force_n ... }
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "fingerpad/pipeline/detail/fingertip_light.hpp"
#include "fingerpad/pipeline/detail/fingertip_stages.hpp"
#include "fingerpad/pipeline/fingertip_options.hpp"

namespace fingerpad {
inline namespace v1 {

/// One pad. The object is the state: copy it to return to a frame later; copies share what is
/// constant of the pad. A copy takes some 3 MB at 640 x 480 pixels and 441 dots, and less than a
/// fifth of the time of a frame (docs/results.md). Use one object a thread. A frame allocates
/// nothing, throws nothing, and takes bounded time, O(rows cols) for the image and O(dots) for the
/// rest.
class Fingertip {
 public:
  /// Refuses bad parameters (parameter_error).
  explicit Fingertip(const FingertipOptions& options)
      : pad_(std::make_shared<const Pad>(options.reference, options.sampling)),
        camera_(sampled(options.camera, options.sampling)),
        red_(pad_->samples.rows, pad_->samples.cols),
        green_(red_),
        depth_mm_(red_.rows, red_.cols),
        pixel_status_(red_.rows, red_.cols),
        mask_(red_.rows, red_.cols),
        estimate_depth_(camera_,
                        options.fluid,
                        pad_->samples,
                        {.window_px = options.smoothing_px, .step = options.sampling}) {
    const FingertipOptions& o = options;
    if (!o.depth_alone && !pad_->samples.green.empty()) {
      light_.emplace();
      light_->free = std::make_shared<const FreeLight<float>>(camera_, o.fluid, pad_->samples);
    }
    if (o.neighbour_light) {
      take_off_light_.emplace(detail::light_of_samples(o));
    }
    if (o.depth_alone) {
      return;
    }
    find_contact_.emplace(camera_, red_.rows, red_.cols, detail::test_of_samples(o));
    if (o.free_dots_mm.rows() * o.free_dots_mm.cols() > 0) {
      dots_.emplace(o);
    }
    if (o.dot_follower) {
      follow_.emplace(*o.dot_follower, o.free_dots_mm, rows(), cols());
    }
    if (o.force_of_area || o.force_of_depth || o.shear) {
      look_up_ =
          detail::FingertipLookUp{o.force_of_area, o.force_of_depth, o.shear, o.shear_by_depth};
    }
    if (o.flat_area || o.force_of_area || (o.shear && !o.shear_by_depth)) {
      find_flat_area_.emplace(camera_, red_.rows, red_.cols);
    }
    if ((dots_ || o.side_dots > 0) && o.wrench) {
      wrench_.emplace(o);
    }
  }

  /// Processes one frame: red and green of 8 or 16 bit, the printed dots in px (NaN: not found),
  /// MPa above the surrounding air, and the time in s of the stick ratio; NaN: not known. Of the
  /// side dots, in the same order in each frame, place and sd in px are read (NaN: not found). What
  /// no stage takes may be left out. With a follower, printed dots are left out, too: those given
  /// are where it restarts, and count as they are where it finds too few.
  template <grid Red, grid Green, dot_grid DotsPx = StridedView<const Point2<double>>>
  FingertipResult operator()(const Red& red,
                             const Green& green,
                             const DotsPx& dots_px = {},
                             double pressure_mpa = not_a_number<double>(),
                             double time_s = not_a_number<double>(),
                             std::span<const Mark> side_dots = {}) {
    const auto given = as_view(dots_px);
    const bool is_given = !dots_ || same_size(given, dots_->seen.view());
    const bool is_followed = follow_ && given.rows() == 0;
    if (!(is_given || is_followed) || !take_samples(as_view(red), as_view(green))) {
      return {};
    }
    if (!follow_) {
      return measure(given, pressure_mpa, time_s, side_dots);
    }
    const DotFollowerResult seen = (*follow_)(mean_light(red, green), given);
    FingertipResult touch =
        measure(std::as_const(follow_->px).view(), pressure_mpa, time_s, side_dots);
    touch.dots = seen;
    return touch;
  }
  /// The same with a follower.
  template <grid Red, grid Green>
  FingertipResult operator()(const Red& red,
                             const Green& green,
                             double pressure_mpa,
                             double time_s = not_a_number<double>(),
                             std::span<const Mark> side_dots = {}) {
    return (*this)(red, green, StridedView<const Point2<double>>(), pressure_mpa, time_s,
                   side_dots);
  }

  Index rows() const { return pad_->pixels.rows; }
  Index cols() const { return pad_->pixels.cols; }
  /// The printed dots that the follower found in the last frame, in px; NaN: lost. Empty without a
  /// follower.
  StridedView<const Point2<double>> dots_px() const {
    return follow_ ? follow_->px.view() : StridedView<const Point2<double>>();
  }
  /// Depth of every pixel of the last frame, in mm; NaN where there is none. The cells of the views
  /// are computed from the samples when they are read.
  auto depth_mm() const {
    return LazyView(rows(), cols(), [this](Index i, Index j) {
      return pixel_depth(*pad_, depth_mm_.view(), pixel_status_.view(), i, j);
    });
  }
  /// 255 in contact, else 0.
  auto contact_mask() const {
    return LazyView(rows(), cols(), [this](Index i, Index j) {
      return mask_.view()(pad_->own_row(i), pad_->own_col(j));
    });
  }
  /// State, contact and place in mm of each printed dot in the last frame; empty without dots.
  StridedView<const DotState> dot_states() const {
    return dots_ ? dots_->stick.states() : StridedView<const DotState>();
  }
  StridedView<const std::uint8_t> dots_in_contact() const {
    return dots_ ? dots_->touching.view() : StridedView<const std::uint8_t>();
  }
  StridedView<const Point3<double>> dots_mm() const {
    return dots_ ? dots_->at_mm.view() : StridedView<const Point3<double>>();
  }
  /// How far each dot has slipped along x and y since the reference of the last answer, in mm; NaN
  /// where not known.
  StridedView<const Point2<double>> dot_slips() const {
    return dots_ ? dots_->stick.slips() : StridedView<const Point2<double>>();
  }
  /// Forgets the object: the next frame is treated as its first. The light, and where the dots near
  /// the rim lie, are of the pad and stay.
  void reset() {
    if (dots_) {
      dots_->reset();
    }
  }

 private:
  using Pad = detail::SampledPad<float>;

  /// The samples of each row from the first of the pad to the last; all others stay 0. False for a
  /// frame of another size.
  template <class Red, class Green>
  bool take_samples(const Red& red, const Green& green) {
    static_assert(std::is_same_v<cell_t<Red>, cell_t<Green>>,
                  "red and green have different types of cell");
    const Index step = pad_->step;
    if (red.rows() != rows() || red.cols() != cols() || !same_size(red, green)) {
      return false;
    }
    for (const detail::PadArea& to : pad_->spans) {
      const detail::PadArea from = {to.row * step, to.col * step, step, to.cols * step};
      (void)sample_frame(detail::crop(red, from), detail::crop(green, from), pad_->step,
                         detail::crop(red_.view(), to), detail::crop(green_.view(), to));
    }
    return true;
  }

  /// Of the samples and the printed dots in px.
  template <class Dots>
  FingertipResult measure(const Dots& dots,
                          double pressure_mpa,
                          double time_s,
                          std::span<const Mark> side_dots) {
    FingertipResult touch;
    if (dots_) {
      dots_->read(dots, pad_->step);
    }
    measure_shape(touch);
    const bool begins =
        light_ && !light_->is_known && touch.contact.ok() && !touch.contact.in_contact();
    if (begins && learn_light() > 0) {
      measure_shape(touch);  // in its own light
    }
    if (dots_) {
      dots_->follow(camera_, depth_mm_.view(), mask_.view(), time_s, touch);
    }
    if (look_up_ && touch.contact.ok()) {
      (*look_up_)(touch);
    }
    if (wrench_) {
      wrench_->read(dots, side_dots, std::as_const(mask_).view(), pad_->step);
      measure_wrench(pressure_mpa, touch);
    }
    if (light_ && !begins) {
      measure_light(touch);
    }
    if (dots_) {
      dots_->judge_slip(touch, wrench_.has_value());
    }
    touch.status = judge(touch, pressure_mpa);
    return touch;
  }

  void measure_shape(FingertipResult& touch) {
    touch.depth =
        estimate_depth_(red_.view(), green_.view(), depth_mm_.view(), pixel_status_.view());
    if (take_off_light_) {
      touch.neighbour_light = (*take_off_light_)(depth_mm_.view(), depth_mm_.view());
    }
    if (find_contact_) {
      touch.contact = (*find_contact_)(depth_mm_.view(), mask_.view());
    }
    if (find_flat_area_ && touch.contact.in_contact()) {
      touch.flat_area = (*find_flat_area_)(mask_.view(), depth_mm_.view());
    }
  }

  /// Returns what the light moved the depth of this frame by, in mm.
  double learn_light() {
    const double mm = light_->learn(std::as_const(red_).view(), std::as_const(green_).view(),
                                    std::as_const(depth_mm_).view());
    estimate_depth_.set_light(light_->gains);
    return mm;
  }
  /// Learns the light from a frame in which neither a region nor a force beyond two standard
  /// deviations is found, for those that follow.
  void measure_light(FingertipResult& touch) {
    const Point3<double>& f = touch.wrench.force_n;
    const double parts[] = {f.x, f.y, f.z};
    bool is_felt = false;
    for (Eigen::Index k = 0; k < 3 && has_sd(touch.wrench); ++k) {
      is_felt = is_felt || square(parts[k]) > 4 * touch.wrench.covariance(k, k);
    }
    if (touch.contact.ok() && !touch.contact.in_contact() && !is_felt) {
      touch.depth_light_sd_mm = learn_light();
    } else {
      touch.depth_light_sd_mm =
          light_->hold(std::as_const(green_).view(), std::as_const(depth_mm_).view());
    }
  }

  /// Learns where the dots lie in frames without contact, from which the first force then follows.
  void measure_wrench(double pressure_mpa, FingertipResult& touch) {
    touch.wrench = (*wrench_)(pressure_mpa);
    if (touch.depth.ok() && touch.contact.ok() && !touch.contact.in_contact()) {
      wrench_->tare(pressure_mpa, touch.wrench);
    }
  }

  /// Whether a force has a standard deviation that holds, however large.
  static bool has_sd(const WrenchResult& wrench) {
    return wrench.ok() || wrench.status == WrenchStatus::uncertain;
  }

  /// A vague edge, as that of a first touch is; or what the rim says, which has not seen the
  /// contact: a press beyond two standard deviations where no region is found, or an area on which
  /// the pressure alone exceeds the press by a quarter, since the membrane's tension around an
  /// object only adds to it.
  static bool doubts_contact(const FingertipResult& touch, double pressure_mpa) {
    const ContactResult& contact = touch.contact;
    const bool is_felt = has_sd(touch.wrench);
    const double press_n = -touch.wrench.force_n.z;
    const double sd_n = std::sqrt(touch.wrench.covariance(2, 2));
    if (!contact.in_contact()) {
      return is_felt && press_n > 2 * sd_n;
    }
    return detail::has_vague_edge(contact) ||
           (is_felt && pressure_mpa * contact.pressed_mm2 > 1.25 * (press_n + 2 * sd_n));
  }

  FingertipStatus judge(FingertipResult& touch, double pressure_mpa) const {
    touch.depth_in_doubt =
        !touch.depth.ok() || touch.neighbour_light != FrameStatus::ok || touch.light_in_doubt();
    touch.contact_in_doubt =
        find_contact_ && (!touch.contact.ok() || doubts_contact(touch, pressure_mpa));
    if (touch.contact_in_doubt && touch.slip.stick_ratio > 0 && touch.slip.stick_ratio < 1) {
      touch.slip.in_doubt = true;  // it depends on which dots touch
    }
    const bool sure = !touch.depth_in_doubt && !touch.contact_in_doubt;
    if (sure && find_contact_ && !touch.contact.in_contact()) {
      return FingertipStatus::no_contact;
    }
    touch.lacks_motion = dots_ && !touch.motion.has_pose();
    touch.lacks_stick_ratio = dots_ && !touch.slip.ok();
    touch.lacks_look_up =
        look_up_ && (look_up_->by_area || look_up_->by_depth) && !touch.normal.has_force();
    touch.lacks_wrench = wrench_ && !touch.wrench.ok();
    const bool all = !touch.lacks_motion && !touch.lacks_stick_ratio && !touch.lacks_look_up &&
                     !touch.lacks_wrench;
    return sure && all ? FingertipStatus::ok : FingertipStatus::partial;
  }

  std::shared_ptr<const Pad> pad_;
  Camera<double> camera_;  // of the samples, like all below
  detail::OwnedGrid<std::uint16_t> red_, green_;
  detail::OwnedGrid<float> depth_mm_;
  detail::OwnedGrid<PixelStatus> pixel_status_;
  detail::OwnedGrid<std::uint8_t> mask_;
  DepthEstimator<float> estimate_depth_;
  std::optional<detail::FingertipLight> light_;
  std::optional<NeighbourLightCompensation<>> take_off_light_;
  std::optional<ContactRegion<>> find_contact_;
  std::optional<EquivalentFlatArea<>> find_flat_area_;
  std::optional<detail::FollowedDots> follow_;
  std::optional<detail::FingertipDots> dots_;
  std::optional<detail::FingertipLookUp> look_up_;
  std::optional<detail::FingertipWrench> wrench_;
};

}  // namespace v1
}  // namespace fingerpad
