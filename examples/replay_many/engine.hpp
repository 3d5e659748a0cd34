// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Works units off, the largest first, and survives what happens to them.
#include <functional>
#include <string>
#include <vector>

#include "crew.hpp"
#include "unit.hpp"

namespace replay_many {

/// What the job makes of a unit that has ended.
struct Job {
  /// Units that become possible now; perhaps none.
  std::function<std::vector<Unit>(const Unit& unit)> done;
  /// Named for good, with its reason.
  std::function<void(const Unit& unit, const std::string& reason)> failed;
  /// Whether the leader sees what a unit did not see, which is then its machine's fault; throws
  /// replay::Failure where all of the input is gone.
  std::function<bool(const Unit& unit)> is_there;
  std::string noun = "recordings";
};

/// A unit whose process died is given this many tries.
constexpr int max_tries = 3;

/// Throws replay::Failure where the output cannot be written or the input is gone: what runs is
/// finished first, and the rest is left for the next run.
void work_off(Crew& crew, std::vector<Unit> units, const Job& job);

}  // namespace replay_many
