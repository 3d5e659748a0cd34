// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A colour image of xtensor is not a channel: the first error says what to pass.
// first error: a grid has two dimensions: pass one plane of the tensor
#if __has_include(<xtensor/containers/xtensor.hpp>)
#include <xtensor/containers/xtensor.hpp>
#include <xtensor/views/xview.hpp>
#else
#include <xtensor/xtensor.hpp>
#include <xtensor/xview.hpp>
#endif

#include "fingerpad/adapt/xtensor.hpp"

xt::xtensor<double, 3> image({480, 640, 3});

int main() {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  (void)fingerpad::rows(image);
#else
  (void)fingerpad::rows(xt::view(image, xt::all(), xt::all(), 1));
#endif
}
