// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "events.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <set>

#include "common/median.hpp"

namespace slip_trials {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double quiet_share = 0.95;

struct Warnings {
  int slips = 0, warned = 0;  // warned: above the threshold before contact is lost
  int holds = 0, false_alarms = 0;
  int lead_frames = 0;  // median over the warned, from warning to loss
};

struct Found {
  Warnings warnings;
  std::vector<int> leads;
};

Found look(const std::vector<Event>& events, const std::string& object, double threshold) {
  Found found;
  for (const Event& event : events) {
    if (event.object != object) {
      continue;
    }
    const auto at = std::find_if(event.measure.begin(), event.measure.end(),
                                 [&](double value) { return value > threshold; });
    const auto first = static_cast<std::size_t>(at - event.measure.begin());
    if (event.slips) {
      ++found.warnings.slips;
      if (first < event.end) {
        ++found.warnings.warned;
        found.leads.push_back(static_cast<int>(event.end - first));
      }
    } else {
      ++found.warnings.holds;
      found.warnings.false_alarms += at != event.measure.end() ? 1 : 0;
    }
  }
  return found;
}

/// "-" if `value` is not finite.
std::string number(double value) {
  char text[32] = "-";
  if (std::isfinite(value)) {
    std::snprintf(text, sizeof text, "%.3f", value);
  }
  return text;
}

void print_line(const std::string& name,
                const Warnings& w,
                double roc_area,
                const std::string& threshold) {
  std::printf("  %-28s %6s  %3d / %-3d  %4d  %6d / %-3d  %s\n", name.c_str(),
              number(roc_area).c_str(), w.warned, w.slips, w.lead_frames, w.false_alarms, w.holds,
              threshold.c_str());
}

std::vector<Event> of_object(const std::vector<Event>& events, const std::string& object) {
  std::vector<Event> found;
  std::copy_if(events.begin(), events.end(), std::back_inserter(found),
               [&](const Event& event) { return event.object == object; });
  return found;
}

/// The value below which 95 % of the holds of all other objects stay; NaN if there are none.
double threshold_without(const std::vector<Event>& events, const std::string& object) {
  std::vector<double> quiet;
  for (const Event& event : events) {
    if (!event.slips && event.object != object) {
      quiet.push_back(event.largest());
    }
  }
  if (quiet.empty()) {
    return none;
  }
  std::sort(quiet.begin(), quiet.end());
  const auto at = static_cast<std::size_t>(quiet_share * static_cast<double>(quiet.size()));
  return quiet[(std::min)(at, quiet.size() - 1)];
}

template <class ThresholdOf>
Found look_at_all(const std::vector<Event>& events, bool each, const ThresholdOf& threshold_of) {
  std::set<std::string> objects;
  for (const Event& event : events) {
    objects.insert(event.object);
  }
  Found all;
  for (const std::string& object : objects) {
    const double threshold = threshold_of(object);
    const Found found = look(events, object, threshold);
    all.warnings.slips += found.warnings.slips;
    all.warnings.warned += found.warnings.warned;
    all.warnings.holds += found.warnings.holds;
    all.warnings.false_alarms += found.warnings.false_alarms;
    all.leads.insert(all.leads.end(), found.leads.begin(), found.leads.end());
    if (each) {
      Warnings one = found.warnings;
      one.lead_frames = replay::median_of(found.leads);
      print_line(object, one, roc_area(of_object(events, object)), number(threshold));
    }
  }
  all.warnings.lead_frames = replay::median_of(all.leads);
  return all;
}

}  // namespace

double Event::largest() const {
  double largest = none;
  for (const double value : measure) {
    largest = std::fmax(largest, value);
  }
  return std::isfinite(largest) ? largest : 0;
}

double roc_area(const std::vector<Event>& events) {
  double won = 0;
  double pairs = 0;
  for (const Event& slip : events) {
    for (const Event& hold : events) {
      if (slip.slips && !hold.slips) {
        const double difference = slip.largest() - hold.largest();
        won += difference > 0 ? 1.0 : difference == 0 ? 0.5 : 0.0;
        ++pairs;
      }
    }
  }
  return pairs > 0 ? won / pairs : none;
}

void print_events(const std::string& name, const std::vector<Event>& events, double own) {
  const double area = roc_area(events);
  std::printf("\n%s\n", name.c_str());
  std::printf("  %-28s %6s  %9s  %4s  %12s  %s\n", "object", "AUC", "warned", "lead", "false",
              "threshold");
  const auto by_others = [&](const std::string& object) {
    return threshold_without(events, object);
  };
  if (std::isfinite(by_others(events.front().object))) {
    print_line("all", look_at_all(events, true, by_others).warnings, area,
               "from the holds of other objects");
  }
  if (std::isfinite(own)) {
    const auto same = [&](const std::string&) { return own; };
    print_line("all", look_at_all(events, false, same).warnings, area,
               number(own) + ", default of the method");
  }
}

}  // namespace slip_trials
