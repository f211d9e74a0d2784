// Command-line options that select a localization method and its settings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "daemon/cli/command/option_parser.h"
#include "daemon/methods/method_options.h"
#include "daemon/methods/method_registry.h"
#include "engine/base/expected.h"
#include "engine/likelihood/likelihood.h"

namespace rayloc::cli {

struct MethodArguments {
  std::string name{default_method().name};
  std::string likelihood{likelihood_names().front().name};
  std::uint64_t seed = 1;
  std::size_t starts = 1;
  std::vector<std::string> paper;     // KEY=VALUE
  std::vector<std::string> baseline;  // KEY=VALUE
  std::string start;                  // "X,Y"; empty: no start
  bool exhaustive = false;            // MethodOptions::is_exhaustive
  std::string tracks;                 // empty: the method's default
};

// Adds the options --method, --likelihood, --seed, --multi-start, --paper, --baseline, --start,
// --exhaustive and --tracks. `options` must outlive the parser.
void add_method_options(OptionParser& app, MethodArguments& options);

// Options that belong to another than the selected method are refused (kUsage).
Expected<MethodOptions> method_options(const MethodArguments& options);

}  // namespace rayloc::cli
