// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Displacement and rotation of a contact from 21 x 21 dots, 69 of them in contact ("ns/pixel" is
// per dot of the grid), with 0.005 mm of noise; "stuck" rows with every seventh dot left where it
// was. Errors: of the displacement in mm, and of the angle in rad.
#include "fingerpad/contact_shift.hpp"

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "support/run.hpp"

using namespace fingerpad;

namespace {

constexpr Index side = 21;
constexpr double pitch_mm = 1.5, radius_mm = 7, angle_rad = 0.05;
constexpr Point2<double> moved_mm{0.7, -0.4};

template <class S>
struct Scene {
  std::vector<Point2<S>> from, to;
  std::vector<unsigned char> touch;

  explicit Scene(bool stuck) {
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0, 0.005);
    for (Index k = 0; k < side * side; ++k) {
      const double x = pitch_mm * static_cast<double>(k % side - side / 2);
      const double y = pitch_mm * static_cast<double>(k / side - side / 2);
      const bool stays = stuck && k % 7 == 0;
      const double c = stays ? 1 : std::cos(angle_rad), s = stays ? 0 : std::sin(angle_rad);
      const Point2<double> shift = stays ? Point2<double>{0, 0} : moved_mm;
      from.push_back({S(x), S(y)});
      to.push_back(
          {S(c * x - s * y + shift.x + noise(random)), S(s * x + c * y + shift.y + noise(random))});
      touch.push_back(std::hypot(x, y) < radius_mm ? 1 : 0);
    }
  }
  static auto grid(const auto& cells) { return StridedView(cells.data(), side, side, side); }
};

template <class S, class Dots, class Mean>
void add(const std::string& name, bool stuck, const Dots& dots, const Mean& mean) {
  struct Data {
    Scene<S> scene;
    ContactShift<Dots, Mean, S> shift;
    typename ContactShift<Dots, Mean, S>::Workspace workspace = shift.workspace();
    ShiftResult<S> result = {};
  };
  const Scene<S> scene(stuck);
  const auto d = std::make_shared<Data>(
      Data{scene, ContactShift<Dots, Mean, S>(Scene<S>::grid(scene.from), dots, mean)});
  bench::add(
      name, static_cast<std::size_t>(side * side),
      [d] {
        d->result =
            d->shift(d->scene.grid(d->scene.to), d->scene.grid(d->scene.touch), d->workspace);
      },
      [d](auto& counters) {
        const auto& r = d->result;
        counters["max_error_mm"] = std::hypot(static_cast<double>(r.displacement.x) - moved_mm.x,
                                              static_cast<double>(r.displacement.y) - moved_mm.y);
        counters["max_error_rad"] = std::abs(static_cast<double>(r.rotation_rad) - angle_rad);
      });
}

}  // namespace

int main(int argc, char** argv) {
  for (const bool stuck : {false, true}) {
    const std::string group = stuck ? "stuck dots/" : "noise only/";
    add<double>(group + "central dot", stuck, central_dot(side, side), PlainMean());
    add<double>(group + "ContactDots", stuck, ContactDots(), PlainMean());
    add<double>(group + "EdgeDots", stuck, EdgeDots(), PlainMean());
    add<double>(group + "EdgeDots, HuberMean", stuck, EdgeDots(), HuberMean());
    add<float>(group + "EdgeDots, HuberMean, float", stuck, EdgeDots(), HuberMean());
  }
  return bench::run(argc, argv);
}
