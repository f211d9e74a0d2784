// What raylocd's configuration says when it is wrong: the exact place, and what to write instead.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/service/config_text.h"

namespace rayloc {
namespace {

using testing::config_text;
using testing::errors_of;
using ::testing::HasSubstr;
using testing::kConfigFile;
using ::testing::StartsWith;

struct Case {
  const char* name;
  const char* from;
  const char* to;
  const char* begin;
  const char* hint;
};

class ConfigError : public ::testing::TestWithParam<Case> {};

TEST_P(ConfigError, NamesThePlaceAndWhatToWrite) {
  const std::string errors = errors_of(config_text(GetParam().from, GetParam().to));
  EXPECT_THAT(errors, StartsWith(GetParam().begin));
  EXPECT_THAT(errors, HasSubstr(GetParam().hint));
  EXPECT_EQ(errors.find('\n'), std::string::npos) << "one mistake, one line: " << errors;
}

const Case kCases[] = {
    {"Schema", "schema = 1", "schema = 2", "raylocd.toml:1:10: 'schema' is 2", "1"},
    {"UnknownKey",
     "burst_s",
     "burst",
     "raylocd.toml:20:1: unknown key 'burst' in [engine]",
     "did you mean 'burst_s'?"},
    {"UnknownTable", "[limits]", "[limit]", "raylocd.toml:22:2: unknown key 'limit'", "'limits'"},
    {"NoDirectory",
     "directory = \"meeting_room\"\n",
     "",
     "raylocd.toml:2:1: [site] lacks 'directory'",
     "directory = \""},
    {"Kind",
     "\"udp\"",
     "\"udb\"",
     "raylocd.toml:6:8: 'udb' is no value of 'kind'",
     "did you mean 'udp'?"},
    {"NoFile",
     "file = \"two.pcap\"\n",
     "",
     "raylocd.toml:8:1: [[source]] lacks 'file'",
     "file = \"recording.pcap\""},
    {"NoInterface",
     "interface = \"eth0\"\n",
     "",
     "raylocd.toml:14:1: [[source]] lacks 'interface'",
     "eth0"},
    {"KeyOfOtherKind",
     "speed = 2",
     "listen = \":1\"",
     "raylocd.toml:12:10: 'listen' belongs to",
     "this source is of kind pcap"},
    {"Listen",
     "127.0.0.1:5501",
     "127.0.0.1",
     "raylocd.toml:7:10: 'listen' is no ADDRESS:PORT",
     "0.0.0.0:5500"},
    {"ListenPort",
     "127.0.0.1:5501",
     "127.0.0.1:65536",
     "raylocd.toml:7:10: 'listen' is no",
     "0.0.0.0:5500"},
    {"Speed", "speed = 2", "speed = \"fast\"", "raylocd.toml:12:9: 'speed' is 'fast'", "\"max\""},
    {"SpeedZero", "speed = 2", "speed = 0", "raylocd.toml:12:9: 'speed' is 0", "from 0.001"},
    {"Format", "axcsi-v4", "axcsi-v5", "raylocd.toml:13:10: 'axcsi-v5' is no value", "'axcsi-v4'"},
    {"Burst",
     "burst_s = 0.5",
     "burst_s = -1",
     "raylocd.toml:20:11: 'burst_s' is -1",
     "from 0.01 to 10 s"},
    {"BurstNaN", "burst_s = 0.5", "burst_s = nan", "raylocd.toml:20:11: 'burst_s' is nan", "0.01"},
    {"WholeNumber",
     "ring_frames = 100",
     "ring_frames = 100.5",
     "raylocd.toml:23:15: 'ring_frames' is a number",
     "a whole number"},
    {"Boolean",
     "0.0.0.0:5561\"\ninsecure = true",
     "127.0.0.1:5561\"\ninsecure = \"yes\"",
     "raylocd.toml:27:12: 'insecure' is a string",
     "insecure = true"},
    {"EndpointOpen",
     "insecure = true\n",
     "",
     "raylocd.toml:26:12: 'endpoint' can be reached from the network",
     "insecure = true"},
    {"EndpointScheme",
     "tcp://0.0.0.0:5561",
     "udp://0.0.0.0:5561",
     "raylocd.toml:26:12: 'endpoint' is 'udp://0.0.0.0:5561'",
     "tcp://127.0.0.1:5560"},
    {"Level",
     "\"debug\"",
     "\"debugging\"",
     "raylocd.toml:33:9: 'debugging' is no value of 'level'",
     "did you mean 'debug'?"},
    {"Syntax", "[log]", "[log", "raylocd.toml:32:5: not TOML: ", "']'"},
    {"TableForSources",
     "[[source]]\naccess_point = \"ap1\"",
     "[source]\naccess_point = \"ap1\"",
     "raylocd.toml:8:",
     "not TOML"},
};

INSTANTIATE_TEST_SUITE_P(All, ConfigError, ::testing::ValuesIn(kCases), [](const auto& tested) {
  return std::string(tested.param.name);
});

std::string sources(const std::string& first, const std::string& second) {
  return "[site]\ndirectory = \"/s\"\n[[source]]\naccess_point = \"a\"\n" + first +
         "\n[[source]]\naccess_point = \"b\"\n" + second + "\n";
}

TEST(ConfigErrors, TwoSourcesCannotShareAPort) {
  const std::string port = "kind = \"udp\"\nlisten = \"127.0.0.1:5500\"";
  EXPECT_THAT(
      errors_of(sources(port, port)),
      StartsWith("raylocd.toml:10:10: a second source on UDP port 5500 (the first: line 3)"));
  // Every address includes this one, whether it is stated or the default.
  EXPECT_THAT(errors_of(sources("kind = \"udp\"", port)),
              StartsWith("raylocd.toml:9:10: a second source on UDP port 5500"));
  EXPECT_THAT(errors_of(sources(port, "kind = \"udp\"")),
              StartsWith("raylocd.toml:7:1: a second source on UDP port 5500"));
  EXPECT_EQ(errors_of(sources(port, "kind = \"udp\"\nlisten = \"127.0.0.2:5500\"")), "");
}

TEST(ConfigErrors, TwoSourcesCannotShareAFileOrInterface) {
  const std::string file = "kind = \"pcap\"\nfile = \"-\"";
  EXPECT_THAT(errors_of(sources(file, file)),
              StartsWith("raylocd.toml:10:8: a second source on -"));
  const std::string interface = "kind = \"interface\"\ninterface = \"eth0\"";
  EXPECT_THAT(errors_of(sources(interface, interface)),
              StartsWith("raylocd.toml:10:13: a second source on interface eth0"));
  EXPECT_EQ(errors_of(sources(interface, interface + "\nfilter = \"udp dst port 5501\"")), "");
}

TEST(ConfigErrors, EmptyFileLacksSiteAndSource) {
  EXPECT_EQ(errors_of(""),
            "raylocd.toml:1:1: the file lacks 'site'; add, for example: [site] with directory = "
            "\"site\"\n"
            "raylocd.toml:1:1: the file lacks 'source'; add, for example: [[source]] with kind = "
            "\"udp\"");
}

// The errors of a configuration against the bundled site.
std::string setup_errors(const std::string& text) {
  // Tests run side by side.
  const std::filesystem::path file =
      std::filesystem::path(::testing::TempDir()) /
      (std::string("config_errors_test-") +
       ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".toml");
  std::ofstream(file) << "[site]\ndirectory = \""
                      << (kConfigFile.parent_path() / "meeting_room").string() << "\"\n"
                      << text;
  const Expected<DaemonSetup> setup = load_daemon_setup(file);
  std::filesystem::remove(file);
  if (setup) {
    return "";
  }
  const std::string& message = setup.error().message;
  return message.substr(file.string().size() + 1);
}

TEST(ConfigErrors, SourceNamesAnAccessPointOfTheSite) {
  EXPECT_EQ(setup_errors("[[source]]\nkind = \"udp\"\naccess_point = \"ap9\"\n"),
            "5:16: the site has no access point 'ap9'; did you mean 'ap1'?");
  EXPECT_EQ(setup_errors("[[source]]\nkind = \"udp\"\n"),
            "3:1: [[source]] lacks 'access_point', and the site has several; write one of: ap1, "
            "ap2, ap3");
}

TEST(ConfigErrors, AccessPointHasOneSource) {
  EXPECT_EQ(
      setup_errors("[[source]]\nkind = \"udp\"\naccess_point = \"ap1\"\n"
                   "[[source]]\nkind = \"udp\"\nlisten = \":5501\"\naccess_point = \"ap1\"\n"),
      "9:16: access point 'ap1' has a source already; give each its own");
}

}  // namespace
}  // namespace rayloc
