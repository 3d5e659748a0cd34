// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A fluid-filled pad that exists only here: a soap film over a round rim, pressed by a level plate
// or a ball, and what a camera, a dot finder and a gauge would see of it. Everything true of it is
// known, so the page can show what the library measures beside what is true. Closed forms and no
// solver, since a frame has a few milliseconds:
// - The film leaves the object tangentially and meets the rim at one angle. Around a contact of
//   radius a on an object of mean curvature H it falls with the slope tan(psi),
//     sin(psi) = L rho - (L - H) a^2 / rho,   p = 2 L tension.
// - A ball off the axis carries the film along: rigidly where it touches, not at all at the rim.
// - The object drags the film until friction lets go from the edge of the contact inward, as
//   Mindlin has it: the part of the contact that holds is 1 - pull / longest pull.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "fingerpad/core/point.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "fingerpad/math/rotation.hpp"
#include "fingerpad/optics/camera.hpp"

namespace playground {

using fingerpad::Index;
using fingerpad::Point2;
using fingerpad::Point3;
using std::numbers::pi;

constexpr double rim_mm = 18.735;    ///< radius of the clamped rim
constexpr double rim_sine = 0.9;     ///< sine of the film's inclination there
constexpr double tension = 0.104;    ///< of the film, N/mm: 10 kPa in the free pad
constexpr double ball_mm = 20;       ///< radius of the ball
constexpr double dent_reach_mm = 1;  ///< farthest that its dent goes from the axis
constexpr double widest_mm = 10;     ///< radius of the widest contact

/// What touches the pad, and where; press 0: nothing does.
struct Object {
  bool is_ball = false;
  double x_mm = 0, y_mm = 0;
  double turn_rad = 0;
  double press_mm = 0;  ///< how far its lowest point is below the top of the free pad
  double friction = 0.6;
};

/// Where the object dents the film: a level plate at the top, a ball under itself as long as it is
/// near the axis.
inline Point2<double> dent_of(const Object& object) {
  const double away = std::hypot(object.x_mm, object.y_mm);
  const double share = object.is_ball ? dent_reach_mm / (dent_reach_mm + away) : 0;
  return {share * object.x_mm, share * object.y_mm};
}

/// The film around a contact, by the distance rho from the contact's middle.
class Film {
 public:
  Film() {
    meet(0, 0);
    free_top_mm_ = top_mm_;
  }

  /// Moves the film under an object of mean curvature -1 / ball radius, or 0, whose lowest point is
  /// `press_mm` below the free top. The deeper the wider: found by halving.
  void press(double press_mm, double object_per_mm) {
    double narrow = 0, wide = press_mm > 0 ? widest_mm : 0;
    for (int step = 0; step < 40 && wide > 0; ++step) {
      const double contact = (narrow + wide) / 2;
      (free_top_mm_ - top_of(contact, object_per_mm) < press_mm ? narrow : wide) = contact;
    }
    meet(wide, object_per_mm);
  }

  double contact_mm() const { return contact_mm_; }
  double top_mm() const { return top_mm_; }
  double free_top_mm() const { return free_top_mm_; }
  /// Mean height of the contact: that of the circle which halves its area, but for a thousandth.
  double mean_contact_mm() const { return at(contact_mm_ / std::numbers::sqrt2).height_mm; }
  double pressure_mpa() const { return 2 * tension * free_per_mm_; }
  /// Of the object on the pad: what the pressure lifts less what the rim holds.
  double normal_n() const { return 2 * pi * rim_mm * tension * (free_per_mm_ * rim_mm - rim_sine); }

  struct HeightAndSlope {
    double height_mm, slope;
  };
  HeightAndSlope at(double rho) const {
    const Place p(rho);
    const double rise = height_[p.k + 1] - height_[p.k];
    return {height_[p.k] + p.t * rise, rise * (steps / rim_mm)};
  }
  double share(double rho) const {
    const Place p(rho);
    return share_[p.k] + p.t * (share_[p.k + 1] - share_[p.k]);
  }

 private:
  static constexpr int steps = 1024;

  struct Place {
    std::size_t k;
    double t;
    explicit Place(double rho) {
      const double place = std::min(rho * (steps / rim_mm), steps - 1e-9);
      k = static_cast<std::size_t>(place);
      t = place - static_cast<double>(k);
    }
  };

  static double curvature(double contact, double object_per_mm) {
    const double share = contact * contact / rim_mm;
    return (rim_sine - object_per_mm * share) / (rim_mm - share);
  }
  static double slope(double rho, double contact, double free_per_mm, double object_per_mm) {
    const double sine = rho <= contact ? object_per_mm * rho
                                       : free_per_mm * rho - (free_per_mm - object_per_mm) *
                                                                 contact * contact / rho;
    return -sine / std::sqrt(1 - sine * sine);
  }
  /// Calls visit(k, height) at rho = rim_mm k / count, from the rim inward, by Simpson's rule.
  template <class Visit>
  static void climb(int count, double contact, double object_per_mm, const Visit& visit) {
    const double free_per_mm = curvature(contact, object_per_mm);
    const double step = rim_mm / count;
    const auto at = [&](double rho) { return slope(rho, contact, free_per_mm, object_per_mm); };
    double height = 0;
    visit(count, height);
    for (int k = count - 1; k >= 0; --k) {
      const double rho = step * k;
      height -= step / 6 * (at(rho) + 4 * at(rho + step / 2) + at(rho + step));
      visit(k, height);
    }
  }
  /// How much of a ball's way the film goes with it: all where it touches, nothing at the rim.
  static double carried(double rho, double contact) {
    const double out = (rho - contact) / (rim_mm - contact);
    return out <= 0 ? 1 : out >= 1 ? 0 : (1 + std::cos(pi * out)) / 2;
  }
  static double top_of(double contact, double object_per_mm) {
    double top = 0;
    climb(64, contact, object_per_mm, [&](int, double height) { top = height; });
    return top;
  }
  void meet(double contact, double object_per_mm) {
    contact_mm_ = contact;
    free_per_mm_ = curvature(contact, object_per_mm);
    climb(steps, contact, object_per_mm, [&](int k, double height) {
      height_[static_cast<std::size_t>(k)] = height;
      share_[static_cast<std::size_t>(k)] = carried(rim_mm / steps * k, contact);
    });
    top_mm_ = height_[0];
  }

  double contact_mm_ = 0, free_per_mm_ = 0, top_mm_ = 0, free_top_mm_ = 0;
  std::array<double, steps + 1> height_{}, share_{};
};

/// The film where a ball off the axis has taken it.
struct Membrane {
  Film film;
  Point2<double> middle_mm = {0, 0};  ///< of the contact

  /// Where on the film, about the contact's middle, lies what is seen at `at`; `guess` is a place
  /// near it. The way of the ball is short against the film, so that each step leaves little.
  Point2<double> home(const Point2<double>& at, const Point2<double>& guess) const {
    return at - film.share(norm(guess)) * middle_mm;
  }
  double height(const Point2<double>& at) const {
    Point2<double> from = at - middle_mm;
    for (int step = 0; step < 12; ++step) {
      from = home(at, from);
    }
    return film.at(norm(from)).height_mm;
  }
  friend bool operator==(const Membrane& a, const Membrane& b) {
    return a.film.contact_mm() == b.film.contact_mm() && a.film.top_mm() == b.film.top_mm() &&
           a.middle_mm.x == b.middle_mm.x && a.middle_mm.y == b.middle_mm.y;
  }
};

/// How the object holds and drags the film.
class Grip {
 public:
  /// The object has come from `before` to `now`, over a film that has met it.
  void drag(const Object& before, const Object& now, const Film& film) {
    contact_mm_ = film.contact_mm();
    if (!(contact_mm_ > 0)) {
      *this = Grip();
      return;
    }
    lever_mm_ = 2 * contact_mm_ / 3;
    longest_mm_ = now.friction * film.normal_n() / stiffness_n_per_mm(film);
    step_ = {now.x_mm - before.x_mm, now.y_mm - before.y_mm};
    step_rad_ = now.turn_rad - before.turn_rad;
    pull_mm_ = pull_mm_ + step_;
    pull_rad_ += step_rad_;
    const double size = std::hypot(pull_mm_.x, pull_mm_.y, lever_mm_ * pull_rad_);
    slides_ = size > longest_mm_;
    if (slides_) {
      // what the object goes farther than the film can follow is slid
      const double lost = 1 - longest_mm_ / size;
      step_ = step_ - lost * pull_mm_;
      step_rad_ -= lost * pull_rad_;
      pull_mm_ = (1 - lost) * pull_mm_;
      pull_rad_ *= 1 - lost;
    }
    stick_mm_ = slides_ ? 0 : contact_mm_ * std::sqrt(1 - size / longest_mm_);
  }

  /// How far the last step has carried film at `at` from the middle of the contact.
  Point2<double> carried(const Point2<double>& at) const {
    const double rho = norm(at);
    const double share = rho < stick_mm_ ? 1 : (rim_mm - rho) / (rim_mm - stick_mm_);
    return std::max(share, 0.0) *
           Point2<double>{step_.x - step_rad_ * at.y, step_.y + step_rad_ * at.x};
  }
  bool touches() const { return contact_mm_ > 0; }
  bool slides() const { return slides_; }
  /// Share of the contact that holds.
  double stick_share() const {
    return touches() ? stick_mm_ * stick_mm_ / (contact_mm_ * contact_mm_)
                     : fingerpad::not_a_number<double>();
  }
  const Point2<double>& pull_mm() const { return pull_mm_; }
  /// Shear along the rim per mm of pull and per rad of turn, N/mm.
  double turning_n_per_mm(const Film& film) const {
    return stiffness_n_per_mm(film) * lever_mm_ * lever_mm_ * pull_rad_ /
           (2 * pi * rim_mm * rim_mm);
  }
  static constexpr double shear_per_mm2 = 0.08 * tension;  ///< of the rim, N/mm per mm of pull

  /// Force on the film per mm of pull; the second term is the lean that keeps the balance.
  static double stiffness_n_per_mm(const Film& film) {
    const double cosine = std::sqrt(1 - rim_sine * rim_sine);
    const double lean = cosine * film.top_mm() / (rim_mm * rim_sine - film.top_mm() * cosine);
    return pi * rim_mm * shear_per_mm2 * (1 + lean);
  }

 private:
  double contact_mm_ = 0, stick_mm_ = 0, lever_mm_ = 0, longest_mm_ = 0;
  Point2<double> pull_mm_ = {0, 0}, step_ = {0, 0};
  double pull_rad_ = 0, step_rad_ = 0;
  bool slides_ = false;
};

/// The clamped rim: how it is pulled, which is the whole force.
class Rim {
 public:
  static constexpr Index count = 72;

  static double angle(Index k) { return 2 * pi * static_cast<double>(k) / count; }
  static Point3<double> border(Index k) {
    return {rim_mm * std::cos(angle(k)), rim_mm * std::sin(angle(k)), 0};
  }

  /// Tensions that balance the object's force about the top of the film, and a ball's about its
  /// middle.
  void pull(const Membrane& membrane, const Grip& grip) {
    const Film& film = membrane.film;
    const double cosine = std::sqrt(1 - rim_sine * rim_sine);
    const double high = film.top_mm();
    const double lean = -high * Grip::shear_per_mm2 / (rim_mm * rim_sine - high * cosine);
    const double aside = -film.normal_n() / (rim_sine * pi * rim_mm * rim_mm);
    const Point2<double> drag = grip.pull_mm();
    const Point2<double> leaned = lean * drag + aside * membrane.middle_mm;
    const Point2<double> sheared = Grip::shear_per_mm2 * drag + cosine * aside * membrane.middle_mm;
    const double turning = grip.turning_n_per_mm(film);
    force_n = {0, 0, -film.pressure_mpa() * pi * rim_mm * rim_mm};
    moment_n_mm = {0, 0, 0};
    for (Index k = 0; k < count; ++k) {
      const double c = std::cos(angle(k)), s = std::sin(angle(k));
      const Point3<double> along = {-s, c, 0};
      const Point3<double> upward = {-cosine * c, -cosine * s, rim_sine};
      const double normal = tension + leaned.x * c + leaned.y * s;
      const double shear = turning - sheared.x * s + sheared.y * c;
      const Point3<double> f = 2 * pi * rim_mm / count * (normal * upward + shear * along);
      force_n += f;
      moment_n_mm += cross(border(k), f);
    }
  }

  Point3<double> force_n{}, moment_n_mm{};  ///< of the object on the pad, about the base's center
};

/// Numbers at random that are the same on every machine (xorshift64*).
class Random {
 public:
  /// Two of mean 0 and standard deviation 1: sums of four.
  Point2<double> normals() {
    state_ ^= state_ >> 12U;
    state_ ^= state_ << 25U;
    state_ ^= state_ >> 27U;
    const std::uint64_t bits = state_ * 0x2545F4914F6CDD1DULL;
    return {normal(static_cast<std::uint32_t>(bits)),
            normal(static_cast<std::uint32_t>(bits >> 32U))};
  }

 private:
  static double normal(std::uint32_t bits) {
    const std::uint32_t sum =
        (bits & 255U) + (bits >> 8U & 255U) + (bits >> 16U & 255U) + (bits >> 24U);
    constexpr double sd = 256 / std::numbers::sqrt3;  // of four numbers in [0, 255]
    return (static_cast<double>(sum) - 510) / sd;
  }

  std::uint64_t state_ = 20110801;
};

/// The camera's view of the film. Pixels whose depth and brightness are as before keep their
/// colour, since most of the time goes into the exponentials.
class View {
 public:
  static constexpr Index size_px = 256;
  static constexpr double brightness = 57, scattering = 0.0163, dot_share = 0.4;  // grey levels
  static constexpr double dot_mm = 0.4;  ///< radius of a printed dot

  const fingerpad::Camera<double> camera{
      .center_x_px = (size_px - 1) / 2.0, .center_y_px = (size_px - 1) / 2.0, .pitch_mm = 0.152};
  const fingerpad::Absorption<double> fluid;

  struct Pixel {
    Index place;
    Point2<double> start_mm, per_mm;  ///< its ray in the fluid
    fingerpad::Ray<double> ray;
    double scattering, light;           ///< g, and the lamp's share here
    Point2<double> home_mm = start_mm;  ///< of what it sees, on the film
    double depth_mm = 10, lit = 0;      ///< lit: brightness times light; 0: not seen yet
    double red = 0, green = 0;          ///< without noise
    double red_sd = 0, green_sd = 0;    ///< of shot noise that is 1 at full brightness
  };

  View() {
    for (Index i = 0; i < size_px; ++i) {
      for (Index j = 0; j < size_px; ++j) {
        const double row = static_cast<double>(i), col = static_cast<double>(j);
        const auto ray = ray_at_pixel(camera, row, col);
        const double share = ray.plate_rho_mm / rim_mm;
        if (share < 1) {
          const auto low = point_at(camera, row, col, 0.0), high = point_at(camera, row, col, 1.0);
          pixels_.push_back({.place = i * size_px + j,
                             .start_mm = {low.x, low.y},
                             .per_mm = {high.x - low.x, high.y - low.y},
                             .ray = ray,
                             .scattering = scattering * (1 - 0.05 * share * share),
                             .light = 1 - 0.06 * share * share});
        }
      }
    }
  }

  const std::vector<Pixel>& pixels() const { return pixels_; }

  /// Looks at the film and its dots, of which those that are not there are NaN.
  void look(const Membrane& membrane, const std::vector<Point2<double>>& dots_px) {
    ink(dots_px);
    const bool moved = !(membrane == last_);
    last_ = membrane;
    for (Pixel& pixel : pixels_) {
      const double depth = moved || pixel.lit == 0 ? seen(membrane, pixel) : pixel.depth_mm;
      const double lit = brightness * pixel.light * (1 - (1 - dot_share) * ink_[place(pixel)]);
      if (std::abs(depth - pixel.depth_mm) < 1e-6 && lit == pixel.lit) {
        continue;
      }
      pixel.depth_mm = depth;
      pixel.lit = lit;
      const auto colour = colour_at_depth(fluid, pixel.ray, lit, pixel.scattering, depth);
      pixel.red = colour.red;
      pixel.green = colour.green;
      pixel.red_sd = std::sqrt(colour.red / brightness);
      pixel.green_sd = std::sqrt(colour.green / brightness);
    }
  }

 private:
  static std::size_t place(const Pixel& pixel) { return static_cast<std::size_t>(pixel.place); }

  /// Where the pixel's ray meets the film: Newton's method from where it met it last.
  static double seen(const Membrane& membrane, Pixel& pixel) {
    double z = pixel.depth_mm;
    for (int step = 0; step < 12; ++step) {
      pixel.home_mm = membrane.home(pixel.start_mm + z * pixel.per_mm, pixel.home_mm);
      const double rho = norm(pixel.home_mm);
      const auto film = membrane.film.at(rho);
      const double along = rho > 0 ? dot(pixel.home_mm, pixel.per_mm) / rho : 0;
      const double change = (film.height_mm - z) / (1 - film.slope * along);
      z += change;
      if (std::abs(change) < 1e-6) {
        break;
      }
    }
    return std::max(z, 0.0);
  }

  /// Which share of each pixel a dot covers.
  void ink(const std::vector<Point2<double>>& dots_px) {
    ink_.assign(static_cast<std::size_t>(size_px * size_px), 0.0);
    constexpr double radius_px = dot_mm / 0.152 * 0.85;  // at the film, which is farther away
    for (const Point2<double>& dot : dots_px) {
      if (!is_finite(dot)) {
        continue;
      }
      const auto row = static_cast<Index>(dot.y), col = static_cast<Index>(dot.x);
      for (Index i = std::max<Index>(row - 4, 0); i < std::min(row + 6, size_px); ++i) {
        for (Index j = std::max<Index>(col - 4, 0); j < std::min(col + 6, size_px); ++j) {
          const double off =
              std::hypot(static_cast<double>(j) - dot.x, static_cast<double>(i) - dot.y);
          double& share = ink_[static_cast<std::size_t>(i * size_px + j)];
          share = std::max(share, std::clamp(radius_px + 0.5 - off, 0.0, 1.0));
        }
      }
    }
  }

  std::vector<Pixel> pixels_;
  std::vector<double> ink_;
  Membrane last_;
};

}  // namespace playground
