// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The scalar is the last of the types: the first error says which types precede it.
// first error: the scalar comes last: StickRatio<StickConsensus<>, UpdatedReference, ResidualMean,
// double>
#include "fingerpad/slip/stick_ratio.hpp"

using namespace fingerpad;

#ifdef FINGERPAD_MUST_NOT_COMPILE
static void good_or_bad() {
  const StickRatio<double> stick_ratio(9, 9);
  (void)stick_ratio;
}
#else
static void good_or_bad() {
  const StickRatio<StickConsensus<>, UpdatedReference, ResidualMean, double> stick_ratio(9, 9);
  (void)stick_ratio;
}
#endif
int main() {
  good_or_bad();
}
