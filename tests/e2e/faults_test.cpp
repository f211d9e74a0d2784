// Faults that a running raylocd must survive: a step of its clock, a silent source, an interface
// that disappears, datagrams from forbidden senders, hundreds of subscribers.
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/publish/subscriber.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/load_tally.h"
#include "tests/e2e/shifted_clock.h"
#include "tests/e2e/stated.h"
#include "tests/support/test_paths.h"

namespace rayloc::e2e::faults_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::chrono::seconds kPatience{60};

nlohmann::json json_at(const LiveDaemon& daemon, const std::string& path) {
  return nlohmann::json::parse(
      testing::http_body(testing::http_get(daemon.http_port(), path)), nullptr, false);
}

// Seconds since 1970 of an RFC 3339 text in UTC; the fraction is of no interest here.
double seconds_of(const std::string& text) {
  std::tm time{};
  if (strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &time) == nullptr) {
    ADD_FAILURE() << text << " is no time";
  }
  return static_cast<double>(timegm(&time));
}

double age_of(const nlohmann::json& source) {
  return std::stod(source.at("age").get<std::string>());
}

// One device, 100 frames a second, for as long as it lasts.
class Device {
 public:
  Device(const std::filesystem::path& folder, const LiveDaemon& daemon, const std::string& name)
      : process_(folder,
                 name,
                 "rayloc",
                 {"send",
                  bundled_recording("calibration", "ap2"),
                  "--to",
                  daemon.address(0),
                  "--rate",
                  "300",
                  "--duration",
                  "120"}) {}

 private:
  Process process_;
};

TEST(Faults, AClockThatIsSetMakesNoAgeWrong) {
  // A clock is set by an hour: what is wrong by that is wrong by more than this, and no machine is
  // late by as much.
  constexpr double kNoStep = 1800.0;  // [s]
  const TemporaryFolder folder;
  ShiftedClock clock(folder.path());
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "heartbeat_s = 0.1\n",
                     .setting = {.environment = clock.environment()}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  auto device = std::make_unique<Device>(folder.path(), daemon, "device");
  // After each step, locations are still published, with times of the new clock.
  std::uint64_t steps = 0;
  for (const int hours : {0, 1, -1, 0}) {
    const std::chrono::hours offset(hours);
    clock.set(offset);
    const std::size_t before = daemon.bodies("location").size();
    ASSERT_TRUE(eventually(kPatience, [&] {
      return daemon.bodies("location").size() > before + 10;
    })) << daemon.errors();
    const double shifted =
        static_cast<double>(std::time(nullptr)) + std::chrono::duration<double>(offset).count();
    EXPECT_NEAR(seconds_of(daemon.bodies("location").back().at("time")), shifted, kNoStep);
    const nlohmann::json source = json_at(daemon, "/api/v1/sources").at(0);
    EXPECT_EQ(source.at("status"), "SOURCE_STATUS_RECEIVING");
    EXPECT_GE(age_of(source), 0.0);
    EXPECT_LT(age_of(source), kNoStep);
    EXPECT_NEAR(seconds_of(source.at("last_frame")), shifted, kNoStep);
    EXPECT_EQ(number(source.at("counters").at("clock_steps")), steps);
    ++steps;
  }
  for (const nlohmann::json& heartbeat : daemon.bodies("heartbeat")) {
    for (const nlohmann::json& source : heartbeat.at("sources")) {
      EXPECT_NE(source.at("status"), "SOURCE_STATUS_STALLED");
      EXPECT_LT(source.contains("age") ? age_of(source) : 0.0, kNoStep);
    }
  }
  // Silence is detected by a clock that is never set, and so is its end.
  device.reset();
  const auto status_is = [&](const char* status) {
    return eventually(
        kPatience, [&] { return json_at(daemon, "/api/v1/sources").at(0).at("status") == status; });
  };
  clock.set(-std::chrono::hours(1));
  EXPECT_TRUE(status_is("SOURCE_STATUS_STALLED"));
  EXPECT_THAT(json_at(daemon, "/readyz").at("reasons").dump(), HasSubstr("source ap2: silent for"));
  device = std::make_unique<Device>(folder.path(), daemon, "device-again");
  EXPECT_TRUE(status_is("SOURCE_STATUS_RECEIVING"));
  EXPECT_EQ(json_at(daemon, "/readyz").at("reasons").dump().find("source ap2"), std::string::npos);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

// An interface whose datagrams no host answers.
const char* const kMakeInterface =
    "ip link add eth7 type veth peer name eth8 && ip link set eth8 up && ip link set eth7 up && "
    "ip addr add 10.9.8.1/24 dev eth7 && "
    "ip neigh add 10.9.8.2 lladdr 02:00:00:00:00:02 dev eth7 nud permanent";

std::string shell(const std::string& commands) { return "sh -c '" + commands + "'"; }

// On that interface, without any port, since the daemon's network is its own.
std::string capturing_configuration(const std::string& endpoint, const std::string& snapshot) {
  return "[site]\ndirectory = \"" + bundled("").string() +
         "\"\n[[source]]\naccess_point = \"ap2\"\nkind = \"interface\"\ninterface = \"eth7\"\n"
         "[engine]\nmethod = \"none\"\n[http]\nenabled = false\n[publish]\nendpoint = \"" +
         endpoint + "\"\nsnapshot = \"" + snapshot + "\"\n";
}

TEST(Faults, AnInterfaceThatWentAwayIsCapturedAgainWhenItComesBack) {
  if (std::system(("unshare --net " + shell(kMakeInterface) + " 2>/dev/null").c_str()) != 0) {
    GTEST_SKIP() << "no right to make a network namespace here";
  }
  const TemporaryFolder folder;
  const std::string endpoint = "ipc://" + (folder.path() / "publish").string();
  const std::string snapshot = "ipc://" + (folder.path() / "snapshot").string();
  const std::filesystem::path config = folder.path() / "raylocd.toml";
  std::ofstream(config) << capturing_configuration(endpoint, snapshot);
  Process daemon(folder.path(),
                 "raylocd",
                 "raylocd",
                 {"--config", config.string()},
                 {.wrapper = {"unshare",
                              "--net",
                              "/bin/sh",
                              "-c",
                              std::string(kMakeInterface) + R"( && exec "$0" "$@")"}});
  const auto logs = [&](const std::string& text) {
    return eventually(kPatience, [&] { return daemon.errors().find(text) != std::string::npos; });
  };
  ASSERT_TRUE(logs("running: publishing")) << daemon.errors();
  Process subscriber(
      folder.path(),
      "sub",
      "rayloc",
      {"sub", "v1/source/", "--json", "--endpoint", endpoint, "--snapshot", snapshot});
  const auto inside = [&](const std::string& command) {
    return std::system(
        ("nsenter --net=/proc/" + std::to_string(daemon.pid()) + "/ns/net " + command).c_str());
  };
  // The latest state that the subscriber has received.
  const auto state = [&] {
    nlohmann::json last = nlohmann::json::object();
    for (const std::string& line : read_lines(subscriber.out())) {
      const nlohmann::json envelope = nlohmann::json::parse(line, nullptr, false);
      last = envelope.is_object() ? envelope.value("source", last) : last;
    }
    return last;
  };
  const auto becomes = [&](const std::string& status) {
    return eventually(kPatience, [&] { return state().value("status", "") == status; });
  };
  ASSERT_TRUE(becomes("SOURCE_STATUS_WAITING")) << subscriber.errors();
  ASSERT_EQ(inside("ip link del eth7"), 0);
  ASSERT_TRUE(becomes("SOURCE_STATUS_FAILED")) << daemon.errors();
  EXPECT_THAT(state().at("detail").get<std::string>(), HasSubstr("interface eth7: "));
  EXPECT_TRUE(logs("source ap2 cannot be read, it is opened again: interface eth7: "));
  ASSERT_EQ(inside(shell(kMakeInterface)), 0);
  ASSERT_TRUE(becomes("SOURCE_STATUS_WAITING")) << daemon.errors();
  EXPECT_TRUE(logs("no longer: source ap2 cannot be read"));
  EXPECT_EQ(number(state().at("counters").at("failures")), 1U);
  EXPECT_EQ(
      inside(test::program_path("rayloc") + " send '" + bundled_recording("calibration", "ap2") +
             "' --to 10.9.8.2:5500 --rate 1000 --duration 1 >/dev/null 2>&1"),
      0);
  EXPECT_TRUE(becomes("SOURCE_STATUS_RECEIVING")) << state().dump() << daemon.errors();
  daemon.signal(SIGTERM);
  EXPECT_EQ(daemon.wait(kPatience), 0) << daemon.errors();
}

// Two network namespaces with two cables between them; gone with the test. The daemon's end of
// cable i is 10.77.i.1.
class Cables {
 public:
  Cables() {
    made_ = run("ip netns add " + here_) && run("ip netns add " + there_) &&
            run("ip -n " + here_ + " link set lo up");
    for (const std::string cable : {"0", "1"}) {
      made_ = made_ && lay(cable);
    }
  }
  ~Cables() {
    run("ip netns del " + here_);
    run("ip netns del " + there_);
  }
  Cables(const Cables&) = delete;
  Cables& operator=(const Cables&) = delete;

  bool made() const { return made_; }
  std::vector<std::string> here() const { return {"ip", "netns", "exec", here_}; }
  std::vector<std::string> there() const { return {"ip", "netns", "exec", there_}; }

 private:
  static bool run(const std::string& command) {
    return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
  }
  bool lay(const std::string& cable) const {
    return run("ip link add rl" + cable + " netns " + here_ + " type veth peer name rl" + cable +
               " netns " + there_) &&
           run("ip -n " + here_ + " addr add 10.77." + cable + ".1/24 dev rl" + cable) &&
           run("ip -n " + there_ + " addr add 10.77." + cable + ".2/24 dev rl" + cable) &&
           run("ip -n " + here_ + " link set rl" + cable + " up") &&
           run("ip -n " + there_ + " link set rl" + cable + " up");
  }
  const std::string here_ = "rayloc-here-" + std::to_string(getpid());
  const std::string there_ = "rayloc-there-" + std::to_string(getpid());
  bool made_ = false;
};

TEST(Faults, AFloodFromAForbiddenInterfaceIsRejectedAndCounted) {
  const Cables cables;
  if (!cables.made()) {
    GTEST_SKIP() << "no right to make network namespaces and veth interfaces here (needs root)";
  }
  const TemporaryFolder folder;
  const std::filesystem::path config = folder.path() / "raylocd.toml";
  std::ofstream(config) << "[site]\ndirectory = \"" << bundled("").string()
                        << "\"\n[[source]]\naccess_point = \"ap2\"\nkind = \"udp\"\n"
                        << "listen = \"0.0.0.0:5500\"\nonly_interface = \"rl0\"\n"
                        << "[publish]\nsnapshot = \"ipc://" << (folder.path() / "s").string()
                        << "\"\n";
  Process daemon(folder.path(),
                 "raylocd",
                 "raylocd",
                 {"--config", config.string()},
                 {.wrapper = cables.here()});
  int runs = 0;
  const auto counters = [&] {
    Process status(folder.path(),
                   "status" + std::to_string(++runs),
                   "rayloc",
                   {"status", "--json"},
                   {.wrapper = cables.here()});
    return status.wait(kPatience) == 0 ? nlohmann::json::parse(read_text(status.out()))
                                             .at("status")
                                             .at("sources")
                                             .at(0)
                                             .at("counters")
                                       : nlohmann::json();
  };
  ASSERT_TRUE(eventually(kPatience, [&] { return !counters().is_null(); })) << daemon.errors();
  const auto sender = [&](const std::string& to, int rate) {
    return std::make_unique<Process>(
        folder.path(),
        "send-" + to,
        "rayloc",
        std::vector<std::string>{"send",
                                 bundled_recording("calibration", "ap2"),
                                 "--to",
                                 to + ":5500",
                                 "--rate",
                                 std::to_string(rate),
                                 "--duration",
                                 "2"},
        ProcessSetting{.wrapper = cables.there()});
  };
  const auto flood = sender("10.77.1.1", 20'000 / slower());
  const auto good = sender("10.77.0.1", 300);
  ASSERT_EQ(good->wait(kPatience), 0) << good->errors();
  ASSERT_EQ(flood->wait(kPatience), 0) << flood->errors();
  const std::uint64_t good_ones = sent_by(*good);
  const std::uint64_t all = good_ones + sent_by(*flood);
  nlohmann::json c;
  ASSERT_TRUE(eventually(kPatience, [&] {
    c = counters();
    return number(c.at("received")) + number(c.at("kernel_drops")) == all &&
           number(c.at("in_flight")) == 0;
  })) << c.dump();
  EXPECT_EQ(number(c.at("rejected").at("interface_not_allowed")) + number(c.at("processed")) +
                number(c.at("kernel_drops")),
            all);
  EXPECT_LE(number(c.at("processed")), good_ones);
  EXPECT_GE(number(c.at("processed")) + number(c.at("kernel_drops")), good_ones);
  daemon.signal(SIGTERM);
  EXPECT_EQ(daemon.wait(kPatience), 0) << daemon.errors();
}

TEST(Faults, SendersThatAreNotAllowedAreRejectedAndCounted) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .source = "kind = \"udp\"\nlisten = \"127.0.0.1:PORT\"\n"
                               "allow = [\"127.0.0.2\", \"10.0.0.0/8\"]"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  ASSERT_EQ(send_for_a_second(folder.path(), daemon), 0);
  nlohmann::json counters;
  ASSERT_TRUE(eventually(kPatience, [&] {
    counters = json_at(daemon, "/api/v1/sources").at(0).at("counters");
    return number(counters.at("received")) + number(counters.at("kernel_drops")) == 2000U;
  })) << counters.dump();
  EXPECT_EQ(number(counters.at("rejected").at("sender_not_allowed")),
            number(counters.at("received")));
  EXPECT_EQ(number(counters.at("processed")), 0U);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

constexpr std::size_t kPrefixes = 20;  // of each subscriber of the flood

Subscriber one_of_many(const LiveDaemon& daemon, const std::string& name) {
  std::vector<std::string> prefixes = {"v1/"};
  prefixes.reserve(kPrefixes);
  for (std::size_t i = 1; i < kPrefixes; ++i) {
    prefixes.push_back("flood/" + name + "/" + std::to_string(i) + "/");
  }
  auto subscriber = Subscriber::connect(daemon.endpoint(), prefixes);
  if (!subscriber) {
    throw std::runtime_error(subscriber.error().message);
  }
  return std::move(*subscriber);
}

TEST(Faults, AFloodOfSubscribersIsCountedAndLosesNoMessage) {
  constexpr std::size_t kHeld = 100;
  constexpr std::size_t kStrangers = 4;
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "heartbeat_s = 0.1\n",
                     .subscriptions = {"v1/"}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const auto publisher = [&] { return json_at(daemon, "/api/v1/status").at("publisher"); };
  const std::uint64_t before = number(publisher().at("subscriptions"));
  const Device device(folder.path(), daemon, "device");
  ASSERT_TRUE(eventually(kPatience, [&] { return !daemon.bodies("location").empty(); }));
  const double resident_before = daemon.resident_kib();
  {
    std::vector<std::thread> strangers;
    strangers.reserve(kStrangers);
    for (std::size_t i = 0; i < kStrangers; ++i) {
      // Each is there: it has got a message.
      strangers.emplace_back([&daemon, i] {
        for (int j = 0; j < 25; ++j) {
          EXPECT_TRUE(
              one_of_many(daemon, std::to_string(i) + "/" + std::to_string(j)).receive(kPatience));
        }
      });
    }
    std::vector<Subscriber> held;
    held.reserve(kHeld);
    for (std::size_t i = 0; i < kHeld; ++i) {
      held.push_back(one_of_many(daemon, "held/" + std::to_string(i)));
      EXPECT_TRUE(json_at(daemon, "/api/v1/status").is_object());
    }
    for (std::thread& stranger : strangers) {
      stranger.join();
    }
    EXPECT_TRUE(eventually(kPatience, [&] {
      return number(publisher().at("subscriptions")) == before + kHeld * kPrefixes;
    })) << publisher().dump();
  }
  EXPECT_TRUE(eventually(kPatience, [&] {
    return number(publisher().at("subscriptions")) == before;
  })) << publisher().dump();
  const std::size_t locations = daemon.bodies("location").size();
  EXPECT_TRUE(eventually(kPatience, [&] { return daemon.bodies("location").size() > locations; }))
      << daemon.errors();
  // 200 bytes a prefix at most, and what a connection holds.
  EXPECT_LT(daemon.resident_kib(), resident_before + 64 * 1024);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  EXPECT_THAT(daemon.errors(), Not(HasSubstr("lost"))) << "the one who stayed";
}

}  // namespace
}  // namespace rayloc::e2e::faults_test
