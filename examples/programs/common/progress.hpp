// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A progress bar on standard error if that is a terminal, otherwise nothing.
#include <unistd.h>

#include <cstdio>
#include <string>

namespace replay {

class Progress {
 public:
  explicit Progress(int total) : total_(total), shown_(::isatty(STDERR_FILENO) == 1) {}
  ~Progress() {
    if (shown_) {
      std::fputs("\r\033[K", stderr);  // clears the line
    }
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(int done) const {
    if (!shown_ || total_ == 0) {
      return;
    }
    constexpr int width = 40;
    const int filled = static_cast<int>(static_cast<long long>(width) * done / total_);
    const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                            std::string(static_cast<std::size_t>(width - filled), '.');
    std::fprintf(stderr, "\r  [%s] frame %d of %d", bar.c_str(), done, total_);
  }

 private:
  int total_;
  bool shown_;
};

}  // namespace replay
