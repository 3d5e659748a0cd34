// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The forces by look-up that a fingertip takes.
#include "fingerpad/force/normal_force.hpp"
#include "fingerpad/force/shear.hpp"

namespace python {

using NormalForce =
    fingerpad::NormalForce<fingerpad::PolynomialForce<5>, fingerpad::ScaledCompensation<>>;
using Shear = fingerpad::Shear<fingerpad::RadialShear<4>>;

}  // namespace python
