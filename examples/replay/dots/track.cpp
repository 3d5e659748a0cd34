// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/dots/track.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <vector>

namespace replay {
namespace {

constexpr double longest_leap = 3.5;  // pitches that a dot may move from one frame to the next
// Shares of the spots that labels explain:
constexpr double nearly_all = 0.99;    // nothing better is looked for
constexpr double max_of_all = 0.96;    // with less, leaps are tried
constexpr double min_explained = 0.9;  // with less, the labels do not count

struct Guess {
  Labels labels;
  int count = 0;
  double score = 0;
};

/// The dots of `dots` that lack one of eight neighbours.
cv::Mat_<uchar> border_of(const DotGrid& dots) {
  cv::Mat_<uchar> border(dots.size(), uchar{0});
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      const auto nothing = [](fingerpad::Index, fingerpad::Index, const cv::Vec2d&) {};
      border(i, j) =
          is_present(dots(i, j)) && fingerpad::for_each_neighbour(dots, i, j, nothing) < 8 ? 1 : 0;
    }
  }
  return border;
}

/// `found` where it is known. Elsewhere `base`, moved as the neighbours of the dot have moved.
DotGrid filled(const DotGrid& found, const DotGrid& base, const DotGrid& otherwise) {
  DotGrid moves(found.size());
  for (int i = 0; i < found.rows; ++i) {
    for (int j = 0; j < found.cols; ++j) {
      moves(i, j) = found(i, j) - base(i, j);
    }
  }
  DotGrid all = found.clone();
  for (int i = 0; i < found.rows; ++i) {
    for (int j = 0; j < found.cols; ++j) {
      if (!is_present(found(i, j))) {
        const cv::Vec2d guess = base(i, j) + move_of_neighbours(moves, i, j, 10);
        all(i, j) = is_present(guess) ? guess : otherwise(i, j);
      }
    }
  }
  return all;
}

/// The dot of `dots` that is nearest to the middle of them all.
cv::Point middle_of(const DotGrid& dots) {
  cv::Vec2d sum(0, 0);
  int count = 0;
  for (const cv::Vec2d& dot : dots) {
    if (is_present(dot)) {
      sum += dot;
      ++count;
    }
  }
  cv::Point middle(0, 0);
  double distance = std::numeric_limits<double>::infinity();
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      const double here = cv::norm(dots(i, j) - sum / count);
      if (here < distance) {
        distance = here;
        middle = {j, i};
      }
    }
  }
  return middle;
}

/// The dot and its eight neighbours.
cv::Mat_<uchar> around_middle(cv::Size size, cv::Point middle) {
  cv::Mat_<uchar> seeds(size, uchar{0});
  const cv::Rect box(middle - cv::Point(1, 1), middle + cv::Point(2, 2));
  seeds(box & cv::Rect(cv::Point(0, 0), size)) = 1;
  return seeds;
}

/// The spots within reach of a place, the nearest first.
Blobs nearest_first(const Blobs& blobs, const cv::Vec2d& place, double reach_px) {
  Blobs near;
  std::copy_if(blobs.begin(), blobs.end(), std::back_inserter(near),
               [&](const cv::Vec2d& blob) { return cv::norm(blob - place) <= reach_px; });
  std::sort(near.begin(), near.end(), [&](const cv::Vec2d& a, const cv::Vec2d& b) {
    return cv::norm(a - place) < cv::norm(b - place);
  });
  return near;
}

/// Dots about which a guess that does nearly as well disagrees are not found.
void drop_doubtful(Guess& best, const std::vector<Guess>& guesses) {
  constexpr double nearly = 0.985;
  for (const Guess& other : guesses) {
    if (other.score < nearly * best.score) {
      continue;
    }
    for (int i = 0; i < best.labels.rows; ++i) {
      for (int j = 0; j < best.labels.cols; ++j) {
        const int label = other.labels(i, j);
        if (label >= 0 && best.labels(i, j) >= 0 && label != best.labels(i, j)) {
          best.labels(i, j) = -1;
        }
      }
    }
  }
}

}  // namespace

DotTracker::DotTracker(const FirstOrder& free_pad, const Smoothness& smoothness)
    : smoothness_(smoothness),
      free_(filled(free_pad.found, free_pad.expected, free_pad.expected)),
      last_(free_.clone()),
      velocity_(free_.size(), cv::Vec2d(0, 0)),
      border_(border_of(free_pad.found)),
      middle_(middle_of(free_pad.found)),
      count_(static_cast<int>(fingerpad::count_present(free_pad.found))) {}

DotGrid DotTracker::track(const Blobs& blobs) {
  const BlobMap map(blobs);
  const Matcher from_last(last_, map, smoothness_);
  const Matcher from_free(free_, map, smoothness_);
  const cv::Mat_<uchar> everywhere(free_.size(), uchar{1});
  const DotGrid at_rest(free_.size(), cv::Vec2d(0, 0));
  const int most = (std::min)(count_, map.size());
  std::vector<Guess> guesses;
  const auto guess = [&](const Matcher& matcher, const cv::Mat_<uchar>& seeds,
                         const DotGrid& moves) {
    Guess next;
    next.labels = matcher.match(seeds, moves);
    next.count = cv::countNonZero(next.labels >= 0);
    next.score = from_free.score(next.labels);
    guesses.push_back(next);
  };
  const auto explains = [&](const Guess& one, double share) {
    return one.count >= share * most && one.score >= 0.95 * one.count;
  };
  const auto best_of_all = [&] {
    return std::max_element(guesses.begin(), guesses.end(),
                            [](const Guess& a, const Guess& b) { return a.score < b.score; });
  };
  // Small steps first: mostly they are all it takes.
  guess(from_last, everywhere, at_rest);
  if (!explains(guesses.back(), nearly_all)) {
    guess(from_last, everywhere, velocity_);
  }
  if (!explains(guesses.back(), nearly_all)) {
    guess(from_last, border_, at_rest);
    guess(from_free, everywhere, at_rest);
    guess(from_free, border_, at_rest);
  }
  if (!explains(*best_of_all(), max_of_all)) {
    // After a leap any spot that is not too far may be the middle dot.
    const cv::Mat_<uchar> seeds = around_middle(free_.size(), middle_);
    const double reach_px = longest_leap * from_free.spacing_px(middle_.y, middle_.x);
    for (const cv::Vec2d& blob : nearest_first(blobs, last_(middle_), reach_px)) {
      guess(from_last, seeds, DotGrid(free_.size(), blob - last_(middle_)));
      if (explains(guesses.back(), nearly_all)) {
        break;
      }
    }
  }
  const auto best = best_of_all();
  drop_doubtful(*best, guesses);
  // Many spots without a label inside the print: the labels are somewhere else's.
  const DotGrid found =
      best->count >= min_explained * most ? dots_of(best->labels, map) : no_dots(free_.size());
  remember(found);
  return found;
}

void DotTracker::remember(const DotGrid& found) {
  const DotGrid now = filled(found, free_, last_);
  for (int i = 0; i < found.rows; ++i) {
    for (int j = 0; j < found.cols; ++j) {
      const cv::Vec2d move = now(i, j) - last_(i, j);
      velocity_(i, j) = is_present(move) ? move : cv::Vec2d(0, 0);
    }
  }
  last_ = now;
}

}  // namespace replay
