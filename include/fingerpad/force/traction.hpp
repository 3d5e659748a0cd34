// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The load of the object on each dot of the membrane: maps of contact pressure and shear, and force
// and moment as their sums. The method is not in the papers. A membrane carries load by tension
// alone:
//   q = -(div T + p n),   T = (mu t / J) (B - J^-2 P),   B = F F^T.
// The load q is per current area, p is the pressure of the fluid, and n is the normal out of the
// pad. F is the surface deformation gradient against the stress-free membrane, J = det F, and P the
// identity on the surface.
//
// In discrete form, the divergence at a dot is the pull of the cells around it, the derivative of
// their stored energy. Therefore rigid motions change nothing, and the sum of the loads over a
// patch equals the pull across its border plus the pressure on it, to rounding: the mesh blurs a
// load by about one pitch but loses none of it. The steps are in detail/, in this order: dot_cell,
// traction_memory, frame_loads.
//
// If mu t (shear modulus times thickness of the stress-free membrane) is not given, it is computed
// from the free part of each frame, where the membrane alone balances the pressure. There the mean
// of the normal loads is 0. With f the pull on a dot for mu t = 1 N/mm, A its area and n its
// normal, this gives sum p = -mu t sum f . n / A. Least squares of mu t f + p A n would be biased:
// noise of the dots adds to f . f, which makes mu t too small, but does not affect f . n.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/dot_cell.hpp"
#include "fingerpad/force/detail/frame_loads.hpp"
#include "fingerpad/force/detail/traction_memory.hpp"

namespace fingerpad {
inline namespace v0 {

enum class TractionStatus : std::uint8_t {
  ok,
  no_contact,  ///< no dot is in contact: force and moment are 0; the maps are written
  incomplete,  ///< force and moment lack the share of some dots in contact or beside it. These dots
               ///< have no load: they lie on the edge of the grid, or dots were not found
  bad_pressure,             ///< <= 0 or not finite: no force
  pressure_not_in_mpa,      ///< above max_pressure_mpa: kPa, Pa? No force
  not_of_this_membrane,     ///< most cells are folded, or stretched beyond largest_stretch: dots in
                            ///< another order or unit, or of another pad. No force
  too_few_dots,             ///< no dot was found with all its neighbours: no force
  modulus_not_of_this_pad,  ///< with the given mu t the free part does not balance the pressure,
                            ///< within 5 % plus the noise of the dots, at most 20 %: the membrane
                            ///< has aged or is another one, or the gauge is off. Force and maps use
                            ///< the given mu t: F_z is off by about twice as much
  free_part_pulled,         ///< the mean load on the free part, where nothing pulls, is more than a
                            ///< quarter of the pressure along the base: dots shifted by one, or
                            ///< of another pad. Force and maps are those of the dots as given and
                            ///< are not reliable
  no_balance,  ///< no mu t was given, and the free part is too small or does not balance the
               ///< pressure
  refused,     ///< a grid or the maps have another size: nothing was done
};

/// "ok", "no contact", ...
constexpr const char* name_of(TractionStatus status) {
  switch (status) {
    case TractionStatus::ok:
      return "ok";
    case TractionStatus::no_contact:
      return "no contact";
    case TractionStatus::incomplete:
      return "incomplete";
    case TractionStatus::bad_pressure:
      return "bad pressure";
    case TractionStatus::pressure_not_in_mpa:
      return "pressure not in MPa";
    case TractionStatus::not_of_this_membrane:
      return "not of this membrane";
    case TractionStatus::too_few_dots:
      return "too few dots";
    case TractionStatus::modulus_not_of_this_pad:
      return "modulus not of this pad: has the membrane aged?";
    case TractionStatus::free_part_pulled:
      return "free part pulled: dots shifted by one?";
    case TractionStatus::no_balance:
      return "no balance";
    case TractionStatus::refused:
      return "refused";
  }
  return "unknown";
}

/// Force and moment of a frame. `force_n` and `moment_n_mm` are finite where there is a force (see
/// has_force). Any other number that is not known is NaN.
template <scalar S = double>
struct [[nodiscard]] TractionResult {
  TractionStatus status = TractionStatus::refused;
  Point3<S> force_n = detail::missing_point<S>();      ///< that the object exerts on the pad
  Point3<S> moment_n_mm = detail::missing_point<S>();  ///< about the origin
  S mu_t_n_per_mm = not_a_number<S>();                 ///< the mu t that was used
  detail::traction::ModulusBalance<S> balance =
      {};  ///< mu t by the free part of this frame, even if it was given
  Point3<S> free_load_mpa = detail::missing_point<S>();  ///< mean of the loads on the free part
  S free_load_rms_mpa = not_a_number<S>();  ///< rms of the same loads, which should be 0: the error
                                            ///< of a single dot's load
  Index dots_in_contact = 0;
  Index dots_summed = 0;    ///< dots whose loads make the force
  Index dots_left_out = 0;  ///< in contact or in the ring around it, but without a load
  Index dots_bridged = 0;   ///< not found, but placed between their neighbours for the sums
  Index dots_loaded = 0;    ///< dots with a load in the maps, if mu t is known
  Index cells_taken = 0;    ///< cells that pull their dots
  Index cells_refused = 0;  ///< folded, or stretched beyond largest_stretch
  Index cells_slack = 0;    ///< with a tension below 0
  S smallest_tension_n_per_mm = not_a_number<S>();  ///< of all cells

  bool ok() const { return status == TractionStatus::ok; }
  bool has_force() const {
    return ok() || status == TractionStatus::no_contact || status == TractionStatus::incomplete ||
           status == TractionStatus::modulus_not_of_this_pad ||
           status == TractionStatus::free_part_pulled;
  }
};

template <scalar S = double>
struct TractionOptions {
  /// Shear modulus times thickness of the stress-free membrane, in (0, 1e6]. It is measured on the
  /// material, or follows from the sum of the `balance` of frames of the free pad. Empty: computed
  /// from the free part of each frame.
  std::optional<S> mu_t_n_per_mm = {};
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
  double largest_stretch = 5.0;   ///< in (1, 1000]: a cell with a principal stretch above this or
                                  ///< below its inverse is refused, because its dots must be wrong
};
template <scalar S>
void expects_valid(const TractionOptions<S>& options) {
  expects(!options.mu_t_n_per_mm || detail::traction::is_measure(*options.mu_t_n_per_mm),
          "TractionOptions", "mu_t_n_per_mm", options.mu_t_n_per_mm.value_or(S(0)), "in (0, 1e6]");
  expects(options.min_free_dots >= 1, "TractionOptions", "min_free_dots",
          static_cast<long long>(options.min_free_dots), ">= 1");
  expects(options.ring_dots >= 0 && options.ring_dots <= 5, "TractionOptions", "ring_dots",
          static_cast<long long>(options.ring_dots), "in [0, 5]");
  expects(options.fade_dots >= 0 && options.fade_dots <= 20, "TractionOptions", "fade_dots",
          static_cast<long long>(options.fade_dots), "in [0, 20]");
  expects(is_finite(options.max_pressure_mpa) && options.max_pressure_mpa > 0, "TractionOptions",
          "max_pressure_mpa", options.max_pressure_mpa, "finite and > 0");
  expects(options.largest_stretch > 1 && options.largest_stretch <= 1000, "TractionOptions",
          "largest_stretch", options.largest_stretch, "in (1, 1000]");
}

/// Computes the loads on the dots of a pad. Threads may share one object, each with its own maps. A
/// frame allocates nothing, throws nothing, and takes O(rows cols) time.
template <scalar S = double>
class TractionField {
 public:
  /// Results of the last frame for each dot and each cell; NaN where unknown. They hold the memory
  /// of a frame, so each thread needs its own. Views are valid as long as the maps exist.
  class Maps {
   public:
    Index rows() const { return memory_.rows; }
    Index cols() const { return memory_.cols; }

    /// Load that the object exerts on the pad, MPa, per current area.
    StridedView<const Point3<S>> load_mpa() const { return dots(memory_.load); }
    /// Contact pressure, positive into the pad: -load . n, with n out of the pad.
    StridedView<const S> pressure_mpa() const { return dots(memory_.pressure); }
    /// The part of the load along the membrane.
    StridedView<const Point3<S>> shear_mpa() const { return dots(memory_.shear); }
    /// Area vector of the dot's share of the membrane, along n, mm^2; a load times its length is a
    /// force.
    StridedView<const Point3<S>> area_mm2() const { return dots(memory_.area); }
    /// Principal tensions of the cell between dots (i, j) and (i + 1, j + 1), N/mm; the grid has
    /// one row and one column fewer than the dots.
    StridedView<const detail::traction::CellTension<S>> tension_n_per_mm() const {
      return {memory_.tension.data(), rows() - 1, cols() - 1, cols() - 1};
    }

   private:
    friend class TractionField;

    Maps(Index rows, Index cols) : memory_(rows, cols) {}
    template <class T>
    StridedView<const T> dots(const std::vector<T>& values) const {
      return {values.data(), rows(), cols(), cols()};
    }

    detail::traction::FrameMemory<S> memory_;
  };

  /// `stress_free_mm`: positions of the dots when the membrane carries neither pressure nor
  /// contact; NaN: no such dot. Only their shape counts, not where it lies. Rows and columns may
  /// run any way; out of the pad is the side on which z grows. Refuses bad parameters and fewer
  /// than 3 x 3 dots (parameter_error).
  template <spatial_dot_grid Dots>
  explicit TractionField(const Dots& stress_free_mm, const TractionOptions<S>& options = {})
      : options_(options), limits_(options.largest_stretch) {
    expects_valid(options);
    const auto from = as_view(stress_free_mm);
    rows_ = from.rows();
    cols_ = from.cols();
    expects_grid_size("TractionField", rows_, cols_, 3);
    const auto at = [&](Index i, Index j) {
      return detail::spatial_dot<S>(cell_t<Dots>(from(i, j)));
    };
    S upward = S(0);
    for (Index i = 0; i + 1 < rows_; ++i) {
      for (Index j = 0; j + 1 < cols_; ++j) {
        cells_.push_back(detail::traction::StressFreeCell<S>(
            {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)}));
        upward = cells_.back().usable ? S(upward + cells_.back().upward) : upward;
      }
    }
    outward_ = S(value(upward) < 0 ? -1 : 1);
  }

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

  /// Maps without a frame, with all the memory that frames need.
  Maps maps() const { return Maps(rows_, cols_); }

  /// The loads in a frame with dots `dots_mm` (NaN: not found). A true `contact` marks the dots
  /// that touch the object. `pressure_mpa` is the pressure of the fluid above that outside.
  template <spatial_dot_grid Dots, contact_mask Contact>
  TractionResult<S> operator()(const Dots& dots_mm,
                               const Contact& contact,
                               const S& pressure_mpa,
                               Maps& maps) const {
    const auto dots = as_view(dots_mm);
    const auto touch = as_view(contact);
    TractionResult<S> result;
    if (!has_size(dots) || !has_size(touch) || !has_size(maps)) {
      return result;
    }
    result.status = TractionStatus::too_few_dots;
    auto& frame = maps.memory_;
    detail::traction::read_dots(dots, frame);
    detail::traction::bridge_dots(frame, result);
    detail::traction::count_steps(touch, frame, result);
    detail::traction::pull_cells(cells_, limits_, outward_, frame, result);
    detail::traction::settle_dots(frame, result);
    result.mu_t_n_per_mm = modulus_of(pressure_mpa, frame, result);
    detail::traction::write_tensions(result.mu_t_n_per_mm, frame, result);
    detail::traction::write_loads(pressure_mpa, result.mu_t_n_per_mm, options_.ring_dots, frame,
                                  result);
    if (result.ok()) {
      detail::traction::sum_loads(pressure_mpa, result.mu_t_n_per_mm, options_.ring_dots,
                                  options_.fade_dots, frame, result);
      result.status = result.dots_in_contact == 0 ? TractionStatus::no_contact
                      : result.dots_left_out > 0  ? TractionStatus::incomplete
                      : !holds(result)            ? TractionStatus::modulus_not_of_this_pad
                      : is_free(result)           ? TractionStatus::ok
                                                  : TractionStatus::free_part_pulled;
    }
    return result;
  }

 private:
  using Memory = detail::traction::FrameMemory<S>;

  template <class G>
  bool has_size(const G& g) const {
    return g.rows() == rows_ && g.cols() == cols_;
  }

  /// Whether nothing pulls the free part along the base; true where it is too small to tell.
  bool is_free(const TractionResult<S>& result) const {
    const auto& balance = result.balance;
    if (balance.dots < options_.min_free_dots) {
      return true;
    }
    const S quarter = balance.pressing_mpa / S(4 * static_cast<double>(balance.dots));
    const S pull_sq = square(result.free_load_mpa.x) + square(result.free_load_mpa.y);
    return !(S(square(quarter)) < pull_sq);
  }

  /// Whether the free part balances the pressure with this mu t. The mean of its loads must be 0,
  /// but for noise and a twentieth of the pressure, which is twice the error of the mesh. The sum
  /// of the loads is the pull across the border, so its noise is about that of one dot, of which
  /// three times are allowed. More than a fifth is refused in any case. True where the free part is
  /// too small to tell.
  bool holds(const TractionResult<S>& result) const {
    const auto& balance = result.balance;
    if (balance.dots < options_.min_free_dots) {
      return true;
    }
    const S off = result.mu_t_n_per_mm * balance.holding_per_mm - balance.pressing_mpa;
    const S fifth = balance.pressing_mpa / S(5);
    const S by_noise = balance.pressing_mpa / S(20) + S(3) * result.free_load_rms_mpa;
    const S bound = by_noise < fifth ? by_noise : fifth;
    return !(bound < off) && !(bound < -off);
  }

  /// The mu t of this frame. If there is none: NaN, and a status that gives the reason.
  S modulus_of(const S& pressure_mpa, const Memory& frame, TractionResult<S>& result) const {
    if (!detail::traction::is_measure(pressure_mpa)) {
      result.status = TractionStatus::bad_pressure;
      return not_a_number<S>();
    }
    if (pressure_mpa > S(options_.max_pressure_mpa)) {
      result.status = TractionStatus::pressure_not_in_mpa;
      return not_a_number<S>();
    }
    if (2 * result.cells_refused > result.cells_refused + result.cells_taken) {
      result.status = TractionStatus::not_of_this_membrane;
      return not_a_number<S>();
    }
    if (result.dots_loaded == 0) {
      result.status = TractionStatus::too_few_dots;
      return not_a_number<S>();
    }
    result.balance = detail::traction::balance_of(pressure_mpa, options_.ring_dots, frame);
    const S balanced = result.balance.dots < options_.min_free_dots
                           ? not_a_number<S>()
                           : result.balance.mu_t_n_per_mm();
    const S mu_t = options_.mu_t_n_per_mm.value_or(balanced);
    const bool known = detail::traction::is_measure(mu_t);
    result.status = known ? TractionStatus::ok : TractionStatus::no_balance;
    return known ? mu_t : not_a_number<S>();
  }

  TractionOptions<S> options_;
  detail::traction::StretchLimits<S> limits_;
  Index rows_ = 0;
  Index cols_ = 0;
  std::vector<detail::traction::StressFreeCell<S>> cells_;
  S outward_ = S(1);  ///< -1 if the normal by the rows and columns of the grid points into the pad
};

template <spatial_dot_grid Dots>
explicit TractionField(const Dots&) -> TractionField<>;
template <spatial_dot_grid Dots, scalar S = double>
TractionField(const Dots&, const TractionOptions<S>&) -> TractionField<S>;

}  // namespace v0
}  // namespace fingerpad
