// The command line of `rayloc`: the verbs declared to CLI11, and the same as plain values for
// what else is made of it (manual page, completion by shells).
#pragma once

#include <string>
#include <vector>

#include "daemon/command/verb.h"

namespace rayloc::cli {

// Declares every verb to `app`; when one has been parsed `chosen` runs it.
void declare_command_line(CLI::App& app, RunVerb& chosen);

struct CommandOption {
  std::vector<std::string> names;  // "--json", "-j"; empty for an argument by position
  std::string value;               // "FILE", "TEXT": what stands behind the name; empty for a flag
  std::vector<std::string> choices;  // when only these values are taken
  std::string preset;                // the default, empty when there is none
  std::string description;
  bool required = false;
  bool repeated = false;  // takes any number of values
};

struct Command {
  std::string name;
  std::string summary;
  std::string notes;  // what --help ends with: the example
  std::vector<CommandOption> options;
  std::vector<CommandOption> arguments;  // by position
  std::vector<Command> commands;         // verbs; of `scene`: check, room, show
};

// `rayloc` with all that it takes.
Command describe_command_line();

}  // namespace rayloc::cli
