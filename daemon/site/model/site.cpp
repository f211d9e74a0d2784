#include "daemon/site/model/site.h"

#include <algorithm>
#include <cctype>
#include <system_error>

#include "daemon/site/model/site_tables.h"
#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSiteFile = "site.toml";
constexpr std::size_t kLongestName = 64;

void read_file_table(const SiteTable& root, std::string_view key, std::optional<fs::path>& file) {
  if (const std::optional<SiteTable> table = root.table(key)) {
    file = table->file("file");
  }
}

void read_trainings(const SiteTable& root, Site& site) {
  for (const SiteTable& table : root.tables("training")) {
    const auto method = table.text("method");
    const auto file = table.file("file");
    if (method && file && !site.training_files.emplace(*method, *file).second) {
      table.error_at("method", "another [[training]] is of method " + *method + "; keep one");
    }
  }
}

void read_root(const SiteTable& root, Site& site) {
  site.name = read_topic_name(root.toml()).value_or("");
  site.scene_file = root.file("scene").value_or(fs::path());
  if (const std::optional<SiteTable> bounds = root.table("bounds")) {
    read_bounds(*bounds, site);
  }
  if (const std::optional<SiteTable> carrier = root.table("carrier")) {
    read_carrier(*carrier, site.carrier);
  }
  if (const std::optional<SiteTable> targets = root.table("targets")) {
    read_targets(*targets, site);
  }
  read_access_points(root.tables("access_point"), site);
  read_transmitters(root, site);
  if (const std::optional<SiteTable> person = root.table("person")) {
    read_person(*person, site);
  }
  read_materials(root, site);
  if (const std::optional<SiteTable> georeference = root.table("georeference")) {
    read_georeference(*georeference, site);
  }
  read_zones(root, site);
  read_file_table(root, "calibration", site.calibration_file);
  read_file_table(root, "reference", site.reference_file);
  read_trainings(root, site);
}

Expected<Site> read_document(TomlDocument& document) {
  Site site;
  site.directory = document.file().parent_path();
  if (site.directory.empty()) {
    site.directory = ".";
  }
  read_root({document.root(), ""}, site);
  site.files = document.named_paths();
  site.files.push_back(document.file());
  RAYLOC_TRY(document.finish());
  return site;
}

}  // namespace

std::optional<std::string> read_topic_name(const TomlTable& table) {
  std::optional<std::string> name = table.string("name");
  if (name && (name->find('/') != std::string::npos || name->size() > kLongestName)) {
    table.error_at("name",
                   "'name' is part of every topic: write at most " + std::to_string(kLongestName) +
                       " bytes, without '/'");
    return std::nullopt;
  }
  return name;
}

Expected<Site> parse_site(std::string_view text, const fs::path& file) {
  const auto document = TomlDocument::parse(text, file);
  return document ? read_document(**document) : tl::make_unexpected(document.error());
}

Expected<Site> load_site(const fs::path& directory) {
  std::error_code status;
  const bool is_file = !fs::is_directory(directory, status) && directory.extension() == ".toml";
  const fs::path file = is_file ? directory : directory / kSiteFile;
  if (!fs::exists(file, status)) {
    return make_error(ErrorKind::kConfiguration,
                      file.string() + ": there is no such file; a site is a directory with a " +
                          std::string(kSiteFile));
  }
  const auto document = TomlDocument::read(file);
  return document ? read_document(**document) : tl::make_unexpected(document.error());
}

bool is_access_point_id(std::string_view text) {
  return !text.empty() && text.size() <= kLongestName &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
         });
}

Expected<std::size_t> find_access_point(const Site& site, const std::string& id) {
  std::vector<std::string_view> ids;
  for (const SiteAccessPoint& access_point : site.access_points) {
    if (access_point.id == id) {
      return ids.size();
    }
    ids.emplace_back(access_point.id);
  }
  return make_error(ErrorKind::kConfiguration,
                    "the site has no access point '" + id + "'; it has: " + list_of(ids));
}

const SiteTransmitter* find_transmitter(const Site& site, const MacAddress& mac) {
  const auto found = std::find_if(site.transmitters.begin(),
                                  site.transmitters.end(),
                                  [&](const SiteTransmitter& each) { return each.mac == mac; });
  return found == site.transmitters.end() ? nullptr : &*found;
}

const SiteTransmitter* find_fixed_transmitter(const Site& site, const MacAddress& mac) {
  const SiteTransmitter* stated = find_transmitter(site, mac);
  return stated != nullptr && stated->role == TransmitterRole::kFixed ? stated : nullptr;
}

std::vector<std::string> access_point_ids(const Site& site) {
  std::vector<std::string> ids;
  ids.reserve(site.access_points.size());
  for (const SiteAccessPoint& access_point : site.access_points) {
    ids.push_back(access_point.id);
  }
  return ids;
}

}  // namespace rayloc
