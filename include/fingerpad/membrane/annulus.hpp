// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The free membrane near its rim, which nothing but the fluid's pressure loads. From its derivative
// d at the rim it is marched inward over the stress-free arc a:
//   d(rho_0 A) / da = -dH/dphi - p / (mu t) x_phi cross x_a,
// where A and H are the pulls across the circles and the meridians. This is a Cauchy problem:
// harmonic m of an error grows like exp(m a / R), so the reach goes with R (about half of it), and
// the scalar has the digits of a double at least.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/membrane/free_pad.hpp"
#include "fingerpad/membrane/rubber.hpp"

namespace fingerpad {
inline namespace v0 {

struct AnnulusOptions {
  double reach_mm = 10;        ///< stress-free arc from the rim, > 0
  Index azimuths = 24;         ///< meridians, in [12, 360]
  Index steps = 5;             ///< of Runge and Kutta's method, in [1, 100]
  Index harmonics = 5;         ///< of the derivative at the rim, in [1, 30]
  Index offset_harmonics = 5;  ///< of the offset of the rim, in [-1, 30]; -1: none
};

inline std::string check(const AnnulusOptions& o) {
  return check("AnnulusOptions", {{"reach_mm", o.reach_mm, positive},
                                  {"azimuths", o.azimuths, within(12, 360)},
                                  {"steps", o.steps, within(1, 100)},
                                  {"harmonics", o.harmonics, within(1, 30)},
                                  {"offset_harmonics", o.offset_harmonics, within(-1, 30)}});
}

/// The annulus, and its derivatives by the parameters. Parameters are harmonics (1, cos phi, sin
/// phi, cos 2 phi, ...) of the derivative's parts inward, around and upward, then of the offset of
/// the rim outward along the membrane's normal, mm, and last p / (mu t), 1/mm.
template <scalar S>
class Annulus {
  static_assert(std::numeric_limits<scalar_real_t<S>>::digits >= 53,
                "the march inward needs the digits of a double");

 public:
  Annulus(const StressFreeCap<S>& cap, const AnnulusOptions& options)
      : cap_(cap), options_(options) {
    require(cap);
    require(options);
    n_ = static_cast<std::size_t>(options.azimuths);
    terms_ = static_cast<std::size_t>(2 * options.harmonics + 1);
    offset_terms_ = static_cast<std::size_t>(std::max<Index>(2 * options.offset_harmonics + 1, 0));
    width_ = (parameters() + lanes - 1) / lanes * lanes;
    steps_ = static_cast<std::size_t>(options.steps);
    step_mm_ = S(options.reach_mm) / S(options.steps);
    const std::size_t nodes = steps_ + 1;
    x_.resize(nodes, Points(n_));
    along_.resize(nodes, Points(n_));
    dx_.resize(nodes, Columns(n_ * 3 * width_, S(0)));
    dalong_.resize(nodes, Columns(n_ * 3 * width_, S(0)));
    scratch_.resize(3 * width_);
    y_.resize(n_);
    across_.resize(n_);
    for (auto* p :
         {&rim_around_, &rim_pull_, &around_, &hoop_, &x_at_, &y_at_, &x_sum_, &y_sum_, &y_rate_}) {
      p->resize(n_);
    }
    for (auto* c : {&drim_around_, &drim_pull_, &dy_, &daround_, &dhoop_, &dx_at_, &dy_at_,
                    &dx_sum_, &dy_sum_, &dy_rate_}) {
      c->resize(n_ * 3 * width_);
    }
    using std::cos;
    using std::sin;
    for (std::size_t j = 0; j < n_; ++j) {
      const S phi =
          S(2 * std::numbers::pi) * S(static_cast<double>(j)) / S(static_cast<double>(n_));
      cosine_.push_back(cos(phi));
      sine_.push_back(sin(phi));
      std::vector<S> basis = {S(1)};
      for (Index m = 1; m <= (std::max)(options.harmonics, options.offset_harmonics); ++m) {
        basis.push_back(cos(S(static_cast<double>(m)) * phi));
        basis.push_back(sin(S(static_cast<double>(m)) * phi));
      }
      basis_.push_back(basis);
    }
  }

  std::size_t parameters() const { return 3 * terms_ + offset_terms_ + 1; }
  std::size_t terms() const { return terms_; }
  const StressFreeCap<S>& cap() const { return cap_; }
  const AnnulusOptions& options() const { return options_; }

  /// Marches inward. `with_slopes`: derivatives by the parameters as well. O(azimuths x steps),
  /// with slopes times the number of parameters.
  void march(const std::vector<S>& parameters, bool with_slopes) {
    load_ = parameters[this->parameters() - 1];
    slopes_ = with_slopes;
    begin(parameters);
    S arc = S(0);
    for (std::size_t k = 0; k < steps_; ++k) {
      const S h = step_mm_;
      rates(x_[k], y_, dx_[k], dy_, arc, along_[k], dalong_[k]);
      x_sum_ = along_[k];
      y_sum_ = y_rate_;
      if (slopes_) {
        dx_sum_ = dalong_[k];
        dy_sum_ = dy_rate_;
      }
      Points* along = &along_[k];
      Columns* dalong = &dalong_[k];
      for (int stage = 1; stage < 4; ++stage) {
        const S ahead = stage == 3 ? h : h / S(2);
        move(x_[k], *along, ahead, x_at_);
        move(y_, y_rate_, ahead, y_at_);
        if (slopes_) {
          move(dx_[k], *dalong, ahead, dx_at_);
          move(dy_, dy_rate_, ahead, dy_at_);
        }
        along = &along_[k + 1];  // free until the next step
        dalong = &dalong_[k + 1];
        rates(x_at_, y_at_, dx_at_, dy_at_, arc + ahead, *along, *dalong);
        const S weight = S(stage == 3 ? 1 : 2);
        move(x_sum_, *along, weight, x_sum_);
        move(y_sum_, y_rate_, weight, y_sum_);
        if (slopes_) {
          move(dx_sum_, *dalong, weight, dx_sum_);
          move(dy_sum_, dy_rate_, weight, dy_sum_);
        }
      }
      move(x_[k], x_sum_, h / S(6), x_[k + 1]);
      move(y_, y_sum_, h / S(6), y_);
      if (slopes_) {
        move(dx_[k], dx_sum_, h / S(6), dx_[k + 1]);
        move(dy_, dy_sum_, h / S(6), dy_);
      }
      arc = arc + h;
    }
    rates(x_[steps_], y_, dx_[steps_], dy_, arc, along_[steps_], dalong_[steps_]);
  }

  /// Weights of the nodes and meridians around a place of the membrane.
  struct Place {
    std::size_t step = 0;
    std::array<S, 4> in_arc;  ///< Hermite: of position and derivative before, and behind
    std::array<std::size_t, 8> meridian;
    std::array<S, 8> around;  ///< Lagrange
  };

  /// The place `arc_mm` from the rim, in [0, reach], at an azimuth.
  Place place(const S& arc_mm, const S& azimuth_rad) const {
    Place at;
    const double along = static_cast<double>(value(arc_mm / step_mm_));
    at.step = static_cast<std::size_t>(
        (std::min)((std::max)(along, 0.0), static_cast<double>(steps_) - 1e-9));
    const S u = arc_mm / step_mm_ - S(static_cast<double>(at.step)), v = S(1) - u;
    at.in_arc = {(S(1) + S(2) * u) * v * v, u * v * v * step_mm_, u * u * (S(3) - S(2) * u),
                 -(u * u * v * step_mm_)};
    const S turn = azimuth_rad * S(static_cast<double>(n_)) / S(2 * std::numbers::pi);
    const double whole = std::floor(static_cast<double>(value(turn)));
    const S w = turn - S(whole);
    const auto n = static_cast<long>(n_);
    for (int i = 0; i < 8; ++i) {
      S weight = S(1);
      for (int l = 0; l < 8; ++l) {
        if (l != i) {
          weight = weight * (w - S(l - 3)) / S(i - l);
        }
      }
      at.around[static_cast<std::size_t>(i)] = weight;
      at.meridian[static_cast<std::size_t>(i)] =
          static_cast<std::size_t>((((static_cast<long>(whole) + i - 3) % n) + n) % n);
    }
    return at;
  }

  /// Position, mm.
  Point3<S> at(const Place& p) const {
    Point3<S> sum = {S(0), S(0), S(0)};
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t j = p.meridian[i];
      sum += p.around[i] * (p.in_arc[0] * x_[p.step][j] + p.in_arc[1] * along_[p.step][j] +
                            p.in_arc[2] * x_[p.step + 1][j] + p.in_arc[3] * along_[p.step + 1][j]);
    }
    return sum;
  }

  /// Derivatives of the position by the parameters: 3 rows of width() numbers.
  void slopes_at(const Place& p, std::vector<S>& rows) const {
    std::fill(rows.begin(), rows.end(), S(0));
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t from = p.meridian[i] * 3 * width_;
      const S* all[4] = {&dx_[p.step][from], &dalong_[p.step][from], &dx_[p.step + 1][from],
                         &dalong_[p.step + 1][from]};
      const S w[4] = {p.around[i] * p.in_arc[0], p.around[i] * p.in_arc[1],
                      p.around[i] * p.in_arc[2], p.around[i] * p.in_arc[3]};
      for (std::size_t c = 0; c < 3 * width_; c += lanes) {
        for (std::size_t l = 0; l < lanes; ++l) {
          rows[c + l] += w[0] * all[0][c + l] + w[1] * all[1][c + l] + w[2] * all[2][c + l] +
                         w[3] * all[3][c + l];
        }
      }
    }
  }
  std::size_t width() const { return width_; }

  /// Force and moment about the origin of what touches the membrane further inward, per mu t:
  ///   F = sum share rho_0 A - q area,  M = sum share x cross rho_0 A - q (moment of the pressure),
  /// over the circle where the march begins; share is the angle of a meridian.
  struct Load {
    Point3<S> force, moment;
  };
  Load load_at_rim() const {
    Load sum = {{S(0), S(0), S(0)}, {S(0), S(0), S(0)}};
    for (std::size_t j = 0; j < n_; ++j) {
      const Point3<S>&x = x_[0][j], &b = rim_around_[j], &y = rim_pull_[j];
      sum.force += y - (load_ / S(2)) * cross(x, b);
      sum.moment += cross(x, y) + (load_ / S(2) * dot(x, x)) * b;
    }
    const S share = S(2 * std::numbers::pi) / S(static_cast<double>(n_));
    return {share * sum.force, share * sum.moment};
  }
  /// Their derivatives by the parameters: 6 rows of width() numbers.
  void slopes_of_load(std::vector<S>& rows) const {
    std::fill(rows.begin(), rows.end(), S(0));
    const S share = S(2 * std::numbers::pi) / S(static_cast<double>(n_));
    const auto part = [&](const Columns& from, std::size_t j, std::size_t c) {
      const S* all = &from[j * 3 * width_];
      return Point3<S>{all[c], all[width_ + c], all[2 * width_ + c]};
    };
    for (std::size_t j = 0; j < n_; ++j) {
      const Point3<S>&x = x_[0][j], &b = rim_around_[j], &y = rim_pull_[j];
      for (std::size_t c = 0; c + 1 < parameters(); ++c) {
        const Point3<S> dx = part(dx_[0], j, c), db = part(drim_around_, j, c),
                        dy = part(drim_pull_, j, c);
        const Point3<S> force = dy - (load_ / S(2)) * (cross(dx, b) + cross(x, db));
        const Point3<S> moment = cross(dx, y) + cross(x, dy) + (load_ * dot(x, dx)) * b +
                                 (load_ / S(2) * dot(x, x)) * db;
        add(rows, c, share, force, moment);
      }
      add(rows, parameters() - 1, share, S(-0.5) * cross(x, b), (S(0.5) * dot(x, x)) * b);
    }
  }

 private:
  using Points = std::vector<Point3<S>>;
  using Columns = std::vector<S>;  // of a meridian: x, y, z, each by all parameters
  static constexpr std::size_t lanes = 8;

  void add(std::vector<S>& rows,
           std::size_t column,
           const S& share,
           const Point3<S>& force,
           const Point3<S>& moment) const {
    const S all[6] = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
    for (std::size_t r = 0; r < 6; ++r) {
      rows[r * width_ + column] += share * all[r];
    }
  }

  static void move(const Points& from, const Points& rate, const S& by, Points& to) {
    for (std::size_t j = 0; j < from.size(); ++j) {
      to[j] = from[j] + by * rate[j];
    }
  }
  static void move(const Columns& from, const Columns& rate, const S& by, Columns& to) {
    for (std::size_t c = 0; c < from.size(); c += lanes) {
      for (std::size_t l = 0; l < lanes; ++l) {
        to[c + l] = from[c + l] + by * rate[c + l];
      }
    }
  }

  /// Derivative by the azimuth, from four neighbours on both sides.
  static constexpr std::array<double, 4> stencil = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
  S per_step(std::size_t s) const {
    return S(stencil[s]) * S(static_cast<double>(n_)) / S(2 * std::numbers::pi);
  }
  void change_around(const Points& f, Points& to) const {
    for (std::size_t j = 0; j < n_; ++j) {
      Point3<S> sum = {S(0), S(0), S(0)};
      for (std::size_t s = 0; s < 4; ++s) {
        sum += per_step(s) * (f[(j + s + 1) % n_] - f[(j + n_ - s - 1) % n_]);
      }
      to[j] = sum;
    }
  }
  void change_around(const Columns& f, Columns& to) const {
    const std::size_t size = 3 * width_;
    const S w[4] = {per_step(0), per_step(1), per_step(2), per_step(3)};
    for (std::size_t j = 0; j < n_; ++j) {
      const S *up[4], *down[4];
      for (std::size_t s = 0; s < 4; ++s) {
        up[s] = &f[(j + s + 1) % n_ * size];
        down[s] = &f[(j + n_ - s - 1) % n_ * size];
      }
      S* out = &to[j * size];
      for (std::size_t c = 0; c < size; c += lanes) {
        for (std::size_t l = 0; l < lanes; ++l) {
          out[c + l] =
              w[0] * (up[0][c + l] - down[0][c + l]) + w[1] * (up[1][c + l] - down[1][c + l]) +
              w[2] * (up[2][c + l] - down[2][c + l]) + w[3] * (up[3][c + l] - down[3][c + l]);
        }
      }
    }
  }

  /// out = one a + other b for the columns of a meridian.
  void combine(const detail::membrane::Matrix3<S>& one,
               const S* a,
               const detail::membrane::Matrix3<S>& other,
               const S* b,
               S* out) const {
    for (std::size_t r = 0; r < 3; ++r) {
      const S p[6] = {one[r][0], one[r][1], one[r][2], other[r][0], other[r][1], other[r][2]};
      for (std::size_t c = 0; c < width_; c += lanes) {
        for (std::size_t l = 0; l < lanes; ++l) {
          const std::size_t i = c + l;
          out[r * width_ + i] = p[0] * a[i] + p[1] * a[width_ + i] + p[2] * a[2 * width_ + i] +
                                p[3] * b[i] + p[4] * b[width_ + i] + p[5] * b[2 * width_ + i];
        }
      }
    }
  }

  /// The circle where the march begins.
  void begin(const std::vector<S>& q) {
    using std::sqrt;
    const S rho = cap_.rho_mm(S(0)), radius = cap_.base_radius_mm;
    Points& d = along_[0];
    Columns& slope = dalong_[0];
    for (std::size_t j = 0; j < n_; ++j) {
      const auto sum = [&](std::size_t from, std::size_t count) {
        S s = S(0);
        for (std::size_t m = 0; m < count; ++m) {
          s = s + q[from + m] * basis_[j][m];
        }
        return s;
      };
      const Point3<S> out = {cosine_[j], sine_[j], S(0)}, tangent = {-sine_[j], cosine_[j], S(0)};
      const S inward = sum(0, terms_), around = sum(terms_, terms_), up = sum(2 * terms_, terms_);
      d[j] = around * tangent - inward * out + Point3<S>{S(0), S(0), up};
      const Point3<S> outward = cross(tangent, d[j]);
      const S length = norm(outward);
      const Point3<S> normal = outward / length;
      const S offset = sum(3 * terms_, offset_terms_);
      x_[0][j] = radius * out + offset * normal;
      if (!slopes_) {
        continue;
      }
      const Point3<S> parts[3] = {-out, tangent, {S(0), S(0), S(1)}};
      const auto put = [&](Columns& to, std::size_t c, const Point3<S>& p) {
        S* all = &to[j * 3 * width_];
        all[c] = p.x;
        all[width_ + c] = p.y;
        all[2 * width_ + c] = p.z;
      };
      for (std::size_t part = 0; part < 3; ++part) {
        const Point3<S> turned = cross(tangent, parts[part]);
        const Point3<S> tilt = (offset / length) * (turned - dot(turned, normal) * normal);
        for (std::size_t m = 0; m < terms_; ++m) {
          put(slope, part * terms_ + m, basis_[j][m] * parts[part]);
          put(dx_[0], part * terms_ + m, basis_[j][m] * tilt);
        }
      }
      for (std::size_t m = 0; m < offset_terms_; ++m) {
        put(slope, 3 * terms_ + m, {S(0), S(0), S(0)});
        put(dx_[0], 3 * terms_ + m, basis_[j][m] * normal);
      }
    }
    change_around(x_[0], around_);
    if (slopes_) {
      change_around(dx_[0], daround_);
    }
    for (std::size_t j = 0; j < n_; ++j) {
      const Point3<S> b = around_[j] / rho;
      y_[j] = rho * rubber_pull(d[j], b, cap_.mooney_share);
      across_[j] = norm(d[j]);
      if (slopes_) {
        auto by = detail::membrane::pull_slopes(d[j], b, cap_.mooney_share);
        for (std::size_t r = 0; r < 3; ++r) {
          for (std::size_t c = 0; c < 3; ++c) {
            by.by_along[r][c] = rho * by.by_along[r][c];
          }
        }
        const std::size_t from = j * 3 * width_;
        combine(by.by_along, &slope[from], by.by_other, &daround_[from], &dy_[from]);
      }
    }
    rim_around_ = around_;
    rim_pull_ = y_;
    if (slopes_) {
      drim_around_ = daround_;
      drim_pull_ = dy_;
    }
  }

  /// Rates by the arc: `along` of x, y_rate_ of y = rho_0 A.
  void rates(const Points& x,
             const Points& y,
             const Columns& dx,
             const Columns& dy,
             const S& arc,
             Points& along,
             Columns& dalong) {
    const S rho = cap_.rho_mm(arc), m = cap_.mooney_share, inverse = S(1) / rho;
    change_around(x, around_);
    if (slopes_) {
      change_around(dx, daround_);
    }
    for (std::size_t j = 0; j < n_; ++j) {
      const Point3<S> b = inverse * around_[j];
      along[j] = detail::membrane::stretch_of_pull(Point3<S>(inverse * y[j]), b, m, across_[j]);
      hoop_[j] = rubber_pull(b, along[j], m);
      if (slopes_) {
        slopes_of_rates(j, along[j], b, inverse, dy, dalong);
      }
    }
    change_around(hoop_, y_rate_);
    if (slopes_) {
      change_around(dhoop_, dy_rate_);
    }
    for (std::size_t j = 0; j < n_; ++j) {
      y_rate_[j] = -(y_rate_[j] + load_ * cross(around_[j], along[j]));
      if (slopes_) {
        const Point3<S>&p = around_[j], &t = along[j];
        const detail::membrane::Matrix3<S> by_t = {{{S(0), load_ * p.z, -(load_ * p.y)},
                                                    {-(load_ * p.z), S(0), load_ * p.x},
                                                    {load_ * p.y, -(load_ * p.x), S(0)}}};
        const detail::membrane::Matrix3<S> by_p = {{{S(0), -(load_ * t.z), load_ * t.y},
                                                    {load_ * t.z, S(0), -(load_ * t.x)},
                                                    {-(load_ * t.y), load_ * t.x, S(0)}}};
        const std::size_t from = j * 3 * width_;
        combine(by_t, &dalong[from], by_p, &daround_[from], &scratch_[0]);
        S* out = &dy_rate_[from];
        for (std::size_t c = 0; c < 3 * width_; c += lanes) {
          for (std::size_t l = 0; l < lanes; ++l) {
            out[c + l] = scratch_[c + l] - out[c + l];
          }
        }
        const Point3<S> by_load = cross(t, p);
        out[parameters() - 1] += by_load.x;
        out[width_ + parameters() - 1] += by_load.y;
        out[2 * width_ + parameters() - 1] += by_load.z;
      }
    }
  }

  void slopes_of_rates(std::size_t j,
                       const Point3<S>& along,
                       const Point3<S>& b,
                       const S& inverse,
                       const Columns& dy,
                       Columns& dalong) {
    using detail::membrane::Matrix3;
    const S m = cap_.mooney_share;
    const auto across = detail::membrane::pull_slopes(along, b, m);
    const auto hoop = detail::membrane::pull_slopes(b, along, m);
    const Matrix3<S> solve = inverse_of(across.by_along);
    Matrix3<S> by_y, by_around, hoop_by_y, hoop_by_around;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        S s = S(0);
        for (std::size_t k = 0; k < 3; ++k) {
          s = s + solve[r][k] * across.by_other[k][c];
        }
        by_y[r][c] = inverse * solve[r][c];
        by_around[r][c] = -(inverse * s);
      }
    }
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        S s = S(0), t = inverse * hoop.by_along[r][c];
        for (std::size_t k = 0; k < 3; ++k) {
          s = s + hoop.by_other[r][k] * by_y[k][c];
          t = t + hoop.by_other[r][k] * by_around[k][c];
        }
        hoop_by_y[r][c] = s;
        hoop_by_around[r][c] = t;
      }
    }
    const std::size_t from = j * 3 * width_;
    combine(by_y, &dy[from], by_around, &daround_[from], &dalong[from]);
    combine(hoop_by_y, &dy[from], hoop_by_around, &daround_[from], &dhoop_[from]);
  }

  static detail::membrane::Matrix3<S> inverse_of(const detail::membrane::Matrix3<S>& a) {
    const Point3<S> r[3] = {
        {a[0][0], a[0][1], a[0][2]}, {a[1][0], a[1][1], a[1][2]}, {a[2][0], a[2][1], a[2][2]}};
    const Point3<S> c0 = cross(r[1], r[2]), c1 = cross(r[2], r[0]), c2 = cross(r[0], r[1]);
    const S d = S(1) / dot(r[0], c0);
    return {{{d * c0.x, d * c1.x, d * c2.x},
             {d * c0.y, d * c1.y, d * c2.y},
             {d * c0.z, d * c1.z, d * c2.z}}};
  }

  StressFreeCap<S> cap_;
  AnnulusOptions options_;
  std::size_t n_ = 0, terms_ = 0, offset_terms_ = 0, width_ = 0, steps_ = 0;
  S step_mm_ = S(0), load_ = S(0);
  bool slopes_ = false;
  std::vector<S> cosine_, sine_, across_;
  std::vector<std::vector<S>> basis_;
  std::vector<Points> x_, along_;     // at each circle
  std::vector<Columns> dx_, dalong_;  // their derivatives by the parameters
  Points y_, around_, hoop_, x_at_, y_at_, x_sum_, y_sum_, y_rate_, rim_around_, rim_pull_;
  Columns dy_, daround_, dhoop_, dx_at_, dy_at_, dx_sum_, dy_sum_, dy_rate_, drim_around_,
      drim_pull_;
  Columns scratch_;
};

}  // namespace v0
}  // namespace fingerpad
