// InboundWatch: cuts off connections that send without ever ending a message, that subscribe
// without limit, and those in excess of the maximum number.
//
// libzmq bounds the bytes of each part of a message (ZMQ_MAXMSGSIZE) and the waiting messages
// (ZMQ_RCVHWM), but not the parts: it stores a message until its last part arrives. It has no bound
// on connections either; without descriptors for another one it retries continuously. So the kernel
// is queried for the bytes read of each connection, encrypted or not. Bytes in excess of the
// messages that have reached us belong to one that has no end yet.
//
// The kernel keeps no count for ipc:// sockets: clients that may open their file are trusted.
//
// Thread safety: delivered() and cut_off() from any thread, the others from one.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string_view>

namespace rayloc {

struct InboundLimits {
  // Bytes read of one connection, and of all together, without the end of a message.
  std::uint64_t unfinished_bytes = std::uint64_t{256} << 10U;
  std::uint64_t unfinished_bytes_in_all = std::uint64_t{2} << 20U;
  // Allowance per second for bytes that are no messages: signs of life.
  std::uint64_t signs_of_life_bytes = 64;
  std::size_t connections = 512;
  // Prefixes of one subscriber, and of all: libzmq stores 200 bytes for each.
  std::uint64_t subscriptions = 10'000;
  std::uint64_t subscriptions_in_all = 100'000;
};

// As many connections as this process has descriptors for, less a reserve for other uses.
InboundLimits inbound_limits();

class InboundWatch {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit InboundWatch(InboundLimits limits) : limits_(limits) {}

  // Events of a socket's monitor about its connections. `socket`: its number; descriptors are
  // reused, and two monitors are not read in order.
  void accepted(int socket, int fd, Time now);
  void gone(int socket, int fd);

  // A part of a whole message of that connection has reached us, possibly before the monitor has
  // reported the connection.
  void delivered(int fd, std::size_t bytes);
  // The connection subscribes to a prefix, or ends a subscription. Ending a subscription that never
  // existed is allowed at any rate.
  void subscribed(int fd, std::string_view prefix, bool more);

  // Queries the kernel, and cuts off connections beyond the limits; to be called many times a
  // second while there are connections.
  void check(Time now);
  bool empty() const;

  std::uint64_t cut_off() const;

 private:
  // The monitor has not reported the connection yet: it is not checked.
  static constexpr int kUnreported = -1;
  struct Connection {
    int socket = kUnreported;
    std::uint64_t cookie = 0;    // distinguishes it from a later one with the same descriptor
    std::uint64_t read = 0;      // lower bound of the bytes read at the last check
    std::uint64_t finished = 0;  // lower bound of those in whole messages
    Time checked;
    std::multiset<std::size_t> prefixes;  // hashes

    std::uint64_t unfinished() const { return read > finished ? read - finished : 0; }
  };
  using Connections = std::map<int, Connection>;
  // The current connection with that descriptor; a new one if its messages arrive before its
  // monitor reports it. Null if it no longer exists.
  Connection* connection_of(int fd);
  void cut(Connections::iterator connection);
  // Cuts off the largest while the sum over all connections exceeds the limit.
  template <typename Amount>
  void cut_the_worst(std::uint64_t most, Amount amount);

  const InboundLimits limits_;
  mutable std::mutex mutex_;
  Connections connections_;    // by descriptor; guarded by mutex_
  std::uint64_t cut_off_ = 0;  // guarded by mutex_
};

}  // namespace rayloc
