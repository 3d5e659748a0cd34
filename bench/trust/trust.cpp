// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// trust SCENE ...: a fingertip on finite-element scenes (made by scenes.py), with one thing after
// another that disturbs it. Prints a line for each number of each frame:
//   condition,scene,frame,quantity,error,limit,sd,confident
// With DRAW=1, 2, ... in the environment, noise, modulus and gauge are others.
// An error beyond the limit, or beyond five of its standard deviations, is wrong. Errors and limits
// of forces are shares of full scale: the largest of the scene, or what its largest press would
// give (docs/trust.md).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/dots/spatial_dots.hpp"
#include "fingerpad/pipeline/fingertip.hpp"
#include "support/image.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// What disturbs a recording. Without a change: brightness 180, one grey level of noise, dots known
/// to 0.02 px.
struct Condition {
  std::string name;
  double green = 1, red = 1;              ///< of each frame, to those of the reference
  double green_drift = 0, red_drift = 0;  ///< share, over the recording
  double brightness = 180, noise = 1;     ///< grey levels
  double dot_noise_px = 0.02;
  double dots_lost = 0, side_dots_lost = 0;        ///< share in each frame, at random
  double blur_px = 0;                              ///< sd
  double pressure_noise = 0, pressure_offset = 0;  ///< shares
  double clock_s = 0;                              ///< sd of the time of a frame
  double center_px = 0;                            ///< the camera's axis is taken to lie so far off
  int shrink = 1;                                  ///< pixels so much wider
  int every = 1, first = 0;                        ///< frames of the scene
};

std::vector<Condition> conditions() {
  return {{.name = "nothing"},
          {.name = "light - 3 %", .green = 0.97, .red = 0.97},
          {.name = "light - 10 %", .green = 0.9, .red = 0.9},
          {.name = "light falls by 3 %", .green_drift = -0.03, .red_drift = -0.03},
          {.name = "red + 1 %", .red = 1.01},
          {.name = "red + 3 %", .red = 1.03},
          {.name = "red rises by 1 %", .red_drift = 0.01},
          {.name = "brightness 57", .brightness = 57},
          {.name = "noise 3 levels", .noise = 3},
          {.name = "blur 2 px", .blur_px = 2},
          {.name = "dots' noise x 3", .dot_noise_px = 0.06},
          {.name = "a fifth of dots lost", .dots_lost = 0.2},
          {.name = "a fifth of side dots lost", .side_dots_lost = 0.2},
          {.name = "half resolution", .shrink = 2},
          {.name = "axis 2 px off", .center_px = 2},
          {.name = "pressure noise 0.5 %", .pressure_noise = 0.005},
          {.name = "pressure + 3 %", .pressure_offset = 0.03},
          {.name = "every 3rd frame", .every = 3},
          {.name = "every 5th frame", .every = 5},
          {.name = "begins in contact", .first = 4},
          {.name = "clock jitter 10 ms", .clock_s = 0.01}};
}

/// A scene as scenes.py writes it.
struct Scene {
  std::string folder, name;
  std::map<std::string, double> values;
  std::vector<std::map<std::string, double>> steps;

  explicit Scene(const std::string& from) : folder(from) {
    const auto path = folder.substr(0, folder.find_last_not_of('/') + 1);
    name = path.substr(path.find_last_of('/') + 1);
    std::ifstream about(folder + "/scene.txt");
    std::string key;
    for (double number = 0; about >> key >> number;) {
      values[key] = number;
    }
    std::ifstream table(folder + "/frames.csv");
    std::string line, cell;
    std::getline(table, line);
    std::vector<std::string> names;
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) {
      names.push_back(cell);
    }
    while (std::getline(table, line)) {
      std::istringstream cells(line);
      auto& step = steps.emplace_back();
      for (const std::string& column : names) {
        std::getline(cells, cell, ',');
        step[column] = std::stod(cell);
      }
    }
    if (steps.empty()) {
      throw std::runtime_error(folder + ": no scene; make it with scenes.py");
    }
  }

  double operator[](const char* key) const { return values.at(key); }
  Index rows() const { return static_cast<Index>(values.at("rows")); }
  Index cols() const { return static_cast<Index>(values.at("cols")); }

  template <class T>
  std::vector<T> read(const char* file, std::size_t count, std::size_t step) const {
    std::ifstream stream(folder + "/" + file, std::ios::binary);
    std::vector<T> numbers(count);
    stream.seekg(static_cast<std::streamoff>(step * count * sizeof(T)));
    stream.read(reinterpret_cast<char*>(numbers.data()),
                static_cast<std::streamsize>(count * sizeof(T)));
    if (!stream) {
      throw std::runtime_error(folder + "/" + file + " is too short");
    }
    return numbers;
  }

  Image<float> depth_mm(std::size_t step) const {
    Image<float> out(rows(), cols());
    out.cells = read<float>("depth.f32", out.cells.size(), step);
    std::replace(out.cells.begin(), out.cells.end(), 0.0F, static_cast<float>(none));
    return out;
  }
  Image<std::uint8_t> contact(std::size_t step) const {
    Image<std::uint8_t> out(rows(), cols());
    out.cells = read<std::uint8_t>("contact.u8", out.cells.size(), step);
    return out;
  }
  std::vector<Point2<double>> points(const char* file, std::size_t count, std::size_t step) const {
    const auto xy = read<double>(file, 2 * count, step);
    std::vector<Point2<double>> out;
    for (std::size_t k = 0; k < count; ++k) {
      out.push_back({xy[2 * k], xy[2 * k + 1]});
    }
    return out;
  }
};

template <class T>
struct Colours {
  Image<T> red, green;
};

/// Means of squares of `shrink` x `shrink` pixels.
template <class T>
Image<T> shrunk(const Image<T>& from, int shrink) {
  if (shrink == 1) {
    return from;
  }
  Image<T> to(from.rows() / shrink, from.cols() / shrink);
  for (Index i = 0; i < to.rows(); ++i) {
    for (Index j = 0; j < to.cols(); ++j) {
      double sum = 0;
      for (int k = 0; k < shrink * shrink; ++k) {
        sum += static_cast<double>(from(i * shrink + k / shrink, j * shrink + k % shrink));
      }
      to(i, j) = static_cast<T>(sum / (shrink * shrink));
    }
  }
  return to;
}

Image<float> blurred(const Image<float>& from, double sd_px) {
  const auto reach = static_cast<Index>(std::ceil(3 * sd_px));
  Image<float> now = from;
  for (int direction = 0; direction < 2; ++direction) {
    const Image<float> before = now;
    for (Index i = 0; i < now.rows(); ++i) {
      for (Index j = 0; j < now.cols(); ++j) {
        double sum = 0, weight = 0;
        for (Index k = -reach; k <= reach; ++k) {
          const Index row = direction == 0 ? i + k : i, col = direction == 0 ? j : j + k;
          if (row >= 0 && col >= 0 && row < now.rows() && col < now.cols()) {
            const double w = std::exp(-0.5 * static_cast<double>(k * k) / (sd_px * sd_px));
            sum += w * static_cast<double>(before(row, col));
            weight += w;
          }
        }
        now(i, j) = static_cast<float>(sum / weight);
      }
    }
  }
  return now;
}

/// Frames of one scene, without noise; each is computed once.
class Frames {
 public:
  explicit Frames(const Scene& scene) {
    camera.plate_distance_mm = scene["distance_mm"];
    camera.refractive_index = scene["index"];
    camera.pitch_mm = scene["pitch_mm"];
    camera.center_x_px = scene["center_x_px"];
    camera.center_y_px = scene["center_y_px"];
    fluid = {.c_red_per_mm = 0.029, .c_green_per_mm = 0.0336, .kappa = 0.9924, .max_depth_mm = 18};
    for (std::size_t k = 0; k < scene.steps.size(); ++k) {
      pictures_.push_back(picture(scene.depth_mm(k)));
    }
    test::Random random(7);
    for (float& x : noise_) {
      x = static_cast<float>(random.normal());
    }
  }

  Camera<double> camera;
  Absorption<double> fluid;

  /// As 8-bit pixels.
  Colours<std::uint8_t> operator()(std::size_t step,
                                   const Condition& of,
                                   double share,
                                   test::Random& random) const {
    Colours<float> seen = pictures_[step];
    if (of.blur_px > 0) {
      seen = {blurred(seen.red, of.blur_px), blurred(seen.green, of.blur_px)};
    }
    const double level = of.brightness / 180;
    return {exposed(seen.red, level * of.red * (1 + of.red_drift * share), of, random),
            exposed(seen.green, level * of.green * (1 + of.green_drift * share), of, random)};
  }

  /// Mean of 16 frames of the free pad, 16 bit.
  Colours<std::uint16_t> reference(const Condition& of, test::Random& random) const {
    const auto mean = [&](const Image<float>& seen) {
      const Image<float> small = shrunk(seen, of.shrink);
      Image<std::uint16_t> out(small.rows(), small.cols());
      for (std::size_t k = 0; k < out.cells.size(); ++k) {
        const double level = static_cast<double>(small.cells[k]) * of.brightness / 180 +
                             of.noise / 4 * static_cast<double>(noise(random));
        out.cells[k] = static_cast<std::uint16_t>(std::lround(256 * std::clamp(level, 0.0, 255.0)));
      }
      return out;
    };
    return {mean(pictures_[0].red), mean(pictures_[0].green)};
  }

 private:
  Colours<float> picture(const Image<float>& depth_mm) const {
    Colours<float> out{Image<float>(depth_mm.rows(), depth_mm.cols()),
                       Image<float>(depth_mm.rows(), depth_mm.cols())};
    for (Index i = 0; i < depth_mm.rows(); ++i) {
      for (Index j = 0; j < depth_mm.cols(); ++j) {
        if (const auto l = static_cast<double>(depth_mm(i, j)); l > 0) {
          const auto ray = ray_at_pixel(camera, static_cast<double>(i), static_cast<double>(j));
          const auto colour = colour_at_depth(fluid, ray, 180.0, 0.0163 * 180 / 57, l);
          out.red(i, j) = static_cast<float>(colour.red);
          out.green(i, j) = static_cast<float>(colour.green);
        }
      }
    }
    return out;
  }

  float noise(test::Random& random) const {
    if (at_ % 4096 == 0) {  // goes on elsewhere
      at_ = static_cast<std::size_t>(random.whole(0, static_cast<Index>(noise_.size()) - 1)) /
            4096 * 4096;
    }
    return noise_[at_++ % noise_.size()];
  }

  Image<std::uint8_t> exposed(const Image<float>& seen,
                              double gain,
                              const Condition& of,
                              test::Random& random) const {
    const Image<float> small = shrunk(seen, of.shrink);
    Image<std::uint8_t> out(small.rows(), small.cols());
    const auto by = static_cast<float>(gain), sd = static_cast<float>(of.noise);
    for (std::size_t k = 0; k < out.cells.size(); ++k) {
      const float level = std::clamp(small.cells[k] * by + sd * noise(random), 0.0F, 255.0F);
      out.cells[k] = static_cast<std::uint8_t>(level + 0.5F);
    }
    return out;
  }

  std::vector<Colours<float>> pictures_;
  std::vector<float> noise_ = std::vector<float>(1U << 20U);
  mutable std::size_t at_ = 0;
};

/// What is known of the pad before its first frame, and its views' memory.
struct Pad {
  Image<Point3<double>> free_dots_mm;
  std::optional<FingertipOptions> options;

  Pad(const Scene& scene, const Frames& frames, const Condition& of, test::Random& random) {
    const auto shape_mm = shrunk(scene.depth_mm(0), of.shrink);
    const auto free = frames.reference(of, random);
    Camera<double> camera = frames.camera;
    const double shrink = of.shrink, shift = (shrink - 1) / 2;
    camera.pitch_mm *= shrink;
    camera.center_x_px = (camera.center_x_px - shift) / shrink;
    camera.center_y_px = (camera.center_y_px - shift) / shrink + of.center_px / shrink;
    options.emplace(FingertipOptions{
        camera, frames.fluid, fit_reference(camera, frames.fluid, free.red, free.green, shape_mm)});
    FingertipOptions& o = *options;
    const bool small = scene["base_mm"] < 15;
    const auto odd = [](double px) { return 2 * static_cast<int>(px / 2) + 1; };
    o.smoothing_px = odd((small ? 15 : 29) / shrink);
    o.sampling = std::clamp((o.smoothing_px - 1) / 7, 1, 3);
    o.contact.ring_px = 25 / shrink;
    o.contact.free_apex_mm = scene["apex_mm"];
    o.dot_radius_px = scene["dot_mm"] / 2 / camera.pitch_mm;
    o.friction.soft_object = scene.name == "P_foam";
    o.side_dots = static_cast<Index>(scene["side_dots"]);
    o.wrench.emplace();
    o.wrench->cap = {scene["base_mm"], scene["mould_mm"], scene["mooney_share"]};
    // what is not known exactly is as far off as the options say
    o.wrench->modulus_n_per_mm =
        scene["modulus_n_per_mm"] * (1 + o.wrench->modulus_sd_share * random.normal());
    for (const auto& step : scene.steps) {
      o.wrench->full_scale_n = std::max(o.wrench->full_scale_n, std::abs(step.at("fz")));
    }
    const auto n = static_cast<Index>(scene["dots"]);
    const auto px = scene.points("dots.f64", static_cast<std::size_t>(n * n), 0);
    Image<Point2<double>> dots(n, n);
    for (std::size_t k = 0; k < px.size(); ++k) {
      dots.cells[k] = {(px[k].x - shift) / shrink, (px[k].y - shift) / shrink};
    }
    free_dots_mm = Image<Point3<double>>(n, n);
    (void)spatial_dots(camera, dots, shape_mm, free_dots_mm);
    o.free_dots_mm = std::as_const(free_dots_mm).view();
    std::vector<Image<float>> free_mm;
    FingertipOptions alone = o;
    alone.depth_alone = true;
    alone.sampling = 1;
    for (int k = 0; k < 4; ++k) {
      Fingertip fingertip(alone);
      const auto frame = frames(0, of, 0, random);
      (void)fingertip(frame.red, frame.green);
      Image<float>& depth_mm = free_mm.emplace_back(shape_mm.rows(), shape_mm.cols());
      const auto seen = fingertip.depth_mm();
      for (Index i = 0; i < depth_mm.rows(); ++i) {
        for (Index j = 0; j < depth_mm.cols(); ++j) {
          depth_mm(i, j) = seen(i, j);
        }
      }
    }
    o.contact.threshold_per_mm =
        fit_contact_threshold(camera, free_mm, o.contact.ring_px).threshold_per_mm;
  }
};

Pose<double> pose_of(const std::map<std::string, double>& step) {
  return {rotation_of(Angles<double>{step.at("rx"), step.at("ry"), step.at("rz")}),
          {step.at("x"), step.at("y"), step.at("z")}};
}

/// Judges the frames of one recording.
class Judge {
 public:
  Judge(const Scene& scene, const Condition& of) : scene_(scene), of_(of) {
    double largest_mm2 = 0;
    for (const auto& step : scene.steps) {
      const auto at = [&](const char* key) { return step.at(key); };
      full_[0] = std::max(full_[0], std::hypot(at("fx"), at("fy")));
      full_[1] = std::max(full_[1], std::abs(at("fz")));
      full_[2] = std::max(full_[2], std::hypot(at("mx"), at("my")));
      full_[3] = std::max(full_[3], std::abs(at("mz")));
      largest_mm2 = std::max(largest_mm2, at("area"));
    }
    const double radius_mm = std::sqrt(largest_mm2 / 3.14159265358979);
    full_[0] = std::max(full_[0], 0.5 * full_[1]);
    full_[2] = std::max(full_[2], 0.9 * full_[1] * radius_mm);
    full_[3] = std::max(full_[3], 0.3 * full_[1] * radius_mm);
  }

  void operator()(std::size_t step, const FingertipResult& touch, const Fingertip& fingertip) {
    const auto& truth = scene_.steps[step];
    judge_depth(step, touch, fingertip);
    judge_contact(step, touch, fingertip);
    judge_motion(step, touch);
    if (truth.at("area") > 0 && std::isfinite(touch.slip.stick_ratio)) {
      add(step, "stick ratio", std::abs(touch.slip.stick_ratio - truth.at("stick")), 0.3,
          touch.slip.ratio_sd, touch.slip.updated() && !touch.slip.in_doubt);
    }
    const WrenchResult& w = touch.wrench;
    if (std::isfinite(w.force_n.x)) {
      const auto& f = w.force_n;
      const auto& m = w.moment_n_mm;
      const auto sd = [&](Eigen::Index a, Eigen::Index b) {
        return std::sqrt(w.covariance(a, a) + (a == b ? 0 : w.covariance(b, b)));
      };
      const auto axis = [&](const char* name, double error, int k, double limit, double error_sd) {
        add(step, name, error / full_[k], limit, error_sd / full_[k], w.ok());
      };
      axis("F_xy", std::hypot(f.x - truth.at("fx"), f.y - truth.at("fy")), 0, 0.03, sd(0, 1));
      axis("F_z", std::abs(f.z - truth.at("fz")), 1, 0.096, sd(2, 2));
      axis("M_xy", std::hypot(m.x - truth.at("mx"), m.y - truth.at("my")), 2, 0.09, sd(3, 4));
      axis("M_z", std::abs(m.z - truth.at("mz")), 3, 0.057, sd(5, 5));
    }
  }

 private:
  void add(std::size_t step,
           const char* quantity,
           double error,
           double limit,
           double sd,
           bool confident) const {
    std::printf("%s,%s,%zu,%s,%.5g,%g,%.5g,%d\n", of_.name.c_str(), scene_.name.c_str(), step,
                quantity, error, limit, sd, confident ? 1 : 0);
  }

  void judge_depth(std::size_t step, const FingertipResult& touch, const Fingertip& fingertip) {
    const auto truth_mm = shrunk(scene_.depth_mm(step), of_.shrink);
    const auto found_mm = fingertip.depth_mm();
    const double width = scene_["pitch_mm"] * of_.shrink, radius = 0.75 * scene_["base_mm"];
    const double x0 = static_cast<double>(truth_mm.cols() - 1) / 2,
                 y0 = static_cast<double>(truth_mm.rows() - 1) / 2;
    double sum = 0, count = 0;
    for (Index i = 0; i < truth_mm.rows(); i += 2) {
      for (Index j = 0; j < truth_mm.cols(); j += 2) {
        const double e = std::abs(static_cast<double>(found_mm(i, j) - truth_mm(i, j)));
        if (std::hypot(static_cast<double>(j) - x0, static_cast<double>(i) - y0) * width < radius &&
            std::isfinite(e)) {
          sum += e;
          count += 1;
        }
      }
    }
    if (count > 0) {
      add(step, "depth", sum / count, 0.09, none, !touch.depth_in_doubt);
    }
  }

  void judge_contact(std::size_t step, const FingertipResult& touch, const Fingertip& fingertip) {
    const Image<std::uint8_t> truth = scene_.contact(step);
    const auto found = fingertip.contact_mask();
    double both = 0, any = 0;
    for (Index i = 0; i < found.rows(); ++i) {
      for (Index j = 0; j < found.cols(); ++j) {
        const bool is = truth(i * of_.shrink, j * of_.shrink) != 0, seen = found(i, j) != 0;
        both += is && seen ? 1 : 0;
        any += is || seen ? 1 : 0;
      }
    }
    const bool sure = touch.contact.ok() && !touch.contact_in_doubt;
    add(step, "contact", any > 0 ? 1 - both / any : 0, scene_["flat"] > 0 ? 0.32 : 0.48, none,
        sure);
    if (both > 0) {
      add(step, "area", std::abs(touch.contact.area_mm2 - scene_.steps[step].at("area")), 1e9,
          touch.contact.area_sd_mm2, sure);
    }
  }

  void judge_motion(std::size_t step, const FingertipResult& touch) {
    const auto& motion = touch.motion;
    if (motion.begun) {
      begun_ = {pose_of(scene_.steps[step]), motion.position_mm};
    }
    if (motion.has_pose() && !motion.begun && begun_) {
      const Pose<double> moved = pose_of(scene_.steps[step]) * inverse(begun_->pose);
      add(step, "rotation", 57.29578 * angle_between(motion.pose.rotation, moved.rotation), 3.2,
          57.29578 * motion.rotation_sd_rad, !touch.rotation_in_doubt);
      const auto off = motion.position_mm - moved(begun_->place_mm);
      add(step, "place", norm(off), 0.072, motion.position_sd_mm, motion.ok());
    }
  }

  struct Begun {
    Pose<double> pose;
    Point3<double> place_mm;
  };
  const Scene& scene_;
  const Condition& of_;
  double full_[4] = {0, 0, 0, 0};
  std::optional<Begun> begun_;
};

void run(const Scene& scene, const Frames& frames, const Condition& of) {
  const char* const draw = std::getenv("DRAW");
  // Each condition of each scene has noise of its own.
  std::uint64_t seed = 23 + (draw ? 1000003 * std::strtoull(draw, nullptr, 10) : 0);
  for (const char letter : of.name + scene.name) {
    seed = 31 * seed + static_cast<std::uint64_t>(letter);
  }
  test::Random random(seed);
  const Pad pad(scene, frames, of, random);
  Fingertip fingertip(*pad.options);
  Judge judge(scene, of);
  const auto n = pad.free_dots_mm.rows();
  const auto sides = static_cast<std::size_t>(scene["side_dots"]);
  const double shrink = of.shrink, shift = (shrink - 1) / 2;
  for (auto k = static_cast<std::size_t>(of.first); k < scene.steps.size();
       k += static_cast<std::size_t>(of.every)) {
    const double share = static_cast<double>(k) / static_cast<double>(scene.steps.size() - 1);
    const auto frame = frames(k, of, share, random);
    const auto seen = [&](const Point2<double>& px, double lost) {
      const double dx = of.dot_noise_px * random.normal(), dy = of.dot_noise_px * random.normal();
      const bool gone = random.uniform() < lost;
      return Point2<double>{gone ? none : (px.x - shift) / shrink + dx,
                            gone ? none : (px.y - shift) / shrink + dy};
    };
    Image<Point2<double>> dots(n, n);
    const auto px = scene.points("dots.f64", dots.cells.size(), k);
    std::transform(px.begin(), px.end(), dots.cells.begin(),
                   [&](const auto& p) { return seen(p, of.dots_lost); });
    std::vector<Mark> marks(sides);
    const auto side_px = scene.points("side_dots.f64", sides, k);
    for (std::size_t s = 0; s < sides; ++s) {
      marks[s].px = seen(side_px[s], of.side_dots_lost);
      marks[s].sd_px = 0.02;
    }
    const double gauge = std::max(of.pressure_noise, pad.options->wrench->pressure_sd_share);
    const double pressure =
        scene.steps[k].at("p") * (1 + of.pressure_offset + gauge * random.normal());
    const double time_s = static_cast<double>(k) / 30 + of.clock_s * random.normal();
    const auto touch = fingertip(frame.red, frame.green, dots, pressure, time_s, marks);
    judge(k, touch, fingertip);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  std::printf("condition,scene,frame,quantity,error,limit,sd,confident\n");
  for (int k = 1; k < argc; ++k) {
    const Scene scene(argv[k]);
    const Frames frames(scene);
    for (const Condition& of : conditions()) {
      run(scene, frames, of);
      std::fflush(stdout);
    }
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "trust: %s\n", error.what());
  return 1;
}
