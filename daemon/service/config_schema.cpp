#include "daemon/service/config_schema.h"

#include <array>

#include "capture/decoder_registry.h"
#include "daemon/service/endpoint.h"

namespace rayloc {
namespace {

constexpr std::array<std::string_view, 3> kKinds = {"udp", "pcap", "interface"};
constexpr std::array<std::string_view, 5> kLevels = {"trace", "debug", "info", "warning", "error"};

const std::string& text(const ConfigValue& value) { return std::get<std::string>(value); }
std::size_t count(const ConfigValue& value) {
  return static_cast<std::size_t>(std::get<std::int64_t>(value));
}
double number(const ConfigValue& value) { return std::get<double>(value); }

// Position of a choice among its names, which are in the order of the enumeration.
template <typename Enum, std::size_t kCount>
Enum chosen(const ConfigValue& value, const std::array<std::string_view, kCount>& names) {
  for (std::size_t i = 0; i < kCount; ++i) {
    if (names.at(i) == text(value)) {
      return static_cast<Enum>(i);
    }
  }
  return {};
}

constexpr std::string_view kUdp = "udp";
constexpr std::string_view kPcap = "pcap";
constexpr std::string_view kInterface = "interface";

// Checked by then (parse_listen); a wrong address is an Error already, and its value unused.
void store_listen(SourceConfig& source, const ConfigValue& value) {
  if (const std::optional<ListenAddress> address = parse_listen(text(value))) {
    source.listen_host = address->host;
    source.listen_port = address->port;
  }
}

using T = ConfigType;
using C = DaemonConfig;
using S = SourceConfig;
using V = ConfigValue;

const std::array kOptions = {
    ConfigOption{.section = "",
                 .key = "schema",
                 .type = T::kInteger,
                 .preset = "1",
                 .range = {1, 1},
                 .description = "Version of the layout of this file",
                 .store = [](C&, const V&) { /* only one layout so far */ }},

    ConfigOption{.section = "site",
                 .key = "directory",
                 .type = T::kFolder,
                 .example = "\"/etc/raylocd/site\"",
                 .required = true,
                 .description = "Directory with site.toml: the room and its access points",
                 .store = [](C& c, const V& v) { c.site_directory = text(v); }},

    ConfigOption{.section = "source",
                 .key = "access_point",
                 .type = T::kText,
                 .example = "\"ap1\"",
                 .description = "Its id in site.toml; may be left out where the site has one",
                 .store_source = [](S& s, const V& v) { s.access_point = text(v); }},
    ConfigOption{.section = "source",
                 .key = "kind",
                 .type = T::kChoice,
                 .example = "\"udp\"",
                 .required = true,
                 .choices = kKinds,
                 .description = "A UDP port, a recording, or a network interface (libpcap)",
                 .store_source = [](S& s, const V& v) { s.kind = chosen<SourceKind>(v, kKinds); }},
    ConfigOption{.section = "source",
                 .key = "listen",
                 .type = T::kText,
                 .preset = "\"0.0.0.0:5500\"",
                 .description = "ADDRESS:PORT that the access point sends to",
                 .only_kinds = kUdp,
                 .store_source = store_listen},
    ConfigOption{.section = "source",
                 .key = "interface",
                 .type = T::kText,
                 .example = "\"eth0\"",
                 .description = "Interface to capture from",
                 .only_kinds = kInterface,
                 .store_source = [](S& s, const V& v) { s.interface = text(v); }},
    ConfigOption{.section = "source",
                 .key = "filter",
                 .type = T::kText,
                 .preset = "\"udp dst port 5500\"",
                 .description = "What to capture, as tcpdump takes it",
                 .only_kinds = kInterface,
                 .store_source = [](S& s, const V& v) { s.filter = text(v); }},
    ConfigOption{.section = "source",
                 .key = "file",
                 .type = T::kFile,
                 .example = "\"recording.pcap\"",
                 .description = "pcap or pcapng, gzip'd or not; \"-\" is standard input",
                 .only_kinds = kPcap,
                 .store_source = [](S& s, const V& v) { s.file = text(v); }},
    ConfigOption{.section = "source",
                 .key = "speed",
                 .type = T::kSpeed,
                 .preset = "\"max\"",
                 .range = {1e-3, 1e6},
                 .description = "\"max\", or recorded seconds per second",
                 .only_kinds = kPcap,
                 .store_source =
                     [](S& s, const V& v) {
                       const double* speed = std::get_if<double>(&v);
                       s.speed = speed != nullptr ? std::optional(*speed) : std::nullopt;
                     }},
    ConfigOption{.section = "source",
                 .key = "format",
                 .type = T::kChoice,
                 .example = "\"axcsi-v4\"",
                 .choices = wire_formats(),
                 .description = "Wire format; recognised by datagram when left out",
                 .store_source = [](S& s, const V& v) { s.format = text(v); }},

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
                 .key = "insecure",
                 .type = T::kBoolean,
                 .preset = "false",
                 .description = "Lets everyone on the network read an endpoint beyond loopback",
                 .store = [](C& c, const V& v) { c.publish.insecure = std::get<bool>(v); }},
    ConfigOption{.section = "publish",
                 .key = "heartbeat_s",
                 .type = T::kNumber,
                 .preset = "1",
                 .range = {0.1, 60.0, "s"},
                 .description = "Time between heartbeats",
                 .store = [](C& c, const V& v) { c.publish.heartbeat = from_seconds(number(v)); }},
    ConfigOption{.section = "publish",
                 .key = "send_high_water_mark",
                 .type = T::kInteger,
                 .preset = "1000",
                 .range = {10, 1'000'000, "messages"},
                 .description = "Messages that wait for a subscriber before it counts as slow",
                 .store = [](C& c, const V& v) { c.publish.send_high_water_mark = count(v); }},

    ConfigOption{.section = "record",
                 .key = "directory",
                 .type = T::kFolder,
                 .example = "\"/var/lib/raylocd\"",
                 .description = "Writes what each source receives there; off when left out",
                 .store = [](C& c, const V& v) { c.record.directory = text(v); }},

    ConfigOption{.section = "log",
                 .key = "level",
                 .type = T::kChoice,
                 .preset = "\"info\"",
                 .choices = kLevels,
                 .description = "Least severe messages that are logged",
                 .store = [](C& c, const V& v) { c.log.level = chosen<LogLevel>(v, kLevels); }},
};

}  // namespace

std::span<const ConfigOption> config_options() { return kOptions; }

bool applies_to_kind(const ConfigOption& option, std::string_view kind) {
  return option.only_kinds.empty() || option.only_kinds.find(kind) != std::string_view::npos;
}

}  // namespace rayloc
