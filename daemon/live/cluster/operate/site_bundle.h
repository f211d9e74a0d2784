// SiteBundle: the files of a site as stored on the broker, so that every worker has
// the same ones. A bundle is identified by the hash of its content; the stream stores
// it in pieces, followed by the entry of its site, which names the valid bundle. So no
// worker reads half of one, and a bundle that is stored already is not stored again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/live/cluster/broker.h"

namespace rayloc {

inline constexpr std::string_view kBundleStream = "BUNDLES";

struct SiteBundle {
  std::map<std::string, std::string> files;  // by path, relative to the site's folder

  std::string hash() const;  // 64 hexadecimal digits (BLAKE2b)
};

// Reads the files that raylocd uses: all but recordings, tables and reports. An
// Error where the folder has links, or more data than a broker should store.
Expected<SiteBundle> read_bundle(const std::filesystem::path& folder);
// Writes into a new folder. An Error where a path of the bundle leads out of it.
Expected<void> write_bundle(const SiteBundle& bundle, const std::filesystem::path& folder);

// Makes this the valid bundle of a site; its predecessor is
// deleted. `replicas`: of the stream, where it is created.
Expected<void> store_bundle(Broker& broker,
                            const std::string& site,
                            const SiteBundle& bundle,
                            int replicas);
// Invalidates the bundle of the site; workers that fetch it receive that state.
Expected<void> retract_bundle(Broker& broker, const std::string& site);
// Returns the hashes of the valid bundles, by site;
// empty: retracted. No entries where none was stored.
Expected<std::map<std::string, std::string>> stored_bundles(Broker& broker);
// An Error where it is incomplete, or has been replaced meanwhile.
Expected<SiteBundle> fetch_bundle(Broker& broker, const std::string& site, const std::string& hash);
// Subject of the notices that a site has another bundle.
std::string bundle_notices();

}  // namespace rayloc
