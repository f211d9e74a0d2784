// DaemonConfig: what raylocd is told to do, read from a TOML file (`raylocd --config FILE`).
//
// Every key, with type, default, range and one line of description, is a row of the table in
// config_schema.cpp: it drives reading, checking, `rayloc config default|schema` and
// deploy/raylocd.toml. Relative paths are taken from the folder of the file that states them.
// Errors name file:line:column and what to write instead; all errors of a file are reported.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

enum class SourceKind { kUdp, kPcap, kInterface };

// [[source]]: where the datagrams of one access point come from.
struct SourceConfig {
  SourceKind kind = SourceKind::kUdp;
  // The id in site.toml, and its position in Site::access_points. load_daemon_setup() resolves both
  // (the id may be left out of the file when the site has one access point); load_config() leaves
  // the id as written and the index at -1.
  std::string access_point;
  int access_point_index = -1;
  std::string format;             // name of a wire format, empty: recognised
  std::string listen_host;        // udp: numeric IPv4 address, "0.0.0.0" for all
  std::uint16_t listen_port = 0;  // udp
  std::filesystem::path file;     // pcap; "-" is standard input
  std::optional<double> speed;    // pcap: recorded seconds per second; empty: as fast as it goes
  std::string interface;          // interface: "eth0"
  std::string filter;             // interface: BPF expression
  int line = 0;                   // of [[source]] in the file, for messages
  int column = 0;
};

struct EngineConfig {
  Duration burst{};                  // length of a burst
  double accuracy_confidence = 0.0;  // of Location.accuracy_m
};

struct LimitsConfig {
  std::size_t ring_frames = 0;  // frames waiting per source; past that the oldest is dropped
  std::size_t max_targets = 0;  // transmitters followed at one time
};

struct PublishConfig {
  std::string endpoint;   // "tcp://127.0.0.1:5560", "ipc:///run/raylocd/publish"
  bool insecure = false;  // the endpoint may be beyond loopback
  Duration heartbeat{};
  std::size_t send_high_water_mark = 0;  // messages queued per subscriber before it counts as slow
};

struct RecordConfig {
  std::filesystem::path directory;  // empty: nothing is recorded
};

enum class LogLevel { kTrace, kDebug, kInfo, kWarning, kError };
struct LogConfig {
  LogLevel level = LogLevel::kInfo;
};

struct DaemonConfig {
  std::filesystem::path file;            // that it was read from
  std::filesystem::path site_directory;  // [site] directory
  std::vector<SourceConfig> sources;     // at least one, in the order of the file
  EngineConfig engine;
  LimitsConfig limits;
  PublishConfig publish;
  RecordConfig record;
  LogConfig log;
};

// The file alone: syntax, keys, types, ranges, and that sources do not get in each other's way.
Expected<DaemonConfig> load_config(const std::filesystem::path& file);

// A configuration and the site that it names, checked against each other: every source is resolved
// to an access point, and no access point has two. An Error lists what is wrong in both files.
struct DaemonSetup {
  DaemonConfig config;
  Site site;
};
Expected<DaemonSetup> load_daemon_setup(const std::filesystem::path& file);

// The same of a text; `file` is for messages and for relative paths.
Expected<DaemonConfig> parse_config(std::string_view text, const std::filesystem::path& file);

// Every key with the value that holds, as TOML; those that the file does not state are marked.
Expected<std::string> effective_config(const std::filesystem::path& file);

}  // namespace rayloc
