// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <opencv2/core.hpp>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Pad;

// Every way of taking memory is counted, in this whole program.
namespace {
std::atomic<long> allocations{0};

void* take(std::size_t size, std::size_t alignment) {
  ++allocations;
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  if (void* p = std::aligned_alloc(alignment, whole == 0 ? alignment : whole)) {
    return p;
  }
  throw std::bad_alloc();
}
/// Not inlined, or GCC 12 sees free() for what it believes came from its own operator new.
[[gnu::noinline]] void give_back(void* p) noexcept {
  std::free(p);
}
constexpr std::size_t plain = alignof(std::max_align_t);
}  // namespace

void* operator new(std::size_t size) {
  return take(size, plain);
}
void* operator new[](std::size_t size) {
  return take(size, plain);
}
void* operator new(std::size_t size, std::align_val_t a) {
  return take(size, std::size_t(a));
}
void* operator new[](std::size_t size, std::align_val_t a) {
  return take(size, std::size_t(a));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return take(size, plain);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return take(size, plain);
}
void operator delete(void* p) noexcept {
  give_back(p);
}
void operator delete[](void* p) noexcept {
  give_back(p);
}
void operator delete(void* p, std::size_t) noexcept {
  give_back(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  give_back(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  give_back(p);
}
void operator delete[](void* p, std::align_val_t) noexcept {
  give_back(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  give_back(p);
}
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept {
  give_back(p);
}

namespace {

/// Memory taken by three frames.
template <class S, class Estimator, class Red, class Green, class Workspace>
long taken(const Estimator& estimator, const Red& red, const Green& green, Workspace& workspace) {
  test::Estimate<S> e(rows(red), cols(red));
  const long before = allocations;
  for (int again = 0; again < 3; ++again) {
    estimator(red, green, e.depth_mm, e.status, workspace);
    estimator(red, green, e.depth_mm, workspace);
    estimator.band(5, 9, red, green, e.depth_mm, e.status, workspace);
  }
  return allocations - before;
}

template <class Smoothing, class Inverse, class Pixel, class S>
struct Step {
  using smoothing = Smoothing;
  using inverse = Inverse;
  using pixel = Pixel;
  using scalar = S;
};

}  // namespace

TEMPLATE_TEST_CASE("no frame takes memory",
                   "[depth]",
                   (Step<NoSmoothing, Bisection, std::uint8_t, float>),
                   (Step<BoxMean, ExponentialFree<>, std::uint8_t, float>),
                   (Step<BiasFreeMean, ExponentialFree<>, std::uint16_t, float>),
                   (Step<Anchored<BoxMean>, Newton<>, std::uint8_t, float>),
                   (Step<Anchored<BiasFreeMean>, ExponentialFree<>, std::uint8_t, float>),
                   (Step<Anchored<BiasFreeMean>, ExponentialFree<>, float, float>),
                   (Step<BiasFreeMean, Newton<Start::previous_frame>, double, double>),
                   (Step<BoxMean, ExponentialFree<9, 12, 8>, std::uint8_t, double>)) {
  using S = typename TestType::scalar;
  using Pixel = typename TestType::pixel;
  const Pad pad;
  auto frame = pad.frame<Pixel>(pad.pressed_depths(3));
  for (std::size_t k = 0; k < frame.red.cells.size(); k += 5) {
    frame.red.cells[k] = test::stored<Pixel>(k % 2 == 0 ? 0 : 255);
  }
  const auto estimator =
      pad.estimator<typename TestType::smoothing, typename TestType::inverse, S>();
  const long before = allocations;
  auto workspace = estimator.template workspace<Pixel>();
  CHECK(allocations > before);  // the counter counts
  CHECK(taken<S>(estimator, frame.red, frame.green, workspace) == 0);
  if constexpr (std::is_same_v<Pixel, std::uint8_t>) {
    cv::Mat image(static_cast<int>(pad.rows), static_cast<int>(pad.cols), CV_8UC3);
    image = cv::Scalar(10, 50, 60);
    CHECK(taken<S>(estimator, channel<const Pixel>(image, 2), channel<const Pixel>(image, 1),
                   workspace) == 0);
  }
}
