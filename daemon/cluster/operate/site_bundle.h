// SiteBundle: the files of a site as the broker keeps them, so that every worker has the same ones.
// A bundle is known by the hash of all of it; in the stream it stands in pieces, behind which its
// site's entry names the one that holds. So nobody reads half of one, and one that was stored
// before is not stored again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/cluster/broker.h"

namespace rayloc {

inline constexpr std::string_view kBundleStream = "BUNDLES";

struct SiteBundle {
  std::map<std::string, std::string> files;  // by path, relative to the site's folder

  std::string hash() const;  // 64 hexadecimal digits (BLAKE2b)
};

// What raylocd reads of a site: all but recordings, tables and reports. An Error where the folder
// has links, or more than a broker should keep.
Expected<SiteBundle> read_bundle(const std::filesystem::path& folder);
// Into a folder that is made. An Error where a path of the bundle leads out of it.
Expected<void> write_bundle(const SiteBundle& bundle, const std::filesystem::path& folder);

// The bundle that holds for a site from now on; the one before it is forgotten. `replicas`: of the
// stream, where it is made.
Expected<void> store_bundle(Broker& broker,
                            const std::string& site,
                            const SiteBundle& bundle,
                            int replicas);
// No bundle holds for the site from now on, which whoever fetches is told.
Expected<void> retract_bundle(Broker& broker, const std::string& site);
// The hashes of those that hold, by site; empty: it was retracted. None where nobody has stored
// any.
Expected<std::map<std::string, std::string>> stored_bundles(Broker& broker);
// An Error where it is not whole, or is another by now.
Expected<SiteBundle> fetch_bundle(Broker& broker, const std::string& site, const std::string& hash);
// Told again when a site has another bundle.
std::string bundle_news();

}  // namespace rayloc
