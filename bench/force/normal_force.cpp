// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Normal force by look-up, of 4096 contacts ("ns/pixel" is per contact). "as printed": eqs. 18 and
// 21 without checks of range, contact or bad input. Error of each contact: rounding, against long
// double, relative to the largest force; of "as printed", against itself. The error of the curve
// itself depends on its calibration: docs/force/normal_force.md has it for finite elements.
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

constexpr double largest_mm2 = 400, largest_depth_mm = 5, largest_radius_mm = 12;
using Long = long double;

/// `force(measure, displacement, angle)` of contact k in the scalar T.
template <class T, class S, class Force>
T force_of(const Force& force, bench::Contacts<S>& contacts, Index k) {
  return force(T(contacts.at(k, 0)), Point2<T>{T(contacts.at(k, 1)), T(contacts.at(k, 2))},
               T(contacts.at(k, 3)));
}

template <class S, class Truth>
void note(bench::Counters& counters,
          const Truth& truth,
          bench::Contacts<S>& contacts,
          const std::vector<S>& found) {
  std::vector<Long> true_n;
  for (Index k = 0; k < contacts.frames; ++k) {
    true_n.push_back(force_of<Long>(truth, contacts, k));
  }
  bench::note_errors(counters, "force", "share", bench::share_errors(found, true_n));
}

/// Adds a row that calls `make(S())`, a force(measure, displacement, angle) in the scalar S, for
/// each contact.
template <class S, class Make>
void add_each(const std::string& name, double largest, const Make& make) {
  const auto contacts = std::make_shared<bench::Contacts<S>>(largest);
  const bench::Memory memory;
  const auto out = std::make_shared<std::vector<S>>(contacts->frames);
  bench::add(
      name, out->size(), memory.bytes(),
      [=, force = make(S())] {
        for (Index k = 0; k < contacts->frames; ++k) {
          (*out)[static_cast<std::size_t>(k)] = force_of<S>(force, *contacts, k);
        }
      },
      [=](auto& counters) { note(counters, make(Long()), *contacts, *out); });
}

/// The force of a NormalForce as a plain number.
template <class Estimator>
auto number_of(const Estimator& estimator) {
  return [=](const auto& measure, const auto&, const auto&) { return estimator(measure).force_n; };
}

/// `make(S())` returns a NormalForce in the scalar S.
template <class S, class Make>
void add_plain(const std::string& type,
               const std::string& name,
               const Make& make,
               double largest = largest_mm2) {
  add_each<S>("one frame, " + type + "/" + name, largest,
              [=](auto number) { return number_of(make(number)); });
}

template <class S>
ForceCurve<S> with_errors(ForceCurve<S> curve) {
  S variance = S(1e-4);
  for (std::size_t k = 0; k < 3; ++k) {
    curve.covariance[k][k] = variance;
    variance *= S(1e-2);
  }
  curve.residual_sd_n = S(0.1);
  return curve;
}

/// The quadratic of eq. 18.
template <class S>
void add_opencv(const std::string& group) {
  const auto contacts = std::make_shared<bench::Contacts<S>>(largest_mm2);
  const bench::Memory memory;
  const auto squares = std::make_shared<std::vector<S>>(contacts->frames);
  const auto out = std::make_shared<std::vector<S>>(contacts->frames);
  bench::add(
      group + "/cv::pow and cv::addWeighted", out->size(), memory.bytes(),
      [=] {
        const auto row = [](S* cells) {
          return cv::Mat(1, int(bench::Contacts<S>::frames), cv::DataType<S>::type, cells);
        };
        const cv::Mat areas = row(contacts->cells.data());
        cv::Mat powers = row(squares->data()), forces = row(out->data());
        cv::pow(areas, 2, powers);
        cv::addWeighted(powers, 0.00008, areas, 0.0191, 0.6242, forces);
      },
      [](auto&) {});
}

template <class S>
void add_all(const std::string& type) {
  const std::string single = "one frame, " + type;
  add_each<S>(single + "/published, as printed", largest_mm2, [](auto) {
    return [](const auto& area, const auto& d, const auto&) {
      using T = std::remove_cvref_t<decltype(area)>;
      using std::sqrt;
      const T plain = T(0.00008) * area * area + T(0.0191) * area + T(0.6242);
      return T(T(0.748) * plain - T(0.637) * sqrt(d.x * d.x + d.y * d.y) + T(1.7));
    };
  });
  add_plain<S>(type, "NormalForce",
               []<class T>(T) { return NormalForce(test::curve_of_area<T>()); });
  add_each<S>(single + "/published::NormalForce, published", largest_mm2,
              []<class T>(T) { return published::normal_force_by_area<T>(); });
  add_each<S>(single + "/published::NormalForce by depth, published", largest_depth_mm,
              []<class T>(T) { return published::normal_force_by_depth<T>(); });
  add_each<S>(single + "/power law, published", largest_radius_mm, [](auto) {
    return []<class T>(const T& radius_mm, const Point2<T>&, const T&) {
      return radius_mm > T(0) ? published::force_of_radius_n(radius_mm, T(6), T(1) / T(3)) : T(0);
    };
  });
  add_each<S>(single + "/NormalForce, variance", largest_mm2, []<class T>(T) {
    return number_of(NormalForce(with_errors(test::curve_of_area<T>())));
  });
  bench::add_streaming(single, static_cast<std::size_t>(bench::Contacts<S>::frames));
  add_opencv<S>(single);
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  add_all<double>("double");
  return bench::run(argc, argv);
}
