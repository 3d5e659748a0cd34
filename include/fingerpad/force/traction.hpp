// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The load of the object on each dot of the membrane: maps of contact pressure and shear, and force
// and moment as their sums. The method is not in the papers. A membrane carries load by tension
// alone:
//   q = -(div T + p n).
// The load q is per current area, p is the pressure of the fluid, and n is the normal out of the
// pad. The tension T follows from the stretch against the stress-free membrane
// (membrane/rubber.hpp).
//
// docs/force/traction.md has the equations. The divergence at a dot is the pull of the triangles
// around it, the derivative of their stored energy; each cell of four dots is divided by either of
// its diagonals, and its energy is the mean of both. If mu t (shear modulus times thickness of the
// stress-free membrane) is not given, the free part of each frame gives it, where the mean of the
// normal loads is 0.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/membrane/rubber.hpp"

namespace fingerpad {
inline namespace v1 {

enum class TractionStatus : std::uint8_t {
  ok,
  no_contact,  ///< no dot is in contact: force and moment are 0; the maps are written
  incomplete,  ///< force and moment lack the share of some dots in contact or beside it. These
               ///< dots have no load: they lie on the edge of the grid, or were not found
  free_part_loaded,  ///< the free part, where nothing touches, is not free of load:
                     ///< modulus_differs or is_pulled
  bad_pressure,      ///< <= 0, not finite, or above max_pressure_mpa (kPa, Pa?): no force
  bad_dots,          ///< no dot was found with all its neighbours, or most cells are folded or
                     ///< stretched fivefold: another order, unit or pad? No force
  no_balance,        ///< no mu t was given, and the free part is too small or does not balance the
                     ///< pressure: no force
  refused,           ///< a grid has another size: nothing was done
};

/// "ok", "no contact", ...
constexpr const char* name_of(TractionStatus status) {
  constexpr std::array<const char*, 8> names = {
      "ok",           "no contact", "incomplete", "free part loaded",
      "bad pressure", "bad dots",   "no balance", "refused"};
  return names[static_cast<std::size_t>(status)];
}

/// Force and moment of a frame. They are finite where there is a force (see has_force). Any other
/// number that is not known is NaN.
template <scalar S = double>
struct [[nodiscard]] TractionResult {
  TractionStatus status = TractionStatus::refused;
  /// With the given mu t the free part does not balance the pressure, within 5 % plus the noise of
  /// the dots, at most 20 %: the membrane has aged or is another one, or the gauge is off. Force
  /// and maps use the given mu t: F_z is off by about twice as much.
  bool modulus_differs = false;
  /// The mean load on the free part along the base is more than a quarter of the pressure: dots
  /// shifted by one, or of another pad. Force and maps are not reliable.
  bool is_pulled = false;
  Point3<S> force_n = detail::missing_point<S>();      ///< that the object exerts on the pad
  Point3<S> moment_n_mm = detail::missing_point<S>();  ///< about the origin
  S mu_t_n_per_mm = not_a_number<S>();                 ///< that was used
  S free_mu_t_n_per_mm = not_a_number<S>();  ///< by the free part, even if mu t was given; its mean
                                             ///< over frames of the free pad calibrates mu t
  S free_load_rms_mpa = not_a_number<S>();   ///< rms of the loads on the free part, which should be
                                             ///< 0: the error of a single dot's load
  Index free_dots = 0;                       ///< dots of the free part
  Index dots_left_out = 0;  ///< in contact or in the ring around it, but without a load

  bool ok() const { return status == TractionStatus::ok; }
  bool has_force() const { return is_finite(force_n); }
};

template <scalar S = double>
struct TractionOptions {
  /// Shear modulus times thickness of the stress-free membrane, in (0, 1e6). It is measured on the
  /// material, or is the mean free_mu_t_n_per_mm of frames of the free pad. Empty: computed from
  /// the free part of each frame.
  std::optional<S> mu_t_n_per_mm = {};
  S mooney_share = S(0);  ///< second constant of the rubber, in [0, 1], as that of StressFreeCap
  /// Smallest number of dots of the free part from which mu t is computed or checked, >= 1. The
  /// noise of mu t goes with the inverse root of their number.
  Index min_free_dots = 40;
  /// In [0, 5]: force and moment are summed over the dots in contact and this many around it, to
  /// which the mesh carries a share of the load at the contact's edge. The dots outside are the
  /// free part, where the load is 0.
  Index ring_dots = 1;
  /// In [0, 20]: over this many further dots the weight in the sums falls to 0. This does not
  /// change the true sums. An abrupt end (0) makes them noisy, because they then depend on the pull
  /// across one line of dots.
  Index fade_dots = 3;
  double max_pressure_mpa = 0.2;  ///< > 0: a higher pressure is taken for kPa or Pa
};

/// The refusal of the first value that is out of range; "" if all are good.
template <scalar S>
std::string check(const TractionOptions<S>& o) {
  return check("TractionOptions", {{"mu_t_n_per_mm",
                                    o.mu_t_n_per_mm.value_or(S(1)),
                                    {.min = 0, .max = 1e6, .above_min = true, .below_max = true}},
                                   {"mooney_share", o.mooney_share, within(0, 1)},
                                   {"min_free_dots", o.min_free_dots, at_least(1)},
                                   {"ring_dots", o.ring_dots, within(0, 5)},
                                   {"fade_dots", o.fade_dots, within(0, 20)},
                                   {"max_pressure_mpa", o.max_pressure_mpa, positive}});
}

namespace detail::traction {

/// Twice the area vector of a triangle: normal to it, with the sense of its corners.
template <scalar S>
Point3<S> twice_area(const Point3<S>& x, const Point3<S>& y, const Point3<S>& z) {
  return cross(y - x, z - y);
}

/// A triangle of membrane between the corners x, y and z.
template <scalar S>
struct Triangle {
  // Without stress x lies at (0, 0) of its plane, y at (base, 0) and z at (shift, height).
  S base_mm = S(0);  ///< 0: a dot is missing, or it is flatter than 1 : 1000
  S shift_mm = S(0), height_mm = S(0);

  Triangle() = default;
  Triangle(const Point3<S>& x, const Point3<S>& y, const Point3<S>& z) {
    const Point3<S> a = y - x, b = z - y, c = x - z;
    const S doubled = norm(twice_area(x, y, z));
    S longest_sq = S(0);
    for (const Point3<S>& edge : {a, b, c}) {
      longest_sq = longest_sq < squared_norm(edge) ? squared_norm(edge) : longest_sq;
    }
    if (doubled > S(1e-3) * longest_sq) {  // false for NaN
      base_mm = norm(a);
      shift_mm = -dot(a, c) / base_mm;
      height_mm = doubled / base_mm;
    }
  }

  bool is_known() const { return value(base_mm) > 0; }

  /// Finds the pull of the membrane on its corners for mu t = 1 N/mm, the derivatives of its stored
  /// energy, in mm, and twice its area vector. False where a principal stretch lies beyond [1 / 5,
  /// 5]: the dots must be wrong. The squares of the stretches are the roots of
  /// s^2 - |F|^2 s + J^2.
  bool pull(const Point3<S>& x,
            const Point3<S>& y,
            const Point3<S>& z,
            const S& mooney_share,
            std::array<Point3<S>, 3>& pulls,
            Point3<S>& normal) const {
    const S in_base = S(1) / base_mm, in_height = S(1) / height_mm;
    const Point3<S> along = in_base * (y - x);
    const Point3<S> across = in_height * (z - x - shift_mm * along);
    normal = twice_area(x, y, z);
    const S stretch_sq = squared_norm(along) + squared_norm(across);
    const S ratio_sq = squared_norm(normal) / square(base_mm * height_mm);
    const S most = S(25), least = S(1) / most;
    const S above = most * (most - stretch_sq) + ratio_sq;
    const S below = least * (least - stretch_sq) + ratio_sq;
    if (!(value(above) >= 0 && value(below) >= 0 && value(stretch_sq) <= value(S(2) * most) &&
          value(stretch_sq) >= value(S(2) * least))) {
      return false;
    }
    const Point3<S> half_across = S(0.5) * rubber_pull(across, along, mooney_share);
    pulls[2] = -base_mm * half_across;
    pulls[1] =
        shift_mm * half_across - S(0.5) * height_mm * rubber_pull(along, across, mooney_share);
    pulls[0] = -(pulls[1] + pulls[2]);
    return true;
  }
};

}  // namespace detail::traction

/// Computes the loads on the dots of a pad. The object holds the maps of its last frame; one object
/// a thread. A frame allocates nothing, throws nothing, and takes O(rows cols) time.
template <scalar S = double>
class TractionField {
 public:
  /// `stress_free_mm`: positions of the dots when the membrane carries neither pressure nor
  /// contact; NaN: no such dot. Only their shape counts, not where it lies. Rows and columns may
  /// run any way; out of the pad is the side on which z grows. Refuses bad parameters and fewer
  /// than 3 x 3 dots (parameter_error).
  template <spatial_dot_grid Dots>
  explicit TractionField(const Dots& stress_free_mm, const TractionOptions<S>& options = {})
      : options_((require(options), options)) {
    const auto from = as_view(stress_free_mm);
    rows_ = from.rows();
    cols_ = from.cols();
    expects_grid_size("TractionField", rows_, cols_, 3);
    const auto dots = static_cast<std::size_t>(rows_ * cols_);
    place_ = pull_ = area_ = cell_area_ = load_ = shear_ =
        std::vector<Point3<S>>(dots, detail::missing_point<S>());
    pressure_.assign(dots, not_a_number<S>());
    use_.assign(dots, Use::none);
    found_.assign(dots, 0);
    steps_.assign(dots, 0);
    part_steps_ = steps_;
    ears_.resize(dots);
    read_dots(from);
    S upward = S(0);
    for (Index i = 0; i + 1 < rows_; ++i) {
      for (Index j = 0; j + 1 < cols_; ++j) {
        for (std::size_t c = 0; c < 4; ++c) {
          const auto cell = dots_around(at(i, j));
          const Point3<S>&x = place_[cell[(c + 3) % 4]], &y = place_[cell[c]],
                &z = place_[cell[(c + 1) % 4]];
          ears_[at(i, j)][c] = detail::traction::Triangle<S>(x, y, z);
          const S rise = detail::traction::twice_area(x, y, z).z;
          upward += ears_[at(i, j)][c].is_known() ? rise : S(0);
        }
      }
    }
    outward_ = S(value(upward) < 0 ? -1 : 1);
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

  // The last frame, dot by dot; NaN where unknown. The views live as long as the object.

  /// Load that the object exerts on the pad, MPa, per current area.
  StridedView<const Point3<S>> load_mpa() const { return map(load_); }
  /// Contact pressure, positive into the pad: -load . n, with n out of the pad.
  StridedView<const S> pressure_mpa() const { return map(pressure_); }
  /// The part of the load along the membrane.
  StridedView<const Point3<S>> shear_mpa() const { return map(shear_); }
  /// Area vector of the dot's share of the membrane, along n, mm^2; a load times its length is a
  /// force.
  StridedView<const Point3<S>> area_mm2() const { return map(area_); }

  /// The loads in a frame with dots `dots_mm` (NaN: not found). A true `contact` marks the dots
  /// that touch the object. `pressure_mpa` is the pressure of the fluid above that outside.
  template <spatial_dot_grid Dots, contact_mask Contact>
  TractionResult<S> operator()(const Dots& dots_mm, const Contact& contact, const S& pressure_mpa) {
    const auto dots = as_view(dots_mm);
    const auto touch = as_view(contact);
    TractionResult<S> result;
    if (!has_size(dots) || !has_size(touch)) {
      return result;
    }
    read_dots(dots);
    place_missing_dots();
    const bool touches = count_steps(touch, steps_);
    const bool is_membrane = pull_cells() && settle_dots();
    result.status = find_modulus(pressure_mpa, is_membrane, result);
    write_loads(pressure_mpa, result);
    frame_ = result;
    frame_pressure_mpa_ = pressure_mpa;
    return sum_loads(touches, steps_, result);
  }

  /// Force and moment of one of several contacts of the last frame, whose dots `contact` marks. Of
  /// the rings, a dot counts for the nearest contact, or for all that are as near.
  template <contact_mask Contact>
  TractionResult<S> part(const Contact& contact) {
    const auto touch = as_view(contact);
    return has_size(touch) ? sum_loads(count_steps(touch, part_steps_), part_steps_, frame_)
                           : TractionResult<S>();
  }

 private:
  /// What a dot is good for. Sums need the four cells around it, facing one side (else the membrane
  /// would be folded there); a load of its own needs all nine dots to be found.
  enum class Use : std::uint8_t { none, sums, load };

  template <class G>
  bool has_size(const G& g) const {
    return g.rows() == rows_ && g.cols() == cols_;
  }
  template <class T>
  StridedView<const T> map(const std::vector<T>& values) const {
    return {values.data(), rows_, cols_, cols_};
  }
  std::size_t at(Index i, Index j) const { return static_cast<std::size_t>(i * cols_ + j); }
  bool is_inside(Index i, Index j) const { return i >= 0 && j >= 0 && i < rows_ && j < cols_; }
  bool is_found(Index i, Index j) const { return is_inside(i, j) && found_[at(i, j)] != 0; }
  /// Whether a dot has a load and lies beyond the ring around the contact.
  bool is_free(std::size_t k) const {
    return use_[k] == Use::load && steps_[k] > options_.ring_dots;
  }

  /// The dots around the cell between dot k and the next ones along row and column.
  std::array<std::size_t, 4> dots_around(std::size_t k) const {
    const auto cols = static_cast<std::size_t>(cols_);
    return {k, k + 1, k + cols + 1, k + cols};
  }
  template <class Dots>
  void read_dots(const Dots& dots) {
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        place_[at(i, j)] = detail::spatial_dot<S>(cell_t<Dots>(dots(i, j)));
        found_[at(i, j)] = is_finite(place_[at(i, j)]) ? 1 : 0;
      }
    }
  }

  void place_missing_dots() {
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        place_[at(i, j)] = is_found(i, j) ? place_[at(i, j)] : between_neighbours(i, j);
      }
    }
  }
  /// On the surface of degree two through all eight neighbours, or in the middle of the opposite
  /// pairs that were found beside the dot, else of those at its corners.
  Point3<S> between_neighbours(Index i, Index j) const {
    constexpr DotIndex steps[4] = {{0, 1}, {1, 0}, {1, 1}, {1, -1}};
    Point3<S> sums[2] = {{S(0), S(0), S(0)}, {S(0), S(0), S(0)}};
    int pairs[2] = {0, 0};
    for (int n = 0; n < 4; ++n) {
      const auto [r, c] = steps[n];
      if (is_found(i + r, j + c) && is_found(i - r, j - c)) {
        sums[n / 2] += (place_[at(i + r, j + c)] + place_[at(i - r, j - c)]) / S(2);
        ++pairs[n / 2];
      }
    }
    const int used = pairs[0] > 0 ? 0 : 1;
    return pairs[0] + pairs[1] == 4 ? sums[0] - sums[1] / S(2)
           : pairs[used] > 0        ? sums[used] / S(pairs[used])
                                    : detail::missing_point<S>();
  }

  /// Counts the steps from each dot to the nearest one in contact, to any of the eight neighbours,
  /// in a pass forward and one backward. Whether any is in contact.
  template <class Touch>
  bool count_steps(const Touch& touch, std::vector<Index>& steps) const {
    bool touches = false;
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        const bool here = is_contact(std::remove_cvref_t<decltype(touch(i, j))>(touch(i, j)));
        steps[at(i, j)] = here ? 0 : rows_ + cols_;
        touches = touches || here;
        pass_on_steps(i, j, 1, steps);
      }
    }
    for (Index i = rows_ - 1; i >= 0; --i) {
      for (Index j = cols_ - 1; j >= 0; --j) {
        pass_on_steps(i, j, -1, steps);
      }
    }
    return touches;
  }
  void pass_on_steps(Index i, Index j, Index way, std::vector<Index>& steps) const {
    for (const auto& [r, c] : {DotIndex{-1, -1}, {-1, 0}, {-1, 1}, {0, -1}}) {
      if (is_inside(i + way * r, j + way * c)) {
        steps[at(i, j)] = (std::min)(steps[at(i, j)], steps[at(i + way * r, j + way * c)] + 1);
      }
    }
  }

  /// Finds the pull on each dot for mu t = 1 N/mm, and its share of the area, as means over both
  /// diagonals of each cell. Cells that are folded or stretched too far have none; false if these
  /// are most.
  bool pull_cells() {
    const Point3<S> zero = {S(0), S(0), S(0)};
    std::fill(pull_.begin(), pull_.end(), zero);
    std::fill(area_.begin(), area_.end(), zero);
    const S a_twelfth = outward_ / S(12);  // a third of each triangle, half of it
    Index taken = 0, refused = 0;
    for (Index i = 0; i + 1 < rows_; ++i) {
      for (Index j = 0; j + 1 < cols_; ++j) {
        const std::size_t cell = at(i, j);
        const std::array<std::size_t, 4> dots = dots_around(cell);
        std::array<std::array<Point3<S>, 3>, 4> pulls;
        std::array<Point3<S>, 4> normal;
        bool known = true, sound = true;
        for (std::size_t c = 0; c < 4; ++c) {
          const auto& x = place_[dots[(c + 3) % 4]];
          const auto& y = place_[dots[c]];
          const auto& z = place_[dots[(c + 1) % 4]];
          known = known && is_finite(y) && ears_[cell][c].is_known();
          sound = known && sound &&
                  ears_[cell][c].pull(x, y, z, options_.mooney_share, pulls[c], normal[c]);
        }
        sound =
            sound && value(dot(normal[0], normal[2])) > 0 && value(dot(normal[1], normal[3])) > 0;
        taken += sound ? 1 : 0;
        refused += known && !sound ? 1 : 0;
        cell_area_[cell] = sound ? normal[0] + normal[2] : detail::missing_point<S>();
        for (std::size_t c = 0; sound && c < 4; ++c) {  // in all triangles but the opposite one
          const std::size_t next = (c + 1) % 4, across = (c + 2) % 4, last = (c + 3) % 4;
          pull_[dots[c]] += S(0.5) * (pulls[c][1] + pulls[next][0] + pulls[last][2]);
          area_[dots[c]] += a_twelfth * (S(2) * cell_area_[cell] - normal[across]);
        }
      }
    }
    return refused <= taken;
  }

  /// Finds what each dot is good for. False if none has a load.
  bool settle_dots() {
    const auto cols = static_cast<std::size_t>(cols_);
    bool any = false;
    for (Index i = 1; i + 1 < rows_; ++i) {
      for (Index j = 1; j + 1 < cols_; ++j) {
        const std::size_t k = at(i, j);
        bool is_whole = true, all_found = true;
        for (const std::size_t cell : {k - cols - 1, k - cols, k - 1, k}) {
          is_whole = is_whole && value(outward_ * dot(cell_area_[cell], area_[k])) > 0;
        }
        for (const std::size_t row : {k - cols, k, k + cols}) {
          all_found = all_found && found_[row - 1] + found_[row] + found_[row + 1] == 3;
        }
        use_[k] = !is_whole ? Use::none : all_found ? Use::load : Use::sums;
        any = any || use_[k] == Use::load;
      }
    }
    return any;
  }

  /// Finds mu t: given, or such that the free part balances the pressure.
  TractionStatus find_modulus(const S& pressure_mpa,
                              bool is_membrane,
                              TractionResult<S>& result) const {
    if (!(value(pressure_mpa) > 0) || pressure_mpa > S(options_.max_pressure_mpa)) {
      return TractionStatus::bad_pressure;
    }
    if (!is_membrane) {
      return TractionStatus::bad_dots;
    }
    S holding = S(0);
    for (std::size_t k = 0; k < use_.size(); ++k) {
      if (is_free(k)) {
        ++result.free_dots;
        holding = holding - dot(pull_[k], area_[k]) / squared_norm(area_[k]);
      }
    }
    if (result.free_dots >= options_.min_free_dots && value(holding) > 0) {
      result.free_mu_t_n_per_mm = pressure_mpa * S(static_cast<double>(result.free_dots)) / holding;
    }
    const S mu_t = options_.mu_t_n_per_mm.value_or(result.free_mu_t_n_per_mm);
    if (!(mu_t < S(1e6))) {  // squares of larger ones might overflow
      return TractionStatus::no_balance;
    }
    result.mu_t_n_per_mm = mu_t;
    return TractionStatus::ok;
  }

  /// Force of the object on the dot's share of the membrane, N, which balances pressure and
  /// tension.
  Point3<S> force_on(std::size_t k, const S& pressure_mpa, const S& mu_t) const {
    return -(pressure_mpa * area_[k] + mu_t * pull_[k]);
  }

  /// Writes the loads and their parts along the normal and the membrane, none without mu t; and
  /// what is left on the free part.
  void write_loads(const S& pressure_mpa, TractionResult<S>& result) {
    using std::sqrt;
    S sum_sq = S(0);
    Point3<S> sum = {S(0), S(0), S(0)};
    for (std::size_t k = 0; k < use_.size(); ++k) {
      load_[k] = shear_[k] = detail::missing_point<S>();
      pressure_[k] = not_a_number<S>();
      if (result.ok() && use_[k] == Use::load) {
        const S size = norm(area_[k]);
        const Point3<S> normal = area_[k] / size;
        load_[k] = force_on(k, pressure_mpa, result.mu_t_n_per_mm) / size;
        pressure_[k] = -dot(load_[k], normal);
        shear_[k] = load_[k] + pressure_[k] * normal;
        sum_sq += is_free(k) ? squared_norm(load_[k]) : S(0);
        sum += is_free(k) ? load_[k] : Point3<S>{S(0), S(0), S(0)};
      }
    }
    if (!result.ok() || result.free_dots == 0) {
      return;
    }
    const S dots = S(static_cast<double>(result.free_dots));
    const S rms = value(sum_sq) > 0 ? sqrt(sum_sq / dots) : S(0);
    result.free_load_rms_mpa = rms;
    // The sum of the loads is the pull across the border, so its noise is about that of one dot, of
    // which three times are allowed; a twentieth is twice the error of the mesh.
    const S by_noise = S(0.05) + S(3) * rms / (dots * pressure_mpa);
    const S bound = by_noise < S(0.2) ? by_noise : S(0.2);
    const S off = result.mu_t_n_per_mm / result.free_mu_t_n_per_mm - S(1);
    const bool enough = result.free_dots >= options_.min_free_dots;
    result.modulus_differs = enough && !(off < bound && -off < bound);
    result.is_pulled =
        enough && square(dots * pressure_mpa) < S(16) * (square(sum.x) + square(sum.y));
  }

  /// Sums force and moment over the dots in contact and in the ring around it, and with decreasing
  /// weight over those of the fade, except those that are nearer to another contact.
  TractionResult<S> sum_loads(bool touches,
                              const std::vector<Index>& steps,
                              TractionResult<S> result) const {
    if (!result.ok()) {
      return result;
    }
    const Index fade = options_.fade_dots + 1;
    result.force_n = result.moment_n_mm = {S(0), S(0), S(0)};
    for (std::size_t k = 0; k < use_.size(); ++k) {
      const Index beyond = (std::max)(steps[k] - options_.ring_dots, Index(0));
      if (beyond >= fade || steps[k] > steps_[k]) {
        continue;
      }
      if (use_[k] == Use::none) {
        result.dots_left_out += beyond == 0 ? 1 : 0;
        continue;
      }
      const S weight = S(static_cast<double>(fade - beyond)) / S(static_cast<double>(fade));
      const Point3<S> force = weight * force_on(k, frame_pressure_mpa_, result.mu_t_n_per_mm);
      result.force_n += force;
      result.moment_n_mm += cross(place_[k], force);
    }
    result.status = !touches                                     ? TractionStatus::no_contact
                    : result.dots_left_out > 0                   ? TractionStatus::incomplete
                    : result.modulus_differs || result.is_pulled ? TractionStatus::free_part_loaded
                                                                 : TractionStatus::ok;
    return result;
  }

  TractionOptions<S> options_;
  Index rows_ = 0;
  Index cols_ = 0;
  S outward_ = S(1);  ///< -1 if the normal by rows and columns points into the pad
  std::vector<std::array<detail::traction::Triangle<S>, 4>> ears_;  ///< of the cell at each dot
  std::vector<Point3<S>> place_, pull_, area_, cell_area_, load_, shear_;
  std::vector<S> pressure_;
  std::vector<Use> use_;
  std::vector<std::uint8_t> found_;
  std::vector<Index> steps_, part_steps_;  ///< from the nearest dot in contact
  TractionResult<S> frame_ = {};           ///< the last one, without the sums
  S frame_pressure_mpa_ = S(0);
};

template <spatial_dot_grid Dots>
explicit TractionField(const Dots&) -> TractionField<>;
template <spatial_dot_grid Dots, scalar S = double>
TractionField(const Dots&, const TractionOptions<S>&) -> TractionField<S>;

}  // namespace v1
}  // namespace fingerpad
