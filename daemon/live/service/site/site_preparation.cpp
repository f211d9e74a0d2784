#include "daemon/live/service/site/site_preparation.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <string>
#include <thread>
#include <utility>

#include "engine/base/parallel.h"

namespace rayloc {

struct SitePreparation::Work {
  std::vector<SiteSetup> setups;
  SiteRuntime::Surroundings surroundings;
  std::vector<Prepared> prepared;
  std::atomic<bool> done = false;
};

namespace {

// Returns its own error, which affects no other site. The running sites keep half of the threads
// for themselves meanwhile.
Expected<std::unique_ptr<SiteRuntime>> prepare(SiteSetup setup,
                                               const SiteRuntime::Surroundings& surroundings) {
  try {
    const std::size_t threads = std::max<std::size_t>(1, concurrency() / 2);
    return tbb::task_arena(static_cast<int>(threads)).execute([&] {
      return SiteRuntime::prepare(std::move(setup), surroundings);
    });
  } catch (const std::exception& error) {  // out of memory
    return make_error(ErrorKind::kUnavailable, error.what());
  }
}

}  // namespace

// Tracing cannot be interrupted: the end of the daemon does not wait for it.
SitePreparation::SitePreparation(std::vector<SiteSetup> setups,
                                 const SiteRuntime::Surroundings& surroundings)
    : work_(std::make_shared<Work>()) {
  work_->setups = std::move(setups);
  work_->surroundings = surroundings;
  std::thread([work = work_] {
    for (SiteSetup& setup : work->setups) {
      Prepared& one = work->prepared.emplace_back();
      one.name = setup.site.name;
      one.files = InputFiles::of(setup);
      auto runtime = prepare(std::move(setup), work->surroundings);
      if (runtime) {
        one.runtime = std::move(*runtime);
      } else {
        one.trouble = runtime.error().message;
      }
    }
    work->done = true;
  }).detach();
}

bool SitePreparation::done() const { return work_->done; }

std::vector<SitePreparation::Prepared> SitePreparation::take() {
  return std::move(work_->prepared);
}

}  // namespace rayloc
