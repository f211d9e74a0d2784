#include "daemon/lab/experiment/condition.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <vector>

#include "daemon/lab/experiment/controls.h"
#include "daemon/methods/method_registry.h"
#include "daemon/site/model/toml_reader.h"
#include "engine/base/check.h"
#include "engine/likelihood/likelihood.h"
#include "engine/paper/settings.h"

namespace rayloc {
namespace {

using C = Condition;

constexpr std::array<std::string_view, 2> kKinds = {"device", "person"};
constexpr std::array<std::string_view, 3> kSights = {"any", "los", "nlos"};
constexpr std::array<std::string_view, 2> kMotions = {"still", "walk"};
constexpr std::array<std::string_view, 2> kChains = {"known", "first_day"};

// The methods of the registry, then the controls.
std::span<const std::string_view> method_and_control_names() {
  static const std::vector<std::string_view> kNames = [] {
    std::vector<std::string_view> names(method_names().begin(), method_names().end());
    for (const ControlName& one : control_names()) {
      names.push_back(one.name);
    }
    return names;
  }();
  return kNames;
}

std::span<const std::string_view> likelihoods() {
  static const std::vector<std::string_view> kNames = [] {
    std::vector<std::string_view> names;
    for (const LikelihoodName& one : likelihood_names()) {
      names.push_back(one.name);
    }
    return names;
  }();
  return kNames;
}

std::string_view method_meaning() {
  static const std::string kText = [] {
    std::string names;
    for (const std::string_view name : method_names()) {
      names += (names.empty() ? "" : ", ") + std::string(name);
    }
    names += "; or a control:";
    for (const ControlName& one : control_names()) {
      names += (names.back() == ':' ? " " : ", ") + std::string(one.name) + " (" +
               std::string(one.meaning) + ")";
    }
    return "localization method: " + names;
  }();
  return kText;
}

constexpr std::span<const std::string_view> kAny;
constexpr NumberRange kHeight = {0.0, 20.0, "m"};
constexpr NumberRange kDepth = {0.0, 4.0, {}};

const std::array kKeys = std::to_array<ConditionKey>({
    {"room", &C::room, "", {}, false, kAny, true, "room plan, in the format of rayloc scene room"},
    {"kind", &C::kind, "device", {}, false, kKinds, true, "kind of target"},
    {"access_points",
     &C::access_points,
     "1",
     {1, 16, {}},
     true,
     kAny,
     true,
     "number of access points, in the order of the plan"},
    {"ap_height_m",
     &C::ap_height_m,
     "0",
     kHeight,
     false,
     kAny,
     true,
     "height of the access points; 0: that of the plan"},
    {"antenna_spacing_m",
     &C::antenna_spacing_m,
     "0",
     {0, 1, "m"},
     false,
     kAny,
     true,
     "antenna spacing of the access points; 0: that of the plan",
     true},
    {"channels",
     &C::channels,
     "plan",
     {},
     false,
     kAny,
     true,
     "channels over which devices hop, in the format of rayloc simulate --channels; plan: the "
     "channel of the plan, no hopping",
     true},
    {"device_height_m",
     &C::device_height_m,
     "1.2",
     kHeight,
     false,
     kAny,
     true,
     "height of the devices; the model uses the same value"},
    {"height_sigma_m",
     &C::height_sigma_m,
     "0",
     {0, 5, "m"},
     false,
     kAny,
     true,
     "standard deviation of the devices' heights",
     true},
    {"model_height_sigma_m",
     &C::model_height_sigma_m,
     "0",
     {0, 5, "m"},
     false,
     kAny,
     true,
     "standard deviation of the heights that the model assumes; 0: the height is exact",
     true},
    {"tilt_deg",
     &C::tilt_deg,
     "0",
     {0, 180, "degrees"},
     false,
     kAny,
     true,
     "maximum tilt of the device from upright, drawn for each spot",
     true},
    {"power_sigma_db",
     &C::power_sigma_db,
     "0",
     {0, 30, "dB"},
     false,
     kAny,
     true,
     "standard deviation of the transmit power between spots",
     true},
    {"second_day",
     &C::second_day,
     "none",
     {},
     false,
     kAny,
     true,
     "changes on the day of the spots, as for rayloc simulate --second-day: none, default or a "
     "file",
     true},
    {"person_radius_m",
     &C::person_radius_m,
     "0.165",
     {0.05, 0.5, "m"},
     false,
     kAny,
     true,
     "radius of people; the model assumes 0.165"},
    {"boxes",
     &C::boxes,
     "0",
     {0, 100, {}},
     true,
     kAny,
     true,
     "number of clutter boxes at random positions; the model includes them"},
    {"distance_m",
     &C::distance_m,
     "0",
     {0, 100, "m"},
     false,
     kAny,
     true,
     "distance of the spots from the first access point, within 0.25 m; 0: any"},
    {"sight",
     &C::sight,
     "any",
     {},
     false,
     kSights,
     true,
     "line of sight between the first access point and a spot"},
    {"layouts",
     &C::layouts,
     "1",
     {1, 1000, {}},
     true,
     kAny,
     true,
     "number of layouts, each with its own clutter and spots"},
    {"spots",
     &C::test_points,
     "20",
     {1, 10'000, {}},
     true,
     kAny,
     true,
     "number of spots at random positions in each layout"},
    {"survey_points",
     &C::survey_points,
     "0",
     {0, 1000, {}},
     true,
     kAny,
     true,
     "number of surveyed points that train the methods and controls",
     true},
    {"frames",
     &C::frames,
     "4",
     {1, 64, {}},
     true,
     kAny,
     true,
     "number of frames received at each spot"},
    {"motion",
     &C::motion,
     "still",
     {},
     false,
     kMotions,
     true,
     "motion of people; walk: each spot is a walk, evaluated every 0.1 s",
     true},
    {"walk_s", &C::walk_s, "10", {1, 600, "s"}, false, kAny, true, "duration of a walk", true},
    {"walk_speed_m_s",
     &C::walk_speed_m_s,
     "0.8",
     {0.1, 3, "m/s"},
     false,
     kAny,
     true,
     "constant speed of a walk",
     true},
    {"rate_hz",
     &C::rate_hz,
     "400",
     {10, 2000, "Hz"},
     false,
     kAny,
     true,
     "frame rate during a walk",
     true},
    {"depth",
     &C::depth,
     "3",
     kDepth,
     true,
     kAny,
     true,
     "maximum number of reflections of a simulated path"},
    {"plan_error_m",
     &C::plan_error_m,
     "0",
     {0, 1, "m"},
     false,
     kAny,
     true,
     "deviation of the real walls and boxes from the model"},
    {"impairments",
     &C::impairments,
     "default",
     {},
     false,
     kAny,
     true,
     "impairments of the radio, as for rayloc simulate --impairments: default, none or a file"},
    {"method",
     &C::method,
     default_method().name,
     {},
     false,
     method_and_control_names(),
     false,
     method_meaning()},
    {"epochs",
     &C::epochs,
     "0",
     {0, 1000, {}},
     true,
     kAny,
     false,
     "training epochs; 0: the method's default",
     true},
    {"constant_power",
     &C::constant_power,
     "0",
     {0, 1, {}},
     true,
     kAny,
     false,
     "1: the transmit power is known to be constant, so that received power is learned and used",
     true},
    {"likelihood",
     &C::likelihood,
     "partial",
     {},
     false,
     likelihoods(),
     false,
     "likelihood of the method rayloc"},
    {"chains",
     &C::chains,
     "known",
     {},
     false,
     kChains,
     false,
     "chain gains in the model: known (those of the spots) or first_day (without the changes of "
     "second_day)",
     true},
    {"model_depth",
     &C::model_depth,
     "2",
     kDepth,
     true,
     kAny,
     false,
     "maximum number of reflections in the model"},
    {"repeats",
     &C::repeats,
     "1",
     {1, 10'000, {}},
     true,
     kAny,
     false,
     "repetitions of each spot with different random starts (method paper)"},
    {"multi_start",
     &C::multi_start,
     "1",
     {1, 10'000, {}},
     true,
     kAny,
     false,
     "random starts of each location; the smallest loss wins (method paper)"},
});

constexpr std::string_view kPaper = "paper.";

const ConditionKey& find_key(std::string_view key) {
  const auto* const found = std::find_if(
      kKeys.begin(), kKeys.end(), [&](const ConditionKey& one) { return one.key == key; });
  RAYLOC_CHECK(found != kKeys.end());
  return *found;
}

std::string text_of(const Condition& condition, const ConditionKey& key) {
  if (const auto* number = std::get_if<double C::*>(&key.member)) {
    return to_text(condition.**number);
  }
  if (const auto* text = std::get_if<std::string C::*>(&key.member)) {
    return condition.**text;
  }
  return (condition.*std::get<std::filesystem::path C::*>(key.member)).stem().string();
}

void set_preset(const ConditionKey& key, Condition& condition) {
  if (const auto* number = std::get_if<double C::*>(&key.member)) {
    std::from_chars(key.preset.data(), key.preset.data() + key.preset.size(), condition.**number);
  } else if (const auto* text = std::get_if<std::string C::*>(&key.member)) {
    condition.** text = key.preset;
  }
}

}  // namespace

std::span<const ConditionKey> condition_keys() { return kKeys; }

bool is_walking(const Condition& condition) { return condition.motion == "walk"; }

bool is_control(const Condition& condition) { return find_method(condition.method) == nullptr; }

paper::LocalizerOptions Condition::paper_options() const {
  paper::LocalizerOptions options =
      kind == "person" ? paper::person_options() : paper::LocalizerOptions{};
  for (const auto& [key, value] : paper) {
    paper::find_setting(key)->set(options, value);
  }
  return options;
}

Condition default_condition() {
  Condition condition;
  for (const ConditionKey& key : kKeys) {
    set_preset(key, condition);
  }
  return condition;
}

std::string condition_text(const Condition& condition, std::string_view key) {
  if (key.starts_with(kPaper)) {
    const paper::Setting* setting = paper::find_setting(key.substr(kPaper.size()));
    RAYLOC_CHECK(setting != nullptr);
    return paper::setting_text(*setting, setting->get(condition.paper_options()));
  }
  return text_of(condition, find_key(key));
}

std::optional<double> condition_number(const Condition& condition, std::string_view key) {
  if (key.starts_with(kPaper)) {
    const paper::Setting* setting = paper::find_setting(key.substr(kPaper.size()));
    RAYLOC_CHECK(setting != nullptr);
    return setting->kind == paper::SettingKind::kFlag
               ? std::nullopt
               : std::optional(setting->get(condition.paper_options()));
  }
  const auto* number = std::get_if<double C::*>(&find_key(key).member);
  return number == nullptr ? std::nullopt : std::optional(condition.**number);
}

std::vector<std::string> reported_keys(std::span<const Condition* const> conditions) {
  std::vector<std::string> keys;
  for (const ConditionKey& key : kKeys) {
    const bool is_used = std::any_of(conditions.begin(), conditions.end(), [&](const Condition* c) {
      return text_of(*c, key) != key.preset;
    });
    if (is_used || !key.only_where_used) {
      keys.emplace_back(key.key);
    }
  }
  for (const paper::Setting& setting : paper::settings()) {
    keys.push_back(std::string(kPaper) + std::string(setting.key));
  }
  return keys;
}

std::string world_text(const Condition& condition) {
  std::string text = condition.room.string();
  for (const ConditionKey& key : kKeys) {
    if (key.is_world) {
      text += "|" + text_of(condition, key);
    }
  }
  return text;
}

std::string experiment_help() {
  constexpr std::size_t kWidth = 28;  // width of "paper.sigma_0_squared = 1"
  std::string help;
  const auto line = [&](std::string text, std::string_view meaning) {
    text.resize(std::max(text.size(), kWidth), ' ');
    help += "  " + text + "# " + std::string(meaning) + "\n";
  };
  for (const ConditionKey& key : kKeys) {
    const bool quoted = !std::holds_alternative<double C::*>(key.member);
    const std::string value =
        quoted ? "\"" + std::string(key.preset) + "\"" : std::string(key.preset);
    line(std::string(key.key) + " = " + value, key.meaning);
  }
  const paper::LocalizerOptions defaults;
  const paper::LocalizerOptions people = paper::person_options();
  for (const paper::Setting& setting : paper::settings()) {
    std::string meaning(setting.meaning);
    if (setting.get(people) != setting.get(defaults)) {
      meaning += " (people: " + paper::setting_text(setting, setting.get(people)) + ")";
    }
    line("paper." + std::string(setting.key) + " = " +
             paper::setting_text(setting, setting.get(defaults)),
         meaning);
  }
  return help;
}

}  // namespace rayloc
