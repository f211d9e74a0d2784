// ConnectionGuard: access control for the sockets that we bind, and counters of its decisions.
//
// With keys, every socket uses CURVE: nothing is readable on the wire, and a client is accepted if
// it proves possession of the secret of a public key on the allow list (ZAP, RFC 27). Without keys,
// all clients that reach the sockets are accepted. Either way connections that break off their
// handshake (another protocol, a wrong server key, a port scan) are counted, and a client that
// sends without ending a message is cut off (InboundWatch).
//
// It owns the context of the sockets and serves ZAP on its own thread, and so outlives them. For
// the .cpp files of this folder: the zmq part. Thread safety: secure() and release() before and
// after the socket's life in its own thread; the others from any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "daemon/live/publish/socket/curve_keys.h"

namespace zmq {
class context_t;
class message_t;
class socket_t;
}  // namespace zmq

namespace rayloc {

struct GuardCounters {
  std::uint64_t clients_admitted = 0;   // connections admitted by CURVE
  std::uint64_t clients_denied = 0;     // clients whose key is not on the list
  std::uint64_t handshakes_failed = 0;  // failed handshakes, including denied clients
  std::uint64_t clients_cut_off = 0;    // connections cut off by InboundWatch
};

class ConnectionGuard {
 public:
  struct Options {
    std::string secret_key = {};          // key of the server; empty: no CURVE
    std::vector<std::string> allow = {};  // public keys
    // Called on the guard's thread for every denial; must not block.
    std::function<void(const std::string& public_key, const std::string& address)> on_denied = {};
    // Called on that thread in each iteration of its loop, several times a second.
    std::function<void()> on_round = {};
  };

  explicit ConnectionGuard(Options options);
  ~ConnectionGuard();
  ConnectionGuard(const ConnectionGuard&) = delete;
  ConnectionGuard& operator=(const ConnectionGuard&) = delete;

  // Replaces the allow list; existing connections remain.
  void allow(const std::vector<std::string>& public_keys);
  GuardCounters counters() const;

  zmq::context_t& context();
  // To be called before the socket is bound.
  void secure(zmq::socket_t& socket);
  // To be called for every part that a socket has received.
  void delivered(zmq::message_t& part);
  // To be called for each subscription that begins or ends: flag in the first byte, then prefix.
  void subscribed(zmq::message_t& part, bool more);
  // To be called before it is closed.
  static void release(zmq::socket_t& socket);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// Returns the guard given, or one that accepts every client if it is null.
std::shared_ptr<ConnectionGuard> guard_or_open_door(std::shared_ptr<ConnectionGuard> guard);

}  // namespace rayloc
