// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// slip_trials: evaluates how well the imprint and the stick ratio separate recordings with slip
// from recordings without. See --help.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "events.hpp"
#include "measures.hpp"
#include "trials.hpp"

namespace {

using slip_trials::Trial;
using slip_trials::View;

/// Prints slip as events for the first view of each trial, where the contact is known.
void print_events_of(const std::vector<Trial>& trials,
                     const std::vector<std::vector<View>>& views) {
  const auto events = [&](const auto& measure_of) {
    std::vector<slip_trials::Event> found;
    for (std::size_t k = 0; k < trials.size(); ++k) {
      if (!views[k].empty() && !views[k].front().slide.evidence.empty()) {
        const View& view = views[k].front();
        found.push_back({trials[k].object, trials[k].slips, measure_of(view), view.slide.end});
      }
    }
    return found;
  };
  const auto print = [&](const char* name, const auto& measure_of, double own) {
    const auto found = events(measure_of);
    if (!found.empty()) {
      slip_trials::print_events(name, found, own);
    }
  };
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  print(
      "imprint past dots, or area lost", [](const View& v) { return v.slide.evidence; }, 1);
  print(
      "imprint past dots", [](const View& v) { return v.slide.slide; }, none);
  print(
      "area lost", [](const View& v) { return v.slide.lost; }, none);
  const auto slipping = [](const View& view) {
    std::vector<double> share;
    for (const double ratio : view.ratio) {
      share.push_back(1 - ratio);
    }
    return share;
  };
  print("stick ratio, lowest", slipping, none);
}

int run(const std::string& folder) {
  const std::vector<Trial> trials = slip_trials::trials_of(folder);
  std::vector<std::vector<View>> views;
  for (const Trial& trial : trials) {
    views.emplace_back();
    for (const auto& file : trial.views) {
      View view = slip_trials::look_at(file, slip_trials::free_frames_for(trial, trials));
      if (view.size() == 0) {
        std::printf("skipped: %s: %s\n", file.c_str(), view.fault.c_str());
        continue;
      }
      std::printf("%-5s %-24s %d frames\n", trial.slips ? "slip" : "hold", trial.name.c_str(),
                  view.size());
      views.back().push_back(std::move(view));
    }
  }
  print_events_of(trials, views);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  replay::limit_image_size(argv);
  CLI::App app(
      "Evaluates slip detection on labelled recordings of pads with dots.\n"
      "\n"
      "FOLDER has one of three forms:\n"
      "- labels.dat (lines: height LABEL 0|1 start end event trial) and, for each trial, a folder\n"
      "  of frames whose name begins with the name of the trial;\n"
      "- the same for several objects: OBJECT_result.dat and a folder OBJECT for each;\n"
      "- folders LABEL/, in which each folder with videos or frames is a trial; several videos of\n"
      "  a trial are views of it.\n"
      "LABEL is fail or slip, or ok, success, hold or wiggle. Other labels are refused.\n"
      "The free pad is taken from the frames in FOLDER/free, else from the last frames of "
      "slipping\n"
      "trials (of other objects if possible) where they agree.\n"
      "Dots are found as in replay; each found dot counts as in contact.\n"
      "\n"
      "Columns, for each object and for all:\n"
      "  AUC        area under the ROC curve of the largest value of each trial; - if an object\n"
      "             only slips or only holds\n"
      "  warned     slips above the threshold before the contact is lost (less than a tenth of\n"
      "             its largest area is left)\n"
      "  lead       median number of frames from the warning to the loss\n"
      "  false      holds above the threshold\n"
      "  threshold  95 % of the holds of the other objects are below it");
  std::string folder;
  app.add_option("FOLDER", folder, "folder of the labelled recordings")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return run(folder);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slip_trials: %s\n", error.what());
    return 1;
  }
}
