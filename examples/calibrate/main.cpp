// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// calibrate: makes the sensor.json that replay reads from recordings. See --help.
#include <CLI/CLI.hpp>
#include <exception>
#include <functional>
#include <string>

#include "calibrate/calibrations.hpp"
#include "fingerpad/core/expects.hpp"
#include "replay/io/failure.hpp"
#include "replay/io/images.hpp"

namespace {

using calibrate::Outcome;
using calibrate::Path;

struct Common {
  Path recording, into, plots;
  /// The sensor.json that is read and written.
  Path sensor() const { return into.empty() ? recording / "sensor.json" : into; }
};

/// Adds a sub-command on a recording; `work` is called after all arguments are parsed.
CLI::App* add(CLI::App& app,
              Common& common,
              const char* name,
              const char* about,
              std::function<Outcome()> work,
              std::function<Outcome()>& chosen) {
  CLI::App* const sub = app.add_subcommand(name, about);
  sub->add_option("RECORDING", common.recording, "the recording's folder")->required();
  sub->add_option("--into", common.into,
                  "the file that is read and written; without it, "
                  "sensor.json in the recording")
      ->option_text("FILE");
  sub->add_option("--plots", common.plots, "write what plot.py draws to this folder")
      ->option_text("DIR");
  sub->callback([&chosen, work = std::move(work)] { chosen = work; });
  return sub;
}

int run(const Common& common, const std::function<Outcome()>& work) {
  const Outcome outcome = work();
  for (const auto& report : outcome.reports) {
    print(report);
  }
  for (const auto& refusal : outcome.refusals) {
    print(refusal);
  }
  save(outcome, common.sensor());
  for (std::size_t k = 0; !common.plots.empty() && k < outcome.plots.size(); ++k) {
    std::filesystem::create_directories(common.plots);
    if (!outcome.plots[k].points.empty()) {
      write_plot(outcome.plots[k], common.plots / (outcome.reports[k].what + ".csv"));
    }
  }
  return outcome.refusals.empty() ? 0 : 1;
}

/// Arguments of the sub-commands.
struct Arguments {
  calibrate::DotPlate plate;
  calibrate::CapSize size;
  int max_radius_px = 50;
  bool slips = false;
  calibrate::RimNoise rim;
  Path contacts, gauge, practice;
};

void add_geometry(CLI::App& app, Common& common, Arguments& given, std::function<Outcome()>& work) {
  auto* sub = add(
      app, common, "camera", "pitch, center and distance, from plate/ and plate_raised/",
      [&] { return calibrate::camera(common.recording, given.plate); }, work);
  sub->add_option("--rows", given.plate.rows, "rows of the plate's dots, odd")->required();
  sub->add_option("--cols", given.plate.cols, "columns, odd")->required();
  sub->add_option("--pitch-mm", given.plate.pitch_mm, "between its dots")
      ->required()
      ->check(CLI::PositiveNumber);
  sub->add_option("--raised-mm", given.plate.raised_mm, "how far it was raised for plate_raised/");
  sub->add_option("--plate-distance-mm", given.plate.plate_distance_mm,
                  "from the camera to the plate's inner face, where it was not raised")
      ->check(CLI::PositiveNumber);
  sub->add_option("--index", given.plate.refractive_index, "of the fluid, 1.33 for water");

  sub = add(
      app, common, "shape", "depth of the free pad: a cap, as given or as touched by a ball",
      [&] { return calibrate::shape(common.recording, common.sensor(), given.size); }, work);
  sub->add_option("--base-radius-mm", given.size.base_radius_mm, "of the pad on the plate");
  sub->add_option("--apex-mm", given.size.apex_height_mm, "height of the free pad");
  sub->add_option("--ball-radius-mm", given.size.ball_radius_mm, "of the ball of touches.csv");
}

void add_light(CLI::App& app, Common& common, Arguments& given, std::function<Outcome()>& work) {
  add(
      app, common, "absorption", "the fluid, from the free pad and frames of known depth",
      [&] { return calibrate::absorption(common.recording, common.sensor()); }, work);
  auto* sub = add(
      app, common, "neighbour-light", "light from neighbouring membrane, from the same",
      [&] {
        return calibrate::neighbour_light(common.recording, common.sensor(), given.max_radius_px);
      },
      work);
  sub->add_option("--max-radius-px", given.max_radius_px, "radii are searched up to here");
  add(
      app, common, "contact", "threshold of contact, from free/",
      [&] { return calibrate::contact(common.recording, common.sensor()); }, work);
}

void add_dots(CLI::App& app, Common& common, Arguments& given, std::function<Outcome()>& work) {
  auto* sub = add(
      app, common, "dots", "noise of the dots and thresholds of slip, from free/",
      [&] { return calibrate::dots(common.recording, given.slips); }, work);
  sub->add_flag("--slips", given.slips,
                "also choose reference_px by frames/, which stick and then slip");
}

void add_forces(CLI::App& app, Common& common, Arguments& given, std::function<Outcome()>& work) {
  auto* sub = add(
      app, common, "rim", "length of the side dots and the membrane's modulus",
      [&] { return calibrate::rim(common.recording, given.rim); }, work);
  sub->add_option("--base-radius-mm", given.rim.base_radius_mm, "of the pad")
      ->required()
      ->check(CLI::PositiveNumber);
  sub->add_option("--length-mm", given.rim.length_mm, "of the side dots, where it is known");
  sub->add_option("--inclination-rad", given.rim.inclination_rad, "of the membrane without stress");
  sub->add_option("--dot-noise-mm", given.rim.dot_noise_mm, "of a side dot's coordinate");
  sub->add_option("--pressure-noise-mpa", given.rim.pressure_noise_mpa, "of a frame's pressure");
  sub->add_option("--stress-free-height-mm", given.rim.stress_free_height_mm,
                  "of the pad's apex without stress: finds the rubber, too, from apex.csv");
  sub->add_option("--apex-noise-mm", given.rim.apex_noise_mm, "of an apex in apex.csv");

  sub = add(
      app, common, "force", "force curves, from contacts and a gauge's table",
      [&] {
        return calibrate::force(common.recording / given.contacts,
                                given.gauge.empty() ? given.gauge : common.recording / given.gauge);
      },
      work);
  sub->add_option("--contacts", given.contacts, "frames.csv of replay, or a table with its columns")
      ->required();
  sub->add_option("--gauge", given.gauge,
                  "table with the columns of forces.csv, where contacts has none");

  add(
      app, common, "taxels", "noise of a foam array at rest, from taxels.csv",
      [&] { return calibrate::taxels(common.recording); }, work);
}

}  // namespace

int main(int argc, char** argv) {
  replay::limit_image_size(argv);
  CLI::App app(
      "Turns recordings into the sensor.json that replay reads, one sub-command a calibration.\n"
      "Each prints its parameters with standard errors, what the fit leaves, and whether it is\n"
      "good, doubtful or refused, because of what. docs/first_hour tells what to record.");
  app.require_subcommand(1);
  app.footer("Exit status: 0 good or doubtful, 1 refused in whole or in part, 2 wrong arguments.");
  Common common;
  Arguments given;
  std::function<Outcome()> work;
  add_geometry(app, common, given, work);
  add_light(app, common, given, work);
  add_dots(app, common, given, work);
  add_forces(app, common, given, work);
  app.add_subcommand("practice", "write recordings of a virtual sensor, to try all this on")
      ->add_option("DIR", given.practice, "the folder to write")
      ->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const std::string name = app.get_subcommands().front()->get_name();
  try {
    if (!given.practice.empty()) {
      calibrate::write_practice(given.practice);
      return 0;
    }
    return run(common, work);
  } catch (const std::exception& error) {
    print(calibrate::Refusal{name, error.what()});
    return 1;
  }
}
