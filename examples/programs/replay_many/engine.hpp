// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Processes units, the largest first, and survives their failures.
#include <functional>
#include <string>
#include <vector>

#include "crew.hpp"
#include "unit.hpp"

namespace replay_many {

/// Callbacks for units that have ended.
struct Job {
  /// Records the final failure of a unit with its reason.
  std::function<void(const Unit& unit, const std::string& reason)> failed;
  /// Whether the leader sees the input that a unit did not see; then the unit's machine is at
  /// fault. Throws replay::Failure if all of the input is gone.
  std::function<bool(const Unit& unit)> is_there;
};

/// Number of tries of a unit whose process dies.
constexpr int max_tries = 3;

/// Processes all units. Throws replay::Failure if the output cannot be written or the input is
/// gone; running units are finished first, and the rest is left for the next run.
void work_off(Crew& crew, std::vector<Unit> units, const Job& job);

}  // namespace replay_many
