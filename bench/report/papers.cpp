// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Every figure that the papers print, compared with the published methods and the defaults in the
// nearest experiment that is possible here. This is no google-benchmark program: it prints the
// Markdown tables of docs/papers.md. Each experiment is described where it is made:
//   papers/shape.hpp, location.hpp    noisy frames of finite-element membranes
//   papers/fluid.hpp                  colours by the model of light
//   papers/six_axis.hpp, rim.hpp      shapes, frames and side dots of these membranes
//   papers/look_up.hpp                contacts of these membranes
//   papers/slippage.hpp               dots of these membranes
//   papers/courses.hpp                courses of three figures over their steps
//   papers/preslip.hpp                simulated foam fingers
//   papers/rates.hpp                  time
//   papers/forms.hpp                  printed forms that no other table has
//   papers/other_rubber.hpp           dots of these membranes, of another rubber
// With the first word of a section's title (Shape, Position, Six-axis, ...) it prints only that
// section.
#include <iostream>
#include <string>

#include "papers/courses.hpp"
#include "papers/fluid.hpp"
#include "papers/forms.hpp"
#include "papers/location.hpp"
#include "papers/look_up.hpp"
#include "papers/other_rubber.hpp"
#include "papers/preslip.hpp"
#include "papers/rates.hpp"
#include "papers/rim.hpp"
#include "papers/shape.hpp"
#include "papers/six_axis.hpp"
#include "papers/slippage.hpp"

int main(int argc, char** argv) {
  using namespace bench::papers;
  const std::string only = argc > 1 ? argv[1] : "";
  const auto wanted = [&](const std::string& name) { return only.empty() || only == name; };
  const auto section = [&](const std::string& name, Section (*make)()) {
    if (wanted(name)) {
      print(std::cout, make());
    }
  };
  section("Shape", shape_section);
  section("Fluid", fluid_section);
  section("Contact", contact_section);
  section("Position", location_section);
  section("Six-axis", six_axis_section);
  if (wanted("rim")) {
    print_rim(std::cout);
  }
  if (wanted("rubber")) {
    print_other_rubber(std::cout);
  }
  section("Forces", look_up_section);
  section("Slippage", slippage_section);
  if (wanted("courses")) {
    print_courses(std::cout);
  }
  section("Pre-slip", preslip_section);
  if (wanted("forms")) {
    print_forms(std::cout);
  }
  section("Rates", rates_section);
  return 0;
}
