// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Without exceptions and without a handler, a refusal prints its reason before it aborts.
#include <csignal>
#include <cstdlib>

#include "fingerpad/optics/camera.hpp"

int main() {
  std::signal(SIGABRT, [](int) { std::_Exit(0); });
  fingerpad::Camera<double> camera;
  camera.refractive_index = 0.9;
  fingerpad::expects_valid(camera);
  return 1;
}
