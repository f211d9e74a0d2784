// Reloader: reads the configuration again (SIGHUP) and says what of it can be applied.
//
// Everything is validated first, the site and its access points included; when anything is wrong
// nothing changes. Keys that a reload applies are marked in config_schema.cpp; changes of others
// are named and wait for a restart, and are named again at each reload until then. Thread safety:
// one thread.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "daemon/service/config.h"

namespace rayloc {

class Reloader {
 public:
  // `values`: what the daemon was started with.
  Reloader(std::filesystem::path file, ConfigValues values)
      : file_(std::move(file)), values_(std::move(values)) {}

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
};

}  // namespace rayloc
