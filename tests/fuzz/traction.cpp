// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Traction of any dots: a force is finite where there is one, a missing dot leaves the loads far
// from it as they were, and the same frame gives the same bits after any other.
#include "fingerpad/force/traction.hpp"

#include <cstdint>

#include "fuzz/dots.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;
using Dots = Grid<Point3<double>>;

namespace {

/// A curved sheet, stretched, with strange dots in it.
Dots sheet(Input& in, Index rows, Index cols, double stretch) {
  Dots dots(rows, cols, in.whole(0, 2));
  const double bulge = in.number(0, 0.1), noise = in.number(0, 0.2);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double x = static_cast<double>(j - cols / 2), y = static_cast<double>(i - rows / 2);
      const double off = noise * static_cast<double>((i * 7 + j * 13) % 5 - 2);
      dots.view()(i, j) = {1.5 * stretch * x + off, 1.5 * stretch * y - off,
                           12 - bulge * (x * x + y * y) + off};
    }
  }
  for (Index k = in.whole(0, 6); k > 0; --k) {
    dots.view()(in.whole(0, rows - 1), in.whole(0, cols - 1)) = {
        in.number(-20, 20), in.number(-20, 20), in.number(0, 20)};
  }
  return dots;
}

void require_same(const TractionResult<double>& a, const TractionResult<double>& b) {
  require(a.status == b.status && fuzz::same_bits(a.force_n, b.force_n) &&
              fuzz::same_bits(a.moment_n_mm, b.moment_n_mm) &&
              fuzz::same_bits(a.mu_t_n_per_mm, b.mu_t_n_per_mm),
          "the same frame gives the same bits, whatever came before");
}

void try_traction(Input& in) {
  const Index rows = in.whole(0, 14), cols = in.whole(0, 14);
  expects(rows > 0 && cols > 0, "fuzz", "rows", 0LL, "> 0");
  TractionOptions<double> options;
  const bool given = in.flag();
  if (given) {
    options.mu_t_n_per_mm = in.number(0.01, 2);
  }
  options.min_free_dots = in.whole(1, 60);
  options.ring_dots = in.whole(0, 5);
  options.fade_dots = in.whole(0, 20);
  TractionField field(sheet(in, rows, cols, 1).view(), options);
  TractionField fresh = field;
  const Dots dots = sheet(in, rows, cols, in.number(1, 2)), other = sheet(in, rows, cols, 1);
  const Grid<std::uint8_t> contact = fuzz::any_contact(in, rows, cols);
  const double pressure_mpa = in.number(0, 0.05);
  (void)fuzz::frame([&] { return field(other.view(), contact.view(), 0.01); });
  const auto r = fuzz::frame([&] { return field(dots.view(), contact.view(), pressure_mpa); });
  require_same(r, fresh(dots.view(), contact.view(), pressure_mpa));
  require(!r.has_force() || (is_finite(r.force_n) && is_finite(r.moment_n_mm)),
          "a force is finite");
  if (!given) {
    return;
  }
  // one dot less: what lies far away stays
  Dots holed = dots;
  const Index row = in.whole(0, rows - 1), col = in.whole(0, cols - 1);
  holed.view()(row, col).x = not_a_number<double>();
  const auto h = fresh(holed.view(), contact.view(), pressure_mpa);
  if (!r.has_force() || !h.has_force()) {
    return;
  }
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const bool is_near = std::abs(i - row) <= 3 && std::abs(j - col) <= 3;
      require(is_near || fuzz::same_bits(field.load_mpa()(i, j), fresh.load_mpa()(i, j)),
              "a missing dot leaves the loads far from it as they were");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, try_traction);
}
