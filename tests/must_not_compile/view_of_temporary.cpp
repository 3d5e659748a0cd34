// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A view of a temporary that owns its cells would dangle.
// message: deleted
#include <Eigen/Core>

#include "fingerpad/adapt/eigen.hpp"

double first(const Eigen::ArrayXXd& owner);
double first(const Eigen::ArrayXXd& owner) {
#ifdef FINGERPAD_MUST_NOT_COMPILE
  return fingerpad::as_view(Eigen::ArrayXXd(owner))(0, 0);
#else
  return fingerpad::as_view(owner)(0, 0);
#endif
}
