#include "engine/paper/settings.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/suggestion.h"

namespace rayloc::paper {
namespace {

using Options = LocalizerOptions;

// In a setting's unit, chosen: far above every value of METHODS A4.
constexpr double kLargest = 1e6;
constexpr double kSmallest = 1e-12;     // in the same unit, chosen: for values that must exceed 0
constexpr double kBelowOne = 0.999999;  // a ratio, chosen: a memory of 1 has no decay

// The settings of METHODS A4 and its open choices; each states its unit.
constexpr std::array kSettings = std::to_array<Setting>({
    {"gamma_1",
     SettingKind::kNumber,
     0.0,
     kLargest,
     "weight of the delays' MSE [1/ns^2]",
     [](const Options& o) { return o.csi.delay_weight; },
     [](Options& o, double x) { o.csi.delay_weight = x; }},
    {"gamma_2",
     SettingKind::kNumber,
     0.0,
     kLargest,
     "weight of the distance from the room's centre [1/m^2]",
     [](const Options& o) { return o.centre_weight; },
     [](Options& o, double x) { o.centre_weight = x; }},
    {"sigma_0_squared",
     SettingKind::kNumber,
     kSmallest,
     kLargest,
     "variance of the smoothing at the start [m^2]",
     [](const Options& o) { return o.descent.variance; },
     [](Options& o, double x) { o.descent.variance = x; }},
    {"sigma_m",
     SettingKind::kNumber,
     kSmallest,
     kLargest,
     "deviation that the smoothing shrinks towards [m]",
     [](const Options& o) { return o.descent.least_deviation; },
     [](Options& o, double x) { o.descent.least_deviation = x; }},
    {"alpha",
     SettingKind::kNumber,
     0.0,
     kLargest,
     "exponent of the bias B = exp(-alpha L)",
     [](const Options& o) { return o.descent.alpha; },
     [](Options& o, double x) { o.descent.alpha = x; }},
    {"positions",
     SettingKind::kWhole,
     1.0,
     10'000.0,
     "N_p, positions that a step of the smoothed loss draws",
     [](const Options& o) { return static_cast<double>(o.descent.positions); },
     [](Options& o, double x) { o.descent.positions = static_cast<std::size_t>(x); }},
    {"iterations",
     SettingKind::kWhole,
     0.0,
     100'000.0,
     "T, steps of the descent",
     [](const Options& o) { return static_cast<double>(o.descent.iterations); },
     [](Options& o, double x) { o.descent.iterations = static_cast<int>(x); }},
    {"rate",
     SettingKind::kNumber,
     kSmallest,
     kLargest,
     "learning rate of RMSprop [m]",
     [](const Options& o) { return o.descent.rate; },
     [](Options& o, double x) { o.descent.rate = x; }},
    {"momentum",
     SettingKind::kNumber,
     0.0,
     kBelowOne,
     "momentum of RMSprop",
     [](const Options& o) { return o.descent.rmsprop.momentum; },
     [](Options& o, double x) { o.descent.rmsprop.momentum = x; }},
    {"decay",
     SettingKind::kNumber,
     0.0,
     kBelowOne,
     "decay of RMSprop's mean square (not stated by the paper)",
     [](const Options& o) { return o.descent.rmsprop.decay; },
     [](Options& o, double x) { o.descent.rmsprop.decay = x; }},
    {"smoothing",
     SettingKind::kFlag,
     0.0,
     1.0,
     "false: ablation, the gradient at the position itself",
     [](const Options& o) { return o.descent.is_smoothed ? 1.0 : 0.0; },
     [](Options& o, double x) { o.descent.is_smoothed = x != 0.0; }},
    {"fixed_sigma",
     SettingKind::kFlag,
     0.0,
     1.0,
     "true: ablation, sigma_0 to the end",
     [](const Options& o) { return o.descent.is_deviation_fixed ? 1.0 : 0.0; },
     [](Options& o, double x) { o.descent.is_deviation_fixed = x != 0.0; }},
    {"window",
     SettingKind::kWhole,
     1.0,
     1'001.0,
     "window of the Savitzky-Golay filter along the tones, odd [tones]",
     [](const Options& o) { return static_cast<double>(o.csi.smoothing.window); },
     [](Options& o, double x) { o.csi.smoothing.window = static_cast<int>(x); }},
    {"order",
     SettingKind::kWhole,
     0.0,
     20.0,
     "order of that filter's polynomial",
     [](const Options& o) { return static_cast<double>(o.csi.smoothing.order); },
     [](Options& o, double x) { o.csi.smoothing.order = static_cast<int>(x); }},
    {"floor",
     SettingKind::kNumber,
     kSmallest,
     1.0,
     "least denominator of the ratio, share of its mean power",
     [](const Options& o) { return o.csi.floor; },
     [](Options& o, double x) { o.csi.floor = x; }},
});

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  const auto [end, status] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

std::optional<double> parse(const Setting& setting, std::string_view text) {
  if (setting.kind == SettingKind::kFlag) {
    return text == "true"    ? std::optional(1.0)
           : text == "false" ? std::optional(0.0)
                             : std::nullopt;
  }
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !(value >= setting.min) ||
      !(value <= setting.max) ||
      (setting.kind == SettingKind::kWhole && value != std::trunc(value))) {
    return std::nullopt;
  }
  return value;
}

std::string limits_text(const Setting& setting) {
  if (setting.kind == SettingKind::kFlag) {
    return "true or false";
  }
  return std::string(setting.kind == SettingKind::kWhole ? "a whole number" : "a number") +
         " from " + number_text(setting.min) + " to " + number_text(setting.max);
}

}  // namespace

std::span<const Setting> settings() { return kSettings; }

const Setting* find_setting(std::string_view key) {
  const auto* const found =
      std::find_if(kSettings.begin(), kSettings.end(), [&](const Setting& setting) {
        return setting.key == key;
      });
  return found == kSettings.end() ? nullptr : found;
}

Expected<Assignment> read_assignment(std::string_view assignment) {
  const auto refuse = [&](const std::string& what) {
    return make_error(ErrorKind::kUsage, std::string(assignment) + ": " + what);
  };
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos) {
    return refuse("write KEY=VALUE, for example alpha=0.5");
  }
  const std::string_view key = assignment.substr(0, equals);
  const Setting* setting = find_setting(key);
  if (setting == nullptr) {
    std::vector<std::string_view> keys;
    keys.reserve(kSettings.size());
    for (const Setting& one : kSettings) {
      keys.push_back(one.key);
    }
    return refuse("method paper has no '" + std::string(key) + "'" + suggestion(key, keys));
  }
  const auto value = parse(*setting, assignment.substr(equals + 1));
  if (!value) {
    return refuse("'" + std::string(key) + "' is " + limits_text(*setting));
  }
  return Assignment{setting, *value};
}

std::string setting_text(const Setting& setting, double value) {
  if (setting.kind == SettingKind::kFlag) {
    return value != 0.0 ? "true" : "false";
  }
  return number_text(value);
}

std::string settings_help() {
  // [characters] of the column, so that the longest, "sigma_0_squared=1", fits.
  constexpr std::size_t kWidth = 22;
  const Options defaults;
  const Options people = person_options();
  std::string text;
  for (const Setting& setting : kSettings) {
    std::string line =
        std::string(setting.key) + "=" + setting_text(setting, setting.get(defaults));
    line.resize(std::max(line.size(), kWidth), ' ');
    text += line + std::string(setting.meaning);
    if (setting.get(people) != setting.get(defaults)) {
      text += " (people: " + setting_text(setting, setting.get(people)) + ")";
    }
    text += "\n";
  }
  return text;
}

}  // namespace rayloc::paper
