// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// JSON files whose objects have known keys. An unknown key is refused with its name, a missing key
// with its purpose, and a value of the wrong type with the expected type.
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/failure.hpp"
#include "fingerpad/core/check.hpp"

namespace replay {

/// A key that an object may have.
struct JsonKey {
  std::string name;
  std::string purpose;  ///< shown in the error message for a missing key
};

/// One object of the file and the keys that it may have.
class JsonSection {
 public:
  JsonSection(const std::filesystem::path& file,
              std::string name,
              const nlohmann::json& object,
              std::vector<JsonKey> keys)
      : file_(file), name_(std::move(name)), object_(object), keys_(std::move(keys)) {
    if (!object_.is_object()) {
      fail(file_, (name_.empty() ? "the whole file" : name_) + " is " + kind(object_) +
                      ", must be an object { ... }");
    }
    for (const auto& item : object_.items()) {
      if (find(item.key()) == nullptr) {
        fail(file_, "unknown key " + full_name(item.key()) + " (known keys: " + known() + ")");
      }
    }
  }

  bool has(const std::string& key) const { return object_.contains(key); }

  const nlohmann::json& at(const std::string& key) const {
    if (!has(key)) {
      fail(file_, full_name(key) + " is missing (" + find(key)->purpose + ")");
    }
    return object_.at(key);
  }

  JsonSection section(const std::string& key, std::vector<JsonKey> keys) const {
    return {file_, full_name(key), at(key), std::move(keys)};
  }

  double number(const std::string& key) const {
    const nlohmann::json& found = at(key);
    if (!found.is_number()) {
      refuse_type(key, found, "a number");
    }
    return found.get<double>();
  }

  double positive(const std::string& key) const {
    const double found = number(key);
    if (!(found > 0)) {
      fail(file_, full_name(key) + " = " + at(key).dump() + ", must be > 0");
    }
    return found;
  }

  int positive_integer(const std::string& key) const { return integer(key, 1); }

  int integer(const std::string& key, int least, int most = std::numeric_limits<int>::max()) const {
    const nlohmann::json& found = at(key);
    if (!found.is_number_integer()) {
      refuse_type(key, found, "a whole number");
    }
    const double found_value = found.get<double>();
    if (!(found_value >= least && found_value <= most)) {
      const bool bounded = most < std::numeric_limits<int>::max();
      fail(file_, full_name(key) + " = " + found.dump() + ", must be " +
                      (bounded ? std::to_string(least) + " to " + std::to_string(most)
                               : ">= " + std::to_string(least) + " and fit into 32 bits"));
    }
    return found.get<int>();
  }

  bool truth(const std::string& key) const {
    const nlohmann::json& found = at(key);
    if (!found.is_boolean()) {
      refuse_type(key, found, "true or false");
    }
    return found.get<bool>();
  }

  std::string one_of(const std::string& key, const std::vector<std::string>& words) const {
    const nlohmann::json& found = at(key);
    for (const std::string& word : words) {
      if (found.is_string() && found.get<std::string>() == word) {
        return word;
      }
    }
    std::string must;
    for (const std::string& word : words) {
      must += (must.empty() ? "\"" : " or \"") + word + "\"";
    }
    refuse_type(key, found, must.c_str());
  }

  [[noreturn]] void refuse(const std::string& why) const {
    fail(file_, name_ + ": " + why + " (known keys: " + known() + ")");
  }
  /// Runs `check`; throws Failure with this section's name for a parameter_error.
  template <class Check>
  void check(const Check& check) const {
    try {
      check();
    } catch (const fingerpad::parameter_error& error) {
      fail(file_, name_ + ": " + error.what());
    }
  }

  std::string path(const std::string& key) const {
    const nlohmann::json& found = at(key);
    if (!found.is_string() || found.get<std::string>().empty()) {
      refuse_type(key, found, "the path of a file");
    }
    return found.get<std::string>();
  }

  /// The numbers of a JSON array, padded with zeros to `Most`.
  template <std::size_t Most>
  std::array<double, Most> numbers(const std::string& key) const {
    const nlohmann::json& found = at(key);
    const auto is_number = [](const nlohmann::json& entry) { return entry.is_number(); };
    if (!found.is_array() || found.empty() || found.size() > Most ||
        !std::all_of(found.begin(), found.end(), is_number)) {
      refuse_type(key, found,
                  (Most == 1 ? std::string("one number [x]")
                             : "1 to " + std::to_string(Most) + " numbers [...]")
                      .c_str());
    }
    std::array<double, Most> numbers{};
    std::copy(found.begin(), found.end(), numbers.begin());
    return numbers;
  }

  /// `size` rows of `size` numbers.
  std::vector<std::vector<double>> square(const std::string& key, std::size_t size) const {
    const nlohmann::json& found = at(key);
    std::vector<std::vector<double>> rows;
    try {
      rows = found.get<std::vector<std::vector<double>>>();
    } catch (const nlohmann::json::exception&) {
      rows.clear();
    }
    if (rows.size() != size || std::any_of(rows.begin(), rows.end(),
                                           [&](const auto& row) { return row.size() != size; })) {
      const std::string count = std::to_string(size);
      refuse_type(key, found, (count + " rows of " + count + " numbers [[...], ...]").c_str());
    }
    return rows;
  }

  std::pair<double, double> pair(const std::string& key) const {
    const nlohmann::json& found = at(key);
    if (!found.is_array() || found.size() != 2 || !found[0].is_number() || !found[1].is_number()) {
      refuse_type(key, found, "two numbers [x, y]");
    }
    return {found[0].get<double>(), found[1].get<double>()};
  }

 private:
  static std::string kind(const nlohmann::json& value) {
    const std::string type = value.type_name();
    return (type == "array" || type == "object" ? "an " : type == "null" ? "" : "a ") + type;
  }
  const JsonKey* find(const std::string& name) const {
    for (const JsonKey& key : keys_) {
      if (key.name == name) {
        return &key;
      }
    }
    return nullptr;
  }
  std::string full_name(const std::string& key) const {
    return name_.empty() ? key : name_ + "." + key;
  }
  std::string known() const {
    std::string list;
    for (const JsonKey& key : keys_) {
      list += (list.empty() ? "" : ", ") + key.name;
    }
    return list;
  }
  [[noreturn]] void refuse_type(const std::string& key,
                                const nlohmann::json& found,
                                const char* must) const {
    fail(file_, full_name(key) + " is " + found.dump() + " (" + kind(found) + "), must be " + must);
  }

  const std::filesystem::path& file_;
  std::string name_;
  const nlohmann::json& object_;
  std::vector<JsonKey> keys_;
};

inline nlohmann::json parse_json(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) {
    fail(file,
         "cannot be read (every recording has this file; it describes the sensor; {} for dots "
         "alone)");
  }
  try {
    return nlohmann::json::parse(stream);
  } catch (const nlohmann::json::exception& error) {
    const std::string what = error.what();  // "[json.exception.parse_error.101] parse error at ..."
    const auto start = what.find("] ");
    fail(file, start == std::string::npos ? what : what.substr(start + 2));
  }
}

}  // namespace replay
