#include "daemon/live/config/config_schema.h"

#include <algorithm>
#include <array>

#include "daemon/live/config/config_schema_rows.h"
#include "daemon/live/config/endpoint.h"
#include "daemon/methods/method_registry.h"
#include "daemon/methods/track_options.h"

namespace rayloc {

std::span<const std::string_view> config_rows::engine_methods() {
  static const std::vector<std::string_view> kNames = [] {
    std::vector<std::string_view> names;
    for (const Method* method : methods()) {
      if (method->is_live) {
        names.push_back(method->name);
      }
    }
    names.emplace_back("none");
    return names;
  }();
  return kNames;
}

namespace {

using config_rows::C;
using config_rows::chosen;
using config_rows::count;
using config_rows::engine_methods;
using config_rows::input_options;
using config_rows::mebibytes;
using config_rows::number;
using config_rows::store_methods;
using config_rows::T;
using config_rows::text;
using config_rows::texts;
using config_rows::V;

constexpr std::array<std::string_view, 2> kTargetIds = {"mac", "hmac"};
constexpr std::array<std::string_view, 2> kSnapshots = {"always", "acquire"};
constexpr std::array<std::string_view, 5> kLevels = {"trace", "debug", "info", "warning", "error"};

void store_http_listen(DaemonConfig& config, const ConfigValue& value) {
  if (const std::optional<ListenAddress> address = parse_listen(text(value))) {
    config.http.host = address->host;
    config.http.port = address->port;
  }
}

const std::array kDaemonOptions = {
    ConfigOption{
        .section = "engine",
        .key = "method",
        .type = T::kMethods,
        .preset = "\"rayloc\"",
        .choices = engine_methods(),
        .description = "How targets are located; \"none\" receives, records and publishes "
                       "CSI only; the first of an array locates, and the others are "
                       "compared with it",
        .store = [](C& c, const V& v) { store_methods(v, c.engine.method, c.engine.compared); }},
    ConfigOption{.section = "engine",
                 .key = "burst_s",
                 .type = T::kNumber,
                 .preset = "0.2",
                 .range = {0.01, 10.0, "s"},
                 .description = "Frames of a transmitter within this time give one position",
                 .store = [](C& c, const V& v) { c.engine.burst = from_seconds(number(v)); }},
    ConfigOption{.section = "engine",
                 .key = "accuracy_confidence",
                 .type = T::kNumber,
                 .preset = "0.95",
                 .range = {0.5, 0.999},
                 .description = "Probability that a target is within the published accuracy_m",
                 .store = [](C& c, const V& v) { c.engine.accuracy_confidence = number(v); }},
    ConfigOption{
        .section = "engine",
        .key = "snapshots",
        .type = T::kChoice,
        .preset = "\"always\"",
        .choices = kSnapshots,
        .description = "Fixes of single bursts: for all, or until a track follows a device",
        .store = [](C& c, const V& v) { c.engine.snapshots_always = text(v) == kSnapshots[0]; }},
    ConfigOption{.section = "engine",
                 .key = kTracksSetting,
                 .type = T::kChoice,
                 .preset = "\"grid\"",
                 .choices = kTracksValues,
                 .description = "How \"rayloc\" follows a device: by the grid of the room, or by a "
                                "cloud of places",
                 .store = [](C& c, const V& v) { c.engine.tracks = text(v); }},
    ConfigOption{.section = "limits",
                 .key = "ring_frames",
                 .type = T::kInteger,
                 .preset = "8192",
                 .range = {16, 1048576, "frames"},
                 .description = "Frames waiting per source; past that the oldest is dropped",
                 .store = [](C& c, const V& v) { c.limits.ring_frames = count(v); }},
    ConfigOption{.section = "limits",
                 .key = "max_targets",
                 .type = T::kInteger,
                 .preset = "256",
                 .range = {1, 65536},
                 .description = "Transmitters followed at one time; frames of others are refused",
                 .store = [](C& c, const V& v) { c.limits.max_targets = count(v); }},

    ConfigOption{.section = "publish",
                 .key = "endpoint",
                 .type = T::kText,
                 .preset = "\"tcp://127.0.0.1:5560\"",
                 .description = "ZeroMQ endpoint to bind: tcp://ADDRESS:PORT or ipc://PATH",
                 .store = [](C& c, const V& v) { c.publish.endpoint = text(v); }},
    ConfigOption{.section = "publish",
                 .key = "snapshot",
                 .type = T::kText,
                 .preset = "\"tcp://127.0.0.1:5561\"",
                 .description = "ZeroMQ endpoint where late subscribers ask for the last messages",
                 .store = [](C& c, const V& v) { c.publish.snapshot = text(v); }},
    ConfigOption{.section = "publish",
                 .key = "insecure",
                 .type = T::kBoolean,
                 .preset = "false",
                 .description = "Lets everyone on the network read an endpoint beyond loopback",
                 .store = [](C& c, const V& v) { c.publish.insecure = std::get<bool>(v); }},
    ConfigOption{.section = "publish",
                 .key = "csi",
                 .type = T::kBoolean,
                 .preset = "false",
                 .description = "Publishes every frame of CSI as well (topics v1/csi/SITE/AP/)",
                 .store = [](C& c, const V& v) { c.publish.csi = std::get<bool>(v); }},
    ConfigOption{.section = "publish",
                 .key = "heartbeat_s",
                 .type = T::kNumber,
                 .preset = "1",
                 .range = {0.1, 60.0, "s"},
                 .description = "Time between heartbeats",
                 .reload = true,
                 .store = [](C& c, const V& v) { c.publish.heartbeat = from_seconds(number(v)); }},
    ConfigOption{.section = "publish",
                 .key = "send_high_water_mark",
                 .type = T::kInteger,
                 .preset = "5000",
                 .range = {10, 1'000'000, "messages"},
                 .description = "Messages that wait for a subscriber before it counts as slow",
                 .store = [](C& c, const V& v) { c.publish.send_high_water_mark = count(v); }},

    ConfigOption{.section = "curve",
                 .key = "enabled",
                 .type = T::kBoolean,
                 .preset = "false",
                 .description = "Encrypts both ZeroMQ endpoints and admits listed clients only",
                 .store = [](C& c, const V& v) { c.curve.enabled = std::get<bool>(v); }},
    ConfigOption{.section = "curve",
                 .key = "secret_file",
                 .type = T::kFile,
                 .example = "\"/etc/raylocd/curve.secret\"",
                 .description =
                     "Secret key of the daemon, by `rayloc keygen`; systemd's credential "
                     "curve.secret when left out",
                 .store = [](C& c, const V& v) { c.curve.secret_file = text(v); }},
    ConfigOption{.section = "curve",
                 .key = "allow",
                 .type = T::kTexts,
                 .example = "[\"Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hID\"]",
                 .description = "Public keys of the clients that may subscribe; a reload admits "
                                "new ones, and disconnects none",
                 .reload = true,
                 .store = [](C& c, const V& v) { c.curve.allow = texts(v); }},

    ConfigOption{.section = "http",
                 .key = "enabled",
                 .type = T::kBoolean,
                 .preset = "true",
                 .description = "Answers over HTTP: the live map at /, health, metrics, state",
                 .store = [](C& c, const V& v) { c.http.enabled = std::get<bool>(v); }},
    ConfigOption{.section = "http",
                 .key = "listen",
                 .type = T::kText,
                 .preset = "\"127.0.0.1:8480\"",
                 .description = "ADDRESS:PORT of the HTTP server",
                 .store = store_http_listen},
    ConfigOption{.section = "http",
                 .key = "token_file",
                 .type = T::kFile,
                 .example = "\"/etc/raylocd/http.token\"",
                 .description = "File with the token that all but health and metrics ask for; a "
                                "browser as user rayloc; else systemd's credential http.token",
                 .store = [](C& c, const V& v) { c.http.token_file = text(v); }},
    ConfigOption{.section = "http",
                 .key = "insecure",
                 .type = T::kBoolean,
                 .preset = "false",
                 .description = "Lets everyone on the network read where everybody is",
                 .store = [](C& c, const V& v) { c.http.insecure = std::get<bool>(v); }},
    ConfigOption{.section = "http",
                 .key = "edit",
                 .type = T::kBoolean,
                 .preset = "false",
                 .description = "Lets who sees the map draw and name in it, and write the site's "
                                "files; beyond this machine with token_file only",
                 .store = [](C& c, const V& v) { c.http.edit = std::get<bool>(v); }},
    ConfigOption{.section = "http",
                 .key = "base_path",
                 .type = T::kText,
                 .preset = "\"/\"",
                 .description =
                     "Answers below this path as well, for a server before this one that "
                     "passes it on",
                 .store = [](C& c, const V& v) { c.http.front.base_path = text(v); }},
    ConfigOption{.section = "http",
                 .key = "origins",
                 .type = T::kTexts,
                 .example = "[\"https://home.example\"]",
                 .description =
                     "Where browsers find the map by a name or through another server: "
                     "that Host is answered, and pages from there may control recordings",
                 .store = [](C& c, const V& v) { c.http.front.origins = texts(v); }},
    ConfigOption{.section = "http",
                 .key = "frame_ancestors",
                 .type = T::kTexts,
                 .example = "[\"http://homeassistant.local:8123\"]",
                 .description = "Pages that may show the map in a frame: origins, self or *",
                 .store = [](C& c, const V& v) { c.http.front.frame_ancestors = texts(v); }},

    ConfigOption{.section = "record",
                 .key = "directory",
                 .type = T::kFolder,
                 .example = "\"/var/lib/raylocd\"",
                 .description = "Writes what each source receives there; off when left out",
                 .store = [](C& c, const V& v) { c.record.directory = text(v); }},
    ConfigOption{.section = "record",
                 .key = "rotate_mb",
                 .type = T::kInteger,
                 .preset = "256",
                 .range = {1, 1'000'000, "MiB"},
                 .description = "A recording that has become so long is closed",
                 .reload = true,
                 .store = [](C& c, const V& v) { c.record.rotate_bytes = mebibytes(v); }},
    ConfigOption{
        .section = "record",
        .key = "rotate_every_s",
        .type = T::kNumber,
        .preset = "3600",
        .range = {1.0, 31'536'000.0, "s"},
        .description = "A recording that has become so old is closed",
        .reload = true,
        .store = [](C& c, const V& v) { c.record.rotate_every = from_seconds(number(v)); }},
    ConfigOption{.section = "record",
                 .key = "max_total_mb",
                 .type = T::kInteger,
                 .preset = "10240",
                 .range = {1, 1'000'000'000, "MiB"},
                 .description = "All recordings there; past that the oldest are removed",
                 .reload = true,
                 .store = [](C& c, const V& v) { c.record.max_total_bytes = mebibytes(v); }},
    ConfigOption{.section = "record",
                 .key = "min_free_mb",
                 .type = T::kInteger,
                 .preset = "512",
                 .range = {0, 1'000'000'000, "MiB"},
                 .description = "With less room on the disk nothing is recorded",
                 .reload = true,
                 .store = [](C& c, const V& v) { c.record.min_free_bytes = mebibytes(v); }},
    ConfigOption{.section = "record",
                 .key = "ring_s",
                 .type = T::kNumber,
                 .preset = "30",
                 .range = {0.0, 3600.0, "s"},
                 .description = "Keeps the last datagrams in memory, for a snapshot",
                 .store = [](C& c, const V& v) { c.record.ring = from_seconds(number(v)); }},
    ConfigOption{.section = "record",
                 .key = "ring_mb",
                 .type = T::kInteger,
                 .preset = "64",
                 .range = {1, 65536, "MiB"},
                 .description = "At most so much of each source, however short a time that is",
                 .store = [](C& c, const V& v) { c.record.ring_bytes = mebibytes(v); }},
    ConfigOption{.section = "record",
                 .key = "snapshot_directory",
                 .type = T::kFolder,
                 .example = "\"/var/lib/raylocd\"",
                 .description = "For snapshots; directory, else $STATE_DIRECTORY when left out",
                 .store = [](C& c, const V& v) { c.record.snapshot_directory = text(v); }},

    ConfigOption{
        .section = "privacy",
        .key = "target_id",
        .type = T::kChoice,
        .preset = "\"mac\"",
        .choices = kTargetIds,
        .description = "Devices are called by their address, or by a keyed hash of it; "
                       "recordings hold addresses in any case",
        .store = [](C& c, const V& v) { c.privacy.target_id = chosen<TargetId>(v, kTargetIds); }},
    ConfigOption{
        .section = "privacy",
        .key = "rotate_h",
        .type = T::kNumber,
        .preset = "24",
        .range = {0.01, 8760.0, "h"},
        .description = "How long a hash names a device; then it gets another",
        .store = [](C& c, const V& v) { c.privacy.rotate = from_seconds(3600.0 * number(v)); }},
    ConfigOption{.section = "privacy",
                 .key = "key_file",
                 .type = T::kFile,
                 .example = "\"/etc/raylocd/privacy.key\"",
                 .description = "Makes hashes that a replay can repeat; left out, systemd's "
                                "credential privacy.key, and without one keys are random, kept in "
                                "memory only and forgotten",
                 .store = [](C& c, const V& v) { c.privacy.key_file = text(v); }},

    ConfigOption{.section = "cache",
                 .key = "enabled",
                 .type = T::kBoolean,
                 .preset = "true",
                 .description = "Keeps the traced room for the next start",
                 .store = [](C& c, const V& v) { c.cache.enabled = std::get<bool>(v); }},
    ConfigOption{.section = "cache",
                 .key = "directory",
                 .type = T::kFolder,
                 .example = "\"/var/cache/raylocd\"",
                 .description = "Where; $CACHE_DIRECTORY or ~/.cache/rayloc when left out",
                 .store = [](C& c, const V& v) { c.cache.directory = text(v); }},

    ConfigOption{.section = "log",
                 .key = "level",
                 .type = T::kChoice,
                 .preset = "\"info\"",
                 .choices = kLevels,
                 .description = "Least severe messages that are logged",
                 .reload = true,
                 .store = [](C& c, const V& v) { c.log.level = chosen<LogLevel>(v, kLevels); }},
};

}  // namespace

std::span<const ConfigOption> config_options() {
  static const std::vector<ConfigOption> kAll = [] {
    const std::span<const ConfigOption> inputs = config_rows::input_options();
    std::vector<ConfigOption> all(inputs.begin(), inputs.end());
    all.insert(all.end(), kDaemonOptions.begin(), kDaemonOptions.end());
    const std::span<const ConfigOption> cluster = config_rows::cluster_options();
    all.insert(all.end(), cluster.begin(), cluster.end());
    return all;
  }();
  return kAll;
}

bool applies_to_kind(const ConfigOption& option, std::string_view kind) {
  return option.only_kinds.empty() || option.only_kinds.find(kind) != std::string_view::npos;
}

}  // namespace rayloc
