// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every membrane, every load and every grid.
#include "fingerpad/force/traction.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/membrane_triangle.hpp"
#include "support/rolling.hpp"

using namespace fingerpad;
using test::Dots;
using test::Flags;
using Vector = Point3<double>;

namespace {

double size(const Vector& a) {
  return std::sqrt(squared_norm(a));
}
double distance(const Vector& a, const Vector& b) {
  return size(a - b);
}
Vector any_vector(double largest) {
  return {test::uniform(-largest, largest), test::uniform(-largest, largest),
          test::uniform(-largest, largest)};
}

/// A membrane that is stretched and loaded at random.
struct Pad {
  Dots free{0, 0};
  Dots dots{0, 0};
  Flags contact{0, 0};
  double pressure = 0.02;
  double mu_t = 0.5;

  static Pad any() {
    const Index rows = test::whole(6, 10), cols = test::whole(6, 10);
    Pad pad{Dots(rows, cols), Dots(rows, cols), Flags(rows, cols, 0), test::log_uniform(1e-3, 0.1),
            test::log_uniform(0.05, 5)};
    const double stretch_x = test::uniform(1, 1.4), stretch_y = test::uniform(1, 1.4);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const double x = 1.5 * static_cast<double>(j - cols / 2);
        const double y = 1.5 * static_cast<double>(i - rows / 2);
        pad.free(i, j) = Vector{x, y, 12 - (x * x + y * y) / 40} + any_vector(0.1);
        const Vector& f = pad.free(i, j);
        pad.dots(i, j) = Vector{stretch_x * f.x, stretch_y * f.y, 1.1 * f.z} + any_vector(0.1);
        pad.contact(i, j) = std::hypot(x - 1, y + 1) < 3 ? 1 : 0;
      }
    }
    return pad;
  }
};

struct Seen {
  TractionResult<double> result;
  TractionField<> maps;
};

Seen look_with(const Pad& pad, const TractionOptions<>& options) {
  Seen seen{{}, TractionField<>(pad.free, options)};
  seen.result = seen.maps(pad.dots, pad.contact, pad.pressure);
  return seen;
}
Seen look(const Pad& pad, TractionOptions<> options = {}) {
  options.mu_t_n_per_mm = pad.mu_t;
  return look_with(pad, options);
}

/// Scale of the loads, for comparison.
double typical_load(const Pad& pad) {
  return pad.pressure + pad.mu_t;
}

template <class Map>
Dots mapped(Dots dots, const Map& map) {
  for (auto& p : dots.cells) {
    p = map(p);
  }
  return dots;
}

/// Asserts that the maps of b are those of a with map(load), `factor` times the contact pressure,
/// and dot (i, j) of a at place(i, j) in b.
template <class Map, class Place>
void assert_same(const Seen& a,
                 const Seen& b,
                 double tolerance,
                 const Map& map,
                 const Place& place,
                 double factor = 1) {
  for (Index i = 0; i < a.maps.rows(); ++i) {
    for (Index j = 0; j < a.maps.cols(); ++j) {
      const DotIndex at = place(i, j);
      const double p = a.maps.pressure_mpa()(i, j);
      const double q = b.maps.pressure_mpa()(at.row, at.col);
      RC_ASSERT(is_finite(p) == is_finite(q));
      if (is_finite(p)) {
        RC_ASSERT(std::abs(factor * p - q) <= tolerance);
        RC_ASSERT(distance(map(a.maps.load_mpa()(i, j)), b.maps.load_mpa()(at.row, at.col)) <=
                  tolerance);
      }
    }
  }
}
const auto same_place = [](Index i, Index j) { return DotIndex{i, j}; };

/// Asserts that all known values are finite and that the counts are those of the maps.
template <class S = double, class Field>
void assert_valid(const Pad& pad, Field field) {
  const auto r = field(pad.dots, pad.contact, static_cast<S>(pad.pressure));
  RC_ASSERT((r.status != TractionStatus::refused));
  const bool has_force = r.has_force();
  RC_ASSERT(has_force == is_finite(r.mu_t_n_per_mm));
  RC_ASSERT(is_finite(r.force_n) == has_force);
  RC_ASSERT(is_finite(r.moment_n_mm) == has_force);
  RC_ASSERT(is_finite(r.free_load_rms_mpa) == (has_force && r.free_dots > 0));
  Index loaded = 0;
  for (Index i = 0; i < pad.dots.rows(); ++i) {
    for (Index j = 0; j < pad.dots.cols(); ++j) {
      const bool known = is_finite(field.pressure_mpa()(i, j));
      RC_ASSERT(is_finite(field.load_mpa()(i, j)) == known);
      RC_ASSERT(is_finite(field.shear_mpa()(i, j)) == known);
      loaded += known ? 1 : 0;
    }
  }
  RC_ASSERT((loaded > 0) == has_force);
}

}  // namespace

TEST_CASE("traction turns and shifts with the dots", "[traction][law]") {
  rc::prop("load, force and moment", [] {
    const Pad pad = Pad::any();
    const Seen before = look(pad);
    RC_PRE(before.result.has_force());
    const Rotation<double> turn = test::turned_by(any_vector(1.5));
    const Vector shift = any_vector(20);
    Pad moved = pad;
    moved.dots = mapped(pad.dots, [&](const Vector& x) { return turn(x) + shift; });
    // the stress-free shape may lie anywhere: only its side toward +z matters
    const Rotation<double> other = test::turned_by(any_vector(0.5));
    moved.free = mapped(pad.free, [&](const Vector& x) { return other(x) + shift; });
    const Seen after = look(moved);
    const double small = 1e-11 * typical_load(pad);
    assert_same(
        before, after, small, [&](const Vector& q) { return turn(q); }, same_place);
    const Vector force = turn(before.result.force_n);
    const Vector moment = turn(before.result.moment_n_mm) + cross(shift, force);
    RC_ASSERT(distance(after.result.force_n, force) <= 1000 * small);
    RC_ASSERT(distance(after.result.moment_n_mm, moment) <= 1e5 * small);
  });
}

TEST_CASE("traction of a mirror image is the mirror image", "[traction][law]") {
  rc::prop("load, force and moment", [] {
    const Pad pad = Pad::any();
    const Seen before = look(pad);
    RC_PRE(before.result.has_force());
    const auto mirror = [](const Vector& x) { return Vector{-x.x, x.y, x.z}; };
    Pad image = pad;
    image.dots = mapped(pad.dots, mirror);
    image.free = mapped(pad.free, mirror);
    const Seen after = look(image);
    const double small = 1e-11 * typical_load(pad);
    assert_same(before, after, small, mirror, same_place);
    const Vector m = before.result.moment_n_mm;
    RC_ASSERT(distance(after.result.moment_n_mm, {m.x, -m.y, -m.z}) <= 1e5 * small);
  });
}

TEST_CASE("traction does not care how rows and columns run", "[traction][law]") {
  rc::prop("transposed, or last row first", [] {
    const Pad pad = Pad::any();
    const Seen before = look(pad);
    RC_PRE(before.result.has_force());
    const bool transposed = test::whole(0, 1) == 1;
    const Index rows = pad.dots.rows(), cols = pad.dots.cols();
    const auto place = [&](Index i, Index j) {
      return transposed ? DotIndex{j, i} : DotIndex{rows - 1 - i, j};
    };
    Pad other{transposed ? Dots(cols, rows) : Dots(rows, cols),
              transposed ? Dots(cols, rows) : Dots(rows, cols),
              transposed ? Flags(cols, rows) : Flags(rows, cols), pad.pressure, pad.mu_t};
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const DotIndex at = place(i, j);
        other.free(at.row, at.col) = pad.free(i, j);
        other.dots(at.row, at.col) = pad.dots(i, j);
        other.contact(at.row, at.col) = pad.contact(i, j);
      }
    }
    const Seen after = look(other);
    const double small = 1e-11 * typical_load(pad);
    assert_same(
        before, after, small, [](const Vector& q) { return q; }, place);
    RC_ASSERT(distance(after.result.force_n, before.result.force_n) <= 1000 * small);
    RC_ASSERT(distance(after.result.moment_n_mm, before.result.moment_n_mm) <= 1e5 * small);
    RC_ASSERT(after.result.status == before.result.status);
  });
}

TEST_CASE("traction is linear in pressure and mu t together", "[traction][law]") {
  rc::prop("the sum of two is the traction of the sums", [] {
    const Pad pad = Pad::any();
    Pad other = pad, both = pad;
    other.pressure = test::log_uniform(1e-3, 0.1);
    other.mu_t = test::log_uniform(0.05, 5);
    both.pressure += other.pressure;
    both.mu_t += other.mu_t;
    const Seen one = look(pad), two = look(other), sum = look(both);
    RC_PRE(one.result.has_force());
    const double small = 1e-11 * typical_load(both);
    for (Index i = 0; i < pad.dots.rows(); ++i) {
      for (Index j = 0; j < pad.dots.cols(); ++j) {
        const Vector& q = sum.maps.load_mpa()(i, j);
        RC_ASSERT(!is_finite(q.x) ||
                  distance(q, one.maps.load_mpa()(i, j) + two.maps.load_mpa()(i, j)) <= small);
      }
    }
    RC_ASSERT(distance(sum.result.force_n, one.result.force_n + two.result.force_n) <=
              1000 * small);
  });
}

TEST_CASE("traction in other units of length", "[traction][law]") {
  rc::prop("loads stay, forces go with the square, moments with the cube", [] {
    const Pad pad = Pad::any();
    const Seen before = look(pad);
    RC_PRE(before.result.has_force());
    const double f = test::log_uniform(0.01, 100);
    const auto larger = [&](const Vector& x) { return f * x; };
    Pad other = pad;
    other.free = mapped(pad.free, larger);
    other.dots = mapped(pad.dots, larger);
    other.mu_t *= f;
    const Seen after = look(other);
    const double small = 1e-11 * typical_load(pad);
    assert_same(
        before, after, small, [](const Vector& q) { return q; }, same_place);
    RC_ASSERT(distance(after.result.force_n, f * f * before.result.force_n) <=
              1000 * f * f * small);
    RC_ASSERT(distance(after.result.moment_n_mm, f * f * f * before.result.moment_n_mm) <=
              1e5 * f * f * f * small);
  });
}

TEST_CASE("the balanced mu t goes with the pressure", "[traction][law]") {
  rc::prop("and with it all loads", [] {
    const Pad pad = Pad::any();
    const TractionOptions<> balanced{.min_free_dots = 1, .max_pressure_mpa = 100};
    const Seen before = look_with(pad, balanced);
    RC_PRE(before.result.has_force());
    const double f = test::log_uniform(0.1, 10);
    Pad scaled = pad;
    scaled.pressure *= f;
    const Seen after = look_with(scaled, balanced);
    const double mu_t = before.result.mu_t_n_per_mm;
    RC_ASSERT(std::abs(after.result.mu_t_n_per_mm - f * mu_t) <= 1e-12 * f * mu_t);
    assert_same(
        before, after, 1e-10 * f * (pad.pressure + mu_t), [&](const Vector& q) { return f * q; },
        same_place, f);
    // with that mu t given, the result is the same
    const Seen given = look_with(pad, {.mu_t_n_per_mm = mu_t, .max_pressure_mpa = 100});
    RC_ASSERT(distance(given.result.force_n, before.result.force_n) <=
              1e-9 * (pad.pressure + mu_t));
  });
}

TEST_CASE("the sum of the loads is what crosses the border", "[traction][law]") {
  rc::prop("wherever the dots inside lie: action is reaction", [] {
    const Pad pad = Pad::any();
    const TractionOptions<> abrupt{.ring_dots = 1, .fade_dots = 0};
    const Seen before = look(pad, abrupt);
    RC_PRE(before.result.has_force() && before.result.dots_left_out == 0);
    Pad other = pad;
    Index moved = 0;
    for (Index i = 1; i + 1 < pad.dots.rows(); ++i) {
      for (Index j = 1; j + 1 < pad.dots.cols(); ++j) {
        if (pad.contact(i, j) != 0) {  // contact and ring include all its neighbours
          other.dots(i, j) = other.dots(i, j) + any_vector(0.2);
          ++moved;
        }
      }
    }
    RC_PRE(moved > 0);
    const Seen after = look(other, abrupt);
    RC_PRE(after.result.dots_left_out == 0);
    const double small = 1e-9 * typical_load(pad);
    RC_ASSERT(distance(after.result.force_n, before.result.force_n) <= small);
    RC_ASSERT(distance(after.result.moment_n_mm, before.result.moment_n_mm) <= 100 * small);
    RC_ASSERT(distance(after.maps.load_mpa()(pad.dots.rows() / 2, pad.dots.cols() / 2),
                       before.maps.load_mpa()(pad.dots.rows() / 2, pad.dots.cols() / 2)) > small);
  });
}

TEST_CASE("the sum of the loads over all dots, from the border alone", "[traction][law]") {
  // All interior dots are summed. Their load balances the pull of the cells along the border of the
  // grid on the border dots, with the sign reversed, and the pressure on the area that does not
  // belong to the border dots.
  rc::prop("force", [] {
    Pad pad = Pad::any();
    for (auto& flag : pad.contact.cells) {
      flag = 1;
    }
    const Seen seen = look(pad, {.ring_dots = 0, .fade_dots = 0});
    RC_PRE(seen.result.dots_left_out == 2 * (pad.dots.rows() + pad.dots.cols()) - 4);
    const Index rows = pad.dots.rows(), cols = pad.dots.cols();
    Vector pull{0, 0, 0}, area{0, 0, 0};
    for (Index i = 0; i + 1 < rows; ++i) {
      for (Index j = 0; j + 1 < cols; ++j) {
        const bool at_border = i == 0 || j == 0 || i + 2 == rows || j + 2 == cols;
        const auto corners = [&](const Dots& d) {
          return std::array<Vector, 4>{d(i, j), d(i, j + 1), d(i + 1, j + 1), d(i + 1, j)};
        };
        const auto x = corners(pad.dots);
        const auto f = corners(pad.free);
        const Index row[4] = {i, i, i + 1, i + 1}, col[4] = {j, j + 1, j + 1, j};
        for (std::size_t k = 0; at_border && k < 4; ++k) {
          const auto ear = [&](const std::array<Vector, 4>& d) {
            return test::Corners<double>{d[(k + 3) % 4], d[k], d[(k + 1) % 4]};
          };
          const auto of = test::corner_forces(test::stress_free(ear(f)), ear(x));
          const auto doubled = test::twice_area_vector(ear(x));
          for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t at = (k + 3 + c) % 4;
            if (row[at] == 0 || col[at] == 0 || row[at] + 1 == rows || col[at] + 1 == cols) {
              pull = pull + 0.5 * of[c];
              area = area + -1.0 / 12 * doubled;
            }
          }
        }
      }
    }
    // the area vector of any surface is half the integral of x times dx along its border
    const auto along = [&](Index r0, Index c0, Index r1, Index c1) {
      area = area + 0.5 * cross(pad.dots(r0, c0), pad.dots(r1, c1));
    };
    for (Index j = 0; j + 1 < cols; ++j) {
      along(0, j, 0, j + 1);
      along(rows - 1, j + 1, rows - 1, j);
    }
    for (Index i = 0; i + 1 < rows; ++i) {
      along(i, cols - 1, i + 1, cols - 1);
      along(i + 1, 0, i, 0);
    }
    const Vector expected = pad.mu_t * pull + -pad.pressure * area;
    RC_ASSERT(distance(seen.result.force_n, expected) <= 1e-10 * typical_load(pad));
  });
}

TEST_CASE("a dot that is missing or wrong spoils what touches it and nothing else",
          "[traction][law]") {
  rc::prop("all other loads stay to the last bit", [] {
    const Pad pad = Pad::any();
    const Seen before = look(pad);
    RC_PRE(before.result.has_force());
    Pad holed = pad;
    const Index i0 = test::whole(0, pad.dots.rows() - 1), j0 = test::whole(0, pad.dots.cols() - 1);
    const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::infinity(), 1e300, 5e5};
    holed.dots(i0, j0).y = bad[test::whole(0, 3)];
    const Seen after = look(holed);
    for (Index i = 0; i < pad.dots.rows(); ++i) {
      for (Index j = 0; j < pad.dots.cols(); ++j) {
        const bool near = std::abs(i - i0) <= 1 && std::abs(j - j0) <= 1;
        const double p = before.maps.pressure_mpa()(i, j), q = after.maps.pressure_mpa()(i, j);
        RC_ASSERT(is_finite(q) == (is_finite(p) && !near));
        RC_ASSERT(near || !is_finite(p) || p == q);
      }
    }
  });
}

TEST_CASE("traction of anything at all", "[traction][law][fuzz]") {
  const double infinity = std::numeric_limits<double>::infinity();
  const double odd[] = {0,        -0.0,      1e-300,
                        1e300,    -1e15,     5e5,
                        infinity, -infinity, std::numeric_limits<double>::quiet_NaN(),
                        1e-12};
  rc::prop("valid fields are finite, and the counts agree", [&] {
    Pad pad = Pad::any();
    const auto spoil = [&](Dots& dots) {
      for (Index k = test::whole(0, 12); k > 0; --k) {
        Vector& p = dots(test::whole(0, dots.rows() - 1), test::whole(0, dots.cols() - 1));
        double& c = *(test::whole(0, 2) == 0 ? &p.x : test::whole(0, 1) == 0 ? &p.y : &p.z);
        c = test::whole(0, 2) == 0 ? test::uniform(-20, 20) : odd[test::whole(0, 9)];
      }
    };
    spoil(pad.dots);
    if (test::whole(0, 1) == 0) {
      spoil(pad.free);
    }
    for (auto& flag : pad.contact.cells) {
      flag = test::whole(0, 9) == 0 ? !flag : flag;
    }
    pad.pressure = test::whole(0, 4) == 0 ? odd[test::whole(0, 9)] : pad.pressure;
    const bool given = test::whole(0, 1) == 0;
    const auto options = [&, ring = test::whole(0, 5), fade = test::whole(0, 20)]<class S>(S) {
      TractionOptions<S> o{.min_free_dots = 1, .ring_dots = ring, .fade_dots = fade};
      if (given) {
        o.mu_t_n_per_mm = static_cast<S>(pad.mu_t);
      }
      return o;
    };
    assert_valid(pad, TractionField(pad.free, options(0.0)));
    assert_valid<float>(pad, TractionField<float>(pad.free, options(0.0F)));
  });
}
