// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What each taxel of a foam array does by itself: the library tells the waves of that taxel alone
// which vibrates most of its finger; here each is taken for a finger of one taxel.
#include <vector>

#include "replay/foam/step.hpp"

namespace replay {

/// One taxel that vibrates at some time.
struct TaxelTrack {
  std::size_t finger = 0;
  int row = 0;  ///< in its finger
  int col = 0;
  long long samples = 0;            ///< in which it vibrates
  std::vector<float> frequency_hz;  ///< the largest of each bin; 0: it does not vibrate
};

struct FoamActivity {
  std::size_t bins = 0;            ///< over the rows, one a row where they are not too many
  std::vector<TaxelTrack> tracks;  ///< by finger, row and column
  /// Of each row asked for: rms of each taxel of the array beyond its noise, 0 where there is none.
  std::vector<std::vector<float>> deviations;
};

/// `asked` are indices of rows, which are samples one after the other.
FoamActivity activity_of(const FoamRecording& recording,
                         const std::vector<FoamNoise>& noise,
                         const std::vector<FoamRow>& rows,
                         const std::vector<std::size_t>& asked,
                         std::size_t max_bins);

}  // namespace replay
