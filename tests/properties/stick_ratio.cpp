// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every motion, every slip and every policy.
#include "fingerpad/slip/stick_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/slipping_dots.hpp"

using namespace fingerpad;
using test::ContactFlags;
using test::DotStates;
using test::PointsPx;
using test::SlippingDots;
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
  std::vector<StickRatioResult<double>> results;
  std::vector<DotStates> states;
};

template <class Ratio>
Said follow(const Ratio& ratio, const Recording& recording) {
  Said said;
  auto state = ratio.start();
  DotStates states(recording.rows(), recording.cols());
  for (std::size_t k = 0; k < recording.size(); ++k) {
    said.results.push_back(ratio(recording.dots[k], recording.contact[k], states, state));
    said.states.push_back(states);
  }
  return said;
}

template <class Motion, class Reference = UpdatedReference, class Denoising = ResidualMean>
struct Policies {
  using Ratio = StickRatio<Motion, Reference, Denoising, double>;
  static Ratio ratio(const Recording& r, const StickTest& test = {}) {
    return Ratio(r.rows(), r.cols(), test);
  }
};

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
    RC_ASSERT(near(x.furthest_px * scale, y.furthest_px));
    RC_ASSERT(near(x.angle_rad * sign, y.angle_rad));
    RC_ASSERT(near(x.scale, y.scale));
    RC_ASSERT(x.reference_dot.exists() == y.reference_dot.exists());
    if (x.reference_dot.exists()) {
      RC_ASSERT(place(x.reference_dot.row, x.reference_dot.col) == y.reference_dot);
    }
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

TEMPLATE_TEST_CASE("stick and slip do not depend on how the image is held",
                   "[stick_ratio][law]",
                   Policies<StickConsensus<>>,
                   (Policies<StickConsensus<Freedom::rigid>, UpdatedReference, NoDenoising>)) {
  rc::prop("shifted, rotated, mirrored, enlarged with the thresholds", [] {
    const Recording recording = any_recording(test::whole(0, 1) == 0 ? 0 : 0.05);
    const Said said = follow(TestType::ratio(recording), recording);
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
    must_agree(said, follow(TestType::ratio(seen, {}), seen), mirror ? -1 : 1, scale, same_place);
  });
}

TEMPLATE_TEST_CASE("stick and slip do not depend on how the dots are numbered",
                   "[stick_ratio][law]",
                   Policies<StickConsensus<>>,
                   (Policies<StickConsensus<Freedom::scaling>, UpdatedReference, NoDenoising>)) {
  rc::prop("from below, from the right, by columns", [] {
    const Recording recording = any_recording(test::whole(0, 1) == 0 ? 0 : 0.05);
    const Said said = follow(TestType::ratio(recording), recording);
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
      must_agree(said, follow(TestType::ratio(other), other), 1, 1, place);
    };
    const Index rows = recording.rows(), cols = recording.cols();
    check(false, [&](Index i, Index j) { return DotIndex{rows - 1 - i, j}; });
    check(false, [&](Index i, Index j) { return DotIndex{i, cols - 1 - j}; });
    check(true, [](Index i, Index j) { return DotIndex{j, i}; });
  });
}

TEMPLATE_TEST_CASE("a dot that begins to slip never raises the ratio",
                   "[stick_ratio][law]",
                   Policies<StickConsensus<>>,
                   (Policies<StickConsensus<>, UpdatedReference, NoDenoising>)) {
  // Without noise; the slip is beyond the gate of the denoising, never of the dots around the
  // middle, where the search begins, and never more than the motion, so that d_max is unchanged.
  rc::prop("clear slip of one dot more lowers it by that dot", [] {
    SlippingDots truth({.rows = 13, .cols = 13, .contact_pitches = 5.9});
    const auto before = truth.dots;
    truth.step({.shift_px = test::uniform(2.5, 5), .direction_rad = test::uniform(-3, 3)});
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
    const auto ratio = TestType::ratio({{before}, {}});
    for (Index slipping = 0; outer.size() > 40; ++slipping) {
      auto state = ratio.start();
      DotStates states(13, 13);
      (void)ratio(before, truth.contact, states, state);
      const auto r = ratio(dots, truth.contact, states, state);
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

TEMPLATE_TEST_CASE("identical frames say nothing new",
                   "[stick_ratio][law]",
                   Policies<StickConsensus<>>) {
  rc::prop("the ratio stands", [] {
    const Recording recording = any_recording(test::uniform(0, 0.6));
    const auto ratio = TestType::ratio(recording, {.store = test::whole(0, 1) == 0 ? 0 : 0.025});
    auto state = ratio.start();
    DotStates states(recording.rows(), recording.cols());
    for (std::size_t k = 0; k < recording.size(); ++k) {
      const auto first = ratio(recording.dots[k], recording.contact[k], states, state);
      const DotStates before = states;
      for (int again = 0; again < 2; ++again) {
        const auto r = ratio(recording.dots[k], recording.contact[k], states, state);
        RC_ASSERT(!r.updated());
        RC_ASSERT(test::same_bits(r.stick_ratio, first.stick_ratio));
        RC_ASSERT(states.cells == before.cells);
      }
    }
  });
}

TEST_CASE("a state is a value", "[stick_ratio][law]") {
  rc::prop("its copy goes on with the same bits", [] {
    const Recording recording = any_recording(0.1);
    const StickRatio ratio(recording.rows(), recording.cols());
    auto state = ratio.start();
    DotStates states(recording.rows(), recording.cols()), other = states;
    const auto copied_at = static_cast<std::size_t>(test::whole(0, 8));
    auto copy = ratio.start();
    for (std::size_t k = 0; k < recording.size(); ++k) {
      if (k == copied_at) {
        copy = state;
        other = states;
      }
      const auto r = ratio(recording.dots[k], recording.contact[k], states, state);
      if (k >= copied_at) {
        const auto s = ratio(recording.dots[k], recording.contact[k], other, copy);
        RC_ASSERT((s.status == r.status && test::same_bits(s.stick_ratio, r.stick_ratio)));
        RC_ASSERT((s.angle_rad == r.angle_rad && s.scale == r.scale));
        RC_ASSERT(s.furthest_px == r.furthest_px);
        RC_ASSERT(other.cells == states.cells);
      }
    }
  });
}

TEST_CASE("dots lost at random change the ratio by the sampling error", "[stick_ratio][law]") {
  // With m of n dots left, the ratio p of these has the error
  //   sqrt(p (1 - p) / m (n - m) / (n - 1)).
  // Without averaging over neighbours the error is at most that. With it, dots at the edge of the
  // stick region are averaged with others and some change sides: up to half as much again.
  const auto spread = [](const auto& ratio, double noise_px, double lost_share, bool lost_now) {
    double sum_sq = 0, expected_sq = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
      test::Random random(seed);
      SlippingDots truth;
      auto before = noisy(truth.dots, noise_px, random);
      truth.step({.shift_px = 3, .direction_rad = random.uniform(0, 6), .stick_share = 0.7});
      auto after = noisy(truth.dots, noise_px, random);
      const auto said = [&] {
        auto state = ratio.start();
        DotStates states(21, 21);
        (void)ratio(before, truth.contact, states, state);
        return ratio(after, truth.contact, states, state);
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
  const StickRatio averaged(21, 21);
  const StickRatio<StickConsensus<>, UpdatedReference, NoDenoising> plain(21, 21);
  for (const bool lost_now : {true, false}) {
    for (const double lost : {0.05, 0.2, 0.5}) {
      CAPTURE(lost_now, lost);
      CHECK(spread(plain, 0, lost, lost_now) < 1.1);
      CHECK(spread(averaged, 0, lost, lost_now) < 1.5);
      CHECK(spread(averaged, 0.14, lost, lost_now) < 1.6);
    }
  }
}

TEMPLATE_TEST_CASE("nothing is worse than a status",
                   "[stick_ratio][law]",
                   Policies<StickConsensus<>>,
                   (Policies<StickConsensus<>, UpdatedReference, NoDenoising>)) {
  rc::prop("whatever the dots, the flags, the times and the sizes", [] {
    const Index rows = test::whole(1, 8), cols = test::whole(1, 8);
    const auto bad = [](double good) {
      const double infinity = std::numeric_limits<double>::infinity();
      const double max = std::numeric_limits<double>::max();
      return *rc::gen::element(good, good, good, good, good, good, good, good, 0.0, 1e-310, 1e5,
                               1e9, 1e20, max, -max, std::nan(""), infinity, -infinity);
    };
    Recording some;
    some.dots.emplace_back(rows, cols);
    const StickTest test{.reference = test::uniform(0.5, 3),
                         .store = test::uniform(0, 0.5),
                         .pitch = 1,
                         .min_dots = test::whole(1, 6)};
    const auto ratio = TestType::ratio(some, test);
    auto state = ratio.start();
    const StickRatio in_float(rows, cols, test);
    auto float_state = in_float.start();
    double drift = 0;
    for (int k = 0; k < 8; ++k) {
      const bool other = test::whole(0, 15) == 0;
      PointsPx dots(rows + (other ? 1 : 0), cols);
      ContactFlags flags(dots.rows(), cols);
      DotStates states(dots.rows(), cols, static_cast<DotState>(77));
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
      const auto check = [&](const auto& r) {
        RC_ASSERT(r.accepted() == !other);
        if (other) {
          RC_ASSERT(std::count(states.cells.begin(), states.cells.end(),
                               static_cast<DotState>(77)) == std::ssize(states.cells));
          return;
        }
        const auto count = [&](DotState s) {
          return std::count(states.cells.begin(), states.cells.end(), s);
        };
        RC_ASSERT(r.stick == count(DotState::stick));
        RC_ASSERT(r.slip == count(DotState::slip));
        RC_ASSERT(r.unknown == count(DotState::unknown));
        RC_ASSERT(r.dots_in_contact() + count(DotState::none) == rows * cols);
        for (std::size_t at = 0; at < flags.cells.size(); ++at) {
          RC_ASSERT((states.cells[at] != DotState::none) == (flags.cells[at] != 0));
        }
        const double q = static_cast<double>(r.stick_ratio);
        RC_ASSERT((std::isnan(q) || (q >= 0 && q <= 1)));
        RC_ASSERT((r.out_of_place >= 0 && r.out_of_place <= rows * cols));
        RC_ASSERT(is_finite(r.angle_rad));
        RC_ASSERT((is_finite(r.scale) && r.scale > 0));
        RC_ASSERT((r.reference_age >= 0 && r.reference_age <= k));
        RC_ASSERT(r.reference_dot.row < rows && r.reference_dot.col < cols);
        if (r.updated()) {
          RC_ASSERT(r.stick + r.slip >= test.min_dots);
          RC_ASSERT(q ==
                    Approx(static_cast<double>(r.stick) / static_cast<double>(r.stick + r.slip)));
          RC_ASSERT((r.reference_age >= 1 && r.reference_dot.exists()));
          RC_ASSERT(static_cast<double>(r.furthest_px) > test.reference * 0.999);
          RC_ASSERT(is_finite(r.furthest_px));
        }
      };
      check(ratio(dots, flags, states, state, time_s));
      std::fill(states.cells.begin(), states.cells.end(), static_cast<DotState>(77));
      check(in_float(dots, flags, states, float_state, time_s));
    }
  });
}
