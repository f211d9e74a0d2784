#include "daemon/cli/stop_signal.h"

#include <atomic>
#include <csignal>

namespace rayloc::cli {
namespace {

std::atomic<bool>& flag() {
  static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");
  static std::atomic<bool> requested{false};
  return requested;
}

}  // namespace

void StopSignal::install() {
  flag();  // made before the handler can need it
  struct sigaction action {};
  action.sa_handler = [](int) { flag() = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool StopSignal::requested() { return flag(); }

}  // namespace rayloc::cli
