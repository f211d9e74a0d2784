// ServiceManager: messages to systemd, and the sockets that it passes (sd_notify(3),
// sd_listen_fds(3)). Without a service manager messages are dropped and there are no sockets.
//
// Thread safety: one thread.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "engine/base/expected.h"

namespace rayloc {

class ServiceManager {
 public:
  // Reads and removes the environment variables, so that children do not inherit them.
  ServiceManager();

  void ready() const;
  void reloading() const;
  void stopping() const;
  // One line for `systemctl status`.
  void status(const std::string& line) const;
  // Reports that the daemon is alive.
  void feed_watchdog() const;

  // The manager's watchdog period; empty if it has none.
  std::optional<std::chrono::milliseconds> watchdog_period() const { return watchdog_period_; }

 private:
  std::optional<std::chrono::milliseconds> watchdog_period_;
};

// Sockets bound by systemd, by their FileDescriptorName=. A socket belongs to the caller that takes
// it.
class PassedSockets {
 public:
  // kConfiguration: two sockets have one name.
  static Expected<PassedSockets> take();

  // The descriptor; empty when there is none of that name.
  std::optional<int> find(const std::string& name) const;
  std::optional<int> take(const std::string& name);
  // Names that were not taken: for the log.
  std::string unused() const;
  bool empty() const { return sockets_.empty(); }

 private:
  std::map<std::string, int> sockets_;
};

}  // namespace rayloc
