// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Contact of a gel pad without depth, from the difference between a frame and the free pad. It
// suits gel pads lit from the side (GelSight, DIGIT and similar), with or without printed dots, and
// gels that darken where they are pressed. Needs OpenCV (core, imgproc): target fingerpad::gel.
//
// The difference is relative, (now / gain) / free - 1, so that lamps may be uneven. The gain of
// each channel is the median of now / free, so that exposure and white balance may change. The
// median is taken over the frame or, if more than half of the frame differs, over its border. Where
// it leaves a difference in most cells, because a lamp has faded on one side or flickers in bands,
// it is multiplied by a plane or by the medians of rows or columns. Dots are left out: they move
// with the gel beside a contact as well as under it, and would be taken for contact.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v1 {

/// Lengths are in px of the frame.
struct GelOptions {
  int cell_px = 4;          ///< side of a cell, in which contact is decided; in [1, 16]
  double smoothing_px = 7;  ///< sd of the Gaussian that averages the difference, about half a dot;
                            ///< in [cell_px / 2, 16 cell_px]
  double dot_px = 14;       ///< diameter of the printed dots, in [0, 16 cell_px]; 0: no dots
  double dot_contrast = 0.1;  ///< a cell darker than its surroundings by this fraction belongs to a
                              ///< dot; in (0, 1)
  bool bright_dots = false;   ///< dots are lighter than their surroundings, not darker
  double min_difference = 0.02;  ///< smallest threshold, as a fraction of the free brightness,
                                 ///< however low the noise of the free frames; in (0, 1)
  double max_gap_px = 28;   ///< gaps in a contact up to this width are closed, by default two dots;
                            ///< in [0, 32 cell_px]
  int min_region_px = 800;  ///< smaller regions are dropped; >= 0
  /// An old gel keeps this share of a press: a cell must differ by more than this share of the
  /// largest difference of the contacts that it has been part of; in [0, 1).
  double kept_share = 0.05;
};

/// Says which value is out of range; "" if none is.
inline std::string check(const GelOptions& options) {
  const double cell = options.cell_px;
  constexpr Range share = {.min = 0, .max = 1, .above_min = true, .below_max = true};
  return check("GelOptions",
               {{"cell_px", options.cell_px, within(1, 16)},
                {"smoothing_px", options.smoothing_px, within(cell / 2, 16 * cell)},
                {"dot_px", options.dot_px, within(0, 16 * cell)},
                {"dot_contrast", options.dot_contrast, share},
                {"min_difference", options.min_difference, share},
                {"max_gap_px", options.max_gap_px, within(0, 32 * cell)},
                {"min_region_px", options.min_region_px, not_negative},
                {"kept_share", options.kept_share, Range{.min = 0, .max = 1, .below_max = true}}});
}

struct [[nodiscard]] GelResult {
  /// not_of_this_pad: no cell is known, or at least half of the frame and of its border differ from
  /// the free pad.
  FrameStatus status = FrameStatus::refused;
  int contact_px = 0;  ///< area of the contact
  Point2<double> center_px = {not_a_number<double>(), not_a_number<double>()};  ///< its centroid

  bool ok() const { return status == FrameStatus::ok; }
  bool in_contact() const { return contact_px > 0; }
};

/// Finds the contact in frames of 8 or 16 bit (grey levels times 256) with one or three channels.
/// Cells that are black or saturated say nothing. Valid while the object touches less than half of
/// the frame or less than half of its border, because the majority is taken to be free.
///
/// One object a thread. Bounded time, O(rows cols). The constructor allocates all images; on each
/// call OpenCV takes buffers for some rows of cells, and for outlines.
class GelContact {
 public:
  /// Learns the free pad from frames of it. With two or more their noise is measured and may raise
  /// the threshold. Refuses no frame, frames of several sizes or types, and bad parameters
  /// (parameter_error).
  explicit GelContact(std::span<const cv::Mat> free_frames, const GelOptions& options = {})
      : options_(options) {
    require(options);
    constexpr const char* owner = "GelContact";
    expects(!free_frames.empty(), owner, "free_frames", free_frames.size(), "one or more");
    size_ = free_frames.front().size();
    type_ = free_frames.front().type();
    for (const cv::Mat& frame : free_frames) {
      const auto number = &frame - free_frames.data();
      expects(frame.size() == size_ && frame.type() == type_, owner, "free_frames: number", number,
              "of the size and type of the first");
    }
    const int side = (std::min)(size_.height, size_.width);
    expects(side >= options.cell_px, owner, "free_frames: side", side, ">= cell_px");
    expects(type_ == CV_8UC1 || type_ == CV_8UC3 || type_ == CV_16UC1 || type_ == CV_16UC3, owner,
            "free_frames: type", type_, "of 8 or 16 bit, with 1 or 3 channels");
    const int gap = cvRound(in_cells(options.max_gap_px / 2));
    closing_ = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * gap + 1, 2 * gap + 1});
    const int half_dot = cvCeil(in_cells(options.dot_px) / 2) + 1;  // and the cell beside
    dot_ = cv::Mat::ones(2 * half_dot + 1, 2 * half_dot + 1, CV_8U);
    inner_ = {{gap, gap}, size_ / options.cell_px};
    wide_.create(inner_.height + 2 * gap, inner_.width + 2 * gap);
    for (cv::Mat_<float>* image : {&weight_, &both_, &grey_, &share_, &difference_, &imprint_}) {
      image->create(inner_.size());
    }
    kept_ = cv::Mat_<float>::zeros(inner_.size());
    mask_.create(inner_.size());
    for (cv::Mat_<cv::Vec3f>* image : {&relative_, &gains_, &trial_}) {
      image->create(inner_.size());
    }
    values_.reserve(static_cast<std::size_t>(inner_.area()));
    holes_.reserve(values_.capacity());
    cells_.reserve(values_.capacity());
    learn(free_frames);
    (void)(*this)(free_frames.front());  // OpenCV allocates the other images
    kept_.setTo(0);
  }
  GelContact(GelContact&&) = default;

  /// The contact, cell by cell: 255, else 0. Cell (i, j) begins at the pixel (i, j) cell_px; pixels
  /// beyond the last whole cell are left out.
  const cv::Mat_<unsigned char>& mask() const { return mask_; }
  /// The difference from the free pad, cell by cell, to which the threshold applies: the root mean
  /// square over the channels, as a fraction of the free brightness; NaN where it is unknown.
  const cv::Mat_<float>& difference() const { return difference_; }
  /// The same with the dots of both frames filled in from the gel beside them; what is dark but
  /// wider than a dot is shade, and stays. GelSlide follows it: an imprint with holes at the dots
  /// would seem to move with the dots. Computed on each call, O(rows cols).
  const cv::Mat_<float>& imprint() {
    for (int k = 0; k < inner_.area(); ++k) {
      both_(k) = grey_(k) > 0 ? free_seen_(k) : 0;
    }
    relate();
    fill(relative_, weight_, both_);
    average(imprint_);
    return imprint_;
  }
  /// Cells whose difference exceeds it, and what earlier contacts may have left, are contact.
  double threshold() const { return threshold_; }

  /// Finds the contact in a frame. A frame of another size or type than the free ones is refused.
  GelResult operator()(const cv::Mat& frame) {
    if (frame.size() != size_ || frame.type() != type_) {
      return {};
    }
    read(frame);
    GelResult result = found(false);
    if (result.in_contact() && !is_mostly_free(false)) {
      // a contact leaves most of the border free; another lamp changes the border most
      result = found(true);
      result.status = is_mostly_free(true) ? FrameStatus::ok : FrameStatus::not_of_this_pad;
    }
    for (int k = 0; k < inner_.area() && result.ok(); ++k) {
      const float seen = is_finite(difference_(k)) ? difference_(k) : 1;  // black or saturated
      const float kept = static_cast<float>(options_.kept_share) * seen;
      kept_(k) = mask_(k) > 0 && kept > kept_(k) ? kept : kept_(k);
    }
    return result;
  }

 private:
  static constexpr float min_share = 0.05F;  // of the Gaussian's weight that is on gel
  static constexpr float saturated = 254;
  static constexpr double max_slope = 0.12;  // of a lamp that fades, across the frame

  double in_cells(double px) const { return px / options_.cell_px; }
  bool is_border(int k) const {
    const int i = k / inner_.width, j = k % inner_.width;
    return i == 0 || j == 0 || i + 1 == inner_.height || j + 1 == inner_.width;
  }
  /// The value that the share `at` of values_ is below; `none` without values.
  float quantile(double at, float none) {
    const auto nth = values_.begin() + static_cast<std::ptrdiff_t>(at * double(values_.size()));
    std::nth_element(values_.begin(), nth, values_.end());
    return values_.empty() ? none : *nth;
  }

  /// Reduces a frame to means of cells, with weight 1 where they show gel, 0 where dots or nothing.
  void read(const cv::Mat& frame) {
    // OpenCV halves an image much faster than it shrinks it by another factor
    const cv::Rect whole({0, 0}, inner_.size() * options_.cell_px);
    cv::resize(frame(whole), half_, whole.size() / (options_.cell_px % 2 == 0 ? 2 : 1), 0, 0,
               cv::INTER_AREA);
    cv::resize(half_, small_, inner_.size(), 0, 0, cv::INTER_AREA);
    if (frame.channels() == 1) {
      cv::cvtColor(small_, colours_, cv::COLOR_GRAY2BGR);
    }
    const double levels = frame.depth() == CV_16U ? 1.0 / 256 : 1.0;
    (frame.channels() == 1 ? colours_ : small_).convertTo(now_, CV_32F, levels);
    for (int k = 0; k < inner_.area(); ++k) {
      const auto [least, most] = std::minmax({now_(k)[0], now_(k)[1], now_(k)[2]});
      weight_(k) = least > 0 && most < saturated ? 1 : 0;
      grey_(k) = weight_(k) * (now_(k)[0] + now_(k)[1] + now_(k)[2]);
    }
    if (options_.dot_px > 0) {
      const int width = 2 * cvCeil(2 * in_cells(options_.dot_px)) + 1;
      cv::blur(grey_, around_, {width, width}, {-1, -1}, cv::BORDER_CONSTANT);
      cv::blur(weight_, share_, {width, width}, {-1, -1}, cv::BORDER_CONSTANT);
      const float sign = options_.bright_dots ? -1 : 1;
      const float gel = sign * (1 - sign * static_cast<float>(options_.dot_contrast));
      for (int k = 0; k < inner_.area(); ++k) {
        weight_(k) = sign * grey_(k) * share_(k) < gel * around_(k) ? 0 : weight_(k);
      }
      cv::erode(weight_, weight_, cv::Mat());  // dots may reach into the cells beside
    }
  }

  /// Sets the free pad to the mean of the frames, and the threshold from their noise: the value
  /// that a hundredth of a frame's difference from the mean of the others exceeds.
  void learn(std::span<const cv::Mat> frames) {
    const auto count = static_cast<float>(frames.size());
    free_ = cv::Mat_<cv::Vec3f>(inner_.size(), cv::Vec3f());
    free_weight_ = cv::Mat_<float>(inner_.size(), 1.0F);
    free_seen_ = free_weight_.clone();
    for (const cv::Mat& frame : frames) {
      read(frame);
      free_ += now_ / static_cast<double>(count);
      cv::multiply(free_weight_, weight_, free_weight_);
      for (int k = 0; k < inner_.area(); ++k) {
        free_seen_(k) = grey_(k) > 0 ? free_seen_(k) : 0;
      }
    }
    fill(free_, free_weight_, free_seen_);
    std::vector<float> noise;
    for (const cv::Mat& frame : frames) {
      read(frame);
      compare(false);
      values_.clear();
      std::copy_if(difference_.begin(), difference_.end(), std::back_inserter(values_),
                   [](float difference) { return is_finite(difference); });
      // the mean of all contains the frame: the mean of the others differs more
      noise.push_back(count / (std::max)(count - 1, 1.0F) * quantile(0.99, 0));
    }
    values_ = noise;  // the median, since one frame may not be free after all
    threshold_ = (std::max)(options_.min_difference, static_cast<double>(quantile(0.5, 0)));
  }

  /// Sets difference_ to the root mean square over the channels of now / gain / free - 1, smoothed
  /// over the gel that both frames show.
  void compare(bool by_border) {
    cv::multiply(weight_, free_weight_, both_);
    find_gains(by_border);
    relate();
    average(difference_);
  }

  /// Sets the gain of each cell to the median over a lattice over the frame, or over its border;
  /// and over the frame, as long as this halves the median difference of the frame and that of its
  /// border, multiplies it by a plane, or by the medians of rows or of columns.
  void find_gains(bool by_border) {
    cells_.clear();
    for (int k = 0; k < inner_.area(); k += by_border ? 1 : 1 + inner_.area() / 2048) {
      if (both_(k) > 0 && (!by_border || is_border(k))) {
        cells_.push_back(k);
      }
    }
    gains_.setTo(cv::Scalar::all(1));
    multiply_by_plane(0);
    cv::swap(gains_, trial_);
    const float enough = static_cast<float>(options_.min_difference) / 4;
    bool is_better = !by_border;
    for (int change = 0; change < 3 && is_better; ++change) {
      const cv::Vec2f left = median_differences(gains_);
      is_better = false;
      for (int shape = 0; shape < 3 && !is_better && left[0] > enough; ++shape) {
        is_better = shape == 0 ? multiply_by_plane(8) : multiply_by_lines(shape == 1);
        const cv::Vec2f now = median_differences(trial_);
        is_better = is_better && now[0] < left[0] / 2 && now[1] < left[1] / 2;
      }
      if (is_better) {
        cv::swap(gains_, trial_);
      }
    }
  }
  float ratio(int k, int c) const { return now_(k)[c] / (gains_(k)[c] * free_(k)[c]); }
  /// Medians over cells_ and over the border of the largest difference in a channel.
  cv::Vec2f median_differences(const cv::Mat_<cv::Vec3f>& gains) {
    cv::Vec2f medians;
    const auto add = [&](int k) {
      float most = 0;
      for (int c = 0; c < 3; ++c) {
        most = (std::max)(most, std::abs(now_(k)[c] / (gains(k)[c] * free_(k)[c]) - 1));
      }
      values_.push_back(most);
    };
    values_.clear();
    std::for_each(cells_.begin(), cells_.end(), add);
    medians[0] = quantile(0.5, 0);
    values_.clear();
    for (int k = 0; k < inner_.area(); ++k) {
      if (is_border(k) && both_(k) > 0) {
        add(k);
      }
    }
    medians[1] = quantile(0.5, 0);
    return medians;
  }
  /// Sets trial_ to gains_ times the median of what they leave or, after some steps of reweighted
  /// least squares, times the plane with the least sum of absolute differences. False: its slope is
  /// not that of a lamp that fades, but of other lamps.
  bool multiply_by_plane(int steps) {
    bool fades = true;
    const auto place = [&](int k) {
      return cv::Vec3d(double(k % inner_.width) / inner_.width - 0.5,
                       double(k / inner_.width) / inner_.height - 0.5, 1);
    };
    for (int c = 0; c < 3; ++c) {
      values_.clear();
      for (const int k : cells_) {
        values_.push_back(ratio(k, c));
      }
      cv::Vec3d plane(0, 0, static_cast<double>(quantile(0.5, 1)));
      for (int step = 0; step < steps; ++step) {
        detail::ProductSums<double, 4> sums;
        for (const int k : cells_) {
          const double seen = static_cast<double>(ratio(k, c));
          const cv::Vec3d at = place(k);
          const double root = 1 / std::sqrt(std::abs(seen - plane.dot(at)) + 0.002);
          sums.add({root * at[0], root * at[1], root, root * seen});
        }
        const detail::NormalEquations<double, 3> equations(sums.corner<3>(), 1e-7);
        if (equations.good) {
          const auto found = equations.solve(sums.column<3>(3));
          plane = {found[0], found[1], found[2]};
        }
      }
      for (int k = 0; k < inner_.area(); ++k) {
        trial_(k)[c] = gains_(k)[c] * static_cast<float>(plane.dot(place(k)));
      }
      fades = fades && std::hypot(plane[0], plane[1]) < max_slope * plane[2];
    }
    return fades;
  }
  /// Sets trial_ to gains_ times the median of what they leave in each row, or in each column.
  /// False: these do not rise and fall, as bands do.
  bool multiply_by_lines(bool rows) {
    int side = 0, turns = 0;
    const int lines = rows ? inner_.height : inner_.width;
    for (int line = 0; line < lines; ++line) {
      const int first = rows ? line * inner_.width : line, step = rows ? 1 : inner_.width;
      const int last = first + step * (inner_.area() / lines);
      float sum = 0;
      for (int c = 0; c < 3; ++c) {
        values_.clear();
        for (int k = first; k < last; k += step) {
          if (both_(k) > 0) {
            values_.push_back(ratio(k, c));
          }
        }
        const float median = quantile(0.5, 1);
        sum += median - 1;
        for (int k = first; k < last; k += step) {
          trial_(k)[c] = gains_(k)[c] * median;
        }
      }
      if (std::abs(sum / 3) > static_cast<float>(options_.min_difference) / 2) {
        const int now = sum > 0 ? 1 : -1;
        turns += side != 0 && now != side ? 1 : 0;
        side = now;
      }
    }
    return turns > 1;
  }
  void relate() {
    for (int k = 0; k < inner_.area(); ++k) {
      for (int c = 0; c < 3; ++c) {
        relative_(k)[c] = both_(k) > 0 ? ratio(k, c) - 1 : 0;
      }
    }
  }
  /// Fills gaps in the gel of a dot's width: each cell becomes the mean of those beside it, by
  /// over-relaxation, and counts as seen. Cells of the border stay as they are.
  void fill(cv::Mat_<cv::Vec3f>& image, const cv::Mat_<float>& gel, cv::Mat_<float>& seen) {
    cv::morphologyEx(gel, share_, cv::MORPH_CLOSE, dot_);
    holes_.clear();
    for (int k = 0; k < inner_.area(); ++k) {
      if (gel(k) == 0 && share_(k) > 0) {
        share_(k) = is_border(k) ? 0 : 1;
        if (share_(k) > 0) {
          seen(k) = 1;
          image(k) = image(k - 1);
          holes_.push_back(k);
        }
      }
    }
    for (int sweep = 0; sweep < 20; ++sweep) {
      for (const int k : holes_) {
        cv::Vec3f sum;
        float count = 0;
        for (const int neighbour : {k - 1, k + 1, k - inner_.width, k + inner_.width}) {
          sum += share_(neighbour) * image(neighbour);
          count += share_(neighbour);
        }
        image(k) += 1.4F * (sum / (std::max)(count, 1.0F) - image(k));
      }
    }
  }
  /// Root mean square over the channels of the mean of relative_ around each cell.
  void average(cv::Mat_<float>& length) {
    const double sd = in_cells(options_.smoothing_px);
    const int width = 2 * cvCeil(3 * sd) + 1;
    cv::GaussianBlur(relative_, smooth_, {width, width}, sd, sd, cv::BORDER_CONSTANT);
    cv::GaussianBlur(both_, share_, {width, width}, sd, sd, cv::BORDER_CONSTANT);
    for (int k = 0; k < inner_.area(); ++k) {
      length(k) = share_(k) > min_share ? std::sqrt(smooth_(k).dot(smooth_(k)) / 3) / share_(k)
                                        : not_a_number<float>();
    }
  }

  /// Finds the contact in the frame that was read last: cells above the threshold, opened by a
  /// cell, closed over gaps, without holes and small regions.
  GelResult found(bool by_border) {
    compare(by_border);
    for (int k = 0; k < inner_.area(); ++k) {
      mask_(k) = difference_(k) > (std::max)(static_cast<float>(threshold_), kept_(k)) ? 255 : 0;
    }
    cv::morphologyEx(mask_, mask_, cv::MORPH_OPEN, cv::Mat());
    wide_.setTo(0);  // wider than the frame, or closing would draw a contact to the frame's edge
    mask_.copyTo(wide_(inner_));
    cv::morphologyEx(wide_, wide_, cv::MORPH_CLOSE, closing_);
    cv::findContours(wide_(inner_), outlines_, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    mask_.setTo(0);
    const int cell_px2 = options_.cell_px * options_.cell_px;
    for (const auto& outline : outlines_) {
      // Pick's theorem: the outline joins the middles of cells
      const double cells = cv::contourArea(outline) + static_cast<double>(outline.size()) / 2 + 1;
      if (cells * cell_px2 >= options_.min_region_px) {
        cv::fillPoly(mask_, outline, 255);
      }
    }
    GelResult result;
    const bool is_known = std::any_of(difference_.begin(), difference_.end(), is_finite<float>);
    result.status = is_known ? FrameStatus::ok : FrameStatus::not_of_this_pad;
    const cv::Moments sums = cv::moments(mask_, true);
    result.contact_px = static_cast<int>(sums.m00) * cell_px2;
    if (result.in_contact()) {
      const auto middle_px = [&](double sum) {
        return (sum / sums.m00 + 0.5) * options_.cell_px - 0.5;
      };
      result.center_px = {middle_px(sums.m10), middle_px(sums.m01)};
    }
    return result;
  }

  /// Whether less than half of the known cells, of the frame or of its border, differ.
  bool is_mostly_free(bool of_border) const {
    int balance = 0;
    for (int k = 0; k < inner_.area(); ++k) {
      const bool differs =
          of_border ? difference_(k) > static_cast<float>(threshold_) : mask_(k) > 0;
      if (!of_border || is_border(k)) {
        balance += differs ? 1 : is_finite(difference_(k)) ? -1 : 0;
      }
    }
    return balance < 0;
  }

  GelOptions options_;
  cv::Size size_;   // of a frame, px
  int type_ = 0;    // of a frame
  cv::Rect inner_;  // the frame in wide_, in cells
  double threshold_ = 0;
  cv::Mat closing_, dot_, half_, small_, colours_;
  cv::Mat_<cv::Vec3f> now_, free_, relative_, smooth_, gains_, trial_;
  cv::Mat_<float> weight_, free_weight_, free_seen_, both_, share_, grey_, around_, difference_,
      imprint_, kept_;
  cv::Mat_<unsigned char> mask_, wide_;
  std::vector<std::vector<cv::Point>> outlines_;
  std::vector<float> values_;
  std::vector<int> holes_, cells_;
};

}  // namespace v1
}  // namespace fingerpad
