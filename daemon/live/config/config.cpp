#include "daemon/live/config/config.h"

#include <algorithm>
#include <array>
#include <map>

#include "capture/transport/address_range.h"
#include "daemon/live/config/config_cluster.h"
#include "daemon/live/config/config_http.h"
#include "daemon/live/config/config_methods.h"
#include "daemon/live/config/config_reader.h"
#include "daemon/live/config/endpoint.h"
#include "daemon/live/config/secrets.h"
#include "daemon/live/config/source_transport.h"
#include "daemon/live/publish/socket/curve_keys.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

template <typename T>
std::optional<ConfigValue> as_value(std::optional<T> value) {
  return value ? std::optional(ConfigValue(*std::move(value))) : std::nullopt;
}

std::optional<ConfigValue> read_path(const TomlTable& table, const ConfigOption& option) {
  const std::optional<std::string> text = table.string(option.key);
  if (text && option.type == ConfigType::kFile && *text == "-") {
    return *text;
  }
  const std::optional<fs::path> path = table.path(option.key);
  return path ? std::optional(ConfigValue(path->string())) : std::nullopt;
}

// The files that a pattern matches are determined when they are opened.
std::optional<ConfigValue> read_paths(const TomlTable& table, const ConfigOption& option) {
  if (table.is_string(option.key) && table.string(option.key) == "-") {
    return ConfigValue(std::vector<std::string>{"-"});
  }
  std::vector<std::string> texts;
  for (const fs::path& path : table.paths(option.key)) {
    texts.push_back(path.string());
  }
  return texts.empty() ? std::nullopt : std::optional(ConfigValue(std::move(texts)));
}

std::optional<ConfigValue> read_speed(const TomlTable& table, const ConfigOption& option) {
  if (!table.is_string(option.key)) {
    return as_value(table.number(option.key, option.range));
  }
  const std::optional<std::string> text = table.string(option.key);
  if (text && *text != "max") {
    table.error_at(option.key,
                   "'" + std::string(option.key) + "' is '" + *text +
                       "'; write \"max\", or a number without quotes");
    return std::nullopt;
  }
  return as_value(text);
}

std::optional<ConfigValue> read_value(const TomlTable& table, const ConfigOption& option) {
  switch (option.type) {
    case ConfigType::kBoolean:
      return as_value(table.boolean(option.key));
    case ConfigType::kInteger:
      return as_value(table.integer(option.key, option.range));
    case ConfigType::kNumber:
      return as_value(table.number(option.key, option.range));
    case ConfigType::kText:
    case ConfigType::kUrl:
      return as_value(table.string(option.key));
    case ConfigType::kChoice:
      return as_value(table.choice(option.key, option.choices));
    case ConfigType::kFolder:
    case ConfigType::kFile:
      return read_path(table, option);
    case ConfigType::kFiles:
      return read_paths(table, option);
    case ConfigType::kSpeed:
      return read_speed(table, option);
    case ConfigType::kMethods:
      return read_methods(table, option);
    case ConfigType::kTexts: {
      std::vector<std::string> texts = table.strings(option.key);
      return texts.empty() ? std::nullopt : std::optional(ConfigValue(std::move(texts)));
    }
  }
  RAYLOC_CHECK(false);
}

// The value of the file, or the default; empty without either. A default is read as if it were in a
// file, so that it obeys the same rules.
std::optional<ConfigEntry> read_entry(const TomlTable& table, const ConfigOption& option) {
  if (const std::optional<ConfigValue> value = read_value(table, option)) {
    return ConfigEntry{&option, *value, true};
  }
  if (option.preset.empty()) {
    return std::nullopt;
  }
  const std::string line = std::string(option.key) + " = " + std::string(option.preset);
  const auto document = TomlDocument::parse(line, "default");
  RAYLOC_CHECK(document.has_value());
  const std::optional<ConfigValue> value = read_value((*document)->root(), option);
  RAYLOC_CHECK(value.has_value());
  return ConfigEntry{&option, *value, false};
}

std::string assignment(const ConfigOption& option) {
  return std::string(option.key) + " = " +
         std::string(option.example.empty() ? option.preset : option.example);
}

void read_site(const TomlTable& table, ConfigReading& reading) {
  SiteConfig site;
  site.place = table.place();
  ConfigSection& entries = reading.sections.emplace_back();
  entries.name = "site";
  for (const ConfigOption& option : config_options()) {
    if (option.section != entries.name) {
      continue;
    }
    if (option.required) {
      table.require({{option.key, assignment(option)}});
    }
    if (const std::optional<ConfigEntry> entry = read_entry(table, option)) {
      option.store_site(site, entry->value);
      entries.entries.push_back(*entry);
    }
  }
  reading.config.sites.push_back(std::move(site));
  reading.site_tables.push_back(table);
}

// Reads [site], or each [[site]].
void read_site_sections(const TomlTable& root, ConfigReading& reading) {
  reading.config.has_site_list = root.is_array("site");
  if (reading.config.has_site_list) {
    for (const TomlTable& table : root.tables("site")) {
      read_site(table, reading);
    }
    if (reading.config.sites.empty()) {
      root.error_at("site", "'site' lists none; write [[site]] with directory = \"site\"");
    }
  } else if (const std::optional<TomlTable> table = root.table("site")) {
    read_site(*table, reading);
  }
}

void read_section(const TomlTable& table, std::string_view section, ConfigReading& reading) {
  ConfigSection& entries = reading.sections.emplace_back();
  entries.name = section;
  for (const ConfigOption& option : config_options()) {
    if (option.section != section) {
      continue;
    }
    if (option.required) {
      table.require({{option.key, assignment(option)}});
    }
    if (const std::optional<ConfigEntry> entry = read_entry(table, option)) {
      option.store(reading.config, entry->value);
      entries.entries.push_back(*entry);
    }
  }
}

// The key `kind`; empty if it is absent or wrong.
std::string stated_kind(const TomlTable& table) {
  const std::span<const ConfigOption> options = config_options();
  const auto kinds = std::find_if(options.begin(), options.end(), [](const ConfigOption& option) {
    return option.section == "source" && option.key == "kind";
  });
  RAYLOC_CHECK(kinds != options.end());
  table.require({{"kind", "kind = \"udp\""}});
  return table.choice("kind", kinds->choices).value_or("");
}

// The reason why a source of that kind has no such key; empty if it has.
std::string misplaced(const ConfigOption& option, const std::string& kind, bool by_url) {
  const std::string key = "'" + std::string(option.key) + "'";
  if (by_url && option.in_url) {
    return key + " is part of 'url'; leave one of them out";
  }
  if (applies_to_kind(option, kind) || (by_url && option.type == ConfigType::kUrl)) {
    return "";
  }
  return key + " belongs to kind " + std::string(option.only_kinds) + "; this source is of kind " +
         kind;
}

void require_address(const TomlTable& table, const std::string& kind) {
  if (kind == "pcap") {
    table.require({{"file", "file = \"recording.pcap\""}});
  }
  if (kind == "interface") {
    table.require({{"interface", "interface = \"eth0\""}});
  }
  if (kind == "unix") {
    table.require({{"path", "path = \"/run/raylocd/eth0\""}});
  }
}

void read_source(const TomlTable& table, ConfigReading& reading) {
  SourceConfig source;
  source.place = table.place();
  ConfigSection entries{"source", {}};
  const bool by_url = table.has("url");
  const std::optional<TransportAddress> url = read_source_url(table);
  const std::string kind = url      ? std::string(kind_of(*url->scheme))
                           : by_url ? ""
                                    : stated_kind(table);
  for (const ConfigOption& option : config_options()) {
    if (option.section != "source") {
      continue;
    }
    if (const std::string why = misplaced(option, kind, by_url); !why.empty()) {
      table.ask_for(option.key);
      if (!kind.empty() && table.has(option.key)) {
        table.error_at(option.key, why);
      }
      continue;
    }
    // With kind "" every key is read once, for its own errors.
    const std::optional<ConfigEntry> entry =
        option.key == "kind" && kind.empty() ? std::nullopt : read_entry(table, option);
    if (entry) {
      option.store_source(source, entry->value);
      entries.entries.push_back(*entry);
    }
  }
  if (url) {
    store_source_url(table, *url, source);
  } else {
    require_address(table, kind);
  }
  reading.config.sources.push_back(std::move(source));
  reading.sections.push_back(std::move(entries));
  reading.source_tables.push_back(table);
}

std::string file_of_both(const SourceConfig& a, const SourceConfig& b) {
  const auto both =
      std::find_first_of(a.files.begin(), a.files.end(), b.files.begin(), b.files.end());
  return both == a.files.end() ? "" : both->string();
}

// An input that two sources would compete for.
std::string shared_input(const SourceConfig& a, const SourceConfig& b) {
  if (a.kind != b.kind) {
    return {};
  }
  switch (a.kind) {
    case SourceKind::kUdp:
      return same_port({a.listen_host, a.listen_port}, {b.listen_host, b.listen_port})
                 ? "UDP port " + std::to_string(a.listen_port)
                 : "";
    case SourceKind::kPcap:
      return file_of_both(a, b);
    case SourceKind::kUnix:
      return a.path == b.path ? "socket " + a.path.string() : "";
    case SourceKind::kInterface:
      return a.interface == b.interface && a.filter == b.filter
                 ? "interface " + a.interface + " with the same filter"
                 : "";
    case SourceKind::kOther:
      return a.url == b.url ? a.url : "";
    case SourceKind::kCluster:
      return "";
  }
  return {};
}

void check_allowed_senders(const TomlTable& table, const SourceConfig& source) {
  for (const std::string& text : source.allow) {
    if (const auto range = AddressRange::parse(text); !range) {
      table.error_at("allow", "'allow': " + range.error().message);
    }
  }
}

// Recordings of a site share one clock.
void check_clocks(const ConfigReading& reading) {
  std::map<std::string, std::size_t> firsts;
  for (std::size_t i = 0; i < reading.config.sources.size(); ++i) {
    const SourceConfig& source = reading.config.sources[i];
    if (source.kind != SourceKind::kPcap) {
      continue;
    }
    const std::size_t first = firsts.try_emplace(source.site, i).first->second;
    const SourceConfig& other = reading.config.sources[first];
    for (const auto& [key, differs] : {std::pair("speed", source.speed != other.speed),
                                       std::pair("max_gap_s", source.max_gap != other.max_gap)}) {
      if (!differs) {
        continue;
      }
      const bool here = reading.source_tables[i].has(key);
      reading.source_tables[here ? i : first].error_at(
          key,
          "recordings are played together, and that of " + line_of((here ? other : source).place) +
              " has another '" + key + "'; write the same in each of them");
      return;
    }
  }
}

void check_sources(const ConfigReading& reading) {
  for (std::size_t i = 0; i < reading.config.sources.size(); ++i) {
    const SourceConfig& source = reading.config.sources[i];
    const TomlTable& table = reading.source_tables[i];
    if (source.kind == SourceKind::kUdp) {
      check_allowed_senders(table, source);
    }
    if (source.kind == SourceKind::kUdp && source.listen_host.empty()) {
      if (table.has("listen")) {
        table.error_at("listen",
                       "'listen' " + listen_fault(table.string("listen").value_or("")) +
                           "; write, for example: listen = \"0.0.0.0:5500\", or one address of "
                           "this machine");
      }
      continue;
    }
    for (std::size_t j = 0; j < i; ++j) {
      const SourceConfig& other = reading.config.sources[j];
      const std::string shared = shared_input(source, other);
      if (!shared.empty() && (table.has("kind") || table.has("url"))) {
        constexpr std::array<std::string_view, 5> kInputs = {
            "listen", "file", "interface", "path", "url"};
        table.error_at(table.has("url") ? "url" : kInputs.at(static_cast<std::size_t>(source.kind)),
                       "a second source on " + shared + " (the first: " + line_of(other.place) +
                           "); every access point sends from the same address, only the port, "
                           "file, interface or socket distinguishes them");
        break;
      }
    }
  }
}

void check_endpoint(const TomlTable& root,
                    std::string_view key,
                    const std::string& endpoint,
                    bool may_be_reached) {
  const std::optional<TomlTable> table = root.table("publish");
  if (!table || !table->is_string(key)) {
    return;
  }
  const std::string name = "'" + std::string(key) + "'";
  switch (endpoint_reach(endpoint)) {
    case EndpointReach::kInvalid:
      table->error_at(key,
                      name + " is '" + endpoint +
                          "'; write tcp://ADDRESS:PORT or ipc://PATH, for example: " +
                          std::string(key) + " = \"tcp://127.0.0.1:5560\"");
      return;
    case EndpointReach::kNamed:
      table->error_at(key,
                      name + " is '" + endpoint +
                          "', and names of hosts and interfaces are not resolved; write the "
                          "numeric address, which `ip address` lists, or * for every one");
      return;
    case EndpointReach::kNetwork:
      if (!may_be_reached) {
        table->error_at(key,
                        name +
                            " can be reached from the network, where everyone could read who is "
                            "where; write tcp://127.0.0.1:PORT, or set up [curve], or "
                            "insecure = true if that is meant");
      }
      return;
    case EndpointReach::kLoopback:
      return;
  }
}

void check_curve(const TomlTable& root, const CurveConfig& curve) {
  const std::optional<TomlTable> table = root.table("curve");
  if (!table) {
    return;
  }
  for (const std::string& key : curve.allow) {
    if (!is_curve_key(key)) {
      table->error_at("allow",
                      "'allow': '" + key +
                          "' is no public key, which is 40 characters (Z85); `rayloc keygen` "
                          "prints one");
      return;
    }
  }
  if (curve.enabled && curve.allow.empty() && !table->has("allow")) {
    table->error(
        "[curve] lacks 'allow': no client could subscribe; list the public keys that `rayloc "
        "keygen` prints on their machines");
  }
}

Expected<DaemonConfig> finish_config(TomlDocument& document) {
  ConfigReading reading = read_config(document);
  RAYLOC_TRY(document.finish());
  return std::move(reading.config);
}

}  // namespace

std::string line_of(const std::string& place) {
  const std::size_t slash = place.rfind('/') + 1;  // 0 if there is none
  const std::size_t column = place.rfind(':', place.size() - 3);
  return place.substr(slash, column - slash);
}

ConfigReading read_config(TomlDocument& document) {
  ConfigReading reading;
  reading.config.file = document.file();
  const TomlTable root = document.root();
  root.require({{"site", "[site] with directory = \"site\""}});
  if (!has_no_sources(root)) {
    root.require({{"source", "[[source]] with kind = \"udp\""}});
  }
  std::string_view section = "none";
  for (const ConfigOption& option : config_options()) {
    if (option.section == section) {
      continue;
    }
    section = option.section;
    if (section.empty()) {
      read_section(root, section, reading);
    } else if (section == "source") {
      for (const TomlTable& table : root.tables(section)) {
        read_source(table, reading);
      }
    } else if (section == "site") {
      read_site_sections(root, reading);
    } else if (const std::optional<TomlTable> table = root.table(section)) {
      read_section(*table, section, reading);
    } else if (!root.has(section)) {
      // Reads the section with all defaults.
      read_section(document.empty_table(std::string(section)), section, reading);
    }
  }
  take_credentials(reading.config);
  check_sources(reading);
  check_clocks(reading);
  const PublishConfig& publish = reading.config.publish;
  const bool may_be_reached = publish.insecure || reading.config.curve.enabled;
  check_endpoint(root, "endpoint", publish.endpoint, may_be_reached);
  check_endpoint(root, "snapshot", publish.snapshot, may_be_reached);
  check_curve(root, reading.config.curve);
  check_http(root, reading.config.http);
  check_cluster(root, reading.config.cluster);
  check_methods(root, reading);
  return reading;
}

Expected<DaemonConfig> parse_config(std::string_view text, const fs::path& file) {
  const auto document = TomlDocument::parse(text, file);
  return document ? finish_config(**document) : tl::make_unexpected(document.error());
}

Expected<DaemonConfig> load_config(const fs::path& file) {
  const auto document = read_files(file);
  return document ? finish_config(**document) : tl::make_unexpected(document.error());
}

Expected<std::unique_ptr<TomlDocument>> read_files(const fs::path& file) {
  Expected<std::unique_ptr<TomlDocument>> document = TomlDocument::read(file);
  if (document) {
    (*document)->include("include");
  }
  return document;
}

}  // namespace rayloc
