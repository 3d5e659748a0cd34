// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// "Which was the latest sample that differs from this one in every coordinate?", in O(1) and with
// 2, 5 or 16 samples remembered of any number (1, 2 or 3 coordinates).
//
// Why so few are enough. The latest sample of all answers each question but those that share a
// coordinate with it. For the questions that share its coordinate d, the latest sample that differs
// there answers, but for those that share one more coordinate with it, and so on: at most one
// sample for each way to fix coordinates one after the other. A new sample answers first wherever
// it can; where it cannot, a sample remembered before does, so no other need be kept.
#include <array>
#include <cstddef>
#include <cstdint>

namespace fingerpad {
inline namespace v0 {
namespace detail {

template <std::size_t Coordinates>
class LatestDiffering {
  static_assert(Coordinates >= 1 && Coordinates <= 3, "at most three coordinates");

 public:
  using Point = std::array<std::int64_t, Coordinates>;
  static constexpr std::int64_t none = -1;

  void clear() { count_ = 0; }

  /// The number of the latest sample that differs from `point` in every coordinate.
  std::int64_t operator()(const Point& point) const {
    const std::size_t found = first(entries_, count_, point, all);
    return found < count_ ? entries_[found].number : none;
  }

  /// Samples come in the order of their numbers.
  void add(const Point& point, std::int64_t number) {
    Selection selection;
    selection.candidates[0] = {point, number};
    for (std::size_t i = 0; i < count_; ++i) {
      selection.candidates[i + 1] = entries_[i];
    }
    selection.count = count_ + 1;
    select({}, 0, selection);
    count_ = 0;
    for (std::size_t i = 0; i < selection.count; ++i) {
      if (selection.is_kept[i]) {
        entries_[count_++] = selection.candidates[i];
      }
    }
  }

 private:
  struct Entry {
    Point point = {};
    std::int64_t number = none;
  };
  static constexpr std::size_t most = Coordinates == 1 ? 2 : Coordinates == 2 ? 5 : 16;
  static constexpr unsigned all = (1U << Coordinates) - 1U;

  struct Selection {
    std::array<Entry, most + 1> candidates;  // latest first
    std::array<bool, most + 1> is_kept = {};
    std::size_t count = 0;
  };

  /// The first of `entries` that differs from `point` in the coordinates of the set `fixed`.
  template <std::size_t N>
  static std::size_t first(const std::array<Entry, N>& entries,
                           std::size_t count,
                           const Point& point,
                           unsigned fixed) {
    for (std::size_t i = 0; i < count; ++i) {
      bool differs = true;
      for (std::size_t d = 0; d < Coordinates; ++d) {
        differs = differs && ((fixed >> d & 1U) == 0 || entries[i].point[d] != point[d]);
      }
      if (differs) {
        return i;
      }
    }
    return count;
  }

  /// Keeps what answers the questions that have the `fixed` coordinates in common with `point`.
  static void select(const Point& point, unsigned fixed, Selection& selection) {
    const std::size_t found = first(selection.candidates, selection.count, point, fixed);
    if (found == selection.count) {
      return;
    }
    selection.is_kept[found] = true;
    for (std::size_t d = 0; d < Coordinates; ++d) {
      if ((fixed >> d & 1U) == 0) {
        Point next = point;
        next[d] = selection.candidates[found].point[d];
        select(next, fixed | 1U << d, selection);
      }
    }
  }

  std::array<Entry, most> entries_;  // latest first
  std::size_t count_ = 0;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
