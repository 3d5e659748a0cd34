// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Rows of dots printed around the rim of a pad, beside a printed grid or without one. On the free
// pad each row is a ring; from frame to frame its dots are followed like those of dot_follower.hpp:
// each is expected where its last motion and its neighbours' motion put it, and its disc, deformed
// as its neighbours and the clamped rim say, is fitted to the pixels. What is hidden, merges,
// reflects or is blurred into the rim is lost, not guessed.
//
//   const SideRow rows[] = {{72, 2, 0.5, 0}, {72, 4, 0.5, pi / 72}, {72, 6, 0.5, 0}};
//   SideDots side(green_of_free_frame, camera, base_radius_mm, rows);
//   if (side.ok() && side(green_of_frame).ok()) { ... side.px()[k], side.sd_px()[k] ... }
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/dots/detail/mark_follower.hpp"
#include "fingerpad/dots/detail/side_rings.hpp"
#include "fingerpad/dots/dot_follower.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

/// Equally spaced dots at one distance from the rim.
struct SideRow {
  Index count = 72;            ///< in [12, 1000]
  double arc_mm = 2;           ///< from the rim along the membrane without stress, in (0, 100]
  double diameter_mm = 0.5;    ///< in (0, 10]
  double first_angle_rad = 0;  ///< azimuth of dot 0, from x to y, right to a quarter of a spacing
};

inline std::string check(const SideRow& row) {
  return check("SideRow",
               {{"count", row.count, within(12, 1000)},
                {"arc_mm", row.arc_mm, {.min = 0, .max = 100, .above_min = true}},
                {"diameter_mm", row.diameter_mm, {.min = 0, .max = 10, .above_min = true}},
                {"first_angle_rad", row.first_angle_rad, within(-10, 10)}});
}

/// The object is the state: copy it to return to a frame. One object a thread. A frame with fewer
/// than half of the dots is lost: none is told, and the next frame begins anew.
class SideDots {
 public:
  using Point = Point2<double>;

  /// `free_image` shows the free pad in one channel; `rows` have growing arcs. The pad's axis is
  /// the camera's to within a third of a spacing. ok() is false if the image does not show the
  /// rows. Refuses bad rows (parameter_error). Takes some tenths of a second.
  template <grid Image>
  SideDots(const Image& free_image,
           const Camera<double>& camera,
           double base_radius_mm,
           std::span<const SideRow> rows)
      : image_rows_(fingerpad::rows(free_image)), image_cols_(fingerpad::cols(free_image)) {
    require(camera);
    require("SideDots", {{"base_radius_mm", base_radius_mm, positive},
                         {"rows", static_cast<long long>(rows.size()), within(1, 20)}});
    std::size_t all = 0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      require(rows[r]);
      expects(r == 0 || rows[r].arc_mm > rows[r - 1].arc_mm, "SideDots", "arc_mm", rows[r].arc_mm,
              "more than that of the row before");
      all += static_cast<std::size_t>(rows[r].count);
    }
    px_.assign(all, detail::MarkFollower::missing());
    sd_px_.assign(all, not_a_number<double>());
    refusal_ = learn(as_view(free_image), {camera, base_radius_mm, rows});
    px_ = free_px();
  }

  /// Whether the free image showed the rows; else why not.
  bool ok() const { return refusal_.empty(); }
  const std::string& refusal() const { return refusal_; }

  /// The dots of the next frame: px() and sd_px(). O(dots x pixels of a dot); allocates nothing.
  template <grid Image>
  DotFollowerResult operator()(const Image& image) {
    if (!ok() || fingerpad::rows(image) != image_rows_ || fingerpad::cols(image) != image_cols_) {
      return {};
    }
    DotFollowerResult result;
    result.expected = dots_.count();
    const bool good = 2 * dots_.look(as_view(image)) >= result.expected;
    result.status = good ? DotFollowerStatus::ok : DotFollowerStatus::lost;
    dots_.keep(good);
    for (std::size_t k = 0; k < px_.size(); ++k) {
      const bool found = dots_[k].found && is_clear_of_rim(dots_[k], rim_px_[k]);
      px_[k] = found ? dots_[k].place : detail::MarkFollower::missing();
      sd_px_[k] = found ? dots_[k].sd_px : not_a_number<double>();
      result.found += found ? 1 : 0;
    }
    if (!good) {
      dots_.expect([](std::size_t) { return detail::MarkFollower::missing(); });
    }
    return result;
  }

  /// Of the last frame, row by row; NaN for a lost dot. First those of the free pad.
  std::span<const Point> px() const { return px_; }
  /// Standard deviation along x and along y, px, from the dot's own residual as if the noise of
  /// neighbouring pixels were independent; NaN if lost.
  std::span<const double> sd_px() const { return sd_px_; }
  /// The free pad's dots; NaN for those that it does not show.
  std::vector<Point> free_px() const {
    std::vector<Point> places;
    for (std::size_t k = 0; k < px_.size(); ++k) {
      places.push_back(dots_[k].free);
    }
    return places;
  }
  /// The longer half axis of a dot on the free pad, with its blurred edge, px.
  double reach_px() const {
    double reach_px = 0;
    for (std::size_t k = 0; k < px_.size(); ++k) {
      reach_px = dots_[k].exists ? (std::max)(reach_px, norm(dots_[k].map.jb)) : reach_px;
    }
    return reach_px + dots_.edge_px();
  }

 private:
  using Rings = detail::SideRings<SideRow>;
  using Mark = detail::MarkFollower::Mark;

  /// Whether the blurred edge of a disc ends before that of the rim, beyond which it is dark: the
  /// fit would take that for a slope of the light and put the center inward.
  bool is_clear_of_rim(const Mark& m, const Point& rim_px) const {
    const Point gap = rim_px - m.place;
    const double half_px = std::hypot(dot(m.map.ja, gap), dot(m.map.jb, gap)) / norm(gap);
    return norm(gap) > half_px + 2 * dots_.edge_px();
  }

  /// A row of dots on its ring.
  struct Ring {
    const Rings& rings;
    const SideRow& row;
    double rho_mm;
    std::size_t count = static_cast<std::size_t>(row.count);

    Point at(double k) const { return rings.at(rho_mm, Rings::angle(row, k)); }
    Point outward(double k) const {
      const Point out = rings.at(rho_mm + 0.01, Rings::angle(row, k)) - at(k);
      return out / norm(out);
    }
    double spacing_px() const { return norm(at(1) - at(0)); }
    /// Along outward() and around, how far dot k is off the ring.
    Point off(std::size_t k, const Point& px) const {
      const Point out = outward(double(k)), off = px - at(double(k));
      return {dot(off, out), out.x * off.y - out.y * off.x};
    }
    /// The median of what the dots beside dot k are off; NaN if they are few.
    Point off_beside(const std::vector<Point>& offs, std::size_t k) const {
      std::vector<double> xs, ys;
      for (std::size_t step = 1; step <= 4; ++step) {
        for (const Point& off : {offs[(k + step) % count], offs[(k + count - step) % count]}) {
          if (is_finite(off)) {
            xs.push_back(off.x);
            ys.push_back(off.y);
          }
        }
      }
      return xs.size() < 3 ? detail::MarkFollower::missing()
                           : Point{detail::median(xs), detail::median(ys)};
    }
  };

  /// Finds the rows on the free pad; why not, or "".
  template <class View>
  std::string learn(const View& image, const Rings& rings) {
    const std::vector<double> radii = rings.radii(image);
    std::vector<detail::MarkFollower::Start> starts;
    for (std::size_t r = 0; r < radii.size(); ++r) {
      add_starts(image, Ring{rings, rings.rows[r], radii[r]}, r, starts);
    }
    dots_.learn(image, starts);
    std::size_t first = 0;
    for (std::size_t r = 0; r < radii.size(); ++r) {
      const Ring ring{rings, rings.rows[r], radii[r]};
      for (std::size_t k = 0; k < ring.count; ++k) {
        rim_px_.push_back(rings.at(rings.base_radius_mm, Rings::angle(ring.row, double(k))));
      }
      const std::size_t seen = drop_strange(ring, first);
      if (2 * seen < ring.count) {
        return detail::print("the row of side dots at %g mm from the rim shows %d of %d dots",
                             ring.row.arc_mm, static_cast<int>(seen), static_cast<int>(ring.count));
      }
      first += ring.count;
    }
    for (Index k = 0; k < rings.rows[0].count; ++k) {  // the clamped rim is a neighbour, too
      dots_.add_still(Ring{rings, rings.rows[0], rings.base_radius_mm}.at(double(k)));
    }
    dots_.connect();
    return "";
  }

  /// The dots of a row are looked for where the ring is darkest nearby, as those beside each other
  /// agree. Their shape is a first guess.
  template <class View>
  static void add_starts(const View& image,
                         const Ring& ring,
                         std::size_t row,
                         std::vector<detail::MarkFollower::Start>& to) {
    const Camera<double>& camera = ring.rings.camera;
    const double radius_px = ring.row.diameter_mm / 2 / camera.pitch_mm;
    const double half_px = 0.45 * ring.spacing_px();
    const double rim_px = (ring.rings.base_radius_mm - ring.rho_mm) / camera.pitch_mm;
    std::vector<Point> offs;
    for (std::size_t k = 0; k < ring.count; ++k) {
      const double light = 0.5 * (detail::light_at(image, ring.at(double(k) - 0.5)) +
                                  detail::light_at(image, ring.at(double(k) + 0.5)));
      const Point dark = detail::darkest(image, 0.75 * light, 1, ring.at(double(k)),
                                         (std::min)(half_px, rim_px - 2));
      offs.push_back(ring.off(k, dark));
    }
    for (std::size_t k = 0; k < ring.count; ++k) {
      const Point out = ring.outward(double(k)), around = {-out.y, out.x};
      const Point off = ring.off_beside(offs, k);
      to.push_back({ring.at(double(k)) + off.x * out + off.y * around,
                    {0.7 * radius_px * out, radius_px * around},
                    half_px,
                    row});
    }
  }

  /// Leaves out what is not as large and as dark as the row's dots, or does not lie as the dots
  /// beside it do: a dot of the grid, dirt. How many are left.
  std::size_t drop_strange(const Ring& ring, std::size_t first) {
    const auto size = [](const Mark& m) {
      return std::fabs(m.map.ja.x * m.map.jb.y - m.map.ja.y * m.map.jb.x);
    };
    std::vector<double> sizes, contrasts;
    std::vector<Point> offs;
    for (std::size_t k = 0; k < ring.count; ++k) {
      const Mark& m = dots_[first + k];
      offs.push_back(ring.off(k, m.free));
      if (m.exists) {
        sizes.push_back(size(m));
        contrasts.push_back(m.contrast);
      }
    }
    const double usual = detail::median(sizes), dark = detail::median(contrasts);
    std::size_t left = 0;
    for (std::size_t k = 0; k < ring.count; ++k) {
      const Mark& m = dots_[first + k];
      const double share = size(m) / usual, tone = m.contrast / dark;
      const bool alike = share > 0.7 && share < 1.4 && tone > 0.6 && tone < 1.5;
      const double off_px = norm(offs[k] - ring.off_beside(offs, k));
      if (m.exists && dark > 0.05 && alike && off_px < 0.15 * ring.spacing_px()) {
        ++left;
      } else {
        dots_.drop(first + k);
      }
    }
    return left;
  }

  Index image_rows_, image_cols_;
  detail::MarkFollower dots_{18};  ///< the dots, then the rim
  std::vector<Point> rim_px_;      ///< nearest to each dot of the free pad
  std::vector<Point> px_;
  std::vector<double> sd_px_;
  std::string refusal_;
};

}  // namespace v1
}  // namespace fingerpad
