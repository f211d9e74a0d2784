// A configuration while it is being read: the values, and where they stand. Shared by config.cpp
// and config_text.cpp; everyone else wants config.h.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "daemon/config/config_schema.h"
#include "daemon/site/toml_reader.h"

namespace rayloc {

struct ConfigEntry {
  const ConfigOption* option = nullptr;
  ConfigValue value;
  bool stated = false;  // else the default
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

// The file and what it includes.
Expected<std::unique_ptr<TomlDocument>> read_files(const std::filesystem::path& file);

// "raylocd.toml:4", of "/etc/raylocd/raylocd.toml:4:1: ".
std::string line_of(const std::string& place);

// Errors are noted in the document.
ConfigReading read_config(TomlDocument& document);

// What holds when a daemon that runs with `running` reads its files again: sites, sources and the
// keys that a reload applies as they are now, the others as they were.
DaemonConfig reloaded_config(const DaemonConfig& running, const ConfigReading& now);

}  // namespace rayloc
