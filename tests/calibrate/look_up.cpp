// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/look_up.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/force/look_up.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::begins_with;
using test::Random;
using test::refusal;

namespace {

using Sample = ForceSample<double>;
using Samples = std::vector<Sample>;

constexpr double infinity = std::numeric_limits<double>::infinity();

template <class S>
std::span<const ForceSample<S>> all(const std::vector<ForceSample<S>>& samples) {
  return samples;
}

/// A pad with known numbers. The measure is a depth in mm, or the radius of an elastic pad.
template <class S = double>
struct Pad {
  S constant = S(0), linear = S(0.5), square_term = S(0.3), cubic = S(0);
  S reference = S(2);
  S pull_1 = S(2), pull_exponent = S(0.7);
  S turn_1 = S(40), turn_exponent = S(1.6);

  S plain(const S& m) const { return ((cubic * m + square_term) * m + linear) * m + constant; }
  S factor(const ForceSample<S>& s, const S& exponent) const {
    return std::pow(s.measure / reference, exponent);
  }
  Point2<S> pull(const ForceSample<S>& s) const {
    return S(pull_1 * factor(s, pull_exponent)) * s.displacement_mm;
  }
  S turn(const ForceSample<S>& s) const {
    return S(turn_1 * factor(s, turn_exponent) * s.rotation_rad);
  }
};

/// Contacts of all sizes, displaced and rotated, at five loads; without forces.
template <class S = double>
std::vector<ForceSample<S>> contacts(int count, Random& random) {
  std::vector<ForceSample<S>> samples;
  for (int k = 0; k < count; ++k) {
    ForceSample<S> s;
    s.measure = S(random.uniform(0.4, 5));
    s.displacement_mm = {S(random.uniform(-1, 1)), S(random.uniform(-1, 1))};
    s.rotation_rad = S(random.uniform(-0.15, 0.15));
    s.load = k % 5;
    samples.push_back(s);
  }
  return samples;
}

constexpr double noise_n = 0.05;

/// All forces of a pad in one sample.
Samples measured(const Pad<>& pad, int count, Random& random, double sd = noise_n) {
  Samples samples = contacts(count, random);
  for (Sample& s : samples) {
    s.normal_force_n = pad.plain(s.measure) + sd * random.normal();
    const auto pull = pad.pull(s);
    s.tangential_force_n = {pull.x + sd * random.normal(), pull.y + sd * random.normal()};
    s.moment_n_mm = pad.turn(s) + sd * random.normal();
  }
  return samples;
}

/// Share of the fits with the truth within two standard errors, and size of the errors relative to
/// them.
class Coverage {
 public:
  explicit Coverage(const std::string& name) : name_(name) {}
  void add(double found, double truth, double standard_error) {
    const double z = (found - truth) / standard_error;
    within_ += std::abs(z) <= 2 ? 1 : 0;
    sum_sq_ += z * z;
    ++fits_;
  }
  /// Allows three standard deviations of a count around `expected`, and of the root mean square
  /// around `size`, with `slack` for standard errors that hold only for many samples.
  void check(double slack = 0, double expected = 0.95, double size = 1.02) const {
    const double share = within_ / fits_, rms = std::sqrt(sum_sq_ / fits_);
    CAPTURE(name_, share, rms, fits_);
    CHECK(share >= expected - 3 * std::sqrt(expected * (1 - expected) / fits_) - slack);
    CHECK(std::abs(rms - size) <= 3 / std::sqrt(2 * fits_) + slack);
  }

 private:
  std::string name_;
  double within_ = 0, sum_sq_ = 0, fits_ = 0;
};

/// Coverage of some parameters over fits of fresh samples. For each of them `fit(random)` returns
/// {found, truth, standard error}.
template <std::size_t N, class Fit>
void check_coverage(const std::array<const char*, N>& names, std::uint64_t seed, const Fit& fit) {
  std::vector<Coverage> coverage(names.begin(), names.end());
  Random random(seed);
  for (int k = 0; k < 200; ++k) {
    const std::array<std::array<double, 3>, N> found = fit(random);
    for (std::size_t i = 0; i < N; ++i) {
      coverage[i].add(found[i][0], found[i][1], found[i][2]);
    }
  }
  for (const Coverage& c : coverage) {
    c.check();
  }
}

double sd(double variance) {
  return std::sqrt(variance);
}

/// Variance of the force at a measure within the range, by the errors of the coefficients.
double variance_at(const ForceCurve<>& curve, double measure) {
  return NormalForce(curve)(measure).variance_n2 - square(curve.residual_sd_n);
}

}  // namespace

TEST_CASE("curves of the normal force are found within their errors", "[calibrate][force]") {
  const Pad<> pad;
  check_coverage<2>({"linear", "square"}, 1, [&](Random& random) {
    const auto samples = measured(pad, 60, random);
    const auto fit = fit_normal_force(all(samples));
    const auto& c = fit.curve.covariance;
    return std::array<std::array<double, 3>, 2>{
        {{fit.curve.coefficients[1], pad.linear, sd(c[1][1])},
         {fit.curve.coefficients[2], pad.square_term, sd(c[2][2])}}};
  });
  const Pad<> cubic{.constant = 0.3, .square_term = 0.05, .cubic = 0.06};
  check_coverage<5>({"constant", "linear", "square", "cubic", "force"}, 2, [&](Random& random) {
    const auto samples = measured(cubic, 60, random);
    const auto fit = fit_normal_force(all(samples), 3, false);
    const auto& c = fit.curve.covariance;
    const auto& p = fit.curve.coefficients;
    // The variance of a force uses the whole covariance.
    const double at = 3.3;
    const double variance = variance_at(fit.curve, at);
    return std::array<std::array<double, 3>, 5>{
        {{p[0], cubic.constant, sd(c[0][0])},
         {p[1], cubic.linear, sd(c[1][1])},
         {p[2], cubic.square_term, sd(c[2][2])},
         {p[3], cubic.cubic, sd(c[3][3])},
         {fit.curve.force_n(at), cubic.plain(at), sd(variance)}}};
  });
}

namespace {

void check_shear_coverage(bool given) {
  const Pad<> pad;
  CAPTURE(given);
  const auto row = [&](const auto& fit, double slope, double exponent) {
    // the slope at twice the reference depends on both parameters; a given exponent is no estimate
    const auto& v = fit.covariance;
    const double c = fit.law.slope, u = std::pow(2, fit.law.exponent);
    const double by_exponent = c * u * std::log(2.0);
    const double variance =
        u * u * v[0][0] + 2 * u * by_exponent * v[0][1] + by_exponent * by_exponent * v[1][1];
    CHECK((v[1][1] == 0) == given);
    const std::array<double, 3> first = {c, slope, sd(v[0][0])};
    const std::array<double, 3> last = {c * u, slope * std::pow(2, exponent), sd(variance)};
    const std::array<double, 3> exponents = {fit.law.exponent, exponent, sd(v[1][1])};
    return std::array<std::array<double, 3>, 3>{{first, last, given ? first : exponents}};
  };
  check_coverage<3>(
      {"slope", "slope at twice the reference", "displacement_exponent"}, 5, [&](Random& random) {
        const auto samples = measured(pad, 60, random);
        const auto fit = fit_tangential_force(
            all(samples), pad.reference, given ? std::optional(pad.pull_exponent) : std::nullopt);
        return row(fit, pad.pull_1, pad.pull_exponent);
      });
  check_coverage<3>(
      {"slope", "slope at twice the reference", "rotation_exponent"}, 6, [&](Random& random) {
        const auto samples = measured(pad, 60, random);
        const auto fit = fit_moment(all(samples), pad.reference,
                                    given ? std::optional(pad.turn_exponent) : std::nullopt);
        return row(fit, pad.turn_1, pad.turn_exponent);
      });
}

}  // namespace

TEST_CASE("shear is found within its errors, exponents searched or given", "[calibrate][force]") {
  check_shear_coverage(false);
  check_shear_coverage(true);
}

TEST_CASE("a calibration tells how far the next force is off", "[calibrate][force]") {
  const Pad<> pad;
  Coverage predicted("next force");
  Random random(8);
  for (int k = 0; k < 1000; ++k) {
    // few samples, so that the parameters matter as well
    const auto samples = measured(pad, 12, random);
    const auto fit = fit_normal_force(all(samples));
    ForceCurve<> curve = fit.curve;
    curve.from = 0.1;
    curve.to = 6;
    const NormalForce force(curve);
    const double at = random.uniform(0.4, 5);
    const auto found = force(at);
    predicted.add(found.force_n, pad.plain(at) + noise_n * random.normal(), sd(found.variance_n2));
  }
  predicted.check(0, 0.927, 1.118);  // Student's distribution, 10 degrees of freedom
}

TEST_CASE("samples without noise give back the parameters", "[calibrate][force]") {
  const Pad<> pad;
  Random random(9);
  const Samples samples = measured(pad, 30, random, 0);
  const auto compare = [&](double found, double truth) {
    CHECK(found == Approx(truth).epsilon(1e-13));  // a few hundred times the spacing
  };
  const auto normal = fit_normal_force(all(samples));
  compare(normal.curve.coefficients[1], pad.linear);
  compare(normal.curve.coefficients[2], pad.square_term);
  CHECK(normal.curve.coefficients[0] == 0);
  const auto pull = fit_tangential_force(all(samples), pad.reference);
  compare(pull.law.slope, pad.pull_1);
  compare(pull.law.exponent, pad.pull_exponent);
  const auto turn = fit_moment(all(samples), pad.reference);
  compare(turn.law.slope, pad.turn_1);
  compare(turn.law.exponent, pad.turn_exponent);
}

namespace {

/// Samples with noise and their fits, for properties of every calibration.
Samples any_samples(int count = 30) {
  Random random(static_cast<std::uint64_t>(test::whole(1, 1000000)));
  Pad<> pad;
  pad.linear = test::uniform(0.3, 1);
  pad.square_term = test::uniform(0.1, 0.5);
  pad.pull_exponent = test::uniform(0, 1);
  Samples samples = measured(pad, count, random, 0.1);
  return samples;
}

/// A parameter or standard error with its powers of the unit of force and of the unit of the
/// measure.
struct Number {
  double value;
  int force_power = 0;
  int measure_power = 0;
};
std::vector<Number> all_fits(const Samples& samples) {
  std::vector<Number> numbers;
  const auto normal = fit_normal_force(all(samples));
  for (int k = 1; k <= 2; ++k) {
    const auto i = static_cast<std::size_t>(k);
    numbers.push_back({normal.curve.coefficients[i], 1, -k});
    numbers.push_back({normal.curve.covariance[i][i], 2, -2 * k});
  }
  numbers.insert(numbers.end(), {{normal.curve.residual_sd_n, 1}, {normal.explained}});
  const auto pull = fit_tangential_force(all(samples), 2.0);
  numbers.insert(numbers.end(), {{pull.law.slope, 1},
                                 {pull.covariance[0][0], 2},
                                 {pull.law.exponent},
                                 {pull.covariance[1][1]},
                                 {pull.law.to}});
  const auto turn = fit_moment(all(samples), 2.0);
  numbers.insert(numbers.end(), {{turn.law.slope, 1}, {turn.law.exponent}, {turn.residual_sd, 1}});
  return numbers;
}

double worst_difference(const std::vector<Number>& a, const std::vector<Number>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = (std::max)(worst,
                       std::abs(a[i].value - b[i].value) / (std::max)(std::abs(b[i].value), 1e-3));
  }
  return worst;
}

}  // namespace

TEST_CASE("a calibration depends neither on order nor on units", "[calibrate][force]") {
  rc::prop("the order of the samples", [] {
    Samples samples = any_samples();
    const auto before = all_fits(samples);
    std::reverse(samples.begin(), samples.end());
    const std::ptrdiff_t first = test::whole(0, static_cast<std::ptrdiff_t>(samples.size()) - 1);
    std::rotate(samples.begin(), samples.begin() + first, samples.end());
    RC_ASSERT(worst_difference(all_fits(samples), before) < 1e-9);
  });
  rc::prop("the unit of force, to the last bit", [] {
    Samples samples = any_samples();
    const auto before = all_fits(samples);
    const int power = static_cast<int>(test::whole(-20, 20));
    for (Sample& s : samples) {
      s.normal_force_n = std::ldexp(s.normal_force_n, power);
      s.tangential_force_n = {std::ldexp(s.tangential_force_n.x, power),
                              std::ldexp(s.tangential_force_n.y, power)};
      s.moment_n_mm = std::ldexp(s.moment_n_mm, power);
    }
    const auto after = all_fits(samples);
    for (std::size_t i = 0; i < before.size(); ++i) {
      RC_ASSERT(after[i].value == std::ldexp(before[i].value, before[i].force_power * power));
    }
  });
  rc::prop("the unit of the measure, to the last bit", [] {
    Samples samples = any_samples();
    const int power = static_cast<int>(test::whole(-20, 20));
    const auto before = fit_normal_force(all(samples));
    for (Sample& s : samples) {
      s.measure = std::ldexp(s.measure, power);
    }
    const auto after = fit_normal_force(all(samples));
    RC_ASSERT(after.curve.to == std::ldexp(before.curve.to, power));
    for (int k = 0; k <= 2; ++k) {
      const auto i = static_cast<std::size_t>(k);
      RC_ASSERT(after.curve.coefficients[i] ==
                std::ldexp(before.curve.coefficients[i], -k * power));
    }
  });
}

TEST_CASE("a gauge is not tared if a constant explains most of the residual, in any unit",
          "[calibrate][force]") {
  // forces along the displacements; residuals of a size without direction, and a constant
  const auto told = [](double force, double residual, const Point2<double>& constant) {
    detail::PlaneVectors<double> d(4, 2), left(4, 2);
    d << 1, 0, -1, 0, 0, 1, 0, -1;
    left = residual * d;
    left.rowwise() += Eigen::RowVector2d(constant.x, constant.y);
    return detail::gauge_mistake<double>(d, force * d, left);
  };
  for (const double unit : {1.0, 1e-4, 1e4}) {
    for (const Point2<double>& way : {Point2<double>{unit, 0}, {0, -unit}}) {
      CAPTURE(unit, way.x);
      CHECK(told(unit, 0.2 * unit, 0.21 * way) == std::string(cause::gauge_not_tared));
      CHECK(told(unit, 0.2 * unit, 0.19 * way) == nullptr);
      CHECK(told(unit, 0.01 * unit, 0.11 * way) == std::string(cause::gauge_not_tared));
      CHECK(told(unit, 0.01 * unit, 0.09 * way) == nullptr);
    }
  }
}

TEST_CASE("a gauge of the normal force is not tared, however small the forces",
          "[calibrate][force]") {
  // a force along the measure with a constant: it explains all of the residual, and matters from a
  // tenth of the largest force
  const auto told = [](double unit, double constant) {
    Samples samples(12);
    for (int k = 0; k < 12; ++k) {
      Sample& s = samples[static_cast<std::size_t>(k)];
      s.measure = 0.5 + 0.25 * k;
      s.normal_force_n = unit * ((1 - constant) * s.measure / 3.25 + constant);
      s.load = k % 3;
    }
    return fit_normal_force(all(samples), 1).cause;
  };
  for (const double unit : {10.0, 1.0, 0.5, 0.3}) {
    CAPTURE(unit);
    CHECK(told(unit, 0.11) == std::string(cause::gauge_not_tared));
    CHECK(told(unit, 0.09) == nullptr);
  }
}

TEST_CASE("a force that would fall is fitted by fewer powers", "[calibrate][force]") {
  Random random(13);
  Samples saturated = contacts(40, random);
  for (Sample& s : saturated) {
    s.normal_force_n = 4 * s.measure - 0.6 * square(s.measure) + 0.05 * random.normal();
  }
  const ForceCurve<> lower = fit_normal_force(all(saturated)).curve;
  CHECK(lower.coefficients == fit_normal_force(all(saturated), 1).curve.coefficients);
  // a curve that is far from falling is that of least squares
  const Samples rising = measured({}, 40, random);
  Eigen::MatrixXd columns(40, 2);
  Eigen::VectorXd forces(40);
  for (Index i = 0; i < 40; ++i) {
    const Sample& s = rising[static_cast<std::size_t>(i)];
    columns.row(i) << s.measure, square(s.measure);
    forces(i) = s.normal_force_n;
  }
  const Eigen::Vector2d best = columns.householderQr().solve(forces);
  const auto kept = fit_normal_force(all(rising));
  CHECK(kept.curve.coefficients[1] == Approx(best(0)));
  CHECK(kept.curve.coefficients[2] == Approx(best(1)));

  // NormalForce accepts every result of a fit
  std::set<std::string> complaints;
  int refused = 0;
  for (int k = 0; k < 80; ++k) {
    const double a = random.uniform(-2, 6), b = random.uniform(-1.5, 1.5);
    const double c = random.uniform(-0.2, 0.2);
    Samples samples = contacts(25, random);
    for (Sample& s : samples) {
      const double m = s.measure;
      s.normal_force_n = m * (a + m * (b + m * c)) + 0.2 * random.normal();
    }
    for (int degree = 1; degree <= 3; ++degree) {
      const std::string message = refusal([&] {
        const auto fit = fit_normal_force(all(samples), degree, k % 2 == 0);
        (void)NormalForce(fit.curve);
        for (int i = 0; i <= 200; ++i) {
          CHECK(fit.curve.slope(fit.curve.to * i / 200.0) > -1e-9);
        }
      });
      const bool falls = begins_with(message, "fit_normal_force: slope of the force");
      refused += falls ? 1 : 0;
      if (message != "accepted" && !falls) {
        complaints.insert(message);
      }
    }
  }
  CHECK((refused > 10 && refused < 150));
  for (const std::string& complaint : complaints) {
    FAIL_CHECK(complaint);
  }
}

TEST_CASE("options add what they name and nothing else", "[calibrate][force]") {
  Random random(14);
  const Pad<> pad{.constant = 0.6};
  const Samples samples = measured(pad, 80, random);
  const auto constant = fit_normal_force(all(samples), 2, false);
  CHECK(constant.curve.coefficients[0] == Approx(0.6).margin(0.1));
  CHECK(constant.curve.residual_sd_n == Approx(0.05).margin(0.015));
  const auto zero = fit_normal_force(all(samples));
  CHECK(zero.curve.coefficients[0] == 0);
  CHECK(zero.curve.covariance[0][0] == 0);
  CHECK(zero.curve.residual_sd_n > constant.curve.residual_sd_n);
  CHECK(zero.explained < constant.explained);
  const auto [least, most] = std::minmax_element(
      samples.begin(), samples.end(), [](auto& a, auto& b) { return a.measure < b.measure; });
  CHECK(zero.curve.from == least->measure);
  CHECK(zero.curve.to == most->measure);
}

TEST_CASE("predictions never use the load that is left out", "[calibrate][force]") {
  Random random(16);
  Samples samples = measured({}, 30, random);
  constexpr std::array<int, 5> loads = {7, -2, 0, 1000000, 3};  // interleaved and unordered
  for (Sample& s : samples) {
    s.load = loads[static_cast<std::size_t>(s.load)];
  }
  const auto fit = [](std::span<const Sample> rest) { return fit_normal_force(rest); };
  // what is predicted of each sample with the fit of the others
  const auto predicted = [&](const Samples& some) {
    std::vector<std::pair<int, double>> all_forces;  // and its load
    (void)leave_one_load_out(all(some), fit, [&](const auto& model, const Sample& s) {
      return all_forces.emplace_back(s.load, model.curve.force_n(s.measure)).second;
    });
    return all_forces;
  };
  const auto clean = predicted(samples);
  REQUIRE(clean.size() == 30);
  for (const int poisoned : loads) {
    Samples other = samples;
    for (Sample& s : other) {
      s.normal_force_n += s.load == poisoned ? s.measure : 0;
    }
    const auto found = predicted(other);
    for (std::size_t k = 0; k < clean.size(); ++k) {
      CHECK(found[k].first == clean[k].first);
      CHECK((found[k].second == clean[k].second) == (found[k].first == poisoned));
    }
  }
  // summed
  double sum = 0, worst = 0;
  const auto off = [&](const auto& model, const Sample& s) {
    const double error = model.curve.force_n(s.measure) - s.normal_force_n;
    sum += s.load == 3 ? 0 : std::abs(error);
    worst = s.load == 3 ? worst : (std::max)(worst, std::abs(error));
    return s.load == 3 ? test::nan : error;
  };
  const auto result = leave_one_load_out(all(samples), fit, off);
  CHECK(result.mean_abs == Approx(sum / 24).epsilon(1e-12));
  CHECK(result.worst == worst);
  CHECK(worst < 1.5);
  // unusable fits are refused; without samples there is no answer
  for (Sample& s : samples) {
    s.load = 1;
  }
  CHECK_THROWS_AS(leave_one_load_out(all(samples), fit, off), parameter_error);
  const auto none = leave_one_load_out(std::span<const Sample>(), fit, off);
  CHECK(none.mean_abs != none.mean_abs);
}

namespace {

template <class Fit>
void check_refused(const Fit& fit, const std::string& begin) {
  const std::string message = refusal([&] { (void)fit(); });
  CAPTURE(message, begin);
  CHECK(begins_with(message, begin));
}

template <class Change>
Samples changed(Samples samples, const Change& change) {
  for (Sample& s : samples) {
    change(s);
  }
  return samples;
}

}  // namespace

TEST_CASE("samples that do not tell the parameters are refused by name", "[calibrate][force]") {
  Random random(17);
  const Samples good = measured({}, 40, random);
  const auto normal = [](const Samples& samples, int degree = 2, bool through_zero = true) {
    return [=, &samples] { return fit_normal_force(all(samples), degree, through_zero); };
  };
  const auto pull = [](const Samples& samples, const std::optional<double>& exponent = {}) {
    return [&samples, exponent] { return fit_tangential_force(all(samples), 2.0, exponent); };
  };
  const auto turn = [](const Samples& samples, const std::optional<double>& exponent = {}) {
    return [&samples, exponent] { return fit_moment(all(samples), 2.0, exponent); };
  };
  SECTION("too few") {
    const Samples none, one(good.begin(), good.begin() + 1), two(good.begin(), good.begin() + 2);
    check_refused(normal(none), "fit_normal_force: usable samples = 0, must be > 0");
    check_refused(normal(two), "fit_normal_force: usable samples = 2, must be > 2");
    check_refused(pull(one), "fit_tangential_force: usable samples = 2, must be > 2");
    check_refused(pull(none), "fit_tangential_force: usable samples = 0");
    check_refused(turn(two), "fit_moment: usable samples = 2, must be > 2");
  }
  SECTION("all measures alike") {
    const auto alike = changed(good, [](Sample& s) { s.measure = 3; });
    check_refused(normal(alike), "fit_normal_force: largest measure = 3, must be > the smallest");
    check_refused(pull(alike),
                  "fit_tangential_force: information in the samples on displacement_exponent");
    check_refused(turn(alike), "fit_moment: information in the samples on rotation_exponent");
    CHECK(refusal(pull(alike, 0.7)) == "accepted");
    const auto at_reference = changed(good, [](Sample& s) { s.measure = 2; });
    check_refused(pull(at_reference),
                  "fit_tangential_force: information in the samples on displacement_exponent");
    // two measures determine at most two coefficients
    const auto two = changed(good, [](Sample& s) { s.measure = s.measure < 3 ? 1 : 4; });
    check_refused([&] { return fit_normal_force(all(two), 3); },
                  "fit_normal_force: information in the samples on measure^3");
    check_refused(normal(two, 2, false),
                  "fit_normal_force: information in the samples on measure^2");
  }
  SECTION("not moved at all") {
    const auto still = changed(good, [](Sample& s) {
      s.displacement_mm = {0, 0};
      s.rotation_rad = 0;
    });
    check_refused(pull(still), "fit_tangential_force: information in the samples on slope");
    check_refused(turn(still), "fit_moment: information in the samples on slope");
  }
  SECTION("a force that falls while the contact grows") {
    const auto falling = changed(good, [](Sample& s) { s.normal_force_n = 10 - s.measure; });
    check_refused(normal(falling, 2, false),
                  "fit_normal_force: slope of the force over the measure = -");
  }
  SECTION("an exponent outside the search") {
    const auto steep = changed(good, [](Sample& s) {
      const double u = std::pow(s.measure / 2, 6.4);
      s.tangential_force_n = {u * s.displacement_mm.x, u * s.displacement_mm.y};
      s.moment_n_mm = u * s.rotation_rad;
    });
    check_refused(pull(steep), "fit_tangential_force: displacement_exponent = 6.4");
    check_refused(turn(steep), "fit_moment: rotation_exponent = 6.4");
    const auto falling = changed(good, [](Sample& s) {
      const double u = std::pow(s.measure / 2, -2.3);
      s.tangential_force_n = {u * s.displacement_mm.x, u * s.displacement_mm.y};
      s.moment_n_mm = u * s.rotation_rad;
    });
    check_refused(pull(falling), "fit_tangential_force: displacement_exponent = -2.3");
    check_refused(turn(falling), "fit_moment: rotation_exponent = -2.3");
  }
  SECTION("forces of 0") {
    const auto zero = changed(good, [](Sample& s) { s.tangential_force_n = {0, 0}; });
    check_refused(pull(zero), "fit_tangential_force: displacement_exponent = nan, must be in");
  }
  SECTION("bad options") {
    check_refused(pull(good, test::nan), "fit_tangential_force: displacement_exponent = ");
    check_refused(turn(good, infinity), "fit_moment: rotation_exponent = inf, must be finite");
    for (const double bad : {0.0, -1.0, test::nan, infinity}) {
      CHECK_THROWS_AS(fit_tangential_force(all(good), bad), parameter_error);
      CHECK_THROWS_AS(fit_moment(all(good), bad), parameter_error);
    }
    for (const int bad : {0, 4}) {
      check_refused(normal(good, bad), "fit_normal_force: degree");
    }
  }
}

TEST_CASE("forces that are 0, or nothing but noise, are doubted", "[calibrate][force]") {
  Random random(17);
  const Samples good = measured({}, 40, random);
  const auto doubts = [](const Samples& samples) {
    const std::string normal = fit_normal_force(all(samples)).cause;
    const std::string pull = fit_tangential_force(all(samples), 2.0, 0).cause;
    const std::string turn = fit_moment(all(samples), 2.0, 0).cause;
    return std::array{normal, pull, turn};
  };
  const auto zero = changed(good, [](Sample& s) {
    s.normal_force_n = s.moment_n_mm = 0;
    s.tangential_force_n = {0, 0};
  });
  CHECK(begins_with(doubts(zero)[0], "no force reaches 0.05"));
  CHECK(begins_with(doubts(zero)[1], "no force reaches 0.05"));
  CHECK(begins_with(doubts(zero)[2], "less than 0.9 of the measured variance"));
  const auto noise = changed(good, [&](Sample& s) {
    s.normal_force_n = 5 + random.normal();
    s.moment_n_mm = random.normal();
    s.tangential_force_n = {random.normal(), random.normal()};
  });
  CHECK(doubts(noise)[0] == cause::gauge_not_tared);  // a force of 5 N whatever the contact
  CHECK(begins_with(doubts(noise)[1], "less than 0.9 of the measured variance is explained"));
  CHECK(begins_with(doubts(noise)[2], "less than 0.9 of the measured variance is explained"));
}

TEST_CASE("samples that are no numbers are left out", "[calibrate][force]") {
  Random random(18);
  const Samples good = measured({}, 40, random);
  Samples with = good;
  for (const double odd : {test::nan, infinity, -infinity, 0.0, -1.0}) {
    Sample s = good[0];
    s.measure = odd;
    with.insert(with.begin() + 3, s);
  }
  for (const double odd : {test::nan, infinity, -infinity}) {
    for (int field = 0; field < 4; ++field) {
      Sample s = good[0];
      (field == 0 ? s.displacement_mm.x : field == 1 ? s.displacement_mm.y : s.rotation_rad) = odd;
      if (field == 3) {
        s.rotation_rad = 0;
        s.normal_force_n = s.tangential_force_n.x = s.moment_n_mm = odd;
      }
      with.insert(with.begin() + 11, s);
    }
  }
  Samples few = with;  // those whose rotation alone is odd have a displacement
  std::erase_if(few, [](const Sample& s) { return !is_finite(s.rotation_rad); });
  CHECK(fit_tangential_force(all(few), 2.0).law.exponent ==
        fit_tangential_force(all(good), 2.0).law.exponent);
  CHECK(fit_normal_force(all(few)).curve.to == fit_normal_force(all(good)).curve.to);
}

namespace {

/// Whether all numbers of a result are finite.
template <class... Numbers>
bool finite(const Numbers&... numbers) {
  return (is_finite(numbers) && ...);
}
template <std::size_t N>
bool finite_array(const std::array<double, N>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return is_finite(x); });
}
bool finite_shear(const ShearFit<>& fit) {
  return std::all_of(fit.covariance.begin(), fit.covariance.end(), finite_array<2>) &&
         finite(fit.law.slope, fit.law.to, fit.law.exponent, fit.residual_sd, fit.explained);
}

/// Sometimes replaces a measured value by another.
double odd(double x, double share, Random& random) {
  constexpr std::array<double, 16> values = {test::nan, infinity, -infinity, 0,     -0.0, -1,
                                             1e-320,    1e-160,   1e-30,     1e-10, 1e-3, 1e3,
                                             1e10,      1e30,     1e160,     1e300};
  return random.uniform() < share ? values[static_cast<std::size_t>(random.whole(0, 15))] : x;
}

}  // namespace

TEST_CASE("odd samples give numbers or a refusal", "[calibrate][force]") {
  Random random(19);
  std::set<std::string> complaints;
  int answers = 0, refusals = 0;
  const auto check = [&](const char* name, int k, const auto& fit) {
    try {
      if (!fit()) {
        complaints.insert(std::string(name) + ", case " + std::to_string(k));
      }
      ++answers;
    } catch (const parameter_error&) {
      ++refusals;
    }
  };
  for (int k = 0; k < 5000; ++k) {
    Samples samples = measured({}, static_cast<int>(random.whole(0, 12)), random);
    const double share = std::array<double, 4>{0, 0.02, 0.1, 0.4}[static_cast<std::size_t>(k % 4)];
    for (Sample& s : samples) {
      for (double* x :
           {&s.measure, &s.displacement_mm.x, &s.displacement_mm.y, &s.rotation_rad,
            &s.normal_force_n, &s.tangential_force_n.x, &s.tangential_force_n.y, &s.moment_n_mm}) {
        *x = odd(*x, share, random);
      }
    }
    const bool moved = random.uniform() < 0.5;
    check("fit_normal_force", k, [&] {
      const auto fit = fit_normal_force(all(samples), 2, moved);
      return finite_array(fit.curve.coefficients) && is_finite(fit.curve.residual_sd_n) &&
             std::all_of(fit.curve.covariance.begin(), fit.curve.covariance.end(),
                         finite_array<4>) &&
             is_finite(fit.explained);
    });
    const std::optional<double> exponent = moved ? std::nullopt : std::optional(1.0);
    check("fit_tangential_force", k,
          [&] { return finite_shear(fit_tangential_force(all(samples), 2.0, exponent)); });
    check("fit_moment", k, [&] { return finite_shear(fit_moment(all(samples), 2.0, exponent)); });
  }
  CHECK(answers > 5000);
  CHECK(refusals > 5000);
  for (const std::string& complaint : complaints) {
    FAIL_CHECK(complaint);
  }
}
