// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The contact of an object with a foam finger, to make test signals and to explain the rules of
// pre-slip. Source: "Pre-slip sensing using tactile sensor" (2007), section 3, eqs. 1-10; published
// and corrected forms in docs/errata.md, E039-E041.
//
//   F = K N^beta, A = pi R depth             friction, contact area   contact_friction.hpp
//   m y'' + c (y' - y_ie') + k (y - y_ie)    mass-spring-damper       mass_spring_damper.hpp
//     = f(t)
//   f = A + B t, cbrt(C + D sin at)(A + B t) loads in slip, in a lift slip_load.hpp
//   Kelvin-Voigt and Maxwell in series       creep                    creep.hpp
//
// docs/sim/foam_contact.md says what the model can predict and what it cannot.
#include "fingerpad/sim/contact_friction.hpp"
#include "fingerpad/sim/creep.hpp"
#include "fingerpad/sim/mass_spring_damper.hpp"
#include "fingerpad/sim/slip_load.hpp"
