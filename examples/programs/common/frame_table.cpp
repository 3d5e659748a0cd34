// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/frame_table.hpp"

#include <cmath>

namespace replay {
namespace {

using Row = FrameRow;
using Text = std::string;

Text cell_if(bool known, double value) {
  return known ? cell_of(value) : "";
}

Text whole_if(bool known, fingerpad::Index value) {
  return known ? std::to_string(value) : "";
}

Text depth_status(const Row& row) {
  const auto light = row.touch.neighbour_light;
  const Text words = name_of(row.touch.depth.ok() ? light : row.touch.depth.status);
  return !row.has_depth                                  ? ""
         : words == "ok" && row.picture_fault != nullptr ? row.picture_fault
         : words == "ok" && row.touch.light_in_doubt()   ? "light has changed"
                                                         : words;
}

Text contact_status(const Row& row) {
  const auto& touch = row.touch;
  return !row.has_depth                                         ? ""
         : !touch.contact.ok()                                  ? name_of(touch.contact.status)
         : touch.contact_in_doubt && touch.contact.in_contact() ? "edge in doubt"
         : touch.contact_in_doubt                               ? "force without region"
         : row.picture_fault != nullptr                         ? row.picture_fault
         : row.touch.light_in_doubt()                           ? "light has changed"
                                                                : "ok";
}

Text look_up_status(const Row& row) {
  const auto status = row.touch.normal.status;
  return !row.has_curves                                         ? ""
         : !row.touch.contact.ok() || row.touch.contact_in_doubt ? "contact in doubt"
         : row.picture_fault != nullptr                          ? row.picture_fault
         : row.touch.light_in_doubt()                            ? "light has changed"
         : status == fingerpad::ForceStatus::measured            ? "ok"
                                                                 : name_of(status);
}

/// Whether there is an object: a frame without a pose keeps it.
bool has_object(const Row& row) {
  using fingerpad::MotionStatus;
  const auto& motion = row.touch.motion;
  return row.has_depth && row.has_dots && motion.object > 0 &&
         motion.status != MotionStatus::no_contact && motion.status != MotionStatus::slipping;
}

Text evidence(const Row& row) {
  switch (row.touch.slip.evidence) {
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

/// Force and moment by their place in the wrench, in N and N m.
Text wrench(const Row& row, int k) {
  const auto &f = row.touch.wrench.force_n, &m = row.touch.wrench.moment_n_mm;
  const double all[] = {f.x, f.y, f.z, m.x / 1000, m.y / 1000, m.z / 1000};
  return cell_if(row.touch.wrench.has_force(), all[k]);
}
Text wrench_sd(const Row& row, int k) {
  const double unit = k < 3 ? 1 : 1000;
  return cell_if(row.touch.wrench.has_force(), std::sqrt(row.touch.wrench.covariance(k, k)) / unit);
}

/// Of a gel.
Text slide_status(const Row& row) {
  return !row.gel                 ? ""
         : !row.gel->contact.ok() ? name_of(row.gel->contact.status)
         : row.gel->slide.ok()    ? "ok"
                                  : name_of(row.gel->slide.status);
}

/// "1" or "0"; empty if the state is unknown or the dot is not in contact.
const char* stick_cell(DotState state) {
  return state == DotState::stick ? "1" : state == DotState::slip ? "0" : "";
}

}  // namespace

std::vector<Column<FrameRow>> frame_columns() {
  return {
      {"frame", [](const Row& r) { return std::to_string(r.frame); }},
      {"time_s", [](const Row& r) { return r.time_s; }},
      {"depth_status", depth_status},
      {"depth_light_sd_mm",
       [](const Row& r) {
         return cell_if(r.has_depth, std::hypot(r.touch.depth_light_sd_mm,
                                                r.picture_fault != nullptr ? 0.1 : 0.0));
       }},
      {"pad_changed", [](const Row& r) { return whole_if(r.has_depth, r.pad_has_changed()); }},
      {"valid_share", [](const Row& r) { return cell_of(r.valid_share); }},
      {"depth_mean_mm", [](const Row& r) { return cell_of(r.depth_mean_mm); }},
      {"depth_max_mm", [](const Row& r) { return cell_of(r.depth_max_mm); }},
      {"contact_status", contact_status},
      {"contact_area_mm2",
       [](const Row& r) { return cell_if(r.touch.contact.ok(), r.touch.contact.area_mm2); }},
      {"contact_area_sd_mm2",
       [](const Row& r) { return cell_if(r.touch.contact.ok(), r.touch.contact.area_sd_mm2); }},
      {"contact_depth_mm", [](const Row& r) { return cell_of(r.touch.contact.depth_mm); }},
      {"contact_center_x_mm", [](const Row& r) { return cell_of(r.touch.contact.center_mm.x); }},
      {"contact_center_y_mm", [](const Row& r) { return cell_of(r.touch.contact.center_mm.y); }},
      {"motion_status",
       [](const Row& r) {
         return Text(r.has_depth && r.has_dots ? name_of(r.touch.motion.status) : "");
       }},
      {"object", [](const Row& r) { return whole_if(has_object(r), r.touch.motion.object); }},
      {"object_x_mm",
       [](const Row& r) {
         return cell_if(r.touch.motion.has_pose(), r.touch.motion.position_mm.x);
       }},
      {"object_y_mm",
       [](const Row& r) {
         return cell_if(r.touch.motion.has_pose(), r.touch.motion.position_mm.y);
       }},
      {"object_z_mm",
       [](const Row& r) {
         return cell_if(r.touch.motion.has_pose(), r.touch.motion.position_mm.z);
       }},
      {"rotation_x_rad",
       [](const Row& r) {
         return cell_if(r.touch.motion.has_pose(), r.touch.motion.angles.x_rad);
       }},
      {"rotation_y_rad",
       [](const Row& r) {
         return cell_if(r.touch.motion.has_pose(), r.touch.motion.angles.y_rad);
       }},
      {"rotation_z_rad",
       [](const Row& r) {
         return cell_if(r.touch.motion.has_pose(), r.touch.motion.angles.z_rad);
       }},
      {"object_sd_mm", [](const Row& r) { return cell_of(r.touch.motion.position_sd_mm); }},
      {"rotation_sd_rad", [](const Row& r) { return cell_of(r.touch.motion.rotation_sd_rad); }},
      {"slip_status",
       [](const Row& r) {
         return Text(!r.has_dots               ? ""
                     : !r.touch.slip.updated() ? name_of(r.touch.stick.status)
                     : r.touch.stick.far_apart ? "frames far apart"
                     : r.touch.slip.in_doubt   ? "doubtful"
                                               : "ok");
       }},
      {"dots_in_contact",
       [](const Row& r) { return whole_if(r.has_dots, r.touch.stick.dots_in_contact()); }},
      {"stick_ratio", [](const Row& r) { return cell_if(r.has_dots, r.touch.slip.stick_ratio); }},
      {"stick_ratio_updated",
       [](const Row& r) { return whole_if(r.has_dots, r.touch.slip.updated()); }},
      {"stick_ratio_sd", [](const Row& r) { return cell_if(r.has_dots, r.touch.slip.ratio_sd); }},
      {"slip_evidence", evidence},
      {"shift_x_mm", [](const Row& r) { return cell_of(r.touch.shift.displacement.x); }},
      {"shift_y_mm", [](const Row& r) { return cell_of(r.touch.shift.displacement.y); }},
      {"shift_rad", [](const Row& r) { return cell_of(r.touch.shift.rotation_rad); }},
      {"look_up_status", look_up_status},
      {"flat_area_mm2", [](const Row& r) { return cell_of(r.touch.flat_area.area_mm2); }},
      {"normal_force_n", [](const Row& r) { return cell_of(r.touch.normal.force_n); }},
      {"normal_force_sd_n",
       [](const Row& r) { return cell_of(std::sqrt(r.touch.normal.variance_n2)); }},
      {"tangential_force_x_n",
       [](const Row& r) { return cell_of(r.touch.shear.tangential_force_n.x); }},
      {"tangential_force_y_n",
       [](const Row& r) { return cell_of(r.touch.shear.tangential_force_n.y); }},
      {"moment_z_nm", [](const Row& r) { return cell_of(r.touch.shear.moment_n_mm / 1000); }},
      {"wrench_status",
       [](const Row& r) { return Text(r.has_rim ? name_of(r.touch.wrench.status) : ""); }},
      {"wrench_fx_n", [](const Row& r) { return wrench(r, 0); }},
      {"wrench_fy_n", [](const Row& r) { return wrench(r, 1); }},
      {"wrench_fz_n", [](const Row& r) { return wrench(r, 2); }},
      {"wrench_mx_nm", [](const Row& r) { return wrench(r, 3); }},
      {"wrench_my_nm", [](const Row& r) { return wrench(r, 4); }},
      {"wrench_mz_nm", [](const Row& r) { return wrench(r, 5); }},
      {"wrench_fx_sd_n", [](const Row& r) { return wrench_sd(r, 0); }},
      {"wrench_fy_sd_n", [](const Row& r) { return wrench_sd(r, 1); }},
      {"wrench_fz_sd_n", [](const Row& r) { return wrench_sd(r, 2); }},
      {"wrench_mx_sd_nm", [](const Row& r) { return wrench_sd(r, 3); }},
      {"wrench_my_sd_nm", [](const Row& r) { return wrench_sd(r, 4); }},
      {"wrench_mz_sd_nm", [](const Row& r) { return wrench_sd(r, 5); }},
      {"slide_status", slide_status},
      {"contact_area_px",
       [](const Row& r) {
         return r.gel && r.gel->contact.ok() ? std::to_string(r.gel->contact.contact_px) : "";
       }},
      {"contact_center_x_px",
       [](const Row& r) { return r.gel ? cell_of(r.gel->contact.center_px.x) : ""; }},
      {"contact_center_y_px",
       [](const Row& r) { return r.gel ? cell_of(r.gel->contact.center_px.y) : ""; }},
      {"slide_dots", [](const Row& r) { return r.gel ? std::to_string(r.gel->slide.dots) : ""; }},
      {"slide_x_px", [](const Row& r) { return r.gel ? cell_of(r.gel->slide.slide_px.x) : ""; }},
      {"slide_y_px", [](const Row& r) { return r.gel ? cell_of(r.gel->slide.slide_px.y) : ""; }},
      {"slide_pitches", [](const Row& r) { return r.gel ? cell_of(r.gel->slide.slide) : ""; }},
      {"area_lost", [](const Row& r) { return r.gel ? cell_of(r.gel->slide.lost) : ""; }},
      {"slide_evidence", [](const Row& r) { return r.gel ? cell_of(r.gel->slide.evidence) : ""; }},
      {"slip", [](const Row& r) { return r.gel ? std::to_string(r.gel->slide.alarm) : ""; }}};
}

std::vector<Column<DotRow>> dot_columns() {
  return {
      {"frame", [](const DotRow& r) { return std::to_string(r.frame); }},
      {"row", [](const DotRow& r) { return std::to_string(r.row); }},
      {"col", [](const DotRow& r) { return std::to_string(r.col); }},
      {"x_px", [](const DotRow& r) { return cell_of(r.dots.dots_px(r.row, r.col)[0]); }},
      {"y_px", [](const DotRow& r) { return cell_of(r.dots.dots_px(r.row, r.col)[1]); }},
      {"x_mm", [](const DotRow& r) { return cell_of(r.dots.dots_mm(r.row, r.col)[0]); }},
      {"y_mm", [](const DotRow& r) { return cell_of(r.dots.dots_mm(r.row, r.col)[1]); }},
      {"z_mm", [](const DotRow& r) { return cell_of(r.dots.dots_mm(r.row, r.col)[2]); }},
      {"contact", [](const DotRow& r) { return r.dots.in_contact(r.row, r.col) != 0 ? "1" : "0"; }},
      {"stick", [](const DotRow& r) { return stick_cell(r.dots.state(r.row, r.col)); }}};
}

}  // namespace replay
