// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/foam/frequency_picture.hpp"

#include <algorithm>
#include <cmath>

#include "replay/foam/axis.hpp"
#include "replay/pictures/canvas.hpp"
#include "replay/pictures/depth_colours.hpp"
#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

constexpr double left = 128;
constexpr double width = 660;
constexpr double top = 96;
constexpr double finger_gap = 10;
constexpr std::size_t max_tracks = 40;
const Ink empty_ink(246, 244, 243);

/// The tracks that vibrate longest, still ordered by finger, row and column.
std::vector<TaxelTrack> longest(std::vector<TaxelTrack> tracks) {
  if (tracks.size() > max_tracks) {
    std::vector<long long> samples;
    for (const TaxelTrack& track : tracks) {
      samples.push_back(track.samples);
    }
    const auto last = samples.begin() + static_cast<std::ptrdiff_t>(max_tracks - 1);
    std::nth_element(samples.begin(), last, samples.end(), std::greater<>());
    const long long least = *last;
    std::erase_if(tracks, [&](const TaxelTrack& track) { return track.samples < least; });
    tracks.resize((std::min)(tracks.size(), max_tracks));
  }
  return tracks;
}

/// Vertical positions of the taxels' rows in the picture.
struct Rows {
  std::vector<double> top_px;
  double height_px;
  double bottom_px;

  explicit Rows(const std::vector<TaxelTrack>& tracks)
      : height_px(std::clamp(
            420.0 / static_cast<double>((std::max)(tracks.size(), std::size_t(1))), 12.0, 18.0)) {
    double y = top;
    for (std::size_t k = 0; k < tracks.size(); ++k) {
      y += k > 0 && tracks[k].finger != tracks[k - 1].finger ? finger_gap : 0;
      top_px.push_back(y);
      y += height_px;
    }
    bottom_px = (std::max)(y, top + 130);
  }
};

void paint_box(Canvas& canvas, const cv::Rect2d& box, const Ink& colour) {
  canvas.polygon({box.tl(), {box.br().x, box.y}, box.br(), {box.x, box.br().y}}, colour);
}

void paint_track(Canvas& canvas,
                 const SampleAxis& axis,
                 const TaxelTrack& track,
                 const cv::Rect2d& box,
                 const ColourScale& scale) {
  paint_box(canvas, box, empty_ink);
  const double bin_px =
      (axis.right() - axis.left()) / static_cast<double>(track.frequency_hz.size());
  for (std::size_t k = 0; k < track.frequency_hz.size(); ++k) {
    const double hz = static_cast<double>(track.frequency_hz[k]);
    if (hz > 0) {
      const double share = std::clamp(hz / scale.top_mm, 0.0, 1.0);
      const cv::Vec3b& colour = scale.colours(0, static_cast<int>(std::lround(share * 255)));
      paint_box(canvas, {axis.left() + bin_px * static_cast<double>(k), box.y, bin_px, box.height},
                Ink(colour[0], colour[1], colour[2]));
    }
  }
}

/// Paints lines under the samples in which this taxel vibrates most of its finger.
void paint_strongest(Canvas& canvas,
                     const SampleAxis& axis,
                     const std::vector<FoamRow>& rows,
                     const TaxelTrack& track,
                     int cols,
                     double y) {
  const auto location = static_cast<fingerpad::Index>(track.row) * cols + track.col;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].fingers[track.finger].location == location) {
      const double middle = static_cast<double>(k);
      canvas.line({axis.x(middle - 0.5), y}, {axis.x(middle + 0.5), y}, 2.0, ink::black);
    }
  }
}

}  // namespace

cv::Mat foam_frequency_picture(const std::string& title,
                               const FoamRecording& recording,
                               const std::vector<FoamRow>& rows,
                               const FoamActivity& activity) {
  const std::vector<TaxelTrack> tracks = longest(activity.tracks);
  const Rows places(tracks);
  const SampleAxis axis(recording, rows, left, width);
  float highest = 0;
  for (const TaxelTrack& track : tracks) {
    highest = (std::max)(highest,
                         *std::max_element(track.frequency_hz.begin(), track.frequency_hz.end()));
  }
  const double tick = round_up((std::max)(static_cast<double>(highest), 1e-12) / 4);
  const ColourScale scale{0, tick * (std::max)(1.0, std::ceil(double(highest) / tick - 1e-9)), tick,
                          depth_scale(1).colours};
  Canvas canvas(left + width + 96, places.bottom_px + 56);
  canvas.text({28, 34}, title, 1.3 * letter, ink::black, Align::left, true);
  const bool is_part = tracks.size() < activity.tracks.size();
  canvas.text({28, 60},
              "frequency of each vibrating taxel" +
                  (is_part ? format(" (the %zu of %zu that vibrate longest)", tracks.size(),
                                    activity.tracks.size())
                           : std::string()) +
                  "; underlined: strongest vibration of the finger",
              letter, ink::grey);
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    const TaxelTrack& track = tracks[k];
    const double y = places.top_px[k];
    paint_track(canvas, axis, track, {left, y, width, places.height_px - 1}, scale);
    paint_strongest(canvas, axis, rows, track, recording.sensor.fingers[track.finger].cols,
                    y + places.height_px - 2);
    const std::string finger =
        recording.fingers() > 1 ? format("finger %zu ", track.finger) : std::string();
    canvas.text({left - 8, y + places.height_px / 2 + 4},
                finger + format("r%d_c%d", track.row, track.col), 8, ink::grey, Align::right);
  }
  if (tracks.empty()) {
    canvas.text({left + width / 2, top + 68}, "no taxel vibrates above its noise", letter,
                ink::grey, Align::center);
  } else {
    paint_legend(canvas, {left + width + 24, top + 14, 14, 116}, scale, letter, "Hz");
  }
  if (const auto alarm = first_alarm(rows)) {
    const double x = axis.x(static_cast<double>(*alarm));
    canvas.line({x, top - 10}, {x, places.bottom_px}, 1.0, ink::accent);
    const bool is_right = x > left + width / 2;
    canvas.text({x + (is_right ? -6 : 6), top - 8}, "first alarm", letter, ink::accent,
                is_right ? Align::right : Align::left);
  }
  axis.paint(canvas, places.bottom_px);
  return canvas.finished();
}

}  // namespace replay
