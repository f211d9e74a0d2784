#include "daemon/live/service/start_watch.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <system_error>

#include <spdlog/spdlog.h>

namespace rayloc {
namespace {

int descriptor_of_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  return signalfd(-1, &signals, SFD_CLOEXEC);
}

// Without descriptors it would neither receive signals nor ever end.
int checked(int fd) {
  if (fd < 0) {
    throw std::system_error(errno, std::generic_category(), "watching for signals");
  }
  return fd;
}

}  // namespace

StartWatch::StartWatch(const ServiceManager& manager)
    : manager_(manager),
      signals_(checked(descriptor_of_stop_signals())),
      over_(checked(eventfd(0, EFD_CLOEXEC))),
      thread_([this] { watch(); }) {}

StartWatch::~StartWatch() {
  eventfd_write(over_.get(), 1);
  thread_.join();
}

void StartWatch::watch() const {
  std::array<pollfd, 2> waiting{{{.fd = signals_.get(), .events = POLLIN, .revents = 0},
                                 {.fd = over_.get(), .events = POLLIN, .revents = 0}}};
  while (poll(waiting.data(), waiting.size(), -1) < 0) {
  }
  // A signal that arrives at the end of the start is left to the run loop.
  if (waiting[1].revents != 0) {
    return;
  }
  signalfd_siginfo signal{};
  if (read(signals_.get(), &signal, sizeof signal) != sizeof signal) {
    return;
  }
  manager_.stopping();
  spdlog::info("stopping: {}, before the daemon was ready",
               signal.ssi_signo == static_cast<unsigned>(SIGINT) ? "SIGINT" : "SIGTERM");
  spdlog::default_logger()->flush();
  // The thread that opens the process cannot be interrupted: it traces rays, or waits for a disk.
  std::_Exit(EXIT_SUCCESS);
}

}  // namespace rayloc
