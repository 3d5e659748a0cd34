// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <functional>
#include <string>

#include "support/catch.hpp"
#include "support/refusal.hpp"

namespace test {

/// A change of an input, and part of the response.
template <class Input>
struct Mistake {
  const char* name;
  std::function<void(Input&)> make;
  const char* said;
};

/// Each mistake by itself gets its response: what `said_of` returns, or the text of a refusal.
template <class Input, std::size_t N>
void check(const Mistake<Input> (&mistakes)[N], std::string (*said_of)(const Input&)) {
  for (const auto& mistake : mistakes) {
    Input input;
    mistake.make(input);
    std::string said;
    const std::string refused = refusal([&] { said = said_of(input); });
    said = refused == "accepted" ? said : refused;
    INFO(mistake.name << ": " << said);
    CHECK(said.find(mistake.said) != std::string::npos);
  }
}

}  // namespace test
