#include "daemon/live/config/config.h"

#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "capture/source/transport_schemes.h"
#include "daemon/base/roff.h"
#include "daemon/live/config/config_schema.h"
#include "daemon/live/config/recording_files.h"
#include "daemon/live/config/source_url.h"
#include "daemon/methods/method_registry.h"
#include "tests/daemon/live/config/config_text.h"
#include "tests/support/test_paths.h"

namespace rayloc::config_test {
namespace {

namespace fs = std::filesystem;
using testing::config_text;
using ::testing::HasSubstr;
using testing::kConfigFile;
using testing::kOtherText;
using testing::kUnixSource;
using testing::kUrlSource;
using testing::without_folders;

constexpr std::string_view kSmallest = "[site]\ndirectory = \"/s\"\n[[source]]\nkind = \"udp\"\n";

// A file that goes away with the test.
class ConfigFile {
 public:
  explicit ConfigFile(const std::string& text)
      : path_(fs::path(::testing::TempDir()) /
              (std::string("config_test-") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".toml")) {
    std::ofstream(path_) << text;
  }
  ~ConfigFile() { fs::remove(path_); }
  ConfigFile(const ConfigFile&) = delete;
  ConfigFile& operator=(const ConfigFile&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string in_quotes(const fs::path& path) { return "\"" + path.string() + "\""; }

TEST(Config, ReadsEveryKey) {
  const Expected<DaemonConfig> config = parse_config(config_text(), kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  const fs::path folder = kConfigFile.parent_path();
  EXPECT_EQ(config->file, kConfigFile);
  EXPECT_EQ(config->sites.front().directory, folder / "meeting_room");
  ASSERT_EQ(config->sources.size(), 3U);
  const SourceConfig& udp = config->sources[0];
  EXPECT_EQ(udp.kind, SourceKind::kUdp);
  EXPECT_EQ(udp.access_point, "ap1");
  EXPECT_EQ(udp.listen_host, "127.0.0.1");
  EXPECT_EQ(udp.listen_port, 5501);
  EXPECT_EQ(udp.place, kConfigFile.string() + ":5:1: ");
  const SourceConfig& pcap = config->sources[1];
  EXPECT_EQ(pcap.kind, SourceKind::kPcap);
  EXPECT_EQ(pcap.files, (std::vector<fs::path>{folder / "two.pcap"}));
  EXPECT_EQ(pcap.speed, 2.0);
  EXPECT_EQ(pcap.format, "axcsi-v4");
  const SourceConfig& interface = config->sources[2];
  EXPECT_EQ(interface.kind, SourceKind::kInterface);
  EXPECT_EQ(interface.interface, "eth0");
  EXPECT_EQ(interface.filter, "udp port 5503");
  EXPECT_EQ(config->engine.burst, std::chrono::milliseconds(500));
  EXPECT_EQ(config->engine.accuracy_confidence, 0.9);
  EXPECT_EQ(config->limits.ring_frames, 100U);
  EXPECT_EQ(config->limits.max_targets, 7U);
  EXPECT_EQ(config->publish.endpoint, "tcp://0.0.0.0:5561");
  EXPECT_EQ(config->publish.snapshot, "ipc:///run/snapshot");
  EXPECT_TRUE(config->publish.insecure);
  EXPECT_EQ(config->publish.heartbeat, std::chrono::milliseconds(2500));
  EXPECT_EQ(config->publish.send_high_water_mark, 50U);
  EXPECT_TRUE(config->http.enabled);
  EXPECT_EQ(config->http.host, "0.0.0.0");
  EXPECT_EQ(config->http.port, 8481);
  EXPECT_EQ(config->http.token_file, folder / "token");
  EXPECT_TRUE(config->http.insecure);
  EXPECT_EQ(config->record.directory, folder / "recordings");
  EXPECT_FALSE(config->cache.enabled);
  EXPECT_EQ(config->cache.directory, folder / "kept");
  EXPECT_EQ(config->log.level, LogLevel::kDebug);
  EXPECT_FALSE(config->curve.enabled);
  EXPECT_EQ(config->curve.secret_file, folder / "secret");
  EXPECT_EQ(config->curve.allow,
            std::vector<std::string>{"Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hID"});
  EXPECT_EQ(config->privacy.target_id, TargetId::kHmac);
  EXPECT_EQ(config->privacy.rotate, std::chrono::hours(2));
  EXPECT_EQ(config->privacy.key_file, folder / "privacy.key");
}

TEST(Config, ReadsTheOtherKeys) {
  const Expected<DaemonConfig> config = parse_config(kOtherText, kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->sources[0].only_interface, "eth1");
  EXPECT_EQ(config->sources[0].allow, (std::vector<std::string>{"10.10.10.10", "192.168.1.0/24"}));
  EXPECT_EQ(config->sources[0].stall_after, std::chrono::milliseconds(7500));
  EXPECT_EQ(config->sources[1].max_gap, std::chrono::seconds(20));
  EXPECT_EQ(config->engine.method, nullptr);
  EXPECT_EQ(config->sites[0].name, "office");
  EXPECT_TRUE(config->sites[0].has_method);
  EXPECT_EQ(config->sites[0].method, nullptr);
  EXPECT_FALSE(config->sites[0].record);
  EXPECT_EQ(config->sources[0].site, "office");
  EXPECT_FALSE(config->engine.snapshots_always);
  EXPECT_EQ(config->engine.tracks, "cloud");
  EXPECT_TRUE(config->publish.csi);
  constexpr std::uint64_t kMebibyte = 1024UL * 1024UL;
  EXPECT_EQ(config->record.rotate_bytes, 3 * kMebibyte);
  EXPECT_EQ(config->record.rotate_every, std::chrono::seconds(90));
  EXPECT_EQ(config->record.max_total_bytes, 5 * kMebibyte);
  EXPECT_EQ(config->record.min_free_bytes, 7 * kMebibyte);
  EXPECT_EQ(config->record.ring, std::chrono::seconds(11));
  EXPECT_EQ(config->record.ring_bytes, 13 * kMebibyte);
  EXPECT_EQ(config->record.snapshot_directory, kConfigFile.parent_path() / "snapshots");
  EXPECT_EQ(config->http.front.base_path, "/rayloc");
  EXPECT_EQ(config->http.front.origins,
            (std::vector<std::string>{"https://home.example", "http://nas:8480"}));
  EXPECT_EQ(config->http.front.frame_ancestors,
            (std::vector<std::string>{"self", "http://homeassistant.local:8123"}));
  EXPECT_TRUE(config->http.edit);
}

TEST(Config, DefaultsAreThoseOfTheDocumentation) {
  const Expected<DaemonConfig> config = parse_config(kSmallest, kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->engine.tracks, "grid");
  EXPECT_EQ(config->sources[0].listen_host, "0.0.0.0");
  EXPECT_EQ(config->sources[0].listen_port, 5500);
  EXPECT_EQ(config->engine.burst, std::chrono::milliseconds(200));
  EXPECT_EQ(config->engine.accuracy_confidence, 0.95);
  EXPECT_EQ(config->limits.ring_frames, 8192U);
  EXPECT_EQ(config->limits.max_targets, 256U);
  EXPECT_EQ(config->publish.endpoint, "tcp://127.0.0.1:5560");
  EXPECT_EQ(config->publish.snapshot, "tcp://127.0.0.1:5561");
  EXPECT_FALSE(config->publish.insecure);
  EXPECT_EQ(config->publish.heartbeat, std::chrono::seconds(1));
  EXPECT_EQ(config->http.host, "127.0.0.1");
  EXPECT_EQ(config->http.port, 8480);
  EXPECT_EQ(config->http.front.base_path, "/");
  EXPECT_TRUE(config->http.front.origins.empty());
  EXPECT_TRUE(config->http.front.frame_ancestors.empty());
  EXPECT_TRUE(config->record.directory.empty());
  EXPECT_TRUE(config->cache.enabled);
  EXPECT_TRUE(config->cache.directory.empty());
  EXPECT_EQ(config->log.level, LogLevel::kInfo);
  EXPECT_FALSE(config->curve.enabled);
  EXPECT_FALSE(config->publish.csi);
  EXPECT_EQ(config->engine.method, find_method("rayloc"));
  EXPECT_EQ(config->privacy.target_id, TargetId::kMac);
  EXPECT_EQ(config->privacy.rotate, std::chrono::hours(24));
}

TEST(Config, WithCurveEndpointsMayBeReachedFromTheNetwork) {
  const Expected<DaemonConfig> config = parse_config(
      std::string(kSmallest) +
          "[publish]\nendpoint = \"tcp://0.0.0.0:5560\"\nsnapshot = \"tcp://*:5561\"\n"
          "[curve]\nenabled = true\nallow = \"Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hID\"\n",
      kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_TRUE(config->curve.enabled);
  EXPECT_EQ(config->curve.allow.size(), 1U);
}

TEST(Config, StandardInputAndGreatestSpeedAreWritten) {
  const Expected<DaemonConfig> config = parse_config(
      "[site]\ndirectory = \"/s\"\n[[source]]\nkind = \"pcap\"\nfile = \"-\"\nspeed = \"max\"\n",
      kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->sources[0].files, (std::vector<fs::path>{"-"}));
  EXPECT_FALSE(config->sources[0].speed);
}

TEST(Field, ASourceHasSeveralRecordingsAndWaitsForNoGap) {
  const std::string begin = "[site]\ndirectory = \"/s\"\n[[source]]\nkind = \"pcap\"\n";
  const Expected<DaemonConfig> config =
      parse_config(begin + "file = [\"/r/a.pcap1\", \"b.pcap*\"]\n", kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->sources[0].files,
            (std::vector<fs::path>{"/r/a.pcap1", kConfigFile.parent_path() / "b.pcap*"}));
  EXPECT_EQ(config->sources[0].max_gap, std::chrono::seconds(10));
  const Expected<DaemonConfig> longer =
      parse_config(begin + "file = \"a\"\nmax_gap_s = 3600\n", kConfigFile);
  ASSERT_TRUE(longer) << longer.error().message;
  EXPECT_EQ(longer->sources[0].max_gap, std::chrono::hours(1));
}

TEST(Field, WildcardsOfARecordingAreExpanded) {
  const fs::path folder = fs::path(::testing::TempDir()) / "field_wildcards";
  fs::create_directories(folder);
  for (const char* name : {"ring.pcap0", "ring.pcap1", "other.pcap"}) {
    std::ofstream(folder / name) << "x";
  }
  SourceConfig source;
  source.files = {folder / "ring.pcap*", folder / "none*", "-"};
  EXPECT_EQ(recording_files(source),
            (std::vector<std::string>{
                folder / "ring.pcap0", folder / "ring.pcap1", folder / "none*", "-"}));
  fs::remove_all(folder);
}

TEST(DaemonSetup, ResolvesSourcesToAccessPoints) {
  const ConfigFile file(
      config_text("\"meeting_room\"", in_quotes(kConfigFile.parent_path() / "meeting_room")));
  const Expected<DaemonSetup> setup = load_daemon_setup(file.path());
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->sites.front().site.name, "meeting_room");
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(setup->config.sources[i].access_point_index, i);
  }
}

TEST(DaemonSetup, ReportsTheErrorsOfBothFiles) {
  const ConfigFile site("name = 3\n");
  const fs::path other = fs::path(::testing::TempDir()) / "config_test-both.toml";
  std::ofstream(other) << "[site]\ndirectory = " << in_quotes(site.path())
                       << "\n[[source]]\nkind = \"udb\"\n";
  const Expected<DaemonSetup> setup = load_daemon_setup(other);
  fs::remove(other);
  ASSERT_FALSE(setup);
  EXPECT_EQ(setup.error().kind, ErrorKind::kConfiguration);
  EXPECT_THAT(setup.error().message, HasSubstr(":4:8: 'udb' is no value of 'kind'"));
  EXPECT_THAT(setup.error().message, HasSubstr(":1:8: 'name' is an integer"));
}

// The example with every commented key enabled, as an operator would write it.
std::string example_with_every_key() {
  return std::regex_replace(config_example(), std::regex("(^|\n)#([a-z])"), "$1$2");
}

TEST(ConfigExample, IsTheFileInDeploy) {
  std::ifstream in(test::source_path("/deploy/raylocd.toml"));
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  EXPECT_EQ(text, config_example()) << "run: rayloc config default > deploy/raylocd.toml";
}

TEST(Config, ReadsTheClusterSettings) {
  const Expected<DaemonConfig> config = parse_config(kOtherText, kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  const ClusterConfig& cluster = config->cluster;
  EXPECT_EQ(cluster.role, ClusterRole::kCapture);
  EXPECT_EQ(cluster.servers, std::vector<std::string>{"nats://127.0.0.1:4222"});
  EXPECT_EQ(cluster.name, "node1");
  EXPECT_EQ(cluster.tls_ca, kConfigFile.parent_path() / "ca.pem");
  EXPECT_EQ(cluster.tls_cert, kConfigFile.parent_path() / "node1.pem");
  EXPECT_EQ(cluster.tls_key, kConfigFile.parent_path() / "node1.key");
  EXPECT_EQ(cluster.nkey_seed_file, kConfigFile.parent_path() / "node1.nkey");
  EXPECT_EQ(cluster.flush, std::chrono::milliseconds(5));
  EXPECT_EQ(cluster.window_bytes, std::size_t{2} << 20U);
  EXPECT_EQ(cluster.keep, std::chrono::seconds(3));
  EXPECT_EQ(cluster.keep_bytes, std::size_t{4} << 20U);
  EXPECT_EQ(cluster.lease, std::chrono::milliseconds(1500));
  EXPECT_EQ(cluster.capacity, 6U);
  EXPECT_EQ(cluster.rewarm, std::chrono::seconds(7));
  EXPECT_TRUE(cluster.is_hot);
  EXPECT_FALSE(cluster.in_memory);
  EXPECT_EQ(cluster.replicas, 3);
  EXPECT_EQ(cluster.retention, std::chrono::seconds(90));
  EXPECT_EQ(parse_config(kSmallest, kConfigFile)->cluster.role, ClusterRole::kNone);
}

TEST(ConfigExample, IsValidAndHoldsTheDefaults) {
  const Expected<DaemonConfig> config = parse_config(config_example(), kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->engine.burst, std::chrono::milliseconds(200));
}

TEST(ConfigExample, StatesEveryKeyWithAValueThatIsAccepted) {
  std::string text = example_with_every_key();
  // A source has one kind, so each of the three is tried separately.
  for (const ConfigOption& option : config_options()) {
    EXPECT_THAT(text, HasSubstr("\n" + std::string(option.key) + " = ")) << option.key;
    EXPECT_FALSE(option.description.empty()) << option.key;
  }
  for (const char* kind : {"udp", "pcap", "interface"}) {
    std::string one = std::regex_replace(
        text, std::regex("kind = \"udp\""), "kind = \"" + std::string(kind) + "\"");
    for (const ConfigOption& option : config_options()) {
      if (option.section == "source" && !applies_to_kind(option, kind)) {
        one = std::regex_replace(one, std::regex("\n" + std::string(option.key) + " = [^\n]*"), "");
      }
    }
    const Expected<DaemonConfig> config = parse_config(one, kConfigFile);
    EXPECT_TRUE(config) << config.error().message;
  }
}

TEST(ConfigSchema, EveryKeyIsStoredOnceAndStatedInTheTest) {
  std::set<std::string> seen;
  for (const ConfigOption& option : config_options()) {
    const std::string path = std::string(option.section) + "." + std::string(option.key);
    EXPECT_TRUE(seen.insert(path).second) << path << " has two rows";
    EXPECT_EQ(option.section != "source" && option.section != "site", option.store != nullptr)
        << path;
    EXPECT_EQ(option.section == "site", option.store_site != nullptr) << path;
    EXPECT_EQ(option.section == "source", option.store_source != nullptr) << path;
    // ReadsEveryKey, ReadsTheOtherKeys and the test of unix sources check each value of these.
    EXPECT_THAT("\n" + config_text() + std::string(kUnixSource) + std::string(kUrlSource) +
                    std::string(kOtherText),
                HasSubstr("\n" + std::string(option.key) + " = "));
  }
}

TEST(ParseConfig, ReadsTheSocketOfRaylocCapture) {
  const Expected<DaemonConfig> config =
      parse_config(config_text() + std::string(kUnixSource), kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->sources.at(3).kind, SourceKind::kUnix);
  EXPECT_EQ(config->sources.at(3).path, "/run/raylocd/eth0");
}

// The sources of a file with these keys.
Expected<std::vector<SourceConfig>> sources_of(const std::string& keys) {
  auto config = parse_config("[site]\ndirectory = \"/s\"\n[[source]]\n" + keys + "\n", kConfigFile);
  return config ? Expected<std::vector<SourceConfig>>(config->sources)
                : tl::make_unexpected(config.error());
}

TEST(ParseConfig, AUrlEqualsKindAndAddress) {
  struct Case {
    const char* url;
    const char* keys;
  };
  for (const Case& c : {Case{"udp:10.0.0.7:5501", "kind = \"udp\"\nlisten = \"10.0.0.7:5501\""},
                        Case{"pcap:sub/one.pcap", "kind = \"pcap\"\nfile = \"sub/one.pcap\""},
                        Case{"pcap:/one.pcap", "kind = \"pcap\"\nfile = \"/one.pcap\""},
                        Case{"pcap:-", "kind = \"pcap\"\nfile = \"-\""},
                        Case{"live:eth0", "kind = \"interface\"\ninterface = \"eth0\""},
                        Case{"unix:run/eth0", "kind = \"unix\"\npath = \"run/eth0\""}}) {
    const auto by_url = sources_of("url = \"" + std::string(c.url) + "\"");
    const auto by_keys = sources_of(c.keys);
    ASSERT_TRUE(by_url) << by_url.error().message;
    ASSERT_TRUE(by_keys) << by_keys.error().message;
    const SourceConfig& one = by_url->at(0);
    const SourceConfig& other = by_keys->at(0);
    EXPECT_EQ(one.kind, other.kind) << c.url;
    EXPECT_EQ(source_url(one), source_url(other));
    EXPECT_EQ(one.files, other.files);
    EXPECT_EQ(one.path, other.path);
    EXPECT_EQ(one.filter, other.filter);
    EXPECT_EQ(one.stall_after, other.stall_after);
    EXPECT_EQ(one.max_gap, other.max_gap);
    EXPECT_EQ(one.speed, other.speed);
  }
}

TEST(ParseConfig, ReportsInvalidUrls) {
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"url = \"nats:lab\"",
       "raylocd.toml:4:7: 'url': 'nats:lab': there is no transport 'nats'; there are: udp, pcap, "
       "unix, live"},
      {"url = \"udq:0.0.0.0:5500\"", "did you mean 'udp'?"},
      {"url = \"0.0.0.0:5500\"", "no transport is named; write SCHEME:ADDRESS"},
      {"url = \"live:\"", "nothing follows the colon"},
      {"url = \"udp:lab:5500\"", "no ADDRESS:PORT of this machine follows the colon"},
      {"url = \"live:eth0\"\nkind = \"udp\"", ":5:8: 'kind' is part of 'url'"},
      {"url = \"udp:0.0.0.0:5500\"\nlisten = \"0.0.0.0:5500\"", "'listen' is part of 'url'"},
      {"url = \"live:eth0\"\nallow = [\"10.0.0.1\"]", "'allow' belongs to kind udp"},
      {"url = \"live:eth0\"\n[[source]]\nkind = \"interface\"\ninterface = \"eth0\"",
       ":7:13: a second source on interface eth0"},
  };
  for (const auto& [keys, message] : cases) {
    const auto sources = sources_of(keys);
    ASSERT_FALSE(sources) << keys;
    EXPECT_THAT(sources.error().message, HasSubstr(message));
  }
}

TEST(ConfigSchema, ListsTheTransportsThereAre) {
  const std::string page = config_manual_page();
  const auto schema = nlohmann::json::parse(config_json_schema());
  const auto& source = schema.at("properties").at("source").at("items");
  const std::regex urls(source.at("properties").at("url").at("pattern").get<std::string>());
  for (const TransportScheme& row : transport_schemes()) {
    EXPECT_TRUE(std::regex_search(std::string(row.example), urls)) << row.example;
    EXPECT_THAT(config_example(),
                HasSubstr(std::string(row.name) + ":" + std::string(row.address)));
    EXPECT_THAT(page, HasSubstr(roff(row.summary)));
  }
  EXPECT_FALSE(std::regex_search("nats:lab", urls));
}

TEST(ConfigSchema, JsonSchemaHasEveryKeyAndTheRequiredSections) {
  const auto schema = nlohmann::json::parse(config_json_schema());
  EXPECT_EQ(schema.at("additionalProperties"), false);
  EXPECT_EQ(schema.at("required"), nlohmann::json({"site", "source"}));
  for (const ConfigOption& option : config_options()) {
    const std::string section(option.section);
    const nlohmann::json& object =
        section.empty()       ? schema
        : section == "source" ? schema.at("properties").at(section).at("items")
        : section == "site"   ? schema.at("properties").at(section).at("anyOf").at(0)
                              : schema.at("properties").at(section);
    const nlohmann::json& property = object.at("properties").at(std::string(option.key));
    EXPECT_EQ(property.at("description"), std::string(option.description));
    EXPECT_EQ(property.contains("default"), !option.preset.empty());
  }
  EXPECT_EQ(schema.at("properties").at("engine").at("properties").at("burst_s").at("minimum"),
            0.01);
}

TEST(EffectiveConfig, ReadsBackAsTheSameAndMarksDefaults) {
  const ConfigFile file(std::string(kSmallest) + "[engine]\nburst_s = 0.3\n");
  const Expected<std::string> text = effective_config(file.path());
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_THAT(*text, HasSubstr("[site]\ndirectory = \"/s\"\n"));
  EXPECT_THAT(*text, HasSubstr("burst_s = 0.3\n"));
  EXPECT_THAT(*text, HasSubstr("ring_frames = 8192  # default\n"));
  const Expected<DaemonConfig> again = parse_config(*text, file.path());
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->engine.burst, std::chrono::milliseconds(300));
  EXPECT_EQ(again->sources.size(), 1U);
}

}  // namespace
}  // namespace rayloc::config_test
