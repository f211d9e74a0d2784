// Converts a configuration to the sites to run: by name, each with its resolved, checked sources.
#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "daemon/live/config/config_methods.h"
#include "daemon/live/config/config_reader.h"
#include "daemon/messages/topic.h"
#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

// The data of a [[site]] that is read before its sources.
struct ReadSite {
  std::string name;     // empty: unknown
  std::string trouble;  // the reason why it could not be read
  bool is_read = false;
  Site site;
  std::vector<std::string> method_places = {};
};

std::vector<ReadSite> read_site_folders(const DaemonConfig& config, const RunningSetup* running) {
  std::vector<ReadSite> sites;
  for (const SiteConfig& stated : config.sites) {
    ReadSite& read = sites.emplace_back();
    read.name = stated.name;
    if (stated.directory.empty()) {
      continue;  // already reported as an error
    }
    Expected<Site> site = load_site(stated.directory);
    if (!site) {
      read.trouble = site.error().message;
      if (read.name.empty() && running != nullptr) {
        const auto known = running->names.find(stated.directory);
        read.name = known == running->names.end() ? "" : known->second;
      }
      read.site.name = read.name;
      continue;
    }
    read.site = std::move(*site);
    read.is_read = true;
    read.name = read.name.empty() ? read.site.name : read.name;
    read.site.name = read.name;
  }
  return sites;
}

// Names are used in paths and topics, and as names of folders.
void check_names(const std::vector<ReadSite>& sites, const ConfigReading& reading) {
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const std::string& name = sites[i].name;
    const TomlTable& table = reading.site_tables[i];
    const std::string_view key = table.has("name") ? "name" : "directory";
    if (name == "." || name == "..") {
      table.error_at(key, fmt::format("'{}' is no name for a site", name));
    }
    for (std::size_t j = 0; j < i && !name.empty(); ++j) {
      if (sites[j].name == name) {
        table.error_at(key,
                       fmt::format("a second site called '{}' (the first: {}); give it another "
                                   "name: name = \"{}-2\"",
                                   name,
                                   line_of(reading.config.sites[j].place),
                                   name));
        break;
      }
    }
  }
}

// -1 if it cannot be determined.
int site_of(const SourceConfig& source,
            const TomlTable& table,
            const std::vector<ReadSite>& sites,
            bool listed) {
  if (sites.empty()) {
    return -1;  // already reported as an error
  }
  if (!table.has("site")) {
    if (sites.size() == 1) {
      return 0;
    }
    table.error("[[source]] lacks 'site', and there are several; write: site = \"NAME\"");
    return -1;
  }
  std::vector<std::string_view> names;
  names.reserve(sites.size());
  for (const ReadSite& site : sites) {
    names.emplace_back(site.name);
  }
  const auto found = std::find(names.begin(), names.end(), source.site);
  if (!source.site.empty() && found != names.end()) {
    return static_cast<int>(found - names.begin());
  }
  // One that could not be read may be the match.
  const bool all_known = std::none_of(
      sites.begin(), sites.end(), [](const ReadSite& site) { return site.name.empty(); });
  if (!source.site.empty() && all_known) {
    table.error_at("site",
                   std::string(listed ? "no [[site]]" : "the site of [site]") +
                       (listed ? " is called '" : " is not called '") + source.site + "'" +
                       suggestion(source.site, names));
  }
  return -1;
}

void resolve_access_point(const Site& site, std::size_t index, ConfigReading& reading) {
  std::vector<std::string_view> ids;
  for (const SiteAccessPoint& access_point : site.access_points) {
    ids.emplace_back(access_point.id);
  }
  SourceConfig& source = reading.config.sources[index];
  const TomlTable& table = reading.source_tables[index];
  if (source.access_point.empty() && !table.has("access_point") && ids.size() == 1) {
    source.access_point = ids.front();
  }
  if (source.access_point.empty()) {
    if (!table.has("access_point")) {
      table.error("[[source]] lacks 'access_point', and the site has several; write one of: " +
                  list_of(ids));
    }
    return;
  }
  const auto found = std::find(ids.begin(), ids.end(), source.access_point);
  if (found == ids.end()) {
    table.error_at("access_point",
                   "the site has no access point '" + source.access_point + "'" +
                       suggestion(source.access_point, ids));
    return;
  }
  source.access_point_index = static_cast<std::size_t>(found - ids.begin());
  for (std::size_t j = 0; j < index; ++j) {
    const SourceConfig& other = reading.config.sources[j];
    if (other.site_index == source.site_index &&
        other.access_point_index == source.access_point_index) {
      table.error_at(
          "access_point",
          "access point '" + source.access_point + "' has a source already; give each its own");
      return;
    }
  }
}

void resolve_sources(const std::vector<ReadSite>& sites, ConfigReading& reading) {
  const bool listed = reading.config.has_site_list;
  std::set<int> received;
  for (std::size_t i = 0; i < reading.config.sources.size(); ++i) {
    SourceConfig& source = reading.config.sources[i];
    source.site_index = site_of(source, reading.source_tables[i], sites, listed);
    received.insert(source.site_index);
    if (source.site_index < 0) {
      continue;
    }
    const ReadSite& site = sites[static_cast<std::size_t>(source.site_index)];
    if (site.is_read) {
      resolve_access_point(site.site, i, reading);
    }
    source.instance = source.access_point;
    if (listed && !site.name.empty()) {
      source.site = site.name;
      source.instance = topic_component(site.name) + "-" + source.access_point;
    }
  }
  for (std::size_t i = 0; i < sites.size() && listed && received.count(-1) == 0; ++i) {
    if (received.count(static_cast<int>(i)) == 0 && !reading.config.sources.empty()) {
      reading.site_tables[i].error("[[site]]" +
                                   (sites[i].name.empty() ? "" : " '" + sites[i].name + "'") +
                                   " has no [[source]]; write one with site = its name");
    }
  }
}

// For a worker: one source for each access point of each site, which is the site's stream.
void add_stream_sources(const std::vector<ReadSite>& sites, DaemonConfig& config) {
  constexpr Duration kStallAfter = std::chrono::seconds(5);  // equal to the default of [[source]]
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Site& site = sites[i].site;
    for (std::size_t j = 0; j < site.access_points.size(); ++j) {
      SourceConfig& source = config.sources.emplace_back();
      source.kind = SourceKind::kCluster;
      source.access_point = site.access_points[j].id;
      source.access_point_index = j;
      source.site = sites[i].name;
      source.site_index = static_cast<int>(i);
      source.instance = topic_component(sites[i].name) + "-" + source.access_point;
      source.stall_after = kStallAfter;
      source.place = config.sites[i].place;
    }
  }
}

// The configuration that applies to one of its sites.
SiteSetup setup_of(const DaemonConfig& config, std::size_t index, ReadSite&& read) {
  SiteSetup setup;
  setup.config = config;
  setup.site = std::move(read.site);
  setup.trouble = std::move(read.trouble);
  setup.method_places = std::move(read.method_places);
  const SiteConfig& stated = config.sites[index];
  setup.directory = stated.directory;
  if (stated.has_method) {
    setup.config.engine.method = stated.method;
    setup.config.engine.compared = stated.compared;
  }
  std::erase_if(setup.config.sources, [&](const SourceConfig& source) {
    return source.site_index != static_cast<int>(index);
  });
  RecordConfig& record = setup.config.record;
  if (!stated.record) {
    record.directory.clear();
    record.ring = Duration::zero();
  }
  if (config.has_site_list && !setup.site.name.empty()) {
    setup.folder = topic_component(setup.site.name);
    for (fs::path* const folder : {&record.directory, &record.snapshot_directory}) {
      if (!folder->empty()) {
        *folder /= setup.folder;
      }
    }
  }
  return setup;
}

Expected<DaemonSetup> load(const fs::path& file, const RunningSetup* running) {
  const auto document = read_files(file);
  RAYLOC_TRY(document);
  ConfigReading reading = read_config(**document);
  std::vector<ReadSite> sites = read_site_folders(reading.config, running);
  check_names(sites, reading);
  const ClusterRole role = reading.config.cluster.role;
  if (role == ClusterRole::kWorker) {
    add_stream_sources(sites, reading.config);
  } else if (role != ClusterRole::kGateway) {
    resolve_sources(sites, reading);
  }
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (sites[i].is_read) {
      sites[i].method_places = check_methods_of((*document)->root(), reading, sites[i].site, i);
    }
  }
  const bool tolerant = running != nullptr && reading.config.has_site_list;
  std::string errors;
  if (const Expected<void> result = (*document)->finish(); !result) {
    errors = result.error().message;
  }
  for (const ReadSite& site : sites) {
    if (!site.trouble.empty() && (!tolerant || site.name.empty())) {
      errors += (errors.empty() ? "" : "\n") + site.trouble;
    }
  }
  if (!errors.empty()) {
    return make_error(ErrorKind::kConfiguration, errors);
  }
  DaemonSetup setup;
  std::vector<std::string> names;
  names.reserve(sites.size());
  for (const ReadSite& site : sites) {
    names.push_back(site.name);
  }
  setup.values = ConfigValues::of(reading, names);
  setup.config =
      running == nullptr ? std::move(reading.config) : reloaded_config(running->config, reading);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    setup.sites.push_back(setup_of(setup.config, i, std::move(sites[i])));
  }
  return setup;
}

}  // namespace

Expected<DaemonSetup> load_daemon_setup(const fs::path& file) { return load(file, nullptr); }

Expected<DaemonSetup> reload_daemon_setup(const fs::path& file, const RunningSetup& running) {
  return load(file, &running);
}

}  // namespace rayloc
