#include "daemon/live/config/config_methods.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "daemon/live/config/config_schema_rows.h"
#include "daemon/methods/method_registry.h"
#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

constexpr std::string_view kNone = "none";

// The reason why the method is invalid at that position of the list; empty if it is valid.
std::string fault_of(const std::vector<std::string>& names,
                     std::size_t entry,
                     const ConfigOption& option) {
  const std::string& name = names[entry];
  const bool is_choice =
      std::find(option.choices.begin(), option.choices.end(), name) != option.choices.end();
  if (!is_choice && find_method(name) != nullptr) {
    return fmt::format(
        "method '{0}' works on recordings only (rayloc replay --method {0}); live methods are: "
        "{1}",
        name,
        list_of(option.choices));
  }
  if (!is_choice) {
    return fmt::format(
        "'{}' is no value of '{}'{}", name, option.key, suggestion(name, option.choices));
  }
  if (name == kNone && names.size() > 1) {
    return fmt::format("'{}' locates nothing, so no method can be compared with it; leave it out",
                       name);
  }
  const auto end = names.begin() + static_cast<std::ptrdiff_t>(entry);
  if (std::find(names.begin(), end, name) != end) {
    return fmt::format("method '{}' is listed twice in '{}'; keep one", name, option.key);
  }
  if (const Method* first = find_method(names.front());
      first != nullptr && first->uses_every_channel && !find_method(name)->uses_every_channel) {
    return fmt::format(
        "'{0}' takes frames of every channel and '{1}' locates by the site's alone: list '{1}' "
        "before '{0}', which then has the frames of that channel",
        names.front(),
        name);
  }
  if (entry == kMaxMethods) {
    return fmt::format(
        "'{}' lists {} methods; at most {} are allowed", option.key, names.size(), kMaxMethods);
  }
  return {};
}

bool has_devices(const Site& site) {
  return site.targets.track_unlisted ||
         std::any_of(site.transmitters.begin(), site.transmitters.end(), [](const auto& one) {
           return one.role == TransmitterRole::kDevice;
         });
}

// Data that the site lacks for the method; empty if it lacks none.
std::string lack_of(const Method& method, const Site& site) {
  const std::string folder = site.directory.string();
  if (method.needs_training && site.training_files.count(std::string(method.name)) == 0) {
    return fmt::format(
        "method '{0}' has no training of site '{1}': run rayloc train {2} --method {0} --capture "
        "... --points ...",
        method.name,
        site.name,
        folder);
  }
  if (method.create_person == nullptr && !has_devices(site)) {
    return fmt::format(
        "method '{}' locates devices, and site '{}' has none: add a [[transmitter]] with role = "
        "\"device\" to its site.toml, or set unlisted = \"track\" in [targets]",
        method.name,
        site.name);
  }
  if (method.create_device == nullptr && !site.reference_file) {
    return fmt::format(
        "method '{}' locates people, and site '{}' has no recording of the empty room: run rayloc "
        "reference {}",
        method.name,
        site.name,
        folder);
  }
  return {};
}

}  // namespace

void config_rows::store_methods(const ConfigValue& value,
                                const Method*& first,
                                std::vector<const Method*>& compared) {
  compared.clear();
  const auto* names = std::get_if<std::vector<std::string>>(&value);
  if (names == nullptr) {
    first = find_method(text(value));
    return;
  }
  first = find_method(names->front());
  for (std::size_t i = 1; i < names->size(); ++i) {
    compared.push_back(find_method((*names)[i]));
  }
}

std::optional<ConfigValue> read_methods(const TomlTable& table, const ConfigOption& option) {
  const std::vector<std::string> names = table.strings(option.key);
  bool is_good = !names.empty();
  for (std::size_t i = 0; i < names.size() && i <= kMaxMethods; ++i) {
    if (const std::string fault = fault_of(names, i, option); !fault.empty()) {
      table.error_at(option.key, i, fault);
      is_good = false;
    }
  }
  if (!is_good) {
    return std::nullopt;
  }
  return names.size() == 1 ? ConfigValue(names.front()) : ConfigValue(names);
}

void check_methods(const TomlTable& root, const ConfigReading& reading) {
  if (reading.config.cluster.role != ClusterRole::kWorker) {
    return;
  }
  const auto refuse = [](const TomlTable& table) {
    table.error_at("method",
                   1,
                   "a worker of a cluster locates by one method, so that every worker finds the "
                   "same; state one method");
  };
  const std::optional<TomlTable> engine = root.table("engine");
  if (engine && !reading.config.engine.compared.empty()) {
    refuse(*engine);
  }
  for (std::size_t i = 0; i < reading.config.sites.size(); ++i) {
    if (!reading.config.sites[i].compared.empty()) {
      refuse(reading.site_tables[i]);
    }
  }
}

std::vector<std::string> check_methods_of(const TomlTable& root,
                                          const ConfigReading& reading,
                                          const Site& site,
                                          std::size_t index) {
  const SiteConfig& stated = reading.config.sites[index];
  const EngineConfig& engine = reading.config.engine;
  const std::optional<TomlTable> table =
      stated.has_method ? std::optional(reading.site_tables[index]) : root.table("engine");
  if (!table || !table->has("method")) {
    return {};  // the default, which has no requirements
  }
  std::vector<const Method*> all = stated.has_method ? stated.compared : engine.compared;
  all.insert(all.begin(), stated.has_method ? stated.method : engine.method);
  std::vector<std::string> places;
  for (std::size_t i = 0; i < all.size(); ++i) {
    places.push_back(table->place("method", i));
    const std::string lack = all[i] == nullptr ? "" : lack_of(*all[i], site);
    if (!lack.empty()) {
      table->error_at("method", i, lack);
    }
  }
  return places;
}

}  // namespace rayloc
