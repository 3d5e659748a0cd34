// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Spots of about the size of a printed dot in a frame, dark or bright. What counts is by which
// share a spot is darker than the ground around it, so neither the depth nor the fall of the light
// matters; bright spots are looked for in the negative. Spots are looked for in a frame that is
// made smaller, where its pixels are still finer than a dot; their centers come from the frame's
// own pixels.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "fingerpad/adapt/detail/dot_patch.hpp"
#include "fingerpad/adapt/detail/dot_table.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// How spots look.
struct SpotLook {
  double radius_px = 0;
  double pitch_px = 0;                              ///< between neighbours
  bool bright = false;                              ///< brighter than what is around them
  double min_contrast = 0.08;                       ///< share of the light around
  std::array<double, 3> color_weights = {1, 1, 1};  ///< of blue, green and red
};

struct TypicalSpot {
  double radius_px = 0;  ///< of a disc as large as what is at least half as dark as the middle
  double contrast = 0;   ///< of the middle: 0 as light as the ground, 1 black
};

/// Whether a frame can be looked at: 8 or 16 bit, one, three or four channels.
inline bool is_picture(const cv::Mat& frame) {
  const int channels = frame.channels();
  return !frame.empty() && (frame.depth() == CV_8U || frame.depth() == CV_16U) &&
         (channels == 1 || channels == 3 || channels == 4);
}

class SpotFinder {
 public:
  /// `where`: nonzero where spots may be; empty: anywhere.
  SpotFinder(cv::Size size, const SpotLook& look, const cv::Mat_<std::uint8_t>& where = {})
      : look_(look),
        where_(where),
        fine_((std::max)(1, static_cast<int>(look.radius_px / 1.5))),
        coarse_((std::max)(1, static_cast<int>(look.pitch_px / fine_ / 4))),
        pad_(size / fine_ / coarse_, 1.0F) {
    if (!where.empty()) {
      // Cells of the border hold a part of the ring around the pad.
      cv::Mat inside = where > 0;
      cv::erode(inside, inside, cv::Mat(), {-1, -1}, 1, cv::BORDER_CONSTANT, 0);
      where_ = inside;
      shrunk(inside, coarse_ * fine_).convertTo(pad_, CV_32F, 1.0 / 255);
      pad_.setTo(0, pad_ < 0.99);
      outside_ = shrunk(inside, fine_) < 255;
    }
  }

  /// Centers of the spots of a frame of the size given, in any order; none where there are more
  /// than `max_spots`, which is the grain of the picture.
  std::vector<Place> find(const cv::Mat& frame, std::size_t max_spots = 4000) const {
    Frame seen = look_at(frame);
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
      read(seen, map[k], ring_px + fine_ + 1, patch);
      const Place center = patch.center_of_gravity(map[k], reach);
      if (is_whole(center, seen.frame.size()) && looks_like_a_dot(patch, center)) {
        found.push_back(center);
      }
    }
    return found;
  }

  /// The medians of some spots; all 0 where there are none.
  TypicalSpot typical(const cv::Mat& frame, const std::vector<Place>& spots) const {
    if (spots.empty()) {
      return {};
    }
    const Frame seen = look_at(frame);
    std::vector<double> radii, contrasts;
    DotPatch patch;
    for (const Place& spot : spots) {
      read(seen, spot, look_.pitch_px / 2, patch);
      const double middle = patch.mean_within(spot, 0, (std::max)(look_.radius_px / 2, 1.0));
      int count = 0;
      patch.for_each(spot, look_.pitch_px / 2,
                     [&](double, double, double dark) { count += dark > middle / 2 ? 1 : 0; });
      radii.push_back(std::sqrt(count / CV_PI));
      contrasts.push_back(middle);
    }
    return {median_of(radii.begin(), radii.end()), median_of(contrasts.begin(), contrasts.end())};
  }

 private:
  static constexpr double min_light = 2;  // grey levels; darker places show nothing
  static constexpr double glare = 2;      // light above this many times the median is a reflection

  /// A frame and what is known of its light.
  struct Frame {
    const cv::Mat& frame;
    cv::Mat_<float> light;   ///< made smaller by fine_
    cv::Mat_<float> ground;  ///< light around, made smaller by fine_ and coarse_
    double brightest;        ///< light above is a reflection
  };

  /// Mean over squares of `factor` pixels; what is left over at the right and below is dropped.
  static cv::Mat shrunk(const cv::Mat& image, int factor) {
    const cv::Size size = image.size() / factor;
    cv::Mat small = image;
    if (factor > 1) {
      cv::resize(image({0, 0, size.width * factor, size.height * factor}), small, size, 0, 0,
                 cv::INTER_AREA);
    }
    return small;
  }

  double unit_of(const cv::Mat& frame) const {
    const auto& w = look_.color_weights;
    const double sum = frame.channels() == 1 ? 1 : w[0] + w[1] + w[2];
    return (frame.depth() == CV_16U ? 1.0 / 256 : 1.0) / sum;
  }

  /// Light in grey levels, bright spots made dark.
  cv::Mat_<float> light_of(const cv::Mat& frame) const {
    const double unit = unit_of(frame) * (look_.bright ? -1 : 1);
    const double offset = look_.bright ? 256 : 0;
    cv::Mat_<float> light;
    if (frame.channels() == 1) {
      frame.convertTo(light, CV_32F, unit, offset);
      return light;
    }
    cv::Mat plane;
    for (int c = 0; c < 3; ++c) {
      const double weight = unit * look_.color_weights[static_cast<std::size_t>(c)];
      if (light.empty() || weight < 0 || weight > 0) {
        cv::extractChannel(frame, plane, c);
        light.empty() ? plane.convertTo(light, CV_32F, weight, offset)
                      : cv::addWeighted(plane, weight, light, 1, 0, light, CV_32F);
      }
    }
    return light;
  }

  Frame look_at(const cv::Mat& frame) const {
    cv::Mat small = frame;
    if (fine_ > 1 && frame.depth() == CV_16U) {
      frame.convertTo(small, CV_8U, 1.0 / 256);  // spots show in 8 bit; centers take all 16
    }
    Frame seen{frame, light_of(shrunk(small, fine_)), {}, 0};
    const cv::Mat_<float> light = shrunk(seen.light, coarse_);
    seen.brightest = glare * median_light(light);
    seen.ground = ground_of(seen, light);
    return seen;
  }

  double median_light(const cv::Mat_<float>& light) const {
    std::vector<float> inside;
    inside.reserve(light.total());
    for (int i = 0; i < light.rows; ++i) {
      for (int j = 0; j < light.cols; ++j) {
        if (pad_(i, j) > 0) {
          inside.push_back(light(i, j));
        }
      }
    }
    return inside.empty() ? 0.0 : median_of(inside.begin(), inside.end());
  }

  /// The ground's light: the mean of what is left around when what is darker than its surroundings
  /// is taken away, first cell by cell of `light`, then pixel by pixel.
  cv::Mat_<float> ground_of(const Frame& seen, const cv::Mat_<float>& light) const {
    const double lit = 1 - look_.min_contrast;
    cv::Mat weight = pad_.clone();
    cv::Mat_<float> ground;
    for (int round = 0; round < 2; ++round) {
      weight.setTo(0, light > seen.brightest);
      ground = mean_around(light.mul(weight), weight);
      weight.setTo(0, light < ground * lit);
    }
    cv::Mat around, kept, dark;
    cv::resize(ground, around, seen.light.size(), 0, 0, cv::INTER_LINEAR);
    cv::compare(seen.light, around * lit, dark, cv::CMP_LE);
    cv::bitwise_or(dark, seen.light > seen.brightest, dark);
    seen.light.copyTo(kept);
    kept.setTo(0, dark);
    around.setTo(1);
    around.setTo(0, dark);
    return mean_around(shrunk(kept, coarse_).mul(pad_), shrunk(around, coarse_).mul(pad_));
  }

  /// Weighted mean around each cell, of sums and weights; 0 where there is no weight.
  cv::Mat_<float> mean_around(const cv::Mat& sum, const cv::Mat& weight) const {
    const double pitch = look_.pitch_px / (fine_ * coarse_);
    const int half = (std::max)(static_cast<int>(std::lround(0.375 * pitch - 0.5)), 1);
    const int side = 2 * half + 1;  // three quarters of a pitch
    const auto blur = [&](const cv::Mat& from, cv::Mat& to) {
      cv::blur(from, to, {side, side}, {-1, -1}, cv::BORDER_CONSTANT);
      cv::blur(to, to, {side, side}, {-1, -1}, cv::BORDER_CONSTANT);
    };
    cv::Mat sums, weights;
    blur(sum, sums);
    blur(weight, weights);
    cv::Mat_<float> mean;
    cv::divide(sums, cv::max(weights, 1e-6), mean);
    return mean;
  }

  /// Where the difference of two blurs, which answers to spots of about the dots' size and to no
  /// slope, is the largest around.
  std::vector<Place> peaks(Frame& seen) const {
    cv::Mat_<float>& dark = seen.light;  // which is not looked at again
    cv::Mat_<float> ground, wide, largest;
    const cv::Mat reflection = dark > seen.brightest;
    cv::resize(seen.ground, ground, dark.size(), 0, 0, cv::INTER_LINEAR);
    cv::divide(dark, ground, dark, -1);
    cv::add(dark, 1, dark);
    dark.setTo(0, reflection);
    dark.setTo(0, ground <= min_light);
    if (!outside_.empty()) {
      dark.setTo(0, outside_);
    }
    const double radius = look_.radius_px / fine_;
    cv::GaussianBlur(dark, wide, {}, 1.2 * radius);
    cv::GaussianBlur(dark, dark, {}, 0.5 * radius);
    cv::Mat_<float>& response = wide;
    cv::subtract(dark, wide, response);
    const int reach = (std::max)(static_cast<int>(std::lround(0.8 * radius)), 1);
    cv::dilate(response, largest,
               cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * reach + 1, 2 * reach + 1}));
    const auto least = static_cast<float>(0.25 * look_.min_contrast);
    std::vector<Place> found;
    const double near_px = fine_ * (reach + 0.5);
    const auto is_beside = [&](const Place& other, const Place& peak) {
      return std::abs(other.x - peak.x) < near_px && std::abs(other.y - peak.y) < near_px;
    };
    for (int i = 0; i < response.rows; ++i) {
      const float* here = response[i];
      const float* most = largest[i];
      for (int j = 0; j < response.cols; ++j) {
        if (here[j] > least && here[j] >= most[j]) {
          // Pixels of the same height on both sides of a middle are one spot.
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

  void read(const Frame& seen, const Place& place, double half_px, DotPatch& patch) const {
    patch.move_to(place, half_px, seen.frame.size());
    seen.frame.depth() == CV_16U ? read_as<std::uint16_t>(seen, place, patch)
                                 : read_as<std::uint8_t>(seen, place, patch);
  }

  template <class Pixel>
  void read_as(const Frame& seen, const Place& place, DotPatch& patch) const {
    const int channels = seen.frame.channels();
    const auto unit = static_cast<float>(unit_of(seen.frame) * (look_.bright ? -1 : 1));
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
      const Pixel* pixel = seen.frame.ptr<Pixel>(i) + box.x * channels;
      float* dark = patch.row(i);
      const float first = ground.at(static_cast<float>(box.x), static_cast<float>(i));
      for (int j = 0; j < box.width; ++j, pixel += channels) {
        const float light = offset + weight[0] * static_cast<float>(pixel[0]) +
                            weight[1] * static_cast<float>(pixel[second]) +
                            weight[2] * static_cast<float>(pixel[third]);
        const float around = first + ground.right * static_cast<float>(j);
        dark[j] = light <= brightest && around > darkest ? 1 - light / around : 0.0F;
      }
      if (masked) {
        const std::uint8_t* inside = where_[i] + box.x;
        for (int j = 0; j < box.width; ++j) {
          dark[j] = inside[j] != 0 ? dark[j] : 0.0F;
        }
      }
    }
  }

  /// The ground's light beside a place.
  struct Plane {
    float value = 0, right = 0, down = 0;
    float x = 0, y = 0;
    float at(float to_x, float to_y) const {
      return value + right * (to_x - x) + down * (to_y - y);
    }
  };

  Plane ground_at(const Frame& seen, const Place& place) const {
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

  /// Whether all of a spot lies within the frame.
  bool is_whole(const Place& center, cv::Size size) const {
    const double r = look_.radius_px;
    return center.x >= r && center.x <= size.width - 1 - r && center.y >= r &&
           center.y <= size.height - 1 - r;
  }

  /// Dark inside and bright around, which the border of a shadow is not.
  bool looks_like_a_dot(const DotPatch& patch, const Place& center) const {
    const double r = look_.radius_px;
    const double core = patch.mean_within(center, 0, r / 2);
    const double ring =
        patch.mean_within(center, (std::max)(1.4 * r, r + 1), (std::max)(1.9 * r, r + 2));
    return core >= look_.min_contrast && ring <= 0.5 * core;
  }

  SpotLook look_;
  cv::Mat_<std::uint8_t> where_;    ///< 255 where spots may be; empty: anywhere
  int fine_;                        ///< pixels a side of what spots are looked for in
  int coarse_;                      ///< of those a side of what the ground is told by
  cv::Mat_<float> pad_;             ///< coarse: 1 where spots may be
  cv::Mat_<std::uint8_t> outside_;  ///< fine: 255 where they may not; empty: anywhere
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
