// A configuration while it is being read: the values, and where they stand. Shared by config.cpp
// and config_text.cpp; everyone else wants config.h.
#pragma once

#include <filesystem>
#include <memory>
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
  std::string_view name;  // "engine"; "source" once for each [[source]]
  std::vector<ConfigEntry> entries;
};

struct ConfigReading {
  DaemonConfig config;
  std::vector<ConfigSection> sections;
  std::vector<TomlTable> source_tables;  // of config.sources, one each
};

// The file and what it includes.
Expected<std::unique_ptr<TomlDocument>> read_files(const std::filesystem::path& file);

// Errors are noted in the document.
ConfigReading read_config(TomlDocument& document);

}  // namespace rayloc
