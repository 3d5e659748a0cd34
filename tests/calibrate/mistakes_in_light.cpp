// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Mistakes in the recordings for the calibration of light and of pre-slip, and the response to
// each: a status, the message of a refusal, "right", or "wrong". docs/mistakes.md has the reason of
// each "wrong".
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "fingerpad/calibrate/intensity.hpp"
#include "fingerpad/calibrate/neighbour_light.hpp"
#include "fingerpad/core/dots.hpp"
#include "support/catch.hpp"
#include "support/mistakes.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::check;
using test::Image;
using test::Mistake;
using test::Random;

namespace {

using Pixels = Image<double>;

/// Cell (i, j) of the result is the one at from(i, j), wrapped around at the edges.
template <class From>
Pixels rearranged(const Pixels& image, const From& from) {
  Pixels out = image;
  const Index rows = image.rows(), cols = image.cols();
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const DotIndex at = from(i, j);
      out(i, j) = image((at.row + rows) % rows, (at.col + cols) % cols);
    }
  }
  return out;
}
Pixels transposed(const Pixels& image) {
  return rearranged(image, [](Index i, Index j) { return DotIndex{j, i}; });
}
Pixels mirrored(const Pixels& image) {
  return rearranged(image, [&](Index i, Index j) { return DotIndex{i, image.cols() - 1 - j}; });
}
Pixels sheared(const Pixels& image) {
  return rearranged(image, [](Index i, Index j) { return DotIndex{i, i + j}; });
}
Pixels times(Pixels image, double factor) {
  for (double& level : image.cells) {
    level *= factor;
  }
  return image;
}
Pixels half_of(Pixels image) {
  const auto half = static_cast<std::ptrdiff_t>(image.cells.size() / 2);
  std::fill(image.cells.begin(), image.cells.begin() + half, test::nan);
  return image;
}

// ---- light of one channel

/// Two presses of a ball into a gel under an uneven lamp; the depth is 4 mm times the logarithm.
struct Presses {
  static constexpr Index size = 96;
  double ball_mm = 4, mm_per_px = 0.1;
  Pixels free{size, size};
  std::array<Pixels, 2> pressed = {free, free};

  Presses() {
    Random random(1);
    set(0, free, random);
    set(1.5, pressed[0], random);
    set(0.9, pressed[1], random);
  }

 private:
  void set(double depth_mm, Pixels& image, Random& random) const {
    for (Index i = 0; i < size; ++i) {
      for (Index j = 0; j < size; ++j) {
        const double x = 0.1 * static_cast<double>(j) - 4.2, y = 0.1 * static_cast<double>(i) - 5;
        const double root_sq = ball_mm * ball_mm - x * x - y * y;
        const double depth = root_sq > 0 ? depth_mm - ball_mm + std::sqrt(root_sq) : 0;
        const double light = 120 + 0.4 * static_cast<double>(i) - 0.3 * static_cast<double>(j);
        image(i, j) = light * std::exp(-std::fmax(depth, 0) / 4) + 0.3 * random.normal();
      }
    }
  }
};

std::string said_of_intensity(const Presses& presses) {
  std::string said;
  const std::string refused = test::refusal([&] {
    const IntensityFit<> fit =
        fit_intensity(presses.free, presses.pressed, presses.ball_mm, presses.mm_per_px);
    said = !fit.ok() ? text_of(fit) : std::abs(fit.law.linear_mm - 4) < 0.2 ? "right" : "wrong";
  });
  return refused == "accepted" ? said : refused;
}

std::function<void(Presses&)> in_each(const std::function<Pixels(const Pixels&)>& changed) {
  return [=](Presses& presses) {
    for (Pixels& pressed : presses.pressed) {
      pressed = changed(pressed);
    }
  };
}
std::function<void(Presses&)> in_all(const std::function<Pixels(const Pixels&)>& changed) {
  return [=](Presses& presses) {
    in_each(changed)(presses);
    presses.free = changed(presses.free);
  };
}

// ---- neighbouring light

/// A plate pressed into a cap twice: measured and true depths, in mm.
struct Depths {
  static constexpr Index size = 64;
  double pitch_mm = 0.2;
  Pixels reference = cap(0, 0);
  std::vector<Pixels> measured = {cap(1, 1), cap(2.5, -2)}, truth;

  Depths() {
    NeighbourLightCompensation<double> light({.radius_px = 5}, pitch_mm, reference);
    Pixels psi_sum_rad(size, size);
    Random random(3);
    for (const Pixels& l : measured) {
      Pixels t = l;
      (void)light.inclination_sums(l, psi_sum_rad);
      for (Index i = 0; i < size; ++i) {
        for (Index j = 0; j < size; ++j) {
          const double m = 0.002 * std::exp(0.2 * (l(i, j) - reference(i, j)));
          t(i, j) -= m * psi_sum_rad(i, j) + 0.01 * random.normal();
        }
      }
      truth.push_back(t);
    }
  }

 private:
  static Pixels cap(double pressed_mm, double shift_mm) {
    Pixels l(size, size);
    for (Index i = 0; i < size; ++i) {
      for (Index j = 0; j < size; ++j) {
        const double x = 0.2 * static_cast<double>(j - 30), y = 0.2 * static_cast<double>(i - 34);
        l(i, j) = std::fmin(8 - 0.08 * (x * x + y * y), 8 - pressed_mm + 0.1 * (x - shift_mm));
      }
    }
    return l;
  }
};

std::string said_of_neighbours(const Depths& depths) {
  const auto fit =
      fit_neighbour_light(depths.pitch_mm, depths.reference, depths.measured, depths.truth, {3, 7});
  const bool right = fit.light.radius_px == 5 && std::abs(fit.light.m0_mm_per_rad - 0.002) < 2e-4;
  return !fit.ok() ? text_of(fit) : right ? "right" : "wrong";
}

void all_of(std::vector<Pixels>& images, const std::function<Pixels(const Pixels&)>& change) {
  for (Pixels& image : images) {
    image = change(image);
  }
}

}  // namespace

TEST_CASE("mistakes: the light of one channel", "[mistakes]") {
  const auto scaled = [](double f) { return [f](const Pixels& image) { return times(image, f); }; };
  const char* const no_ball = "fit_intensity: press = 0, must be of a ball";
  const Mistake<Presses> mistakes[] = {
      {"none", [](Presses&) {}, "right"},
      {"ball in m", [](Presses& p) { p.ball_mm /= 1000; }, no_ball},
      {"ball in um", [](Presses& p) { p.ball_mm *= 1000; }, "give depths in mm"},
      {"diameter for radius",  // twice as large and half as deep: equally dark
       [](Presses& p) { p.ball_mm *= 2; }, "wrong"},
      {"pixels in m", [](Presses& p) { p.mm_per_px /= 1000; }, "give depths in mm"},
      {"pixels in um", [](Presses& p) { p.mm_per_px *= 1000; }, no_ball},
      {"pixels of another zoom", [](Presses& p) { p.mm_per_px *= 2; }, no_ball},
      {"light times 1000", in_all(scaled(1e3)), no_ball},
      {"frames of a longer exposure", in_each(scaled(1e3)), no_ball},
      {"frames of a shorter exposure", in_each(scaled(1e-3)), no_ball},
      {"a lamp 10 % darker", in_each(scaled(0.9)), no_ball},
      {"a lamp 10 % lighter", in_each(scaled(1.1)), no_ball},
      {"free and pressed exchanged", [](Presses& p) { std::swap(p.free, p.pressed[0]); }, no_ball},
      {"pressed transposed", in_each(transposed), no_ball},
      {"pressed mirrored", in_each(mirrored), no_ball},
      {"both transposed", in_all(transposed), "right"},
      {"rows sheared", in_all(sheared), no_ball},
      {"half missing", in_each(half_of), "right"},
      {"constant", [](Presses& p) { p.pressed[0] = Pixels(Presses::size, Presses::size, 77.0); },
       no_ball},
      {"the free frame again", [](Presses& p) { p.pressed[0] = p.free; }, no_ball},
      {"no number", in_each(scaled(test::nan)), no_ball},
      {"the same press twice", [](Presses& p) { p.pressed[1] = p.pressed[0]; }, "right"},
  };
  check(mistakes, said_of_intensity);
}

TEST_CASE("mistakes: neighbouring light", "[mistakes]") {
  const auto scaled = [](double f) { return [f](const Pixels& l) { return times(l, f); }; };
  const Mistake<Depths> mistakes[] = {
      {"none", [](Depths&) {}, "right"},
      {"truth in m", [=](Depths& d) { all_of(d.truth, scaled(1e-3)); },
       "measured and true depths may be exchanged"},
      {"truth in um", [=](Depths& d) { all_of(d.truth, scaled(1e3)); }, "true depth = 0"},
      {"all depths in m",
       [=](Depths& d) {
         all_of(d.truth, scaled(1e-3));
         all_of(d.measured, scaled(1e-3));
         d.reference = times(d.reference, 1e-3);
       },
       "an end of the search"},
      {"all depths in um",
       [=](Depths& d) {
         all_of(d.truth, scaled(1e3));
         all_of(d.measured, scaled(1e3));
         d.reference = times(d.reference, 1e3);
       },
       "less than 100 mm apart"},
      {"pitch in m", [](Depths& d) { d.pitch_mm *= 1e-3; }, "an end of the search"},
      {"pitch in um", [](Depths& d) { d.pitch_mm *= 1e3; }, "pitch_mm = 200"},
      {"measured and true exchanged", [](Depths& d) { std::swap(d.measured, d.truth); },
       "measured and true depths may be exchanged"},
      {"frames exchanged", [](Depths& d) { std::swap(d.truth[0], d.truth[1]); },
       "an end of the search"},
      {"truth transposed", [](Depths& d) { all_of(d.truth, transposed); }, "less than a tenth"},
      {"truth mirrored", [](Depths& d) { all_of(d.truth, mirrored); }, "less than a tenth"},
      {"truth shifted by a pixel",
       [](Depths& d) {
         all_of(d.truth, [](const Pixels& l) {
           return rearranged(l, [](Index i, Index j) { return DotIndex{i, j + 1}; });
         });
       },
       "less than a tenth"},
      {"reference mirrored",  // of a nearly round pad
       [](Depths& d) { d.reference = mirrored(d.reference); }, "wrong"},
      {"all mirrored",
       [](Depths& d) {
         all_of(d.truth, mirrored);
         all_of(d.measured, mirrored);
         d.reference = mirrored(d.reference);
       },
       "right"},
      {"rows sheared", [](Depths& d) { all_of(d.measured, sheared); }, "would darken"},
      {"truth constant",
       [](Depths& d) {
         all_of(d.truth, [](const Pixels&) { return Pixels(Depths::size, Depths::size, 7.0); });
       },
       "less than a tenth"},
      {"truth as measured", [](Depths& d) { d.truth = d.measured; },
       "some error must be explained"},
      {"the free pad's depths for truth",
       [](Depths& d) {
         d.truth = {d.reference, d.reference};
       },
       "an end of the search"},
      {"half missing", [](Depths& d) { all_of(d.measured, half_of); }, "right"},
      {"random truth",
       [](Depths& d) {
         Random random(9);
         all_of(d.truth, [&](const Pixels& l) {
           Pixels o = l;
           for (double& x : o.cells) {
             x += 0.3 * random.normal();
           }
           return o;
         });
       },
       "less than a tenth"},
      {"no truth", [=](Depths& d) { all_of(d.truth, scaled(test::nan)); }, "true depth = 0"},
  };
  check(mistakes, said_of_neighbours);
}
