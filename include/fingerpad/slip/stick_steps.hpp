// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The steps of the stick ratio and the policies of each step: the reference frame, the motion of
// the object since then, and the dots that have followed it. Source: Ito, Kim, Obinata, "Robust
// slippage degree estimation based on reference update of vision-based tactile sensor", the talk
// with its backup slides.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/check.hpp"
#include "fingerpad/slip/detail/dot_doubts.hpp"
#include "fingerpad/slip/detail/dot_places.hpp"
#include "fingerpad/slip/detail/similarity.hpp"

namespace fingerpad {
inline namespace v0 {

/// The reference is the newest stored frame from which the dots in contact have moved further than
/// U. The search goes back from the newest frame as long as the distance grows. Where it begins to
/// shrink, the object has reversed, and older frames are not examined. Equal distances do not stop
/// the search.
struct UpdatedReference {
  Index capacity = 64;   ///< stored frames, 1 to 4096; when full, the oldest is dropped
  bool at_rest = false;  ///< also compares frames within U_min of the newest stored one
};

/// What may change between two frames of an object besides its position.
enum class Freedom {
  translation,  ///< nothing: it is only shifted
  rigid,        ///< it rotates about the line of sight
  scaling,      ///< it appears larger or smaller, as the normal force changes
  similarity,   ///< both
};
constexpr bool may_rotate(Freedom f) {
  return f == Freedom::rigid || f == Freedom::similarity;
}
constexpr bool may_scale(Freedom f) {
  return f == Freedom::scaling || f == Freedom::similarity;
}

/// The map that best fits all sticking dots. Starting with the reference dot and its 24 nearest
/// dots, dots that follow the map are taken and the map is fitted to them, until hardly any are
/// added. No dot that the object drags can outrun the map. If one has, the dots found so far only
/// stand still together, and the search restarts from the dot that has moved furthest. If most dots
/// slipped in the last answer, dots at rest are never taken for the object.
template <Freedom Free = Freedom::similarity>
struct StickConsensus {
  int max_passes = 10;  ///< 0 to 100; two or three are typical
};

/// Weights of a dot, of its four side neighbours and of its four diagonal ones; > 0, >= 0, >= 0.
/// The defaults leave 0.42 of the noise, as the published 0.06 of 0.14 px.
struct DotWeights {
  double self = 6;      ///< S1
  double side = 2;      ///< S2
  double diagonal = 1;  ///< S3
};

/// Reduces noise by averaging the residual displacements, which remain without the object's motion,
/// over neighbours in contact. Neighbours that slip by more than `gate` times the threshold are
/// left out, so that they do not affect the sticking dots beside them.
struct ResidualMean {
  DotWeights weights = {};
  double gate = 6;  ///< >= 1
};

/// Each dot is judged by itself.
struct NoDenoising {};

inline void expects_valid(const UpdatedReference& reference) {
  expects(reference.capacity >= 1 && reference.capacity <= 4096, "UpdatedReference", "capacity",
          static_cast<long long>(reference.capacity), "in [1, 4096]");
}
template <Freedom Free>
void expects_valid(const StickConsensus<Free>& motion) {
  expects(motion.max_passes >= 0 && motion.max_passes <= 100, "StickConsensus", "max_passes",
          static_cast<long long>(motion.max_passes), "in [0, 100]");
}
inline void expects_valid(const DotWeights& weights, const char* owner) {
  expects(is_finite(weights.self) && weights.self > 0, owner, "weights.self", weights.self,
          "finite and > 0");
  expects(is_finite(weights.side) && weights.side >= 0, owner, "weights.side", weights.side,
          "finite and >= 0");
  expects(is_finite(weights.diagonal) && weights.diagonal >= 0, owner, "weights.diagonal",
          weights.diagonal, "finite and >= 0");
}
inline void expects_valid(const ResidualMean& mean) {
  expects_valid(mean.weights, "ResidualMean");
  expects(is_finite(mean.gate) && mean.gate >= 1, "ResidualMean", "gate", mean.gate,
          "finite and >= 1");
}
inline void expects_valid(const NoDenoising&) {}

namespace detail::stick {

/// Share of the noise of one dot that a denoising leaves. 0: unknown, and no threshold follows from
/// the noise.
template <class Denoising>
double noise_left_by(const Denoising&) {
  return 0;
}
inline double noise_left_by(const NoDenoising&) {
  return 1;
}
inline double noise_left_by(const ResidualMean& mean) {
  const auto& [self, side, diagonal] = mean.weights;
  return std::sqrt(self * self + 4 * side * side + 4 * diagonal * diagonal) /
         (self + 4 * side + 4 * diagonal);
}

// ---- reference

template <class P, class S>
Choice<S> choose_reference(const UpdatedReference& reference,
                           const std::vector<Index>& touching,
                           const P* now,
                           const Repository<P>& stored,
                           const S& reference_sq,
                           const S& store_sq) {
  Choice<S> choice;
  S before = S(-1);
  for (Index age = 0; age < stored.size(); ++age) {
    const S sq = furthest_sq(touching, now, stored.dots(age));
    if (age == 0) {
      choice.newest_sq = choice.furthest_sq = sq;
      choice.standing = !(sq < S(0)) && !(store_sq < sq);
    }
    if ((choice.standing && !reference.at_rest) || sq < before) {
      break;
    }
    if (reference_sq < sq) {
      choice.age = age;
      choice.furthest_sq = sq;
      break;
    }
    before = sq;
  }
  return choice;
}

/// Whether a frame that is not at rest is stored.
template <class P>
bool is_stored(const UpdatedReference&, const Repository<P>&) {
  return true;
}

// ---- motion

/// Adds dot k, relative to the origins of `about`, if it was found in both frames.
template <class S>
void add_dot(const FramePair<S>& pair,
             Index k,
             const S& weight,
             const Similarity<S>& about,
             PairSums<S>& sums) {
  const Point2<S> now = pair.now[k] - about.now_at, then = pair.then[k] - about.then_at;
  if (is_distance_sq(S(squared_norm(now) + squared_norm(then)))) {
    sums.add(weight, now, then);
  }
}

/// Sums over the reference dot and the 24 dots around it, with binomial weights.
template <class S>
PairSums<S> sums_around(const FramePair<S>& pair, Index reference, const Similarity<S>& about) {
  constexpr std::array<int, 5> binomial = {1, 4, 6, 4, 1};
  PairSums<S> sums;
  const DotIndex center = pair.layout.dot_at(reference);
  for (Index i = -2; i <= 2; ++i) {
    for (Index j = -2; j <= 2; ++j) {
      const bool inside = center.row + i >= 0 && center.row + i < pair.layout.rows &&
                          center.col + j >= 0 && center.col + j < pair.layout.cols;
      if (inside) {
        const int weight =
            binomial[static_cast<std::size_t>(i + 2)] * binomial[static_cast<std::size_t>(j + 2)];
        add_dot(pair, reference + i * pair.layout.cols + j, S(weight), about, sums);
      }
    }
  }
  return sums;
}

template <Freedom Free, class S>
Similarity<S> fit(const PairSums<S>& sums, const Similarity<S>& about) {
  return fit<may_rotate(Free), may_scale(Free)>(sums, about);
}

/// The map of the dots around `from` and of those that follow it.
template <Freedom Free, class S>
Similarity<S> consensus(const FramePair<S>& pair, Index from, const S& slip_sq, int max_passes) {
  constexpr int fewest = 3;  // two dots fit a map exactly and do not confirm it
  const S hardly_more = S(1.005);
  const Similarity<S> about = {S(1), S(0), pair.now[from], pair.then[from]};
  Similarity<S> map = fit<Free>(sums_around(pair, from, about), about);
  S before = S(0);
  for (int pass = 0; pass < max_passes; ++pass) {
    PairSums<S> sums;
    for (const Index k : pair.touching) {
      if (squared_norm(map.residual(pair.now[k], pair.then[k])) < slip_sq) {
        sums.add(S(1), pair.now[k] - about.now_at, pair.then[k] - about.then_at);
      }
    }
    if (sums.weight < S(fewest)) {
      break;
    }
    map = fit<Free>(sums, about);
    if (!(hardly_more * before < sums.weight)) {
      break;
    }
    before = sums.weight;
  }
  return map;
}

/// Whether the object, at the origins of the map, has moved by less than half of d_max.
template <class S>
bool has_hardly_moved(const Similarity<S>& map, const S& furthest_sq) {
  return S(4) * squared_norm(map.now_at - map.then_at) < furthest_sq;
}

/// The dot with the largest displacement among those that have outrun the map; -1 if there is none.
/// Such a dot has moved by at least half of d_max, and its residual in the direction of its motion
/// is more than half of its displacement. Dots of which the scale explains more than a quarter of
/// the displacement do not count.
template <class S>
Index furthest_outrunner(const FramePair<S>& pair, const Similarity<S>& map) {
  const S growth = map.scale() - S(1);
  Index furthest = -1;
  S min_sq = pair.furthest_sq / S(4);
  for (const Index k : pair.touching) {
    const Point2<S> moved = pair.now[k] - pair.then[k];
    const S sq = squared_norm(moved);
    if (min_sq < sq && is_distance_sq(sq)) {
      const Point2<S> grown = growth * (pair.now[k] - map.now_at);
      const S ahead = dot(map.residual(pair.now[k], pair.then[k]), moved);
      if (!(sq < S(16) * squared_norm(grown)) && sq < S(2) * ahead) {
        furthest = k;
        min_sq = sq;
      }
    }
  }
  return furthest;
}

/// The translation of one dot and of those that follow it.
template <class S>
Similarity<S> shift_with(const FramePair<S>& pair, Index from, const S& slip_sq) {
  const Similarity<S> about = {S(1), S(0), pair.now[from], pair.then[from]};
  PairSums<S> sums;
  for (const Index k : pair.touching) {
    if (squared_norm(about.residual(pair.now[k], pair.then[k])) < slip_sq) {
      add_dot(pair, k, S(1), about, sums);
    }
  }
  return fit<Freedom::translation>(sums, about);
}

template <Freedom Free, class S>
Similarity<S> motion_between(const StickConsensus<Free>& policy,
                             const FramePair<S>& pair,
                             Index reference,
                             const S& slip_sq,
                             bool mostly_slipped) {
  const Similarity<S> map = consensus<Free>(pair, reference, slip_sq, policy.max_passes);
  if (!has_hardly_moved(map, pair.furthest_sq)) {
    return map;
  }
  const Index ahead = furthest_outrunner(pair, map);
  if (ahead < 0) {
    return map;
  }
  const Similarity<S> other = consensus<Free>(pair, ahead, slip_sq, policy.max_passes);
  if (!has_hardly_moved(other, pair.furthest_sq)) {
    return other;
  }
  // dots that slipped and now rest together are not the object: it has moved on with the last few
  return mostly_slipped ? shift_with(pair, ahead, slip_sq) : map;
}

// ---- denoising and marking

/// Denoises the positions before the comparison. By default nothing is done.
template <class Denoising, class S>
void denoise_positions(const Denoising&,
                       const GivenDots<Point2<S>>&,
                       const DotLayout&,
                       Dots<Point2<S>>&) {}

template <class S>
DotState state_of(const S& residual_sq, const S& slip_sq) {
  return !is_distance_sq(residual_sq) ? DotState::unknown
         : residual_sq < slip_sq      ? DotState::stick
                                      : DotState::slip;
}

/// Marks the dots in contact: a dot sticks if its residual is less than the square root of slip_sq.
/// Returns the variance of the number of sticking dots due to noise. `sd`: standard deviation of
/// one component of a residual.
template <class Denoising, class S>
S mark_dots(const Denoising&,
            const FramePair<S>& pair,
            const Similarity<S>& map,
            const S& slip_sq,
            const S& sd,
            MarkingRoom<S>&,
            std::vector<DotState>& marks) {
  S variance = S(0);
  for (const Index k : pair.touching) {
    const S sq = squared_norm(map.residual(pair.now[k], pair.then[k]));
    marks[static_cast<std::size_t>(k)] = state_of(sq, slip_sq);
    const S doubt = doubt_of(sq, slip_sq, sd);
    variance = variance + doubt * doubt;
  }
  return variance;
}

/// Weighted mean of the residuals of a dot and its neighbours; NaN ones do not count.
template <class S>
Point2<S> mean_around(const DotWeights& weights,
                      const Point2<S>* residuals,
                      const DotLayout& layout,
                      Index k) {
  Point2<S> sum = {S(0), S(0)};
  double weight = 0;
  for (Index i = -1; i <= 1; ++i) {
    for (Index j = -1; j <= 1; ++j) {
      const Point2<S> r = beside(residuals, layout, k, i, j);
      if (r.x == r.x) {
        const double w = i == 0 && j == 0   ? weights.self
                         : i == 0 || j == 0 ? weights.side
                                            : weights.diagonal;
        sum += S(w) * r;
        weight += w;
      }
    }
  }
  return sum / S(weight);
}

template <class S>
S mark_dots(const ResidualMean& mean,
            const FramePair<S>& pair,
            const Similarity<S>& map,
            const S& slip_sq,
            const S& sd,
            MarkingRoom<S>& room,
            std::vector<DotState>& marks) {
  Dots<Point2<S>>& residuals = room.residuals;
  const S gate_sq = slip_sq * S(mean.gate * mean.gate);
  std::fill(residuals.begin(), residuals.end(), no_dot<Point2<S>>());
  for (const Index k : pair.touching) {
    const Point2<S> residual = map.residual(pair.now[k], pair.then[k]);
    const S sq = squared_norm(residual);
    marks[static_cast<std::size_t>(k)] = is_distance_sq(sq) ? DotState::slip : DotState::unknown;
    at(residuals, k) = sq < gate_sq ? residual : no_dot<Point2<S>>();
  }
  room.doubts.clear();
  for (const Index k : pair.touching) {
    if (at(residuals, k).x == at(residuals, k).x) {
      const S sq = squared_norm(mean_around(mean.weights, residuals.data(), pair.layout, k));
      marks[static_cast<std::size_t>(k)] = state_of(sq, slip_sq);
      room.doubts.set(pair.layout.dot_at(k), doubt_of(sq, slip_sq, sd));
    }
  }
  return room.doubts.variance({mean.weights.self, mean.weights.side, mean.weights.diagonal});
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
