// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// What the page calls, as plain C functions: a virtual pad and one's own pictures, measured by
// pipeline/fingertip.hpp. Compiled to WebAssembly by docs/playground/build, and to a program of
// this machine by the test.
#include "core.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/pipeline/fingertip.hpp"
#include "virtual_pad.hpp"

namespace playground {
namespace {

template <class T>
class Picture {
 public:
  Picture(Index rows, Index cols, const T& cell = T())
      : rows_(rows), cols_(cols), cells_(static_cast<std::size_t>(rows * cols), cell) {}
  fingerpad::StridedView<T> view() { return {cells_.data(), rows_, cols_, cols_}; }
  fingerpad::StridedView<const T> view() const { return {cells_.data(), rows_, cols_, cols_}; }
  T& at(Index place) { return cells_[static_cast<std::size_t>(place)]; }
  const T* data() const { return cells_.data(); }
  T* data() { return cells_.data(); }

 private:
  Index rows_, cols_;
  std::vector<T> cells_;
};

/// One channel of red, green, blue, opaque.
fingerpad::StridedView<const std::uint8_t> channel(const Picture<std::uint8_t>& rgba,
                                                   Index rows,
                                                   Index cols,
                                                   Index which) {
  return {rgba.data() + which, rows, cols, 4 * cols, 4};
}

/// Numbers with their names, as the page reads them.
class Numbers {
 public:
  struct Named {
    const char* name;
    double value;
  };
  void tell(std::initializer_list<Named> all) {
    values_.clear();
    for (const Named& number : all) {
      values_.push_back(number.value);
    }
    if (names_.empty()) {
      for (const Named& number : all) {
        names_ += (names_.empty() ? "" : ",") + std::string(number.name);
      }
    }
  }
  const double* values() const { return values_.data(); }
  const char* names() const { return names_.c_str(); }

 private:
  std::vector<double> values_;
  std::string names_;
};

/// The pattern of printed dots.
constexpr Index dots_across = 21;
constexpr double dot_pitch_mm = 1.5;
constexpr double dot_noise_px = 0.06;  ///< of a dot finder

using Reference = fingerpad::DepthReference<float>;
using Options = fingerpad::FingertipOptions;

class VirtualPad {
 public:
  static constexpr Index size_px = View::size_px;
  static constexpr std::size_t dot_numbers = 5;

  VirtualPad()
      : rgba_(size_px, 4 * size_px),
        depth_mm_(size_px, size_px, fingerpad::not_a_number<float>()),
        true_depth_mm_(depth_mm_),
        touching_(size_px, size_px),
        home_(dots_across, dots_across),
        dots_px_(static_cast<std::size_t>(dots_across * dots_across)),
        shift_mm_(dots_px_.size()),
        dots_(dots_across, static_cast<Index>(dot_numbers) * dots_across),
        section_(size_px, 3) {
    for (Index k = 0; k < size_px * size_px; ++k) {
      rgba_.at(4 * k + 3) = 255;
    }
    place_dots();
    expose(0);
    tip_ = std::make_unique<fingerpad::Fingertip>(options());
    measure(0);
  }

  void frame(const Object& object, double noise, double time_s) {
    move(object, time_s);
    expose(noise);
    measure(time_s);
  }

  const std::uint8_t* image() const { return rgba_.data(); }
  const float* depth_mm() const { return depth_mm_.data(); }
  const float* true_depth_mm() const { return true_depth_mm_.data(); }
  const std::uint8_t* touching() const { return touching_.data(); }
  const float* dots() const { return dots_.data(); }
  const float* section() const { return section_.data(); }
  const std::vector<float>& edge() const { return edge_; }
  const Numbers& numbers() const { return numbers_; }

 private:
  void place_dots() {
    const double middle = (dots_across - 1) / 2.0;
    for (Index i = 0; i < dots_across; ++i) {
      for (Index j = 0; j < dots_across; ++j) {
        const Point2<double> at = {dot_pitch_mm * (static_cast<double>(j) - middle),
                                   dot_pitch_mm * (static_cast<double>(i) - middle)};
        home_.at(i * dots_across + j) = norm(at) < 0.88 * rim_mm
                                            ? Point3<double>{at.x, at.y, membrane_.height(at)}
                                            : fingerpad::detail::missing_point<double>();
      }
    }
  }

  /// The pad as a fingertip is told of it.
  Options options() {
    Picture<float> red(size_px, size_px), green(size_px, size_px);
    for (const View::Pixel& pixel : view_.pixels()) {
      red.at(pixel.place) = static_cast<float>(pixel.red);
      green.at(pixel.place) = static_cast<float>(pixel.green);
    }
    auto reference =
        fit_reference(view_.camera, view_.fluid, red.view(), green.view(), true_depth_mm_.view());
    Options o{view_.camera, view_.fluid, std::move(reference)};
    // windows and rings as wide on the pad as those by default are at 0.08 mm a pixel
    const double scale = 0.08 / view_.camera.pitch_mm;
    o.smoothing_px = 2 * static_cast<int>(14 * scale) + 1;
    o.contact.ring_px = 25 * scale;
    o.contact.free_apex_mm = membrane_.film.free_top_mm();
    o.free_dots_mm = home_.view();
    o.stick.noise = dot_noise_px * view_.camera.pitch_mm;
    look_up_forces(o);
    return o;
  }

  /// The curves that presses and drags of this film by a plate would give.
  static void look_up_forces(Options& o) {
    Film film;
    std::array<double, 3> area_mm2{}, force_n{};
    double stiffness = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      film.press(0.5 + 0.75 * static_cast<double>(k), 0);
      area_mm2[k] = pi * film.contact_mm() * film.contact_mm();
      force_n[k] = film.normal_n();
      stiffness += Grip::stiffness_n_per_mm(film) / 3;
    }
    // c_1 S + c_2 S^2 through the first and the last
    const double low = force_n[0] / area_mm2[0], high = force_n[2] / area_mm2[2];
    const double c2 = (high - low) / (area_mm2[2] - area_mm2[0]), c1 = low - c2 * area_mm2[0];
    o.force_of_area.emplace(fingerpad::ForceCurve<>{{0, c1, c2}, 3, 500, 0.05});
    // the lever of a torque is 2/3 of the contact's radius
    const double turning = stiffness * 4 / (9 * pi) * 100;
    o.shear.emplace(fingerpad::ShearMap<>{100, {stiffness, 0, 5}, {turning, 1, 2}});
  }

  void move(const Object& object, double time_s) {
    const bool same = grip_.touches() && object.is_ball == object_.is_ball;
    membrane_.film.press(object.press_mm, object.is_ball ? -1 / ball_mm : 0);
    membrane_.middle_mm = dent_of(object);
    grip_.drag(same ? object_ : object, object, membrane_.film);
    if (!same) {
      start_rad_ = object.turn_rad;
    }
    object_ = object;
    // springs back within some frames; a clock that goes back stands still
    const double kept = std::exp(std::min(last_s_ - time_s, 0.0) / 0.05);
    last_s_ = time_s;
    for (std::size_t k = 0; k < shift_mm_.size(); ++k) {
      const Point3<double>& home = home_.data()[k];
      const Point2<double> at = Point2<double>{home.x, home.y} + shift_mm_[k];
      shift_mm_[k] = grip_.touches() ? shift_mm_[k] + grip_.carried(at - membrane_.middle_mm)
                                     : kept * shift_mm_[k];
    }
  }

  void expose(double noise) {
    for (std::size_t k = 0; k < dots_px_.size(); ++k) {
      const Point3<double>& home = home_.data()[k];
      const Point2<double> at = Point2<double>{home.x, home.y} + shift_mm_[k];
      dots_px_[k] = is_finite(home) ? pixel_of(view_.camera, {at.x, at.y, membrane_.height(at)})
                                    : Point2<double>{home.x, home.y};
    }
    view_.look(membrane_, dots_px_);
    const auto stored = [](double level) {
      return static_cast<std::uint8_t>(std::clamp(level + 0.5, 0.0, 255.0));
    };
    for (const View::Pixel& pixel : view_.pixels()) {
      const Point2<double> grain = noise * random_.normals();
      rgba_.at(4 * pixel.place) = stored(pixel.red + pixel.red_sd * grain.x);
      rgba_.at(4 * pixel.place + 1) = stored(pixel.green + pixel.green_sd * grain.y);
      rgba_.at(4 * pixel.place + 2) = stored(0.05 * pixel.green);
      true_depth_mm_.at(pixel.place) = static_cast<float>(pixel.depth_mm);
    }
    for (Point2<double>& dot : dots_px_) {
      dot += dot_noise_px * random_.normals();
    }
  }

  void measure(double time_s) {
    const fingerpad::StridedView<const Point2<double>> dots(dots_px_.data(), dots_across,
                                                            dots_across, dots_across);
    rim_pull_.pull(membrane_, grip_);
    const auto touch =
        (*tip_)(channel(rgba_, size_px, size_px, 0), channel(rgba_, size_px, size_px, 1), dots,
                membrane_.film.pressure_mpa(), time_s);
    copy_maps();
    tell(touch);
  }

  void copy_maps() {
    const auto depth = tip_->depth_mm();
    const auto mask = tip_->contact_mask();
    double sum = 0, count = 0;
    for (const View::Pixel& pixel : view_.pixels()) {
      const Index row = pixel.place / size_px, col = pixel.place % size_px;
      const float z = depth(row, col);
      depth_mm_.at(pixel.place) = z;
      touching_.at(pixel.place) = mask(row, col);
      if (fingerpad::is_finite(z) && fingerpad::squared_norm(pixel.start_mm) < 14 * 14) {
        sum += std::abs(static_cast<double>(z) - pixel.depth_mm);
        count += 1;
      }
    }
    depth_error_mm_ = sum / count;
    copy_section();
    find_edge();
    for (Index k = 0; k < dots_across * dots_across; ++k) {
      const Index i = k / dots_across, j = k % dots_across;
      const auto at = tip_->dots_mm()(i, j);
      const std::array<double, dot_numbers> dot = {
          at.x, at.y, at.z, static_cast<double>(tip_->dots_in_contact()(i, j) != 0),
          static_cast<double>(tip_->dot_states()(i, j))};
      for (std::size_t c = 0; c < dot_numbers; ++c) {
        dots_.data()[static_cast<std::size_t>(k) * dot_numbers + c] = static_cast<float>(dot[c]);
      }
    }
  }

  /// Along the row of pixels in the middle of the picture.
  void copy_section() {
    constexpr Index row = size_px / 2;
    for (Index col = 0; col < size_px; ++col) {
      const float z = depth_mm_.at(row * size_px + col);
      const float true_z = true_depth_mm_.at(row * size_px + col);
      const auto at = point_at(view_.camera, static_cast<double>(row), static_cast<double>(col),
                               static_cast<double>(true_z));
      section_.at(3 * col) = static_cast<float>(at.x);
      section_.at(3 * col + 1) = z;
      section_.at(3 * col + 2) = true_z;
    }
  }

  /// Where on the film the outermost pixels in contact are.
  void find_edge() {
    edge_.clear();
    const auto touches = [&](Index place) { return touching_.at(place) != 0; };
    for (const View::Pixel& pixel : view_.pixels()) {
      const Index k = pixel.place;
      if (touches(k) &&
          !(touches(k - 1) && touches(k + 1) && touches(k - size_px) && touches(k + size_px))) {
        const Point2<double> at =
            pixel.start_mm + static_cast<double>(depth_mm_.at(k)) * pixel.per_mm;
        edge_.push_back(static_cast<float>(at.x));
        edge_.push_back(static_cast<float>(at.y));
      }
    }
  }

  void tell(const fingerpad::FingertipResult& touch) {
    const double none = fingerpad::not_a_number<double>();
    const double degrees = 180 / pi;
    const Film& film = membrane_.film;
    const bool pressed = touch.contact.in_contact();
    const Point2<double>& along = touch.shear.tangential_force_n;
    numbers_.tell({
        {"object_x_mm", object_.x_mm},
        {"object_y_mm", object_.y_mm},
        {"object_turn_rad", object_.turn_rad},
        {"object_press_mm", object_.press_mm},
        {"dent_x_mm", membrane_.middle_mm.x},
        {"free_top_mm", film.free_top_mm()},
        {"pressure_kpa", 1000 * film.pressure_mpa()},
        {"true_press_mm", film.free_top_mm() - film.mean_contact_mm()},
        {"true_contact_mm2", pi * film.contact_mm() * film.contact_mm()},
        {"true_turn_deg", grip_.touches() ? (object_.turn_rad - start_rad_) * degrees : none},
        {"true_stick_ratio", grip_.stick_share()},
        {"true_force_x_n", rim_pull_.force_n.x},
        {"true_force_y_n", rim_pull_.force_n.y},
        {"true_force_z_n", rim_pull_.force_n.z},
        {"true_moment_z_n_mm", rim_pull_.moment_n_mm.z},
        {"status", static_cast<double>(touch.status)},
        {"press_mm", touch.contact.depth_mm},
        {"contact_mm2", touch.contact.area_mm2},
        {"middle_x_mm", touch.contact.center_mm.x},
        {"middle_y_mm", touch.contact.center_mm.y},
        {"turn_deg",
         pressed && touch.motion.has_pose() ? touch.motion.angles.z_rad * degrees : none},
        {"dots_ratio", pressed ? touch.stick.stick_ratio : none},
        {"stick_ratio", pressed ? touch.slip.stick_ratio : none},
        {"friction", touch.slip.friction},
        {"force_x_n", along.x},
        {"force_y_n", along.y},
        {"force_z_n", -touch.normal.force_n},
        {"moment_z_n_mm", touch.shear.moment_n_mm},
        {"depth_error_mm", depth_error_mm_},
    });
  }

  Membrane membrane_;
  Grip grip_;
  Object object_;
  Rim rim_pull_;
  View view_;
  Random random_;
  double start_rad_ = 0, last_s_ = 0, depth_error_mm_ = 0;

  Picture<std::uint8_t> rgba_;
  Picture<float> depth_mm_, true_depth_mm_;
  Picture<std::uint8_t> touching_;
  Picture<Point3<double>> home_;
  std::vector<Point2<double>> dots_px_, shift_mm_;
  Picture<float> dots_, section_;
  std::vector<float> edge_;
  Numbers numbers_;
  std::unique_ptr<fingerpad::Fingertip> tip_;
};

/// A free and a pressed picture of one's own sensor, of which only the free pad's cap is known.
class OwnPictures {
 public:
  OwnPictures(Index rows, Index cols)
      : rows_(rows),
        cols_(cols),
        free_(rows, 4 * cols),
        pressed_(rows, 4 * cols),
        depth_mm_(rows, cols, fingerpad::not_a_number<float>()),
        touching_(rows, cols) {}

  /// The pad is a spherical cap in the middle of the picture.
  void measure(double pitch, double base_radius_mm, double height_mm) {
    const fingerpad::Camera<double> camera{.center_x_px = static_cast<double>(cols_ - 1) / 2,
                                           .center_y_px = static_cast<double>(rows_ - 1) / 2,
                                           .pitch_mm = pitch};
    fingerpad::Absorption<double> fluid;
    fluid.max_depth_mm = height_mm + 1;
    const auto free_depth = cap(camera, base_radius_mm, height_mm);
    auto reference = fit_reference(camera, fluid, channel(free_, rows_, cols_, 0),
                                   channel(free_, rows_, cols_, 1), free_depth.view());
    fingerpad::FingertipOptions o{camera, fluid, std::move(reference)};
    const double scale = 0.08 / pitch;
    o.smoothing_px = 2 * std::clamp(static_cast<int>(14 * scale), 1, 54) + 1;
    o.contact.ring_px = 25 * scale;
    o.contact.free_apex_mm = height_mm;
    fingerpad::Fingertip tip(o);
    const auto touch = tip(channel(pressed_, rows_, cols_, 0), channel(pressed_, rows_, cols_, 1));
    const auto depth = tip.depth_mm();
    const auto mask = tip.contact_mask();
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        depth_mm_.at(i * cols_ + j) = depth(i, j);
        touching_.at(i * cols_ + j) = mask(i, j);
      }
    }
    numbers_.tell({{"press_mm", touch.contact.depth_mm},
                   {"contact_mm2", touch.contact.area_mm2},
                   {"share_with_depth", static_cast<double>(touch.depth.valid_pixels()) /
                                            static_cast<double>(touch.depth.pad_pixels)}});
  }

  std::uint8_t* free_image() { return free_.data(); }
  std::uint8_t* pressed_image() { return pressed_.data(); }
  const float* depth_mm() const { return depth_mm_.data(); }
  const std::uint8_t* touching() const { return touching_.data(); }
  const Numbers& numbers() const { return numbers_; }

 private:
  Picture<float> cap(const fingerpad::Camera<double>& camera,
                     double base_radius_mm,
                     double height_mm) const {
    Picture<float> depth(rows_, cols_, fingerpad::not_a_number<float>());
    const double radius = (base_radius_mm * base_radius_mm / height_mm + height_mm) / 2;
    const double middle = height_mm - radius;
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        const auto ray = ray_at_pixel(camera, static_cast<double>(i), static_cast<double>(j));
        if (ray.plate_rho_mm < base_radius_mm) {
          // (rho + t z)^2 + (z - middle)^2 = radius^2
          const double a = 1 + ray.tan_fluid * ray.tan_fluid;
          const double b = middle - ray.plate_rho_mm * ray.tan_fluid;
          const double c = ray.plate_rho_mm * ray.plate_rho_mm + middle * middle - radius * radius;
          depth.at(i * cols_ + j) = static_cast<float>((b + std::sqrt(b * b - a * c)) / a);
        }
      }
    }
    return depth;
  }

  Index rows_, cols_;
  Picture<std::uint8_t> free_, pressed_;
  Picture<float> depth_mm_;
  Picture<std::uint8_t> touching_;
  Numbers numbers_;
};

std::unique_ptr<VirtualPad> pad;
std::unique_ptr<OwnPictures> own;
std::string refusal;

void remember(const char* message) {
  refusal = message;
}

/// Pressed in the first second; turned to and fro; dragged until it slides; dragged back; lifted.
Object demo(double time_s, bool is_ball) {
  const auto ramp = [&](double from_s, double to_s) {
    const double share = std::clamp((time_s - from_s) / (to_s - from_s), 0.0, 1.0);
    return share * share * (3 - 2 * share);
  };
  Object object;
  object.is_ball = is_ball;
  object.press_mm = 3 * (ramp(0, 1) - ramp(7.2, 7.8));
  object.turn_rad = 0.2 * (ramp(1.2, 2) - ramp(2, 2.8));
  object.x_mm = 3.6 * ramp(3, 5) - 3.6 * ramp(5.4, 7);
  object.y_mm = 1.2 * ramp(3, 5) - 2.4 * ramp(5.4, 7);
  return object;
}

}  // namespace
}  // namespace playground

using namespace playground;

void pad_start() {
  fingerpad::set_refusal_handler(remember);
  pad = std::make_unique<VirtualPad>();
}
void pad_frame(int is_ball,
               double x_mm,
               double y_mm,
               double turn_rad,
               double press_mm,
               double friction,
               double noise_levels,
               double time_s) {
  pad->frame({is_ball != 0, x_mm, y_mm, turn_rad, press_mm, friction}, noise_levels, time_s);
}
void pad_demo_frame(double time_s, int is_ball, double noise_levels) {
  pad->frame(demo(time_s, is_ball != 0), noise_levels, time_s);
}
int pad_size_px() {
  return static_cast<int>(VirtualPad::size_px);
}
int pad_dots_across() {
  return static_cast<int>(dots_across);
}
const unsigned char* pad_image() {
  return pad->image();
}
const float* pad_depth_mm() {
  return pad->depth_mm();
}
const float* pad_true_depth_mm() {
  return pad->true_depth_mm();
}
const unsigned char* pad_touching() {
  return pad->touching();
}
const float* pad_dots() {
  return pad->dots();
}
const float* pad_section() {
  return pad->section();
}
int pad_edge_count() {
  return static_cast<int>(pad->edge().size() / 2);
}
const float* pad_edge() {
  return pad->edge().data();
}
const double* pad_numbers() {
  return pad->numbers().values();
}
const char* pad_names() {
  return pad->numbers().names();
}

void own_start(int rows, int cols) {
  fingerpad::set_refusal_handler(remember);
  own = std::make_unique<OwnPictures>(rows, cols);
}
unsigned char* own_free_image() {
  return own->free_image();
}
unsigned char* own_pressed_image() {
  return own->pressed_image();
}
void own_measure(double pitch_mm, double base_radius_mm, double height_mm) {
  own->measure(pitch_mm, base_radius_mm, height_mm);
}
const float* own_depth_mm() {
  return own->depth_mm();
}
const unsigned char* own_touching() {
  return own->touching();
}
const double* own_numbers() {
  return own->numbers().values();
}
const char* own_names() {
  return own->numbers().names();
}
const char* refusal_text() {
  return refusal.c_str();
}
