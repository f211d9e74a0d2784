// Several sites in one raylocd: what one does, and what happens to it, is no matter of the others.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <sys/socket.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/publish/subscriber.h"
#include "rayloc/v1/envelope.pb.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/support/patience.h"

namespace rayloc::e2e::many_sites_test {
namespace {

using ::testing::HasSubstr;
using testing::http_body;
using testing::http_get;
using ::testing::Not;
using ::testing::StartsWith;

constexpr std::chrono::seconds kPatience{60};
constexpr std::chrono::minutes kExplained{4};  // a room is traced, and a recording explained
constexpr const char* kCountOnly = "[engine]\nmethod = \"none\"\n";

nlohmann::json json_at(const LiveDaemon& daemon, const std::string& path) {
  return nlohmann::json::parse(http_body(http_get(daemon.http_port(), path)));
}

std::uint64_t received(const LiveDaemon& daemon, const std::string& site) {
  const nlohmann::json status = json_at(daemon, "/site/" + site + "/api/v1/status");
  return number(status.at("sources").at(0).at("counters").at("received"));
}

std::string started(const LiveDaemon& daemon, const std::string& site) {
  return json_at(daemon, "/site/" + site + "/api/v1/status").at("started");
}

// `count` datagrams of the bundled ap2 to the source of that number.
void send_some(const std::filesystem::path& folder,
               const LiveDaemon& daemon,
               std::size_t source,
               int count) {
  Process sender(folder,
                 "send" + std::to_string(source),
                 "rayloc",
                 {"send",
                  bundled_recording("calibration", "ap2"),
                  "--to",
                  daemon.address(source),
                  "--rate",
                  std::to_string(count),
                  "--duration",
                  "1"});
  EXPECT_EQ(sender.wait(kPatience), 0) << sender.errors();
}

std::filesystem::path copy_of_bundled(const std::filesystem::path& folder,
                                      const std::string& name) {
  std::filesystem::create_directory(folder / name);
  for (const auto& entry : std::filesystem::directory_iterator(bundled(""))) {
    const std::string file = entry.path().filename().string();
    if (file.find(".pcap") == std::string::npos) {
      std::filesystem::copy(
          entry.path(), folder / name / file, std::filesystem::copy_options::recursive);
    }
  }
  return folder / name;
}

void append(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::app) << text;
}

bool logs(const LiveDaemon& daemon, const std::string& words) {
  return eventually(kPatience, [&] { return daemon.log().find(words) != std::string::npos; });
}

// The output of a verb about the daemon.
std::string run_verb(const std::filesystem::path& folder, const std::vector<std::string>& words) {
  Process verb(folder, words.front(), "rayloc", words);
  EXPECT_EQ(verb.wait(kPatience), 0) << verb.errors();
  return read_text(verb.out());
}

TEST(ManySites, EachHasTopicsPathsMetricsAndRecordingsOfItsOwn) {
  const TemporaryFolder folder;
  const std::filesystem::path recordings = folder.path() / "rec";
  std::filesystem::create_directory(recordings);
  LiveDaemon daemon(
      folder.path(),
      {.more_configuration = "csi = true\n" + std::string(kCountOnly) + "[record]\ndirectory = \"" +
                             recordings.string() + "\"\n",
       .sites = {
           {"office", bundled("")},
           {"lab 2", bundled("")},
           {.name = "hall", .directory = bundled(""), .more_configuration = "record = false\n"}}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  auto listener = Subscriber::connect(daemon.endpoint(), {"v1/csi/"}, 10'000);
  ASSERT_TRUE(listener);
  send_some(folder.path(), daemon, 1, 300);
  ASSERT_TRUE(eventually(kPatience, [&] { return received(daemon, "lab%202") == 300; }));
  EXPECT_EQ(received(daemon, "office"), 0U);
  EXPECT_EQ(received(daemon, "hall"), 0U);

  const nlohmann::json sites = json_at(daemon, "/api/v1/sites");
  ASSERT_EQ(sites.size(), 3U);
  EXPECT_EQ(sites.at(1).at("name"), "lab 2");
  EXPECT_EQ(sites.at(1).at("path"), "site/lab%202/");
  EXPECT_EQ(json_at(daemon, "/site/hall/api/v1/sites").at(0).at("path"), "../../site/office/");
  EXPECT_EQ(json_at(daemon, "/site/hall/api/v1/map").at("site"), "hall");
  const std::uint16_t port = daemon.http_port();
  EXPECT_THAT(http_get(port, "/"), HasSubstr("map/sites.js"));
  EXPECT_THAT(http_get(port, "/site/hall/"), HasSubstr("map/main.js"));
  EXPECT_THAT(http_get(port, "/site/hall/map/main.js"), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(http_get(port, "/site/attic/"), StartsWith("HTTP/1.1 404 "));
  EXPECT_THAT(http_get(port, "/api/v1/status"), HasSubstr("/api/v1/sites lists them"));
  EXPECT_EQ(json_at(daemon, "/api/v1/map?site=hall").at("site"), "hall");
  EXPECT_EQ(json_at(daemon, "/api/v1/map?site=lab%202").at("site"), "lab 2");
  for (const char* const unknown : {"/api/v1/map?site=attic", "/api/v1/map?site=", "/api/v1/map"}) {
    const std::string answer = http_get(port, unknown);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 404 ")) << unknown;
    EXPECT_EQ(nlohmann::json::parse(http_body(answer)).at("sites"),
              nlohmann::json({"hall", "lab 2", "office"}))
        << unknown;
  }
  const std::string metrics = http_body(http_get(port, "/metrics"));
  EXPECT_THAT(metrics,
              HasSubstr("rayloc_source_received_total{site=\"lab 2\",access_point=\"ap2\"} 300"));
  EXPECT_THAT(metrics,
              HasSubstr("rayloc_source_received_total{site=\"hall\",access_point=\"ap2\"} 0"));
  EXPECT_THAT(json_at(daemon, "/readyz").at("reasons").dump(),
              HasSubstr("site 'office': source ap2: nothing has come yet"));

  const std::string http = "127.0.0.1:" + std::to_string(port);
  const std::string all = run_verb(folder.path(), {"status", "--http", http});
  for (const std::string name : {"site office\n", "site lab 2\n", "site hall\n"}) {
    EXPECT_THAT(all, HasSubstr(name));
  }
  const std::string one = run_verb(folder.path(), {"status", "--http", http, "--site", "lab 2"});
  EXPECT_THAT(one, HasSubstr("300 datagrams"));
  EXPECT_THAT(one, Not(HasSubstr("office")));
  const std::string top =
      run_verb(folder.path(),
               {"top", "--once", "--endpoint", daemon.endpoint(), "--snapshot", daemon.snapshot()});
  EXPECT_THAT(top, HasSubstr("site hall"));
  EXPECT_THAT(top, HasSubstr("site lab 2"));

  const auto frame = listener->receive(test::patient(kPatience));
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->topic, "v1/csi/lab%202/ap2/");
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  EXPECT_EQ(daemon.bodies("goodbye").size(), 3U);
  EXPECT_TRUE(std::filesystem::exists(recordings / "office"));
  EXPECT_FALSE(std::filesystem::is_empty(recordings / "lab%202"));
  EXPECT_FALSE(std::filesystem::exists(recordings / "hall"));
}

// Threads of a daemon that runs and records so many sites.
std::size_t threads_with(std::size_t sites) {
  const TemporaryFolder folder;
  LiveDaemonOptions options;
  options.more_configuration = std::string(kCountOnly) + "[record]\ndirectory = \"" +
                               (folder.path() / "rec").string() + "\"\n";
  for (std::size_t i = 0; i < sites; ++i) {
    options.sites.push_back({"site" + std::to_string(i), bundled("")});
  }
  LiveDaemon daemon(folder.path(), options);
  EXPECT_TRUE(daemon.ready()) << daemon.errors();
  for (const std::size_t source : {std::size_t{0}, sites - 1}) {
    send_some(folder.path(), daemon, source, 50);
    EXPECT_TRUE(eventually(
        kPatience, [&] { return received(daemon, "site" + std::to_string(source)) >= 50; }));
  }
  const std::filesystem::directory_iterator tasks("/proc/" + std::to_string(daemon.pid()) +
                                                  "/task");
  return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

TEST(ManySites, ShareThreadsWhoseNumberDependsOnTheCores) {
  // Receivers, recorders and workers, of which one site needs one each.
  const std::size_t cores = std::max(2U, std::thread::hardware_concurrency());
  const std::size_t one = threads_with(1);
  EXPECT_LE(threads_with(20), one + 3 * (cores - 1));
}

TEST(ManySites, AReloadOfOneAndItsTroublesLeaveTheOthersAlone) {
  const TemporaryFolder folder;
  const std::filesystem::path lab = copy_of_bundled(folder.path(), "lab");
  LiveDaemon daemon(folder.path(),
                    {.more_configuration = kCountOnly,
                     .sites = {{"office", bundled("")}, {"lab", lab}, {"hall", bundled("")}}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  for (const std::size_t source : {0U, 1U}) {
    send_some(folder.path(), daemon, source, 200);
  }
  ASSERT_TRUE(eventually(kPatience, [&] {
    return received(daemon, "office") == 200 && received(daemon, "lab") == 200;
  }));
  const std::string office = started(daemon, "office");
  const std::string before = started(daemon, "lab");

  append(lab / "site.toml", "\n# as it is now\n");
  daemon.signal(SIGHUP);
  ASSERT_TRUE(logs(daemon, "site 'lab' runs, prepared anew")) << daemon.errors();
  ASSERT_TRUE(eventually(kPatience, [&] { return started(daemon, "lab") != before; }));
  EXPECT_EQ(received(daemon, "lab"), 0U) << "it counts from its own beginning";
  EXPECT_EQ(received(daemon, "office"), 200U);
  EXPECT_EQ(started(daemon, "office"), office);
  send_some(folder.path(), daemon, 1, 100);
  EXPECT_TRUE(eventually(kPatience, [&] { return received(daemon, "lab") == 100; }));

  append(lab / "site.toml", "nonsense\n");
  daemon.signal(SIGHUP);
  ASSERT_TRUE(logs(daemon, "site 'lab' is left as it was")) << daemon.errors();
  send_some(folder.path(), daemon, 1, 100);
  EXPECT_TRUE(eventually(kPatience, [&] { return received(daemon, "lab") == 200; }));
  ASSERT_TRUE(eventually(kPatience, [&] {
    return json_at(daemon, "/site/lab/readyz").at("warnings").dump().find("site.toml") !=
           std::string::npos;
  }));
  EXPECT_THAT(json_at(daemon, "/site/office/readyz").dump(), Not(HasSubstr("site.toml")));
  EXPECT_EQ(started(daemon, "office"), office);

  // Without the hall, whose table and source are the last of theirs.
  std::string text = read_text(daemon.configuration());
  const std::size_t hall = text.find("[[site]]\nname = \"hall\"");
  text.erase(hall, text.find("[http]") - hall);
  std::ofstream(daemon.configuration()) << text;
  daemon.signal(SIGHUP);
  ASSERT_TRUE(logs(daemon, "site 'hall' has ended")) << daemon.errors();
  ASSERT_TRUE(eventually(kPatience, [&] { return json_at(daemon, "/api/v1/sites").size() == 2; }));
  ASSERT_TRUE(eventually(kPatience, [&] { return daemon.bodies("goodbye").size() == 1; }));
  EXPECT_EQ(daemon.bodies("goodbye").front().at("reason"), "the site is no longer configured");
  EXPECT_EQ(received(daemon, "office"), 200U);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

// Received datagrams in the last heartbeat of this start of a site.
std::uint64_t received_in_all(const LiveDaemon& daemon, const std::string& start) {
  std::uint64_t count = 0;
  for (const nlohmann::json& heartbeat : daemon.bodies("heartbeat")) {
    if (heartbeat.at("started") == start) {
      count = number(heartbeat.at("sources").at(0).at("counters").at("received"));
    }
  }
  return count;
}

// The port stays open: datagrams during the exchange are counted by the one or by the other.
TEST(ManySites, AnExchangeLosesNoDatagram) {
  const TemporaryFolder folder;
  const std::filesystem::path lab = copy_of_bundled(folder.path(), "lab");
  LiveDaemon daemon(
      folder.path(),
      {.more_configuration = kCountOnly, .sites = {{"office", bundled("")}, {"lab", lab}}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  std::vector<std::string> starts = {started(daemon, "lab")};
  std::atomic<bool> is_done = false;
  std::thread reloads([&] {
    for (int i = 0; i < 2; ++i) {
      EXPECT_TRUE(eventually(kPatience, [&] { return received(daemon, "lab") > 100; }));
      append(lab / "site.toml", "\n# as it is now\n");
      daemon.signal(SIGHUP);
      EXPECT_TRUE(eventually(kPatience, [&] { return started(daemon, "lab") != starts.back(); }));
      starts.push_back(started(daemon, "lab"));
    }
    is_done = true;
  });
  std::uint64_t sent = 0;
  while (!is_done) {
    send_some(folder.path(), daemon, 1, 500);
    sent += 500;
  }
  reloads.join();
  std::uint64_t all = 0;
  EXPECT_TRUE(eventually(kPatience,
                         [&] {
                           all = 0;
                           for (const std::string& start : starts) {
                             all += received_in_all(daemon, start);
                           }
                           return all == sent;
                         }))
      << all << " of " << sent;
  const nlohmann::json status = json_at(daemon, "/site/lab/api/v1/status");
  EXPECT_EQ(number(status.at("reloads").at("exchanges")), 2U);
  EXPECT_EQ(number(status.at("reloads").at("datagrams_lost")), 0U);
  EXPECT_EQ(number(status.at("sources").at(0).at("counters").at("kernel_drops")), 0U);
  EXPECT_THAT(http_get(daemon.http_port(), "/metrics"),
              HasSubstr("rayloc_reload_exchanges_total{site=\"lab\"} 2"));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

// A reload adds a site with wrong files: the daemon is not ready and reports the site.
TEST(ManySites, ASiteThatFailedToStartIsNotReady) {
  const TemporaryFolder folder;
  const std::filesystem::path lab = copy_of_bundled(folder.path(), "lab");
  const std::string good = read_text(lab / "site.toml");
  LiveDaemon daemon(folder.path(),
                    {.more_configuration = kCountOnly,
                     .sites = {{"office", bundled("")}, {"hall", bundled("")}}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  send_some(folder.path(), daemon, 0, 100);
  send_some(folder.path(), daemon, 1, 100);
  ASSERT_TRUE(eventually(kPatience, [&] { return json_at(daemon, "/readyz").at("ready"); }));

  append(lab / "site.toml", "nonsense\n");
  append(daemon.configuration(),
         "[[site]]\nname = \"lab\"\ndirectory = \"" + lab.string() +
             "\"\n[[source]]\nsite = \"lab\"\naccess_point = \"ap2\"\nkind = \"udp\"\n"
             "listen = \"127.0.0.1:" +
             std::to_string(free_port(SOCK_DGRAM)) + "\"\n");
  daemon.signal(SIGHUP);
  ASSERT_TRUE(logs(daemon, "site 'lab' does not begin, reload again")) << daemon.errors();
  ASSERT_TRUE(eventually(kPatience, [&] { return json_at(daemon, "/api/v1/sites").size() == 3; }));
  EXPECT_THAT(json_at(daemon, "/readyz").at("reasons").dump(),
              HasSubstr("site 'lab': it has not begun: "));
  EXPECT_EQ(json_at(daemon, "/api/v1/sites").at(2).at("running"), false);
  EXPECT_TRUE(json_at(daemon, "/site/office/readyz").at("ready"));
  const std::uint16_t port = daemon.http_port();
  EXPECT_THAT(http_get(port, "/site/lab/readyz"), StartsWith("HTTP/1.1 503 "));
  EXPECT_THAT(http_get(port, "/site/lab/api/v1/map"), HasSubstr("site.toml"));
  EXPECT_THAT(http_get(port, "/metrics"), HasSubstr("rayloc_site_running{site=\"lab\"} 0"));
  EXPECT_THAT(http_get(port, "/metrics"), HasSubstr("rayloc_site_running{site=\"office\"} 1"));
  const std::string http = "127.0.0.1:" + std::to_string(port);
  EXPECT_THAT(run_verb(folder.path(), {"status", "--http", http}),
              HasSubstr("site lab\nnot ready: it has not begun: "));

  std::ofstream(lab / "site.toml") << good;
  daemon.signal(SIGHUP);
  ASSERT_TRUE(logs(daemon, "site 'lab' runs, prepared anew")) << daemon.errors();
  EXPECT_TRUE(eventually(kPatience, [&] { return received(daemon, "lab") == 0; }));
  EXPECT_THAT(json_at(daemon, "/readyz").at("reasons").dump(), Not(HasSubstr("has not begun")));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

// Bodies by the site of their topics and their event.
using Published = std::map<std::string, std::map<std::string, std::string>>;

Published published_locations(Subscriber& listener, int goodbyes) {
  Published bodies;
  while (goodbyes > 0) {
    const auto message = listener.receive(test::patient(kPatience));
    if (!message) {
      ADD_FAILURE() << "no goodbye";
      return bodies;
    }
    v1::Envelope envelope;
    EXPECT_TRUE(envelope.ParseFromString(message->payload));
    goodbyes -= envelope.has_goodbye() ? 1 : 0;
    if (envelope.has_location()) {
      const std::string rest = message->topic.substr(std::string("v1/location/").size());
      v1::Location& location = *envelope.mutable_location();
      location.clear_frame();  // names the site
      bodies[rest.substr(0, rest.find('/'))][location.event_id()] = location.SerializeAsString();
    }
  }
  return bodies;
}

// Compares events that both received: the first may precede a subscriber's connection, and a
// publisher under load sends only the newest.
void expect_the_same(const std::map<std::string, std::string>& one,
                     const std::map<std::string, std::string>& other) {
  int common = 0;
  for (const auto& [event, body] : one) {
    if (const auto found = other.find(event); found != other.end()) {
      EXPECT_EQ(found->second, body) << event;
      ++common;
    }
  }
  EXPECT_GT(common, 10);
}

// The site's recording has ended, and none of its bursts is in flight.
bool is_through(const LiveDaemon& daemon, const std::string& site) {
  const std::string path = "/site/" + site + "/api/v1/status";
  const auto status =
      nlohmann::json::parse(http_body(http_get(daemon.http_port(), path)), nullptr, false);
  return status.is_object() && status.at("sources").at(0).at("status") == "SOURCE_STATUS_ENDED" &&
         number(status.at("estimation").value("bursts_in_flight", nlohmann::json(0))) == 0;
}

// By a reload that prepares the site "two" anew.
void expect_tracks_to_end(LiveDaemon& daemon) {
  std::string text = read_text(daemon.configuration());
  const std::string table = "[[site]]\nname = \"two\"\n";
  text.insert(text.find(table) + table.size(), "record = false\n");
  std::ofstream(daemon.configuration()) << text;
  daemon.signal(SIGHUP);
  EXPECT_TRUE(logs(daemon, "site 'two' runs, prepared anew")) << daemon.errors();
  EXPECT_TRUE(eventually(kPatience, [&] {
    const auto events = daemon.bodies("track");
    return std::any_of(events.begin(), events.end(), [](const nlohmann::json& event) {
      return event.at("state") == "TRACK_STATE_LOST" &&
             event.at("reason") == "the site was prepared anew";
    });
  }));
}

// Recordings, so that nothing depends on the load of the machine.
TEST(ManySites, AreLocatedAsEachWouldBeAlone) {
  const TemporaryFolder folder;
  const std::filesystem::path site = calibrated_site(folder.path());
  // No two sources may read one file.
  for (const std::string name : {"one", "two", "none"}) {
    std::filesystem::copy_file(bundled_recording("device_los", "ap2"),
                               folder.path() / (name + ".pcap.gz"));
  }
  const std::string play =
      "kind = \"pcap\"\nfile = \"" + (folder.path() / "SITE.pcap.gz").string() + "\"\nspeed = 20\n";
  Published alone;
  Published together;
  for (const bool is_alone : {true, false}) {
    const TemporaryFolder place;
    LiveDaemonOptions options;
    options.source = play;
    options.sites = {{"one", site}, {"two", site}, {"none", site, {"ap2"}, "method = \"none\"\n"}};
    if (is_alone) {
      options.sites.resize(1);
    }
    const int goodbyes = static_cast<int>(options.sites.size());
    LiveDaemon daemon(place.path(), options);
    auto listener =
        Subscriber::connect(daemon.endpoint(), {"v1/location/", "v1/heartbeat/"}, 100'000);
    ASSERT_TRUE(listener);
    for (const LiveSite& one : options.sites) {
      ASSERT_TRUE(eventually(kExplained, [&] { return is_through(daemon, one.name); }))
          << daemon.errors();
    }
    if (!is_alone) {
      expect_tracks_to_end(daemon);
    }
    EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
    (is_alone ? alone : together) = published_locations(*listener, goodbyes);
  }
  expect_the_same(together["one"], alone["one"]);
  expect_the_same(together["two"], alone["one"]);
  EXPECT_TRUE(together["none"].empty());
}

}  // namespace
}  // namespace rayloc::e2e::many_sites_test
