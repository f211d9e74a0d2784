// StartWatch: ends the process immediately, with status 0, when SIGTERM or SIGINT arrives while the
// daemon is being opened: reading a calibrated site and tracing its room take seconds to minutes,
// and the main thread then awaits no signals. No data have been received by then, so none are lost.
//
//   const sigset_t signals = block_daemon_signals();
//   auto watch = std::make_unique<StartWatch>(manager);
//   ... open ...
//   watch.reset();  // from here on RunLoop handles signals; earlier ones wait for it
#pragma once

#include <thread>

#include "capture/transport/file_descriptor.h"
#include "daemon/live/service/service_manager.h"

namespace rayloc {

class StartWatch {
 public:
  // REQUIRES: the signals are blocked, the log is set up; `manager` outlives the watch. Throws
  // std::system_error when there is no descriptor or thread for it.
  explicit StartWatch(const ServiceManager& manager);
  ~StartWatch();
  StartWatch(const StartWatch&) = delete;
  StartWatch& operator=(const StartWatch&) = delete;

 private:
  void watch() const;

  const ServiceManager& manager_;
  const FileDescriptor signals_;
  const FileDescriptor over_;
  std::thread thread_;
};

}  // namespace rayloc
