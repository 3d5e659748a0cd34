// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// replay: turns a recording on disk into tables, maps and pictures. See --help.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <map>
#include <string>

#include "replay/check/check.hpp"
#include "replay/io/images.hpp"
#include "replay/live/live.hpp"
#include "replay/replay.hpp"

namespace {

const char* const about =
    "Depth, contact, the motion of the object, the stick ratio and the force from a recording\n"
    "of a fluid-filled pad, or pre-slip from one of a foam array.\n"
    "RECORDING is a folder with sensor.json, reference.png, reference_depth.tiff and frames/,\n"
    "and perhaps free/ (frames of the free pad) and dots.csv;\n"
    "force and moment need signals.csv with pressures, side_dots.csv and \"rim\" in sensor.json,\n"
    "the load on each dot also stress_free_dots.csv; forces by look-up need \"force\" in\n"
    "sensor.json, and are compared with forces.csv where there is one;\n"
    "DIR receives frames.csv, dots.csv and pictures/, and depth/ and contact/ with --raw.\n"
    "A recording of any other pad with a grid of dots needs a sensor.json of {} and frames/ or a\n"
    "video, and perhaps free/: contact is where a frame differs from the free pad (the first\n"
    "frames where nothing else shows it), and slip is where it slides past the dots: slide.csv\n"
    "and pictures/slide.png. The stick ratio counts each dot that is found as in contact.\n"
    "A recording of a foam array is taxels.csv, and perhaps a sensor.json with a section "
    "\"foam\":\n"
    "it gives frames.csv, with the vibration of each finger and pre-slip, and pictures/.\n"
    "An earlier run's DIR is replaced when the new one is complete; nothing is left behind when\n"
    "something fails.\n"
    "--check computes and writes nothing: it says what is wrong with the recording.\n"
    "--camera and --video show a pad as it is touched: of RECORDING they need sensor.json,\n"
    "reference.png and reference_depth.tiff. q or Esc ends it.";

void add_live_options(CLI::App& app, replay::LiveOptions& live) {
  const auto camera = app.add_option("--camera", live.camera, "show live what camera N sees")
                          ->check(CLI::NonNegativeNumber)
                          ->option_text("N");
  const auto video = app.add_option("--video", live.video, "a recorded video in place of a camera")
                         ->option_text("FILE");
  camera->excludes(video);
  const auto headless =
      app.add_flag("--headless", live.headless, "write the live pictures to DIR, without a window");
  for (const char* other : {"--check", "--raw", "--no-pictures"}) {
    camera->excludes(app.get_option(other));
    video->excludes(app.get_option(other));
    headless->excludes(app.get_option(other));
  }
}

void add_options(CLI::App& app, replay::Options& options, std::string& frames, bool& checks) {
  static const std::map<std::string, replay::Smoothing> policies = {
      {"none", replay::Smoothing::none},
      {"box", replay::Smoothing::box},
      {"anchored", replay::Smoothing::anchored}};
  app.add_option("RECORDING", options.recording, "the recording's folder")->required();
  const auto check = app.add_flag("--check", checks,
                                  "say what is wrong with the recording: a line each, with the "
                                  "remedy; exit status 1 if there is anything");
  const auto out = app.add_option("--out", options.out, "the folder to write")->option_text("DIR");
  check->excludes(out);
  app.add_flag(
      "--raw", options.raw,
      "also write depth/NNNNNN.tiff (32-bit float, mm, NaN: invalid) and contact/NNNNNN.png "
      "(255 in contact, else 0)");
  app.add_option_function<std::string>(
         "--smoothing", [&](const std::string& name) { options.smoothing = policies.at(name); },
         "none, box or anchored (default; none without smoothing_px)")
      ->check(CLI::IsMember({"none", "box", "anchored"}))
      ->option_text("POLICY");
  app.add_option("--frames", frames, "only frames A to B-1, counted from 0; A or B may be left out")
      ->option_text("A:B");
  app.add_flag_callback(
      "--no-pictures", [&] { options.pictures = false; }, "write no pictures");
  app.footer("Exit status: 0 done, 1 something in the files, 2 wrong arguments.");
}

}  // namespace

int main(int argc, char** argv) {
  replay::limit_image_size(argv);
  CLI::App app(about);
  replay::Options options;
  std::string frames;
  bool checks = false;
  replay::LiveOptions live;
  add_options(app, options, frames, checks);
  add_live_options(app, live);
  try {
    app.parse(argc, argv);
    const bool in_window = live.asked_for() && !live.headless;
    if (live.headless && !live.asked_for()) {
      throw CLI::RequiresError("--headless", "--camera or --video");
    }
    if (in_window && !options.out.empty()) {
      throw CLI::RequiresError("--out", "--headless, with --camera or --video");
    }
    if (!in_window && !checks && options.out.empty()) {
      throw CLI::RequiredError("--out or --check");
    }
    if (!frames.empty()) {
      options.range = replay::parse_range(frames);
    }
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "--frames: %s\nRun with --help for more information.\n", error.what());
    return 2;
  }
  try {
    return checks             ? replay::print_check(options.recording)
           : live.asked_for() ? replay::run_live(options, live)
                              : replay::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "replay: %s\n", error.what());
    return 1;
  }
}
