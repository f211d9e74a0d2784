// `rayloc`: the command line. Data goes to stdout, words for people to stderr.
#include <array>
#include <cstdio>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "daemon/cli/verb.h"
#include "daemon/cli/verbs.h"
#include "daemon/service/exit_status.h"

namespace rayloc::cli {
namespace {

int run(int argc, const char* const* argv) {
  CLI::App app{"Wi-Fi localization from channel state information", "rayloc"};
  app.set_version_flag("--version", "rayloc " RAYLOC_VERSION);
  app.require_subcommand(1);
  RunVerb chosen;
  for (const Verb& verb : verbs()) {
    CLI::App* sub = app.add_subcommand(verb.name, verb.summary);
    sub->footer(std::string("Example:\n  ") + verb.example);
    sub->callback([&chosen, run_verb = verb.declare(*sub)] { chosen = run_verb; });
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  }
  const Expected<void> result = chosen();
  if (result) {
    return std::fflush(stdout) == 0 ? 0 : exit_status(ErrorKind::kUnavailable);
  }
  if (!result.error().message.empty()) {
    std::fprintf(stderr, "rayloc: %s\n", result.error().message.c_str());
  }
  return exit_status(result.error().kind);
}

}  // namespace
}  // namespace rayloc::cli

int main(int argc, char** argv) {
  try {
    return rayloc::cli::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rayloc: internal error: %s\n", error.what());
    return rayloc::kExitInternal;
  }
}
