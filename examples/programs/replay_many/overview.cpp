// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "overview.hpp"

#include <algorithm>
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

/// Escapes HTML text or an attribute value.
std::string in_html(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

/// Percent-encodes a URL path; keeps slashes.
std::string in_address(const std::string& name) {
  std::string safe;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '_' || c == '.' || c == '/';
    char code[4];
    std::snprintf(code, sizeof code, "%%%02X",
                  static_cast<unsigned>(static_cast<unsigned char>(c)));
    safe += plain ? std::string(1, c) : code;
  }
  return safe;
}

/// Maximum or minimum of columns over the frames of a recording, NaN if unknown, and its doubts.
struct Extremes {
  struct Column {
    const char* name;  ///< column in frames.csv
    bool is_least;
    const char* title;  ///< column in summary.csv
    double value = std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<Column> columns = {
      {"depth_max_mm", false, "depth_max_mm"},  {"contact_area_mm2", false, "contact_area_max_mm2"},
      {"stick_ratio", true, "stick_ratio_min"}, {"normal_force_n", false, "normal_force_max_n"},
      {"wrench_fz_n", true, "wrench_fz_min_n"}, {"preslip", false, "preslip"}};

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
      : recordings_(recordings),
        frames_(out / "all_frames.csv"),
        summary_(out / "summary.csv"),
        page_(out / "overview.html") {
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
    page_ << page_head();
    page_ << tiles_;
    page_ << "</main>\n</html>\n";
    page_.publish();
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
    add_tile(found.name, status, failure.value_or(""), frames, extremes);
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

  void add_tile(const std::string& name,
                const std::string& status,
                const std::string& reason,
                long long frames,
                const Extremes& extremes) {
    std::string tile = "<figure class=\"" + status + "\">";
    std::error_code error;
    if (status != "done") {
      tile += "<p>" + in_html(status == "failed" ? reason : "not done yet") + "</p>";
    } else if (std::filesystem::exists(recordings_.place_of(name) / "small.png", error)) {
      const std::string folder = "recordings/" + in_address(name);
      tile += "<a href=\"" + folder + "/pictures/\"><img loading=\"lazy\" alt=\"" + in_html(name) +
              "\" src=\"" + folder + "/small.png\"></a>";
    }
    tile += "<figcaption><b>" + in_html(name) + "</b> ";
    tile += status == "done" ? std::to_string(frames) + " frames" : status;
    for (const auto& column : extremes.columns) {
      if (std::isfinite(column.value)) {
        tile += std::string("<br>") + column.title + " " + in_words(column.value);
      }
    }
    tiles_ += tile + "</figcaption></figure>\n";
  }

  std::string page_head() const {
    return "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width\">\n<title>Recordings</title>\n"
           "<style>\n"
           "body { font: 14px/1.4 sans-serif; margin: 1.5em; color: #222; }\n"
           "main { display: grid; gap: 1.2em;"
           " grid-template-columns: repeat(auto-fill, minmax(260px, 1fr)); align-items: start; }\n"
           "figure { margin: 0; border-top: 3px solid #2a7; padding-top: .4em;"
           " overflow-wrap: anywhere; }\n"
           "figure.failed { border-color: #c33; } figure.left { border-color: #bbb; }\n"
           "img { max-width: 100%; max-height: 240px; }\n"
           "figcaption { color: #555; font-size: 12px; } figcaption b { color: #222; }\n"
           "</style>\n<h1>" +
           std::to_string(recordings_.all().size()) + " recordings</h1>\n<p>" +
           std::to_string(counts_.done) + " done with " + std::to_string(counts_.frames) +
           " frames, " + std::to_string(counts_.failed) + " failed, " +
           std::to_string(counts_.left) +
           " to do. <a href=\"summary.csv\">summary.csv</a>, "
           "<a href=\"all_frames.csv\">all_frames.csv</a></p>\n<main>\n";
  }

  const Recordings& recordings_;
  replay::WholeFile frames_, summary_, page_;
  Words columns_;
  std::string tiles_;
  Counts counts_;
};

}  // namespace

Counts write_overview(const Recordings& recordings, const Path& out) {
  return Overview(recordings, out).write();
}

}  // namespace replay_many
