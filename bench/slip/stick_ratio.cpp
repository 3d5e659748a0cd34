// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Stick ratio of 21 x 21 dots with 64 stored frames; "ns/pixel" is per frame. Timed: dots dragged
// back and forth, all in contact. Error: of the ratio, in each frame of recordings in which dots
// are dragged, rotated and pressed, one by one and at once (tests/support/slipping_dots.hpp), with
// 0.14 px of noise. A frame without an answer (at rest, or moved too little) has no error.
// "On scenes": the same noise on dots of finite-element membranes.
#include "fingerpad/slip/stick_ratio.hpp"

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene_stick.hpp"
#include "support/published_stick.hpp"
#include "support/slipping_dots.hpp"

using namespace fingerpad;

namespace {

constexpr double noise_px = 0.14;

/// An endless drag back and forth with all dots in contact, in which every frame searches 64 stored
/// ones for its reference.
struct Recording {
  explicit Recording(Index rows, Index cols, double step_px) {
    test::Random random(1);
    test::SlippingDots moving({.rows = rows, .cols = cols, .contact_pitches = 1e6});
    contact = moving.contact;
    for (int k = 0; k < 256; ++k) {
      const double direction = k < 128 ? 0.3 : 0.3 + std::numbers::pi;
      moving.step({.shift_px = step_px, .direction_rad = direction, .stick_share = 6.0 / 1e6});
      frames.push_back(test::noisy(moving.dots, noise_px, random));
    }
  }
  std::vector<test::PointsPx> frames;
  test::ContactFlags contact;
};

const Recording& recording() {
  static const Recording r(21, 21, 0.6);
  return r;
}

/// A frame whose true ratio is known against any reference.
struct KnownFrame {
  bool begins;
  test::PointsPx seen;
  test::SlippingDots truth;
};

/// All scenes, each in six directions. The contact covers the same share of the pattern at any
/// size.
const std::vector<KnownFrame>& known_frames(Index dots) {
  static std::map<Index, std::vector<KnownFrame>> of_size;
  std::vector<KnownFrame>& frames = of_size[dots];
  if (frames.empty()) {
    const double share = static_cast<double>(dots) / 21;
    const test::SlippingPattern pattern{
        .rows = dots, .cols = dots, .pitch_px = 19.5 / share, .contact_pitches = 8.2 * share};
    for (const test::SlipScene scene : test::all_slip_scenes) {
      for (int n = 0; n < 6; ++n) {
        test::Random random(static_cast<std::uint64_t>(1 + n));
        test::SlippingDots truth(pattern);
        frames.push_back({true, test::noisy(truth.dots, noise_px, random), truth});
        for (const test::SlipStep& step : steps_of(scene, 2.4 * n)) {
          truth.step(step);
          frames.push_back({false, test::noisy(truth.dots, noise_px, random), truth});
        }
      }
    }
  }
  return frames;
}

template <class Ratio>
std::vector<double> errors_of(const Ratio& ratio) {
  std::vector<double> errors;
  Ratio stick = ratio;
  for (const KnownFrame& frame : known_frames(ratio.rows())) {
    if (frame.begins) {
      stick = ratio;
    }
    const auto r = stick(frame.seen, frame.truth.contact);
    errors.push_back(r.updated() ? static_cast<double>(r.stick_ratio) -
                                       frame.truth.stick_ratio(r.reference_age)
                                 : test::nan);
  }
  return errors;
}

void note_ratio(bench::Counters& counters, const std::vector<double>& errors) {
  bench::note_errors(counters, "stick ratio", "of 1", errors);
}

/// `ratio` has seen no frame; `slip_share` is its delta_0 / U.
template <class Ratio>
void add(const std::string& name, const Recording& input, const Ratio& ratio, double slip_share) {
  struct Running {
    Ratio fresh, stick = fresh;
    std::size_t k = 0;
  };
  const bench::Memory memory;
  const auto d = std::make_shared<Running>(Running{ratio});
  bench::add(
      name, 1, memory.bytes() / 2,
      [d, &input] {
        d->k = d->k + 1 < input.frames.size() ? d->k + 1 : 0;
        benchmark::DoNotOptimize(d->stick(input.frames[d->k], input.contact));
      },
      [d, slip_share, errors = std::vector<double>()](auto& counters) mutable {
        if (d->fresh.rows() == 21) {
          bench::note_stick_on_scenes(counters, d->fresh, noise_px, slip_share);
        }
        errors = errors.empty() ? errors_of(d->fresh) : errors;
        note_ratio(counters, errors);
      });
}

template <class S>
void add_frame(const std::string& name, const StickOptions& options = {}) {
  add("frame of 21x21 dots/" + name, recording(), StickRatio<S>(21, 21, options),
      options.slip_share);
}

/// The printed method.
void add_printed(const char* name, const published::StickRatioOptions& options) {
  add(std::string("frame of 21x21 dots/") + name, recording(),
      test::PublishedStick{.ratio = {21, 21, options}}, 0.12);
}

/// Motion of the object between two frames, from random samples of the dots.
void add_opencv() {
  struct Data {
    std::vector<cv::Point2f> from, to;
    cv::Mat sticks, motion;
  };
  const auto d = std::make_shared<Data>();
  const auto points = [](const test::PointsPx& dots) {
    std::vector<cv::Point2f> out;
    for (const auto& p : dots.cells) {
      out.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
    }
    return out;
  };
  d->from = points(recording().frames[0]);
  d->to = points(recording().frames[8]);
  const bench::Memory memory;
  d->motion = cv::estimateAffinePartial2D(d->from, d->to, d->sticks, cv::RANSAC, 0.5);
  bench::add(
      "frame of 21x21 dots/cv::estimateAffinePartial2D, RANSAC", 1, memory.bytes(),
      [d] {
        d->motion = cv::estimateAffinePartial2D(d->from, d->to, d->sticks, cv::RANSAC, 0.5);
        benchmark::DoNotOptimize(d->motion.data);
      },
      [](auto&) {});
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  add_printed("published: StickRatio", {});
  add_printed("published: the first reference stays", {.updates = false});
  add_printed("published: without denoising", {.S2 = 0, .S3 = 0});
  add_printed("published: the conventional method", published::conventional_stick_ratio);
  add_frame<double>("StickRatio, double, the default");
  add_frame<double>("the noise is given", {.noise = noise_px});
  add_frame<float>("float");
  add_opencv();
  bench::add_streaming("frame of 21x21 dots");
  return bench::run(argc, argv);
}
