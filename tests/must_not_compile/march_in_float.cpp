// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Errors of the march inward from the rim grow like exp(m a / R): in float they are 0.03 mm.
// message: the march inward needs the digits of a double
#include "fingerpad/membrane/annulus.hpp"

#ifdef FINGERPAD_MUST_NOT_COMPILE
using Scalar = float;
#else
using Scalar = double;
#endif
static void march() {
  fingerpad::Annulus<Scalar> annulus({}, {});
  annulus.march(std::vector<Scalar>(annulus.parameters()));
}
int main() {
  (void)&march;
}
