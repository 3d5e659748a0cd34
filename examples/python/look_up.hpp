// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Forces by look-up, as arguments of a fingertip.
#include "fingerpad/force/normal_force.hpp"
#include "fingerpad/force/shear.hpp"

namespace python {

using NormalForce =
    fingerpad::NormalForce<fingerpad::PolynomialForce<5>, fingerpad::ScaledCompensation<>>;
using Shear = fingerpad::Shear<fingerpad::RadialShear<4>>;

}  // namespace python
