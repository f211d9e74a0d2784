// The table of every key of raylocd's configuration: what there is, what it may be, what it means.
//
// Reading and checking (config.cpp), the commented example (deploy/raylocd.toml, `rayloc config
// default`), the effective configuration and the JSON schema all come from this table. A row also
// stores the value, so that there can be no key that is documented and not read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "daemon/config/config.h"
#include "daemon/site/number_range.h"

namespace rayloc {

enum class ConfigType {
  kBoolean,
  kInteger,
  kNumber,
  kText,
  kChoice,   // one of `choices`
  kFolder,   // a path
  kFile,     // a path, or "-" for standard input
  kFiles,    // an array of paths and patterns of them, or one; or "-"
  kSpeed,    // a number, or "max"
  kTexts,    // an array of texts, or one
  kUrl,      // of a transport (capture/source/transport_schemes.h)
  kMethods,  // one of `choices`, or an array of different ones (config_methods.h)
};

inline constexpr std::size_t kMaxMethods = 4;  // of ConfigType::kMethods

// Paths as text, joined with the folder of the file.
using ConfigValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>>;

struct ConfigOption {
  // "engine"; "" for the top of the file; "source" for [[source]], "site" for [site] or [[site]].
  std::string_view section;
  std::string_view key;
  ConfigType type;
  std::string_view preset = {};   // the default in TOML, empty when there is none
  std::string_view example = {};  // in TOML, where there is no default
  bool required = false;
  NumberRange range = {};
  std::span<const std::string_view> choices = {};
  std::string_view description = {};  // one line
  std::string_view only_kinds = {};   // of [[source]]: kinds that have the key, empty: all
  bool in_url = false;                // of [[source]]: `url` says it, where that is stated
  bool reload = false;                // SIGHUP applies a change; else it takes a restart
  void (*store)(DaemonConfig&, const ConfigValue&) = nullptr;
  void (*store_site)(SiteConfig&, const ConfigValue&) = nullptr;
  void (*store_source)(SourceConfig&, const ConfigValue&) = nullptr;
};

// In the order of the example; the options of a section stand together.
std::span<const ConfigOption> config_options();

// Whether a [[source]] of that kind has the option.
bool applies_to_kind(const ConfigOption& option, std::string_view kind);

// The file deploy/raylocd.toml: every key with its description; what is left out is commented.
std::string config_example();

// The manual page raylocd.toml(5), in the man macros of roff.
std::string config_manual_page();

// A JSON schema (draft 2020-12) of the file, for editors.
std::string config_json_schema();

// What values an option takes: "from 0.01 to 10 s", "udp", "pcap" or "interface"; empty when that
// is told by its type.
std::string config_limits(const ConfigOption& option);

// A value in TOML: true, 5, 0.2, "text", ["a", "b"].
std::string to_toml(const ConfigValue& value);

}  // namespace rayloc
