// Settings of the methods of this room by name (`rayloc replay --baseline KEY=VALUE`). Parsing,
// limits and the text of --help come from these tables.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "engine/base/expected.h"

namespace rayloc {

// By BaselineSetting::key. A missing key has the setting's default.
using BaselineValues = std::map<std::string, std::variant<double, std::string>, std::less<>>;

struct BaselineSetting {
  std::string_view key;
  std::string_view meaning;  // with the unit
  double standard = 0.0;     // default of a number
  double min = 0.0;
  double max = 0.0;
  bool is_whole = false;
  std::span<const std::string_view> choices = {};  // of a word; the first is the default
};

// Value from a method's table. REQUIRES: the table has that key.
double number_of(std::span<const BaselineSetting> table,
                 const BaselineValues& values,
                 std::string_view key);
// Index in BaselineSetting::choices.
std::size_t choice_of(std::span<const BaselineSetting> table,
                      const BaselineValues& values,
                      std::string_view key);

// A number or a word in the form of the command line.
std::string setting_text(std::span<const BaselineSetting> table,
                         const BaselineValues& values,
                         std::string_view key);

// Parses "KEY=VALUE" of the command line into `values`. Errors (kUsage) name the nearest key, or
// the permitted values.
Expected<void> read_baseline_value(std::string_view assignment,
                                   std::string_view method,
                                   std::span<const BaselineSetting> table,
                                   BaselineValues& values);

// One line per key: "frames=10   at most, of a burst at an access point".
std::string baseline_settings_help(std::span<const BaselineSetting> table);

}  // namespace rayloc
