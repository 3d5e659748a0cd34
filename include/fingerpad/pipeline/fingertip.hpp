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
#include <cstdint>
#include <type_traits>
#include <vector>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/force/normal_force.hpp"
#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/force/shear.hpp"
#include "fingerpad/force/wrench.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/pipeline/detail/one_thread.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {

/// Which stages a fingertip has, and by which methods. Derive from it and change what differs: a
/// stage that is false is not instantiated and costs nothing. Contact is needed by all that follow.
///   struct DepthAndContact : FingertipMethods {
///     static constexpr bool has_dots = false, has_wrench = false;
///   };
struct FingertipMethods {
  static constexpr bool has_contact = true;  ///< contact region
  static constexpr bool has_dots = true;     ///< object motion, stick ratio, forces by look-up
  static constexpr bool has_wrench = true;   ///< six-axis force from pressure and side dots

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
  int smoothing_px = 29;
  ContactTest contact = {};
  StridedView<const Point3<double>> free_dots_mm = {};  ///< printed dots of the free pad; NaN: none
  StickTest stick_test = {};
  UpdatedReference stick_reference = {};
  PolynomialForce<> force_of_area = {};                         ///< N, of mm^2
  PolynomialForce<> force_of_depth = {};                        ///< N, of mm
  double force_sd_n = 0.1;                                      ///< standard deviation of both, > 0
  ShearNormalisation<> shear_normalisation = {100, 0.65, 1.7};  ///< by area in mm^2, as printed
  RadialShear<> shear = {};
  StridedView<const Point3<double>> rim_mm = {};  ///< where side dots are fixed; one row
  WrenchOptions<double> wrench = {};
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
  ok,          ///< every stage has an answer
  partial,     ///< a stage has none; its own result says why
  no_contact,  ///< nothing touches the pad
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
  StickRatioResult<float> stick;
  FusedForce<double> normal;    ///< by look-up
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

/// Not const: a frame changes depth map, mask, dots, and what is remembered of the object. One
/// object per pad; it is not shared by threads. A frame allocates nothing, throws nothing, and
/// takes bounded time, O(rows cols) for the image and O(dots) for the rest.
template <class Reference, class Methods = FingertipMethods>
class Fingertip {
  using Pixel = typename Methods::Pixel;
  using Executor = typename Methods::Executor;
  static constexpr bool has_contact = Methods::has_contact;
  static constexpr bool has_dots = has_contact && Methods::has_dots;
  static constexpr bool has_wrench = has_contact && Methods::has_wrench;

 public:
  /// Refuses bad parameters (parameter_error).
  explicit Fingertip(const FingertipOptions<Reference>& options)
      : image_(options), region_(options), dots_(options), balance_(options) {}

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
          [&] { dots_.follow(image_, region_, dots_px, time_s, touch, watch); },
          [&] { balance_.solve(image_, region_, side_dots_mm, pressure_mpa, touch, watch); });
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
    using ByLookUp = NormalForce<>;
    Grid<Point3<double>> at_mm;
    Grid<std::uint8_t> touching;
    ObjectMotion<> motion;
    ObjectMotion<>::State motion_state;
    StickRatio<> stick;
    StickRatio<>::State stick_state;
    Grid<DotState> states;
    ContactShift<> shift;
    ContactShift<>::Workspace shift_work;
    ByLookUp by_area, by_depth;
    Shear<> shear;

    explicit DotStage(const Options& o)
        : at_mm(o.free_dots_mm.rows(), o.free_dots_mm.cols()),
          touching(at_mm.rows, at_mm.cols),
          motion(o.free_dots_mm),
          motion_state(motion.start()),
          stick(at_mm.rows, at_mm.cols, o.stick_test, {}, o.stick_reference),
          stick_state(stick.start()),
          states(at_mm.rows, at_mm.cols),
          shift(o.free_dots_mm),
          shift_work(shift.workspace()),
          by_area(o.force_of_area, {}, {.residual_sd_n = o.force_sd_n}),
          by_depth(o.force_of_depth, {}, {.residual_sd_n = o.force_sd_n}),
          shear(o.shear_normalisation, o.shear) {}

    template <class Dots>
    bool fits(const Dots& dots_px) const {
      return same_size(dots_px, states.view());
    }
    void reset() {
      motion_state = motion.start();
      stick_state.reset();
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
      touch.motion = motion(at_mm.view(), touching.view(), motion_state);
      watch(FingertipStage::motion);
      touch.stick = stick(dots_px, touching.view(), states.view(), stick_state, time_s);
      watch(FingertipStage::stick);
      const auto moved = shift(at_mm.view(), touching.view(), shift_work);
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
    void solve(Given&&...) {}
  };

  static FingertipStatus status_of(const FingertipResult& touch) {
    if (!touch.contact.in_contact()) {
      return FingertipStatus::no_contact;
    }
    const bool dots = !has_dots || (touch.motion.ok() && is_finite(touch.stick.stick_ratio) &&
                                    touch.normal.sources > 0);
    const bool wrench = !has_wrench || touch.wrench.ok();
    return touch.depth.ok() && dots && wrench ? FingertipStatus::ok : FingertipStatus::partial;
  }

  [[no_unique_address]] Executor executor_;
  ImageStage image_;
  [[no_unique_address]] std::conditional_t<has_contact, ContactStage, NoStage> region_;
  [[no_unique_address]] std::conditional_t<has_dots, DotStage, NoStage> dots_;
  [[no_unique_address]] std::conditional_t<has_wrench, BalanceStage, NoStage> balance_;
};

}  // namespace v0
}  // namespace fingerpad
