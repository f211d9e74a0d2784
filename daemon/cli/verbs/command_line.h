// The command line of `rayloc`: its verbs declared to a parser.
#pragma once

#include "daemon/cli/command/option_parser.h"
#include "daemon/cli/command/verb.h"

namespace rayloc::cli {

// Declares every verb to `parser`; after parsing, `chosen` runs the selected verb.
void declare_command_line(OptionParser& parser, RunVerb& chosen);

// `rayloc`, without its verbs.
std::unique_ptr<OptionParser> make_parser();

// `rayloc` with all its options.
Command describe_command_line();

}  // namespace rayloc::cli
