// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Grids of samples, the depth of a pixel between them, and the stages of pipeline/fingertip.hpp
// that consist of several methods.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "fingerpad/depth/sampling.hpp"
#include "fingerpad/pipeline/detail/fingertip_axis.hpp"
#include "fingerpad/pipeline/fingertip_options.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// A grid that owns its cells.
template <class T>
struct OwnedGrid {
  Index rows = 0, cols = 0;
  std::vector<T> cells = {};
  OwnedGrid() = default;
  OwnedGrid(Index height, Index width)
      : rows(height), cols(width), cells(static_cast<std::size_t>(height * width)) {}
  StridedView<T> view() { return {cells.data(), rows, cols, cols}; }
  StridedView<const T> view() const { return {cells.data(), rows, cols, cols}; }
};

/// The free pad, and its samples: constant, and shared by all copies of a fingertip.
template <scalar S>
struct SampledPad {
  int step;
  DepthReference<S> pixels, samples;
  std::vector<PadArea> spans;  ///< in each row of samples, from the first of the pad to the last

  SampledPad(const DepthReference<S>& reference, int pixels_a_sample)
      : step(pixels_a_sample), pixels(reference), samples(sampled(reference, step)) {
    pixels.scattering = pixels.red_gain = pixels.green = {};  // only its depth is needed
    for (Index i = 0; i < samples.rows; ++i) {
      PadArea row{i, 0, 1, 0};
      for (Index j = 0; j < samples.cols; ++j) {
        if (samples.in_pad(i, j)) {
          row.col = row.cols == 0 ? j : row.col;
          row.cols = j + 1 - row.col;
        }
      }
      spans.push_back(row);
    }
  }

  Index own_row(Index px) const { return (std::min)(px / step, samples.rows - 1); }
  Index own_col(Index px) const { return (std::min)(px / step, samples.cols - 1); }
};

/// Depth of a pixel from the depth of the samples: the difference from the free pad is interpolated
/// bilinearly and added to the free pad. Beside missing samples it is extrapolated from the other
/// side. NaN where its own sample has none, except at the pad's rim, where a sample may hold only
/// some pixels.
template <scalar S>
S pixel_depth(const SampledPad<S>& free,
              const StridedView<const S>& samples_mm,
              const StridedView<const PixelStatus>& sample_status,
              Index row,
              Index col) {
  if (free.step == 1) {
    return samples_mm(row, col);
  }
  const PixelStatus own = sample_status(free.own_row(row), free.own_col(col));
  if (!free.pixels.in_pad(row, col) ||
      (own != PixelStatus::ok && own != PixelStatus::outside_pad)) {
    return not_a_number<S>();
  }
  struct Between {
    Index sample;  // the one before
    S behind;      // of it, in samples
    Index next;    // 0: a single sample is everywhere
  };
  const auto place = [&free](Index px, Index count) {
    const double at = sampled_px(static_cast<double>(px), free.step);
    const double last = static_cast<double>(count - 2);
    const double before = (std::max)(0.0, (std::min)(std::floor(at), last));
    return Between{static_cast<Index>(before), S(at - before), count > 1 ? 1 : 0};
  };
  const auto moved = [&](Index i, Index j) { return samples_mm(i, j) - free.samples.depth(i, j); };
  const Between down = place(row, samples_mm.rows()), right = place(col, samples_mm.cols());
  for (const Index di : {0, -1, 1}) {
    for (const Index dj : {0, -1, 1}) {
      const Index i = down.sample + di, j = right.sample + dj;
      if (i >= 0 && j >= 0 && i + down.next < samples_mm.rows() &&
          j + right.next < samples_mm.cols()) {
        const S along = right.behind - S(static_cast<double>(dj));
        const auto between = [&](Index k) {
          return moved(k, j) + along * (moved(k, j + right.next) - moved(k, j));
        };
        const S up = between(i), low = between(i + down.next);
        const S change = up + (down.behind - S(static_cast<double>(di))) * (low - up);
        if (change == change) {
          return free.pixels.depth(row, col) + change;
        }
      }
    }
  }
  return not_a_number<S>();
}

/// The printed dots of each frame, found in its light.
struct FollowedDots {
  DotFollower follower;
  OwnedGrid<Point2<double>> px;

  FollowedDots(const DotFollower& from,
               const StridedView<const Point3<double>>& free_dots_mm,
               Index frame_rows,
               Index frame_cols)
      : follower(from), px(free_dots_mm.rows(), free_dots_mm.cols()) {
    expects(same_size(from.sd_px(), free_dots_mm), "FingertipOptions", "rows of dot_follower",
            static_cast<long long>(from.rows()), "the size of free_dots_mm");
    expects(from.image_rows() == frame_rows && from.image_cols() == frame_cols, "FingertipOptions",
            "image_rows of dot_follower", static_cast<long long>(from.image_rows()),
            "the size of the frame");
  }

  /// `given` is empty, or where the dots are looked for, which holds where too few are found.
  template <class Light, class Dots>
  DotFollowerResult operator()(const Light& light, const Dots& given) {
    auto found = px.view();
    if (given.rows() == 0) {
      return follower(light, found);
    }
    copy(given);
    const DotFollowerResult seen = follower.restart(light, found);
    if (!seen.ok()) {
      copy(given);
    }
    return seen;
  }

 private:
  template <class Dots>
  void copy(const Dots& dots) {
    using Traits = point_traits<cell_t<Dots>>;
    for (Index i = 0; i < px.rows; ++i) {
      for (Index j = 0; j < px.cols; ++j) {
        const cell_t<Dots> p = dots(i, j);
        px.view()(i, j) = {static_cast<double>(Traits::x(p)), static_cast<double>(Traits::y(p))};
      }
    }
  }
};

/// Whether a quarter of a region may be none, as of a first touch: nothing that rests on its edge
/// is certain.
inline bool has_vague_edge(const ContactResult& contact) {
  return contact.expected_one_minus_iou() > 0.25;
}

/// Slip and motion from the printed dots: all that a fingertip remembers from frame to frame.
struct FingertipDots {
  /// A pose that two standard deviations may put further off, or that rests on a stick ratio in
  /// doubt below 0.8, is doubtful.
  static constexpr double most_place_mm = 0.072, most_rotation_rad = 3.2 / 180 * std::numbers::pi;

  OwnedGrid<Point2<double>> seen;  // in px of the samples
  OwnedGrid<Point3<double>> at_mm;
  OwnedGrid<std::uint8_t> touching;
  OwnedGrid<std::uint8_t> held;  // those that touch wherever the edge may lie
  double radius_px;              // of the samples
  double depth_noise_mm;
  bool is_rigid;         // the object: the dots follow the surface of a soft one, not its body
  bool follows = false;  // an object
  ContactShift<> shift;
  ObjectMotion<> motion;
  StickRatio<> stick;
  FrictionLimit<> friction;

  explicit FingertipDots(const FingertipOptions& o)
      : seen(o.free_dots_mm.rows(), o.free_dots_mm.cols()),
        at_mm(seen.rows, seen.cols),
        touching(seen.rows, seen.cols),
        held(touching),
        radius_px(o.dot_radius_px / o.sampling),
        depth_noise_mm(o.dot_depth_noise_mm),
        is_rigid(!o.friction.soft_object),
        shift(o.free_dots_mm),
        motion(seen.rows, seen.cols),
        stick(seen.rows, seen.cols, o.stick),
        friction(o.friction) {
    require("FingertipOptions", {{"dot_radius_px", o.dot_radius_px, within(0, 1000)},
                                 {"dot_depth_noise_mm", depth_noise_mm, not_negative}});
  }

  void reset() {
    motion = ObjectMotion<>(seen.rows, seen.cols);
    follows = false;
    stick.reset();
    friction.reset();
  }

  /// Positions of a frame's dots, in px of the samples.
  template <class Dots>
  void read(const Dots& dots_px, int step) {
    using Traits = point_traits<cell_t<Dots>>;
    for (Index i = 0; i < seen.rows; ++i) {
      for (Index j = 0; j < seen.cols; ++j) {
        const cell_t<Dots> p = dots_px(i, j);
        seen.view()(i, j) = {sampled_px(static_cast<double>(Traits::x(p)), step),
                             sampled_px(static_cast<double>(Traits::y(p)), step)};
      }
    }
  }

  void follow(const Camera<double>& camera,
              const StridedView<const float>& depth_mm,
              const StridedView<const std::uint8_t>& mask,
              double time_s,
              FingertipResult& touch) {
    (void)spatial_dots(camera, seen.view(), depth_mm, at_mm.view());
    contact_at_dots(seen.view(), mask, touching.view(), radius_px);
    const double edge_px = edge_sd_px(touch.contact);
    contact_at_dots(seen.view(), mask, held.view(), radius_px + edge_px);
    touch.stick = stick(at_mm.view(), touching.view(), time_s);
    if (touch.contact.ok()) {
      touch.shift = shift(at_mm.view(), touching.view());
    }
  }

  /// How far the edge of a round contact may lie from where it was found, in px of the samples.
  static double edge_sd_px(const ContactResult& contact) {
    const auto px = static_cast<double>(contact.contact_px);
    return contact.in_contact()
               ? contact.expected_one_minus_iou() * std::sqrt(px / (4 * std::numbers::pi))
               : 0.0;
  }

  /// Decides whether the object slides, which needs the forces, and computes its motion from the
  /// dots that stick.
  void judge_slip(FingertipResult& touch, bool has_six_axes) {
    touch.slip = friction(load_of(touch, has_six_axes), touch.stick);
    const LazyView slips(seen.rows, seen.cols,
                         [&](Index i, Index j) { return !touch.slip.holds(stick.states()(i, j)); });
    if (has_vague_edge(touch.contact) && !follows) {
      return;  // no object begins here
    }
    touch.motion = motion(at_mm.view(), held.view(), slips, depth_noise_mm);
    follows = touch.motion.has_pose();
    ObjectMotionResult<double>& pose = touch.motion;
    pose.position_sd_mm = std::hypot(pose.position_sd_mm, touch.depth_light_sd_mm);
    // one that mostly sticks has not slid as a whole, whatever its ratio
    const bool may_have_slid = touch.slip.in_doubt && touch.slip.stick_ratio < 0.8;
    const bool is_place_known = is_rigid && 2 * pose.position_sd_mm < most_place_mm;
    touch.rotation_in_doubt =
        !pose.ok() || !(2 * pose.rotation_sd_rad < most_rotation_rad) || may_have_slid;
    const bool is_doubted = pose.ok() && (touch.rotation_in_doubt || !is_place_known);
    pose.status = is_doubted ? MotionStatus::doubtful : pose.status;
  }

  /// The load from the six axes where they exist, else from the look-up; never from one after the
  /// other, because the limit of friction is learnt from it. Unknown without both.
  ContactLoad<double> load_of(const FingertipResult& touch, bool has_six_axes) const {
    if (has_six_axes) {
      const bool is_known = touch.wrench.ok() || touch.wrench.status == WrenchStatus::uncertain;
      return is_known ? contact_load(touch.wrench.force_n, touch.wrench.moment_n_mm, at_mm.view(),
                                     touching.view())
                      : ContactLoad<double>{};
    }
    return contact_load(touch.normal.force_n, touch.shear.tangential_force_n,
                        touch.shear.moment_n_mm, at_mm.view(), touching.view());
  }
};

/// Forces from the curves, once area, depth and shift are known.
struct FingertipLookUp {
  std::optional<NormalForce<>> by_area, by_depth;
  std::optional<Shear<>> shear;
  bool shear_by_depth;

  void operator()(FingertipResult& touch) const {
    const bool pressed = touch.contact.in_contact();
    const auto area = pressed ? touch.flat_area : FlatAreaResult<double>{0, 0};
    const double depth_mm = pressed ? touch.contact.depth_mm : 0;
    if (by_area) {
      touch.by_area = (*by_area)(area.area_mm2, area.variance_mm4);
    }
    if (by_depth) {
      touch.by_depth = (*by_depth)(depth_mm);
    }
    touch.normal = fused(touch.by_area, touch.by_depth);
    if (is_finite(touch.by_area.variance_n2)) {
      const ForceResult<double>& a = touch.by_area;
      touch.normal = {a.status, a.force_n, a.variance_n2, touch.normal.disagreement};
    }
    if (shear) {
      touch.shear = (*shear)(shear_by_depth ? depth_mm : area.area_mm2, touch.shift.displacement,
                             touch.shift.rotation_rad);
    }
  }
};

/// Six axes from the dots near the rim: of a printed grid, and of rows around it. Where they lie on
/// the membrane is learnt from frames that touch nothing: the mean of the first ones, which later
/// ones move slowly. A slow touch is never tared away, because no later frame is learnt from whose
/// force or moment by the first places is beyond two standard deviations, and no dot moves further
/// than four of its own. A free pad with a part beyond four without a press, which no touch exerts,
/// is not tared until all are within two again.
///
/// All of it is about the pad's axis. Where the printed grid of the first of these frames shows it
/// more than five standard deviations beside the camera's, the dots are seen from there.
struct FingertipWrench {
  struct Place {
    double arc_mm = 0, azimuth_rad = 0;
    void approach(const fingerpad::Mark& found, double share) {
      arc_mm += share * (found.arc_mm - arc_mm);
      azimuth_rad += share * std::remainder(found.azimuth_rad - azimuth_rad, 2 * std::numbers::pi);
    }
  };
  struct Dot {
    Point2<double> px = {};  // in this frame; NaN: not found
    double sd_px = 0;
    Place first, now;
    int frames = 0;  // learnt from, at most free_frames
  };
  static constexpr int free_frames = 16;

  Wrench<> wrench;
  Camera<double> camera;
  Point2<double> axis_px = {0, 0};     // from the camera's
  Index rows, cols;                    // of the printed grid
  std::vector<Dot> dots;               // the printed grid, then the rows around it
  std::vector<std::uint8_t> touching;  // of each dot, in this frame
  ReservedVector<fingerpad::Mark> marks;
  double dot_sd_px;
  int learnt = 0;
  bool is_uneven;  // then the lattice is not drawn out about the axis
  bool is_tared = true;

  explicit FingertipWrench(const FingertipOptions& o)
      : wrench(o.camera, *o.wrench),
        camera(o.camera),
        rows(o.free_dots_mm.rows()),
        cols(o.free_dots_mm.cols()),
        dot_sd_px(o.dot_sd_px),
        is_uneven(o.wrench->cap.is_uneven()) {
    require("FingertipOptions",
            {{"dot_sd_px", o.dot_sd_px, positive}, {"side_dots", o.side_dots, within(0, 100000)}});
    dots.resize(static_cast<std::size_t>(rows * cols + o.side_dots));
    touching.resize(dots.size());
    marks = ReservedVector<fingerpad::Mark>(dots.size());
  }

  /// Takes the dots of a frame; `mask` has the contact in samples of `step` pixels.
  template <class Dots>
  void read(const Dots& dots_px,
            std::span<const fingerpad::Mark> side_dots,
            const StridedView<const std::uint8_t>& mask,
            int step) {
    using Traits = point_traits<cell_t<Dots>>;
    Dot* to = dots.data();
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j, ++to) {
        const cell_t<Dots> p = dots_px(i, j);
        to->px = {static_cast<double>(Traits::x(p)), static_cast<double>(Traits::y(p))};
        to->sd_px = dot_sd_px;
      }
    }
    const std::span<Dot> sides(to, dots.data() + dots.size());
    for (std::size_t k = 0; k < sides.size(); ++k) {
      constexpr double none = not_a_number<double>();
      sides[k].px = k < side_dots.size() ? side_dots[k].px : Point2<double>{none, none};
      sides[k].sd_px = k < side_dots.size() ? side_dots[k].sd_px : none;
    }
    const auto count = static_cast<Index>(dots.size());
    const LazyView in_samples(count, 1, [&](Index k, Index) {
      const Point2<double>& px = dots[static_cast<std::size_t>(k)].px;
      return Point2<double>{sampled_px(px.x, step), sampled_px(px.y, step)};
    });
    (void)contact_at_dots(in_samples, mask,
                          StridedView<std::uint8_t>(touching.data(), count, 1, 1));
  }

  /// Of the dots that nothing touches.
  WrenchResult operator()(double pressure_mpa) {
    WrenchResult result = fit(pressure_mpa, &Dot::now);
    result.status = result.has_force() && !is_tared ? WrenchStatus::not_tared : result.status;
    return result;
  }

  /// Learns from a frame in which no contact is seen, if `seen` allows it; `seen` becomes what the
  /// dots then say, if they said nothing.
  void tare(double pressure_mpa, WrenchResult& seen) {
    const WrenchResult by_first = learnt > free_frames ? fit(pressure_mpa, &Dot::first) : seen;
    const bool is_first = by_first.status == WrenchStatus::too_few_marks;
    if (by_first.has_force()) {
      const Point3<double>&f = by_first.force_n, &m = by_first.moment_n_mm;
      const double parts[] = {f.x, f.y, f.z, m.x, m.y, m.z};
      const auto sds = [&](Eigen::Index k) {
        return std::fabs(parts[k]) / std::sqrt(by_first.covariance(k, k));
      };
      double most = 0;
      for (Eigen::Index k = 0; k < 6; ++k) {
        most = (std::max)(most, sds(k));
      }
      const bool is_pressed = f.z < 0 && sds(2) > 2;
      is_tared = most < 2 || (is_tared && (most < 4 || is_pressed));
      if (!(most < 2)) {
        return;
      }
    }
    if ((by_first.has_force() || is_first) && wrench.begin(pressure_mpa)) {
      if (learnt == 0 && !is_uneven) {
        find_axis();
      }
      learn();
    }
    seen = seen.has_force() ? seen : (*this)(pressure_mpa);
  }

 private:
  WrenchResult fit(double pressure_mpa, Place Dot::*place) {
    marks.clear();
    for (std::size_t k = 0; k < dots.size(); ++k) {
      const Dot& dot = dots[k];
      if (touching[k] == 0 && dot.frames > 0) {
        const Place& at = dot.*place;
        marks.push_back({at.arc_mm, at.azimuth_rad, dot.px - axis_px,
                         dot.sd_px * std::sqrt(1 + 1.0 / dot.frames)});
      }
    }
    return wrench(marks, pressure_mpa, (std::min)(learnt, free_frames));
  }

  void find_axis() {
    const LazyView grid(rows, cols, [this](Index i, Index j) {
      return dots[static_cast<std::size_t>(i * cols + j)].px;
    });
    const AxisOfGrid axis = axis_of_grid(camera, grid);
    if (norm(axis.at_mm) > 5 * axis.sd_mm) {
      axis_px = {axis.at_mm.x / camera.pitch_mm,
                 axis.at_mm.y / (camera.pitch_mm * camera.pixel_aspect)};
    }
  }

  void learn() {
    learnt += learnt <= free_frames ? 1 : 0;
    for (Dot& dot : dots) {
      if (const auto found = wrench.place_in_free_picture(dot.px - axis_px)) {
        const bool is_later = dot.frames == free_frames;
        const double most_mm = 4 * dot.sd_px * camera.pitch_mm;
        const double most_rad = most_mm / wrench.base_radius_mm();
        dot.frames += is_later ? 0 : 1;
        dot.now.approach(*found, 1.0 / dot.frames);
        dot.first = is_later ? dot.first : dot.now;
        const Place& first = dot.first;
        dot.now = {std::clamp(dot.now.arc_mm, first.arc_mm - most_mm, first.arc_mm + most_mm),
                   std::clamp(dot.now.azimuth_rad, first.azimuth_rad - most_rad,
                              first.azimuth_rad + most_rad)};
      }
    }
  }
};

/// The test of the contact in samples. Refuses a free apex more than 5 % off the highest point of
/// the reference's shape: one of them is of another pad or unit, and every contact depth would be
/// off by their difference. 5 % of a pad of 13 mm are 0.65 mm, more than a measured height errs.
inline ContactTest test_of_samples(const FingertipOptions& o) {
  ContactTest test = o.contact;
  double apex_mm = 0;
  for (const float depth_mm : o.reference.depth_mm) {
    apex_mm = (std::max)(apex_mm, is_depth(depth_mm) ? static_cast<double>(depth_mm) : 0.0);
  }
  expects(!(apex_mm > 0) || std::fabs(test.free_apex_mm / apex_mm - 1) <= 0.05, "FingertipOptions",
          "contact.free_apex_mm", test.free_apex_mm,
          ("within 5 % of the highest point of the reference's shape, " + written(apex_mm) + " mm")
              .c_str());
  test.ring_px = (std::max)(test.ring_px / o.sampling, 1.0);
  const int px = o.sampling * o.sampling;
  test.min_region_px = (test.min_region_px + px - 1) / px;
  return test;
}

/// Takes the light of neighbouring membrane off the depth of the samples.
inline NeighbourLightCompensation<> light_of_samples(const FingertipOptions& o) {
  const int step = o.sampling;
  const StridedView<const float>& free_mm = o.free_depth_mm;
  expects(free_mm.rows() == o.reference.rows && free_mm.cols() == o.reference.cols,
          "FingertipOptions", "rows of free_depth_mm", static_cast<long long>(free_mm.rows()),
          "the size of the frame");
  double sum_mm = 0, count = 0;
  each_pixel(free_mm.rows(), free_mm.cols(), [&](Index i, Index j) {
    const auto depth_mm = static_cast<double>(free_mm(i, j));
    sum_mm += is_finite(depth_mm) ? depth_mm : 0;
    count += is_finite(depth_mm) ? 1 : 0;
  });
  // between the points that neighbouring samples see at the mean depth; x is 0 on the axis
  const Camera<double>& camera = o.camera;
  const double pitch_mm =
      point_at(camera, camera.center_y_px, camera.center_x_px + step, sum_mm / count).x;
  const LazyView free_samples(free_mm.rows() / step, free_mm.cols() / step, [&](Index i, Index j) {
    float sum = 0;
    for (Index k = 0; k < step * step; ++k) {
      sum += free_mm(i * step + k / step, j * step + k % step);
    }
    return sum / static_cast<float>(step * step);
  });
  NeighbourLight<float> light = sampled(*o.neighbour_light, step);
  light.pixel_aspect = static_cast<float>(camera.pixel_aspect);
  return {light, static_cast<float>(pitch_mm), free_samples};
}

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
