// NatsServer: a real nats-server on loopback, with a folder and a port of its own, for tests of a
// cluster. RAYLOC_NATS_SERVER names another program than Debian's.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace rayloc::cluster {

class NatsServer {
 public:
  // True if a server is installed; tests are skipped otherwise.
  static bool is_installed();

  // Version of the installed server, such as "2.9.10"; empty if it prints none.
  static std::string version();

  // Address of the server, and the process whose network namespace it uses; 0: ours.
  struct Place {
    std::string host = "127.0.0.1";
    std::uint16_t port = 0;
    pid_t network = 0;
  };

  // Does not start it. It stores in `folder`/nats and listens on a free port of loopback.
  explicit NatsServer(const std::filesystem::path& folder);
  NatsServer(const std::filesystem::path& folder, Place place);
  ~NatsServer();
  NatsServer(const NatsServer&) = delete;
  NatsServer& operator=(const NatsServer&) = delete;

  // Returns once the server listens; false if it never does.
  bool start() {
    launch();
    return comes();
  }
  void launch();
  bool comes() const;
  // Ends it as a loss of power would.
  void kill();
  // Ends it as a service manager does.
  void stop();
  // Deletes all that it has stored; REQUIRES: it does not run.
  void lose_store() const;
  // Stops its execution, as if it hung, until thaw().
  void freeze() const;
  void thaw() const;

  // Later starts use this configuration file, not the options for the store; empty: none.
  void set_configuration(const std::filesystem::path& file) { configuration_ = file; }

  // Later starts refuse to store more than that [bytes].
  void limit_store(std::uint64_t memory, std::uint64_t files);

  std::string url() const { return "nats://" + place_.host + ":" + std::to_string(place_.port); }
  pid_t pid() const { return pid_; }

 private:
  void end(int signal);

  std::filesystem::path folder_;
  std::filesystem::path configuration_;
  Place place_;
  pid_t pid_ = -1;
};

// A TCP port that is free at present.
std::uint16_t free_tcp_port();

}  // namespace rayloc::cluster

// At the beginning of a test: skips it if no server is installed.
#define RAYLOC_NEEDS_NATS_SERVER()                                                  \
  if (!rayloc::cluster::NatsServer::is_installed()) {                               \
    GTEST_SKIP() << "no nats-server: install it, or name it in RAYLOC_NATS_SERVER"; \
  }
