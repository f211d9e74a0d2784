// One verb of `rayloc`: a file of this folder, and a row of the table in main.cpp.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "engine/base/expected.h"

namespace rayloc::cli {

// Runs the verb once the command line is parsed. An Error becomes a line on stderr and the exit
// status of INTERFACE 1.
using RunVerb = std::function<Expected<void>()>;

struct Verb {
  const char* name;
  const char* summary;                // one line, for `rayloc --help`
  const char* example;                // printed at the end of `rayloc VERB --help`
  RunVerb (*declare)(CLI::App& app);  // adds the verb's arguments to `app`
};

// A verb that reports by exit status what is no failure of its own (for example a check that
// found something wrong) returns this: it has printed what there is to say.
inline tl::unexpected<Error> exit_silently(ErrorKind kind) { return make_error(kind, ""); }

}  // namespace rayloc::cli
