// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/frame_table.hpp"

#include <algorithm>
#include <string>

#include "support/catch.hpp"
#include "support/files.hpp"

using namespace fingerpad;

namespace {

/// The cell of a column in a table of this row alone.
std::string written(const replay::FrameRow& row, const std::string& column) {
  const test::ScratchFolder folder;
  const auto file = folder.path() / "frames.csv";
  replay::TableWriter table(file, replay::frame_columns());
  table.write(row);
  table.close();
  replay::Table read(file);
  REQUIRE(read.next());
  const auto at = std::find(read.header().begin(), read.header().end(), column);
  return read.cells().at(static_cast<std::size_t>(at - read.header().begin()));
}

}  // namespace

TEST_CASE("frames.csv: the stick ratio is that of dots and friction together") {
  replay::FrameRow row;
  row.has_dots = true;
  row.touch.stick.status = StickStatus::falls_back;
  row.touch.stick.stick_ratio = 0.2;  // the last one of the dots, before the object reversed
  row.touch.slip.stick_ratio = 0.9;
  row.touch.slip.ratio_sd = 0.15;
  row.touch.slip.update = RatioUpdate::fresh;
  CHECK(written(row, "stick_ratio") == "0.900000");
  CHECK(written(row, "stick_ratio_sd") == "0.150000");
  CHECK(written(row, "stick_ratio_updated") == "1");
  CHECK(written(row, "slip_status") == "ok");
  row.touch.slip.in_doubt = true;
  CHECK(written(row, "slip_status") == "doubtful");
  row.touch.stick.far_apart = true;
  CHECK(written(row, "slip_status") == "framesfarapart");  // read without blanks
  row.touch.slip.update = RatioUpdate::missing;
  CHECK(written(row, "slip_status") == "fallsback");
}

TEST_CASE("frames.csv: a force by look-up is no surer than the contact that it is looked up by") {
  replay::FrameRow row;
  row.has_depth = row.has_curves = true;
  row.touch.contact.status = FrameStatus::ok;
  row.touch.normal.status = ForceStatus::measured;
  CHECK(written(row, "look_up_status") == "ok");
  row.touch.contact_in_doubt = true;
  CHECK(written(row, "look_up_status") == "contactindoubt");  // read without blanks
}
