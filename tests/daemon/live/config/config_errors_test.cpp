// Tests the errors of a wrong configuration of raylocd: the exact place, and what to write instead.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/live/config/config_text.h"

namespace rayloc::config_errors_test {
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

TEST_P(ConfigError, ReportsThePositionAndTheRemedy) {
  const std::string errors = errors_of(config_text(GetParam().from, GetParam().to));
  EXPECT_THAT(errors, StartsWith(GetParam().begin));
  EXPECT_THAT(errors, HasSubstr(GetParam().hint));
  EXPECT_EQ(errors.find('\n'), std::string::npos) << "one mistake, one line: " << errors;
}

const auto kCases = std::to_array<Case>({
    {"Schema", "schema = 1", "schema = 2", "raylocd.toml:1:10: 'schema' is 2", "1"},
    {"UnknownKey",
     "burst_s",
     "burst",
     "raylocd.toml:21:1: unknown key 'burst' in [engine]",
     "did you mean 'burst_s'?"},
    {"UnknownTable", "[limits]", "[limit]", "raylocd.toml:23:2: unknown key 'limit'", "'limits'"},
    {"NoDirectory",
     "directory = \"meeting_room\"\n",
     "",
     "raylocd.toml:3:1: [site] lacks 'directory'",
     "directory = \""},
    {"Kind",
     "\"udp\"",
     "\"udb\"",
     "raylocd.toml:7:8: 'udb' is no value of 'kind'",
     "did you mean 'udp'?"},
    {"NoFile",
     "file = \"two.pcap\"\n",
     "",
     "raylocd.toml:9:1: [[source]] lacks 'file'",
     "file = \"recording.pcap\""},
    {"NoInterface",
     "interface = \"eth0\"\n",
     "",
     "raylocd.toml:15:1: [[source]] lacks 'interface'",
     "eth0"},
    {"KeyOfOtherKind",
     "speed = 2",
     "listen = \":1\"",
     "raylocd.toml:13:10: 'listen' belongs to",
     "this source is of kind pcap"},
    {"Listen",
     "127.0.0.1:5501",
     "127.0.0.1",
     "raylocd.toml:8:10: 'listen' is no ADDRESS:PORT",
     "0.0.0.0:5500"},
    {"ListenPort",
     "127.0.0.1:5501",
     "127.0.0.1:65536",
     "raylocd.toml:8:10: 'listen' is no",
     "0.0.0.0:5500"},
    {"Speed", "speed = 2", "speed = \"fast\"", "raylocd.toml:13:9: 'speed' is 'fast'", "\"max\""},
    {"SpeedZero", "speed = 2", "speed = 0", "raylocd.toml:13:9: 'speed' is 0", "from 0.001"},
    {"Format", "axcsi-v4", "axcsi-v5", "raylocd.toml:14:10: 'axcsi-v5' is no value", "'axcsi-v4'"},
    {"Burst",
     "burst_s = 0.5",
     "burst_s = -1",
     "raylocd.toml:21:11: 'burst_s' is -1",
     "from 0.01 to 10 s"},
    {"BurstNaN", "burst_s = 0.5", "burst_s = nan", "raylocd.toml:21:11: 'burst_s' is nan", "0.01"},
    {"Tracks",
     "burst_s = 0.5",
     "tracks = \"clouds\"",
     "raylocd.toml:21:10: 'clouds' is no value of 'tracks'",
     "did you mean 'cloud'?"},
    {"WholeNumber",
     "ring_frames = 100",
     "ring_frames = 100.5",
     "raylocd.toml:24:15: 'ring_frames' is a number",
     "a whole number"},
    {"Boolean",
     "0.0.0.0:5561\"\nsnapshot = \"ipc:///run/snapshot\"\ninsecure = true",
     "127.0.0.1:5561\"\nsnapshot = \"ipc:///s\"\ninsecure = \"yes\"",
     "raylocd.toml:29:12: 'insecure' is a string",
     "insecure = true"},
    {"CurveKey",
     "Yne@",
     "Yne",
     "raylocd.toml:47:9: 'allow': 'Yne$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hID' is no public key",
     "rayloc keygen"},
    {"CurveForNobody",
     "enabled = false\nsecret_file = \"secret\"\nallow = "
     "[\"Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hID\"]\n",
     "enabled = true\n",
     "raylocd.toml:44:1: [curve] lacks 'allow'",
     "rayloc keygen"},
    {"EndpointOpen",
     "insecure = true\n",
     "",
     "raylocd.toml:27:12: 'endpoint' can be reached from the network",
     "or set up [curve], or insecure = true if that is meant"},
    {"EndpointScheme",
     "tcp://0.0.0.0:5561",
     "udp://0.0.0.0:5561",
     "raylocd.toml:27:12: 'endpoint' is 'udp://0.0.0.0:5561'",
     "tcp://127.0.0.1:5560"},
    {"EndpointNamed",
     "tcp://0.0.0.0:5561",
     "tcp://eth0:5561",
     "raylocd.toml:27:12: 'endpoint' is 'tcp://eth0:5561', and names of hosts and interfaces are",
     "write the numeric address"},
    {"SnapshotNamed",
     "ipc:///run/snapshot",
     "tcp://raylocd.example.org:5561",
     "raylocd.toml:28:12: 'snapshot' is 'tcp://raylocd.example.org:5561', and names of hosts",
     "write the numeric address"},
    {"SnapshotOpen",
     "tcp://0.0.0.0:5561\"\nsnapshot = \"ipc:///run/snapshot\"\ninsecure = true\n",
     "tcp://127.0.0.1:1\"\nsnapshot = \"tcp://*:2\"\n",
     "raylocd.toml:28:12: 'snapshot' can be reached from the network",
     "insecure = true"},
    {"HttpOpen",
     "token_file = \"token\"\ninsecure = true",
     "insecure = false",
     "raylocd.toml:34:10: 'listen' can be reached from the network",
     "token_file"},
    {"HttpEdit",
     "token_file = \"token\"\ninsecure = true",
     "edit = true\ninsecure = true",
     "raylocd.toml:35:8: 'edit' would let everyone on the network write the files of the site",
     "set token_file"},
    {"HttpListenIpv6",
     "0.0.0.0:8481",
     "[::1]:8481",
     "raylocd.toml:34:10: 'listen' is an IPv6 address",
     "127.0.0.1:8480"},
    {"ListenIpv6",
     "127.0.0.1:5501",
     "[::1]:5501",
     "raylocd.toml:8:10: 'listen' is an IPv6 address",
     "0.0.0.0:5500"},
    {"HttpListen",
     "0.0.0.0:8481",
     "8481",
     "raylocd.toml:34:10: 'listen' is no ADDRESS:PORT",
     "127.0.0.1:8480"},
    {"HttpBasePath",
     "insecure = true\n[record]",
     "insecure = true\nbase_path = \"rayloc\"\n[record]",
     "raylocd.toml:37:13: 'base_path' is 'rayloc', which is no path",
     "base_path = \"/rayloc\""},
    {"HttpOrigins",
     "insecure = true\n[record]",
     "insecure = true\norigins = [\"https://home.example\", \"home.example\"]\n[record]",
     "raylocd.toml:37:11: 'origins': 'home.example' is no origin",
     "https://home.example or"},
    {"HttpFrameAncestors",
     "insecure = true\n[record]",
     "insecure = true\nframe_ancestors = \"http://ha.local:8123/lovelace\"\n[record]",
     "raylocd.toml:37:19: 'frame_ancestors': 'http://ha.local:8123/lovelace' is no origin",
     "without a path, or self, or *"},
    {"Level",
     "\"debug\"",
     "\"debugging\"",
     "raylocd.toml:43:9: 'debugging' is no value of 'level'",
     "did you mean 'debug'?"},
    {"Syntax", "[log]", "[log", "raylocd.toml:42:5: not TOML: ", "']'"},
    {"TableForSources",
     "[[source]]\naccess_point = \"ap1\"",
     "[source]\naccess_point = \"ap1\"",
     "raylocd.toml:9:",
     "not TOML"},
});

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
      StartsWith(
          "raylocd.toml:10:10: a second source on UDP port 5500 (the first: raylocd.toml:3)"));
  // Every address includes this one, whether it is stated or the default.
  EXPECT_THAT(errors_of(sources("kind = \"udp\"", port)),
              StartsWith("raylocd.toml:9:10: a second source on UDP port 5500"));
  EXPECT_THAT(errors_of(sources(port, "kind = \"udp\"")),
              StartsWith("raylocd.toml:7:1: a second source on UDP port 5500"));
  EXPECT_EQ(errors_of(sources(port, "kind = \"udp\"\nlisten = \"127.0.0.2:5500\"")), "");
}

TEST(ConfigErrors, OnlyAddressesAndNetworksMayBeAllowed) {
  const std::string udp = "kind = \"udp\"\nlisten = \"127.0.0.1:5500\"\nallow = ";
  const std::string file = "kind = \"pcap\"\nfile = \"-\"";
  EXPECT_EQ(errors_of(sources(udp + "\"192.168.1.0/24\"", file)), "");
  EXPECT_THAT(errors_of(sources(udp + "[\"10.1.1.1\", \"192.168.1.7/24\"]", file)),
              StartsWith("raylocd.toml:7:9: 'allow': '192.168.1.7/24' is an address in a network; "
                         "write 192.168.1.7 for the one"));
  EXPECT_THAT(errors_of(sources(udp + "\"router\"", file)),
              StartsWith("raylocd.toml:7:9: 'allow': 'router' is no IPv4 address"));
  EXPECT_THAT(errors_of(sources(udp + "[]", file)),
              StartsWith("raylocd.toml:7:9: 'allow' is an empty array"));
  EXPECT_THAT(errors_of(sources(file, "kind = \"unix\"\npath = \"/s\"\nallow = \"10.1.1.1\"")),
              StartsWith("raylocd.toml:11:9: 'allow' belongs to kind udp"));
}

TEST(ConfigErrors, TwoSourcesCannotShareAFileInterfaceOrSocket) {
  const std::string file = "kind = \"pcap\"\nfile = \"-\"";
  EXPECT_THAT(errors_of(sources(file, file)),
              StartsWith("raylocd.toml:10:8: a second source on -"));
  const std::string interface = "kind = \"interface\"\ninterface = \"eth0\"";
  EXPECT_THAT(errors_of(sources(interface, interface)),
              StartsWith("raylocd.toml:10:13: a second source on interface eth0"));
  EXPECT_EQ(errors_of(sources(interface, interface + "\nfilter = \"udp dst port 5501\"")), "");
  const std::string socket = "kind = \"unix\"\npath = \"/run/raylocd/eth0\"";
  EXPECT_THAT(errors_of(sources(socket, socket)),
              StartsWith("raylocd.toml:10:8: a second source on socket /run/raylocd/eth0"));
  EXPECT_THAT(errors_of(sources(socket, "kind = \"unix\"")),
              StartsWith("raylocd.toml:7:1: [[source]] lacks 'path'"));
}

TEST(ConfigErrors, RecordingsArePlayedAtOneSpeed) {
  const auto file = [](const char* name, const char* speed) {
    return std::string("kind = \"pcap\"\nfile = \"") + name + "\"\n" + speed;
  };
  EXPECT_EQ(errors_of(sources(file("a", "speed = 2"), file("b", "speed = 2.0"))), "");
  EXPECT_EQ(errors_of(sources(file("a", ""), file("b", "speed = \"max\""))), "");
  EXPECT_THAT(errors_of(sources(file("a", "speed = 2"), file("b", "speed = 1"))),
              StartsWith("raylocd.toml:12:9: recordings are played together, and that of "
                         "raylocd.toml:3 has another 'speed'"));
  EXPECT_THAT(errors_of(sources(file("a", "speed = 2"), file("b", ""))),
              StartsWith("raylocd.toml:7:9: recordings are played together"));
  EXPECT_EQ(errors_of(sources("kind = \"udp\"", file("b", "speed = 2"))), "");
}

TEST(Field, RecordingsWaitForTheSameGaps) {
  const std::string file = "kind = \"pcap\"\nfile = [\"a\", \"b\"]";
  const std::string other = "kind = \"pcap\"\nfile = [\"c\", \"d\"]\nmax_gap_s = 20";
  EXPECT_THAT(errors_of(sources(file, other)),
              StartsWith("raylocd.toml:11:13: recordings are played together, and that of "
                         "raylocd.toml:3 has another 'max_gap_s'"));
  EXPECT_THAT(errors_of(sources(file, "kind = \"pcap\"\nfile = [\"b\", \"e\"]")),
              StartsWith("raylocd.toml:10:8: a second source on b"));
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

TEST(ConfigErrors, AMachineOfAClusterHasServersAndAName) {
  const std::string cluster = config_text() + "[cluster]\nrole = \"capture\"\n";
  EXPECT_THAT(errors_of(cluster), HasSubstr("[cluster] lacks 'servers'"));
  EXPECT_THAT(errors_of(cluster + "servers = [\"nats://a:4222\"]\n"),
              HasSubstr("[cluster] lacks 'name'"));
  EXPECT_THAT(errors_of(cluster + "servers = [\"a:4222\"]\nname = \"n\"\n"),
              HasSubstr("write nats://ADDRESS:PORT"));
  EXPECT_THAT(errors_of(cluster + "servers = [\"tls://a:4222\"]\nname = \"n\"\ntls_cert = \"c\"\n"),
              HasSubstr("'tls_cert' and 'tls_key' belong together"));
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
}  // namespace rayloc::config_errors_test
