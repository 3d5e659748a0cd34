// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Counts the instructions and cycles of this thread where processor and system allow it (Linux).
#include <cstdint>
#include <optional>

#ifdef __linux__
#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace chain {

class EventCounter {
 public:
  enum class Event { instructions, cycles };

#ifdef __linux__
  explicit EventCounter(Event event) {
    perf_event_attr asked{};
    asked.type = PERF_TYPE_HARDWARE;
    asked.size = sizeof asked;
    asked.config =
        event == Event::instructions ? PERF_COUNT_HW_INSTRUCTIONS : PERF_COUNT_HW_CPU_CYCLES;
    asked.exclude_kernel = 1;
    file_ = static_cast<int>(syscall(SYS_perf_event_open, &asked, 0, -1, -1, 0));
  }
  ~EventCounter() {
    if (file_ >= 0) {
      close(file_);
    }
  }
  std::optional<std::int64_t> value() const {
    std::int64_t count = 0;
    return file_ >= 0 && read(file_, &count, sizeof count) == sizeof count ? std::optional(count)
                                                                           : std::nullopt;
  }
#else
  explicit EventCounter(Event) {}
  std::optional<std::int64_t> value() const {
    return std::nullopt;
  }
#endif
  EventCounter(const EventCounter&) = delete;
  EventCounter& operator=(const EventCounter&) = delete;

 private:
  int file_ = -1;
};

}  // namespace chain
