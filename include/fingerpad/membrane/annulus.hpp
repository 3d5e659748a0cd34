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
#include <span>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/membrane/free_pad.hpp"
#include "fingerpad/membrane/rubber.hpp"

namespace fingerpad {
inline namespace v1 {

struct AnnulusOptions {
  double reach_mm = 10;        ///< stress-free arc from the rim, > 0
  Index azimuths = 24;         ///< meridians, in [12, 360]
  Index steps = 6;             ///< of Runge and Kutta's method, in [1, 100]
  Index harmonics = 5;         ///< of the derivative at the rim, in [1, 30]
  Index offset_harmonics = 5;  ///< of the offset of the rim, in [-1, 30]; -1: none
  bool slopes = true;          ///< the derivatives by the parameters are marched, too
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
      : cap_(cap), options_((require(cap), require(options), options)) {
    n_ = static_cast<std::size_t>(options.azimuths);
    terms_ = static_cast<std::size_t>(2 * options.harmonics + 1);
    offset_terms_ = static_cast<std::size_t>(std::max<Index>(2 * options.offset_harmonics + 1, 0));
    value_ = options.slopes ? parameters() : 0;
    width_ = options.slopes ? value_ / lanes * lanes + lanes : 1;
    steps_ = static_cast<std::size_t>(options.steps);
    step_mm_ = S(options.reach_mm) / S(options.steps);
    const Field zero(n_ * 3 * width_, S(0));
    x_.assign(steps_ + 1, zero);
    along_ = x_;
    y_ = around_ = hoop_ = x_at_ = y_at_ = x_sum_ = y_sum_ = y_rate_ = zero;
    rim_around_ = rim_pull_ = zero;
    across_.resize(n_);
    using std::cos;
    using std::sin;
    for (std::size_t j = 0; j < n_; ++j) {
      const S phi =
          S(2 * std::numbers::pi) * S(static_cast<double>(j)) / S(static_cast<double>(n_));
      std::vector<S> basis = {S(1)};
      for (Index m = 1; m <= (std::max)(options.harmonics, options.offset_harmonics); ++m) {
        basis.push_back(cos(S(static_cast<double>(m)) * phi));
        basis.push_back(sin(S(static_cast<double>(m)) * phi));
      }
      basis_.push_back(basis);
      growth_.push_back((cap.uneven_x * cos(phi) + cap.uneven_y * sin(phi)) / cap.base_radius_mm);
    }
  }

  std::size_t parameters() const { return 3 * terms_ + offset_terms_ + 1; }
  std::size_t terms() const { return terms_; }
  const StressFreeCap<S>& cap() const { return cap_; }
  const AnnulusOptions& options() const { return options_; }

  /// Marches inward. O(azimuths x steps), with slopes times the number of parameters.
  void march(const std::vector<S>& parameters) {
    begin(parameters);
    S arc = S(0);
    for (std::size_t k = 0; k < steps_; ++k) {
      const S h = step_mm_;
      Field* along = &along_[k];
      rates(x_[k], y_, arc, *along);
      x_sum_ = *along;
      y_sum_ = y_rate_;
      for (int stage = 1; stage < 4; ++stage) {
        const S ahead = stage == 3 ? h : h / S(2);
        move(x_[k], *along, ahead, x_at_);
        move(y_, y_rate_, ahead, y_at_);
        along = &along_[k + 1];  // free until the next step
        rates(x_at_, y_at_, arc + ahead, *along);
        const S weight = S(stage == 3 ? 1 : 2);
        move(x_sum_, *along, weight, x_sum_);
        move(y_sum_, y_rate_, weight, y_sum_);
      }
      move(x_[k], x_sum_, h / S(6), x_[k + 1]);
      move(y_, y_sum_, h / S(6), y_);
      arc = arc + h;
    }
    rates(x_[steps_], y_, arc, along_[steps_]);
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
    shift(at, arc_mm);
    const S turn = azimuth_rad * S(static_cast<double>(n_)) / S(2 * std::numbers::pi);
    const double whole = std::floor(static_cast<double>(value(turn)));
    const S w = turn - S(whole);
    const auto n = static_cast<long>(n_);
    constexpr double products[4] = {5040, -720, 240, -144};  // products of differences
    for (int i = 0; i < 8; ++i) {
      S weight = S(1) / S(i < 4 ? -products[i] : products[7 - i]);
      for (int l = 0; l < 8; ++l) {
        weight = l != i ? weight * (w - S(l - 3)) : weight;
      }
      at.around[static_cast<std::size_t>(i)] = weight;
      at.meridian[static_cast<std::size_t>(i)] =
          static_cast<std::size_t>((((static_cast<long>(whole) + i - 3) % n) + n) % n);
    }
    return at;
  }
  /// The same meridian at another arc.
  void shift(Place& at, const S& arc_mm) const {
    const double along = static_cast<double>(value(arc_mm / step_mm_));
    at.step = static_cast<std::size_t>(
        (std::min)((std::max)(along, 0.0), static_cast<double>(steps_) - 1e-9));
    const S u = arc_mm / step_mm_ - S(static_cast<double>(at.step)), v = S(1) - u;
    at.in_arc = {(S(1) + S(2) * u) * v * v, u * v * v * step_mm_, u * u * (S(3) - S(2) * u),
                 -(u * u * v * step_mm_)};
  }

  /// Position, mm.
  Point3<S> at(const Place& p) const {
    Point3<S> sum = {S(0), S(0), S(0)};
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t j = p.meridian[i];
      sum += p.around[i] * (p.in_arc[0] * column(x_[p.step], j, value_) +
                            p.in_arc[1] * column(along_[p.step], j, value_) +
                            p.in_arc[2] * column(x_[p.step + 1], j, value_) +
                            p.in_arc[3] * column(along_[p.step + 1], j, value_));
    }
    return sum;
  }

  /// Derivatives of the position by the parameters: 3 rows of width() numbers, the last ones of
  /// which mean nothing.
  void slopes_at(const Place& p, std::vector<S>& rows) const {
    std::fill(rows.begin(), rows.end(), S(0));
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t from = p.meridian[i] * 3 * width_;
      const S *a = &x_[p.step][from], *b = &along_[p.step][from], *c = &x_[p.step + 1][from],
              *d = &along_[p.step + 1][from], *sum = rows.data();
      const S v = p.around[i] * p.in_arc[0], w = p.around[i] * p.in_arc[1],
              x = p.around[i] * p.in_arc[2], y = p.around[i] * p.in_arc[3];
      each(3 * width_, rows.data(),
           [=](std::size_t k) { return sum[k] + v * a[k] + w * b[k] + x * c[k] + y * d[k]; });
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
      const Point3<S> x = column(x_[0], j, value_), b = column(rim_around_, j, value_),
                      y = column(rim_pull_, j, value_);
      sum.force += y - (load_ / S(2)) * cross(x, b);
      sum.moment += cross(x, y) + (load_ / S(2) * dot(x, x)) * b;
    }
    const S share = S(2 * std::numbers::pi) / S(static_cast<double>(n_));
    return {share * sum.force, share * sum.moment};
  }
  /// Their derivatives by the parameters: 6 rows of width() numbers.
  void slopes_of_load(std::span<S> rows) const {
    std::fill(rows.begin(), rows.end(), S(0));
    const S share = S(2 * std::numbers::pi) / S(static_cast<double>(n_));
    for (std::size_t j = 0; j < n_; ++j) {
      const Point3<S> x = column(x_[0], j, value_), b = column(rim_around_, j, value_),
                      y = column(rim_pull_, j, value_);
      for (std::size_t c = 0; c < value_; ++c) {
        const bool is_load = c + 1 == value_;
        const Point3<S> dx = column(x_[0], j, c), db = column(rim_around_, j, c),
                        dy = column(rim_pull_, j, c);
        const Point3<S> force = is_load ? Point3<S>(S(-0.5) * cross(x, b))
                                        : dy - (load_ / S(2)) * (cross(dx, b) + cross(x, db));
        const Point3<S> moment = is_load ? Point3<S>((S(0.5) * dot(x, x)) * b)
                                         : cross(dx, y) + cross(x, dy) + (load_ * dot(x, dx)) * b +
                                               (load_ / S(2) * dot(x, x)) * db;
        const S all[6] = {force.x, force.y, force.z, moment.x, moment.y, moment.z};
        for (std::size_t r = 0; r < 6; ++r) {
          rows[r * width_ + c] += share * all[r];
        }
      }
    }
  }

 private:
  /// Of each meridian x, y and z, each a row of width() columns: the derivatives by all parameters,
  /// then the value. Without slopes the value alone.
  using Field = std::vector<S>;
  static constexpr std::size_t lanes = 2;

  Point3<S> column(const Field& f, std::size_t j, std::size_t c) const {
    const S* all = &f[j * 3 * width_ + c];
    return {all[0], all[width_], all[2 * width_]};
  }
  void put(Field& f, std::size_t j, std::size_t c, const Point3<S>& p) const {
    S* all = &f[j * 3 * width_ + c];
    all[0] = p.x;
    all[width_] = p.y;
    all[2 * width_] = p.z;
  }
  /// to[k] = of(k), in groups that fit vector registers.
  template <class Of>
  static void each(std::size_t count, S* to, const Of& of) {
    std::size_t c = 0;
    for (; c + lanes <= count; c += lanes) {
      S group[lanes];
      for (std::size_t l = 0; l < lanes; ++l) {
        group[l] = of(c + l);
      }
      for (std::size_t l = 0; l < lanes; ++l) {
        to[c + l] = group[l];
      }
    }
    for (; c < count; ++c) {
      to[c] = of(c);
    }
  }
  static void move(const Field& from, const Field& rate, const S& by, Field& to) {
    const S *a = from.data(), *b = rate.data(), h = by;
    each(from.size(), to.data(), [=](std::size_t k) { return a[k] + h * b[k]; });
  }

  /// Derivative by the azimuth, from four neighbours on both sides.
  void change_around(const Field& f, Field& to) const {
    const std::size_t size = 3 * width_;
    const S unit = S(static_cast<double>(n_)) / S(2 * std::numbers::pi);
    const S w0 = unit * S(4.0 / 5), w1 = unit * S(-1.0 / 5), w2 = unit * S(4.0 / 105),
            w3 = unit * S(-1.0 / 280);
    for (std::size_t j = 0; j < n_; ++j) {
      const auto near = [&](std::size_t by) { return &f[(j + by) % n_ * size]; };
      const S *a = near(1), *b = near(2), *c = near(3), *d = near(4);
      const S *e = near(n_ - 1), *g = near(n_ - 2), *h = near(n_ - 3), *i = near(n_ - 4);
      each(size, &to[j * size], [=](std::size_t k) {
        return w0 * (a[k] - e[k]) + w1 * (b[k] - g[k]) + w2 * (c[k] - h[k]) + w3 * (d[k] - i[k]);
      });
    }
  }

  /// out = one a + other b for the columns of a meridian.
  void combine(const detail::membrane::Matrix3<S>& one,
               const S* a,
               const detail::membrane::Matrix3<S>& other,
               const S* b,
               S* out) const {
    const std::size_t w = width_;
    for (std::size_t r = 0; r < 3; ++r) {
      const S p = one[r][0], q = one[r][1], s = one[r][2], t = other[r][0], u = other[r][1],
              v = other[r][2];
      each(w, out + r * w, [=](std::size_t k) {
        return p * a[k] + q * a[w + k] + s * a[2 * w + k] + t * b[k] + u * b[w + k] +
               v * b[2 * w + k];
      });
    }
  }

  /// mu t of a meridian over that of the axis.
  S thickness(std::size_t j, const S& rho) const { return S(1) + rho * growth_[j]; }

  /// The circle where the march begins.
  void begin(const std::vector<S>& q) {
    load_ = q[parameters() - 1];
    const S rho = cap_.rho_mm(S(0)), m = cap_.mooney_share;
    std::fill(along_[0].begin(), along_[0].end(), S(0));
    for (std::size_t j = 0; j < n_; ++j) {
      const std::vector<S>& basis = basis_[j];
      const auto sum = [&](std::size_t from, std::size_t count) {
        S s = S(0);
        for (std::size_t k = 0; k < count; ++k) {
          s = s + q[from + k] * basis[k];
        }
        return s;
      };
      const Point3<S> out = {basis[1], basis[2], S(0)}, tangent = {-basis[2], basis[1], S(0)};
      const Point3<S> parts[3] = {-out, tangent, {S(0), S(0), S(1)}};
      const Point3<S> d = sum(0, terms_) * parts[0] + sum(terms_, terms_) * parts[1] +
                          sum(2 * terms_, terms_) * parts[2];
      const Point3<S> outward = cross(tangent, d);
      const S length = norm(outward), offset = sum(3 * terms_, offset_terms_);
      const Point3<S> normal = outward / length;
      for (std::size_t part = 0; options_.slopes && part < 3; ++part) {
        const Point3<S> turned = cross(tangent, parts[part]);
        const Point3<S> tilt = (offset / length) * (turned - dot(turned, normal) * normal);
        for (std::size_t k = 0; k < terms_; ++k) {
          put(along_[0], j, part * terms_ + k, basis[k] * parts[part]);
          put(x_[0], j, part * terms_ + k, basis[k] * tilt);
        }
      }
      for (std::size_t k = 0; options_.slopes && k < offset_terms_; ++k) {
        put(x_[0], j, 3 * terms_ + k, basis[k] * normal);
      }
      put(x_[0], j, value_, cap_.base_radius_mm * out + offset * normal);
      put(along_[0], j, value_, d);
    }
    change_around(x_[0], around_);
    for (std::size_t j = 0; j < n_; ++j) {
      const Point3<S> b = column(around_, j, value_) / rho, d = column(along_[0], j, value_);
      if (options_.slopes) {
        auto by = detail::membrane::pull_slopes(d, b, m);
        const S share = thickness(j, rho);
        for (std::size_t r = 0; r < 3; ++r) {
          for (std::size_t c = 0; c < 3; ++c) {
            by.by_along[r][c] = rho * share * by.by_along[r][c];
            by.by_other[r][c] = share * by.by_other[r][c];
          }
        }
        const std::size_t from = j * 3 * width_;
        combine(by.by_along, &along_[0][from], by.by_other, &around_[from], &y_[from]);
      }
      put(y_, j, value_, rho * thickness(j, rho) * rubber_pull(d, b, m));
      across_[j] = norm(d);
    }
    rim_around_ = around_;
    rim_pull_ = y_;
  }

  /// Rates by the arc: `along` of x, y_rate_ of y = rho_0 A.
  void rates(const Field& x, const Field& y, const S& arc, Field& along) {
    const S m = cap_.mooney_share, rho = cap_.rho_mm(arc), inverse = S(1) / rho, load = load_;
    change_around(x, around_);
    for (std::size_t j = 0; j < n_; ++j) {
      const Point3<S> b = inverse * column(around_, j, value_);
      const S share = thickness(j, rho), of_pull = inverse / share;
      const Point3<S> pull = of_pull * column(y, j, value_);
      const Point3<S> t = detail::membrane::stretch_of_pull(pull, b, m, across_[j]);
      if (options_.slopes) {
        slopes_of_rates(j, t, b, inverse, of_pull, share, y, along);
      }
      put(along, j, value_, t);
      put(hoop_, j, value_, share * rubber_pull(b, t, m));
    }
    change_around(hoop_, y_rate_);
    const std::size_t w = width_;
    for (std::size_t j = 0; j < n_; ++j) {
      const Point3<S> p = column(around_, j, value_), t = column(along, j, value_);
      const Point3<S> turned = load * cross(p, t);
      const S at[3] = {p.x, p.y, p.z}, way[3] = {t.x, t.y, t.z};
      const S *a = &around_[j * 3 * w], *d = &along[j * 3 * w];
      S* out = &y_rate_[j * 3 * w];
      for (std::size_t r = 0; r < 3; ++r) {  // both factors of the product change
        const std::size_t n = (r + 1) % 3, l = (r + 2) % 3;
        const S* row = out + r * w;
        const S tl = load * way[l], tn = load * way[n], pl = load * at[l], pn = load * at[n];
        each(w, out + r * w, [=](std::size_t k) {
          return tn * a[l * w + k] - tl * a[n * w + k] + pl * d[n * w + k] - pn * d[l * w + k] -
                 row[k];
        });
      }
      put(y_rate_, j, value_, column(y_rate_, j, value_) + turned);  // not twice
      if (options_.slopes) {
        const std::size_t by_load = value_ - 1;
        put(y_rate_, j, by_load, column(y_rate_, j, by_load) - cross(p, t));
      }
    }
  }

  void slopes_of_rates(std::size_t j,
                       const Point3<S>& along,
                       const Point3<S>& b,
                       const S& inverse,
                       const S& of_pull,
                       const S& share,
                       const Field& y,
                       Field& along_of_x) {
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
        by_y[r][c] = of_pull * solve[r][c];
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
        hoop_by_y[r][c] = share * s;
        hoop_by_around[r][c] = share * t;
      }
    }
    const std::size_t from = j * 3 * width_;
    combine(by_y, &y[from], by_around, &around_[from], &along_of_x[from]);
    combine(hoop_by_y, &y[from], hoop_by_around, &around_[from], &hoop_[from]);
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
  std::size_t n_ = 0, terms_ = 0, offset_terms_ = 0, value_ = 0, width_ = 0, steps_ = 0;
  S step_mm_ = S(0), load_ = S(0);
  std::vector<S> across_, growth_;  // growth of mu t per mm from the axis
  std::vector<std::vector<S>> basis_;
  std::vector<Field> x_, along_;  // at each circle
  Field y_, around_, hoop_, x_at_, y_at_, x_sum_, y_sum_, y_rate_, rim_around_, rim_pull_;
};

}  // namespace v1
}  // namespace fingerpad
