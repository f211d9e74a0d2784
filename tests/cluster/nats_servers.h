// NatsServers: three servers that keep three copies of each message, each with its own network: any
// of them may be killed, hang, or be cut off from the other servers, or from clients as well. The
// servers and all processes that the test begins are in a network namespace of the test.
//
// Requires root, `ip` (iproute2), and nats-server 2.14.6 or newer: 2.9.10, the version in Debian
// 12, loses acknowledged messages when one of three is cut off, and 2.14.5 answers no direct get on
// a follower that was a candidate.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/cluster/nats_server.h"

namespace rayloc::cluster {

class NatsServers {
 public:
  static constexpr std::size_t kCount = 3;

  // The reason to skip a test of them; empty: none.
  static std::string why_not();

  // They store in `folder`. Processes that are begun afterwards share their network.
  // REQUIRES: why_not() is empty; the process has one thread.
  explicit NatsServers(const std::filesystem::path& folder);
  ~NatsServers();
  NatsServers(const NatsServers&) = delete;
  NatsServers& operator=(const NatsServers&) = delete;

  // Starts all servers, and returns once they listen. False if one of them does not.
  bool start();
  NatsServer& at(std::size_t server) { return *servers_.at(server); }

  // Cuts the links of a server to the other servers, or all its links.
  enum class Cut { kFromServers, kFromAll };
  void cut(std::size_t server, Cut from) const;
  void join(std::size_t server) const;

  std::vector<std::string> urls() const;
  // The answer of a server's monitoring port for this path; empty: none.
  std::string monitor(std::size_t server, const std::string& path) const;
  // For each server, the state of its streams, a line for each stream; nothing if a server does not
  // answer.
  std::vector<std::string> stored() const;

 private:
  std::array<pid_t, kCount> networks_{};  // processes that hold the networks of the servers
  std::array<std::unique_ptr<NatsServer>, kCount> servers_;
};

}  // namespace rayloc::cluster
