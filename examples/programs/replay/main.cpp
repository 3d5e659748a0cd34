// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// replay: turns a recording on disk into tables, maps and pictures. See --help.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <map>
#include <string>

#include "common/images.hpp"
#include "replay/check/check.hpp"
#include "replay/live/live.hpp"
#include "replay/replay.hpp"

namespace {

const char* const about =
    "Computes depth, contact, motion of the object, stick ratio and force from a recording of a\n"
    "fluid-filled pad, or pre-slip from a recording of a foam array.\n"
    "\n"
    "Fluid-filled pad: RECORDING is a folder with sensor.json, reference.png,\n"
    "reference_depth.tiff and frames/. free/ (frames of the free pad) and dots.csv are optional.\n"
    "Six-axis force and moment need signals.csv with pressures, printed dots and \"rim\" in\n"
    "sensor.json; the load on each dot needs stress_free_dots.csv. Forces by look-up need "
    "\"force\"\n"
    "in sensor.json; they are compared with forces.csv if it exists.\n"
    "The results are frames.csv, dots.csv and pictures/, with --raw also depth/ and contact/.\n"
    "\n"
    "Any other pad with a grid of dots: sensor.json may be {}; frames/ or a video is needed and\n"
    "free/ is optional. Contact is where a frame differs from the free pad, which is taken from\n"
    "free/, else from the reference in sensor.json, else from the first frames. Slip is a contact\n"
    "that slides past the dots. These are the last columns of frames.csv, and\n"
    "pictures/slide_*.png. For the stick ratio each detected dot counts as in contact.\n"
    "\n"
    "Foam array: taxels.csv, and optionally sensor.json with a section \"foam\". The results are\n"
    "frames.csv, with the vibration of each finger and pre-slip.\n"
    "\n"
    "plot.py draws charts of all of these: python3 examples/programs/plot.py DIR\n"
    "\n"
    "An earlier run's DIR is replaced when the new one is complete. A run that fails leaves\n"
    "nothing behind.\n"
    "--check writes nothing; it lists the problems of the recording.\n"
    "--camera and --video show results live while the pad is touched; they need sensor.json,\n"
    "reference.png and reference_depth.tiff in RECORDING. Press q or Esc to quit, r to begin and "
    "to\n"
    "end a recording under DIR of --record.";

void add_live_options(CLI::App& app, replay::LiveOptions& live) {
  const auto camera = app.add_option("--camera", live.camera, "show the results for camera N live")
                          ->check(CLI::NonNegativeNumber)
                          ->option_text("N");
  const auto video =
      app.add_option("--video", live.video, "play a recorded video instead of a camera")
          ->option_text("FILE");
  camera->excludes(video);
  const auto headless =
      app.add_flag("--headless", live.headless, "write the live pictures to DIR, without a window");
  const auto record =
      app.add_option("--record", live.record,
                     "where the key r writes recordings: DIR/001, DIR/002, ...; replay reads them "
                     "with --sensor RECORDING/sensor.json. With --headless: all frames")
          ->option_text("DIR");
  for (const char* other : {"--check", "--raw", "--no-pictures"}) {
    record->excludes(app.get_option(other));
    camera->excludes(app.get_option(other));
    video->excludes(app.get_option(other));
    headless->excludes(app.get_option(other));
  }
}

void add_options(CLI::App& app, replay::Options& options, std::string& frames, bool& checks) {
  app.add_option("RECORDING", options.recording, "folder of the recording")->required();
  app.add_option("--sensor", options.sensor,
                 "sensor.json to read, with the reference beside it; default: the one in RECORDING")
      ->option_text("FILE");
  const auto check = app.add_flag("--check", checks,
                                  "list the problems of the recording, one per line with the "
                                  "remedy; exit status 1 if there are any");
  const auto out = app.add_option("--out", options.out, "output folder")->option_text("DIR");
  check->excludes(out);
  app.add_flag(
      "--raw", options.raw,
      "also write depth/NNNNNN.tiff (32-bit float, mm, NaN where invalid) and contact/NNNNNN.png "
      "(255 in contact, else 0)");
  app.add_option("--smoothing", options.smoothing_px,
                 "width of the smoothing window, odd, 3 to 109 times the width of a sample, or 1: "
                 "none; default: smoothing_px of sensor.json, else 1")
      ->option_text("PX");
  app.add_option("--frames", frames,
                 "process frames A to B-1 only, counted from 0; A or B may be omitted")
      ->option_text("A:B");
  app.add_flag_callback(
      "--no-pictures", [&] { options.pictures = false; }, "do not write pictures");
  app.footer("Exit status: 0 success, 1 error in the files, 2 wrong arguments.");
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
    if (!live.record.empty() && !live.asked_for()) {
      throw CLI::RequiresError("--record", "--camera or --video");
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
    return checks             ? replay::print_check(options.recording, options.sensor)
           : live.asked_for() ? replay::run_live(options, live)
                              : replay::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "replay: %s\n", error.what());
    return 1;
  }
}
