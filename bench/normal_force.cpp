// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Normal force by look-up, of 4096 contacts ("ns/pixel" is per contact). "as printed": eqs. 18 and
// 21 with nothing about range, contact or bad input. Error: largest difference from long double, as
// a share of the largest force; of "as printed", from itself.
#include "fingerpad/normal_force.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "support/contacts.hpp"
#include "support/run.hpp"

using namespace fingerpad;

namespace {

constexpr double largest_mm2 = 400;
using Long = long double;

/// Work on each contact: force(measure, displacement, angle).
template <class S, class Force, class Truth>
void add_each(const std::string& name, const Force& force, const Truth& truth) {
  const auto contacts = std::make_shared<bench::Contacts<S>>(largest_mm2);
  const auto out = std::make_shared<std::vector<S>>(contacts->frames);
  const auto visit = [=](auto& to, const auto& of, auto number) {
    using T = decltype(number);
    for (Index k = 0; k < contacts->frames; ++k) {
      to[static_cast<std::size_t>(k)] =
          of(T(contacts->at(k, 0)), Point2<T>{T(contacts->at(k, 1)), T(contacts->at(k, 2))},
             T(contacts->at(k, 3)));
    }
  };
  bench::add(
      name, static_cast<std::size_t>(contacts->frames), [=] { visit(*out, force, S()); },
      [=](auto& counters) {
        std::vector<Long> true_n(out->size());
        visit(true_n, truth, Long());
        counters["max_error_share"] = bench::worst_share(*out, true_n);
      });
}

template <class Estimator>
auto force_of(const Estimator& estimator) {
  return [=](const auto& measure, const auto& displacement, const auto& rotation) {
    return estimator(measure, displacement, rotation).force_n;
  };
}

/// All contacts in one call.
template <class Estimator, class Truth>
void add_batch(const std::string& name, const Estimator& estimator, const Truth& truth) {
  using S = typename Estimator::S;
  const auto contacts = std::make_shared<bench::Contacts<S>>(largest_mm2);
  const auto out = std::make_shared<std::vector<S>>(contacts->frames);
  bench::add(
      name, static_cast<std::size_t>(contacts->frames),
      [=] {
        estimator.for_samples(contacts->samples(),
                              StridedView<S>(out->data(), contacts->frames, 1, 1));
      },
      [=](auto& counters) {
        std::vector<Long> true_n;
        for (Index k = 0; k < contacts->frames; ++k) {
          true_n.push_back(truth(Long(contacts->at(k, 0)),
                                 Point2<Long>{Long(contacts->at(k, 1)), Long(contacts->at(k, 2))},
                                 Long(contacts->at(k, 3))));
        }
        counters["max_error_share"] = bench::worst_share(*out, true_n);
      });
}

template <class S>
void add_all(const std::string& type) {
  const auto printed = [](const auto& area, const auto& d, const auto&) {
    using T = std::remove_cvref_t<decltype(area)>;
    using std::sqrt;
    const T plain = T(0.00008) * area * area + T(0.0191) * area + T(0.6242);
    return T(T(0.748) * plain - T(0.637) * sqrt(d.x * d.x + d.y * d.y) + T(1.7));
  };
  const NormalForce plain(published_force_of_area<S>());
  const NormalForce published(published_force_of_area<S>(), published_compensation_by_area<S>());
  const ScaledCompensation<S> scaling{S(-0.02), S(0.5)};
  const NormalForce scaled(published_force_of_area<S>(), scaling);
  const CurveErrors<3, S> errors{{{{S(1e-4), 0, 0}, {0, S(1e-6), 0}, {0, 0, S(1e-9)}}}, S(0.1)};
  const NormalForce with_variance(published_force_of_area<S>(), scaling, errors);
  const PowerLawForce<S> power{S(6), S(1) / S(3), S(0), S(largest_mm2)};
  const NormalForce<PowerLawForce<S>> elastic(power);

  const NormalForce plain_l(published_force_of_area<Long>());
  const NormalForce published_l(published_force_of_area<Long>(),
                                published_compensation_by_area<Long>());
  const NormalForce scaled_l(published_force_of_area<Long>(),
                             ScaledCompensation<Long>{-0.02L, 0.5L});
  const NormalForce<PowerLawForce<Long>> elastic_l({6, 1 / 3.0L, 0, Long(largest_mm2)});

  const std::string single = "one frame, " + type + "/", batch = "many frames, " + type + "/";
  add_each<S>(single + "as printed", printed, printed);
  add_each<S>(single + "NoCompensation", force_of(plain), force_of(plain_l));
  add_each<S>(single + "ScaledCompensation", force_of(scaled), force_of(scaled_l));
  add_each<S>(single + "ScaledCompensation, variance", force_of(with_variance), force_of(scaled_l));
  add_each<S>(single + "PublishedCompensation", force_of(published), force_of(published_l));
  add_each<S>(single + "PowerLawForce", force_of(elastic), force_of(elastic_l));
  add_batch(batch + "NoCompensation", plain, force_of(plain_l));
  add_batch(batch + "ScaledCompensation", scaled, force_of(scaled_l));
  add_batch(batch + "PublishedCompensation", published, force_of(published_l));
}

}  // namespace

int main(int argc, char** argv) {
  add_all<double>("double");
  add_all<float>("float");
  return bench::run(argc, argv);
}
