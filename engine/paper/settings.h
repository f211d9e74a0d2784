// The hyper-parameters and ablations of method `paper` by name (METHODS A4), as used on the command
// line and in the files of experiments.
//
// settings() is the single source: parsing, limits and the text of --help come from it.
// Defaults are those of LocalizerOptions for devices, of person_options() for
// people.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "engine/base/expected.h"
#include "engine/paper/options.h"

namespace rayloc::paper {

enum class SettingKind { kNumber, kWhole, kFlag };  // a flag: 0 or 1

struct Setting {
  std::string_view key;
  SettingKind kind = SettingKind::kNumber;
  double min = 0.0;
  double max = 0.0;
  std::string_view meaning;  // with the unit
  double (*get)(const LocalizerOptions&) = nullptr;
  void (*set)(LocalizerOptions&, double) = nullptr;  // REQUIRES: a value within the limits
};

std::span<const Setting> settings();
// nullptr: no setting has that name.
const Setting* find_setting(std::string_view key);

struct Assignment {
  const Setting* setting = nullptr;
  double value = 0.0;
};

// Parses "KEY=VALUE" of the command line: "alpha=0.5", "smoothing=false". Errors (kUsage) name the
// nearest key, or the permitted values.
Expected<Assignment> read_assignment(std::string_view assignment);

// "0.2", "100", "true".
std::string setting_text(const Setting& setting, double value);

// One line per key: name, default and meaning, and the default for people if it differs.
std::string settings_help();

}  // namespace rayloc::paper
