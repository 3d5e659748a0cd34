// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vibration of each taxel of a foam array. The library reports only the taxel of a finger that
// vibrates most; here each taxel is processed as a finger of its own.
#include <vector>

#include "replay/foam/step.hpp"

namespace replay {

/// A taxel that vibrates at some time.
struct TaxelTrack {
  std::size_t finger = 0;
  int row = 0;  ///< within its finger
  int col = 0;
  long long samples = 0;            ///< number of samples in which it vibrates
  std::vector<float> frequency_hz;  ///< largest in each bin; 0 without vibration
};

struct FoamActivity {
  std::size_t bins = 0;            ///< over the rows; one per row up to `max_bins`
  std::vector<TaxelTrack> tracks;  ///< by finger, row and column
  /// For each requested row: rms vibration of each taxel of the array, 0 without vibration.
  std::vector<std::vector<float>> deviations;
};

/// `rows` are the samples in order; `asked` are the indices of the rows for `deviations`.
FoamActivity activity_of(const FoamRecording& recording,
                         const std::vector<FoamNoise>& noise,
                         const std::vector<FoamRow>& rows,
                         const std::vector<std::size_t>& asked,
                         std::size_t max_bins);

}  // namespace replay
