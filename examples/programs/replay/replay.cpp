// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/replay.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "common/failure.hpp"
#include "common/interrupt.hpp"
#include "common/progress.hpp"
#include "common/recording.hpp"
#include "common/writer.hpp"
#include "replay/chain.hpp"
#include "replay/foam/recording.hpp"
#include "replay/foam/replay.hpp"
#include "replay/gel/gel.hpp"
#include "replay/steps/fingertip_options.hpp"

namespace replay {
namespace {

using fingerpad::ForceStatus;

/// Mean of the finite values.
class Mean {
 public:
  void add(double value) {
    if (std::isfinite(value)) {
      sum_ += value;
      ++count_;
    }
  }
  int count() const { return count_; }
  std::string words(const char* unit) const {
    char text[48] = "none";
    if (count_ > 0) {
      std::snprintf(text, sizeof text, "%.2f %s", sum_ / count_, unit);
    }
    return text;
  }

 private:
  double sum_ = 0;
  int count_ = 0;
};

/// Prints forces by look-up, and their errors where the truth is known.
void print_look_up(const Writer& writer, const Recording& recording) {
  if (!recording.sensor.force) {
    return;
  }
  int known = 0, beyond = 0, disagreeing = 0;
  double normal_n = 0, tangential_n = 0;
  Mean normal_error, tangential_error, moment_error;
  for (const FrameRow& row : writer.rows()) {
    const auto& touch = row.touch;
    const auto& along = touch.shear.tangential_force_n;
    const double along_n = std::hypot(along.x, along.y);
    known += std::isfinite(touch.normal.force_n) || std::isfinite(along_n) ? 1 : 0;
    for (const ForceStatus status :
         {touch.by_area.status, touch.by_depth.status, touch.shear.status}) {
      if (status == ForceStatus::beyond_range) {
        ++beyond;
        break;
      }
    }
    disagreeing += std::abs(touch.normal.disagreement) > 3 ? 1 : 0;
    normal_n = std::fmax(normal_n, touch.normal.force_n);
    tangential_n = std::fmax(tangential_n, along_n);
    if (row.truth) {
      const auto& truth = *row.truth;
      normal_error.add(std::abs(touch.normal.force_n + truth.force_n.z));
      tangential_error.add(std::hypot(along.x - truth.force_n.x, along.y - truth.force_n.y));
      moment_error.add(std::abs(touch.shear.moment_n_mm - truth.moment_n_mm));
    }
  }
  std::printf("look-up      in %d frames; maximum %.2f N normal, %.2f N tangential\n", known,
              normal_n, tangential_n);
  if (disagreeing > 0) {
    std::printf(
        "             %d of these: area and depth disagree, so the object has another shape than\n"
        "             in the calibration; the force by area is used\n",
        disagreeing);
  }
  if (beyond > 0) {
    std::printf("             %d of these: outside the calibrated range\n", beyond);
  }
  if (normal_error.count() + tangential_error.count() > 0) {
    std::printf("mean error   %s normal, %s tangential, %s moment\n",
                normal_error.words("N").c_str(), tangential_error.words("N").c_str(),
                moment_error.words("N mm").c_str());
  }
}

void print_wrench(const Writer& writer, const Recording& recording) {
  const std::string lacking = lacking_for_wrench(recording);
  if (!lacking.empty()) {
    std::printf("six-axis     none: %s\n", lacking.c_str());
    return;
  }
  int known = 0;
  double largest_n = 0;
  for (const FrameRow& row : writer.rows()) {
    if (row.touch.wrench.ok()) {
      ++known;
      const auto& f = row.touch.wrench.force_n;
      largest_n = std::fmax(largest_n, std::sqrt(f.x * f.x + f.y * f.y + f.z * f.z));
    }
  }
  std::printf("six-axis     in %d frames; maximum %.2f N\n", known, largest_n);
}

/// Prints the results that need depth.
void print_depth(const Chain& chain, const Writer& writer) {
  double valid_share = 0;
  double deepest_mm = 0;
  double largest_mm2 = 0;
  int in_contact = 0;
  int changed = 0;
  for (const FrameRow& row : writer.rows()) {
    valid_share += row.valid_share;
    deepest_mm = std::fmax(deepest_mm, row.depth_max_mm);
    largest_mm2 = std::fmax(largest_mm2, row.touch.contact.area_mm2);
    in_contact += row.touch.contact.in_contact() ? 1 : 0;
    changed += row.pad_has_changed() ? 1 : 0;
  }
  const auto frames = static_cast<double>(writer.rows().size());
  std::printf("valid        %.2f %% of the pad's pixels\n", 100 * valid_share / frames);
  if (changed > 0) {
    std::printf(
        "pad changed  in %d frames: the light differs from the reference; record a new reference\n",
        changed);
  }
  std::printf("max depth    %.2f mm\n", deepest_mm);
  std::printf("contact      in %d frames; maximum %.1f mm^2\n", in_contact, largest_mm2);
  std::printf("fingertip    %.2f ms per frame (median)\n", chain.frame_ms());
}

/// The most useful reason why no frame has a stick ratio.
const char* why_none(const std::vector<FrameRow>& rows) {
  const bool outline = std::any_of(rows.begin(), rows.end(), [](const FrameRow& row) {
    return row.touch.stick.status == fingerpad::StickStatus::no_outline;
  });
  return outline ? "all dots count as in contact, but some do not follow the object; if the object "
                   "is larger than the dot pattern, set \"stick\": {\"covers_pattern\": true} in "
                   "sensor.json"
                 : "the dots never moved far enough";
}

/// Returns in how many frames the stick ratio is new.
int print_dots(const Chain& chain, const Writer& writer) {
  std::printf("dots         %td, %s\n", fingerpad::count_present(chain.dots().initial()),
              chain.dots().how().c_str());
  if (const std::string side = chain.dots().side_how(); !side.empty()) {
    std::printf("side dots    %s\n", side.c_str());
  }
  if (!chain.dots().present()) {
    return 0;
  }
  double lowest = std::numeric_limits<double>::infinity();
  int updated = 0;
  for (const FrameRow& row : writer.rows()) {
    if (row.touch.slip.updated()) {
      ++updated;
      lowest = (std::min)(lowest, row.touch.slip.stick_ratio);
    }
  }
  if (updated > 0) {
    std::printf("stick ratio  updated in %d frames; minimum %.2f\n", updated, lowest);
  } else {
    std::printf("stick ratio  none: %s\n", why_none(writer.rows()));
  }
  return updated;
}

/// A gel that has no stick ratio in any frame has nothing to doubt there.
void print_doubts(const Writer& writer, bool has_stick_ratio) {
  for (const auto& [what, frames] : writer.doubts().in_words()) {
    if (what != "slip" || has_stick_ratio) {
      std::printf("doubted      %s in %s\n", what.c_str(), frames.c_str());
    }
  }
}

/// The picture of a gel to look at first: of its first slip, else of its last contact.
std::string telling_picture(const std::vector<FrameRow>& rows) {
  int frame = rows.front().frame;
  for (const FrameRow& row : rows) {
    if (row.gel && row.gel->slide.alarm) {
      return numbered("slide_", row.frame, ".png");
    }
    if (row.gel && row.gel->contact.ok() && row.gel->contact.in_contact()) {
      frame = row.frame;
    }
  }
  return numbered("slide_", frame, ".png");
}

void print_summary(const Chain& chain,
                   const Writer& writer,
                   const Recording& recording,
                   const Options& options) {
  const bool dots_only = recording.sensor.dots_only;
  const cv::Size size = recording.reference.size();
  std::printf("frames       %zu\n", writer.rows().size());
  if (dots_only) {
    std::printf("size         %d x %d px\n", size.width, size.height);
  } else {
    std::printf("size         %d x %d px, %g mm/px\n", size.width, size.height,
                recording.sensor.camera.pitch_mm);
    print_depth(chain, writer);
  }
  const int updated = print_dots(chain, writer);
  if (!dots_only) {
    print_look_up(writer, recording);
    print_wrench(writer, recording);
  }
  print_doubts(writer, !dots_only || updated > 0);
  std::printf("table        %s\n", (writer.place() / "frames.csv").c_str());
  if (options.raw && !dots_only) {
    std::printf("depth maps   %s\n", (writer.place() / "depth").c_str());
    std::printf("masks        %s\n", (writer.place() / "contact").c_str());
  }
  if (options.pictures) {
    std::printf("pictures     %s; start with %s\n", (writer.place() / "pictures").c_str(),
                dots_only ? telling_picture(writer.rows()).c_str() : "montage.png");
  }
  std::printf("charts       plot.py %s\n", writer.place().c_str());
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

Range within(const Range& range, int size, const std::filesystem::path& recording) {
  const int last = range.last.value_or(size);
  if (range.first >= last || last > size) {
    fail(recording, "has frames 0 to " + std::to_string(size - 1) + ", but --frames is " +
                        std::to_string(range.first) + ":" + std::to_string(last) +
                        "; A must be less than B, and B at most " + std::to_string(size));
  }
  return {range.first, last};
}

int run(const Options& options) {
  if (is_foam_recording(options.recording)) {
    return run_foam(options);
  }
  Recording recording = open_recording(options.recording, options.sensor);
  const Range range = within(options.range, recording.frames.size(), options.recording);
  const int total = *range.last - range.first;
  Chain chain(recording, options);
  watch_for_interrupts();
  Writer writer(recording, options, chain.dots().initial(), total);
  std::optional<GelReplay> gel;  // only for a dots-only recording
  if (recording.sensor.dots_only) {
    gel.emplace(recording, options, chain.dots(), writer.output());
  }
  recording.frames.seek(range.first);
  DamagedFrames damaged;
  {
    const Progress progress(total);
    for (int done = 0; done < total; ++done) {
      progress.show(done);
      if (is_interrupted()) {
        return 130;
      }
      const cv::Mat image = next_whole_frame(recording.frames, recording.reference.size(), damaged);
      if (image.empty()) {
        continue;
      }
      Scene scene = chain(range.first + done, image);
      if (gel) {
        (*gel)(scene);
      }
      writer(std::move(scene));
    }
  }
  if (static_cast<int>(damaged.size()) == total) {
    throw Failure(damaged.begin()->second);
  }
  writer.finish();
  print_summary(chain, writer, recording, options);
  for (const auto& [frame, why] : damaged) {
    std::printf("left out     frame %d: %s\n", frame, why.c_str());
  }
  if (gel) {
    gel->print_summary();
  }
  return 0;
}

}  // namespace replay
