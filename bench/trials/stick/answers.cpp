// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "answers.hpp"

#include <cmath>
#include <cstdio>

#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/pad.hpp"

namespace stick_table {
namespace {

using fingerpad::Point3;

constexpr double pixel_mm = 0.005 / 0.06;

/// Root mean square error of the dots found along x and along y.
double noise_of(const Recording& r) {
  double sum = 0, count = 0;
  for (const Frame& f : r.frames) {
    for (std::size_t k = 0; k < f.found.cells.size(); ++k) {
      const Point3<double> off = f.found.cells[k] - f.place.cells[k];
      const double sq = off.x * off.x + off.y * off.y;
      sum += fingerpad::is_finite(sq) ? sq : 0;
      count += fingerpad::is_finite(sq) ? 2 : 0;
    }
  }
  return std::sqrt(sum / count);
}

}  // namespace

Answers& Answers::operator+=(const Answers& o) {
  asked += o.asked;
  told += o.told;
  kept += o.kept;
  far_apart += o.far_apart;
  missed += o.missed;
  falsely += o.falsely;
  within_2_sd += o.within_2_sd;
  within_5_sd += o.within_5_sd;
  error += o.error;
  sd += o.sd;
  return *this;
}

Answers answers(const Recording& recording, const Conditions& c) {
  test::Random random(c.seed);
  const double along = c.noise_px * pixel_mm;
  const Dots& first = recording.frames.front().found;
  fingerpad::StickRatio<> stick(
      first.rows(), first.cols(),
      {.noise = c.noise_is_given ? std::hypot(along, noise_of(recording)) : 0});
  fingerpad::FrictionLimit<> limit;
  Answers a;
  std::vector<std::size_t> seen;
  for (std::size_t k = 0; k < recording.frames.size(); k += static_cast<std::size_t>(c.every)) {
    const Frame& frame = recording.frames[k];
    seen.push_back(k);
    Dots dots = frame.found;
    for (Point3<double>& p : dots.cells) {
      const double x = random.normal(), y = random.normal(), z = random.normal();
      p = p + along * Point3<double>{x, y, 5 * z};
    }
    const auto seen_by_dots = stick(dots, frame.in_contact, frame.time_s);
    const auto slip =
        limit(fingerpad::contact_load(frame.force_n, frame.moment_n_mm, dots, frame.in_contact),
              seen_by_dots);
    const auto truth = recording.asks(k) ? recording.truth(seen) : std::nullopt;
    if (c.prints_each) {
      std::printf(
          "%-12s %3zu true %5.3f told %5.3f +- %5.3f  dots %5.3f +- %5.3f %-12s back %5.3f "
          "L %5.3f limit %5.3f %s\n",
          recording.name.c_str(), k, truth.value_or(test::nan), slip.stick_ratio, slip.ratio_sd,
          seen_by_dots.stick_ratio, seen_by_dots.ratio_sd, name_of(seen_by_dots.status),
          seen_by_dots.back_ratio, slip.friction, slip.limit, name_of(slip.status));
    }
    if (!truth) {
      continue;
    }
    ++a.asked;
    if (slip.ok()) {
      const double error = std::fabs(slip.stick_ratio - *truth);
      ++a.told;
      a.kept += slip.updated() ? 0 : 1;
      a.far_apart += seen_by_dots.far_apart ? 1 : 0;
      a.error += error;
      a.sd += slip.ratio_sd;
      a.missed += slip.stick_ratio > 0.5 && *truth < 0.2 ? 1 : 0;
      a.falsely += slip.stick_ratio < 0.5 && *truth > 0.8 ? 1 : 0;
      a.within_2_sd += error <= 2 * slip.ratio_sd ? 1 : 0;
      a.within_5_sd += error <= 5 * slip.ratio_sd ? 1 : 0;
    }
  }
  return a;
}

}  // namespace stick_table
