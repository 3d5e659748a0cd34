// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "resampling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <utility>

#include "common/csv_cells.hpp"
#include "common/failure.hpp"
#include "fingerpad/core/check.hpp"
#include "trials.hpp"

namespace replay_many {
namespace {

constexpr int resamples_of_unit = 500;
constexpr double none = std::numeric_limits<double>::quiet_NaN();
const std::vector<std::string> kinds = {"bootstrap", "monte_carlo"};

std::string in_digits(double value) {
  char text[32] = "";
  if (std::isfinite(value)) {
    std::snprintf(text, sizeof text, "%.17g", value);
  }
  return text;
}

/// Seed of a resample, independent of the process that runs it.
std::uint64_t seed_of(const std::string& name, const std::string& kind, int resample) {
  std::uint64_t seed = 14695981039346656037U;  // FNV-1a
  for (const char c : name + "/" + kind + "/" + std::to_string(resample)) {
    seed = (seed ^ static_cast<unsigned char>(c)) * 1099511628211U;
  }
  return seed;
}

/// Mean and covariance over the resamples with a result.
struct Moments {
  int answers = 0, refused = 0;
  std::vector<double> mean, told;  ///< told: mean of the variances reported by the fits
  std::vector<std::vector<double>> covariance;

  Moments(const std::vector<Path>& files, std::size_t parameters)
      : mean(parameters, 0),
        told(parameters, 0),
        covariance(parameters, std::vector<double>(parameters, 0)) {
    for (const Path& file : files) {
      std::ifstream table(file);
      std::string line;
      if (!std::getline(table, line)) {
        replay::fail(file, "is missing");
      }
      while (std::getline(table, line)) {
        add(replay::cells_of(line));
      }
    }
    for (auto& row : covariance) {
      for (double& cell : row) {
        cell /= answers - 1;
      }
    }
  }

 private:
  void add(const std::vector<std::string>& cells) {
    std::vector<double> off;  // cells: the resample, its parameters, their variances
    for (std::size_t k = 0; k < mean.size(); ++k) {
      off.push_back(std::strtod(cells.at(k + 1).c_str(), nullptr) - mean[k]);
      if (cells[k + 1].empty()) {
        ++refused;
        return;
      }
    }
    ++answers;
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] += off[i] / answers;
      const std::string& cell = cells.at(1 + mean.size() + i);
      const double variance = cell.empty() ? none : std::strtod(cell.c_str(), nullptr);
      told[i] += (variance - told[i]) / answers;
      for (std::size_t j = 0; j < mean.size(); ++j) {
        covariance[i][j] += off[i] * off[j] * (answers - 1) / answers;  // Welford
      }
    }
  }
};

}  // namespace

Resampling::Resampling(Path out, std::vector<std::string> names, int resamples)
    : out_(std::move(out)), names_(std::move(names)), resamples_(resamples) {
  if (names_.empty()) {
    names_ = trial_names();
  }
  for (const std::string& name : names_) {
    (void)trial_of(name);
  }
}

std::vector<Path> Resampling::files(const std::string& name, const std::string& kind) const {
  std::vector<Path> all;
  for (int first = 0; first < resamples_; first += resamples_of_unit) {
    const int last = (std::min)(first + resamples_of_unit, resamples_);
    all.push_back(out_ / "resamples" / name / kind /
                  (std::to_string(first) + "-" + std::to_string(last) + ".csv"));
  }
  return all;
}

std::vector<Unit> Resampling::left() const {
  std::vector<Unit> units;
  for (const std::string& name : names_) {
    const double weight = trial_of(name).weight;
    for (const std::string& kind : kinds) {
      make_folders(out_ / "resamples" / name / kind);
      int first = 0;
      for (const Path& file : files(name, kind)) {
        const int last = (std::min)(first + resamples_of_unit, resamples_);
        if (!std::filesystem::exists(file)) {
          units.push_back({name + " " + kind,
                           {"resamples", name, out_.string(), kind, std::to_string(first),
                            std::to_string(last), file.string()},
                           weight * (last - first)});
        }
        first = last;
      }
    }
  }
  return units;
}

Job Resampling::job() const {
  Job job;
  job.noun = "parts";
  job.done = [](const Unit&) { return std::vector<Unit>(); };
  job.failed = [](const Unit& unit, const std::string& reason) { replay::fail(unit.name, reason); };
  job.is_there = [](const Unit&) { return true; };
  return job;
}

void Resampling::write_covariance() const {
  std::string text =
      "calibration,row,column,truth,estimate,analytic,bootstrap,monte_carlo,monte_carlo_analytic,"
      "bootstrap_mean,monte_carlo_mean,bootstrap_refused,monte_carlo_refused\n";
  for (const std::string& name : names_) {
    const Trial trial = trial_of(name);
    const std::size_t size = trial.parameters.size();
    const Moments bootstrap(files(name, "bootstrap"), size);
    const Moments monte_carlo(files(name, "monte_carlo"), size);
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = i; j < size; ++j) {
        text += name + "," + trial.parameters[i] + "," + trial.parameters[j];
        for (const double value :
             {i == j ? trial.truth[i] : none, i == j ? trial.once.values[i] : none,
              trial.once.covariance[i][j], bootstrap.covariance[i][j], monte_carlo.covariance[i][j],
              i == j ? monte_carlo.told[i] : none, i == j ? bootstrap.mean[i] : none,
              i == j ? monte_carlo.mean[i] : none}) {
          text += ',';
          text += in_digits(value);
        }
        for (const int refused : {bootstrap.refused, monte_carlo.refused}) {
          text += ',';
          text += std::to_string(refused);
        }
        text += '\n';
      }
    }
  }
  write_file(out_ / "covariance.csv", text);
}

void do_resamples(const std::vector<std::string>& arguments) {
  const std::string& name = arguments.at(1);
  const std::string& kind = arguments.at(3);
  const Path place = arguments.at(6);
  const Trial trial = trial_of(name);
  const auto& once_more = kind == "bootstrap" ? trial.bootstrap : trial.monte_carlo;
  std::string text = "resample";
  for (const std::string& parameter : trial.parameters) {
    text += ',';
    text += parameter;
  }
  for (const std::string& parameter : trial.parameters) {
    text += ",variance of " + parameter;
  }
  text += "\n";
  const int last = std::stoi(arguments.at(5));
  for (int k = std::stoi(arguments.at(4)); k < last; ++k) {
    Chance chance(seed_of(name, kind, k));
    const std::size_t size = trial.parameters.size();
    std::vector<double> values(2 * size, none);
    try {
      const Estimate estimate = once_more(chance);
      for (std::size_t i = 0; i < size; ++i) {
        values[i] = estimate.values[i];
        values[size + i] = estimate.covariance[i][i];
      }
    } catch (const fingerpad::parameter_error&) {  // refused: no values
    }
    text += std::to_string(k);
    for (const double value : values) {
      text += ',';
      text += in_digits(value);
    }
    text += "\n";
  }
  write_file(place, text);
}

}  // namespace replay_many
