// The HTTP interface of raylocd, from its start without datagrams to the first datagrams.
#include <sys/stat.h>

#include <csignal>
#include <deque>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e::http_test {
namespace {

using ::testing::HasSubstr;
using testing::http_body;
using testing::http_get;
using ::testing::StartsWith;

constexpr std::chrono::seconds kPatience{60};

nlohmann::json json_at(const LiveDaemon& daemon, const std::string& path) {
  return nlohmann::json::parse(http_body(http_get(daemon.http_port(), path)));
}

TEST(Http, ServesStateMetricsAndReasons) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), {.site = bundled(""), .access_points = {"ap2"}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const std::uint16_t port = daemon.http_port();
  EXPECT_THAT(http_get(port, "/healthz"), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(http_get(port, "/readyz"), StartsWith("HTTP/1.1 503 "));
  const std::string waiting = "source ap2: nothing has come yet at udp " + daemon.address(0);
  EXPECT_EQ(json_at(daemon, "/readyz").at("reasons").back(), waiting);
  EXPECT_EQ(json_at(daemon, "/api/v1/targets"), nlohmann::json::array());

  ASSERT_EQ(send_for_a_second(folder.path(), daemon), 0);
  EXPECT_EQ(json_at(daemon, "/readyz").at("reasons").dump().find("source ap2"), std::string::npos);
  EXPECT_EQ(json_at(daemon, "/api/v1/sources").at(0).at("status"), "SOURCE_STATUS_RECEIVING");
  ASSERT_TRUE(eventually(kPatience, [&] { return !json_at(daemon, "/api/v1/targets").empty(); }));
  EXPECT_EQ(json_at(daemon, "/api/v1/targets").at(0).at("location").at("target").at("mac"),
            "02:52:4c:00:00:01");
  EXPECT_EQ(json_at(daemon, "/api/v1/config").at("publish.endpoint"), daemon.endpoint());

  Process late(folder.path(),
               "late",
               "rayloc",
               {"sub",
                "v1/location/",
                "--endpoint",
                daemon.endpoint(),
                "--snapshot",
                daemon.snapshot(),
                "--json",
                "--count",
                "1"});
  EXPECT_EQ(late.wait(kPatience), 0) << late.errors();
  EXPECT_EQ(nlohmann::json::parse(read_text(late.out())), json_at(daemon, "/api/v1/targets").at(0));

  // The three ways to learn the counters agree.
  const nlohmann::json status = json_at(daemon, "/api/v1/status");
  EXPECT_EQ(number(status.at("sources").at(0).at("counters").at("received")), 2000U);
  const std::string metrics = http_body(http_get(port, "/metrics"));
  EXPECT_THAT(metrics, HasSubstr("\nrayloc_source_received_total{access_point=\"ap2\"} 2000\n"));
  EXPECT_THAT(metrics, HasSubstr("\nrayloc_http_requests_total{status=\"503\"} "));
  EXPECT_EQ(status.at("epoch"), daemon.bodies("heartbeat").back().at("epoch"));

  // Silence is a reason again.
  EXPECT_TRUE(eventually(kPatience, [&] {
    return json_at(daemon, "/readyz").at("reasons").dump().find("source ap2: silent for") !=
           std::string::npos;
  }));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  // The last heartbeat counts those as well that ask.
  const nlohmann::json last = daemon.bodies("heartbeat").back();
  EXPECT_EQ(number(last.at("snapshot_server").at("answered")), 1U);
  EXPECT_GE(number(last.at("http").at("requests").at("503")), 2U);
  EXPECT_FALSE(last.contains("ring_snapshots")) << "nothing is kept for them here";
}

TEST(Http, TheVerbsAskAndReport) {
  const TemporaryFolder folder;
  // Which site it is does not matter to who locates nothing.
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[engine]\nmethod = \"none\"\n"});
  const std::string address = "127.0.0.1:" + std::to_string(daemon.http_port());
  int runs = 0;
  const auto rayloc = [&](std::vector<std::string> words, int status) {
    if (words.front() != "doctor") {  // doctor uses the configured address
      words.insert(words.end(), {"--http", address});
    }
    Process process(folder.path(), "verb" + std::to_string(++runs), "rayloc", words);
    EXPECT_EQ(process.wait(kPatience), status) << process.errors();
    return read_text(process.out()) + process.errors();
  };
  rayloc({"wait-ready", "--running"}, 0);
  EXPECT_THAT(rayloc({"wait-ready", "--timeout", "0.5"}, 69),
              HasSubstr("not ready: source ap2: nothing has come yet"));
  EXPECT_THAT(rayloc({"doctor", daemon.configuration().string()}, 69),
              HasSubstr("problem  source ap2: nothing has come yet"));
  Process sender(folder.path(),
                 "sender",
                 "rayloc",
                 {"send",
                  bundled_recording("calibration", "ap2"),
                  "--to",
                  daemon.address(0),
                  "--rate",
                  "1000",
                  "--duration",
                  "5"});
  rayloc({"wait-ready"}, 0);
  const std::string status = rayloc({"status"}, 0);
  EXPECT_THAT(status, HasSubstr(": ready\n"));
  EXPECT_THAT(status, HasSubstr("ap2          receiving"));
  EXPECT_THAT(rayloc({"status", "--json"}, 0), HasSubstr("\"readiness\":{"));
  EXPECT_THAT(rayloc({"doctor", daemon.configuration().string()}, 0),
              HasSubstr("ok       source ap2: UDP " + daemon.address(0) + " is in use"));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();

  EXPECT_THAT(rayloc({"status"}, 69), HasSubstr("is raylocd running there"));
  EXPECT_THAT(rayloc({"doctor", daemon.configuration().string()}, 0),
              HasSubstr("ok       HTTP " + address + " is free"));
  // Another daemon has the port.
  LiveDaemon other(folder.path(), {.site = bundled(""), .access_points = {"ap2"}});
  ASSERT_TRUE(other.ready()) << other.errors();
  const std::filesystem::path ours = folder.path() / "ours.toml";
  std::filesystem::copy_file(other.configuration(), ours);
  EXPECT_THAT(
      rayloc({"doctor", ours.string(), "--http", address}, 69),
      HasSubstr("problem  source ap2: UDP " + other.address(0) + ": Address already in use"));
}

// The output and the messages of `rayloc VERB`.
std::string run_verb(const std::filesystem::path& folder, const std::vector<std::string>& words) {
  Process process(folder, "said", "rayloc", words);
  EXPECT_TRUE(process.wait(kPatience)) << words.front();
  return read_text(process.out()) + process.errors();
}

TEST(Field, ASiteThatCannotLocateIsReportedEverywhere) {
  const std::string cannot =
      "nothing can be located: the access points in use are not calibrated (ap2)";
  const std::string no_people = "people are not looked for";
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), {.site = bundled(""), .access_points = {"ap2"}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  EXPECT_THAT(daemon.log(),
              ::testing::ContainsRegex("warning.*" + std::string("nothing can be located")));
  EXPECT_THAT(daemon.log(), HasSubstr(no_people));
  const nlohmann::json ready = json_at(daemon, "/readyz");
  EXPECT_EQ(ready.at("ready"), false);
  EXPECT_THAT(ready.at("reasons").at(0).get<std::string>(), StartsWith(cannot));
  EXPECT_THAT(ready.at("warnings").dump(), HasSubstr(no_people));
  // The map reads these warnings; its page shows each.
  const nlohmann::json warnings = daemon.bodies("heartbeat").back().at("warnings");
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_THAT(warnings.at(0).get<std::string>(), StartsWith(cannot));
  EXPECT_THAT(http_get(daemon.http_port(), "/map/sources.js"), HasSubstr("heartbeat.warnings"));

  const std::string address = "127.0.0.1:" + std::to_string(daemon.http_port());
  EXPECT_THAT(run_verb(folder.path(), {"status", "--http", address}), HasSubstr("\n  " + cannot));
  const std::string doctor = run_verb(folder.path(), {"doctor", daemon.configuration().string()});
  EXPECT_THAT(doctor, HasSubstr("problem  " + cannot));
  EXPECT_THAT(doctor, HasSubstr("warning  " + no_people));
  EXPECT_EQ(doctor.find(no_people), doctor.rfind(no_people)) << "once";
  const std::string checked =
      run_verb(folder.path(), {"check-config", daemon.configuration().string()});
  EXPECT_THAT(checked, HasSubstr("site.toml: " + cannot));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

// A daemon that was stopped finds more bursts of one device than it has places for.
TEST(Field, OverloadIsReportedEverywhere) {
  const std::string overload = "more bursts come than this machine can explain";
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[engine]\nburst_s = 0.01\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  daemon.signal(SIGSTOP);
  EXPECT_EQ(send_for_a_second(folder.path(), daemon), 0);
  daemon.signal(SIGCONT);
  nlohmann::json warnings;
  EXPECT_TRUE(eventually(kPatience, [&] {
    warnings = json_at(daemon, "/readyz").at("warnings");
    return warnings.dump().find(overload) != std::string::npos;
  })) << daemon.errors();
  EXPECT_THAT(warnings.dump(), HasSubstr("faster machine")) << "what to do";
  // The pipeline's report logs it, a second later at the most; the answer above is of the counters.
  EXPECT_TRUE(eventually(kPatience, [&] {
    return daemon.log().find(overload) != std::string::npos;
  })) << daemon.log();
  const std::string status = run_verb(
      folder.path(), {"status", "--http", "127.0.0.1:" + std::to_string(daemon.http_port())});
  EXPECT_THAT(status, HasSubstr("  warning: " + overload));
  EXPECT_THAT(status, ::testing::ContainsRegex("; [1-9][0-9]* bursts gave way to newer ones,"));
  EXPECT_TRUE(eventually(kPatience, [&] {
    const nlohmann::json heartbeat = daemon.bodies("heartbeat").back();
    return heartbeat.at("warnings").dump().find(overload) != std::string::npos;
  })) << "the map reads it there";
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

TEST(Field, LogAndStatusAgreeOnReadiness) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[engine]\nmethod = \"none\"\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const auto logs = [&](const std::string& text) {
    return eventually(kPatience, [&] { return daemon.log().find(text) != std::string::npos; });
  };
  EXPECT_TRUE(logs("not ready: source ap2: nothing has come yet")) << daemon.log();
  EXPECT_EQ(daemon.log().find("info ready: "), std::string::npos) << daemon.log();
  Process sender(folder.path(),
                 "sender",
                 "rayloc",
                 {"send",
                  bundled_recording("calibration", "ap2"),
                  "--to",
                  daemon.address(0),
                  "--rate",
                  "1000",
                  "--duration",
                  "5"});
  EXPECT_TRUE(logs("info ready: every access point sends frames")) << daemon.log();
  const std::string status = run_verb(
      folder.path(), {"status", "--http", "127.0.0.1:" + std::to_string(daemon.http_port())});
  EXPECT_THAT(status, HasSubstr(": ready\n"));
  EXPECT_THAT(status,
              ::testing::ContainsRegex("ap2 .* frames \\([0-9]+ partial\\) .* [0-9.]+ s ago\n"));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

TEST(Field, TheStatusOfARecordingReportsNoMissingDatagrams) {
  const TemporaryFolder folder;
  LiveDaemon daemon(
      folder.path(),
      {.site = bundled(""),
       .access_points = {"ap2"},
       .more_configuration = "[engine]\nmethod = \"none\"\n",
       .source = "kind = \"pcap\"\nfile = \"" + bundled_recording("calibration", "ap2") + "\""});
  const std::string address = "127.0.0.1:" + std::to_string(daemon.http_port());
  std::string status;
  EXPECT_TRUE(eventually(kPatience, [&] {
    status = run_verb(folder.path(), {"status", "--http", address});
    return status.find("from a recording\n") != std::string::npos;
  })) << status;
  EXPECT_EQ(status.find("no datagram yet"), std::string::npos) << status;
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

// The daemon waits for a writer of a pipe, with its publishing port bound.
TEST(Field, TheDoctorReportsNoProblemBesideAStartingDaemon) {
  const TemporaryFolder folder;
  const std::filesystem::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[engine]\nmethod = \"none\"\n",
                     .source = "kind = \"pcap\"\nfile = \"" + pipe.string() + "\""});
  ASSERT_TRUE(eventually(kPatience, [&] {
    return daemon.log().find("preparing the room") != std::string::npos;
  })) << daemon.errors();
  std::string doctor;
  EXPECT_TRUE(eventually(kPatience, [&] {
    doctor = run_verb(folder.path(), {"doctor", daemon.configuration().string()});
    return doctor.find("is in use, raylocd runs") != std::string::npos;
  })) << doctor;
  EXPECT_THAT(doctor,
              HasSubstr("raylocd runs with this file as process " + std::to_string(daemon.pid()) +
                        " and does not answer yet: it is starting"));
  EXPECT_EQ(doctor.find("problem"), std::string::npos) << doctor;
}

TEST(Http, TheDoctorUsesTheConfiguredAddressAndToken) {
  const TemporaryFolder folder;
  const std::filesystem::path token = folder.path() / "token";
  std::ofstream(token) << "0123456789abcdef\n";
  std::filesystem::permissions(token, std::filesystem::perms(0600));
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[record]\nsnapshot_directory = \"" +
                                           folder.path().string() + "\"\nmin_free_mb = 1\n",
                     .http_configuration = "token_file = \"" + token.string() + "\"\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  Process doctor(folder.path(), "doctor", "rayloc", {"doctor", daemon.configuration().string()});
  EXPECT_EQ(doctor.wait(kPatience), 69);
  const std::string findings = read_text(doctor.out());
  EXPECT_THAT(findings, HasSubstr("problem  source ap2: nothing has come yet"));
  EXPECT_THAT(findings, HasSubstr("ok       [http] token_file " + token.string() + " can be read"));
  EXPECT_THAT(findings, HasSubstr("snapshots in " + folder.path().string() + ": "));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

TEST(Http, HostileClientsCostNothing) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), {.site = bundled(""), .access_points = {"ap2"}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  std::deque<testing::HttpClient> slow;
  for (int i = 0; i < 200; ++i) {
    slow.emplace_back(daemon.http_port());
    slow.back().send("GET /metrics HTTP/1.1\r\nX: ");
  }
  EXPECT_THAT(http_get(daemon.http_port(), "/../../../etc/passwd"), StartsWith("HTTP/1.1 404 "));
  EXPECT_THAT(http_get(daemon.http_port(), "/healthz", "X: " + std::string(50'000, 'x') + "\r\n"),
              StartsWith("HTTP/1.1 431 "));
  for (const char* const length : {"100000000", "99999999999999999999"}) {
    const testing::HttpClient large(daemon.http_port());
    large.send("POST /api/v1/record/snapshot HTTP/1.1\r\nContent-Length: " + std::string(length) +
               "\r\n\r\nx");
    EXPECT_THAT(large.receive(), StartsWith("HTTP/1.1 413 ")) << length;
  }
  ASSERT_EQ(send_for_a_second(folder.path(), daemon), 0);
  // The last datagrams may still be in the socket.
  EXPECT_TRUE(eventually(kPatience, [&] {
    return http_body(http_get(daemon.http_port(), "/metrics"))
               .find("\nrayloc_source_received_total{access_point=\"ap2\"} 2000\n") !=
           std::string::npos;
  })) << daemon.errors();
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

TEST(Http, TheStateOfADaemonThatLocatesNothingIsShown) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[engine]\nmethod = \"none\"\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const std::string address = "127.0.0.1:" + std::to_string(daemon.http_port());
  Process status(folder.path(), "status", "rayloc", {"status", "--http", address});
  EXPECT_EQ(status.wait(kPatience), 0) << status.errors();
  EXPECT_THAT(read_text(status.out()),
              HasSubstr("0 fixes, 0 without a position, 0 tracks of devices; "));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

TEST(Http, ATokenThatSystemdPassesIsAskedFor) {
  const TemporaryFolder folder;
  const std::string token = "0123456789abcdef0123456789abcdef";
  std::ofstream(folder.path() / "http.token") << token << "\n";
  std::filesystem::permissions(folder.path() / "http.token", std::filesystem::perms(0600));
  LiveDaemon daemon(
      folder.path(),
      {.site = bundled(""),
       .access_points = {"ap2"},
       .more_configuration = "[engine]\nmethod = \"none\"\n",
       .setting = {.environment = {"CREDENTIALS_DIRECTORY=" + folder.path().string()}}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  EXPECT_THAT(http_get(daemon.http_port(), "/api/v1/status"), StartsWith("HTTP/1.1 401 "));
  EXPECT_THAT(
      http_get(daemon.http_port(), "/api/v1/status", "Authorization: Bearer " + token + "\r\n"),
      StartsWith("HTTP/1.1 200 "));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::e2e::http_test
