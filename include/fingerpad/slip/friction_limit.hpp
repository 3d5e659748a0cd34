// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Detects gross slip by comparing force and moment of the contact with their limit at the last
// slide. Dots cannot show an object that slides over a membrane at rest, or that carries all dots
// along equally. The load L of a contact is the least friction coefficient that holds it under even
// pressure: the power of force and moment over the mean speed of the contact, for the sliding and
// turning motion for which this is largest (principle of maximum dissipation: Goyal, Ruina,
// Papadopoulos, "Planar sliding with dry friction", 1991). While the object slides, L is the
// friction coefficient, whatever the shape of the contact and about whatever point it turns. The
// published form has forces only, "F / N ~ F0 / N0": published/friction_ratio.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/detail/dot_surface.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

namespace fingerpad {
inline namespace v1 {

/// Load of a contact. NaN and values of a million or more mean unknown.
template <scalar S = double>
struct ContactLoad {
  S normal_n = not_a_number<S>();      ///< F_n, positive under pressure
  S tangential_n = not_a_number<S>();  ///< F_t
  S friction = not_a_number<S>();      ///< L; NaN: that of the forces alone, F_t / F_n
};

namespace detail {
/// L of force (x, y) and moment z about the middle of the contact, all per normal force. The mean
/// speed is made least by least squares with weights of one over the speed; four passes leave 2 %
/// where the contact turns about one of two patches, 0.7 % in a rod and 0.01 % in a disc.
template <scalar S, class ForEach>
S least_friction(const Point3<S>& load, const ForEach& for_each_arm) {
  using std::sqrt;
  S friction = S(0), floor_sq = S(1);
  Point3<S> slide = {S(0), S(0), S(0)};  // along x and y, and turning; the load has the power 1
  for (int pass = 0; pass <= 4; ++pass) {
    S speeds = S(0), count = S(0), weight = S(0), square_sum = S(0);
    Point2<S> sum = {S(0), S(0)};
    for_each_arm([&](const Point2<S>& arm) {
      const S sq = square(slide.x - slide.z * arm.y) + square(slide.y + slide.z * arm.x);
      const S speed = sqrt(floor_sq < sq ? sq : floor_sq), w = S(1) / speed;
      speeds = speeds + speed;
      count = count + S(1);
      weight = weight + w;
      sum += w * arm;
      square_sum = square_sum + w * squared_norm(arm);
    });
    if (pass > 0) {
      friction = count / speeds;
      floor_sq = square(S(1e-3) / friction);
    }
    const S about = square_sum - squared_norm(sum) / weight;
    const S turn =
        S(0) < about ? (load.z + (sum.y * load.x - sum.x * load.y) / weight) / about : S(0);
    const S x = (load.x + sum.y * turn) / weight, y = (load.y - sum.x * turn) / weight;
    const S power = load.x * x + load.y * y + load.z * turn;
    if (!(S(0) < power)) {
      break;
    }
    slide = Point3<S>{x, y, turn} / power;
  }
  return friction;
}

/// `loads_at` gives force and moment about the middle of the contact, for its middle and normal.
template <scalar S, class Dots, class Contact, class LoadsAt>
ContactLoad<S> contact_load(const Dots& dots, const Contact& touch, const LoadsAt& loads_at) {
  if (!same_size(dots, touch)) {
    return {};
  }
  const auto for_each = [&](const auto& visit) {
    for (Index i = 0; i < dots.rows(); ++i) {
      for (Index j = 0; j < dots.cols(); ++j) {
        const Point3<S> p = spatial_dot<S>(cell_t<Dots>(dots(i, j)));
        if (is_contact(cell_t<Contact>(touch(i, j))) && is_finite(p)) {
          visit(p);
        }
      }
    }
  };
  const auto surface = stick::quadric_through<S>(for_each);
  if (surface.dots < 3) {
    return {};
  }
  const Point3<S> normal = surface.normal();
  const Point3<S> x = normalized(Point3<S>{normal.z, S(0), -normal.x}), y = cross(normal, x);
  const auto [force, about] = loads_at(surface.middle, normal);
  const S moment = dot(about, normal), normal_n = -dot(force, normal);
  const Point3<S> load = {dot(force, x), dot(force, y), is_plausible(moment) ? moment : S(0)};
  return {normal_n, norm(force + normal_n * normal),
          least_friction<S>(load / normal_n, [&](const auto& visit) {
            for_each([&](const Point3<S>& p) {
              const Point3<S> arm = p - surface.middle;
              visit(Point2<S>{dot(arm, x), dot(arm, y)});
            });
          })};
}
}  // namespace detail

/// Computes the load from the six-axis force and moment, which the object exerts on the pad, about
/// Q, and from the dots in contact. The normal is that of the mean slope of the quadric through
/// them. The forces are NaN with fewer than three dots. Allocates nothing, O(rows cols).
template <scalar S, spatial_dot_grid Dots, contact_mask Contact>
ContactLoad<S> contact_load(const Point3<S>& force_n,
                            const Point3<S>& moment_n_mm,
                            const Dots& dots_mm,
                            const Contact& contact) {
  const auto loads = [&](const Point3<S>& middle, const Point3<S>&) {
    return std::pair(force_n, moment_n_mm - cross(middle, force_n));
  };
  return detail::contact_load<S>(as_view(dots_mm), as_view(contact), loads);
}
/// The same from the force along the normal, > 0 under pressure, the one along the pad, and the
/// moment about the normal through the middle of the contact, as a look-up has them.
template <scalar S, spatial_dot_grid Dots, contact_mask Contact>
ContactLoad<S> contact_load(const S& normal_n,
                            const Point2<S>& tangential_n,
                            const S& moment_n_mm,
                            const Dots& dots_mm,
                            const Contact& contact) {
  const auto loads = [&](const Point3<S>&, const Point3<S>& normal) {
    const Point3<S> t = {tangential_n.x, tangential_n.y, S(0)};
    return std::pair(t - (dot(t, normal) + normal_n) * normal, moment_n_mm * normal);
  };
  return detail::contact_load<S>(as_view(dots_mm), as_view(contact), loads);
}

/// L; NaN unless the normal force is > 0 and both forces are known.
template <scalar S>
S friction_of(const ContactLoad<S>& load) {
  if (!is_plausible(load.normal_n) || !is_plausible(load.tangential_n) || !(S(0) < load.normal_n)) {
    return not_a_number<S>();
  }
  return is_finite(load.friction) ? load.friction : load.tangential_n / load.normal_n;
}

/// How current a stick ratio is.
enum class RatioUpdate : std::uint8_t {
  fresh,       ///< the ratio is that of this frame
  unmoved,     ///< the dots moved too little for a new ratio: the last one still applies
  missing,     ///< there is no usable ratio
  no_contact,  ///< nothing touches: there is no object, or it has just been lost
};

/// The update that a status of the stick ratio means.
constexpr RatioUpdate update_of(StickStatus status) {
  return status == StickStatus::updated      ? RatioUpdate::fresh
         : status == StickStatus::unmoved    ? RatioUpdate::unmoved
         : status == StickStatus::no_contact ? RatioUpdate::no_contact
                                             : RatioUpdate::missing;
}

struct FrictionLimitOptions {
  /// Fraction of the limit above which the object counts as sliding, in (0, 1]. The default is 1
  /// less 2.4 times the noise of L. With both forces known to 1.5 %, L is known to 2.1 %.
  double slide_fraction = 0.95;
  double min_normal_n = 0.05;  ///< N, > 0: L is unknown with a smaller normal force
  /// Whether the object is soft, as foam or skin: its surface shears before it slips, so dots that
  /// fall behind need not slip. Anything from the ratio of the dots to 1 may then stick: the middle
  /// is told, and is in doubt below 0.7. The place of such an object is doubted by a `Fingertip`.
  bool soft_object = false;
};
/// Says which option has no meaning; "" if all have one.
inline std::string check(const FrictionLimitOptions& o) {
  return check("FrictionLimitOptions",
               {{"slide_fraction", o.slide_fraction, {.min = 0, .max = 1, .above_min = true}},
                {"min_normal_n", o.min_normal_n, positive}});
}

enum class FrictionLimitStatus : std::uint8_t {
  held,      ///< L is at most slide_fraction of the limit
  sliding,   ///< L is above it: the stick ratio is 0, whatever the dots report
  no_limit,  ///< no slide so far: the answer is that of the dots alone
  no_load,   ///< no normal force, or a force is not finite: the answer is that of the dots alone
};
/// "held", "sliding", ...
constexpr const char* name_of(FrictionLimitStatus status) {
  constexpr std::array<const char*, 4> names = {"held", "sliding", "no limit", "no load"};
  return names[static_cast<std::size_t>(status)];
}

/// What an answer is based on.
enum class SlipEvidence : std::uint8_t {
  none,
  dots,      ///< the stick ratio of the dots
  imprint,   ///< on a gel: slide of the imprint, or lost area
  friction,  ///< the friction limit alone
  both,      ///< friction, and dots or imprint
};

/// The stick ratio by dots, or by the imprint on a gel, combined with friction.
template <scalar S = double>
struct [[nodiscard]] SlipResult {
  FrictionLimitStatus status = FrictionLimitStatus::no_load;
  SlipEvidence evidence = SlipEvidence::none;
  /// In [0, 1]; NaN: unknown. With an imprint it is 1 - the imprint's evidence for slip.
  S stick_ratio = not_a_number<S>();
  S ratio_sd = not_a_number<S>();             ///< of stick_ratio; NaN: unknown
  RatioUpdate update = RatioUpdate::missing;  ///< how current it is, for GripControl
  S dots_ratio = not_a_number<S>();           ///< of dots or imprint alone in this frame; NaN: none
  Index reference_age = 0;  ///< frames since the reference of the dots; 0: unknown
  /// The dots move back toward their free positions: the load falls, or the object slides because
  /// friction has fallen.
  bool falls_back = false;
  /// The dots' ratio is of this frame, and not above a fifth by what the number of dots leaves
  /// open.
  bool may_slide = false;
  /// The ratio may be off by more than 0.3: its standard deviation is that of a guess, friction
  /// says that the object slides and a fifth of the dots or more that they stick, the frames are
  /// too far apart, or no load tells a slide in part, with a ratio below 0.8, from one as a whole.
  bool in_doubt = false;
  S normal_n = not_a_number<S>();  ///< F_n; NaN where L is unknown
  S friction = not_a_number<S>();  ///< L
  S limit = not_a_number<S>();     ///< L at the last slide; NaN: none so far
  S margin = not_a_number<S>();    ///< 1 - L / limit; NaN if unknown

  bool ok() const { return is_finite(stick_ratio); }
  bool updated() const { return update == RatioUpdate::fresh; }

  /// Whether a dot of this state moves with the object, so that it counts for the object's motion.
  /// A pose given during a slide is wrong from then on, but a frame without a pose costs only that
  /// frame, so doubt counts as slip. If the load shows that the object carries dots that fall back,
  /// and more than half of them stick, all count: the states are those from before the reversal,
  /// and the few dots that slip since have little weight in the fit of the motion.
  bool holds(DotState state) const {
    const bool carried = falls_back && update == RatioUpdate::fresh && S(1) < S(2) * stick_ratio;
    return status != FrictionLimitStatus::sliding && !may_slide &&
           (carried || state != DotState::slip);
  }
};

/// Combines the dots, or the imprint on a gel, with friction, frame by frame. A value: copy it to
/// return to this frame later; one object a thread. A frame allocates nothing, throws nothing, and
/// examines at most the last 64 loads.
template <scalar S = double>
class FrictionLimit {
 public:
  /// Refuses bad parameters (parameter_error).
  explicit FrictionLimit(const FrictionLimitOptions& options = {}) : options_(options) {
    require(options);
    reset();
  }

  /// L at the last slide; NaN: none so far.
  const S& limit() const { return limit_; }
  /// Call it when another object is grasped: the limit is a property of the object and outlives a
  /// contact.
  void reset() {
    limit_ = not_a_number<S>();
    loads_.fill(limit_);
  }

  /// `ratio` (NaN: none) and `update` are those of the dots, or of `source`.
  SlipResult<S> operator()(const ContactLoad<S>& load,
                           const S& ratio,
                           RatioUpdate update,
                           SlipEvidence source = SlipEvidence::dots) {
    SlipResult<S> result;
    const bool known = value(ratio) >= 0 && value(ratio) <= 1;
    const bool fresh = known && update == RatioUpdate::fresh;
    const bool slides = fresh && ratio < S(least_stick);
    result.stick_ratio = known ? ratio : not_a_number<S>();
    result.dots_ratio = fresh ? ratio : not_a_number<S>();
    result.update = update;
    result.evidence = known ? source : SlipEvidence::none;
    result.limit = limit_;
    result.friction = loads_[next_] = friction_with(load);
    next_ = (next_ + 1) % loads_.size();
    if (!is_finite(result.friction)) {
      return result;
    }
    result.normal_n = load.normal_n;
    if (fresh && S(2) * ratio < S(1)) {
      learn(result.friction, slides);
    } else if (fresh && S(max_rise) * limit_ < result.friction) {
      limit_ = not_a_number<S>();
    }
    result.limit = limit_;
    result.margin = S(1) - result.friction / limit_;
    result.status = is_finite(limit_) ? FrictionLimitStatus::held : FrictionLimitStatus::no_limit;
    if (S(options_.slide_fraction) * limit_ < result.friction) {
      result.status = FrictionLimitStatus::sliding;
      result.evidence = slides ? SlipEvidence::both : SlipEvidence::friction;
      result.stick_ratio = S(0);
      result.ratio_sd = zero_sd(known ? ratio : S(1), result.friction);
      result.update = RatioUpdate::fresh;
    }
    return result;
  }

  /// The same for the result of a stick ratio. Dots that fall back have two answers. An object that
  /// sticks carries them only while its load falls below the highest since the reference by more
  /// than noise does: then the ratio is that of this frame. Under an object that slides, the
  /// membrane springs back while the load stays: the last ratio applies, and a first slide is
  /// learnt if less than half stuck in it. The standard deviation grows where the limit lets the
  /// object slide under this load, and, by a ratio anywhere from 0 up, where it is not known which
  /// answer holds and in the first answers after a slide. That of a slide which shows the limit for
  /// the first time rests on the dots alone.
  template <scalar T>
  SlipResult<S> operator()(const ContactLoad<S>& load, const StickResult<T>& seen) {
    using std::sqrt;
    RatioUpdate update = update_of(seen.status);
    S ratio = S(seen.stick_ratio), sd = S(seen.ratio_sd);
    Index age = seen.reference_age;
    const bool had_limit = is_finite(limit_);
    const bool falls_back = is_finite(seen.back_ratio);
    bool carried = false;
    if (falls_back) {
      age = seen.back_age;
      const S before = highest_of_last(age), now = friction_with(load);
      carried = now < (S(1) - fall_of_noise(age)) * before;
      const bool slides =
          S(options_.slide_fraction) * before < now && !had_limit && S(2) * ratio < S(1);
      sd = carried ? S(seen.back_sd) : slides ? sd : sqrt(sd * sd + ratio * ratio / S(3));
      ratio = carried ? S(seen.back_ratio) : slides ? S(0) : ratio;
      update = carried || slides ? RatioUpdate::fresh : update;
    }
    SlipResult<S> result = (*this)(load, ratio, update);
    const bool slid = result.status == FrictionLimitStatus::sliding;
    if (!slid) {
      sd = follows_slide_ ? sqrt(sd * sd + ratio * ratio / S(3)) : sd;
      const S shear = options_.soft_object ? S(1) - ratio : S(0);
      result.stick_ratio = result.stick_ratio + shear / S(2);
      result.ratio_sd = held_sd(result, sqrt(sd * sd + shear * shear / S(12)));
    } else if (falls_back) {
      result.ratio_sd = zero_sd(S(seen.back_ratio), result.friction);
    } else if (!had_limit && result.ratio_sd < sd) {
      result.ratio_sd = sd;
    }
    const bool fresh = !falls_back && update == RatioUpdate::fresh;
    follows_slide_ = slid || (follows_slide_ && !fresh);
    result.evidence = carried && !slid ? SlipEvidence::both : result.evidence;
    result.reference_age = age;
    result.falls_back = falls_back;
    result.may_slide = fresh && !(S(least_stick) < ratio - S(seen.least_sd()));
    result.in_doubt = seen.far_apart || !(square(result.ratio_sd) < S(guess_sq)) ||
                      (slid && fresh && !(ratio < S(least_stick))) ||
                      (options_.soft_object && !slid && result.stick_ratio < S(0.7)) ||
                      (result.status == FrictionLimitStatus::no_load && ratio < S(0.8));
    return result;
  }

  /// The same for a gel, where `imprint`, the result of GelSlide, replaces the dots.
  template <class Imprint>
    requires requires(const Imprint& imprint) {
      imprint.ok();
      imprint.held();
      imprint.touches();
    }
  SlipResult<S> operator()(const ContactLoad<S>& load, const Imprint& imprint) {
    return (*this)(load, imprint.ok() ? S(imprint.held()) : not_a_number<S>(),
                   imprint.ok()        ? RatioUpdate::fresh
                   : imprint.touches() ? RatioUpdate::missing
                                       : RatioUpdate::no_contact,
                   SlipEvidence::imprint);
  }

 private:
  /// An object slides if less of it sticks.
  static constexpr double least_stick = 0.2;
  /// Mean square difference of two ratios that have nothing to do with each other.
  static constexpr double guess_sq = 1.0 / 6;
  /// Largest factor by which the limit rises in a frame. An object that exceeds the limit by this
  /// factor while more than half of it sticks makes the limit unknown again.
  static constexpr double max_rise = 1.15;

  /// Standard deviation of the difference of two L, relative to L.
  double noise() const {
    return std::sqrt(2.0) * (std::max)(1 - options_.slide_fraction, 1e-3) / 2.4;
  }
  /// By how much noise alone lets L fall below the highest of `age` others in 1 of 160 frames: for
  /// more of them, the threshold of a normal distribution is higher.
  S fall_of_noise(Index age) const {
    return S(noise() *
             std::sqrt(square(2.5) + 2 * std::log(static_cast<double>((std::max)(age, Index(1))))));
  }
  /// Chance that the object slides. In slides L is spread about the limit by its noise, in holds it
  /// is anywhere below the limit alike.
  S chance_of_slide(const S& friction) const {
    using std::exp;
    const S below = (S(1) - friction / limit_) / S(noise());
    const S fall = S(0) < below ? exp(-below * below / S(2)) : S(1);
    const S slides = fall / S(noise() * 2.5066282746310002);
    return slides / (S(1) + slides);
  }
  /// Of a ratio of 0 by friction, where the dots say `otherwise`. Less than least_stick sticks in a
  /// slide, any share of it alike.
  S zero_sd(const S& otherwise, const S& friction) const {
    using std::sqrt;
    return sqrt(S(square(least_stick) / 3) +
                otherwise * otherwise * (S(1) - chance_of_slide(friction)));
  }
  /// Of a ratio by the dots with the standard deviation `sd`, where the object may slide.
  S held_sd(const SlipResult<S>& r, const S& sd) const {
    using std::sqrt;
    const bool known = is_finite(r.friction) && is_finite(limit_) && is_finite(sd);
    return known ? sqrt(sd * sd + square(r.stick_ratio) * chance_of_slide(r.friction)) : sd;
  }

  /// L; NaN if the normal force is below min_normal_n.
  S friction_with(const ContactLoad<S>& load) const {
    return !(load.normal_n < S(options_.min_normal_n)) ? friction_of(load) : not_a_number<S>();
  }

  /// Learns from a slide. Rises fast and falls slowly: noise makes the mean slightly too high,
  /// never too low. A load below slide_fraction of the limit is not that of a slide under the same
  /// friction, and one near 0 is no friction. Where most slips, L above the limit shows that the
  /// limit is at least what noise leaves of L: no object bears more than its limit.
  void learn(const S& friction, bool slides) {
    if (!is_finite(limit_)) {
      limit_ = slides && S(1e-6) < friction ? friction : limit_;
      return;
    }
    const S top = S(max_rise) * limit_, toward = friction < top ? friction : top;
    const S fraction = S(options_.slide_fraction);
    if (slides && !(friction < fraction * limit_)) {
      limit_ = limit_ + (limit_ < toward ? S(0.5) : S(0.1)) * (toward - limit_);
    }
    limit_ = limit_ < fraction * toward ? fraction * toward : limit_;
  }

  /// The largest L of the `age` frames before this one, of which the first is the reference; NaN if
  /// one of them is unknown.
  S highest_of_last(Index age) const {
    S highest = not_a_number<S>();
    const auto room = static_cast<Index>(loads_.size());
    for (Index k = 1; k <= (std::min)(age, room); ++k) {
      const S& load = loads_[(next_ + loads_.size() - static_cast<std::size_t>(k)) % loads_.size()];
      if (!is_finite(load)) {
        return load;
      }
      highest = load < highest ? highest : load;
    }
    return highest;
  }

  FrictionLimitOptions options_;
  S limit_;
  std::array<S, 64> loads_;  ///< of the last frames; NaN: unknown
  std::size_t next_ = 0;
  bool follows_slide_ = false;  ///< no dots have answered by themselves since the last slide
};

}  // namespace v1
}  // namespace fingerpad
