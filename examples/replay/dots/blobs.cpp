// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/dots/blobs.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace replay {
namespace {

constexpr float min_darkness = 0.08F;    // a dot is darker than the membrane by this share or more
constexpr std::size_t max_spots = 4000;  // in a whole frame; more are its grain
constexpr float min_light = 4.0F;        // grey levels of red + green; darker places show nothing
constexpr float glare = 2.0F;  // light above this many times the pad's median is none of its own

/// Median of the values where `mask` is positive; 0 where it is nowhere.
float median_of(const cv::Mat_<float>& values, const cv::Mat_<float>& mask) {
  std::vector<float> inside;
  inside.reserve(values.total());
  for (int i = 0; i < values.rows; ++i) {
    for (int j = 0; j < values.cols; ++j) {
      if (mask(i, j) > 0) {
        inside.push_back(values(i, j));
      }
    }
  }
  if (inside.empty()) {
    return 0;
  }
  const auto middle = inside.begin() + static_cast<std::ptrdiff_t>(inside.size() / 2);
  std::nth_element(inside.begin(), middle, inside.end());
  return *middle;
}

constexpr float brightest_light = 512;  // red plus green, or what stands for it

/// Red plus green in grey levels.
cv::Mat_<float> red_and_green(const cv::Mat& image) {
  cv::Mat green;
  cv::Mat red;
  cv::extractChannel(image, green, 1);
  cv::extractChannel(image, red, 2);
  const double level = image.depth() == CV_16U ? 1.0 / 256 : 1.0;
  cv::Mat_<float> sum;
  cv::addWeighted(red, level, green, level, 0, sum, CV_32F);
  return sum;
}

/// Square around a point, within the image.
cv::Rect square(const cv::Vec2d& center, double half_px, cv::Size size) {
  const cv::Point first(static_cast<int>(std::ceil(center[0] - half_px)),
                        static_cast<int>(std::ceil(center[1] - half_px)));
  const cv::Point last(static_cast<int>(std::floor(center[0] + half_px)),
                       static_cast<int>(std::floor(center[1] + half_px)));
  return cv::Rect(first, last + cv::Point(1, 1)) & cv::Rect(cv::Point(0, 0), size);
}

/// Center of gravity of the darkness within a disc that follows it; NaN where there is none. The
/// membrane around a dot has darkness 0 on average and so does not pull.
cv::Vec2d center_of_gravity(const cv::Mat_<float>& dark, cv::Vec2d center, double reach_px) {
  constexpr int rounds = 4;
  for (int round = 0; round < rounds; ++round) {
    const cv::Rect box = square(center, reach_px, dark.size());
    cv::Vec2d sum(0, 0);
    double weight = 0;
    for (int i = box.y; i < box.y + box.height; ++i) {
      for (int j = box.x; j < box.x + box.width; ++j) {
        const cv::Vec2d at(j, i);
        if (cv::norm(at - center) <= reach_px) {
          const auto here = static_cast<double>(dark(i, j));
          sum += here * at;
          weight += here;
        }
      }
    }
    if (!(weight > 0) || cv::norm(sum / weight - center) > reach_px) {
      return no_dot();
    }
    center = sum / weight;
  }
  return center;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Whether a disc lies within the frame.
bool is_whole(const cv::Vec2d& center, double radius_px, cv::Size size) {
  return center[0] >= radius_px && center[0] <= size.width - 1 - radius_px &&
         center[1] >= radius_px && center[1] <= size.height - 1 - radius_px;
}

float mean_within(const cv::Mat_<float>& values, const cv::Vec2d& center, double radius_px) {
  const cv::Rect box = square(center, radius_px, values.size());
  double sum = 0;
  int count = 0;
  for (int i = box.y; i < box.y + box.height; ++i) {
    for (int j = box.x; j < box.x + box.width; ++j) {
      if (cv::norm(cv::Vec2d(j, i) - center) <= radius_px) {
        sum += static_cast<double>(values(i, j));
        ++count;
      }
    }
  }
  return count > 0 ? static_cast<float>(sum / count) : 0.0F;
}

/// Pixels whose response is the largest around them.
Blobs peaks(const cv::Mat_<float>& response, float least, int reach_px) {
  cv::Mat_<float> largest;
  const cv::Size window(2 * reach_px + 1, 2 * reach_px + 1);
  cv::dilate(response, largest, cv::getStructuringElement(cv::MORPH_ELLIPSE, window));
  Blobs found;
  for (int i = 0; i < response.rows; ++i) {
    for (int j = 0; j < response.cols; ++j) {
      if (response(i, j) > least && response(i, j) >= largest(i, j)) {
        found.emplace_back(j, i);
      }
    }
  }
  return found;
}

double distance_to_nearest(const Blobs& blobs, std::size_t self) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < blobs.size(); ++k) {
    if (k != self) {
      nearest = (std::min)(nearest, cv::norm(blobs[k] - blobs[self]));
    }
  }
  return nearest;
}

}  // namespace

BlobFinder::BlobFinder(const Sensor& sensor, const cv::Mat_<float>& reference_depth)
    : pad_(reference_depth.size()) {
  for (int i = 0; i < pad_.rows; ++i) {
    for (int j = 0; j < pad_.cols; ++j) {
      pad_(i, j) = std::isfinite(reference_depth(i, j)) ? 1.0F : 0.0F;
    }
  }
  // The pixels of the border hold a part of the ring.
  cv::erode(pad_, pad_, cv::Mat(), {-1, -1}, 1, cv::BORDER_CONSTANT, 0);
  const auto depth_mm = static_cast<double>(median_of(reference_depth, pad_));
  const double px_per_mm =
      fingerpad::pixel_of(sensor.camera, fingerpad::Point3<double>{0.5, 0, depth_mm}).x -
      fingerpad::pixel_of(sensor.camera, fingerpad::Point3<double>{-0.5, 0, depth_mm}).x;
  radius_px_ = sensor.dots->diameter_mm / 2 * px_per_mm;
  pitch_px_ = sensor.dots->pitch_mm * px_per_mm;
}

BlobFinder::BlobFinder(cv::Size size, const SpotLook& look)
    : pad_(size, 1.0F),
      radius_px_(look.radius_px),
      pitch_px_(look.pitch_px),
      margin_px_(look.radius_px),
      whole_frame_(true),
      bright_(look.bright) {}

/// Twice the mean of all colours in the place of red and green, and bright spots made dark.
cv::Mat_<float> BlobFinder::light_of(const cv::Mat& image) const {
  if (!whole_frame_) {
    return red_and_green(image);
  }
  const double level = image.depth() == CV_16U ? 1.0 / 256 : 1.0;
  const double share = 2 * level / 3;
  cv::Mat_<float> light;
  cv::transform(cv::Mat_<cv::Vec3f>(image), light, cv::Matx13f::all(static_cast<float>(share)));
  if (bright_) {
    cv::subtract(static_cast<double>(brightest_light), light, light);
  }
  return light;
}

/// Mean of the light around each pixel, weighted; 0 where there is no weight.
cv::Mat_<float> BlobFinder::light_around(const cv::Mat_<float>& light,
                                         const cv::Mat_<float>& weight) const {
  const int side = 2 * (std::max)(static_cast<int>(std::lround(pitch_px_ / 2)), 1) + 1;
  cv::Mat sum;
  cv::Mat total;
  cv::multiply(light, weight, sum);
  cv::blur(sum, sum, {side, side}, {-1, -1}, cv::BORDER_CONSTANT);
  cv::blur(weight, total, {side, side}, {-1, -1}, cv::BORDER_CONSTANT);
  cv::blur(sum, sum, {side, side}, {-1, -1}, cv::BORDER_CONSTANT);
  cv::blur(total, total, {side, side}, {-1, -1}, cv::BORDER_CONSTANT);
  cv::Mat_<float> mean;
  cv::divide(sum, cv::max(total, 1e-6), mean);
  return mean;
}

/// By which share a pixel is darker than the membrane around it, 0 off the pad. The membrane is
/// what is left when the pixels that are darker than their surroundings are taken away.
cv::Mat_<float> BlobFinder::darkness(const cv::Mat& image) const {
  const cv::Mat_<float> light = light_of(image);
  const float brightest = glare * median_of(light, pad_);
  cv::Mat_<float> pad = pad_.clone();
  pad.setTo(0, light > static_cast<double>(brightest));
  cv::Mat_<float> membrane = pad.clone();
  cv::Mat_<float> around;
  for (int round = 0; round < 2; ++round) {
    around = light_around(light, membrane);
    cv::Mat bright;
    cv::compare(light, around * static_cast<double>(1 - min_darkness), bright, cv::CMP_GT);
    bright.convertTo(bright, CV_32F, 1.0 / 255);
    cv::multiply(pad, bright, membrane);
  }
  around = light_around(light, membrane);
  cv::Mat_<float> dark(light.size(), 0.0F);
  for (int i = 0; i < light.rows; ++i) {
    for (int j = 0; j < light.cols; ++j) {
      if (pad(i, j) > 0 && around(i, j) > min_light) {
        dark(i, j) = 1 - light(i, j) / around(i, j);
      }
    }
  }
  return dark;
}

/// Dark inside and bright around, which the border of a shadow is not.
bool BlobFinder::looks_like_a_dot(const cv::Mat_<float>& dark, const cv::Vec2d& center) const {
  const double outer_px = (std::max)(1.9 * radius_px_, radius_px_ + 2);
  const double inner_px = (std::max)(1.4 * radius_px_, radius_px_ + 1);
  const cv::Rect box = square(center, outer_px, dark.size());
  double core = 0;
  double ring = 0;
  int core_count = 0;
  int ring_count = 0;
  for (int i = box.y; i < box.y + box.height; ++i) {
    for (int j = box.x; j < box.x + box.width; ++j) {
      const double off_px = cv::norm(cv::Vec2d(j, i) - center);
      if (off_px <= radius_px_ / 2) {
        core += static_cast<double>(dark(i, j));
        ++core_count;
      } else if (off_px > inner_px && off_px <= outer_px) {
        ring += static_cast<double>(dark(i, j));
        ++ring_count;
      }
    }
  }
  if (core_count == 0 || ring_count == 0) {
    return false;
  }
  core /= core_count;
  ring /= ring_count;
  return core >= static_cast<double>(min_darkness) && ring <= 0.5 * core;
}

Blobs BlobFinder::find(const cv::Mat& image) const {
  const cv::Mat_<float> dark = darkness(image);
  // The difference of two blurs answers to spots of about the dots' size and to no slope.
  cv::Mat_<float> fine;
  cv::Mat_<float> coarse;
  cv::GaussianBlur(dark, fine, {}, 0.5 * radius_px_);
  cv::GaussianBlur(dark, coarse, {}, 1.2 * radius_px_);
  cv::Mat_<float> response;
  cv::subtract(fine, coarse, response);
  const int reach_px = (std::max)(static_cast<int>(std::lround(0.8 * radius_px_)), 1);
  const Blobs rough = peaks(response, 0.25F * min_darkness, reach_px);
  Blobs found;
  if (whole_frame_ && rough.size() > max_spots) {
    return found;
  }
  for (std::size_t k = 0; k < rough.size(); ++k) {
    const double reach = (std::min)((std::max)(1.4 * radius_px_, radius_px_ + 1.5),
                                    0.55 * distance_to_nearest(rough, k));
    const cv::Vec2d center = center_of_gravity(dark, rough[k], reach);
    if (is_present(center) && is_whole(center, margin_px_, dark.size()) &&
        looks_like_a_dot(dark, center)) {
      found.push_back(center);
    }
  }
  return found;
}

TypicalSpot BlobFinder::typical(const cv::Mat& image, const Blobs& spots) const {
  if (spots.empty()) {
    return {};
  }
  const cv::Mat_<float> dark = darkness(image);
  std::vector<double> radii;
  std::vector<double> middles;
  for (const cv::Vec2d& spot : spots) {
    const float middle = mean_within(dark, spot, (std::max)(radius_px_ / 2, 1.0));
    int count = 0;
    const cv::Rect box = square(spot, pitch_px_ / 2, dark.size());
    for (int i = box.y; i < box.y + box.height; ++i) {
      for (int j = box.x; j < box.x + box.width; ++j) {
        const bool near = cv::norm(cv::Vec2d(j, i) - spot) <= pitch_px_ / 2;
        count += near && dark(i, j) > middle / 2 ? 1 : 0;
      }
    }
    radii.push_back(std::sqrt(count / 3.14159265358979));
    middles.push_back(static_cast<double>(middle));
  }
  return {median(radii), median(middles)};
}

}  // namespace replay
