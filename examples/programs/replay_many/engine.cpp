// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "engine.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <optional>
#include <queue>
#include <utility>

#include "common/failure.hpp"

namespace replay_many {
namespace {

/// Progress on standard error: one changing line in a terminal, otherwise a line at intervals.
class Progress {
 public:
  explicit Progress(const Crew& crew)
      : workers_(crew.jobs()), in_terminal_(::isatty(STDERR_FILENO) == 1) {}
  ~Progress() {
    if (in_terminal_) {
      std::fputs("\r\033[K", stderr);
    }
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void add(const Unit& unit) {
    ++units_;
    size_ += unit.size;
  }
  void ended(const Unit& unit, bool well) {
    ++units_ended_;
    size_ended_ += unit.size;
    failed_ += well ? 0 : 1;
    show();
  }

 private:
  using Clock = std::chrono::steady_clock;

  void show() {
    const auto now = Clock::now();
    const std::chrono::duration<double> spent = now - begin_;
    const std::chrono::duration<double> quiet = now - shown_;
    if (quiet.count() < (in_terminal_ ? 0.2 : 30) && units_ended_ < units_) {
      return;
    }
    shown_ = now;
    const double rate = size_ended_ / spent.count();
    std::fprintf(
        stderr,
        "%s%d of %d recordings done, %d failed, %.3g per minute on %d processes, %.0f s left%s",
        in_terminal_ ? "\r\033[K" : "", units_ended_, units_, failed_,
        60 * units_ended_ / spent.count(), workers_, rate > 0 ? (size_ - size_ended_) / rate : 0,
        in_terminal_ ? "" : "\n");
  }

  int workers_;
  bool in_terminal_;
  int units_ = 0, units_ended_ = 0, failed_ = 0;
  double size_ = 0, size_ended_ = 0;
  Clock::time_point begin_ = Clock::now(), shown_ = begin_;
};

class Work {
 public:
  Work(Crew& crew, const Job& job) : crew_(crew), job_(job), progress_(crew) {}

  void add(Unit unit) {
    progress_.add(unit);
    const std::size_t index = units_.size();
    waiting_.push({unit.size, index});
    units_.push_back({std::move(unit)});
  }

  void run() {
    while (running_ > 0 || (!waiting_.empty() && !stop_)) {
      hand_out();
      for (const Report& report : crew_.ended()) {
        --running_;
        take(report);
      }
    }
    if (stop_) {
      throw replay::Failure(*stop_);
    }
  }

 private:
  struct Entry {
    Unit unit;
    int tries = 0;
  };
  /// Larger units come first; of equal sizes the first one.
  struct Place {
    double size;
    std::size_t index;
    bool operator<(const Place& other) const {
      return size != other.size ? size < other.size : index > other.index;
    }
  };

  void hand_out() {
    while (!stop_ && !waiting_.empty()) {
      const std::size_t index = waiting_.top().index;
      if (!crew_.start(index, units_[index].unit.arguments)) {
        return;
      }
      ++running_;
      waiting_.pop();
    }
  }

  void again(std::size_t index) { waiting_.push({units_[index].unit.size, index}); }

  void take(const Report& report) {
    Entry& entry = units_[report.unit];
    switch (report.end) {
      case End::done:
        progress_.ended(entry.unit, true);
        return;
      case End::no_room:
        stop_ = report.reason;
        again(report.unit);
        return;
      case End::died:
        if (++entry.tries < max_tries) {
          again(report.unit);
          return;
        }
        give_up(entry.unit, report.reason + ", " + std::to_string(max_tries) + " times");
        return;
      case End::missing:
      case End::failed:
        judge(report);
    }
  }

  /// Decides whether the recording, the machine or a lost mount is at fault.
  void judge(const Report& report) {
    const Unit unit = units_[report.unit].unit;
    try {
      if (!job_.is_there(unit) || report.rank == 0 || report.end == End::failed) {
        give_up(unit, report.reason);
        return;
      }
      std::fprintf(stderr, "rank %d cannot read the recordings and gets no more work: %s\n",
                   report.rank, report.reason.c_str());
      crew_.retire(report.rank);
    } catch (const replay::Failure& gone) {
      stop_ = gone.what();
    }
    again(report.unit);
  }

  void give_up(const Unit& unit, const std::string& reason) {
    job_.failed(unit, reason);
    progress_.ended(unit, false);
  }

  Crew& crew_;
  const Job& job_;
  Progress progress_;
  std::vector<Entry> units_;
  std::priority_queue<Place> waiting_;
  int running_ = 0;
  std::optional<std::string> stop_;
};

}  // namespace

void work_off(Crew& crew, std::vector<Unit> units, const Job& job) {
  Work work(crew, job);
  for (Unit& unit : units) {
    work.add(std::move(unit));
  }
  work.run();
}

}  // namespace replay_many
