// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Time and instructions of a call on its usual input and on its slowest input, time at the tail of
// many calls of both, its allocations and its page faults.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "support/allocations.hpp"

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else  // for compilers alone: instructions are counted where valgrind is installed
#define CALLGRIND_START_INSTRUMENTATION
#define CALLGRIND_STOP_INSTRUMENTATION
#define CALLGRIND_ZERO_STATS
#define CALLGRIND_DUMP_STATS
#endif

namespace bench::worst_case {

/// A kind of input, and a call on the k-th input of that kind. The first kind is the usual one.
struct Kind {
  std::string name;
  std::function<void(int k)> call;
};

struct Row {
  std::string method;
  std::string hardest;  ///< kind of input
  double usual_us = 0, hardest_us = 0, slowest_us = 0;
  double usual_instructions = 0, hardest_instructions = 0;
  long calls = 0, page_faults = 0, allocations = 0;
};

inline double microseconds_of(const Kind& kind, int k) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  kind.call(k);
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

inline double median_us(const Kind& kind, int calls) {
  std::vector<double> us;
  for (int k = 0; k < calls; ++k) {
    us.push_back(microseconds_of(kind, k));
  }
  const auto middle = us.begin() + static_cast<std::ptrdiff_t>(us.size() / 2);
  std::nth_element(us.begin(), middle, us.end());
  return *middle;
}

inline long page_faults() {
  rusage used{};
  getrusage(RUSAGE_THREAD, &used);
  return used.ru_minflt + used.ru_majflt;
}

/// Has valgrind write the instructions of one pass over all inputs, kind by kind.
inline void count_instructions(const std::vector<Kind>& kinds, int inputs) {
  for (const Kind& kind : kinds) {
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
    for (int k = 0; k < inputs; ++k) {
      kind.call(k);
    }
    CALLGRIND_DUMP_STATS;
    CALLGRIND_STOP_INSTRUMENTATION;
  }
}

/// Measures a row. The tail is that of `calls` calls, alternately on the usual and the hardest
/// input. `instructions`: of a call, by kind.
inline Row row_of(const std::string& method,
                  const std::vector<Kind>& kinds,
                  long calls,
                  const std::vector<double>& instructions) {
  Row row;
  row.method = method;
  row.calls = calls;
  std::size_t hardest = 0;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const double us = median_us(kinds[k], 101);
    row.usual_us = k == 0 ? us : row.usual_us;
    if (us > row.hardest_us) {
      row.hardest_us = us;
      hardest = k;
    }
  }
  row.hardest = kinds[hardest].name;
  row.usual_instructions = instructions.front();
  row.hardest_instructions = *std::max_element(instructions.begin(), instructions.end());
  const long pages = page_faults();
  const long taken = test::allocations();
  for (long k = 0; k < calls; ++k) {
    const Kind& kind = k % 2 == 0 ? kinds.front() : kinds[hardest];
    row.slowest_us = (std::max)(row.slowest_us, microseconds_of(kind, static_cast<int>(k / 2)));
  }
  row.page_faults = page_faults() - pages;
  row.allocations = test::allocations() - taken;
  return row;
}

inline void print(std::ostream& out, const std::vector<Row>& rows) {
  const auto digits = [](double us) {
    char text[32];
    std::snprintf(text, sizeof text, us < 9.95 ? "%.2f" : us < 99.5 ? "%.1f" : "%.0f", us);
    return std::string(text);
  };
  out << "| method | usual, us | hardest, us | times | hardest input | slowest of both, us | "
         "usual, 1000 instructions | most | calls | page faults | allocations |\n"
         "|---|--:|--:|--:|---|--:|--:|--:|--:|--:|--:|\n";
  for (const Row& r : rows) {
    out << "| " << r.method << " | " << digits(r.usual_us) << " | " << digits(r.hardest_us) << " | "
        << digits(r.hardest_us / r.usual_us) << " | " << r.hardest << " | " << digits(r.slowest_us)
        << " | " << digits(r.usual_instructions / 1000) << " | "
        << digits(r.hardest_instructions / 1000) << " | " << r.calls << " | " << r.page_faults
        << " | " << r.allocations << " |\n";
  }
}

}  // namespace bench::worst_case
