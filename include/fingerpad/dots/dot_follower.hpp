// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Follows the printed dots of a pad from frame to frame, at the frame's speed and without OpenCV.
// Each dot is expected where its last motion and its neighbours' motion in this frame put it. There
// the picture of its disc, deformed as the lattice of its neighbours is, is fitted to the pixels.
// A dot that does not look like itself, or does not move with its neighbours, is lost, not guessed.
//
//   auto green = channel<const unsigned char>(free_frame, 1);       // any image type
//   DotFollower follower(green, finder.free_px(), {.radius_px = finder.pattern().radius_px});
//   auto seen = follower(channel<const unsigned char>(frame, 1), dots);   // NaN: a lost dot
//   if (seen.status == DotFollowerStatus::lost && finder(frame, dots).ok()) {
//     seen = follower.restart(channel<const unsigned char>(frame, 1), dots);
//   }
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/dots/detail/dot_locator.hpp"

namespace fingerpad {
inline namespace v0 {

enum class DotFollowerStatus : std::uint8_t {
  ok,
  lost,     ///< too many dots were lost to trust the others: all are NaN, restart() is needed
  refused,  ///< image or grid of another size: nothing was written
};
inline constexpr std::array<const char*, 3> dot_follower_status_names = {"ok", "lost", "refused"};

struct DotFollowerOptions {
  double radius_px = 4;   ///< of a dot on the free pad, right to within a third; in [1, 16]
  double max_lost = 0.1;  ///< share of the dots beyond which all count as lost; in [0, 1)
};

/// The refusal of bad options; "" if all are good.
inline std::string check(const DotFollowerOptions& o) {
  return check("DotFollower", {{"radius_px", o.radius_px, within(1, 16)},
                               {"max_lost", o.max_lost, {.min = 0, .max = 1, .below_max = true}}});
}

struct [[nodiscard]] DotFollowerResult {
  DotFollowerStatus status = DotFollowerStatus::refused;
  Index found = 0;     ///< dots located in this frame
  Index expected = 0;  ///< dots located on the free pad

  bool ok() const { return status == DotFollowerStatus::ok; }
};

/// The object is the state: copy it to return to a frame. One object a thread.
class DotFollower {
 public:
  /// `free_image` shows the free pad in one channel, `free_px` has its dots to within half a
  /// radius, by printed row and column, NaN where there is none. A dot whose disc cannot be fitted
  /// is never followed. Refuses bad options and fewer than 9 dots (parameter_error). Takes some
  /// tenths of a second.
  template <grid Image, dot_grid Dots>
  DotFollower(const Image& free_image, const Dots& free_px, const DotFollowerOptions& options = {})
      : rows_(fingerpad::rows(free_px)),
        cols_(fingerpad::cols(free_px)),
        image_rows_(fingerpad::rows(free_image)),
        image_cols_(fingerpad::cols(free_image)),
        wide_(cols_ + 2 * margin),
        options_(options),
        marks_(std::size_t((rows_ + 2 * margin) * wide_)),
        sd_px_(std::size_t(rows_ * cols_), not_a_number<double>()),
        todo_(marks_.size()),
        residuals_(marks_.size()) {
    require(options);
    learn(as_view(free_image), free_px);
    expects(order_.size() >= 9, "DotFollower", "dots found at free_px",
            static_cast<long long>(order_.size()), ">= 9");
  }

  /// The dots of the next frame by their printed row and column; NaN for a lost dot. O(dots x
  /// pixels of a dot); allocates nothing.
  template <grid Image, dot_grid Dots>
  DotFollowerResult operator()(const Image& image, Dots& dots_px) {
    if (!fits(image, dots_px)) {
      return {};
    }
    for (const Index k : order_) {
      at(k).place = at(k).last + at(k).velocity;
    }
    return look(as_view(image), dots_px);
  }

  /// The same, where the dots are expected at `dots_px` (as a DotFinder labels them): a dot that is
  /// NaN there is expected to have moved like its neighbours since the free pad.
  template <grid Image, dot_grid Dots>
  DotFollowerResult restart(const Image& image, Dots& dots_px) {
    if (!fits(image, dots_px)) {
      return {};
    }
    for (const Index k : order_) {
      const Point given = point_of(dots_px, k);
      at(k).found = is_plausible(given);
      at(k).place = at(k).found ? given : at(k).last;
    }
    place_lost(tries, true);
    for (const Index k : order_) {
      at(k).velocity = {0, 0};
      at(k).last = at(k).place;
    }
    lost_ = 0;
    return look(as_view(image), dots_px);
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  /// Standard deviation of each dot's place along x and along y, px, from its own residual as if
  /// the noise of neighbouring pixels were independent (JPEG: up to twice that); NaN if lost.
  StridedView<const double> sd_px() const { return {sd_px_.data(), rows_, cols_, cols_}; }

 private:
  using Point = Point2<double>;
  static constexpr Index margin = 2;  ///< of absent dots around the grid

  struct Mark {
    bool exists = false;  ///< on the free pad
    bool found = false;   ///< in this frame
    bool visited = false;
    bool likely = false;  ///< found but for its shape, which lost neighbours may spoil
    Point free = missing(), last = missing(), velocity = {0, 0};
    Point place = missing();  ///< expected, then found
    Point expected = missing();
    Point news = {0, 0};  ///< place less what was expected
    // The disc: an ellipse in the lattice (axes a, b in pitches), and by how much its map's second
    // derivatives differ from the lattice's.
    Point a = {0, 0}, b = {0, 0}, aa = {0, 0}, ab = {0, 0}, bb = {0, 0};
    Point slope = {0, 0};
    double contrast = 0, residual = 0;  ///< on the free pad, as a share of light and of contrast
    double light = 0;
    double residual_ratio = 0;          ///< in this frame, to that on the free pad
    double sd_px = 0, surprise_px = 0;  ///< in this frame; distance from where it was expected
  };

  /// The lattice around a dot, px per pitch: u.x pitches to the right, u.y pitches down.
  struct Lattice {
    Point right, down, rr, rd, dd;
    Point operator()(const Point& u) const { return u.x * right + u.y * down; }
    Point second(const Point& u, const Point& w) const {
      return u.x * w.x * rr + (u.x * w.y + u.y * w.x) * rd + u.y * w.y * dd;
    }
    Point pitches(const Point& px) const {
      const double det = right.x * down.y - right.y * down.x;
      return {(px.x * down.y - px.y * down.x) / det, (right.x * px.y - right.y * px.x) / det};
    }
    double pitch() const { return (std::min)(norm(right), norm(down)); }
  };

  /// A place beyond the border of the print where the free pad shows no dot.
  struct Beyond {
    Index dot, step;
  };

  static constexpr Point missing() { return {not_a_number<double>(), not_a_number<double>()}; }
  Mark& at(Index k) { return marks_[std::size_t(k)]; }
  const Mark& at(Index k) const { return marks_[std::size_t(k)]; }
  Index key(Index i, Index j) const { return (i + margin) * wide_ + j + margin; }
  std::array<Index, 8> around() const {
    return {-wide_ - 1, -wide_, -wide_ + 1, -1, 1, wide_ - 1, wide_, wide_ + 1};
  }
  template <class Image, class Dots>
  bool fits(const Image& image, const Dots& dots) const {
    return fingerpad::rows(image) == image_rows_ && fingerpad::cols(image) == image_cols_ &&
           fingerpad::rows(dots) == rows_ && fingerpad::cols(dots) == cols_;
  }
  template <class Dots>
  Point point_of(const Dots& dots, Index k) const {
    using Traits = point_traits<cell_t<Dots>>;
    const cell_t<Dots> p = grid_traits<Dots>::at(dots, k / wide_ - margin, k % wide_ - margin);
    return {double(Traits::x(p)), double(Traits::y(p))};
  }

  /// The lattice at dot k, whose neighbours not yet visited are taken to have its news. Beyond the
  /// print's border the second difference is taken as constant.
  Lattice lattice(Index k, const Point& news) const {
    const auto place = [&](Index n) { return at(n).visited ? at(n).place : at(n).place + news; };
    const Point here = at(k).place + news;
    Lattice l;
    const auto along = [&](Index step, Point& first, Point& second) {
      Point before = place(k - step), after = place(k + step);
      const auto beyond = [&](const Point& other, Index far) {
        return at(far).exists ? 3.0 * (here - other) + place(far) : 2.0 * here - other;
      };
      const bool no_before = !at(k - step).exists, no_after = !at(k + step).exists;
      if (no_before && no_after) {
        before = after = here;
      } else if (no_before) {
        before = beyond(after, k + 2 * step);
      } else if (no_after) {
        after = beyond(before, k - 2 * step);
      }
      first = 0.5 * (after - before);
      second = after + before - 2.0 * here;
    };
    along(1, l.right, l.rr);
    along(wide_, l.down, l.dd);
    l.rd = 0.25 * (place(k + wide_ + 1) + place(k - wide_ - 1) - place(k + wide_ - 1) -
                   place(k - wide_ + 1));
    l.rd = is_finite(l.rd) ? l.rd : Point{0, 0};
    return l;
  }

  /// Fits the disc of every dot on the free pad, then the lattice.
  template <class View, class Dots>
  void learn(const View& image, const Dots& free_px) {
    std::vector<detail::DiscMap> maps(marks_.size());
    std::vector<double> edges;
    for (Index k = margin * wide_; k < (rows_ + margin) * wide_; ++k) {
      const Index j = k % wide_ - margin;
      if (j >= 0 && j < cols_ && is_plausible(point_of(free_px, k))) {
        at(k).exists = true;
        order_.push_back(k);
      }
    }
    for (const bool free_edge : {true, false}) {  // one blur for all dots
      for (const Index k : order_) {
        double edge_px = free_edge ? 2 : edge_px_;
        detail::DiscMap& map = maps[std::size_t(k)];
        map = {{options_.radius_px, 0}, {0, options_.radius_px}};
        const Point given = point_of(free_px, k);
        const detail::DiscFit fit = locator_.fit_shape(image, given, map, edge_px, free_edge);
        Mark& m = at(k);
        m.exists = fit.good && norm(fit.center - given) < options_.radius_px;
        m.place = m.last = m.free = m.exists ? fit.center : missing();
        m.slope = fit.slope;
        m.light = fit.light;
        m.contrast = fit.contrast;
        m.residual = fit.residual / std::fabs(fit.contrast * fit.light);
        if (free_edge && m.exists) {
          edges.push_back(edge_px);
        }
      }
      if (free_edge && !edges.empty()) {
        const auto middle = edges.begin() + std::ptrdiff_t(edges.size() / 2);
        std::nth_element(edges.begin(), middle, edges.end());
        edge_px_ = *middle;
      }
    }
    for (const Index k : order_) {
      const Lattice l = lattice(k, {0, 0});
      Mark& m = at(k);
      m.a = l.pitches(maps[std::size_t(k)].ja);
      m.b = l.pitches(maps[std::size_t(k)].jb);
      m.aa = -1.0 * l.pitches(l.second(m.a, m.a));
      m.ab = -1.0 * l.pitches(l.second(m.a, m.b));
      m.bb = -1.0 * l.pitches(l.second(m.b, m.b));
      m.visited = m.exists && is_plausible(m.a) && is_plausible(m.b);  // a use until the next line
    }
    for (const Index k : order_) {
      at(k).exists = at(k).visited;
    }
    std::erase_if(order_, [&](Index k) { return !at(k).exists; });
    sort_inward();
    for (const Index k : order_) {
      for (const Index step : {Index(-1), Index(1), -wide_, wide_}) {
        if (!at(k + step).exists && at(k - step).exists && !dark_beyond(image, k, step)) {
          beyond_.push_back({k, step});
        }
      }
    }
  }

  /// The border moves least and comes first.
  void sort_inward() {
    std::vector<int> ring(marks_.size(), 0);
    for (bool more = true; more;) {
      more = false;
      for (const Index k : order_) {
        int least = 1000;
        for (const Index step : around()) {
          least = (std::min)(least, ring[std::size_t(k + step)]);
        }
        more = more || ring[std::size_t(k)] != least + 1;
        ring[std::size_t(k)] = least + 1;
      }
    }
    std::stable_sort(order_.begin(), order_.end(),
                     [&](Index a, Index b) { return ring[std::size_t(a)] < ring[std::size_t(b)]; });
  }

  /// Whether it is as dark as in dot k where the next dot in direction `step` would be.
  template <class View>
  bool dark_beyond(const View& image, Index k, Index step) const {
    const Mark& m = at(k);
    const Point p = 2.0 * m.place - at(k - step).place;
    const auto x = Index(std::floor(p.x + 0.5)), y = Index(std::floor(p.y + 0.5));
    if (x < 1 || y < 1 || x + 1 >= image.cols() || y + 1 >= image.rows()) {
      return false;
    }
    double sum = 0;
    for (Index i = y - 1; i <= y + 1; ++i) {
      for (Index j = x - 1; j <= x + 1; ++j) {
        sum += double(image(i, j));
      }
    }
    return (1 - sum / 9 / m.light) / m.contrast > 0.5;
  }

  /// Mean news of the neighbours that are found.
  Point neighbours_news(Index k) const {
    Point sum = {0, 0};
    double count = 0;
    for (const Index step : around()) {
      if (at(k + step).found) {
        sum += at(k + step).news;
        count += 1;
      }
    }
    return count > 0 ? sum / count : sum;
  }

  /// Puts lost dots where they are displaced from the free pad like the mean of their neighbours.
  void place_lost(int sweeps, bool likely) {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      for (const Index k : order_) {
        Mark& m = at(k);
        if (!m.found && (likely || !m.likely)) {
          Point sum = {0, 0};
          double count = 0;
          for (const Index step : around()) {
            if (at(k + step).exists) {
              sum += at(k + step).place - at(k + step).free;
              count += 1;
            }
          }
          m.place = count > 0 ? m.free + sum / count : m.place;
        }
      }
    }
  }

  template <class View, class Dots>
  DotFollowerResult look(const View& image, Dots& dots_px) {
    for (const Index k : order_) {
      at(k).expected = at(k).place;
      at(k).visited = at(k).found = at(k).likely = false;
      at(k).news = {0, 0};
    }
    // The lost are tried again where those found put them, as long as that finds any; with a wide
    // look if they are more than in the last frame.
    if (noise_ == 0) {
      learn_noise(image);
    }
    auto lost = Index(order_.size());
    Index before = lost + 1;
    for (int round = 0; round < tries && lost > 0; ++round) {
      const bool wide = round > 1 && lost > lost_;
      if (round > 1 && lost == before && !(wide && round == 2)) {
        break;
      }
      before = lost;
      lost = 0;
      place_lost(round, false);
      for (const Index k : order_) {
        Mark& m = at(k);
        if (!m.found) {
          m.news = round == 0 ? neighbours_news(k) : m.place - m.expected;
          m.place = m.expected;
          m.visited = false;
          lost += locate(image, k, wide) ? 0 : 1;
        }
      }
    }
    place_lost(tries, true);
    for (const Index k : order_) {  // with the whole lattice where it was guessed
      if (at(k).found && at(k).surprise_px > 0.25) {
        (void)locate(image, k, false);
      }
    }
    drop_strangers();
    return finish(image, dots_px);
  }

  /// How much noisier the frames are than the picture of the free pad, which may be a mean of many:
  /// from the dots near where they are expected.
  template <class View>
  void learn_noise(const View& image) {
    noise_ = (std::numeric_limits<double>::infinity)();
    for (const Index k : order_) {
      (void)locate(image, k, false);
    }
    keep_noise();
    for (const Index k : order_) {
      Mark& m = at(k);
      m.place = m.expected;
      m.news = {0, 0};
      m.visited = m.found = false;
    }
  }

  /// Half of the dots are needed.
  void keep_noise() {
    std::size_t count = 0;
    for (const Index k : order_) {
      if (at(k).found) {
        residuals_[count++] = at(k).residual_ratio;
      }
    }
    const auto first = residuals_.begin(), middle = first + std::ptrdiff_t(count / 2);
    std::nth_element(first, middle, first + std::ptrdiff_t(count));
    noise_ = 2 * count >= order_.size() ? (std::max)(*middle, 1.0) : 0;
  }

  /// Looks for dot k where its place and its news put it.
  template <class View>
  bool locate(const View& image, Index k, bool wide) {
    constexpr double least_contrast = 0.6, most_contrast = 1.5, most_residual = 3;
    Mark& m = at(k);
    const Point news = m.visited ? Point{0, 0} : m.news;
    const Point guess = m.place + news;
    const Lattice l = lattice(k, news);
    const detail::DiscMap map = {l(m.a), l(m.b), l(m.aa) + l.second(m.a, m.a),
                                 l(m.ab) + l.second(m.a, m.b), l(m.bb) + l.second(m.b, m.b)};
    const double reach = max_off * l.pitch();
    const double threshold = m.light * (1 - 0.4 * m.contrast), sign = m.contrast > 0 ? 1 : -1;
    const Point start = wide ? detail::darkest(image, threshold, sign, guess, reach) : guess;
    const detail::DiscFit fit = locator_.find(image, start, map, edge_px_, m.slope);
    const double contrast = fit.contrast / m.contrast;
    m.residual_ratio = fit.residual / std::fabs(fit.contrast * fit.light * m.residual);
    m.surprise_px = norm(fit.center - guess);
    m.likely =
        fit.good && contrast > least_contrast && contrast < most_contrast && m.surprise_px < reach;
    m.found = m.likely && m.residual_ratio < most_residual * noise_;
    if (m.found && is_finite(noise_)) {
      m.news = m.news + (fit.center - guess);
      m.slope = fit.slope;
      m.light = fit.light;
      m.sd_px = std::sqrt(squared_norm(fit.sd_px) / 2 + square(bias_px));
    }
    m.place = m.likely ? fit.center : guess;
    m.visited = true;
    return m.found;
  }

  /// Neighbours move alike. Of the parts of the print within which they do, the largest is kept.
  void drop_strangers() {
    for (const Index k : order_) {
      at(k).visited = false;
    }
    std::size_t largest = 0;
    Index seed = -1;
    for (const Index k : order_) {
      if (at(k).found && !at(k).visited) {
        const std::size_t size = part_of(k);
        seed = size > largest ? k : seed;
        largest = (std::max)(largest, size);
      }
    }
    for (const Index k : order_) {
      at(k).visited = false;
    }
    if (seed >= 0) {
      (void)part_of(seed);
    }
    for (const Index k : order_) {
      at(k).found = at(k).found && at(k).visited;
    }
  }

  /// Visits the part of the print around dot k; its size.
  std::size_t part_of(Index k) {
    std::size_t count = 0;
    todo_[count++] = k;
    at(k).visited = true;
    for (std::size_t next = 0; next < count; ++next) {
      const Index here = todo_[next];
      for (const Index step : {Index(-1), Index(1), -wide_, wide_}) {
        Mark& other = at(here + step);
        const Point apart = other.last - at(here).last;
        const Point off = other.place - at(here).place - apart;
        if (other.found && !other.visited && norm(off) < max_off * norm(apart)) {
          other.visited = true;
          todo_[count++] = here + step;
        }
      }
    }
    return count;
  }

  template <class View, class Dots>
  DotFollowerResult finish(const View& image, Dots& dots_px) {
    DotFollowerResult result;
    result.expected = Index(order_.size());
    for (const Index k : order_) {
      result.found += at(k).found ? 1 : 0;
    }
    // After a jump by whole pitches every dot looks right, but one row has none beyond it any more.
    Index strange = 0;
    for (const Beyond& b : beyond_) {
      strange += at(b.dot).found && dark_beyond(image, b.dot, b.step) ? 1 : 0;
    }
    const bool good = double(result.found) >= (1 - options_.max_lost) * double(result.expected) &&
                      double(strange) <= max_strange * double(beyond_.size());
    if (good) {
      keep_noise();
      lost_ = result.expected - result.found;
    }
    result.status = good ? DotFollowerStatus::ok : DotFollowerStatus::lost;
    for (const Index k : order_) {
      Mark& m = at(k);
      m.found = m.found && good;
      if (good) {
        m.velocity = m.place - m.last;
        m.last = m.place;
      } else {
        m.velocity = {0, 0};
      }
    }
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        const Mark& m = at(key(i, j));
        using Cell = cell_t<Dots>;
        using C = std::remove_cvref_t<decltype(point_traits<Cell>::x(Cell()))>;
        const Point p = m.found ? m.place : missing();
        grid_traits<Dots>::at(dots_px, i, j) = Cell{static_cast<C>(p.x), static_cast<C>(p.y)};
        sd_px_[std::size_t(i * cols_ + j)] = m.found ? m.sd_px : not_a_number<double>();
      }
    }
    return result;
  }

  Index lost_ = 0;    ///< dots, in the last good frame
  double noise_ = 0;  ///< residuals of the frames to that of the free pad's picture; 0: unknown
  static constexpr int tries = 5;             ///< in which lost dots are tried again
  static constexpr double max_off = 0.45;     ///< pitches
  static constexpr double bias_px = 0.01;     ///< rms of the centers in pictures without noise
  static constexpr double max_strange = 0.1;  ///< of the places beyond the border

  Index rows_, cols_, image_rows_, image_cols_, wide_;
  DotFollowerOptions options_;
  double edge_px_ = 2;  ///< half width of the blurred edge
  std::vector<Mark> marks_;
  std::vector<double> sd_px_;
  std::vector<Index> todo_;
  std::vector<double> residuals_;
  std::vector<Beyond> beyond_;
  std::vector<Index> order_;  ///< the dots of the free pad, border first
  detail::DotLocator locator_;
};

}  // namespace v0
}  // namespace fingerpad
