// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/array_picture.hpp"

#include <algorithm>
#include <cmath>

#include "replay/foam/axis.hpp"
#include "replay/pictures/canvas.hpp"
#include "replay/pictures/depth_colours.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

constexpr std::size_t columns = 7;
constexpr double left = 28;
constexpr double finger_gap = 8;
constexpr double small_letter = 8;
const Ink empty_ink(246, 244, 243);

/// Positions of fingers and taxels in a column of the picture.
class Layout {
 public:
  explicit Layout(const std::vector<FingerPlace>& fingers) : fingers_(fingers) {
    int rows = 1;
    int cols = 0;
    for (const FingerPlace& place : fingers) {
      rows = (std::max)(rows, place.rows);
      cols += place.cols;
    }
    const double gaps = finger_gap * static_cast<double>(fingers.size() - 1);
    cell_ = (std::min)({20.0, (160 - gaps) / cols, 300.0 / rows});
    width_ = cell_ * cols + gaps;
    height_ = cell_ * rows;
    pitch_ = (std::max)(width_ + 24, 100.0);
  }

  double cell() const { return cell_; }
  double height() const { return height_; }
  double pitch() const { return pitch_; }
  double middle(std::size_t column) const {
    return left + pitch_ * (static_cast<double>(column) + 0.5);
  }
  /// Upper left corner of a finger.
  Spot corner(std::size_t column, std::size_t finger, double top) const {
    double x = middle(column) - width_ / 2;
    for (std::size_t f = 0; f < finger; ++f) {
      x += cell_ * fingers_[f].cols + finger_gap;
    }
    return {x, top};
  }

 private:
  const std::vector<FingerPlace>& fingers_;
  double cell_;
  double width_;
  double height_;
  double pitch_;
};

/// A scale from 0 to a round number.
ColourScale scale_to(double largest, const cv::Mat_<cv::Vec3b>& colours) {
  const double tick = round_up((std::max)(largest, 1e-12) / 4);
  return {0, tick * (std::max)(1.0, std::ceil(largest / tick - 1e-9)), tick, colours};
}

/// Pale to red, the upper half of change_scale().
cv::Mat_<cv::Vec3b> reds() {
  const cv::Mat_<cv::Vec3b> both = change_scale(1).colours;
  cv::Mat_<cv::Vec3b> upper(1, 256);
  for (int k = 0; k < 256; ++k) {
    upper(0, k) = both(0, 128 + k / 2);
  }
  return upper;
}

Ink ink_of(const ColourScale& scale, double value) {
  const double share = std::clamp(value / scale.top_mm, 0.0, 1.0);
  const cv::Vec3b& colour = scale.colours(0, static_cast<int>(std::lround(share * 255)));
  return Ink(colour[0], colour[1], colour[2]);
}

class Strip {
 public:
  Strip(const FoamRecording& recording,
        const std::vector<FoamRow>& rows,
        const std::vector<std::size_t>& shown,
        const FoamActivity& activity)
      : recording_(recording),
        rows_(rows),
        shown_(shown),
        activity_(activity),
        layout_(recording.sensor.fingers) {}

  cv::Mat paint(const std::string& title) const {
    const double first = 128;
    const double second = first + layout_.height() + 64;
    const double right = left + layout_.pitch() * static_cast<double>(columns);
    Canvas canvas(right + 76, second + layout_.height() + 66);
    canvas.text({left, 34}, title, 1.3 * letter, ink::black, Align::left, true);
    const ColourScale readings = scale_to(largest_reading(), depth_scale(1).colours);
    const ColourScale spreads = scale_to(largest_deviation(), reds());
    canvas.text({left, 60}, "above: readings", letter, ink::grey);
    canvas.text({left + 124, 60},
                "below: rms of the vibration in the window, where above the noise", letter,
                ink::grey);
    for (std::size_t c = 0; c < shown_.size(); ++c) {
      paint_caption(canvas, c, first - 34);
      for (std::size_t f = 0; f < recording_.sensor.fingers.size(); ++f) {
        paint_finger(canvas, c, f, layout_.corner(c, f, first), readings, true);
        paint_finger(canvas, c, f, layout_.corner(c, f, second), spreads, false);
      }
    }
    const double bar = (std::min)(layout_.height(), 160.0);
    paint_legend(canvas, {right + 10, first, 12, bar}, readings, small_letter, "");
    if (largest_deviation() > 0) {
      paint_legend(canvas, {right + 10, second, 12, bar}, spreads, small_letter, "");
    }
    paint_marks(canvas, second + layout_.height() + 42);
    return canvas.finished();
  }

 private:
  const FoamRow& row(std::size_t column) const { return rows_[shown_[column]]; }
  double reading(std::size_t column, const FingerPlace& place, int i, int j) const {
    const auto sample = static_cast<std::size_t>(row(column).sample);
    return recording_.table.readings[sample * recording_.table.taxels() + taxel(place, i, j)];
  }
  std::size_t taxel(const FingerPlace& place, int i, int j) const {
    return static_cast<std::size_t>(place.first_row + i) *
               static_cast<std::size_t>(recording_.table.cols) +
           static_cast<std::size_t>(place.first_col + j);
  }

  double largest_reading() const {
    double largest = 0;
    for (std::size_t c = 0; c < shown_.size(); ++c) {
      for (const FingerPlace& place : recording_.sensor.fingers) {
        for (int i = 0; i < place.rows; ++i) {
          for (int j = 0; j < place.cols; ++j) {
            const double now = reading(c, place, i, j);
            const bool counts = now < recording_.sensor.taxels.saturated_at;
            largest = counts ? (std::max)(largest, now) : largest;
          }
        }
      }
    }
    return largest;
  }

  double largest_deviation() const {
    float largest = 0;
    for (const auto& taxels : activity_.deviations) {
      largest = (std::max)(largest, *std::max_element(taxels.begin(), taxels.end()));
    }
    return static_cast<double>(largest);
  }

  void paint_caption(Canvas& canvas, std::size_t column, double y) const {
    const auto alarm = first_alarm(rows_);
    const bool is_alarm = alarm && shown_[column] == *alarm;
    const FoamRow& now = row(column);
    const double x = layout_.middle(column);
    const Ink& colour = is_alarm ? ink::accent : ink::black;
    canvas.text({x, y}, "frame " + std::to_string(now.frame), small_letter, colour, Align::center);
    if (!now.time_s.empty()) {
      canvas.text({x, y + 16}, format("%.3f s", std::stod(now.time_s)), small_letter, colour,
                  Align::center);
    }
    if (is_alarm) {
      canvas.text({x, y - 16}, "first alarm", small_letter, colour, Align::center, true);
    }
  }

  /// Paints the readings or the vibration of a finger.
  void paint_finger(Canvas& canvas,
                    std::size_t column,
                    std::size_t finger,
                    const Spot& corner,
                    const ColourScale& scale,
                    bool is_reading) const {
    const FingerPlace& place = recording_.sensor.fingers[finger];
    const double cell = layout_.cell();
    for (int i = 0; i < place.rows; ++i) {
      for (int j = 0; j < place.cols; ++j) {
        const Spot at = corner + Spot(cell * j, cell * i);
        const double value =
            is_reading ? reading(column, place, i, j)
                       : static_cast<double>(activity_.deviations[column][taxel(place, i, j)]);
        if (std::isfinite(value)) {
          const bool is_empty = !is_reading && !(value > 0);
          box(canvas, at, cell, is_empty ? empty_ink : ink_of(scale, value));
        } else {  // missing
          canvas.line(at, at + Spot(cell, cell), 0.6, ink::grey);
        }
      }
    }
    const Spot far = corner + Spot(cell * place.cols, cell * place.rows);
    canvas.curve({corner, {far.x, corner.y}, far, {corner.x, far.y}, corner}, 0.6, ink::grey);
    paint_features(canvas, row(column).fingers[finger], place, corner, is_reading);
    if (recording_.fingers() > 1 && is_reading) {
      canvas.text({(corner.x + far.x) / 2, far.y + 16}, std::to_string(finger), small_letter,
                  ink::grey, Align::center);
    }
  }

  void paint_features(Canvas& canvas,
                      const fingerpad::FingerSample<double>& sample,
                      const FingerPlace& place,
                      const Spot& corner,
                      bool is_reading) const {
    const double cell = layout_.cell();
    if (is_reading && sample.is_pressed()) {
      const double pitch_mm = recording_.sensor.taxels.pitch_mm;
      paint_cross(canvas, corner + Spot(cell * (sample.center_x_mm / pitch_mm + 0.5),
                                        cell * (sample.center_y_mm / pitch_mm + 0.5)));
    }
    if (sample.location != sample.no_location) {
      const auto col = static_cast<double>(sample.location % place.cols);
      const auto along = static_cast<double>(sample.location / place.cols);
      canvas.circle(corner + Spot(cell * (col + 0.5), cell * (along + 0.5)), ring(), 1.4,
                    is_reading ? ink::accent : ink::black);
    }
  }

  double ring() const { return (std::max)(0.62 * layout_.cell(), 4.5); }

  static void box(Canvas& canvas, const Spot& at, double size, const Ink& colour) {
    canvas.polygon({at, at + Spot(size, 0), at + Spot(size, size), at + Spot(0, size)}, colour);
  }

  static void paint_cross(Canvas& canvas, const Spot& at) {
    for (const bool is_border : {true, false}) {
      const double reach = is_border ? 5 : 4;
      const double width = is_border ? 3 : 1.2;
      const Ink& colour = is_border ? ink::black : ink::white;
      canvas.line(at - Spot(reach, 0), at + Spot(reach, 0), width, colour);
      canvas.line(at - Spot(0, reach), at + Spot(0, reach), width, colour);
    }
  }

  void paint_marks(Canvas& canvas, double y) const {
    paint_cross(canvas, {left + 6, y - letter / 2});
    canvas.text({left + 20, y}, "centroid of force", letter, ink::black);
    canvas.circle({left + 170, y - letter / 2}, 5, 1.4, ink::accent);
    canvas.circle({left + 186, y - letter / 2}, 5, 1.4, ink::black);
    canvas.text({left + 200, y}, "strongest vibration of the finger", letter, ink::black);
  }

  const FoamRecording& recording_;
  const std::vector<FoamRow>& rows_;
  const std::vector<std::size_t>& shown_;
  const FoamActivity& activity_;
  Layout layout_;
};

}  // namespace

std::vector<std::size_t> shown_rows(const std::vector<FoamRow>& rows, int window) {
  const std::size_t count = (std::min)(columns, rows.size());
  const auto alarm = first_alarm(rows);
  const auto step = static_cast<std::size_t>((std::max)(window / 2, 1));
  std::vector<std::size_t> shown;
  for (std::size_t k = 0; k < columns && alarm; ++k) {
    const std::size_t at = *alarm + k * step;
    if (at >= 3 * step && at - 3 * step < rows.size()) {
      shown.push_back(at - 3 * step);
    }
  }
  for (std::size_t k = 0; k < count && !alarm; ++k) {
    shown.push_back(count == 1 ? 0 : k * (rows.size() - 1) / (count - 1));
  }
  return shown;
}

cv::Mat foam_array_picture(const std::string& title,
                           const FoamRecording& recording,
                           const std::vector<FoamRow>& rows,
                           const std::vector<std::size_t>& shown,
                           const FoamActivity& activity) {
  return Strip(recording, rows, shown, activity).paint(title);
}

}  // namespace replay
