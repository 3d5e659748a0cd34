// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Writes the bundled foam recording:
//   foam_recording examples/data/foam/taxels.csv
#include <cstdio>
#include <fstream>

#include "recording.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: foam_recording TAXELS.csv\n");
    return 2;
  }
  std::ofstream file(argv[1]);
  file << foam::recording();
  file.close();
  if (!file) {
    std::fprintf(stderr, "%s: cannot be written\n", argv[1]);
    return 1;
  }
}
