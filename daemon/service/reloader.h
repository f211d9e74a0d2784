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

#include "daemon/config/config.h"
#include "daemon/service/input_files.h"

namespace rayloc {

class Reloader {
 public:
  // `setup`: what the daemon is started with; what its files hold now is taken for what it reads.
  explicit Reloader(const DaemonSetup& setup)
      : file_(setup.config.file), values_(setup.values), inputs_(InputFiles::of(setup)) {}

  struct Reload {
    DaemonConfig config;    // as the files are now
    ConfigChanges changes;  // since the start or the last reload; `config` may be applied as far
                            // as `changes.applicable` goes
  };
  // An Error: what is wrong, by file:line:column; nothing is to be changed.
  Expected<Reload> reload();
  // What holds now.
  const ConfigValues& values() const { return values_; }

 private:
  std::filesystem::path file_;
  ConfigValues values_;
  InputFiles inputs_;
};

}  // namespace rayloc
