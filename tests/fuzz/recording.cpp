// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// What replay reads but videos, with any bytes in it: each file is read, or refused by one line.
// with: examples/programs/common/sensor.cpp examples/programs/common/table.cpp
// with: examples/programs/common/signals.cpp examples/programs/common/images.cpp
// with: examples/programs/common/stress_free_dots.cpp examples/programs/common/true_forces.cpp
// with: examples/programs/replay/dots/file.cpp
// with: examples/programs/replay/foam/sensor.cpp examples/programs/replay/foam/recording.cpp
// with: examples/programs/replay/foam/faults.cpp
// with: -lopencv_core -lopencv_imgproc -lopencv_imgcodecs
#include "replay/foam/recording.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/sensor.hpp"
#include "common/signals.hpp"
#include "common/stress_free_dots.hpp"
#include "common/true_forces.hpp"
#include "fuzz/file.hpp"
#include "fuzz/input.hpp"
#include "replay/dots/file.hpp"
#include "replay/foam/sensor.hpp"

using fuzz::require;

namespace {

/// As the file that the first byte names.
void read(std::uint8_t kind, const std::filesystem::path& path) {
  switch (kind % 11) {
    case 0:
      (void)replay::read_sensor(path);
      break;
    case 1:
      (void)replay::read_signals(path, 10);
      break;
    case 2:
      (void)replay::read_foam_sensor(path);
      break;
    case 3:
      (void)replay::read_colour_image(path);
      break;
    case 4:
      (void)replay::read_depth_image(path);
      break;
    case 5:
    case 6:
      (void)replay::read_stress_free_dots(path, {8, 8});
      break;
    case 7:
      (void)replay::read_true_forces(path, 10);
      break;
    case 8: {
      const auto table = replay::read_taxels(path);
      const auto readings = static_cast<std::size_t>(table.samples()) * table.taxels();
      require(table.readings.size() == readings,
              "a table has a reading of each taxel in each sample");
      break;
    }
    case 9:
      (void)replay::read_dots(path, 10, {});
      break;
    default:
      (void)replay::read_dots(path, 10, cv::Size(8, 8));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::File file;
  if (size == 0) {
    return 0;
  }
  const std::string content(reinterpret_cast<const char*>(data + 1), size - 1);
  const auto& path = file.with(content);
  try {
    read(data[0], path);
  } catch (const replay::Failure& failure) {
    require(std::string(failure.what()).find('\n') == std::string::npos, "a refusal is one line");
  }
  return 0;
}
