#include "daemon/cli/command_line.h"

#include "daemon/cli/verbs.h"

namespace rayloc::cli {
namespace {

// CLI11 tells the values of IsMember() in the option's type only: "TEXT:{device,person,all}".
std::vector<std::string> choices_of(const std::string& type) {
  std::vector<std::string> choices;
  const std::size_t begin = type.find(":{");
  const std::size_t end = type.find('}', begin == std::string::npos ? 0 : begin);
  if (begin == std::string::npos || end == std::string::npos) {
    return choices;
  }
  for (std::size_t at = begin + 2; at < end;) {
    const std::size_t comma = std::min(type.find(',', at), end);
    choices.push_back(type.substr(at, comma - at));
    at = comma + 1;
  }
  return choices;
}

CommandOption describe(const CLI::Option& option) {
  CommandOption described;
  for (const std::string& name : option.get_lnames()) {
    described.names.push_back("--" + name);
  }
  for (const std::string& name : option.get_snames()) {
    described.names.push_back("-" + name);
  }
  const bool flag = option.get_type_size_max() == 0;
  if (!flag) {
    const std::string type = option.get_type_name();
    described.value =
        option.get_positional() ? option.get_name(true) : type.substr(0, type.find(':'));
    described.choices = choices_of(type);
    described.preset = option.get_default_str();
  }
  described.description = option.get_description();
  described.required = option.get_required();
  described.repeated = option.get_expected_max() > 1;
  return described;
}

Command describe(const CLI::App& app) {
  Command command;
  command.name = app.get_name();
  command.summary = app.get_description();
  command.notes = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    (option->get_positional() ? command.arguments : command.options).push_back(describe(*option));
  }
  for (const CLI::App* sub : app.get_subcommands({})) {
    command.commands.push_back(describe(*sub));
  }
  return command;
}

}  // namespace

void declare_command_line(CLI::App& app, RunVerb& chosen) {
  app.name("rayloc");
  app.description("Wi-Fi localization from channel state information");
  app.set_version_flag("--version", "rayloc " RAYLOC_VERSION);
  app.require_subcommand(1);
  for (const Verb& verb : verbs()) {
    CLI::App* sub = app.add_subcommand(verb.name, verb.summary);
    sub->footer(std::string("Example:\n  ") + verb.example);
    sub->callback([&chosen, run_verb = verb.declare(*sub)] { chosen = run_verb; });
  }
}

Command describe_command_line() {
  CLI::App app;
  RunVerb chosen;
  declare_command_line(app, chosen);
  return describe(app);
}

}  // namespace rayloc::cli
