// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Mistakes with depth and contact, and the response to each.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/contact/surface.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/depth/intensity_depth.hpp"
#include "fingerpad/depth/neighbour_light.hpp"
#include "fingerpad/dots/spatial_dots.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"
#include "support/soap_film.hpp"

using namespace fingerpad;
using test::Image;
using test::Pad;
using test::refusal;
using Frame8 = test::Frame<std::uint8_t>;

namespace {

/// Inputs of a user for the reference.
struct Given {
  Pad pad;
  Image<double> depth_mm = pad.free_depths();
  Frame8 frame = pad.frame<std::uint8_t>(depth_mm, 1, 3);
};

std::string said_of(const Given& given) {
  return refusal([&] {
    const auto reference = fit_reference(given.pad.camera, given.pad.fluid, given.frame.red,
                                         given.frame.green, given.depth_mm);
    const DepthEstimator<> estimator(given.pad.camera, given.pad.fluid, reference);
  });
}

template <class Change>
void each_pixel(Given& given, const Change& change) {
  for (Index i = 0; i < given.pad.rows; ++i) {
    for (Index j = 0; j < given.pad.cols; ++j) {
      change(i, j, given.depth_mm(i, j));
    }
  }
}

/// Rows read one after the other with a stride that is wrong by `px`.
Frame8 sheared(const Frame8& frame, Index px) {
  Frame8 out = frame;
  const Index cols = frame.red.cols();
  for (Index k = 0; k < frame.red.rows() * cols; ++k) {
    const auto from = static_cast<std::size_t>((std::max)(k - k / cols * px, Index(0)));
    out.red.cells[static_cast<std::size_t>(k)] = frame.red.cells[from];
    out.green.cells[static_cast<std::size_t>(k)] = frame.green.cells[from];
  }
  return out;
}

Frame8 times(Frame8 frame, double factor) {
  for (auto* channel : {&frame.red, &frame.green}) {
    for (std::uint8_t& cell : channel->cells) {
      cell = static_cast<std::uint8_t>((std::min)(factor * cell, 255.0));
    }
  }
  return frame;
}

struct Mistake {
  const char* what;
  void (*make)(Given&);
  const char* said;  ///< part of the response
};

constexpr const char* exchanged = "are red and green exchanged";

const Mistake with_the_reference[] = {
    {"none", [](Given&) {}, "accepted"},
    {"red and green exchanged", [](Given& g) { std::swap(g.frame.red, g.frame.green); }, exchanged},
    {"free shape in metres",
     [](Given& g) { each_pixel(g, [](Index, Index, double& l) { l /= 1000; }); }, "not m"},
    {"free shape in micrometres",
     [](Given& g) { each_pixel(g, [](Index, Index, double& l) { l *= 1000; }); }, "give mm"},
    {"max_depth_mm smaller than the pad", [](Given& g) { g.pad.fluid.max_depth_mm = 9; },
     "raise max_depth_mm"},
    {"center of another crop", [](Given& g) { g.pad.camera.center_x_px += 10; },
     "center_x_px, center_y_px are not those of this image"},
    {"shape 0 outside of the pad",
     [](Given& g) { each_pixel(g, [](Index, Index, double& l) { l = l == l ? l : 0; }); },
     "depth_mm must be NaN outside of the pad"},
    {"shape in plan, not along rays",
     [](Given& g) {
       each_pixel(g, [&](Index i, Index j, double& l) {
         const auto& c = g.pad.camera;
         const double x = (static_cast<double>(j) - c.center_x_px) * c.pitch_mm;
         const double y = (static_cast<double>(i) - c.center_y_px) * c.pitch_mm;
         const double r = g.pad.sphere_radius_mm;
         const double height = std::sqrt(r * r - x * x - y * y) - (r - g.pad.height_mm);
         l = height > 0 ? height : test::nan;
       });
     },
     "its height along each pixel's ray"},
    {"shape as indentation",
     [](Given& g) { each_pixel(g, [](Index, Index, double& l) { l = 13 - l; }); },
     "is depth_mm the height of the free pad"},
    {"a pressed frame for the reference",
     [](Given& g) { g.frame = g.pad.frame<std::uint8_t>(g.pad.pressed_depths(3), 1, 3); },
     "is the reference of the free pad?"},
    {"constants of another fluid", [](Given& g) { g.pad.fluid.c_green_per_mm = 0.1; },
     "are the constants of absorption those of this fluid"},
    {"plain grey", [](Given& g) { g.frame = Frame8(g.pad.rows, g.pad.cols, 128); }, exchanged},
    {"noise",
     [](Given& g) {
       test::Random random(3);
       for (auto* channel : {&g.frame.red, &g.frame.green}) {
         for (std::uint8_t& cell : channel->cells) {
           cell = static_cast<std::uint8_t>(random.whole(1, 254));
         }
       }
     },
     "fit_reference: "},
    {"row stride without padding", [](Given& g) { g.frame = sheared(g.frame, 5); },
     "is the frame one of the free pad"},
};

/// A camera with a realistic resolution of the pad, and frames under another light.
Pad fine_pad() {
  return test::pad_of(240, 320, 0.16);
}

struct FrameMistake {
  const char* what;
  Frame8 (*make)(const Frame8&);
  FrameStatus said;
};

const FrameMistake with_a_frame[] = {
    {"none", [](const Frame8& f) { return f; }, FrameStatus::ok},
    {"lamp 10 % darker", [](const Frame8& f) { return times(f, 0.9); },
     FrameStatus::not_of_this_pad},
    {"lamp 10 % brighter", [](const Frame8& f) { return times(f, 1.1); },
     FrameStatus::not_of_this_pad},
    {"lamp off", [](const Frame8& f) { return times(f, 0); }, FrameStatus::not_of_this_pad},
    {"lens saturated", [](const Frame8& f) { return times(f, 9); }, FrameStatus::not_of_this_pad},
    {"row stride without padding", [](const Frame8& f) { return sheared(f, 5); },
     FrameStatus::not_of_this_pad},
    {"red and green exchanged",
     [](const Frame8& f) {
       Frame8 out = f;
       std::swap(out.red, out.green);
       return out;
     },
     FrameStatus::not_of_this_pad},
    {"no depth but near the rim",
     [](const Frame8& f) {
       Frame8 out = f;
       for (Index i = 0; i < 240; ++i) {
         for (Index j = 0; j < 320; ++j) {
           const double px =
               std::hypot(static_cast<double>(i) - 119.5, static_cast<double>(j) - 159.5);
           out.red(i, j) = static_cast<std::uint8_t>(f.red(i, j) / (px > 95 ? 1 : 2));
         }
       }
       return out;
     },
     FrameStatus::not_of_this_pad},
    {"a frame of another size", [](const Frame8&) { return Frame8(240, 319, 60); },
     FrameStatus::refused},
};

}  // namespace

TEST_CASE("mistakes with the reference are refused with their likely cause", "[mistakes]") {
  for (const Mistake& mistake : with_the_reference) {
    Given given;
    mistake.make(given);
    const std::string said = said_of(given);
    CAPTURE(mistake.what, said);
    CHECK(said.find(mistake.said) != std::string::npos);
  }
}

TEST_CASE("a free shape is refused where more than half of its middle lies too deep",
          "[mistakes]") {
  for (const double share : {0.35, 0.65}) {
    Given given;
    // the share of the pad's middle, a disc of a quarter of its radius, that lies outside of r
    const auto& c = given.pad.camera;
    const double middle_mm = given.pad.base_radius_mm() / 4,
                 r_mm = middle_mm * std::sqrt(1 - share);
    each_pixel(given, [&](Index i, Index j, double& l) {
      const double x = (static_cast<double>(j) - c.center_x_px) * c.pitch_mm;
      const double y = (static_cast<double>(i) - c.center_y_px) * c.pitch_mm;
      l = std::hypot(x, y) > r_mm && std::hypot(x, y) < 1.2 * middle_mm
              ? 1.01 * given.pad.fluid.max_depth_mm
              : l;
    });
    CAPTURE(share);
    const bool is_too_deep = said_of(given).find("raise max_depth_mm") != std::string::npos;
    CHECK(is_too_deep == (share > 0.5));
  }
}

TEST_CASE("a frame that is not of this pad and lamp is told", "[mistakes]") {
  const Pad pad = fine_pad();
  auto estimator = pad.estimator<float>();
  Image<float> depth(pad.rows, pad.cols);
  for (const double pressed_mm : {0.0, 3.0}) {
    const auto frame = pad.frame<std::uint8_t>(pad.pressed_depths(pressed_mm), 1, 5);
    for (const FrameMistake& mistake : with_a_frame) {
      const auto seen = mistake.make(frame);
      const DepthResult result = estimator(seen.red, seen.green, depth);
      CAPTURE(mistake.what, pressed_mm);
      CHECK(name_of(result.status) == std::string(name_of(mistake.said)));
    }
  }
}

TEST_CASE("a membrane that has aged: depths are those of the fluid", "[mistakes]") {
  // half a millimetre higher on the same base, and lower
  const Pad pad = fine_pad();
  auto estimator = pad.estimator<float>();
  const auto mean_error_mm = [&](double higher_mm) {
    Pad aged = pad;
    aged.height_mm += higher_mm;
    aged.sphere_radius_mm =
        (std::pow(pad.base_radius_mm(), 2) + std::pow(aged.height_mm, 2)) / (2 * aged.height_mm);
    const auto truth = aged.pressed_depths(3);
    const auto seen = test::estimate(estimator, aged.frame<std::uint8_t>(truth, 1, 5));
    CHECK(seen.result.ok());
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < truth.cells.size(); ++k) {
      const double off = std::abs(static_cast<double>(seen.depth_mm.cells[k]) - truth.cells[k]);
      sum += off == off ? off : 0;
      count += off == off ? 1 : 0;
    }
    return sum / count;
  };
  // the light at each depth differs: the error is a tenth larger, and no more
  const double as_new = mean_error_mm(0);
  CHECK(mean_error_mm(0.5) / as_new == Approx(1.1).margin(0.05));
  CHECK(mean_error_mm(-0.5) / as_new == Approx(1.1).margin(0.05));
}

TEST_CASE("a pad that is dark on one side is not one of another light", "[mistakes]") {
  const Pad pad = fine_pad();
  auto estimator = pad.estimator<float>();
  Image<float> depth(pad.rows, pad.cols);
  auto dark = pad.frame<std::uint8_t>(pad.pressed_depths(2), 1, 5);
  for (Index i = 0; i < 70; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      dark.green(i, j) = 0;
    }
  }
  CHECK(estimator(dark.red, dark.green, depth).status == FrameStatus::ok);
}

TEST_CASE("a depth that is ok lies in [0, max_depth_mm]", "[mistakes][figures]") {
  // absorption constants and references at the limits of acceptance, with colours of all kinds
  test::Random random(11);
  for (int k = 0; k < 40; ++k) {
    Pad pad;
    pad.fluid.c_green_per_mm = random.uniform(0.029, 0.1);
    pad.fluid.kappa = random.uniform(0.5, 1.5);
    pad.scattering = random.uniform(-0.01, 0.05);
    pad.scattering_loss = random.uniform(-0.5, 0.5);
    Image<float> depth(pad.rows, pad.cols);
    Image<PixelStatus> status(pad.rows, pad.cols);
    Frame8 frame(pad.rows, pad.cols);
    for (auto* channel : {&frame.red, &frame.green}) {
      for (std::uint8_t& cell : channel->cells) {
        cell = static_cast<std::uint8_t>(random.whole(0, 255));
      }
    }
    const auto check = [&](auto estimator) {
      (void)estimator(frame.red, frame.green, depth, status);
      for (std::size_t p = 0; p < depth.cells.size(); ++p) {
        const auto l = static_cast<double>(depth.cells[p]);
        const bool within = l >= 0 && l <= pad.fluid.max_depth_mm;
        REQUIRE(within == (status.cells[p] == PixelStatus::ok));
      }
    };
    for (const int window_px : {1, 5}) {
      (void)refusal([&] { check(pad.estimator<float>({.window_px = window_px})); });
      (void)refusal([&] { check(pad.estimator<double>({.window_px = window_px})); });
    }
  }
}

TEST_CASE("a bad pixel of the reference spoils no other", "[mistakes]") {
  const Pad pad = fine_pad();
  const auto pressed = pad.frame<std::uint8_t>(pad.pressed_depths(3), 1, 4);
  auto good = pad.reference<float>();
  good.red_gain.assign(good.depth_mm.size(), 1.0F);
  const auto depth_with = [&](const DepthReference<float>& reference) {
    DepthEstimator<> estimator(pad.camera, pad.fluid, reference);
    return test::estimate(estimator, pressed).depth_mm;
  };
  const auto before = depth_with(good);
  using Plane = std::vector<float> DepthReference<float>::*;
  for (const Plane plane : {&DepthReference<float>::depth_mm, &DepthReference<float>::scattering,
                            &DepthReference<float>::red_gain}) {
    for (const Index size : {1, 9}) {
      auto spoilt = good;
      for (Index i = 0; i < size; ++i) {
        for (Index j = 0; j < size; ++j) {
          (spoilt.*plane)[static_cast<std::size_t>((100 + i) * pad.cols + 150 + j)] =
              not_a_number<float>();
        }
      }
      const auto after = depth_with(spoilt);
      double worst = 0;
      for (std::size_t k = 0; k < after.cells.size(); ++k) {
        const double change = std::abs(static_cast<double>(after.cells[k] - before.cells[k]));
        worst = change > worst ? change : worst;
      }
      CAPTURE(size, worst);
      // the effect of the pixels that the window has lost, and no more
      CHECK(worst < (size == 1 ? 0.02 : 0.15));
      CHECK(std::isnan(after(100, 150)));
      CHECK(is_finite(after(100, 150 + size)));
    }
  }
}

TEST_CASE("wild finite depths move no contact and make no negative area", "[mistakes]") {
  const auto check = [](const auto& camera) {
    const auto depth = test::depths_of<float>(camera, test::RoundFilm({}), 60, 64);
    ContactTest contact_test;
    contact_test.ring_px = 5;
    ContactRegion<> region(camera, 60, 64, contact_test);
    Image<std::uint8_t> mask(60, 64), clean(60, 64);
    const ContactResult before = region(depth, clean);
    for (const double wild : {30.0, 60.0, 99.0, 101.0, 300.0, 2000.0, 5000.0, 1e6, 1e30}) {
      for (const double sign : {1.0, -1.0}) {
        auto spoilt = depth;
        spoilt(30, 32) = static_cast<float>(sign * wild);
        const ContactResult after = region(spoilt, mask);
        const auto flat = fit_surface(camera, spoilt, clean);
        CAPTURE(sign * wild, after.depth_mm, before.depth_mm, after.area_mm2, before.area_mm2);
        // below 100 mm it may be a depth: it counts as one pixel of some thousand
        const double most = wild < 100 ? 0.12 : 1e-4;
        CHECK(std::abs(after.depth_mm - before.depth_mm) < most);
        CHECK(after.area_mm2 == Approx(before.area_mm2).epsilon(0.01));
        CHECK(flat.ok());
        CHECK((wild < 100 || flat.normal.z > 0.999));
      }
    }
  };
  check(test::height_map(60, 64, 0.32));
  check(test::pad_camera(60, 64, 0.32));
}

TEST_CASE("wild finite depths make no dot in space", "[mistakes]") {
  const Camera<double> camera = test::pad_camera(60, 64, 0.32);
  Image<double> depth(60, 64, 9.0);
  const Image<Point2<double>> dots(1, 1, {32, 30});
  Image<Point3<double>> places(1, 1);
  for (const double wild : {101.0, -101.0, 5000.0, -5000.0, 1e30}) {
    for (Index j = 31; j < 34; ++j) {
      depth(30, j) = wild;
    }
    CAPTURE(wild);
    CHECK(spatial_dots(camera, dots, depth, places) == 0);
  }
}

TEST_CASE("images larger than any are refused by name", "[mistakes]") {
  const auto said = [](Index rows, Index cols) {
    const LazyView image(rows, cols, [](Index, Index) { return 100.0; });
    return std::array{
        refusal([&] { ContactRegion<> r({}, rows, cols); }),
        refusal([&] { const CurvatureMap<> r({}, rows, cols); }),
        refusal([&] { (void)fit_reference(Camera<>{}, Absorption<>{}, image, image, image); }),
        refusal([&] { const NeighbourLightCompensation<> r({5}, 0.1F, image); }),
        refusal([&] { const IntensityDepth<> r(image, {}); }),
        refusal([&] { (void)fit_contact_threshold(Camera<>{}, std::array{image}); }),
    };
  };
  const auto enormous = std::numeric_limits<Index>::max();
  for (const auto& [rows, cols, what] : {std::tuple<Index, Index, const char*>{-1, 60, "rows = -1"},
                                         {enormous, 60, "rows = "},
                                         {60, enormous, "cols = "},
                                         {enormous, enormous, "rows = "},
                                         {1000000, 1000000, "rows times cols = 1000000000000"}}) {
    for (const std::string& message : said(rows, cols)) {
      CAPTURE(message);
      CHECK(message.find(what) != std::string::npos);
    }
  }
}
