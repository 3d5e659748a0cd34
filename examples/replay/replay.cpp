// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay.hpp"

#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <stdexcept>

#include "chain.hpp"
#include "failure.hpp"
#include "progress.hpp"
#include "recording.hpp"
#include "writer.hpp"

namespace replay {
namespace {

volatile std::sig_atomic_t interrupted = 0;
void interrupt(int /*signal*/) {
  interrupted = 1;
}

Range within(const Range& range, int size, const std::filesystem::path& recording) {
  const int last = range.last.value_or(size);
  if (range.first >= last || last > size) {
    fail(recording, "holds frames 0 to " + std::to_string(size - 1) + ", so --frames " +
                        std::to_string(range.first) + ":" + std::to_string(last) +
                        " names none or too many");
  }
  return {range.first, last};
}

void print_summary(const Chain& chain,
                   const Writer& writer,
                   const Recording& recording,
                   const Options& options) {
  double valid_share = 0;
  double deepest_mm = 0;
  double largest_mm2 = 0;
  int in_contact = 0;
  for (const FrameRow& row : writer.rows()) {
    valid_share += row.valid_share;
    deepest_mm = std::fmax(deepest_mm, row.depth_max_mm);
    largest_mm2 = std::fmax(largest_mm2, row.contact.area_mm2);
    in_contact += row.contact.in_contact() ? 1 : 0;
  }
  const auto frames = static_cast<double>(writer.rows().size());
  std::printf("frames       %zu\n", writer.rows().size());
  std::printf("size         %d x %d px, %g mm/px\n", recording.reference.cols,
              recording.reference.rows, recording.sensor.camera.pitch_mm);
  std::printf("valid        %.2f %% of the pad's pixels\n", 100 * valid_share / frames);
  std::printf("deepest      %.2f mm\n", deepest_mm);
  std::printf("contact      in %d frames, at most %.1f mm^2\n", in_contact, largest_mm2);
  std::printf("dots         %td, %s\n", fingerpad::count_present(chain.dots().initial()),
              chain.dots().how().c_str());
  std::printf("depth step   %.2f ms a frame (median)\n", chain.depth_ms());
  std::printf("contact step %.2f ms a frame (median)\n", chain.contact_ms());
  std::printf("table        %s\n", (writer.place() / "frames.csv").c_str());
  if (options.raw) {
    std::printf("depth maps   %s\n", (writer.place() / "depth").c_str());
    std::printf("masks        %s\n", (writer.place() / "contact").c_str());
  }
  if (options.pictures) {
    std::printf("pictures     %s; montage.png first\n", (writer.place() / "pictures").c_str());
  }
}

}  // namespace

Range parse_range(const std::string& text) {
  const auto colon = text.find(':');
  const auto number = [&](const std::string& digits) {
    int value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size() || value < 0) {
      throw std::invalid_argument("'" + text + "' is not of the form A:B, as in 3:10");
    }
    return value;
  };
  if (colon == std::string::npos) {
    throw std::invalid_argument("'" + text + "' is not of the form A:B, as in 3:10");
  }
  Range range;
  const std::string first = text.substr(0, colon);
  const std::string last = text.substr(colon + 1);
  range.first = first.empty() ? 0 : number(first);
  if (!last.empty()) {
    range.last = number(last);
  }
  return range;
}

int run(const Options& options) {
  Recording recording = open_recording(options.recording);
  const Range range = within(options.range, recording.frames.size(), options.recording);
  const int total = *range.last - range.first;
  Chain chain(recording, options);
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  Writer writer(recording, options, chain.dots().initial(), total);
  recording.frames.seek(range.first);
  {
    const Progress progress(total);
    for (int done = 0; done < total; ++done) {
      progress.show(done);
      if (interrupted != 0) {
        return 130;
      }
      const cv::Mat image = next_frame(recording.frames, recording.reference.size());
      writer(chain(range.first + done, image));
    }
  }
  writer.finish();
  print_summary(chain, writer, recording, options);
  return 0;
}

}  // namespace replay
