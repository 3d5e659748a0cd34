// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Frame, dots and pressure in, touch out: depth, contact region, motion of the object, stick ratio,
// forces by look-up and the six-axis force of one fluid-filled fingertip, by one object. It puts
// the methods together and adds none; who needs one method alone includes that method's header.
//
//   Fingertip fingertip(options);                    // takes all memory, refuses bad parameters
//   auto touch = fingertip(ColorFrame(red, green), dots_px, side_dots_mm, pressure_mpa, time_s);
//   if (touch.ok()) { ... touch.wrench.force_n ... }
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <type_traits>
#include <vector>

#include "fingerpad/pipeline/fingertip_options.hpp"

namespace fingerpad {
inline namespace v0 {

/// Not const: a frame changes depth map, mask, dots, and what is remembered of the object. One
/// object per pad; it is not shared by threads. A frame allocates nothing, throws nothing, and
/// takes bounded time, O(rows cols) for the image and O(dots) for the rest.
template <class Reference, class Methods = FingertipMethods>
class Fingertip {
  using Pixel = typename Methods::Pixel;
  using Executor = typename Methods::Executor;
  static constexpr bool has_contact = Methods::has_contact;
  static constexpr bool has_dots = has_contact && Methods::has_dots;
  static constexpr bool has_look_up = has_dots && Methods::has_look_up;
  static constexpr bool has_wrench = has_contact && Methods::has_wrench;

 public:
  /// Refuses bad parameters (parameter_error).
  explicit Fingertip(const FingertipOptions<Reference>& options)
      : image_(options), region_(options), dots_(options), look_up_(options), balance_(options) {}

  /// One frame. Without a stage for them, `dots_px` or `side_dots_mm` may be any dot grid;
  /// `time_s` as the stick ratio has it (NaN: not known). `watch` is told each stage that has
  /// ended.
  template <class Red,
            class Green,
            dot_grid Dots,
            spatial_dot_grid SideDots,
            class Watch = detail::NoWatch>
  FingertipResult operator()(const ColorFrame<Red, Green>& frame,
                             const Dots& dots_px,
                             const SideDots& side_dots_mm,
                             double pressure_mpa,
                             double time_s = not_a_number<double>(),
                             Watch&& watch = {}) {
    FingertipResult touch;
    if (!image_.fits(frame) || !dots_.fits(dots_px)) {
      return touch;
    }
    image_.measure(frame, executor_, touch.depth);
    watch(FingertipStage::depth);
    if constexpr (!has_contact) {
      touch.status = FingertipStatus::ok;
      return touch;
    } else {
      touch.contact = region_.find(image_);
      watch(FingertipStage::contact);
      executor_.both(
          [&] {
            dots_.follow(image_, region_, dots_px, time_s, touch, watch);
            look_up_.measure(dots_, touch, watch);
          },
          [&] { balance_.solve(image_, region_, side_dots_mm, pressure_mpa, touch, watch); });
      dots_.conclude(touch, watch);
      touch.status = status_of(touch);
      return touch;
    }
  }

  /// The same for a fingertip that needs no side dots.
  template <class Red, class Green, dot_grid Dots>
    requires(!has_wrench)
  FingertipResult operator()(const ColorFrame<Red, Green>& frame,
                             const Dots& dots_px,
                             double pressure_mpa,
                             double time_s = not_a_number<double>()) {
    return (*this)(frame, dots_px, StridedView<const Point3<double>>(), pressure_mpa, time_s);
  }

  /// Of the last frame; NaN where there is no depth.
  StridedView<const float> depth_mm() const { return image_.depth.view(); }
  StridedView<const PixelStatus> pixel_status() const { return image_.status.view(); }
  /// Of the last frame: 255 in contact, else 0.
  StridedView<const std::uint8_t> contact_mask() const requires(has_contact) {
    return region_.mask.view();
  }
  /// What each printed dot does, and where it is in mm, in the last frame.
  StridedView<const DotState> dot_states() const requires(has_dots) { return dots_.states.view(); }
  StridedView<const Point3<double>> dots_mm() const requires(has_dots) {
    return dots_.at_mm.view();
  }

  /// Forgets the object: the next frame begins anew.
  void reset() {
    if constexpr (has_dots) {
      dots_.reset();
    }
  }

 private:
  using Options = FingertipOptions<Reference>;

  /// A grid that owns its cells.
  template <class T>
  struct Grid {
    Index rows, cols;
    std::vector<T> cells;
    Grid(Index height, Index width)
        : rows(height), cols(width), cells(static_cast<std::size_t>(height * width)) {}
    StridedView<T> view() { return {cells.data(), rows, cols, cols}; }
    StridedView<const T> view() const { return {cells.data(), rows, cols, cols}; }
  };

  /// The frame's depth.
  struct ImageStage {
    using Estimator = decltype(DepthEstimator(std::declval<Camera<double>>(),
                                              std::declval<Absorption<double>>(),
                                              std::declval<const Reference&>(),
                                              std::declval<typename Methods::Smoothing>(),
                                              std::declval<typename Methods::Inverse>()));
    Camera<double> camera;
    Estimator estimate;
    std::vector<typename Estimator::template Workspace<Pixel>> work;  // one a thread
    Grid<float> depth;
    Grid<PixelStatus> status;

    explicit ImageStage(const Options& o)
        : camera(o.camera),
          estimate(o.camera, o.fluid, o.reference, {o.smoothing_px}),
          work(Executor::threads, estimate.template workspace<Pixel>()),
          depth(o.rows, o.cols),
          status(o.rows, o.cols) {
      expects(o.rows == estimate.rows(), "FingertipOptions", "rows", static_cast<long long>(o.rows),
              "those of the reference");
      expects(o.cols == estimate.cols(), "FingertipOptions", "cols", static_cast<long long>(o.cols),
              "those of the reference");
    }

    template <class Frame>
    bool fits(const Frame& frame) const {
      return same_size(frame.red, depth.view()) && same_size(frame.green, depth.view());
    }

    template <class Frame>
    void measure(const Frame& frame, Executor& executor, DepthResult& result) {
      std::array<DepthResult, Executor::threads> parts;
      executor.bands(depth.rows, [&](int thread, Index first, Index last) {
        const auto k = static_cast<std::size_t>(thread);
        parts[k] = estimate.band(first, last, frame.red, frame.green, depth.view(), status.view(),
                                 work[k]);
      });
      result = parts[0];
      for (std::size_t k = 1; k < parts.size(); ++k) {
        result.add(parts[k]);
      }
    }
  };

  /// Where the object touches.
  struct ContactStage {
    using Region = ContactRegion<typename Methods::Statistic, typename Methods::Edge>;
    Region region;
    typename Region::Workspace work;
    Grid<std::uint8_t> mask;

    explicit ContactStage(const Options& o)
        : region(o.camera, o.rows, o.cols, o.contact),
          work(region.workspace()),
          mask(o.rows, o.cols) {}

    ContactResult find(const ImageStage& image) {
      return region(image.depth.view(), mask.view(), work);
    }
  };

  /// What the printed dots say.
  struct DotStage {
    Grid<Point3<double>> at_mm;
    Grid<std::uint8_t> touching;
    ObjectMotion<> motion;
    ObjectMotion<>::State motion_state;
    SpatialStickRatio<> stick;
    SpatialStickRatio<>::State stick_state;
    Grid<DotState> states;
    Grid<std::uint8_t> slips;
    FrictionLimit<> friction;
    FrictionLimit<>::State friction_state;

    explicit DotStage(const Options& o)
        : at_mm(o.free_dots_mm.rows(), o.free_dots_mm.cols()),
          touching(at_mm.rows, at_mm.cols),
          motion(o.free_dots_mm),
          motion_state(motion.start()),
          stick(at_mm.rows, at_mm.cols, o.stick),
          stick_state(stick.start()),
          states(at_mm.rows, at_mm.cols),
          slips(at_mm.rows, at_mm.cols),
          friction(o.friction),
          friction_state(friction.start()) {}

    template <class Dots>
    bool fits(const Dots& dots_px) const {
      return same_size(dots_px, states.view());
    }
    void reset() {
      motion_state = motion.start();
      stick_state.reset();
      friction_state.reset();
    }

    template <class Dots, class Watch>
    void follow(const ImageStage& image,
                const ContactStage& region,
                const Dots& dots_px,
                double time_s,
                FingertipResult& touch,
                Watch& watch) {
      (void)spatial_dots(image.camera, dots_px, image.depth.view(), at_mm.view());
      contact_at_dots(dots_px, region.mask.view(), touching.view());
      touch.stick = stick(at_mm.view(), touching.view(), states.view(), stick_state, time_s);
      watch(FingertipStage::stick);
    }

    /// Whether the object slides, once the forces are known; and its motion, by the dots that hold.
    template <class Watch>
    void conclude(FingertipResult& touch, Watch& watch) {
      touch.slip = friction(load_of(touch), touch.stick.stick_ratio, update_of(touch.stick.status),
                            friction_state);
      const bool slides = touch.slip.status == FrictionLimitStatus::sliding;
      for (std::size_t k = 0; k < slips.cells.size(); ++k) {
        slips.cells[k] = slides || states.cells[k] == DotState::slip ? 1 : 0;
      }
      touch.motion = motion(at_mm.view(), touching.view(), slips.view(), motion_state);
      watch(FingertipStage::motion);
    }

    /// By the six-axis force; without it by look-up; without either not known.
    ContactLoad<double> load_of(const FingertipResult& touch) const {
      if (touch.wrench.ok()) {
        return contact_load(touch.wrench.force_n, touch.wrench.moment_n_mm, at_mm.view(),
                            touching.view());
      }
      const double radius_mm = std::sqrt(touch.contact.area_mm2 / std::numbers::pi);
      return {touch.normal.force_n, norm(touch.shear.tangential_force_n), touch.shear.moment_n_mm,
              2.0 / 3 * radius_mm};
    }
  };

  /// Forces by look-up.
  struct LookUpStage {
    ContactShift<> shift;
    ContactShift<>::Workspace work;
    NormalForce<> by_area, by_depth;
    Shear<> shear;

    explicit LookUpStage(const Options& o)
        : shift(o.free_dots_mm),
          work(shift.workspace()),
          by_area(o.force_of_area, {}, {.residual_sd_n = o.force_sd_n}),
          by_depth(o.force_of_depth, {}, {.residual_sd_n = o.force_sd_n}),
          shear(o.shear_normalisation, o.shear) {}

    template <class Watch>
    void measure(const DotStage& dots, FingertipResult& touch, Watch& watch) {
      const auto moved = shift(dots.at_mm.view(), dots.touching.view(), work);
      touch.normal = fused(by_area(touch.contact.area_mm2), by_depth(touch.contact.depth_mm));
      touch.shear = shear(touch.contact.area_mm2, moved.displacement, moved.rotation_rad);
      watch(FingertipStage::look_up);
    }
  };

  /// The six-axis force.
  struct BalanceStage {
    using Solver = Wrench<typename Methods::Solver>;
    PadHeights<> heights;
    PadHeights<>::Map map;
    Solver wrench;
    typename Solver::Workspace work;

    explicit BalanceStage(const Options& o)
        : heights(o.rows, o.cols, o.camera),
          map(heights.map()),
          wrench(o.rim_mm, o.wrench),
          work(wrench.workspace()) {}

    template <class SideDots, class Watch>
    void solve(const ImageStage& image,
               const ContactStage& region,
               const SideDots& side_dots_mm,
               double pressure_mpa,
               FingertipResult& touch,
               Watch& watch) {
      heights(image.depth.view(), region.mask.view(), map);
      watch(FingertipStage::heights);
      touch.wrench = wrench(map, side_dots_mm, pressure_mpa, work);
      watch(FingertipStage::wrench);
    }
  };

  /// In place of a stage that is switched off.
  struct NoStage {
    explicit NoStage(const Options&) {}
    template <class Dots>
    bool fits(const Dots&) const {
      return true;
    }
    template <class... Given>
    void follow(Given&&...) {}
    template <class... Given>
    void measure(Given&&...) {}
    template <class... Given>
    void conclude(Given&&...) {}
    template <class... Given>
    void solve(Given&&...) {}
  };

  static FingertipStatus status_of(const FingertipResult& touch) {
    if (!touch.contact.in_contact()) {
      return FingertipStatus::no_contact;
    }
    const bool dots = !has_dots || (touch.motion.ok() && is_finite(touch.stick.stick_ratio));
    const bool look_up = !has_look_up || touch.normal.sources > 0;
    const bool wrench = !has_wrench || touch.wrench.ok();
    return touch.depth.ok() && dots && look_up && wrench ? FingertipStatus::ok
                                                         : FingertipStatus::partial;
  }

  [[no_unique_address]] Executor executor_;
  ImageStage image_;
  [[no_unique_address]] std::conditional_t<has_contact, ContactStage, NoStage> region_;
  [[no_unique_address]] std::conditional_t<has_dots, DotStage, NoStage> dots_;
  [[no_unique_address]] std::conditional_t<has_look_up, LookUpStage, NoStage> look_up_;
  [[no_unique_address]] std::conditional_t<has_wrench, BalanceStage, NoStage> balance_;
};

}  // namespace v0
}  // namespace fingerpad
