// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The stages of pipeline/fingertip.hpp, each with its estimators and their memory. A stage is
// constructed from the options and fills its part of the result.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/pipeline/detail/frame_samples.hpp"
#include "fingerpad/pipeline/fingertip_options.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Depth of the frame.
template <class Methods>
struct FingertipImage {
  using Executor = typename Methods::Executor;
  static constexpr int step = Methods::sampling;
  using Samples = FrameSamples<typename Methods::Pixel, step, Executor::threads>;
  Index rows, cols;                             // of frames
  Camera<double> camera;                        // of samples, like all members below
  std::vector<DepthEstimator<float>> estimate;  // one per thread
  Samples samples;
  OwnedGrid<float> depth;
  OwnedGrid<PixelStatus> status;

  explicit FingertipImage(const FingertipOptions& o)
      : rows(o.rows),
        cols(o.cols),
        camera(sampled(o.camera, step)),
        estimate(static_cast<std::size_t>(Executor::threads),
                 DepthEstimator(camera,
                                o.fluid,
                                sampled(o.reference, step),
                                {.window_px = o.smoothing_px, .step = step})),
        samples(o.reference),
        depth(o.reference.rows / step, o.reference.cols / step),
        status(depth.rows, depth.cols) {
    expects(rows == o.reference.rows, "FingertipOptions", "rows", static_cast<long long>(rows),
            "those of the reference");
    expects(cols == o.reference.cols, "FingertipOptions", "cols", static_cast<long long>(cols),
            "those of the reference");
  }

  template <class Frame>
  bool fits(const Frame& frame) const {
    return frame.red.rows() == rows && frame.red.cols() == cols &&
           same_size(frame.red, frame.green);
  }

  template <class Frame>
  void measure(const Frame& frame, Executor& executor, DepthResult& result) {
    std::array<DepthResult, Executor::threads> parts;
    const auto& sampled_frame = samples(frame, executor);
    executor.bands(depth.rows, [&](int thread, Index first, Index last) {
      const auto k = static_cast<std::size_t>(thread);
      parts[k] = estimate[k].band(first, last, sampled_frame.red, sampled_frame.green, depth.view(),
                                  status.view());
    });
    result = parts[0];
    for (std::size_t k = 1; k < parts.size(); ++k) {
      result.add(parts[k]);
    }
  }
};

/// Compensation of the light from neighbouring membrane.
template <class Methods>
struct FingertipLight {
  static constexpr int step = Methods::sampling;
  std::optional<NeighbourLightCompensation<>> compensate;

  explicit FingertipLight(const FingertipOptions& o) {
    if (o.neighbour_light) {
      expects(o.free_depth_mm.rows() == o.rows && o.free_depth_mm.cols() == o.cols,
              "FingertipOptions", "rows of free_depth_mm",
              static_cast<long long>(o.free_depth_mm.rows()), "the size of the frame");
      const LazyView free_samples(o.rows / step, o.cols / step, [&o](Index i, Index j) {
        float sum = 0;
        for (Index k = 0; k < step * step; ++k) {
          sum += o.free_depth_mm(i * step + k / step, j * step + k % step);
        }
        return sum / float(step * step);
      });
      NeighbourLight<float> light = sampled(*o.neighbour_light, step);
      light.pixel_aspect = static_cast<float>(o.camera.pixel_aspect);
      compensate.emplace(light, pitch_on_membrane_mm(o), free_samples);
    }
  }

  template <class Image>
  FrameStatus take_off(Image& image) {
    return compensate ? (*compensate)(image.depth.view(), image.depth.view()) : FrameStatus::ok;
  }

  /// Distance between the points seen by neighbouring samples at the pad's mean depth.
  static float pitch_on_membrane_mm(const FingertipOptions& o) {
    double sum_mm = 0, count = 0;
    for (Index i = 0; i < o.rows; ++i) {
      for (Index j = 0; j < o.cols; ++j) {
        const auto depth_mm = static_cast<double>(o.free_depth_mm(i, j));
        sum_mm += is_finite(depth_mm) ? depth_mm : 0;
        count += is_finite(depth_mm) ? 1 : 0;
      }
    }
    const double beside_axis_px = o.camera.center_x_px + step;  // x is 0 on the axis
    return static_cast<float>(
        point_at(o.camera, o.camera.center_y_px, beside_axis_px, sum_mm / count).x);
  }
};

/// Contact region.
template <class Methods>
struct FingertipContact {
  static constexpr int step = Methods::sampling;
  ContactRegion<> region;
  OwnedGrid<std::uint8_t> mask;

  explicit FingertipContact(const FingertipOptions& o)
      : region(sampled(o.camera, step), o.rows / step, o.cols / step, test_of_samples(o)),
        mask(region.rows(), region.cols()) {}

  /// Refuses a free apex more than 5 % off the highest point of the reference's shape: one of them
  /// is of another pad or unit, and every contact depth would be off by their difference. 5 % of a
  /// pad of 13 mm are 0.65 mm, more than a measured height errs.
  static ContactTest test_of_samples(const FingertipOptions& o) {
    ContactTest test = o.contact;
    double apex_mm = 0;
    for (const auto& depth_mm : o.reference.depth_mm) {
      apex_mm = (std::max)(apex_mm, is_depth(depth_mm) ? static_cast<double>(depth_mm) : 0.0);
    }
    expects(
        !(apex_mm > 0) || std::fabs(test.free_apex_mm / apex_mm - 1) <= 0.05, "FingertipOptions",
        "contact.free_apex_mm", test.free_apex_mm,
        ("within 5 % of the highest point of the reference's shape, " + written(apex_mm) + " mm")
            .c_str());
    test.ring.radius_px = (std::max)(test.ring.radius_px / step, 1.0);
    test.min_region_px = (test.min_region_px + step * step - 1) / (step * step);
    return test;
  }

  template <class Image>
  ContactResult find(const Image& image) {
    return region(image.depth.view(), mask.view());
  }
};

/// Slip and motion from the printed dots.
struct FingertipDots {
  struct Followed {
    ObjectMotion<> motion;
    SpatialStickRatio<> stick;
    SpatialStickRatio<>::State stick_state;
    FrictionLimit<> friction;

    explicit Followed(const FingertipOptions& o)
        : motion(o.free_dots_mm.rows(), o.free_dots_mm.cols()),
          stick(o.free_dots_mm.rows(), o.free_dots_mm.cols(), o.stick),
          stick_state(stick.start()),
          friction(o.friction) {}
  };
  OwnedGrid<Point3<double>> at_mm;
  OwnedGrid<std::uint8_t> touching;
  OwnedGrid<DotState> states;
  double radius_px;
  double depth_noise_mm;
  std::optional<Followed> followed;  // empty without dots

  explicit FingertipDots(const FingertipOptions& o)
      : at_mm(o.free_dots_mm.rows(), o.free_dots_mm.cols()),
        touching(at_mm.rows, at_mm.cols),
        states(at_mm.rows, at_mm.cols),
        radius_px(o.dot_radius_px),
        depth_noise_mm(o.stick.depth_mm) {
    expects(radius_px >= 0 && radius_px <= 1000, "FingertipOptions", "dot_radius_px", radius_px,
            "in [0, 1000]");
    if (!at_mm.cells.empty()) {
      followed.emplace(o);
    }
  }

  template <class Dots>
  bool fits(const Dots& dots_px) const {
    return !followed || same_size(dots_px, states.view());
  }
  bool answers(const FingertipResult& touch) const {
    return !followed || (touch.motion.has_pose() && is_finite(touch.stick.stick_ratio));
  }
  StridedView<const DotSlip<double>> slipped() const {
    return followed ? followed->stick_state.slips() : StridedView<const DotSlip<double>>();
  }
  void reset() {
    if (followed) {
      followed->motion = ObjectMotion<>(at_mm.rows, at_mm.cols);
      followed->stick_state.reset();
      followed->friction.reset();
    }
  }

  template <class Image, class Contact, class Dots, class Watch>
  void follow(const Image& image,
              const Contact& region,
              const Dots& dots_px,
              double time_s,
              FingertipResult& touch,
              Watch& watch) {
    if (followed) {
      const auto from = as_view(dots_px);
      const LazyView dots(from.rows(), from.cols(), [&from](Index i, Index j) {
        using Traits = point_traits<cell_t<Dots>>;
        const cell_t<Dots> p = from(i, j);
        return Point2<double>{sampled_px(static_cast<double>(Traits::x(p)), Image::step),
                              sampled_px(static_cast<double>(Traits::y(p)), Image::step)};
      });
      (void)spatial_dots(image.camera, dots, image.depth.view(), at_mm.view());
      contact_at_dots(dots, region.mask.view(), touching.view(), radius_px / Image::step);
      touch.stick = followed->stick(at_mm.view(), touching.view(), states.view(),
                                    followed->stick_state, time_s);
    }
    watch(FingertipStage::stick);
  }

  /// Decides whether the object slides, which needs the forces, and computes its motion from the
  /// dots that stick.
  template <class Watch>
  void conclude(FingertipResult& touch, Watch& watch) {
    if (followed) {
      touch.slip = followed->friction(load_of(touch), touch.stick);
      const LazyView slips(states.rows, states.cols, [&](Index i, Index j) {
        return !touch.slip.holds(states.view()(i, j));
      });
      touch.motion = followed->motion(at_mm.view(), touching.view(), slips, depth_noise_mm);
    }
    watch(FingertipStage::motion);
  }

  /// The load from the six-axis force, else from the look-up; unknown without both.
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

/// The area of a flat contact with the same force.
template <class Methods>
struct FingertipFlatArea {
  static constexpr int step = Methods::sampling;
  EquivalentFlatArea<> of;

  explicit FingertipFlatArea(const FingertipOptions& o)
      : of(sampled(o.camera, step), o.rows / step, o.cols / step, o.flat_area) {}

  template <class Image, class Contact>
  void measure(const Image& image, const Contact& region, FingertipResult& touch) {
    if (touch.contact.in_contact()) {
      touch.flat_area = of(region.mask.view(), image.depth.view());
    }
  }
};

/// Forces by look-up.
template <bool by_flat_area>
struct FingertipLookUp {
  std::optional<ContactShift<>> shift;  // empty without dots
  std::optional<NormalForce<>> of_area, of_depth;
  std::optional<Shear<>> of_shift;
  bool shear_by_depth;

  explicit FingertipLookUp(const FingertipOptions& o)
      : of_area(o.force_of_area),
        of_depth(o.force_of_depth),
        of_shift(o.shear),
        shear_by_depth(o.shear_by_depth) {
    if (o.free_dots_mm.rows() * o.free_dots_mm.cols() > 0) {
      shift.emplace(o.free_dots_mm);
    }
  }
  bool answers(const FingertipResult& touch) const {
    return !(of_area || of_depth) || touch.normal.has_force();
  }

  template <class Dots, class Watch>
  void measure(const Dots& dots, FingertipResult& touch, Watch& watch) {
    if (touch.contact.ok()) {
      look_up(dots, touch.contact.in_contact(), touch);
    }
    watch(FingertipStage::look_up);
  }

  template <class Dots>
  void look_up(const Dots& dots, bool pressed, FingertipResult& touch) {
    if (shift) {
      touch.shift = (*shift)(dots.at_mm.view(), dots.touching.view());
    }
    // an unknown shift counts as 0: the compensation is small compared with the force
    const auto known = [](double x) { return is_finite(x) ? x : 0; };
    const Point2<double> moved = touch.shift.displacement;
    const Point2<double> along = {known(moved.x), known(moved.y)};
    const double rotation = known(touch.shift.rotation_rad);
    const FlatAreaResult<double> area = pressed ? area_of(touch) : nothing_touches;
    const double depth_mm = pressed ? touch.contact.depth_mm : 0;
    if (of_area) {
      touch.by_area = (*of_area)(area.area_mm2, along, rotation, area.variance_mm4);
    }
    if (of_depth) {
      touch.by_depth = (*of_depth)(depth_mm, along, rotation);
    }
    touch.normal = fused(touch.by_area, touch.by_depth);
    if (by_flat_area && is_finite(touch.by_area.variance_n2)) {
      const ForceResult<double>& a = touch.by_area;
      touch.normal = {a.status, a.force_n, a.variance_n2, touch.normal.disagreement};
    }
    if (of_shift) {  // without contact the shift is 0
      touch.shear = (*of_shift)(shear_by_depth ? depth_mm : area.area_mm2,
                                pressed ? moved : Point2<double>{0, 0},
                                pressed ? touch.shift.rotation_rad : 0);
    }
  }

  static constexpr FlatAreaResult<double> nothing_touches = {0, 0};
  static FlatAreaResult<double> area_of(const FingertipResult& touch) {
    return by_flat_area ? touch.flat_area : FlatAreaResult<double>{touch.contact.area_mm2, 0};
  }
};

/// The six-axis force.
template <class Methods>
struct FingertipBalance {
  static constexpr int step = Methods::sampling;
  struct Balance {
    PadHeights<> heights;
    PadHeights<>::Map map;
    Wrench<> wrench;

    explicit Balance(const FingertipOptions& o)
        : heights(
              o.rows / step, o.cols / step, sampled(o.camera, step), o.wrench.base_radius_mm + 1),
          map(heights.map()),
          wrench(o.rim_mm, o.wrench) {}
  };
  std::optional<Balance> balance;  // empty without a rim

  explicit FingertipBalance(const FingertipOptions& o) {
    if (o.rim_mm.rows() * o.rim_mm.cols() > 0) {
      balance.emplace(o);
    }
  }
  bool answers(const FingertipResult& touch) const { return !balance || touch.wrench.ok(); }

  template <class Image, class Contact, class Executor>
  void measure(const Image& image, const Contact& region, Executor&) {
    if (balance) {
      (void)balance->heights(image.depth.view(), region.mask.view(), balance->map);
    }
  }

  template <class SideDots, class Watch>
  void solve(const SideDots& side_dots_mm,
             double pressure_mpa,
             FingertipResult& touch,
             Watch& watch) {
    if (balance) {
      touch.wrench = balance->wrench(balance->map, side_dots_mm, pressure_mpa);
    }
    watch(FingertipStage::wrench);
  }
};

/// Replaces a stage that is switched off.
struct NoFingertipStage {
  template <class Options>
  explicit NoFingertipStage(const Options&) {}
  template <class Dots>
  bool fits(const Dots&) const {
    return true;
  }
  bool answers(const FingertipResult&) const { return true; }
  template <class Image>
  FrameStatus take_off(const Image&) {
    return FrameStatus::ok;
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

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
