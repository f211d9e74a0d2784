// Resources that a start needs: threads with their memory, and descriptors.
//
// Without them a start would fail half-way, and libzmq ends the process with a line of its own code
// where it gets no thread. So as many are tried and released first, to name the limit.
#pragma once

#include <cstddef>
#include <exception>
#include <string>

#include "engine/base/expected.h"

namespace rayloc {

// kUnavailable, with the limit to raise.
Expected<void> check_start_resources(std::size_t threads, std::size_t descriptors);

// Connections that a server may hold of this process's descriptors, at most `most`.
std::size_t affordable_connections(std::size_t most);

// Reason for the end of a program, as a message: a lack of memory, threads or descriptors names the
// limit to raise. `exit_status`: that of a program that ends for this reason.
struct FatalMessage {
  std::string text;
  int exit_status = 0;
};
FatalMessage fatal_message(const std::exception& error);

// An exception that is not caught on any thread ends raylocd with such a message, too.
void report_uncaught_exceptions();

}  // namespace rayloc
