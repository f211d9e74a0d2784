// ConnectionGuard: who may connect to the sockets that we bind, and what became of those who tried.
//
// With keys, every socket speaks CURVE: nothing is readable on the wire, and a client is let in
// when it proves to have the secret of a public key on the allow list (ZAP, RFC 27). Without, all
// who reach the sockets are let in. Either way connections that break off their handshake (another
// protocol, a wrong server key, a scan of ports) are counted, and who sends without ending a
// message is cut off (InboundWatch).
//
// It lends the sockets their context and serves ZAP on a thread of its own, and so outlives them.
// For the .cpp files of this folder: the zmq part. Thread safety: secure() and release() before
// and after the socket's life in its own thread; the others from any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "daemon/publish/socket/curve_keys.h"

namespace zmq {
class context_t;
class message_t;
class socket_t;
}  // namespace zmq

namespace rayloc {

struct GuardCounters {
  std::uint64_t clients_admitted = 0;   // by CURVE, each connection
  std::uint64_t clients_denied = 0;     // whose key is not on the list
  std::uint64_t handshakes_failed = 0;  // connections that did not become any, the denied included
  std::uint64_t clients_cut_off = 0;    // by InboundWatch
};

class ConnectionGuard {
 public:
  struct Options {
    std::string secret_key = {};          // of the server; empty: no CURVE
    std::vector<std::string> allow = {};  // public keys
    // Called on the guard's thread for every denial; must not block.
    std::function<void(const std::string& public_key, const std::string& address)> on_denied = {};
    // Called there each time that its loop comes round, several times a second.
    std::function<void()> on_round = {};
  };

  explicit ConnectionGuard(Options options);
  ~ConnectionGuard();
  ConnectionGuard(const ConnectionGuard&) = delete;
  ConnectionGuard& operator=(const ConnectionGuard&) = delete;

  // From now on; connections that exist stay.
  void allow(const std::vector<std::string>& public_keys);
  GuardCounters counters() const;

  zmq::context_t& context();
  // Before the socket is bound.
  void secure(zmq::socket_t& socket);
  // Of every part of what a socket has received.
  void delivered(zmq::message_t& part);
  // Of a subscription that begins, or ends: its first byte says so, the prefix follows.
  void subscribed(zmq::message_t& part, bool more);
  // Before it is closed.
  static void release(zmq::socket_t& socket);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// The guard given, else one that lets everyone in.
std::shared_ptr<ConnectionGuard> guard_or_open_door(std::shared_ptr<ConnectionGuard> guard);

}  // namespace rayloc
