// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Measurement of one row of a table. A name is "group/row". The report compares each row with the
// first of its group and with those called "streaming ..." and "cv::...". A row with "published" in
// its name is the published method.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "support/allocations.hpp"

namespace bench {

using Counters = benchmark::UserCounters;

/// Bytes taken from the heap since this object was made: the memory of a row's estimator,
/// workspace, state and outputs. Inputs are made before it.
class Memory {
 public:
  long bytes() const { return test::bytes_taken() - before_; }

 private:
  long before_ = test::bytes_taken();
};

/// Notes the median, the 99th percentile and the maximum of |errors|, over the errors that are
/// numbers, and the share of these if it is not 1. The first quantity noted is the main one of the
/// row. A unit is "mm", "1/mm", "deg", "share" (relative to the truth) ...
inline void note_errors(Counters& counters,
                        const std::string& quantity,
                        const std::string& unit,
                        std::vector<double> errors) {
  const double all = static_cast<double>(errors.size());
  std::erase_if(errors, [](double e) { return std::isnan(e); });
  if (static_cast<double>(errors.size()) < all) {
    counters["found|" + quantity] = static_cast<double>(errors.size()) / all;
  }
  if (errors.empty()) {
    return;
  }
  for (double& e : errors) {
    e = std::abs(e);
  }
  std::sort(errors.begin(), errors.end());
  const auto share = [&](double s) {
    return errors[static_cast<std::size_t>(s * static_cast<double>(errors.size() - 1))];
  };
  const std::string name = "error|" + quantity + "|" + unit + "|";
  counters[name + "median"] = share(0.5);
  counters[name + "99 %"] = share(0.99);
  counters[name + "worst"] = errors.back();
}

/// Times `work`, which processes `pixels` pixels (or dots, frames, ...), and counts the heap
/// allocations per call. `note` adds errors. It is called once, although Google Benchmark runs a
/// row many times.
template <class Work, class Note>
void add(const std::string& name, std::size_t pixels, long bytes, Work work, Note note) {
  const auto noted = std::make_shared<std::optional<Counters>>();
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) mutable {
    work();
    const long before = test::allocations();
    work();
    const long allocations = test::allocations() - before;
    for (auto _ : state) {
      work();
      benchmark::ClobberMemory();
    }
    state.counters["pixels/s"] =
        benchmark::Counter(double(pixels), benchmark::Counter::kIsIterationInvariantRate);
    state.counters["bytes"] = double(bytes);
    state.counters["allocations"] = double(allocations);
    if (!*noted) {
      noted->emplace();
      note(**noted);
    }
    state.counters.insert((*noted)->begin(), (*noted)->end());
  })->Unit(benchmark::kMicrosecond);
}

/// Memory bandwidth as a lower bound of time: reads four planes of floats and writes one, once.
inline void add_streaming(const std::string& group, std::size_t pixels = 640 * 480) {
  const auto planes = std::make_shared<std::vector<float>>(5 * pixels, 1.0F);
  add(
      group + "/streaming pass", pixels, static_cast<long>(planes->size() * sizeof(float)),
      [planes, pixels] {
        const float* in = planes->data();
        float* out = planes->data() + 4 * pixels;
        for (std::size_t k = 0; k < pixels; ++k) {
          out[k] = in[k] * in[k + pixels] + in[k + 2 * pixels] * in[k + 3 * pixels];
        }
        benchmark::DoNotOptimize(out);
      },
      [](auto&) {});
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
