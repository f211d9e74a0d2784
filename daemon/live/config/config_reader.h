// A configuration while it is being read: the values and their places. Shared by config.cpp and
// config_text.cpp; all other code should include config.h.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "daemon/live/config/config_schema.h"
#include "daemon/site/model/toml_reader.h"

namespace rayloc {

struct ConfigEntry {
  const ConfigOption* option = nullptr;
  ConfigValue value;
  bool stated = false;  // otherwise the default
};

struct ConfigSection {
  std::string_view name;  // "engine"; "source" once for each [[source]], "site" for each [[site]]
  std::vector<ConfigEntry> entries;
};

struct ConfigReading {
  DaemonConfig config;
  std::vector<ConfigSection> sections;
  std::vector<TomlTable> site_tables;    // of config.sites, one each
  std::vector<TomlTable> source_tables;  // of config.sources, one each
};

// Reads the file and its includes.
Expected<std::unique_ptr<TomlDocument>> read_files(const std::filesystem::path& file);

// "raylocd.toml:4", of "/etc/raylocd/raylocd.toml:4:1: ".
std::string line_of(const std::string& place);

// Errors are recorded in the document.
ConfigReading read_config(TomlDocument& document);

// The configuration after a daemon with `running` reads its files again: sites, sources and the
// keys that a reload applies from the new reading, the others unchanged.
DaemonConfig reloaded_config(const DaemonConfig& running, const ConfigReading& now);

}  // namespace rayloc
