// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Simulates an object that hangs between two foam fingers: the readings of the taxels while the
// grip is loosened until the object slips.
//
// Each taxel carries a share of the grip force, largest at the center of the contact (Hertz). It
// bears friction up to K N^beta and holds the object by a spring along the finger. The object sinks
// until the springs carry its weight. Where a spring would pull harder than friction can bear, the
// taxel slips. A slipping taxel vibrates: its speed is the load of an oscillator on the foam, whose
// motion adds to the measured normal force.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/sim/foam_contact.hpp"

namespace grip {

struct FoamFingersSetup {
  fingerpad::Index rows = 16;
  fingerpad::Index cols = 4;
  double pitch_mm = 3.4;
  double first_force_n = 10;                                 // of each finger
  double weight_n = 4.1;                                     // of the object
  fingerpad::PolymerFriction<> friction = {.factor = 0.35};  // of one taxel
  double contact_radius_mm = 22;           // at the first force; scales with its cube root
  double shear_stiffness_n_per_mm = 0.05;  // of one taxel
  fingerpad::MassSpringDamper<> oscillator = {1e-5, 6e-5, 0.3};  // about 28 Hz
  double drag_n_s_per_mm = 0.03;  // load on the oscillator per mm/s of slip
  double counts_per_n = 800;
  double noise_counts = 4;
  double rate_hz = 100;
  double grip_lag_s = 0.1;  // of the gripper
};

/// Both fingers and the object between them.
class FoamFingers {
 public:
  /// `carried_share` of the weight is carried by the fingers at first; see carry().
  FoamFingers(const FoamFingersSetup& setup, unsigned seed, double carried_share = 1)
      : setup_(setup),
        hold_(setup.oscillator, 1 / setup.rate_hz),
        force_n_(setup.first_force_n),
        carried_share_(carried_share),
        random_(seed) {
    for (Finger& finger : fingers_) {
      // objects are not held exactly at the center
      std::uniform_real_distribution<double> place(-2, 2);
      finger.center_x_mm = place(random_);
      finger.center_y_mm = place(random_);
      finger.slip_mm.assign(taxels(), 0.0);
      finger.load_n.assign(taxels(), 0.0);
      finger.oscillators.assign(taxels(), {});
      finger.readings.assign(taxels(), 0.0);
    }
    for (int k = 0; k < 100; ++k) {  // let it come to rest
      advance(setup.first_force_n);
    }
    time_s_ = 0;
  }

  /// Advances by one sample, while the grip force approaches `force_n`.
  void advance(double force_n) {
    force_n_ += (force_n - force_n_) / (1 + setup_.grip_lag_s * setup_.rate_hz);
    time_s_ += 1 / setup_.rate_hz;
    for (Finger& finger : fingers_) {
      advance(finger);
    }
  }

  /// Readings of finger 0 or 1, counts.
  fingerpad::StridedView<const double> readings(std::size_t finger) const {
    return {fingers_[finger].readings.data(), setup_.rows, setup_.cols, setup_.cols};
  }
  double time_s() const { return time_s_; }
  double force_n() const { return force_n_; }
  /// Sets the share of the weight that the fingers carry, 0 to 1; a surface carries the rest.
  void carry(double share) { carried_share_ = share; }
  /// Largest slip of the object over a taxel of this finger in this sample.
  double slipped_mm(std::size_t finger) const { return fingers_[finger].slipped_mm; }
  /// Whether friction can no longer hold the object on one of the fingers.
  bool has_slipped() const { return fingers_[0].has_slipped || fingers_[1].has_slipped; }
  /// Least grip force at which friction bears the carried weight, with every taxel at its limit.
  double least_force_n() const {
    double low = 0, high = 1000;
    for (int k = 0; k < 40; ++k) {
      const double middle = (low + high) / 2;
      double bears = 1e300;
      for (const Finger& finger : fingers_) {
        double of_finger = 0;
        for (const double normal : pressures(finger, middle)) {
          of_finger += friction_force(setup_.friction, normal);
        }
        bears = std::min(bears, of_finger);
      }
      (bears < carried_share_ * setup_.weight_n / 2 ? low : high) = middle;
    }
    return high;
  }
  const FoamFingersSetup& setup() const { return setup_; }

 private:
  struct Finger {
    double center_x_mm = 0, center_y_mm = 0;
    double sunk_mm = 0;  // the object relative to the finger
    bool has_slipped = false;
    double slipped_mm = 0;        // in this sample, the largest
    std::vector<double> slip_mm;  // of the object over each taxel
    std::vector<double> load_n;   // on each oscillator
    std::vector<fingerpad::MassSpringDamper<>::Motion> oscillators;
    std::vector<double> readings;
  };

  std::size_t taxels() const { return static_cast<std::size_t>(setup_.rows * setup_.cols); }

  /// The normal force on each taxel.
  std::vector<double> pressures(const Finger& finger, double force_n) const {
    const double radius = setup_.contact_radius_mm * std::cbrt(force_n / setup_.first_force_n);
    std::vector<double> normal(taxels());
    double sum = 0;
    for (std::size_t k = 0; k < normal.size(); ++k) {
      const auto row = static_cast<fingerpad::Index>(k) / setup_.cols;
      const auto col = static_cast<fingerpad::Index>(k) % setup_.cols;
      const double y = (double(row) - double(setup_.rows - 1) / 2) * setup_.pitch_mm;
      const double x = (double(col) - double(setup_.cols - 1) / 2) * setup_.pitch_mm;
      const double away = std::hypot(x - finger.center_x_mm, y - finger.center_y_mm) / radius;
      normal[k] = std::sqrt(std::max(0.0, 1 - away * away));
      sum += normal[k];
    }
    for (double& n : normal) {
      n *= force_n / sum;
    }
    return normal;
  }

  void advance(Finger& finger) {
    const std::vector<double> normal = pressures(finger, force_n_);
    sink(finger, normal);
    finger.slipped_mm = 0;
    for (std::size_t k = 0; k < normal.size(); ++k) {
      const double bears = friction_force(setup_.friction, normal[k]);
      const double pull = setup_.shear_stiffness_n_per_mm * (finger.sunk_mm - finger.slip_mm[k]);
      const double slipped = std::max(0.0, (pull - bears) / setup_.shear_stiffness_n_per_mm);
      finger.slip_mm[k] += slipped;
      finger.slipped_mm = std::max(finger.slipped_mm, normal[k] > 0 ? slipped : 0.0);
      const double load = normal[k] > 0 ? setup_.drag_n_s_per_mm * slipped * setup_.rate_hz : 0.0;
      auto& oscillator = finger.oscillators[k];
      oscillator = hold_(finger.load_n[k], load, oscillator);
      const double shakes = setup_.oscillator.stiffness_n_per_mm * oscillator.position_mm;
      finger.load_n[k] = load;
      const double felt = normal[k] > 0 ? normal[k] + shakes : 0.0;
      finger.readings[k] =
          std::max(0.0, setup_.counts_per_n * felt + setup_.noise_counts * normal_(random_));
    }
  }

  /// Lets the object sink until this finger's taxels carry half of the carried weight.
  void sink(Finger& finger, const std::vector<double>& normal) const {
    const auto carried = [&](double sunk_mm) {
      double sum = 0;
      for (std::size_t k = 0; k < normal.size(); ++k) {
        sum += std::min(friction_force(setup_.friction, normal[k]),
                        setup_.shear_stiffness_n_per_mm * (sunk_mm - finger.slip_mm[k]));
      }
      return sum;
    };
    const double weight = carried_share_ * setup_.weight_n / 2;
    double low = finger.sunk_mm, high = finger.sunk_mm + 100;
    finger.has_slipped = finger.has_slipped || carried(high) < weight;
    if (finger.has_slipped || carried(low) >= weight) {
      return;
    }
    for (int k = 0; k < 40; ++k) {
      const double middle = (low + high) / 2;
      (carried(middle) < weight ? low : high) = middle;
    }
    finger.sunk_mm = high;
  }

  FoamFingersSetup setup_;
  fingerpad::FirstOrderHold<> hold_;
  double force_n_;
  double time_s_ = 0;
  double carried_share_;
  std::array<Finger, 2> fingers_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_{0, 1};
};

}  // namespace grip
