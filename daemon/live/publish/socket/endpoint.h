// Endpoints: the supported ZeroMQ addresses, and messages for those that do not work.
#pragma once

#include <string>

#include "engine/base/expected.h"

namespace rayloc {

// tcp:// and ipc:// only: ws:// is a draft of libzmq 4.3, the others reach no other process. Errors
// carry `kind`.
Expected<void> check_endpoint(const std::string& endpoint, ErrorKind kind);

// Returns true for tcp://.
bool is_tcp(const std::string& endpoint);

// Returns true if a program listens on this ipc:// endpoint. libzmq would silently delete its
// socket file and replace it. False for tcp://, where bind itself fails.
bool ipc_in_use(const std::string& endpoint);

// The error for `endpoint`, from the errno of libzmq; `verb`: "bind", "connect to".
Error endpoint_error(const std::string& endpoint, const std::string& verb, int number);

}  // namespace rayloc
