// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/dots/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <queue>
#include <utility>
#include <vector>

#include "replay/dots/match.hpp"

namespace replay {
namespace {

constexpr int min_dots = 9;              // fewer in order are chance
constexpr std::size_t max_spots = 1200;  // more are the grain of the picture
// In parts of the distance between neighbours:
constexpr double max_uneven = 0.15;  // of a typical dot, from the middle of its neighbours
constexpr double alike = 0.2;        // two steps are the same
constexpr double reach = 0.42;       // how far a spot may lie from where it is looked for

using Step = cv::Vec2d;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double cross(const Step& a, const Step& b) {
  return a[0] * b[1] - a[1] * b[0];
}

/// From each spot to its nearest ones, each step once and to the right or down.
std::vector<Step> steps_between(const Blobs& spots) {
  constexpr std::size_t nearest = 6;
  std::vector<Step> steps;
  std::vector<Step> around;
  for (std::size_t k = 0; k < spots.size(); ++k) {
    around.clear();
    for (std::size_t other = 0; other < spots.size(); ++other) {
      if (other != k) {
        around.push_back(spots[other] - spots[k]);
      }
    }
    const auto last =
        around.begin() + static_cast<std::ptrdiff_t>(std::min(nearest, around.size()));
    std::partial_sort(around.begin(), last, around.end(),
                      [](const Step& a, const Step& b) { return a.dot(a) < b.dot(b); });
    for (auto step = around.begin(); step != last; ++step) {
      steps.push_back((*step)[0] + (*step)[1] > 0 ? *step : Step(-*step));
    }
  }
  return steps;
}

struct CommonStep {
  Step step{0, 0};
  int count = 0;
};

/// The step that most of `steps` are like, or the opposite of, among those that `allowed` lets
/// through.
template <class Allowed>
CommonStep max_common(const std::vector<Step>& steps, const Allowed& allowed) {
  CommonStep best;
  for (const Step& one : steps) {
    if (!allowed(one)) {
      continue;
    }
    const double near = alike * cv::norm(one);
    Step sum(0, 0);
    int count = 0;
    for (const Step& other : steps) {
      const Step same_way = other.dot(one) < 0 ? Step(-other) : other;
      if (cv::norm(same_way - one) < near) {
        sum += same_way;
        ++count;
      }
    }
    if (count > best.count) {
      best = {sum / count, count};
    }
  }
  return best;
}

/// Along the rows and along the columns of a grid, from a dot to the next.
struct Steps {
  Step right{0, 0};
  Step down{0, 0};
};

std::optional<Steps> steps_of(const Blobs& spots) {
  const std::vector<Step> all = steps_between(spots);
  const CommonStep first = max_common(all, [](const Step&) { return true; });
  const CommonStep second = max_common(all, [&](const Step& step) {
    const double length = cv::norm(step);
    return std::abs(step.dot(first.step)) < 0.5 * length * cv::norm(first.step) &&
           length < 2 * cv::norm(first.step);
  });
  if (second.count < 2) {
    return std::nullopt;
  }
  const bool first_is_right = std::abs(first.step[0]) * cv::norm(second.step) >=
                              std::abs(second.step[0]) * cv::norm(first.step);
  Steps steps = first_is_right ? Steps{first.step, second.step} : Steps{second.step, first.step};
  steps.right *= steps.right[0] < 0 ? -1 : 1;
  steps.down *= cross(steps.right, steps.down) < 0 ? -1 : 1;
  return steps;
}

/// Names spots from one dot outward, the best fitting first. Steps follow the grid as it bends.
class Growth {
 public:
  Growth(const BlobMap& spots, const Steps& steps)
      : spots_(spots), steps_(steps), taken_(static_cast<std::size_t>(spots.size()), 0) {}

  /// Column and row of each named spot, from the seed.
  const std::map<std::pair<int, int>, int>& from(int seed) {
    name({{0, 0}, seed, steps_, 0});
    while (!open_.empty()) {
      const Claim best = open_.top();
      open_.pop();
      if (named_.count(best.at) == 0 && taken_[static_cast<std::size_t>(best.spot)] == 0) {
        name(best);
      }
    }
    return named_;
  }

 private:
  struct Claim {
    std::pair<int, int> at;
    int spot;
    Steps steps;
    double misfit;
    bool operator<(const Claim& other) const { return misfit > other.misfit; }
  };

  void name(const Claim& claim) {
    named_[claim.at] = claim.spot;
    taken_[static_cast<std::size_t>(claim.spot)] = 1;
    for (const int sign : {1, -1}) {
      look(claim, sign, true);
      look(claim, sign, false);
    }
  }

  void look(const Claim& from, int sign, bool along_row) {
    Steps steps = from.steps;
    Step& step = along_row ? steps.right : steps.down;
    const double length = cv::norm(step);
    const auto hit = spots_.nearest(spots_[from.spot] + sign * step, reach * length);
    if (hit.blob < 0) {
      return;
    }
    step = 0.5 * step + 0.5 * sign * (spots_[hit.blob] - spots_[from.spot]);
    const std::pair<int, int> at(from.at.first + (along_row ? sign : 0),
                                 from.at.second + (along_row ? 0 : sign));
    open_.push({at, hit.blob, steps, hit.distance_px / length});
  }

  const BlobMap& spots_;
  Steps steps_;
  std::vector<char> taken_;
  std::map<std::pair<int, int>, int> named_;
  std::priority_queue<Claim> open_;
};

/// The spot with a neighbour on all four sides, or on as many as there are, that is nearest to the
/// middle.
int best_seed(const Blobs& spots, const BlobMap& map, const Steps& steps) {
  cv::Vec2d middle(0, 0);
  for (const cv::Vec2d& spot : spots) {
    middle += spot / static_cast<double>(spots.size());
  }
  int best = 0;
  double best_score = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < map.size(); ++k) {
    double score = -1e-4 * cv::norm(map[k] - middle);
    for (const Step& step : {steps.right, steps.down, Step(-steps.right), Step(-steps.down)}) {
      score += map.nearest(map[k] + step, alike * cv::norm(step)).blob >= 0 ? 1 : 0;
    }
    if (score > best_score) {
      best = k;
      best_score = score;
    }
  }
  return best;
}

int dots_in(const DotGrid& grid) {
  return static_cast<int>(fingerpad::count_present(grid));
}

/// Without the outer rows and columns that hold a single dot: no one knows whether it belongs.
DotGrid without_single_dots(DotGrid grid) {
  while (!grid.empty()) {
    const cv::Rect all(cv::Point(0, 0), grid.size());
    const cv::Rect trials[] = {{0, 1, all.width, all.height - 1},
                               {0, 0, all.width, all.height - 1},
                               {1, 0, all.width - 1, all.height},
                               {0, 0, all.width - 1, all.height}};
    const auto poor =
        std::find_if(std::begin(trials), std::end(trials), [&](const cv::Rect& trial) {
          return dots_in(grid) - (trial.empty() ? 0 : dots_in(DotGrid(grid, trial))) < 2;
        });
    if (poor == std::end(trials)) {
      break;
    }
    grid = poor->empty() ? DotGrid() : DotGrid(grid, *poor).clone();
  }
  return grid;
}

double pitch_of(const DotGrid& grid) {
  std::vector<double> lengths;
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.cols; ++j) {
      for (const cv::Point to : {cv::Point(j + 1, i), cv::Point(j, i + 1)}) {
        if (to.x < grid.cols && to.y < grid.rows && is_present(grid(i, j)) &&
            is_present(grid(to))) {
          lengths.push_back(cv::norm(grid(to) - grid(i, j)));
        }
      }
    }
  }
  return lengths.empty() ? 0 : median(lengths);
}

/// How far a typical dot lies from the middle between its neighbours on both sides, in pitches.
/// Spots at random can be named like a grid, but lie anywhere.
double unevenness(const DotGrid& grid) {
  std::vector<double> off;
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.cols; ++j) {
      for (const cv::Point step : {cv::Point(1, 0), cv::Point(0, 1)}) {
        const cv::Point at(j, i);
        const cv::Rect all(cv::Point(0, 0), grid.size());
        if (all.contains(at - step) && all.contains(at + step)) {
          const cv::Vec2d bend = grid(at - step) / 2 + grid(at + step) / 2 - grid(at);
          if (is_present(bend)) {
            off.push_back(cv::norm(bend));
          }
        }
      }
    }
  }
  return off.empty() ? 0.0 : median(off) / pitch_of(grid);
}

/// Rows x cols of a grid, or of the places around it, that hold the most dots; of several such the
/// first.
DotGrid window_of(const DotGrid& grid, cv::Size size) {
  DotGrid best = no_dots(size);
  int most = -1;
  for (int top = (std::min)(0, grid.rows - size.height);
       top <= (std::max)(0, grid.rows - size.height); ++top) {
    for (int left = (std::min)(0, grid.cols - size.width);
         left <= (std::max)(0, grid.cols - size.width); ++left) {
      const cv::Rect shared = cv::Rect({left, top}, size) & cv::Rect(cv::Point(0, 0), grid.size());
      const int count = dots_in(DotGrid(grid, shared));
      // A grid with fewer rows than there are lies at their beginning.
      if (count > most || (count == most && left <= 0 && top <= 0)) {
        most = count;
        best = no_dots(size);
        DotGrid(grid, shared).copyTo(best(shared - cv::Point(left, top)));
      }
    }
  }
  return best;
}

/// The grid as the plane through all its dots has it.
DotGrid flat(const DotGrid& grid) {
  cv::Matx33d normal = cv::Matx33d::zeros();
  cv::Matx<double, 3, 2> right = cv::Matx<double, 3, 2>::zeros();
  const auto place = [](int i, int j) { return cv::Vec3d(1, i, j); };
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.cols; ++j) {
      if (is_present(grid(i, j))) {
        normal += place(i, j) * place(i, j).t();
        right += place(i, j) * grid(i, j).t();
      }
    }
  }
  const cv::Matx<double, 3, 2> plane = normal.solve(right, cv::DECOMP_SVD);
  DotGrid all(grid.size());
  for (int i = 0; i < grid.rows; ++i) {
    for (int j = 0; j < grid.cols; ++j) {
      const cv::Matx12d at = place(i, j).t() * plane;
      all(i, j) = {at(0), at(1)};
    }
  }
  return all;
}

struct Attempt {
  SpotLook look;
  DotGrid grid;
  TypicalSpot spot;
  double score = 0;
};

/// Many dots, few spots that are none, and dark ones: the blocks of a compressed picture lie in a
/// grid, too, but are faint.
Attempt attempt(const cv::Mat& image, const SpotLook& look) {
  const BlobFinder finder(image.size(), look);
  const Blobs spots = finder.find(image);
  Attempt one{look, lattice_of(spots), {}, 0};
  if (!one.grid.empty()) {
    Blobs dots;
    std::copy_if(one.grid.begin(), one.grid.end(), std::back_inserter(dots),
                 [](const cv::Vec2d& dot) { return is_present(dot); });
    one.spot = finder.typical(image, dots);
    const auto count = static_cast<double>(dots.size());
    one.score =
        count * count / static_cast<double>(spots.size()) * one.spot.darkness * one.spot.darkness;
  }
  return one;
}

/// With radius and pitch as they rotated out to be, where that finds as many dots.
Attempt refined(const cv::Mat& image, Attempt one, const DotPattern& given) {
  constexpr int rounds = 2;
  for (int round = 0; round < rounds && !one.grid.empty(); ++round) {
    SpotLook look = one.look;
    look.pitch_px = pitch_of(one.grid);
    const double radius_px = given.diameter_px > 0 ? given.diameter_px / 2 : one.spot.radius_px;
    look.radius_px = (std::min)((std::max)(radius_px, 1.0), 0.4 * look.pitch_px);
    const Attempt next = attempt(image, look);
    if (next.score < 0.9 * one.score) {
      break;
    }
    one = next;
  }
  return one;
}

}  // namespace

DotGrid lattice_of(const Blobs& spots) {
  if (spots.size() < static_cast<std::size_t>(min_dots) || spots.size() > max_spots) {
    return {};
  }
  const auto steps = steps_of(spots);
  if (!steps) {
    return {};
  }
  const BlobMap map(spots);
  Growth growth(map, *steps);
  const auto& named = growth.from(best_seed(spots, map, *steps));
  cv::Point first(0, 0);
  cv::Point last(0, 0);
  for (const auto& [at, spot] : named) {
    first = {(std::min)(first.x, at.first), (std::min)(first.y, at.second)};
    last = {(std::max)(last.x, at.first), (std::max)(last.y, at.second)};
  }
  DotGrid grid = no_dots(cv::Size(last - first) + cv::Size(1, 1));
  for (const auto& [at, spot] : named) {
    grid(at.second - first.y, at.first - first.x) = map[spot];
  }
  grid = without_single_dots(grid);
  return dots_in(grid) < min_dots || unevenness(grid) > max_uneven ? DotGrid() : grid;
}

std::optional<FoundPattern> find_pattern(const cv::Mat& image, const DotPattern& given) {
  constexpr double smallest_px = 1.5;
  constexpr double step = 1.4;
  const double largest_px = (std::min)(image.cols, image.rows) / 12.0;
  Attempt best;
  for (double radius_px = smallest_px; radius_px <= largest_px; radius_px *= step) {
    for (const bool bright : {false, true}) {
      if (bright != given.bright.value_or(bright)) {
        continue;
      }
      constexpr double usual_pitch = 5;  // radii
      const double radius = given.diameter_px > 0 ? given.diameter_px / 2 : radius_px;
      const Attempt one = attempt(image, {radius, usual_pitch * radius, bright});
      if (one.score > best.score) {
        best = one;
      }
    }
    if (given.diameter_px > 0) {
      break;
    }
  }
  best = refined(image, best, given);
  if (best.grid.empty()) {
    return std::nullopt;
  }
  if (given.rows > 0) {
    best.grid = window_of(best.grid, {given.cols, given.rows});
  }
  if (dots_in(best.grid) < min_dots) {
    return std::nullopt;
  }
  return FoundPattern{{best.grid, flat(best.grid)}, best.look};
}

}  // namespace replay
