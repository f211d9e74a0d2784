// What the methods of this room can be told by name (`rayloc replay --baseline KEY=VALUE`).
// Reading, limits and the text of --help come from these tables.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "engine/base/expected.h"

namespace rayloc {

// By BaselineSetting::key. A key that is not there has the setting's standard.
using BaselineValues = std::map<std::string, std::variant<double, std::string>, std::less<>>;

struct BaselineSetting {
  std::string_view key;
  std::string_view meaning;  // with the unit
  double standard = 0.0;     // of a number
  double min = 0.0;
  double max = 0.0;
  bool is_whole = false;
  std::span<const std::string_view> choices = {};  // of a word; the first is the standard
};

// Of a method's table. REQUIRES: the table has that key.
double number_of(std::span<const BaselineSetting> table,
                 const BaselineValues& values,
                 std::string_view key);
// Position in BaselineSetting::choices.
std::size_t choice_of(std::span<const BaselineSetting> table,
                      const BaselineValues& values,
                      std::string_view key);

// Either as the command line would have it.
std::string setting_text(std::span<const BaselineSetting> table,
                         const BaselineValues& values,
                         std::string_view key);

// "KEY=VALUE", as the command line has it, into `values`. Errors (kUsage) name the nearest key, or
// what the value may be.
Expected<void> read_baseline_value(std::string_view assignment,
                                   std::string_view method,
                                   std::span<const BaselineSetting> table,
                                   BaselineValues& values);

// A line a key: "frames=10   at most, of a burst at an access point".
std::string baseline_settings_help(std::span<const BaselineSetting> table);

}  // namespace rayloc
