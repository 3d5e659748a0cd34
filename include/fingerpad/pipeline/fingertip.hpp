// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Frame, dots and pressure in, touch out. One object computes depth, contact region, motion of the
// object, stick ratio, forces by look-up and the six-axis force of one fluid-filled fingertip. It
// only combines the methods; to use a single method, include that method's header.
//
//   Fingertip fingertip(options);                    // takes all memory, refuses bad parameters
//   auto touch = fingertip(ColorFrame(red, green), dots_px, side_dots_mm, pressure_mpa, time_s);
//   if (touch.ok()) { ... touch.wrench.force_n ... }
#include <cstdint>
#include <type_traits>

#include "fingerpad/pipeline/detail/fingertip_stages.hpp"
#include "fingerpad/pipeline/fingertip_options.hpp"

namespace fingerpad {
inline namespace v0 {

/// Use one object per pad, and do not share it between threads: a frame changes its depth map,
/// mask, dots and the memory of the object. A frame allocates nothing, throws nothing, and takes
/// bounded time, O(rows cols) for the image and O(dots) for the rest.
template <class Methods = FingertipMethods>
class Fingertip {
  using Executor = typename Methods::Executor;
  static constexpr bool has_contact = Methods::has_contact;
  static constexpr bool has_dots = has_contact && Methods::has_dots;
  static constexpr bool has_look_up = has_dots && Methods::has_look_up;
  static constexpr bool has_flat_area = has_look_up && Methods::has_flat_area;
  static constexpr bool has_wrench = has_contact && Methods::has_wrench;

 public:
  /// Refuses bad parameters (parameter_error).
  explicit Fingertip(const FingertipOptions& options)
      : image_(options),
        light_(options),
        region_(options),
        dots_(options),
        flat_area_(options),
        look_up_(options),
        balance_(options) {}

  /// Processes one frame. `dots_px` and `side_dots_mm` may be any dot grid if no stage uses them.
  /// `time_s` is that of the stick ratio (NaN: not known). `watch` is called at the end of each
  /// stage.
  template <class Red,
            class Green,
            dot_grid DotsPx,
            spatial_dot_grid SideDots,
            class Watch = detail::NoWatch>
  FingertipResult operator()(const ColorFrame<Red, Green>& frame,
                             const DotsPx& dots_px,
                             const SideDots& side_dots_mm,
                             double pressure_mpa,
                             double time_s = not_a_number<double>(),
                             Watch&& watch = {}) {
    FingertipResult touch;
    if (!image_.fits(frame) || !dots_.fits(dots_px)) {
      return touch;
    }
    image_.measure(frame, executor_, touch.depth);
    touch.neighbour_light = light_.take_off(image_);
    watch(FingertipStage::depth);
    if constexpr (!has_contact) {
      touch.status = has_depth(touch) ? FingertipStatus::ok : FingertipStatus::partial;
      return touch;
    } else {
      touch.contact = region_.find(image_);
      watch(FingertipStage::contact);
      balance_.measure(image_, region_, executor_);
      watch(FingertipStage::heights);
      executor_.both(
          [&] {
            dots_.follow(image_, region_, dots_px, time_s, touch, watch);
            flat_area_.measure(image_, region_, touch);
            look_up_.measure(dots_, touch, watch);
          },
          [&] { balance_.solve(side_dots_mm, pressure_mpa, touch, watch); });
      dots_.conclude(touch, watch);
      touch.status = status_of(touch);
      return touch;
    }
  }

  /// The same without side dots.
  template <class Red, class Green, dot_grid DotsPx>
    requires(!has_wrench)
  FingertipResult operator()(const ColorFrame<Red, Green>& frame,
                             const DotsPx& dots_px,
                             double pressure_mpa,
                             double time_s = not_a_number<double>()) {
    return (*this)(frame, dots_px, StridedView<const Point3<double>>(), pressure_mpa, time_s);
  }

  /// Depth of every pixel of the last frame; NaN where there is none. Interpolated from the samples
  /// at the first call after a frame.
  StridedView<const float> depth_mm() { return image_.samples.depth(image_.depth, image_.status); }
  StridedView<const PixelStatus> pixel_status() {
    return image_.samples.status(image_.depth, image_.status);
  }
  /// Contact of every pixel of the last frame: 255 in contact, else 0.
  StridedView<const std::uint8_t> contact_mask() requires(has_contact) {
    return image_.samples.mask(region_.mask);
  }
  /// State, contact and place in mm of each printed dot in the last frame.
  StridedView<const DotState> dot_states() const requires(has_dots) { return dots_.states.view(); }
  StridedView<const std::uint8_t> dots_in_contact() const requires(has_dots) {
    return dots_.touching.view();
  }
  StridedView<const Point3<double>> dots_mm() const requires(has_dots) {
    return dots_.at_mm.view();
  }
  /// How far each dot has slipped since the reference of the last answer; NaN where not known.
  StridedView<const DotSlip<double>> dot_slips() const requires(has_dots) {
    return dots_.slipped();
  }
  /// Pull of the membrane on the rim at column `k` of rim_mm in the last frame, N/mm; NaN where it
  /// is not known.
  Point3<double> rim_tension(Index k) const requires(has_wrench) {
    return balance_.balance->wrench.rim_tension(k);
  }

  /// Forgets the object: the next frame is treated as the first.
  void reset() {
    if constexpr (has_dots) {
      dots_.reset();
    }
  }

 private:
  using Image = detail::FingertipImage<Methods>;
  using Light = std::conditional_t<Methods::has_neighbour_light,
                                   detail::FingertipLight<Methods>,
                                   detail::NoFingertipStage>;
  using Contact =
      std::conditional_t<has_contact, detail::FingertipContact<Methods>, detail::NoFingertipStage>;
  using Dots = std::conditional_t<has_dots, detail::FingertipDots, detail::NoFingertipStage>;
  using FlatArea = std::
      conditional_t<has_flat_area, detail::FingertipFlatArea<Methods>, detail::NoFingertipStage>;
  using LookUp = std::
      conditional_t<has_look_up, detail::FingertipLookUp<has_flat_area>, detail::NoFingertipStage>;
  using Balance =
      std::conditional_t<has_wrench, detail::FingertipBalance<Methods>, detail::NoFingertipStage>;

  static bool has_depth(const FingertipResult& touch) {
    return touch.depth.ok() && touch.neighbour_light == FrameStatus::ok;
  }
  FingertipStatus status_of(const FingertipResult& touch) const {
    if (!has_depth(touch) || !touch.contact.ok()) {
      return FingertipStatus::partial;  // neither contact nor its absence is certain
    }
    const bool all = dots_.answers(touch) && look_up_.answers(touch) && balance_.answers(touch);
    return !touch.contact.in_contact() ? FingertipStatus::no_contact
           : all                       ? FingertipStatus::ok
                                       : FingertipStatus::partial;
  }

  [[no_unique_address]] Executor executor_;
  Image image_;
  [[no_unique_address]] Light light_;
  [[no_unique_address]] Contact region_;
  [[no_unique_address]] Dots dots_;
  [[no_unique_address]] FlatArea flat_area_;
  [[no_unique_address]] LookUp look_up_;
  [[no_unique_address]] Balance balance_;
};

}  // namespace v0
}  // namespace fingerpad
