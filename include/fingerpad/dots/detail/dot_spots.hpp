// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finds spots of about the size of a printed dot in a frame, dark or bright. They are detected in a
// reduced frame, whose pixels are still finer than a dot, as peaks of the difference of two blurs.
// At each peak the picture of a disc is fitted to the pixels of the frame: that gives the center,
// and tells by contrast and residual whether it is a dot.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/dots/detail/dot_locator.hpp"
#include "fingerpad/dots/detail/dot_table.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// Appearance of spots.
struct SpotLook {
  double radius_px = 0;
  double edge_px = 2;                               ///< half width of the blurred edge
  bool bright = false;                              ///< brighter than the background
  double min_contrast = 0.08;                       ///< share of the light that is missing
  std::array<double, 3> color_weights = {1, 1, 1};  ///< of blue, green and red
};

/// Whether a frame has a supported type: 8 or 16 bit, one, three or four channels.
inline bool is_picture(const cv::Mat& frame) {
  const int channels = frame.channels();
  return !frame.empty() && (frame.depth() == CV_8U || frame.depth() == CV_16U) &&
         (channels == 1 || channels == 3 || channels == 4);
}

class SpotFinder {
 public:
  /// `where`: nonzero where spots may be; empty: anywhere.
  explicit SpotFinder(const SpotLook& look, const cv::Mat_<std::uint8_t>& where = {})
      : look_(look),
        where_(where),
        fine_((std::max)(1, static_cast<int>(look.radius_px / 1.5))),
        coarse_((std::max)(1, static_cast<int>(look.radius_px / 10))),
        edge_px_((std::max)(look.edge_px / coarse_, 0.6)) {}

  /// Centers of the spots of a frame, in any order; none if there are more than `max_spots`, which
  /// are image noise. Spots that no disc explains, as of damaged dots, are added to `poor` if it is
  /// given, else left out: they are near where a dot is, no measure of its center.
  std::vector<Place> find(const cv::Mat& frame,
                          std::vector<Place>* poor = nullptr,
                          std::size_t max_spots = 4000) {
    const std::vector<Place> rough = peaks(frame);
    std::vector<Place> found;
    if (rough.size() > max_spots) {
      return found;
    }
    in_light_of(frame, [&](const auto& light) {
      const double r = look_.radius_px / coarse_;
      for (const Place& peak : rough) {
        const Place at = reduced(peak, coarse_);
        const int print = dots_.nearest(peak, 5 * look_.radius_px).spot;
        const DiscMap disc =
            print < 0 ? DiscMap{{r, 0}, {0, r}} : discs_[static_cast<std::size_t>(print)];
        const DiscFit fit = locator_.find(light, at, disc, edge_px_, {0, 0});
        const bool is_spot = is_dark(fit) && norm(fit.center - at) < r;
        if (is_spot && is_disc(fit)) {
          found.push_back(full(fit.center, coarse_));
        } else if (is_spot && poor != nullptr) {
          poor->push_back(full(fit.center, coarse_));
        }
      }
    });
    return found;
  }

  /// Medians over dots that are found: radius, blur of the edge and contrast; 0 without dots.
  struct Typical {
    double radius_px = 0, edge_px = 0, contrast = 0;
  };
  /// From now on spots are judged by the disc of the nearest of these dots.
  Typical learn(const cv::Mat& frame, const std::vector<Place>& dots) {
    std::vector<double> radii, edges, contrasts;
    std::vector<Place> fitted;
    discs_.clear();
    in_light_of(frame, [&](const auto& light) {
      for (const Place& dot : dots) {
        const double r = look_.radius_px / coarse_;
        DiscMap map = {{r, 0}, {0, r}};
        double edge = edge_px_;
        const DiscFit fit = locator_.fit_shape(light, reduced(dot, coarse_), map, edge, true);
        if (fit.good) {
          radii.push_back(coarse_ * std::sqrt(map.ja.x * map.jb.y - map.ja.y * map.jb.x));
          edges.push_back(coarse_ * edge);
          contrasts.push_back(fit.contrast);
          discs_.push_back(map);
          fitted.push_back(dot);
        }
      }
    });
    dots_ = SpotMap(std::move(fitted));
    return radii.empty() ? Typical() : Typical{median(radii), median(edges), median(contrasts)};
  }

 private:
  static constexpr double min_light = 2;  // grey levels; darker areas are ignored

  /// Between pixels of a frame and those of one reduced by a factor.
  static Place reduced(const Place& p, double by) {
    return (p + Place{0.5, 0.5}) / by - Place{0.5, 0.5};
  }
  static Place full(const Place& p, double by) {
    return by * (p + Place{0.5, 0.5}) - Place{0.5, 0.5};
  }

  bool is_dark(const DiscFit& fit) const {
    return fit.good && fit.contrast >= look_.min_contrast && fit.light > min_light;
  }
  bool is_disc(const DiscFit& fit) const {
    constexpr double max_residual = 0.55;  // of the step from background to dot: ellipses are dots
    constexpr double max_slope = 0.15;     // of the light, over a radius: a dot is half covered
    return norm(fit.slope) * look_.radius_px / coarse_ < max_slope &&
           fit.residual < max_residual * fit.contrast * fit.light;
  }

  /// Mean over squares of `factor` pixels. Incomplete squares at the right and bottom are dropped.
  static cv::Mat shrunk(const cv::Mat& image, int factor) {
    const cv::Size size = image.size() / factor;
    cv::Mat small = image;
    if (factor > 1 && !size.empty()) {
      cv::resize(image({0, 0, size.width * factor, size.height * factor}), small, size, 0, 0,
                 cv::INTER_AREA);
    }
    return small;
  }

  /// The light is offset + weights * channels, in grey levels of 8 bit; of bright dots that of the
  /// negative.
  float offset() const { return look_.bright ? 256.0F : 0.0F; }
  std::array<float, 3> weights(const cv::Mat& frame) const {
    const auto& w = look_.color_weights;
    const double unit = (frame.depth() == CV_16U ? 1.0 / 256 : 1.0) * (look_.bright ? -1 : 1);
    const double sum = w[0] + w[1] + w[2];
    const auto of = [&](double weight) { return static_cast<float>(unit * weight / sum); };
    return frame.channels() == 1 ? std::array{of(sum), 0.0F, 0.0F}
                                 : std::array{of(w[0]), of(w[1]), of(w[2])};
  }

  template <class Pixel>
  auto light_view(const cv::Mat& image) const {
    const auto w = weights(image);
    const float dark = offset();
    const int channels = image.channels();
    const int second = channels > 1 ? 1 : 0, third = channels > 1 ? 2 : 0;
    return LazyView(image.rows, image.cols, [=](Index i, Index j) {
      const Pixel* p = image.ptr<Pixel>(static_cast<int>(i)) + j * channels;
      return dark + w[0] * static_cast<float>(p[0]) + w[1] * static_cast<float>(p[second]) +
             w[2] * static_cast<float>(p[third]);
    });
  }

  /// Calls visit with a view of the light of a frame, in which a dot's radius is some pixels.
  template <class Visit>
  void in_light_of(const cv::Mat& frame, const Visit& visit) const {
    const cv::Mat image = shrunk(frame, coarse_);
    image.depth() == CV_16U ? visit(light_view<std::uint16_t>(image))
                            : visit(light_view<std::uint8_t>(image));
  }
  /// Gaussian blur, cut off at no less than 2.5 standard deviations.
  static cv::Mat blurred(const cv::Mat& image, double sigma) {
    const int side = 2 * static_cast<int>(std::ceil(2.5 * sigma)) + 1;
    cv::Mat out;
    cv::GaussianBlur(image, out, {side, side}, sigma);
    return out;
  }

  /// Local maxima of the difference of two blurs as a share of the light. It responds to spots of
  /// about the dots' size and not to a gradient.
  std::vector<Place> peaks(const cv::Mat& frame) const {
    std::vector<Place> found;
    const cv::Mat small = shrunk(frame, fine_);
    if (small.rows < 3 || small.cols < 3) {
      return found;
    }
    const double radius = look_.radius_px / fine_;
    const auto w = weights(frame);
    cv::Mat levels, light;
    small.convertTo(levels, CV_32F);
    cv::Mat_<float> sum(1, small.channels() + 1, 0.0F);
    std::copy_n(w.begin(), (std::min)(small.channels(), 3), sum.begin());
    sum(sum.cols - 1) = offset();
    cv::transform(levels, light, sum);
    cv::min(light, 2 * cv::mean(light)[0], light);  // a reflection has no dark ring
    const cv::Mat near = blurred(light, 0.5 * radius), wide = blurred(light, 1.2 * radius);
    cv::Mat_<float> response(light.size());
    cv::subtract(wide, near, response);
    response /= cv::max(wide, min_light);
    const int reach = (std::max)(static_cast<int>(std::lround(0.8 * radius)), 1);
    const auto least = static_cast<float>(0.25 * look_.min_contrast);
    cv::Mat_<float> highest;
    cv::dilate(response, highest, cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8U));
    for (int i = 1; i + 1 < response.rows; ++i) {
      for (int j = 1; j + 1 < response.cols; ++j) {
        const float here = response(i, j);
        // none within reach is higher, and of neighbours that are equal it is the first
        if (here > least && here == highest(i, j) && here > response(i, j - 1) &&
            here > response(i - 1, j - 1) && here > response(i - 1, j) &&
            here > response(i - 1, j + 1)) {
          const auto off = [&](float before, float after) {
            const float bend = 2 * here - before - after;
            return bend > 0 ? 0.5 * static_cast<double>((after - before) / bend) : 0.0;
          };
          const Place peak = full({j + off(response(i, j - 1), response(i, j + 1)),
                                   i + off(response(i - 1, j), response(i + 1, j))},
                                  fine_);
          const cv::Point at(cvRound(peak.x), cvRound(peak.y));
          const bool counts = where_.empty() || where_(at) != 0;
          if (counts) {
            found.push_back(peak);
          }
        }
      }
    }
    return found;
  }

  SpotLook look_;
  cv::Mat_<std::uint8_t> where_;
  int fine_;        ///< frame pixels per side of a pixel of the frame in which spots are detected
  int coarse_;      ///< the same where centers are fitted
  double edge_px_;  ///< there
  SpotMap dots_;    ///< of the free pad
  std::vector<DiscMap> discs_;
  DotLocator locator_;
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
