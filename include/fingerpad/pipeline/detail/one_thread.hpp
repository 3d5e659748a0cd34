// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Who works on a frame when nobody else does, and who watches when nobody does.
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The calling thread. Another executor has the same members; bench/report/chain has one of two
/// threads.
struct OneThread {
  static constexpr int threads = 1;

  /// Calls work(thread, first, last) until all rows are done.
  template <class Work>
  void bands(Index rows, const Work& work) {
    work(0, 0, rows);
  }
  /// Calls both, in any order or at once.
  template <class First, class Second>
  void both(const First& first, const Second& second) {
    first();
    second();
  }
};

struct NoWatch {
  template <class Stage>
  void operator()(Stage) const {}
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
