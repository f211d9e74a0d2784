// InputFiles: the contents of the files of a configuration at some instant: the site with its
// scene, calibration, reference and tables of antennas, and the secrets. The difference of two of
// them gives the files that have changed since, which a daemon reads at its start only.
//
// By hashes of the contents: a file rewritten unchanged is no change. Thread safety: a value.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "daemon/live/config/config.h"

namespace rayloc {

class InputFiles {
 public:
  // The files that a reload cannot read anew: secrets, and the site of [site].
  static InputFiles of(const DaemonSetup& setup);
  // The files of a site.
  static InputFiles of(const SiteSetup& setup);

  // The paths of files that were changed, added or removed; sorted.
  std::vector<std::string> changes_to(const InputFiles& newer) const;

 private:
  void add_site(const Site& site);
  void add(const std::filesystem::path& file);
  void add_scene(const Site& site);

  std::map<std::string, std::string> hash_;  // by path
};

}  // namespace rayloc
