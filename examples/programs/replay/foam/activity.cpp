// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/activity.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace replay {

FoamActivity activity_of(const FoamRecording& recording,
                         const std::vector<FoamNoise>& noise,
                         const std::vector<FoamRow>& rows,
                         const std::vector<std::size_t>& asked,
                         std::size_t max_bins) {
  FoamActivity activity;
  activity.bins = (std::min)(rows.size(), max_bins);
  activity.deviations.assign(asked.size(), std::vector<float>(recording.table.taxels(), 0.0F));
  for (std::size_t f = 0; f < noise.size(); ++f) {
    const FingerPlace& place = recording.sensor.fingers[f];
    for (int i = 0; i < place.rows; ++i) {
      for (int j = 0; j < place.cols; ++j) {
        const double& deviation =
            noise[f]
                .deviations[static_cast<std::size_t>(i) * std::size_t(place.cols) + std::size_t(j)];
        fingerpad::TaxelFeatures<> alone(1, 1, recording.sensor.taxels, std::span(&deviation, 1));
        const std::size_t taxel =
            static_cast<std::size_t>(place.first_row + i) * std::size_t(recording.table.cols) +
            static_cast<std::size_t>(place.first_col + j);
        TaxelTrack track{f, i, j, 0, std::vector<float>(activity.bins, 0.0F)};
        for (std::size_t k = 0; k < rows.size(); ++k) {
          const auto sample = static_cast<std::size_t>(rows[k].sample);
          const double& reading =
              recording.table.readings[sample * recording.table.taxels() + taxel];
          const auto seen = alone(fingerpad::StridedView<const double>(&reading, 1, 1, 1),
                                  recording.table.times_s[sample]);
          if (seen.status != fingerpad::TaxelStatus::vibrating) {
            continue;
          }
          ++track.samples;
          float& bin = track.frequency_hz[k * activity.bins / rows.size()];
          bin = (std::max)(bin, static_cast<float>(seen.frequency_hz));
          for (std::size_t a = 0; a < asked.size(); ++a) {
            if (asked[a] == k) {
              activity.deviations[a][taxel] = static_cast<float>(seen.deviation);
            }
          }
        }
        if (track.samples > 0) {
          activity.tracks.push_back(std::move(track));
        }
      }
    }
  }
  return activity;
}

}  // namespace replay
