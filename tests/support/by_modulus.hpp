// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Wrench::by_modulus() wrapped as a solver, so that the tests of the solvers also cover it.
#include <type_traits>

#include "fingerpad/force/wrench.hpp"

namespace test {

/// Tag of this solver in lists of types.
struct KnownModulus {
  static constexpr bool finds_tensions = false;
};

/// Estimator that ignores the shape. mu t is 0.5 N/mm unless the options set another.
template <class Row = fingerpad::OneRow, class S = double>
class ByModulus {
  using Wrench = fingerpad::
      Wrench<fingerpad::BalancedRim, Row, fingerpad::ClampedRim, fingerpad::StraightLines, S>;

 public:
  template <class Border>
  explicit ByModulus(const Border& border_mm,
                     fingerpad::WrenchOptions<S> options = {},
                     KnownModulus = {},
                     const Row& row = {},
                     const fingerpad::ClampedRim& law = {})
      : wrench_(border_mm, with_modulus(options), {}, row, law) {}

  auto workspace() const { return wrench_.workspace(); }
  using Workspace = typename Wrench::Workspace;
  template <class Shape, class Dots>
  fingerpad::WrenchResult<S> operator()(const Shape&,
                                        const Dots& side_dots_mm,
                                        const S& pressure_mpa,
                                        Workspace& work,
                                        const fingerpad::WrenchNoise<S>& noise = {}) const {
    return wrench_.by_modulus(side_dots_mm, pressure_mpa, work, noise);
  }

 private:
  static const fingerpad::WrenchOptions<S>& with_modulus(fingerpad::WrenchOptions<S>& options) {
    if (!options.calibrated_modulus_n_per_mm) {
      options.calibrated_modulus_n_per_mm = S(0.5);
    }
    return options;
  }

  Wrench wrench_;
};

/// Wrench, or ByModulus for the tag KnownModulus.
template <class Solver,
          class Row = fingerpad::OneRow,
          class Law = fingerpad::ClampedRim,
          class Lines = fingerpad::StraightLines,
          class S = double>
using WrenchBy = typename std::conditional_t<
    std::is_same_v<Solver, KnownModulus>,
    std::type_identity<ByModulus<Row, S>>,
    std::type_identity<fingerpad::Wrench<Solver, Row, Law, Lines, S>>>::type;

}  // namespace test
