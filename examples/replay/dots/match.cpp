// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/dots/match.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace replay {
namespace {

constexpr double cell_px = 16;
// In parts of the spacing between dots:
constexpr double growth_gate = 0.35;    // how far a spot may lie from where a dot is looked for
constexpr double largest_misfit = 0.3;  // how far a dot may lie from where its neighbours put it
constexpr double strange = 8;           // times the median is much more than usual
constexpr int around = 2;               // dots as far as this in the grid tell how a dot moves
constexpr int min_neighbours = 3;

struct Neighbour {
  cv::Vec3d place;  ///< 1, row and column from the dot in question
  cv::Vec2d move;
  double weight;
};

/// Value at the dot in question of the plane through the neighbours' moves. The slopes are held
/// back a little, so that neighbours in one line do no harm.
cv::Vec2d plane_through(const std::vector<Neighbour>& neighbours) {
  constexpr double hold = 0.05;
  cv::Matx33d normal = cv::Matx33d::diag({0, hold, hold});
  cv::Matx<double, 3, 2> right = cv::Matx<double, 3, 2>::zeros();
  for (const Neighbour& n : neighbours) {
    normal += n.weight * (n.place * n.place.t());
    right += n.weight * (n.place * n.move.t());
  }
  const cv::Matx<double, 3, 2> plane = normal.solve(right, cv::DECOMP_CHOLESKY);
  return {plane(0, 0), plane(0, 1)};
}

}  // namespace

BlobMap::BlobMap(const Blobs& blobs) : blobs_(blobs) {
  cv::Vec2d last(0, 0);
  if (!blobs.empty()) {
    origin_ = last = blobs.front();
  }
  for (const cv::Vec2d& blob : blobs) {
    origin_ = {(std::min)(origin_[0], blob[0]), (std::min)(origin_[1], blob[1])};
    last = {(std::max)(last[0], blob[0]), (std::max)(last[1], blob[1])};
  }
  cells_ = {static_cast<int>((last[0] - origin_[0]) / cell_px) + 1,
            static_cast<int>((last[1] - origin_[1]) / cell_px) + 1};
  content_.resize(static_cast<std::size_t>(cells_.area()));
  for (int k = 0; k < size(); ++k) {
    content_[cell_of((*this)[k][0], (*this)[k][1])].push_back(k);
  }
}

/// The cell at a place, or the one nearest to it.
std::size_t BlobMap::cell_of(double x_px, double y_px) const {
  const double col = std::floor((x_px - origin_[0]) / cell_px);
  const double row = std::floor((y_px - origin_[1]) / cell_px);
  const auto inside = [](double index, int count) {
    return static_cast<int>((std::min)((std::max)(index, 0.0), count - 1.0));
  };
  return static_cast<std::size_t>(inside(row, cells_.height) * cells_.width +
                                  inside(col, cells_.width));
}

BlobMap::Hit BlobMap::nearest(const cv::Vec2d& place, double reach_px) const {
  Hit hit;
  if (!is_present(place)) {
    return hit;
  }
  hit.distance_px = reach_px;
  const auto width = static_cast<std::size_t>(cells_.width);
  const std::size_t first = cell_of(place[0] - reach_px, place[1] - reach_px);
  const std::size_t last = cell_of(place[0] + reach_px, place[1] + reach_px);
  for (std::size_t row = first / width; row <= last / width; ++row) {
    for (std::size_t col = first % width; col <= last % width; ++col) {
      for (const int k : content_[row * width + col]) {
        const double distance = cv::norm((*this)[k] - place);
        if (distance <= hit.distance_px) {
          hit = {k, distance};
        }
      }
    }
  }
  return hit;
}

cv::Vec2d move_of_neighbours(const DotGrid& moves, int row, int col, double spacing_px) {
  std::vector<Neighbour> neighbours;
  neighbours.reserve((2 * around + 1) * (2 * around + 1));
  for (int i = (std::max)(row - around, 0); i <= (std::min)(row + around, moves.rows - 1); ++i) {
    for (int j = (std::max)(col - around, 0); j <= (std::min)(col + around, moves.cols - 1); ++j) {
      if ((i != row || j != col) && is_present(moves(i, j))) {
        const double distance_sq = (i - row) * (i - row) + (j - col) * (j - col);
        neighbours.push_back(
            {{1.0, double(i - row), double(j - col)}, moves(i, j), 1 / distance_sq});
      }
    }
  }
  if (neighbours.size() < static_cast<std::size_t>(min_neighbours)) {
    return no_dot();
  }
  // Once as it is; then moves that disagree with the median count less.
  std::array<std::vector<double>, 2> sorted;
  for (const Neighbour& n : neighbours) {
    sorted[0].push_back(n.move[0]);
    sorted[1].push_back(n.move[1]);
  }
  cv::Vec2d median;
  for (int c = 0; c < 2; ++c) {
    auto& values = sorted[static_cast<std::size_t>(c)];
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[c] = *middle;
  }
  for (Neighbour& n : neighbours) {
    const double off = cv::norm(n.move - median) / spacing_px;
    n.weight /= 1 + off * off * off * off;
  }
  return plane_through(neighbours);
}

DotGrid dots_of(const Labels& labels, const BlobMap& blobs) {
  DotGrid dots = no_dots(labels.size());
  for (int i = 0; i < labels.rows; ++i) {
    for (int j = 0; j < labels.cols; ++j) {
      if (labels(i, j) >= 0) {
        dots(i, j) = blobs[labels(i, j)];
      }
    }
  }
  return dots;
}

Matcher::Matcher(const DotGrid& base, const BlobMap& blobs, const Smoothness& smoothness)
    : base_(base), blobs_(blobs), smoothness_(smoothness), spacing_px_(base.size(), 0.0) {
  double sum = 0;
  int count = 0;
  for (int i = 0; i < base.rows; ++i) {
    for (int j = 0; j < base.cols; ++j) {
      double nearest = std::numeric_limits<double>::infinity();
      fingerpad::for_each_neighbour<4>(
          base, i, j, [&](fingerpad::Index, fingerpad::Index, const cv::Vec2d& other) {
            const double distance = cv::norm(other - base_(i, j));
            nearest = distance < nearest ? distance : nearest;
          });
      if (std::isfinite(nearest)) {
        spacing_px_(i, j) = nearest;
        sum += nearest;
        ++count;
      }
    }
  }
  for (double& spacing : spacing_px_) {
    spacing = spacing > 0 || count == 0 ? spacing : sum / count;
  }
}

cv::Vec2d Matcher::move_of(const Labels& labels, int row, int col) const {
  return labels(row, col) >= 0 ? cv::Vec2d(blobs_[labels(row, col)] - base_(row, col)) : no_dot();
}

cv::Vec2d Matcher::expected(const Labels& labels, int row, int col) const {
  DotGrid moves = no_dots({2 * around + 1, 2 * around + 1});
  for (int i = -around; i <= around; ++i) {
    for (int j = -around; j <= around; ++j) {
      const cv::Point at(col + j, row + i);
      if (cv::Rect(cv::Point(0, 0), labels.size()).contains(at)) {
        moves(i + around, j + around) = move_of(labels, at.y, at.x);
      }
    }
  }
  return base_(row, col) + move_of_neighbours(moves, around, around, spacing_px_(row, col));
}

Labels Matcher::match(const cv::Mat_<uchar>& seeds, const DotGrid& moves) const {
  Labels labels = seed(seeds, moves);
  drop_misfits(labels);
  // What was dropped may grow again, and better, from what stayed.
  constexpr int max_rounds = 5;
  int count = -1;
  for (int round = 0; round < max_rounds; ++round) {
    grow(labels);
    drop_misfits(labels);
    const int now = cv::countNonZero(labels >= 0);
    if (now == count) {
      break;
    }
    count = now;
  }
  drop_strangers(labels);
  return labels;
}

/// Seeds whose spot is in reach; two that claim the same spot both lose it.
Labels Matcher::seed(const cv::Mat_<uchar>& seeds, const DotGrid& moves) const {
  Labels labels(base_.size(), -1);
  std::vector<int> claims(static_cast<std::size_t>(blobs_.size()), 0);
  for (int i = 0; i < base_.rows; ++i) {
    for (int j = 0; j < base_.cols; ++j) {
      if (seeds(i, j) != 0) {
        const auto hit = blobs_.nearest(base_(i, j) + moves(i, j), growth_gate * spacing_px_(i, j));
        labels(i, j) = hit.blob;
        if (hit.blob >= 0) {
          ++claims[static_cast<std::size_t>(hit.blob)];
        }
      }
    }
  }
  for (int& label : labels) {
    label = label >= 0 && claims[static_cast<std::size_t>(label)] == 1 ? label : -1;
  }
  return labels;
}

/// Dots with many labelled neighbours come first: where they are is known best.
void Matcher::grow(Labels& labels) const {
  constexpr int most = 5;
  constexpr int least = 2;
  for (int wanted = most; wanted >= least;) {
    wanted = grow_once(labels, wanted) ? most : wanted - 1;
  }
}

bool Matcher::may_grow(const Labels& labels, int row, int col, int wanted) const {
  if (labels(row, col) >= 0 || !is_present(base_(row, col))) {
    return false;
  }
  int count = 0;
  for (int i = (std::max)(row - 1, 0); i <= (std::min)(row + 1, labels.rows - 1); ++i) {
    for (int j = (std::max)(col - 1, 0); j <= (std::min)(col + 1, labels.cols - 1); ++j) {
      count += labels(i, j) >= 0 ? 1 : 0;
    }
  }
  return count >= wanted;
}

bool Matcher::grow_once(Labels& labels, int wanted) const {
  struct Claim {
    double distance;
    cv::Point dot;
    int blob;
  };
  std::vector<Claim> claims;
  for (int i = 0; i < labels.rows; ++i) {
    for (int j = 0; j < labels.cols; ++j) {
      if (may_grow(labels, i, j, wanted)) {
        const double gate_px = growth_gate * spacing_px_(i, j);
        const auto hit = blobs_.nearest(expected(labels, i, j), gate_px);
        if (hit.blob >= 0) {
          claims.push_back({hit.distance_px, {j, i}, hit.blob});
        }
      }
    }
  }
  std::vector<char> taken(static_cast<std::size_t>(blobs_.size()), 0);
  for (const int label : labels) {
    if (label >= 0) {
      taken[static_cast<std::size_t>(label)] = 1;
    }
  }
  std::sort(claims.begin(), claims.end(),
            [](const Claim& a, const Claim& b) { return a.distance < b.distance; });
  bool grown = false;
  for (const Claim& claim : claims) {
    char& is_taken = taken[static_cast<std::size_t>(claim.blob)];
    if (is_taken == 0) {
      labels(claim.dot) = claim.blob;
      is_taken = 1;
      grown = true;
    }
  }
  return grown;
}

double Matcher::misfit(const Labels& labels, int row, int col) const {
  const cv::Vec2d where = expected(labels, row, col);
  return is_present(where) ? cv::norm(blobs_[labels(row, col)] - where) / spacing_px_(row, col)
                           : std::numeric_limits<double>::infinity();
}

/// Takes away what fits much worse than most: half a dot beside a shadow, or the shadow itself.
void Matcher::drop_strangers(Labels& labels) const {
  cv::Mat_<double> misfits(labels.size(), 0.0);
  std::vector<double> sorted;
  for (int i = 0; i < labels.rows; ++i) {
    for (int j = 0; j < labels.cols; ++j) {
      if (labels(i, j) >= 0) {
        misfits(i, j) = misfit(labels, i, j);
        sorted.push_back(misfits(i, j));
      }
    }
  }
  if (sorted.empty()) {
    return;
  }
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double limit = (std::max)(smoothness_.min_strange, strange * *middle);
  for (int i = 0; i < labels.rows; ++i) {
    for (int j = 0; j < labels.cols; ++j) {
      labels(i, j) = misfits(i, j) > limit ? -1 : labels(i, j);
    }
  }
}

/// Takes labels away until every dot lies where its neighbours put it, the worst first.
void Matcher::drop_misfits(Labels& labels) const {
  cv::Mat_<double> misfits(labels.size(), 0.0);
  const auto measure = [&](int i, int j) {
    misfits(i, j) = labels(i, j) >= 0 ? misfit(labels, i, j) : 0.0;
  };
  for (int i = 0; i < labels.rows; ++i) {
    for (int j = 0; j < labels.cols; ++j) {
      measure(i, j);
    }
  }
  while (true) {
    double worst = 0;
    cv::Point where;
    cv::minMaxLoc(misfits, nullptr, &worst, nullptr, &where);
    if (worst <= largest_misfit) {
      return;
    }
    labels(where) = -1;
    for (int i = (std::max)(where.y - around, 0);
         i <= (std::min)(where.y + around, labels.rows - 1); ++i) {
      for (int j = (std::max)(where.x - around, 0);
           j <= (std::min)(where.x + around, labels.cols - 1); ++j) {
        measure(i, j);
      }
    }
  }
}

double Matcher::score(const Labels& labels) const {
  constexpr double cost_of_misfit = 0.5;
  constexpr double cost_of_move = 0.003;
  double sum = 0;
  for (int i = 0; i < labels.rows; ++i) {
    for (int j = 0; j < labels.cols; ++j) {
      if (labels(i, j) < 0) {
        continue;
      }
      const double off = misfit(labels, i, j) / largest_misfit;
      const double move = cv::norm(move_of(labels, i, j)) / spacing_px_(i, j);
      sum += 1 - cost_of_misfit * (std::min)(off * off, 1.0) -
             cost_of_move * (std::min)(move * move, 10.0);
    }
  }
  return sum;
}

}  // namespace replay
