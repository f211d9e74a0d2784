// Measures how many devices a real raylocd locates live: it receives them over loopback, at
// the pace of a recorded walk, and a subscriber reads its messages. For each number of
// devices:
//   bursts         offered, explained, merged and dropped a second
//   CPU            of the daemon, in cores, and of a burst
//   latency        from the last frame of an estimate to its arrival here
//   rates          bursts a second that devices got: fewest, median, most
//   memory         of the daemon
// Build with the release preset and -DRAYLOC_BENCHMARKS=ON. `site` beside this file makes a room.
//
//   crowd_bench SITE SECONDS DEVICES[,DEVICES...] AP=RECORDING.pcap...
//   crowd_bench SITE SECONDS DEVICES AP=RECORDING.pcap... --rounds N
//   crowd_bench SITE SECONDS DEVICES AP=RECORDING.pcap... --methods rayloc,spotfi
// The second keeps the daemon for N rounds: each time half of the devices leave, and others come.
// The third compares methods: the first one's estimates are measured.
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "daemon/live/publish/subscriber.h"
#include "rayloc/v1/envelope.pb.h"
#include "tests/bench/crowd/crowd_sender.h"
#include "tests/e2e/live_daemon.h"

namespace rayloc::bench {
namespace {

using Clock = std::chrono::system_clock;

// [s], in which tracks begin: acquisitions are not measured.
constexpr int kSettling = 5;

struct Setting {
  std::string site;
  int seconds = 20;
  std::vector<std::string> access_points;
  std::vector<test::Recording> recordings;
  int rounds = 1;
  std::string methods = "rayloc";  // separated by commas
};

struct State {
  double cpu = 0.0;     // [s]
  double memory = 0.0;  // [MiB]
  v1::EstimationCounters counters;
};

// user and system time, fields 14 and 15 of proc(5).
double cpu_seconds(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string all((std::istreambuf_iterator<char>(file)), {});
  std::istringstream fields(all.substr(all.rfind(')') + 2));
  std::string field;
  double ticks = 0.0;
  for (int i = 3; fields >> field && i <= 15; ++i) {
    ticks += i >= 14 ? std::stod(field) : 0.0;
  }
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

// The published messages, received by a subscriber on a separate thread.
class Ear {
 public:
  explicit Ear(const std::string& endpoint)
      : subscriber_(*Subscriber::connect(endpoint, {"v1/"})), thread_([this] { run(); }) {}
  ~Ear() {
    stopping_ = true;
    thread_.join();
  }
  Ear(const Ear&) = delete;
  Ear& operator=(const Ear&) = delete;

  // Starts the statistics of estimates anew.
  void begin() {
    const std::lock_guard lock(mutex_);
    latencies_.clear();
    bursts_.clear();
  }
  v1::EstimationCounters counters() {
    const std::lock_guard lock(mutex_);
    return counters_;
  }
  std::vector<double> latencies() {  // [ms], sorted
    const std::lock_guard lock(mutex_);
    std::sort(latencies_.begin(), latencies_.end());
    return latencies_;
  }
  std::vector<double> rates(int devices, double seconds) {  // [1/s], sorted
    const std::lock_guard lock(mutex_);
    std::vector<double> rates;
    for (const auto& [device, bursts] : bursts_) {
      rates.push_back(static_cast<double>(bursts.size()) / seconds);
    }
    rates.resize(std::max(rates.size(), static_cast<std::size_t>(devices)));
    std::sort(rates.begin(), rates.end());
    return rates;
  }

 private:
  void run() {
    while (!stopping_) {
      const auto message = subscriber_.receive(std::chrono::milliseconds(100));
      v1::Envelope envelope;
      if (!message || !envelope.ParseFromString(message->payload)) {
        continue;
      }
      const std::lock_guard lock(mutex_);
      if (envelope.has_heartbeat()) {
        counters_ = envelope.heartbeat().estimation();
      } else if (envelope.has_location() && envelope.location().mode() != v1::FIX_MODE_PREDICTED) {
        receive(envelope);
      }
    }
  }
  // A burst's estimates are sent together; the latency of its last instant is that of the burst.
  void receive(const v1::Envelope& envelope) {
    const auto& end = envelope.location().capture_end();
    const auto ended = Clock::time_point(std::chrono::duration_cast<Clock::duration>(
        std::chrono::seconds(end.seconds()) + std::chrono::nanoseconds(end.nanos())));
    const double latency = std::chrono::duration<double, std::milli>(Clock::now() - ended).count();
    const auto& device = envelope.location().target().mac();
    // A burst's estimates lie within its 200 ms, and the next burst's do not.
    auto& [first, least] = last_[device];
    if (ended - first > std::chrono::milliseconds(160)) {
      if (first != Clock::time_point()) {
        latencies_.push_back(least);
      }
      first = ended;
      least = latency;
      bursts_[device].push_back(ended);
    }
    least = std::min(least, latency);
  }

  Subscriber subscriber_;
  std::mutex mutex_;
  v1::EstimationCounters counters_;
  std::vector<double> latencies_;
  std::map<std::string, std::vector<Clock::time_point>> bursts_;
  struct Last {
    Clock::time_point first;
    double latency = 0.0;  // [ms], the least
  };
  std::map<std::string, Last> last_;  // burst of each device
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

State state_of(const e2e::LiveDaemon& daemon, Ear& ear) {
  // The heartbeat with these counters arrives within a tenth of a second.
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  return {cpu_seconds(daemon.pid()), daemon.resident_kib() / 1024.0, ear.counters()};
}

double at(const std::vector<double>& sorted, double share) {
  return sorted.empty()
             ? 0.0
             : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

void print(int devices, const State& before, const State& after, double seconds, Ear& ear) {
  const auto a_second = [&](std::uint64_t later, std::uint64_t earlier) {
    return static_cast<double>(later - earlier) / seconds;
  };
  const double explained = a_second(after.counters.bursts(), before.counters.bursts());
  const double merged = a_second(after.counters.bursts_merged(), before.counters.bursts_merged());
  const double dropped =
      a_second(after.counters.bursts_dropped(), before.counters.bursts_dropped());
  const double cores = (after.cpu - before.cpu) / seconds;
  const auto latencies = ear.latencies();
  const auto rates = ear.rates(devices, seconds);
  std::printf(
      "%5d devices: bursts/s %7.1f, explained %7.1f, merged %7.1f, dropped %6.1f; %4.2f cores, "
      "%6.2f ms a burst; latency p50 %6.0f p99 %6.0f ms; a device %4.2f %4.2f %4.2f bursts/s; "
      "%5.0f MiB (%.0f before)\n",
      devices,
      explained + merged + dropped,
      explained,
      merged,
      dropped,
      cores,
      1e3 * cores / std::max(explained, 1e-9),
      at(latencies, 0.5),
      at(latencies, 0.99),
      at(rates, 0.0),
      at(rates, 0.5),
      at(rates, 1.0),
      after.memory,
      before.memory);
  std::fflush(stdout);
}

// `crowd`: the devices that transmit; recordings and ports follow from the setting.
void listen(const Setting& setting, const e2e::LiveDaemon& daemon, Ear& ear, Crowd crowd) {
  const int crowd_size = crowd.devices;
  crowd.recordings = setting.recordings;
  crowd.length = std::chrono::seconds(setting.seconds + kSettling);
  for (std::size_t ap = 0; ap < setting.access_points.size(); ++ap) {
    const std::string address = daemon.address(ap);
    crowd.ports.push_back(
        static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1))));
  }
  const CrowdSender sender(std::move(crowd));
  std::this_thread::sleep_for(std::chrono::seconds(kSettling));
  ear.begin();
  const auto begin = std::chrono::steady_clock::now();
  const State before = state_of(daemon, ear);
  while (!sender.finished()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const State after = state_of(daemon, ear);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  print(crowd_size, before, after, seconds, ear);
  if (sender.latest() > std::chrono::milliseconds(100)) {
    std::printf("      a datagram was sent %ld ms late: this machine had no time for its sender\n",
                static_cast<long>(sender.latest().count()));  // NOLINT
  }
}

// a,b becomes "a", "b".
std::string quoted(const std::string& list) {
  std::istringstream items(list);
  std::string text;
  for (std::string item; std::getline(items, item, ',');) {
    text.append(text.empty() ? "\"" : ", \"").append(item).append("\"");
  }
  return text;
}

bool measure(const Setting& setting, int devices) {
  const e2e::TemporaryFolder folder;
  e2e::LiveDaemonOptions options{.site = setting.site, .access_points = setting.access_points};
  options.subscriptions = {"v1/heartbeat/"};
  options.more_configuration = "heartbeat_s = 0.1\n[engine]\nsnapshots = \"acquire\"\nmethod = [" +
                               quoted(setting.methods) +
                               "]\n[limits]\nmax_targets = " + std::to_string(devices + 1) + "\n";
  e2e::LiveDaemon daemon(folder.path(), options);
  if (!daemon.ready()) {
    std::fprintf(stderr, "%s\n", daemon.errors().c_str());
    return false;
  }
  Ear ear(daemon.endpoint());
  for (int round = 0; round < setting.rounds; ++round) {
    Crowd crowd;
    crowd.first = devices / 2 * round;
    crowd.devices = devices;
    listen(setting, daemon, ear, std::move(crowd));
  }
  const bool stopped = daemon.stop() == 0;
  if (!stopped) {
    std::fprintf(stderr, "%s\n", daemon.errors().c_str());
  }
  return stopped;
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr, "crowd_bench SITE SECONDS DEVICES[,DEVICES...] AP=RECORDING.pcap...\n");
    return 64;
  }
  rayloc::bench::Setting setting;
  setting.site = argv[1];
  setting.seconds = std::atoi(argv[2]);
  for (int i = 4; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--rounds" && i + 1 < argc) {
      setting.rounds = std::atoi(argv[++i]);
      continue;
    }
    if (argument == "--methods" && i + 1 < argc) {
      setting.methods = argv[++i];
      continue;
    }
    const std::size_t equals = argument.find('=');
    setting.access_points.push_back(argument.substr(0, equals));
    setting.recordings.push_back(rayloc::test::read_recording(argument.substr(equals + 1)));
  }
  std::istringstream numbers(argv[3]);
  for (std::string number; std::getline(numbers, number, ',');) {
    if (!rayloc::bench::measure(setting, std::stoi(number))) {
      return 1;
    }
  }
  return 0;
}
