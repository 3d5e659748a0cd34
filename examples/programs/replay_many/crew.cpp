// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "crew.hpp"

#ifdef FINGERPAD_WITH_MPI
#include <mpi.h>
#endif

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>

namespace replay_many {
namespace {

/// Polling interval for ranks and children. It is short compared with a unit. Waiting inside MPI
/// instead would keep a core busy.
constexpr std::chrono::milliseconds turn{2};

// Without MPI there is one rank, and messages go nowhere.
#ifdef FINGERPAD_WITH_MPI
void say(int rank, const std::string& words) {
  MPI_Send(words.data(), static_cast<int>(words.size()), MPI_CHAR, rank, 0, MPI_COMM_WORLD);
}

/// Receives a message and its sender; returns false if there is none now.
bool hear(int& rank, std::string& words) {
  int is_there = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &is_there, &status);
  if (is_there == 0) {
    return false;
  }
  int size = 0;
  MPI_Get_count(&status, MPI_CHAR, &size);
  words.resize(static_cast<std::size_t>(size));
  rank = status.MPI_SOURCE;
  MPI_Recv(words.data(), size, MPI_CHAR, rank, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return true;
}
#else
void say(int /*rank*/, const std::string& /*words*/) {}
bool hear(int& /*rank*/, std::string& /*words*/) {
  return false;
}
#endif

// A message is a list of words, each terminated by a zero byte.
std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    text += word + '\0';
  }
  return text;
}

std::vector<std::string> parted(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\0', at);
    words.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

}  // namespace

bool has_ranks() {
#ifdef FINGERPAD_WITH_MPI
  return std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr || std::getenv("PMIX_RANK") != nullptr ||
         std::getenv("PMI_SIZE") != nullptr;
#else
  return false;
#endif
}

Crew::Crew(int jobs) : jobs_(jobs), children_(jobs) {
#ifdef FINGERPAD_WITH_MPI
  if (has_ranks()) {
    MPI_Init(nullptr, nullptr);
    int size = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    at_work_.resize(static_cast<std::size_t>(size));
  }
#endif
}

Crew::~Crew() {
#ifdef FINGERPAD_WITH_MPI
  if (has_ranks()) {
    dismissed_ ? MPI_Finalize() : MPI_Abort(MPI_COMM_WORLD, 1);
  }
#endif
}

bool Crew::start(std::size_t unit, const std::vector<std::string>& arguments) {
  const auto least = std::min_element(at_work_.begin(), at_work_.end());
  if (*least >= jobs_) {
    return false;
  }
  ++*least;
  if (const auto rank = static_cast<int>(least - at_work_.begin()); rank == 0) {
    children_.start(unit, arguments);
  } else {
    std::vector<std::string> words = {std::to_string(unit)};
    words.insert(words.end(), arguments.begin(), arguments.end());
    say(rank, joined(words));
  }
  return true;
}

std::vector<Report> Crew::ended() {
  std::vector<Report> reports;
  for (int turns = 0; turns < 10 && reports.empty(); ++turns) {
    reports = children_.ended();
    int rank = 0;
    std::string text;
    while (ranks() > 1 && hear(rank, text)) {
      const auto words = parted(text);
      reports.push_back(
          {std::stoul(words.at(0)), static_cast<End>(std::stoi(words.at(1))), words.at(2), rank});
    }
    if (reports.empty()) {
      std::this_thread::sleep_for(turn);
    }
  }
  for (const Report& report : reports) {
    --at_work_[static_cast<std::size_t>(report.rank)];
  }
  return reports;
}

void Crew::serve() {
  for (;;) {
    int leader = 0;
    std::string text;
    while (hear(leader, text)) {
      auto words = parted(text);
      if (words.empty()) {
        dismissed_ = true;
        return;
      }
      const std::size_t unit = std::stoul(words.front());
      words.erase(words.begin());
      children_.start(unit, words);
    }
    for (const Report& report : children_.ended()) {
      say(0, joined({std::to_string(report.unit), std::to_string(static_cast<int>(report.end)),
                     report.reason}));
    }
    std::this_thread::sleep_for(turn);
  }
}

void Crew::dismiss() {
  for (int rank = 1; rank < ranks(); ++rank) {
    say(rank, "");
  }
  dismissed_ = true;
}

}  // namespace replay_many
