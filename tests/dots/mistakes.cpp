// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Mistakes with printed dots, and the responses to each. An object is dragged, and nothing slips.
// Each line has a mistake in the dots and the responses of six methods in the last frame.
// "updated", "ok", "measured": the mistake does no harm. "another motion", "another shift", "false
// slip" or "alarm": a wrong number that cannot be detected; docs/mistakes.md has the reason.
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "fingerpad/gel/gel_slide.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/published/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/gel_frames.hpp"
#include "support/refusal.hpp"
#include "support/slipping_dots.hpp"

using namespace fingerpad;
using test::ContactFlags;
using test::Image;
using test::PointsPx;
using test::SlippingDots;

namespace {

constexpr Index across = 15;
constexpr double mm_per_px = 0.08;
constexpr int frames = 12;
using Spatial = Image<Point3<double>>;

/// Changes frame k; 0 is the free pad.
using Spoil = std::function<void(PointsPx&, int k)>;

/// Responses of the methods.
struct Answers {
  std::string stick, spatial, motion, shift, slide;

  friend bool operator==(const Answers&, const Answers&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Answers& a) {
    return out << a.stick << " | " << a.spatial << " | " << a.motion << " | " << a.shift << " | "
               << a.slide;
  }
};

struct Mistake {
  std::string name;
  Answers said;
  Spoil spoil;
};

Spoil each(const std::function<Point2<double>(const Point2<double>&)>& change) {
  return [=](PointsPx& dots, int) {
    for (auto& p : dots.cells) {
      p = change(p);
    }
  };
}
Spoil renamed(const std::function<DotIndex(Index i, Index j, int k)>& from) {
  return [=](PointsPx& dots, int k) {
    const PointsPx as_they_were = dots;
    for (Index i = 0; i < across; ++i) {
      for (Index j = 0; j < across; ++j) {
        const DotIndex d = from(i, j, k);
        dots(i, j) = as_they_were((d.row + across) % across, (d.col + across) % across);
      }
    }
  };
}
Spoil lost_as(const Point2<double>& mark, bool from_frame) {
  return [=](PointsPx& dots, int k) {
    for (Index n = from_frame ? k : 0; n < across * across; n += 4) {
      dots.cells[static_cast<std::size_t>(n)] = mark;
    }
  };
}
Spoil one_at(double far_px) {
  return [=](PointsPx& dots, int) { dots(across / 2, across / 2) = {far_px, -far_px}; };
}
void shuffle(PointsPx& dots, std::uint64_t seed) {
  test::Random random(seed);
  for (Index k = across * across - 1; k > 0; --k) {
    std::swap(dots.cells[static_cast<std::size_t>(k)],
              dots.cells[static_cast<std::size_t>(random.whole(0, k))]);
  }
}

const std::vector<Mistake>& mistakes() {
  static const std::vector<Mistake> all = {
      {"none", {"updated", "updated", "ok", "measured", "updated"}, [](PointsPx&, int) {}},
      {"dots in mm",
       {"updated", "not in order", "another motion", "another shift", "refused"},
       each([](auto& p) { return mm_per_px * p; })},
      {"dots in m",
       {"updated", "not in order", "no pose", "another shift", "refused"},
       each([](auto& p) { return mm_per_px / 1000 * p; })},
      {"dots in shares of the frame",
       {"false slip", "not in order", "no pose", "another shift", "refused"},
       each([](auto& p) {
         return Point2<double>{p.x / 640, p.y / 480};
       })},
      {"dots times 1000",
       {"updated", "updated", "no pose", "another shift", "refused"},
       each([](auto& p) { return 1000.0 * p; })},
      {"x and y exchanged",
       {"updated", "updated", "another motion", "another shift", "alarm"},
       each([](auto& p) {
         return Point2<double>{p.y, p.x};
       })},
      {"y upward",
       {"updated", "updated", "another motion", "another shift", "alarm"},
       each([](auto& p) {
         return Point2<double>{p.x, 480 - p.y};
       })},
      {"column by column",
       {"updated", "updated", "ok", "measured", "updated"},
       renamed([](Index i, Index j, int) {
         return DotIndex{j, i};
       })},
      {"rows from the other end",
       {"updated", "updated", "ok", "measured", "updated"},
       renamed([](Index i, Index j, int) {
         return DotIndex{across - 1 - i, j};
       })},
      {"names by chance",
       {"not in order", "not in order", "ok", "another shift", "updated"},
       [](PointsPx& dots, int) { shuffle(dots, 3); }},
      {"names by chance, others in each frame",
       {"not in order", "not in order", "no pose", "not rigid", "no dots"},
       [](PointsPx& dots, int k) { shuffle(dots, static_cast<std::uint64_t>(k)); }},
      {"column by column from frame 6 on",
       {"not in order", "not in order", "no pose", "not rigid", "no dots"},
       renamed([](Index i, Index j, int k) {
         return k < 6 ? DotIndex{i, j} : DotIndex{j, i};
       })},
      {"shifted by one from frame 6 on",
       {"not in order", "not in order", "another motion", "another shift", "no dots"},
       renamed([](Index i, Index j, int k) {
         return DotIndex{i, k < 6 ? j : j + 1};
       })},
      {"two halves exchanged from frame 6 on",
       {"not in order", "not in order", "no pose", "not rigid", "no dots"},
       renamed([](Index i, Index j, int k) {
         return DotIndex{i, k < 6 ? j : j + across / 2};
       })},
      {"neighbours exchanged from frame 6 on",
       {"too few dots", "too few dots", "no pose", "not rigid", "no dots"},
       renamed([](Index i, Index j, int k) {
         return DotIndex{i, k < 6 || j == across - 1 ? j : j % 2 == 0 ? j + 1 : j - 1};
       })},
      {"lost as (0, 0)",
       {"updated", "updated", "ok", "measured", "updated"},
       lost_as({0, 0}, false)},
      {"lost as (0, 0), others in each frame",
       {"updated", "updated", "ok", "measured", "updated"},
       lost_as({0, 0}, true)},
      {"lost as (-1, -1), others in each frame",
       {"updated", "updated", "ok", "measured", "updated"},
       lost_as({-1, -1}, true)},
      {"lost as 1e30, others in each frame",
       {"updated", "updated", "ok", "measured", "updated"},
       lost_as({1e30, 1e30}, true)},
      {"a dot a billion px away", {"updated", "updated", "ok", "measured", "updated"}, one_at(1e9)},
      {"a dot as far away as numbers go",
       {"updated", "updated", "ok", "measured", "updated"},
       one_at(1.7e308)},
      {"all dots a billion px away",
       {"too few dots", "too few dots", "no pose", "no dots", "refused"},
       each([](auto& p) {
         return Point2<double>{p.x + 1e9, p.y};
       })},
      {"dots times 1e300",
       {"too few dots", "too few dots", "no pose", "no dots", "refused"},
       each([](auto& p) { return 1e300 * p; })},
      {"half of the dots missing",
       {"updated", "updated", "ok", "another shift", "updated"},
       [](PointsPx& dots, int) {
         for (Index n = 0; n < across * across / 2; ++n) {
           dots.cells[static_cast<std::size_t>(n)] = {test::nan, test::nan};
         }
       }},
      {"frozen from frame 6 on",
       {"unmoved", "updated", "another motion", "another shift", "updated"},
       [last = PointsPx()](PointsPx& dots, int k) mutable {
         last = k < 6 ? dots : last;
         dots = last;
       }},
  };
  return all;
}

/// A free frame, then a drag in which all dots stick.
template <class See>
void drag(const Mistake& mistake, const See& see) {
  SlippingDots truth({.rows = across, .cols = across, .pitch_px = 19.5, .contact_pitches = 5});
  Spoil spoil = mistake.spoil;
  for (int k = 0; k <= frames; ++k) {
    PointsPx dots = truth.dots;
    spoil(dots, k);
    see(dots, truth.contact);
    truth.step({.shift_px = 0.6, .direction_rad = 0.4, .turn_rad = 0.003});
  }
}

/// Dots on a slope; marks of lost dots are kept.
Spatial in_space(const PointsPx& dots) {
  Spatial out(dots.rows(), dots.cols());
  for (std::size_t k = 0; k < out.cells.size(); ++k) {
    const auto& p = dots.cells[k];
    const bool mark = p.x <= 0 && p.x == p.y;
    const double x = mm_per_px * p.x, y = mm_per_px * p.y;
    out.cells[k] = mark ? Point3<double>{p.x, p.y, p.x} : Point3<double>{x, y, 14 + 0.02 * x};
  }
  return out;
}

/// The last status of a stick ratio, or "false slip".
template <class Convert>
std::string said_by_stick(const StickOptions& options,
                          const Mistake& mistake,
                          const Convert& convert) {
  StickRatio<> stick(across, across, options);
  std::string said;
  bool slip = false;
  drag(mistake, [&](const PointsPx& dots, const ContactFlags& contact) {
    const auto r = stick(convert(dots), contact);
    said = name_of(r.status);
    slip = slip || (r.updated() && r.stick_ratio < 0.9);
  });
  return slip ? "false slip" : said;
}

constexpr double way_px = 0.6 * frames, way_rad = 0.4;  // motion of the object's middle, in total

template <class S>
bool is_true_way(const S& x, const S& y, double unit) {
  const double off =
      std::hypot(x - unit * way_px * std::cos(way_rad), y - unit * way_px * std::sin(way_rad));
  return off < 0.05 * unit * way_px;
}

/// The last status, or "another motion".
std::string said_by_motion(const Mistake& mistake) {
  ObjectMotion<> motion(across, across);
  std::string said;
  bool is_true = true;
  drag(mistake, [&](const PointsPx& dots, const ContactFlags& contact) {
    const auto r = motion(in_space(dots), contact);
    const Point3<double> middle = in_space(PointsPx(across, across, {320, 240}))(0, 0);
    const Point3<double> moved = r.pose(middle) - middle;
    said = name_of(r.status);
    is_true = !r.ok() || is_true_way(moved.x, moved.y, mm_per_px);
  });
  return is_true ? said : "another motion";
}

std::string said_by_shift(const Mistake& mistake) {
  std::optional<ContactShift<>> shift;
  std::string said;
  drag(mistake, [&](const PointsPx& dots, const ContactFlags& contact) {
    if (!shift) {
      shift.emplace(dots, ShiftOptions{.edge_dots = false});
    }
    const auto r = (*shift)(dots, contact);
    const bool is_true = !r.ok() || is_true_way(r.displacement.x, r.displacement.y, 1);
    said = is_true ? name_of(r.status) : "another shift";
  });
  return said;
}

/// The imprint moves with the dots.
std::string said_by_slide(const Mistake& mistake) {
  std::optional<GelSlide> slide;
  Image<float> imprint(60, 80);
  ContactFlags touch(60, 80);
  std::string said;
  bool alarm = false;
  int k = 0;
  const auto see = [&](const PointsPx& dots, const ContactFlags&) {
    if (!slide) {
      slide.emplace(60, 80, dots, SlideOptions{.cell_px = 8});
    }
    for (Index i = 0; i < 60; ++i) {
      for (Index j = 0; j < 80; ++j) {
        const double x = static_cast<double>(j) - 40 - 0.6 * k / 8 * std::cos(way_rad);
        const double y = static_cast<double>(i) - 30 - 0.6 * k / 8 * std::sin(way_rad);
        const double bumps = 1 + 0.3 * std::cos(x / 3) + 0.2 * std::sin(y / 2.5);
        imprint(i, j) =
            static_cast<float>(0.1 * bumps * std::exp(-std::pow(std::hypot(x, y) / 14, 6)));
        touch(i, j) = std::hypot(x, y) < 14 ? 1 : 0;
      }
    }
    ++k;
    const auto r = (*slide)(imprint, touch, dots);
    alarm = alarm || r.alarm;
    said = name_of(r.status);
  };
  const std::string refused = test::refusal([&] { drag(mistake, see); });
  return refused != "accepted" ? "refused" : alarm ? "alarm" : said;
}

}  // namespace

TEST_CASE("mistakes with printed dots", "[mistakes]") {
  const auto as_they_are = [](const PointsPx& dots) -> const PointsPx& { return dots; };
  for (const Mistake& mistake : mistakes()) {
    INFO(mistake.name);
    const Answers said = {
        said_by_stick({}, mistake, as_they_are),
        said_by_stick({.noise = 0.005}, mistake, in_space),
        said_by_motion(mistake),
        said_by_shift(mistake),
        said_by_slide(mistake),
    };
    CHECK(said == mistake.said);
  }
}

TEST_CASE("a dot from a million px on is none that is out of place", "[mistakes]") {
  const auto out_of_place = [](double far_px) {
    StickRatio<> stick(across, across);
    Index out = 0;
    drag({"", {}, one_at(far_px)}, [&](const PointsPx& dots, const ContactFlags& contact) {
      out = stick(dots, contact).out_of_place;
    });
    return out;
  };
  CHECK(out_of_place(0.99e6) > 0);
  CHECK(out_of_place(1.01e6) == 0);
}

TEST_CASE("patterns larger than any are refused by name", "[mistakes]") {
  using test::refusal;
  const auto said = [](Index rows, Index cols) {
    const LazyView px(rows, cols, [](Index i, Index j) {
      return Point2<double>{20 * static_cast<double>(j), 20 * static_cast<double>(i)};
    });
    const LazyView mm(rows, cols, [px](Index i, Index j) {
      return Point3<double>{px(i, j).x / 12, px(i, j).y / 12, 9};
    });
    return std::array{
        refusal([&] { const StickRatio<> r(rows, cols); }),
        refusal([&] { const ObjectMotion<> r(rows, cols); }),
        refusal([&] { const ContactShift<> r(px); }),
        refusal([&] { const GelSlide r(rows, cols, PointsPx(9, 9)); }),
        refusal([&] { const GelSlide r(60, 80, px); }),
        refusal([&] { const published::StickRatio<> r(rows, cols); }),
    };
  };
  constexpr Index enormous = std::numeric_limits<Index>::max();
  for (const auto& [rows, cols, what] :
       {std::tuple<Index, Index, const char*>{enormous, 9, "rows = "},
        {9, enormous, "cols = "},
        {enormous, enormous, "rows = "},
        {1000000, 1000000, "rows times cols = 1000000000000"}}) {
    for (const std::string& message : said(rows, cols)) {
      CAPTURE(message);
      CHECK(message.find(what) != std::string::npos);
    }
  }
  const std::string too_many = "cells in memory = 128000000, must be <= 100000000";
  CHECK(refusal([] { const StickRatio<> r(1000, 2000); }) == "StickRatio: " + too_many);
}

namespace {

/// Response for a ball that drags a gel along without slip, with contact flags of the dots under
/// the ball or of all dots. The gel follows around the ball, the less the further away.
template <class Convert>
std::string said_of_gel(const StickOptions& options, bool all_touch, const Convert& convert) {
  const test::GelCamera camera{.pitch_mm = 1.2, .jitter_px = 0.06};
  test::BallOnGel<> ball({.friction = 5});
  test::Random random(3);
  StickRatio<> stick(camera.dot_rows(), camera.dot_cols(), options);
  ContactFlags contact(stick.rows(), stick.cols(), all_touch ? 1 : 0);
  std::string said;
  for (int k = 0; k <= frames; ++k) {
    ball.drag(10, {0.1 * k, 0});
    const auto dots = camera.dots(ball, random);
    for (std::size_t n = 0; n < dots.cells.size() && !all_touch; ++n) {
      const auto from_ball = camera.mm_of(dots.cells[n].y, dots.cells[n].x) - ball.ball_mm();
      contact.cells[n] = norm(from_ball) < 0.9 * ball.radius_mm() ? 1 : 0;
    }
    const auto r = stick(convert(dots), contact);
    said = r.updated() && r.stick_ratio < 0.9 ? "false slip" : name_of(r.status);
    CHECK((r.ok() || std::isnan(r.stick_ratio)));
    CHECK((said != "no outline" || std::isnan(r.stick_ratio)));
  }
  return said;
}

}  // namespace

TEST_CASE("mistakes with printed dots: all are said to touch", "[mistakes]") {
  const auto as_they_are = [](const PointsPx& dots) -> const PointsPx& { return dots; };
  const auto check = [](StickOptions options, const auto& convert) {
    CHECK(said_of_gel(options, false, convert) == "updated");
    CHECK(said_of_gel(options, true, convert) == "no outline");
    options.covers_pattern = true;  // is believed
    CHECK(said_of_gel(options, true, convert) == "false slip");
  };
  check({.noise = 0.06}, as_they_are);
  check({.noise = 0.005}, in_space);
}
