// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The tables of docs/hard_cases.md. First table: the loss of accuracy of the published or textbook
// form of a formula in its hard cases, and that of fingerpad's form, in float and in double against
// 50 digits. Inputs are rounded to the type first, so the whole error belongs to the form.
// tests/figures/naive_forms.cpp asserts every row. Second table: cases that are hard in any
// number type.
#include <iostream>

#include "hard_cases/all.hpp"
#include "hard_cases/by_nature.hpp"

int main() {
  std::cout << "| method | hard case; error | naive, float | naive, double | fingerpad, float | "
               "fingerpad, double | how |\n"
            << "|---|---|--:|--:|--:|--:|---|\n";
  for (const hard::MakeRow make : hard::all_rows()) {
    std::cout << hard::line_of(make()) << '\n';
  }
  std::cout << "\nCases that are hard in any number type, with the published method next to the "
               "default:\n\n"
            << "| method | hard case | figure | published | default |\n|---|---|---|--:|--:|\n";
  for (const hard::CaseByNature& c : hard::cases_by_nature()) {
    std::cout << hard::line_of(c) << '\n';
  }
}
