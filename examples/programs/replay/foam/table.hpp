// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Writes frames.csv of a foam recording.
#include <filesystem>
#include <fstream>

#include "replay/foam/step.hpp"

namespace replay {

/// "finger1_" or similar if there are several fingers, else empty.
std::string finger_prefix(std::size_t finger, std::size_t fingers);

class FoamCsv {
 public:
  FoamCsv(const std::filesystem::path& file, const FoamRecording& recording);
  void write(const FoamRow& row);
  void close();  ///< throws Failure where anything could not be written

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  std::vector<FingerPlace> fingers_;
};

}  // namespace replay
