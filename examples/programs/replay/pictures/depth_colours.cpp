// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/depth_colours.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace replay {
namespace {

/// A map resampled to the pixels of the canvas.
struct Enlarged {
  cv::Mat_<float> value;
  cv::Mat_<float> relief;  ///< blurred value, whose slopes show shapes instead of noise
  cv::Mat_<float> opacity;
};

float clamped(float x) {
  return (std::min)((std::max)(x, 0.0F), 1.0F);
}

/// Reduces a map that is shown smaller than its own size.
template <class T>
cv::Mat_<T> shrunk(const cv::Mat_<T>& map, cv::Size size) {
  if (size.width >= map.cols || size.height >= map.rows) {
    return map;
  }
  cv::Mat_<T> small;
  cv::resize(map, small, size, 0, 0, cv::INTER_NEAREST_EXACT);
  return small;
}

/// `per_px`: pixels of the canvas per pixel of the camera. `values` has at most the camera's
/// pixels.
Enlarged enlarged(const cv::Mat_<float>& values,
                  const cv::Mat_<uchar>& in_pad,
                  cv::Size size,
                  double per_px) {
  cv::Mat_<float> filled(values.size());
  cv::Mat_<float> known(values.size());
  cv::Mat_<float> missing(values.size());
  cv::Mat_<float> pad(values.size());
  for (int i = 0; i < values.rows; ++i) {
    for (int j = 0; j < values.cols; ++j) {
      const bool good = std::isfinite(values(i, j));
      filled(i, j) = good ? values(i, j) : 0.0F;
      known(i, j) = good ? 1.0F : 0.0F;
      pad(i, j) = in_pad(i, j) != 0 ? 1.0F : 0.0F;
      missing(i, j) = !good && in_pad(i, j) != 0 ? 1.0F : 0.0F;
    }
  }
  // Pixels without a value take the mean of nearby ones, so that edges enlarge smoothly.
  const double cells_per_px = (std::min)(per_px, 1.0);
  const int near = 1 + 2 * static_cast<int>(std::lround(4 * cells_per_px));
  cv::Mat_<float> sum;
  cv::Mat_<float> count;
  cv::blur(filled, sum, {near, near});
  cv::blur(known, count, {near, near});
  for (int i = 0; i < values.rows; ++i) {
    for (int j = 0; j < values.cols; ++j) {
      if (known(i, j) == 0.0F && count(i, j) > 1e-3F) {
        filled(i, j) = sum(i, j) / count(i, j);
      }
    }
  }
  Enlarged large;
  cv::resize(filled, large.value, size, 0, 0, cv::INTER_LINEAR);
  cv::GaussianBlur(filled, filled, {0, 0}, 5 * cells_per_px);
  cv::resize(filled, large.relief, size, 0, 0, cv::INTER_LINEAR);
  // The pad's edge is drawn smooth, as it is in reality; single missing pixels stay visible.
  cv::GaussianBlur(pad, pad, {0, 0}, 2 * cells_per_px);
  cv::resize(pad, large.opacity, size, 0, 0, cv::INTER_CUBIC);
  cv::Mat_<float> holes;
  cv::resize(missing, holes, size, 0, 0, cv::INTER_LINEAR);
  for (int i = 0; i < size.height; ++i) {
    for (int j = 0; j < size.width; ++j) {
      const float edge = clamped((large.opacity(i, j) - 0.5F) * 12 + 0.5F);
      large.opacity(i, j) = edge * clamped(1.5F - 2 * holes(i, j));
    }
  }
  return large;
}

/// Central differences over one pixel of the finished picture to either side, per pixel of the
/// canvas, which is `scale` times as large.
struct Slope {
  float x;
  float y;
};
Slope slope_at(const cv::Mat_<float>& field, int i, int j, int scale) {
  const int up = (std::max)(i - scale, 0);
  const int down = (std::min)(i + scale, field.rows - 1);
  const int left = (std::max)(j - scale, 0);
  const int right = (std::min)(j + scale, field.cols - 1);
  return {(field(i, right) - field(i, left)) / static_cast<float>(right - left),
          (field(down, j) - field(up, j)) / static_cast<float>(down - up)};
}

/// Coverage of a pixel by a contour line, in [0, 1]. Value 0, the rim, has no line.
float line_cover(const cv::Mat_<float>& field, int i, int j, float every, int scale) {
  const float value = field(i, j);
  const Slope slope = slope_at(field, i, j, scale);
  const float number = std::round(value / every);
  const float steepness = (std::max)(std::hypot(slope.x, slope.y), 1e-6F);
  const float distance = std::abs(value - number * every) / steepness;
  const float half_width = 0.45F * static_cast<float>(scale);
  return number > 0 ? clamped(half_width - distance + 0.5F) : 0.0F;
}

cv::Mat_<cv::Vec3b> blended(const cv::Vec3d& from, const cv::Vec3d& middle, const cv::Vec3d& to) {
  cv::Mat_<cv::Vec3b> table(1, 256);
  for (int i = 0; i < 256; ++i) {
    const double along = i / 127.5 - 1;
    const cv::Vec3d colour = middle + ((along < 0 ? from : to) - middle) * std::abs(along);
    for (int c = 0; c < 3; ++c) {
      table(0, i)[c] = cv::saturate_cast<uchar>(colour[c]);
    }
  }
  return table;
}

}  // namespace

ColourScale depth_scale(double top_mm) {
  cv::Mat_<uchar> steps(1, 256);
  for (int i = 0; i < 256; ++i) {
    steps(0, i) = static_cast<uchar>(i);
  }
  cv::Mat table;
  cv::applyColorMap(steps, table, cv::COLORMAP_VIRIDIS);
  return {0, top_mm, 2, table};
}

ColourScale change_scale(double reach_mm) {
  return {-reach_mm, reach_mm, reach_mm / 2,
          blended({168, 92, 24}, {240, 240, 240}, {36, 20, 176})};
}

cv::Mat colour_column(const ColourScale& scale, cv::Size size) {
  cv::Mat_<cv::Vec3b> column(size);
  for (int i = 0; i < size.height; ++i) {
    column.row(i).setTo(scale.colours(0, 255 - (255 * i) / (std::max)(size.height - 1, 1)));
  }
  return column;
}

void paint_map(Canvas& canvas,
               const cv::Rect2d& rectangle,
               const cv::Mat_<float>& values_mm,
               const cv::Mat_<uchar>& in_pad,
               const ColourScale& scale,
               double line_every_mm) {
  const cv::Size size = canvas.area(rectangle).size();
  const double per_px = static_cast<double>(size.width) / values_mm.cols;
  const Enlarged map = enlarged(shrunk(values_mm, size), shrunk(in_pad, size), size, per_px);
  const auto bottom = static_cast<float>(scale.bottom_mm);
  const auto range = static_cast<float>(scale.top_mm - scale.bottom_mm);
  const auto every = static_cast<float>(line_every_mm);
  const auto slopes = static_cast<float>(12 * per_px);
  cv::Mat_<cv::Vec3b> picture(size, cv::Vec3b(255, 255, 255));
  cv::Mat_<uchar> mask(size, uchar{0});
  for (int i = 0; i < size.height; ++i) {
    for (int j = 0; j < size.width; ++j) {
      if (map.opacity(i, j) <= 0) {
        continue;
      }
      const float share = clamped((map.value(i, j) - bottom) / range);
      const cv::Vec3b colour = scale.colours(0, static_cast<int>(std::lround(share * 255)));
      const Slope tilt = slope_at(map.relief, i, j, canvas.scale());
      const float steep = slopes * (tilt.x + tilt.y);  // lit from top left
      const float shade = 1 + 0.15F * steep / std::sqrt(1 + steep * steep);
      const float line =
          every > 0 ? 0.45F * line_cover(map.value, i, j, every, canvas.scale()) : 0.0F;
      for (int c = 0; c < 3; ++c) {
        const float lit = (std::min)(static_cast<float>(colour[c]) * shade, 255.0F);
        picture(i, j)[c] = static_cast<uchar>(lit + (255 - lit) * line);
      }
      mask(i, j) = static_cast<uchar>(std::lround(map.opacity(i, j) * 255));
    }
  }
  canvas.blend(rectangle, picture, mask);
}

void paint_legend(Canvas& canvas,
                  const cv::Rect2d& bar,
                  const ColourScale& scale,
                  double text_height,
                  const char* unit) {
  cv::Mat paper = canvas.area(bar);
  colour_column(scale, paper.size()).copyTo(paper);
  const double right = bar.x + bar.width;
  canvas.curve({bar.tl(), {right, bar.y}, bar.br(), {bar.x, bar.y + bar.height}, bar.tl()}, 0.8,
               ink::grey);
  const double range = scale.top_mm - scale.bottom_mm;
  const int ticks = static_cast<int>(std::lround(range / scale.tick_mm));
  for (int k = 0; k <= ticks; ++k) {
    const double mm = scale.bottom_mm + k * range / ticks;
    const double y = bar.y + bar.height * (1 - static_cast<double>(k) / ticks);
    char label[16];
    std::snprintf(label, sizeof label, "%g", mm);
    canvas.line({right, y}, {right + 4, y}, 0.8, ink::grey);
    canvas.text({right + 8, y + text_height / 2}, label, text_height, ink::black);
  }
  canvas.text({bar.x, bar.y - 1.6 * text_height}, unit, text_height, ink::black);
}

}  // namespace replay
