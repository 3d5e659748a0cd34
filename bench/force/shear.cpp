// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Tangential force and moment by look-up, of 4096 contacts ("ns/pixel" is per contact). "as
// printed": eqs. 4 and 5 by std::pow, one line each, without checks of contact or bad input.
// Errors: of each contact's moment and of the force along x, against long double, relative to the
// largest. "with normal force": additionally the normal force by area and by depth, fused by their
// variances.
#include "fingerpad/force/shear.hpp"

#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "bench/support/contacts.hpp"
#include "bench/support/run.hpp"
#include "fingerpad/force/normal_force.hpp"
#include "fingerpad/published/normal_force.hpp"
#include "fingerpad/published/shear.hpp"

using namespace fingerpad;

namespace {

constexpr double largest_mm2 = 400, largest_mm = 15;
using Long = long double;

template <class S>
struct Out {
  std::vector<S> cells;
  explicit Out(Index frames) : cells(static_cast<std::size_t>(3 * frames)) {}
  StridedView<S> view() {
    const Index frames = static_cast<Index>(cells.size()) / 3;
    return {cells.data(), frames, 3, 1, frames};
  }
  std::vector<S> column(Index k) const {
    const Index frames = static_cast<Index>(cells.size()) / 3;
    return {cells.begin() + k * frames, cells.begin() + (k + 1) * frames};
  }
};

template <class S, class Map>
void note_shear(bench::Counters& counters,
                bench::Contacts<S>& contacts,
                const Shear<Map>& truth,
                const Out<S>& out) {
  std::vector<Long> moments, forces;
  for (Index k = 0; k < contacts.frames; ++k) {
    const auto exact =
        truth(Long(contacts.at(k, 0)), {Long(contacts.at(k, 1)), Long(contacts.at(k, 2))},
              Long(contacts.at(k, 3)));
    moments.push_back(exact.moment_n_mm);
    forces.push_back(exact.tangential_force_n.x);
  }
  bench::note_errors(counters, "moment", "share", bench::share_errors(out.column(2), moments));
  bench::note_errors(counters, "force", "share", bench::share_errors(out.column(0), forces));
}

template <class S>
std::string row(const std::string& name) {
  return "4096 contacts/" + name + (sizeof(S) == sizeof(float) ? ", float" : ", double");
}

/// Calls `of(measure, displacement, angle, row of three results)` for each contact.
template <class S, class Work, class Map>
void add_each(const std::string& name,
              const Work& of,
              const Shear<Map>& truth,
              double largest = largest_mm2) {
  const auto contacts = std::make_shared<bench::Contacts<S>>(largest);
  const bench::Memory memory;
  const auto out = std::make_shared<Out<S>>(contacts->frames);
  bench::add(
      row<S>(name), static_cast<std::size_t>(contacts->frames), memory.bytes(),
      [=] {
        const auto to = out->view();
        for (Index k = 0; k < contacts->frames; ++k) {
          of(contacts->at(k, 0), Point2<S>{contacts->at(k, 1), contacts->at(k, 2)},
             contacts->at(k, 3), to, k);
        }
      },
      [=](auto& counters) { note_shear(counters, *contacts, truth, *out); });
}

template <class Result, class To>
void fill(const Result& result, const To& to, Index k) {
  to(k, 0) = result.tangential_force_n.x;
  to(k, 1) = result.tangential_force_n.y;
  to(k, 2) = result.moment_n_mm;
}

template <class S, class Map, class TrueMap>
void add_shear(const std::string& name,
               const Shear<Map>& shear,
               const Shear<TrueMap>& truth,
               double largest = largest_mm2) {
  add_each<S>(
      name,
      [=](const S& measure, const Point2<S>& d, const S& theta, const auto& to, Index k) {
        fill(shear(measure, d, theta), to, k);
      },
      truth, largest);
}

template <class S>
RadialShear<1, S> linear() {
  return {{{S(2)}, not_a_number<S>()}, {{S(250)}, not_a_number<S>()}};
}
template <class S>
RadialShear<2, S> curved() {
  return {{{S(2), -S(1) / S(8)}, S(3)}, {{S(250), S(10)}, S(1)}};
}
template <class S>
LinearShear<S> any_linear() {
  return {S(2), S(0.25), S(-0.25), S(1.5), {S(0), S(0)}, S(250), S(0)};
}

/// The constants in the truth are also those of S.
template <class S>
ShearNormalisation<Long> exactly(const ShearNormalisation<S>& n) {
  return {Long(n.reference), Long(n.displacement_exponent), Long(n.rotation_exponent)};
}

template <class S>
void add_all() {
  const auto by_area = published::shear_normalisation_by_area<S>(),
             by_depth = published::shear_normalisation_by_depth<S>();
  const auto by_radius = shear_by_radius<S>(S(6));
  const Shear shear(by_area, linear<S>());
  const Shear shear_curved(by_area, curved<S>());
  const Shear truth(exactly(by_area), linear<Long>());
  const Shear truth_curved(exactly(by_area), curved<Long>());
  const Shear shear_any(by_area, any_linear<S>());
  const Shear truth_any(exactly(by_area), any_linear<Long>());
  add_each<S>(
      "published: as printed",
      [](const S& area, const Point2<S>& d, const S& theta, const auto& to, Index k) {
        const S by_d = S(2) * std::pow(area / S(100), S(0.65));
        to(k, 0) = by_d * d.x;
        to(k, 1) = by_d * d.y;
        to(k, 2) = S(250) * std::pow(area / S(100), S(1.7)) * theta;
      },
      truth);
  add_shear<S>("RadialShear<1>, the default", shear, truth);
  add_shear<S>("RadialShear<2>", shear_curved, truth_curved);
  add_shear<S>("LinearShear", shear_any, truth_any);
  add_shear<S>("RadialShear<1> by depth", Shear(by_depth, linear<S>()),
               Shear(exactly(by_depth), linear<Long>()), largest_mm);
  add_shear<S>("RadialShear<1> by radius", Shear(by_radius, linear<S>()),
               Shear(exactly(by_radius), linear<Long>()), largest_mm);
  const CurveErrors<3, S> errors{{{{S(1e-4), 0, 0}, {0, S(1e-6), 0}, {0, 0, S(1e-9)}}}, S(0.1)};
  const NormalForce force_by_area(published::force_of_area<S>(), ScaledCompensation<S>{}, errors);
  const NormalForce force_by_depth(published::force_of_depth<S>(), ScaledCompensation<S>{}, errors);
  add_each<S>(
      "with normal force",
      [=](const S& area, const Point2<S>& d, const S& theta, const auto& to, Index k) {
        const S depth_mm = area / S(80);
        benchmark::DoNotOptimize(
            fused(force_by_area(area, d, theta), force_by_depth(depth_mm, d, theta)).force_n);
        fill(shear(area, d, theta), to, k);
      },
      truth);
}

/// One power per contact; the look-up needs two.
template <class S>
void add_opencv() {
  const auto contacts = std::make_shared<bench::Contacts<S>>(largest_mm2);
  const bench::Memory memory;
  const auto powers =
      std::make_shared<std::vector<S>>(contacts->cells.begin(), contacts->cells.begin() + 4096);
  const long bytes = memory.bytes();
  const int type = cv::DataType<S>::type;
  bench::add(
      row<S>("cv::pow, once"), 4096, bytes,
      [=] {
        const cv::Mat from(4096, 1, type, contacts->cells.data());
        cv::Mat to(4096, 1, type, powers->data());
        cv::pow(from, 0.65, to);
        benchmark::DoNotOptimize(powers->data());
      },
      [](auto&) {});
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  add_all<double>();
  add_all<float>();
  add_opencv<double>();
  add_opencv<float>();
  bench::add_streaming("4096 contacts");
  return bench::run(argc, argv);
}
