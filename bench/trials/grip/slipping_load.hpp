// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A minimal model of a load that hangs on a fluid fingertip by friction:
//   - the membrane is a square net of springs, fixed at the rim; each node is a printed dot. The
//     fluid behind the membrane does not resist its motion, so there is no other spring;
//   - the contact is a disc over which the fluid's pressure carries the grip force, so its area is
//     force / pressure, and each dot in it carries an equal share;
//   - a dot in contact moves with the object while the net pulls on it by less than the friction
//     limit (Coulomb, one coefficient), and slides against that force otherwise;
//   - the object has a mass, and a little drag so that it does not ring.
// Not modelled: depth, lateral contraction, a drop of friction when sliding begins, other fingers.
// "load" is the share of the weight that this fingertip bears.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

namespace grip {

struct Fingertip {
  int dots = 21;  ///< per direction, odd
  double pitch_mm = 1.5;
  double rim_mm = 15.5;          ///< radius at which the membrane is fixed
  double spring_n_per_mm = 0.1;  ///< of the net: shear modulus times thickness of the membrane
  double pressure_mpa = 0.02;
  double friction = 0.6;
  double drag_ns_per_mm = 0.005;
};

class SlippingLoad {
 public:
  /// Starts with the object hanging at rest.
  SlippingLoad(const Fingertip& tip, double load_n, double force_n)
      : tip_(tip),
        shift_mm_(cells(), 0),
        slid_mm_(cells(), 0),
        touches_(cells(), 0),
        free_(cells(), 0) {
    for (int i = 0; i < tip.dots; ++i) {
      for (int j = 0; j < tip.dots; ++j) {
        free_[at(i, j)] = std::hypot(place_mm(i), place_mm(j)) < tip.rim_mm ? 1 : 0;
      }
    }
    for (int k = 0; k < 60; ++k) {
      advance(load_n, force_n, 1.0 / 30);
    }
    slip_mm_ = 0;
  }

  /// Advances by `time_s`: `load_n` pulls the object along x, and the tip presses with `force_n`.
  void advance(double load_n, double force_n, double time_s) {
    constexpr int steps = 40;
    constexpr double gravity_mm_s2 = 9810;
    press(force_n);
    for (int k = 0; k < steps; ++k) {
      held_n_ = relax();
      const double pull_n = load_n - held_n_ - tip_.drag_ns_per_mm * speed_mm_s_;
      speed_mm_s_ += time_s / steps * pull_n / load_n * gravity_mm_s2;
      object_mm_ += time_s / steps * speed_mm_s_;
    }
  }

  /// Changes the friction from now on, as when the contact gets wet.
  void set_friction(double friction) { tip_.friction = friction; }
  /// Moves the center of the contact along x, as a rolling object does.
  void roll_to(double middle_mm) { middle_mm_ = middle_mm; }

  double x_mm(int row, int col) const { return place_mm(col) + shift_mm_[at(row, col)]; }
  double y_mm(int row, int) const { return place_mm(row); }
  bool touches(int row, int col) const { return touches_[at(row, col)] != 0; }
  /// The tangential force, as a force sensor in the fingertip measures it.
  double held_n() const { return held_n_; }
  double friction_limit_n() const { return tip_.friction * force_n_; }
  /// Gross slip of the object: the sum over the steps of the slip of the dot that slips least.
  double slip_mm() const { return slip_mm_; }

 private:
  int width() const { return tip_.dots + 2; }
  std::size_t cells() const { return static_cast<std::size_t>(width() * width()); }
  std::size_t at(int row, int col) const {
    return static_cast<std::size_t>((row + 1) * width() + col + 1);
  }
  double place_mm(int k) const { return tip_.pitch_mm * (k - tip_.dots / 2); }

  /// Sets the contact for this force. Dots that come into contact stick where they are.
  void press(double force_n) {
    force_n_ = force_n;
    touching_ = 0;
    const double contact_mm = std::sqrt(force_n / tip_.pressure_mpa / std::numbers::pi);
    const double radius_mm = (std::min)(contact_mm, tip_.rim_mm - tip_.pitch_mm);
    for (int i = 0; i < tip_.dots; ++i) {
      for (int j = 0; j < tip_.dots; ++j) {
        const std::size_t k = at(i, j);
        const bool touches = std::hypot(place_mm(i), place_mm(j) - middle_mm_) < radius_mm;
        slid_mm_[k] = touches && touches_[k] == 0 ? shift_mm_[k] - object_mm_ : slid_mm_[k];
        touches_[k] = touches ? 1 : 0;
        touching_ += touches ? 1 : 0;
      }
    }
  }

  /// Relaxes the net with the object fixed; returns the force with which it holds the object.
  double relax() {
    const double max_mm = friction_limit_n() / touching_ / tip_.spring_n_per_mm;
    for (int sweep = 0; sweep < 12; ++sweep) {
      for (std::size_t k = 0; k < free_.size(); ++k) {
        if (free_[k] != 0) {
          const double rest_mm = neighbours_mm(k) / 4;
          shift_mm_[k] = touches_[k] == 0 ? shift_mm_[k] + 1.5 * (rest_mm - shift_mm_[k])
                                          : std::clamp(object_mm_ + slid_mm_[k],
                                                       rest_mm - max_mm / 4, rest_mm + max_mm / 4);
        }
      }
    }
    double held_mm = 0;
    double least_mm = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < free_.size(); ++k) {
      if (touches_[k] != 0) {
        held_mm += std::clamp(4 * shift_mm_[k] - neighbours_mm(k), -max_mm, max_mm);
        const double at_mm = shift_mm_[k] - object_mm_;
        least_mm = (std::min)(least_mm, (std::max)(slid_mm_[k] - at_mm, 0.0));
        slid_mm_[k] = at_mm;
      }
    }
    slip_mm_ += touching_ > 0 ? least_mm : 0;
    return tip_.spring_n_per_mm * held_mm;
  }

  double neighbours_mm(std::size_t k) const {
    const auto row = static_cast<std::size_t>(width());
    return shift_mm_[k - 1] + shift_mm_[k + 1] + shift_mm_[k - row] + shift_mm_[k + row];
  }

  Fingertip tip_;
  std::vector<double> shift_mm_;  ///< of each dot, along x
  std::vector<double> slid_mm_;   ///< of each dot relative to the object
  std::vector<char> touches_;
  std::vector<char> free_;  ///< not fixed at the rim
  int touching_ = 0;
  double middle_mm_ = 0;  ///< of the contact, along x
  double force_n_ = 0;
  double held_n_ = 0;
  double object_mm_ = 0;
  double speed_mm_s_ = 0;
  double slip_mm_ = 0;
};

}  // namespace grip
