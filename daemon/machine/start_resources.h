// What a start needs of the machine: threads with their memory, and descriptors.
//
// Without them a start would fail half-way, and libzmq ends the process with a line of its own code
// where it gets no thread. So as many are tried and given back first: a limit is then named.
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

// What has ended a program, for people: a lack of memory, threads or descriptors says which limit
// to raise. `exit_status`: that of a program that ends for it.
struct LastWords {
  std::string text;
  int exit_status = 0;
};
LastWords last_words(const std::exception& error);

// An exception that nobody catches on any thread ends raylocd with these words, too.
void say_last_words_of_threads();

}  // namespace rayloc
