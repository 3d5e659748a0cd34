// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/depth/neighbour_light.hpp"

#include <Eigen/Core>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>
#include <xtensor/xtensor.hpp>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/adapt/xtensor.hpp"
#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/foreign_image.hpp"
#include "support/generators.hpp"

using namespace fingerpad;

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

template <class S>
using Map = Eigen::Array<S, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The pressed cap of a small pad with waves, so that nothing is symmetric; NaN outside the pad.
Map<double> membrane(Index rows, Index cols, double pressed_mm, double phase) {
  Map<double> l(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double x = (static_cast<double>(j) - static_cast<double>(cols) / 2) / 8;
      const double y = (static_cast<double>(i) - static_cast<double>(rows) / 2) / 8;
      const double cap = 6 - 0.15 * (x * x + y * y);
      const double wave = 0.2 * std::sin(x + phase) * std::cos(0.7 * y - phase);
      l(i, j) = cap > 0.5 ? (std::min)(cap, 6 - pressed_mm) + wave * pressed_mm : missing;
    }
  }
  return l;
}

/// Whether two maps differ by no more than `margin`; NaN equals NaN.
template <class A, class B>
bool identical(const A& a, const B& b, double margin = 0) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) {
    return false;
  }
  for (Index i = 0; i < a.rows(); ++i) {
    for (Index j = 0; j < a.cols(); ++j) {
      const bool both_nan = std::isnan(a(i, j)) && std::isnan(b(i, j));
      if (!both_nan && !(std::abs(double(a(i, j)) - double(b(i, j))) <= margin)) {
        return false;
      }
    }
  }
  return true;
}

template <class S>
Map<S> compensated(const NeighbourLight<S>& light, const Map<S>& reference, const Map<S>& depth) {
  NeighbourLightCompensation<S> compensation(light, S(0.125), reference);
  Map<S> out(depth.rows(), depth.cols());
  REQUIRE(compensation(depth, out) == FrameStatus::ok);
  return out;
}

/// The definition: pixel by pixel over the disc, in double.
double slow_psi(const Map<double>& l, Index i, Index j, double pitch, double aspect) {
  const auto at = [&](Index r, Index c) {
    return r >= 0 && r < l.rows() && c >= 0 && c < l.cols() ? l(r, c) : missing;
  };
  const auto along = [&](double before, double here, double after) {
    if (std::isnan(before)) return after - here;
    return std::isnan(after) ? here - before : (after - before) / 2;
  };
  const double gx = along(at(i, j - 1), at(i, j), at(i, j + 1)) / pitch;
  const double gy = along(at(i - 1, j), at(i, j), at(i + 1, j)) / (aspect * pitch);
  return std::isnan(l(i, j)) ? missing : std::atan(std::hypot(gx, gy));
}

Map<double> slow_compensation(const NeighbourLight<double>& light,
                              const Map<double>& reference,
                              const Map<double>& depth,
                              double pitch) {
  const double aspect = light.pixel_aspect;
  Map<double> change(depth.rows(), depth.cols()), known(depth.rows(), depth.cols());
  for (Index i = 0; i < depth.rows(); ++i) {
    for (Index j = 0; j < depth.cols(); ++j) {
      known(i, j) = slow_psi(reference, i, j, pitch, aspect);
      change(i, j) = slow_psi(depth, i, j, pitch, aspect) - known(i, j);
    }
  }
  Map<double> out(depth.rows(), depth.cols());
  for (Index i = 0; i < depth.rows(); ++i) {
    for (Index j = 0; j < depth.cols(); ++j) {
      double sum = 0, seen = 0, all = 0;
      for (Index r = 0; r < depth.rows(); ++r) {
        for (Index c = 0; c < depth.cols(); ++c) {
          const double y = aspect * static_cast<double>(r - i), x = static_cast<double>(c - j);
          if (x * x + y * y <= static_cast<double>(light.radius_px * light.radius_px)) {
            all += std::isnan(known(r, c)) ? 0 : 1;
            seen += std::isnan(change(r, c)) ? 0 : 1;
            sum += std::isnan(change(r, c)) ? 0 : change(r, c);
          }
        }
      }
      const double risen = depth(i, j) - reference(i, j);
      const double m =
          std::isnan(risen) ? 0 : light.m0_mm_per_rad * std::exp(light.n_per_mm * risen);
      const double l = depth(i, j) - m * (seen > 0 ? sum * all / seen : 0);
      out(i, j) = l < 0 ? 0 : l;
    }
  }
  return out;
}

NeighbourLight<double> random_light(Index largest_radius_px) {
  return {test::whole(1, largest_radius_px), test::uniform(-0.004, 0.004),
          test::uniform(-0.4, 0.4)};
}

template <class S>
NeighbourLight<S> as(const NeighbourLight<double>& light) {
  return {light.radius_px, S(light.m0_mm_per_rad), S(light.n_per_mm), S(light.pixel_aspect)};
}

/// Random clumps of missing pixels.
void punch(Map<double>& l, Index clumps) {
  for (Index k = 0; k < clumps; ++k) {
    const Index i = test::whole(0, l.rows() - 1), j = test::whole(0, l.cols() - 1);
    const Index h = (std::min)(test::whole(1, 4), l.rows() - i);
    const Index w = (std::min)(test::whole(1, 4), l.cols() - j);
    l.block(i, j, h, w).setConstant(missing);
  }
}

std::string refusal(const NeighbourLight<float>& light, float pitch_mm, Index rows) {
  try {
    const Map<float> reference = Map<float>::Constant(rows, 4, 1.0F);
    NeighbourLightCompensation<> compensation(light, pitch_mm, reference);
  } catch (const parameter_error& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("neighbour light: nothing to compensate leaves the depth to the last bit") {
  rc::prop("no change of shape", [] {
    Map<double> l = membrane(37, 43, test::uniform(0, 3), test::uniform(0, 6));
    punch(l, test::whole(0, 5));
    const NeighbourLight<double> light = random_light(30);
    RC_ASSERT(identical(compensated(light, l, l), l));
    const Map<float> single = l.cast<float>();
    RC_ASSERT(identical(compensated(as<float>(light), single, single), single));
  });
  rc::prop("m0 = 0", [] {
    NeighbourLight<double> light = random_light(30);
    light.m0_mm_per_rad = 0;
    const Map<double> l = membrane(37, 43, test::uniform(0, 3), 1);
    RC_ASSERT(identical(compensated(light, membrane(37, 43, 0, 0), l), l));
  });
}

TEST_CASE("neighbour light: exact disc is the definition, with missing pixels or without") {
  rc::prop("against the definition", [] {
    Map<double> reference = membrane(29, 34, 0, 0);
    Map<double> depth = membrane(29, 34, test::uniform(0, 3), test::uniform(0, 6));
    punch(reference, test::whole(0, 3));
    punch(depth, test::whole(0, 6));
    NeighbourLight<double> light = random_light(20);
    light.pixel_aspect = *rc::gen::element(1.0, 1.25, 0.75);
    const Map<double> truth = slow_compensation(light, reference, depth, 0.125);
    const Map<double> fast = compensated(light, reference, depth);
    const Map<float> single =
        compensated<float>(as<float>(light), reference.cast<float>(), depth.cast<float>());
    const auto worse = [&](double error, double limit, Index k) {
      const bool same = std::isnan(truth(k)) && std::isnan(error);
      return !same && !(std::abs(error) <= limit);
    };
    for (Index k = 0; k < truth.size(); ++k) {
      RC_ASSERT(!worse(fast(k) - truth(k), 1e-11, k));
      RC_ASSERT(!worse(static_cast<double>(single(k)) - truth(k), 1e-4, k));
    }
  });
}

TEST_CASE("neighbour light: the pad may lie anywhere in the image and be transposed or rotated") {
  rc::prop("up to the rounding of sums", [] {
    constexpr double margin = 1e-12;
    const NeighbourLight<double> light = random_light(12);
    Map<double> reference = membrane(32, 40, 0, 0);
    Map<double> depth = membrane(32, 40, test::uniform(0, 3), test::uniform(0, 6));
    punch(depth, 3);
    const Map<double> plain = compensated(light, reference, depth);

    const Index up = test::whole(0, 20), left = test::whole(0, 20);
    const auto shifted = [&](const Map<double>& l) {
      Map<double> wide = Map<double>::Constant(64, 64, missing);
      wide.block(up, left, 32, 40) = l;
      return wide;
    };
    const Map<double> moved = compensated(light, shifted(reference), shifted(depth));
    RC_ASSERT(identical(moved, shifted(plain), margin));

    const auto transposed = [](const Map<double>& l) { return Map<double>(l.transpose()); };
    RC_ASSERT(identical(compensated(light, transposed(reference), transposed(depth)),
                        transposed(plain), margin));
    const auto rotated = [](const Map<double>& l) {
      return Map<double>(l.transpose().rowwise().reverse());
    };
    RC_ASSERT(
        identical(compensated(light, rotated(reference), rotated(depth)), rotated(plain), margin));
  });
}

TEST_CASE("neighbour light: absurd depths stay finite and harm nobody") {
  const Map<float> reference = membrane(24, 24, 0, 0).cast<float>();
  Map<float> depth = reference;
  depth(12, 12) = 3e38F;
  depth(12, 13) = -3e38F;
  depth(3, 12) = 1e-40F;
  const Map<float> out = compensated(NeighbourLight<float>{}, reference, depth);
  for (Index k = 0; k < out.size(); ++k) {
    CHECK(std::isnan(out(k)) == std::isnan(depth(k)));
    CHECK((std::isnan(out(k)) || (out(k) >= 0 && std::isfinite(out(k)))));
  }
}

TEST_CASE("neighbour light: other sizes are refused and nothing is written") {
  const Map<float> reference = Map<float>::Constant(8, 9, 1.0F);
  NeighbourLightCompensation<> compensation({}, 0.1F, reference);
  Map<float> out = Map<float>::Constant(8, 9, 7.0F);
  const Map<float> narrow = Map<float>::Constant(8, 8, 1.0F);
  CHECK(compensation(narrow, out) == FrameStatus::refused);
  CHECK(compensation.inclination_sums(narrow, out) == FrameStatus::refused);
  CHECK((out == 7.0F).all());
  Map<float> small_out = Map<float>::Constant(7, 9, 7.0F);
  CHECK(compensation(reference, small_out) == FrameStatus::refused);
  CHECK((small_out == 7.0F).all());
}

TEST_CASE("neighbour light: a frame leaves nothing behind for the next") {
  const Map<float> reference = membrane(40, 150, 0, 0).cast<float>();
  const Map<float> depth = membrane(40, 150, 2, 1).cast<float>();
  const NeighbourLight<float> light{5, 0.002F, 0.2F};
  const Map<float> expected = compensated(light, reference, depth);
  NeighbourLightCompensation<> used(light, 0.125F, reference);
  Map<float> out(40, 150);
  for (const Index j : {62, 71, 75, 88}) {  // wherever they lie in a long row
    Map<float> rough = depth;
    rough(20, j) = std::nanf("");
    REQUIRE(used(rough, out) == FrameStatus::ok);
    CHECK(identical(out, compensated(light, reference, rough)));
    CHECK_FALSE(identical(out, expected));
    REQUIRE(used(depth, out) == FrameStatus::ok);
    CHECK(identical(out, expected));
  }
}

TEST_CASE("neighbour light: samples of a smooth pad lose as much light") {
  const int step = GENERATE(2, 3, 4);
  const auto pad = [](double pressed_mm) {  // no crease: samples do not follow one
    Map<double> l(120, 144);
    for (Index i = 0; i < 120; ++i) {
      for (Index j = 0; j < 144; ++j) {
        const double x = (static_cast<double>(j) - 71.5) / 40,
                     y = (static_cast<double>(i) - 59.5) / 40;
        l(i, j) = 8 - 0.8 * (x * x + y * y) - pressed_mm * std::exp(-x * x - 1.5 * y * y);
      }
    }
    return l;
  };
  const auto means = [step](const Map<double>& l) {
    Map<double> out(l.rows() / step, l.cols() / step);
    for (Index i = 0; i < out.rows(); ++i) {
      for (Index j = 0; j < out.cols(); ++j) {
        out(i, j) = l.block(i * step, j * step, step, step).mean();
      }
    }
    return out;
  };
  const NeighbourLight<double> light{13, 0.001, 0.2};
  const Map<double> free = pad(0), pressed = pad(1);
  const Map<double> taken = means(pressed - compensated(light, free, pressed));
  NeighbourLightCompensation<double> by_samples(sampled(light, step), 0.125 * step, means(free));
  Map<double> out(taken.rows(), taken.cols());
  REQUIRE(by_samples(means(pressed), out) == FrameStatus::ok);
  const Map<double> taken_by_samples = means(pressed) - out;
  CHECK(taken.abs().maxCoeff() > 0.03);
  CHECK((taken_by_samples - taken).abs().maxCoeff() < 0.1 * taken.abs().maxCoeff());
}

TEST_CASE("neighbour light: a pixel around which nothing is seen keeps its depth") {
  const Map<float> reference = Map<float>::Constant(20, 20, 1.0F);
  Map<float> depth = Map<float>::Constant(20, 20, std::nanf(""));
  depth(9, 11) = 1.0F;
  const Map<float> out = compensated(NeighbourLight<float>{5, 0.001F, 0.2F}, reference, depth);
  CHECK(out(9, 11) == 1.0F);
}

TEST_CASE(
    "neighbour light: the unit is judged by every eighth pixel where the reference has depth") {
  const auto is_of_this_pad = [](const Map<double>& reference, const Map<double>& depth) {
    NeighbourLightCompensation<double> compensation({2, 0.0, 0.0}, 0.125, reference);
    Map<double> out(depth.rows(), depth.cols());
    return compensation(depth, out) == FrameStatus::ok;
  };
  // depth beyond the pad of the reference does not count
  Map<double> reference = Map<double>::Constant(64, 64, missing);
  reference(0, 0) = 1;
  CHECK(is_of_this_pad(reference, Map<double>::Constant(64, 64, 1)));
  CHECK_FALSE(is_of_this_pad(reference, Map<double>::Constant(64, 64, 21)));
  // an image of eight columns has one such pixel in its first row; the next lies a row below
  reference = Map<double>::Constant(2, 8, 1);
  Map<double> depth = reference;
  depth(1, 0) = 100;
  CHECK(is_of_this_pad(reference, depth));
}

TEST_CASE("neighbour light: bad parameters are refused by name, value and range") {
  CHECK(refusal({}, 0.1F, 4) == "accepted");
  CHECK(refusal({0, 0.1F, 0.1F}, 0.1F, 4) == "NeighbourLight: radius_px = 0, must be in [1, 1000]");
  CHECK(refusal({5, std::nanf(""), 0.1F}, 0.1F, 4) ==
        "NeighbourLight: m0_mm_per_rad = nan, must be finite");
  CHECK(refusal({5, 0.1F, INFINITY}, 0.1F, 4) == "NeighbourLight: n_per_mm = inf, must be finite");
  CHECK(refusal({5, 0.1F, 0.1F, 0}, 0.1F, 4) ==
        "NeighbourLight: pixel_aspect = 0, must be in [0.1, 10]");
  CHECK(refusal({}, 0, 4) == "NeighbourLightCompensation: pitch_mm = 0, must be finite and > 0");
  CHECK(refusal({}, 0.1F, 0) == "NeighbourLightCompensation: rows = 0, must be in [1, 1000000]");
}

TEST_CASE("quick functions of float keep their bounds") {
  double exp_error = 0, angle_error = 0;
  for (int k = -100000; k <= 100000; ++k) {
    const float x = static_cast<float>(k) / 10000;
    const double truth = std::exp(static_cast<double>(x));
    exp_error =
        (std::max)(exp_error, std::abs(static_cast<double>(detail::quick_exp(x)) / truth - 1));
    const float slope_sq = std::exp(x);
    const double angle = std::atan(std::sqrt(static_cast<double>(slope_sq)));
    angle_error = (std::max)(angle_error,
                             std::abs(static_cast<double>(detail::inclination(slope_sq)) - angle));
  }
  CAPTURE(exp_error, angle_error);
  CHECK(exp_error < 1e-6);
  CHECK(angle_error < 4e-7);
  CHECK(detail::inclination(0.0F) == 0.0F);
  CHECK(detail::inclination(INFINITY) == Approx(1.5707963F));
  CHECK(std::isfinite(detail::inclination(std::nanf(""))));
  CHECK(detail::quick_exp(0.0F) == 1.0F);
  for (const float x : {1e30F, -1e30F, INFINITY, -INFINITY, std::nanf("")}) {
    CHECK(std::isfinite(detail::quick_exp(x)));
  }
}

TEST_CASE("quick functions of a vector are those of each number") {
  std::vector<float> x;
  for (int k = -2000; k <= 2000; ++k) {
    x.push_back(static_cast<float>(k) / 17);
  }
  x.insert(x.end(), {1e30F, -1e30F, INFINITY, -INFINITY, std::nanf(""), 0.0F, -0.0F, 1e-40F});
  x.resize((x.size() + 63) / 64 * 64);
  std::vector<float> power(x.size()), angle(x.size());
  detail::for_each_cell<float>(static_cast<Index>(x.size()), [&]<class V>(Index j) {
    const V numbers = detail::load_cells<V, float>(x.data() + j);
    detail::store_cells<float>(power.data() + j, detail::quick_exp(numbers));
    detail::store_cells<float>(angle.data() + j, detail::inclination(V(numbers * numbers)));
  });
  for (std::size_t j = 0; j < x.size(); ++j) {
    CAPTURE(x[j]);
    CHECK(power[j] == detail::quick_exp(x[j]));
    CHECK(angle[j] == detail::inclination(x[j] * x[j]));
  }
}

TEST_CASE("neighbour light: a frame allocates nothing") {
  using namespace fingerpad;
  std::vector<float> reference(48 * 64, 1.0F), depth(48 * 64, 2.0F);
  depth[1000] = std::nanf("");
  const StridedView<float> reference_view(reference.data(), 48, 64, 64);
  const StridedView<float> view(depth.data(), 48, 64, 64);
  NeighbourLightCompensation<> compensation({}, 0.1F, reference_view);
  const long before = test::allocations();
  for (int frame = 0; frame < 3; ++frame) {
    (void)compensation(view, view);
  }
  const long after = test::allocations();
  CHECK(before > 0);
  CHECK(after == before);
}
