// The command line of a program as plain values, for uses
// other than parsing (manual page, completion by shells).
#pragma once

#include <string>
#include <vector>

namespace rayloc::cli {

struct CommandOption {
  std::vector<std::string> names;  // "--json", "-j"; empty for a positional argument
  std::string value;               // "FILE", "TEXT": the placeholder of the value; empty for a flag
  std::vector<std::string> choices;  // the only allowed values; empty: any value
  std::string preset;                // the default; empty: none
  std::string description;
  bool required = false;
  bool repeated = false;  // takes any number of values
};

struct Command {
  std::string name;
  std::string summary;
  std::string notes;  // end of the --help text: the example
  std::vector<CommandOption> options;
  std::vector<CommandOption> arguments;  // positional
  std::vector<Command> commands;         // verbs; for `scene`: check, room, show
};

}  // namespace rayloc::cli
