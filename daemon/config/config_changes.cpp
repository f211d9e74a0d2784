#include <iterator>

#include <nlohmann/json.hpp>

#include "daemon/config/config_reader.h"

namespace rayloc {

ConfigValues ConfigValues::of(const ConfigReading& reading) {
  ConfigValues values;
  int sources = 0;
  for (const ConfigSection& section : reading.sections) {
    std::string name(section.name);
    if (name == "source") {
      name += " " + std::to_string(++sources);
    }
    for (const ConfigEntry& entry : section.entries) {
      const std::string key = (name.empty() ? "" : name + ".") + std::string(entry.option->key);
      values.values_[key] = {to_toml(entry.value), entry.option->reload};
    }
  }
  values.values_["source"] = {std::to_string(sources), false};
  return values;
}

ConfigChanges ConfigValues::changes_to(const ConfigValues& newer) const {
  ConfigChanges changes;
  const auto note = [&](const std::string& key, bool reload) {
    (reload ? changes.applicable : changes.needs_restart).push_back(key);
  };
  for (const auto& [key, entry] : values_) {
    const auto now = newer.values_.find(key);
    if (now == newer.values_.end() || now->second.value != entry.value) {
      note(key, entry.reload);
    }
  }
  for (const auto& [key, entry] : newer.values_) {
    if (values_.count(key) == 0) {
      note(key, entry.reload);
    }
  }
  return changes;
}

std::string ConfigValues::json() const {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [key, entry] : values_) {
    // What to_toml() writes reads the same in JSON; strings that are no UTF-8 are left out.
    const auto value = nlohmann::ordered_json::parse(entry.value, nullptr, false);
    json[key] = value.is_discarded() ? nlohmann::ordered_json() : value;
  }
  return json.dump(2) + "\n";
}

void ConfigValues::adopt_applicable(const ConfigValues& newer) {
  for (auto entry = values_.begin(); entry != values_.end();) {
    entry = entry->second.reload ? values_.erase(entry) : std::next(entry);
  }
  for (const auto& [key, entry] : newer.values_) {
    if (entry.reload) {
      values_[key] = entry;
    }
  }
}

}  // namespace rayloc
