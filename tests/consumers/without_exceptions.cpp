// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Without exceptions, a refusal tells the installed handler before it aborts.
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "fingerpad/optics/camera.hpp"

int main() {
  std::signal(SIGABRT, [](int) { std::_Exit(0); });
  fingerpad::set_refusal_handler([](const char* message) { std::fputs(message, stderr); });
  fingerpad::Camera<double> camera;
  camera.refractive_index = 0.9;
  fingerpad::require(camera);
  return 1;
}
