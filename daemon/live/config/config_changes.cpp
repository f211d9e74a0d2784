#include <iterator>

#include <nlohmann/json.hpp>

#include "daemon/live/config/config_reader.h"

namespace rayloc {

ConfigValues ConfigValues::of(const ConfigReading& reading, const std::vector<std::string>& names) {
  ConfigValues values;
  const DaemonConfig& config = reading.config;
  std::size_t sources = 0;
  std::size_t sites = 0;
  for (const ConfigSection& section : reading.sections) {
    std::string name(section.name);
    std::string site;
    if (name == "source") {
      const SourceConfig& source = config.sources[sources++];
      site = config.has_site_list ? source.site : "";
      name += " " + (config.has_site_list ? source.instance : std::to_string(sources));
    } else if (name == "site" && config.has_site_list) {
      site = names.at(sites++);
      name += " " + site;
    }
    for (const ConfigEntry& entry : section.entries) {
      const std::string key = (name.empty() ? "" : name + ".") + std::string(entry.option->key);
      values.values_[key] = {to_toml(entry.value), entry.option->reload, site};
    }
  }
  if (!config.has_site_list) {
    values.values_["source"] = {std::to_string(sources), false};
  }
  return values;
}

ConfigChanges ConfigValues::changes_to(const ConfigValues& newer) const {
  ConfigChanges changes;
  const auto note = [&](const std::string& key, const Entry& entry) {
    if (!entry.site.empty()) {
      changes.sites.insert(entry.site);
    }
    const bool applies = entry.reload || !entry.site.empty();
    (applies ? changes.applicable : changes.needs_restart).push_back(key);
  };
  for (const auto& [key, entry] : values_) {
    const auto now = newer.values_.find(key);
    if (now == newer.values_.end() || now->second.value != entry.value) {
      note(key, entry);
    }
  }
  for (const auto& [key, entry] : newer.values_) {
    if (values_.count(key) == 0) {
      note(key, entry);
    }
  }
  return changes;
}

std::string ConfigValues::json() const {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [key, entry] : values_) {
    // The output of to_toml() is valid JSON as well; strings that are not UTF-8 are left out.
    const auto value = nlohmann::ordered_json::parse(entry.value, nullptr, false);
    json[key] = value.is_discarded() ? nlohmann::ordered_json() : value;
  }
  return json.dump(2) + "\n";
}

void ConfigValues::adopt_applicable(const ConfigValues& newer) {
  for (auto entry = values_.begin(); entry != values_.end();) {
    entry = entry->second.reload || !entry->second.site.empty() ? values_.erase(entry)
                                                                : std::next(entry);
  }
  for (const auto& [key, entry] : newer.values_) {
    if (entry.reload || !entry.site.empty()) {
      values_[key] = entry;
    }
  }
}

namespace {

// The value of an option that no file states and that has no default.
ConfigValue nothing_of(ConfigType type) {
  switch (type) {
    case ConfigType::kTexts:
    case ConfigType::kFiles:
      return std::vector<std::string>();
    case ConfigType::kBoolean:
      return false;
    case ConfigType::kInteger:
      return std::int64_t{0};
    case ConfigType::kNumber:
      return 0.0;
    default:
      return std::string();
  }
}

}  // namespace

DaemonConfig reloaded_config(const DaemonConfig& running, const ConfigReading& now) {
  DaemonConfig config = running;
  config.file = now.config.file;
  config.sites = now.config.sites;
  config.has_site_list = now.config.has_site_list;
  config.sources = now.config.sources;
  for (const ConfigOption& option : config_options()) {
    if (!option.reload || option.store == nullptr) {
      continue;
    }
    ConfigValue value = nothing_of(option.type);
    for (const ConfigSection& section : now.sections) {
      for (const ConfigEntry& entry : section.entries) {
        if (entry.option == &option) {
          value = entry.value;
        }
      }
    }
    option.store(config, value);
  }
  return config;
}

}  // namespace rayloc
