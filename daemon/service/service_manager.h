// ServiceManager: what raylocd says to systemd, and the sockets that it is given (sd_notify(3),
// sd_listen_fds(3)). Without a service manager every message is dropped and there are no sockets.
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
  // Takes the environment; children are not to find it.
  ServiceManager();

  void ready() const;
  void reloading() const;
  void stopping() const;
  // One line for `systemctl status`.
  void status(const std::string& line) const;
  // I am well.
  void feed_watchdog() const;

  // How often the manager wants to be fed; nothing when it does not.
  std::optional<std::chrono::milliseconds> watchdog_period() const { return watchdog_period_; }

 private:
  std::optional<std::chrono::milliseconds> watchdog_period_;
};

// Sockets that systemd bound for us, by their FileDescriptorName=. A socket belongs to who takes
// it.
class PassedSockets {
 public:
  // kConfiguration: two sockets have one name.
  static Expected<PassedSockets> take();

  // The descriptor, nothing when there is none of that name.
  std::optional<int> find(const std::string& name) const;
  std::optional<int> take(const std::string& name);
  // Names that nobody took: for the log.
  std::string unused() const;
  bool empty() const { return sockets_.empty(); }

 private:
  std::map<std::string, int> sockets_;
};

}  // namespace rayloc
