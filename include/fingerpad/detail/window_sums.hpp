// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
#include "fingerpad/detail/window_running.hpp"
#include "fingerpad/detail/window_vector.hpp"
namespace fingerpad {
inline namespace v0 {
namespace detail {
template <class Pixel, int Windows = 1>
struct WindowSumsOf { using type = RunningWindowSums<Pixel, Windows>; };
template <class Pixel, int Windows>
  requires (native_vector_bytes > 0 && (std::same_as<Pixel, std::uint8_t> || std::same_as<Pixel, std::uint16_t>))
struct WindowSumsOf<Pixel, Windows> { using type = VectorWindowSums<Pixel, Windows, native_vector_bytes>; };
template <class Pixel, int Windows = 1>
using WindowSums = typename WindowSumsOf<Pixel, Windows>::type;
}}}
