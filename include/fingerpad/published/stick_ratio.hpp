// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The stick ratio by reference update as printed: Ito, Kim, Obinata, "Robust slippage degree
// estimation based on reference update of vision-based tactile sensor", with its backup slides: the
// reference dot's motion, its four neighbours' rotation and the scale of all neighbours, the newest
// stored frame beyond U, positions averaged over neighbours. docs/errata.md, E032-E038.
#include "fingerpad/slip/stick_ratio.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

template <scalar S = float>
using StickRatio = fingerpad::StickRatio<ReferenceDotMotion<Freedom::similarity, PublishedScale>,
                                         UpdatedReference<>,
                                         DotMean,
                                         S>;

/// For a grid of rows x cols dots. Refuses bad parameters (parameter_error).
template <scalar S = float>
StickRatio<S> stick_ratio(Index rows, Index cols, const StickTest& test = {}) {
  return StickRatio<S>(rows, cols, test);
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
