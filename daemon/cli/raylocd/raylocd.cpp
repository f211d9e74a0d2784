// raylocd: the daemon. Reads CSI datagrams and publishes locations until it is stopped.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <spdlog/spdlog.h>

#include "daemon/base/exit_status.h"
#include "daemon/cli/command/option_parser.h"
#include "daemon/live/log/log.h"
#include "daemon/live/machine/spare_memory.h"
#include "daemon/live/machine/start_resources.h"
#include "daemon/live/service/process.h"
#include "daemon/live/service/run_loop.h"
#include "daemon/live/service/service_manager.h"
#include "daemon/live/service/start_watch.h"
#include "daemon/messages/quiet_protobuf.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

constexpr auto kStopPatience = std::chrono::milliseconds(5000);
// Time for libzmq's own thread to send the goodbye, which no call waits for any more.
constexpr auto kLinger = std::chrono::milliseconds(100);

// Ends the process when a thread does not end, for example because its disk does not answer.
void stop_in_time(Process& process, const std::string& reason) {
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<std::string> hung = process.stop(reason, kStopPatience);
  const auto taken = std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::steady_clock::now() - begin);
  for (const std::string& stage : hung) {
    const bool recorder = stage.rfind("recorder", 0) == 0;
    spdlog::critical("not stopped after {} ms: '{}' does not come back{}",
                     taken.count(),
                     stage,
                     recorder ? ": data that waits for the disk is lost" : "");
  }
  if (hung.empty() && process.preparing_sites()) {
    spdlog::info("stopped while a site was being prepared");
    spdlog::default_logger()->flush();
    std::this_thread::sleep_for(kLinger);
    std::_Exit(0);  // tracing cannot be interrupted
  }
  if (!hung.empty()) {
    spdlog::default_logger()->flush();
    std::this_thread::sleep_for(kLinger);
    std::_Exit(kExitInternal);
  }
}

Expected<void> serve(const std::string& file) {
  const sigset_t signals = block_daemon_signals();
  const ServiceManager manager;
  Expected<DaemonSetup> setup = load_daemon_setup(file);
  RAYLOC_TRY(setup);
  Expected<PassedSockets> sockets = PassedSockets::take();
  RAYLOC_TRY(sockets);
  Reloader reloader(*setup);
  set_up_log(setup->config.log);
  auto watch = std::make_unique<StartWatch>(manager);  // throws where there is no thread for it
  spdlog::info("raylocd {} starts", RAYLOC_VERSION);
  Expected<std::unique_ptr<Process>> opened =
      Process::open(std::move(*setup), *sockets, [](const std::string& line) {
        spdlog::info("{}", printable(line));
      });
  RAYLOC_TRY(opened);
  if (!sockets->empty()) {
    spdlog::warn("systemd passed sockets that nothing here is called: {}", sockets->unused());
  }
  Process& process = **opened;
  process.start();
  for (const std::string& line : process.source_descriptions()) {
    spdlog::info("listening: {}", line);
  }
  if (const std::string http = process.http_address(); !http.empty()) {
    spdlog::info("answering at http://{}/", http);
  }
  watch.reset();
  spdlog::info("running: publishing at {}", process.endpoint());
  spdlog::default_logger()->flush();  // waiting programs read it next
  manager.ready();
  const std::string reason = RunLoop(process, manager, std::move(reloader)).run(signals);
  manager.stopping();
  spdlog::info("stopping: {}", reason);
  // A second signal ends the daemon immediately; a request for a snapshot comes too late.
  std::signal(SIGUSR1, SIG_IGN);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  stop_in_time(process, reason);
  spdlog::info("stopped");
  return {};
}

int run(int argc, const char* const* argv) {
  cli::OptionParser app("Wi-Fi localization daemon: CSI datagrams in, locations out over ZeroMQ",
                        "raylocd",
                        "raylocd " RAYLOC_VERSION);
  app.footer("Example:\n  raylocd --config /etc/raylocd/raylocd.toml");
  std::string file;
  app.add_option("--config", file, "configuration (TOML); `rayloc config default` prints one")
      ->required();
  if (const std::optional<int> status = app.parse(argc, argv)) {
    return *status;
  }
  const Expected<void> served = serve(file);
  if (!served) {
    spdlog::default_logger()->flush();
    // Errors of a configuration begin with file:line:column, one a line, as editors read them.
    const bool placed = served.error().kind == ErrorKind::kConfiguration;
    std::fprintf(stderr,
                 "%s%s\n",
                 placed ? "" : "raylocd: ",
                 printable(served.error().message, '\n').c_str());
    return exit_status(served.error().kind);
  }
  return 0;
}

}  // namespace
}  // namespace rayloc

int main(int argc, char** argv) {
  try {
    rayloc::bound_spare_memory();
    rayloc::quiet_protobuf();
    rayloc::report_uncaught_exceptions();
    return rayloc::run(argc, argv);
  } catch (const std::exception& error) {
    const rayloc::FatalMessage message = rayloc::fatal_message(error);
    std::fprintf(stderr, "raylocd: %s\n", message.text.c_str());
    return message.exit_status;
  }
}
