// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How a row of a table is measured. A name is "group/row"; the first row of a group is what the
// report compares the others of the group with, and rows called "streaming ..." also.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <string>

namespace bench {

/// Times `work`, which treats `pixels` pixels, and lets `note` add the row's error as a counter.
template <class Work, class Note>
void add(const std::string& name, std::size_t pixels, Work work, Note note) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) mutable {
    for (auto _ : state) {
      work();
      benchmark::ClobberMemory();
    }
    state.counters["pixels/s"] =
        benchmark::Counter(double(pixels), benchmark::Counter::kIsIterationInvariantRate);
    note(state.counters);
  })->Unit(benchmark::kMicrosecond);
}

inline int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 1;
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

}  // namespace bench
