// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/check/check.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "common/failure.hpp"
#include "replay/chain.hpp"
#include "replay/check/parts.hpp"
#include "replay/gel/free_pad.hpp"
#include "replay/steps/fingertip_options.hpp"

namespace replay {
namespace {

/// Adds notes on results for which the recording has no data.
void note_missing(const Recording& recording, Findings& findings) {
  const auto note = [&](const std::string& place, const std::string& what, const char* remedy) {
    findings.push_back({place, what, remedy, false});
  };
  if (recording.sensor.dots_only) {
    if (!recording.sensor.stick.covers_pattern) {
      note(
          "sensor.json, stick.covers_pattern",
          "every dot counts as in contact, so there is no stick ratio once some dots do not follow "
          "the object",
          "Set it to true if the object is larger than the dot pattern.");
    }
    return;
  }
  if (const std::string lacking = lacking_for_wrench(recording);
      !lacking.empty() && fault_of_pressure(recording).empty()) {
    note("six-axis force", lacking, "Add it if you need this force.");
  }
  if (!recording.sensor.force) {
    note("forces by look-up", "sensor.json has no section force",
         "Calibrate with known loads if you need these forces.");
  }
  if (recording.free_frames.size() == 0) {
    note("free", "there are no frames of the free pad",
         "Record at least twenty: the threshold of contact is computed from their noise.");
  }
}

/// What replay refuses when nothing else has been found, and what it doubts in the first frame.
void check_first_frame(const std::filesystem::path& folder,
                       Recording& recording,
                       Findings& findings) {
  Options options;
  options.recording = folder;
  Chain chain(recording, options);
  DamagedFrames damaged;
  recording.frames.seek(0);
  const cv::Mat first = next_whole_frame(recording.frames, recording.reference.size(), damaged);
  const auto is_wrong = [](const Finding& finding) { return finding.is_wrong; };
  if (!first.empty() && std::none_of(findings.begin(), findings.end(), is_wrong)) {
    const auto touch = chain(0, first).touch;
    if (touch.depth.ok() && touch.light_in_doubt()) {
      findings.push_back(
          {"frames, first frame",
           "its light is not that of the reference, by which depth errs by " +
               short_number(touch.depth_light_sd_mm) + " mm",
           "Record the reference again in this light, or find what has changed it."});
    }
  }
}

void check_camera_recording(const std::filesystem::path& folder,
                            const std::filesystem::path& sensor,
                            Findings& findings) {
  Recording recording = open_recording(folder, sensor);
  if (!recording.signals.times_s.empty()) {
    std::vector<double> times_s;
    for (int frame = 0; frame < recording.frames.size(); ++frame) {
      const std::string text = recording.signals.time_s(frame);
      times_s.push_back(text.empty() ? std::numeric_limits<double>::quiet_NaN()
                                     : std::strtod(text.c_str(), nullptr));
    }
    check_clock("signals.csv, time_s", "frame", times_s, findings);
  }
  if (!recording.sensor.dots_only) {
    check_numbers(recording, findings);
    check_reference(recording, findings);
  }
  check_light(recording, findings);
  check_dots(folder, recording, findings);
  if (recording.sensor.dots_only) {
    const FreePad pad = free_pad_of(recording, DotSource::of_dots_only(folder, recording));
    findings.insert(findings.end(), pad.told.begin(), pad.told.end());
  }
  check_gauge(folder, recording, findings);
  note_missing(recording, findings);
  if (!recording.sensor.dots_only) {
    check_first_frame(folder, recording, findings);
  }
}

}  // namespace

Findings check_recording(const std::filesystem::path& folder, const std::filesystem::path& sensor) {
  Findings findings;
  try {
    if (is_foam_recording(folder)) {
      check_foam(open_foam_recording(folder), findings);
    } else {
      check_camera_recording(folder, sensor, findings);
    }
  } catch (const Failure& failure) {
    findings.push_back(
        {failure.what(), "the check stops here", "Correct this error and check again."});
  }
  return findings;
}

int print_check(const std::filesystem::path& folder, const std::filesystem::path& sensor) {
  int wrong = 0;
  for (const Finding& finding : check_recording(folder, sensor)) {
    std::printf("%s%s: %s. %s\n", finding.is_wrong ? "" : "(optional) ", finding.place.c_str(),
                finding.what.c_str(), finding.remedy.c_str());
    wrong += finding.is_wrong ? 1 : 0;
  }
  if (wrong == 0) {
    std::printf("no problems found\n");
  } else {
    std::printf("%d problem%s found\n", wrong, wrong == 1 ? "" : "s");
  }
  return wrong == 0 ? 0 : 1;
}

}  // namespace replay
