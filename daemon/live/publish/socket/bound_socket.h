// Binds a ZeroMQ socket to one of our endpoints. For the .cpp files of this folder: brings zmq.
#pragma once

#include <string>

#include <zmq.hpp>

#include "engine/base/expected.h"

namespace rayloc {

// Returns the bound endpoint, with the selected port. `adopted_fd`: a listening socket to use
// instead of the endpoint's address, -1 for none. kConfiguration for an invalid endpoint,
// kUnavailable for one that is in use or cannot be bound.
Expected<std::string> bind_socket(zmq::socket_t& socket,
                                  const std::string& endpoint,
                                  int adopted_fd);

}  // namespace rayloc
