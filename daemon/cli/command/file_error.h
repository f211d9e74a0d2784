// Reports an error in a file that was given to a verb.
#pragma once

#include <cstdio>

#include "daemon/cli/command/verb.h"
#include "engine/base/expected.h"
#include "engine/base/printable.h"

namespace rayloc::cli {

// Prints the error without the program's name before it, so that editors jump to its
// FILE:LINE:COLUMN, and returns only the exit status. Quoted parts of the file cannot control the
// terminal; a message may have several lines.
inline tl::unexpected<Error> report_file_error(const Error& error) {
  std::fprintf(stderr, "%s\n", printable(error.message, '\n').c_str());
  return exit_silently(error.kind);
}

}  // namespace rayloc::cli
