// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// How long before an object slides as a whole, in steps of finite-element scenes, a stick ratio
// below 0.5 and the published friction ratio warn, and how often they warn for nothing.
// test_figures "[slip_warning]" -s prints all figures.
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "fingerpad/published/friction_ratio.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/spatial_scene.hpp"

using namespace fingerpad;
using test::SpatialScene;

namespace {

/// A warning method on the recordings of a scene.
struct Warner {
  std::vector<std::vector<double>> leads;  ///< per slide, of each recording with a warning
  double calm = 0, false_warnings = 0;     ///< steps in which more than 0.95 sticks

  void reset() { since_ = -1, slides_ = 0, sliding_ = false; }
  /// `sticks` is the true share in step k.
  void add(Index k, double sticks, bool warns) {
    if (sticks > 0.95) {
      calm += 1;
      false_warnings += warns ? 1 : 0;
      since_ = -1;
    }
    if (sliding_ && sticks > 0.3) {
      sliding_ = false, since_ = -1;
    }
    since_ = !sliding_ && warns && since_ < 0 && sticks < 0.95 ? k : since_;
    if (!sliding_ && sticks < 0.05) {
      sliding_ = true;
      if (leads.size() <= slides_) {
        leads.emplace_back();
      }
      if (since_ >= 0 && since_ < k) {
        leads[slides_].push_back(static_cast<double>(k - since_));
      }
      ++slides_;
    }
  }
  double false_share() const { return false_warnings / calm; }
  double mean_lead(std::size_t slide) const {
    double sum = 0;
    for (const double lead : leads[slide]) {
      sum += lead;
    }
    return leads[slide].empty() ? 0 : sum / static_cast<double>(leads[slide].size());
  }

 private:
  Index since_ = -1;
  std::size_t slides_ = 0;
  bool sliding_ = false;
};

struct Warners {
  Warner image, dots, fused, friction_ratio;
};

constexpr int recordings = 10;

Warners warned_on(const std::string& name) {
  const SpatialScene scene(name);
  const Index across = scene.dots_across();
  const StickRatio<> fresh(across, across, {.noise = 0.005});
  Warners w;
  for (int seed = 1; seed <= recordings; ++seed) {
    test::Random random(static_cast<std::uint64_t>(seed));
    StickRatio<> ratio = fresh, in_image = fresh;
    test::Image<Point2<double>> flat(across, across);
    FrictionLimit<double> limit;
    published::FrictionRatio<double> friction;
    w.image.reset(), w.dots.reset(), w.fused.reset(), w.friction_ratio.reset();
    for (Index k = 0; k < scene.size(); ++k) {
      auto dots = scene[k].dots;
      for (auto& p : dots.cells) {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        p = {p.x + 0.005 * x, p.y + 0.005 * y, p.z + 0.025 * z};
      }
      for (std::size_t at = 0; at < dots.cells.size(); ++at) {
        flat.cells[at] = {dots.cells[at].x, dots.cells[at].y};  // as seen from straight above
      }
      const auto seen = in_image(flat, scene[k].contact);
      const auto r = ratio(dots, scene[k].contact);
      const auto load =
          contact_load(test::noisy(scene[k].force_n, 0.015, random),
                       test::noisy(scene[k].moment_n_mm, 0.02, random), dots, scene[k].contact);
      const auto slip = limit(load, r);
      // as on its page, the stick ratio reports when the object slides
      const bool slides = r.updated() && r.stick_ratio < 0.1;
      const double margin = friction(load.tangential_n, load.normal_n, slides);
      const double sticks = scene[k].stick_ratio;
      const auto warns = [](RatioUpdate update, double of) {
        return (update == RatioUpdate::fresh || update == RatioUpdate::unmoved) && of < 0.5;
      };
      w.image.add(k, sticks, warns(update_of(seen.status), static_cast<double>(seen.stick_ratio)));
      w.dots.add(k, sticks, warns(update_of(r.status), r.stick_ratio));
      w.fused.add(k, sticks, warns(slip.update, slip.stick_ratio));
      w.friction_ratio.add(k, sticks, slides || margin < 0.1);
    }
  }
  return w;
}

/// "10 of 10 by 3.8, ... false 0.00": for each slide, the warned recordings and the lead in steps.
std::string figures(const Warner& w) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1);
  for (std::size_t slide = 0; slide < w.leads.size(); ++slide) {
    text << w.leads[slide].size() << " of " << recordings << " by " << w.mean_lead(slide) << ", ";
  }
  text << "false " << std::setprecision(3) << w.false_share();
  return text.str();
}

}  // namespace

TEST_CASE("warning before an object slides, on finite-element membranes", "[slip_warning]") {
  for (const char* name :
       {"drag", "twist", "tilt", "mix", "slide", "cylinder", "ball_slip", "rod_turn"}) {
    const Warners w = warned_on(name);
    INFO(name << "\n  image: " << figures(w.image) << "\n  dots: " << figures(w.dots)
              << "\n  fused: " << figures(w.fused)
              << "\n  friction ratio: " << figures(w.friction_ratio));
    CHECK(w.dots.false_share() == 0);
    CHECK(w.fused.false_share() == 0);
    REQUIRE(!w.fused.leads.empty());
    for (std::size_t slide = 0; slide < w.fused.leads.size(); ++slide) {
      CHECK(w.fused.leads[slide].size() == recordings);  // a warning before every slide
      CHECK(w.fused.mean_lead(slide) >= 1);
    }
  }
}

TEST_CASE("no warning of what rolls or is pressed and sticks", "[slip_warning]") {
  for (const char* name : {"roll", "press"}) {
    const Warners w = warned_on(name);
    INFO(name << "\n  image: " << figures(w.image) << "\n  fused: " << figures(w.fused)
              << "\n  friction ratio: " << figures(w.friction_ratio));
    CHECK(w.fused.false_share() == 0);
    CHECK(w.friction_ratio.false_share() == 0);
  }
}
