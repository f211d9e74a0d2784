#include "daemon/cli/verbs/command_line.h"

#include "daemon/cli/verbs/verbs.h"

namespace rayloc::cli {

std::unique_ptr<OptionParser> make_parser() {
  return std::make_unique<OptionParser>(
      "Wi-Fi localization from channel state information", "rayloc", "rayloc " RAYLOC_VERSION);
}

void declare_command_line(OptionParser& parser, RunVerb& chosen) {
  parser.require_subcommand(1);
  for (const Verb& verb : verbs()) {
    OptionParser* sub = parser.add_subcommand(verb.name, verb.summary);
    sub->footer(std::string("Example:\n  ") + verb.example);
    sub->callback([&chosen, run_verb = verb.declare(*sub)] { chosen = run_verb; });
  }
}

Command describe_command_line() {
  const std::unique_ptr<OptionParser> parser = make_parser();
  RunVerb chosen;
  declare_command_line(*parser, chosen);
  return parser->describe();
}

}  // namespace rayloc::cli
