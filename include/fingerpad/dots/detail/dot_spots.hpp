// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finds spots of about the size of a printed dot in a frame, dark or bright. The criterion is by
// which share a spot is darker than the background around it, so neither depth nor uneven
// illumination matters. Bright spots are found in the negative. Spots are detected in a reduced
// frame, whose pixels are still finer than a dot; their centers come from the full frame.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "fingerpad/dots/detail/dot_patch.hpp"
#include "fingerpad/dots/detail/dot_table.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// Appearance of spots.
struct SpotLook {
  double radius_px = 0;
  double pitch_px = 0;                              ///< between neighbours
  bool bright = false;                              ///< brighter than the background
  double min_contrast = 0.08;                       ///< share of the light around
  std::array<double, 3> color_weights = {1, 1, 1};  ///< of blue, green and red
};

struct TypicalSpot {
  double radius_px = 0;  ///< of a disc with the area that is more than half as dark as the middle
  double contrast = 0;   ///< of the middle: 0 as light as the background, 1 black
};

/// Whether a frame has a supported type: 8 or 16 bit, one, three or four channels.
inline bool is_picture(const cv::Mat& frame) {
  const int channels = frame.channels();
  return !frame.empty() && (frame.depth() == CV_8U || frame.depth() == CV_16U) &&
         (channels == 1 || channels == 3 || channels == 4);
}

/// Intermediate images. They are kept for the next frame, because allocating them costs as much
/// time as filling them. A copy is empty, because copies of a cv::Mat share their data.
class SpotWorkspace {
 public:
  SpotWorkspace() = default;
  SpotWorkspace(const SpotWorkspace&) {}
  SpotWorkspace& operator=(const SpotWorkspace&) { return *this; }

 private:
  friend class SpotFinder;
  // Size of the reduced frame, except eight_bit (full size):
  cv::Mat eight_bit, small;
  std::array<cv::Mat, 4> planes;
  cv::Mat_<float> light, part, around;
  cv::Mat_<std::uint8_t> dull, shown;  // 255: not a reflection; 255: light counts
  cv::Mat_<float> half;                // half that size
  cv::Mat_<float> ground;              // light of the background, coarse cells
  double brightest = 0;                // more light is a reflection
};

class SpotFinder {
 public:
  /// `where`: nonzero where spots may be; empty: anywhere.
  SpotFinder(cv::Size size, const SpotLook& look, const cv::Mat_<std::uint8_t>& where = {})
      : look_(look),
        where_(where),
        fine_((std::max)(1, static_cast<int>(look.radius_px / 1.5))),
        coarse_((std::max)(1, static_cast<int>(look.pitch_px / fine_ / 4))),
        pad_(size / fine_ / coarse_, 1.0F),
        around_(two_boxes(0.75 * look.pitch_px / (fine_ * coarse_))) {
    if (!where.empty()) {
      // Leave out cells at the border: they contain part of the ring around the pad.
      cv::Mat inside = where > 0;
      cv::erode(inside, inside, cv::Mat(), {-1, -1}, 1, cv::BORDER_CONSTANT, 0);
      where_ = inside;
      shrunk(inside, coarse_ * fine_).convertTo(pad_, CV_32F, 1.0 / 255);
      pad_.setTo(0, pad_ < 0.99);
      inside_ = shrunk(inside, fine_) == 255;
    }
  }

  /// Centers of the spots of a frame of the given size, in any order; none if there are more than
  /// `max_spots`, which are image noise.
  std::vector<Place> find(const cv::Mat& frame,
                          SpotWorkspace& seen,
                          std::size_t max_spots = 4000) const {
    look_at(frame, seen);
    const std::vector<Place> rough = peaks(seen);
    std::vector<Place> found;
    if (rough.size() > max_spots) {
      return found;
    }
    const SpotMap map(rough);
    const double reach_px = (std::max)(1.4 * look_.radius_px, look_.radius_px + 1.5);
    const double ring_px = (std::max)(1.9 * look_.radius_px, look_.radius_px + 2);
    DotPatch patch;
    for (int k = 0; k < map.size(); ++k) {
      const auto next = map.nearest(map[k], 2 * reach_px, k);
      const double reach =
          next.spot >= 0 ? (std::min)(reach_px, 0.55 * next.distance_px) : reach_px;
      read(frame, seen, map[k], ring_px + fine_ + 1, patch);
      const Place center = patch.center_of_gravity(map[k], reach);
      if (is_whole(center, frame.size()) && looks_like_a_dot(patch, center)) {
        found.push_back(center);
      }
    }
    return found;
  }

  /// Median radius and contrast of some spots; 0 without spots.
  TypicalSpot typical(const cv::Mat& frame, const std::vector<Place>& spots) const {
    if (spots.empty()) {
      return {};
    }
    SpotWorkspace seen;
    look_at(frame, seen);
    std::vector<double> radii, contrasts;
    DotPatch patch;
    for (const Place& spot : spots) {
      read(frame, seen, spot, look_.pitch_px / 2, patch);
      const double middle = patch.mean_within(spot, 0, (std::max)(look_.radius_px / 2, 1.0));
      int count = 0;
      patch.for_each(spot, look_.pitch_px / 2,
                     [&](double, double, double dark) { count += dark > middle / 2 ? 1 : 0; });
      radii.push_back(std::sqrt(count / CV_PI));
      contrasts.push_back(middle);
    }
    return {median(radii), median(contrasts)};
  }

 private:
  static constexpr double min_light = 2;  // grey levels; darker areas are ignored
  static constexpr double glare = 2;      // more light than this times the median is a reflection

  /// Weights along a line of two successive box means over about `width` cells.
  static cv::Mat_<float> two_boxes(double width) {
    const int half = (std::max)(static_cast<int>(std::lround(0.5 * (width - 1))), 1);
    const int side = 2 * half + 1;
    cv::Mat_<float> weights(1, 2 * side - 1);
    for (int k = 0; k < weights.cols; ++k) {
      weights(k) =
          static_cast<float>(side - std::abs(k - 2 * half)) / static_cast<float>(side * side);
    }
    return weights;
  }

  /// Mean over squares of `factor` pixels. Incomplete squares at the right and bottom are dropped.
  static void shrink(const cv::Mat& image, int factor, cv::Mat& small) {
    const cv::Size size = image.size() / factor;
    cv::resize(image({0, 0, size.width * factor, size.height * factor}), small, size, 0, 0,
               cv::INTER_AREA);
  }
  /// The same in steps of two where possible, for which OpenCV takes a third of the time.
  static cv::Mat shrunk(const cv::Mat& image, int factor) {
    cv::Mat small = image({0, 0, image.cols / factor * factor, image.rows / factor * factor});
    for (int step = 2; factor > 1; factor /= step) {
      step = factor % 2 == 0 ? 2 : factor;
      cv::Mat smaller;
      shrink(small, step, smaller);
      small = smaller;
    }
    return small;
  }

  double unit_of(const cv::Mat& frame) const {
    const auto& w = look_.color_weights;
    const double sum = frame.channels() == 1 ? 1 : w[0] + w[1] + w[2];
    return (frame.depth() == CV_16U ? 1.0 / 256 : 1.0) / sum;
  }

  /// Light in grey levels, inverted for bright spots.
  void light_of(const cv::Mat& frame, SpotWorkspace& seen) const {
    const double unit = unit_of(frame) * (look_.bright ? -1 : 1);
    const double offset = look_.bright ? 256 : 0;
    if (frame.channels() == 1) {
      frame.convertTo(seen.light, CV_32F, unit, offset);
      return;
    }
    cv::split(frame, seen.planes.data());
    seen.planes[0].convertTo(seen.light, CV_32F, unit * look_.color_weights[0], offset);
    for (const std::size_t c : {1U, 2U}) {
      seen.planes[c].convertTo(seen.part, CV_32F, unit * look_.color_weights[c]);
      cv::add(seen.light, seen.part, seen.light);
    }
  }

  void look_at(const cv::Mat& frame, SpotWorkspace& seen) const {
    const cv::Mat* all = &frame;
    if (fine_ > 1 && frame.depth() == CV_16U) {
      // detection needs only 8 bit; centers use all 16
      frame.convertTo(seen.eight_bit, CV_8U, 1.0 / 256);
      all = &seen.eight_bit;
    }
    if (fine_ > 1) {
      shrink(*all, fine_, seen.small);
      all = &seen.small;
    }
    light_of(*all, seen);
    const cv::Mat_<float> light = shrunk(seen.light, coarse_);
    seen.brightest = glare * median_light(light);
    cv::compare(seen.light, seen.brightest, seen.dull, cv::CMP_LE);
    find_ground(seen, light);
  }

  double median_light(const cv::Mat_<float>& light) const {
    const int step = 1 + light.rows / 50;  // some thousand cells suffice
    std::vector<double> inside;
    for (int i = 0; i < light.rows; i += step) {
      for (int j = 0; j < light.cols; j += step) {
        if (pad_(i, j) > 0) {
          inside.push_back(static_cast<double>(light(i, j)));
        }
      }
    }
    return inside.empty() ? 0.0 : median(inside);
  }

  /// Light of the background: the mean around each cell without everything darker than its
  /// surroundings. Dark parts are excluded first by cell of `light`, then by pixel.
  void find_ground(SpotWorkspace& seen, const cv::Mat_<float>& light) const {
    const double lit = 1 - look_.min_contrast;
    cv::Mat weight = pad_.clone();
    cv::Mat_<float> ground;
    for (int round = 0; round < 2; ++round) {
      weight.setTo(0, light > seen.brightest);
      ground = mean_around(light.mul(weight), weight);
      weight.setTo(0, light < ground * lit);
    }
    cv::resize(ground * lit, seen.around, seen.light.size(), 0, 0, cv::INTER_LINEAR);
    cv::compare(seen.light, seen.around, seen.shown, cv::CMP_GT);
    cv::bitwise_and(seen.shown, seen.dull, seen.shown);
    seen.shown.convertTo(seen.part, CV_32F, 1.0 / 255);
    weight = shrunk(seen.part, coarse_).mul(pad_);
    cv::multiply(seen.light, seen.part, seen.part);
    constexpr double no_light = 1e-3;  // avoids a division by 0 where nothing is known
    cv::max(mean_around(shrunk(seen.part, coarse_).mul(pad_), weight), no_light, seen.ground);
  }

  /// Weighted mean around each cell, from weighted values and weights; 0 where there is no weight.
  cv::Mat_<float> mean_around(const cv::Mat& sum, const cv::Mat& weight) const {
    const auto blur_over = [&](const cv::Mat& from, cv::Mat& to) {
      cv::sepFilter2D(from, to, CV_32F, around_, around_, {-1, -1}, 0, cv::BORDER_CONSTANT);
    };
    cv::Mat sums, weights;
    blur_over(sum, sums);
    blur_over(weight, weights);
    cv::Mat_<float> mean;
    cv::divide(sums, cv::max(weights, 1e-6), mean);
    return mean;
  }

  /// Gaussian blur, cut off at no less than 2.5 standard deviations.
  static void blur(cv::Mat& image, double sigma) {
    const int side = 2 * static_cast<int>(std::ceil(2.5 * sigma)) + 1;
    cv::GaussianBlur(image, image, {side, side}, sigma);
  }

  /// Local maxima of the difference of two blurs. It responds to spots of about the dots' size and
  /// not to a gradient.
  std::vector<Place> peaks(SpotWorkspace& seen) const {
    cv::Mat_<float>& dark = seen.light;  // the light is not needed afterwards
    cv::resize(seen.ground, seen.around, dark.size(), 0, 0, cv::INTER_LINEAR);
    cv::compare(seen.around, min_light, seen.shown, cv::CMP_GT);
    cv::bitwise_and(seen.shown, seen.dull, seen.shown);
    if (!inside_.empty()) {
      cv::bitwise_and(seen.shown, inside_, seen.shown);
    }
    cv::divide(dark, seen.around, dark, -1);
    cv::add(dark, 1, dark);
    seen.shown.convertTo(seen.part, CV_32F, 1.0 / 255);
    cv::multiply(dark, seen.part, dark);
    const double radius = look_.radius_px / fine_;
    blur(dark, 0.5 * radius);
    // The wider blur loses nothing at half the resolution.
    cv::resize(dark, seen.half, dark.size() / 2, 0, 0, cv::INTER_LINEAR);
    blur(seen.half, 0.5 * std::sqrt(1.2 * 1.2 - 0.5 * 0.5) * radius);
    cv::resize(seen.half, seen.around, dark.size(), 0, 0, cv::INTER_LINEAR);
    cv::Mat_<float>& response = dark;
    cv::subtract(dark, seen.around, response);
    const int reach = (std::max)(static_cast<int>(std::lround(0.8 * radius)), 1);
    const auto least = static_cast<float>(0.25 * look_.min_contrast);
    cv::dilate(response, seen.around, cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8U));
    std::vector<Place> found;
    const double near_px = fine_ * (reach + 0.5);
    const auto is_beside = [&](const Place& other, const Place& peak) {
      return std::abs(other.x - peak.x) < near_px && std::abs(other.y - peak.y) < near_px;
    };
    for (int i = 0; i < response.rows; ++i) {
      const float* here = response[i];
      for (int j = 0; j < response.cols; ++j) {
        if (here[j] > least && here[j] == seen.around(i, j)) {  // none within reach is higher
          // Neighbouring peak pixels of equal height are one spot.
          const Place peak{fine_ * (j + 0.5) - 0.5, fine_ * (i + 0.5) - 0.5};
          const auto above = std::find_if(found.rbegin(), found.rend(), [&](const Place& other) {
            return other.y <= peak.y - near_px || is_beside(other, peak);
          });
          if (above == found.rend() || !is_beside(*above, peak)) {
            found.push_back(peak);
          }
        }
      }
    }
    return found;
  }

  void read(const cv::Mat& frame,
            const SpotWorkspace& seen,
            const Place& place,
            double half_px,
            DotPatch& patch) const {
    patch.move_to(place, half_px, frame.size());
    frame.depth() == CV_16U ? read_as<std::uint16_t>(frame, seen, place, patch)
                            : read_as<std::uint8_t>(frame, seen, place, patch);
  }

  template <class Pixel>
  void read_as(const cv::Mat& frame,
               const SpotWorkspace& seen,
               const Place& place,
               DotPatch& patch) const {
    const int channels = frame.channels();
    const auto unit = static_cast<float>(unit_of(frame) * (look_.bright ? -1 : 1));
    const float offset = look_.bright ? 256.0F : 0.0F;
    std::array<float, 3> weight = {unit, 0, 0};
    for (std::size_t c = 0; c < 3 && channels > 1; ++c) {
      weight[c] = unit * static_cast<float>(look_.color_weights[c]);
    }
    const int second = channels > 1 ? 1 : 0;
    const int third = channels > 1 ? 2 : 0;
    const cv::Rect& box = patch.box();
    const bool masked = !where_.empty();
    const Plane ground = ground_at(seen, place);
    const auto brightest = static_cast<float>(seen.brightest);
    constexpr auto darkest = static_cast<float>(min_light);
    for (int i = box.y; i < box.y + box.height; ++i) {
      const Pixel* pixel = frame.ptr<Pixel>(i) + box.x * channels;
      const std::uint8_t* inside = masked ? where_[i] + box.x : nullptr;
      float* dark = patch.row(i);
      const float first = ground.at(static_cast<float>(box.x), static_cast<float>(i));
      for (int j = 0; j < box.width; ++j, pixel += channels) {
        const float light = offset + weight[0] * static_cast<float>(pixel[0]) +
                            weight[1] * static_cast<float>(pixel[second]) +
                            weight[2] * static_cast<float>(pixel[third]);
        const float around = first + ground.right * static_cast<float>(j);
        const bool counts = light <= brightest && around > darkest && (!masked || inside[j] != 0);
        dark[j] = counts ? 1 - light / around : 0.0F;
      }
    }
  }

  /// Linear approximation of the background's light around a place.
  struct Plane {
    float value = 0, right = 0, down = 0;
    float x = 0, y = 0;
    float at(float to_x, float to_y) const {
      return value + right * (to_x - x) + down * (to_y - y);
    }
  };

  Plane ground_at(const SpotWorkspace& seen, const Place& place) const {
    const int cell = fine_ * coarse_;
    const auto within = [](double index, int count) {
      return (std::min)((std::max)(index, 0.0), count - 1.0);
    };
    const double x = within((place.x + 0.5) / cell - 0.5, seen.ground.cols);
    const double y = within((place.y + 0.5) / cell - 0.5, seen.ground.rows);
    const int left = static_cast<int>(within(std::floor(x), seen.ground.cols - 1));
    const int top = static_cast<int>(within(std::floor(y), seen.ground.rows - 1));
    const int right = (std::min)(left + 1, seen.ground.cols - 1);
    const int bottom = (std::min)(top + 1, seen.ground.rows - 1);
    const auto u = static_cast<float>(x - left);
    const auto v = static_cast<float>(y - top);
    const cv::Mat_<float>& g = seen.ground;
    const float above = g(top, left) + u * (g(top, right) - g(top, left));
    const float below = g(bottom, left) + u * (g(bottom, right) - g(bottom, left));
    const float across =
        (1 - v) * (g(top, right) - g(top, left)) + v * (g(bottom, right) - g(bottom, left));
    return {above + v * (below - above), across / static_cast<float>(cell),
            (below - above) / static_cast<float>(cell), static_cast<float>(place.x),
            static_cast<float>(place.y)};
  }

  /// Whether the whole spot lies within the frame.
  bool is_whole(const Place& center, cv::Size size) const {
    const double r = look_.radius_px;
    return center.x >= r && center.x <= size.width - 1 - r && center.y >= r &&
           center.y <= size.height - 1 - r;
  }

  /// Whether a spot is dark inside and bright all around, unlike the border of a shadow.
  bool looks_like_a_dot(const DotPatch& patch, const Place& center) const {
    const double r = look_.radius_px;
    const double core = patch.mean_within(center, 0, r / 2);
    const double ring =
        patch.mean_within(center, (std::max)(1.4 * r, r + 1), (std::max)(1.9 * r, r + 2));
    return core >= look_.min_contrast && ring <= 0.5 * core;
  }

  SpotLook look_;
  cv::Mat_<std::uint8_t> where_;   ///< 255 where spots may be; empty: anywhere
  int fine_;                       ///< frame pixels per side of a pixel of the reduced frame
  int coarse_;                     ///< reduced pixels per side of a background cell
  cv::Mat_<float> pad_;            ///< coarse: 1 where spots may be
  cv::Mat_<float> around_;         ///< coarse: blur weights along rows and columns
  cv::Mat_<std::uint8_t> inside_;  ///< fine: 255 where spots may be; empty: anywhere
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
