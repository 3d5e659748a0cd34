// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// calibrate: makes the sensor.json that replay reads from recordings. See --help.
#include <CLI/CLI.hpp>
#include <exception>
#include <functional>
#include <string>

#include "calibrate/calibrations.hpp"
#include "common/failure.hpp"
#include "common/images.hpp"
#include "fingerpad/core/check.hpp"

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
  sub->add_option("RECORDING", common.recording, "folder of the recording")->required();
  sub->add_option("--into", common.into,
                  "sensor.json to read and update; default: the one in the recording")
      ->option_text("FILE");
  sub->add_option("--plots", common.plots, "write tables for plot.py to this folder")
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
  if (!common.recording.empty()) {  // a plan has none
    save(outcome, common.sensor());
  }
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
  calibrate::PadSize size;
  int max_radius_px = 50;
  double pressure_mpa = 0;
  calibrate::RimNoise rim;
  double weight_n = 0;
  calibrate::Plan plan;
  Path contacts, gauge, practice, finger, today;
};

void add_geometry(CLI::App& app, Common& common, Arguments& given, std::function<Outcome()>& work) {
  auto* sub = add(
      app, common, "camera",
      "pitch, center and distance of the camera, from plate/ and plate_raised/",
      [&] { return calibrate::camera(common.recording, given.plate); }, work);
  sub->add_option("--rows", given.plate.rows, "rows of dots on the target, odd")->required();
  sub->add_option("--cols", given.plate.cols, "columns of dots on the target, odd")->required();
  sub->add_option("--pitch-mm", given.plate.pitch_mm,
                  "distance between neighbouring dots of the target")
      ->required()
      ->check(CLI::PositiveNumber);
  sub->add_option("--raised-mm", given.plate.raised_mm,
                  "height by which the target was raised for plate_raised/");
  sub->add_option(
         "--plate-distance-mm", given.plate.plate_distance_mm,
         "distance from the camera to the inner face of the plate, if there is no plate_raised/")
      ->check(CLI::PositiveNumber);
  sub->add_option("--index", given.plate.refractive_index,
                  "refractive index of the fluid, 1.33 for water");
  sub->add_flag("--srgb", given.plate.is_srgb,
                "the camera writes light by the curve of sRGB, as webcams do");
  sub->add_option("--mosaic", given.plate.mosaic,
                  "colours of the first four pixels of raw pictures")
      ->check(CLI::IsMember({"rggb", "bggr", "grbg", "gbrg"}));

  sub = add(
      app, common, "shape",
      "depth of the free pad, fitted to touches of a ball, or a cap of given size",
      [&] { return calibrate::shape(common.recording, common.sensor(), given.size); }, work);
  sub->add_option("--base-radius-mm", given.size.base_radius_mm, "radius of the pad on the plate");
  sub->add_option("--apex-mm", given.size.apex_height_mm, "height of the free pad");
  sub->add_option("--ball-radius-mm", given.size.ball_radius_mm,
                  "radius of the ball of touches.csv");
  sub->add_option("--stress-free-height-mm", given.size.stress_free_height_mm,
                  "height of the rubber's apex before it is inflated, if known");
  sub->add_flag("--no-rubber", given.size.no_rubber,
                "the pad is no inflated rubber: a cap with three terms, touched beyond the rim");
}

void add_light(CLI::App& app, Common& common, Arguments& given, std::function<Outcome()>& work) {
  add(
      app, common, "absorption",
      "absorption of the fluid, from the free pad and frames of known depth",
      [&] { return calibrate::absorption(common.recording, common.sensor()); }, work);
  auto* sub = add(
      app, common, "neighbour-light", "light from neighbouring membrane, from the same recording",
      [&] {
        return calibrate::neighbour_light(common.recording, common.sensor(), given.max_radius_px);
      },
      work);
  sub->add_option("--max-radius-px", given.max_radius_px, "largest radius that is searched");
  sub = add(
      app, common, "contact", "threshold of contact, from free/, and the smallest press it finds",
      [&] { return calibrate::contact(common.recording, common.sensor(), given.pressure_mpa); },
      work);
  sub->add_option("--pressure-mpa", given.pressure_mpa, "pressure of the free pad");
}

void add_dots(CLI::App& app, Common& common, std::function<Outcome()>& work) {
  add(
      app, common, "dots", "noise of the dots and thresholds of slip, from free/",
      [&] { return calibrate::dots(common.recording, common.sensor()); }, work);
}

void add_forces(CLI::App& app, Common& common, Arguments& given, std::function<Outcome()>& work) {
  auto* sub = add(
      app, common, "rim",
      "the membrane's modulus and stress-free height, from apex.csv, or the modulus from a weight",
      [&] {
        return given.weight_n > 0 ? calibrate::rim_by_weight(common.recording, common.sensor(),
                                                             given.rim, given.weight_n)
                                  : calibrate::rim(common.recording, given.rim);
      },
      work);
  sub->add_option("--base-radius-mm", given.rim.base_radius_mm, "base radius of the pad")
      ->required()
      ->check(CLI::PositiveNumber);
  sub->add_option("--stress-free-height-mm", given.rim.stress_free_height_mm,
                  "apex height of the pad without stress, as its mould says")
      ->required()
      ->check(CLI::PositiveNumber);
  sub->add_option("--height-sd-mm", given.rim.height_sd_mm, "standard deviation of that height");
  sub->add_option("--apex-noise-mm", given.rim.apex_noise_mm,
                  "noise of an apex height in apex.csv");
  sub->add_option("--pressure-noise-share", given.rim.pressure_noise_share,
                  "noise of a pressure, as a share of it");
  sub->add_option("--weight-n", given.weight_n,
                  "weight on the pad wherever something touches it, in place of apex.csv")
      ->check(CLI::PositiveNumber);
  sub->add_flag("--rubber", given.rim.finds_rubber, "fit the type of rubber, too");

  sub = add(
      app, common, "force", "force curves, from contacts and a table of the gauge",
      [&] {
        return calibrate::force(common.recording / given.contacts,
                                given.gauge.empty() ? given.gauge : common.recording / given.gauge);
      },
      work);
  sub->add_option("--contacts", given.contacts, "frames.csv of replay, or a table with its columns")
      ->required();
  sub->add_option("--gauge", given.gauge,
                  "table with the columns of forces.csv, if the contacts have no forces");

  add(
      app, common, "taxels", "noise of a foam array at rest, from taxels.csv",
      [&] { return calibrate::taxels(common.recording); }, work);
}

void add_plan(CLI::App& app, Arguments& given, std::function<Outcome()>& work) {
  auto* sub = app.add_subcommand(
      "plan",
      "before one builds: what such a finger will measure of depth and force, and how well");
  auto& p = given.plan;
  const auto must = [&](const char* name, double& to, const char* about) {
    sub->add_option(name, to, about)->required()->check(CLI::PositiveNumber);
  };
  must("--base-radius-mm", p.base_radius_mm, "base radius of the pad");
  must("--stress-free-height-mm", p.stress_free_height_mm, "apex height of the pad's mould");
  must("--thickness-mm", p.thickness_mm, "thickness of the membrane");
  must("--shear-modulus-mpa", p.shear_modulus_mpa, "shear modulus of the rubber");
  must("--pressure-mpa", p.pressure_mpa, "pressure of the free pad");
  sub->add_option("--grid-pitch-mm", p.grid_pitch_mm, "pitch of the printed grid of dots");
  sub->add_option("--side-rows", p.rows_mm, "rows of dots around the rim in place of the grid, mm")
      ->delimiter(',');
  sub->add_option("--dots-in-row", p.dots_in_row, "dots in each row");
  sub->add_option("--dot-noise-px", p.dot_noise_px, "noise with which a dot is found");
  sub->add_option("--brightness", p.brightness, "grey levels of the membrane without fluid");
  sub->add_option("--grey-noise", p.grey_noise, "noise of a pixel, grey levels");
  sub->add_option("--picture-rows", p.picture_rows, "height of the picture, which the pad fills");
  sub->add_option("--window-px", p.window_px, "window over which depth is smoothed");
  sub->callback([&given, &work] { work = [&given] { return calibrate::plan(given.plan); }; });
}

}  // namespace

int main(int argc, char** argv) {
  replay::limit_image_size(argv);
  CLI::App app(
      "Computes the sensor.json that replay reads from recordings; each sub-command is one\n"
      "calibration. It prints the parameters with standard errors, the residual of the fit, and\n"
      "whether the result is good, doubtful or refused, with the reason. docs/first_hour explains\n"
      "what to record.");
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 good or doubtful, 1 refused in whole or in part, 2 wrong arguments;\n"
      "of today: 0 as calibrated, 1 changed.");
  Common common;
  Arguments given;
  std::function<Outcome()> work;
  add_geometry(app, common, given, work);
  add_light(app, common, given, work);
  add_dots(app, common, work);
  add_forces(app, common, given, work);
  add_plan(app, given, work);
  app.add_subcommand("all",
                     "everything that a folder has pictures of: plate/, plate_raised/, pad/, rim/, "
                     "with about.json; writes its sensor.json")
      ->add_option("FOLDER", given.finger, "folder of one's own finger")
      ->required();
  auto* today = app.add_subcommand(
      "today", "what has changed since the calibration, from pictures with nothing in contact");
  today->add_option("FOLDER", given.finger, "folder with the calibrated sensor.json")->required();
  today->add_option("PICTURES", given.today, "folder of today's pictures")->required();
  app.add_subcommand("practice",
                     "write recordings of a virtual sensor to try the calibrations with")
      ->add_option("DIR", given.practice, "output folder")
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
    if (!given.today.empty()) {
      return calibrate::today(given.finger, given.today) ? 0 : 1;
    }
    return given.finger.empty() ? run(common, work) : calibrate::all(given.finger) ? 0 : 1;
  } catch (const std::exception& error) {
    print(calibrate::Refusal{name, error.what()});
    return 1;
  }
}
