// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Real-time behaviour, one row per method: the time and the instructions of a call on the usual and
// on the hardest input, the slowest of many calls, page faults and allocations. This is no
// google-benchmark program: it prints the Markdown table of docs/results.md. "worst_case count"
// under callgrind leaves a dump for each input. "worst_case CALLS INSTRUCTIONS" makes that many
// calls of each row, for at most a minute, and reads what the dumps say, a line each.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>
#include <type_traits>
#include <vector>

#include "chain/pressed_frames.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/foam/taxels.hpp"
#include "fingerpad/force/traction.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/gel_frames.hpp"
#include "support/slipping_patch.hpp"
#include "support/traction_scenes.hpp"
#include "worst_case/rows.hpp"

using namespace fingerpad;
using bench::worst_case::Kind;
using test::Image;

namespace {

constexpr int variants = 16;  ///< of each kind of input
std::size_t variant(int k) {
  return static_cast<std::size_t>(k % variants);
}

template <class T, class Make>
std::vector<T> made(Make make) {
  std::vector<T> all;
  for (int k = 0; k < variants; ++k) {
    test::Random random(static_cast<std::uint64_t>(k + 1));
    all.push_back(make(k, random));
  }
  return all;
}

Image<std::uint8_t> noise(Index rows, Index cols, test::Random& random) {
  Image<std::uint8_t> image(rows, cols);
  for (std::uint8_t& pixel : image.cells) {
    pixel = static_cast<std::uint8_t>(random.whole(0, 255));
  }
  return image;
}
test::Frame<std::uint8_t> noise_frame(test::Random& random) {
  test::Frame<std::uint8_t> frame(480, 640);
  frame.red = noise(480, 640, random);
  frame.green = noise(480, 640, random);
  return frame;
}

/// Random dots, a tenth of them missing.
template <class Point>
Image<Point> scattered(Index rows, Index cols, double from, double to, test::Random& random) {
  Image<Point> dots(rows, cols);
  for (Point& dot : dots.cells) {
    dot.x = random.uniform() < 0.1 ? test::nan : random.uniform(from, to);
    dot.y = random.uniform(from, to);
    if constexpr (requires { dot.z; }) {
      dot.z = random.uniform(4, 14);
    }
  }
  return dots;
}

const chain::PressedFrames& pressed() {
  static const chain::PressedFrames frames;
  return frames;
}

/// The chain on pressed frames, on noise, and on pressed frames with random dots.
std::vector<Kind> of_chain(Fingertip& fingertip) {
  static const auto frames =
      made<test::Frame<std::uint8_t>>([](int, test::Random& r) { return noise_frame(r); });
  static const auto dots = made<Image<Point2<double>>>(
      [](int, test::Random& r) { return scattered<Point2<double>>(21, 21, 0, 600, r); });
  return {
      {"a pressed pad", [&](int k) { (void)touch_of(fingertip, pressed()[variant(k)].view()); }},
      {"an image of noise",
       [&](int k) {
         auto in = pressed()[variant(k)].view();
         in.red = as_view(frames[variant(k)].red);
         in.green = as_view(frames[variant(k)].green);
         (void)touch_of(fingertip, in);
       }},
      {"dots anywhere", [&](int k) {
         auto in = pressed()[variant(k)].view();
         in.dots_px = as_view(dots[variant(k)]);
         (void)touch_of(fingertip, in);
       }}};
}

std::vector<Kind> of_depth() {
  const auto options = pressed().options();
  static DepthEstimator depth(options.camera, options.fluid, options.reference);
  static Image<float> to(480, 640);
  static const auto frames =
      made<test::Frame<std::uint8_t>>([](int, test::Random& r) { return noise_frame(r); });
  return {{"a pressed pad",
           [](int k) {
             const auto& image = pressed()[variant(k)].image;
             (void)depth(image.red, image.green, to);
           }},
          {"an image of noise",
           [](int k) { (void)depth(frames[variant(k)].red, frames[variant(k)].green, to); }}};
}

std::vector<Kind> of_contact_region() {
  const auto options = pressed().options();
  static ContactRegion<> region(options.camera, 480, 640, options.contact);
  static Image<std::uint8_t> mask(480, 640);
  const auto depths_of = [](auto depth) {
    return made<Image<float>>([&](int k, test::Random& random) {
      Image<float> image(480, 640);
      for (Index i = 0; i < 480; ++i) {
        for (Index j = 0; j < 640; ++j) {
          image(i, j) = static_cast<float>(depth(k, i, j, random));
        }
      }
      return image;
    });
  };
  static const auto plain = depths_of([](int k, Index i, Index j, test::Random&) {
    return pressed()[static_cast<std::size_t>(k)].depth_mm(i, j);
  });
  static const auto noisy =
      depths_of([](int, Index, Index, test::Random& random) { return random.uniform(0, 14); });
  static const auto holes = depths_of([](int k, Index i, Index j, test::Random&) {
    return (i / 8 + j / 8) % 2 == 0 ? test::nan
                                    : pressed()[static_cast<std::size_t>(k)].depth_mm(i, j);
  });
  const auto call = [](const std::vector<Image<float>>& depths) {
    return [&](int k) { (void)region(depths[variant(k)], mask); };
  };
  return {{"a pressed pad", call(plain)},
          {"depths of noise", call(noisy)},
          {"holes like a chessboard", call(holes)}};
}

std::vector<Kind> of_gel(bool with_slide) {
  static const test::GelCamera camera{.rows = 480, .cols = 640, .mm_per_px = 0.04};
  static const auto usual = made<cv::Mat>([](int k, test::Random& random) {
    test::BallOnGel<> contact(test::GelPad{});
    contact.drag(0.5, {0.05 * k, 0.02 * k});
    return test::mat_of(camera.frame(contact, random));
  });
  static const auto noisy = made<cv::Mat>([](int, test::Random& random) {
    cv::Mat_<cv::Vec3b> frame(480, 640);
    for (cv::Vec3b& pixel : frame) {
      pixel = {static_cast<std::uint8_t>(random.whole(0, 255)),
               static_cast<std::uint8_t>(random.whole(0, 255)),
               static_cast<std::uint8_t>(random.whole(0, 255))};
    }
    return cv::Mat(frame);
  });
  static auto gel = [] {
    test::Random random(99);
    const test::BallOnGel<> nothing(test::GelPad{});
    return GelContact(std::vector{test::mat_of(camera.frame(nothing, random))});
  }();
  static const auto dots = made<test::GelDots>([](int k, test::Random& random) {
    test::BallOnGel<> contact(test::GelPad{});
    contact.drag(0.5, {0.05 * k, 0.02 * k});
    return camera.dots(contact, random);
  });
  static GelSlide slide(gel.mask().rows, gel.mask().cols, dots[0]);
  const auto call = [with_slide](const std::vector<cv::Mat>& frames) {
    return [&frames, with_slide](int k) {
      (void)gel(frames[variant(k)]);
      if (with_slide) {
        (void)slide(gel.imprint(), gel.mask(), dots[variant(k)]);
      }
    };
  };
  return {{"a ball on a gel", call(usual)}, {"an image of noise", call(noisy)}};
}

/// Dots of a dragged patch, the same with all dots in contact and strong noise, and random dots.
std::vector<Kind> of_stick_in_space() {
  static StickRatio<> ratio(21, 21, {.noise = 0.005});
  static const test::SlippingPatch patch;
  const auto moved = [](double lateral_mm, double step_mm) {
    return made<Image<Point3<double>>>([=](int k, test::Random& random) {
      auto dots = noisy(patch.dots, lateral_mm, 0.025, random);
      for (auto& dot : dots.cells) {
        dot.x += step_mm * k;
      }
      return dots;
    });
  };
  static const auto usual = moved(0.005, 0.05);
  static const auto shaken = moved(0.3, 0.05);
  static const auto anywhere = made<Image<Point3<double>>>(
      [](int, test::Random& random) { return scattered<Point3<double>>(21, 21, -15, 15, random); });
  static const Image<std::uint8_t> all(21, 21, 1);
  return {{"a patch that is dragged", [](int k) { (void)ratio(usual[variant(k)], patch.contact); }},
          {"all dots touch, each shaken by a fifth of a pitch",
           [](int k) { (void)ratio(shaken[variant(k)], all); }},
          {"dots anywhere", [](int k) { (void)ratio(anywhere[variant(k)], all); }}};
}

std::vector<Kind> of_stick_in_the_image() {
  static StickRatio<> ratio(21, 21);
  const auto moved = [](double shake_px) {
    return made<Image<Point2<double>>>([=](int k, test::Random& random) {
      Image<Point2<double>> dots(21, 21);
      for (Index i = 0; i < 21; ++i) {
        for (Index j = 0; j < 21; ++j) {
          dots(i, j) = {100 + 19.5 * static_cast<double>(j) + k + shake_px * random.normal(),
                        40 + 19.5 * static_cast<double>(i) + shake_px * random.normal()};
        }
      }
      return dots;
    });
  };
  static const auto usual = moved(0.06);
  static const auto shaken = moved(3);
  static const auto anywhere = made<Image<Point2<double>>>(
      [](int, test::Random& random) { return scattered<Point2<double>>(21, 21, 0, 600, random); });
  static const Image<std::uint8_t> all(21, 21, 1);
  const auto call = [](const std::vector<Image<Point2<double>>>& dots) {
    return [&](int k) { (void)ratio(dots[variant(k)], all); };
  };
  return {{"dots that are dragged", call(usual)},
          {"each shaken by a seventh of a pitch", call(shaken)},
          {"dots anywhere", call(anywhere)}};
}

std::vector<Kind> of_traction() {
  static TractionField field(test::stress_free_dots());
  static const auto drag = test::traction_scene("drag");
  static const auto usual = made<test::Dots>([](int, test::Random&) { return drag.dots; });
  static const auto shaken = made<test::Dots>([](int, test::Random& random) {
    auto dots = drag.dots;
    for (auto& dot : dots.cells) {
      dot.x = random.uniform() < 0.1 ? test::nan : dot.x + 0.3 * random.normal();
      dot.y += 0.3 * random.normal();
    }
    return dots;
  });
  const auto call = [](const std::vector<test::Dots>& dots) {
    return [&](int k) { (void)field(dots[variant(k)], drag.contact, drag.pressure_mpa); };
  };
  return {{"a dragged plate", call(usual)}, {"dots shaken, a tenth missing", call(shaken)}};
}

std::vector<Kind> of_taxels() {
  static TaxelFeatures<> finger(16, 4);
  static double time_s = 0;
  static const auto usual = made<Image<double>>([](int k, test::Random&) {
    Image<double> taxels(16, 4, 100);
    taxels(3, 2) = k % 4 < 2 ? 200 : 100;
    return taxels;
  });
  static const auto noisy = made<Image<double>>([](int, test::Random& random) {
    Image<double> taxels(16, 4);
    for (double& reading : taxels.cells) {
      reading = random.uniform(0, 4095);
    }
    return taxels;
  });
  const auto call = [](const std::vector<Image<double>>& taxels) {
    return [&](int k) { (void)finger(taxels[variant(k)], time_s += 1 / 30.0); };
  };
  return {{"one of 64 taxels vibrates", call(usual)}, {"readings of noise", call(noisy)}};
}

}  // namespace

int main(int argc, char** argv) {
  using bench::worst_case::Row;
  const bool counts = argc > 1 && std::string(argv[1]) == "count";
  if (!counts && argc != 3) {
    std::cerr << "worst_case count | worst_case CALLS INSTRUCTIONS\n";
    return 2;
  }
  const long calls = counts ? 0 : std::atol(argv[1]);
  std::ifstream dumps(counts ? "" : argv[2]);
  std::vector<Row> rows;
  const auto add = [&](const char* method, const std::vector<Kind>& kinds) {
    if (counts) {
      bench::worst_case::count_instructions(kinds, variants);
      return;
    }
    std::vector<double> instructions(kinds.size(), 0);
    for (double& of : instructions) {
      dumps >> of;
      of /= variants;
    }
    const double hardest_us = bench::worst_case::row_of(method, kinds, 0, instructions).hardest_us;
    const long affordable = static_cast<long>(6e7 / (std::max)(hardest_us, 1.0));
    rows.push_back(
        bench::worst_case::row_of(method, kinds, (std::min)(calls, affordable), instructions));
    std::cerr << method << '\n';
  };
  Fingertip lean(chain::lean(pressed().options())), by_default(pressed().options());
  add("whole chain, lean", of_chain(lean));
  add("whole chain, default", of_chain(by_default));
  add("depth, every pixel", of_depth());
  add("contact region, every pixel", of_contact_region());
  add("gel contact", of_gel(false));
  add("gel contact and slide", of_gel(true));
  add("stick ratio in the image, 441 dots", of_stick_in_the_image());
  add("stick ratio in space, 441 dots", of_stick_in_space());
  add("traction, 21 x 21 dots", of_traction());
  add("taxel features, 16 x 4", of_taxels());
  if (!counts) {
    if (!dumps) {
      std::cerr << "the file of instructions has too few lines\n";
      return 1;
    }
    bench::worst_case::print(std::cout, rows);
  }
  return 0;
}
