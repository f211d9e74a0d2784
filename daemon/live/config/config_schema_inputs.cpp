// The rows of the table of keys for inputs: files, sites, sources.
#include "capture/decode/decoder_registry.h"
#include "daemon/live/config/config_schema_rows.h"
#include "daemon/live/config/endpoint.h"
#include "daemon/methods/method_registry.h"

namespace rayloc::config_rows {
namespace {

constexpr std::array<std::string_view, 4> kSourceKinds = {"udp", "pcap", "interface", "unix"};

constexpr std::string_view kUdp = "udp";
constexpr std::string_view kPcap = "pcap";
constexpr std::string_view kInterface = "interface";
constexpr std::string_view kUnix = "unix";
constexpr std::string_view kUrl = "url";  // a transport without its own keys
constexpr std::string_view kLive = "udp, interface, unix or url";

// Already checked (parse_listen); a wrong address is an Error, and its value unused.
void store_listen(SourceConfig& source, const ConfigValue& value) {
  if (const std::optional<ListenAddress> address = parse_listen(text(value))) {
    source.listen_host = address->host;
    source.listen_port = address->port;
  }
}

const std::array kInputOptions = {
    ConfigOption{.section = "",
                 .key = "schema",
                 .type = T::kInteger,
                 .preset = "1",
                 .range = {1, 1},
                 .description = "Version of the layout of this file",
                 .store = [](C&, const V&) { /* only one layout so far */ }},
    ConfigOption{.section = "",
                 .key = "include",
                 .type = T::kTexts,
                 .example = "[\"conf.d/*.toml\"]",
                 .description = "Further files, as patterns; a key may be stated in one file only",
                 .reload = true,
                 .store = [](C&, const V&) { /* TomlDocument::include has read them */ }},

    ConfigOption{.section = "site",
                 .key = "directory",
                 .type = T::kFolder,
                 .example = "\"/etc/raylocd/site\"",
                 .required = true,
                 .description = "Directory with site.toml: the room and its access points",
                 .store_site = [](L& l, const V& v) { l.directory = text(v); }},
    ConfigOption{
        .section = "site",
        .key = "name",
        .type = T::kText,
        .example = "\"office\"",
        .description = "Name of the site in topics and paths; as in site.toml when left out",
        .store_site = [](L& l, const V& v) { l.name = text(v); }},
    ConfigOption{.section = "site",
                 .key = "method",
                 .type = T::kMethods,
                 .example = "\"none\"",
                 .choices = engine_methods(),
                 .description = "How targets are located here; as in [engine] when left out",
                 .store_site =
                     [](L& l, const V& v) {
                       store_methods(v, l.method, l.compared);
                       l.has_method = true;
                     }},
    ConfigOption{.section = "site",
                 .key = "record",
                 .type = T::kBoolean,
                 .preset = "true",
                 .description = "Records what its sources receive, where [record] enables it",
                 .store_site = [](L& l, const V& v) { l.record = std::get<bool>(v); }},

    ConfigOption{.section = "source",
                 .key = "access_point",
                 .type = T::kText,
                 .example = "\"ap1\"",
                 .description = "Its id in site.toml; may be left out where the site has one",
                 .store_source = [](S& s, const V& v) { s.access_point = text(v); }},
    ConfigOption{.section = "source",
                 .key = "site",
                 .type = T::kText,
                 .example = "\"office\"",
                 .description = "Name of its site; may be left out where there is one",
                 .store_source = [](S& s, const V& v) { s.site = text(v); }},
    ConfigOption{
        .section = "source",
        .key = "kind",
        .type = T::kChoice,
        .example = "\"udp\"",
        .required = true,
        .choices = kSourceKinds,
        .description = "A UDP port, a recording, a network interface (libpcap), or rayloc-capture",
        .in_url = true,
        .store_source = [](S& s, const V& v) { s.kind = chosen<SourceKind>(v, kSourceKinds); }},
    ConfigOption{.section = "source",
                 .key = "url",
                 .type = T::kUrl,
                 .example = "\"udp:0.0.0.0:5500\"",
                 .description = "Kind and address in one, instead of kind and the key of its kind",
                 .only_kinds = kUrl,
                 .store_source = [](S& s, const V& v) { s.url = text(v); }},
    ConfigOption{.section = "source",
                 .key = "listen",
                 .type = T::kText,
                 .preset = "\"0.0.0.0:5500\"",
                 .description = "ADDRESS:PORT that the access point sends to",
                 .only_kinds = kUdp,
                 .in_url = true,
                 .store_source = store_listen},
    ConfigOption{.section = "source",
                 .key = "only_interface",
                 .type = T::kText,
                 .example = "\"br0\"",
                 .description = "Rejects what arrives at the port through another interface",
                 .only_kinds = kUdp,
                 .store_source = [](S& s, const V& v) { s.only_interface = text(v); }},
    ConfigOption{
        .section = "source",
        .key = "allow",
        .type = T::kTexts,
        .example = R"(["192.168.1.7", "10.10.10.0/24"])",
        .description = "Rejects what other addresses and networks send; all may when left out",
        .only_kinds = kUdp,
        .store_source = [](S& s, const V& v) { s.allow = texts(v); }},
    ConfigOption{.section = "source",
                 .key = "interface",
                 .type = T::kText,
                 .example = "\"eth0\"",
                 .description = "Interface to capture from",
                 .only_kinds = kInterface,
                 .in_url = true,
                 .store_source = [](S& s, const V& v) { s.interface = text(v); }},
    ConfigOption{.section = "source",
                 .key = "filter",
                 .type = T::kText,
                 .preset = "\"udp dst port 5500\"",
                 .description = "Packets to capture, a filter of tcpdump",
                 .only_kinds = kInterface,
                 .store_source = [](S& s, const V& v) { s.filter = text(v); }},
    ConfigOption{.section = "source",
                 .key = "path",
                 .type = T::kFile,
                 .example = "\"/run/raylocd/eth0\"",
                 .description = "Socket to make, where rayloc-capture sends to",
                 .only_kinds = kUnix,
                 .in_url = true,
                 .store_source = [](S& s, const V& v) { s.path = text(v); }},
    ConfigOption{.section = "source",
                 .key = "file",
                 .type = T::kFiles,
                 .example = "\"recording.pcap\"",
                 .description =
                     "pcap or pcapng, gzip'd or not; \"-\" is standard input; several, as "
                     "an array or by wildcards, are a sequence in order of time",
                 .only_kinds = kPcap,
                 .in_url = true,
                 .store_source =
                     [](S& s, const V& v) {
                       const auto& texts = std::get<std::vector<std::string>>(v);
                       s.files.assign(texts.begin(), texts.end());
                     }},
    ConfigOption{
        .section = "source",
        .key = "speed",
        .type = T::kSpeed,
        .preset = "\"max\"",
        .range = {1e-3, 1e6},
        .description = "\"max\", or recorded seconds per second; the same for all recordings",
        .only_kinds = kPcap,
        .store_source =
            [](S& s, const V& v) {
              const double* speed = std::get_if<double>(&v);
              s.speed = speed != nullptr ? std::optional(*speed) : std::nullopt;
            }},
    ConfigOption{.section = "source",
                 .key = "max_gap_s",
                 .type = T::kNumber,
                 .preset = "10",
                 .range = {0.1, 1e7, "s"},
                 .description =
                     "Longest wait, in recorded time, where the recordings hold nothing or "
                     "a clock was set; the same for all recordings",
                 .only_kinds = kPcap,
                 .store_source = [](S& s, const V& v) { s.max_gap = from_seconds(number(v)); }},
    ConfigOption{.section = "source",
                 .key = "stall_after_s",
                 .type = T::kNumber,
                 .preset = "5",
                 .range = {0.1, 86400.0, "s"},
                 .description = "Silent for so long it counts as stalled: raylocd is not ready",
                 .only_kinds = kLive,
                 .store_source = [](S& s, const V& v) { s.stall_after = from_seconds(number(v)); }},
    ConfigOption{.section = "source",
                 .key = "format",
                 .type = T::kChoice,
                 .example = "\"axcsi-v4\"",
                 .choices = wire_formats(),
                 .description = "Wire format; recognised by datagram when left out",
                 .store_source = [](S& s, const V& v) { s.format = text(v); }},
};

}  // namespace

std::span<const ConfigOption> input_options() { return kInputOptions; }

}  // namespace rayloc::config_rows
