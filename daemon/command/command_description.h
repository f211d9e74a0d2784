// What a program takes, as plain values: for what is made of it beside parsing (manual page,
// completion by shells).
#pragma once

#include <string>
#include <vector>

namespace rayloc::cli {

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

}  // namespace rayloc::cli
