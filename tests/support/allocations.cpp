// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "support/allocations.hpp"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

// Counts every kind of allocation in the whole program: replacing only some of the operators would
// mix allocators.
namespace {
std::atomic<long> taken{0};
std::atomic<long> bytes{0};

void* take(std::size_t size, std::size_t alignment) {
  ++taken;
  bytes += static_cast<long>(size);
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  if (void* p = std::aligned_alloc(alignment, whole == 0 ? alignment : whole)) {
    return p;
  }
  throw std::bad_alloc();
}
/// Not inlined, because GCC 12 otherwise sees free() for memory that it attributes to its own
/// operator new.
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

long test::allocations() {
  return taken;
}
long test::bytes_taken() {
  return bytes;
}
