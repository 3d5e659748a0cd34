// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A table from the waves of all fingers to what is remembered of the samples that had them. Open
// addressing of fixed size with at most half of the places taken; a key is removed with its last
// sample, and those behind it move up, so that a look-up never gets longer with time.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fingerpad {
inline namespace v0 {
namespace detail {

template <std::size_t Fingers, class Memory>
class WaveTable {
 public:
  using Key = std::array<std::int64_t, Fingers>;

  explicit WaveTable(std::size_t samples) {
    std::size_t places = 4;
    while (places < 2 * samples) {
      places *= 2;
    }
    places_.resize(places);
  }

  void clear() {
    for (Place& place : places_) {
      place.samples = 0;
    }
  }

  /// What is remembered for this key; null: no sample has it.
  const Memory* find(const Key& key) const {
    const Place& place = places_[place_of(key)];
    return place.samples > 0 ? &place.memory : nullptr;
  }

  /// The memory of a key that gets one sample more.
  Memory& add(const Key& key) {
    Place& place = places_[place_of(key)];
    if (place.samples == 0) {
      place.key = key;
      place.memory.clear();
    }
    ++place.samples;
    return place.memory;
  }

  /// One sample of the key, added before, is gone.
  void remove(const Key& key) {
    std::size_t hole = place_of(key);
    if (--places_[hole].samples > 0) {
      return;
    }
    for (std::size_t i = next(hole); places_[i].samples > 0; i = next(i)) {
      const std::size_t from_home = (i - home(places_[i].key)) & mask();
      const std::size_t from_hole = (i - hole) & mask();
      if (from_home >= from_hole) {  // its search would stop at the hole
        places_[hole] = places_[i];
        places_[i].samples = 0;
        hole = i;
      }
    }
  }

 private:
  struct Place {
    Key key = {};
    std::int64_t samples = 0;
    Memory memory;
  };

  std::size_t mask() const { return places_.size() - 1; }
  std::size_t next(std::size_t i) const { return (i + 1) & mask(); }

  std::size_t home(const Key& key) const {
    std::uint64_t mixed = 0;
    for (const std::int64_t waves : key) {
      mixed = (mixed ^ static_cast<std::uint64_t>(waves)) * 0x9E3779B97F4A7C15U;  // 2^64 / golden
      mixed ^= mixed >> 32;
    }
    return static_cast<std::size_t>(mixed) & mask();
  }

  /// Where the key is, or where it would go.
  std::size_t place_of(const Key& key) const {
    std::size_t i = home(key);
    while (places_[i].samples > 0 && places_[i].key != key) {
      i = next(i);
    }
    return i;
  }

  std::vector<Place> places_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
