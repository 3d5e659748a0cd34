// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Two threads that work on a frame, as an executor of Fingertip.
#include <atomic>
#include <thread>

#include "fingerpad/core/grid.hpp"

namespace chain {

using fingerpad::Index;

/// Calls take no memory: the second thread lives as long as this, and is handed the address of its
/// work.
class TwoThreads {
 public:
  static constexpr int threads = 2;

  TwoThreads() : other_([this] { serve(); }) {}
  ~TwoThreads() {
    work_ = nullptr;
    announce(busy);
    other_.join();
  }
  TwoThreads(const TwoThreads&) = delete;
  TwoThreads& operator=(const TwoThreads&) = delete;

  template <class Work>
  void bands(Index rows, const Work& work) {
    both([&] { work(0, 0, rows / 2); }, [&] { work(1, rows / 2, rows); });
  }
  /// `second` by the other thread, at the same time.
  template <class First, class Second>
  void both(const First& first, const Second& second) {
    argument_ = &second;
    work_ = [](const void* argument) { (*static_cast<const Second*>(argument))(); };
    announce(busy);
    first();
    state_.wait(busy, std::memory_order_acquire);
  }

 private:
  static constexpr int idle = 0;
  static constexpr int busy = 1;

  void announce(int state) {
    state_.store(state, std::memory_order_release);
    state_.notify_one();
  }
  void serve() {
    for (;;) {
      state_.wait(idle, std::memory_order_acquire);
      if (work_ == nullptr) {
        return;
      }
      work_(argument_);
      announce(idle);
    }
  }

  std::atomic<int> state_{idle};
  void (*work_)(const void*) = nullptr;
  const void* argument_ = nullptr;
  std::thread other_;
};

}  // namespace chain
