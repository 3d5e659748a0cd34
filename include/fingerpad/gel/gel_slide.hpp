// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Detects gross slip of an object on an elastic gel, from its imprint. A slipping object moves past
// dots that hardly move, and its contact shrinks before it is lost. There are two measures, and
// either can raise the alarm:
//   slide  displacement of the imprint relative to the dots in it since the contact began
//   lost   fraction of the largest contact area so far that has been lost
// The dots alone (slip/stick_ratio.hpp) do not show this, because an object that slides as a whole
// leaves them where they are. Use the stick ratio on membranes and this method on gels.
//
// The imprint is any image in which the contact is visible: that of GelContact, or a depth map.
// Its travel is the translation that maps an earlier imprint to the present one, up to a gain and
// an offset, by Gauss-Newton steps on the squared differences (Baker and Matthews, "Lucas-Kanade 20
// years on", 2004, inverse compositional); with gain and offset this maximises the correlation
// (Evangelidis and Psarakis, 2008).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v1 {

/// Thresholds of the slide. A pitch is the distance of neighbouring dots.
struct SlideOptions {
  double cell_px = 4;       ///< pixels of the dots' image per cell of the imprint, > 0
  double max_slide = 0.25;  ///< pitches; the alarm threshold of the slide, > 0
  /// Limits the evidence from lost area to (slide - its standard error) / min_slide, because an
  /// object that is let go shrinks in place. Pitches, in (0, max_slide].
  double min_slide = 0.1;
  double max_lost = 0.25;  ///< fraction of the area; the alarm threshold of the loss, in (0, 1)
  Index min_cells = 100;   ///< a smaller area counts as no contact; >= 30
};

/// Says which value is out of range; "" if none is.
inline std::string check(const SlideOptions& o) {
  constexpr Range share = {.min = 0, .max = 1, .above_min = true, .below_max = true};
  const Range up_to_max = {.min = 0, .max = o.max_slide, .above_min = true};
  return check("SlideOptions", {{"cell_px", o.cell_px, positive},
                                {"max_slide", o.max_slide, positive},
                                {"min_slide", o.min_slide, up_to_max},
                                {"max_lost", o.max_lost, share},
                                {"min_cells", o.min_cells, at_least(30)}});
}

enum class SlideStatus : std::uint8_t {
  updated,  ///< slide and area are those of this frame
  began,    ///< the first frame of a contact, from which slide and loss are measured
  /// Fewer than three dots in the contact were found both before and now, of which one could be
  /// wrong, or most dots are more than 0.75 pitches from where they are in the free pad: their
  /// labels have changed. The last slide is kept.
  no_dots,
  not_found,   ///< the imprint was not found again: the last slide is kept
  no_contact,  ///< the area is below min_cells; after a contact, all of its area counts as lost
  no_edge,     ///< contact fills the image, so that there is no imprint: nothing changes
  refused,     ///< a grid has another size: nothing was done
};

/// "updated", "began", ...
constexpr const char* name_of(SlideStatus status) {
  constexpr std::array<const char*, 7> names = {"updated",    "began",   "no dots", "not found",
                                                "no contact", "no edge", "refused"};
  return names[static_cast<std::size_t>(status)];
}

/// Result of a frame; one that is refused has no number.
struct [[nodiscard]] SlideResult {
  SlideStatus status = SlideStatus::refused;
  Index dots = 0;  ///< dots in contact from which the slide was computed
  /// Displacement of the imprint since the contact began, and its standard deviation along an axis.
  Point2<double> imprint_px = {not_a_number<double>(), not_a_number<double>()};
  double imprint_sd_px = not_a_number<double>();
  /// Displacement of the imprint relative to the dots in it.
  Point2<double> slide_px = {not_a_number<double>(), not_a_number<double>()};
  double slide = not_a_number<double>();  ///< |slide_px| in pitches
  double lost = not_a_number<double>();   ///< of the largest area so far, a fraction in [0, 1]
  /// Evidence for slip: the larger of slide / max_slide and lost / max_lost, the latter as far as
  /// min_slide allows.
  double evidence = not_a_number<double>();
  bool alarm = false;  ///< evidence > 1

  /// 1 without evidence for slip, falling to 0 at the alarm. FrictionLimit and GripControl take it
  /// in place of a stick ratio; it is fresh if ok(), and NaN if the frame is refused.
  double held() const { return (std::max)(1 - evidence, 0.0); }
  /// Whether slide and area are those of this frame.
  bool ok() const { return status == SlideStatus::updated || status == SlideStatus::began; }
  bool touches() const { return status != SlideStatus::no_contact; }
};

/// Slide of a contact, frame by frame. One object a thread; a copy of the new object is a reset. A
/// frame takes O(rows cols) time and allocates nothing.
class GelSlide {
 public:
  /// For imprints of rows x cols cells, and the dots of the free pad in px (NaN: not found).
  /// Refuses bad parameters, and dots closer than a cell or farther apart than the imprint is long
  /// (parameter_error).
  template <dot_grid Dots>
  GelSlide(Index rows, Index cols, const Dots& free_px, const SlideOptions& options = {})
      : options_(options), rows_(rows), cols_(cols) {
    const auto free = as_view(free_px);
    expects_grid_size("GelSlide: imprint", rows, cols, 3);
    expects_grid_size("GelSlide: dots", free.rows(), free.cols());
    require(options);
    touching_.resize(static_cast<std::size_t>(rows * cols));
    dots_ = {free.rows(), free.cols()};
    key_dots_ = dots_.found;
    x_.reserve(2 * dots_.found.size());
    y_.reserve(dots_.found.size());
    cells_.reserve(static_cast<std::size_t>((std::min)(rows * cols, 2 * max_cells)));
    dots_.read(free, true);
    free_ = dots_.found;
    pitch_px_ = pitch();
    const double side_px = options.cell_px * static_cast<double>((std::max)(rows, cols));
    expects(pitch_px_ >= options.cell_px && pitch_px_ <= side_px, "GelSlide", "free_px: pitch",
            pitch_px_, "at least a cell and at most the imprint: check the unit of the dots");
  }

  /// Processes a frame with `imprint` (NaN: unknown) and `contact`, cell by cell, and the dots
  /// `dots_px` in pixels (NaN: not found). A cell is cell_px pixels wide.
  template <grid Imprint, contact_mask Contact, dot_grid Dots>
  SlideResult operator()(const Imprint& imprint, const Contact& contact, const Dots& dots_px) {
    const auto now = as_view(imprint);
    const auto touch = as_view(contact);
    const auto dots = as_view(dots_px);
    if (now.rows() != rows_ || now.cols() != cols_ || !same_size(now, touch) ||
        dots.rows() != dots_.rows || dots.cols() != dots_.cols) {
      return {};
    }
    dots_.read(dots, true);
    discard_mislabelled();
    const Index area = read_contact(touch);
    result_.dots = 0;
    if (static_cast<double>(area) > filled * static_cast<double>(rows_ * cols_)) {
      result_.status = SlideStatus::no_edge;
    } else if (area < options_.min_cells) {
      result_.status = SlideStatus::no_contact;
      result_.lost = max_area_ > 0 ? 1 : 0;
      began_ = false;
    } else if (!began_) {
      began_ = true;
      max_area_ = area;
      result_ = at_rest(SlideStatus::began);
      set_key(now, area);
    } else {
      max_area_ = (std::max)(max_area_, area);
      result_.lost = 1 - static_cast<double>(area) / static_cast<double>(max_area_);
      follow(now, area);
    }
    const double sure = result_.slide - result_.imprint_sd_px / pitch_px_;
    const double by_area = (std::min)(result_.lost / options_.max_lost, sure / options_.min_slide);
    result_.evidence = (std::max)(result_.slide / options_.max_slide, by_area);
    result_.alarm = result_.evidence > 1;
    return result_;
  }

 private:
  static constexpr double filled = 0.95;            // of the image: there is no imprint
  static constexpr double min_correlation = 0.6;    // of an imprint that is found
  static constexpr double max_displacement = 0.75;  // pitches, of most dots; gels yield by less
  static constexpr Index least_dots = 3;            // of which the median is a motion
  static constexpr Index max_cells = 2048;
  static constexpr double min_cells = 30;
  static constexpr double smoothed_cells = 28;  // correlated cells: 4 pi sd^2 of a smoothing with
                                                // an sd of 1.5 cells
  static constexpr double least_noise = 0.01;   // relative to the spread of the imprint

  static SlideResult at_rest(SlideStatus status) {
    return {status, 0, {0, 0}, 0, {0, 0}, 0, 0, 0, false};
  }

  struct Cell {  // of the key frame
    Point2<double> at;
    Point2<double> slope;
    double level;
  };
  struct Travel {
    Point2<double> shift;  // cells
    double variance = 0;   // mean of both axes
    double correlation = 0;
  };

  /// The value that the share `at` of `values` is below; NaN without values.
  static double quantile(std::vector<double>& values, double at) {
    const auto nth =
        values.begin() + static_cast<std::ptrdiff_t>(at * static_cast<double>(values.size()));
    std::nth_element(values.begin(), nth, values.end());
    return values.empty() ? not_a_number<double>() : *nth;
  }

  /// Median distance of neighbours; NaN if there are none.
  double pitch() {
    x_.clear();
    for (Index k = 0; k + dots_.width < detail::size_of(free_); ++k) {
      for (const Index next : {Index(1), dots_.width}) {
        const double distance = norm(free_[k + next] - free_[k]);
        if (is_finite(distance)) {
          x_.push_back(distance);
        }
      }
    }
    return quantile(x_, 0.5);
  }

  /// Discards all dots if most are too far from where they belong.
  void discard_mislabelled() {
    x_.clear();
    for (Index k = 0; k < detail::size_of(free_); ++k) {
      const double displaced = norm(dots_.found[k] - free_[k]) / pitch_px_;
      if (is_finite(displaced)) {
        x_.push_back(displaced);
      }
    }
    if (quantile(x_, 0.5) > max_displacement) {
      std::fill(dots_.found.begin(), dots_.found.end(), detail::missing_point<double>());
    }
  }

  /// Copies the contact. Returns its area.
  template <class Touch>
  Index read_contact(const Touch& touch) {
    Index area = 0;
    for (Index k = 0; k < rows_ * cols_; ++k) {
      const bool in = is_contact(cell_t<Touch>(touch(k / cols_, k % cols_)));
      touching_[static_cast<std::size_t>(k)] = in ? 1 : 0;
      area += in ? 1 : 0;
    }
    return area;
  }
  bool touches(Index i, Index j) const {
    return touching_[static_cast<std::size_t>(i * cols_ + j)] > 0;
  }
  bool touches(const Point3<double>& dot) const {
    const double i = std::floor((dot.y + 0.5) / options_.cell_px);
    const double j = std::floor((dot.x + 0.5) / options_.cell_px);
    return i >= 0 && j >= 0 && i < static_cast<double>(rows_) && j < static_cast<double>(cols_) &&
           touches(static_cast<Index>(i), static_cast<Index>(j));
  }

  /// Makes this frame the key frame, with which later frames are compared: the cells in
  /// contact, about max_cells of them, evenly spaced. Cells with an unknown neighbour are left out.
  template <class Imprint>
  void set_key(const Imprint& now, Index area) {
    const Index step = 1 + area / max_cells;
    cells_per_sample_ = (std::max)(smoothed_cells / static_cast<double>(step), 1.0);
    cells_.clear();
    for (Index i = 1; i + 1 < rows_; ++i) {
      for (Index j = 1 + i % step; j + 1 < cols_; j += step) {
        const Point2<double> slope = {(level(now, i, j + 1) - level(now, i, j - 1)) / 2,
                                      (level(now, i + 1, j) - level(now, i - 1, j)) / 2};
        const Cell cell = {
            {static_cast<double>(j), static_cast<double>(i)}, slope, level(now, i, j)};
        if (touches(i, j) && is_finite(slope.x + slope.y + cell.level)) {
          cells_.push_back(cell);
        }
      }
    }
    for (Index k = 0; k < detail::size_of(key_dots_); ++k) {
      const Point3<double>& dot = dots_.found[k];
      key_dots_[k] = touches(dot) ? dot : detail::missing_point<double>();
    }
    last_shift_ = {0, 0};
    key_ = result_;
  }

  template <class Imprint>
  void follow(const Imprint& now, Index area) {
    const Travel travel = find(now);
    if (travel.correlation < min_correlation) {
      result_.status = SlideStatus::not_found;
      set_key(now, area);
      return;
    }
    last_shift_ = travel.shift;
    const Point2<double> imprint_px = options_.cell_px * travel.shift;
    result_.imprint_px = key_.imprint_px + imprint_px;
    result_.imprint_sd_px =
        std::hypot(key_.imprint_sd_px, options_.cell_px * std::sqrt(travel.variance));
    const Point2<double> dots_px = motion_of_dots();
    const bool known = result_.dots >= least_dots;
    result_.status = known ? SlideStatus::updated : SlideStatus::no_dots;
    if (known) {
      result_.slide_px = key_.slide_px + imprint_px - dots_px;
      result_.slide = norm(result_.slide_px) / pitch_px_;
    }
    // in motion each frame becomes the key frame of the next; at rest the key frame stays, so that
    // errors do not add up
    if (norm(travel.shift) > 1 || travel.correlation < (1 + min_correlation) / 2 || !known) {
      set_key(now, area);
    }
  }

  /// Median motion of the dots that are in contact now and were in the key frame.
  Point2<double> motion_of_dots() {
    x_.clear();
    y_.clear();
    for (Index k = 0; k < detail::size_of(key_dots_); ++k) {
      if (is_finite(key_dots_[k]) && touches(dots_.found[k])) {
        x_.push_back(dots_.found[k].x - key_dots_[k].x);
        y_.push_back(dots_.found[k].y - key_dots_[k].y);
      }
    }
    result_.dots = static_cast<Index>(x_.size());
    return {quantile(x_, 0.5), quantile(y_, 0.5)};
  }

  /// Finds the imprint of the key frame in this one, within half a pitch of its last shift.
  /// Correlation 0: not found.
  template <class Imprint>
  Travel find(const Imprint& now) const {
    constexpr int max_steps = 12;
    constexpr double enough = 0.02;  // cells; each step reduces the error a hundredfold
    const double max_shift = 0.5 * pitch_px_ / options_.cell_px;
    Travel travel = {.shift = last_shift_};
    for (int step = 0; step < max_steps; ++step) {
      // least squares of (x slope, y slope, level, 1) q = what is seen
      detail::ProductSums<double, 5> sums;
      for (const Cell& cell : cells_) {
        const double seen = sample(now, cell.at + travel.shift);
        if (is_finite(seen)) {
          sums.add({cell.slope.x, cell.slope.y, cell.level, 1, seen});
        }
      }
      const double n = sums(3, 3);
      const detail::NormalEquations<double, 4> equations(sums.corner<4>(), 1e-7);
      const auto q = equations.solve(sums.column<4>(4));
      if (n < min_cells || !equations.good || !(q[2] > 0)) {  // or inverted contrast
        return {};
      }
      const Point2<double> back = Point2<double>{q[0], q[1]} / q[2];
      travel.shift = travel.shift - back;
      const auto covariance = [&](std::size_t a, std::size_t b) {
        return (sums(a, b) - sums(a, 3) * sums(b, 3) / n) / n;
      };
      const double spreads = covariance(2, 2) * covariance(4, 4);
      travel.correlation = spreads > 0 ? covariance(2, 4) / std::sqrt(spreads) : 0;
      // mean squared residual, at the gain of the imprint
      const double known = (std::max)(travel.correlation, 0.1);
      const double noise = covariance(2, 2) * (1 / (known * known) - 1 + least_noise * least_noise);
      const auto inverse = equations.inverse();
      travel.variance = noise * cells_per_sample_ * (inverse[0][0] + inverse[1][1]) / 2;
      if (!(norm(travel.shift - last_shift_) < max_shift)) {
        return {};
      }
      if (norm(back) < enough) {
        break;
      }
    }
    return travel;
  }

  template <class Imprint>
  static double level(const Imprint& from, Index i, Index j) {
    return static_cast<double>(value(from(i, j)));
  }
  /// Bilinear interpolation; NaN beyond the image.
  template <class Imprint>
  double sample(const Imprint& from, const Point2<double>& at) const {
    if (!(at.x >= 0 && at.y >= 0 && at.x < static_cast<double>(cols_ - 1) &&
          at.y < static_cast<double>(rows_ - 1))) {
      return not_a_number<double>();
    }
    const auto i = static_cast<Index>(at.y), j = static_cast<Index>(at.x);
    const double u = at.x - static_cast<double>(j), v = at.y - static_cast<double>(i);
    return (1 - v) * ((1 - u) * level(from, i, j) + u * level(from, i, j + 1)) +
           v * ((1 - u) * level(from, i + 1, j) + u * level(from, i + 1, j + 1));
  }

  SlideOptions options_;
  Index rows_, cols_;
  double pitch_px_ = 0;
  std::vector<std::uint8_t> touching_;  // 1 for cells in contact
  detail::FrameOfDots<double> dots_{0, 0};
  detail::Bordered<Point3<double>> free_, key_dots_;  // px; z is 0
  detail::ReservedVector<Cell> cells_;
  detail::ReservedVector<double> x_, y_;
  double cells_per_sample_ = 1;
  Point2<double> last_shift_ = {0, 0};  // since the key frame, in cells
  Index max_area_ = 0;
  bool began_ = false;
  // of the key frame, of the last frame
  SlideResult key_ = at_rest(SlideStatus::no_contact), result_ = key_;
};

}  // namespace v1
}  // namespace fingerpad
