// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// slip_trials: evaluates how well the imprint and the stick ratio separate recordings with slip
// from recordings without, compared with the simplest measure. See --help.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <string>
#include <vector>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "events.hpp"
#include "measures.hpp"
#include "trials.hpp"

namespace {

using slip_trials::Measures;
using slip_trials::Trial;
using slip_trials::View;

/// One trial with the mean over its views.
struct Scored {
  const Trial* trial;
  Measures whole;
  Measures early;
};

/// Area under the ROC curve of the scores. Negative without a pair of a slip and a hold.
double roc_area(const std::vector<Scored>& trials, double (*score)(const Scored&)) {
  std::vector<slip_trials::Event> events;
  for (const Scored& one : trials) {
    events.push_back({one.trial->object, one.trial->slips, {score(one)}, 1});
  }
  const double area = slip_trials::roc_area(events);
  return std::isnan(area) ? -1 : area;
}

void print_roc_area(const char* name,
                    const std::vector<Scored>& trials,
                    double (*whole)(const Scored&),
                    double (*early)(const Scored&)) {
  std::printf("%-34s %8.3f %12.3f\n", name, roc_area(trials, whole), roc_area(trials, early));
}

void print_trial(const Scored& scored, const std::vector<View>& views) {
  const Trial& trial = *scored.trial;
  const auto& all = scored.whole;
  std::printf("%-5s %-24s %6d %5zu  %5.2f %5.2f %5.2f  %5.2f  %5.3f %5.3f  |",
              trial.slips ? "slip" : "hold", trial.name.c_str(), views.front().size(), all.answers,
              all.ratio, all.lowest, all.ratio_by_noise, scored.early.ratio, all.moved_share,
              scored.early.moved_share);
  for (const std::string& tenth : tenths_of(views)) {
    std::printf(" %s", tenth.c_str());
  }
  std::printf("\n");
}

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
  print(
      "recoil of the dots", [](const View& v) { return v.slide.recoil; }, none);
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
  constexpr int all_frames = std::numeric_limits<int>::max();
  const std::vector<Trial> trials = slip_trials::trials_of(folder);
  std::vector<std::vector<View>> views;
  int shortest = 0;
  for (const Trial& trial : trials) {
    views.emplace_back();
    for (const auto& file : trial.views) {
      View view = slip_trials::look_at(file, slip_trials::free_frames_for(trial, trials));
      if (view.size() == 0) {
        std::printf("skipped: %s: %s\n", file.c_str(), view.fault.c_str());
        continue;
      }
      shortest = shortest == 0 ? view.size() : (std::min)(shortest, view.size());
      views.back().push_back(std::move(view));
    }
  }
  std::printf(
      "label trial                    frames  new  ratio lowest noise  early  moved early  | ratio "
      "by tenths\n");
  std::vector<Scored> scored;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    if (!views[k].empty()) {
      scored.push_back({&trials[k], slip_trials::mean_over(views[k], all_frames),
                        slip_trials::mean_over(views[k], shortest)});
      print_trial(scored.back(), views[k]);
    }
  }
  const auto slips = std::count_if(scored.begin(), scored.end(),
                                   [](const Scored& one) { return one.trial->slips; });
  std::printf("\n%td slip, %td hold. Area under the ROC curve    whole     first %d frames\n",
              slips, static_cast<std::ptrdiff_t>(scored.size()) - slips, shortest);
  print_roc_area(
      "stick ratio, low", scored, [](const Scored& s) { return -s.whole.ratio; },
      [](const Scored& s) { return -s.early.ratio; });
  print_roc_area(
      "stick ratio, threshold from noise", scored,
      [](const Scored& s) { return -s.whole.ratio_by_noise; },
      [](const Scored& s) { return -s.early.ratio_by_noise; });
  print_roc_area(
      "share of dots > 2 px off, high", scored, [](const Scored& s) { return s.whole.moved_share; },
      [](const Scored& s) { return s.early.moved_share; });
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
      "Columns of the first table:\n"
      "  frames  number of frames of the first view\n"
      "  new     number of new values of the stick ratio\n"
      "  ratio   mean of the new values; 1 if there are none, because no slip was seen\n"
      "  lowest  smallest of the new values\n"
      "  noise   as ratio, with slip_px from the noise of the first five frames if that is above\n"
      "          the default\n"
      "  moved   mean share of dots more than 2 px off the median motion since the first frame\n"
      "  early   the value before it, for the first frames only: as many as the shortest "
      "recording\n"
      "          has\n"
      "No measure depends on the length of a recording.\n"
      "\n"
      "Columns of the tables of slip events, for each object and for all:\n"
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
