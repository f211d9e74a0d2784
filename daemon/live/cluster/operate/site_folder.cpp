#include "daemon/live/cluster/operate/site_folder.h"

#include <fstream>
#include <system_error>
#include <utility>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/operate/scratch_folder.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

// The first line of a file, without its line end; empty if there is no file.
std::string first_line_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

}  // namespace

Expected<std::string> check_bundle(const SiteBundle& bundle,
                                   const std::filesystem::path& folder,
                                   const CheckSite& check) {
  RAYLOC_TRY(write_bundle(bundle, folder));
  return check(folder);
}

bool is_plain_site_name(const std::string& name) {
  return name == printable(name) && name.find_first_of("\"\\") == std::string::npos;
}

SiteFolder::SiteFolder(std::filesystem::path folder, CheckSite check)
    : folder_(std::move(folder)), check_(std::move(check)) {}

std::vector<SiteDifference> SiteFolder::differences(
    const std::map<std::string, std::string>& stored) const {
  std::vector<SiteDifference> differences;
  for (const auto& [site, hash] : stored) {
    const auto refused = refused_.find(site);
    const bool is_refused = !hash.empty() && refused != refused_.end() && refused->second == hash;
    if (!is_refused && hash != first_line_of(hash_file(site))) {
      differences.push_back({site, hash});
    }
  }
  return differences;
}

SiteChange SiteFolder::settle(Broker& broker, const SiteDifference& difference) {
  if (difference.hash.empty()) {
    return remove(difference.site);
  }
  const Expected<void> replaced = replace(broker, difference.site, difference.hash);
  if (replaced) {
    return {SiteChange::Kind::kReplaced};
  }
  refused_[difference.site] =
      replaced.error().kind == ErrorKind::kUnavailable ? "" : difference.hash;
  return {SiteChange::Kind::kRefused, replaced.error().message};
}

std::filesystem::path SiteFolder::path(const std::string& site, const char* end) const {
  return folder_ / (subject_token(site) + end);
}

std::filesystem::path SiteFolder::hash_file(const std::string& site) const {
  return path(site, ".hash");
}

// Removes its configuration first: no configuration may refer to a missing folder.
SiteChange SiteFolder::remove(const std::string& site) const {
  std::error_code failed;
  std::filesystem::remove(path(site, ".toml"), failed);
  if (!failed) {
    std::filesystem::remove_all(path(site, ""), failed);
  }
  // The hash file goes last: while it exists, the next run detects an incomplete removal.
  const bool was_there = !failed && std::filesystem::remove(hash_file(site), failed);
  if (failed) {
    return {SiteChange::Kind::kRemovalFailed, failed.message()};
  }
  return {was_there ? SiteChange::Kind::kRemoved : SiteChange::Kind::kNone};
}

Expected<void> SiteFolder::replace(Broker& broker,
                                   const std::string& site,
                                   const std::string& hash) const {
  if (!is_plain_site_name(site)) {
    return bad_input("its name has a quotation mark, a backslash or what cannot be printed");
  }
  const auto bundle = fetch_bundle(broker, site, hash);
  RAYLOC_TRY(bundle);
  const ScratchFolder fresh(path(site, ".new"));
  RAYLOC_TRY(check_bundle(*bundle, fresh.path(), check_));
  const ScratchFolder old(path(site, ".old"));
  std::error_code failed;
  std::filesystem::rename(path(site, ""), old.path(), failed);  // fails if there was none
  std::filesystem::rename(fresh.path(), path(site, ""), failed);
  if (failed) {
    std::error_code ignored;
    std::filesystem::rename(old.path(), path(site, ""), ignored);
    return make_error(ErrorKind::kUnavailable,
                      path(site, "").string() + ": cannot be exchanged: " + failed.message());
  }
  std::ofstream toml(path(site, ".toml"));
  toml << "# Written by `rayloc cluster fetch`.\n[[site]]\nname = \"" << site
       << "\"\ndirectory = \"" << subject_token(site) << "\"\n"
       << std::flush;
  std::ofstream seen(hash_file(site));
  seen << hash << "\n" << std::flush;
  return !toml || !seen
             ? make_error(ErrorKind::kUnavailable, folder_.string() + ": cannot be written")
             : Expected<void>();
}

}  // namespace rayloc
