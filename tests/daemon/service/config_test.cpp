#include "daemon/service/config.h"

#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/service/config_schema.h"
#include "tests/daemon/service/config_text.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;
using testing::config_text;
using ::testing::HasSubstr;
using testing::kConfigFile;
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
  EXPECT_EQ(config->site_directory, folder / "meeting_room");
  ASSERT_EQ(config->sources.size(), 3U);
  const SourceConfig& udp = config->sources[0];
  EXPECT_EQ(udp.kind, SourceKind::kUdp);
  EXPECT_EQ(udp.access_point, "ap1");
  EXPECT_EQ(udp.listen_host, "127.0.0.1");
  EXPECT_EQ(udp.listen_port, 5501);
  EXPECT_EQ(udp.line, 4);
  EXPECT_EQ(udp.column, 1);
  const SourceConfig& pcap = config->sources[1];
  EXPECT_EQ(pcap.kind, SourceKind::kPcap);
  EXPECT_EQ(pcap.file, folder / "two.pcap");
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
  EXPECT_TRUE(config->publish.insecure);
  EXPECT_EQ(config->publish.heartbeat, std::chrono::milliseconds(2500));
  EXPECT_EQ(config->publish.send_high_water_mark, 50U);
  EXPECT_EQ(config->record.directory, folder / "recordings");
  EXPECT_EQ(config->log.level, LogLevel::kDebug);
}

TEST(Config, DefaultsAreThoseOfTheDocumentation) {
  const Expected<DaemonConfig> config = parse_config(kSmallest, kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->sources[0].listen_host, "0.0.0.0");
  EXPECT_EQ(config->sources[0].listen_port, 5500);
  EXPECT_EQ(config->engine.burst, std::chrono::milliseconds(200));
  EXPECT_EQ(config->engine.accuracy_confidence, 0.95);
  EXPECT_EQ(config->limits.ring_frames, 8192U);
  EXPECT_EQ(config->limits.max_targets, 256U);
  EXPECT_EQ(config->publish.endpoint, "tcp://127.0.0.1:5560");
  EXPECT_FALSE(config->publish.insecure);
  EXPECT_EQ(config->publish.heartbeat, std::chrono::seconds(1));
  EXPECT_TRUE(config->record.directory.empty());
  EXPECT_EQ(config->log.level, LogLevel::kInfo);
}

TEST(Config, StandardInputAndGreatestSpeedAreWritten) {
  const Expected<DaemonConfig> config = parse_config(
      "[site]\ndirectory = \"/s\"\n[[source]]\nkind = \"pcap\"\nfile = \"-\"\nspeed = \"max\"\n",
      kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->sources[0].file, "-");
  EXPECT_FALSE(config->sources[0].speed);
}

TEST(DaemonSetup, ResolvesSourcesToAccessPoints) {
  const ConfigFile file(
      config_text("\"meeting_room\"", in_quotes(kConfigFile.parent_path() / "meeting_room")));
  const Expected<DaemonSetup> setup = load_daemon_setup(file.path());
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->site.name, "meeting_room");
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(setup->config.sources[static_cast<std::size_t>(i)].access_point_index, i);
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

// The example with every commented key in place, as somebody would write it.
std::string example_with_every_key() {
  return std::regex_replace(config_example(), std::regex("(^|\n)#([a-z])"), "$1$2");
}

TEST(ConfigExample, IsTheFileInDeploy) {
  std::ifstream in(fs::path(RAYLOC_TEST_DATA) / "../../deploy/raylocd.toml");
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  EXPECT_EQ(text, config_example()) << "run: rayloc config default > deploy/raylocd.toml";
}

TEST(ConfigExample, IsValidAndHoldsTheDefaults) {
  const Expected<DaemonConfig> config = parse_config(config_example(), kConfigFile);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->engine.burst, std::chrono::milliseconds(200));
}

TEST(ConfigExample, StatesEveryKeyWithAValueThatIsAccepted) {
  std::string text = example_with_every_key();
  // Of the three kinds only one can be tried at a time.
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
    EXPECT_EQ(option.section != "source", option.store != nullptr) << path;
    EXPECT_EQ(option.section == "source", option.store_source != nullptr) << path;
    // ReadsEveryKey checks each value of this text.
    EXPECT_THAT("\n" + config_text(), HasSubstr("\n" + std::string(option.key) + " = "));
  }
}

TEST(ConfigSchema, JsonSchemaHasEveryKeyAndRequiresWhatWeRequire) {
  const auto schema = nlohmann::json::parse(config_json_schema());
  EXPECT_EQ(schema.at("additionalProperties"), false);
  EXPECT_EQ(schema.at("required"), nlohmann::json({"site", "source"}));
  for (const ConfigOption& option : config_options()) {
    const std::string section(option.section);
    const nlohmann::json& object = section.empty() ? schema
                                   : section == "source"
                                       ? schema.at("properties").at(section).at("items")
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
}  // namespace rayloc
