// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Follows the printed dots of a pad from frame to frame, at the frame's speed and without OpenCV.
// Each dot is expected where its last motion and its neighbours' motion in this frame put it. There
// the picture of its disc, deformed as its neighbours say, is fitted to the pixels, or that of the
// free pad if it fits better: beads in a gel stay round. A dot that does not look like itself, or
// does not move with its neighbours, is lost, not guessed.
//
//   auto green = channel<const unsigned char>(free_frame, 1);       // any image type
//   DotFollower follower(green, finder.free_px(), {.radius_px = finder.pattern().radius_px});
//   auto seen = follower(channel<const unsigned char>(frame, 1), dots);   // NaN: a lost dot
//   if (seen.status == DotFollowerStatus::lost && finder(frame, dots).ok()) {
//     seen = follower.restart(channel<const unsigned char>(frame, 1), dots);
//   }
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/dots/detail/mark_follower.hpp"

namespace fingerpad {
inline namespace v1 {

enum class DotFollowerStatus : std::uint8_t {
  ok,
  lost,     ///< too many dots were lost to trust the others: all are NaN
  refused,  ///< image or grid of another size, or no dots to follow: nothing was written
};
/// "ok", "lost" or "refused".
constexpr const char* name_of(DotFollowerStatus status) {
  constexpr std::array<const char*, 3> names = {"ok", "lost", "refused"};
  return names[static_cast<std::size_t>(status)];
}

/// The mean of two channels of a frame, as a grid of float: green and red of a red fluid scatter a
/// dot less than either alone. Valid as long as both channels are.
template <grid A, grid B>
auto mean_light(const A& a, const B& b) {
  return LazyView(rows(a), cols(a), [a = as_view(a), b = as_view(b)](Index i, Index j) {
    return 0.5F * (static_cast<float>(a(i, j)) + static_cast<float>(b(i, j)));
  });
}

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
        max_lost_(options.max_lost),
        dots_(8),
        sd_px_(std::size_t(rows_ * cols_)) {
    require(options);
    const double r = options.radius_px;
    std::vector<detail::MarkFollower::Start> starts;
    for (Index cell = 0; cell < rows_ * cols_; ++cell) {
      const Point given = point_of(free_px, cell);
      if (is_plausible(given)) {
        starts.push_back({given, {{r, 0}, {0, r}}, r, starts.size()});
        cell_of_.push_back(cell);
      }
    }
    dots_.learn(as_view(free_image), starts);
    dots_.connect();
    expects(dots_.count() >= 9, "DotFollower", "dots found at free_px",
            static_cast<long long>(dots_.count()), ">= 9");
    look_beyond(as_view(free_image));
  }

  /// The dots of the next frame by their printed row and column; NaN for a lost dot. O(dots x
  /// pixels of a dot); allocates nothing.
  template <grid Image, dot_grid Dots>
  DotFollowerResult operator()(const Image& image, Dots& dots_px) {
    return fits(image, dots_px) ? look(as_view(image), dots_px) : DotFollowerResult{};
  }

  /// The same, where the dots are expected at `dots_px` (as a DotFinder labels them): a dot that is
  /// NaN there is expected to have moved like its neighbours since the free pad.
  template <grid Image, dot_grid Dots>
  DotFollowerResult restart(const Image& image, Dots& dots_px) {
    if (!fits(image, dots_px)) {
      return {};
    }
    dots_.expect([&](std::size_t k) { return point_of(dots_px, cell_of_[k]); });
    return look(as_view(image), dots_px);
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  Index image_rows() const { return image_rows_; }
  Index image_cols() const { return image_cols_; }
  /// Standard deviation of each dot's place along x and along y, px, from its own residual as if
  /// the noise of neighbouring pixels were independent (JPEG: up to twice that); NaN if lost.
  StridedView<const double> sd_px() const { return {sd_px_.data(), rows_, cols_, cols_}; }

 private:
  using Point = Point2<double>;
  static constexpr double max_strange = 0.125;  ///< beyond the border: half of one side of four

  /// A place beyond the border of the print where the free pad shows no dot.
  struct Beyond {
    std::size_t dot, before;
  };

  template <class Image, class Dots>
  bool fits(const Image& image, const Dots& dots) const {
    return fingerpad::rows(image) == image_rows_ && fingerpad::cols(image) == image_cols_ &&
           fingerpad::rows(dots) == rows_ && fingerpad::cols(dots) == cols_;
  }
  template <class Dots>
  Point point_of(const Dots& dots, Index cell) const {
    using Traits = point_traits<cell_t<Dots>>;
    const cell_t<Dots> p = grid_traits<Dots>::at(dots, cell / cols_, cell % cols_);
    return {double(Traits::x(p)), double(Traits::y(p))};
  }

  template <class View>
  void look_beyond(const View& image) {
    const std::size_t none = cell_of_.size();
    std::vector<std::size_t> marks(std::size_t(rows_ * cols_), none);
    for (std::size_t k = 0; k < none; ++k) {
      marks[std::size_t(cell_of_[k])] = dots_[k].exists ? k : none;
    }
    const auto mark = [&](Index i, Index j) {
      const bool inside = i >= 0 && j >= 0 && i < rows_ && j < cols_;
      return inside ? marks[std::size_t(i * cols_ + j)] : none;
    };
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        for (const auto& [down, right] : {std::array<Index, 2>{0, -1}, {0, 1}, {-1, 0}, {1, 0}}) {
          const Beyond b = {mark(i, j), mark(i - down, j - right)};
          if (b.dot != none && b.before != none && mark(i + down, j + right) == none &&
              !dark_beyond(image, b)) {
            beyond_.push_back(b);
          }
        }
      }
    }
  }

  /// Whether it is as dark as in the dot where the next dot would be.
  template <class View>
  bool dark_beyond(const View& image, const Beyond& b) const {
    const detail::MarkFollower::Mark& m = dots_[b.dot];
    const Point p = 2.0 * m.place - dots_[b.before].place;
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

  template <class View, class Dots>
  DotFollowerResult look(const View& image, Dots& dots_px) {
    DotFollowerResult result;
    result.expected = dots_.count();
    result.found = dots_.look(image);
    // After a jump by whole pitches every dot looks right, but one row has none beyond it any more.
    Index strange = 0;
    for (const Beyond& b : beyond_) {
      strange += dots_[b.dot].found && dark_beyond(image, b) ? 1 : 0;
    }
    const bool good = double(result.found) >= (1 - max_lost_) * double(result.expected) &&
                      double(strange) <= max_strange * double(beyond_.size());
    result.status = good ? DotFollowerStatus::ok : DotFollowerStatus::lost;
    dots_.keep(good);
    using Cell = cell_t<Dots>;
    using C = std::remove_cvref_t<decltype(point_traits<Cell>::x(Cell()))>;
    const auto write = [&](Index cell, const Point& p, double sd_px) {
      grid_traits<Dots>::at(dots_px, cell / cols_, cell % cols_) =
          Cell{static_cast<C>(p.x), static_cast<C>(p.y)};
      sd_px_[std::size_t(cell)] = sd_px;
    };
    for (Index cell = 0; cell < rows_ * cols_; ++cell) {
      write(cell, detail::MarkFollower::missing(), not_a_number<double>());
    }
    for (std::size_t k = 0; k < cell_of_.size(); ++k) {
      if (dots_[k].found) {
        write(cell_of_[k], dots_[k].place, dots_[k].sd_px);
      }
    }
    return result;
  }

  Index rows_, cols_, image_rows_, image_cols_;
  double max_lost_;
  detail::MarkFollower dots_;
  std::vector<Index> cell_of_;  ///< of each mark: row times columns plus column
  std::vector<Beyond> beyond_;
  std::vector<double> sd_px_;
};

}  // namespace v1
}  // namespace fingerpad
