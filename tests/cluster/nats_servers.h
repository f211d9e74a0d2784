// NatsServers: three servers that keep each message three times, each with a network of its own:
// any of them may be killed, hang, or be cut off from the other servers, or from clients as well.
// They and all processes that the test begins are in a network of the test, which nobody else sees.
//
// Needs to be root, `ip` (iproute2), and a server that keeps what it has acknowledged when one of
// three is cut off: 2.9.10, which Debian 12 has, does not.
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

  // Why a test of them is skipped; empty: it is not.
  static std::string why_not();

  // What they store is in `folder`. Processes that are begun afterwards are in their network.
  // REQUIRES: why_not() is empty; the process has one thread.
  explicit NatsServers(const std::filesystem::path& folder);
  ~NatsServers();
  NatsServers(const NatsServers&) = delete;
  NatsServers& operator=(const NatsServers&) = delete;

  // All of them; returns when they listen. False when one does not come.
  bool start();
  NatsServer& at(std::size_t server) { return *servers_.at(server); }

  // The other servers, or nobody at all, is heard by it and hears it.
  enum class Cut { kFromServers, kFromAll };
  void cut(std::size_t server, Cut from) const;
  void join(std::size_t server) const;

  std::vector<std::string> urls() const;
  // What a server says of itself, by its port for that; empty: nothing.
  std::string monitor(std::size_t server, const std::string& path) const;
  // Of each server what it stores of each stream, a line for each; nothing where one of them does
  // not say it.
  std::vector<std::string> stored() const;

 private:
  std::array<pid_t, kCount> networks_{};  // processes that hold the networks of the servers
  std::array<std::unique_ptr<NatsServer>, kCount> servers_;
};

}  // namespace rayloc::cluster
