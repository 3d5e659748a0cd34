// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Tangential force and moment by look-up, of 4096 contacts ("ns/pixel" is per contact). "as
// printed": eqs. 4 and 5 by std::pow and a line each, with nothing about contact or bad input.
// Error: largest difference of the moment from long double, as a share of the largest moment; of
// "as printed", from itself. "force and moment": normal force by area and by depth, fused by their
// variances, and both shear forces and the moment.
#include "fingerpad/shear.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "fingerpad/normal_force.hpp"
#include "support/contacts.hpp"
#include "support/run.hpp"

using namespace fingerpad;

namespace {

constexpr double largest_mm2 = 400;
using Long = long double;

template <class S>
struct Out {
  std::vector<S> cells;
  explicit Out(Index frames) : cells(static_cast<std::size_t>(3 * frames)) {}
  StridedView<S> view() {
    const Index frames = static_cast<Index>(cells.size()) / 3;
    return {cells.data(), frames, 3, 1, frames};
  }
  std::vector<S> moments() const {
    return {cells.begin() + static_cast<Index>(cells.size()) / 3 * 2, cells.end()};
  }
};

template <class S>
RadialShear<1, S> linear() {
  return {{{S(2)}, not_a_number<S>()}, {{S(250)}, not_a_number<S>()}};
}

/// The moment of each contact in long double.
template <class S, class Map>
double worst_moment(bench::Contacts<S>& contacts, const Shear<Map>& truth, const Out<S>& out) {
  std::vector<Long> moments;
  for (Index k = 0; k < contacts.frames; ++k) {
    moments.push_back(truth(Long(contacts.at(k, 0)), {0, 0}, Long(contacts.at(k, 3))).moment_n_mm);
  }
  return bench::worst_share(out.moments(), moments);
}

/// of(measure, displacement, angle, row of three results) for each contact.
template <class S, class Work, class Map>
void add_each(const std::string& name, const Work& of, const Shear<Map>& truth) {
  const auto contacts = std::make_shared<bench::Contacts<S>>(largest_mm2);
  const auto out = std::make_shared<Out<S>>(contacts->frames);
  bench::add(
      name, static_cast<std::size_t>(contacts->frames),
      [=] {
        const auto to = out->view();
        for (Index k = 0; k < contacts->frames; ++k) {
          of(contacts->at(k, 0), Point2<S>{contacts->at(k, 1), contacts->at(k, 2)},
             contacts->at(k, 3), to, k);
        }
      },
      [=](auto& counters) { counters["max_error_share"] = worst_moment(*contacts, truth, *out); });
}

template <class S, class Map, class TrueMap>
void add_batch(const std::string& name, const Shear<Map>& shear, const Shear<TrueMap>& truth) {
  const auto contacts = std::make_shared<bench::Contacts<S>>(largest_mm2);
  const auto out = std::make_shared<Out<S>>(contacts->frames);
  bench::add(
      name, static_cast<std::size_t>(contacts->frames),
      [=] { shear.for_samples(contacts->samples(), out->view()); },
      [=](auto& counters) { counters["max_error_share"] = worst_moment(*contacts, truth, *out); });
}

template <class S>
void add_all(const std::string& type) {
  const Shear<RadialShear<1, S>> shear(published_shear_by_area<S>(), linear<S>());
  const Shear<RadialShear<1, Long>> truth(published_shear_by_area<Long>(), linear<Long>());
  const RadialShear<2, S> cubic{{{S(2), S(-0.1)}, S(3)}, {{S(250), S(10)}, S(1)}};
  const RadialShear<2, Long> cubic_l{{{2, -0.1L}, 3}, {{250, 10}, 1}};
  const Shear<RadialShear<2, S>> curved(published_shear_by_area<S>(), cubic);
  const Shear<RadialShear<2, Long>> curved_l(published_shear_by_area<Long>(), cubic_l);
  const auto fill = [](const auto& result, const auto& to, Index k) {
    to(k, 0) = result.tangential_force_n.x;
    to(k, 1) = result.tangential_force_n.y;
    to(k, 2) = result.moment_n_mm;
  };
  const std::string single = "one frame, " + type + "/", batch = "many frames, " + type + "/";
  add_each<S>(
      single + "as printed",
      [](const S& area, const Point2<S>& d, const S& theta, const auto& to, Index k) {
        const S by_d = S(2) * std::pow(area / S(100), S(0.65));
        to(k, 0) = by_d * d.x;
        to(k, 1) = by_d * d.y;
        to(k, 2) = S(250) * std::pow(area / S(100), S(1.7)) * theta;
      },
      truth);
  add_each<S>(
      single + "RadialShear<1>",
      [=](const S& area, const Point2<S>& d, const S& theta, const auto& to, Index k) {
        fill(shear(area, d, theta), to, k);
      },
      truth);
  add_each<S>(
      single + "RadialShear<2>",
      [=](const S& area, const Point2<S>& d, const S& theta, const auto& to, Index k) {
        fill(curved(area, d, theta), to, k);
      },
      curved_l);
  const CurveErrors<3, S> errors{{{{S(1e-4), 0, 0}, {0, S(1e-6), 0}, {0, 0, S(1e-9)}}}, S(0.1)};
  const NormalForce by_area(published_force_of_area<S>(), ScaledCompensation<S>{}, errors);
  const NormalForce by_depth(published_force_of_depth<S>(), ScaledCompensation<S>{}, errors);
  add_each<S>(
      single + "force and moment",
      [=](const S& area, const Point2<S>& d, const S& theta, const auto& to, Index k) {
        const S depth_mm = area / S(80);
        benchmark::DoNotOptimize(
            fused(by_area(area, d, theta), by_depth(depth_mm, d, theta)).force_n);
        fill(shear(area, d, theta), to, k);
      },
      truth);
  add_batch<S>(batch + "RadialShear<1>", shear, truth);
  add_batch<S>(batch + "RadialShear<2>", curved, curved_l);
}

}  // namespace

int main(int argc, char** argv) {
  add_all<double>("double");
  add_all<float>("float");
  return bench::run(argc, argv);
}
