// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// replay_many: processes a folder of recordings on all cores of one machine or, under MPI, of many.
// See --help.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "overview.hpp"
#include "recordings.hpp"

namespace {

using replay_many::Crew;
using replay_many::Path;

struct Arguments {
  Path recordings, out;
  bool raw = false, pictures = true;
  int jobs = 0;  ///< 0: one per core, or one per rank
  bool retry = false;
};

/// Locks the output folder until this process ends in any way.
void lock(const Path& out) {
  const int file = ::open((out / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file >= 0 && ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    replay::fail(out, "another run is writing to this folder");
  }
}

/// Later runs continue an earlier one, so all must have the same options; else throws Failure.
void expects_same(const Path& file, const std::string& options) {
  std::ifstream stream(file);
  std::string before;
  if (!std::getline(stream, before)) {
    replay::write_file(file, options + "\n");
  } else if (before != options) {
    replay::fail(file,
                 "was started with other options (" + before + "); choose another output folder");
  }
}

/// Processes the units; returns false, after printing the reason, if it had to stop.
bool worked_off(Crew& crew, std::vector<replay_many::Unit> units, const replay_many::Job& job) {
  try {
    replay_many::work_off(crew, std::move(units), job);
    return true;
  } catch (const replay::Failure& failure) {
    std::fprintf(stderr, "replay_many: stopped: %s; run the same command again to continue\n",
                 failure.what());
    return false;
  }
}

int lead(Crew& crew, const Arguments& arguments) {
  replay_many::Recordings recordings(arguments.recordings, arguments.out, arguments.raw,
                                     arguments.pictures);
  replay::make_folders(arguments.out);
  lock(arguments.out);
  std::filesystem::remove_all(arguments.out / "aside");
  replay::make_folders(arguments.out / "aside");
  expects_same(arguments.out / "options.txt",
               std::string(arguments.pictures ? "pictures" : "no pictures") +
                   (arguments.raw ? ", raw" : ""));
  if (!worked_off(crew, recordings.left(arguments.retry), recordings.job())) {
    return 3;
  }
  std::filesystem::remove_all(arguments.out / "aside");
  const auto counts = replay_many::write_overview(recordings, arguments.out);
  std::printf("recordings   %d done, %d failed\nframes       %lld\n", counts.done, counts.failed,
              counts.frames);
  for (const char* file : {"summary.csv", "all_frames.csv"}) {
    std::printf("%s %s\n", file == std::string("summary.csv") ? "tables      " : "            ",
                (arguments.out / file).c_str());
  }
  return counts.failed > 0 ? 1 : 0;
}

int run(Arguments arguments) {
  if (arguments.jobs == 0) {
    const auto cores = static_cast<int>(std::thread::hardware_concurrency());
    arguments.jobs = replay_many::has_ranks() ? 1 : (std::max)(cores, 1);
  }
  Crew crew(arguments.jobs);
  if (!crew.leads()) {
    crew.serve();
    return 0;
  }
  int status = 3;
  try {
    status = lead(crew, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "replay_many: %s\n", error.what());
  }
  crew.dismiss();
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  replay::limit_image_size(argv);
  if (argc > 2 && std::string(argv[1]) == "--unit") {
    return replay_many::run_unit({argv + 2, argv + argc});
  }
  CLI::App app(
      "Runs replay for each recording in a folder and its subfolders on all cores, or on all "
      "ranks\n"
      "under mpirun or srun. It can be killed at any moment; the same command continues.\n"
      "DIR receives complete results of each recording in recordings/NAME/, or the reason of a\n"
      "failure in failed/NAME.txt, and for all together summary.csv and all_frames.csv.");
  Arguments arguments;
  app.add_option("RECORDINGS", arguments.recordings, "folder with the recordings")->required();
  app.add_option("--out", arguments.out, "output folder")->option_text("DIR")->required();
  app.add_option("--jobs", arguments.jobs,
                 "number of processes; default: one per core, or one per rank")
      ->check(CLI::PositiveNumber);
  app.add_flag("--raw", arguments.raw, "as for replay");
  app.add_flag_callback(
      "--no-pictures", [&] { arguments.pictures = false; }, "as for replay");
  app.add_flag("--retry", arguments.retry, "process failed recordings again");
  app.footer(
      "Exit status: 0 all done, 1 some failed, 2 wrong arguments, 3 stopped: the output cannot be\n"
      "written, or the recordings are missing.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return run(arguments);
}
