// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Stick ratio of 21 x 21 dots with 64 stored frames; "ns/pixel" is per frame, "ns/dot" where it
// says so. Error: mean absolute error of the ratio over recordings in which dots are dragged,
// turned and pressed at once (tests/support/slipping_dots.hpp), with 0.14 px of noise.
#include "fingerpad/stick_ratio.hpp"

#include <memory>
#include <string>
#include <vector>

#include "../tests/support/slipping_dots.hpp"
#include "support/naive_stick_ratio.hpp"
#include "support/run.hpp"

using namespace fingerpad;

namespace {

constexpr double noise_px = 0.14;

/// Dragged to and fro for ever, all in contact, so that every frame looks for its reference among
/// 64 stored ones.
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

template <class Ratio>
void add(const std::string& name, const Ratio& ratio, const Recording& input, bool with_error) {
  struct Running {
    Ratio ratio;
    typename Ratio::State state = ratio.start();
    test::DotStates states{ratio.rows(), ratio.cols()};
    std::size_t k = 0;
  };
  const auto d = std::make_shared<Running>(Running{ratio});
  bench::add(
      name, 1,
      [d, &input] {
        d->k = d->k + 1 < input.frames.size() ? d->k + 1 : 0;
        benchmark::DoNotOptimize(d->ratio(input.frames[d->k], input.contact, d->states, d->state));
      },
      [d, with_error](auto& counters) {
        if (with_error) {
          counters["mean_error_ratio"] =
              test::error_of(d->ratio, test::SlipScene::everything, noise_px, {}, 6).mean_abs;
        }
      });
}

template <class Motion,
          class Reference = UpdatedReference<>,
          class Denoising = ResidualMean,
          class S = float>
void add_frame(const std::string& name) {
  add("frame of 21x21 dots/" + name, StickRatio<Motion, Reference, Denoising, S>(21, 21),
      recording(), true);
}

void add_naive() {
  struct Running {
    bench::NaiveStickRatio ratio{21, 21, 64};
    std::vector<std::vector<bench::NaivePoint>> frames;
    std::size_t k = 0;
  };
  const auto d = std::make_shared<Running>();
  for (const auto& frame : recording().frames) {
    auto& points = d->frames.emplace_back();
    for (const auto& p : frame.cells) {
      points.push_back({p.x, p.y});
    }
  }
  bench::add(
      "frame of 21x21 dots/naive: the slides in double, every stored frame", 1,
      [d] {
        d->k = d->k + 1 < d->frames.size() ? d->k + 1 : 0;
        benchmark::DoNotOptimize(d->ratio(d->frames[d->k]));
      },
      [](auto&) {});
}

void add_growth() {
  static const Recording small(11, 11, 0.6), large(41, 41, 0.6), slow(21, 21, 0.05);
  const auto name = [](const char* what) { return std::string("growth/") + what; };
  add(name("21x21 dots, 64 stored frames"), StickRatio(21, 21), recording(), false);
  add(name("11x11 dots"), StickRatio(11, 11), small, false);
  add(name("41x41 dots"), StickRatio(41, 41), large, false);
  add(name("1024 stored frames"),
      StickRatio<StickConsensus<>, UpdatedReference<>>(21, 21, {}, {}, {.capacity = 1024}),
      recording(), false);
  add(name("moving by 0.05 px a frame"), StickRatio(21, 21), slow, false);
}

}  // namespace

int main(int argc, char** argv) {
  using Published = ReferenceDotMotion<Freedom::similarity, PublishedZoom>;
  using Updated = UpdatedReference<>;
  add_naive();
  add_frame<Published, Updated, DotMean, double>("published policies, double");
  add_frame<Published, Updated, DotMean>("published policies");
  add_frame<ReferenceDotMotion<>, Updated, DotMean>(
      "ReferenceDotMotion<LeastSquaresZoom>, DotMean");
  add_frame<ReferenceDotMotion<>>("ReferenceDotMotion<LeastSquaresZoom>, ResidualMean");
  add_frame<StickConsensus<>>("StickConsensus, ResidualMean, the default");
  add_frame<StickConsensus<>, Updated, ResidualMean, double>("the default in double");
  add_frame<StickConsensus<>, UpdatedReference<InStickRegion>>("d_max in the stick region");
  add_frame<StickConsensus<>, Updated, DotMean>("StickConsensus, DotMean");
  add_frame<StickConsensus<>, Updated, NoDenoising>("without denoising");
  add_frame<StickConsensus<Freedom::rigid>>("without scale");
  add_frame<StickConsensus<Freedom::scaling>>("without turn");
  add_frame<StickConsensus<Freedom::translation>>("without turn and scale");
  add_frame<StickConsensus<>, FirstReference>("FirstReference");
  add_growth();
  return bench::run(argc, argv);
}
