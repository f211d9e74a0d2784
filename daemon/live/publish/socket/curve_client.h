// Sets a client's keys on its socket. For the .cpp files of this folder: brings zmq.
#pragma once

#include <optional>

#include <zmq.hpp>

#include "daemon/live/publish/socket/curve_keys.h"

namespace rayloc {

// To be called before the socket is connected; without keys it has no effect.
inline void use_curve(const std::optional<CurveClientKeys>& keys, zmq::socket_t& socket) {
  if (keys) {
    socket.set(zmq::sockopt::curve_serverkey, keys->server_key);
    socket.set(zmq::sockopt::curve_publickey, keys->own.public_key);
    socket.set(zmq::sockopt::curve_secretkey, keys->own.secret_key);
  }
}

}  // namespace rayloc
