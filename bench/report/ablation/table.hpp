// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Scenes, errors with and without an effect, cost of the effect, and their output.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

namespace bench::ablation {

enum class Scene {
  free,
  press,
  drag,
  reversal,
  twist,
  normal_force_change,
  rolling,
  wedge,
  tilted,
  noisy,
  dots_lost,
};
inline constexpr std::size_t scene_count = 11;

inline const char* name_of(std::size_t scene) {
  constexpr std::array<const char*, scene_count> names = {
      "free",    "press", "drag",   "reversal", "twist",    "normal force change",
      "rolling", "wedge", "tilted", "noisy",    "dots lost"};
  return names[scene];
}

/// Absolute errors. NaN means no answer and counts only in `missing()`.
class Errors {
 public:
  void add(double error) {
    if (std::isnan(error)) {
      ++missing_;
    } else {
      errors_.push_back(std::abs(error));
    }
  }
  void add(const Errors& other) {
    errors_.insert(errors_.end(), other.errors_.begin(), other.errors_.end());
    missing_ += other.missing_;
  }
  bool any() const { return !errors_.empty(); }
  /// Share of the cases without an answer.
  double missing() const {
    const double all = static_cast<double>(missing_ + errors_.size());
    return all > 0 ? static_cast<double>(missing_) / all : 0;
  }
  double quantile(double share) const {
    std::vector<double> e = errors_;
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(e.size() - 1) + 0.5);
    std::nth_element(e.begin(), e.begin() + at, e.end());
    return e[static_cast<std::size_t>(at)];
  }

 private:
  std::vector<double> errors_;
  std::size_t missing_ = 0;
};

/// An effect, on ("with") and off ("without"), and one quantity that it improves.
struct Effect {
  std::string name = {};
  std::string quantity = {};
  std::string unit = {};
  std::string on = {};   ///< policies, as in code
  std::string off = {};  ///< policies, as in code
  double cost_us = 0;
  std::array<Errors, scene_count> with{};
  std::array<Errors, scene_count> without{};

  Errors& with_in(Scene scene) { return with[static_cast<std::size_t>(scene)]; }
  Errors& without_in(Scene scene) { return without[static_cast<std::size_t>(scene)]; }
  bool has(std::size_t scene) const { return with[scene].any() || without[scene].any(); }
};

/// Cost of an effect in us per frame: time of `with` minus time of `without`, each of `frames`
/// frames, as the best of many alternating rounds. 0 where the difference is below 2 % or below the
/// difference between the two halves of the rounds.
template <class With, class Without>
double cost_us(const With& with, const Without& without, double frames = 1) {
  using Clock = std::chrono::steady_clock;
  const auto time_us = [](const auto& work) {
    const auto start = Clock::now();
    work();
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  };
  const double first_us = time_us(with) + time_us(without);
  const int rounds = static_cast<int>(std::clamp(1.2e6 / first_us, 30.0, 400.0));
  double best[2][2] = {{1e30, 1e30}, {1e30, 1e30}};
  for (int round = 0; round < rounds; ++round) {
    const int half = round % 2;
    best[half][0] = (std::min)(best[half][0], time_us(with));
    best[half][1] = (std::min)(best[half][1], time_us(without));
  }
  const double on = (std::min)(best[0][0], best[1][0]);
  const double off = (std::min)(best[0][1], best[1][1]);
  const double noise = (std::max)({std::abs(best[0][0] - best[1][0]),
                                   std::abs(best[0][1] - best[1][1]), 0.02 * (std::min)(on, off)});
  return std::abs(on - off) <= noise ? 0 : (on - off) / frames;
}

/// Two significant digits without an exponent; 0 below 0.00005.
inline std::string number(double x) {
  std::ostringstream text;
  if (std::abs(x) < 5e-5) {
    return "0";
  }
  const int before = static_cast<int>(std::floor(std::log10(std::abs(x)))) + 1;
  text.setf(std::ios::fixed);
  text.precision((std::clamp)(2 - before, 0, 4));
  text << x;
  return text.str();
}

inline std::string cell(const Effect& e, std::size_t scene, double share) {
  const auto text = [&](const Errors& errors) {
    return errors.any() ? number(errors.quantile(share)) : std::string("no answer");
  };
  return e.has(scene) ? text(e.with[scene]) + " / " + text(e.without[scene]) : std::string();
}

/// One Markdown table of a quantile of the errors, with the effect / without it.
inline void print_table(std::ostream& out, const std::vector<Effect>& effects, double share) {
  out << "| Effect: error of |";
  for (std::size_t s = 0; s < scene_count; ++s) {
    out << ' ' << name_of(s) << " |";
  }
  out << " cost, us per frame |\n|---|";
  for (std::size_t s = 0; s <= scene_count; ++s) {
    out << "--:|";
  }
  out << '\n';
  for (const Effect& e : effects) {
    out << "| **" << e.name << "**: " << e.quantity << ", " << e.unit << " |";
    for (std::size_t s = 0; s < scene_count; ++s) {
      out << ' ' << cell(e, s, share) << (cell(e, s, share).empty() ? "|" : " |");
    }
    out << ' ' << number(e.cost_us) << " |\n";
  }
}

/// Effects with more than one missing answer in a hundred, which the errors above leave out.
inline void print_missing(std::ostream& out, const std::vector<Effect>& effects) {
  out << "| No answer, per cent | with | without |\n|---|--:|--:|\n";
  const auto percent = [](const Errors& errors) { return number(100 * errors.missing()); };
  for (const Effect& e : effects) {
    for (std::size_t s = 0; s < scene_count; ++s) {
      if ((std::max)(e.with[s].missing(), e.without[s].missing()) > 0.01) {
        out << "| " << e.name << ", " << e.quantity << ": " << name_of(s) << " | "
            << percent(e.with[s]) << " | " << percent(e.without[s]) << " |\n";
      }
    }
  }
  out << '\n';
}

/// Policies of each effect, on and off.
inline void print_policies(std::ostream& out, const std::vector<Effect>& effects) {
  out << "| Effect | on | off |\n|---|---|---|\n";
  std::string last;
  for (const Effect& e : effects) {
    if (e.name != last) {
      out << "| " << e.name << " | " << e.on << " | " << e.off << " |\n";
    }
    last = e.name;
  }
}

inline void print_csv(std::ostream& out, const std::vector<Effect>& effects) {
  out << "effect,scene,quantity,unit,with_median,without_median,with_99,without_99,cost_us\n";
  const auto value = [&](const Errors& errors, double share) {
    if (errors.any()) {
      out << errors.quantile(share);
    }
    out << ',';
  };
  for (const Effect& e : effects) {
    for (std::size_t s = 0; s < scene_count; ++s) {
      if (e.has(s)) {
        out << e.name << ',' << name_of(s) << ',' << e.quantity << ',' << e.unit << ',';
        value(e.with[s], 0.5);
        value(e.without[s], 0.5);
        value(e.with[s], 0.99);
        value(e.without[s], 0.99);
        out << e.cost_us << '\n';
      }
    }
  }
}

}  // namespace bench::ablation
