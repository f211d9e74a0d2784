// SitePreparation: the rooms of sites that a reload begins or changes, prepared on a thread of its
// own while the others go on. Thread safety: one thread.
#pragma once

#include <memory>
#include <vector>

#include "daemon/service/input_files.h"
#include "daemon/service/site_runtime.h"

namespace rayloc {

class SitePreparation {
 public:
  struct Prepared {
    std::string name;
    InputFiles files;
    std::unique_ptr<SiteRuntime> runtime;  // null: `trouble` says why
    std::string trouble;
  };

  SitePreparation(std::vector<SiteSetup> setups, const SiteRuntime::Surroundings& surroundings);

  bool done() const;
  // All of them, in their order. REQUIRES: it is done.
  std::vector<Prepared> take();

 private:
  struct Work;
  std::shared_ptr<Work> work_;  // a thread that still traces has its own part in it
};

}  // namespace rayloc
