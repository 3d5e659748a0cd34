// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Motion of an object from the dots in contact. "ns/pixel" is per update or per frame. Errors of a
// rotation: what a shear of 0.2 of the neighbourhood makes it err, and what noise does. Errors of a
// frame: of the attitude after a ball has rolled 30 mm, rms over ten rolls. Noise: 0.02 mm in the
// plane, 0.05 mm in depth.
#include "fingerpad/object_motion.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "../tests/support/rolling.hpp"
#include "support/run.hpp"

using namespace fingerpad;

namespace {

constexpr double degrees = 180 / std::numbers::pi;

template <class S>
Neighbourhood<S> as(const Neighbourhood<double>& n) {
  Neighbourhood<S> out;
  for (std::size_t k = 0; k < 9; ++k) {
    out.dot[k] = {S(n.dot[k].x), S(n.dot[k].y), S(n.dot[k].z)};
    out.found[k] = n.found[k];
  }
  return out;
}

template <class Local>
double shear_error_deg() {
  const auto before = test::nine_dots();
  auto after = before;
  for (auto& p : after.dot) {
    p.x += 0.2 * p.y;
  }
  // a shear by 0.2 turns the neighbourhood by atan(0.1) about its normal besides deforming it
  const auto turn = Local::turn(before, after).rotation;
  const auto true_turn = test::turned_by({0, 0, -std::atan(0.1)});
  const auto a = zyx_angles(turn);
  return degrees * angle_between(rotation_of(a), true_turn);
}

template <class Local>
double noise_error_deg() {
  test::Gauss gauss(7);
  double sum_sq = 0;
  for (int k = 0; k < 1000; ++k) {
    const auto before = test::nine_dots();
    auto after = before;
    for (auto& p : after.dot) {
      p = {p.x + 0.02 * gauss(), p.y + 0.02 * gauss(), p.z + 0.05 * gauss()};
    }
    sum_sq +=
        square(degrees * angle_between(rotation_of(zyx_angles(Local::turn(before, after).rotation)),
                                       Rotation<double>()));
  }
  return std::sqrt(sum_sq / 1000);
}

/// From an anchor to now, composed with what was before, and the angles.
template <class Local, class S>
void add_rotation(const std::string& name) {
  struct Data {
    Neighbourhood<S> anchor = as<S>(test::nine_dots());
    Neighbourhood<S> now = as<S>(test::nine_dots());
    Rotation<S> before = rotation_of(Angles<S>{S(0.1), S(-0.2), S(0.3)});
    Angles<S> angles;
  };
  const auto d = std::make_shared<Data>();
  const auto turn = rotation_of(Angles<S>{S(-0.2), S(0.1), S(0.05)});
  for (auto& p : d->now.dot) {
    p = turn(p);
  }
  bench::add(
      "rotation update/" + name, 1,
      [d] {
        benchmark::DoNotOptimize(d->now.dot.data());
        d->angles = zyx_angles(Local::turn(d->anchor, d->now).rotation * d->before);
      },
      [](auto& counters) {
        counters["shear_error_deg"] = shear_error_deg<Local>();
        counters["noise_error_deg"] = noise_error_deg<Local>();
      });
}

/// A roll of 30 mm in a circle, in 300 frames.
struct Roll {
  explicit Roll(std::uint64_t seed) : initial(test::RollingBall().initial()) {
    test::Gauss gauss(seed);
    const auto x = [](int k) { return 4.8 * std::cos(k * 0.0208) + 0.2; };
    const auto y = [](int k) { return 4.8 * std::sin(k * 0.0208) - 0.1; };
    test::Rolling roll(test::RollingBall(), x(0), y(0));
    for (int k = 0; k < 300; ++k) {
      roll.step(x(k), y(k));
      dots.push_back(noisy(roll.dots, roll.contact, gauss));
      contact.push_back(roll.contact);
    }
    truth = roll.pose.rotation;
  }

  test::Dots initial;
  std::vector<test::Dots> dots;
  std::vector<test::Flags> contact;
  Rotation<double> truth;
};

const std::vector<Roll>& rolls() {
  static const std::vector<Roll> all = [] {
    std::vector<Roll> r;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      r.emplace_back(seed);
    }
    return r;
  }();
  return all;
}

template <class Way, class S>
double roll_error_deg(const ObjectMotion<Way, S>& motion) {
  double sum_sq = 0;
  for (const Roll& roll : rolls()) {
    auto state = motion.start();
    Rotation<double> last;
    for (std::size_t k = 0; k < roll.dots.size(); ++k) {
      const auto r = motion(roll.dots[k], roll.contact[k], state).pose.rotation;
      for (int i = 0; i < 9; ++i) {
        last.m[i / 3][i % 3] = static_cast<double>(r.m[i / 3][i % 3]);
      }
    }
    sum_sq += square(degrees * angle_between(last, roll.truth));
  }
  return std::sqrt(sum_sq / static_cast<double>(rolls().size()));
}

template <class Way, class S = double>
void add_frame(const std::string& name, double margin_mm = 0, Way way = {}) {
  struct Running {
    ObjectMotion<Way, S> motion;
    typename ObjectMotion<Way, S>::State state = motion.start();
    std::size_t k = 0;
  };
  const Roll& roll = rolls().front();
  const auto d = std::make_shared<Running>(
      Running{ObjectMotion<Way, S>(roll.initial, {.reference_margin_mm = S(margin_mm)}, way)});
  bench::add(
      "frame of 21x21 dots/" + name, 1,
      [d, &roll] {
        if (d->k == roll.dots.size()) {
          d->k = 0;
          d->state = d->motion.start();
        }
        benchmark::DoNotOptimize(d->motion(roll.dots[d->k], roll.contact[d->k], d->state));
        ++d->k;
      },
      [d](auto& counters) { counters["rms_error_deg"] = roll_error_deg(d->motion); });
}

}  // namespace

int main(int argc, char** argv) {
  add_rotation<PublishedBasis, double>("PublishedBasis, double");
  add_rotation<SymmetricFrame, double>("SymmetricFrame, double, the default");
  add_rotation<SymmetricFrame, float>("SymmetricFrame, float");
  add_rotation<Kabsch, double>("Kabsch, double");
  add_rotation<Kabsch, float>("Kabsch, float");
  add_frame<SumOfAngles<>>("published: SumOfAngles<PublishedBasis>");
  add_frame<SumOfAngles<SymmetricFrame>>("SumOfAngles<SymmetricFrame>");
  add_frame<AnchoredComposition<>>("AnchoredComposition<SymmetricFrame>");
  add_frame<AnchoredComposition<>>("the same, reference kept within 0.2 mm", 0.2);
  add_frame<AnchoredComposition<Kabsch>>("AnchoredComposition<Kabsch>, 0.2 mm", 0.2);
  add_frame<ContactMap>("ContactMap, the default");
  add_frame<ContactMap>("ContactMap, no robust pass", 0, {.robust_passes = 0});
  add_frame<ContactMap, float>("ContactMap, float");
  return bench::run(argc, argv);
}
