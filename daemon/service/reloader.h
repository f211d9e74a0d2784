// Reloader: reads the configuration again (SIGHUP) and says what of it can be applied.
//
// Everything is validated first, the site and its access points included; when anything is wrong
// nothing changes. Keys that a reload applies are marked in config_schema.cpp; changes of others,
// and of the files that are read at the start (input_files.h), are named and wait for a restart,
// and are named again at each reload until then. Thread safety: one thread.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "daemon/config/config.h"
#include "daemon/service/input_files.h"

namespace rayloc {

class Reloader {
 public:
  // `setup`: what the daemon is started with; what its files hold now is taken for what it reads.
  explicit Reloader(const DaemonSetup& setup)
      : file_(setup.config.file), values_(setup.values), inputs_(InputFiles::of(setup)) {}

  struct Reload {
    DaemonConfig config;           // as the files are now, as far as a reload applies them
    std::vector<SiteSetup> sites;  // the same
    ConfigChanges changes;         // since the start or the last reload
  };
  // An Error: what is wrong, by file:line:column; nothing is to be changed.
  // Files of a site of [[site]] that are wrong are its own trouble.
  Expected<Reload> reload(const RunningSetup& running);
  // What holds now.
  const ConfigValues& values() const { return values_; }

 private:
  std::filesystem::path file_;
  ConfigValues values_;
  InputFiles inputs_;
};

}  // namespace rayloc
