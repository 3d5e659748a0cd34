// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "children.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>

#include "common/failure.hpp"

namespace replay_many {
namespace {

/// Runs in the new process, which may call only async-signal-safe functions before execv().
[[noreturn]] void become(char* const* arguments, int words, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) {
    ::_exit(1);
  }
  const int nowhere = ::open("/dev/null", O_RDWR);
  ::dup2(nowhere, STDIN_FILENO);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(words, STDERR_FILENO);
  ::execv("/proc/self/exe", arguments);
  ::_exit(127);
}

/// The last non-empty line.
std::string last_line(std::FILE* words) {
  std::rewind(words);
  std::string last, line;
  for (int c = std::fgetc(words); c != EOF; c = std::fgetc(words)) {
    if (c != '\n') {
      line += static_cast<char>(c);
    } else if (!line.empty()) {
      last = line;
      line.clear();
    }
  }
  return line.empty() ? last : line;
}

}  // namespace

void Children::start(std::size_t unit, const std::vector<std::string>& arguments) {
  // Messages are kept in memory, so that a full disk can be reported.
  std::unique_ptr<std::FILE, Close> words(::fdopen(::memfd_create("words", MFD_CLOEXEC), "w+"));
  if (!words) {
    replay::fail("memory for messages", std::strerror(errno));
  }
  std::vector<std::string> all = {"replay_many", "--unit"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& one : all) {
    pointers.push_back(one.data());
  }
  pointers.push_back(nullptr);
  const int file = ::fileno(words.get());
  const pid_t parent = ::getpid();
  const pid_t process = ::fork();
  if (process < 0) {
    replay::fail("a process", std::string("cannot be started: ") + std::strerror(errno));
  }
  if (process == 0) {
    become(pointers.data(), file, parent);
  }
  running_.push_back({unit, process, std::move(words)});
}

Report Children::report_of(const Child& child, int status) {
  Report report{child.unit};
  if (WIFSIGNALED(status)) {
    report.end = End::died;
    report.reason = std::string("its process died: ") + ::strsignal(WTERMSIG(status));
    return report;
  }
  const int code = WEXITSTATUS(status);
  const auto is = [code](End end) { return code == static_cast<int>(end); };
  if (is(End::done)) {
    return report;
  }
  report.reason = last_line(child.words.get());
  if (is(End::failed) || is(End::no_room) || is(End::missing)) {
    report.end = static_cast<End>(code);
  } else {
    report.end = End::died;
    report.reason += is(End::died) ? "" : " (status " + std::to_string(code) + ")";
  }
  return report;
}

std::vector<Report> Children::ended() {
  std::vector<Report> reports;
  for (auto child = running_.begin(); child != running_.end();) {
    int status = 0;
    if (::waitpid(child->process, &status, WNOHANG) == child->process) {
      reports.push_back(report_of(*child, status));
      child = running_.erase(child);
    } else {
      ++child;
    }
  }
  return reports;
}

}  // namespace replay_many
