// Reloader: reads the configuration again (SIGHUP) and reports the applicable changes.
//
// Everything is validated first, the site and its access points included; after any error nothing
// changes. Keys that a reload applies are marked in config_schema.cpp; changes of others, and of
// the files that are read at the start (input_files.h), are named and require a restart, and are
// named again at each reload until then. Thread safety: one thread.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "daemon/live/config/config.h"
#include "daemon/live/service/site/input_files.h"

namespace rayloc {

class Reloader {
 public:
  // `setup`: the setup at the start; the present content of its files is the reference.
  explicit Reloader(const DaemonSetup& setup)
      : file_(setup.config.file), values_(setup.values), inputs_(InputFiles::of(setup)) {}

  struct Reload {
    DaemonConfig config;           // current content of the files, as far as a reload applies it
    std::vector<SiteSetup> sites;  // the same
    ConfigChanges changes;         // since the start or the last reload
  };
  // An Error: description of the fault, by file:line:column; no change is made.
  // Errors in files of a site of [[site]] are reported for that site only.
  Expected<Reload> reload(const RunningSetup& running);
  // Current values.
  const ConfigValues& values() const { return values_; }

 private:
  std::filesystem::path file_;
  ConfigValues values_;
  InputFiles inputs_;
};

}  // namespace rayloc
