// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The work of one process: a recording, a part of one, or the parts joined.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <new>
#include <opencv2/core/utility.hpp>
#include <system_error>

#include "common/failure.hpp"
#include "common/recording.hpp"
#include "fingerpad/core/check.hpp"
#include "recordings.hpp"
#include "replay/foam/recording.hpp"

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

/// The first frame to compute for files from frame `first` on. Dots are tracked from frame to
/// frame, so with dots all earlier frames are computed, too; without dots none.
int warm_up(const Path& folder, int first) {
  const replay::Sensor sensor = replay::read_sensor(folder / "sensor.json");
  return sensor.dots || fs::exists(folder / "dots.csv") ? 0 : first;
}

/// Processes a recording and writes files for frames [first, last), or for all if last < 0.
void do_recording(const std::vector<std::string>& arguments) {
  replay::Options options;
  options.recording = arguments.at(1);
  const Path out = arguments.at(2);
  const Path place = arguments.at(3);
  const int first = std::stoi(arguments.at(4));
  const int last = std::stoi(arguments.at(5));
  for (std::size_t k = 6; k < arguments.size(); ++k) {
    options.raw = options.raw || arguments[k] == "--raw";
    options.pictures = options.pictures && arguments[k] != "--no-pictures";
  }
  const bool is_part = last >= 0;
  if (is_part) {
    options.files = {first, last};
  }
  if (last > first) {
    options.range = {warm_up(options.recording, first), last};
  }
  const Aside aside(out);
  options.out = aside.growing();
  if (replay::run(options) != 0) {
    throw Interrupted();
  }
  replay::publish_folder(options.out, place);
}

bool is_of_a_frame(const Path& file) {
  const std::string stem = file.stem().string();
  return stem.size() >= 6 && stem.find_first_not_of("0123456789", stem.size() - 6) == stem.npos;
}

/// Joins parts: the first has the tables and charts, the others add the files of their frames.
void join_parts(const std::vector<std::string>& arguments) {
  const Path out = arguments.at(1);
  const Path place = arguments.at(2);
  const Aside aside(out);
  const Path whole = aside.growing();
  fs::create_directory(whole);
  for (std::size_t k = 3; k < arguments.size(); ++k) {
    const Path part = arguments[k];
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(part)) {
      const Path to = whole / entry.path().lexically_relative(part);
      if (entry.is_directory()) {
        fs::create_directories(to);
      } else if (k == 3 || is_of_a_frame(to)) {
        fs::create_hard_link(entry.path(), to);  // parts stay complete until the whole is in place
      }
    }
  }
  replay::publish_folder(whole, place);
  fs::remove_all(Path(arguments.at(3)).parent_path());
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
  const bool joins = arguments.at(0) == "join";
  const Path out = arguments.at(joins ? 1 : 2);
  const auto ended = [&](End end, const std::string& why) {
    std::fprintf(stderr, "%s%s\n", why.c_str(), end == End::no_room ? room_in(out).c_str() : "");
    return static_cast<int>(end);
  };
  const auto fault_of = [&](const std::string& message) {
    return is_of_output(message, out) ? End::no_room : End::failed;
  };
  try {
    cv::setNumThreads(1);  // the other cores process other units
    if (std::error_code error; !joins && !fs::is_directory(arguments.at(1), error)) {
      return ended(End::missing, arguments[1] + ": there is no such folder");
    }
    joins ? join_parts(arguments) : do_recording(arguments);
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
