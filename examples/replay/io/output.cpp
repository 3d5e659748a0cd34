// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/io/output.hpp"

#include <unistd.h>

#include <cstdio>
#include <limits>
#include <regex>
#include <system_error>
#include <vector>

#include "replay/io/csv_cells.hpp"
#include "replay/io/failure.hpp"

namespace replay {
namespace {

namespace fs = std::filesystem;

constexpr const char* columns =
    "frame,time_s,valid_share,depth_mean_mm,depth_max_mm,"
    "contact_area_mm2,contact_depth_mm,contact_center_x_mm,contact_center_y_mm,"
    "object,motion_status,object_x_mm,object_y_mm,object_z_mm,"
    "rotation_x_rad,rotation_y_rad,rotation_z_rad,"
    "dots_in_contact,stick_ratio,stick_ratio_updated,stick_ratio_sd,slip_evidence,"
    "shift_x_mm,shift_y_mm,shift_rad,"
    "flat_area_mm2,normal_force_n,normal_force_sd_n,tangential_force_x_n,tangential_force_y_n,"
    "moment_z_nm,"
    "wrench_fx_n,wrench_fy_n,wrench_fz_n,wrench_mx_nm,wrench_my_nm,wrench_mz_nm,"
    "wrench_fx_sd_n,wrench_fy_sd_n,wrench_fz_sd_n,wrench_mx_sd_nm,wrench_my_sd_nm,wrench_mz_sd_nm";
constexpr const char* dot_columns = "frame,row,col,x_px,y_px,x_mm,y_mm,z_mm,contact,stick";

const char* words_of(fingerpad::SlipEvidence evidence) {
  switch (evidence) {
    case fingerpad::SlipEvidence::none:
      return "";
    case fingerpad::SlipEvidence::dots:
      return "dots";
    case fingerpad::SlipEvidence::imprint:
      return "imprint";
    case fingerpad::SlipEvidence::friction:
      return "friction";
    case fingerpad::SlipEvidence::both:
      return "dots+friction";
  }
  return "";
}

/// "1" or "0"; empty if the state is unknown or the dot is not in contact.
const char* stick_cell(DotState state) {
  return state == DotState::stick ? "1" : state == DotState::slip ? "0" : "";
}

void close_file(std::ofstream& stream, const fs::path& file) {
  stream.close();
  if (!stream) {
    fail(file, "cannot be written");
  }
}

/// Whether the program itself writes a file of this path, relative to the output folder.
bool is_ours(const std::string& relative) {
  static const std::regex ours(
      R"(frames\.csv|dots\.csv|slide\.csv|depth|depth/\d{6}\.tiff|contact|contact/\d{6}\.png|pictures|)"
      R"(pictures/(depth|side|contact|stick|traction|slide|live)_\d{6}\.png|)"
      R"(pictures/(montage|motion|stick_ratio|forces|wrench|array|frequency|preslip|slide)\.png)");
  return std::regex_match(relative, ours);
}

void refuse_foreign(const fs::path& place) {
  const std::string kept = ": nothing was changed; choose another folder";
  if (!fs::exists(fs::symlink_status(place))) {
    return;
  }
  if (!fs::is_directory(place)) {
    fail(place, "is not a folder" + kept);
  }
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(place)) {
    const std::string relative = entry.path().lexically_relative(place).generic_string();
    if (entry.is_symlink() || !is_ours(relative)) {
      fail(place, "contains " + relative + ", which replay did not write" + kept);
    }
  }
  if (!fs::is_empty(place)) {
    std::ifstream table(place / "frames.csv");
    std::string header;
    if (!std::getline(table, header) || header.rfind("frame,time_s", 0) != 0) {
      fail(place, "is not empty and has no frames.csv of an earlier run" + kept);
    }
  }
}

/// The folder's path without "." and trailing slash, with symbolic links resolved.
fs::path resolved(const fs::path& given) {
  fs::path place = fs::weakly_canonical(fs::absolute(given));
  return place.has_filename() ? place : place.parent_path();
}

fs::path make_sibling(const fs::path& place) {
  std::string hidden = ".";
  hidden += place.filename().string() + ".XXXXXX";
  const std::string name = (place.parent_path() / hidden).string();
  std::vector<char> pattern(name.begin(), name.end());
  pattern.push_back('\0');
  if (::mkdtemp(pattern.data()) == nullptr) {
    fail(place.parent_path(),
         "cannot be written: " + std::error_code(errno, std::generic_category()).message());
  }
  const fs::path sibling(pattern.data());
  fs::permissions(sibling,
                  fs::perms::group_read | fs::perms::group_exec | fs::perms::others_read |
                      fs::perms::others_exec,
                  fs::perm_options::add);
  return sibling;
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& place) {
  try {
    place_ = resolved(place);
    refuse_foreign(place_);
  } catch (const fs::filesystem_error& error) {
    fail(place, error.code().message());
  }
  make_parents(place_.parent_path());
  try {
    growing_ = make_sibling(place_);
  } catch (const Failure&) {
    remove_traces();
    throw;
  }
}

OutputFolder::~OutputFolder() {
  if (!growing_.empty()) {
    remove_traces();
  }
}

void OutputFolder::make_parents(const fs::path& folder) {
  if (fs::exists(folder)) {
    return;
  }
  make_parents(folder.parent_path());
  std::error_code error;
  fs::create_directory(folder, error);
  if (error) {
    remove_traces();
    fail(folder, "cannot be created: " + error.message());
  }
  made_parents_.push_back(folder);
}

void OutputFolder::remove_traces() {
  std::error_code ignored;
  if (!growing_.empty()) {
    fs::remove_all(growing_, ignored);
  }
  for (; !made_parents_.empty(); made_parents_.pop_back()) {
    fs::remove(made_parents_.back(), ignored);  // fails unless it is empty
  }
}

fs::path OutputFolder::file(const std::string& part, const std::string& name) const {
  std::error_code error;
  fs::create_directories(growing_ / part, error);
  if (error) {
    fail(growing_ / part, "cannot be written: " + error.message());
  }
  return growing_ / part / name;
}

void OutputFolder::publish() {
  try {
    refuse_foreign(place_);  // again: another program may have used it meanwhile
    if (fs::exists(place_)) {
      // The earlier run stays complete until the new one is in place.
      const fs::path earlier = make_sibling(place_);
      fs::rename(place_, earlier);
      std::error_code error;
      fs::rename(growing_, place_, error);
      if (error) {
        fs::rename(earlier, place_);
        fail(place_, "cannot be replaced: " + error.message());
      }
      fs::remove_all(earlier);
    } else {
      fs::rename(growing_, place_);
    }
    growing_.clear();
  } catch (const fs::filesystem_error& error) {
    fail(place_, "cannot be written: " + error.code().message());
  }
}

std::string numbered(const std::string& stem, int frame, const std::string& extension) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "%06d", frame);
  return stem + digits + extension;
}

FramesCsv::FramesCsv(const fs::path& file) : file_(file), stream_(file) {
  stream_ << columns << '\n';
}

void FramesCsv::write(const FrameRow& row) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const auto& contact = row.contact;
  stream_ << row.frame << ',' << row.time_s << ',' << cell_of(row.valid_share) << ','
          << cell_of(row.depth_mean_mm) << ',' << cell_of(row.depth_max_mm) << ','
          << cell_of(contact.ok() ? contact.area_mm2 : none) << ',' << cell_of(contact.depth_mm)
          << ',' << cell_of(contact.center_mm.x) << ',' << cell_of(contact.center_mm.y);
  const auto& motion = row.motion;
  if (row.has_dots) {
    stream_ << ',' << motion.object << ',' << name_of(motion.status);
  } else {
    stream_ << ",,";
  }
  for (const double value : {motion.position_mm.x, motion.position_mm.y, motion.position_mm.z,
                             motion.angles.x_rad, motion.angles.y_rad, motion.angles.z_rad}) {
    stream_ << ',' << cell_of(motion.has_pose() ? value : none);
  }
  const auto& stick = row.stick;
  if (row.has_dots) {
    stream_ << ',' << stick.dots_in_contact() << ',' << cell_of(stick.stick_ratio) << ','
            << (stick.updated() ? 1 : 0) << ',' << cell_of(stick.ratio_sd) << ','
            << words_of(row.slip_evidence);
  } else {
    stream_ << ",,,,,";
  }
  const auto& shift = row.force.shift;
  constexpr double metre = 1000;  // in mm
  for (const double value :
       {shift.displacement.x, shift.displacement.y, shift.rotation_rad, row.force.flat_area_mm2,
        row.force.normal_n, row.force.normal_sd_n, row.force.tangential_n.x,
        row.force.tangential_n.y, row.force.moment_n_mm / metre}) {
    stream_ << ',' << cell_of(value);
  }
  const fingerpad::Point3<double>& force = row.wrench.force_n;
  const fingerpad::Point3<double>& moment = row.wrench.moment_n_mm;
  for (const double value :
       {force.x, force.y, force.z, moment.x / metre, moment.y / metre, moment.z / metre}) {
    stream_ << ',' << cell_of(row.has_wrench() ? value : none);
  }
  for (std::size_t k = 0; k < 6; ++k) {
    stream_ << ',' << cell_of(row.wrench_sd[k] / (k < 3 ? 1 : metre));
  }
  stream_ << '\n';
}

void FramesCsv::close() {
  close_file(stream_, file_);
}

DotsCsv::DotsCsv(const fs::path& file) : file_(file), stream_(file) {
  stream_ << dot_columns << '\n';
}

void DotsCsv::write(int frame, const FrameDots& dots) {
  for (int i = 0; i < dots.dots_px.rows; ++i) {
    for (int j = 0; j < dots.dots_px.cols; ++j) {
      const cv::Vec2d& px = dots.dots_px(i, j);
      const cv::Vec3d& mm = dots.dots_mm(i, j);
      if (is_present(px)) {
        stream_ << frame << ',' << i << ',' << j << ',' << cell_of(px[0]) << ',' << cell_of(px[1])
                << ',' << cell_of(mm[0]) << ',' << cell_of(mm[1]) << ',' << cell_of(mm[2]) << ','
                << (dots.in_contact(i, j) != 0 ? 1 : 0) << ',' << stick_cell(dots.stick.state(i, j))
                << '\n';
      }
    }
  }
}

void DotsCsv::close() {
  close_file(stream_, file_);
}

}  // namespace replay
