// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Mistakes in the calibration of a sensor, and the response to each: the name of a status, or the
// message with which the samples are refused. "ok" means that the mistake cannot be detected, with
// the reason.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/calibrate/depth.hpp"
#include "fingerpad/calibrate/foam.hpp"
#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/calibrate/rim.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::Image;
using test::Random;

namespace {

/// Response of a fit: the its likely mistake, or the message of its refusal.
template <class Fit>
std::string said(const Fit& fit) {
  std::string status;
  const std::string refused = test::refusal([&] { status = text_of(fit()); });
  return refused == "accepted" ? status : refused;
}

struct Mistake {
  const char* name;
  std::function<std::string()> says;
  const char* expected;  ///< part of the response
};

void check(const std::vector<Mistake>& mistakes) {
  for (const Mistake& mistake : mistakes) {
    const std::string says = mistake.says();
    INFO(mistake.name << ": " << says);
    CHECK(says.find(mistake.expected) != std::string::npos);
  }
}

// ---- forces

using Forces = std::vector<ForceSample<double>>;

/// A press of twelve loads, and a drag and a twist at three depths, as a gauge and a camera measure
/// them.
Forces forces(std::uint64_t seed = 1) {
  Random random(seed);
  Forces samples;
  for (int k = 0; k < 60; ++k) {
    ForceSample<double> s;
    s.measure = 0.5 + 0.4 * (k % 12);
    const double angle = 0.7 * k, length = 0.1 * (k % 7), u = std::pow(s.measure / 2, 0.7);
    s.displacement_mm = {length * std::cos(angle), length * std::sin(angle)};
    s.rotation_rad = 0.02 * (k % 9 - 4);
    s.normal_force_n = 0.55 * s.measure + 0.6 * s.measure * s.measure + 0.02 * random.normal();
    s.tangential_force_n = {2 * u * s.displacement_mm.x + 0.01 * random.normal(),
                            2 * u * s.displacement_mm.y + 0.01 * random.normal()};
    s.moment_n_mm = 150 * u * s.rotation_rad + 0.05 * random.normal();
    s.load = k % 12;
    samples.push_back(s);
  }
  return samples;
}

using Change = std::function<void(ForceSample<double>&)>;

Forces changed(const Change& change) {
  Forces samples = forces();
  for (ForceSample<double>& s : samples) {
    change(s);
  }
  return samples;
}

std::function<std::string()> normal(const Change& change) {
  return [=] {
    const Forces samples = changed(change);
    return said([&] { return fit_normal_force(std::span<const ForceSample<double>>(samples)); });
  };
}
std::function<std::string()> tangential(const Change& change) {
  return [=] {
    const Forces samples = changed(change);
    return said(
        [&] { return fit_tangential_force(std::span<const ForceSample<double>>(samples), 2); });
  };
}
std::function<std::string()> moment(const Change& change) {
  return [=] {
    const Forces samples = changed(change);
    return said([&] { return fit_moment(std::span<const ForceSample<double>>(samples), 2); });
  };
}

void rotate(Point2<double>& p, double angle) {
  p = {p.x * std::cos(angle) - p.y * std::sin(angle),
       p.x * std::sin(angle) + p.y * std::cos(angle)};
}

/// Forces unrelated to the contact.
Change any_force() {
  return [random = Random(7)](ForceSample<double>& s) mutable {
    s.normal_force_n = 10 * random.uniform();
    s.tangential_force_n = {random.normal(), random.normal()};
    s.moment_n_mm = random.normal();
  };
}

// ---- depth

using Colours = std::vector<DepthSample<double>>;

Colours colours() {
  const Camera<double> camera;
  const Absorption<double> fluid;
  Random random(2);
  Colours samples;
  for (int k = 0; k < 20; ++k) {
    auto s = depth_sample(camera, 239.5, 319.5 + 10 * (k % 5), 0.3 + 0.6 * k, Colour<double>{});
    s.colour = colour_at_depth(fluid, s.ray, 57.0, 0.0163, s.depth_mm);
    s.colour.red += 0.03 * random.normal();
    s.colour.green += 0.03 * random.normal();
    samples.push_back(s);
  }
  return samples;
}

template <int Degree = 0>
std::function<std::string()> absorption(const std::function<void(Colours&)>& change) {
  return [=] {
    Colours samples = colours();
    change(samples);
    return said(
        [&] { return fit_absorption<Degree>(std::span<const DepthSample<double>>(samples)); });
  };
}

/// Some are refused, some are fitted; none is reliable.
std::string random_colours() {
  std::string unexplained;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::string says = absorption([random = Random(seed)](Colours& samples) mutable {
      for (auto& s : samples) {
        s.colour = {20 + 100 * random.uniform(), 20 + 100 * random.uniform()};
      }
    })();
    if (says == "ok") {
      return says;
    }
    unexplained = test::begins_with(says, "fit_absorption") ? unexplained : says;
  }
  return unexplained;
}

}  // namespace

TEST_CASE("mistakes: forces by look-up", "[mistakes]") {
  check({
      {"none", normal([](auto&) {}), "ok"},
      {"none", tangential([](auto&) {}), "ok"},
      {"none", moment([](auto&) {}), "ok"},
      {"random forces", normal(any_force()), "contradict each other"},
      {"random forces", tangential(any_force()), "contradict each other"},
      {"random forces", moment(any_force()), "they are too few, too alike or tied to each other"},
      {"forces along x and y exchanged",
       tangential([](auto& s) { std::swap(s.tangential_force_n.x, s.tangential_force_n.y); }),
       "check whether x and y are exchanged"},
      {"one axis reversed", tangential([](auto& s) { s.tangential_force_n.x *= -1; }),
       "or one is reversed"},
      {"force on the object, not on the pad", tangential([](auto& s) {
         s.tangential_force_n = {-s.tangential_force_n.x, -s.tangential_force_n.y};
       }),
       "check the sign of each axis"},
      {"moment on the object", moment([](auto& s) { s.moment_n_mm *= -1; }),
       "check the sign of each axis"},
      {"normal force negative, as a wrench has it", normal([](auto& s) { s.normal_force_n *= -1; }),
       "the force falls while the contact grows"},
      {"normal force and measure exchanged",
       normal([](auto& s) { std::swap(s.normal_force_n, s.measure); }), "tare the gauge"},
      {"gauge not tared", normal([](auto& s) { s.normal_force_n += 6; }), "tare the gauge"},
      {"gauge not tared", tangential([](auto& s) { s.tangential_force_n.y += 0.9; }),
       "tare the gauge"},
      {"gauge not tared", moment([](auto& s) { s.moment_n_mm += 9; }), "tare the gauge"},
      {"gauge rotated by 15 degrees",
       tangential([](auto& s) { rotate(s.tangential_force_n, 0.26); }),
       "align the gauge with the image"},
      {"gauge rotated by 30 degrees",
       tangential([](auto& s) { rotate(s.tangential_force_n, 0.52); }),
       "align the gauge with the image"},
      {"gauge rotated by 90 degrees",
       tangential([](auto& s) { rotate(s.tangential_force_n, 1.57); }),
       "align the gauge with the image (rotated by 90 +- 2 degrees)"},
      {"area in m^2", normal([](auto& s) { s.measure *= 1e-6; }), "areas in mm^2"},
      {"depth in m", normal([](auto& s) { s.measure *= 1e-3; }), "depths and radii in mm"},
      {"area in um^2", normal([](auto& s) { s.measure *= 1e6; }), "areas in mm^2"},
      {"depth in um",  // as plausible as an area; a looked-up force is then "below range"
       normal([](auto& s) { s.measure *= 1e3; }), "ok"},
      {"forces in mN", normal([](auto& s) { s.normal_force_n *= 1e3; }), "give forces in N"},
      {"forces in kN", normal([](auto& s) { s.normal_force_n *= 1e-3; }), "give forces in N"},
      {"forces in mN",
       tangential([](auto& s) { s.tangential_force_n = 1e3 * s.tangential_force_n; }),
       "give forces in N"},
      {"forces in kN",
       tangential([](auto& s) { s.tangential_force_n = 1e-3 * s.tangential_force_n; }),
       "give forces in N"},
      {"forces times 1e300", normal([](auto& s) { s.normal_force_n *= 1e300; }),
       "a force is far too large"},
      {"moment in N um", moment([](auto& s) { s.moment_n_mm *= 1e3; }), "give moments in N mm"},
      {"displacement in um",
       tangential([](auto& s) { s.displacement_mm = 1e3 * s.displacement_mm; }),
       "give displacements in mm"},
      {"displacement in m", tangential([](auto& s) {
         s.displacement_mm = {s.displacement_mm.x / 1000, s.displacement_mm.y / 1000};
       }),
       "no displacement reaches 0.01"},
      {"rotation in degrees", moment([](auto& s) { s.rotation_rad *= 57.3; }),
       "give rotations in rad"},
      {"moment in N m", moment([](auto& s) { s.moment_n_mm /= 1000; }), "give moments in N mm"},
      {"a bumped gauge",
       normal([k = 0](auto& s) mutable { s.normal_force_n += k++ == 30 ? 3 : 0; }),
       "check its dots and its gauge reading"},
      {"a gauge that reads 1e300 once", normal([k = 0](auto& s) mutable {
         s.normal_force_n = k++ == 30 ? 1e300 : s.normal_force_n;
       }),
       "a force is far too large"},
      {"a contact of 1e300 once",
       normal([k = 0](auto& s) mutable { s.measure = k++ == 30 ? 1e300 : s.measure; }),
       "too few, too alike or tied"},
      {"dots lost as 1e30 once", tangential([k = 0](auto& s) mutable {
         s.displacement_mm.x = k++ == 30 ? 1e30 : s.displacement_mm.x;
       }),
       "too few, too alike or tied"},
      {"one load alone", normal([](auto& s) { s.measure = 2; }), "must be > the smallest"},
      {"shifted by one", tangential([before = Point2<double>{0, 0}](auto& s) mutable {
         std::swap(before, s.tangential_force_n);
       }),
       "contradict each other"},
      {"stuck gauge", normal([](auto& s) { s.normal_force_n = 4; }), "tare the gauge"},
      {"nothing measured", normal([](auto& s) { s.normal_force_n = test::nan; }),
       "usable samples = 0"},
  });
}

TEST_CASE("mistakes: by how much a gauge is turned", "[mistakes]") {
  const auto fitted = [](std::uint64_t seed, double turned_rad, const Change& change) {
    Forces samples = forces(seed);
    Random random(seed + 1000);
    for (auto& s : samples) {
      change(s);
      s.tangential_force_n.x += 0.1 * random.normal();
      s.tangential_force_n.y += 0.1 * random.normal();
      rotate(s.tangential_force_n, turned_rad);
    }
    return fit_tangential_force(std::span<const ForceSample<double>>(samples), 2, 0.7);
  };
  const auto as_it_is = [](auto&) {};
  // the standard error holds at any angle
  for (const double turned_rad : {0.0, 0.3, -0.52}) {
    double ratio_sq = 0;
    constexpr int fits = 200;
    for (std::uint64_t seed = 1; seed <= fits; ++seed) {
      const auto fit = fitted(seed, turned_rad, as_it_is);
      ratio_sq += std::pow((fit.gauge_angle_rad - turned_rad) / fit.gauge_angle_sd_rad, 2);
      CHECK(std::abs(fit.gauge_angle_rad - turned_rad) < 0.1);
    }
    CHECK(std::sqrt(ratio_sq / fits) == Approx(1).margin(4 / std::sqrt(2.0 * fits)));
  }
  // a pad twice as stiff along one of its axes is not rotated
  const auto stiffer = fitted(1, 0, [](auto& s) {
    const double askew = s.tangential_force_n.x + s.tangential_force_n.y;
    s.tangential_force_n = s.tangential_force_n + 0.2 * Point2<double>{askew, askew};
  });
  CHECK(std::abs(stiffer.gauge_angle_rad) < 4 * stiffer.gauge_angle_sd_rad);
  // along one line it would look the same
  const auto line = [](auto& s) {
    s.tangential_force_n = {s.tangential_force_n.x, 0};
    s.displacement_mm = {s.displacement_mm.x, 0};
  };
  CHECK(std::isnan(fitted(1, 0.3, line).gauge_angle_rad));
  CHECK(fitted(1, 0.3, line).cause == std::string(cause::gauge_rotated));
  const std::string said = test::refusal([&] { (void)fitted(1, 1.5, line); });
  CHECK(test::begins_with(said, "fit_tangential_force: usable samples = 60, must be such that"));
  CHECK(said.find("rotated by") == std::string::npos);
}

TEST_CASE("mistakes: the fluid", "[mistakes]") {
  check({
      {"none", absorption([](Colours&) {}), "ok"},
      {"random colours", random_colours, "the colours do not follow from the depths"},
      {"depths of another order", absorption([](Colours& samples) {
         for (std::size_t k = 0; k < samples.size(); ++k) {
           samples[k].depth_mm = 0.3 + 0.6 * static_cast<double>(7 * k % 20);
         }
       }),
       "the colours do not follow from the depths"},
      {"depths in m", absorption([](Colours& samples) {
         for (auto& s : samples) {
           s.depth_mm /= 1000;
         }
       }),
       "in mm"},
      {"red and green exchanged", absorption([](Colours& samples) {
         for (auto& s : samples) {
           std::swap(s.colour.red, s.colour.green);
         }
       }),
       "check whether red and green are exchanged"},
      {"g negative at the rim", absorption<1>([](Colours& samples) {
         for (std::size_t k = 0; k < samples.size(); ++k) {
           auto& s = samples[k];
           s = depth_sample(Camera<double>{}, 239.5 + 10 * static_cast<double>(k % 3),
                            319.5 + 10 * static_cast<double>(k % 5), s.depth_mm, s.colour);
           const double g = 0.0163 * (1 - 0.4 * s.plate_mm.x);
           s.colour = colour_at_depth(Absorption<double>{}, s.ray, 57.0, g, s.depth_mm);
         }
       }),
       "g is not positive everywhere"},
      {"four samples", absorption([](Colours& samples) {
         samples = {samples[0], samples[6], samples[12], samples[19]};
       }),
       "so the fit cannot be checked"},
      {"one depth", absorption([](Colours& samples) {
         for (auto& s : samples) {
           s.depth_mm = 4;
         }
       }),
       "number of distinct depths = 1"},
      {"colour NaN", absorption([](Colours& samples) { samples[3].colour.red = test::nan; }),
       "colour.red = "},
      {"saturated", absorption([](Colours& samples) {
         for (auto& s : samples) {
           s.colour = {255, 255};
         }
       }),
       "colours must change with the depth"},
  });
}

namespace {

// ---- frames

/// Readings of 6 x 4 taxels at rest, every 30th of a second or every `period_s`.
std::function<std::string()> resting(const std::function<double(double, Index, Index)>& reading,
                                     double period_s = 1.0 / 30) {
  return [=] {
    return said([&] {
      Random random(5);
      TaxelNoiseCalibration calibration(6, 4);
      Image<double> taxels(6, 4);
      for (Index k = 0; k < 600; ++k) {
        for (Index i = 0; i < 24; ++i) {
          taxels(i / 4, i % 4) = reading(500 + 2 * random.normal(), i, k);
        }
        calibration.add(taxels, period_s * static_cast<double>(k));
      }
      return calibration.fit();
    });
  };
}

/// Depth maps of a free pad, a cap of 40 mm radius with 1 um of noise; `scale` is that of the unit.
std::function<std::string()> free_pad(double scale, double share_seen, double noise_mm = 0.001) {
  return [=] {
    return said([&] {
      Random random(6);
      OrthographicCamera<double> camera;
      camera.pitch_mm = 0.16;
      std::vector<Image<double>> frames;
      for (int t = 0; t < 4; ++t) {
        Image<double> depth(60, 80);
        for (Index i = 0; i < 60; ++i) {
          for (Index j = 0; j < 80; ++j) {
            const double x = 0.16 * static_cast<double>(j - 40);
            const double y = 0.16 * static_cast<double>(i - 30);
            const double l = std::sqrt(1600 - x * x - y * y) - 28 + noise_mm * random.normal();
            depth(i, j) = static_cast<double>(i) < 60 * share_seen ? scale * l : test::nan;
          }
        }
        frames.push_back(depth);
      }
      return fit_contact_threshold(camera, frames, 8);
    });
  };
}

/// Apex heights of a free pad at four pressures, with factors on what is given.
std::function<std::string()> rim(double pressure,
                                 double apex,
                                 double radius = 18.735,
                                 std::size_t levels = 4,
                                 double one_pressure = 1) {
  return [=] {
    return said([&] {
      std::vector<FreeApex> apexes;
      for (std::size_t k = 0; k < levels; ++k) {
        const double mpa = 0.008 + 0.004 * static_cast<double>(k);
        const double height_mm = FreePad<double>({18.735, 11}).rim(mpa / 0.5)->apex_mm;
        apexes.push_back({mpa * pressure * (k == 1 ? one_pressure : 1), height_mm * apex});
      }
      return fit_rim({radius, 11}, apexes);
    });
  };
}

}  // namespace

TEST_CASE("mistakes: noise of the taxels", "[mistakes]") {
  check({
      {"none", resting([](double r, Index, Index) { return r; }), "ok"},
      {"a dead array", resting([](double, Index, Index) { return 0.0; }),
       "taxels whose readings change = 0"},
      {"most readings at full scale",  // looks like rest without noise
       resting([](double r, Index i, Index) { return i < 20 ? 4095.0 : r; }), "ok"},
      {"most readings missing",
       resting([](double r, Index i, Index) { return i < 20 ? test::nan : r; }), "in range"},
      {"one dead taxel", resting([](double r, Index i, Index) { return i == 3 ? test::nan : r; }),
       "ok"},
      {"a taxel that reads 1e300",
       resting([](double r, Index i, Index) { return i == 3 ? 1e300 : r; }), "ok"},
      {"time in ms", resting([](double r, Index, Index) { return r; }, 1000.0 / 30), "windows = "},
      {"time stands still", resting([](double r, Index, Index) { return r; }, 0), "windows = 0"},
  });
}

TEST_CASE("mistakes: threshold of the contact", "[mistakes]") {
  check({
      {"none", free_pad(1, 1), "ok"},
      {"depths in m", free_pad(1e-3, 1), "give depths in mm"},
      {"no depth at all", free_pad(1, 0), "pixels = 0"},
      {"height for depth", free_pad(-1, 1), "bulges too little"},
      // no free frame seems touched; how deep a dent must be to be seen, `calibrate contact` tells
      {"no smoothing", free_pad(1, 1, 0.2), "ok"},
  });
}

TEST_CASE("mistakes: the rim", "[mistakes]") {
  check({
      {"none", rim(1, 1), "ok"},
      {"one of four pressures absolute", rim(1, 1, 18.735, 4, 1 + 0.1 / 0.012), "inflated cap"},
      {"one of four pressures of another frame", rim(1, 1, 18.735, 4, 1.4), "inflated cap"},
      {"apex in m", rim(1, 1e-3), "must be"},
      {"apex in um", rim(1, 1e3), "must be"},
      {"z into the plate", rim(1, -1), "must be"},
      {"diameter for the radius", rim(1, 1, 2 * 18.735), "inflated cap"},
      {"one pressure alone", rim(1, 1, 18.735, 1), "hardly differ"},
      {"no pressure", rim(0, 1), "must be"},
      // the modulus is in the unit of the pressure
      {"pressure in kPa", rim(1e3, 1), "ok"},
  });
}
