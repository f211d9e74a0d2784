#include "daemon/live/service/run_loop.h"

#include <algorithm>
#include <ctime>
#include <utility>

#include <spdlog/spdlog.h>

#include "daemon/live/log/log.h"
#include "daemon/live/machine/spare_memory.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

constexpr std::chrono::milliseconds kTick{1000};
constexpr std::chrono::seconds kStatusInterval{10};

// A stage counts as stuck after half the time that the manager grants; the other half is left for
// reporting it.
std::chrono::milliseconds patience(const ServiceManager& manager) {
  return manager.watchdog_period().value_or(std::chrono::seconds{20}) / 2;
}

std::string joined(const std::vector<std::string>& words, const char* between = ", ") {
  std::string list;
  for (const std::string& word : words) {
    list += (list.empty() ? "" : between) + word;
  }
  return list;
}

}  // namespace

sigset_t block_daemon_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGUSR1}) {
    sigaddset(&signals, signal);
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return signals;
}

RunLoop::RunLoop(Process& process, const ServiceManager& manager, Reloader reloader)
    : process_(process),
      manager_(manager),
      reloader_(std::move(reloader)),
      watchdog_(process.stages(), patience(manager)),
      period_(std::min(kTick, patience(manager) / 2)) {
  process_.note_reload(true, &reloader_.values());
}

std::string RunLoop::run(const sigset_t& signals) {
  const auto period = std::min(period_, process_.tend_period());
  const timespec wait{period.count() / 1000, (period.count() % 1000) * 1'000'000};
  auto next = std::chrono::steady_clock::now();
  for (;;) {
    const int signal = sigtimedwait(&signals, nullptr, &wait);
    if (signal == SIGHUP) {
      reload();
    } else if (signal == SIGUSR1) {
      snapshot("SIGUSR1");
    } else if (signal > 0) {
      log_.finish();
      return signal == SIGINT ? "SIGINT" : "SIGTERM";
    }
    if (const auto now = std::chrono::steady_clock::now(); signal > 0 || now >= next) {
      next = now + period_;
      tick();
    } else {
      tend_sites();
    }
  }
}

void RunLoop::tend_sites() {
  if (process_.tend_sites()) {
    watchdog_.replace(process_.stages());
  }
}

void RunLoop::tick() {
  // Before tend_sites(): sites ended by a reload are no longer among the stages then.
  const bool requested = process_.take_reload_request();
  if (requested || (reload_again_ && !process_.preparing_sites())) {
    reload();
  }
  tend_sites();
  for (const std::string& error : process_.new_errors()) {
    log_.add(error, {LogLevel::kError, error, {}});
  }
  for (const std::string& error : process_.ended_errors()) {
    log_.add("no longer: " + error, {LogLevel::kWarning, "no longer: " + error, {}});
  }
  log_.flush();
  for (const std::string& warning : process_.new_warnings()) {
    spdlog::warn("{}", printable(warning));
  }
  for (const std::string& line : process_.notices()) {
    spdlog::info("{}", printable(line));
  }
  process_.log_losses();
  log_readiness();
  feed_watchdog();
  const auto now = std::chrono::steady_clock::now();
  if (now >= next_status_) {
    manager_.status(process_.status_line());
    next_status_ = now + kStatusInterval;
  }
  if (now >= next_spare_) {
    give_spare_memory_back();
    next_spare_ = now + kSpareInterval;
  }
}

// Logs the state of /readyz when it changes between ready and not ready.
void RunLoop::log_readiness() {
  const Readiness now = process_.readiness();
  if (ready_ == now.ready()) {
    return;
  }
  ready_ = now.ready();
  if (now.ready()) {
    log_.add("ready", {LogLevel::kInfo, "ready: every access point sends frames", {}});
  } else {
    log_.add("not ready", {LogLevel::kWarning, "not ready: " + joined(now.reasons, "; "), {}});
  }
}

void RunLoop::feed_watchdog() {
  const std::vector<Watchdog::Stuck> stuck = watchdog_.check(std::chrono::steady_clock::now());
  std::vector<std::string> names;
  names.reserve(stuck.size());
  for (const Watchdog::Stuck& stage : stuck) {
    names.push_back(stage.stage);
  }
  process_.note_stuck(std::move(names));
  if (stuck.empty()) {
    if (stuck_) {
      spdlog::warn("watchdog: every stage makes progress again");
    }
    stuck_ = false;
    manager_.feed_watchdog();
    return;
  }
  if (stuck_) {
    return;  // already reported
  }
  stuck_ = true;
  for (const Watchdog::Stuck& stage : stuck) {
    spdlog::critical(
        "watchdog: stage '{}' has made no progress for {} ms", stage.stage, stage.since.count());
  }
  snapshot("watchdog");
  spdlog::default_logger()->flush();
}

void RunLoop::snapshot(const std::string& reason) {
  const Expected<std::vector<std::string>> files = process_.snapshot();
  if (files) {
    spdlog::info("snapshot ({}): writing {}", reason, joined(*files));
  } else {
    spdlog::warn("snapshot ({}): {}", reason, files.error().message);
  }
}

void RunLoop::reload() {
  reload_again_ = process_.preparing_sites();
  if (reload_again_) {
    spdlog::info("reload: again when the sites of the last one run");
    return;
  }
  manager_.reloading();
  Expected<Reloader::Reload> reload = reloader_.reload(process_.running());
  if (!reload) {
    spdlog::error("reload: nothing has changed, the configuration is wrong:\n{}",
                  reload.error().message);
  } else {
    set_log_level(reload->config.log);
    process_.apply(reload->config);
    process_.reload_sites(std::move(reload->sites), reload->changes.sites);
    const std::string applied = joined(reload->changes.applicable);
    spdlog::info("reload: {}", applied.empty() ? "no change" : "changed " + applied);
    if (!reload->changes.needs_restart.empty()) {
      spdlog::warn("reload: refused, these need a restart: {}",
                   joined(reload->changes.needs_restart));
    }
  }
  process_.note_reload(reload.has_value(), &reloader_.values());
  spdlog::default_logger()->flush();  // programs that wait for the reload read it next
  manager_.ready();
}

}  // namespace rayloc
