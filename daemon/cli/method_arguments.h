// What the command line says to a method of localization: which one, and its settings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "daemon/command/option_parser.h"
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
  std::string start;                  // "X,Y"; empty: none is told
  bool exhaustive = false;            // MethodOptions::is_exhaustive
};

// The options --method, --likelihood, --seed, --multi-start, --paper, --baseline, --start and
// --exhaustive. `options` outlives the parser.
void add_method_options(OptionParser& app, MethodArguments& options);

// Those of another method than the one that is named are refused (kUsage).
Expected<MethodOptions> method_options(const MethodArguments& options);

}  // namespace rayloc::cli
