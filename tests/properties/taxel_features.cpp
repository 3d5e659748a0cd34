// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties of the features of every array.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fingerpad/foam/taxels.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

namespace {

using Array = Image<double>;
using Recording = std::vector<Array>;

/// Integer readings from 1 to 4000 of a few taxels that vibrate, jump, drift or rest: sums of
/// integers are exact. No reading is 0, which means no pressure.
Recording any_recording(Index rows, Index cols, Index samples) {
  struct Taxel {
    double level, amplitude, period, phase, drift;
    Index jump_at;
  };
  std::vector<Taxel> taxels;
  for (Index k = 0; k < rows * cols; ++k) {
    taxels.push_back({test::uniform(0, 2000), test::whole(0, 1) == 0 ? 0 : test::uniform(0, 500),
                      test::uniform(2, 20), test::uniform(0, 1), test::uniform(-5, 5),
                      test::whole(0, 3 * samples)});
  }
  Recording recording;
  for (Index n = 0; n < samples; ++n) {
    Array array(rows, cols);
    for (std::size_t k = 0; k < taxels.size(); ++k) {
      const Taxel& t = taxels[k];
      const double time = static_cast<double>(n);
      const double wave = t.amplitude * std::sin(6.283 * (time / t.period + t.phase));
      array.cells[k] = std::clamp(
          std::round(t.level + wave + t.drift * time + (n > t.jump_at ? 300 : 0)), 1.0, 4000.0);
    }
    recording.push_back(array);
  }
  return recording;
}

TaxelOptions any_options() {
  TaxelOptions o;
  o.window = Index(1) << test::whole(2, 5);  // a power of two: means of integers are exact
  o.sample_period_s = 1;
  o.longest_gap_s = 10;
  o.noise = test::uniform(0, 50);
  return o;
}

std::vector<FingerSample<double>> features_of(TaxelFeatures<> features,
                                              const Recording& recording) {
  std::vector<FingerSample<double>> samples;
  for (std::size_t n = 0; n < recording.size(); ++n) {
    samples.push_back(features(recording[n], static_cast<double>(n)));
  }
  return samples;
}

template <class Change>
Recording changed(Recording recording, const Change& change) {
  for (Array& array : recording) {
    for (double& reading : array.cells) {
      reading = change(reading);
    }
  }
  return recording;
}

void same_vibration(const FingerSample<double>& a, const FingerSample<double>& b) {
  RC_ASSERT(a.status == b.status);
  RC_ASSERT(a.location == b.location);
  RC_ASSERT(a.waves == b.waves);
  RC_ASSERT(a.left_out == b.left_out);
}

double variance_by_hand(const Recording& recording, std::size_t last, std::size_t taxel, Index n) {
  const double length = static_cast<double>(n);
  double mean = 0, middle = (length - 1) / 2, tilt = 0, spread = 0, squares = 0;
  const auto reading = [&](Index u) {
    return recording[last + 1 - static_cast<std::size_t>(n - u)].cells[taxel];
  };
  for (Index u = 0; u < n; ++u) {
    mean += reading(u) / length;
    tilt += (static_cast<double>(u) - middle) * reading(u);
    spread += (static_cast<double>(u) - middle) * (static_cast<double>(u) - middle);
  }
  for (Index u = 0; u < n; ++u) {
    const double left = reading(u) - mean - tilt / spread * (static_cast<double>(u) - middle);
    squares += left * left;
  }
  return squares / length;
}

}  // namespace

TEST_CASE("taxel features: laws", "[taxel_features]") {
  using Features = TaxelFeatures<>;

  rc::prop("a load that is added to all of them vibrates no taxel and stops none", [] {
    const auto recording = any_recording(3, 4, 70);
    const Features features(3, 4, any_options());
    const double load = static_cast<double>(test::whole(0, 5000));
    const auto plain = features_of(features, recording);
    const auto loaded =
        features_of(features, changed(recording, [=](double x) { return x + load; }));
    for (std::size_t n = 0; n < plain.size(); ++n) {
      same_vibration(plain[n], loaded[n]);
      RC_ASSERT(std::fabs(plain[n].deviation - loaded[n].deviation) <= 1e-9 * plain[n].deviation);
    }
  });

  rc::prop("in another unit all is the same, and sums and deviations are in that unit", [] {
    const auto recording = any_recording(3, 4, 70);
    const auto o = any_options();
    const double unit = std::ldexp(1.0, static_cast<int>(test::whole(-30, 12)));
    auto in_unit = o;
    in_unit.noise *= unit;
    const auto plain = features_of(Features(3, 4, o), recording);
    const auto scaled = features_of(Features(3, 4, in_unit),
                                    changed(recording, [=](double x) { return x * unit; }));
    for (std::size_t n = 0; n < plain.size(); ++n) {
      same_vibration(plain[n], scaled[n]);
      RC_ASSERT(plain[n].deviation * unit == scaled[n].deviation);
      RC_ASSERT(plain[n].sum * unit == scaled[n].sum);
      RC_ASSERT(plain[n].is_pressed() == scaled[n].is_pressed());
      RC_ASSERT(!plain[n].is_pressed() || plain[n].center_x_mm == scaled[n].center_x_mm);
      RC_ASSERT(!plain[n].is_pressed() || plain[n].center_y_mm == scaled[n].center_y_mm);
    }
  });

  rc::prop("an array that is rotated over is felt rotated over", [] {
    const auto recording = any_recording(3, 4, 60);
    const Features features(3, 4, any_options());
    const Features across(4, 3, features.options());
    Recording transposed;
    for (const Array& array : recording) {
      Array t(4, 3);
      for (Index i = 0; i < 3; ++i) {
        for (Index j = 0; j < 4; ++j) {
          t(j, i) = array(i, j);
        }
      }
      transposed.push_back(t);
    }
    const auto plain = features_of(features, recording);
    const auto rotated = features_of(across, transposed);
    for (std::size_t n = 0; n < plain.size(); ++n) {
      RC_ASSERT(plain[n].status == rotated[n].status);
      // among equal taxels another may be the first
      RC_ASSERT(std::fabs(plain[n].deviation - rotated[n].deviation) <= 1e-9 * plain[n].deviation);
      RC_ASSERT(!plain[n].is_pressed() ||
                std::fabs(plain[n].center_x_mm - rotated[n].center_y_mm) < 1e-12);
      RC_ASSERT(!plain[n].is_pressed() ||
                std::fabs(plain[n].center_y_mm - rotated[n].center_x_mm) < 1e-12);
    }
  });

  rc::prop("when the recording was taken does not matter", [] {
    const auto recording = any_recording(2, 3, 60);
    const Features features(2, 3, any_options());
    const double later = static_cast<double>(test::whole(-1000000, 1000000));
    auto finger = features;
    const auto plain = features_of(features, recording);
    for (std::size_t n = 0; n < plain.size(); ++n) {
      same_vibration(plain[n], finger(recording[n], static_cast<double>(n) + later));
    }
  });

  rc::prop("a copy of the finger goes on like the finger", [] {
    const auto recording = any_recording(2, 3, 60);
    const Features features(2, 3, any_options());
    const auto plain = features_of(features, recording);
    const std::size_t at = static_cast<std::size_t>(test::whole(1, 59));
    auto finger = features;
    for (std::size_t n = 0; n < at; ++n) {
      finger(recording[n], static_cast<double>(n));
    }
    auto copy = finger;
    finger(recording[0], 1e6);
    for (std::size_t n = at; n < plain.size(); ++n) {
      same_vibration(plain[n], copy(recording[n], static_cast<double>(n)));
    }
  });

  rc::prop("a taxel that cannot be read changes nothing in what the others say", [] {
    const auto recording = any_recording(3, 3, 60);
    const auto o = any_options();
    const std::size_t broken = static_cast<std::size_t>(test::whole(0, 8));
    Recording with_gap = recording;
    for (Array& array : with_gap) {
      array.cells[broken] = test::nan;
    }
    std::vector<double> noise(9, o.noise);
    noise[broken] = test::nan;  // known to be dead
    const auto told = features_of(Features(3, 3, o, noise), recording);
    const auto found = features_of(Features(3, 3, o), with_gap);
    for (std::size_t n = 0; n < told.size(); ++n) {
      same_vibration(told[n], found[n]);
      RC_ASSERT(told[n].sum == found[n].sum);
      RC_ASSERT(told[n].location != static_cast<Index>(broken));
    }
  });

  rc::prop("more noise to be expected never makes a vibration", [] {
    const auto recording = any_recording(3, 3, 60);
    auto o = any_options();
    const auto few = features_of(Features(3, 3, o), recording);
    o.noise *= test::uniform(1, 3);
    const auto fewer = features_of(Features(3, 3, o), recording);
    for (std::size_t n = 0; n < few.size(); ++n) {
      RC_ASSERT(fewer[n].location == FingerSample<double>::no_location ||
                fewer[n].location == few[n].location);
    }
  });
}

TEST_CASE("taxel features: what is reported is what two passes over the window give",
          "[taxel_features]") {
  rc::prop("any recording", [] {
    const auto recording = any_recording(3, 4, 90);
    const TaxelFeatures<> features(3, 4, any_options());
    const auto samples = features_of(features, recording);
    const double floor = std::pow(2.5 * features.options().noise, 2);
    const Index window = features.options().window;
    for (std::size_t n = static_cast<std::size_t>(window) - 1; n < samples.size(); n += 3) {
      double largest = 0;
      for (std::size_t k = 0; k < 12; ++k) {
        largest = (std::max)(largest, variance_by_hand(recording, n, k, window));
      }
      const auto& sample = samples[n];
      if (largest > floor * (1 + 1e-9) && largest > 1e-9) {
        RC_ASSERT(sample.is_vibrating());
        const std::size_t at = static_cast<std::size_t>(sample.location);
        RC_ASSERT(variance_by_hand(recording, n, at, window) >= largest * (1 - 1e-9));
        RC_ASSERT(std::fabs(sample.deviation * sample.deviation - largest) <= 1e-9 * largest);
      } else if (largest < floor * (1 - 1e-9)) {
        RC_ASSERT(!sample.is_vibrating());
      }
    }
  });
}

TEST_CASE("taxel features: whatever is read, what is said is in range", "[taxel_features]") {
  rc::prop("odd readings at odd times", [] {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    constexpr double odd[] = {test::nan, infinite, -infinite, 0, -0.0, 1e308, -1e308, 5e-324, 4095};
    auto o = any_options();
    o.stuck_after = test::whole(0, 8);
    o.saturated_at = test::whole(0, 1) == 0 ? 1e9 : 4000;
    o.min_sum = test::uniform(0, 100);
    const TaxelFeatures features(2, 3, o);
    auto finger = features;
    double time = 0;
    for (int n = 0; n < 60; ++n) {
      Array array(2, 3);
      for (double& reading : array.cells) {
        const auto kind = test::whole(0, 24);
        reading = kind < 9 ? odd[kind] : test::uniform(0, 1000);
      }
      const auto kind = test::whole(0, 30);
      time = kind == 0 ? time - 100 : kind == 1 ? time + 50 : time + test::uniform(0.01, 2);
      const auto sample = finger(array, kind == 2 ? odd[test::whole(0, 2)] : time);
      RC_ASSERT(sample.location >= -1 && sample.location < 6);
      RC_ASSERT(sample.waves >= 0 && sample.waves <= o.window / 2);
      RC_ASSERT(sample.left_out >= 0 && sample.left_out <= 6);
      RC_ASSERT((sample.location >= 0) == (sample.status == TaxelStatus::vibrating));
      RC_ASSERT(is_finite(sample.frequency_hz));
      if (sample.is_pressed()) {  // sums of huge readings may overflow
        RC_ASSERT(sample.center_x_mm >= 0 && sample.center_x_mm <= 2 * o.pitch_mm * (1 + 1e-12));
        RC_ASSERT(sample.center_y_mm >= 0 && sample.center_y_mm <= o.pitch_mm * (1 + 1e-12));
      }
    }
  });
}

TEST_CASE("taxel features: what is held still stays", "[taxel_features]") {
  rc::prop("sum and centroid of a steady hold are those of its first sample", [] {
    auto o = any_options();
    o.stuck_after = test::whole(1, 8);
    const auto flickering = test::whole(0, 6);  // of 16 taxels
    std::vector<double> load;
    for (int k = 0; k < 16; ++k) {
      load.push_back(static_cast<double>(test::whole(1, 1000)));
    }
    TaxelFeatures<> finger(4, 4, o);
    FingerSample<> first, last;
    for (int n = 0; n < 41; ++n) {
      Array array(4, 4);
      for (std::ptrdiff_t k = 0; k < 16; ++k) {
        array.cells[static_cast<std::size_t>(k)] =
            load[static_cast<std::size_t>(k)] + (k < flickering ? n % 2 : 0);
      }
      last = finger(array, n * o.sample_period_s);
      first = n == 0 ? last : first;
    }
    RC_ASSERT(last.left_out == 0);
    RC_ASSERT(last.sum == Approx(first.sum));
    RC_ASSERT(last.center_x_mm == Approx(first.center_x_mm));
    RC_ASSERT(last.center_y_mm == Approx(first.center_y_mm));
  });
}
