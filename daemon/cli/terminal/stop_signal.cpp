#include "daemon/cli/terminal/stop_signal.h"

#include <atomic>
#include <csignal>

namespace rayloc::cli {
namespace {

std::atomic<bool>& flag() {
  static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");
  static std::atomic<bool> requested{false};
  return requested;
}

void install_handler(void (*handler)(int)) {
  flag();  // initialised before the handler needs it
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

void StopSignal::install() {
  install_handler([](int) { flag() = true; });
}

void StopSignal::install_once() {
  install_handler([](int) {
    flag() = true;
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
  });
}

bool StopSignal::requested() { return flag(); }

void StopSignal::end_if_requested() {
  if (requested()) {
    std::signal(SIGINT, SIG_DFL);
    std::raise(SIGINT);
  }
}

}  // namespace rayloc::cli
