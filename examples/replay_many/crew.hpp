// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Who does the units: this process' children and, under MPI, those of the other ranks.
#include <vector>

#include "children.hpp"
#include "unit.hpp"

namespace replay_many {

/// Whether mpirun or srun started this program, and it is built with MPI.
bool has_ranks();

class Crew {
 public:
  /// `jobs` processes at a time on each rank. Under MPI, every rank makes one.
  explicit Crew(int jobs);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  bool leads() const { return rank_ == 0; }
  int ranks() const { return static_cast<int>(at_work_.size()); }
  int jobs() const { return jobs_ * ranks(); }

  /// A rank that does not lead: works until the leader dismisses it.
  void serve();

  /// Hands a unit out; false where everybody is busy.
  bool start(std::size_t unit, const std::vector<std::string>& arguments);
  /// What has ended; waits up to a fiftieth of a second for it.
  std::vector<Report> ended();
  /// Nothing more for this rank.
  void retire(int rank) { at_work_[static_cast<std::size_t>(rank)] += for_ever; }
  /// The end of the work for all ranks.
  void dismiss();

 private:
  static constexpr int for_ever = 1 << 30;
  int jobs_;
  int rank_ = 0;
  Children children_;
  std::vector<int> at_work_ = {0};  ///< by rank
  bool dismissed_ = false;
};

}  // namespace replay_many
