// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/sensor.hpp"

#include <algorithm>
#include <tuple>
#include <vector>

#include "common/failure.hpp"
#include "common/json_section.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

namespace replay {
namespace {

using Section = JsonSection;

constexpr int min_dots = 2;  // rows and columns of a print
constexpr int max_dots = 100;

/// Light of each value of 8 bit, 255 at the last; empty if linear.
std::vector<double> read_response(const Section& section) {
  if (!section.at("response").is_array()) {
    const bool is_srgb = section.one_of("response", {"linear", "srgb"}) == "srgb";
    return is_srgb ? srgb_response() : std::vector<double>{};
  }
  const auto values = section.numbers<256>("response");
  std::vector<double> light(values.begin(), values.end());
  if (section.at("response").size() != 256 || !(light.front() >= 0) || !(light.back() > 0) ||
      !std::is_sorted(light.begin(), light.end())) {
    section.refuse("response must have 256 values that grow, from 0 or more");
  }
  const double most = light.back();
  for (double& value : light) {
    value *= 255 / most;
  }
  return light;
}

void read_camera(const Section& root, Sensor& sensor) {
  const Section section = root.section(
      "camera",
      {{"plate_distance_mm", "distance from the camera's center to the plate's inner face, mm"},
       {"refractive_index", "refractive index of the fluid, 1.33 for water"},
       {"center_px", "[x, y] of the pixel on the optical axis"},
       {"pitch_mm", "size of a pixel on the plate's inner face, mm, or its [width, height]"},
       {"distortion", "radial distortion of the lens, [k1, k2] of OpenCV"},
       {"response", "linear, srgb, or a list of the light of each of the 256 values"},
       {"mosaic", "colours of the first four pixels of raw pictures: rggb, bggr, grbg or gbrg"}});
  fingerpad::Camera<double> camera;
  camera.plate_distance_mm = section.number("plate_distance_mm");
  camera.refractive_index = section.number("refractive_index");
  std::tie(camera.center_x_px, camera.center_y_px) = section.pair("center_px");
  if (section.at("pitch_mm").is_array()) {
    const auto [width, height] = section.pair("pitch_mm");
    camera.pitch_mm = width;
    camera.pixel_aspect = height / width;
  } else {
    camera.pitch_mm = section.number("pitch_mm");
  }
  if (section.has("distortion")) {
    const auto [k1, k2, p1, p2, k3] = section.numbers<5>("distortion");
    if (p1 != 0 || p2 != 0 || k3 != 0) {
      section.refuse("distortion has p1, p2 or k3, which the rays of this program have not");
    }
    camera.distortion_k1 = k1;
    camera.distortion_k2 = k2;
  }
  require(camera);
  sensor.camera = camera;
  if (section.has("response")) {
    sensor.pictures.response = read_response(section);
  }
  if (section.has("mosaic")) {
    sensor.pictures.mosaic = section.one_of("mosaic", {"rggb", "bggr", "grbg", "gbrg"});
  }
}

fingerpad::Absorption<double> read_absorption(const Section& root) {
  const Section section = root.section(
      "absorption", {{"c_red_per_mm", "absorption coefficient of red light in the fluid, 1/mm"},
                     {"c_green_per_mm", "absorption coefficient of green light, 1/mm"},
                     {"kappa", "ratio of light and camera in green to those in red"},
                     {"max_depth_mm", "largest depth that is searched, mm"}});
  fingerpad::Absorption<double> absorption;
  absorption.c_red_per_mm = section.number("c_red_per_mm");
  absorption.c_green_per_mm = section.number("c_green_per_mm");
  absorption.kappa = section.number("kappa");
  absorption.max_depth_mm = section.number("max_depth_mm");
  fingerpad::require(absorption);
  return absorption;
}

fingerpad::PadLight<double> read_light(const Section& root) {
  const Section section = root.section(
      "light", {{"scale_mm", "unit of x and y in the polynomials over the plate, mm"},
                {"kappa", "coefficients of 1, x, y"},
                {"scattering", "coefficients of 1; x, y; x^2, x y, y^2; ... to degree 6"}});
  fingerpad::PadLight<double> light;
  light.kappa.scale_mm = light.scattering.scale_mm = section.positive("scale_mm");
  const auto copy = [](const auto& from, auto& to) {
    std::copy(from.begin(), from.end(), to.coefficient.begin());
  };
  copy(section.numbers<decltype(light.kappa)::terms>("kappa"), light.kappa);
  copy(section.numbers<decltype(light.scattering)::terms>("scattering"), light.scattering);
  return light;
}

Pad read_pad(const Section& root) {
  const Section section =
      root.section("pad", {{"base_radius_mm", "radius of the pad on the plate, mm"},
                           {"apex_height_mm", "height of the free pad above the plate, mm"}});
  return {section.positive("base_radius_mm"), section.positive("apex_height_mm")};
}

Dots read_dots(const Section& root) {
  const Section section =
      root.section("dots", {{"rows", "number of rows of printed dots"},
                            {"cols", "number of columns of printed dots"},
                            {"pitch_mm", "distance between neighbouring dots, mm"},
                            {"diameter_mm", "diameter of a printed dot, mm"}});
  const Dots dots{section.integer("rows", min_dots, max_dots),
                  section.integer("cols", min_dots, max_dots), section.positive("pitch_mm"),
                  section.positive("diameter_mm")};
  if (!(dots.diameter_mm < dots.pitch_mm)) {
    section.refuse("diameter_mm must be less than pitch_mm");
  }
  return dots;
}

DotPattern read_pattern(const Section& root) {
  const Section section =
      root.section("dots", {{"rows", "number of rows of dots; detected if absent"},
                            {"cols", "number of columns of dots; needed together with rows"},
                            {"diameter_px", "diameter of a dot, px; measured if absent"},
                            {"bright", "whether the dots are brighter than their surroundings"}});
  DotPattern pattern;
  if (section.has("rows") || section.has("cols")) {
    pattern.rows = section.integer("rows", min_dots, max_dots);
    pattern.cols = section.integer("cols", min_dots, max_dots);
  }
  if (section.has("diameter_px")) {
    pattern.diameter_px = section.positive("diameter_px");
  }
  if (section.has("bright")) {
    pattern.bright = section.truth("bright");
  }
  return pattern;
}

fingerpad::StickOptions read_stick(const Section& root, bool& soft_object) {
  const Section section = root.section(
      "stick", {{"noise_px", "standard deviation of a dot along x and along y, px"},
                {"covers_pattern", "whether the object is larger than the dot pattern"},
                {"soft_object", "whether the object shears before it slips, as foam does"}});
  soft_object = section.has("soft_object") && section.truth("soft_object");
  fingerpad::StickOptions options;
  options.covers_pattern = section.has("covers_pattern") && section.truth("covers_pattern");
  if (section.has("noise_px")) {
    options.noise = section.positive("noise_px");
  }
  return options;
}

/// Whether the file has a key that only depth needs.
bool names_depth(const Section& root) {
  for (const char* key : {"camera", "absorption", "light", "pad", "smoothing_px", "rim",
                          "neighbour_light", "force", "contact"}) {
    if (root.has(key)) {
      return true;
    }
  }
  return root.has("reference") && root.at("reference").contains("depth");
}

std::vector<fingerpad::SideRow> read_side_rows(const Section& rim) {
  constexpr std::size_t most = 20;
  const Section section = rim.section(
      "side_dots", {{"count", "number of dots of each row"},
                    {"arc_mm", "list of the rows' arcs from the rim, mm, growing"},
                    {"diameter_mm", "diameter of a dot, mm"},
                    {"first_angle_rad", "list of the azimuths of the rows' first dots"}});
  const auto arcs = section.numbers<most>("arc_mm");
  const auto angles = section.numbers<most>("first_angle_rad");
  const std::size_t count = section.at("arc_mm").size();
  if (section.at("first_angle_rad").size() != count) {
    section.refuse("arc_mm and first_angle_rad must have one number for each row");
  }
  std::vector<fingerpad::SideRow> rows;
  for (std::size_t r = 0; r < count; ++r) {
    rows.push_back(
        {section.positive_integer("count"), arcs[r], section.positive("diameter_mm"), angles[r]});
    section.check([&] { fingerpad::require(rows.back()); });
    if (r > 0 && !(arcs[r] > arcs[r - 1])) {
      section.refuse("arc_mm must grow");
    }
  }
  return rows;
}

Rim read_rim(const Section& root) {
  const Section section = root.section(
      "rim",
      {{"side_dot_length_mm", "length to the side dots, which nothing here reads"},
       {"membrane_modulus_n_per_mm", "shear modulus times thickness of the membrane, N/mm"},
       {"membrane_modulus_sd_n_per_mm", "its standard deviation, N/mm; 1 % if absent"},
       {"stress_free_inclination_rad", "inclination of the stress-free membrane at the rim, rad"},
       {"mooney_share", "C2 / (C1 + C2) of the rubber; 0 (neo-Hookean) if absent"},
       {"membrane_thickness_mm", "thickness of the membrane, which bends where it is clamped, mm"},
       {"full_scale_n",
        "the largest press to expect, N; a quarter of pressure times base if absent"},
       {"side_dots", "rows of dots around the rim, which are found in the pictures"}});
  Rim rim;
  if (section.has("membrane_modulus_n_per_mm")) {
    rim.membrane_modulus_n_per_mm = section.positive("membrane_modulus_n_per_mm");
  }
  if (section.has("membrane_modulus_sd_n_per_mm")) {
    rim.membrane_modulus_sd_n_per_mm = section.positive("membrane_modulus_sd_n_per_mm");
  }
  if (section.has("stress_free_inclination_rad")) {
    rim.stress_free_inclination_rad = section.positive("stress_free_inclination_rad");
  }
  if (section.has("mooney_share")) {
    rim.mooney_share = section.number("mooney_share");
    section.check([&] {
      fingerpad::require("rim", {{"mooney_share", rim.mooney_share, fingerpad::within(0, 1)}});
    });
  }
  if (section.has("membrane_thickness_mm")) {
    rim.membrane_thickness_mm = section.positive("membrane_thickness_mm");
  }
  if (section.has("full_scale_n")) {
    rim.full_scale_n = section.positive("full_scale_n");
  }
  if (section.has("side_dots")) {
    rim.side_rows = read_side_rows(section);
  }
  return rim;
}

/// `unit` is the unit of the measure in the keys: mm2 or mm.
fingerpad::ForceCurve<> read_normal_force(const Section& force,
                                          const std::string& key,
                                          const std::string& unit,
                                          bool needs_residual) {
  const Section section = force.section(
      key, {{"coefficients", "normal force in N, a polynomial in the measure, constant term first"},
            {"from_" + unit, "the smallest contact of the calibration"},
            {"to_" + unit, "the largest contact of the calibration"},
            {"residual_n",
             "standard deviation of the residual, N; by_area and by_depth are weighted by it"},
            {"covariance", "covariance of the coefficients, one row for each"}});
  fingerpad::ForceCurve<> curve;
  curve.coefficients = section.numbers<fingerpad::ForceCurve<>::size>("coefficients");
  curve.from = section.number("from_" + unit);
  curve.to = section.number("to_" + unit);
  const bool has_residual = section.has("residual_n") || section.has("covariance");
  curve.residual_sd_n = needs_residual || has_residual ? section.positive("residual_n") : 0;
  if (section.has("covariance")) {
    const auto rows = section.square("covariance", section.at("coefficients").size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      std::copy(rows[k].begin(), rows[k].end(), curve.covariance[k].begin());
    }
  }
  section.check([&] { fingerpad::require(curve); });
  return curve;
}

ShearLookUp read_shear(const Section& force) {
  const Section section = force.section(
      "shear", {{"by", "measure by which displacement and rotation are scaled, area or depth"},
                {"reference", "measure at which they are not scaled, mm^2 or mm"},
                {"displacement_exponent", "exponent of measure / reference for the displacement"},
                {"rotation_exponent", "exponent of measure / reference for the rotation"},
                {"force_n_per_mm", "[slope of the force over the scaled displacement]"},
                {"moment_n_mm_per_rad", "[slope of the moment over the scaled rotation]"},
                {"to_mm", "the largest scaled displacement of the calibration, mm"},
                {"to_rad", "the largest scaled rotation of the calibration, rad"}});
  ShearLookUp look_up;
  look_up.by = section.one_of("by", {"area", "depth"}) == "area" ? ContactMeasure::area
                                                                 : ContactMeasure::depth;
  look_up.map.reference = section.number("reference");
  look_up.map.force.exponent = section.number("displacement_exponent");
  look_up.map.moment.exponent = section.number("rotation_exponent");
  look_up.map.force.slope = section.numbers<1>("force_n_per_mm")[0];
  look_up.map.force.to = section.number("to_mm");
  look_up.map.moment.slope = section.numbers<1>("moment_n_mm_per_rad")[0];
  look_up.map.moment.to = section.number("to_rad");
  section.check([&] { fingerpad::require(look_up.map); });
  return look_up;
}

Contact read_contact(const Section& root) {
  const Section section = root.section(
      "contact", {{"threshold_per_mm", "curvature below which a pixel is in contact, 1/mm"},
                  {"faint_per_mm", "the same where nothing is below threshold_per_mm, 1/mm"},
                  {"ring_px", "radius of the ring of pixels from which the curvature is taken, px"},
                  {"depth_noise_mm", "standard deviation of a depth, mm"}});
  Contact contact{.threshold_per_mm = section.positive("threshold_per_mm")};
  if (section.has("faint_per_mm")) {
    contact.faint_per_mm = section.positive("faint_per_mm");
  }
  if (section.has("ring_px")) {
    contact.ring_px = section.positive("ring_px");
  }
  if (section.has("depth_noise_mm")) {
    contact.depth_noise_mm = section.positive("depth_noise_mm");
  }
  section.check([&] { fingerpad::require(fingerpad::ContactTest{.ring_px = contact.ring_px}); });
  return contact;
}

ForceLookUp read_force(const Section& root) {
  const Section section = root.section(
      "force", {{"by_area", "curve of normal force against contact area"},
                {"by_depth", "curve of normal force against contact depth"},
                {"shear", "curves of tangential force and moment against shift and rotation"}});
  const bool both = section.has("by_area") && section.has("by_depth");
  ForceLookUp look_up;
  if (section.has("by_area")) {
    look_up.by_area = read_normal_force(section, "by_area", "mm2", both);
  }
  if (section.has("by_depth")) {
    look_up.by_depth = read_normal_force(section, "by_depth", "mm", both);
  }
  if (section.has("shear")) {
    look_up.shear = read_shear(section);
  }
  if (!look_up.by_area && !look_up.by_depth && !look_up.shear) {
    section.refuse("contains no curve");
  }
  return look_up;
}

NeighbourLight read_neighbour_light(const Section& root) {
  const Section section = root.section(
      "neighbour_light", {{"radius_px", "radius of the disc from which light arrives, px"},
                          {"m0_mm_per_rad", "strength of the light, mm per rad"},
                          {"n_per_mm", "growth of the strength with depth, 1/mm"}});
  return {section.positive_integer("radius_px"), section.number("m0_mm_per_rad"),
          section.number("n_per_mm")};
}

void read_dots_only(const Section& root, Sensor& sensor) {
  if (root.has("dots")) {
    sensor.pattern = read_pattern(root);
  }
  if (root.has("reference")) {
    const Section reference =
        root.section("reference", {{"frame", "picture of the dots before anything touches them"}});
    sensor.reference_frame = reference.path("frame");
  }
}

/// Reads the keys of a recording with depth.
void read_depth(const std::filesystem::path& file, const Section& root, Sensor& sensor) {
  try {
    read_camera(root, sensor);
    sensor.absorption = read_absorption(root);
  } catch (const fingerpad::parameter_error& error) {
    fail(file, error.what());
  }
  if (root.has("light")) {
    sensor.light = read_light(root);
  }
  sensor.pad = read_pad(root);
  const Section reference =
      root.section("reference", {{"frame", "picture of the free pad, a PNG file"},
                                 {"depth", "depth of each pixel in mm, a 32-bit float TIFF file"}});
  sensor.reference_frame = reference.path("frame");
  sensor.reference_depth = reference.path("depth");
  if (root.has("smoothing_px")) {
    sensor.smoothing_px = root.positive_integer("smoothing_px");
    if (*sensor.smoothing_px % 2 == 0) {
      fail(file, "smoothing_px = " + std::to_string(*sensor.smoothing_px) + ", must be odd");
    }
  }
  if (root.has("dots")) {
    sensor.dots = read_dots(root);
  }
  if (root.has("force")) {
    sensor.force = read_force(root);
  }
  if (root.has("contact")) {
    sensor.contact = read_contact(root);
  }
  if (root.has("rim")) {
    sensor.rim = read_rim(root);
  }
  if (root.has("neighbour_light")) {
    sensor.neighbour_light = read_neighbour_light(root);
  }
}

}  // namespace

void expects_known_version(const std::filesystem::path& file, const nlohmann::json& content) {
  if (content.is_object() && content.contains("version") &&
      content.at("version") != nlohmann::json(sensor_version)) {
    fail(file, "version = " + content.at("version").dump() + ", but this program reads version " +
                   std::to_string(sensor_version));
  }
}

Sensor read_sensor(const std::filesystem::path& file) {
  return read_sensor(file, parse_json(file));
}

Sensor read_sensor(const std::filesystem::path& file, const nlohmann::json& content) {
  expects_known_version(file, content);
  const Section root(file, "", content,
                     {{"version", "version of the file format"},
                      {"calibration", "reports of the calibrations"},
                      {"camera", "position and resolution of the camera"},
                      {"absorption", "absorption of light in the fluid"},
                      {"light", "the light over the plate"},
                      {"pad", "size of the free pad"},
                      {"reference", "a frame of the free pad and its known depth"},
                      {"video", "a video instead of the folder frames/"},
                      {"smoothing_px", "width of the smoothing window, px"},
                      {"dots", "the printed dots"},
                      {"rim", "the dots at the rim"},
                      {"neighbour_light", "compensation of light from neighbouring membrane"},
                      {"force", "curves of force against contact and shift"},
                      {"stick", "thresholds for comparing dots and detecting slip"},
                      {"contact", "threshold of contact"},
                      {"foam", "a foam array"}});
  if (root.has("foam")) {
    fail(file, "has a section foam, but taxels.csv with the readings of the array is missing");
  }
  Sensor sensor;
  if (root.has("video")) {
    sensor.video = root.path("video");
  }
  if (root.has("stick")) {
    try {
      sensor.stick = read_stick(root, sensor.soft_object);
    } catch (const fingerpad::parameter_error& error) {
      fail(file, error.what());
    }
  }
  sensor.dots_only = !names_depth(root);
  if (sensor.dots_only) {
    sensor.pictures.may_be_grey = true;
    read_dots_only(root, sensor);
  } else {
    read_depth(file, root, sensor);
  }
  return sensor;
}

}  // namespace replay
