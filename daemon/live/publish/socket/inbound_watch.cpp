#include "daemon/live/publish/socket/inbound_watch.h"

#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <optional>

namespace rayloc {
namespace {

// Maximum bytes that frames and CURVE add to a part.
constexpr std::uint64_t kFraming = 64;
// Descriptors for recordings, HTTP and libzmq itself.
constexpr std::size_t kOtherDescriptors = 160;

std::optional<std::uint64_t> cookie_of(int fd) {
  std::uint64_t cookie = 0;
  socklen_t size = sizeof cookie;
  const int known = getsockopt(fd, SOL_SOCKET, SO_COOKIE, &cookie, &size);
  return known == 0 ? std::optional(cookie) : std::nullopt;
}

std::optional<std::uint64_t> bytes_received(int fd) {
  tcp_info info{};
  socklen_t size = sizeof info;
  constexpr std::size_t kNeeded = offsetof(tcp_info, tcpi_bytes_received) + sizeof(std::uint64_t);
  const bool known = getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 && size >= kNeeded;
  return known ? std::optional<std::uint64_t>(info.tcpi_bytes_received) : std::nullopt;
}

// Bounds of the bytes that libzmq has read: the kernel reports the received bytes and the waiting
// bytes one after the other, and on a busy machine megabytes may arrive in between. Empty if it is
// no TCP connection.
struct BytesRead {
  std::uint64_t least = 0;
  std::uint64_t most = 0;
};

BytesRead bytes_read(int fd) {
  int unread = 0;
  const std::optional<std::uint64_t> before = bytes_received(fd);
  const bool counted = ioctl(fd, FIONREAD, &unread) == 0;
  const std::optional<std::uint64_t> after = bytes_received(fd);
  if (!before || !counted || !after) {
    return {};
  }
  const auto waiting = static_cast<std::uint64_t>(std::max(unread, 0));
  return {*before - std::min(*before, waiting), *after - std::min(*after, waiting)};
}

}  // namespace

InboundLimits inbound_limits() {
  InboundLimits limits;
  rlimit descriptors{};
  if (getrlimit(RLIMIT_NOFILE, &descriptors) == 0 && descriptors.rlim_cur != RLIM_INFINITY) {
    const auto all = static_cast<std::size_t>(descriptors.rlim_cur);
    limits.connections = std::max(all / 4, all - std::min(all, kOtherDescriptors));
  }
  return limits;
}

InboundWatch::Connection* InboundWatch::connection_of(int fd) {
  const std::optional<std::uint64_t> cookie = cookie_of(fd);
  if (!cookie) {
    return nullptr;
  }
  Connection& connection = connections_[fd];
  if (connection.cookie != *cookie) {
    connection = Connection{};
    connection.cookie = *cookie;
  }
  return &connection;
}

void InboundWatch::accepted(int socket, int fd, Time now) {
  const std::lock_guard lock(mutex_);
  Connection* const connection = connection_of(fd);
  if (connection == nullptr) {
    return;  // it has already been closed
  }
  connection->socket = socket;
  connection->checked = now;
  if (connections_.size() > limits_.connections ||
      connection->prefixes.size() > limits_.subscriptions) {
    cut(connections_.find(fd));
  }
}

void InboundWatch::gone(int socket, int fd) {
  const std::lock_guard lock(mutex_);
  const auto found = connections_.find(fd);
  if (found != connections_.end() && found->second.socket == socket) {
    connections_.erase(found);
  }
}

void InboundWatch::delivered(int fd, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  if (Connection* const connection = connection_of(fd)) {
    connection->finished += bytes + kFraming;
  }
}

void InboundWatch::subscribed(int fd, std::string_view prefix, bool more) {
  const std::lock_guard lock(mutex_);
  Connection* const connection = connection_of(fd);
  if (connection == nullptr) {
    return;
  }
  std::multiset<std::size_t>& prefixes = connection->prefixes;
  const std::size_t hash = std::hash<std::string_view>()(prefix);
  if (more) {
    prefixes.insert(hash);
  } else if (const auto known = prefixes.find(hash); known != prefixes.end()) {
    prefixes.erase(known);
  }
  if (connection->socket != kUnreported && prefixes.size() > limits_.subscriptions) {
    cut(connections_.find(fd));
  }
}

void InboundWatch::check(Time now) {
  const std::lock_guard lock(mutex_);
  for (auto it = connections_.begin(); it != connections_.end();) {
    const auto here = it++;
    Connection& connection = here->second;
    if (cookie_of(here->first) != connection.cookie) {
      connections_.erase(here);
      continue;
    }
    if (connection.socket == kUnreported) {
      continue;
    }
    const std::chrono::duration<double> elapsed = now - connection.checked;
    connection.checked = now;
    const BytesRead read = bytes_read(here->first);
    connection.read = read.least;
    // Future messages give no credit in advance, and received messages are never discounted, so the
    // upper bound is used.
    connection.finished =
        std::min(read.most,
                 connection.finished +
                     static_cast<std::uint64_t>(elapsed.count() *
                                                static_cast<double>(limits_.signs_of_life_bytes)));
    if (connection.unfinished() > limits_.unfinished_bytes) {
      cut(here);
    }
  }
  cut_the_worst(limits_.unfinished_bytes_in_all,
                [](const Connection& connection) { return connection.unfinished(); });
  cut_the_worst(limits_.subscriptions_in_all, [](const Connection& connection) {
    return connection.socket == kUnreported ? 0 : connection.prefixes.size();
  });
}

template <typename Amount>
void InboundWatch::cut_the_worst(std::uint64_t most, Amount amount) {
  const auto less = [&](const Connections::value_type& a, const Connections::value_type& b) {
    return amount(a.second) < amount(b.second);
  };
  std::uint64_t sum = 0;
  for (const auto& [fd, connection] : connections_) {
    sum += amount(connection);
  }
  while (sum > most) {
    const auto worst = std::max_element(connections_.begin(), connections_.end(), less);
    sum -= amount(worst->second);
    cut(worst);
  }
}

// libzmq detects the end, frees its stored parts and closes the descriptor; the peer is notified by
// a reset, otherwise it would wait for room for its unsent data.
void InboundWatch::cut(Connections::iterator connection) {
  constexpr linger kReset{1, 0};
  setsockopt(connection->first, SOL_SOCKET, SO_LINGER, &kReset, sizeof kReset);
  shutdown(connection->first, SHUT_RDWR);
  connections_.erase(connection);
  ++cut_off_;
}

bool InboundWatch::empty() const {
  const std::lock_guard lock(mutex_);
  return connections_.empty();
}

std::uint64_t InboundWatch::cut_off() const {
  const std::lock_guard lock(mutex_);
  return cut_off_;
}

}  // namespace rayloc
