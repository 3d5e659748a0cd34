// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Detects incipient slip of an object that drags the membrane along. Slip starts at the edge of the
// contact; the stick ratio shows it long before the whole object slips.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "fingerpad/slip/stick_ratio.hpp"

using namespace fingerpad;

int main() {
  constexpr Index n = 21;  // dots 19.5 px apart; any grid of points with x and y works
  std::vector<Point2<float>> dots(n * n);
  std::vector<unsigned char> contact(n * n);
  for (Index k = 0; k < n * n; ++k) {
    const float col = float(k % n - 10), row = float(k / n - 10);
    dots[std::size_t(k)] = {320 + 19.5F * col, 240 + 19.5F * row};
    contact[std::size_t(k)] = std::hypot(col, row) < 8 ? 1 : 0;
  }
  const StridedView<const Point2<float>> dot_grid(dots.data(), n, n, n);
  const StridedView<const unsigned char> contact_grid(contact.data(), n, n, n);

  StickRatio stick(n, n);  // once
  double last = 1;
  for (int frame = 0; frame <= 12; ++frame) {
    const auto seen = stick(dot_grid, contact_grid);  // every frame
    if (seen.updated()) {
      std::printf("frame %2d: stick ratio %.2f (%td of %td dots), %s\n", frame, seen.stick_ratio,
                  seen.stick, seen.dots_in_contact(),
                  seen.stick_ratio < 0.5 ? "grip harder" : "ok");
      last = seen.stick_ratio;
    } else {
      std::printf("frame %2d: %s\n", frame, name_of(seen.status));
    }
    for (std::size_t k = 0; k < dots.size(); ++k) {  // the object moves by 1 px; dots far from
      const Index row = Index(k) / n - 10;           // the center follow less and less
      const Index col = Index(k) % n - 10;
      const float slipping = std::hypot(float(col), float(row)) - (8 - 0.6F * float(frame));
      dots[k].x += std::clamp(1 - slipping, 0.0F, 1.0F);
    }
  }
  return last < 0.2 ? 0 : 1;
}
