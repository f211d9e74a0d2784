#include "engine/baselines/settings.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  const auto [end, status] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

const BaselineSetting* find(std::span<const BaselineSetting> table, std::string_view key) {
  const auto found = std::find_if(table.begin(), table.end(), [&](const BaselineSetting& setting) {
    return setting.key == key;
  });
  return found == table.end() ? nullptr : &*found;
}

std::string limits_text(const BaselineSetting& setting) {
  if (setting.choices.empty()) {
    return std::string(setting.is_whole ? "a whole number" : "a number") + " from " +
           number_text(setting.min) + " to " + number_text(setting.max);
  }
  std::string text;
  for (std::size_t i = 0; i < setting.choices.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == setting.choices.size() ? " or " : ", ");
    text += setting.choices[i];
  }
  return text;
}

}  // namespace

double number_of(std::span<const BaselineSetting> table,
                 const BaselineValues& values,
                 std::string_view key) {
  const BaselineSetting* setting = find(table, key);
  RAYLOC_CHECK(setting != nullptr && setting->choices.empty());
  const auto given = values.find(key);
  const double* value = given == values.end() ? nullptr : std::get_if<double>(&given->second);
  return value == nullptr ? setting->standard : *value;
}

std::size_t choice_of(std::span<const BaselineSetting> table,
                      const BaselineValues& values,
                      std::string_view key) {
  const BaselineSetting* setting = find(table, key);
  RAYLOC_CHECK(setting != nullptr && !setting->choices.empty());
  const auto given = values.find(key);
  const auto* value = given == values.end() ? nullptr : std::get_if<std::string>(&given->second);
  const auto found = value == nullptr
                         ? setting->choices.begin()
                         : std::find(setting->choices.begin(), setting->choices.end(), *value);
  RAYLOC_CHECK(found != setting->choices.end());
  return static_cast<std::size_t>(found - setting->choices.begin());
}

std::string setting_text(std::span<const BaselineSetting> table,
                         const BaselineValues& values,
                         std::string_view key) {
  const BaselineSetting* setting = find(table, key);
  RAYLOC_CHECK(setting != nullptr);
  return setting->choices.empty() ? number_text(number_of(table, values, key))
                                  : std::string(setting->choices[choice_of(table, values, key)]);
}

Expected<void> read_baseline_value(std::string_view assignment,
                                   std::string_view method,
                                   std::span<const BaselineSetting> table,
                                   BaselineValues& values) {
  const auto refuse = [&](const std::string& what) {
    return make_error(ErrorKind::kUsage, std::string(assignment) + ": " + what);
  };
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos) {
    return refuse("write KEY=VALUE");
  }
  const std::string_view key = assignment.substr(0, equals);
  const std::string_view text = assignment.substr(equals + 1);
  const BaselineSetting* setting = find(table, key);
  if (setting == nullptr) {
    std::vector<std::string_view> keys;
    for (const BaselineSetting& one : table) {
      keys.push_back(one.key);
    }
    return refuse("no such setting of " + std::string(method) + suggestion(key, keys));
  }
  if (!setting->choices.empty()) {
    if (std::find(setting->choices.begin(), setting->choices.end(), text) ==
        setting->choices.end()) {
      return refuse("'" + std::string(key) + "' is " + limits_text(*setting));
    }
    values.insert_or_assign(std::string(key), std::string(text));
    return {};
  }
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !(value >= setting->min) ||
      !(value <= setting->max) || (setting->is_whole && value != std::trunc(value))) {
    return refuse("'" + std::string(key) + "' is " + limits_text(*setting));
  }
  values.insert_or_assign(std::string(key), value);
  return {};
}

std::string baseline_settings_help(std::span<const BaselineSetting> table) {
  constexpr std::size_t kWidth = 20;  // [characters], width of the column of keys
  std::string text;
  for (const BaselineSetting& setting : table) {
    std::string line = std::string(setting.key) + "=" +
                       (setting.choices.empty() ? number_text(setting.standard)
                                                : std::string(setting.choices.front()));
    line.resize(std::max(line.size() + 1, kWidth), ' ');
    text += line + std::string(setting.meaning);
    if (!setting.choices.empty()) {
      text += ": " + limits_text(setting);
    }
    text += "\n";
  }
  return text;
}

}  // namespace rayloc
