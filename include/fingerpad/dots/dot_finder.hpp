// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finds printed dots in camera frames, assigns them rows and columns, and tracks them from frame to
// frame. Unknown properties of the print (size, spacing, dark or bright, number of rows) are found
// in a frame of the free pad. Needs OpenCV (core, imgproc): target fingerpad::dot_finder.
//
//   #include "fingerpad/adapt/opencv.hpp"            // makes cv::Mat_ a grid
//   DotFinder finder(free_frame);                    // any pad with a grid of dots
//   auto state = finder.start();
//   cv::Mat_<cv::Vec2d> dots(finder.rows(), finder.cols());
//   auto result = finder(frame, dots, state);        // NaN where a dot is lost
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "fingerpad/dots/detail/dot_lattice.hpp"
#include "fingerpad/dots/detail/dot_spots.hpp"
#include "fingerpad/dots/dot_tracker.hpp"

namespace fingerpad {
inline namespace v0 {

/// Known properties of a print. Values that are 0, NaN or empty are found in the frame of the free
/// pad.
struct DotPattern {
  Index rows = 0;  ///< 2 to 100; give both rows and cols, or neither
  Index cols = 0;
  double radius_px = 0;        ///< of a dot, >= 1
  double pitch_px = 0;         ///< between neighbouring dots, > 2 radii; needs a radius
  std::optional<bool> bright;  ///< true: dots brighter than the background; false: darker
  /// Position of the middle of the print. If rows and columns can be counted in several ways, the
  /// one with the middle nearest to this position is taken; without it, the one that begins with
  /// the first dots.
  Point2<double> middle_px = {not_a_number<double>(), not_a_number<double>()};
};

struct DotFinderOptions {
  DotPattern pattern;
  /// Mask of the frames' size: nonzero where dots may be. Empty: anywhere.
  cv::Mat_<unsigned char> where;
  /// Least contrast of a dot, as a share of the light of the background around it; in (0, 1).
  double min_contrast = 0.08;
  /// Weights of blue, green and red, >= 0 and not all 0. Use 0 for a channel that holds only noise.
  std::array<double, 3> color_weights = {1, 1, 1};
  DotTrackerOptions tracker;
};

/// Finds and tracks the dots of a pad. Const: all memory of a pad is in its State.
class DotFinder {
 public:
  /// Memory of one pad. A value: copy it to try something, assign start() to reset it.
  class State {
    friend DotFinder;
    DotTracker::State dots;
    detail::SpotWorkspace workspace;
  };

  /// Finds the grid in `free_frame`: an image of the free pad, 8 or 16 bit (grey levels times 256),
  /// with one, three or four channels. If it shows no grid of 9 or more dots, ok() is false and
  /// every frame is refused. Refuses bad options (parameter_error). Takes up to a second if nothing
  /// is known of the print.
  explicit DotFinder(const cv::Mat& free_frame, const DotFinderOptions& options = {})
      : size_(free_frame.size()) {
    check(free_frame, options);
    if (!detail::is_picture(free_frame)) {
      return;
    }
    Attempt best = options.pattern.pitch_px > 0 ? attempt(free_frame, options, known_look(options))
                                                : search(free_frame, options);
    if (best.dots.rows() == 0) {
      return;
    }
    const DotPattern& given = options.pattern;
    if (given.rows > 0) {
      best.dots = detail::best_window(best.dots, given.rows, given.cols, given.middle_px);
    }
    if (count_present(best.dots) < detail::min_lattice_dots) {
      return;
    }
    look_ = best.look;
    free_ = best.dots;
    spots_.emplace(size_, look_, options.where);
    tracker_.emplace(free_, places_of(free_, options.where), options.tracker);
  }

  /// Whether the free frame showed a grid.
  bool ok() const { return tracker_.has_value(); }
  Index rows() const { return free_.rows(); }
  Index cols() const { return free_.cols(); }
  /// The free pad's dots, px; NaN for a dot that was not seen.
  StridedView<const Point2<double>> free_px() const { return free_.view(); }
  /// Properties of the print as found in the free frame.
  DotPattern pattern() const {
    DotPattern found;
    found.rows = rows();
    found.cols = cols();
    found.radius_px = look_.radius_px;
    found.pitch_px = look_.pitch_px;
    found.bright = look_.bright;
    return found;
  }

  /// State of the free pad, as in the free frame.
  State start() const {
    State state;
    if (ok()) {
      state.dots = tracker_->start();
    }
    return state;
  }

  /// The dots of the next frame, by their printed row and column; NaN for a lost dot. Takes
  /// O(pixels + dots) time, and more after a jump of more than a third of a pitch. Small buffers
  /// are allocated on each call; those of the frame's size stay in `state`. Use one state per
  /// thread.
  template <dot_grid Dots>
  DotResult operator()(const cv::Mat& frame, Dots& dots_px, State& state) const {
    if (!ok() || frame.size() != size_ || !detail::is_picture(frame)) {
      return {};
    }
    return (*tracker_)(spots_->find(frame, state.workspace), dots_px, state.dots);
  }

 private:
  struct Attempt {
    detail::SpotLook look;
    detail::Places dots;
    detail::TypicalSpot spot;
    double score = 0;
  };

  static void check(const cv::Mat& frame, const DotFinderOptions& o) {
    const char* const owner = "DotFinder";
    const DotPattern& p = o.pattern;
    const auto counted = [](Index n) { return n >= 2 && n <= 100; };
    expects((p.rows == 0 && p.cols == 0) || counted(p.rows), owner, "pattern.rows",
            static_cast<long long>(p.rows), "2 to 100, or 0 with cols = 0");
    expects((p.rows == 0 && p.cols == 0) || counted(p.cols), owner, "pattern.cols",
            static_cast<long long>(p.cols), "2 to 100, or 0 with rows = 0");
    const double largest = (std::min)(frame.cols, frame.rows) / 4.0;
    expects(p.radius_px == 0 || (p.radius_px >= 1 && p.radius_px <= largest), owner,
            "pattern.radius_px", p.radius_px, "0, or 1 to a quarter of the frame");
    expects(p.pitch_px == 0 ||
                (p.pitch_px > 2 * p.radius_px && p.pitch_px <= 2 * largest && p.radius_px > 0),
            owner, "pattern.pitch_px", p.pitch_px,
            "0, or more than two radii and at most half of the frame");
    expects(o.min_contrast > 0 && o.min_contrast < 1, owner, "min_contrast", o.min_contrast,
            "in (0, 1)");
    double sum = 0;
    for (const double weight : o.color_weights) {
      expects(weight >= 0 && is_finite(weight), owner, "color_weights", weight, ">= 0");
      sum += weight;
    }
    expects(sum > 0, owner, "the sum of color_weights", sum, "> 0");
    expects(o.where.empty() || o.where.size() == frame.size(), owner, "where.rows",
            static_cast<long long>(o.where.rows),
            "equal to the rows of the free frame, and where.cols to its columns");
  }

  static detail::SpotLook known_look(const DotFinderOptions& o) {
    return {o.pattern.radius_px, o.pattern.pitch_px, o.pattern.bright.value_or(false),
            o.min_contrast, o.color_weights};
  }

  /// Finds and scores the grid for one look. The score favours many dots, few other spots and a
  /// high contrast. Contrast matters because the blocks of a compressed image form a grid, too, but
  /// a faint one.
  static Attempt attempt(const cv::Mat& frame,
                         const DotFinderOptions& options,
                         const detail::SpotLook& look) {
    const detail::SpotFinder finder(frame.size(), look, options.where);
    detail::SpotWorkspace workspace;
    const std::vector<Point2<double>> spots = finder.find(frame, workspace);
    Attempt one{look, detail::lattice_of(spots), {}, 0};
    std::vector<Point2<double>> dots;
    for (const Point2<double>& dot : one.dots.cells()) {
      if (is_finite(dot)) {
        dots.push_back(dot);
      }
    }
    if (!dots.empty()) {
      one.spot = finder.typical(frame, dots);
      const auto count = static_cast<double>(dots.size());
      one.score =
          count * count / static_cast<double>(spots.size()) * one.spot.contrast * one.spot.contrast;
    }
    return one;
  }

  /// Tries radii and both signs (dark, bright), and returns the grid with the best score.
  static Attempt search(const cv::Mat& frame, const DotFinderOptions& options) {
    constexpr double smallest_px = 1.5, step = 1.4;
    constexpr double usual_pitch = 5;  // radii
    const DotPattern& given = options.pattern;
    const bool known = given.radius_px > 0;
    const double largest_px = known ? given.radius_px : (std::min)(frame.cols, frame.rows) / 12.0;
    Attempt best;
    for (double r = known ? given.radius_px : smallest_px; r <= largest_px; r *= step) {
      for (const bool bright : {false, true}) {
        if (bright == given.bright.value_or(bright)) {
          const Attempt one =
              attempt(frame, options,
                      {r, usual_pitch * r, bright, options.min_contrast, options.color_weights});
          best = one.score > best.score ? one : best;
        }
      }
    }
    return refined(frame, options, best);
  }

  /// Repeats the attempt with the radius and pitch found, as long as the score stays at 90 % or
  /// more of the last one.
  static Attempt refined(const cv::Mat& frame, const DotFinderOptions& options, Attempt one) {
    constexpr int rounds = 2;
    for (int round = 0; round < rounds && one.dots.rows() > 0; ++round) {
      detail::SpotLook look = one.look;
      look.pitch_px = detail::pitch_of(one.dots);
      const double given_px = options.pattern.radius_px;
      look.radius_px = (std::min)((std::max)(given_px > 0 ? given_px : one.spot.radius_px, 1.0),
                                  0.4 * look.pitch_px);
      const Attempt next = attempt(frame, options, look);
      if (next.score < 0.9 * one.score) {
        break;
      }
      one = next;
    }
    return one;
  }

  /// Expected positions of all dots on the free pad; NaN outside of `where`.
  static detail::Places places_of(const detail::Places& dots,
                                  const cv::Mat_<unsigned char>& where) {
    detail::Places all = detail::extrapolated(dots);
    for (Point2<double>& place : all.cells()) {
      const auto x = static_cast<int>(std::lround(place.x));
      const auto y = static_cast<int>(std::lround(place.y));
      const bool inside = where.empty() || (x >= 0 && y >= 0 && x < where.cols && y < where.rows &&
                                            where(y, x) != 0);
      place = inside ? place : detail::no_place();
    }
    return all;
  }

  cv::Size size_;
  detail::SpotLook look_;
  detail::Places free_;
  std::optional<detail::SpotFinder> spots_;
  std::optional<DotTracker> tracker_;
};

}  // namespace v0
}  // namespace fingerpad
