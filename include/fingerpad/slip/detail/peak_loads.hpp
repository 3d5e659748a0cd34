// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The largest load of a contact since a given frame.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// The largest load since a given frame. At most `room` loads that no later one exceeds are kept.
/// If there are more, the oldest load is assigned to a later frame than its own, so the answer may
/// be too large, but never too small.
template <class S>
class PeakLoads {
 public:
  /// Adds the load of the next frame. NaN: unknown, as is the largest load of any period with it.
  void add(const S& load) {
    ++frame_;
    if (!is_finite(load)) {
      size_ = 0;
      unknown_ = frame_;
      return;
    }
    while (size_ > 0 && !(load < peaks_[size_ - 1].load)) {
      --size_;
    }
    if (size_ == room) {
      peaks_[0].frame = peaks_[1].frame;
      for (std::size_t k = 2; k < room; ++k) {
        peaks_[k - 1] = peaks_[k];
      }
      --size_;
    }
    peaks_[size_++] = {load, frame_};
  }
  /// The largest load of this frame and the `age` frames before; NaN if unknown.
  S since(Index age) const {
    if (age < 0 || frame_ - age <= unknown_) {
      return not_a_number<S>();
    }
    std::size_t k = 0;
    while (k + 1 < size_ && peaks_[k].frame < frame_ - age) {
      ++k;
    }
    return peaks_[k].load;
  }

 private:
  static constexpr std::size_t room = 16;
  struct Peak {
    S load;
    std::int64_t frame;
  };
  std::array<Peak, room> peaks_ = {};
  std::size_t size_ = 0;
  std::int64_t frame_ = 0;
  std::int64_t unknown_ = 0;  // the latest frame with an unknown load
};

}  // namespace detail::stick

}  // namespace v0
}  // namespace fingerpad
