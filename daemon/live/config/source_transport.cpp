#include "daemon/live/config/source_transport.h"

#include <algorithm>
#include <array>
#include <utility>

#include "capture/source/transport_schemes.h"
#include "daemon/live/config/endpoint.h"
#include "daemon/live/config/source_url.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

// Scheme and kind of the transports that have their own keys.
struct KindName {
  std::string_view scheme;
  std::string_view kind;
  SourceKind value;
};
constexpr std::array kSchemeKinds = {KindName{"udp", "udp", SourceKind::kUdp},
                                     KindName{"pcap", "pcap", SourceKind::kPcap},
                                     KindName{"live", "interface", SourceKind::kInterface},
                                     KindName{"unix", "unix", SourceKind::kUnix}};
constexpr KindName kOther{"", "url", SourceKind::kOther};

const KindName& kind_name(const TransportScheme& scheme) {
  const auto* const found =
      std::find_if(kSchemeKinds.begin(), kSchemeKinds.end(), [&](const KindName& one) {
        return one.scheme == scheme.name;
      });
  return found == kSchemeKinds.end() ? kOther : *found;
}

// The reason why a URL is not allowed here; empty if it is.
std::string objection(const TransportAddress& url) {
  const SourceKind kind = kind_name(*url.scheme).value;
  if (url.address.empty()) {
    return "nothing follows the colon";
  }
  if (url.scheme->open_source == nullptr) {
    return "nothing can be received this way";
  }
  if (kind == SourceKind::kOther && !url.scheme->live) {
    return "raylocd plays recordings of pcap only";
  }
  if (kind == SourceKind::kUdp && !parse_listen(url.address)) {
    const std::string fault = listen_fault(url.address);
    return fault == "is no ADDRESS:PORT" ? "no ADDRESS:PORT of this machine follows the colon"
                                         : "the text after the colon " + fault;
  }
  return "";
}

// A relative path starts at the folder of the file that states it.
fs::path path_in(const TomlTable& table, const TransportAddress& url) {
  fs::path path = url.address;
  const std::optional<fs::path> whole = table.path("url");  // FOLDER/SCHEME:ADDRESS
  if (path.is_absolute() || url.address == "-" || !whole) {
    return path;
  }
  std::string text = whole->string();
  const std::size_t scheme = url.scheme->name.size() + 1;
  text.erase(text.size() - url.address.size() - scheme, scheme);
  return text;
}

std::string listen_address(const SourceConfig& source) {
  const bool ipv6 = source.listen_host.find(':') != std::string::npos;
  return (ipv6 ? "[" + source.listen_host + "]" : source.listen_host) + ":" +
         std::to_string(source.listen_port);
}

}  // namespace

std::optional<TransportAddress> read_source_url(const TomlTable& table) {
  const std::optional<std::string> text = table.string("url");
  if (!text) {
    return std::nullopt;
  }
  const auto url = parse_transport(transport_schemes(), *text);
  const std::string wrong = url ? objection(*url) : "";
  if (!url) {
    table.error_at("url", "'url': " + url.error().message);
  } else if (!wrong.empty()) {
    table.error_at("url",
                   "'url' is '" + *text + "': " + wrong + "; write " +
                       transport_syntax(transport_schemes(), TransportUse::kSource) +
                       ", for example: url = \"udp:0.0.0.0:5500\"");
  }
  return url && wrong.empty() ? std::optional(*url) : std::nullopt;
}

std::string_view kind_of(const TransportScheme& scheme) { return kind_name(scheme).kind; }

void store_source_url(const TomlTable& table, const TransportAddress& url, SourceConfig& source) {
  source.kind = kind_name(*url.scheme).value;
  switch (source.kind) {
    case SourceKind::kUdp:
      if (const std::optional<ListenAddress> address = parse_listen(url.address)) {
        source.listen_host = address->host;
        source.listen_port = address->port;
      }
      return;
    case SourceKind::kPcap:
      source.files = {path_in(table, url)};
      return;
    case SourceKind::kInterface:
      source.interface = url.address;
      return;
    case SourceKind::kUnix:
      source.path = path_in(table, url);
      return;
    case SourceKind::kOther:
    case SourceKind::kCluster:
      return;
  }
}

std::string source_url(const SourceConfig& source) {
  switch (source.kind) {
    case SourceKind::kUdp:
      return "udp:" + listen_address(source);
    case SourceKind::kPcap:
      return "pcap:" + (source.files.empty() ? "" : source.files.front().string());
    case SourceKind::kInterface:
      return "live:" + source.interface;
    case SourceKind::kUnix:
      return "unix:" + source.path.string();
    case SourceKind::kOther:
    case SourceKind::kCluster:
      break;
  }
  return source.url;
}

Expected<SourceOptions> source_options(const SourceConfig& source) {
  SourceOptions options;
  options.only_interface = source.only_interface;
  options.filter = source.filter;
  for (const std::string& text : source.allow) {
    const auto range = AddressRange::parse(text);
    RAYLOC_TRY(range);
    options.senders.push_back(*range);
  }
  return options;
}

}  // namespace rayloc
