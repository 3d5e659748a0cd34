// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every motion and every slip, in the image and in space.
#include "fingerpad/slip/stick_ratio.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/slipping_dots.hpp"
#include "support/slipping_patch.hpp"

using namespace fingerpad;
using test::ContactFlags;
using DotStates = test::Image<DotState>;
using test::PointsPx;
using test::SlippingDots;
using test::SlippingPatch;
using test::SlippingPattern;

namespace {

using Point = Point2<double>;
const Point missing{test::nan, test::nan};

struct Recording {
  std::vector<PointsPx> dots;
  std::vector<ContactFlags> contact;
  std::size_t size() const { return dots.size(); }
  Index rows() const { return dots[0].rows(); }
  Index cols() const { return dots[0].cols(); }
};

/// An object is dragged, rotated and pressed at random while its stick disc changes at random.
Recording any_recording(double lost_share = 0) {
  SlippingPattern pattern{.rows = 13, .cols = 12, .contact_pitches = test::uniform(3.5, 5.5)};
  pattern.disc_row = test::uniform(-1, 1);
  pattern.disc_col = test::uniform(-1, 1);
  pattern.shear_pitches = test::uniform(0, 2);
  SlippingDots truth(pattern);
  test::Random random(static_cast<std::uint64_t>(test::whole(0, 1 << 30)));
  const double noise_px = test::uniform(0.02, 0.15);
  Recording recording;
  double direction = random.uniform(0, 6.3);
  for (int k = 0; k < 9; ++k) {
    auto dots = noisy(truth.dots, noise_px, random);
    for (Point& p : dots.cells) {
      p = random.uniform() < lost_share ? missing : p;
    }
    recording.dots.push_back(dots);
    recording.contact.push_back(truth.contact);
    direction += random.uniform(-0.4, 0.4) + (random.whole(0, 9) == 0 ? 3 : 0);
    truth.step({.shift_px = random.uniform(0, 3),
                .direction_rad = direction,
                .turn_rad = random.uniform(-0.02, 0.02),
                .zoom = random.uniform(0.99, 1.01),
                .stick_share = random.uniform(0.2, 1.2)});
  }
  return recording;
}

/// Maps the dots and flags of a recording one by one.
template <class MapDots, class MapFlags>
Recording mapped(const Recording& from, const MapDots& map_dots, const MapFlags& map_flags) {
  Recording to;
  for (std::size_t k = 0; k < from.size(); ++k) {
    to.dots.push_back(map_dots(from.dots[k]));
    to.contact.push_back(map_flags(from.contact[k]));
  }
  return to;
}

struct Said {
  std::vector<StickResult<>> results;
  std::vector<DotStates> states;
};

DotStates states_of(const StickRatio<>& stick) {
  DotStates states(stick.rows(), stick.cols());
  for (Index i = 0; i < stick.rows(); ++i) {
    for (Index j = 0; j < stick.cols(); ++j) {
      states(i, j) = stick.states()(i, j);
    }
  }
  return states;
}

Said follow(const Recording& recording) {
  Said said;
  StickRatio<> stick(recording.rows(), recording.cols());
  for (std::size_t k = 0; k < recording.size(); ++k) {
    said.results.push_back(stick(recording.dots[k], recording.contact[k]));
    said.states.push_back(states_of(stick));
  }
  return said;
}

double angle_of(const StickResult<>& r) {
  return std::atan2(r.motion.rotation.m[1][0], r.motion.rotation.m[0][0]);
}

bool near(double a, double b, double margin = 1e-9) {
  return test::same_bits(a, b) || std::abs(a - b) <= margin * std::max(1.0, std::abs(b));
}

/// `sign` is that of the angle in `b`, `scale` that of its lengths, and `place` maps dots of a to
/// dots of b.
template <class Place>
void must_agree(const Said& a, const Said& b, double sign, double scale, const Place& place) {
  for (std::size_t k = 0; k < a.results.size(); ++k) {
    const auto &x = a.results[k], &y = b.results[k];
    RC_ASSERT(x.status == y.status);
    RC_ASSERT((x.stick == y.stick && x.slip == y.slip && x.unknown == y.unknown));
    RC_ASSERT(x.out_of_place == y.out_of_place);
    RC_ASSERT(test::same_bits(x.stick_ratio, y.stick_ratio));
    RC_ASSERT(x.reference_age == y.reference_age);
    RC_ASSERT(near(x.furthest * scale, y.furthest));
    RC_ASSERT(near(angle_of(x) * sign, angle_of(y)));
    RC_ASSERT(near(x.scale, y.scale));
    for (Index i = 0; i < a.states[k].rows(); ++i) {
      for (Index j = 0; j < a.states[k].cols(); ++j) {
        const DotIndex at = place(i, j);
        RC_ASSERT(a.states[k](i, j) == b.states[k](at.row, at.col));
      }
    }
  }
}

DotIndex same_place(Index row, Index col) {
  return {row, col};
}

}  // namespace

TEST_CASE("stick and slip do not depend on how the image is held", "[stick_ratio][law]") {
  rc::prop("shifted, rotated, mirrored, enlarged with the thresholds", [] {
    const Recording recording = any_recording(test::whole(0, 1) == 0 ? 0 : 0.05);
    const Said said = follow(recording);
    const double shift_x = test::uniform(-500, 500), shift_y = test::uniform(-500, 500);
    const double turn = test::uniform(-3.2, 3.2), scale = test::log_uniform(0.01, 100);
    const bool mirror = test::whole(0, 1) == 1;
    const double cosine = scale * std::cos(turn), sine = scale * std::sin(turn);
    const Recording seen = mapped(
        recording,
        [&](PointsPx dots) {
          for (Point& p : dots.cells) {
            const double x = mirror ? -p.x : p.x;
            p = {cosine * x - sine * p.y + shift_x, sine * x + cosine * p.y + shift_y};
          }
          return dots;
        },
        [](const ContactFlags& flags) { return flags; });
    must_agree(said, follow(seen), mirror ? -1 : 1, scale, same_place);
  });
}

TEST_CASE("stick and slip do not depend on how the dots are numbered", "[stick_ratio][law]") {
  rc::prop("from below, from the right, by columns", [] {
    const Recording recording = any_recording(test::whole(0, 1) == 0 ? 0 : 0.05);
    const Said said = follow(recording);
    const auto check = [&](bool swaps, const auto& place) {
      const auto map = [&](const auto& grid) {
        using Grid = std::decay_t<decltype(grid)>;
        Grid out = swaps ? Grid(grid.cols(), grid.rows()) : Grid(grid.rows(), grid.cols());
        for (Index i = 0; i < grid.rows(); ++i) {
          for (Index j = 0; j < grid.cols(); ++j) {
            const DotIndex at = place(i, j);
            out(at.row, at.col) = grid(i, j);
          }
        }
        return out;
      };
      const Recording other = mapped(recording, map, map);
      must_agree(said, follow(other), 1, 1, place);
    };
    const Index rows = recording.rows(), cols = recording.cols();
    check(false, [&](Index i, Index j) { return DotIndex{rows - 1 - i, j}; });
    check(false, [&](Index i, Index j) { return DotIndex{i, cols - 1 - j}; });
    check(true, [](Index i, Index j) { return DotIndex{j, i}; });
  });
}

TEST_CASE("a dot that begins to slip never raises the ratio", "[stick_ratio][law]") {
  // Without noise; the slip is beyond the gate of the denoising, never of the dots around the
  // middle, where the search begins, and never more than the motion, so that d_max is unchanged.
  rc::prop("clear slip of one dot more lowers it by that dot", [] {
    SlippingDots truth({.rows = 13, .cols = 13, .contact_pitches = 5.9});
    const auto before = truth.dots;
    truth.step({.shift_px = test::uniform(4.5, 6), .direction_rad = test::uniform(-3, 3)});
    auto dots = truth.dots;
    std::vector<DotIndex> outer;
    Index all = 0;
    for (Index i = 0; i < 13; ++i) {
      for (Index j = 0; j < 13; ++j) {
        const double pitches = std::hypot(i - 6, j - 6);
        all += truth.contact(i, j);
        if (truth.contact(i, j) != 0 && pitches > 3) {
          outer.push_back({i, j});
        }
      }
    }
    for (Index slipping = 0; outer.size() > 40; ++slipping) {
      StickRatio<> stick(13, 13, {.noise = 0.06});
      (void)stick(before, truth.contact);
      const auto r = stick(dots, truth.contact);
      RC_ASSERT(r.updated());
      RC_ASSERT(r.slip == slipping);
      RC_ASSERT(r.stick == all - slipping);
      const auto pick = outer.begin() + test::whole(0, std::ssize(outer) - 1);
      const double behind = test::uniform(0.8, 1);
      Point& p = dots(pick->row, pick->col);
      const Point& from = before(pick->row, pick->col);
      p = {p.x + behind * (from.x - p.x), p.y + behind * (from.y - p.y)};
      outer.erase(pick);
    }
  });
}

TEST_CASE("identical frames say nothing new", "[stick_ratio][law]") {
  rc::prop("the ratio stands", [] {
    const Recording recording = any_recording(test::uniform(0, 0.6));
    StickRatio<> stick(recording.rows(), recording.cols());
    for (std::size_t k = 0; k < recording.size(); ++k) {
      const auto first = stick(recording.dots[k], recording.contact[k]);
      for (int again = 0; again < 2; ++again) {
        const auto r = stick(recording.dots[k], recording.contact[k]);
        RC_ASSERT((!r.updated() || r.reference_age > again + 1));  // never against itself
        RC_ASSERT((r.updated() || test::same_bits(r.stick_ratio, first.stick_ratio)));
      }
    }
  });
}

TEST_CASE("a stick ratio is a value", "[stick_ratio][law]") {
  rc::prop("its copy goes on with the same bits", [] {
    const Recording recording = any_recording(0.1);
    StickRatio<> stick(recording.rows(), recording.cols()), copy = stick;
    const auto copied_at = static_cast<std::size_t>(test::whole(0, 8));
    for (std::size_t k = 0; k < recording.size(); ++k) {
      if (k == copied_at) {
        copy = stick;
      }
      const auto r = stick(recording.dots[k], recording.contact[k]);
      if (k >= copied_at) {
        const auto s = copy(recording.dots[k], recording.contact[k]);
        RC_ASSERT((s.status == r.status && test::same_bits(s.stick_ratio, r.stick_ratio)));
        RC_ASSERT((angle_of(s) == angle_of(r) && s.scale == r.scale));
        RC_ASSERT(s.furthest == r.furthest);
        RC_ASSERT(states_of(copy).cells == states_of(stick).cells);
      }
    }
  });
}

TEST_CASE("dots lost at random change the ratio by the sampling error",
          "[stick_ratio][law][figures]") {
  // With m of n dots left, the ratio p of these has the error
  //   sqrt(p (1 - p) / m (n - m) / (n - 1)).
  // Dots at the edge of the stick region are averaged with others and some change sides: up to half
  // as much again. With noise the dots around which the search begins are others, too: up to three
  // times as much.
  const auto spread = [](double noise_px, double lost_share, bool lost_now) {
    double sum_sq = 0, expected_sq = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
      test::Random random(seed);
      SlippingDots truth;
      auto before = noisy(truth.dots, noise_px, random);
      truth.step({.shift_px = 5, .direction_rad = random.uniform(0, 6), .stick_share = 0.7});
      auto after = noisy(truth.dots, noise_px, random);
      const auto said = [&] {
        StickRatio<> stick(21, 21, {.noise = noise_px > 0 ? noise_px : 0.06});
        (void)stick(before, truth.contact);
        return stick(after, truth.contact);
      };
      const auto all = said();
      for (Point& p : (lost_now ? after : before).cells) {
        p = random.uniform() < lost_share ? missing : p;
      }
      const auto left = said();
      REQUIRE((all.updated() && left.updated()));
      const double p = static_cast<double>(all.stick_ratio);
      const double n = static_cast<double>(all.stick + all.slip);
      const double m = static_cast<double>(left.stick + left.slip);
      REQUIRE(m < n);
      sum_sq += square(static_cast<double>(left.stick_ratio) - p);
      expected_sq += p * (1 - p) / m * (n - m) / (n - 1);
    }
    return std::sqrt(sum_sq / expected_sq);
  };
  for (const bool lost_now : {true, false}) {
    for (const double lost : {0.05, 0.2, 0.5}) {
      CAPTURE(lost_now, lost);
      CHECK(spread(0, lost, lost_now) < 1.5);
      CHECK(spread(0.14, lost, lost_now) < 3.2);
    }
  }
}

TEST_CASE("stick ratio: nothing is worse than a status", "[stick_ratio][law]") {
  rc::prop("whatever the dots, the flags, the times and the sizes", [] {
    const Index rows = test::whole(1, 8), cols = test::whole(1, 8);
    const auto bad = [](double good) {
      const double infinity = std::numeric_limits<double>::infinity();
      const double max = std::numeric_limits<double>::max();
      return *rc::gen::element(good, good, good, good, good, good, good, good, 0.0, 1e-310, 1e5,
                               1e9, 1e20, max, -max, std::nan(""), infinity, -infinity);
    };
    const StickOptions options{.noise = test::uniform(0.02, 0.2)};
    StickRatio<> stick(rows, cols, options);
    StickRatio<float> in_float(rows, cols, options);
    double drift = 0;
    for (int k = 0; k < 8; ++k) {
      const bool other = test::whole(0, 15) == 0;
      PointsPx dots(rows + (other ? 1 : 0), cols);
      ContactFlags flags(dots.rows(), cols);
      const auto kind = test::whole(0, 4);
      const auto touching = test::whole(0, 130), wild = test::whole(0, 2);
      drift += test::uniform(-2, 4);
      for (Index i = 0; i < dots.rows(); ++i) {
        for (Index j = 0; j < cols; ++j) {
          const double x = 20 * static_cast<double>(j) + drift, y = 20 * static_cast<double>(i);
          dots(i, j) = kind == 0   ? Point{3, 4}
                       : kind == 1 ? Point{x, x}
                       : wild == 0 ? Point{bad(x), bad(y)}
                                   : Point{x + test::uniform(-1, 1), y + test::uniform(-1, 1)};
          flags(i, j) = test::whole(0, 99) < touching ? 1 : 0;
        }
      }
      const double time_s = bad(static_cast<double>(k));
      const auto check = [&](auto& of) {
        const auto r = of(dots, flags, time_s);
        RC_ASSERT(r.accepted() == !other);
        if (other) {
          return;
        }
        Index none = 0;
        std::array<Index, 4> count = {};
        for (Index i = 0; i < rows; ++i) {
          for (Index j = 0; j < cols; ++j) {
            const DotState state = of.states()(i, j);
            ++count[static_cast<std::size_t>(state)];
            none += flags(i, j) == 0 ? 1 : 0;
            RC_ASSERT((state != DotState::none) == (flags(i, j) != 0));
          }
        }
        RC_ASSERT((count[0] == none && count[1] == r.unknown && count[2] == r.slip &&
                   count[3] == r.stick));
        const double q = static_cast<double>(r.stick_ratio);
        RC_ASSERT((std::isnan(q) || (q >= 0 && q <= 1)));
        RC_ASSERT((r.out_of_place >= 0 && r.out_of_place <= rows * cols));
        RC_ASSERT((is_finite(r.scale) && is_finite(r.motion.translation_mm)));
        RC_ASSERT((r.reference_age >= 0 && r.reference_age <= k));
        if (r.updated()) {
          RC_ASSERT(r.stick + r.slip >= 6);
          RC_ASSERT(q ==
                    Approx(static_cast<double>(r.stick) / static_cast<double>(r.stick + r.slip)));
          RC_ASSERT(r.reference_age >= 1);
          RC_ASSERT((is_finite(r.furthest) && static_cast<double>(r.furthest) > 0));
          RC_ASSERT((is_finite(r.ratio_sd) && static_cast<double>(r.ratio_sd) >= 0));
        }
      };
      check(stick);
      check(in_float);
    }
  });
}

namespace {

using Spatial = test::Image<Point3<double>>;

/// An object is dragged, rolled, rotated and pressed at random while its stick disc changes at
/// random.
std::vector<Spatial> any_recording(SlippingPatch& patch) {
  test::Random random(static_cast<std::uint64_t>(test::whole(0, 1 << 30)));
  std::vector<Spatial> frames;
  const auto small = [&](double size) { return random.uniform(-size, size); };
  for (int k = 0; k < 8; ++k) {
    frames.push_back(noisy(patch.dots, 0.005, 0.025, random));
    patch.step(test::moved_by({small(0.01), small(0.01), small(0.02)}, {small(3), small(3), 28},
                              {small(0.2), small(0.2), small(0.1)}),
               random.uniform(0.3, 1.3));
  }
  return frames;
}

}  // namespace

TEST_CASE("in space, stick and slip do not depend on where the pad is seen from its axis",
          "[stick_ratio][law]") {
  rc::prop("shifted, rotated about z, mirrored", [] {
    SlippingPatch patch;
    const auto frames = any_recording(patch);
    const double angle = test::uniform(-3, 3), x = test::uniform(-30, 30),
                 y = test::uniform(-30, 30), z = test::uniform(-5, 5);
    const bool mirror = test::whole(0, 1) == 1;
    StickRatio<> stick(21, 21, {.noise = 0.005}), other = stick;
    for (const Spatial& dots : frames) {
      Spatial seen = dots;
      for (auto& p : seen.cells) {
        const double px = mirror ? -p.x : p.x;
        p = {std::cos(angle) * px - std::sin(angle) * p.y + x,
             std::sin(angle) * px + std::cos(angle) * p.y + y, p.z + z};
      }
      const auto a = stick(dots, patch.contact), b = other(seen, patch.contact);
      RC_ASSERT(a.status == b.status);
      RC_ASSERT(a.reference_age == b.reference_age);
      RC_ASSERT((a.stick == b.stick && a.slip == b.slip && a.unknown == b.unknown));
      RC_ASSERT(states_of(stick).cells == states_of(other).cells);
      RC_ASSERT(std::abs(a.furthest - b.furthest) < 1e-9);
    }
  });
}

TEST_CASE("in space, results are within their ranges", "[stick_ratio][law]") {
  rc::prop("whatever is lost", [] {
    SlippingPatch patch;
    auto frames = any_recording(patch);
    const double lost = test::uniform(0, 0.7);
    const double infinity = std::numeric_limits<double>::infinity();
    StickRatio<> stick(21, 21, {.noise = 0.005});
    for (Spatial& dots : frames) {
      for (auto& p : dots.cells) {
        if (test::uniform(0, 1) < lost) {
          p.x = *rc::gen::element(std::nan(""), infinity, 1e300, 0.0);
        }
      }
      const auto r = stick(dots, patch.contact);
      RC_ASSERT((std::isnan(r.stick_ratio) || (r.stick_ratio >= 0 && r.stick_ratio <= 1)));
      RC_ASSERT(r.dots_in_contact() ==
                std::count(patch.contact.cells.begin(), patch.contact.cells.end(), 1));
      if (r.updated()) {
        RC_ASSERT(r.furthest > 0.08);  // U / 2
        RC_ASSERT(is_finite(r.ratio_sd));
        RC_ASSERT(is_finite(r.motion.translation_mm));
        for (Index i = 0; i < 21; ++i) {
          for (Index j = 0; j < 21; ++j) {
            const bool known = stick.states()(i, j) >= DotState::slip;
            RC_ASSERT(is_finite(stick.slips()(i, j)) == known);
          }
        }
      }
    }
  });
}
