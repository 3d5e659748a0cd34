// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Which spot is which printed dot, given about where the dots were before. The membrane moves
// smoothly, so labels grow from a few dots that are sure to their neighbours: where a neighbour is
// looked for follows from how the dots beside it have moved. Moves of several pitches come out
// right as long as neighbours move nearly alike.
#include <opencv2/core.hpp>
#include <vector>

#include "replay/dots/grid.hpp"

namespace replay {

/// The spots of a frame, to ask for the nearest one to a place.
class BlobMap {
 public:
  explicit BlobMap(const Blobs& blobs);

  struct Hit {
    int blob = -1;  ///< none within reach
    double distance_px = 0;
  };
  Hit nearest(const cv::Vec2d& place, double reach_px) const;
  const cv::Vec2d& operator[](int blob) const { return blobs_[static_cast<std::size_t>(blob)]; }
  int size() const { return static_cast<int>(blobs_.size()); }

 private:
  std::size_t cell_of(double x_px, double y_px) const;

  const Blobs& blobs_;
  cv::Vec2d origin_{0, 0};
  cv::Size cells_{1, 1};
  std::vector<std::vector<int>> content_;
};

/// How smoothly neighbours move, in parts of the spacing between dots: a dot that is further from
/// where its neighbours put it, and much further than is usual in the frame, is a shadow or half a
/// dot. Behind an elastic pad a contact moves dots while those beside it stand still.
struct Smoothness {
  double min_strange = 0.10;
};
constexpr Smoothness membrane{};
constexpr Smoothness elastic_pad{0.3};

/// Number of the spot that is each printed dot; -1: none.
using Labels = cv::Mat_<int>;

class Matcher {
 public:
  /// `base`: where the dots were (NaN: nobody knows). Both must outlive the matcher.
  Matcher(const DotGrid& base, const BlobMap& blobs, const Smoothness& smoothness = membrane);

  /// Labels of the dots in `seeds` (nonzero), each taken to have moved by about `moves`, and of all
  /// the dots that are reached from them.
  Labels match(const cv::Mat_<uchar>& seeds, const DotGrid& moves) const;

  /// Where a dot should be that moves as its neighbours; NaN where too few of them are labelled.
  cv::Vec2d expected(const Labels& labels, int row, int col) const;

  /// Number of labels, less what the irregularity and the amount of their moves cost.
  double score(const Labels& labels) const;

  /// Distance to the nearest of the four neighbours in `base`.
  double spacing_px(int row, int col) const { return spacing_px_(row, col); }

 private:
  Labels seed(const cv::Mat_<uchar>& seeds, const DotGrid& moves) const;
  void grow(Labels& labels) const;
  bool grow_once(Labels& labels, int min_neighbours) const;
  void drop_misfits(Labels& labels) const;
  void drop_strangers(Labels& labels) const;
  double misfit(const Labels& labels, int row, int col) const;
  bool may_grow(const Labels& labels, int row, int col, int min_neighbours) const;
  cv::Vec2d move_of(const Labels& labels, int row, int col) const;

  const DotGrid& base_;
  const BlobMap& blobs_;
  Smoothness smoothness_;
  cv::Mat_<double> spacing_px_;
};

/// The spots of `labels` as a grid of dots.
DotGrid dots_of(const Labels& labels, const BlobMap& blobs);

/// The move that neighbours suggest for a dot: a plane through the moves of the labelled dots
/// around it, those that disagree with the others counting less. NaN where there are too few.
cv::Vec2d move_of_neighbours(const DotGrid& moves, int row, int col, double spacing_px);

}  // namespace replay
