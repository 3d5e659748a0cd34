// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/replay.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "common/failure.hpp"
#include "common/interrupt.hpp"
#include "common/output.hpp"
#include "common/progress.hpp"
#include "fingerpad/core/check.hpp"
#include "replay/foam/step.hpp"
#include "replay/foam/table.hpp"

namespace replay {
namespace {

using fingerpad::TaxelStatus;

FoamStep make_step(const Options& options,
                   const FoamRecording& recording,
                   const std::vector<FoamNoise>& noise) {
  try {
    return FoamStep(recording, noise);
  } catch (const fingerpad::parameter_error& error) {
    fail(options.recording, error.what());
  }
}

std::string alarm_words(const FoamRow& row) {
  const std::string when = row.time_s.empty() ? "" : ", t = " + row.time_s + " s";
  return "frame " + std::to_string(row.frame) + when + ": " + row.alarm.names();
}

void print_fingers(const FoamRecording& recording, const std::vector<FoamNoise>& noise) {
  for (std::size_t f = 0; f < noise.size(); ++f) {
    const FingerPlace& place = recording.sensor.fingers[f];
    double least = 0;
    double most = 0;
    int dead = 0;
    for (const double deviation : noise[f].deviations) {
      if (std::isfinite(deviation)) {
        least = most > 0 ? (std::min)(least, deviation) : deviation;
        most = (std::max)(most, deviation);
      } else {
        ++dead;
      }
    }
    std::printf("%s %d x %d taxels, noise %.3g to %.3g (%s)%s\n",
                f == 0 ? "fingers     " : "            ", place.rows, place.cols, least, most,
                noise[f].source.c_str(),
                dead > 0 ? (", " + std::to_string(dead) + " dead").c_str() : "");
  }
}

/// "from 0.5 s to 3.2 s, from 4.1 s on": when a finger is pressed.
std::string touches_of(const std::vector<FoamRow>& rows, std::size_t finger) {
  std::string touches;
  bool is_pressed = false;
  int count = 0;
  for (const FoamRow& row : rows) {
    if (!row.was_taken() || row.fingers[finger].is_pressed() == is_pressed) {
      continue;
    }
    is_pressed = !is_pressed;
    count += is_pressed ? 1 : 0;
    if (count > 3) {
      return touches + ", ...";
    }
    touches += is_pressed ? (count > 1 ? ", from " : "from ") : " to ";
    touches += row.time_s + " s";
  }
  return touches.empty() ? "never" : touches + (is_pressed ? " on" : "");
}

void print_summary(const FoamRecording& recording,
                   const std::vector<FoamNoise>& noise,
                   const std::vector<FoamRow>& rows,
                   const FoamStep& step,
                   const std::filesystem::path& place) {
  const auto count = [&](const auto& is) { return std::count_if(rows.begin(), rows.end(), is); };
  std::printf("samples      %zu, every %.4g ms (median)\n", rows.size(),
              1000 * recording.sensor.taxels.sample_period_s);
  print_fingers(recording, noise);
  if (recording.table.missing > 0) {
    std::printf("missing      %lld readings in the whole recording\n", recording.table.missing);
  }
  for (const Finding& finding : recording.told) {
    std::printf("%-12s %s: %s\n", finding.is_wrong ? "left out" : "note", finding.place.c_str(),
                finding.what.c_str());
  }
  const auto not_taken = count([](const FoamRow& row) { return !row.was_taken(); });
  if (not_taken > 0) {
    std::printf("left out     %td samples: the time is missing or not later than before\n",
                not_taken);
  }
  for (std::size_t f = 0; f < noise.size(); ++f) {
    const std::string which = noise.size() > 1 ? "finger " + std::to_string(f) + " " : "";
    std::printf("%s %s%s\n", f == 0 ? "pressed     " : "            ", which.c_str(),
                touches_of(rows, f).c_str());
  }
  if (recording.sensor.newton_per_unit.empty()) {
    std::printf("sum          in the unit of the readings; newtons need foam.newton_per_unit\n");
  }
  std::printf("vibrating    in %td samples\n", count([](const FoamRow& row) {
                return std::any_of(row.fingers.begin(), row.fingers.end(), [](const auto& finger) {
                  return finger.status == TaxelStatus::vibrating;
                });
              }));
  const auto alarm =
      std::find_if(rows.begin(), rows.end(), [](const FoamRow& row) { return row.alarm.any(); });
  std::printf("first alarm  %s\n", alarm != rows.end() ? alarm_words(*alarm).c_str() : "none");
  if (alarm != rows.end()) {
    std::printf("alarms       in %td samples\n",
                count([](const FoamRow& row) { return row.alarm.any(); }));
  }
  std::printf("step         %.2f us per sample (median)\n", step.median_us());
  std::printf("table        %s\n", (place / "frames.csv").c_str());
  std::printf("charts       plot.py %s\n", place.c_str());
}

}  // namespace

int run_foam(const Options& options) {
  const FoamRecording recording = open_foam_recording(options.recording);
  const Range range = within(options.range, recording.table.samples(), options.recording);
  std::vector<FoamNoise> noise;
  for (int f = 0; f < recording.fingers(); ++f) {
    noise.push_back(noise_of(recording, f));
  }
  FoamStep step = make_step(options, recording, noise);
  watch_for_interrupts();
  OutputFolder output(options.out);
  TableWriter<FoamRow> table(output.file("frames.csv"), foam_columns(recording.sensor));
  std::vector<FoamRow> rows;
  const int total = *range.last - range.first;
  {
    const Progress progress(total);
    for (int done = 0; done < total; ++done) {
      progress.show(done);
      if (is_interrupted()) {
        return 130;
      }
      rows.push_back(step(range.first + done));
      table.write(rows.back());
    }
  }
  table.close();
  if (is_interrupted()) {
    return 130;
  }
  output.publish();
  print_summary(recording, noise, rows, step, output.place());
  return 0;
}

}  // namespace replay
