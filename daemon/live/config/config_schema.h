// The table of every key of raylocd's configuration: names, valid values, meanings.
//
// Reading and checking (config.cpp), the commented example (deploy/raylocd.toml, `rayloc config
// default`), the effective configuration and the JSON schema all come from this table. A row also
// stores the value, so that a documented key is always read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "daemon/live/config/config.h"
#include "daemon/site/model/number_range.h"

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
  std::string_view preset = {};   // the default in TOML, empty if there is none
  std::string_view example = {};  // in TOML, if there is no default
  bool required = false;
  NumberRange range = {};
  std::span<const std::string_view> choices = {};
  std::string_view description = {};  // one line
  std::string_view only_kinds = {};   // of [[source]]: kinds that have the key, empty: all
  bool in_url = false;                // of [[source]]: replaced by `url` if that is stated
  bool reload = false;                // SIGHUP applies a change; otherwise a restart does
  void (*store)(DaemonConfig&, const ConfigValue&) = nullptr;
  void (*store_site)(SiteConfig&, const ConfigValue&) = nullptr;
  void (*store_source)(SourceConfig&, const ConfigValue&) = nullptr;
};

// In the order of the example; the options of a section are adjacent.
std::span<const ConfigOption> config_options();

// True if a [[source]] of that kind has the option.
bool applies_to_kind(const ConfigOption& option, std::string_view kind);

// The file deploy/raylocd.toml: every key with its description; omitted keys are commented out.
std::string config_example();

// The manual page raylocd.toml(5), in the man macros of roff.
std::string config_manual_page();

// A JSON schema (draft 2020-12) of the file, for editors.
std::string config_json_schema();

// The valid values of an option: "from 0.01 to 10 s", "udp", "pcap" or "interface"; empty if its
// type is sufficient.
std::string config_limits(const ConfigOption& option);

// A value in TOML: true, 5, 0.2, "text", ["a", "b"].
std::string to_toml(const ConfigValue& value);

}  // namespace rayloc
