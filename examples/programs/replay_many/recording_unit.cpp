// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The work of one process: a recording.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <new>
#include <opencv2/core/utility.hpp>
#include <system_error>

#include "common/failure.hpp"
#include "fingerpad/core/check.hpp"
#include "recordings.hpp"
#include "replay/replay.hpp"

namespace replay_many {
namespace {

namespace fs = std::filesystem;

/// A folder in OUT/aside for this process only. If the process is killed, the next run removes it.
class Aside {
 public:
  explicit Aside(const Path& out) {
    std::string name = (out / "aside" / "XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      replay::fail(out / "aside", "cannot be written: " + std::generic_category().message(errno));
    }
    folder_ = name;
  }
  ~Aside() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Aside(const Aside&) = delete;
  Aside& operator=(const Aside&) = delete;
  Path growing() const { return folder_ / "out"; }

 private:
  Path folder_;
};

struct Interrupted {};

void do_recording(const std::vector<std::string>& arguments) {
  replay::Options options;
  options.recording = arguments.at(0);
  const Path out = arguments.at(1);
  for (std::size_t k = 3; k < arguments.size(); ++k) {
    options.raw = options.raw || arguments[k] == "--raw";
    options.pictures = options.pictures && arguments[k] != "--no-pictures";
  }
  const Aside aside(out);
  options.out = aside.growing();
  if (replay::run(options) != 0) {
    throw Interrupted();
  }
  replay::publish_folder(options.out, arguments.at(2));
}

/// The free space on the output's file system, as text.
std::string room_in(const Path& out) {
  std::error_code error;
  const auto space = fs::space(out, error);
  return error ? "" : " (" + std::to_string(space.available >> 20U) + " MiB are free)";
}

/// Whether a message begins with a path in the output.
bool is_of_output(const std::string& message, const Path& out) {
  return message.rfind(out.string() + "/", 0) == 0;
}

}  // namespace

int run_unit(const std::vector<std::string>& arguments) {
  const Path out = arguments.at(1);
  const auto ended = [&](End end, const std::string& why) {
    std::fprintf(stderr, "%s%s\n", why.c_str(), end == End::no_room ? room_in(out).c_str() : "");
    return static_cast<int>(end);
  };
  const auto fault_of = [&](const std::string& message) {
    return is_of_output(message, out) ? End::no_room : End::failed;
  };
  try {
    cv::setNumThreads(1);  // the other cores process other units
    if (std::error_code error; !fs::is_directory(arguments[0], error)) {
      return ended(End::missing, arguments[0] + ": there is no such folder");
    }
    do_recording(arguments);
    return static_cast<int>(End::done);
  } catch (const replay::Failure& failure) {
    return ended(fault_of(failure.what()), failure.what());
  } catch (const fs::filesystem_error& error) {
    return ended(fault_of(error.path1().string()), error.what());
  } catch (const Interrupted&) {
    return ended(End::died, "interrupted");
  } catch (const std::bad_alloc&) {
    return ended(End::died, "not enough memory");
  } catch (const std::exception& error) {
    return ended(End::failed, error.what());
  }
}

}  // namespace replay_many
