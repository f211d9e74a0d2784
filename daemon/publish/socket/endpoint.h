// Endpoints: which ZeroMQ addresses we use, and what to say when one does not work.
#pragma once

#include <string>

#include "engine/base/expected.h"

namespace rayloc {

// tcp:// and ipc:// alone: ws:// is a draft of libzmq 4.3, the others reach nobody outside.
// Errors carry `kind`.
Expected<void> check_endpoint(const std::string& endpoint, ErrorKind kind);

// Whether it is a tcp:// one.
bool is_tcp(const std::string& endpoint);

// A program listens on this ipc:// endpoint. libzmq would delete its socket file and take its
// place without a word. False of tcp://, where bind itself fails.
bool ipc_in_use(const std::string& endpoint);

// What went wrong with `endpoint`, from the errno of libzmq; `verb`: "bind", "connect to".
Error endpoint_error(const std::string& endpoint, const std::string& verb, int number);

}  // namespace rayloc
