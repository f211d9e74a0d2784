// DaemonConfig: the configuration of raylocd, read from a TOML file (`raylocd --config FILE`).
//
// Every key, with type, default, range and one line of description, is a row of the table in
// config_schema.cpp: it drives reading, checking, `rayloc config default|schema`,
// deploy/raylocd.toml. Relative paths start at the folder of the file that states them. Errors name
// file:line:column and the valid input; all errors of a file are reported.
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

#include "daemon/live/config/cluster_config.h"
#include "daemon/live/http/http_front.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// kOther: without its own keys, identified by `url`. kCluster: a worker's, the stream of its site.
enum class SourceKind { kUdp, kPcap, kInterface, kUnix, kOther, kCluster };

// [[source]]: the origin of one access point's datagrams.
struct SourceConfig {
  SourceKind kind = SourceKind::kUdp;
  // The id in site.toml, and its position in Site::access_points. load_daemon_setup() resolves both
  // (the id may be left out of the file if the site has one access point); load_config() leaves the
  // id as written and the index empty.
  std::string access_point;
  std::optional<std::size_t> access_point_index;
  // Its site by name (as written without [[site]]), and its position in DaemonConfig::sites.
  std::string site;
  int site_index = -1;
  // Its name among the sources of all sites: "ap1", or with [[site]] "office-ap1".
  std::string instance;
  std::string format;              // name of a wire format; empty: detected
  std::string listen_host;         // udp: numeric IPv4 address, "0.0.0.0" for all
  std::uint16_t listen_port = 0;   // udp
  std::string only_interface;      // udp: the only accepted interface; empty: any
  std::vector<std::string> allow;  // udp: accepted senders (AddressRange); empty: all
  // pcap: of one access point, with wildcards (glob(7)); "-" is standard input.
  std::vector<std::filesystem::path> files;
  std::optional<double> speed;  // pcap: recorded seconds per second; empty: unlimited
  Duration max_gap{};           // pcap: longest wait in a period without records
  std::string interface;        // interface: "eth0"
  std::string filter;           // interface: BPF expression
  std::filesystem::path path;   // unix: path of the socket
  std::string url;              // as stated, if used instead of kind and address
  Duration stall_after{};       // all but pcap: minimum silence that is reported
  std::string place;            // of [[source]]: "raylocd.toml:4:1: ", for messages
};

struct Method;

// [site], or one [[site]] of several: a place, and the processing at it.
struct SiteConfig {
  std::filesystem::path directory;
  std::string name;                // empty: the name in site.toml
  bool has_method = false;         // otherwise that of [engine] applies
  const Method* method = nullptr;  // null: no localization
  std::vector<const Method*> compared = {};
  bool record = true;  // effective if [record] enables recording
  std::string place;   // of its table: "raylocd.toml:4:1: ", for messages
};

struct EngineConfig {
  const Method* method = nullptr;       // null: no localization
  std::vector<const Method*> compared;  // run beside it on the same bursts
  Duration burst{};                     // length of a burst
  double accuracy_confidence = 0.0;     // confidence of Location.accuracy_m
  bool snapshots_always = true;         // also for devices that a track follows
  std::string tracks;                   // one of kTracksValues, for methods with that setting
};

struct LimitsConfig {
  std::size_t ring_frames = 0;  // frames waiting per source; beyond it the oldest is dropped
  std::size_t max_targets = 0;  // transmitters tracked at one time
};

struct PublishConfig {
  std::string endpoint;   // "tcp://127.0.0.1:5560", "ipc:///run/raylocd/publish"
  std::string snapshot;   // endpoint at which late subscribers request the last messages
  bool insecure = false;  // both may be beyond loopback
  bool csi = false;       // publish raw frames besides their results
  Duration heartbeat{};
  std::size_t send_high_water_mark = 0;  // messages queued per subscriber before it counts as slow
};

// [curve]: access control and encryption of the published messages.
struct CurveConfig {
  bool enabled = false;
  std::filesystem::path secret_file;  // or systemd's credential "curve.secret", if there is one
  std::vector<std::string> allow;     // public keys of clients (Z85)
};

struct HttpConfig {
  bool enabled = true;
  std::string host;  // numeric IPv4
  std::uint16_t port = 0;
  // Or systemd's credential "http.token", if there is one; empty: no token is required.
  std::filesystem::path token_file;
  bool insecure = false;  // beyond loopback without a token
  bool edit = false;      // the site can be drawn and named in the map
  HttpFront front;        // reverse proxy in front of it, as browsers see it
};

struct RecordConfig {
  std::filesystem::path directory;           // empty: no recording
  std::uint64_t rotate_bytes = 0;            // a longer file is closed
  Duration rotate_every{};                   // an older file is closed
  std::uint64_t max_total_bytes = 0;         // limit for all recordings in the directory
  std::uint64_t min_free_bytes = 0;          // of its disk; below it recording stops
  Duration ring{};                           // data kept in memory for a snapshot; zero: none
  std::size_t ring_bytes = 0;                // maximum for each source
  std::filesystem::path snapshot_directory;  // empty: given by snapshot_folder()
};

enum class LogLevel { kTrace, kDebug, kInfo, kWarning, kError };
struct LogConfig {
  LogLevel level = LogLevel::kInfo;
};

enum class TargetId { kMac, kHmac };

struct PrivacyConfig {
  TargetId target_id = TargetId::kMac;
  Duration rotate{};  // validity period of a target's hash
  // Or systemd's credential "privacy.key", if there is one; empty: a random key for each period.
  std::filesystem::path key_file;
};

struct CacheConfig {
  bool enabled = true;
  std::filesystem::path directory;  // empty: cache_directory()
};

struct DaemonConfig {
  std::filesystem::path file;  // the file of origin
  // At least one, in the order of the file. Sites stated as [[site]] have paths, folders and labels
  // by their names, even if there is only one; [site] has none of these.
  std::vector<SiteConfig> sites;
  bool has_site_list = false;
  // At least one, in the order of the file. A worker has one for each access point of its sites.
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

// Reads the file and its includes. Checks syntax, keys, types, ranges, and that sources do not
// conflict.
Expected<DaemonConfig> load_config(const std::filesystem::path& file);

// The same for a text; `file` is for messages and relative paths. `include` is not followed.
Expected<DaemonConfig> parse_config(std::string_view text, const std::filesystem::path& file);

// Every key with its effective value, as TOML; those that no file states are marked.
Expected<std::string> effective_config(const std::filesystem::path& file);

// The keys whose values differ between two files, as "publish.endpoint" or "source 2.listen"; an
// added or removed source is "source". With [[site]]: "site office.method", "source
// office-ap1.listen".
struct ConfigChanges {
  std::vector<std::string> applicable;     // applied while the daemon runs
  std::vector<std::string> needs_restart;  // applied by a restart only
  std::set<std::string> sites;             // of [[site]]: those whose keys or sources differ
};

struct ConfigReading;  // config_reader.h

// The effective values of a file, key by key; kept for comparison with a later version of it.
class ConfigValues {
 public:
  // `names`: of the sites of [[site]], in their order.
  static ConfigValues of(const ConfigReading& reading, const std::vector<std::string>& names = {});
  ConfigChanges changes_to(const ConfigValues& newer) const;
  // Adopts the values of the keys that a reload applies.
  void adopt_applicable(const ConfigValues& newer);
  // {"publish.endpoint":"tcp://127.0.0.1:5560",...}
  std::string json() const;

 private:
  struct Entry {
    std::string value;  // in TOML
    bool reload = false;
    std::string site = {};  // of [[site]]: the site of the key
  };
  std::map<std::string, Entry> values_;
};

// One site, and the configuration that applies to it: with its own sources only.
struct SiteSetup {
  DaemonConfig config;
  Site site;                        // with the name from the configuration
  std::filesystem::path directory;  // as stated
  // With [[site]]: its folder below those of [record] and $STATE_DIRECTORY, its component of paths
  // and topics. Empty for [site].
  std::string folder;
  // The reason why its files are unusable; then `site` has its name only (see load_daemon_setup).
  std::string trouble;
  // Places of its methods in the files, its own first: "raylocd.toml:4:11: "; empty for a default.
  std::vector<std::string> method_places = {};

  // "site 'office': " with [[site]], otherwise empty: prefix of lines about it.
  std::string label() const { return folder.empty() ? "" : "site '" + site.name + "': "; }
};

// Checked against each other: every source is resolved to an access point, and no access point has
// two. An Error lists the errors in all files.
struct DaemonSetup {
  DaemonConfig config;
  ConfigValues values;           // values of the files
  std::vector<SiteSetup> sites;  // at least one
};
Expected<DaemonSetup> load_daemon_setup(const std::filesystem::path& file);

// The same for a running daemon: keys that need a restart are unchanged, and with [[site]] unusable
// files of a site set its own SiteSetup::trouble instead of an Error.
struct RunningSetup {
  DaemonConfig config;                                 // configuration at its start
  std::map<std::filesystem::path, std::string> names;  // names of its sites, by directory
};
Expected<DaemonSetup> reload_daemon_setup(const std::filesystem::path& file,
                                          const RunningSetup& running);

}  // namespace rayloc
