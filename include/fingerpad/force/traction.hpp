// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The load that the object exerts on each dot of the membrane: contact pressure and shear as maps,
// force and moment as their sums. Not in the papers. A membrane carries load by its tension alone:
//   q = -(div T + p n),   T = (mu t / J) (B - J^-2 P),   B = F F^T,
// per area as it is now, with p the pressure of the fluid, n out of the pad, F the surface
// deformation gradient against the stress-free membrane, J = det F, P the identity on the surface.
//
// Discrete, the divergence is what the cells around a dot pull it with, the derivative of their
// stored energy. So rigid motions change nothing, and the sum of the loads over a patch is the pull
// across its border and the pressure on it, to rounding: the mesh blurs a load by about one pitch,
// but loses none of it. The steps lie in detail/traction/ in this order: membrane_triangle,
// dot_cell, frame_pulls, modulus, frame_loads.
#include <cstddef>
#include <utility>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/force/detail/frame_loads.hpp"
#include "fingerpad/force/dot_cell.hpp"
#include "fingerpad/force/traction_maps.hpp"
#include "fingerpad/force/traction_result.hpp"

namespace fingerpad {
inline namespace v0 {

struct TractionOptions {
  Index ring_dots = 1;  ///< in [0, 5]: force and moment are summed over the dots in contact and
                        ///< this many around it, to which the mesh carries a share of the load at
                        ///< the contact's edge. What lies outside is the free part: its load is 0
  Index fade_dots = 3;  ///< in [0, 20]: over this many dots more the weight in the sums falls to 0.
                        ///< The true sums do not change by that; an abrupt end, 0, makes them
                        ///< noisy, since all the pull across one line of dots then counts
  double largest_stretch = 5.0;  ///< in (1, 1000]: a cell with a principal stretch above this or
                                 ///< below its inverse is no membrane: wrong dots
};
inline void expects_valid(const TractionOptions& options) {
  expects(options.ring_dots >= 0 && options.ring_dots <= 5, "TractionOptions", "ring_dots",
          static_cast<long long>(options.ring_dots), "in [0, 5]");
  expects(options.fade_dots >= 0 && options.fade_dots <= 20, "TractionOptions", "fade_dots",
          static_cast<long long>(options.fade_dots), "in [0, 20]");
  expects(options.largest_stretch > 1 && options.largest_stretch <= 1000, "TractionOptions",
          "largest_stretch", options.largest_stretch, "in (1, 1000]");
}

/// The traction field of a pad.
///   Modulus  BalancedModulus (default), GivenModulus<S>
/// Const: threads may share one, each with maps of its own. A frame takes no memory, throws
/// nothing, and needs O(rows cols) time.
template <class Modulus = BalancedModulus, scalar S = double>
class TractionField {
 public:
  /// `stress_free_mm`: where the dots are when the membrane carries nothing, neither pressure nor
  /// touch; only its shape counts, not where it lies. NaN: no such dot. Rows and columns may run
  /// any way; out of the pad is the side on which z grows. Refuses bad parameters and fewer than
  /// 3 x 3 dots (parameter_error).
  template <spatial_dot_grid Dots>
  explicit TractionField(const Dots& stress_free_mm,
                         const Modulus& modulus = {},
                         const TractionOptions& options = {})
      : modulus_(modulus), options_(options), limits_(options.largest_stretch) {
    expects_valid(modulus);
    expects_valid(options);
    const auto from = as_view(stress_free_mm);
    rows_ = from.rows();
    cols_ = from.cols();
    expects(rows_ >= 3, "TractionField", "rows", static_cast<long long>(rows_), ">= 3");
    expects(cols_ >= 3, "TractionField", "cols", static_cast<long long>(cols_), ">= 3");
    const auto at = [&](Index i, Index j) {
      return detail::traction::dot_of<S, cell_t<Dots>>(from(i, j));
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

  /// Maps without a frame, with all the memory that frames will need.
  TractionMaps<S> maps() const { return TractionMaps<S>(rows_, cols_); }

  /// The loads in a frame with dots `dots_mm` (NaN: not found), of which those with a true
  /// `contact` touch the object, at `pressure_mpa` of the fluid above that outside.
  template <spatial_dot_grid Dots, contact_mask Contact>
  TractionResult<S> operator()(const Dots& dots_mm,
                               const Contact& contact,
                               const S& pressure_mpa,
                               TractionMaps<S>& maps) const {
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
                      : result.dots_left_out == 0 ? TractionStatus::ok
                                                  : TractionStatus::incomplete;
    }
    return result;
  }

  /// The same, and writes contact pressure and load of each dot into the caller's own grids.
  template <spatial_dot_grid Dots, contact_mask Contact, class Pressure, class Load>
    requires(writable_grid<Pressure, S>&& writable_grid<Load>&& spatial_dot_grid<Load>)
  TractionResult<S>
  operator()(const Dots& dots_mm,
             const Contact& contact,
             const S& pressure_mpa,
             TractionMaps<S>& maps,
             Pressure&& contact_pressure_mpa,
             Load&& load_mpa) const {
    const auto to_pressure = as_view(std::forward<Pressure>(contact_pressure_mpa));
    const auto to_load = as_view(std::forward<Load>(load_mpa));
    if (!has_size(to_pressure) || !has_size(to_load)) {
      return {};
    }
    const TractionResult<S> result = (*this)(dots_mm, contact, pressure_mpa, maps);
    for (Index i = 0; result.accepted() && i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        to_pressure(i, j) = static_cast<cell_t<Pressure>>(maps.pressure_mpa()(i, j));
        to_load(i, j) = detail::traction::point_as<cell_t<Load>>(maps.load_mpa()(i, j));
      }
    }
    return result;
  }

 private:
  using Memory = detail::traction::FrameMemory<S>;

  template <class G>
  bool has_size(const G& g) const {
    return g.rows() == rows_ && g.cols() == cols_;
  }

  /// NaN, and a status that says why, where there is none.
  S modulus_of(const S& pressure_mpa, const Memory& frame, TractionResult<S>& result) const {
    if (!detail::traction::is_measure(pressure_mpa)) {
      result.status = TractionStatus::bad_pressure;
      return not_a_number<S>();
    }
    if (result.dots_loaded == 0) {
      result.status = TractionStatus::too_few_dots;
      return not_a_number<S>();
    }
    result.balance = detail::traction::balance_of(pressure_mpa, options_.ring_dots, frame);
    const S mu_t = modulus_(result.balance);
    const bool known = detail::traction::is_measure(mu_t);
    result.status = known ? TractionStatus::ok : TractionStatus::no_balance;
    return known ? mu_t : not_a_number<S>();
  }

  Modulus modulus_;
  TractionOptions options_;
  detail::traction::StretchLimits<S> limits_;
  Index rows_ = 0;
  Index cols_ = 0;
  std::vector<detail::traction::StressFreeCell<S>> cells_;
  S outward_ = S(1);  ///< -1 where rows and columns of the grid run such that their normal looks in
};

template <spatial_dot_grid Dots>
explicit TractionField(const Dots&) -> TractionField<>;
template <spatial_dot_grid Dots>
TractionField(const Dots&, const BalancedModulus&, const TractionOptions& = {}) -> TractionField<>;
template <spatial_dot_grid Dots, scalar S>
TractionField(const Dots&, const GivenModulus<S>&, const TractionOptions& = {})
    -> TractionField<GivenModulus<S>, S>;

}  // namespace v0
}  // namespace fingerpad
