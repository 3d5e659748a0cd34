// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What the fuzzer's bytes mean: sizes, parameters, and grids with gaps between rows and cells.
// Zeros follow where the bytes end.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <limits>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "support/allocations.hpp"

namespace fuzz {

using fingerpad::Index;

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  bool is_empty() const { return left_ == 0; }
  std::uint8_t byte() {
    if (left_ == 0) {
      return 0;
    }
    --left_;
    return *data_++;
  }
  bool flag() { return (byte() & 1) != 0; }
  Index whole(Index min, Index max) {
    const unsigned word = byte() | unsigned(byte()) << 8;
    return min + static_cast<Index>(word) % (max - min + 1);
  }

  /// The side of an image: in the lower third of [min, max] but for once in 16, so that an
  /// execution is short.
  Index side(Index min, Index max) {
    const Index word = whole(0, 65535), more = word % (max - min + 1);
    return min + (word >= 0xF000 ? more : more % ((max - min) / 3 + 1));
  }

  /// In [min, max], or, once in 16, a value that nobody expects.
  double number(double min, double max) {
    const std::uint8_t kind = byte();
    if (kind >= 240) {
      return strange(kind & 15);
    }
    return min + (max - min) * static_cast<double>(whole(0, 65535)) / 65535;
  }
  /// The same as a cell: integers wrap, as a camera's would.
  template <class T>
  T cell(double min, double max) {
    if constexpr (std::is_integral_v<T>) {
      return static_cast<T>(whole(0, 65535));
    } else {
      return static_cast<T>(number(min, max));
    }
  }

 private:
  static double strange(int kind) {
    using Limits = std::numeric_limits<double>;
    const double values[] = {Limits::quiet_NaN(),
                             Limits::infinity(),
                             -Limits::infinity(),
                             0,
                             -0.0,
                             Limits::denorm_min(),
                             1e-30,
                             -1e-30,
                             1e30,
                             -1e30,
                             Limits::max(),
                             Limits::lowest(),
                             1e-300,
                             1e9,
                             -1e9,
                             -1};
    return values[kind];
  }

  const std::uint8_t* data_;
  std::size_t left_;
};

/// A grid of its own memory, with gaps, whose cells come from the input: a few of them one by one,
/// the others repeated, so that short inputs fill large grids.
template <class T>
class Grid {
 public:
  Grid(Index rows, Index cols, Index gap = 0)
      : rows_(rows), cols_(cols), step_(1 + gap), stride_(cols * step_ + gap) {
    cells_.resize(static_cast<std::size_t>(rows * stride_ + 1));
  }
  Grid(Input& input, Index rows, Index cols, double min, double max)
      : Grid(rows, cols, input.whole(0, 2)) {
    fill(input, [&] { return input.cell<T>(min, max); });
  }

  template <class MakeCell>
  void fill(Input& input, const MakeCell& make) {
    std::vector<T> few;
    for (Index k = 1 + input.whole(0, 63); k > 0; --k) {
      few.push_back(make());
    }
    const auto step = static_cast<std::size_t>(input.whole(1, 7));
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      cells_[k] = few[k * step % few.size()];
    }
  }

  fingerpad::StridedView<T> view() { return {cells_.data(), rows_, cols_, stride_, step_}; }
  fingerpad::StridedView<const T> view() const {
    return {cells_.data(), rows_, cols_, stride_, step_};
  }
  bool operator==(const Grid& other) const {
    return cells_.size() == other.cells_.size() &&
           std::memcmp(cells_.data(), other.cells_.data(), cells_.size() * sizeof(T)) == 0;
  }

 private:
  Index rows_, cols_, step_, stride_;
  std::vector<T> cells_;
};

/// Ends the run: the input is kept by the fuzzer.
inline void require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "property violated: %s\n", what);
    std::abort();
  }
}

/// Whether a call takes longer than bounded time allows: ten times the median of its kind, once a
/// thousand have been seen. Below 10 ms it may be the machine; above, run() tries again.
class BoundedTime {
 public:
  void add(double seconds) {
    ++count_;
    ++of_[bin(seconds)];
    is_late() = is_late() || (count_ >= 1000 && seconds >= 0.01 && seconds >= 10 * median());
  }
  /// Whether any call was late since this was last set.
  static bool& is_late() {
    static bool late = false;
    return late;
  }

 private:
  static constexpr double shortest = 1e-7;

  /// Eighths of octaves.
  static std::size_t bin(double seconds) {
    const double octaves = std::log2((std::max)(seconds / shortest, 1.0));
    return (std::min)(static_cast<std::size_t>(8 * octaves), std::size_t{255});
  }
  double median() const {
    std::size_t k = 0;
    for (long below = of_[0]; 2 * below < count_; below += of_[k]) {
      ++k;
    }
    return shortest * std::exp2(static_cast<double>(k + 1) / 8);
  }

  std::array<long, 256> of_ = {};
  long count_ = 0;
};

/// Of this thread alone. What a virtual machine's host takes away counts, too.
inline double processor_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The result of a frame, which throws nothing, takes no memory, and bounded time.
template <class Frame>
auto frame(const Frame& call) noexcept {
  static BoundedTime time;  // one for each place in a target
  const long before = test::allocations();
  const double begin = processor_seconds();
  auto result = call();
  const double seconds = processor_seconds() - begin;
  require(test::allocations() == before, "a frame allocates no memory");
  time.add(seconds);
  return result;
}

/// Whether two numbers have the same bits; any two NaN are alike.
template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0 || (a != a && b != b);
}
template <class T>
bool same_bits(const fingerpad::Point2<T>& a, const fingerpad::Point2<T>& b) {
  return same_bits(a.x, b.x) && same_bits(a.y, b.y);
}
template <class T>
bool same_bits(const fingerpad::Point3<T>& a, const fingerpad::Point3<T>& b) {
  return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

/// Runs a target on an input; refused parameters end it. An input is too slow if it is late in each
/// of five runs: in one of them it may be the machine.
template <class Target>
int run(const std::uint8_t* data, std::size_t size, const Target& target) {
  for (int times = 1;; ++times) {
    BoundedTime::is_late() = false;
    Input in(data, size);
    try {
      target(in);
    } catch (const fingerpad::parameter_error&) {
      // refused, as it should be
    }
    if (!BoundedTime::is_late()) {
      return 0;
    }
    require(times < 5, "a frame takes bounded time");
  }
}

}  // namespace fuzz
