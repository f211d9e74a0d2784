// SitePreparation: prepares the rooms of sites that a reload starts or changes, on a separate
// thread while the others continue. Thread safety: one thread.
#pragma once

#include <memory>
#include <vector>

#include "daemon/live/service/site/input_files.h"
#include "daemon/live/service/site/site_runtime.h"

namespace rayloc {

class SitePreparation {
 public:
  struct Prepared {
    std::string name;
    InputFiles files;
    std::unique_ptr<SiteRuntime> runtime;  // null: `trouble` states the reason
    std::string trouble;
  };

  SitePreparation(std::vector<SiteSetup> setups, const SiteRuntime::Surroundings& surroundings);

  bool done() const;
  // All of them, in their order. REQUIRES: it is done.
  std::vector<Prepared> take();

 private:
  struct Work;
  std::shared_ptr<Work> work_;  // shared with a thread that may still trace
};

}  // namespace rayloc
