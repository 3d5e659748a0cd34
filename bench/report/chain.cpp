// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The whole chain from a frame to all results (pipeline/fingertip.hpp), as JSON: error of each
// result, time of each stage, time against error by the step of the samples, instructions and
// cycles where the machine counts them, what a copy costs, and latencies over
// 10,000 frames.
// Frames and truth: bench/report/chain/pressed_frames.hpp. "chain FRAMES" only times that many
// frames.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "chain/pressed_frames.hpp"
#include "support/allocations.hpp"

using namespace fingerpad;
using chain::touch_of;
using nlohmann::ordered_json;

namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;

/// Processor time of this thread: without what another process took.
double thread_ms() {
  std::timespec now{};
  (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double share_of(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

/// Latencies of one kind.
class Times {
 public:
  explicit Times(int count = 0) { ms_.reserve(static_cast<std::size_t>(count)); }
  void add(double ms) { ms_.push_back(ms); }
  std::vector<double> sorted() const {
    std::vector<double> all = ms_;
    std::sort(all.begin(), all.end());
    return all;
  }
  double median() const { return share_of(sorted(), 0.5); }

 private:
  std::vector<double> ms_;
};

/// Median processor time of a frame.
double frame_ms(Fingertip fingertip, const chain::PressedFrames& frames, int count) {
  Times whole;
  for (int k = 0; k < count; ++k) {
    const double begin_ms = thread_ms();
    (void)touch_of(fingertip, frames[static_cast<std::size_t>(k) % frames.size()].view());
    whole.add(thread_ms() - begin_ms);
  }
  return whole.median();
}

/// What each stage adds to the time of a frame.
ordered_json stages_of(FingertipOptions options, const chain::PressedFrames& frames, int count) {
  std::array<double, 4> ms;  // of a frame with one stage more each
  const auto time = [&] { return frame_ms(Fingertip(options), frames, count); };
  ms[3] = time();
  options.force_of_area = options.force_of_depth = {};
  options.shear = {};
  ms[2] = time();
  options.free_dots_mm = {};
  ms[1] = time();
  options.depth_alone = true;
  ms[0] = time();
  return {{"stages_ms",
           {{"smoothing, depth", ms[0]},
            {"contact region", ms[1] - ms[0]},
            {"stick ratio, object motion", ms[2] - ms[1]},
            {"look-up forces", ms[3] - ms[2]}}},
          {"whole_ms", ms[3]}};
}

/// What a copy costs, in bytes and in ms: a new one, and one into memory that is there.
ordered_json copy_of(const FingertipOptions& options, const chain::PressedFrames& frames) {
  Fingertip original(options);
  for (std::size_t k = 0; k < 4 * frames.size(); ++k) {
    (void)touch_of(original, frames[k % frames.size()].view());
  }
  const long before = test::bytes_taken();
  Fingertip copy = original;
  const long bytes = test::bytes_taken() - before;
  Times anew, again;
  for (int k = 0; k < 100; ++k) {
    const double begin_ms = thread_ms();
    const Fingertip other = original;
    const double middle_ms = thread_ms();
    copy = original;
    anew.add(middle_ms - begin_ms);
    again.add(thread_ms() - middle_ms);
  }
  return {{"bytes", bytes}, {"new_ms", anew.median()}, {"again_ms", again.median()}};
}

/// Writes {"unit", "median", "99 %", "worst", "found"} of each quantity.
class Errors {
 public:
  void add(const std::string& quantity, const std::string& unit, double error) {
    auto of = std::find_if(all_.begin(), all_.end(),
                           [&](const Quantity& q) { return q.name == quantity; });
    if (of == all_.end()) {
      of = all_.insert(of, {quantity, unit});
    }
    ++of->asked;
    if (error == error) {
      of->errors.push_back(std::abs(error));
    }
  }
  ordered_json summary() {
    ordered_json out;
    for (Quantity& q : all_) {
      auto& of = out[q.name];
      of["unit"] = q.unit;
      std::sort(q.errors.begin(), q.errors.end());
      if (!q.errors.empty()) {
        of["median"] = share_of(q.errors, 0.5);
        of["99 %"] = share_of(q.errors, 0.99);
        of["worst"] = q.errors.back();
      }
      of["found"] = static_cast<double>(q.errors.size()) / q.asked;
    }
    return out;
  }

 private:
  struct Quantity {
    std::string name, unit;
    double asked = 0;
    std::vector<double> errors = {};
  };
  std::vector<Quantity> all_;
};

/// Error of the displacement since the first frame, at the point of the plate that is now at
/// r.position_mm.
double displacement_error_mm(const ObjectMotionResult<double>& r,
                             const chain::PressedFrame& first,
                             const chain::PressedFrame& frame) {
  const auto& a = first.plate;
  const auto& b = frame.plate;
  const double x = r.position_mm.x - r.displacement_mm.x - a.shift_x_mm;
  const double y = r.position_mm.y - r.displacement_mm.y - a.shift_y_mm;
  const double c = std::cos(b.turn_rad - a.turn_rad), s = std::sin(b.turn_rad - a.turn_rad);
  return std::hypot(c * x - s * y + b.shift_x_mm - r.position_mm.x,
                    s * x + c * y + b.shift_y_mm - r.position_mm.y);
}

ordered_json errors_of(Fingertip chain, const chain::PressedFrames& frames) {
  Errors errors;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto& f = frames[k];
    const auto r = touch_of(chain, f.view());
    const auto depth_mm = chain.depth_mm();
    for (Index i = 0; i < f.depth_mm.rows(); ++i) {
      for (Index j = 0; j < f.depth_mm.cols(); ++j) {
        if (f.depth_mm(i, j) == f.depth_mm(i, j)) {
          errors.add("depth of a pixel", "mm",
                     static_cast<double>(depth_mm(i, j)) - f.depth_mm(i, j));
        }
      }
    }
    const double degrees = 180 / std::numbers::pi;
    errors.add("contact area", "share", r.contact.area_mm2 / f.contact_area_mm2() - 1);
    errors.add("contact depth", "mm", r.contact.depth_mm - (13 - f.membrane.height(0)));
    errors.add("object's turn", "deg",
               degrees * (r.motion.angles.z_rad - f.plate.turn_rad + frames[0].plate.turn_rad));
    errors.add("object's displacement", "mm", displacement_error_mm(r.motion, frames[0], f));
    if (k > 0) {  // the first frame has no reference
      errors.add("stick ratio", "1", static_cast<double>(r.stick.stick_ratio) - 1);
    }
    errors.add("normal force by look-up", "N",
               r.normal.force_n - chain::pressure_mpa * f.contact_area_mm2());
  }
  return errors.summary();
}

ordered_json latencies_of(Fingertip chain, const chain::PressedFrames& frames, int count) {
  for (std::size_t k = 0; k < frames.size(); ++k) {
    (void)touch_of(chain, frames[k].view());
  }
  Times times(count);
  const long before = test::allocations();
  double sum_ms = 0, worst_of_thread_ms = 0;
  for (int k = 0; k < count; ++k) {
    const double thread_before_ms = thread_ms();
    const auto begin = Clock::now();
    (void)touch_of(chain, frames[static_cast<std::size_t>(k) % frames.size()].view());
    const double ms = Milliseconds(Clock::now() - begin).count();
    worst_of_thread_ms = std::max(worst_of_thread_ms, thread_ms() - thread_before_ms);
    sum_ms += ms;
    times.add(ms);
  }
  const long allocations = test::allocations() - before;
  const std::vector<double> sorted = times.sorted();
  ordered_json out;
  out["frames"] = count;
  out["allocations"] = allocations;
  out["median_ms"] = share_of(sorted, 0.5);
  out["99_ms"] = share_of(sorted, 0.99);
  out["999_ms"] = share_of(sorted, 0.999);
  out["worst_ms"] = sorted.back();
  out["worst_of_thread_ms"] = worst_of_thread_ms;
  out["frames_per_s"] = 1000 * count / sum_ms;
  return out;
}

/// Time and errors of a chain in samples of Step x Step pixels.
ordered_json samples_of(const char* policies,
                        const FingertipOptions& options,
                        const chain::PressedFrames& frames) {
  ordered_json out = {{"policies", policies}, {"step", options.sampling}};
  out["whole_ms"] = frame_ms(Fingertip(options), frames, 400);
  out["errors"] = errors_of(Fingertip(options), frames);
  return out;
}

/// Medians of the two passes from a frame to depth, alone and in sequence, and of a copy of what
/// the first leaves for the second: what one pass over the frame could save.
ordered_json passes_of(const FingertipOptions& options, const chain::PressedFrames& frames) {
  const int step = options.sampling;
  using Samples = test::Image<std::uint16_t>;
  const auto reference = sampled(options.reference, step);
  DepthEstimator estimate(sampled(options.camera, step), options.fluid, reference,
                          {.window_px = options.smoothing_px, .step = step});
  test::Image<float> depth_mm(reference.rows, reference.cols);
  test::Image<PixelStatus> status(reference.rows, reference.cols);
  Samples red(reference.rows, reference.cols), green = red, copy = red;
  const auto sample = [&](const chain::Inputs& in) {
    (void)sample_frame(in.red, in.green, step, as_view(red), as_view(green));
  };
  const auto invert = [&] { (void)estimate(red, green, depth_mm, status); };
  const auto median = [&](const auto& pass) {
    Times times;
    for (std::size_t k = 0; k < 400; ++k) {
      const auto in = frames[k % frames.size()].view();
      const auto begin = Clock::now();
      pass(in);
      times.add(Milliseconds(Clock::now() - begin).count());
    }
    return times.median();
  };
  return {{"samples", median(sample)},
          {"depth from the samples", median([&](const chain::Inputs&) { invert(); })},
          {"both", median([&](const chain::Inputs& in) {
             sample(in);
             invert();
           })},
          {"copy of the samples", median([&](const chain::Inputs&) {
             std::copy(red.cells.begin(), red.cells.end(), copy.cells.begin());
             std::copy(green.cells.begin(), green.cells.end(), copy.cells.begin());
           })}};
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 10000;
  const chain::PressedFrames frames;
  const auto options = frames.options();
  ordered_json out;
  const auto lean = chain::lean(options);
  const auto add = [&](const char* name, const FingertipOptions& of_chain) {
    const long before = test::bytes_taken();
    const Fingertip made(of_chain);
    auto& of = out["chains"][name];
    of["bytes"] = test::bytes_taken() - before;
    of.update(stages_of(of_chain, frames, 400));
    of["copy"] = copy_of(of_chain, frames);
    of["errors"] = errors_of(made, frames);
  };
  add("lean", lean);
  add("default", options);
  for (const int step : {1, 2, 4}) {
    out["samples"].push_back(samples_of("lean", chain::in_samples(lean, step), frames));
  }
  for (const int step : {1, 2, 3, 4}) {
    out["samples"].push_back(samples_of("default", chain::in_samples(options, step), frames));
  }
  out["passes_ms"] = {{"lean", passes_of(lean, frames)}, {"default", passes_of(options, frames)}};
  out["latency"] = latencies_of(Fingertip(lean), frames, count);
  std::cout << out.dump(1) << '\n';
}
