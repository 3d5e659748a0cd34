// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Recordings of printed dots with the true slip.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "fingerpad/core/point.hpp"
#include "support/pad.hpp"

namespace stick_table {

using Dots = test::Image<fingerpad::Point3<double>>;

struct Frame {
  double time_s = 0;
  double contact_mm2 = 0;  ///< true
  double stick_share = 1;  ///< true, of the area since the frame before
  fingerpad::Point3<double> force_n = {}, moment_n_mm = {};  ///< measured; NaN: not known
  Dots found, place, on_object;          ///< measured; true; in the object's frame, in contact
  test::Image<std::uint8_t> in_contact;  ///< measured
};

struct Recording {
  std::string name;
  std::vector<Frame> frames;
  double largest_mm2 = 0;  ///< contact

  /// Throws replay::Failure if a table is missing or has other columns.
  explicit Recording(const std::filesystem::path& folder);

  /// Frames in which a ratio is asked for: beyond the first touch.
  bool asks(std::size_t frame) const;
  /// Share of the dots in contact that have slipped on the object by less than 1 / 18.6 of the
  /// longest way since the newest of the `seen` frames from which a dot has moved by 0.16 mm, of
  /// the twelve before; the share of the area since the frame before if there is none. Empty: not
  /// enough dots.
  std::optional<double> truth(const std::vector<std::size_t>& seen) const;
};

}  // namespace stick_table
