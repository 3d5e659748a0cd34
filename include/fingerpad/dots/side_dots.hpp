// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Rows of dots printed around the rim of a pad, beside a printed grid or without one. On the free
// pad each row is a ring; from frame to frame its dots are followed like those of dot_follower.hpp:
// each is expected where its last motion and its neighbours' motion put it, and its disc, deformed
// as its neighbours and the clamped rim say, is fitted to the pixels. What is hidden, merges or
// reflects is lost, not guessed.
//
//   const SideRow rows[] = {{72, 2, 0.5, 0}, {72, 4, 0.5, pi / 72}, {72, 6, 0.5, 0}};
//   SideDots side(green_of_free_frame, camera, base_radius_mm, rows);
//   if (side.ok() && side(green_of_frame).ok()) { ... side.px()[k], side.sd_px()[k] ... }
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/dots/detail/dot_locator.hpp"
#include "fingerpad/dots/detail/side_rings.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

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

enum class SideDotsStatus : std::uint8_t {
  ok,
  lost,     ///< fewer than half of the dots: none is told, and the next frame begins anew
  refused,  ///< image of another size, or the free image did not show the rows
};
inline constexpr std::array<const char*, 3> side_dots_status_names = {"ok", "lost", "refused"};

struct [[nodiscard]] SideDotsResult {
  SideDotsStatus status = SideDotsStatus::refused;
  Index found = 0;     ///< dots located in this frame
  Index expected = 0;  ///< dots located on the free pad

  bool ok() const { return status == SideDotsStatus::ok; }
};

/// The object is the state: copy it to return to a frame. One object a thread.
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
    const Rings rings{camera, base_radius_mm, rows};
    marks_.resize(all);
    px_.assign(all, missing());
    sd_px_.assign(all, not_a_number<double>());
    residuals_.resize(all);
    refusal_ = learn(as_view(free_image), rings);
    px_ = free_px();
  }

  /// Whether the free image showed the rows; else why not.
  bool ok() const { return refusal_.empty(); }
  const std::string& refusal() const { return refusal_; }

  /// The dots of the next frame: px() and sd_px(). O(dots x pixels of a dot); allocates nothing.
  template <grid Image>
  SideDotsResult operator()(const Image& image) {
    if (!ok() || fingerpad::rows(image) != image_rows_ || fingerpad::cols(image) != image_cols_) {
      return {};
    }
    return look(as_view(image));
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
      places.push_back(marks_[k].exists ? marks_[k].free : missing());
    }
    return places;
  }
  /// The longer half axis of a dot on the free pad, with its blurred edge, px.
  double reach_px() const { return reach_px_; }

 private:
  static constexpr std::size_t around = 18;  ///< neighbours that say how the print is deformed
  static constexpr std::size_t terms = 6;    ///< of a polynomial of second order
  static constexpr int tries = 8;            ///< in which lost dots are tried again
  static constexpr double max_off = 0.3;     ///< distances to the next dot
  static constexpr double max_jump = 0.45;   ///< between a dot and the row before, likewise
  static constexpr double bias_px = 0.01;    ///< rms of the centers in pictures without noise

  struct Mark {
    bool exists = false;  ///< on the free pad
    bool found = false;   ///< in this frame
    bool placed = false;  ///< in this frame, found or not
    Point free = missing(), last = missing(), velocity = {0, 0};
    Point place = missing();  ///< found, else where it would be
    Point news = {0, 0};      ///< place less what last motion made expect
    detail::DiscMap map = {{1, 0}, {0, 1}};
    Point slope = {0, 0};
    double contrast = 0, light = 0, residual = 0, residual_ratio = 0;  ///< as in DotFollower
    double next_px = 0;                                                ///< distance to the next dot
    double look_px = 0;  ///< so far around a dot it may be looked for: beyond the rim it is dark
    double sd_px = 0;
    std::size_t row = 0;  ///< its first dot
    /// Displacement and its first and second derivatives by disc coordinates: weights of the
    /// neighbours' displacements.
    std::array<std::size_t, around> neighbours = {};
    std::array<std::array<double, around>, terms> weights = {};
  };
  using Displacement = std::array<Point, terms>;

  using Rings = detail::SideRings<SideRow>;

  static constexpr Point missing() { return {not_a_number<double>(), not_a_number<double>()}; }

  /// Finds the rows on the free pad; why not, or "".
  template <class View>
  std::string learn(const View& image, const Rings& rings) {
    const std::vector<double> radii = rings.radii(image);
    for (const bool free_edge : {true, false}) {  // one blur for all dots
      std::vector<double> edges;
      std::size_t first = 0;
      for (std::size_t r = 0; r < radii.size(); ++r) {
        const auto count = static_cast<std::size_t>(rings.rows[r].count);
        for (std::size_t k = 0; k < count; ++k) {
          marks_[first + k].row = first;
          const double edge = learn_dot(image, rings, r, radii[r], k, first + k, free_edge);
          if (marks_[first + k].exists) {
            edges.push_back(edge);
          }
        }
        drop_strange(first, count);
        const auto seen = std::count_if(marks_.begin() + std::ptrdiff_t(first),
                                        marks_.begin() + std::ptrdiff_t(first + count),
                                        [](const Mark& m) { return m.exists; });
        if (2 * seen < std::ptrdiff_t(count)) {
          return detail::print("the row of side dots at %g mm from the rim shows %d of %d dots",
                               rings.rows[r].arc_mm, static_cast<int>(seen),
                               static_cast<int>(count));
        }
        first += count;
      }
      edge_px_ = free_edge ? median(edges) : edge_px_;
    }
    for (Mark& m : marks_) {
      expected_ += m.exists ? 1 : 0;
      m.place = m.last = m.free;
      reach_px_ = m.exists ? (std::max)(reach_px_, norm(m.map.jb) + edge_px_) : reach_px_;
    }
    add_rim(rings);
    for (std::size_t k = 0; k < px_.size(); ++k) {
      if (marks_[k].exists && !weigh_neighbours(k)) {
        marks_[k].exists = false;
        --expected_;
      }
    }
    return "";
  }

  /// Fits the disc of one dot with its shape.
  template <class View>
  double learn_dot(const View& image,
                   const Rings& rings,
                   std::size_t r,
                   double rho_mm,
                   std::size_t k,
                   std::size_t to,
                   bool free_edge) {
    const SideRow& row = rings.rows[r];
    const double angle = Rings::angle(row, static_cast<double>(k));
    const Point at = rings.at(rho_mm, angle), out = rings.at(rho_mm + 0.01, angle) - at;
    const Point outward = out / norm(out);
    const double radius_px = row.diameter_mm / 2 / rings.camera.pitch_mm;
    const double spacing_px =
        2 * std::numbers::pi * rho_mm / rings.camera.pitch_mm / static_cast<double>(row.count);
    Mark& m = marks_[to];
    Point start = at;
    if (free_edge) {
      m.next_px = spacing_px;
      m.look_px =
          (std::min)(0.45 * spacing_px, norm(rings.at(rings.base_radius_mm, angle) - at) - 2);
      m.light = 0;
      for (const double beside : {-0.5, 0.5}) {
        m.light +=
            0.5 * detail::light_at(
                      image, rings.at(rho_mm, Rings::angle(row, static_cast<double>(k) + beside)));
      }
      start = detail::darkest(image, 0.75 * m.light, 1, at, m.look_px);
    } else if (is_finite(m.free)) {
      start = m.free;
    }
    m.map = {0.7 * radius_px * outward, radius_px * Point{-outward.y, outward.x}};
    double edge_px = free_edge ? 1.5 : edge_px_;
    const detail::DiscFit fit = locator_.fit_shape(image, start, m.map, edge_px, free_edge);
    m.exists = fit.good && fit.contrast > 0.05 && norm(fit.center - at) < 0.45 * spacing_px;
    m.free = m.exists ? fit.center : missing();
    m.slope = fit.slope;
    m.light = m.exists ? fit.light : m.light;
    m.contrast = fit.contrast;
    m.residual = fit.residual / std::fabs(fit.contrast * fit.light);
    m.news = Point{dot(fit.center - at, outward),
                   outward.x * (fit.center - at).y - outward.y * (fit.center - at).x};
    return edge_px;
  }

  /// Leaves out what is not as large and as dark as the row's dots, or does not lie as the dots
  /// beside it do: a dot of the grid, dirt.
  void drop_strange(std::size_t first, std::size_t count) {
    std::vector<double> sizes, contrasts;
    const auto size = [](const Mark& m) {
      return std::fabs(m.map.ja.x * m.map.jb.y - m.map.ja.y * m.map.jb.x);
    };
    for (std::size_t k = first; k < first + count; ++k) {
      if (marks_[k].exists) {
        sizes.push_back(size(marks_[k]));
        contrasts.push_back(marks_[k].contrast);
      }
    }
    const double usual = median(sizes), dark = median(contrasts);
    std::vector<char> strange(count, 0);
    for (std::size_t k = 0; k < count; ++k) {
      const Mark& m = marks_[first + k];
      std::vector<double> xs, ys;
      for (std::size_t step = 1; step <= 4; ++step) {
        for (const std::size_t other : {(k + step) % count, (k + count - step) % count}) {
          if (marks_[first + other].exists) {
            xs.push_back(marks_[first + other].news.x);
            ys.push_back(marks_[first + other].news.y);
          }
        }
      }
      const double share = size(m) / usual, tone = m.contrast / dark;
      const bool alike = share > 0.7 && share < 1.4 && tone > 0.6 && tone < 1.5;
      const Point off = xs.size() < 3 ? missing() : m.news - Point{median(xs), median(ys)};
      strange[k] = !alike || !(norm(off) < 0.15 * m.next_px) ? 1 : 0;
    }
    for (std::size_t k = 0; k < count; ++k) {
      Mark& m = marks_[first + k];
      m.exists = m.exists && strange[k] == 0;
      m.free = m.exists ? m.free : missing();
    }
  }

  /// The clamped rim does not move: it is a neighbour, too.
  void add_rim(const Rings& rings) {
    const SideRow& row = rings.rows.front();
    for (Index k = 0; k < row.count; ++k) {
      Mark m;
      m.exists = m.placed = true;
      m.free = m.last = m.place =
          rings.at(rings.base_radius_mm, Rings::angle(row, static_cast<double>(k)));
      marks_.push_back(m);
    }
  }

  /// Mean displacement of the neighbours nearer to the rim, whose dots cannot be confused.
  Point outer_displacement(const Mark& m) const {
    Point sum = {0, 0};
    double count = 0;
    for (const std::size_t n : m.neighbours) {
      if (n < m.row || n >= px_.size()) {
        sum += marks_[n].place - marks_[n].free;
        count += 1;
      }
    }
    return count > 0 ? sum / count : sum;
  }

  /// The nearest neighbours by distance on the print, a third of them of the own row, and least
  /// squares of a polynomial.
  bool weigh_neighbours(std::size_t k) {
    Mark& m = marks_[k];
    const double det = m.map.ja.x * m.map.jb.y - m.map.ja.y * m.map.jb.x;
    const auto on_print = [&](const Point& px) {
      const Point off = px - m.free;
      return Point{(off.x * m.map.jb.y - off.y * m.map.jb.x) / det,
                   (m.map.ja.x * off.y - m.map.ja.y * off.x) / det};
    };
    std::vector<std::size_t> others;
    for (std::size_t n = 0; n < marks_.size(); ++n) {
      if (n != k && marks_[n].exists) {
        others.push_back(n);
      }
    }
    std::sort(others.begin(), others.end(), [&](std::size_t a, std::size_t b) {
      return norm(on_print(marks_[a].free)) < norm(on_print(marks_[b].free));
    });
    m.next_px = (std::numeric_limits<double>::infinity)();
    std::size_t chosen = 0, own = 0;
    for (const std::size_t other : others) {
      const bool of_row = other < px_.size() && marks_[other].row == m.row;
      if (chosen < around && (!of_row || own < around / 3)) {
        m.neighbours[chosen++] = other;
        own += of_row ? 1 : 0;
        const double off_px = norm(marks_[other].free - m.free);
        m.next_px = other < px_.size() ? (std::min)(m.next_px, off_px) : m.next_px;
      }
    }
    if (chosen < around) {
      return false;
    }
    const double scale = norm(on_print(marks_[m.neighbours[around / 2]].free));
    std::array<std::array<double, terms>, around> rows;
    std::array<double, around> weight;
    detail::SmallMatrix<double, terms> normal = detail::zero_matrix<double, terms>();
    for (std::size_t n = 0; n < around; ++n) {
      const Point v = on_print(marks_[m.neighbours[n]].free) / scale;
      rows[n] = {1, v.x, v.y, v.x * v.x / 2, v.x * v.y, v.y * v.y / 2};
      weight[n] = 1 / (0.25 + dot(v, v));
      for (std::size_t i = 0; i < terms; ++i) {
        for (std::size_t j = 0; j < terms; ++j) {
          normal[i][j] += weight[n] * rows[n][i] * rows[n][j];
        }
      }
    }
    for (std::size_t i = 3; i < terms; ++i) {  // neighbours in two lines say nothing of a bend
      normal[i][i] += 0.01;
    }
    const detail::NormalEquations<double, terms> equations(normal);
    const std::array<double, terms> unit = {
        1, 1 / scale, 1 / scale, square(1 / scale), square(1 / scale), square(1 / scale)};
    for (std::size_t n = 0; n < around && equations.good; ++n) {
      const auto column = equations.solve(rows[n]);
      for (std::size_t i = 0; i < terms; ++i) {
        m.weights[i][n] = column[i] * weight[n] * unit[i];
      }
    }
    return equations.good && is_finite(m.next_px);
  }

  /// How the neighbours are displaced from the free pad; those not placed yet are taken to have
  /// this dot's news.
  Displacement displacement(const Mark& m) const {
    Displacement d{};
    for (std::size_t n = 0; n < around; ++n) {
      const Mark& other = marks_[m.neighbours[n]];
      const Point at = other.placed ? other.place : other.last + other.velocity + m.news;
      for (std::size_t i = 0; i < terms; ++i) {
        d[i] += m.weights[i][n] * (at - other.free);
      }
    }
    return d;
  }

  template <class View>
  SideDotsResult look(const View& image) {
    const auto count = px_.size();
    if (noise_ == 0) {  // how much noisier frames are than the free picture
      noise_ = (std::numeric_limits<double>::infinity)();
      (void)pass(image);
      keep_noise();
    }
    Index found = pass(image);
    for (std::size_t k = 0; k < count; ++k) {
      Mark& m = marks_[k];
      if (m.found && norm(m.place - m.free - displacement(m)[0]) > max_off * m.next_px) {
        m.found = false;
        --found;
      }
    }
    const bool good = 2 * found >= expected_;
    if (good) {
      keep_noise();
    }
    for (std::size_t k = 0; k < count; ++k) {
      Mark& m = marks_[k];
      if (m.exists && !m.found) {
        m.place = m.free + displacement(m)[0];
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      Mark& m = marks_[k];
      m.velocity = good ? m.place - m.last : Point{0, 0};
      m.last = good ? m.place : m.free;
      m.found = m.found && good;
      px_[k] = m.found ? m.place : missing();
      sd_px_[k] = m.found ? m.sd_px : not_a_number<double>();
    }
    return {good ? SideDotsStatus::ok : SideDotsStatus::lost, found, expected_};
  }

  /// Looks for all dots, from the rim inward; how many are found. Those lost are tried again where
  /// their neighbours put them, as long as that finds any.
  template <class View>
  Index pass(const View& image) {
    const auto count = px_.size();
    for (std::size_t k = 0; k < count; ++k) {
      marks_[k].found = marks_[k].placed = false;
    }
    Index found = 0, before = -1;
    for (int round = 0; round < tries && found < expected_ && (round < 3 || found > before);
         ++round) {
      before = found;
      for (std::size_t k = 0; k < count; ++k) {
        Mark& m = marks_[k];
        if (m.exists && !m.found) {
          m.news = news_of_neighbours(m, round == 0);
          m.place = m.last + m.velocity + m.news;
          found += locate(image, m, round > 1) ? 1 : 0;
        }
      }
    }
    for (std::size_t k = 0; k < count; ++k) {  // with the shape that all neighbours give
      if (marks_[k].found && norm(marks_[k].news) > 0.25) {
        found -= locate(image, marks_[k], false) ? 0 : 1;
      }
    }
    return found;
  }

  /// What a dot's neighbours say of its motion beyond the last: the mean of their news, or of their
  /// motion where the last motion may have misled; of the row before if none is found.
  Point news_of_neighbours(const Mark& m, bool moves_on) const {
    Point sum = {0, 0};
    double count = 0;
    for (const std::size_t n : m.neighbours) {
      const Mark& other = marks_[n];
      if (other.found && n < px_.size()) {
        sum += moves_on ? other.news : other.place - other.last - m.velocity;
        count += 1;
      }
    }
    const Point alone =
        moves_on ? Point{0, 0} : m.free + outer_displacement(m) - m.last - m.velocity;
    return count > 0 ? sum / count : alone;
  }

  /// Looks for a dot at its place.
  template <class View>
  bool locate(const View& image, Mark& m, bool wide) {
    constexpr double least_contrast = 0.6, most_contrast = 1.5, most_residual = 3;
    const Displacement d = displacement(m);
    const detail::DiscMap map = {m.map.ja + d[1], m.map.jb + d[2], d[3], d[4], d[5]};
    const double reach = max_off * m.next_px;
    const double threshold = m.light * (1 - 0.4 * m.contrast);
    const Point guess = m.place;
    const Point start =
        wide ? detail::darkest(image, threshold, 1, guess, (std::min)(reach, m.look_px)) : guess;
    const detail::DiscFit fit = locator_.find(image, start, map, edge_px_, m.slope);
    const double contrast = fit.contrast / m.contrast;
    m.residual_ratio = fit.residual / std::fabs(fit.contrast * fit.light * m.residual);
    m.placed = true;
    m.found = fit.good && contrast > least_contrast && contrast < most_contrast &&
              norm(fit.center - guess) < reach && m.residual_ratio < most_residual * noise_ &&
              norm(fit.center - m.free - outer_displacement(m)) < max_jump * m.next_px;
    if (m.found) {
      m.place = fit.center;
      m.news = m.place - m.last - m.velocity;
      m.slope = fit.slope;
      m.light = fit.light;
      m.sd_px = std::sqrt(squared_norm(fit.sd_px) / 2 + square(bias_px));
    }
    return m.found;
  }

  /// The median residual of those found; half of the dots are needed.
  void keep_noise() {
    std::size_t count = 0;
    for (std::size_t k = 0; k < px_.size(); ++k) {
      if (marks_[k].found) {
        residuals_[count++] = marks_[k].residual_ratio;
      }
    }
    const auto first = residuals_.begin(), middle = first + std::ptrdiff_t(count / 2);
    std::nth_element(first, middle, first + std::ptrdiff_t(count));
    const bool enough = count > 0 && 2 * Index(count) >= expected_;
    noise_ = enough ? (std::max)(*middle, 1.0) : is_finite(noise_) ? noise_ : 0;
  }

  /// NaN of none.
  static double median(std::vector<double>& values) {
    if (values.empty()) {
      return not_a_number<double>();
    }
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  Index image_rows_, image_cols_, expected_ = 0;
  double edge_px_ = 1.5, reach_px_ = 0,
         noise_ = 0;         ///< noise: of frames to that of the free picture
  std::vector<Mark> marks_;  ///< the dots, then the rim
  std::vector<Point> px_;
  std::vector<double> sd_px_, residuals_;
  std::string refusal_;
  detail::DotLocator locator_;
};

}  // namespace v0
}  // namespace fingerpad
