// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "overview.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <system_error>

#include "common/failure.hpp"
#include "common/frame_table.hpp"
#include "common/table.hpp"
#include "common/whole_files.hpp"

namespace replay_many {
namespace {

using Words = std::vector<std::string>;

/// Quotes a cell of a .csv file.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == text.npos) {
    return text;
  }
  std::string cell = "\"";
  for (const char c : text) {
    cell += c == '"' ? "\"\"" : std::string(1, c);
  }
  return cell + "\"";
}

/// Maximum or minimum of columns over the frames of a recording, NaN if unknown, and its doubts.
struct Extremes {
  struct Column {
    const char* name;  ///< column in frames.csv
    bool is_least;
    const char* title;  ///< column in summary.csv
    double value = std::numeric_limits<double>::quiet_NaN();
  };
  std::array<Column, 6> columns = {{{"depth_max_mm", false, "depth_max_mm"},
                                    {"contact_area_mm2", false, "contact_area_max_mm2"},
                                    {"stick_ratio", true, "stick_ratio_min"},
                                    {"normal_force_n", false, "normal_force_max_n"},
                                    {"wrench_fz_n", true, "wrench_fz_min_n"},
                                    {"preslip", false, "preslip"}}};
  replay::Doubts doubts;

  void see(const std::string& name, const std::string& cell) {
    doubts.see(name, cell);
    for (Column& column : columns) {
      if (!cell.empty() && name == column.name) {
        const double value = std::strtod(cell.c_str(), nullptr);
        column.value =
            column.is_least ? std::fmin(column.value, value) : std::fmax(column.value, value);
      }
    }
  }
};

std::string in_words(double value) {
  char text[32] = "";
  if (std::isfinite(value)) {
    std::snprintf(text, sizeof text, "%g", value);
  }
  return text;
}

replay::Table frames_of(const Path& folder) {
  return replay::Table(folder / "frames.csv", replay::Table::Lines::may_end_early);
}

class Overview {
 public:
  Overview(const Recordings& recordings, const Path& out)
      : recordings_(recordings), frames_(out / "all_frames.csv"), summary_(out / "summary.csv") {
    find_columns();
    frames_ << "recording";
    for (const std::string& column : columns_) {
      frames_ << ',' << column;
    }
    frames_ << '\n';
    summary_ << "recording,status,reason,bytes,frames";
    for (const auto& column : Extremes().columns) {
      summary_ << ',' << column.title;
    }
    summary_ << ",doubted\n";
  }

  Counts write() {
    for (const auto& found : recordings_.all()) {
      add(found);
    }
    frames_.publish();
    summary_.publish();
    return counts_;
  }

 private:
  bool is_done(const std::string& name) const {
    std::error_code error;
    return std::filesystem::exists(recordings_.place_of(name), error);
  }

  /// Collects the columns of all tables, in order of first occurrence.
  void find_columns() {
    for (const auto& found : recordings_.all()) {
      if (is_done(found.name)) {
        const replay::Table table = frames_of(recordings_.place_of(found.name));
        for (const std::string& name : table.header()) {
          if (std::find(columns_.begin(), columns_.end(), name) == columns_.end()) {
            columns_.push_back(name);
          }
        }
      }
    }
  }

  void add(const Recordings::Found& found) {
    Extremes extremes;
    const auto failure = recordings_.failure_of(found.name);
    const bool done = is_done(found.name);
    const char* const status = done ? "done" : failure ? "failed" : "left";
    const long long frames = done ? add_frames(found.name, extremes) : 0;
    ++(done ? counts_.done : failure ? counts_.failed : counts_.left);
    counts_.frames += frames;
    summary_ << quoted(found.name) << ',' << status << ',' << quoted(failure.value_or("")) << ','
             << std::to_string(static_cast<long long>(found.bytes)) << ',' << frames;
    for (const auto& column : extremes.columns) {
      summary_ << ',' << in_words(column.value);
    }
    std::string doubted;
    for (const auto& [what, in_frames] : extremes.doubts.in_words()) {
      doubted += (doubted.empty() ? "" : "; ") + what + " in " + in_frames;
    }
    summary_ << ',' << quoted(doubted) << '\n';
  }

  long long add_frames(const std::string& name, Extremes& extremes) {
    replay::Table table = frames_of(recordings_.place_of(name));
    const Words& header = table.header();
    std::vector<std::size_t> places;
    for (const std::string& column : columns_) {
      places.push_back(static_cast<std::size_t>(std::find(header.begin(), header.end(), column) -
                                                header.begin()));
    }
    long long frames = 0;
    for (; table.next(); ++frames) {
      const Words& cells = table.cells();
      std::string row = quoted(name);
      for (const std::size_t place : places) {
        row += ',';
        row += place < header.size() ? cells[place] : "";
      }
      frames_ << row + '\n';
      for (std::size_t k = 0; k < header.size(); ++k) {
        extremes.see(header[k], cells[k]);
      }
    }
    return frames;
  }

  const Recordings& recordings_;
  replay::WholeFile frames_, summary_;
  Words columns_;
  Counts counts_;
};

}  // namespace

Counts write_overview(const Recordings& recordings, const Path& out) {
  return Overview(recordings, out).write();
}

}  // namespace replay_many
