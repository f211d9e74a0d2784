// Command-line options of `rayloc simulate`.
#pragma once

#include <string>
#include <vector>

#include "daemon/cli/command/option_parser.h"
#include "daemon/lab/simulate/simulate_recordings.h"

namespace rayloc::cli {

struct SimulateArguments {
  std::string site;
  std::vector<std::string> out;  // [AP=]FILE
  SimulationOptions simulation;  // without `outputs`, which need the site
  bool quiet = false;
};

// Adds all options; `arguments` must outlive the parser.
void add_simulate_options(OptionParser& app, SimulateArguments& arguments);

}  // namespace rayloc::cli
