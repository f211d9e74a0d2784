// terminal_notes: an observer that prints notes on standard error.
#pragma once

#include <cstdio>
#include <string>

#include "daemon/base/observer.h"

namespace rayloc::cli {

// Prints each note on a line of its own; nothing if `quiet`.
inline Observer terminal_notes(bool quiet) {
  Observer observer;
  if (!quiet) {
    observer.on_note = [](const std::string& note) { std::fprintf(stderr, "%s\n", note.c_str()); };
  }
  return observer;
}

}  // namespace rayloc::cli
