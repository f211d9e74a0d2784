// DaemonConfig: what raylocd is told to do, read from a TOML file (`raylocd --config FILE`).
//
// Every key, with type, default, range and one line of description, is a row of the table in
// config_schema.cpp: it drives reading, checking, `rayloc config default|schema`,
// deploy/raylocd.toml. Relative paths are taken from the folder of the file that states them.
// Errors name file:line:column and what to write instead; all errors of a file are reported.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/config/cluster_config.h"
#include "daemon/http/http_front.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// kOther: without keys of its own, `url` says which. kCluster: a worker's, the stream of its site.
enum class SourceKind { kUdp, kPcap, kInterface, kUnix, kOther, kCluster };

// [[source]]: where the datagrams of one access point come from.
struct SourceConfig {
  SourceKind kind = SourceKind::kUdp;
  // The id in site.toml, and its position in Site::access_points. load_daemon_setup() resolves both
  // (the id may be left out of the file when the site has one access point); load_config() leaves
  // the id as written and the index at -1.
  std::string access_point;
  int access_point_index = -1;
  // Its site by name (as written without [[site]]), and its position in DaemonConfig::sites.
  std::string site;
  int site_index = -1;
  // What names it among the sources of all sites: "ap1", or with [[site]] "office-ap1".
  std::string instance;
  std::string format;              // name of a wire format, empty: recognised
  std::string listen_host;         // udp: numeric IPv4 address, "0.0.0.0" for all
  std::uint16_t listen_port = 0;   // udp
  std::string only_interface;      // udp: what arrives elsewhere is rejected; empty: nothing is
  std::vector<std::string> allow;  // udp: whose datagrams are taken (AddressRange); empty: all
  // pcap: of one access point, with wildcards (glob(7)); "-" is standard input.
  std::vector<std::filesystem::path> files;
  std::optional<double> speed;  // pcap: recorded seconds per second; empty: as fast as it goes
  Duration max_gap{};           // pcap: longest wait where nothing is recorded
  std::string interface;        // interface: "eth0"
  std::string filter;           // interface: BPF expression
  std::filesystem::path path;   // unix: of the socket
  std::string url;              // as stated, where it was instead of kind and address
  Duration stall_after{};       // all but pcap: a longer silence is reported
  std::string place;            // of [[source]]: "raylocd.toml:4:1: ", for messages
};

struct Method;

// [site], or one [[site]] of several: a place, and what is done there.
struct SiteConfig {
  std::filesystem::path directory;
  std::string name;                // empty: as in site.toml
  bool has_method = false;         // else that of [engine]
  const Method* method = nullptr;  // null: nothing is located
  std::vector<const Method*> compared = {};
  bool record = true;  // where [record] says so
  std::string place;   // of its table: "raylocd.toml:4:1: ", for messages
};

struct EngineConfig {
  const Method* method = nullptr;       // null: nothing is located
  std::vector<const Method*> compared;  // with it, on the same bursts
  Duration burst{};                     // length of a burst
  double accuracy_confidence = 0.0;     // of Location.accuracy_m
  bool snapshots_always = true;         // also of devices that a track follows
};

struct LimitsConfig {
  std::size_t ring_frames = 0;  // frames waiting per source; past that the oldest is dropped
  std::size_t max_targets = 0;  // transmitters followed at one time
};

struct PublishConfig {
  std::string endpoint;   // "tcp://127.0.0.1:5560", "ipc:///run/raylocd/publish"
  std::string snapshot;   // where late subscribers ask for what was last said
  bool insecure = false;  // both may be beyond loopback
  bool csi = false;       // frames as they are, besides what is made of them
  Duration heartbeat{};
  std::size_t send_high_water_mark = 0;  // messages queued per subscriber before it counts as slow
};

// [curve]: who may read what is published, encrypted on its way.
struct CurveConfig {
  bool enabled = false;
  std::filesystem::path secret_file;  // or systemd's credential "curve.secret", where there is one
  std::vector<std::string> allow;     // public keys of clients (Z85)
};

struct HttpConfig {
  bool enabled = true;
  std::string host;  // numeric IPv4
  std::uint16_t port = 0;
  // Or systemd's credential "http.token", where there is one; empty: no token is asked for.
  std::filesystem::path token_file;
  bool insecure = false;  // beyond loopback without a token
  bool edit = false;      // the site can be drawn and named in the map
  HttpFront front;        // what browsers see before it
};

struct RecordConfig {
  std::filesystem::path directory;           // empty: nothing is recorded
  std::uint64_t rotate_bytes = 0;            // a longer file is closed
  Duration rotate_every{};                   // an older one is closed
  std::uint64_t max_total_bytes = 0;         // of all recordings in the directory
  std::uint64_t min_free_bytes = 0;          // of its disk, below which nothing is recorded
  Duration ring{};                           // what is kept in memory for a snapshot; zero: nothing
  std::size_t ring_bytes = 0;                // at most, of each source
  std::filesystem::path snapshot_directory;  // empty: snapshot_folder() says where
};

enum class LogLevel { kTrace, kDebug, kInfo, kWarning, kError };
struct LogConfig {
  LogLevel level = LogLevel::kInfo;
};

enum class TargetId { kMac, kHmac };

struct PrivacyConfig {
  TargetId target_id = TargetId::kMac;
  Duration rotate{};  // how long a hash names a target
  // Or systemd's credential "privacy.key", where there is one; empty: a random key for each period.
  std::filesystem::path key_file;
};

struct CacheConfig {
  bool enabled = true;
  std::filesystem::path directory;  // empty: cache_directory()
};

struct DaemonConfig {
  std::filesystem::path file;  // that it was read from
  // At least one, in the order of the file. Stated as [[site]] they have paths, folders and labels
  // by their names, even where there is one; [site] has none of that.
  std::vector<SiteConfig> sites;
  bool has_site_list = false;
  // At least one, in the order of the file. A worker has one of each access point of its sites.
  std::vector<SourceConfig> sources;
  EngineConfig engine;
  LimitsConfig limits;
  PublishConfig publish;
  CurveConfig curve;
  HttpConfig http;
  RecordConfig record;
  PrivacyConfig privacy;
  CacheConfig cache;
  LogConfig log;
  ClusterConfig cluster;
};

// The file and what it includes: syntax, keys, types, ranges, and that sources do not get in each
// other's way.
Expected<DaemonConfig> load_config(const std::filesystem::path& file);

// The same of a text; `file` is for messages and for relative paths. `include` is not followed.
Expected<DaemonConfig> parse_config(std::string_view text, const std::filesystem::path& file);

// Every key with the value that holds, as TOML; those that no file states are marked.
Expected<std::string> effective_config(const std::filesystem::path& file);

// The keys whose values differ between two files, as "publish.endpoint" or "source 2.listen"; a
// source that came or went is "source". With [[site]]: "site office.method", "source
// office-ap1.listen".
struct ConfigChanges {
  std::vector<std::string> applicable;     // while the daemon runs
  std::vector<std::string> needs_restart;  // by a restart only
  std::set<std::string> sites;             // of [[site]]: whose keys or sources differ
};

struct ConfigReading;  // config_reader.h

// What holds with a file, key by key; kept to be compared with the same file later.
class ConfigValues {
 public:
  // `names`: of the sites of [[site]], in their order.
  static ConfigValues of(const ConfigReading& reading, const std::vector<std::string>& names = {});
  ConfigChanges changes_to(const ConfigValues& newer) const;
  // Takes the values of the keys that a reload applies.
  void adopt_applicable(const ConfigValues& newer);
  // {"publish.endpoint":"tcp://127.0.0.1:5560",...}
  std::string json() const;

 private:
  struct Entry {
    std::string value;  // in TOML
    bool reload = false;
    std::string site = {};  // of [[site]]: whose key it is
  };
  std::map<std::string, Entry> values_;
};

// One site, and the configuration as it holds for it: with its own sources alone.
struct SiteSetup {
  DaemonConfig config;
  Site site;                        // called as the configuration calls it
  std::filesystem::path directory;  // as stated
  // With [[site]]: its folder below those of [record] and $STATE_DIRECTORY, its component of paths
  // and topics. Empty for [site].
  std::string folder;
  // Why its files cannot be used; then `site` has its name alone (see load_daemon_setup).
  std::string trouble;
  // Where its methods are stated, its own first: "raylocd.toml:4:11: "; empty of a default.
  std::vector<std::string> method_places = {};

  // "site 'office': " with [[site]], else empty: how lines about it begin.
  std::string label() const { return folder.empty() ? "" : "site '" + site.name + "': "; }
};

// Checked against each other: every source is resolved to an access point, and no access point has
// two. An Error lists what is wrong in all files.
struct DaemonSetup {
  DaemonConfig config;
  ConfigValues values;           // of the files
  std::vector<SiteSetup> sites;  // at least one
};
Expected<DaemonSetup> load_daemon_setup(const std::filesystem::path& file);

// The same for a daemon that runs: keys that need a restart are as there, and with [[site]] files
// of a site that cannot be used are its own SiteSetup::trouble and no Error.
struct RunningSetup {
  DaemonConfig config;                                 // that it was started with
  std::map<std::filesystem::path, std::string> names;  // of its sites, by directory
};
Expected<DaemonSetup> reload_daemon_setup(const std::filesystem::path& file,
                                          const RunningSetup& running);

}  // namespace rayloc
