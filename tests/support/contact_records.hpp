// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Contacts of finite-element membranes, step by step: size, displacement, rotation and true loads.
// See tests/data/README.md.
#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/core/dots.hpp"
#include "support/finite_elements.hpp"

namespace test {

struct ContactRecord {
  std::string scene;
  int step = 0;
  double area_mm2 = 0;
  double depth_mm = 0;
  fingerpad::Point2<double> central_mm = {0, 0};  ///< the central dot
  double contact_rad = 0;                         ///< the dots in contact
  fingerpad::Point2<double> edge_mm = {0, 0};     ///< the dots on both sides of the edge
  double edge_rad = 0;
  fingerpad::Point3<double> force_n = {0, 0, 0};
  double moment_n_mm = 0;
};

inline std::vector<ContactRecord> read_contact_records() {
  auto file = open_data("contacts.csv",
                        "scene,step,area_mm2,depth_mm,central_x_mm,central_y_mm,contact_rad,"
                        "shift_x_mm,shift_y_mm,shift_rad,force_x_n,force_y_n,force_z_n,moment_n_mm"
                        "\n");
  std::vector<ContactRecord> records;
  for (std::string line; std::getline(file, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    ContactRecord r;
    words >> r.scene >> r.step >> r.area_mm2 >> r.depth_mm >> r.central_mm.x >> r.central_mm.y >>
        r.contact_rad >> r.edge_mm.x >> r.edge_mm.y >> r.edge_rad >> r.force_n.x >> r.force_n.y >>
        r.force_n.z >> r.moment_n_mm;
    if (!words.fail()) {
      records.push_back(r);
    }
  }
  require_data(records.size() == 207, "contacts.csv has not 207 contacts");
  return records;
}

/// All steps of these scenes, in the order of the file.
inline std::vector<ContactRecord> contact_records(const std::vector<std::string>& scenes) {
  static const std::vector<ContactRecord> all = read_contact_records();
  std::vector<ContactRecord> chosen;
  for (const ContactRecord& r : all) {
    if (std::find(scenes.begin(), scenes.end(), r.scene) != scenes.end()) {
      chosen.push_back(r);
    }
  }
  return chosen;
}

enum class ContactMeasure { area, depth };
enum class ContactDotsOf { edge, center };

/// Samples for a calibration; each scene is one load.
inline std::vector<fingerpad::ForceSample<double>> force_samples(
    const std::vector<ContactRecord>& records,
    ContactMeasure measure,
    ContactDotsOf dots = ContactDotsOf::edge) {
  const bool edge = dots == ContactDotsOf::edge;
  std::vector<fingerpad::ForceSample<double>> samples;
  int load = 0;
  for (std::size_t k = 0; k < records.size(); ++k) {
    const ContactRecord& r = records[k];
    load += k > 0 && r.scene != records[k - 1].scene ? 1 : 0;
    samples.push_back({.measure = measure == ContactMeasure::area ? r.area_mm2 : r.depth_mm,
                       .displacement_mm = edge ? r.edge_mm : r.central_mm,
                       .rotation_rad = edge ? r.edge_rad : r.contact_rad,
                       .normal_force_n = -r.force_n.z,
                       .tangential_force_n = {r.force_n.x, r.force_n.y},
                       .moment_n_mm = r.moment_n_mm,
                       .load = load});
  }
  return samples;
}

}  // namespace test
