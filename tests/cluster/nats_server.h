// NatsServer: a real nats-server on loopback, with a folder and a port of its own, for tests of a
// cluster. RAYLOC_NATS_SERVER names another program than Debian's.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

namespace rayloc::cluster {

class NatsServer {
 public:
  // Whether there is one; tests are skipped where there is none.
  static bool is_installed();

  // Of the installed one: {2, 9} for 2.9.10; {0, 0} where it does not say.
  static std::pair<int, int> version();

  // Where it listens, and the process whose network it is in; 0: ours.
  struct Place {
    std::string host = "127.0.0.1";
    std::uint16_t port = 0;
    pid_t network = 0;
  };

  // Not started. What it stores is in `folder`/nats. On loopback, on a port that nobody uses now.
  explicit NatsServer(const std::filesystem::path& folder);
  NatsServer(const std::filesystem::path& folder, Place place);
  ~NatsServer();
  NatsServer(const NatsServer&) = delete;
  NatsServer& operator=(const NatsServer&) = delete;

  // Returns when it listens; false when it does not come.
  bool start() {
    launch();
    return comes();
  }
  void launch();
  bool comes() const;
  // As a machine that loses its power.
  void kill();
  // As a service manager ends it.
  void stop();
  // Everything that it has stored; REQUIRES: it does not run.
  void lose_store() const;
  // As one that hangs, until it is continued.
  void freeze() const;
  void thaw() const;

  // From its next start it reads this file, which says what it stores where.
  void set_configuration(const std::filesystem::path& file) { configuration_ = file; }

  std::string url() const { return "nats://" + place_.host + ":" + std::to_string(place_.port); }
  pid_t pid() const { return pid_; }

 private:
  void end(int signal);

  std::filesystem::path folder_;
  std::filesystem::path configuration_;
  Place place_;
  pid_t pid_ = -1;
};

// A port of TCP that nobody uses now.
std::uint16_t free_tcp_port();

}  // namespace rayloc::cluster

// At the beginning of a test.
#define RAYLOC_NEEDS_NATS_SERVER()                                                  \
  if (!rayloc::cluster::NatsServer::is_installed()) {                               \
    GTEST_SKIP() << "no nats-server: install it, or name it in RAYLOC_NATS_SERVER"; \
  }
