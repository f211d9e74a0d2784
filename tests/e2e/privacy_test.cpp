// Everything that leaves a running raylocd, looked through for the address of the device that it
// locates: topics and payloads on both sockets, HTTP, log, names of files; as text and as bytes.
#include <cctype>
#include <map>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/publish/late_subscriber.h"
#include "daemon/live/publish/subscriber.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/support/patience.h"

namespace rayloc::e2e::privacy_test {
namespace {

using ::testing::HasSubstr;
using testing::http_get;

constexpr std::chrono::seconds kPatience{60};
const std::string kTransmitter = "02:52:4c:00:00:01";  // of the bundled recordings

// The address as people and programs write it, the text ones in lower case.
std::vector<std::string> forms_of_the_address() {
  return {"02:52:4c:00:00:01",
          "02-52-4c-00-00-01",
          "02524c000001",
          "0252.4c00.0001",
          "52:4c:00:00:01",
          std::string("\x02\x52\x4c\x00\x00\x01", 6),
          std::string("\x01\x00\x00\x4c\x52\x02", 6)};
}

std::string lower(std::string text) {
  for (char& c : text) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

// The names of what contains it, in the order of the map.
std::vector<std::string> places_of_the_address(const std::map<std::string, std::string>& outputs) {
  std::vector<std::string> places;
  for (const auto& [name, bytes] : outputs) {
    const std::string text = lower(bytes);
    for (const std::string& form : forms_of_the_address()) {
      if (bytes.find(form) != std::string::npos || text.find(form) != std::string::npos) {
        places.push_back(name);
        break;
      }
    }
  }
  return places;
}

void take(Subscriber& subscriber, std::map<std::string, std::string>& outputs) {
  while (const auto message = subscriber.receive(std::chrono::milliseconds(100))) {
    outputs["topics"] += message->topic + "\n";
    // Payloads by the class of their topic: "payloads v1/csi".
    outputs["payloads " + message->topic.substr(0, message->topic.find('/', 3))] +=
        message->payload;
  }
}

// All outputs of the daemon while it locates the device for a while.
std::map<std::string, std::string> outputs_of(const std::filesystem::path& folder,
                                              const std::string& privacy) {
  const std::filesystem::path records = folder / "recordings";
  LiveDaemon daemon(folder,
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "csi = true\n[log]\nlevel = \"trace\"\n[record]\n"
                                           "directory = \"" +
                                           records.string() + "\"\n" + privacy});
  EXPECT_TRUE(daemon.ready()) << daemon.errors();
  std::map<std::string, std::string> outputs;
  auto subscriber = Subscriber::connect(daemon.endpoint(), {""});
  EXPECT_TRUE(subscriber->receive(test::patient(kPatience))) << "its subscription has arrived";
  EXPECT_EQ(send_for_a_second(folder, daemon), 0);
  EXPECT_TRUE(eventually(kPatience, [&] {
    return !daemon.bodies("location").empty() && !daemon.bodies("csi").empty();
  })) << daemon.errors();
  take(*subscriber, outputs);
  auto late =
      LateSubscriber::join(daemon.endpoint(), daemon.snapshot(), {""}, test::patient(kPatience));
  EXPECT_TRUE(late);
  for (int i = 0; late && i < 5; ++i) {
    if (const auto message = late->receive(test::patient(kPatience))) {
      outputs["snapshot"] += message->topic + " " + message->payload;
    }
  }
  for (const char* path : {"/",
                           "/healthz",
                           "/readyz",
                           "/metrics",
                           "/api/v1/status",
                           "/api/v1/sources",
                           "/api/v1/targets",
                           "/api/v1/map",
                           "/api/v1/calibration",
                           "/api/v1/channel",
                           "/api/v1/presence",
                           "/api/v1/solid",
                           "/api/v1/config"}) {
    outputs[std::string("http ") + path] = http_get(daemon.http_port(), path);
  }
  daemon.signal(SIGHUP);
  EXPECT_TRUE(eventually(
      kPatience, [&] { return daemon.log().find("reload: no change") != std::string::npos; }));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  take(*subscriber, outputs);
  outputs["log"] = daemon.log();
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    outputs["file names"] += entry.path().string() + "\n";
    if (entry.path().extension() == ".pcap") {
      outputs["recording"] += read_text(entry.path());
    }
  }
  return outputs;
}

TEST(Privacy, NoAddressLeavesTheDaemonWhenItIsHashed) {
  const TemporaryFolder folder;
  const auto outputs = outputs_of(folder.path(), "[privacy]\ntarget_id = \"hmac\"\n");
  EXPECT_THAT(outputs.at("topics"), HasSubstr("v1/location/meeting_room/"));
  EXPECT_GT(outputs.at("payloads v1/csi").size(), 1000U);
  EXPECT_THAT(outputs.at("http /api/v1/targets"), HasSubstr("\"hashed_mac\":\""));
  EXPECT_THAT(outputs.at("log"), HasSubstr("recordings hold the addresses of all devices"));
  EXPECT_THAT(places_of_the_address(outputs), ::testing::ElementsAre("recording"));
}

// The same without, so that the one above looks in the right places.
TEST(Privacy, AddressesAppearEverywhereWithoutHashing) {
  const TemporaryFolder folder;
  EXPECT_THAT(places_of_the_address(outputs_of(folder.path(), "")),
              ::testing::IsSupersetOf({"http /api/v1/targets",
                                       "payloads v1/csi",
                                       "payloads v1/location",
                                       "recording",
                                       "snapshot",
                                       "topics"}));
}

// The channel behind a fix, which takes a calibrated site.
TEST(Privacy, TheChannelIsOfTheHashWhenItIsHashed) {
  const TemporaryFolder calibrated;
  const std::filesystem::path site = calibrated_site(calibrated.path());
  for (const bool hashed : {true, false}) {
    const TemporaryFolder folder;
    LiveDaemon daemon(folder.path(),
                      {.site = site,
                       .access_points = {"ap2"},
                       .more_configuration = hashed ? "[privacy]\ntarget_id = \"hmac\"\n" : ""});
    ASSERT_TRUE(daemon.ready()) << daemon.errors();
    http_get(daemon.http_port(), "/api/v1/channel");  // from now on channels are kept for it
    EXPECT_EQ(send_for_a_second(folder.path(), daemon), 0);
    std::string channel;
    EXPECT_TRUE(eventually(kPatience, [&] {  // it is made beside, once it has been asked for
      channel = http_get(daemon.http_port(), "/api/v1/channel");
      return channel.find("\"target\"") != std::string::npos;
    })) << daemon.errors();
    EXPECT_EQ(places_of_the_address({{"channel", channel}}).empty(), hashed) << channel;
    EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  }
}

TEST(Privacy, AReplayWithTheKeyGivesTheVeryHashes) {
  const TemporaryFolder folder;
  const std::filesystem::path key = folder.path() / "privacy.key";
  {
    Process keygen(folder.path(), "keygen", "rayloc", {"keygen", key.string()});
    ASSERT_EQ(keygen.wait(kPatience), 0) << keygen.errors();
  }
  std::vector<std::string> results;
  for (const char* run : {"one", "two"}) {
    Process replay(folder.path(),
                   run,
                   "rayloc",
                   {"replay",
                    bundled("").string(),
                    "ap2=" + bundled_recording("device_los", "ap2"),
                    "--target-key",
                    key.string()});
    ASSERT_EQ(replay.wait(std::chrono::minutes{4}), 0) << replay.errors();
    results.push_back(read_text(replay.out()));
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_THAT(results[0], HasSubstr("\"hashed_mac\":\""));
  EXPECT_EQ(results[0].find(kTransmitter), std::string::npos);
}

}  // namespace
}  // namespace rayloc::e2e::privacy_test
