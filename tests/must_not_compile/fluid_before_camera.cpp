// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The message names both types that were exchanged.
// message: no known conversion.*Absorption<.*Camera<
#include "fingerpad/depth/depth.hpp"

static fingerpad::DepthEstimator<> good_or_bad(const fingerpad::DepthReference<float>& reference) {
  const fingerpad::Camera<> camera;
  const fingerpad::Absorption<> fluid;
#ifdef FINGERPAD_MUST_NOT_COMPILE
  return fingerpad::DepthEstimator<>(fluid, camera, reference);
#else
  return fingerpad::DepthEstimator<>(camera, fluid, reference);
#endif
}
int main() {
  (void)&good_or_bad;
}
