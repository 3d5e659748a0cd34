// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Where the object touches the pad, from the depth map. A free membrane under pressure bulges
// outward (Young and Laplace: sigma1 K1 + sigma2 K2 = p > 0). Where it is flat or dented in all
// directions, an object presses on it.
// Source: Ito et al. 2011, III.B, eqs. 1-12, and the slides, contact region. Published and
// corrected forms in docs/errata.md, E012-E018.
//
// Parts: the mean curvature (image/curvature.hpp), threshold and edge (contact/contact_test.hpp),
// the level of the edge (contact/edge_level.hpp).
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "fingerpad/contact/contact_test.hpp"
#include "fingerpad/contact/detail/edge_finder.hpp"
#include "fingerpad/contact/detail/region_measures.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/status.hpp"
#include "fingerpad/image/curvature.hpp"
#include "fingerpad/image/detail/pixel_box.hpp"
#include "fingerpad/image/detail/pixel_rays.hpp"
#include "fingerpad/image/detail/regions.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// The contact of a frame. Without contact, areas are 0 and all other values NaN.
///
/// `not_of_this_pad` means one of these: no pixel of the frame is known; the mean height of the
/// contact is a twentieth of the free apex or less, or twenty times it or more, as with depths in m
/// (contact_region.hpp); at least half of the frame and half of its border are in contact
/// (contact_by_difference.hpp).
struct [[nodiscard]] ContactResult {
  FrameStatus status = FrameStatus::refused;
  Index contact_px = 0;  ///< pixels in contact
  Index unknown_px = 0;  ///< pixels without depth, or with too few neighbours to decide
  Index regions = 0;     ///< connected parts of the contact
  double area_mm2 = 0;   ///< of the contact, at its depth, projected on the plate
  Point3<double> center_mm = {not_a_number<double>(), not_a_number<double>(),
                              not_a_number<double>()};  ///< centroid of that area
  double depth_mm = not_a_number<double>();  ///< D: free apex height less mean height of contact

  bool accepted() const { return status != FrameStatus::refused; }
  bool ok() const { return status == FrameStatus::ok; }
  bool in_contact() const { return contact_px > 0; }
};

/// The contact region of depth maps of one size.
///   Edge        HalfLevelEdge       use it when the area matters
///               AtThreshold         use it when only the place of the contact matters
///   CameraType  Camera<double>      use it for depth maps along a camera's rays
///               OrthographicCamera  use it for height maps
/// published/contact_region.hpp is the test as printed.
/// A pixel without depth is never contact. A pixel whose ring is partly missing is judged by the
/// remaining directions; if these are too few (ContactTest::ring) it is unknown.
///
/// Threads may share one object, each with its own workspace. Bounded time and no allocation per
/// frame; O(rows cols directions).
template <class Edge = HalfLevelEdge, class CameraType = Camera<double>, scalar S = float>
class ContactRegion {
  static_assert(!scalar<Edge>,
                "the scalar comes last: ContactRegion<HalfLevelEdge, Camera<double>, double>");

  using Finder = detail::EdgeFinder<Edge, S>;

 public:
  /// Refuses bad parameters (parameter_error).
  ContactRegion(const CameraType& camera,
                Index rows,
                Index cols,
                const ContactTest& test = {},
                const Edge& edge = {})
      : test_(checked(camera, rows, cols, test, edge)),
        image_{rows, cols},
        curvature_(camera, rows, cols, test.ring),
        finder_(edge, test, camera, image_),
        rays_(camera, rows, cols) {}

  /// Scratch memory for a frame; one per thread.
  class Workspace {
   public:
    explicit Workspace(const ContactRegion& region)
        : regions_(region.image_),
          curvature_(region.curvature_),
          ring_(region.test_.ring),
          statistic_(static_cast<std::size_t>(region.image_.size()), not_a_number<S>()),
          finder_(region.finder_.workspace()) {}

    /// The statistic of the last frame, 1/mm; NaN where it is unknown.
    StridedView<const S> statistic() const { return regions_.image().view(statistic_.data()); }

   private:
    friend class ContactRegion;
    detail::Regions regions_;
    CurvatureMap<S> curvature_;
    CurvatureRing ring_;
    std::vector<S> statistic_;
    typename Finder::Workspace finder_;
  };
  Workspace workspace() const { return Workspace(*this); }

  /// Finds the contact in a depth map in mm. Cells of `mask` become a Touch if they are of that
  /// type, else 255 (or true) in contact and 0 elsewhere.
  template <grid Depth, class Mask>
  ContactResult operator()(const Depth& depth_mm, Mask&& mask, Workspace& w) const {
    detail::writes_to<Mask>();
    ContactResult result;
    const auto depth = as_view(depth_mm);
    const auto to = as_view(mask);
    if (!has_size(depth) || !has_size(to) || w.regions_.image() != image_ ||
        w.ring_ != test_.ring) {
      return result;
    }
    const auto statistic = image_.view(w.statistic_.data());
    result.unknown_px = w.curvature_(depth, statistic).unknown_px;
    mark_seeds(statistic, w.regions_.marks());
    const auto keep = [this](const detail::Regions::Region& region) {
      return region.pixels() >= test_.min_region_px;
    };
    result.regions = finder_(depth, w.statistic_.data(), w.curvature_, keep, w.regions_, w.finder_);
    write(w.regions_.marks(), to);
    measure(w.regions_.marks(), depth, result);
    result.status = is_of_this_pad(result) ? FrameStatus::ok : FrameStatus::not_of_this_pad;
    return result;
  }

  Index rows() const { return image_.rows; }
  Index cols() const { return image_.cols; }

 private:
  static const ContactTest& checked(
      const CameraType& camera, Index rows, Index cols, const ContactTest& test, const Edge& edge) {
    expects_grid_size("ContactRegion", rows, cols, 2);  // areas need a neighbour
    require(camera);
    expects_valid(test);
    expects_valid(edge);
    using C = decltype(camera.pitch_mm);
    for (const double end : {0.0, 1.0}) {  // first and last pixel
      const auto corner = point_at(camera, C(end * static_cast<double>(rows - 1)),
                                   C(end * static_cast<double>(cols - 1)), C(0));
      expects(is_plausible(corner), "ContactRegion", "camera: corner of the image, mm",
              value(corner.x) + value(corner.y), "less than a million from the axis");
    }
    return test;
  }

  template <class G>
  bool has_size(const G& g) const {
    return g.rows() == image_.rows && g.cols() == image_.cols;
  }

  template <class View, class Marks>
  void mark_seeds(const View& statistic, const Marks& marks) const {
    const S threshold = S(test_.threshold_per_mm);
    for (Index i = 0; i < image_.rows; ++i) {
      detail::mark_below(threshold, statistic.row(i), image_.cols, marks.row(i));
    }
  }

  template <class Cell>
  static Cell as_cell(detail::Mark mark) {
    using detail::Mark;
    if constexpr (std::is_same_v<Cell, Touch>) {
      const Touch other = mark == Mark::unknown ? Touch::unknown : Touch::none;
      return mark == Mark::contact ? Touch::contact : other;
    } else {
      return static_cast<Cell>(mark == Mark::contact ? 255 : 0);
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

  template <class View>
  void measure(const StridedView<detail::Mark>& marks,
               const View& depth_mm,
               ContactResult& result) const {
    const detail::RegionMeasures sums(marks, depth_mm, rays_);
    result.contact_px = sums.pixels();
    if (result.in_contact()) {
      result.area_mm2 = sums.area_mm2();
      result.center_mm = sums.center_mm();
      result.depth_mm = test_.free_apex_mm - result.center_mm.z;
    }
  }

  /// Where nothing is known, nothing is free either. Of an apex that is not one nothing is said.
  bool is_of_this_pad(const ContactResult& result) const {
    if (result.unknown_px == rows() * cols()) {
      return false;
    }
    const double apex = test_.free_apex_mm, height = result.center_mm.z;
    return !result.in_contact() || !(apex > 0) || (apex < 20 * height && height < 20 * apex);
  }

  ContactTest test_;
  detail::BorderedImage image_;
  CurvatureMap<S> curvature_;
  Finder finder_;
  detail::PixelRays<CameraType> rays_;
};

}  // namespace v0
}  // namespace fingerpad
