// rayloc-capture: captures the datagrams that pass an interface and sends them
// to raylocd over an AF_UNIX socket. It is our only program with a capability,
// and it drops it as soon as the interface is open: before it has read a packet.
#include <cap-ng.h>
#include <sys/prctl.h>
#include <systemd/sd-daemon.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>

#include "capture/source/transport_schemes.h"
#include "daemon/base/exit_status.h"
#include "daemon/cli/command/option_parser.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kTick = std::chrono::milliseconds(100);
constexpr auto kLogPeriod = std::chrono::seconds(30);

struct Arguments {
  std::string interface;
  std::string filter = "udp dst port 5500";
  std::string to;
};

// Drops all of them permanently. The interface stays open.
Expected<void> drop_capabilities() {
  capng_clear(CAPNG_SELECT_CAPS);
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || capng_apply(CAPNG_SELECT_CAPS) != 0 ||
      prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0) != 0 ||
      capng_get_caps_process() != 0 || capng_have_capabilities(CAPNG_SELECT_CAPS) != CAPNG_NONE) {
    return make_error(ErrorKind::kInternal, "the capabilities cannot be given back");
  }
  return {};
}

// SIGINT and SIGTERM stay pending until they are polled.
class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    sigprocmask(SIG_BLOCK, &signals_, nullptr);
  }
  bool requested() const {
    const timespec now{};
    return sigtimedwait(&signals_, nullptr, &now) > 0;
  }

 private:
  sigset_t signals_{};
};

std::uint64_t lost_as(const SinkCounters& sink, const char* reason) {
  const auto found = sink.lost_by.find(reason);
  return found == sink.lost_by.end() ? 0 : found->second;
}

void print(const char* when, const SourceCounters& source, const SinkCounters& sink) {
  const std::uint64_t absent = lost_as(sink, "not_there");
  std::fprintf(stderr,
               "rayloc-capture: %s: %llu captured, %llu sent, %llu lost because raylocd did not "
               "take them, %llu because it was not there, %llu dropped by the kernel\n",
               when,
               static_cast<unsigned long long>(source.delivered),
               static_cast<unsigned long long>(sink.delivered),
               static_cast<unsigned long long>(sink.lost() - absent),
               static_cast<unsigned long long>(absent),
               static_cast<unsigned long long>(source.kernel_drops));
}

// Reports losses: at once, then every half minute while they continue.
class LossLog {
 public:
  void check(const SourceCounters& source, const SinkCounters& sink) {
    const std::uint64_t lost = sink.lost() + source.kernel_drops;
    const auto now = Clock::now();
    if (lost > reported_ && (reported_ == 0 || now - when_ > kLogPeriod)) {
      reported_ = lost;
      when_ = now;
      print("losing", source, sink);
    }
  }

 private:
  std::uint64_t reported_ = 0;
  Clock::time_point when_;
};

Expected<void> forward(DatagramSource& source, DatagramSink& sink, const StopSignals& stop) {
  DatagramBatch batch;
  LossLog losses;
  while (!stop.requested()) {
    RAYLOC_TRY(source.read(batch, kTick));
    sink.note_source(source.counters());
    RAYLOC_TRY(sink.write(batch));
    losses.check(source.counters(), sink.counters());
  }
  return {};
}

Expected<void> capture(const Arguments& arguments) {
  const StopSignals stop;
  SourceOptions options;
  options.filter = arguments.filter;
  auto source =
      open_datagram_source(transport_schemes(), "live:" + arguments.interface, {}, options);
  RAYLOC_TRY(source);
  RAYLOC_TRY(drop_capabilities());
  // Without privileges: whatever it opens, or a process that it starts, has none.
  auto sink = open_datagram_sink(transport_schemes(), arguments.to, "unix");
  RAYLOC_TRY(sink);
  std::fprintf(stderr,
               "rayloc-capture: %s (%s) to %s\n",
               arguments.interface.c_str(),
               arguments.filter.c_str(),
               arguments.to.c_str());
  sd_notify(0, "READY=1");
  Expected<void> done = forward(**source, **sink, stop);
  sd_notify(0, "STOPPING=1");
  print("ended", (*source)->counters(), (*sink)->counters());
  return done;
}

int run(int argc, const char* const* argv) {
  cli::OptionParser app(
      "Captures what passes an interface and hands it to raylocd, without its privileges",
      "rayloc-capture",
      "rayloc-capture " RAYLOC_VERSION);
  app.footer("Example:\n  rayloc-capture --interface eth0 --to /run/raylocd/eth0");
  Arguments arguments;
  app.add_option("--interface", arguments.interface, "Interface to capture from")->required();
  app.add_option("--filter", arguments.filter, "Packets to capture: a pcap-filter(7)")
      ->capture_default_str();
  app.add_option("--to",
                 arguments.to,
                 "Socket of raylocd: path of a source of kind \"unix\"; or " +
                     transport_syntax(transport_schemes(), TransportUse::kSink))
      ->required();
  if (const std::optional<int> status = app.parse(argc, argv)) {
    return *status;
  }
  const Expected<void> done = capture(arguments);
  if (!done) {
    std::fprintf(stderr, "rayloc-capture: %s\n", printable(done.error().message, '\n').c_str());
    return exit_status(done.error().kind);
  }
  return 0;
}

}  // namespace
}  // namespace rayloc

int main(int argc, char** argv) {
  try {
    return rayloc::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rayloc-capture: internal error: %s\n", error.what());
    return rayloc::kExitInternal;
  }
}
