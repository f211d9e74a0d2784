// The hyper-parameters and ablations of method `paper` by name (METHODS A4), as used on the command
// line and in the files of experiments.
//
// paper_settings() is the single source: parsing, limits and the text of --help come from it.
// Defaults are those of PaperLocalizerOptions for devices, of paper_person_options() for
// people.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "engine/base/expected.h"
#include "engine/paper/paper_options.h"

namespace rayloc {

enum class PaperSettingKind { kNumber, kWhole, kFlag };  // a flag: 0 or 1

struct PaperSetting {
  std::string_view key;
  PaperSettingKind kind = PaperSettingKind::kNumber;
  double min = 0.0;
  double max = 0.0;
  std::string_view meaning;  // with the unit
  double (*get)(const PaperLocalizerOptions&) = nullptr;
  void (*set)(PaperLocalizerOptions&, double) = nullptr;  // REQUIRES: a value within the limits
};

std::span<const PaperSetting> paper_settings();
// nullptr: no setting has that name.
const PaperSetting* find_paper_setting(std::string_view key);

struct PaperAssignment {
  const PaperSetting* setting = nullptr;
  double value = 0.0;
};

// Parses "KEY=VALUE" of the command line: "alpha=0.5", "smoothing=false". Errors (kUsage) name the
// nearest key, or the permitted values.
Expected<PaperAssignment> read_paper_assignment(std::string_view assignment);

// "0.2", "100", "true".
std::string paper_text(const PaperSetting& setting, double value);

// One line per key: name, default and meaning, and the default for people if it differs.
std::string paper_settings_help();

}  // namespace rayloc
