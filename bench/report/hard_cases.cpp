// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The table of docs/hard_cases.md: what the published or textbook form of a formula loses where it
// is hard, and what fingerpad's loses there, in float and in double against 50 digits. Inputs are
// rounded to the type first, so that all of the error is the form's. tests/hard_cases/naive_forms.cpp
// asserts every row.
#include <iostream>

#include "hard_cases/all.hpp"

int main() {
  std::cout << "| method | hard case; error | naive, float | naive, double | fingerpad, float | "
               "fingerpad, double | how |\n"
            << "|---|---|--:|--:|--:|--:|---|\n";
  for (const hard::MakeRow make : hard::all_rows()) {
    std::cout << hard::line_of(make()) << '\n';
  }
}
