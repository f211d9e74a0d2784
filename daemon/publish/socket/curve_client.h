// The keys of a client on its socket. For the .cpp files of this folder: brings zmq.
#pragma once

#include <optional>

#include <zmq.hpp>

#include "daemon/publish/socket/curve_keys.h"

namespace rayloc {

// Before the socket is connected; nothing without keys.
inline void use_curve(const std::optional<CurveClientKeys>& keys, zmq::socket_t& socket) {
  if (keys) {
    socket.set(zmq::sockopt::curve_serverkey, keys->server_key);
    socket.set(zmq::sockopt::curve_publickey, keys->own.public_key);
    socket.set(zmq::sockopt::curve_secretkey, keys->own.secret_key);
  }
}

}  // namespace rayloc
