// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The workers for the units: the children of this process and, under MPI, of the other ranks.
#include <vector>

#include "children.hpp"
#include "unit.hpp"

namespace replay_many {

/// Whether the program is built with MPI and was started by mpirun or srun.
bool has_ranks();

class Crew {
 public:
  /// Runs `jobs` processes at a time on each rank. Under MPI, every rank creates a Crew.
  explicit Crew(int jobs);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  bool leads() const { return rank_ == 0; }
  int ranks() const { return static_cast<int>(at_work_.size()); }
  int jobs() const { return jobs_ * ranks(); }

  /// For a rank that does not lead: works until the leader dismisses it.
  void serve();

  /// Assigns a unit to a worker; returns false if all are busy.
  bool start(std::size_t unit, const std::vector<std::string>& arguments);
  /// Reports of ended units; waits up to 20 ms for them.
  std::vector<Report> ended();
  /// Assigns no more units to this rank.
  void retire(int rank) { at_work_[static_cast<std::size_t>(rank)] += for_ever; }
  /// Ends the work of all ranks.
  void dismiss();

 private:
  static constexpr int for_ever = 1 << 30;
  int jobs_;
  int rank_ = 0;
  Children children_;
  std::vector<int> at_work_ = {0};  ///< number of running units by rank
  bool dismissed_ = false;
};

}  // namespace replay_many
