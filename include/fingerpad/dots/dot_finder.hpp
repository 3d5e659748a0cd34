// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finds printed dots in camera frames and assigns them rows and columns. Unknown properties of the
// print (size, spacing, dark or bright, number of rows) are found in a frame of the free pad. Needs
// OpenCV (core, imgproc): target fingerpad::dot_finder.
//
//   #include "fingerpad/adapt/opencv.hpp"            // makes cv::Mat_ a grid
//   DotFinder finder(free_frame);                    // any pad with a grid of dots
//   cv::Mat_<cv::Vec2d> dots(finder.rows(), finder.cols());
//   auto result = finder(frame, dots);               // NaN where a dot is lost
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/dots/detail/dot_labels.hpp"
#include "fingerpad/dots/detail/dot_lattice.hpp"
#include "fingerpad/dots/detail/dot_spots.hpp"
#include "fingerpad/dots/detail/dot_table.hpp"

namespace fingerpad {
inline namespace v1 {

/// Known properties of a print. Values that are 0, NaN or empty are found in the frame of the free
/// pad.
struct DotPattern {
  Index rows = 0;  ///< 2 to 100; give both rows and cols, or neither
  Index cols = 0;
  double radius_px = 0;        ///< of a dot, >= 1
  double pitch_px = 0;         ///< between neighbouring dots, right to a third
  std::optional<bool> bright;  ///< true: dots brighter than the background; false: darker
  /// Position of the middle of the print. With it, rows and columns at the border of the print may
  /// be out of view on the free pad; without it, all that are given must be seen.
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
  /// Deviation of a dot from the position predicted by its neighbours beyond which it may count as
  /// lost, as a fraction of the pitch, > 0. Use 0.1 for a membrane over a fluid, which moves
  /// smoothly, and 0.3 for dots behind an elastic pad, where a contact moves dots while those
  /// beside it stay still.
  double max_off = 0.1;
};

inline std::string check(const DotFinderOptions& o) {
  const DotPattern& p = o.pattern;
  const auto counted = [](Index other) { return other == 0 ? within(0, 0) : within(2, 100); };
  const Range weight = within(0, 1e6);
  return check(
      "DotFinder",
      {{"pattern.rows", p.rows, counted(p.cols)},
       {"pattern.cols", p.cols, counted(p.rows)},
       {"pattern.radius_px", p.radius_px, p.radius_px == 0 ? within(0, 0) : at_least(1)},
       {"pattern.pitch_px", p.pitch_px, at_least(0)},
       {"min_contrast", o.min_contrast, {.min = 0, .max = 1, .above_min = true, .below_max = true}},
       {"color_weights", o.color_weights[0], weight},
       {"color_weights", o.color_weights[1], weight},
       {"color_weights", o.color_weights[2], weight},
       {"the sum of color_weights", o.color_weights[0] + o.color_weights[1] + o.color_weights[2],
        positive},
       {"max_off", o.max_off, positive}});
}

enum class DotStatus : std::uint8_t {
  ok,
  lost,       ///< too few dots were recognised to trust any of them: all are NaN
  ambiguous,  ///< the rows or columns may be off by a whole number: all are NaN
  refused,    ///< frame or grid of another size or type: nothing was written
};
inline constexpr std::array<const char*, 4> dot_status_names = {"ok", "lost", "ambiguous",
                                                                "refused"};
constexpr const char* name_of(DotStatus status) {
  return dot_status_names[static_cast<std::size_t>(status)];
}

struct [[nodiscard]] DotResult {
  DotStatus status = DotStatus::refused;
  Index found = 0;     ///< dots located in this frame, also some that the free pad did not show
  Index expected = 0;  ///< dots seen on the free pad
  Index spots = 0;     ///< spots in this frame, whether they are dots or not

  bool ok() const { return status == DotStatus::ok; }
};

/// Finds and labels the dots of a pad. A value: of a print that reaches beyond the picture it knows
/// where it was in the last frame; copy it to return to a frame. One object a thread and pad.
class DotFinder {
  using Place = detail::Place;
  using Places = detail::Places;

 public:
  /// Finds the grid in `free_frame`: an image of the free pad, 8 or 16 bit (grey levels times 256),
  /// with one, three or four channels. If it does not show the grid that the options describe,
  /// ok() is false and every frame is refused. Refuses bad options (parameter_error). Takes up to a
  /// second if nothing is known of the print.
  explicit DotFinder(const cv::Mat& free_frame, const DotFinderOptions& options = {})
      : size_(free_frame.size()), max_off_(options.max_off) {
    require(options);
    const double side = (std::min)(free_frame.cols, free_frame.rows);
    expects(options.pattern.radius_px <= side / 4, "DotFinder", "pattern.radius_px",
            options.pattern.radius_px, "at most a quarter of the frame");
    expects(options.pattern.pitch_px <= side / 2, "DotFinder", "pattern.pitch_px",
            options.pattern.pitch_px, "at most half of the frame");
    expects(options.where.empty() || options.where.size() == size_, "DotFinder", "where.rows",
            static_cast<long long>(options.where.rows),
            "equal to the rows of the free frame, and where.cols to its columns");
    if (!detail::is_picture(free_frame)) {
      refusal_ = "no picture of 8 or 16 bit with one, three or four channels";
      return;
    }
    const Attempt best = search(free_frame, options);
    look_ = best.look;
    free_ = best.dots;
    refusal_ = refusal_of(best, options.pattern.pitch_px);
    if (refusal_.empty() && options.pattern.rows > 0) {
      refusal_ = placed(options.pattern);
    }
    if (!refusal_.empty()) {
      return;
    }
    spots_.emplace(look_, options.where);
    (void)spots_->learn(free_frame, present(free_));
    const double edge = look_.radius_px + (std::max)(look_.radius_px, look_.edge_px + 2);
    print_.emplace(free_, [where = options.where, size = size_, edge](const Place& at) {
      const cv::Rect2d view(edge, edge, size.width - 1 - 2 * edge, size.height - 1 - 2 * edge);
      return view.contains({at.x, at.y}) &&
             (where.empty() || where(cvRound(at.y), cvRound(at.x)) != 0);
    });
    seeds_px_ = print_->seeds_px();
  }

  /// Whether the free frame showed the grid.
  bool ok() const { return refusal_.empty(); }
  /// What it showed instead: "7 rows and 9 columns of dots, not 8 and 10".
  const std::string& refusal() const { return refusal_; }
  Index rows() const { return free_.rows(); }
  Index cols() const { return free_.cols(); }
  /// The free pad's dots, px; NaN for a dot that was not seen.
  StridedView<const Point2<double>> free_px() const { return free_.view(); }
  /// Properties of the print as found in the free frame, also of one that is refused.
  DotPattern pattern() const {
    DotPattern found;
    found.rows = rows();
    found.cols = cols();
    found.radius_px = look_.radius_px;
    found.pitch_px = detail::pitch_of(free_);
    found.bright = look_.bright;
    return found;
  }

  /// The dots of the next frame, by their printed row and column; NaN for a lost dot. Takes
  /// O(pixels + dots) time and allocates its buffers.
  template <dot_grid Dots>
  DotResult operator()(const cv::Mat& frame, Dots&& dots_px) {
    if (!ok() || frame.size() != size_ || !detail::is_picture(frame)) {
      return {};
    }
    std::vector<Place> poor;
    std::vector<Place> spots = spots_->find(frame, &poor);
    const auto discs = static_cast<int>(spots.size());
    spots.insert(spots.end(), poor.begin(), poor.end());
    return label(detail::SpotMap(std::move(spots)), discs, dots_px);
  }

  /// The same from spots in any order that another program has found. Those that are not finite, or
  /// farther out than 1e6 px, are ignored.
  template <dot_grid Dots>
  DotResult label(const std::vector<Point2<double>>& spots, Dots&& dots_px) {
    std::vector<Place> good;
    std::copy_if(spots.begin(), spots.end(), std::back_inserter(good),
                 [](const Place& spot) { return is_plausible(spot); });
    const detail::SpotMap map(std::move(good));
    return label(map, map.size(), dots_px);
  }

 private:
  /// Damaged dots tell rows and columns like the others, but only the first `discs` spots have a
  /// center to be returned.
  template <class Dots>
  DotResult label(const detail::SpotMap& map, int discs, Dots&& dots_px) {
    DotResult result;
    if (!ok() || fingerpad::rows(dots_px) != rows() || fingerpad::cols(dots_px) != cols()) {
      return result;
    }
    auto answer = print_->labels_of(map, seeds_px_, max_off_);
    Places found(rows(), cols(), detail::no_place());
    result.status = answer.score <= 0  ? DotStatus::lost
                    : answer.ambiguous ? DotStatus::ambiguous
                                       : DotStatus::ok;
    if (result.ok()) {
      print_->follow(places_of(answer.labels, map), seeds_px_);
      for (int& label : answer.labels.cells()) {
        label = label < discs ? label : -1;
      }
      constexpr Index beyond = detail::DotPrint::beyond;
      found = window_of(places_of(answer.labels, map), beyond, beyond, rows(), cols(),
                        detail::no_place());
    }
    result.spots = map.size();
    result.expected = print_->count();
    result.found = count_present(found);
    for (Index i = 0; i < rows(); ++i) {
      for (Index j = 0; j < cols(); ++j) {
        using Grid = std::remove_cvref_t<Dots>;
        using Cell = cell_t<Grid>;
        using Coordinate = std::remove_cvref_t<decltype(point_traits<Cell>::x(Cell()))>;
        grid_traits<Grid>::at(dots_px, i, j) =
            Cell{static_cast<Coordinate>(found(i, j).x), static_cast<Coordinate>(found(i, j).y)};
      }
    }
    return result;
  }

  struct Attempt {
    detail::SpotLook look;
    detail::Places dots;
    Index beside = 0;  ///< spots beside the grid, within two and a half pitches of a dot
    detail::SpotFinder::Typical spot;
    double score = 0;
  };

  /// Why the dots of an attempt are no print; "" if they are one.
  static std::string refusal_of(const Attempt& one, double given_pitch_px) {
    if (one.dots.rows() == 0) {
      return "no grid of 9 or more dots";
    }
    const double pitch_px = detail::pitch_of(one.dots);
    if (given_pitch_px > 0 &&
        (std::max)(pitch_px, given_pitch_px) > 1.5 * (std::min)(pitch_px, given_pitch_px)) {
      return detail::print("dots %.3g px apart, not %.3g", pitch_px, given_pitch_px);
    }
    const Index count = count_present(one.dots);
    return 9 * one.beside > count
               ? detail::print("%d dots in %d rows and %d columns, and %d beside them",
                               static_cast<int>(count), static_cast<int>(one.dots.rows()),
                               static_cast<int>(one.dots.cols()), static_cast<int>(one.beside))
               : "";
  }

  static std::vector<Place> present(const Places& dots) {
    std::vector<Place> some;
    std::copy_if(dots.cells().begin(), dots.cells().end(), std::back_inserter(some),
                 [](const Place& dot) { return is_finite(dot); });
    return some;
  }

  /// Puts the dots at their place among the given rows and columns; why not if they have none.
  std::string placed(const DotPattern& given) {
    const Places flat = detail::flattened(free_);
    const auto index = [](double number) { return static_cast<Index>(std::lround(number)); };
    double top = 0, left = 0;
    if (is_finite(given.middle_px)) {
      const Place right = flat(0, 1) - flat(0, 0), down = flat(1, 0) - flat(0, 0);
      const Place off = given.middle_px - flat(0, 0);
      const double area = right.x * down.y - right.y * down.x;
      top = (right.x * off.y - right.y * off.x) / area - static_cast<double>(given.rows - 1) / 2;
      left = (off.x * down.y - off.y * down.x) / area - static_cast<double>(given.cols - 1) / 2;
    }
    const auto fits = [](double first, Index found, Index all, bool known) {
      const double before = -std::round(first);  // rows or columns out of view
      const double after = static_cast<double>(all - found) - before;
      return known ? std::abs(first + before) < 0.25 && before >= 0 && after >= 0 : found == all;
    };
    const bool known = is_finite(given.middle_px);
    if (!fits(top, rows(), given.rows, known) || !fits(left, cols(), given.cols, known)) {
      return detail::print("%d rows and %d columns of dots, not %d and %d",
                           static_cast<int>(rows()), static_cast<int>(cols()),
                           static_cast<int>(given.rows), static_cast<int>(given.cols));
    }
    free_ = window_of(free_, index(top), index(left), given.rows, given.cols, detail::no_place());
    return "";
  }

  /// Finds and scores the grid for one look. The score favours many dots, few other spots and a
  /// high contrast. Contrast matters because the blocks of a compressed image form a grid, too, but
  /// a faint one.
  static Attempt attempt(const cv::Mat& frame,
                         const DotFinderOptions& options,
                         const detail::SpotLook& look) {
    detail::SpotFinder finder(look, options.where);
    std::vector<Place> poor;
    std::vector<Place> spots = finder.find(frame, &poor);
    if (2 * poor.size() < spots.size()) {  // else the look is not that of the dots
      spots.insert(spots.end(), poor.begin(), poor.end());
    }
    Attempt one;
    one.look = look;
    one.dots = detail::lattice_of(spots);
    const std::vector<Place> dots = present(one.dots);
    if (!dots.empty()) {
      const detail::SpotMap map(dots);
      const double pitch_px = detail::pitch_of(one.dots);
      for (const Place& spot : spots) {
        const auto hit = map.nearest(spot, 2.5 * pitch_px);
        one.beside += hit.spot >= 0 && hit.distance_px > look.radius_px ? 1 : 0;
      }
      one.spot = finder.learn(frame, dots);
      const auto count = static_cast<double>(dots.size());
      one.score =
          count * count / static_cast<double>(spots.size()) * one.spot.contrast * one.spot.contrast;
    }
    return one;
  }

  /// Tries radii, if none is given, and both signs (dark, bright). The grid with the best score is
  /// looked for again with the radius and the blur that its dots have; that counts if the score
  /// stays at 90 % or more.
  static Attempt search(const cv::Mat& frame, const DotFinderOptions& options) {
    constexpr double smallest_px = 1, step = 1.4;
    const DotPattern& given = options.pattern;
    const bool known = given.radius_px > 0;
    const double largest_px = known ? given.radius_px : (std::min)(frame.cols, frame.rows) / 8.0;
    Attempt best;
    for (double r = known ? given.radius_px : smallest_px; r <= largest_px; r *= step) {
      for (const bool bright : {false, true}) {
        if (bright == given.bright.value_or(bright)) {
          const Attempt one =
              attempt(frame, options,
                      {r, (std::min)(r, 2.0), bright, options.min_contrast, options.color_weights});
          best = one.score > best.score ? one : best;
        }
      }
    }
    detail::SpotLook look = best.look;
    look.radius_px = known ? given.radius_px : (std::max)(best.spot.radius_px, 1.0);
    look.edge_px = best.spot.edge_px;
    const Attempt again = best.score > 0 ? attempt(frame, options, look) : best;
    return again.score < 0.9 * best.score ? best : again;
  }

  cv::Size size_;
  double max_off_;
  std::string refusal_;
  detail::SpotLook look_;
  Places free_;
  std::vector<Place> seeds_px_;  ///< where the seeds of labels are looked for
  std::optional<detail::SpotFinder> spots_;
  std::optional<detail::DotPrint> print_;
};

}  // namespace v1
}  // namespace fingerpad
