// SiteFolder: the applied sites as subfolders of a folder that raylocd's configuration includes.
//
// The broker has the desired state (stored_bundles() in site_bundle.h). differences() compares the
// folder with it, and settle() removes one difference. A site that fails its check is refused, and
// the previous site stays in use. A subfolder is replaced as a whole.
//
// Thread safety: one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/operate/site_bundle.h"
#include "engine/base/expected.h"

namespace rayloc {

// Checks that raylocd would locate with the site in a folder; returns the good findings as text.
using CheckSite = std::function<Expected<std::string>(const std::filesystem::path& folder)>;

// Writes the bundle to an empty folder and checks it there, as a worker would.
Expected<std::string> check_bundle(const SiteBundle& bundle,
                                   const std::filesystem::path& folder,
                                   const CheckSite& check);

// True if the name can be written into a configuration without escapes.
bool is_plain_site_name(const std::string& name);

// A site whose desired bundle is not the one in the folder.
struct SiteDifference {
  std::string site;
  std::string hash;  // of the desired bundle; empty: the site was removed from the cluster
};

// Result of settling a difference.
struct SiteChange {
  enum class Kind : std::uint8_t {
    kNone,           // there was nothing to remove
    kReplaced,       // the folder has the desired bundle
    kRefused,        // the previous site stays
    kRemoved,        // the site is removed from the folder
    kRemovalFailed,  // a part of the site may be left
  };
  Kind kind = Kind::kNone;
  std::string reason = {};  // of a refusal or failure

  bool has_changed() const { return kind == Kind::kReplaced || kind == Kind::kRemoved; }
};

class SiteFolder {
 public:
  SiteFolder(std::filesystem::path folder, CheckSite check);

  // `stored`: hashes of the desired bundles by site, as stored_bundles() returns them. A bundle
  // that was refused is no difference any more; one that was unavailable (kUnavailable) still is.
  std::vector<SiteDifference> differences(const std::map<std::string, std::string>& stored) const;

  // Fetches and checks the desired bundle, or removes the site.
  SiteChange settle(Broker& broker, const SiteDifference& difference);

 private:
  std::filesystem::path path(const std::string& site, const char* end) const;
  std::filesystem::path hash_file(const std::string& site) const;
  SiteChange remove(const std::string& site) const;
  Expected<void> replace(Broker& broker, const std::string& site, const std::string& hash) const;

  std::filesystem::path folder_;
  CheckSite check_;
  std::map<std::string, std::string> refused_;  // hash by site
};

}  // namespace rayloc
