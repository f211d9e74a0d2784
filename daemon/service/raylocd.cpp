// raylocd: the daemon. Reads CSI datagrams, publishes locations, until it is told to stop.
#include <csignal>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>
#include <CLI/CLI.hpp>

#include "daemon/service/exit_status.h"
#include "daemon/service/service.h"

namespace rayloc {
namespace {

constexpr auto kDrainPatience = std::chrono::milliseconds(4000);

spdlog::level::level_enum log_level(LogLevel level) {
  switch (level) {
    case LogLevel::kTrace:
      return spdlog::level::trace;
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::info;
}

void set_up_log(const LogConfig& config) {
  auto logger = spdlog::stderr_color_mt("raylocd");
  logger->set_level(log_level(config.level));
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %^%l%$ %v", spdlog::pattern_time_type::utc);
  spdlog::set_default_logger(std::move(logger));
}

// The signals that end the daemon, blocked in every thread, so that this one waits for them.
sigset_t block_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return signals;
}

// Returns the name of the signal that came.
std::string wait_for_stop(const sigset_t& signals, Service& service) {
  for (;;) {
    const timespec second{1, 0};
    const int signal = sigtimedwait(&signals, nullptr, &second);
    if (signal > 0) {
      return signal == SIGINT ? "SIGINT" : "SIGTERM";
    }
    for (const std::string& error : service.new_errors()) {
      spdlog::error("{}", error);
    }
    for (const std::string& warning : service.new_warnings()) {
      spdlog::warn("{}", warning);
    }
  }
}

Expected<void> serve(const std::string& file) {
  const sigset_t signals = block_stop_signals();
  Expected<DaemonSetup> setup = load_daemon_setup(file);
  if (!setup) {
    return tl::make_unexpected(setup.error());
  }
  set_up_log(setup->config.log);
  spdlog::info("raylocd {}: preparing the room of site '{}'", RAYLOC_VERSION, setup->site.name);
  Expected<std::unique_ptr<Service>> opened = Service::open(std::move(*setup));
  if (!opened) {
    return tl::make_unexpected(opened.error());
  }
  Service& service = **opened;
  service.start();
  for (const std::string& line : service.source_descriptions()) {
    spdlog::info("listening: {}", line);
  }
  spdlog::info("ready: publishing at {}", service.endpoint());
  sd_notify(0, "READY=1");
  const std::string reason = wait_for_stop(signals, service);
  sd_notify(0, "STOPPING=1");
  spdlog::info("stopping: {}", reason);
  // A second signal ends the daemon at once.
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  service.stop(reason, kDrainPatience);
  spdlog::info("stopped");
  return {};
}

int run(int argc, const char* const* argv) {
  CLI::App app{"Wi-Fi localization daemon: CSI datagrams in, locations out over ZeroMQ", "raylocd"};
  app.set_version_flag("--version", "raylocd " RAYLOC_VERSION);
  app.footer("Example:\n  raylocd --config /etc/raylocd/raylocd.toml");
  std::string file;
  app.add_option("--config", file, "configuration (TOML); `rayloc config default` prints one")
      ->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  }
  const Expected<void> served = serve(file);
  if (!served) {
    // Errors of a configuration begin with file:line:column, one a line, as editors read them.
    const bool placed = served.error().kind == ErrorKind::kConfiguration;
    std::fprintf(stderr, "%s%s\n", placed ? "" : "raylocd: ", served.error().message.c_str());
    return exit_status(served.error().kind);
  }
  return 0;
}

}  // namespace
}  // namespace rayloc

int main(int argc, char** argv) {
  try {
    return rayloc::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "raylocd: internal error: %s\n", error.what());
    return rayloc::kExitInternal;
  }
}
