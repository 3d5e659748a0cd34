// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Readings of two foam fingers that hold an object, with patches that begin to slip at a known
// time. All taxels of a patch vibrate about their load in phase. White noise and a slow drift of
// the load are added.
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "fingerpad/foam/taxels.hpp"
#include "support/pad.hpp"

namespace test {

/// A rectangle of taxels that vibrates from `begin_s` on.
struct VibratingPatch {
  fingerpad::Index row = 0, col = 0, rows = 2, cols = 2;
  double begin_s = 0;
  double frequency_hz = 5;
  double phase = 0;
};

struct FoamScene {
  fingerpad::Index rows = 16;
  fingerpad::Index cols = 4;
  double load = 400;               // counts in the middle of the contact
  double noise = 4;                // counts, standard deviation
  double drift = 0.2;              // amplitude of the drift, relative to the load
  double drift_period_s = 20;      // period of the drift
  double signal_to_noise_db = 20;  // power of the vibration relative to the noise
  std::array<std::vector<VibratingPatch>, 2> patches;  // of each finger

  double amplitude() const {
    return noise * std::sqrt(2.0) * std::pow(10.0, signal_to_noise_db / 20);
  }
};

/// Readings of both fingers, sample by sample.
class FoamSignal {
 public:
  FoamSignal(const FoamScene& scene, unsigned seed) : scene_(scene), random_(seed) {}

  Image<double> finger(std::size_t f, double time_s) {
    using fingerpad::Index;
    Image<double> taxels(scene_.rows, scene_.cols);
    const double tau = 2 * std::numbers::pi;
    const double drift =
        1 + scene_.drift * std::sin(tau * time_s / scene_.drift_period_s + double(f));
    for (Index i = 0; i < scene_.rows; ++i) {
      for (Index j = 0; j < scene_.cols; ++j) {
        taxels(i, j) = scene_.load * share(i, j) * drift + scene_.noise * normal_(random_);
      }
    }
    Image<int> is_slipping(scene_.rows, scene_.cols, 0);
    for (const VibratingPatch& patch : scene_.patches[f]) {
      const double since_s = time_s - patch.begin_s;
      const double wave =
          scene_.amplitude() * std::sin(tau * patch.frequency_hz * since_s + patch.phase);
      for (Index i = patch.row; i < patch.row + patch.rows && since_s >= 0; ++i) {
        for (Index j = patch.col; j < patch.col + patch.cols; ++j) {
          taxels(i, j) += is_slipping(i, j) == 0 ? wave : 0;  // overlaps: of the first patch only
          is_slipping(i, j) = 1;
        }
      }
    }
    return taxels;
  }

 private:
  /// Relative load of a taxel in an elliptic contact that covers the array.
  double share(fingerpad::Index i, fingerpad::Index j) const {
    const double y = (double(i) + 0.5) / double(scene_.rows) * 2 - 1;
    const double x = (double(j) + 0.5) / double(scene_.cols) * 2 - 1;
    return std::sqrt(std::fmax(0.1, 1 - 0.5 * x * x - 0.5 * y * y));
  }

  FoamScene scene_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_{0, 1};
};

/// A finger that vibrates at `location` with `waves`; its force is at x.
inline fingerpad::FingerSample<> finger(double x_mm,
                                        fingerpad::Index location,
                                        fingerpad::Index waves) {
  using fingerpad::TaxelStatus;
  fingerpad::FingerSample<> s;
  s.status = waves > 0 ? TaxelStatus::vibrating : TaxelStatus::quiet;
  s.center_x_mm = x_mm;
  s.center_y_mm = 10;
  if (waves > 0) {
    s.add_vibration(location, waves);
  }
  return s;
}

}  // namespace test
