#include "daemon/live/service/service_manager.h"

#include <fcntl.h>
#include <systemd/sd-daemon.h>

#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <memory>

namespace rayloc {
namespace {

std::uint64_t monotonic_microseconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000U +
         static_cast<std::uint64_t>(now.tv_nsec) / 1'000U;
}

}  // namespace

ServiceManager::ServiceManager() {
  std::uint64_t microseconds = 0;
  if (sd_watchdog_enabled(1, &microseconds) > 0) {
    watchdog_period_ = std::chrono::milliseconds(microseconds / 1000U);
  }
}

void ServiceManager::ready() const { sd_notify(0, "READY=1"); }

void ServiceManager::reloading() const {
  // systemd 253 and later (Type=notify-reload) require the time as well.
  const std::string message =
      "RELOADING=1\nMONOTONIC_USEC=" + std::to_string(monotonic_microseconds());
  sd_notify(0, message.c_str());
}

void ServiceManager::stopping() const { sd_notify(0, "STOPPING=1"); }

void ServiceManager::status(const std::string& line) const {
  sd_notify(0, ("STATUS=" + line).c_str());
}

void ServiceManager::feed_watchdog() const {
  if (watchdog_period_) {
    sd_notify(0, "WATCHDOG=1");
  }
}

Expected<PassedSockets> PassedSockets::take() {
  PassedSockets passed;
  char** names = nullptr;
  const int count = sd_listen_fds_with_names(1, &names);
  Expected<void> result;
  for (int i = 0; i < count; ++i) {
    const int fd = SD_LISTEN_FDS_START + i;
    const std::string name = names != nullptr ? names[i] : "";
    if (!passed.sockets_.emplace(name, fd).second) {
      result = make_error(ErrorKind::kConfiguration,
                          "systemd passed two sockets with the name '" + name +
                              "'; give each .socket unit a FileDescriptorName= of its own");
    }
  }
  for (int i = 0; names != nullptr && names[i] != nullptr; ++i) {
    std::free(names[i]);  // NOLINT(cppcoreguidelines-no-malloc): sd_listen_fds(3)
  }
  std::free(names);  // NOLINT(cppcoreguidelines-no-malloc)
  RAYLOC_TRY(result);
  return passed;
}

std::optional<int> PassedSockets::find(const std::string& name) const {
  const auto found = sockets_.find(name);
  return found == sockets_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<int> PassedSockets::take(const std::string& name) {
  const std::optional<int> fd = find(name);
  sockets_.erase(name);
  return fd;
}

std::string PassedSockets::unused() const {
  std::string names;
  for (const auto& [name, fd] : sockets_) {
    names += (names.empty() ? "" : ", ") + name;
  }
  return names;
}

}  // namespace rayloc
