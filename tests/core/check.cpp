// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/core/check.hpp"

#include <limits>
#include <string>

#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/optics/camera.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

template <class Action>
std::string refusal_of(const Action& action) {
  try {
    action();
  } catch (const parameter_error& error) {
    return error.what();
  }
  return "";
}

/// The message with which `Parameters` are refused when one field has this value; "" if accepted.
template <class Parameters>
std::string refusal_of_field(double Parameters::*field, double given) {
  Parameters p;
  p.*field = given;
  return refusal_of([&] { require(p); });
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string heard;
void listen(const char* message) {
  heard = message;
}
struct OwnError {};
void throw_own(const char*) {
  throw OwnError();
}

/// Checks that every bad value is refused with a message that names owner and field, and that every
/// good one is accepted.
template <class Parameters>
void check_field(double Parameters::*field,
                 const std::string& owner,
                 const std::string& name,
                 std::initializer_list<double> bad,
                 std::initializer_list<double> good) {
  INFO(owner + "::" + name);
  for (const double given : bad) {
    INFO(given);
    const std::string message = refusal_of_field(field, given);
    CHECK(message.rfind(owner + ": " + name + " = ", 0) == 0);
    CHECK(contains(message, ", must be "));
  }
  for (const double given : good) {
    INFO(given);
    CHECK(refusal_of_field(field, given) == "");
  }
}

}  // namespace

TEST_CASE("a refusal names owner, parameter, value and range", "[expects]") {
  const auto refuse_index = [] { expects(false, "Camera", "refractive_index", 0.9, ">= 1"); };
  REQUIRE(refusal_of(refuse_index) == "Camera: refractive_index = 0.9, must be >= 1");
  const auto refuse_count = [] { expects(false, "Window", "size", -3LL, "odd and >= 1"); };
  REQUIRE(refusal_of(refuse_count) == "Window: size = -3, must be odd and >= 1");
  REQUIRE_THROWS_AS(refuse_index(), std::invalid_argument);
}

TEST_CASE("a refusal prints every kind of number", "[expects]") {
  using test::Digits50;
  const auto message = [](auto x) {
    return refusal_of([&] { expects(false, "A", "b", x, "good"); });
  };
  REQUIRE(message(0.5f) == "A: b = 0.5, must be good");
  REQUIRE(message(0.5L) == "A: b = 0.5, must be good");
  REQUIRE(message(Digits50(-2)) == "A: b = -2, must be good");
  REQUIRE(message(test::Tangent<double>(3, 7)) == "A: b = 3, must be good");
  REQUIRE(contains(message(missing), "nan"));
  REQUIRE(contains(message(-infinity), "-inf"));
}

TEST_CASE("a table of parameters refuses the first that is out of its range", "[expects]") {
  const auto refusal = [](const auto& given, const Range& range) {
    return check(
        "A", {{"good", 1, finite_number}, {"b", given, range}, {"later", missing, finite_number}});
  };
  const std::string later = "A: later = nan, must be finite";
  CHECK(refusal(missing, finite_number) == "A: b = nan, must be finite");
  CHECK(refusal(infinity, finite_number) == "A: b = inf, must be finite");
  CHECK(refusal(-1e300, finite_number) == later);
  CHECK(refusal(0.0, positive) == "A: b = 0, must be finite and > 0");
  CHECK(refusal(infinity, positive) == "A: b = inf, must be finite and > 0");
  CHECK(refusal(5e-324, positive) == later);
  CHECK(refusal(-5e-324, not_negative) == "A: b = -4.94065646e-324, must be finite and >= 0");
  CHECK(refusal(0.0f, not_negative) == later);
  CHECK(refusal(0, at_least(1)) == "A: b = 0, must be >= 1");
  CHECK(refusal(1, at_least(1)) == later);
  CHECK(refusal(0.999, at_least(1)) == "A: b = 0.999, must be finite and >= 1");
  CHECK(refusal(1.5, within(0, 1)) == "A: b = 1.5, must be in [0, 1]");
  CHECK(refusal(test::Digits50(1), within(0, 1)) == later);
  CHECK(refusal(test::Tangent<double>(2, 1), within(0, 1)) == "A: b = 2, must be in [0, 1]");
  CHECK(refusal(4, odd_within(3, 109)) == "A: b = 4, must be odd, in [3, 109]");
  CHECK(refusal(-3LL, odd_within(-5, 5)) == later);
  CHECK(refusal(1000000, within(1, 10)) == "A: b = 1000000, must be in [1, 10]");
  CHECK(check("A", {{"b", 1, finite_number}}).empty());
}

TEST_CASE("nothing happens for good values", "[expects]") {
  REQUIRE_NOTHROW(expects(true, "A", "b", 1.0, "anything"));
  REQUIRE_NOTHROW(expects(true, "A", "b", 1LL, "anything"));
  REQUIRE_NOTHROW(require(Camera<>{}));
  REQUIRE_NOTHROW(require(Camera<test::Digits50>{}));
  REQUIRE_NOTHROW(require(Absorption<>{}));
  REQUIRE_NOTHROW(require(Absorption<test::Tangent<float>>{}));
}

TEST_CASE("the installed handler hears of a refusal first", "[expects]") {
  heard.clear();
  REQUIRE(set_refusal_handler(listen) == nullptr);
  expects(true, "A", "b", 1.0, "anything");
  CHECK(heard == "");
  CHECK_THROWS_AS(expects(false, "A", "b", 1.0, "2"), parameter_error);
  CHECK(heard == "A: b = 1, must be 2");

  CHECK(set_refusal_handler(throw_own) == listen);
  CHECK_THROWS_AS(refuse("no"), OwnError);

  CHECK(set_refusal_handler(nullptr) == throw_own);
  CHECK_THROWS_AS(refuse("no"), parameter_error);
}

TEST_CASE("a camera that cannot be is refused", "[expects][optics]") {
  using C = Camera<double>;
  const std::initializer_list<double> never = {missing, infinity, -infinity};
  for (const double bad : never) {
    CHECK(refusal_of_field(&C::center_x_px, bad) != "");
    CHECK(refusal_of_field(&C::center_y_px, bad) != "");
  }
  check_field(&C::plate_distance_mm, "Camera", "plate_distance_mm",
              {missing, infinity, -infinity, 0, -1}, {1e-3, 1e3});
  check_field(&C::refractive_index, "Camera", "refractive_index",
              {missing, infinity, 0, 0.999, -1.33}, {1, 1.33});
  check_field(&C::center_x_px, "Camera", "center_x_px", never, {-1e4, 0, 1e4});
  check_field(&C::center_y_px, "Camera", "center_y_px", never, {-1e4, 0, 1e4});
  check_field(&C::pitch_mm, "Camera", "pitch_mm", {missing, infinity, 0, -0.1}, {1e-6, 1});
  check_field(&C::pixel_aspect, "Camera", "pixel_aspect", {missing, infinity, 0, -1}, {0.9, 1.1});
  check_field(&C::distortion_k1, "Camera", "distortion_k1", never, {-0.2, 0, 0.3});
  check_field(&C::distortion_k2, "Camera", "distortion_k2", never, {-0.1, 0, 0.1});
  check_field(&C::plate_thickness_mm, "Camera", "plate_thickness_mm",
              {missing, infinity, -1e-9, 50, 51}, {0, 49.999});
  check_field(&C::plate_index, "Camera", "plate_index", {missing, infinity, 0, 0.999}, {1, 1.49});
}

TEST_CASE("a fluid that cannot be is refused", "[expects][absorption]") {
  using A = Absorption<double>;
  check_field(&A::c_red_per_mm, "Absorption", "c_red_per_mm",
              {missing, infinity, -infinity, 0, -0.01}, {1e-6, 0.0336});
  check_field(&A::c_green_per_mm, "Absorption", "c_green_per_mm", {missing, infinity, 0.028, -1},
              {0.029, 1});
  check_field(&A::kappa, "Absorption", "kappa", {missing, infinity, -infinity, 0, -1}, {1e-3, 10});
  check_field(&A::max_depth_mm, "Absorption", "max_depth_mm", {missing, infinity, 0, -18},
              {1e-3, 100});
  CHECK(contains(refusal_of_field(&A::c_green_per_mm, 0.028), "c_green_per_mm = 0.028"));
}
