// `rayloc completion bash|zsh`: completion scripts of these shells for rayloc's command line.
#include <cstdio>
#include <memory>
#include <string>

#include "daemon/cli/command/shell_completion.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/command_line.h"
#include "daemon/cli/verbs/verbs.h"

namespace rayloc::cli {
namespace {

RunVerb declare_completion(OptionParser& app) {
  const auto shell = std::make_shared<std::string>();
  app.add_option("SHELL", *shell, "For which shell: bash or zsh")
      ->required()
      ->check(one_of({"bash", "zsh"}));
  return [shell]() -> Expected<void> {
    const Command rayloc = describe_command_line();
    std::fputs((*shell == "bash" ? bash_completion(rayloc) : zsh_completion(rayloc)).c_str(),
               stdout);
    return {};
  };
}

}  // namespace

extern const Verb kCompletion;
const Verb kCompletion = {"completion",
                          "Print a script by which bash or zsh completes command lines of rayloc",
                          "source <(rayloc completion bash)",
                          declare_completion};

}  // namespace rayloc::cli
