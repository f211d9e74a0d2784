// `rayloc`: the command line. Data goes to stdout, messages for people to stderr.
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>

#include "daemon/base/exit_status.h"
#include "daemon/cli/verbs/command_line.h"
#include "daemon/messages/quiet_protobuf.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

int run_program(int argc, const char* const* argv) {
  const std::unique_ptr<OptionParser> parser = make_parser();
  RunVerb chosen;
  declare_command_line(*parser, chosen);
  if (const std::optional<int> status = parser->parse(argc, argv)) {
    return *status;
  }
  const Expected<int> result = chosen();
  if (result) {
    return std::fflush(stdout) == 0 ? *result : exit_status(ErrorKind::kUnavailable);
  }
  if (!result.error().message.empty()) {
    std::fprintf(stderr, "rayloc: %s\n", printable(result.error().message, '\n').c_str());
  }
  return exit_status(result.error().kind);
}

}  // namespace
}  // namespace rayloc::cli

int main(int argc, char** argv) {
  try {
    rayloc::quiet_protobuf();
    return rayloc::cli::run_program(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rayloc: internal error: %s\n", error.what());
    return rayloc::kExitInternal;
  }
}
