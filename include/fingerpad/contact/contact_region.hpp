// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Where the object touches the pad, from the depth map. A free membrane under pressure bulges
// outward (Young and Laplace: sigma1 K1 + sigma2 K2 = p > 0). Where it is flat or dented in all
// directions, an object presses on it.
// Source: Ito et al. 2011, III.B, eqs. 1-12, and the slides, contact region. Published and
// corrected forms in docs/errata.md, E012-E018.
//
// Where the mean curvature with negative ones set to 0 (image/curvature.hpp) is below a threshold,
// there is contact; its edge is then placed where the plain mean is half way between object and
// free membrane.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/contact/detail/regions.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/curvature.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

/// The test for contact: a mean curvature below the threshold.
struct ContactTest {
  /// delta in the sources, > 0. Half the curvature of the free pad is a good choice: 1/40 per mm
  /// for the published pad of 20 mm radius. calibrate/contact.hpp measures it.
  double threshold_per_mm = 0.025;
  /// Counts instead where no region lies below the threshold: finds small and hollow objects, whose
  /// curvature never falls to half. >= 0; 0, or less than the threshold: not used.
  double faint_per_mm = 0;
  double free_apex_mm = 13;   ///< height of the free pad, from which contact depth counts; finite
  double ring_px = 25;        ///< radius of the ring of image/curvature.hpp, in [1, 1000]
  int directions = 18;        ///< of its sections, in [1, 360]; time grows with it
  Index min_region_px = 200;  ///< smaller regions are dropped: noise makes specks of about half a
                              ///< ring's radius. >= 1; 1 drops none
  /// False: contact ends where the threshold does, as published. A ring that reaches beyond the
  /// edge includes free membrane, so the region is off by up to a ring's radius on all sides; it is
  /// faster, where only the place of the contact matters.
  bool places_edge = true;
  /// Membrane nearer than this to the object counts as touched, in [0, 1], but not as bearing load.
  /// In the mask this moves the placed edge outward by sqrt(gap / jump of the mean curvature),
  /// about 0.5 mm at the default; a depth map from 8-bit frames cannot distinguish such a gap from
  /// contact.
  double touching_gap_mm = 0.02;
};

/// Says which value is out of range; "" if none is.
inline std::string check(const ContactTest& test) {
  return check("ContactTest", {{"threshold_per_mm", test.threshold_per_mm, positive},
                               {"faint_per_mm", test.faint_per_mm, not_negative},
                               {"free_apex_mm", test.free_apex_mm, finite_number},
                               {"ring_px", test.ring_px, within(1, 1000)},
                               {"directions", test.directions, within(1, 360)},
                               {"min_region_px", test.min_region_px, at_least(1)},
                               {"touching_gap_mm", test.touching_gap_mm, within(0, 1)}});
}

/// The contact of a frame. Without contact, areas are 0 and place and depth NaN; if the status is
/// not ok, all of them are.
///
/// `not_of_this_pad`: no pixel of the frame is known, or the mean height of the contact is a
/// twentieth of the free apex or less, or twenty times it or more, as with depths in m.
struct [[nodiscard]] ContactResult {
  FrameStatus status = FrameStatus::refused;
  Index contact_px = 0;  ///< pixels in contact
  Index unknown_px = 0;  ///< pixels without depth, or with too few neighbours to decide
  Index regions = 0;     ///< connected parts of the contact
  /// At the contact's depth, projected on the plate, without the touching gap: times the pressure
  /// it is the load of a flat object. `contact_px` and the mask have the gap's membrane too.
  double area_mm2 = not_a_number<double>();
  /// Standard deviation of the area: the touching gap, of which a soft object may touch all, and
  /// the edge as the noise of the free membrane's curvature moves it. Where the edge is not placed,
  /// it may lie anywhere within the ring's radius.
  double area_sd_mm2 = not_a_number<double>();
  /// The area, of each region by the share of the fluid's pressure that the object takes: all of it
  /// where it is flat, the less the more it bulges with the membrane. Times the pressure this is
  /// what the object presses with, without the membrane's pull around it. Where the edge is not
  /// placed, all of the area.
  double pressed_mm2 = not_a_number<double>();
  Point3<double> center_mm = {not_a_number<double>(), not_a_number<double>(),
                              not_a_number<double>()};  ///< centroid; z over all that is touched
  double depth_mm = not_a_number<double>();  ///< D: free apex height less mean height of contact

  bool accepted() const { return status != FrameStatus::refused; }
  bool ok() const { return status == FrameStatus::ok; }
  bool in_contact() const { return contact_px > 0; }
  /// What 1 - IoU of the mask with the true region is expected to be, in [0, 1]: an area that is
  /// wrong by its standard deviation is so by its edge. NaN where nothing is found.
  double expected_one_minus_iou() const {
    return in_contact() ? area_sd_mm2 / (area_mm2 + area_sd_mm2) : not_a_number<double>();
  }
};

/// The contact region of depth maps of one size, computed in the scalar S.
/// published/contact_region.hpp is the test as printed.
/// A pixel without depth is never contact. A pixel whose ring is partly missing is judged by the
/// remaining directions; if these are fewer than half it is unknown. All contacts of a
/// frame are compared with one free membrane, whose curvature is linear in the pixel.
///
/// One object a thread. Bounded time and no allocation per frame; O(rows cols directions).
template <scalar S = float>
class ContactRegion {
 public:
  /// Depths along the rays of a Camera, or heights of an OrthographicCamera; rows and cols in
  /// [2, 1e6], at most 1e8 pixels. Refuses bad parameters (parameter_error).
  template <class CameraType = Camera<double>>
  ContactRegion(const CameraType& camera, Index rows, Index cols, const ContactTest& test = {})
      : test_(checked(camera, rows, cols, test)),
        pitch_mm_(static_cast<double>(value(camera.pitch_mm))),
        pixel_aspect_(static_cast<double>(value(camera.pixel_aspect))),
        growth_per_mm_(static_cast<double>(value(growth_per_mm(camera)))),
        ring_cols_(static_cast<Index>(std::ceil(test.ring_px))),
        ring_rows_(static_cast<Index>(std::ceil(test.ring_px / pixel_aspect_))),
        spread_cols_((ring_cols_ + 1) / 3),
        spread_rows_((ring_rows_ + 1) / 3),
        image_{rows, cols, (std::max)({spread_cols_, spread_rows_, Index(1)})},
        regions_(image_),
        curvature_(camera, rows, cols, test.ring_px, test.directions),
        statistic_(static_cast<std::size_t>(image_.size()), not_a_number<S>()),
        raw_(statistic_),
        mean_(statistic_) {
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const auto seen = [&](double depth_mm) {
          return point_at(cast<double>(camera), static_cast<double>(i), static_cast<double>(j),
                          depth_mm);
        };
        const auto low = seen(0), high = seen(1);
        rays_.push_back({{low.x, low.y}, {high.x - low.x, high.y - low.y}});
      }
    }
    for (const auto& corner : {point(0, 0, 0), point(rows - 1, 0, 0), point(0, cols - 1, 0),
                               point(rows - 1, cols - 1, 0)}) {
      expects(is_plausible(norm(corner)), "ContactRegion", "camera: corner of the image, mm",
              norm(corner), "less than a million from the axis");
    }
  }

  /// Finds the contact in a depth map in mm. Cells of `mask` become a Touch if they are of that
  /// type, else 255 (or true) in contact and 0 elsewhere. Refuses other sizes, and then writes
  /// nothing.
  template <grid Depth, class Mask>
  ContactResult operator()(const Depth& depth_mm, Mask&& mask) {
    static_assert(!std::is_integral_v<cell_t<Depth>>,
                  "depths are no whole numbers: give the depth map first, then the mask");
    detail::writes_to<Mask>();
    ContactResult result;
    const auto depth = as_view(depth_mm);
    const auto to = as_view(mask);
    if (!has_size(depth) || !has_size(to)) {
      return result;
    }
    result.area_mm2 = result.area_sd_mm2 = result.pressed_mm2 = 0;
    const auto statistic = image_.view(statistic_.data());
    const auto raw = image_.view(raw_.data());
    const auto marks = regions_.marks();
    result.unknown_px =
        *(test_.places_edge ? curvature_(depth, statistic, raw) : curvature_(depth, statistic));
    double pressed_px = find_below(test_.threshold_per_mm, depth, result);
    if (result.regions == 0 && test_.faint_per_mm > test_.threshold_per_mm) {
      result.area_sd_mm2 = 0;
      pressed_px = find_below(test_.faint_per_mm, depth, result);
    }
    write(marks, to);
    measure(marks, depth, result);
    if (result.in_contact()) {
      result.pressed_mm2 = result.area_mm2 * pressed_px / static_cast<double>(result.contact_px);
    }
    if (!is_of_this_pad(result)) {
      return {FrameStatus::not_of_this_pad, result.contact_px, result.unknown_px, result.regions};
    }
    result.status = FrameStatus::ok;
    return result;
  }

  /// The mean curvature of the last frame that the threshold was compared with, 1/mm; NaN where it
  /// is unknown.
  StridedView<const S> statistic() const { return image_.view(statistic_.data()); }

  Index rows() const { return image_.rows; }
  Index cols() const { return image_.cols; }

 private:
  template <class CameraType>
  static const ContactTest& checked(const CameraType& camera,
                                    Index rows,
                                    Index cols,
                                    const ContactTest& test) {
    expects_grid_size("ContactRegion", rows, cols, 2);  // areas need a neighbour
    require(camera);
    require(test);
    return test;
  }

  template <class G>
  bool has_size(const G& g) const {
    return g.rows() == image_.rows && g.cols() == image_.cols;
  }

  /// Finds the regions whose curvature is below a threshold; returns their pixels, each by the
  /// share of the pressure that the object takes there.
  template <class View>
  double find_below(double threshold_per_mm, const View& depth, ContactResult& result) {
    const auto marks = regions_.marks();
    for (Index i = 0; i < image_.rows; ++i) {
      detail::mark_below(S(threshold_per_mm), statistic().row(i), image_.cols, marks.row(i));
    }
    if (test_.places_edge && regions_.next_seed(0) < image_.size()) {
      find_free_plane();
      detail::mean_of_nine(image_.view(raw_.data()), spread_rows_, spread_cols_,
                           image_.view(mean_.data()));
    }
    const auto keep = [this](const detail::Regions::Region& region) {
      return region.pixels() >= test_.min_region_px;
    };
    double pressed_px = 0;
    result.regions = regions_.for_each(keep, [&](detail::Regions::Region& region) {
      if (test_.places_edge) {
        const Edge edge = place_edge(depth, region);
        result.area_sd_mm2 += edge.area_sd_mm2;
        pressed_px += edge.pressure_share * static_cast<double>(region.pixels());
      } else {
        result.area_sd_mm2 +=
            perimeter_mm(region, pitch_mm_) * test_.ring_px * pitch_mm_ / std::numbers::sqrt3;
        pressed_px += static_cast<double>(region.pixels());
      }
      result.contact_px += region.pixels();
    });
    return pressed_px;
  }

  template <class Cell>
  static Cell as_cell(detail::Mark mark) {
    using detail::Mark;
    if constexpr (std::is_same_v<Cell, Touch>) {
      const Touch other = mark == Mark::unknown ? Touch::unknown : Touch::none;
      return mark >= Mark::contact ? Touch::contact : other;
    } else {
      return static_cast<Cell>(mark >= Mark::contact ? 255 : 0);
    }
  }

  template <class To>
  void write(const StridedView<detail::Mark>& marks, const To& to) const {
    using Cell = cell_t<To>;
    for (Index i = 0; i < image_.rows; ++i) {
      const detail::Mark* row = marks.row(i);
      if constexpr (std::is_same_v<To, StridedView<Cell>>) {
        if (to.col_stride() == 1) {
          std::transform(row, row + image_.cols, to.row(i), as_cell<Cell>);
          continue;
        }
      }
      for (Index j = 0; j < image_.cols; ++j) {
        to(i, j) = as_cell<Cell>(row[j]);
      }
    }
  }

  /// Whether the ring of a pixel sees free membrane alone: no seed here nor a ring's radius away.
  bool is_free(const StridedView<detail::Mark>& marks, Index row, Index col) const {
    bool is_free = marks(row, col) == detail::Mark::free;
    for (const Index i : {row - ring_rows_, row, row + ring_rows_}) {
      for (const Index j : {col - ring_cols_, col, col + ring_cols_}) {
        is_free = is_free && marks(std::clamp(i, Index(0), image_.rows - 1),
                                   std::clamp(j, Index(0), image_.cols - 1)) != detail::Mark::seed;
      }
    }
    return is_free;
  }

  /// The plane of the free membrane's curvature over the image, by least squares over the free
  /// pixels (of every fourth row and column) within three rings around all seeds. That it is level
  /// counts as much as one pixel, which matters where few are free.
  void find_free_plane() {
    const auto marks = regions_.marks();
    Index top = image_.rows, bottom = 0, left = image_.cols, right = 0;  // of the seeds
    for (Index i = 0; i < image_.rows; ++i) {
      for (Index j = 0; j < image_.cols; ++j) {
        if (marks(i, j) == detail::Mark::seed) {
          top = (std::min)(top, i), bottom = i;
          left = (std::min)(left, j), right = (std::max)(right, j);
        }
      }
    }
    top = (std::max)(top - 3 * ring_rows_, Index(0));
    bottom = (std::min)(bottom + 3 * ring_rows_, image_.rows - 1);
    left = (std::max)(left - 3 * ring_cols_, Index(0));
    right = (std::min)(right + 3 * ring_cols_, image_.cols - 1);
    detail::ProductSums<double, 4> sums;  // of 1, row, column, curvature
    sums.add({0, static_cast<double>(bottom - top + 1), 0, 0});
    sums.add({0, 0, static_cast<double>(right - left + 1), 0});
    for (Index i = top; i <= bottom; i += 4) {
      for (Index j = left; j <= right; j += 4) {
        if (is_free(marks, i, j)) {
          sums.add({1, static_cast<double>(i), static_cast<double>(j),
                    static_cast<double>(statistic()(i, j))});
        }
      }
    }
    const detail::NormalEquations<double, 3> equations(sums.corner<3>());
    free_ = equations.good ? equations.solve(sums.column<3>(3))
                           : std::array<double, 3>{2 * test_.threshold_per_mm, 0, 0};
    double sum_sq = sums(3, 3);  // of the deviations from it
    for (std::size_t k = 0; k < 3; ++k) {
      sum_sq -= free_[k] * sums(k, 3);
    }
    // where no free pixel is seen, the edge may lie anywhere within the ring
    free_sd_per_mm_ = sums(0, 0) > 0 ? std::sqrt((std::max)(sum_sq, 0.0) / sums(0, 0))
                                     : std::numeric_limits<double>::infinity();
  }

  /// The curvature of the free membrane at a pixel of the bordered image, 1/mm.
  double free_per_mm(Index at) const {
    const Index pixel = at - image_.at(0, 0);
    return free_[0] + free_[1] * static_cast<double>(pixel / image_.stride()) +
           free_[2] * static_cast<double>(pixel % image_.stride());
  }

  /// Of a round region of the same area.
  double perimeter_mm(const detail::Regions::Region& region, double pixel_mm) const {
    return 2 * pixel_mm *
           std::sqrt(std::numbers::pi * pixel_aspect_ * static_cast<double>(region.pixels()));
  }

  /// Means over a region, from one to two thousand of its pixels, or from all if there are fewer,
  /// and the lower quartile of the mean curvature: a quarter of a disc lies so far inside that its
  /// ring sees only the object, if the disc is twice as wide as the ring.
  struct Inside {
    S quarter;
    double depth_mm, free_per_mm;
  };
  template <class View>
  Inside look_inside(const View& depth_mm, const detail::Regions::Region& region) {
    samples_.clear();
    double depth = 0, outside = 0;
    for (Index k = region.begin; k < region.end; k += region.pixels() / most + 1) {
      const Index at = regions_.pixel(k), pixel = at - image_.at(0, 0);
      depth += static_cast<double>(depth_mm(pixel / image_.stride(), pixel % image_.stride()));
      outside += free_per_mm(at);
      samples_.push_back(mean_[static_cast<std::size_t>(at)]);
    }
    const double count = static_cast<double>(samples_.size());
    const auto quarter = samples_.begin() + static_cast<std::ptrdiff_t>(samples_.size() / 4);
    std::nth_element(samples_.begin(), quarter, samples_.end());
    return {*quarter, depth / count, outside / count};
  }

  struct Edge {
    double area_sd_mm2, pressure_share;
  };

  /// Grows and trims a region to the pixels whose mean curvature is below that of its end. By Young
  /// and Laplace, an object takes the share of the pressure by which the curvature falls.
  template <class View>
  Edge place_edge(const View& depth_mm, detail::Regions::Region& region) {
    Inside found = look_inside(depth_mm, region);
    const double pixel_mm = pitch_mm_ * (1 + growth_per_mm_ * found.depth_mm);
    const double ring_mm = test_.ring_px * pixel_mm;
    const auto radius_mm = [&] {
      return pixel_mm *
             std::sqrt(static_cast<double>(region.pixels()) * pixel_aspect_ / std::numbers::pi);
    };
    double patch_mm = radius_mm();
    if (found.quarter > S(0)) {
      // a hollow or soft object bulges like the membrane, but less: seeds are parts of it only
      regions_.grow(region, image_.size(), [&](Index at) {
        return mean_[static_cast<std::size_t>(at)] < (found.quarter + S(free_per_mm(at))) / S(2);
      });
      if (radius_mm() > 2 * ring_mm) {
        found = look_inside(depth_mm, region);
        patch_mm = radius_mm();
      } else {
        found.quarter = S(0);  // too small to tell: flat
      }
    }
    const S inside = found.quarter;
    const double jump = found.free_per_mm - static_cast<double>(value(inside));
    const auto within = [&](double gap_mm) {
      const S share =
          S(jump > 0 ? detail::share_at_end(jump, gap_mm, ring_mm, patch_mm,
                                            static_cast<double>(spread_cols_) * pixel_mm)
                     : 0.0);
      return [this, share, inside](Index at) {
        return mean_[static_cast<std::size_t>(at)] < inside + share * (S(free_per_mm(at)) - inside);
      };
    };
    const auto touches = within(test_.touching_gap_mm);
    regions_.grow(region, (std::max)(ring_rows_, ring_cols_), touches);
    regions_.trim(region, touches);
    regions_.mark_gap(region, within(0));

    // across a straight edge, the ring's mean rises by 4 / pi of the jump per ring radius; its
    // noise moves stretches of the edge as long as the ring is wide, each by itself
    const double edge_mm = perimeter_mm(region, pixel_mm);
    const double gap_mm = std::sqrt(test_.touching_gap_mm / jump);
    const double moved_mm =
        (std::min)(free_sd_per_mm_ / jump * std::numbers::pi / 4, 1.0) * ring_mm;
    const double stretches = (std::max)(edge_mm / (2 * ring_mm), 1.0);
    return {jump > 0 ? edge_mm * std::sqrt(square(gap_mm) + square(moved_mm) / stretches)
                     : edge_mm * ring_mm,
            inside > S(0) && jump > 0 ? jump / found.free_per_mm : 1};
  }

  Point3<double> point(Index i, Index j, double depth_mm) const {
    const Ray& ray = rays_[static_cast<std::size_t>(i * image_.cols + j)];
    const Point2<double> at = ray.on_plate_mm + depth_mm * ray.per_mm;
    return {at.x, at.y, depth_mm};
  }

  /// Sums over the pixels in contact, each weighted with the area that it sees, projected on the
  /// plate: the differences of its neighbours' points. They are linear along each axis, so that
  /// noise does not add up. An unknown neighbour counts as being as deep as the pixel, and so do
  /// all of them if the surface would be seen from behind, which no camera can do.
  template <class View>
  void measure(const StridedView<detail::Mark>& marks,
               const View& depth_mm,
               ContactResult& result) const {
    using detail::Mark;
    Point3<double> moment = {0, 0, 0};
    double touched_mm2 = 0, height_mm3 = 0;  // with the touching gap
    for (Index i = 0; i < image_.rows; ++i) {
      const Index up = (std::max)(i - 1, Index(0)), down = (std::min)(i + 1, image_.rows - 1);
      const Mark* row = marks.row(i);
      for (Index j = 0; j < image_.cols; ++j) {
        if (row[j] < Mark::contact) {
          continue;
        }
        const Index left = (std::max)(j - 1, Index(0)), right = (std::min)(j + 1, image_.cols - 1);
        const double depth = static_cast<double>(depth_mm(i, j));
        const auto seen = [&](Index r, Index c) {
          const bool known = marks(r, c) != Mark::unknown;
          return point(r, c, known ? static_cast<double>(depth_mm(r, c)) : depth);
        };
        const auto level = [&](Index r, Index c) { return point(r, c, depth); };
        const auto area_of = [&](const auto& seen_at) {
          const auto across = seen_at(i, right) - seen_at(i, left);
          const auto along = seen_at(down, j) - seen_at(up, j);
          return (across.x * along.y - across.y * along.x) /
                 static_cast<double>((right - left) * (down - up));
        };
        const double area = area_of(seen), positive_area = area > 0 ? area : area_of(level);
        touched_mm2 += positive_area;
        height_mm3 += positive_area * depth;
        if (row[j] == Mark::contact) {
          result.area_mm2 += positive_area;
          moment += positive_area * point(i, j, depth);
        }
      }
    }
    if (result.in_contact()) {
      result.center_mm = {moment.x / result.area_mm2, moment.y / result.area_mm2,
                          height_mm3 / touched_mm2};
      result.depth_mm = test_.free_apex_mm - result.center_mm.z;
    }
  }

  /// Where nothing is known, nothing is free either. An apex of 0 or less is not compared.
  bool is_of_this_pad(const ContactResult& result) const {
    if (result.unknown_px == rows() * cols()) {
      return false;
    }
    const double apex = test_.free_apex_mm, height = result.center_mm.z;
    return !result.in_contact() || !(apex > 0) || (apex < 20 * height && height < 20 * apex);
  }

  static constexpr Index most = 2000;  // samples of a region

  struct Ray {
    Point2<double> on_plate_mm, per_mm;
  };
  ContactTest test_;
  double pitch_mm_, pixel_aspect_;
  double growth_per_mm_;
  Index ring_cols_, ring_rows_;      // the ring's radius in whole pixels
  Index spread_cols_, spread_rows_;  // a third of it smooths noise without moving the edge
  detail::BorderedImage image_;
  detail::Regions regions_;
  CurvatureMap<S> curvature_;
  std::array<double, 3> free_ = {};        // plane of the free membrane's curvature: 1, row, column
  double free_sd_per_mm_ = 0;              // of the curvature about it
  std::vector<S> statistic_, raw_, mean_;  // curvatures: clamped, plain, smoothed
  detail::ReservedVector<S> samples_{2 * most};
  detail::SharedVector<Ray> rays_;
};

}  // namespace v1
}  // namespace fingerpad
