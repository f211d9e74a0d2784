// InboundWatch: cuts off connections that send and send without ending a message, that subscribe
// and subscribe, and those that are too many.
//
// libzmq bounds the bytes of each part of a message (ZMQ_MAXMSGSIZE) and the messages that wait
// (ZMQ_RCVHWM), but not the parts: it keeps all of a message until its last one has come. Neither
// has it a bound for connections; without descriptors for a further one it tries again and again.
// So the kernel is asked how many bytes have been read of each connection, encrypted or not. What
// is more than the messages that have reached us belongs to one that has no end yet.
//
// Of ipc:// sockets the kernel keeps no count: who may open their file is trusted.
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
  // Read of one connection, and of all together, without the end of a message.
  std::uint64_t unfinished_bytes = std::uint64_t{256} << 10U;
  std::uint64_t unfinished_bytes_in_all = std::uint64_t{2} << 20U;
  // A second, which are no messages: signs of life.
  std::uint64_t signs_of_life_bytes = 64;
  std::size_t connections = 512;
  // Prefixes of one subscriber, and of all: libzmq keeps 200 bytes for each.
  std::uint64_t subscriptions = 10'000;
  std::uint64_t subscriptions_in_all = 100'000;
};

// As many connections as this process has descriptors for, and leaves some for everything else.
InboundLimits inbound_limits();

class InboundWatch {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit InboundWatch(InboundLimits limits) : limits_(limits) {}

  // What the monitor of a socket says of its connections. `socket`: which one it is; descriptors
  // are used again, and two monitors are not read in order.
  void accepted(int socket, int fd, Time now);
  void gone(int socket, int fd);

  // A part of a whole message of that connection has reached us, maybe before we have heard of the
  // connection.
  void delivered(int fd, std::size_t bytes);
  // It subscribes to a prefix, or no longer. What it never subscribed to may end as often as it
  // likes.
  void subscribed(int fd, std::string_view prefix, bool more);

  // Asks the kernel, and cuts off who has gone too far; to be called many times a second while
  // there are connections.
  void look(Time now);
  bool empty() const;

  std::uint64_t cut_off() const;

 private:
  // The monitor has not told of the connection yet: it is not judged.
  static constexpr int kNotTold = -1;
  struct Connection {
    int socket = kNotTold;
    std::uint64_t cookie = 0;    // tells it from a later one with the same descriptor
    std::uint64_t read = 0;      // bytes, at least, when it was last looked at
    std::uint64_t finished = 0;  // of those, in whole messages, at least
    Time looked;
    std::multiset<std::size_t> prefixes;  // hashes

    std::uint64_t unfinished() const { return read > finished ? read - finished : 0; }
  };
  using Connections = std::map<int, Connection>;
  // The one with that descriptor now; a new one if messages of it come before its monitor tells of
  // it. Null if there is none any more.
  Connection* connection_of(int fd);
  void cut(Connections::iterator connection);
  // While all together have more than that of it.
  template <typename Amount>
  void cut_the_worst(std::uint64_t most, Amount amount);

  const InboundLimits limits_;
  mutable std::mutex mutex_;
  Connections connections_;    // by descriptor; guarded by mutex_
  std::uint64_t cut_off_ = 0;  // guarded by mutex_
};

}  // namespace rayloc
