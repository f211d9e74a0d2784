// What is wrong with a file that a verb was given.
#pragma once

#include <cstdio>

#include "daemon/command/verb.h"
#include "engine/base/expected.h"
#include "engine/base/printable.h"

namespace rayloc::cli {

// Prints the error without the program's name before it, so that editors jump to its
// FILE:LINE:COLUMN, and leaves nothing to say but the exit status. What it quotes of the file may
// not control the terminal; a message may have several lines.
inline tl::unexpected<Error> report_file_error(const Error& error) {
  std::fprintf(stderr, "%s\n", printable(error.message, '\n').c_str());
  return exit_silently(error.kind);
}

}  // namespace rayloc::cli
