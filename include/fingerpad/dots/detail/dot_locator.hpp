// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The center of one printed disc in a picture: least squares of light, contrast and center against
// the picture of an ellipse whose edge is blurred. A centroid is drawn aside by uneven light, which
// is fitted here, and by the second derivative of the map from print to picture, as the ellipse is:
// by how much follows from the map.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/quick_math.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// Where a point (a, b) of the disc, in radii, is seen:
/// center + a ja + b jb + (a^2 qaa + 2 a b qab + b^2 qbb) / 2, in px.
struct DiscMap {
  Point2<double> ja, jb;
  Point2<double> qaa = {0, 0}, qab = {0, 0}, qbb = {0, 0};
};

/// a^2 + b^2 as a polynomial in the offset (x, y) from the center, px, without the map's second
/// order; and how far that moves the ellipse that fits the rim best.
struct DiscRim {
  explicit DiscRim(const DiscMap& map) {
    const double det = map.ja.x * map.jb.y - map.jb.x * map.ja.y;
    const double ax = map.jb.y / det, ay = -map.jb.x / det;
    const double bx = -map.ja.y / det, by = map.ja.x / det;
    xx = float(ax * ax + bx * bx);
    xy = float(2 * (ax * ay + bx * by));
    yy = float(ay * ay + by * by);
    const auto a_of = [&](const Point2<double>& q) { return ax * q.x + ay * q.y; };
    const auto b_of = [&](const Point2<double>& q) { return bx * q.x + by * q.y; };
    // the rim's shift q(angle) / 2 along the normal, times twice the normal: means over the angle
    bend = (3 * a_of(map.qaa) + a_of(map.qbb) + 2 * b_of(map.qab)) / 8 * map.ja +
           (3 * b_of(map.qbb) + b_of(map.qaa) + 2 * a_of(map.qab)) / 8 * map.jb;
  }
  float xx, xy, yy;
  Point2<double> bend;
};

struct DiscFit {
  bool good = false;
  Point2<double> center = {0, 0};
  Point2<double> sd_px = {0, 0};
  double light = 0;     ///< grey levels of the print's background at the center
  double contrast = 0;  ///< share of the light that the disc takes; negative: a bright disc
  double residual = 0;  ///< rms, grey levels
  Point2<double> slope = {0, 0};  ///< relative change of the light per px
};

/// The middle of what is darker than `threshold` (brighter, if `sign` is -1) within `reach` px of
/// `from`, by mean shift.
template <class View>
Point2<double> darkest(
    const View& image, double threshold, double sign, Point2<double> from, double reach) {
  constexpr int rounds = 6;
  const auto r = Index(reach);
  for (int round = 0; round < rounds; ++round) {
    const auto x0 = Index(std::floor(from.x + 0.5)), y0 = Index(std::floor(from.y + 0.5));
    if (x0 < r || y0 < r || x0 + r >= image.cols() || y0 + r >= image.rows()) {
      break;
    }
    double sum = 0;
    Point2<double> moment = {0, 0};
    for (Index y = -r; y <= r; ++y) {
      for (Index x = -r; x <= r; ++x) {
        const double dark = sign * (threshold - double(image(y0 + y, x0 + x)));
        if (dark > 0 && x * x + y * y <= r * r) {
          sum += dark;
          moment += dark * Point2<double>{double(x), double(y)};
        }
      }
    }
    if (!(sum > 0)) {
      break;
    }
    const Point2<double> next = Point2<double>{double(x0), double(y0)} + moment / sum;
    const double step = norm(next - from);
    from = next;
    if (step < 0.3) {
      break;
    }
  }
  return from;
}

/// Reads windows of one image of any type; one object a thread.
class DotLocator {
 public:
  static constexpr int side = 64;  ///< largest window, px
  /// The window reaches this far beyond the blurred edge, px.
  static constexpr double around_px = 1.0;

  DotLocator() : cells_(std::size_t(side) * side) {}

  /// Steps of Gauss and Newton from `guess` until one is short: it errs by less than a fiftieth of
  /// its length, since errors are of the third power.
  template <class View>
  DiscFit find(const View& image,
               Point2<double> guess,
               const DiscMap& map,
               double edge_px,
               Point2<double> slope) {
    constexpr int most = 5;
    constexpr double short_px = 0.5, longest_px = 1.5;
    const DiscRim rim(map);
    guess += rim.bend;
    DiscFit fit;
    for (int k = 0; k < most; ++k) {
      fit = load(image, guess, map, edge_px) ? step(guess, rim, edge_px, slope) : DiscFit();
      const Point2<double> move = fit.center - guess;
      const double length = norm(move);
      if (!fit.good || length < short_px) {
        fit.center = fit.center - rim.bend;
        return fit;
      }
      slope = fit.slope;
      guess += (std::min)(1.0, longest_px / length) * move;
    }
    fit.good = false;
    return fit;
  }

  /// Fits shape and blur of the edge as well, for a disc that is still: `map` is improved by a
  /// stretch of its own, `edge_px` only if it is free.
  template <class View>
  DiscFit fit_shape(
      const View& image, Point2<double> center, DiscMap& map, double& edge_px, bool free_edge) {
    constexpr int rounds = 12;
    constexpr std::size_t n = 10;
    DiscFit fit;
    Point2<double> slope{0, 0};
    for (int round = 0; round < rounds; ++round) {
      if (!load(image, center, map, edge_px)) {
        return {};
      }
      const DiscRim rim(map);
      ProductSums<double, n + 1> sums;
      for (Index i = 0; i < rows_; ++i) {
        const double y = double(y0_ + i) - center.y;
        const Line<float> l(rim, float(y), slope);
        for (Index j = 0; j < cols_; ++j) {
          const double x = double(x0_ + j) - center.x;
          const Edge<float> e(l, float(x), float(edge_px));
          if (e.inside != 0) {
            const double hx = double(e.hx), hy = double(e.hy);
            sums.add({1, x, y, -double(e.disc), hx, hy, hx * x, hx * y + hy * x, hy * y,
                      double(e.wider), double(cells_[std::size_t(i * cols_ + j)] - base_)});
          }
        }
      }
      SmallMatrix<double, n> a = sums.corner<n>();
      if (!free_edge) {
        for (std::size_t k = 0; k < n; ++k) {
          a[n - 1][k] = a[k][n - 1] = k == n - 1 ? 1 : 0;
        }
      }
      std::array<double, n> b = sums.column<n>(n);
      b[n - 1] = free_edge ? b[n - 1] : 0;
      const NormalEquations<double, n> normal(a);
      if (!normal.good) {
        return {};
      }
      const std::array<double, n> p = normal.solve(b);
      const double light = p[0] + double(base_);
      double square = sums(n, n);
      for (std::size_t k = 0; k < n; ++k) {
        square -= p[k] * b[k];
      }
      fit.light = light;
      fit.contrast = p[3] / light;
      fit.slope = slope = {p[1] / light, p[2] / light};
      fit.residual = std::sqrt((std::max)(square, 0.0) / (std::max)(sums(0, 0) - n, 1.0));
      const auto held = [](double v, double most) { return (std::clamp)(v, -most, most); };
      const Point2<double> move{held(p[4] / p[3], 1.0), held(p[5] / p[3], 1.0)};
      const double sxx = held(p[6] / p[3], 0.2), sxy = held(p[7] / p[3], 0.2),
                   syy = held(p[8] / p[3], 0.2);
      const auto stretched = [&](const Point2<double>& v) {
        return Point2<double>{v.x + sxx * v.x + sxy * v.y, v.y + sxy * v.x + syy * v.y};
      };
      center += move;
      map.ja = stretched(map.ja);
      map.jb = stretched(map.jb);
      if (free_edge) {
        edge_px = (std::clamp)(edge_px + held(p[9] / p[3], 0.5), 0.6, 8.0);
      }
      fit.center = center;
      fit.good = norm(move) < 0.02 && std::fabs(sxx) + std::fabs(sxy) + std::fabs(syy) < 0.01;
      if (fit.good) {
        return fit;
      }
    }
    return fit;
  }

 private:
  using Row = lanes<float, row_lanes<float>>;
  static constexpr int terms = 28;
  using Sums = std::array<double, terms>;

  /// Loads the window around a center, wide enough for whole vectors; false if it is not inside the
  /// image or too large.
  template <class View>
  bool load(const View& image, const Point2<double>& center, const DiscMap& map, double edge_px) {
    constexpr Index step = lanes_in<Row, float>;
    const double beyond = edge_px + around_px;
    const double half_x = std::hypot(map.ja.x, map.jb.x) + beyond;
    const double half_y = std::hypot(map.ja.y, map.jb.y) + beyond;
    const double left = std::ceil(center.x - half_x), top = std::ceil(center.y - half_y);
    const double right = std::floor(center.x + half_x), bottom = std::floor(center.y + half_y);
    if (!(left >= 0 && top >= 0 && right < double(image.cols()) && bottom < double(image.rows())) ||
        right - left >= side - 16 || bottom - top >= side - 16) {
      return false;
    }
    cols_ = (Index(right) - Index(left) + step) / step * step;
    rows_ = Index(bottom) - Index(top) + 1;
    x0_ = (std::min)(Index(left), image.cols() - cols_);
    y0_ = Index(top);
    if (x0_ < 0) {
      return false;
    }
    float* to = cells_.data();
    const Index x0 = x0_, cols = cols_;  // a store of floats could change the members
    for (Index i = y0_; i < y0_ + rows_; ++i, to += cols) {
#pragma GCC unroll 4
      for (Index j = 0; j < cols; ++j) {
        to[j] = float(image(i, x0 + j));
      }
    }
    base_ = cells_[0];
    return true;
  }

  /// A row of the picture: coefficients of powers of x.
  template <class V>
  struct Line {
    Line() = default;
    Line(const DiscRim& r, float at, const Point2<double>& slope)
        : y(V{} + at),
          a0(V{} + (at * at * r.yy + 1e-6F)),
          a1(V{} + at * r.xy),
          a2(V{} + r.xx),
          b0(V{} + 2 * at * r.yy),
          b1(V{} + r.xy),
          light(V{} + (1 + float(slope.y) * at)),
          light_x(V{} + float(slope.x)) {}
    V y, a0, a1, a2;   ///< distance from the center, in radii, squared
    V b0, b1;          ///< its derivative by y
    V light, light_x;  ///< relative to that at the center
  };

  /// The picture of the disc at offsets x from its center.
  template <class V>
  struct Edge {
    Edge() = default;
    [[gnu::always_inline]] Edge(const Line<V>& l, const V& x, float width) {
      const V one = V{} + 1.0F;
      const V ax = l.a2 * x, first = ax + l.a1;
      const V square = first * x + l.a0;
      const V fx = first + ax;
      const V fy = l.b1 * x + l.b0;
      const V inverse = rough_inverse_sqrt<V>(fx * fx + fy * fy + 1e-6F);
      // distance from the edge, in its widths
      const V t = (square - square * rough_inverse_sqrt<V>(square)) * inverse * (2.0F / width);
      const V above = t > -one ? t : -one;
      const V u = above < one ? above : one;
      const V uu = u * u, gap = one - uu;
      const V light = l.light_x * x + l.light;
      const V bell = (0.9375F / width) * light * gap * gap;
      const V steep = bell * inverse;
      inside = t < V{} + (1.0F + float(around_px) / width) ? one : V{};
      disc = light * (0.5F - u * (0.9375F - uu * (0.625F - 0.1875F * uu)));
      hx = -steep * fx;
      hy = -steep * fy;
      wider = -bell * u;
    }
    V inside;  ///< 1 in the window, else 0
    V disc;    ///< 1 in the disc, 0 outside, times the light's slope
    V hx, hy;  ///< derivatives of `disc` by x and y
    V wider;   ///< derivative of -`disc` by the width of the edge
  };

  DiscFit step(const Point2<double>& center,
               const DiscRim& rim,
               double edge_px,
               const Point2<double>& slope) const {
    std::array<Line<Row>, side> lines;
    for (Index i = 0; i < rows_; ++i) {
      lines[std::size_t(i)] = {rim, float(double(y0_ + i) - center.y), slope};
    }
    std::array<Row, terms> sums{};
    for (Index j = 0; j < cols_; j += lanes_in<Row, float>) {
      add(lines, float(double(x0_ + j) - center.x), j, float(edge_px), sums);
    }
    Sums all;
    for (std::size_t k = 0; k < terms; ++k) {
      all[k] = double(sum(sums[k]));
    }
    return solve(all, center);
  }

  /// Adds a column of vectors of the window to the sums.
  [[gnu::always_inline]] void add(const std::array<Line<Row>, side>& lines,
                                  float x0,
                                  Index j,
                                  float width,
                                  std::array<Row, terms>& to) const {
    std::array<float, lanes_in<Row, float>> ramp;
    for (std::size_t k = 0; k < ramp.size(); ++k) {
      ramp[k] = x0 + float(k);
    }
    const auto x = load_cells<Row>(ramp.data());
    const Row base = Row{} + base_;
    // In two rounds: all 21 sums at once would not fit into the registers of most machines.
    std::array<Row, side> ins, discs, hxs, hys, vs;
    const auto n = std::size_t(rows_);
    Row s0{}, s1{}, s2{}, s3{}, s4{}, s5{}, s6{}, s7{}, s8{}, s9{};
    for (std::size_t i = 0; i < n; ++i) {
      const Edge<Row> e(lines[i], x, width);
      ins[i] = e.inside;
      discs[i] = e.disc;
      hxs[i] = e.hx;
      hys[i] = e.hy;
      vs[i] = (load_cells<Row>(cells_.data() + Index(i) * cols_ + j) - base) * e.inside;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Row y = lines[i].y, in = ins[i], disc = discs[i], v = vs[i], iny = in * y;
      s0 += in;
      s1 += iny;
      s2 += iny * y;
      s3 += v;
      s4 += v * y;
      s5 += v * v;
      s6 += disc;
      s7 += disc * y;
      s8 += disc * disc;
      s9 += disc * v;
    }
    Row s10{}, s11{}, s12{}, s13{}, s14{}, s15{}, s16{}, s17{}, s18{}, s19{}, s20{};
    for (std::size_t i = 0; i < n; ++i) {
      const Row y = lines[i].y, disc = discs[i], v = vs[i], hx = hxs[i], hy = hys[i];
      s10 += hx;
      s11 += hx * y;
      s12 += hy;
      s13 += hy * y;
      s14 += disc * hx;
      s15 += disc * hy;
      s16 += hx * hx;
      s17 += hx * hy;
      s18 += hy * hy;
      s19 += hx * v;
      s20 += hy * v;
    }
    const auto add_each = [&to](const auto&... sums) {
      std::size_t k = 0;
      ((to[k++] += sums), ...);
    };
    add_each(s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10, s11, s12, s13, s14, s15, s16, s17, s18,
             s19, s20, s0 * x, s0 * x * x, s1 * x, s3 * x, s6 * x, s10 * x, s12 * x);
  }

  /// The sum of the lanes, by halves.
  template <class V>
  [[gnu::always_inline]] static float sum(const V& v) {
    if constexpr (scalar<V>) {
      return v;
    } else if constexpr (lanes_in<V, float> == 4) {
      return (v[0] + v[2]) + (v[1] + v[3]);
    } else {
      using Half = lanes<float, lanes_in<V, float> / 2>;
      const char* bytes = reinterpret_cast<const char*>(&v);
      return sum(Half(detail::load<Half>(bytes) + detail::load<Half>(bytes + sizeof(Half))));
    }
  }

  DiscFit solve(const Sums& s, const Point2<double>& center) const {
    // Unknowns: light and its two slopes, contrast, contrast times the two steps. L D L^T, in which
    // the steps come last, so that their variances are in its last two rows.
    double a[6][6] = {{s[0]},
                      {s[21], s[22]},
                      {s[1], s[23], s[2]},
                      {-s[6], -s[25], -s[7], s[8]},
                      {s[10], s[26], s[11], -s[14], s[16]},
                      {s[12], s[27], s[13], -s[15], s[17], s[18]}};
    double p[6] = {s[3], s[24], s[4], -s[9], s[19], s[20]};
    double inverse[6];  // of D
    double square = s[5];
    DiscFit fit;
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
      double row[6];  // of L D
      double rest = a[i][i];
#pragma GCC unroll 6
      for (int j = 0; j < i; ++j) {
        row[j] = a[i][j];
#pragma GCC unroll 6
        for (int k = 0; k < j; ++k) {
          row[j] -= row[k] * a[j][k];
        }
        a[i][j] = row[j] * inverse[j];
        rest -= row[j] * a[i][j];
        p[i] -= a[i][j] * p[j];
      }
      if (!(rest > 1e-4 * a[i][i])) {
        return fit;
      }
      inverse[i] = 1 / rest;
      square -= p[i] * p[i] * inverse[i];
    }
#pragma GCC unroll 6
    for (int i = 5; i >= 0; --i) {
      p[i] *= inverse[i];
#pragma GCC unroll 6
      for (int k = i + 1; k < 6; ++k) {
        p[i] -= a[k][i] * p[k];
      }
    }
    fit.light = p[0] + double(base_);
    fit.contrast = p[3] / fit.light;
    fit.slope = {p[1] / fit.light, p[2] / fit.light};
    fit.residual = std::sqrt((std::max)(square, 0.0) / (std::max)(s[0] - 6, 1.0));
    fit.center = center + Point2<double>{p[4] / p[3], p[5] / p[3]};
    const double scale = fit.residual / std::fabs(p[3]);
    fit.sd_px = {scale * std::sqrt(inverse[4] + a[5][4] * a[5][4] * inverse[5]),
                 scale * std::sqrt(inverse[5])};
    fit.good = is_finite(fit.center);
    return fit;
  }

  std::vector<float> cells_;
  Index x0_ = 0, y0_ = 0, rows_ = 0, cols_ = 0;  ///< of the window
  float base_ = 0;
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
