// `rayloc man`: the manual page rayloc(1), from the declarations of the verbs.
#include <cstdio>

#include "daemon/cli/command/manual_page.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/command_line.h"
#include "daemon/cli/verbs/verbs.h"

namespace rayloc::cli {
namespace {

RunVerb declare_man(OptionParser&) {
  return []() -> Expected<void> {
    std::fputs(manual_page(describe_command_line()).c_str(), stdout);
    return {};
  };
}

}  // namespace

extern const Verb kMan;
const Verb kMan = {"man",
                   "Print the manual page rayloc(1); those of files: rayloc config man",
                   "rayloc man | man -l -",
                   declare_man};

}  // namespace rayloc::cli
