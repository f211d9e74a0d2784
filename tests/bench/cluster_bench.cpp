// Measures the cost of a datagram's path through the broker, from the tap of a capture node to the
// batch that a worker takes, against a bare client that publishes and receives the same batches.
//
//   cluster_bench [SECONDS]     of each part; 10 by default
//   cluster_bench catch_up      only the time that a successor takes to read a stored stream
//
// It starts a nats-server of its own (RAYLOC_NATS_SERVER, else Debian's) on loopback. Publisher and
// reader are threads of this process, so its processor time is that of both.
#include <nats/nats.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "daemon/live/cluster/batch_sender.h"
#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/sequencer.h"
#include "daemon/live/cluster/stream_reader.h"
#include "tests/cluster/nats_server.h"

namespace rayloc::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kDatagramBytes = 566;  // of the bundled meeting room
constexpr std::size_t kBatch = 64;
constexpr std::size_t kMaxInFlight = 200;  // batches, some of 8 MiB

double own_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double seconds_of(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string word;
  std::array<double, 2> ticks{};
  for (int i = 1; i <= 15 && stat >> word; ++i) {
    if (i >= 14) {
      ticks.at(static_cast<std::size_t>(i) - 14) = std::atof(word.c_str());
    }
  }
  return (ticks[0] + ticks[1]) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

struct Cost {
  double datagrams = 0;
  double seconds = 0;
  double own = 0;
  double server = 0;
  Cost& operator+=(const Cost& more) {
    datagrams += more.datagrams;
    seconds += more.seconds;
    own += more.own;
    server += more.server;
    return *this;
  }
  void print(const char* name) const {
    std::printf(
        "%-14s %9.0f datagrams/s, %5.2f us of ours and %5.2f us of the server's a datagram\n",
        name,
        datagrams / seconds,
        1e6 * own / datagrams,
        1e6 * server / datagrams);
  }
};

class Stopwatch {
 public:
  explicit Stopwatch(pid_t server) : server_(server) {}
  Cost cost(double datagrams) const {
    return {datagrams,
            std::chrono::duration<double>(Clock::now() - begin_).count(),
            own_seconds() - own_,
            seconds_of(server_) - server_seconds_};
  }

 private:
  const pid_t server_;
  const Clock::time_point begin_ = Clock::now();
  const double own_ = own_seconds();
  const double server_seconds_ = seconds_of(server_);
};

// As a source gives them.
std::vector<Datagram> some_datagrams(const std::vector<std::byte>& payload) {
  std::vector<Datagram> datagrams(kBatch);
  const Timestamp now{std::chrono::system_clock::now()};
  for (std::size_t i = 0; i < kBatch; ++i) {
    datagrams[i] = {now + i * std::chrono::microseconds(10), {}, payload};
  }
  return datagrams;
}

StreamOptions bench_stream(const std::string& site) {
  StreamOptions options;
  options.max_age = std::chrono::seconds(5);  // no gigabytes
  return site_stream(site, options);
}

// Publishes and receives messages as a client that does not decode batches.
Cost run_bare(const cluster::NatsServer& server, const std::string& site, double seconds) {
  const auto made = open_broker({{server.url()}, "bench"});
  while (!(*made)->connected()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  (void)(*made)->ensure_stream(bench_stream(site));
  Batch batch;
  batch.epoch = batch.number = 1;
  const std::vector<std::byte> payload(kDatagramBytes, std::byte{7});
  BatchPart& part = batch.parts.emplace_back();
  part.access_point = "ap1";
  for (const Datagram& one : some_datagrams(payload)) {
    part.datagrams.entries.push_back({one.time, one.address, one.payload.size()});
    part.datagrams.payloads.insert(
        part.datagrams.payloads.end(), one.payload.begin(), one.payload.end());
  }
  part.watermark = part.datagrams.entries.back().time;
  const std::string bytes = encode(batch);
  natsConnection* connection = nullptr;
  natsSubscription* subscription = nullptr;
  jsCtx* jetstream = nullptr;
  natsConnection_ConnectTo(&connection, server.url().c_str());
  jsOptions options;
  jsOptions_Init(&options);
  options.PublishAsync.MaxPending = kMaxInFlight;
  options.PublishAsync.StallWait = 10'000;
  natsConnection_JetStream(&jetstream, connection, &options);
  static std::atomic<std::uint64_t> received;
  received = 0;
  natsConnection_Subscribe(
      &subscription,
      connection,
      live_subjects(site).c_str(),
      [](natsConnection*, natsSubscription*, natsMsg* message, void*) {
        ++received;
        natsMsg_Destroy(message);
      },
      nullptr);
  const std::string subject = csi_subject(site, "node1");
  const Stopwatch watch(server.pid());
  std::uint64_t sent = 0;
  for (const auto end = Clock::now() + std::chrono::duration<double>(seconds);
       Clock::now() < end;) {
    const std::string id = "bare-" + std::to_string(++sent);
    jsPubOptions one;
    jsPubOptions_Init(&one);
    one.MsgId = id.c_str();
    js_PublishAsync(jetstream, subject.c_str(), bytes.data(), static_cast<int>(bytes.size()), &one);
  }
  for (const auto end = Clock::now() + std::chrono::seconds(10);
       received < sent && Clock::now() < end;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const Cost cost = watch.cost(static_cast<double>(sent * kBatch));
  natsConnection_Close(connection);
  natsSubscription_Destroy(subscription);
  jsCtx_Destroy(jetstream);
  natsConnection_Destroy(connection);
  return cost;
}

// Takes the batches of a site, and the age of each datagram that contains its time.
class Taker {
 public:
  Taker(const cluster::NatsServer& server, const std::string& site) {
    broker_ = *open_broker({{server.url()}, "bench worker"});
    StreamReader::Options options;
    options.stream = csi_stream(site);
    options.again = live_subjects(site);
    reader_ = *StreamReader::open(broker_, options);
    thread_ = std::thread([this] { run(); });
  }
  ~Taker() {
    ending_ = true;
    thread_.join();
  }
  Taker(const Taker&) = delete;
  Taker& operator=(const Taker&) = delete;
  std::uint64_t datagrams() const { return datagrams_; }
  const std::vector<double>& ages_ms() const { return ages_ms_; }  // once all are there

 private:
  void run() {
    Sequencer sequencer({}, true);
    std::vector<Sequencer::Taken> taken;
    while (!ending_) {
      const auto message = reader_->next(std::chrono::milliseconds(50));
      if (!message) {
        continue;
      }
      auto batch = decode_batch(message->data);
      if (batch) {
        sequencer.push("node1", std::move(*batch), taken);
      }
      for (const Sequencer::Taken& one : taken) {
        count(one.batch);
      }
      taken.clear();
    }
  }
  void count(const Batch& batch) {
    const Clock::rep now = Clock::now().time_since_epoch().count();
    for (const BatchPart& part : batch.parts) {
      for (const Datagram& datagram : part.datagrams.datagrams()) {
        Clock::rep received = 0;
        std::memcpy(&received, datagram.payload.data(), sizeof received);
        if (received > 0 && now > received && now - received < 60'000'000'000) {
          ages_ms_.push_back(1e-6 * static_cast<double>(now - received));
        }
      }
      datagrams_ += part.datagrams.entries.size();
    }
  }

  std::shared_ptr<Broker> broker_;
  std::unique_ptr<StreamReader> reader_;
  std::atomic<bool> ending_{false};
  std::atomic<std::uint64_t> datagrams_{0};
  std::vector<double> ages_ms_;
  std::thread thread_;
};

struct Node {
  std::shared_ptr<Broker> broker;
  std::unique_ptr<CaptureRole> role;
  std::shared_ptr<BatchSender> sender;
  DatagramTap* tap = nullptr;
};

Node open_node(const cluster::NatsServer& server, const std::string& site) {
  Node node;
  node.broker = *open_broker({{server.url()}, "bench node"});
  BatchSender::Options options;
  options.stream = bench_stream(site);
  node.role = *CaptureRole::open(node.broker, {"node1", 1, options});
  node.sender = *node.role->add_site(site);
  node.tap = &node.sender->tap("ap1");
  (void)node.sender->start();
  return node;
}

void wait_for(const Taker& taker, std::uint64_t datagrams) {
  for (const auto end = Clock::now() + std::chrono::seconds(30);
       taker.datagrams() < datagrams && Clock::now() < end;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

Cost run_ours(const cluster::NatsServer& server, const std::string& site, double seconds) {
  const Node node = open_node(server, site);
  const Taker taker(server, site);
  const std::vector<std::byte> payload(kDatagramBytes, std::byte{0});
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const Stopwatch watch(server.pid());
  std::uint64_t sent = 0;
  for (const auto end = Clock::now() + std::chrono::duration<double>(seconds);
       Clock::now() < end;) {
    while (node.sender->counters().ring.unacknowledged > kMaxInFlight) {
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    const auto datagrams = some_datagrams(payload);
    node.tap->tap(datagrams);
    node.tap->advance(datagrams.back().time);
    sent += kBatch;
  }
  wait_for(taker, sent);
  const Cost cost = watch.cost(static_cast<double>(taker.datagrams()));
  const NumberedRing::Counters ring = node.sender->counters().ring;
  if (taker.datagrams() != sent || ring.repeated + ring.asked_for + ring.marked_batches > 0) {
    std::printf("%s: %llu of %llu datagrams taken; %llu batches sent again, %llu marked\n",
                site.c_str(),
                static_cast<unsigned long long>(taker.datagrams()),
                static_cast<unsigned long long>(sent),
                static_cast<unsigned long long>(ring.repeated + ring.asked_for),
                static_cast<unsigned long long>(ring.marked_batches));
  }
  node.sender->finish();
  return cost;
}

// `rate`: datagrams a second.
void run_paced(const cluster::NatsServer& server, int rate, double seconds) {
  const std::string site = "paced" + std::to_string(rate);
  const Node node = open_node(server, site);
  const Taker taker(server, site);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  std::vector<std::byte> payload(kDatagramBytes);
  const Stopwatch watch(server.pid());
  const auto begin = Clock::now();
  const auto all = static_cast<std::uint64_t>(rate * seconds);
  for (std::uint64_t i = 0; i < all; ++i) {
    std::this_thread::sleep_until(begin + i * std::chrono::nanoseconds(1'000'000'000 / rate));
    const Clock::rep now = Clock::now().time_since_epoch().count();
    std::memcpy(payload.data(), &now, sizeof now);
    const Datagram one{Timestamp(std::chrono::system_clock::now()), {}, payload};
    node.tap->tap({&one, 1});
    node.tap->advance(one.time);
  }
  wait_for(taker, all);
  const Cost cost = watch.cost(static_cast<double>(taker.datagrams()));
  std::vector<double> ages = taker.ages_ms();
  std::sort(ages.begin(), ages.end());
  const auto at = [&](double share) {
    return ages.empty()
               ? 0.0
               : ages[static_cast<std::size_t>(share * static_cast<double>(ages.size() - 1))];
  };
  cost.print(site.c_str());
  std::printf(
      "               from the tap to the worker: p50 %.1f, p90 %.1f, p99 %.1f, most %.1f ms\n",
      at(0.5),
      at(0.9),
      at(0.99),
      at(1.0));
  node.sender->finish();
}

// As a worker after a take-over: a stored stream from its beginning, at most `most` messages by a
// request.
void catch_up(const cluster::NatsServer& server,
              const std::string& stream,
              std::uint64_t messages,
              std::size_t most) {
  StreamReader::Options options;
  options.stream = stream;
  options.again = live_subjects("stored");
  options.max_requested = most;
  const auto broker = *open_broker({{server.url()}, "bench worker"});
  while (!broker->connected()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const auto reader = *StreamReader::open(broker, options);
  const Stopwatch watch(server.pid());
  std::uint64_t read = 0;
  for (const auto end = Clock::now() + std::chrono::minutes(1);
       read < messages && Clock::now() < end;) {
    read += reader->next(std::chrono::milliseconds(50)) ? 1U : 0U;
  }
  const Cost cost = watch.cost(static_cast<double>(read));
  std::printf("catch-up, %3zu a request: %llu messages in %.3f s, %.0f messages/s, %.1f us each\n",
              most,
              static_cast<unsigned long long>(read),
              cost.seconds,
              cost.datagrams / cost.seconds,
              1e6 * cost.seconds / cost.datagrams);
}

// In turns, the first of which finds a cold store.
void run_catch_up(const cluster::NatsServer& server) {
  constexpr std::uint64_t kMessages = 2000;
  constexpr std::size_t kBytes = 40 * kDatagramBytes;  // a batch of five access points in 20 ms
  constexpr int kRounds = 5;
  const StreamOptions stream = site_stream("stored", {});
  const auto broker = *open_broker({{server.url()}, "bench node"});
  while (!broker->connected()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  (void)broker->ensure_stream(stream);
  const std::string bytes(kBytes, 'x');
  for (std::uint64_t last = 0; last < kMessages; ++last) {
    if (!broker->publish_behind(csi_subject("stored", "node1"), bytes, last)) {
      std::fprintf(stderr, "cluster_bench: the server stores no message\n");
      return;
    }
  }
  for (int round = 0; round < kRounds; ++round) {
    for (const std::size_t most : {std::size_t{1}, StreamReader::Options{}.max_requested}) {
      catch_up(server, stream.name, kMessages, most);
    }
  }
}

void run_live(const cluster::NatsServer& server, double seconds) {
  // In turns, for the machine may be busy with other things.
  constexpr int kRounds = 8;
  Cost bare;
  Cost ours;
  for (int round = 0; round < kRounds; ++round) {
    bare += run_bare(server, "bare" + std::to_string(round), seconds / kRounds);
    ours += run_ours(server, "ours" + std::to_string(round), seconds / kRounds);
  }
  bare.print("bare client");
  ours.print("ours");
  for (const int rate : {200, 2000, 10'000}) {
    run_paced(server, rate, seconds);
  }
}

// Zero seconds: only the catch-up.
int run(double seconds) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("cluster_bench." + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  {
    cluster::NatsServer server(folder);
    if (!cluster::NatsServer::is_installed() || !server.start()) {
      std::fprintf(stderr, "cluster_bench: no nats-server\n");
      return 69;
    }
    run_catch_up(server);
    if (seconds > 0) {
      run_live(server, seconds);
    }
  }
  std::filesystem::remove_all(folder);
  return 0;
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  setvbuf(stdout, nullptr, _IOLBF, 0);
  return rayloc::bench::run(argc > 1 ? std::atof(argv[1]) : 10);
}
