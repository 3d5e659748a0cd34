// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// load_trials: evaluates how well the motion of a pad's dots gives the tangential force, for loads
// left out of the calibration. See --help.
#include <CLI/CLI.hpp>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "common/failure.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "loads.hpp"

namespace {

using fingerpad::ForceSample;
using fingerpad::Point2;
using load_trials::Load;

using Samples = std::vector<ForceSample<double>>;

/// Mean displacement of the dots over all repeats, in px.
Samples samples_of(const std::vector<Load>& loads, const fingerpad::ShiftOptions& options) {
  Samples samples;
  for (const Load& load : loads) {
    fingerpad::ContactShift shift(load.from, options);
    const cv::Mat_<unsigned char> all(load.to.size(), static_cast<unsigned char>(1));
    const auto moved = shift(load.to, all);
    samples.push_back({.measure = 1,
                       .displacement_mm = moved.displacement,
                       .tangential_force_n = {load.fx_n, load.fz_n},
                       .load = static_cast<int>(samples.size())});
  }
  return samples;
}

/// Least-squares line of force over displacement along the same axis.
struct Lines {
  Point2<double> slope;
  Point2<double> at_zero;
  Point2<double> operator()(const Point2<double>& d) const {
    return {slope.x * d.x + at_zero.x, slope.y * d.y + at_zero.y};
  }
};
Lines fit_lines(std::span<const ForceSample<double>> samples) {
  const auto line = [&](double Point2<double>::*axis) {
    double n = 0, mean_d = 0, mean_f = 0, dd = 0, df = 0;
    for (const auto& s : samples) {
      n += 1;
      mean_d += (s.displacement_mm.*axis - mean_d) / n;
      mean_f += (s.tangential_force_n.*axis - mean_f) / n;
    }
    for (const auto& s : samples) {
      const double off = s.displacement_mm.*axis - mean_d;
      dd += off * off;
      df += off * (s.tangential_force_n.*axis - mean_f);
    }
    return Point2<double>{df / dd, mean_f - df / dd * mean_d};
  };
  const auto x = line(&Point2<double>::x);
  const auto y = line(&Point2<double>::y);
  return {{x.x, y.x}, {x.y, y.y}};
}

/// Mean absolute error of one component, with each load left out once.
template <class Fit>
double left_out_error(const Samples& samples, const Fit& fit, double Point2<double>::*axis) {
  const auto error = [&](const auto& map, const ForceSample<double>& s) {
    return map(s.displacement_mm).*axis - s.tangential_force_n.*axis;
  };
  return fingerpad::leave_one_load_out(std::span<const ForceSample<double>>(samples), fit, error)
      .mean_abs;
}

/// Displacements of all loads, and of those tilted about one axis only.
struct Displaced {
  Samples single;
  Samples all;
};

Displaced displaced(const std::vector<Load>& loads, const fingerpad::ShiftOptions& options) {
  std::vector<Load> single;
  std::copy_if(loads.begin(), loads.end(), std::back_inserter(single),
               [](const Load& load) { return load.single_axis; });
  return {samples_of(single, options), samples_of(loads, options)};
}

template <class Fit>
void print_row(const char* name, const Displaced& samples, const Fit& fit) {
  std::printf("%-38s", name);
  for (const Samples* some : {&samples.single, &samples.all}) {
    std::printf(" %10.3f %8.3f", left_out_error(*some, fit, &Point2<double>::x),
                left_out_error(*some, fit, &Point2<double>::y));
  }
  std::printf("\n");
}

/// F = K d + offset by least squares, or by Huber's loss, for each component.
auto linear_map(bool robust) {
  return [robust](std::span<const ForceSample<double>> samples) {
    const auto n = static_cast<Eigen::Index>(samples.size());
    Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(n, 3), forces(n, 2), fit(3, 2);
    for (Eigen::Index i = 0; i < n; ++i) {
      const ForceSample<double>& s = samples[static_cast<std::size_t>(i)];
      columns.row(i).head(2) << s.displacement_mm.x, s.displacement_mm.y;
      forces.row(i) << s.tangential_force_n.x, s.tangential_force_n.y;
    }
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      Eigen::VectorXd root = Eigen::VectorXd::Ones(n);  // of the weights
      for (int pass = 0; pass < (robust ? 100 : 1); ++pass) {
        fit.col(axis) = (root.asDiagonal() * columns)
                            .colPivHouseholderQr()
                            .solve(root.cwiseProduct(forces.col(axis)));
        const Eigen::VectorXd off = (forces.col(axis) - columns * fit.col(axis)).cwiseAbs();
        Eigen::VectorXd sorted = off;
        std::sort(sorted.data(), sorted.data() + n);
        const double sd =
            1.4826 * sorted(n / 2) * std::sqrt(static_cast<double>(n) / static_cast<double>(n - 3));
        root = (1.345 * sd / off.array().max(1e-12)).min(1).sqrt();
      }
    }
    return [fit](const Point2<double>& d) {
      return Point2<double>{fit(0, 0) * d.x + fit(1, 0) * d.y + fit(2, 0),
                            fit(0, 1) * d.x + fit(1, 1) * d.y + fit(2, 1)};
    };
  };
}

int run(const std::string& folder, double threshold) {
  const std::vector<Load> loads = load_trials::loads_of(folder);
  const Displaced robust =
      displaced(loads, {.edge_dots = false, .robust_passes = 10, .threshold = threshold});
  const Displaced plain = displaced(loads, {.edge_dots = false});
  std::printf(
      "%zu loads tilted about one axis, %zu in all. Each load is left out of the fit once.\n"
      "Mean absolute error in N                one axis: fx       fz    all: fx       fz\n",
      robust.single.size(), robust.all.size());
  print_row("robust mean, robust linear map", robust, linear_map(true));
  print_row("robust mean, linear map", robust, linear_map(false));
  print_row("robust mean, a line for each axis", robust, fit_lines);
  print_row("plain mean, robust linear map", plain, linear_map(true));
  print_row("plain mean, linear map", plain, linear_map(false));
  print_row("plain mean, a line for each axis", plain, fit_lines);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Evaluates the force along a pad that is computed from the displacements of its dots.\n"
      "FOLDER contains a .json file for each load, with the force along the pad (fx, fz, in N), "
      "the\n"
      "tilt angles from which it was computed (thetax, thetaz) and, for each repeat,\n"
      "MoveData[].BlobMoves[] = [x, y, size, dx, dy, dsize] in px.\n"
      "Each load is predicted by a calibration with all others: first among the loads that are\n"
      "tilted about one axis, whose forces are exact, then among all. The linear map computes "
      "both\n"
      "forces from both displacements, with offsets. Robust means Huber's loss, against stuck or\n"
      "mismatched dots and against outlying loads.");
  std::string folder;
  app.add_option("FOLDER", folder, "folder of the loads")->required();
  // normal errors in the plane exceed it as often as 1.345 on a line: 18 %
  double threshold = 1.86;
  app.add_option("--threshold", threshold, "threshold of the robust mean, in standard deviations")
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return run(folder, threshold);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "load_trials: %s\n", error.what());
    return 1;
  }
}
