// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Tangential force and moment by look-up, of 4096 contacts ("ns/pixel" is per contact). "as
// printed": eqs. 4 and 5 by std::pow, one line each, without checks of contact or bad input.
// Errors: of each contact's moment and of the force along x, against long double, relative to the
// largest.

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "bench/support/contacts.hpp"
#include "bench/support/run.hpp"
#include "fingerpad/force/look_up.hpp"
#include "fingerpad/published/look_up.hpp"
#include "support/curves.hpp"

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
  std::vector<S> column(Index k) const {
    const Index frames = static_cast<Index>(cells.size()) / 3;
    return {cells.begin() + k * frames, cells.begin() + (k + 1) * frames};
  }
};

template <class S>
void note_shear(bench::Counters& counters,
                bench::Contacts<S>& contacts,
                const Shear<Long>& truth,
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
template <class S, class Work>
void add_each(const std::string& name, const Work& of, const Shear<Long>& truth) {
  const auto contacts = std::make_shared<bench::Contacts<S>>(largest_mm2);
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

/// The constants in the truth are also those of S.
template <class S>
ShearMap<Long> exactly(const ShearMap<S>& m) {
  const auto law = [](const ShearLaw<S>& of) {
    return ShearLaw<Long>{Long(of.slope), Long(of.exponent), Long(of.to)};
  };
  return {Long(m.reference), law(m.force), law(m.moment)};
}

template <class S>
void add_all() {
  const auto by_area = test::map_of(published::shear_by_area(S(2), S(250)));
  const Shear shear(by_area);
  const Shear truth(exactly(by_area));
  if constexpr (std::is_same_v<S, double>) {
    add_each<S>(
        "published: as printed",
        [](const S& area, const Point2<S>& d, const S& theta, const auto& to, Index k) {
          const S by_d = S(2) * std::pow(area / S(100), S(0.65));
          to(k, 0) = by_d * d.x;
          to(k, 1) = by_d * d.y;
          to(k, 2) = S(250) * std::pow(area / S(100), S(1.7)) * theta;
        },
        truth);
  }
  add_each<S>(
      "straight lines, the default",
      [=](const S& measure, const Point2<S>& d, const S& theta, const auto& to, Index k) {
        fill(shear(measure, d, theta), to, k);
      },
      truth);
}

/// One power per contact; the look-up needs two.
void add_opencv() {
  const auto contacts = std::make_shared<bench::Contacts<double>>(largest_mm2);
  const bench::Memory memory;
  const auto powers = std::make_shared<std::vector<double>>(contacts->cells.begin(),
                                                            contacts->cells.begin() + 4096);
  const long bytes = memory.bytes();
  bench::add(
      row<double>("cv::pow, once"), 4096, bytes,
      [=] {
        const cv::Mat from(4096, 1, CV_64F, contacts->cells.data());
        cv::Mat to(4096, 1, CV_64F, powers->data());
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
  add_opencv();
  bench::add_streaming("4096 contacts");
  return bench::run(argc, argv);
}
