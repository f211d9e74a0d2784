// An experiment as a file states it (TOML):
//
//   name = "Clutter"
//   seed = 1
//   [defaults]                    # optional; one value each
//   room = "rooms/office.toml"    # relative to this file
//   [[study]]
//   name = "boxes"
//   claim = "errors grow slowly with clutter"   # optional: text shown beside the figures
//   boxes = [2, 4, 6, 8, 10]      # a list: an axis
//   method = ["rayloc", "paper"]
//   paper.alpha = 0.5             # a value: held
//   over = "boxes"                # optional: the axis that charts run over
//
// The keys are those of condition.h. For several axes all combinations are run. Errors name
// file:line:column, all of them at once; unknown keys are errors.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/lab/experiment/condition.h"
#include "engine/base/expected.h"

namespace rayloc {

struct Study {
  std::string name;
  std::string claim;
  std::vector<std::string> axes;  // keys with a list of values, in order of the tables
  std::string over;               // an axis of numbers; empty: none
  std::vector<Condition> conditions;
};

struct Experiment {
  std::string name;
  std::uint64_t seed = 1;
  std::vector<Study> studies;
};

inline constexpr std::size_t kMaxConditions = 10'000;  // per study

Expected<Experiment> load_experiment(const std::filesystem::path& file);
// `file` is used in messages and for relative paths.
Expected<Experiment> parse_experiment(std::string_view text, const std::filesystem::path& file);

// Keeps only the named studies; no names: all. Returns an Error for an unknown study.
Expected<void> keep_studies(const std::vector<std::string>& names, Experiment& experiment);

}  // namespace rayloc
