// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The samples to be remembered grow as the factorial of the fingers that must differ at once.
// message: at most three coordinates
#include "fingerpad/foam/preslip.hpp"

#ifdef FINGERPAD_MUST_NOT_COMPILE
using Pairing = fingerpad::SamePair;
#else
using Pairing = fingerpad::AnyPair;
#endif
int main() {
  const fingerpad::Preslip<fingerpad::GraspOptimise<Pairing>, 4, fingerpad::ConstantTime> preslip;
  auto state = preslip.start();
  return preslip({}, state).alarm ? 1 : 0;
}
