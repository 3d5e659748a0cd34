// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Follows discs that are printed on a membrane, in whatever pattern. Each is expected where its
// last motion and the deviation of the neighbours already found put it; there its disc of the free
// pad, deformed by a polynomial of second order through the displacements of its neighbours, is
// fitted to the pixels, or as it was where that fits better. What does not look like itself, or
// does not move with its neighbours, is lost.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/dots/detail/dot_locator.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// Fill it: learn(), drop() and add_still() as needed, connect(). Then look() and keep() once a
/// frame.
class MarkFollower {
 public:
  using Point = Point2<double>;

  /// Where a disc is looked for on the free pad.
  struct Start {
    Point at;
    DiscMap map;
    double within_px = 0;
    std::size_t row = 0;  ///< marks of one row have few neighbours of it
  };
  struct Mark {
    bool exists = false;  ///< on the free pad
    bool still = false;   ///< does not move and cannot be seen
    bool found = false;   ///< in this frame
    bool placed = false;  ///< in this frame, found or not
    bool seen = false;    ///< found but for its shape, which lost neighbours may spoil
    Point free = missing(), last = missing(), velocity = {0, 0};
    Point place = missing();   ///< found, else where it would be
    Point deviation = {0, 0};  ///< place less what its last motion made expect
    DiscMap map = {{1, 0}, {0, 1}};
    Point slope = {0, 0};
    double contrast = 0, residual = 0;  ///< on the free pad, as a share of light and of contrast
    double light = 0;
    double residual_ratio = 0;  ///< in this frame, to that on the free pad
    double next_px = 0;         ///< distance to the next mark on the free pad
    double look_px = (std::numeric_limits<double>::infinity)();  ///< to what is still, less 2
    double sd_px = 0, surprise_px = 0;  ///< in this frame; distance from where it was expected
    std::size_t row = 0;
  };

  static constexpr Point missing() { return {not_a_number<double>(), not_a_number<double>()}; }

  /// `around`: how many neighbours say how the print is deformed around a mark.
  explicit MarkFollower(std::size_t around) : around_(around) {}

  const Mark& operator[](std::size_t k) const { return marks_[k]; }
  Index count() const { return Index(order_.size()); }
  double edge_px() const { return edge_px_; }

  /// Fits the shape of each disc, with one blur for all. A disc that is not there does not exist.
  template <class View>
  void learn(const View& image, std::span<const Start> starts) {
    marks_.assign(starts.size(), {});
    std::vector<double> edges;
    for (const bool free_edge : {true, false}) {
      for (std::size_t k = 0; k < starts.size(); ++k) {
        Mark& m = marks_[k];
        double edge_px = edge_px_;
        m.map = starts[k].map;
        m.row = starts[k].row;
        const Point at = m.exists ? m.free : starts[k].at;
        const DiscFit fit = locator_.fit_shape(image, at, m.map, edge_px, free_edge);
        m.exists = fit.good && norm(fit.center - starts[k].at) < starts[k].within_px;
        m.place = m.last = m.free = m.exists ? fit.center : missing();
        m.slope = fit.slope;
        m.light = fit.light;
        m.contrast = fit.contrast;
        m.residual = fit.residual / std::fabs(fit.contrast * fit.light);
        if (free_edge && m.exists) {
          edges.push_back(edge_px);
        }
      }
      edge_px_ = free_edge && !edges.empty() ? median(edges) : edge_px_;
    }
  }

  void drop(std::size_t k) {
    marks_[k].exists = false;
    marks_[k].free = marks_[k].last = marks_[k].place = missing();
  }

  /// A place of the print that is clamped.
  void add_still(const Point& at) {
    Mark m;
    m.exists = m.still = m.placed = true;
    m.free = m.last = m.place = at;
    marks_.push_back(m);
  }

  /// Chooses the neighbours; a mark without enough of them does not exist. O(marks^2).
  void connect() {
    neighbours_.assign(marks_.size() * around_, 0);
    weights_.assign(marks_.size() * around_, {});
    for (bool dropped = true; dropped;) {
      dropped = false;
      order_.clear();
      for (std::size_t k = 0; k < marks_.size(); ++k) {
        if (marks_[k].exists && !marks_[k].still) {
          order_.push_back(k);
          if (!weigh_neighbours(k)) {
            drop(k);
            dropped = true;
          }
        }
      }
    }
    Point middle = {0, 0};
    for (const std::size_t k : order_) {
      middle += marks_[k].free / double(order_.size());
    }
    // beside a gap in the print, too, another dot may come as near as elsewhere
    const auto size_px = [&](std::size_t k) { return std::sqrt(std::fabs(area(marks_[k].map))); };
    std::vector<double> gaps;
    for (const std::size_t k : order_) {
      gaps.push_back(marks_[k].next_px / size_px(k));
    }
    const double usual = median(gaps);
    for (const std::size_t k : order_) {
      marks_[k].next_px = (std::min)(marks_[k].next_px, usual * size_px(k));
    }
    // what is at the border moves least and comes first
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
      return norm(marks_[a].free - middle) > norm(marks_[b].free - middle);
    });
    residuals_.resize(order_.size());
    part_.resize(marks_.size());
    part_size_.resize(marks_.size());
  }

  /// Marks are expected at given places, in px; one that is not finite is expected to have moved
  /// like its neighbours since the free pad.
  template <class PlaceOf>
  void expect(const PlaceOf& place_of) {
    for (const std::size_t k : order_) {
      Mark& m = marks_[k];
      const Point given = place_of(k);
      m.last = m.free;
      m.found = m.seen = is_plausible(given);
      m.place = m.found ? given : m.free;
    }
    place_lost();
    for (const std::size_t k : order_) {
      marks_[k].velocity = {0, 0};
      marks_[k].last = marks_[k].place;
    }
  }

  /// Finds the marks of a frame; how many. O(marks x pixels of a mark); allocates nothing.
  template <class View>
  Index look(const View& image) {
    if (noise_ == 0) {  // how much noisier frames are than the free picture
      noise_ = (std::numeric_limits<double>::infinity)();
      pass(image);
      keep_noise();
    }
    pass(image);
    for (const std::size_t k : order_) {
      marks_[k].seen = marks_[k].found;
    }
    place_lost();
    for (const std::size_t k : order_) {  // with the shape that all neighbours give
      if (marks_[k].found && marks_[k].surprise_px > 0.15) {
        (void)locate(image, k, false);
      }
    }
    for (const std::size_t k : order_) {
      Mark& m = marks_[k];
      m.found = m.found && norm(m.place - m.free - displacement<1>(k)[0]) < max_bend * m.next_px;
    }
    drop_strangers();
    return std::count_if(order_.begin(), order_.end(),
                         [&](std::size_t k) { return marks_[k].found; });
  }

  /// Ends a frame: the marks go on from what was found if it is good, else from the last good one.
  void keep(bool good) {
    if (good) {
      keep_noise();
    }
    for (const std::size_t k : order_) {
      Mark& m = marks_[k];
      m.found = m.found && good;
      m.velocity = good ? m.place - m.last : Point{0, 0};
      m.last = good ? m.place : m.last;
    }
  }

 private:
  static constexpr std::size_t terms = 6;  ///< of a polynomial of second order
  static constexpr int tries = 5;          ///< in which lost marks are tried again
  static constexpr double max_off = 0.45;  ///< distances to the next mark
  static constexpr double max_bend = 0.3;  ///< likewise, beside what the neighbours say
  static constexpr double bias_px = 0.01;  ///< rms of the centers in pictures without noise

  using Weights = std::array<double, terms>;

  static double area(const DiscMap& d) { return d.ja.x * d.jb.y - d.ja.y * d.jb.x; }
  std::span<const std::size_t> neighbours(std::size_t k) const {
    return {neighbours_.data() + k * around_, around_};
  }

  /// The nearest neighbours by distance on the print, a third of them of the own row, and least
  /// squares of a polynomial in the coordinates of the disc.
  bool weigh_neighbours(std::size_t k) {
    Mark& m = marks_[k];
    const double det = area(m.map);
    const auto on_print = [&](std::size_t other) {
      const Point off = marks_[other].free - m.free;
      return Point{(off.x * m.map.jb.y - off.y * m.map.jb.x) / det,
                   (m.map.ja.x * off.y - m.map.ja.y * off.x) / det};
    };
    std::vector<std::pair<double, std::size_t>> others;
    for (std::size_t n = 0; n < marks_.size(); ++n) {
      if (n != k && marks_[n].exists) {
        others.push_back({norm(on_print(n)), n});
      }
    }
    std::sort(others.begin(), others.end());
    m.next_px = (std::numeric_limits<double>::infinity)();
    std::size_t chosen = 0, own = 0;
    for (const auto& [distance, n] : others) {
      const Mark& other = marks_[n];
      const bool of_row = !other.still && other.row == m.row;
      if (chosen < around_ && (!of_row || own < around_ / 3)) {
        neighbours_[k * around_ + chosen++] = n;
        own += of_row ? 1 : 0;
        double& px = other.still ? m.look_px : m.next_px;
        px = (std::min)(px, norm(other.free - m.free) - (other.still ? 2 : 0));
      }
    }
    if (chosen < around_) {
      return false;
    }
    const double scale = norm(on_print(neighbours(k)[around_ / 2]));
    const auto powers = [&](std::size_t n) {
      const Point v = on_print(n) / scale;
      return Weights{1, v.x, v.y, v.x * v.x / 2, v.x * v.y, v.y * v.y / 2};
    };
    const auto weight = [&](std::size_t n) {
      return 1 / (0.25 + squared_norm(on_print(n)) / square(scale));
    };
    SmallMatrix<double, terms> normal = zero_matrix<double, terms>();
    for (const std::size_t n : neighbours(k)) {
      const Weights row = powers(n);
      for (std::size_t i = 0; i < terms; ++i) {
        for (std::size_t j = 0; j < terms; ++j) {
          normal[i][j] += weight(n) * row[i] * row[j];
        }
      }
    }
    for (std::size_t i = 3; i < terms; ++i) {  // neighbours in two lines say nothing of a bend
      normal[i][i] += 1e-4;
    }
    const NormalEquations<double, terms> equations(normal);
    for (std::size_t n = 0; n < around_ && equations.good; ++n) {
      Weights& w = weights_[k * around_ + n];
      w = equations.solve(powers(neighbours(k)[n]));
      for (std::size_t i = 0; i < terms; ++i) {
        w[i] *= weight(neighbours(k)[n]) / (i == 0 ? 1 : i < 3 ? scale : square(scale));
      }
    }
    return equations.good && is_finite(m.next_px);
  }

  /// The displacement of a mark from the free pad and its derivatives, as its neighbours are
  /// displaced; those not placed yet are taken to have this mark's deviation.
  template <std::size_t N = terms>
  std::array<Point, N> displacement(std::size_t k) const {
    std::array<Point, N> d{};
    const std::size_t* const others = neighbours_.data() + k * around_;
    const Weights* const weights = weights_.data() + k * around_;
    for (std::size_t n = 0; n < around_; ++n) {
      const Mark& other = marks_[others[n]];
      const Point at =
          other.placed ? other.place : other.last + other.velocity + marks_[k].deviation;
      const Point moved = at - other.free;
      for (std::size_t i = 0; i < N; ++i) {
        d[i] += weights[n][i] * moved;
      }
    }
    return d;
  }

  /// Looks for all marks. The lost are tried again where those found put them, then with a wide
  /// look as long as that finds any.
  template <class View>
  void pass(const View& image) {
    for (const std::size_t k : order_) {
      marks_[k].found = marks_[k].seen = marks_[k].placed = false;
    }
    std::size_t lost = order_.size(), before = lost + 1;
    for (int round = 0; round < tries && lost > 0 && (round < 3 || lost < before); ++round) {
      before = lost;
      lost = 0;
      if (round > 0) {
        place_lost();
      }
      for (const std::size_t k : order_) {
        Mark& m = marks_[k];
        if (!m.found) {
          if (round == 0) {
            m.deviation = neighbours_deviation(k);
            m.place = m.last + m.velocity + m.deviation;
          }
          lost += static_cast<std::size_t>(!locate(image, k, round > 1));
        }
      }
    }
  }

  /// How far a mark is off what its last motion makes expect if it moves like its neighbours; those
  /// not found yet are taken to deviate like the mean of those found.
  Point neighbours_deviation(std::size_t k) const {
    Point sum = {0, 0}, deviation = {0, 0};
    double count = 0, rest = 1;
    for (std::size_t n = 0; n < around_; ++n) {
      const Mark& m = marks_[neighbours(k)[n]];
      if (m.found) {
        const double weight = weights_[k * around_ + n][0];
        sum += m.deviation;
        count += 1;
        deviation += weight * m.deviation;
        rest -= weight;
      }
    }
    return count > 0 ? deviation + rest / count * sum : sum;
  }

  /// Puts lost marks where they have moved like the mean of their neighbours.
  void place_lost() {
    for (int sweep = 0; sweep < tries; ++sweep) {
      for (const std::size_t k : order_) {
        Mark& m = marks_[k];
        if (!m.seen) {
          Point sum = {0, 0};
          for (const std::size_t n : neighbours(k)) {
            sum += marks_[n].place - marks_[n].last;
          }
          m.place = m.last + sum / double(around_);
          m.deviation = m.place - m.last - m.velocity;
        }
      }
    }
  }

  /// Looks for a mark at its place.
  template <class View>
  bool locate(const View& image, std::size_t k, bool wide) {
    constexpr double least_contrast = 0.6, most_contrast = 1.5;
    constexpr double unusual_residual = 1.5, most_residual = 3;
    Mark& m = marks_[k];
    const Point guess = m.place;
    const auto d = displacement(k);
    const DiscMap map = {m.map.ja + d[1], m.map.jb + d[2], d[3], d[4], d[5]};
    const double closer = (std::clamp)(area(map) / area(m.map), 0.0, 1.0);
    const double reach = max_off * m.next_px * closer;
    const double threshold = m.light * (1 - 0.4 * m.contrast), sign = m.contrast > 0 ? 1 : -1;
    const Point start =
        wide ? darkest(image, threshold, sign, guess, (std::min)(reach, m.look_px)) : guess;
    const auto ratio_of = [&](const DiscFit& f) {
      return f.residual / std::fabs(f.contrast * f.light * m.residual);
    };
    DiscFit fit = locator_.find(image, start, map, edge_px_, m.slope);
    if (fit.good && ratio_of(fit) > unusual_residual * noise_) {
      // a bead, or the head of a pin, stays round
      const DiscFit stiff = locator_.find(image, start, m.map, edge_px_, m.slope);
      fit = stiff.good && ratio_of(stiff) < ratio_of(fit) ? stiff : fit;
    }
    const double contrast = fit.contrast / m.contrast;
    m.placed = true;
    m.residual_ratio = ratio_of(fit);
    m.surprise_px = norm(fit.center - guess);
    m.seen =
        fit.good && contrast > least_contrast && contrast < most_contrast && m.surprise_px < reach;
    m.found = m.seen && m.residual_ratio < most_residual * noise_;
    m.place = m.seen ? fit.center : guess;
    m.deviation = m.place - m.last - m.velocity;
    if (m.found && is_finite(noise_)) {
      m.slope = fit.slope;
      m.light = fit.light;
      m.sd_px = std::sqrt(squared_norm(fit.sd_px) / 2 + square(bias_px));
    }
    return m.found;
  }

  /// The median residual of those found; half of the marks are needed.
  void keep_noise() {
    std::size_t count = 0;
    for (const std::size_t k : order_) {
      if (marks_[k].found) {
        residuals_[count++] = marks_[k].residual_ratio;
      }
    }
    const double usual = median({residuals_.data(), count});
    noise_ = count > 0 && 2 * count >= order_.size() ? (std::max)(usual, 1.0) : 0;
  }

  /// Neighbours move alike. Of the parts of the print within which they do, the largest is kept, or
  /// the one that hangs together with what is still.
  void drop_strangers() {
    std::size_t still = marks_.size();
    for (std::size_t k = marks_.size(); k-- > 0;) {
      part_size_[k] = 0;
      still = marks_[k].still ? k : still;
      part_[k] = k;
    }
    for (std::size_t k = still; k < marks_.size(); ++k) {
      part_[k] = still;
    }
    for (const std::size_t k : order_) {
      for (const std::size_t n : neighbours(k)) {
        if (marks_[k].found && (marks_[n].found || marks_[n].still) &&
            move_alike(marks_[k], marks_[n])) {
          const std::size_t a = part_of(k), b = part_of(n);
          part_[(std::max)(a, b)] = (std::min)(a, b);
        }
      }
    }
    for (const std::size_t k : order_) {
      part_size_[part_of(k)] += static_cast<std::size_t>(marks_[k].found);
    }
    const auto largest = std::max_element(part_size_.begin(), part_size_.end());
    const std::size_t kept =
        still < marks_.size() ? part_of(still) : std::size_t(largest - part_size_.begin());
    for (const std::size_t k : order_) {
      marks_[k].found = marks_[k].found && part_of(k) == kept;
    }
  }

  /// From frame to frame, and what is still since the free pad.
  static bool move_alike(const Mark& a, const Mark& b) {
    const Point apart = b.still ? b.free - a.free : b.last - a.last;
    return norm(b.place - a.place - apart) < max_off * (std::min)(norm(apart), a.next_px);
  }

  std::size_t part_of(std::size_t k) {
    while (part_[k] != k) {
      k = part_[k] = part_[part_[k]];
    }
    return k;
  }

  std::size_t around_;
  double noise_ = 0;    ///< residuals of the frames to that of the free pad's picture; 0: unknown
  double edge_px_ = 2;  ///< half width of the blurred edge
  std::vector<Mark> marks_;
  std::vector<std::size_t> order_;       ///< the marks that exist and move, border first
  std::vector<std::size_t> neighbours_;  ///< around_ of each mark
  std::vector<Weights> weights_;         ///< of their displacements
  std::vector<std::size_t> part_, part_size_;
  std::vector<double> residuals_;
  DotLocator locator_;
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
