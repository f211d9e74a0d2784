#include "daemon/publish/inbound_watch.h"

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

// What frames and CURVE add to a part, at most.
constexpr std::uint64_t kFraming = 64;
// Recordings, HTTP and libzmq itself.
constexpr std::size_t kOtherDescriptors = 160;

std::optional<std::uint64_t> cookie_of(int fd) {
  std::uint64_t cookie = 0;
  socklen_t size = sizeof cookie;
  const int known = getsockopt(fd, SOL_SOCKET, SO_COOKIE, &cookie, &size);
  return known == 0 ? std::optional(cookie) : std::nullopt;
}

// Bytes that libzmq has read; nothing of what is no TCP connection.
std::optional<std::uint64_t> bytes_read(int fd) {
  tcp_info info{};
  socklen_t size = sizeof info;
  int unread = 0;
  constexpr std::size_t kNeeded = offsetof(tcp_info, tcpi_bytes_received) + sizeof(std::uint64_t);
  if (getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 || size < kNeeded ||
      ioctl(fd, FIONREAD, &unread) != 0) {
    return std::nullopt;
  }
  // Between the two calls more may have come.
  const auto waiting = std::min<std::uint64_t>(info.tcpi_bytes_received,
                                               static_cast<std::uint64_t>(std::max(unread, 0)));
  return info.tcpi_bytes_received - waiting;
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

void InboundWatch::accepted(int socket, int fd, Time now) {
  const std::optional<std::uint64_t> cookie = cookie_of(fd);
  if (!cookie) {
    return;  // it has gone already
  }
  const std::lock_guard lock(mutex_);
  const auto connection = connections_.insert_or_assign(fd, Connection{}).first;
  connection->second.socket = socket;
  connection->second.cookie = *cookie;
  connection->second.looked = now;
  if (connections_.size() > limits_.connections) {
    cut(connection);
  }
}

// libzmq bounds a handshake, and asks for its end in time.
void InboundWatch::shook_hands(int socket, int fd) {
  const std::lock_guard lock(mutex_);
  const auto found = connections_.find(fd);
  if (found != connections_.end() && found->second.socket == socket) {
    found->second.finished = std::max(found->second.finished, bytes_read(fd).value_or(0));
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
  const auto found = connections_.find(fd);
  if (found != connections_.end()) {
    found->second.finished += bytes + kFraming;
  }
}

void InboundWatch::subscribed(int fd, std::string_view prefix, bool more) {
  const std::lock_guard lock(mutex_);
  const auto found = connections_.find(fd);
  if (found == connections_.end()) {
    return;
  }
  std::multiset<std::size_t>& prefixes = found->second.prefixes;
  const std::size_t hash = std::hash<std::string_view>()(prefix);
  if (more) {
    prefixes.insert(hash);
  } else if (const auto known = prefixes.find(hash); known != prefixes.end()) {
    prefixes.erase(known);
  }
  if (prefixes.size() > limits_.subscriptions) {
    cut(found);
  }
}

void InboundWatch::look(Time now) {
  const std::lock_guard lock(mutex_);
  for (auto it = connections_.begin(); it != connections_.end();) {
    const auto here = it++;
    Connection& connection = here->second;
    if (cookie_of(here->first) != connection.cookie) {
      connections_.erase(here);
      continue;
    }
    const std::chrono::duration<double> elapsed = now - connection.looked;
    connection.looked = now;
    connection.read = bytes_read(here->first).value_or(0);
    // Of what comes later nothing is forgiven in advance.
    connection.finished =
        std::min(connection.read,
                 connection.finished +
                     static_cast<std::uint64_t>(elapsed.count() *
                                                static_cast<double>(limits_.signs_of_life_bytes)));
    if (connection.unfinished() > limits_.unfinished_bytes) {
      cut(here);
    }
  }
  cut_the_worst(limits_.unfinished_bytes_in_all,
                [](const Connection& connection) { return connection.unfinished(); });
  cut_the_worst(limits_.subscriptions_in_all,
                [](const Connection& connection) { return connection.prefixes.size(); });
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

// libzmq notices the end, gives back what it has kept and closes the descriptor; the other side is
// told by a reset, else it would wait for room for what it has not yet sent.
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
