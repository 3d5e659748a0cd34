// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Loads from dots of finite-element membranes against the truth.
// test_figures "[traction]" -s prints all figures.
#include "fingerpad/force/traction.hpp"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

#include "support/catch.hpp"
#include "support/traction_scenes.hpp"

using namespace fingerpad;
using test::TractionError;
using test::TractionScene;

namespace {

constexpr double true_mu_t = 0.5;  // N/mm: shear modulus 0.5 MPa, 1 mm thick

class Table {
 public:
  explicit Table(const std::string& title) {
    text_ << '\n'
          << title << ", per cent\n"
          << "            F_x   F_y   F_z |  M_x   M_y   M_z | pressure: rms worst  mean |  mu t"
             " | free load\n";
  }
  void add(const TractionScene& s, const TractionError& e) {
    text_ << std::left << std::setw(9) << s.name << std::right << std::fixed
          << std::setprecision(2);
    for (const double f : e.force) {
      text_ << std::setw(6) << 100 * f;
    }
    text_ << " |";
    // a press has no moment about Q to relate errors to
    for (const double m : e.moment) {
      text_ << std::setw(6) << (s.largest_moment_n_mm() > 0.1 ? 100 * m : 0);
    }
    text_ << " |      " << std::setw(6) << 100 * e.pressure_rms << std::setw(6)
          << 100 * e.pressure_worst << std::setw(6) << 100 * e.pressure_mean << " | "
          << std::setprecision(4) << e.mu_t << " | " << std::setprecision(1) << 100 * e.free_load
          << '\n';
  }
  void show() const {
    INFO(text_.str());
    SUCCEED();
  }

 private:
  std::ostringstream text_;
};

bool is_flat(const TractionScene& s) {
  return s.name != "roll" && s.name != "cylinder";
}

double largest(const std::array<double, 3>& parts) {
  return (std::max)({parts[0], parts[1], parts[2]});
}

}  // namespace

TEST_CASE("traction of finite-element membranes, mu t given", "[traction]") {
  TractionField field(test::stress_free_dots(), {.mu_t_n_per_mm = true_mu_t});
  Table table("mu t given, exact dots");
  for (const TractionScene& s : test::traction_scenes()) {
    const TractionError e = traction_error(field, s);
    table.add(s, e);
    CAPTURE(s.name);
    CHECK(e.frames == 1);
    CHECK(largest(e.force) <= 0.01);
    CHECK((s.name == "press" || largest(e.moment) <= 0.02));
    CHECK(e.pressure_rms <= (is_flat(s) ? 0.01 : 0.04));
    CHECK(e.pressure_worst <= 0.05);
    CHECK(e.free_load <= 0.06);
  }
  table.show();
}

TEST_CASE("traction of finite-element membranes, mu t from the balance", "[traction]") {
  TractionField field(test::stress_free_dots());
  Table table("mu t from the balance, exact dots");
  for (const TractionScene& s : test::traction_scenes()) {
    const TractionError e = traction_error(field, s);
    table.add(s, e);
    CAPTURE(s.name);
    CHECK(e.frames == 1);
    CHECK(std::abs(e.mu_t - true_mu_t) <= 0.03 * true_mu_t);
    CHECK(largest(e.force) <= 0.03);
    CHECK((s.name == "press" || largest(e.moment) <= 0.03));
    CHECK(e.pressure_rms <= (is_flat(s) ? 0.01 : 0.05));
    CHECK(e.pressure_worst <= 0.05);
  }
  table.show();
}

TEST_CASE("traction of finite-element membranes, noisy dots", "[traction]") {
  TractionField field(test::stress_free_dots());
  const int frames = 40;
  for (const double noise_mm : {0.005, 0.02}) {
    std::ostringstream title;
    title << "mu t from the balance, noise of " << noise_mm << " mm in x, y and z";
    Table table(title.str());
    for (const TractionScene& s : test::traction_scenes()) {
      const TractionError e = traction_error(field, s, noise_mm, frames);
      table.add(s, e);
      CAPTURE(s.name, noise_mm);
      CHECK(e.frames == frames);
      // noise does not change the balance
      CHECK(std::abs(e.mu_t - true_mu_t) <= 0.03 * true_mu_t);
      CHECK(largest(e.force) <= 0.02 + 6 * noise_mm);
      CHECK(e.pressure_mean < e.pressure_rms / 2);
    }
    table.show();
  }
}

TEST_CASE("mu t from frames of the free pad", "[traction]") {
  TractionField field(test::stress_free_dots());
  const TractionScene s = test::traction_scene("free");
  const auto exact = field(s.dots, s.contact, s.pressure_mpa);
  CHECK(exact.status == TractionStatus::no_contact);
  CHECK(std::abs(exact.mu_t_n_per_mm - true_mu_t) <= 0.015 * true_mu_t);
  CHECK(exact.free_load_rms_mpa <= 0.04 * s.pressure_mpa);

  test::Gauss gauss(3);
  double sum = 0, sum_sq = 0;
  const int frames = 50;
  for (int k = 0; k < frames; ++k) {
    const auto r = field(noisy(s.dots, 0.02, gauss), s.contact, s.pressure_mpa);
    sum += r.mu_t_n_per_mm;
    sum_sq += square(r.mu_t_n_per_mm);
  }
  const double mean = sum / frames;
  const double sd = std::sqrt((std::max)(0.0, sum_sq / frames - mean * mean));
  INFO("mu t, N/mm: exact dots " << exact.mu_t_n_per_mm << ", noise of 0.02 mm: one frame " << mean
                                 << " +- " << sd);
  CHECK(sd <= 0.02 * true_mu_t);
  CHECK(std::abs(mean - true_mu_t) <= 0.025 * true_mu_t);
}

TEST_CASE("what noise of the dots does to a load", "[traction]") {
  // The load is a second difference of positions: noise scales with mu t / pitch^2 along the
  // membrane and with its tension / pitch^2 across it.
  const double mu_t = 0.5, stretch = 1.15, noise_mm = 0.005;
  const double tension = mu_t * (1 - std::pow(stretch, -6));
  for (const double pitch : {0.75, 1.5, 3.0}) {
    test::Dots free(15, 15), dots(15, 15);
    for (Index i = 0; i < 15; ++i) {
      for (Index j = 0; j < 15; ++j) {
        free(i, j) = {pitch * static_cast<double>(j), pitch * static_cast<double>(i), 0};
        dots(i, j) = stretch * free(i, j);
      }
    }
    TractionField field(free, {.mu_t_n_per_mm = mu_t});
    test::Gauss gauss(6);
    double shear_sq = 0, normal_sq = 0, count = 0;
    for (int k = 0; k < 20; ++k) {
      (void)field(noisy(dots, noise_mm, gauss), test::Flags(15, 15, 0), 0.02);
      for (Index i = 1; i < 14; ++i) {
        for (Index j = 1; j < 14; ++j) {
          shear_sq += squared_norm(field.shear_mpa()(i, j)) / 2;
          normal_sq += square(field.pressure_mpa()(i, j) - 0.02);
          count += 1;
        }
      }
    }
    const double unit = noise_mm / square(pitch * stretch);
    const double along = std::sqrt(shear_sq / count) / (mu_t * unit);
    const double across = std::sqrt(normal_sq / count) / (tension * unit);
    INFO("pitch " << pitch << " mm: sd of a component of the shear " << along
                  << " mu t noise / pitch^2, of the pressure " << across
                  << " tension noise / pitch^2 (pitch of the dots as they are)");
    CHECK(along == Approx(7.5).epsilon(0.1));
    CHECK(across == Approx(4.5).epsilon(0.1));
  }
}
