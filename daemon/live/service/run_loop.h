// RunLoop: the loop of raylocd's main thread while the others work: signals, the watchdog, the log
// of errors, the state for the service manager, unused memory.
//
//   SIGTERM, SIGINT   the loop ends; a second one ends the process immediately
//   SIGHUP            the configuration is read again (reloader.h)
//   SIGUSR1           the recent datagrams are written (ring_snapshots.h), as on a watchdog miss
//
// Thread safety: the main thread.
#pragma once

#include <chrono>
#include <csignal>
#include <optional>
#include <string>

#include "daemon/live/health/watchdog.h"
#include "daemon/live/log/limited_log.h"
#include "daemon/live/service/process.h"
#include "daemon/live/service/reloader.h"
#include "daemon/live/service/service_manager.h"

namespace rayloc {

// Blocks the signals above in this thread and in those that it will start.
sigset_t block_daemon_signals();

class RunLoop {
 public:
  RunLoop(Process& process, const ServiceManager& manager, Reloader reloader);

  // Returns the name of the signal that ends the daemon. REQUIRES: `signals` are blocked.
  std::string run(const sigset_t& signals);

 private:
  void tick();
  void tend_sites();
  void log_readiness();
  void reload();
  void snapshot(const std::string& reason);
  void feed_watchdog();

  Process& process_;
  const ServiceManager& manager_;
  Reloader reloader_;
  Watchdog watchdog_;                 // of the current stages
  std::chrono::milliseconds period_;  // between two ticks
  std::chrono::steady_clock::time_point next_status_{};
  std::chrono::steady_clock::time_point next_spare_{};  // next return of unused memory
  bool stuck_ = false;
  bool reload_again_ = false;  // requested while sites were being prepared
  std::optional<bool> ready_;  // last logged state; empty: none logged yet
  LimitedLog log_{log_event};  // of errors: some come and go every second
};

}  // namespace rayloc
