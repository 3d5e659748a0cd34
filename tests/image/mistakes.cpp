// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Mistakes with pixels: frames of gels and depth maps, and the responses of six methods. "found":
// the mistake does no harm or does not apply to the method. "another ...": a wrong number that
// cannot be detected; docs/mistakes.md has the reason.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/contact/equivalent_flat_area.hpp"
#include "fingerpad/contact/surface.hpp"
#include "fingerpad/depth/intensity_depth.hpp"
#include "fingerpad/depth/neighbour_light.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/catch.hpp"
#include "support/gel_frames.hpp"
#include "support/soap_film.hpp"

using namespace fingerpad;
using test::Image;

namespace {

constexpr int size = 64;
using Pixels = Image<double>;
using Colours = Image<std::array<double, 3>>;

double times(double level, double factor) {
  return factor * level;
}
std::array<double, 3> times(const std::array<double, 3>& p, double factor) {
  return {factor * p[0], factor * p[1], factor * p[2]};
}

/// Cell (i, j) of the result is the one at from(i, j), times a factor.
template <class Cell, class From>
Image<Cell> rearranged(const Image<Cell>& image, const From& from, double factor = 1) {
  Image<Cell> out = image;
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      const DotIndex at = from(i, j);
      out(i, j) = times(image((at.row + size) % size, (at.col + size) % size), factor);
    }
  }
  return out;
}

/// A frame with the mistake; `free` is the correct free pad.
template <class Cell>
Image<Cell> spoilt(const std::string& mistake, const Image<Cell>& now, const Image<Cell>& free) {
  const auto scaled = [&](double factor) {
    return rearranged(
        now,
        [](Index i, Index j) {
          return DotIndex{i, j};
        },
        factor);
  };
  if (mistake == "x 1000") {
    return scaled(1000);
  }
  if (mistake == "/ 1000") {
    return scaled(1e-3);
  }
  if (mistake == "10 % less") {
    return scaled(0.9);
  }
  if (mistake == "transposed") {
    return rearranged(now, [](Index i, Index j) { return DotIndex{j, i}; });
  }
  if (mistake == "mirrored") {
    return rearranged(now, [](Index i, Index j) { return DotIndex{i, size - 1 - j}; });
  }
  if (mistake == "two halves exchanged") {
    return rearranged(now, [](Index i, Index j) { return DotIndex{i, j + size / 2}; });
  }
  if (mistake == "a row stride of one too many") {
    return rearranged(now, [](Index i, Index j) { return DotIndex{i, j + i}; });
  }
  if (mistake == "constant") {
    return rearranged(now, [](Index, Index) { return DotIndex{size / 2, size / 2}; });
  }
  Image<Cell> out = mistake == "the free pad for now" ? free : now;
  if (mistake == "half missing") {
    std::fill(out.cells.begin(), out.cells.begin() + size * size / 2, times(out(0, 0), test::nan));
  }
  return mistake == "no number" ? scaled(test::nan) : out;
}

bool is_near(const Point3<double>& a, const Point3<double>& b, double mm) {
  return std::hypot(a.x - b.x, a.y - b.y) < mm;
}

/// Response of a contact, compared with the one without the mistake.
std::string told(const ContactResult& r, const ContactResult& right) {
  CHECK((r.ok() || std::isnan(r.area_mm2)));
  return !r.ok()                          ? name_of(r.status)
         : 2 * r.unknown_px > size * size ? "mostly unknown"
         : !r.in_contact()                ? "no contact"
         : std::abs(r.area_mm2 / right.area_mm2 - 1) < 0.1 &&
                 is_near(r.center_mm, right.center_mm, 0.3)
             ? "found"
             : "another contact";
}

/// A gel that darkens under an off-center ball, under an uneven lamp.
std::string of_intensity(const std::string& mistake) {
  Pixels free(size, size), now(size, size), right(size, size);
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      const double x = static_cast<double>(j - 24), y = static_cast<double>(i - 40);
      right(i, j) = std::fmax(0.0, 1.2 - (x * x + y * y) / 150);
      free(i, j) = 120 + 0.5 * static_cast<double>(i) - 0.3 * static_cast<double>(j);
      now(i, j) = free(i, j) * std::exp(-right(i, j) / 3);
    }
  }
  const bool exchanged = mistake == "free pad and now exchanged";
  IntensityDepth<double> depth(exchanged ? now : free, {});
  Pixels out(size, size);
  const auto r = depth(exchanged ? free : spoilt(mistake, now, free), out);
  return r != FrameStatus::ok                    ? name_of(r)
         : test::largest_error(right, out) < 0.2 ? "found"
                                                 : "another depth";
}

/// A ball on a gel, in colours of 8 bit.
std::string of_gel(const std::string& mistake) {
  test::GelCamera camera{.rows = size, .cols = size, .mm_per_px = 0.25, .dot_mm = 0};
  test::Random random(7);
  test::BallOnGel<> ball{test::GelPad{}};
  const auto frame = [&] {
    const auto bytes = camera.frame(ball, random);
    Colours out(size, size);
    for (std::size_t k = 0; k < out.cells.size(); ++k) {
      out.cells[k] = {double(bytes.cells[k][0]), double(bytes.cells[k][1]),
                      double(bytes.cells[k][2])};
    }
    return out;
  };
  std::vector<Colours> free = {frame(), frame(), frame()};
  ball.drag(0.5, {-1.7, 2.2});
  Colours now = frame();
  const auto look = [](const std::vector<Colours>& free_frames, const Colours& seen) {
    const auto mat_of = [](const Colours& colours) {
      cv::Mat_<cv::Vec3b> mat(size, size);
      std::transform(colours.cells.begin(), colours.cells.end(), mat.begin(),
                     [](const auto& p) { return cv::Vec3b(cv::Vec3d(p[0], p[1], p[2])); });
      return mat;
    };
    std::vector<cv::Mat> mats;
    for (const Colours& colours : free_frames) {
      mats.push_back(mat_of(colours));
    }
    GelContact contact(
        mats, {.cell_px = 2, .smoothing_px = 2, .dot_px = 0, .max_gap_px = 4, .min_region_px = 40});
    return contact(mat_of(seen));
  };
  const GelResult right = look(free, now);
  if (mistake == "channels exchanged") {
    for (auto& p : now.cells) {
      std::swap(p[0], p[2]);
    }
  }
  if (mistake == "free pad and now exchanged") {
    std::swap(free.front(), now);
    free.resize(1);
  }
  const GelResult r = look(free, spoilt(mistake, now, free.front()));
  return !r.ok()           ? name_of(r.status)
         : !r.in_contact() ? "no contact"
         : std::abs(r.contact_px / double(right.contact_px) - 1) < 0.1 &&
                 norm(r.center_px - right.center_px) < 1.2
             ? "found"
             : "another contact";
}

/// A pad around a ball, as a depth map.
struct PressedPad {
  OrthographicCamera<double> camera = test::height_map(size, size, 0.32);
  Pixels free =
      test::depths_of<double>(camera, test::RoundFilm({.radius_mm = 0, .top_mm = 12}), size, size);
  Pixels now = test::depths_of<double>(
      camera,
      test::RoundFilm({.radius_mm = 4, .object_per_mm = -0.1, .x_mm = 1.5, .y_mm = -1}),
      size,
      size);
};

std::string of_region(const std::string& mistake) {
  const PressedPad pad;
  ContactTest options;
  options.ring_px = 5;
  ContactRegion<> region(pad.camera, size, size, options);
  Image<std::uint8_t> mask(size, size);
  const ContactResult right = region(pad.now, mask);
  return told(region(spoilt(mistake, pad.now, pad.free), mask), right);
}

std::string of_surface(const std::string& mistake) {
  const PressedPad pad;
  Image<std::uint8_t> mask(size, size);
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      const auto p = point_at(pad.camera, double(i), double(j), 10.0);
      mask(i, j) = std::hypot(p.x - 1.5, p.y + 1) < 3.5 ? 1 : 0;
    }
  }
  const auto r = fit_surface(pad.camera, spoilt(mistake, pad.now, pad.free), mask);
  const auto right = fit_surface(pad.camera, pad.now, mask);
  const auto middle = [](const SurfaceResult& s) {
    return s.point_mm + 2 / (s.curvature_1_per_mm + s.curvature_2_per_mm) * s.normal;
  };
  const bool same = norm(middle(r) - middle(right)) < 0.1;
  return !r.ok() ? "no answer" : same ? "found" : "another object";
}

std::string of_light(const std::string& mistake) {
  const PressedPad pad;
  const bool exchanged = mistake == "free pad and now exchanged";
  NeighbourLightCompensation<> light({10}, 0.32F, exchanged ? pad.now : pad.free);
  Pixels right(size, size), out(size, size);
  const FrameStatus first = light(exchanged ? pad.free : spoilt(mistake, pad.now, pad.free), out);
  NeighbourLightCompensation<> good({10}, 0.32F, pad.free);
  CHECK(good(pad.now, right) == FrameStatus::ok);
  return first != FrameStatus::ok                 ? name_of(first)
         : test::largest_error(right, out) < 0.02 ? "found"
                                                  : "another depth";
}

/// The equivalent flat area for the true contact.
std::string of_flat_area(const std::string& mistake) {
  const PressedPad pad;
  Image<std::uint8_t> mask(size, size);
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      const auto p = point_at(pad.camera, double(i), double(j), 10.0);
      mask(i, j) = std::hypot(p.x - 1.5, p.y + 1) < 4 ? 1 : 0;
    }
  }
  EquivalentFlatArea<> area(pad.camera, size, size);
  const auto right = area(mask, pad.now);
  REQUIRE(right.ok());
  if (mistake == "free pad and now exchanged") {  // of the contact, too
    for (std::uint8_t& cell : mask.cells) {
      cell = cell != 0 ? 0 : 1;
    }
  }
  const auto r = area(mask, spoilt(mistake, pad.now, pad.free));
  return !r.ok()                                            ? "no answer"
         : std::abs(r.area_mm2 / right.area_mm2 - 1) < 0.05 ? "found"
                                                            : "another area";
}

struct Said {
  std::string mistake, intensity, gel, region, surface, light, flat_area;
};

const std::vector<Said> table = {
    {"none", "found", "found", "found", "found", "found", "found"},
    {"x 1000", "not of this pad", "not of this pad", "not of this pad", "no answer",
     "not of this pad", "no answer"},
    {"/ 1000", "not of this pad", "not of this pad", "not of this pad", "another object",
     "not of this pad", "found"},
    {"10 % less", "not of this pad", "found", "found", "found", "another depth", "found"},
    {"transposed", "another depth", "not of this pad", "another contact", "another object",
     "another depth", "another area"},
    {"mirrored", "another depth", "not of this pad", "another contact", "another object",
     "another depth", "another area"},
    {"two halves exchanged", "not of this pad", "not of this pad", "another contact",
     "another object", "another depth", "no answer"},
    {"a row stride of one too many", "another depth", "not of this pad", "another contact",
     "another object", "another depth", "no answer"},
    {"constant", "not of this pad", "not of this pad", "another contact", "another object",
     "another depth", "no answer"},
    {"half missing", "found", "found", "mostly unknown", "found", "found", "no answer"},
    {"no number", "not of this pad", "not of this pad", "not of this pad", "no answer", "found",
     "no answer"},
    {"the free pad for now", "another depth", "no contact", "no contact", "another object",
     "another depth", "another area"},
    {"free pad and now exchanged", "another depth", "found", "found", "found", "another depth",
     "no answer"},
    {"channels exchanged", "found", "not of this pad", "found", "found", "found", "found"},
};

}  // namespace

TEST_CASE("mistakes with pixels", "[mistakes]") {
  for (const Said& said : table) {
    INFO(said.mistake);
    CHECK(of_intensity(said.mistake) == said.intensity);
    CHECK(of_gel(said.mistake) == said.gel);
    CHECK(of_region(said.mistake) == said.region);
    CHECK(of_surface(said.mistake) == said.surface);
    CHECK(of_light(said.mistake) == said.light);
    CHECK(of_flat_area(said.mistake) == said.flat_area);
  }
}
