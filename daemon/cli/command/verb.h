// One verb of `rayloc`: a file of daemon/cli/verbs, and a row of its verbs.cpp.
#pragma once

#include <functional>
#include <type_traits>
#include <utility>

#include "daemon/cli/command/option_parser.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// Runs the verb once the command line is parsed. An Error becomes a line on stderr and the exit
// status of INTERFACE 1. A completed verb ends with 0, or with the status that it returns.
class RunVerb {
 public:
  RunVerb() = default;
  template <typename Run, typename = std::enable_if_t<!std::is_same_v<std::decay_t<Run>, RunVerb>>>
  RunVerb(Run run)  // NOLINT(google-explicit-constructor): what declares a verb returns a lambda
      : run_([run = std::move(run)] { return status_of(run()); }) {}

  Expected<int> operator()() const { return run_(); }

 private:
  static Expected<int> status_of(Expected<int> result) { return result; }
  static Expected<int> status_of(const Expected<void>& result) {
    return result.map([] { return 0; });
  }

  std::function<Expected<int>()> run_;
};

struct Verb {
  const char* name;
  const char* summary;                    // one line, for `rayloc --help`
  const char* example;                    // printed at the end of `rayloc VERB --help`
  RunVerb (*declare)(OptionParser& app);  // adds the verb's arguments to `app`
};

// Returned by a verb whose exit status reports something other than its own failure (for example a
// check that found an error); the verb has printed all messages.
inline tl::unexpected<Error> exit_silently(ErrorKind kind) { return make_error(kind, ""); }

}  // namespace rayloc::cli
