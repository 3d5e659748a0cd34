// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "recording.hpp"

#include <algorithm>

#include "common/table.hpp"

namespace stick_table {
namespace {

constexpr double reference_mm = 0.16, slip_share = 0.0086 / 0.16;

/// Calls `take` with the values of these columns, line by line; NaN where a cell is empty.
template <class Take>
void read(const std::filesystem::path& file,
          const std::vector<std::string>& columns,
          const Take& take) {
  replay::Table table(file, replay::Table::Lines::may_end_early);
  std::vector<std::size_t> at;
  for (const std::string& column : columns) {
    const auto& header = table.header();
    at.push_back(
        static_cast<std::size_t>(std::find(header.begin(), header.end(), column) - header.begin()));
    if (at.back() == header.size()) {
      table.refuse("has no column " + column);
    }
  }
  std::vector<double> values(columns.size());
  while (table.next()) {
    for (std::size_t k = 0; k < at.size(); ++k) {
      values[k] = table.number_or_nan(at[k]);
    }
    take(values);
  }
}

}  // namespace

Recording::Recording(const std::filesystem::path& folder) : name(folder.filename().string()) {
  const std::vector<std::string> dot = {"frame", "row", "col", "x_mm", "y_mm", "z_mm"};
  const auto n = [](double value) { return static_cast<std::size_t>(value); };
  fingerpad::Index rows = 0, cols = 0;
  read(folder / "truth/dots.csv", dot, [&](const std::vector<double>& v) {
    rows = std::max(rows, static_cast<fingerpad::Index>(v[1]) + 1);
    cols = std::max(cols, static_cast<fingerpad::Index>(v[2]) + 1);
    frames.resize(std::max(frames.size(), n(v[0]) + 1));
  });
  const fingerpad::Point3<double> none = {test::nan, test::nan, test::nan};
  for (Frame& f : frames) {
    f.found = f.place = f.on_object = Dots(rows, cols, none);
    f.in_contact = {rows, cols};
  }
  const auto read_dots = [&](const char* file, Dots Frame::*to) {
    read(folder / file, dot, [&](const std::vector<double>& v) {
      (frames.at(n(v[0])).*to)(static_cast<fingerpad::Index>(v[1]),
                               static_cast<fingerpad::Index>(v[2])) = {v[3], v[4], v[5]};
    });
  };
  read_dots("truth/dots.csv", &Frame::place);
  read_dots("truth/on_object.csv", &Frame::on_object);
  read_dots("answer/dots.csv", &Frame::found);
  read(folder / "answer/dots.csv", {"frame", "row", "col", "contact"},
       [&](const std::vector<double>& v) {
         frames.at(n(v[0])).in_contact(static_cast<fingerpad::Index>(v[1]),
                                       static_cast<fingerpad::Index>(v[2])) = v[3] > 0 ? 1 : 0;
       });
  read(folder / "answer/frames.csv",
       {"frame", "time_s", "wrench_fx_n", "wrench_fy_n", "wrench_fz_n", "wrench_mx_nm",
        "wrench_my_nm", "wrench_mz_nm"},
       [&](const std::vector<double>& v) {
         Frame& f = frames.at(n(v[0]));
         f.time_s = v[1];
         f.force_n = {v[2], v[3], v[4]};
         f.moment_n_mm = 1e3 * fingerpad::Point3<double>{v[5], v[6], v[7]};
       });
  read(folder / "truth/forces.csv", {"frame", "contact_area_mm2", "stick_ratio"},
       [&](const std::vector<double>& v) {
         frames.at(n(v[0])).contact_mm2 = v[1];
         frames.at(n(v[0])).stick_share = v[2];
         largest_mm2 = std::max(largest_mm2, v[1]);
       });
}

bool Recording::asks(std::size_t frame) const {
  return frame >= 2 && frames[frame].contact_mm2 > std::min(20.0, 0.3 * largest_mm2);
}

std::optional<double> Recording::truth(const std::vector<std::size_t>& seen) const {
  const std::size_t last = seen.back();
  const Frame& now = frames[last];
  for (std::size_t back = 2; back <= seen.size(); ++back) {
    const std::size_t at = seen[seen.size() - back];
    if (at == 0 || at + 12 <= last) {
      break;
    }
    const Frame& then = frames[at];
    std::vector<double> slips;
    double longest = 0;
    for (std::size_t k = 0; k < now.place.cells.size(); ++k) {
      const double slip = norm(now.on_object.cells[k] - then.on_object.cells[k]);
      if (fingerpad::is_finite(slip)) {
        slips.push_back(slip);
        longest = std::max(longest, norm(now.place.cells[k] - then.place.cells[k]));
      }
    }
    if (slips.size() < 6) {
      return std::nullopt;
    }
    if (longest > reference_mm) {
      const auto stick = std::count_if(slips.begin(), slips.end(),
                                       [&](double slip) { return slip < slip_share * longest; });
      return static_cast<double>(stick) / static_cast<double>(slips.size());
    }
  }
  return now.stick_share;
}

}  // namespace stick_table
