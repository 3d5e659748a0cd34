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
  S x_by_x = S(1.9), x_by_y = S(-0.3), y_by_x = S(0.2), y_by_y = S(2.4);
  Point2<S> offset_n = {S(0.4), S(-0.25)};

  S plain(const S& m) const { return ((cubic * m + square_term) * m + linear) * m + constant; }
  Point2<S> mapped(const Point2<S>& d) const {
    return {x_by_x * d.x + x_by_y * d.y + offset_n.x, y_by_x * d.x + y_by_y * d.y + offset_n.y};
  }
  S factor(const ForceSample<S>& s, const S& exponent) const {
    return shear_factor(s.measure, reference, exponent);
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

/// Errors of a measured force, in N.
struct Noise {
  double sd = 0.05;
  double outliers = 0;  ///< share
  double size = 2;      ///< of an outlier, on average
  bool one_side = false;
};

double error_of(const Noise& noise, Random& random) {
  if (random.uniform() < noise.outliers) {
    const double size = noise.size * random.uniform(0.5, 1.5);
    return noise.one_side || random.uniform() < 0.5 ? size : -size;
  }
  return noise.sd * random.normal();
}

/// All forces of a pad in one sample.
Samples measured(const Pad<>& pad, int count, const Noise& noise, Random& random) {
  Samples samples = contacts(count, random);
  for (Sample& s : samples) {
    s.normal_force_n = pad.plain(s.measure) + error_of(noise, random);
    const auto pull = pad.pull(s);
    s.tangential_force_n = {pull.x + error_of(noise, random), pull.y + error_of(noise, random)};
    s.moment_n_mm = pad.turn(s) + error_of(noise, random);
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
void check_coverage(const std::array<const char*, N>& names,
                    int fits,
                    std::uint64_t seed,
                    const Fit& fit,
                    double slack = 0) {
  std::vector<Coverage> coverage(names.begin(), names.end());
  Random random(seed);
  for (int k = 0; k < fits; ++k) {
    const std::array<std::array<double, 3>, N> found = fit(random);
    for (std::size_t i = 0; i < N; ++i) {
      coverage[i].add(found[i][0], found[i][1], found[i][2]);
    }
  }
  for (const Coverage& c : coverage) {
    c.check(slack);
  }
}

struct Way {
  const char* name;
  bool robust;
  Noise noise;
  int samples;
  int fits;
  double slack;
};
/// Huber's standard errors hold for many samples. With 40 samples, 15 % of them outliers, 91 % are
/// within two standard errors.
const std::array<Way, 3> ways = {
    {{"plain", false, {}, 60, 200, 0},
     {"Huber without outliers", true, {}, 60, 80, 0.02},
     {"Huber, 15 % outliers", true, {.outliers = 0.15}, 100, 80, 0.02}}};

FitOptions options_of(const Way& way) {
  return {.robust = way.robust};
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
  for (const Way& way : ways) {
    CAPTURE(way.name);
    const Pad<> pad;
    check_coverage<2>(
        {"linear", "square"}, way.fits, 1,
        [&](Random& random) {
          const auto samples = measured(pad, way.samples, way.noise, random);
          const auto fit = fit_normal_force(all(samples), {}, options_of(way));
          const auto& c = fit.curve.covariance;
          return std::array<std::array<double, 3>, 2>{
              {{fit.curve.coefficients[1], pad.linear, sd(c[1][1])},
               {fit.curve.coefficients[2], pad.square_term, sd(c[2][2])}}};
        },
        way.slack);
    const Pad<> cubic{.constant = 0.3, .square_term = 0.05, .cubic = 0.06};
    check_coverage<5>(
        {"constant", "linear", "square", "cubic", "force"}, way.fits, 2,
        [&](Random& random) {
          const auto samples = measured(cubic, way.samples, way.noise, random);
          const auto fit =
              fit_normal_force(all(samples), {.degree = 3, .through_zero = false}, options_of(way));
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
        },
        way.slack);
  }
}

namespace {

void check_shear_coverage(const Way& way, bool given) {
  const Pad<> pad;
  CAPTURE(given);
  const auto row = [&](const auto& fit, double slope, double exponent) {
    // the slope at twice the reference depends on both parameters; a given exponent is no estimate
    const auto& v = fit.covariance;
    const double c = fit.law.coefficients[0], u = std::pow(2, fit.law.exponent);
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
      {"slope", "slope at twice the reference", "displacement_exponent"}, way.fits, 5,
      [&](Random& random) {
        const auto samples = measured(pad, way.samples, way.noise, random);
        const auto fit = fit_tangential_force(
            all(samples), pad.reference, given ? std::optional(pad.pull_exponent) : std::nullopt,
            options_of(way));
        return row(fit, pad.pull_1, pad.pull_exponent);
      },
      way.slack);
  check_coverage<3>(
      {"slope", "slope at twice the reference", "rotation_exponent"}, way.fits, 6,
      [&](Random& random) {
        const auto samples = measured(pad, way.samples, way.noise, random);
        const auto fit =
            fit_moment(all(samples), pad.reference,
                       given ? std::optional(pad.turn_exponent) : std::nullopt, options_of(way));
        return row(fit, pad.turn_1, pad.turn_exponent);
      },
      way.slack);
}

}  // namespace

TEST_CASE("shear is found within its errors, exponents searched or given", "[calibrate][force]") {
  for (const Way& way : ways) {
    CAPTURE(way.name);
    check_shear_coverage(way, false);
  }
  check_shear_coverage(ways[0], true);
}

TEST_CASE("a linear map with offsets is found within its errors", "[calibrate][force]") {
  const Pad<> pad;
  for (const Way& way : ways) {
    CAPTURE(way.name);
    check_coverage<6>(
        {"x_by_x", "x_by_y", "offset_n.x", "y_by_x", "y_by_y", "offset_n.y"}, way.fits, 7,
        [&](Random& random) {
          Samples samples = contacts(way.samples, random);
          for (Sample& s : samples) {
            const double u = pad.factor(s, pad.pull_exponent);
            const auto force = pad.mapped(u * s.displacement_mm);
            s.tangential_force_n = {force.x + error_of(way.noise, random),
                                    force.y + error_of(way.noise, random)};
          }
          const auto fit =
              fit_linear_shear(all(samples), pad.reference, pad.pull_exponent, options_of(way));
          const auto& x = fit.x_standard_errors;
          const auto& y = fit.y_standard_errors;
          return std::array<std::array<double, 3>, 6>{{{fit.map.x_by_x, pad.x_by_x, x[0]},
                                                       {fit.map.x_by_y, pad.x_by_y, x[1]},
                                                       {fit.map.offset_n.x, pad.offset_n.x, x[2]},
                                                       {fit.map.y_by_x, pad.y_by_x, y[0]},
                                                       {fit.map.y_by_y, pad.y_by_y, y[1]},
                                                       {fit.map.offset_n.y, pad.offset_n.y, y[2]}}};
        },
        way.slack);
  }
}

TEST_CASE("a linear map reaches as far as the longest displacement", "[calibrate][force]") {
  const Pad<> pad;
  Random random(11);
  for (const double across : {0.01, 1.0, 100.0}) {  // mostly along y, mixed, mostly along x
    Samples samples = contacts(30, random);
    double longest = 0;
    for (Sample& s : samples) {
      s.displacement_mm.x *= across;
      const double u = pad.factor(s, pad.pull_exponent);
      const Point2<double> scaled = {u * s.displacement_mm.x, u * s.displacement_mm.y};
      s.tangential_force_n = pad.mapped(scaled);
      longest = (std::max)(longest, std::hypot(scaled.x, scaled.y));
    }
    const auto fit = fit_linear_shear(all(samples), pad.reference, pad.pull_exponent, {});
    CHECK(fit.map.force.to == Approx(longest));
  }
}

TEST_CASE("a calibration tells how far the next force is off", "[calibrate][force]") {
  const Pad<> pad;
  Coverage predicted("next force");
  Random random(8);
  const Noise noise;
  for (int k = 0; k < 1000; ++k) {
    // few samples, so that the parameters matter as well
    const auto samples = measured(pad, 12, noise, random);
    const auto fit = fit_normal_force(all(samples));
    ForceCurve<> curve = fit.curve;
    curve.from = 0.1;
    curve.to = 6;
    const NormalForce force(curve);
    const double at = random.uniform(0.4, 5);
    const auto found = force(at);
    predicted.add(found.force_n, pad.plain(at) + error_of(noise, random), sd(found.variance_n2));
  }
  predicted.check(0, 0.927, 1.118);  // Student's distribution, 10 degrees of freedom
}

namespace {

/// Largest relative error of each parameter for samples without noise.
double error_without_noise(bool robust) {
  using S = double;
  const Pad<S> pad;
  FitOptions options;
  options.robust = robust;
  Random random(9);
  auto samples = contacts<S>(30, random);
  double worst = 0;
  const auto compare = [&](const S& found, const S& truth) {
    using std::abs;
    worst = (std::max)(worst, static_cast<double>(abs(S((found - truth) / truth))));
  };
  for (auto& s : samples) {
    s.normal_force_n = pad.plain(s.measure);
    s.tangential_force_n = pad.pull(s);
    s.moment_n_mm = pad.turn(s);
  }
  const auto normal = fit_normal_force(all(samples), {}, options);
  compare(normal.curve.coefficients[1], pad.linear);
  compare(normal.curve.coefficients[2], pad.square_term);
  CHECK(value(normal.curve.coefficients[0]) == 0);
  const auto pull = fit_tangential_force(all(samples), pad.reference, {}, options);
  compare(pull.law.coefficients[0], pad.pull_1);
  compare(pull.law.exponent, pad.pull_exponent);
  const auto turn = fit_moment(all(samples), pad.reference, {}, options);
  compare(turn.law.coefficients[0], pad.turn_1);
  compare(turn.law.exponent, pad.turn_exponent);
  auto shifted = samples;
  for (auto& s : shifted) {
    const S u = pad.factor(s, pad.pull_exponent);
    s.tangential_force_n = pad.mapped(u * s.displacement_mm);
  }
  const auto linear = fit_linear_shear(all(shifted), pad.reference, pad.pull_exponent, options);
  compare(linear.map.x_by_x, pad.x_by_x);
  compare(linear.map.x_by_y, pad.x_by_y);
  compare(linear.map.offset_n.x, pad.offset_n.x);
  compare(linear.map.y_by_x, pad.y_by_x);
  compare(linear.map.y_by_y, pad.y_by_y);
  compare(linear.map.offset_n.y, pad.offset_n.y);
  return worst;
}

}  // namespace

TEST_CASE("samples without noise give back the parameters", "[calibrate][force]") {
  // A few hundred times the spacing of the number type.
  CHECK(error_without_noise(false) < 1e-13);
  CHECK(error_without_noise(true) < 1e-13);
}

namespace {

/// Samples with noise and their fits, for properties of every calibration.
Samples any_samples(int count = 30) {
  Random random(static_cast<std::uint64_t>(test::whole(1, 1000000)));
  Pad<> pad;
  pad.linear = test::uniform(0.3, 1);
  pad.square_term = test::uniform(0.1, 0.5);
  pad.pull_exponent = test::uniform(0, 1);
  Samples samples = measured(pad, count, {.sd = 0.1}, random);
  return samples;
}

FitOptions any_options() {
  FitOptions options;
  options.robust = test::whole(0, 1) == 1;
  options.min_explained = 0.5;
  return options;
}

/// A parameter or standard error with its powers of the unit of force and of the unit of the
/// measure.
struct Number {
  double value;
  int force_power = 0;
  int measure_power = 0;
};
std::vector<Number> all_fits(const Samples& samples, const FitOptions& options) {
  std::vector<Number> numbers;
  const auto normal = fit_normal_force(all(samples), {}, options);
  for (int k = 1; k <= 2; ++k) {
    const auto i = static_cast<std::size_t>(k);
    numbers.push_back({normal.curve.coefficients[i], 1, -k});
    numbers.push_back({normal.curve.covariance[i][i], 2, -2 * k});
  }
  numbers.insert(numbers.end(), {{normal.curve.residual_sd_n, 1}, {normal.explained}});
  const auto pull = fit_tangential_force(all(samples), 2.0, {}, options);
  numbers.insert(numbers.end(), {{pull.law.coefficients[0], 1},
                                 {pull.covariance[0][0], 2},
                                 {pull.law.exponent},
                                 {pull.covariance[1][1]},
                                 {pull.law.to}});
  const auto turn = fit_moment(all(samples), 2.0, {}, options);
  numbers.insert(numbers.end(),
                 {{turn.law.coefficients[0], 1}, {turn.law.exponent}, {turn.residual_sd, 1}});
  const auto linear = fit_linear_shear(all(samples), 1, 0, options);
  numbers.insert(numbers.end(), {{linear.map.x_by_x, 1},
                                 {linear.map.x_by_y, 1},
                                 {linear.map.offset_n.y, 1},
                                 {linear.y_standard_errors[2], 1},
                                 {linear.residual_sd_n.x, 1}});
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
    const FitOptions options = any_options();
    const auto before = all_fits(samples, options);
    std::reverse(samples.begin(), samples.end());
    const std::ptrdiff_t first = test::whole(0, static_cast<std::ptrdiff_t>(samples.size()) - 1);
    std::rotate(samples.begin(), samples.begin() + first, samples.end());
    RC_ASSERT(worst_difference(all_fits(samples, options), before) < 1e-9);
  });
  rc::prop("the unit of force, to the last bit", [] {
    Samples samples = any_samples();
    const FitOptions options = any_options();
    const auto before = all_fits(samples, options);
    const int power = static_cast<int>(test::whole(-20, 20));
    for (Sample& s : samples) {
      s.normal_force_n = std::ldexp(s.normal_force_n, power);
      s.tangential_force_n = {std::ldexp(s.tangential_force_n.x, power),
                              std::ldexp(s.tangential_force_n.y, power)};
      s.moment_n_mm = std::ldexp(s.moment_n_mm, power);
    }
    const auto after = all_fits(samples, options);
    for (std::size_t i = 0; i < before.size(); ++i) {
      RC_ASSERT(after[i].value == std::ldexp(before[i].value, before[i].force_power * power));
    }
  });
  rc::prop("the unit of the measure, to the last bit", [] {
    Samples samples = any_samples();
    const FitOptions options = any_options();
    const int power = static_cast<int>(test::whole(-20, 20));
    const auto before = fit_normal_force(all(samples), {}, options);
    for (Sample& s : samples) {
      s.measure = std::ldexp(s.measure, power);
    }
    const auto after = fit_normal_force(all(samples), {}, options);
    RC_ASSERT(after.curve.to == std::ldexp(before.curve.to, power));
    for (int k = 0; k <= 2; ++k) {
      const auto i = static_cast<std::size_t>(k);
      RC_ASSERT(after.curve.coefficients[i] ==
                std::ldexp(before.curve.coefficients[i], -k * power));
    }
  });
  rc::prop("the axes of the image", [] {
    Samples samples = any_samples();
    const auto before = fit_tangential_force(all(samples), 2.0);
    const double angle = test::uniform(-3, 3), c = std::cos(angle), s = std::sin(angle);
    const auto rotated = [&](const Point2<double>& p) {
      return Point2<double>{c * p.x - s * p.y, s * p.x + c * p.y};
    };
    for (Sample& sample : samples) {
      sample.displacement_mm = rotated(sample.displacement_mm);
      sample.tangential_force_n = rotated(sample.tangential_force_n);
    }
    const auto after = fit_tangential_force(all(samples), 2.0);
    RC_ASSERT(std::abs(after.law.exponent - before.law.exponent) < 1e-9);
    RC_ASSERT(std::abs(after.law.coefficients[0] - before.law.coefficients[0]) < 1e-8);
  });
}

TEST_CASE("sums of Bernstein polynomials", "[calibrate][force]") {
  // column k: the sum of the B_j from k on, at any t
  for (int degree = 1; degree <= 3; ++degree) {
    for (const double t : {0.0, 0.2, 0.7, 1.0}) {
      double sum = 0;
      for (int k = degree; k >= 0; --k) {
        const double choose = k == 0 || k == degree ? 1 : degree;
        sum += choose * std::pow(t, k) * std::pow(1 - t, degree - k);
        const auto& c = detail::rising_terms[degree - 1][k];
        CHECK(c[0] + t * (c[1] + t * (c[2] + t * c[3])) == Approx(sum).margin(1e-15));
      }
    }
  }
}

TEST_CASE("a gauge is not tared if a constant explains most of the residual, in any unit",
          "[calibrate][force]") {
  // forces along the displacements; residuals of a size without direction, and a constant
  const auto told = [](double force, double residual, const Point2<double>& constant) {
    detail::PlaneVectors<double> d(4, 2), left(4, 2);
    d << 1, 0, -1, 0, 0, 1, 0, -1;
    left = residual * d;
    left.rowwise() += Eigen::RowVector2d(constant.x, constant.y);
    return detail::mistake_in<double>(d, force * d, &left);
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
    return fit_normal_force(all(samples), {.degree = 1}).cause;
  };
  for (const double unit : {10.0, 1.0, 0.5, 0.3}) {
    CAPTURE(unit);
    CHECK(told(unit, 0.11) == std::string(cause::gauge_not_tared));
    CHECK(told(unit, 0.09) == nullptr);
  }
}

TEST_CASE("samples given twice count twice", "[calibrate][force]") {
  Random random(10);
  const Samples once = measured({}, 30, {}, random);
  Samples twice = once;
  twice.insert(twice.end(), once.begin(), once.end());
  const auto a = fit_normal_force(all(once));
  const auto b = fit_normal_force(all(twice));
  for (std::size_t k = 1; k <= 2; ++k) {
    CHECK(b.curve.coefficients[k] == Approx(a.curve.coefficients[k]).epsilon(1e-12));
    // the same sum of squares over 58 instead of 28 degrees of freedom
    CHECK(b.curve.covariance[k][k] == Approx(a.curve.covariance[k][k] * 28 / 58).epsilon(1e-12));
  }
}

TEST_CASE("Huber's loss withstands gross outliers", "[calibrate][force]") {
  for (const double share : {0.1, 0.2}) {
    CAPTURE(share);
    const Noise noise{.outliers = share, .size = 4, .one_side = true};
    Random random(12);
    const Pad<> pad;
    int plain_far = 0;
    double worst = 0;
    for (int k = 0; k < 20; ++k) {
      const auto samples = measured(pad, 100, noise, random);
      const auto robust =
          fit_normal_force(all(samples), {}, {.robust = true, .min_explained = 0.5});
      const auto plain = fit_normal_force(all(samples), {}, {.min_explained = 0.5});
      for (const double at : {1.0, 3.0, 5.0}) {
        const double standard_error = sd(variance_at(robust.curve, at));
        worst =
            (std::max)(worst, std::abs(robust.curve.force_n(at) - pad.plain(at)) / standard_error);
        plain_far += plain.curve.force_n(at) - pad.plain(at) > 10 * standard_error ? 1 : 0;
      }
      // and the outliers are found: all samples with a weight below a third are far off
      for (const auto& r : robust.residuals) {
        const double off = r.measured - pad.plain(samples[r.sample].measure);
        CHECK((off < 1 || r.weight < 1.0 / 3));
        CHECK((r.weight > 1.0 / 3 || off > 0.1));
      }
    }
    CHECK(worst < 6);
    CHECK(plain_far >= 50);  // of 60
  }
}

TEST_CASE("a force that would fall is held", "[calibrate][force]") {
  const auto lowest_slope = [](const auto& curve) {
    double lowest = infinity;
    for (int k = 0; k <= 200; ++k) {
      lowest = (std::min)(lowest, curve.slope(curve.to * k / 200.0));
    }
    return lowest;
  };
  Random random(13);
  Samples saturated = contacts(40, random);
  for (Sample& s : saturated) {
    s.normal_force_n = 4 * s.measure - 0.6 * square(s.measure) + 0.05 * random.normal();
  }
  const auto fit = fit_normal_force(all(saturated), {}, {.min_explained = 0.5});
  CHECK(lowest_slope(fit.curve) > -1e-12);
  // a free quadratic would fall by more than 0.5 N per mm at the end
  Eigen::MatrixXd columns(40, 2);
  Eigen::VectorXd forces(40);
  for (Index i = 0; i < 40; ++i) {
    const Sample& s = saturated[static_cast<std::size_t>(i)];
    columns.row(i) << s.measure, square(s.measure);
    forces(i) = s.normal_force_n;
  }
  const Eigen::Vector2d free = columns.householderQr().solve(forces);
  CHECK(free(0) + 2 * free(1) * fit.curve.to < -0.5);
  // a curve that is far from falling is that of least squares
  const Samples rising = measured({}, 40, {}, random);
  for (Index i = 0; i < 40; ++i) {
    const Sample& s = rising[static_cast<std::size_t>(i)];
    columns.row(i) << s.measure, square(s.measure);
    forces(i) = s.normal_force_n;
  }
  const Eigen::Vector2d best = columns.householderQr().solve(forces);
  const auto held = fit_normal_force(all(rising));
  CHECK(held.curve.coefficients[1] == Approx(best(0)));
  CHECK(held.curve.coefficients[2] == Approx(best(1)));

  // NormalForce accepts every result of a rising fit
  std::set<std::string> complaints;
  int refused = 0;
  const auto make = [&](const Samples& samples, const CurveOptions& curve,
                        const FitOptions& options) {
    const auto fitted = fit_normal_force(all(samples), curve, options);
    CHECK(lowest_slope(fitted.curve) > -1e-9);
    (void)NormalForce(fitted.curve);
  };
  for (int k = 0; k < 80; ++k) {
    const double a = random.uniform(-2, 6), b = random.uniform(-1.5, 1.5);
    const double c = random.uniform(-0.2, 0.2);
    Samples samples = contacts(25, random);
    for (Sample& s : samples) {
      const double m = s.measure;
      s.normal_force_n = m * (a + m * (b + m * c)) + 0.2 * random.normal();
    }
    const FitOptions options{.robust = k % 3 == 0, .min_explained = 0};
    for (int degree = 1; degree <= 3; ++degree) {
      const std::string message =
          refusal([&] { make(samples, {.degree = degree, .through_zero = k % 2 == 0}, options); });
      const bool falls = begins_with(message, "fit_normal_force: share of the measured variance");
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
  const Samples samples = measured(pad, 80, {}, random);
  const auto constant = fit_normal_force(all(samples), {.through_zero = false});
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

TEST_CASE("residuals are complete and in order", "[calibrate][force]") {
  Random random(15);
  Samples samples = measured({}, 40, {}, random);
  // samples in between that a fit cannot use
  std::vector<std::size_t> usable;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k % 7 == 2) {
      samples[k].measure = k % 2 == 0 ? test::nan : 0;
    } else if (k % 11 == 3) {
      samples[k].normal_force_n = samples[k].moment_n_mm = samples[k].tangential_force_n.y =
          infinity;
    } else {
      usable.push_back(k);
    }
  }
  const auto places = [](const auto& residuals, std::size_t first, std::size_t step,
                         std::size_t count) {
    std::vector<std::size_t> found;
    for (std::size_t k = first; found.size() < count && k < residuals.size(); k += step) {
      found.push_back(residuals[k].sample);
    }
    return found;
  };
  const auto normal = fit_normal_force(all(samples));
  CHECK(normal.residuals.size() == usable.size());
  CHECK(places(normal.residuals, 0, 1, usable.size()) == usable);
  const NormalForce force(normal.curve);
  double left_sq = 0;
  for (const auto& r : normal.residuals) {
    const Sample& s = samples[r.sample];
    CHECK(r.measured == s.normal_force_n);
    CHECK(r.weight == 1);
    CHECK(r.fitted == Approx(force(s.measure).force_n).epsilon(1e-12));
    left_sq += square(r.measured - r.fitted);
  }
  CHECK(normal.curve.residual_sd_n ==
        Approx(std::sqrt(left_sq / static_cast<double>(usable.size() - 2))).epsilon(1e-9));

  const auto pull = fit_tangential_force(all(samples), 2.0);
  CHECK(pull.residuals.size() == 2 * usable.size());
  CHECK(places(pull.residuals, 0, 2, usable.size()) == usable);
  CHECK(places(pull.residuals, 1, 2, usable.size()) == usable);
  CHECK(pull.residuals[3].measured == samples[usable[1]].tangential_force_n.y);
  const auto turn = fit_moment(all(samples), 2.0);
  CHECK(places(turn.residuals, 0, 1, turn.residuals.size()) == usable);
  const Shear<> shear({2.0, pull.law, turn.law});
  for (std::size_t k = 0; k < usable.size(); ++k) {
    const Sample& s = samples[usable[k]];
    const auto found = shear(s.measure, s.displacement_mm, s.rotation_rad);
    CHECK(pull.residuals[2 * k].fitted == Approx(found.tangential_force_n.x).epsilon(1e-9));
    CHECK(pull.residuals[2 * k + 1].fitted == Approx(found.tangential_force_n.y).epsilon(1e-9));
    CHECK(turn.residuals[k].fitted == Approx(found.moment_n_mm).epsilon(1e-9));
    CHECK(shear_factor(s.measure, 2.0, pull.law.exponent) * norm(s.displacement_mm) <=
          pull.law.to * (1 + 1e-12));
  }
  const auto linear = fit_linear_shear(all(samples));
  CHECK(linear.residuals.size() == 2 * usable.size());
  CHECK(places(linear.residuals, 0, 1, usable.size()) == usable);
  CHECK(places(linear.residuals, usable.size(), 1, usable.size()) == usable);
  CHECK(linear.residuals[usable.size()].measured == samples[usable[0]].tangential_force_n.y);
}

TEST_CASE("predictions never use the load that is left out", "[calibrate][force]") {
  Random random(16);
  Samples samples = measured({}, 30, {}, random);
  constexpr std::array<int, 5> loads = {7, -2, 0, 1000000, 3};  // interleaved and unordered
  for (Sample& s : samples) {
    s.load = loads[static_cast<std::size_t>(s.load)];
  }
  const auto fit = [](std::span<const Sample> rest) {
    return fit_normal_force(rest, {}, {.min_explained = 0.5});
  };
  const auto predicted = [](const auto& model, const Sample& s) {
    return model.curve.force_n(s.measure);
  };
  const auto clean = leave_one_load_out(all(samples), fit, predicted);
  CHECK(clean.loads == 5);
  REQUIRE(clean.errors.size() == 30);
  for (const int poisoned : loads) {
    Samples other = samples;
    for (Sample& s : other) {
      s.normal_force_n += s.load == poisoned ? s.measure : 0;
    }
    const auto result = leave_one_load_out(all(other), fit, predicted);
    for (std::size_t k = 0; k < samples.size(); ++k) {
      CHECK((result.errors[k] == clean.errors[k]) == (samples[k].load == poisoned));
    }
  }
  // summed
  const auto off = [](const auto& model, const Sample& s) {
    return s.load == 3 ? test::nan : model.curve.force_n(s.measure) - s.normal_force_n;
  };
  const auto result = leave_one_load_out(all(samples), fit, off);
  double sum = 0, worst = 0;
  for (const double error : result.errors) {
    sum += is_finite(error) ? std::abs(error) : 0;
    worst = is_finite(error) ? (std::max)(worst, std::abs(error)) : worst;
  }
  CHECK(result.loads == 5);
  CHECK(result.mean_abs == Approx(sum / 24).epsilon(1e-12));
  CHECK(result.worst == worst);
  CHECK(worst < 1.5);
  // unusable fits are refused; without samples there is no answer
  for (Sample& s : samples) {
    s.load = 1;
  }
  CHECK_THROWS_AS(leave_one_load_out(all(samples), fit, off), parameter_error);
  const auto none = leave_one_load_out(std::span<const Sample>(), fit, off);
  CHECK((none.loads == 0 && none.mean_abs != none.mean_abs));
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
  const Samples good = measured({}, 40, {}, random);
  const auto normal = [](const Samples& samples, const CurveOptions& curve = {},
                         const FitOptions& options = {}) {
    return [&samples, curve, options] { return fit_normal_force(all(samples), curve, options); };
  };
  const auto pull = [](const Samples& samples, const std::optional<double>& exponent = {}) {
    return [&samples, exponent] { return fit_tangential_force(all(samples), 2.0, exponent); };
  };
  const auto turn = [](const Samples& samples, const std::optional<double>& exponent = {}) {
    return [&samples, exponent] { return fit_moment(all(samples), 2.0, exponent); };
  };
  const auto linear = [](const Samples& samples) {
    return [&samples] { return fit_linear_shear(all(samples)); };
  };

  SECTION("too few") {
    const Samples none, one(good.begin(), good.begin() + 1), two(good.begin(), good.begin() + 2);
    check_refused(normal(none), "fit_normal_force: usable samples = 0, must be > 0");
    check_refused(normal(two), "fit_normal_force: usable samples = 2, must be > 2");
    check_refused(pull(one), "fit_tangential_force: usable samples = 2, must be > 2");
    check_refused(pull(none), "fit_tangential_force: usable samples = 0");
    check_refused(turn(two), "fit_moment: usable samples = 2, must be > 2");
    check_refused(linear(two), "fit_linear_shear: usable samples = 2, must be > 3");
    check_refused(linear(none), "fit_linear_shear: usable samples = 0");
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
    check_refused([&] { return fit_normal_force(all(two), {.degree = 3}); },
                  "fit_normal_force: information in the samples on measure^3");
    check_refused(normal(two, {.through_zero = false}),
                  "fit_normal_force: information in the samples on measure^2");
  }
  SECTION("collinear or not moved at all") {
    const auto along =
        changed(good, [](Sample& s) { s.displacement_mm.y = 2 * s.displacement_mm.x; });
    check_refused(linear(along), "fit_linear_shear: information in the samples on x_by_y");
    const auto still = changed(good, [](Sample& s) {
      s.displacement_mm = {0, 0};
      s.rotation_rad = 0;
    });
    check_refused(linear(still), "fit_linear_shear: information in the samples on x_by_x");
    check_refused(pull(still), "fit_tangential_force: information in the samples on coefficient 1");
    check_refused(turn(still), "fit_moment: information in the samples on coefficient 1");
  }
  SECTION("forces that are constant, 0, or nothing but noise") {
    const auto constant = changed(good, [](Sample& s) { s.normal_force_n = 2; });
    check_refused(normal(constant, {.through_zero = false}),
                  "fit_normal_force: share of the measured variance");
    check_refused(normal(constant, {.through_zero = false}),
                  "fit_normal_force: share of the measured variance");
    const auto zero = changed(good, [](Sample& s) {
      s.normal_force_n = s.moment_n_mm = 0;
      s.tangential_force_n = {0, 0};
    });
    check_refused(normal(zero), "fit_normal_force: share of the measured variance");
    check_refused(linear(zero), "fit_linear_shear: share of the measured variance");
    const auto noise = changed(good, [&](Sample& s) {
      s.normal_force_n = 5 + random.normal();
      s.moment_n_mm = random.normal();
      s.tangential_force_n = {random.normal(), random.normal()};
    });
    check_refused(normal(noise, {.through_zero = false}),
                  "fit_normal_force: share of the measured variance");
    check_refused(pull(noise, 0), "fit_tangential_force: share of the measured variance");
    check_refused(turn(noise, 0), "fit_moment: share of the measured variance");
    check_refused(linear(noise), "fit_linear_shear: share of the measured variance");
  }
  SECTION("a force that falls while the contact grows") {
    const auto falling = changed(good, [](Sample& s) { s.normal_force_n = 10 - s.measure; });
    check_refused(normal(falling, {.through_zero = false}),
                  "fit_normal_force: share of the measured variance that a rising force explains");
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
  SECTION("bad options") {
    check_refused(pull(good, test::nan), "fit_tangential_force: displacement_exponent = ");
    check_refused(turn(good, infinity), "fit_moment: rotation_exponent = inf, must be finite");
    for (const double bad : {0.0, -1.0, test::nan, infinity}) {
      CHECK_THROWS_AS(fit_tangential_force(all(good), bad), parameter_error);
      CHECK_THROWS_AS(fit_moment(all(good), bad), parameter_error);
      CHECK_THROWS_AS(fit_linear_shear(all(good), bad), parameter_error);
    }
    for (const double bad : {-0.1, 1.0, test::nan}) {
      check_refused(normal(good, {}, {.min_explained = bad}), "FitOptions: min_explained");
    }
    for (const int bad : {0, 4}) {
      check_refused(normal(good, {.degree = bad}), "CurveOptions: degree");
    }
  }
}

TEST_CASE("samples that are no numbers are left out", "[calibrate][force]") {
  Random random(18);
  const Samples good = measured({}, 40, {}, random);
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
  const auto fit = fit_normal_force(all(with));
  CHECK(fit.residuals.size() == good.size() + 9);  // those whose displacement is odd have a force
  CHECK(fit_tangential_force(all(with), 2.0).law.exponent ==
        fit_tangential_force(all(good), 2.0).law.exponent);
}

namespace {

/// Whether all numbers of a result are finite.
template <class... Numbers>
bool finite(const Numbers&... numbers) {
  return (is_finite(numbers) && ...);
}
template <class Residuals>
bool finite_residuals(const Residuals& residuals) {
  return std::all_of(residuals.begin(), residuals.end(), [](const auto& r) {
    return finite(r.measured, r.fitted, r.weight) && r.weight >= 0 && r.weight <= 1;
  });
}
template <std::size_t N>
bool finite_array(const std::array<double, N>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return is_finite(x); });
}
bool finite_shear(const ShearFit<>& fit) {
  return finite_array(fit.law.coefficients) &&
         std::all_of(fit.covariance.begin(), fit.covariance.end(), finite_array<2>) &&
         finite(fit.law.to, fit.law.exponent, fit.residual_sd, fit.explained) &&
         finite_residuals(fit.residuals);
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
    Samples samples = measured({}, static_cast<int>(random.whole(0, 12)), {}, random);
    const double share = std::array<double, 4>{0, 0.02, 0.1, 0.4}[static_cast<std::size_t>(k % 4)];
    for (Sample& s : samples) {
      for (double* x :
           {&s.measure, &s.displacement_mm.x, &s.displacement_mm.y, &s.rotation_rad,
            &s.normal_force_n, &s.tangential_force_n.x, &s.tangential_force_n.y, &s.moment_n_mm}) {
        *x = odd(*x, share, random);
      }
    }
    FitOptions options;
    options.robust = k % 3 == 0;
    options.min_explained = random.uniform() < 0.5 ? 0 : options.min_explained;
    const bool moved = random.uniform() < 0.5;
    const CurveOptions curve{.through_zero = moved};
    check("fit_normal_force", k, [&] {
      const auto fit = fit_normal_force(all(samples), curve, options);
      return finite_array(fit.curve.coefficients) && is_finite(fit.curve.residual_sd_n) &&
             std::all_of(fit.curve.covariance.begin(), fit.curve.covariance.end(),
                         finite_array<6>) &&
             is_finite(fit.explained) && finite_residuals(fit.residuals);
    });
    const std::optional<double> exponent = moved ? std::nullopt : std::optional(1.0);
    check("fit_tangential_force", k,
          [&] { return finite_shear(fit_tangential_force(all(samples), 2.0, exponent, options)); });
    check("fit_moment", k,
          [&] { return finite_shear(fit_moment(all(samples), 2.0, exponent, options)); });
    check("fit_linear_shear", k, [&] {
      const auto fit = fit_linear_shear(all(samples), 2.0, 0.5, options);
      return finite(fit.map.x_by_x, fit.map.x_by_y, fit.map.y_by_x, fit.map.y_by_y,
                    fit.map.offset_n.x, fit.map.offset_n.y, fit.residual_sd_n.x) &&
             finite_array(fit.x_standard_errors) && finite_array(fit.y_standard_errors) &&
             finite_residuals(fit.residuals);
    });
  }
  CHECK(answers > 5000);
  CHECK(refusals > 5000);
  for (const std::string& complaint : complaints) {
    FAIL_CHECK(complaint);
  }
}
