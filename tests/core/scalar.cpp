// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/core/scalar.hpp"

#include <cstdint>
#include <limits>
#include <string>

#include "support/catch.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using test::Digits50;
using test::Tangent;

static_assert(scalar<float> && scalar<double> && scalar<long double>);
static_assert(scalar<Digits50> && scalar<Tangent<double>> && scalar<Tangent<float>>);
static_assert(!scalar<int> && !scalar<bool> && !scalar<char> && !scalar<void*>);
static_assert(!scalar<std::string> && !scalar<const double> && !scalar<double&>);
// Sums that are expressions and hold references would dangle in `auto`.
using Lazy50 = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                             boost::multiprecision::et_on>;
static_assert(!scalar<Lazy50>);

static_assert(std::same_as<scalar_real_t<float>, float>);
static_assert(std::same_as<scalar_real_t<Digits50>, Digits50>);
static_assert(std::same_as<scalar_real_t<Tangent<float>>, float>);

// Functions without mathematics are usable at compile time.
static_assert(value(2.5) == 2.5 && square(3.0f) == 9.0f);
static_assert(epsilon<float>() == (std::numeric_limits<float>::epsilon)());
static_assert(is_finite(1.0));

TEMPLATE_TEST_CASE("every scalar has a value, an epsilon, NaN and infinities",
                   "[scalar]",
                   float,
                   double,
                   long double,
                   Digits50,
                   Tangent<float>,
                   Tangent<Digits50>) {
  using S = TestType;
  using R = scalar_real_t<S>;
  const R infinity = (std::numeric_limits<R>::infinity)();
  const R largest = (std::numeric_limits<R>::max)();

  REQUIRE(value(S(3)) == R(3));
  REQUIRE(epsilon<S>() == (std::numeric_limits<R>::epsilon)());
  REQUIRE(value(square(S(-3))) == R(9));

  const R nan = value(not_a_number<S>());
  REQUIRE(nan != nan);
  REQUIRE_FALSE(is_finite(not_a_number<S>()));
  REQUIRE_FALSE(is_finite(S(infinity)));
  REQUIRE_FALSE(is_finite(S(-infinity)));
  REQUIRE(is_finite(S(0)));
  REQUIRE(is_finite(S(largest)));
  REQUIRE(is_finite(S(-largest)));
  REQUIRE(is_plausible(S(999999)));
  REQUIRE(is_plausible(S(-999999)));
  for (const S& none : {S(1000000), S(-1000000), S(infinity), S(-infinity), not_a_number<S>()}) {
    REQUIRE_FALSE(is_plausible(none));
  }
}

TEST_CASE("the value of a dual number leaves its derivative out", "[scalar]") {
  const Tangent<double> x(2, 5);
  REQUIRE(value(x) == 2);
  REQUIRE(square(x).d == 20);
  REQUIRE(is_finite(Tangent<double>(1, not_a_number<double>())));  // branches use values only
}
