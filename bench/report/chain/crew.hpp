// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Two threads that share the work on a frame, as an executor of Fingertip.
#include <atomic>
#include <chrono>
#include <thread>

#include "fingerpad/core/grid.hpp"

namespace chain {

using fingerpad::Index;

/// Calls allocate no memory: the second thread lives as long as this object and receives the
/// address of its work.
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
  /// Runs `second` on the other thread while `first` runs on this one.
  template <class First, class Second>
  void both(const First& first, const Second& second) {
    argument_ = &second;
    work_ = [](const void* argument) { (*static_cast<const Second*>(argument))(); };
    announce(busy);
    first();
    await_change_from(busy);
  }

 private:
  static constexpr int idle = 0;
  static constexpr int busy = 1;

  void announce(int state) {
    state_.store(state, std::memory_order_release);
    state_.notify_one();
  }
  /// Sleeps only after half a millisecond. Waking a thread takes about a tenth of a frame, and a
  /// frame hands work over four times.
  void await_change_from(int state) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::microseconds(500);
    while (state_.load(std::memory_order_acquire) == state) {
      if (end < Clock::now()) {
        state_.wait(state, std::memory_order_acquire);
        return;
      }
      std::this_thread::yield();  // to whoever else needs this core
    }
  }

  void serve() {
    for (;;) {
      await_change_from(idle);
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
