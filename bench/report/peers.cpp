// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// fingerpad beside OpenCV on the same frames: error and time of one run. Prints the Markdown tables
// of docs/peers.md. The frames are rendered, so that the truth is known.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "peers/dots.hpp"
#include "peers/slide.hpp"

namespace {

using namespace bench::peers;

constexpr int frames = 7;

/// Processor time of a call.
template <class Call>
double ms_of(Call&& call) {
  const std::clock_t start = std::clock();
  call();
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

double median_of(std::vector<double> all) {
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2),
                   all.end());
  return all[all.size() / 2];
}

/// Errors of the dots that are found, and the share that is lost or elsewhere.
struct Score {
  double rms_px, lost_percent;
};

Score follow(const DotFrames& of, const Follow& method, std::vector<double>& ms) {
  DotPlaces dots = of.truth[0].clone();
  double sum = 0;
  int found = 0, all = 0;
  for (std::size_t k = 0; k < of.frames.size(); ++k) {
    const double time = ms_of([&] { method(of.frames[k], dots); });
    if (k == 0) {  // some remember it
      continue;
    }
    ms.push_back(time);
    for (int i = 0; i < dots.rows; ++i) {
      for (int j = 0; j < dots.cols; ++j) {
        const double off = cv::norm(dots(i, j) - of.truth[k](i, j));
        const bool is_found = off < of.pitch_px / 4;
        found += is_found ? 1 : 0;
        sum += is_found ? off * off : 0;
        ++all;
      }
    }
  }
  return {found > 0 ? std::sqrt(sum / found) : std::nan(""), 100.0 * (all - found) / all};
}

void print_dots(const std::string& title,
                DotFrames (*make)(const Filming&, int),
                double max_off,
                const std::vector<Filming>& filmings) {
  std::printf("\n### %s\n\n| Method | ms a frame |", title.c_str());
  for (const Filming& filming : filmings) {
    std::printf(" %s: error, px; lost |", filming.name.c_str());
  }
  std::printf("\n|---|--:|");
  for (std::size_t k = 0; k < filmings.size(); ++k) {
    std::printf("--:|");
  }
  std::vector<DotFrames> all;
  for (const Filming& filming : filmings) {
    all.push_back(make(filming, frames));
  }
  const std::vector<std::pair<const char*, std::function<Follow(const DotFrames&)>>> methods = {
      {"`DotFinder`", [=](const DotFrames& of) { return dot_finder(of, max_off); }},
      {"`DotFollower`", [=](const DotFrames& of) { return dot_follower(of, max_off); }},
      {"mask and centroid", mask_and_centroid},
      {"cv::SimpleBlobDetector", simple_blobs},
      {"cv::calcOpticalFlowPyrLK, from the frame before",
       [](const DotFrames& of) { return optical_flow(of, false); }},
      {"the same, from the free pad", [](const DotFrames& of) { return optical_flow(of, true); }},
      {"cv::findCirclesGrid", circles_grid}};
  for (const auto& [name, method_for] : methods) {
    std::vector<double> ms;
    std::string cells;
    for (const DotFrames& of : all) {
      const Score score = follow(of, method_for(of), ms);
      char text[64];
      if (std::isfinite(score.rms_px)) {
        std::snprintf(text, sizeof text, " %.3f; %.2g %% |", score.rms_px, score.lost_percent);
      } else {
        std::snprintf(text, sizeof text, " all lost |");
      }
      cells += text;
    }
    std::printf("\n| %s | %.2f |%s", name, median_of(ms), cells.c_str());
    std::fflush(stdout);
  }
  std::printf("\n");
}

void print_slides() {
  struct Light {
    const char* name;
    double noise, flicker;
  };
  const Light lights[] = {{"clean", 1, 0}, {"noise of 3 grey levels", 3, 0}, {"flicker", 1, 0.1}};
  const std::vector<std::pair<const char*, std::function<Travel(const SlideFrames&)>>> methods = {
      {"`GelContact` and `GelSlide`", gel_slide},
      {"cv::phaseCorrelate of the difference", phase_correlation},
      {"cv::matchTemplate of the difference", template_matching},
      {"corners and cv::calcOpticalFlowPyrLK", [](const SlideFrames&) { return corners(); }}};
  std::printf("\n### Travel of an imprint\n\n| Method | ms a frame |");
  for (const Light& light : lights) {
    std::printf(" %s: error, mean / largest, px |", light.name);
  }
  std::printf("\n|---|--:|--:|--:|--:|");
  for (const auto& [name, method_for] : methods) {
    std::vector<double> ms;
    std::string cells;
    for (const Light& light : lights) {
      double sum = 0, largest = 0;
      int count = 0;
      for (unsigned seed = 1; seed <= 4; ++seed) {
        const SlideFrames of = dragged_ball(seed, light.noise, light.flicker, frames);
        const Travel method = method_for(of);
        for (std::size_t k = 0; k < of.frames.size(); ++k) {
          cv::Point2d travel;
          ms.push_back(ms_of([&] { travel = method(of.frames[k], of.dots[k]); }));
          const double off = cv::norm(travel - of.truth[k]);
          sum += off;
          largest = std::fmax(largest, off);
          ++count;
        }
      }
      char text[64];
      std::snprintf(text, sizeof text, " %.2f / %.2f |", sum / count, largest);
      cells += text;
    }
    std::printf("\n| %s | %.2f |%s", name, median_of(ms), cells.c_str());
    std::fflush(stdout);
  }
  std::printf("\n");
}

}  // namespace

int main() {
  cv::setNumThreads(1);
  const Filming clean{.name = "clean"}, noisy{.name = "noise of 3 grey levels", .noise = 3},
      flicker{.name = "flicker of 10 %", .flicker = 0.1},
      rare{.name = "every 4th frame", .every = 4};
  print_dots("8 x 10 dots of 20 px on a gel", gel_dots, 0.3, {clean, noisy, flicker, rare});
  print_dots("21 x 21 dots of 9 px on a membrane", membrane_dots, 0.1,
             {clean, noisy, flicker, rare});
  print_slides();
  return 0;
}
