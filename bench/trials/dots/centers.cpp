// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Errors of dots found in pictures whose truth is known: mean and standard deviation along the
// radius and around, by load, for the printed grid and each row of side dots, and how many labels
// are wrong. Usage: centers RECORDING..., folders with truth/dots.csv and truth/side_dots_px.csv.
// Prints a table; fails if a label is wrong.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/dots/dot_finder.hpp"
#include "fingerpad/dots/dot_follower.hpp"
#include "fingerpad/dots/side_dots.hpp"

using namespace fingerpad;
namespace fs = std::filesystem;

namespace {

using Point = Point2<double>;
constexpr double wrong_px = 4;  // less than half of the least spacing of these prints

cv::Mat_<float> light_of(const cv::Mat& image) {
  cv::Mat levels;
  image.convertTo(levels, CV_32F, image.depth() == CV_16U ? 1.0 / 256 : 1);
  cv::Mat_<float> light;
  cv::transform(levels, light, cv::Matx13f(0, 0.5F, 0.5F));
  return light;
}

/// What the red sites of a raw mosaic see: red at every second pixel of every second row.
cv::Mat_<float> red_sites(const cv::Mat& image) {
  cv::Mat red, levels;
  cv::extractChannel(image, red, 2);
  red.convertTo(levels, CV_32F, image.depth() == CV_16U ? 1.0 / 256 : 1);
  cv::Mat_<float> sites;
  cv::resize(levels, sites, levels.size() / 2, 0, 0, cv::INTER_NEAREST);
  return sites;
}

/// Numbers of a table by its first column, without the header.
std::map<int, std::vector<std::vector<double>>> read(const fs::path& file) {
  std::ifstream in(file);
  std::map<int, std::vector<std::vector<double>>> rows;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<double> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      row.push_back(std::atof(cell.c_str()));
    }
    rows[int(row[0])].push_back(row);
  }
  return rows;
}

/// Mean and standard deviation.
struct Spread {
  double count = 0, sum = 0, squares = 0;
  void add(double value) {
    ++count;
    sum += value;
    squares += value * value;
  }
  double mean() const { return sum / count; }
  double sd() const { return std::sqrt((std::max)(squares / count - square(mean()), 0.0)); }
};

constexpr std::array<const char*, 3> loads = {"free", "to half", "loaded"};

/// Of one kind of dots in the pictures of one camera.
struct Errors {
  std::array<Spread, loads.size()> along = {}, around = {};
  int all = 0, wrong = 0;

  void add(const Point& found, const Point& truth, const Point& middle, std::size_t load) {
    ++all;
    if (!is_finite(found)) {
      return;
    }
    const Point arm = truth - middle, off = found - truth;
    const Point out = norm(arm) > 0 ? arm / norm(arm) : Point{1, 0};
    if (norm(off) > wrong_px) {
      ++wrong;
    } else {
      along[load].add(dot(off, out));
      around[load].add(out.x * off.y - out.y * off.x);
    }
  }
  void print(const std::string& name) const {
    double found = 0, squares = 0;
    for (std::size_t k = 0; k < loads.size(); ++k) {
      found += along[k].count;
      squares += along[k].squares + around[k].squares;
    }
    std::printf("| %s | %.1f | %d |", name.c_str(), 100 * found / all, wrong);
    for (std::size_t k = 0; k < loads.size(); ++k) {
      std::printf(" %+.3f, %.3f | %+.3f, %.3f |", along[k].mean(), along[k].sd(), around[k].mean(),
                  around[k].sd());
    }
    std::printf(" %.4f |\n", std::sqrt(squares / found / 2));
  }
};

struct Recording {
  fs::path folder;
  Camera<double> camera;
  std::vector<SideRow> rows;
  double base_mm = 0, pitch_mm = 0, diameter_mm = 0;
  cv::Mat reference, depth_mm;
  std::vector<cv::Mat> frames;
  std::vector<double> load_n;
  std::map<int, std::vector<std::vector<double>>> dots, side;

  explicit Recording(const fs::path& from) : folder(from) {
    const auto json = nlohmann::json::parse(std::ifstream(folder / "sensor.json"));
    const auto& c = json["camera"];
    camera = {.plate_distance_mm = c["plate_distance_mm"],
              .refractive_index = c["refractive_index"],
              .center_x_px = c["center_px"][0],
              .center_y_px = c["center_px"][1]};
    const auto& pitch = c["pitch_mm"];
    camera.pitch_mm = pitch.is_array() ? pitch[0].get<double>() : pitch.get<double>();
    camera.pixel_aspect = pitch.is_array() ? pitch[1].get<double>() / camera.pitch_mm : 1.0;
    if (c.contains("distortion")) {
      camera.distortion_k1 = c["distortion"][0];
      camera.distortion_k2 = c["distortion"][1];
    }
    base_mm = json["pad"]["base_radius_mm"];
    pitch_mm = json["dots"]["pitch_mm"];
    diameter_mm = json["dots"]["diameter_mm"];
    const auto& s = json["rim"]["side_dots"];
    for (std::size_t r = 0; r < s["arc_mm"].size(); ++r) {
      rows.push_back({s["count"], s["arc_mm"][r], s["diameter_mm"], s["first_angle_rad"][r]});
    }
    reference = cv::imread(folder / "reference.png", cv::IMREAD_UNCHANGED);
    depth_mm = cv::imread(folder / "reference_depth.tiff", cv::IMREAD_UNCHANGED);
    dots = read(folder / "truth/dots.csv");
    side = read(folder / "truth/side_dots_px.csv");
    const auto forces = read(folder / "truth/forces.csv");
    for (const auto& [k, of] : forces) {
      char name[16];
      std::snprintf(name, sizeof name, "%06d.png", k);
      frames.push_back(cv::imread(folder / "frames" / name, cv::IMREAD_UNCHANGED));
      load_n.push_back(std::hypot(of[0][1], of[0][2], of[0][3]));
    }
  }

  DotFinder finder(const SideDots& beside) const {
    DotFinderOptions o;
    o.where = depth_mm > 0;
    for (const Point& dot : beside.free_px()) {
      if (is_finite(dot)) {
        cv::circle(o.where, cv::Point(cvRound(dot.x), cvRound(dot.y)), cvCeil(beside.reach_px()), 0,
                   cv::FILLED);
      }
    }
    const double mean_mm = cv::mean(depth_mm, o.where)[0];
    const auto x_px = [&](double x) { return pixel_of(camera, Point3<double>{x, 0, mean_mm}).x; };
    const double px_per_mm = x_px(0.5) - x_px(-0.5);
    o.pattern = {21,
                 21,
                 diameter_mm / 2 * px_per_mm,
                 pitch_mm * px_per_mm,
                 false,
                 {camera.center_x_px, camera.center_y_px}};
    o.color_weights = {0, 1, 1};
    return DotFinder(reference, o);
  }
};

using Grid = cv::Mat_<cv::Vec2d>;

void compare(const Grid& found,
             const std::vector<std::vector<double>>& truth,
             const Point& middle,
             std::size_t load,
             Errors& to) {
  for (const auto& row : truth) {
    const cv::Vec2d& at = found(int(row[1]), int(row[2]));
    to.add({at[0], at[1]}, {row[3], row[4]}, middle, load);
  }
}

/// How many labels of the finder are wrong if the whole picture jumps between two frames.
int jumps(const Recording& r, const DotFinder& finder) {
  const double pitch_px = finder.pattern().pitch_px;
  int wrong = 0, ok = 0, all = 0, labels = 0;
  for (int eighth = 0; eighth <= 16; ++eighth) {
    for (const double angle : {0.0, 0.6, 1.5707963}) {
      DotFinder f = finder;
      Grid dots(21, 21);
      for (std::size_t k = 0; k < r.frames.size(); k += 8) {
        const bool moved = (k / 8) % 2 == 1;
        const double by = moved ? pitch_px * eighth / 8 : 0;
        const Point shift = {std::round(by * std::cos(angle)), std::round(by * std::sin(angle))};
        cv::Mat frame;
        cv::warpAffine(r.frames[k], frame, cv::Matx23d(1, 0, shift.x, 0, 1, shift.y),
                       r.frames[k].size(), cv::INTER_NEAREST);
        ++all;
        if (f(frame, dots).ok()) {
          ++ok;
          for (const auto& row : r.dots.at(int(k))) {
            const cv::Vec2d& at = dots(int(row[1]), int(row[2]));
            const Point off = Point{at[0], at[1]} - Point{row[3], row[4]} - shift;
            labels += is_finite(off) ? 1 : 0;
            wrong += norm(off) > wrong_px ? 1 : 0;
          }
        }
      }
    }
  }
  std::printf("%s: jumps of 0 to 2 pitches: %d of %d frames ok, %d of %d labels wrong\n",
              r.folder.filename().c_str(), ok, all, wrong, labels);
  return wrong;
}

/// Follows the dots of a recording through each, every second and every fourth frame.
int look_at(const Recording& r, std::map<std::string, Errors>& errors) {
  const Point middle = {r.camera.center_x_px, r.camera.center_y_px};
  const SideDots side(light_of(r.reference), r.camera, r.base_mm, r.rows);
  DotFinder finder = r.finder(side);
  const std::string folder = r.folder.filename(), camera = folder.substr(0, folder.find('-'));
  if (!side.ok() || !finder.ok()) {
    std::fprintf(stderr, "%s: %s %s\n", folder.c_str(), side.refusal().c_str(),
                 finder.refusal().c_str());
    return 1;
  }
  const DotFollower free(light_of(r.reference), finder.free_px(),
                         {.radius_px = finder.pattern().radius_px});
  Grid free_sites(21, 21);
  for (int i = 0; i < 21; ++i) {
    for (int j = 0; j < 21; ++j) {
      free_sites(i, j) = {finder.free_px()(i, j).x / 2, finder.free_px()(i, j).y / 2};
    }
  }
  const DotFollower raw(red_sites(r.reference), free_sites,
                        {.radius_px = finder.pattern().radius_px / 2});
  const double most_n = *std::max_element(r.load_n.begin(), r.load_n.end());
  const DotFinder start = finder;
  for (const int step : {1, 2, 4}) {
    const auto of = [&](const std::string& dots) -> Errors& {
      return errors[camera + " | " + dots + " | " + std::to_string(step)];
    };
    DotFollower follower = free, of_sites = raw;
    SideDots rings = side;
    finder = start;
    Grid dots(21, 21), found(21, 21);
    for (std::size_t k = 0; k < r.frames.size(); k += std::size_t(step)) {
      const std::size_t load = r.load_n[k] < 0.05 * most_n ? 0 : r.load_n[k] < 0.5 * most_n ? 1 : 2;
      const auto& truth = r.dots.at(int(k));
      const cv::Mat_<float> light = light_of(r.frames[k]);
      found.setTo(cv::Scalar::all(std::nan("")));
      const bool is_found = finder(r.frames[k], found).ok();
      compare(found, truth, middle, load, of("grid, DotFinder"));
      if (follower(light, dots).status == DotFollowerStatus::lost && is_found) {
        dots = found.clone();
        (void)follower.restart(light, dots);
      }
      compare(dots, truth, middle, load, of("grid"));
      (void)of_sites(red_sites(r.frames[k]), found);
      compare(Grid(2 * found), truth, middle, load, of("grid, red sites"));
      (void)rings(light);
      std::size_t at = 0;
      for (const SideRow& row : r.rows) {
        Errors& to = of(detail::print("row at %g mm", row.arc_mm));
        for (Index i = 0; i < row.count; ++i, ++at) {
          const auto& place = r.side.at(int(k))[at];
          to.add(rings.px()[at], {place[2], place[3]}, middle, load);
        }
      }
    }
  }
  return jumps(r, start);
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  std::map<std::string, Errors> errors;
  int wrong = 0;
  for (int k = 1; k < argc; ++k) {
    wrong += look_at(Recording(argv[k]), errors);
  }
  std::printf("\n| pictures | dots | every | found, %% | wrong |");
  for (const char* load : loads) {
    std::printf(" %s: along: bias, sd, px | around |", load);
  }
  std::printf(" rms |\n|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  for (const auto& [name, of] : errors) {
    of.print(name);
    wrong += of.wrong;
  }
  return wrong == 0 ? 0 : 1;
}
