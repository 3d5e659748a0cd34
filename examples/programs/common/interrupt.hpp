// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Whether the user has interrupted the program, so that it can stop without leaving files behind.
#include <csignal>

namespace replay {

inline volatile std::sig_atomic_t interrupts = 0;

inline void watch_for_interrupts() {
  const auto note = [](int /*signal*/) { interrupts = 1; };
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
#ifdef SIGHUP
  if (std::signal(SIGHUP, note) == SIG_IGN) {
    std::signal(SIGHUP, SIG_IGN);  // nohup
  }
#endif
}

inline bool is_interrupted() {
  return interrupts != 0;
}

}  // namespace replay
