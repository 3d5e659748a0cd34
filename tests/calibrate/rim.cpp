// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/rim.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "fingerpad/adapt/dual.hpp"
#include "fingerpad/force/wrench.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::begins_with;
using test::refusal;

namespace {

using Point = Point3<double>;
using Row = std::vector<Point>;
constexpr double radius_mm = 18.735;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// One row of points, or two rows, as a grid.
template <class S = double>
auto grid_of(const std::vector<Point3<S>>& points, Index rows = 1) {
  const auto columns = static_cast<Index>(points.size()) / rows;
  return StridedView<const Point3<S>>(points.data(), rows, columns, columns);
}

/// A pad whose rim pulls exactly by the law.
struct Pad {
  double length_mm = 0.8;
  double modulus_n_per_mm = 0.5;
  double uneven = 0.05;  ///< relative change of the side dots' lengths around the rim
  int columns = 36;
  bool equal_angles = true;

  double angle(int j) const {
    const double turn = 2 * std::numbers::pi * j / columns;
    return equal_angles ? turn : turn + 0.05 * std::sin(3.0 * turn);
  }
  double dot_length(int j) const { return length_mm * (1 + uneven * std::cos(3 * angle(j))); }

  template <class S = double>
  std::vector<Point3<S>> border() const {
    std::vector<Point3<S>> points;
    for (int j = 0; j < columns; ++j) {
      points.push_back(
          {S(radius_mm * std::cos(angle(j))), S(radius_mm * std::sin(angle(j))), S(0)});
    }
    return points;
  }

  /// lambda with mu t (lambda - lambda^-3) sin(inclination) = p a / 2.
  double stretch(double pressure_mpa) const {
    const double wanted =
        pressure_mpa * radius_mm / 2 / (modulus_n_per_mm * std::sin(inclination(pressure_mpa)));
    double low = 1, high = 4;
    for (int k = 0; k < 200; ++k) {
      const double middle = (low + high) / 2;
      (middle - std::pow(middle, -3) < wanted ? low : high) = middle;
    }
    return low;
  }
  static double inclination(double pressure_mpa) { return 1.05 + 4 * pressure_mpa; }

  template <class S = double>
  std::vector<Point3<S>> dots(double pressure_mpa, double times = 1) const {
    const auto rim = border();
    const double lambda = stretch(pressure_mpa), phi = inclination(pressure_mpa);
    std::vector<Point3<S>> points;
    for (int j = 0; j < columns; ++j) {
      const double chord = times * lambda * dot_length(j);
      const Point& b = rim[static_cast<std::size_t>(j)];
      points.push_back({S(b.x - chord * std::cos(phi) * b.x / radius_mm),
                        S(b.y - chord * std::cos(phi) * b.y / radius_mm),
                        S(chord * std::sin(phi))});
    }
    return points;
  }
};

RimCalibration<> calibration_of(const Pad& pad, const std::vector<double>& pressures) {
  RimCalibration<> calibration(grid_of(pad.border()), radius_mm);
  for (std::size_t k = 0; k < pressures.size(); ++k) {
    CHECK(calibration.add(k, grid_of(pad.dots(pressures[k])), pressures[k]));
  }
  return calibration;
}

const std::vector<double> four_pressures = {0.008, 0.012, 0.016, 0.020};

/// The free pad of tests/data/rim_free.csv.
struct MeasuredPad {
  Row border;
  std::vector<double> pressures;
  std::vector<Row> dots;
};

MeasuredPad finite_element_pad() {
  const auto folder = std::filesystem::path(__FILE__).parent_path().parent_path() / "data";
  std::ifstream file(folder / "rim_free.csv");
  std::string line;
  std::getline(file, line);
  MeasuredPad pad;
  while (std::getline(file, line)) {
    double p = 0;
    int j = 0;
    Point b{}, d{};
    REQUIRE(std::sscanf(line.c_str(), "%lf,%d,%lf,%lf,%lf,%lf,%lf,%lf", &p, &j, &b.x, &b.y, &b.z,
                        &d.x, &d.y, &d.z) == 8);
    if (pad.pressures.empty() || pad.pressures.back() != p) {
      pad.pressures.push_back(p);
      pad.dots.emplace_back();
    }
    if (pad.pressures.size() == 1) {
      pad.border.push_back(b);
    }
    pad.dots.back().push_back(d);
  }
  REQUIRE(pad.border.size() == 72);
  REQUIRE(pad.dots.size() == 4);
  return pad;
}

void add_all(const MeasuredPad& pad, RimCalibration<>& calibration) {
  for (std::size_t k = 0; k < pad.dots.size(); ++k) {
    REQUIRE(calibration.add(k, grid_of(pad.dots[k]), pad.pressures[k]));
  }
}

}  // namespace

TEST_CASE("rim calibration: a rim that follows the law is found exactly", "[wrench]") {
  for (const double modulus : {0.2, 0.5, 3.0}) {
    for (const double length : {0.3, 0.8, 1.5}) {
      for (const bool equal_angles : {true, false}) {
        Pad pad;
        pad.modulus_n_per_mm = modulus;
        pad.length_mm = length;
        pad.equal_angles = equal_angles;
        const double scale = modulus / 0.5;
        const std::vector<double> pressures = {0.008 * scale, 0.020 * scale};
        const auto calibration = calibration_of(pad, pressures);
        const auto fit = calibration.fit();
        CAPTURE(modulus, length, equal_angles);
        CHECK(fit.modulus_n_per_mm == Approx(modulus).epsilon(1e-9));
        // L is the mean weighted by each dot's share of the rim
        double weighted = 0;
        for (int j = 0; j < pad.columns; ++j) {
          const double share = (pad.angle(j + 1) - pad.angle(j - 1)) / (4 * std::numbers::pi);
          weighted += share * pad.dot_length(j);
        }
        CHECK(fit.length_mm == Approx(weighted).epsilon(1e-9));
        for (int j = 0; j < pad.columns; ++j) {
          CHECK(fit(j) == Approx(pad.dot_length(j)).epsilon(1e-9));
        }
        CHECK(fit.residual < 1e-10);
        CHECK(fit.share_scatter < 1e-9);
        CHECK(std::isnan(fit.correlation));  // two levels have no residual

        CHECK(calibration.fit_modulus(fit.length_mm).modulus_n_per_mm ==
              Approx(modulus).epsilon(1e-9));
        RimCalibration<> single(grid_of(pad.border()), radius_mm);
        REQUIRE(single.add(0, grid_of(pad.dots(pressures[1])), pressures[1]));
        CHECK(single.fit_modulus(fit.length_mm).modulus_n_per_mm == Approx(modulus).epsilon(1e-9));
        CHECK(std::isnan(single.fit_modulus(fit.length_mm).share_scatter));
      }
    }
  }
}

TEST_CASE("rim calibration: units and the order of levels and dots do not matter", "[wrench]") {
  const Pad pad;
  const auto fit = calibration_of(pad, four_pressures).fit();
  const auto backward = calibration_of(pad, {0.020, 0.016, 0.012, 0.008}).fit();
  CHECK(backward.length_mm == Approx(fit.length_mm).epsilon(1e-12));
  CHECK(backward.modulus_n_per_mm == Approx(fit.modulus_n_per_mm).epsilon(1e-12));

  // columns in the opposite order, or with another first column
  const auto rotated = [](Row row) {
    std::reverse(row.begin(), row.end());
    std::rotate(row.begin(), row.begin() + 7, row.end());
    return row;
  };
  RimCalibration<> other(grid_of(rotated(pad.border())), radius_mm);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(other.add(k, grid_of(rotated(pad.dots(four_pressures[k]))), four_pressures[k]));
  }
  const auto again = other.fit();
  CHECK(again.modulus_n_per_mm == Approx(fit.modulus_n_per_mm).epsilon(1e-12));
  CHECK(again(0) == Approx(fit(pad.columns - 1 - 7)).epsilon(1e-12));

  // a pad of another size and stiffness: lengths by 2, so p a by 2 for the same mu t
  for (const double times : {2.0, 0.04}) {
    const auto scaled = [&](Row row) {
      for (Point& p : row) {
        p = times * p;
      }
      return row;
    };
    RimCalibration<> other_size(grid_of(scaled(pad.border())), times * radius_mm);
    for (std::size_t k = 0; k < 4; ++k) {
      const Row dots = scaled(pad.dots(four_pressures[k]));
      CHECK(other_size.add(k, grid_of(dots), 3 * four_pressures[k]));
    }
    const auto scaled_fit = other_size.fit();
    CHECK(scaled_fit.modulus_n_per_mm == Approx(3 * times * fit.modulus_n_per_mm).epsilon(1e-9));
    CHECK(scaled_fit.length_mm == Approx(times * fit.length_mm).epsilon(1e-9));
  }
}

TEST_CASE("rim calibration: frames of a level are averaged", "[wrench]") {
  const Pad pad;
  RimCalibration<> calibration(grid_of(pad.border()), radius_mm);
  for (std::size_t k = 0; k < 4; ++k) {
    for (const double off : {0.03, -0.01, -0.02}) {
      Row dots = pad.dots(four_pressures[k]);
      for (Point& d : dots) {
        d = {d.x + off, d.y - off, d.z + 2 * off};
      }
      CHECK(calibration.add(k, grid_of(dots), four_pressures[k] + 0.01 * off));
    }
  }
  CHECK(calibration.levels() == 4);
  const auto fit = calibration.fit();
  CHECK(fit.modulus_n_per_mm == Approx(0.5).epsilon(1e-9));
  CHECK(fit(5) == Approx(pad.dot_length(5)).epsilon(1e-9));
}

TEST_CASE("rim calibration: dots that are missing now and then", "[wrench]") {
  const Pad pad;
  RimCalibration<> calibration(grid_of(pad.border()), radius_mm);
  for (std::size_t k = 0; k < 4; ++k) {
    Row whole = pad.dots(four_pressures[k]);
    Row gaps = whole;
    for (std::size_t j = 0; j < whole.size(); j += 5) {
      gaps[j].y = none;
    }
    CHECK(calibration.add(k, grid_of(gaps), four_pressures[k]));
    if (k != 2) {  // at level 2 every fifth dot is always missing
      CHECK(calibration.add(k, grid_of(whole), four_pressures[k]));
    }
  }
  const auto fit = calibration.fit();
  CHECK(fit.modulus_n_per_mm == Approx(0.5).epsilon(1e-9));
  for (int j = 0; j < pad.columns; ++j) {
    CHECK(fit(j) == Approx(pad.dot_length(j)).epsilon(1e-9));
  }
}

TEST_CASE("rim calibration: standard errors are those of repeated measurements", "[wrench]") {
  const Pad pad;
  constexpr int frames = 4, runs = 300;
  const double dot_noise_mm = 0.004, pressure_noise_mpa = 1e-4;
  test::Random random(11);
  double sums[4] = {}, squares[4] = {}, both = 0, residuals = 0;
  RimFit<double> last;
  for (int run = 0; run < runs; ++run) {
    RimCalibration<> calibration(grid_of(pad.border()), radius_mm);
    for (std::size_t k = 0; k < 4; ++k) {
      for (int frame = 0; frame < frames; ++frame) {
        Row dots = pad.dots(four_pressures[k]);
        for (Point& d : dots) {
          d = {d.x + dot_noise_mm * random.normal(), d.y + dot_noise_mm * random.normal(),
               d.z + dot_noise_mm * random.normal()};
        }
        calibration.add(k, grid_of(dots), four_pressures[k] + pressure_noise_mpa * random.normal());
      }
    }
    last = calibration.fit({dot_noise_mm, pressure_noise_mpa});
    const auto from_residual = calibration.fit();
    const auto with_length = calibration.fit_modulus(0.8, {dot_noise_mm, pressure_noise_mpa});
    const double values[4] = {last.length_mm - 0.8, last.modulus_n_per_mm - 0.5,
                              with_length.modulus_n_per_mm - 0.5, last(7) - pad.dot_length(7)};
    for (int i = 0; i < 4; ++i) {
      sums[i] += values[i];
      squares[i] += values[i] * values[i];
    }
    both += values[0] * values[1];
    residuals += from_residual.length_sd_mm * from_residual.length_sd_mm;
    if (run == 0) {
      CHECK(with_length.length_sd_mm == 0);
      CHECK(std::sqrt(squares[2]) < 5 * with_length.modulus_sd_n_per_mm);
    }
    if (run + 1 == runs) {
      const auto sd = [&](int i) { return std::sqrt(squares[i] / runs); };
      INFO("sd of L " << sd(0) << " mm, of mu t " << sd(1) << " N/mm");
      CHECK(last.length_sd_mm == Approx(sd(0)).epsilon(0.15));
      CHECK(last.modulus_sd_n_per_mm == Approx(sd(1)).epsilon(0.15));
      CHECK(last.correlation == Approx(both / runs / (sd(0) * sd(1))).margin(0.03));
      CHECK(with_length.modulus_sd_n_per_mm == Approx(sd(2)).epsilon(0.15));
      // without given noise: from the deviation of the four levels from a line
      CHECK(std::sqrt(residuals / runs) == Approx(sd(0)).epsilon(0.2));
      // without bias
      for (int i = 0; i < 4; ++i) {
        CAPTURE(i);
        CHECK(std::abs(sums[i] / runs) < 0.25 * sd(i));
      }
      // a frame's noise on a length of 0.8 mm, averaged over the frames of a level
      CHECK(last.share_scatter == Approx(dot_noise_mm / 0.88 / std::sqrt(frames)).epsilon(0.15));
    }
  }
  // two levels leave no residual to estimate errors from
  const auto two = calibration_of(pad, {0.01, 0.02}).fit();
  CHECK(std::isnan(two.length_sd_mm));
  CHECK(std::isnan(two.modulus_sd_n_per_mm));
}

TEST_CASE("rim calibration: standard errors do not depend on where the x axis points", "[wrench]") {
  // a rim without symmetry: ten neighbouring dots are never seen
  const Pad pad;
  const auto fit_at = [&](double angle) {
    const auto rotated = [&](Row row) {
      for (Point& p : row) {
        p = {std::cos(angle) * p.x - std::sin(angle) * p.y,
             std::sin(angle) * p.x + std::cos(angle) * p.y, p.z};
      }
      return row;
    };
    RimCalibration<> calibration(grid_of(rotated(pad.border())), radius_mm);
    for (std::size_t k = 0; k < 4; ++k) {
      Row dots = rotated(pad.dots(four_pressures[k]));
      for (std::size_t j = 0; j < 10 && k > 0; ++j) {
        dots[j].x = none;
      }
      REQUIRE(calibration.add(k, grid_of(dots), four_pressures[k]));
    }
    return calibration.fit({0.004, 0.0});
  };
  const auto before = fit_at(0), after = fit_at(0.7);
  CHECK(after.modulus_n_per_mm == Approx(before.modulus_n_per_mm).epsilon(1e-10));
  CHECK(after.modulus_sd_n_per_mm == Approx(before.modulus_sd_n_per_mm).epsilon(1e-9));
  CHECK(after.length_sd_mm == Approx(before.length_sd_mm).epsilon(1e-9));
}

TEST_CASE("rim calibration: its errors carry into the six axes as told", "[wrench]") {
  // length and mu t by four pressures with fresh noise, and their effect on one dragged rim
  const Pad pad{.uneven = 0};
  const auto border = pad.border();
  auto dragged = pad.dots(0.016);
  for (Point& d : dragged) {
    d = {d.x + 0.05, d.y + 0.02 - 0.001 * d.x, d.z};
  }
  using Dual = fingerpad::Dual<2>;
  const auto six_axes = [&](const std::array<Dual, 2>& p) {
    const auto as_dual = [](const Row& from) {
      std::vector<Point3<Dual>> to;
      for (const Point& q : from) {
        to.push_back({Dual(q.x), Dual(q.y), Dual(q.z)});
      }
      return to;
    };
    WrenchOptions<Dual> options{.base_radius_mm = Dual(radius_mm), .side_dot_length_mm = p[0]};
    options.modulus_n_per_mm = p[1];
    const auto rim = as_dual(border), dots = as_dual(dragged);
    Wrench<Dual> wrench(grid_of(rim), options);
    const auto r = wrench.by_modulus(grid_of(dots), Dual(0.016));
    REQUIRE(r.ok());
    return std::array{r.force_n.x,     r.force_n.y,     r.force_n.z,
                      r.moment_n_mm.x, r.moment_n_mm.y, r.moment_n_mm.z};
  };
  const auto truth = six_axes({Dual(0.8), Dual(0.5)});
  constexpr int runs = 200;
  const double dot_noise_mm = 0.004, pressure_noise_mpa = 1e-4;
  test::Random random(5);
  std::array<double, 6> told{}, scatter{};
  for (int run = 0; run < runs; ++run) {
    RimCalibration<> calibration(grid_of(border), radius_mm);
    for (std::size_t k = 0; k < 4; ++k) {
      Row dots = pad.dots(four_pressures[k]);
      for (Point& d : dots) {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        d = d + dot_noise_mm * Point{x, y, z};
      }
      calibration.add(k, grid_of(dots), four_pressures[k] + pressure_noise_mpa * random.normal());
    }
    const auto fit = calibration.fit({dot_noise_mm, pressure_noise_mpa});
    const double both = fit.correlation * fit.length_sd_mm * fit.modulus_sd_n_per_mm;
    const Eigen::Matrix2d covariance{{square(fit.length_sd_mm), both},
                                     {both, square(fit.modulus_sd_n_per_mm)}};
    const auto found = six_axes(seeded(std::array{fit.length_mm, fit.modulus_n_per_mm}));
    for (std::size_t axis = 0; axis < 6; ++axis) {
      told[axis] += carried_variance(found[axis], covariance) / runs;
      scatter[axis] += square(found[axis].value - truth[axis].value) / runs;
    }
  }
  for (std::size_t axis = 0; axis < 6; ++axis) {
    CAPTURE(axis, scatter[axis], told[axis]);
    CHECK(scatter[axis] / told[axis] == Approx(1).margin(0.3));  // 200 runs determine it to 10 %
  }
}

TEST_CASE("rim calibration: finite elements of a free pad", "[wrench]") {
  // true L 0.79995 mm, mu t 0.5 N/mm
  const MeasuredPad pad = finite_element_pad();
  RimCalibration<> calibration(grid_of(pad.border), radius_mm);
  add_all(pad, calibration);
  const auto chord = calibration.fit();
  CHECK(chord.length_mm == Approx(0.7991).margin(2e-4));
  CHECK(chord.modulus_n_per_mm == Approx(0.5072).margin(1e-3));
  CHECK(chord.residual < 1e-3);
  CHECK(chord.share_scatter < 2e-4);
  CHECK(calibration.fit_modulus(0.79995).modulus_n_per_mm == Approx(0.5135).margin(1e-3));

  // extrapolated to the rim: the unstressed cap is 11 mm high
  RimCalibration<> at_rim(grid_of(pad.border), radius_mm, 2 * std::atan(11 / radius_mm));
  add_all(pad, at_rim);
  const auto fit = at_rim.fit();
  CHECK(fit.length_mm == Approx(0.79995).margin(4e-4));
  CHECK(fit.modulus_n_per_mm == Approx(0.5).margin(1.5e-3));
  CHECK(fit.residual < 1e-4);
  CHECK(at_rim.fit_modulus(0.79995).modulus_n_per_mm == Approx(0.5).margin(4e-3));
}

TEST_CASE("rim calibration: float", "[wrench]") {
  const Pad pad;
  RimCalibration<float> calibration(grid_of(pad.border<float>()), 18.735F);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(calibration.add(k, grid_of(pad.dots<float>(four_pressures[k])),
                          static_cast<float>(four_pressures[k])));
  }
  const auto fit = calibration.fit();
  CHECK(fit.length_mm == Approx(0.8).epsilon(1e-3));
  CHECK(fit.modulus_n_per_mm == Approx(0.5).epsilon(5e-3));

  const MeasuredPad free = finite_element_pad();
  const auto narrow = [](const Row& row) {
    std::vector<Point3<float>> points;
    for (const Point& p : row) {
      points.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
    return points;
  };
  const auto border = narrow(free.border);
  RimCalibration<float> at_rim(grid_of(border), 18.735F, 2 * std::atan(11 / radius_mm));
  for (std::size_t k = 0; k < 4; ++k) {
    const auto dots = narrow(free.dots[k]);
    CHECK(at_rim.add(k, grid_of(dots), static_cast<float>(free.pressures[k])));
  }
  CHECK(at_rim.fit().length_mm == Approx(0.79995).epsilon(2e-3));
  CHECK(at_rim.fit().modulus_n_per_mm == Approx(0.5).epsilon(0.02));
}

TEST_CASE("rim calibration: other numbers, here of fifty digits", "[wrench]") {
  // a pad in exact balance: flat, so that sines are 1 and one stretch gives its pressure
  using std::abs;
  using std::sqrt;
  using S = test::Digits50;
  const S radius = 18, modulus = S(1) / 3, length = S(4) / 5;
  std::vector<Point3<S>> border;
  for (int j = 0; j < 8; ++j) {
    const S c = j % 2 == 0 ? S(1) : S(sqrt(S(S(1) / 2)));
    const int x[] = {1, 1, 0, -1, -1, -1, 0, 1}, y[] = {0, 1, 1, 1, 0, -1, -1, -1};
    border.push_back({S(radius * c * x[j]), S(radius * c * y[j]), S(0)});
  }
  RimCalibration<S> calibration(grid_of(border), radius);
  for (std::size_t k = 0; k < 3; ++k) {
    const S lambda = S(1) + S(static_cast<double>(k + 1)) / 20;
    auto dots = border;
    for (auto& d : dots) {
      d.z = lambda * length;
    }
    const S pressure = S(2) * modulus * (lambda - S(1) / (lambda * lambda * lambda)) / radius;
    CHECK(calibration.add(k, grid_of(dots), pressure));
  }
  const auto fit = calibration.fit();
  CHECK(static_cast<double>(S(abs(S(fit.modulus_n_per_mm / modulus - 1)))) < 1e-40);
  CHECK(static_cast<double>(S(abs(S(fit.length_mm / length - 1)))) < 1e-40);
  const S given = calibration.fit_modulus(length).modulus_n_per_mm;
  CHECK(static_cast<double>(S(abs(S(given / modulus - 1)))) < 1e-40);
}

TEST_CASE("rim calibration: what it refuses", "[wrench]") {
  const Pad pad;
  const std::string owner = "RimCalibration: ";
  const Row border = pad.border();
  const auto dots_at = [&](double p) { return pad.dots(p); };
  CHECK(begins_with(refusal([&] { const RimCalibration<> refused(grid_of(border), -1); }),
                    owner + "base_radius_mm = -1"));
  CHECK(begins_with(refusal([&] { const RimCalibration<> refused(grid_of(border), 0); }),
                    owner + "base_radius_mm = 0"));
  CHECK(begins_with(refusal([&] { const RimCalibration<> refused(grid_of(border), none); }),
                    owner + "base_radius_mm = "));
  CHECK(refusal([&] { const RimCalibration<> refused(grid_of(border), 30); }) != "accepted");
  CHECK(begins_with(
      refusal([&] { const RimCalibration<> refused(grid_of(border), radius_mm, none); }),
      owner + "stress_free_inclination_rad = "));

  // unusable frames: nothing is added
  RimCalibration<> calibration(grid_of(border), radius_mm);
  const Row dots = dots_at(0.01);
  for (const double bad : {0.0, -0.01, none, infinity}) {
    CHECK_FALSE(calibration.add(0, grid_of(dots), bad));
  }
  CHECK_FALSE(calibration.add(1, grid_of(dots), 0.01));  // the earlier levels are missing
  CHECK_FALSE(calibration.add(0, grid_of(dots, 2), 0.01));
  CHECK(calibration.levels() == 0);
  CHECK(begins_with(refusal([&] { (void)(void)calibration.fit_modulus(0.8); }),
                    owner + "levels of pressure = 0"));
  REQUIRE(calibration.add(0, grid_of(dots), 0.01));
  CHECK(begins_with(refusal([&] { (void)(void)calibration.fit(); }),
                    owner + "levels of pressure = 1"));
  CHECK(refusal([&] { (void)(void)calibration.fit_modulus(0.8); }) == "accepted");
  for (const double bad : {0.0, -1.0, none, infinity}) {
    CHECK(begins_with(refusal([&] { (void)(void)calibration.fit_modulus(bad); }),
                      owner + "length_mm = "));
  }
  // shorter than the unstressed length
  CHECK(begins_with(refusal([&] { (void)(void)calibration.fit_modulus(1.2); }),
                    owner + "stretch of the side dots = "));

  const auto levels = [&](const std::vector<Row>& rows, const std::vector<double>& pressures,
                          const RimFitOptions& options = {}) {
    RimCalibration<> all(grid_of(border), radius_mm);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      REQUIRE(all.add(k, grid_of(rows[k]), pressures[k]));
    }
    return refusal([&] { (void)(void)all.fit(options); });
  };
  const Row low = dots_at(0.01), high = dots_at(0.02);
  CHECK(levels({low, high}, {0.01, 0.02}) == "accepted");
  CHECK(begins_with(levels({low, high}, {0.01, 0.01005}), owner + "distinct pressures = 1"));
  CHECK(begins_with(levels({low, low}, {0.01, 0.02}), owner + "condition number = "));
  CHECK(levels({high, low}, {0.01, 0.02}) != "accepted");
  Row few = high;
  for (std::size_t j = 0; j < 13; ++j) {
    few[2 * j].x = none;
  }
  CHECK(
      begins_with(levels({low, few}, {0.01, 0.02}), owner + "side dots found at every level = 23"));
  Row never = low, nor_here = high;
  never[3].z = nor_here[3].z = infinity;
  CHECK(begins_with(levels({never, nor_here}, {0.01, 0.02}),
                    owner + "side dots found at any level = 35"));
  // a pad that hangs down
  Row down = low, further_down = high;
  for (std::size_t j = 0; j < down.size(); ++j) {
    down[j].z = -down[j].z;
    further_down[j].z = -further_down[j].z;
  }
  CHECK(begins_with(levels({down, further_down}, {0.01, 0.02}), owner));

  for (const double bad : {-1.0, none, infinity}) {
    CHECK(begins_with(levels({low, high}, {0.01, 0.02}, {.side_dot_noise_mm = bad}),
                      "RimFitOptions: side_dot_noise_mm = "));
    CHECK(begins_with(levels({low, high}, {0.01, 0.02}, {.pressure_noise_mpa = bad}),
                      "RimFitOptions: pressure_noise_mpa = "));
  }
}
