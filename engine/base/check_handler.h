// set_check_handler: sets a function that is called when a RAYLOC_CHECK fails, before the program
// stops. For an engine inside the process of another program, such as Python.
#pragma once

#include <string>

namespace rayloc {

// `message`: "FILE:LINE: check failed: CONDITION". It may throw; the exception passes through
// parallel_for to the caller of the engine. If it returns, the program stops.
using CheckHandler = void (*)(const std::string& message);

// Null: the program stops at once, as without a handler. Call it before other threads use the
// engine. An exception of the handler leaves the object that failed in an unknown state: it must
// not be used any more.
void set_check_handler(CheckHandler handler);

}  // namespace rayloc
