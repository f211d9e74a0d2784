// The part of Process that starts and stops its threads.
#include <algorithm>
#include <chrono>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "daemon/live/config/source_url.h"
#include "daemon/live/machine/start_resources.h"
#include "daemon/live/service/process.h"
#include "daemon/pipeline/shared/shared_threads.h"

namespace rayloc {
namespace {

constexpr auto kStartPoll = std::chrono::milliseconds(1);

void wait_until_started(const std::vector<Stage>& stages) {
  for (const Stage& stage : stages) {
    while (!stage.progress->started()) {
      std::this_thread::sleep_for(kStartPoll);
    }
  }
}

bool has_runtime_of(const std::vector<SiteSet::Site>& sites, const SiteSet::Site& site) {
  return std::any_of(sites.begin(), sites.end(), [&](const SiteSet::Site& one) {
    return one->runtime == site->runtime;
  });
}

}  // namespace

// To be called before any object is opened that needs the threads and descriptors, and before the
// room is prepared, which uses many threads.
Expected<void> Process::check_resources(bool estimators_ready) const {
  const auto& all = setup_.config.sources;
  const std::size_t sources = all.size();
  const bool is_worker = setup_.config.cluster.role == ClusterRole::kWorker;
  // Recordings have a thread each; live sources, and access points in a stream of a cluster, share
  // some.
  const std::size_t live =
      is_worker ? sources
                : static_cast<std::size_t>(std::count_if(all.begin(), all.end(), is_live));
  const std::size_t receivers = SharedThreads::receivers_for(live);
  const std::size_t readers = receivers + (sources - live);
  const std::size_t estimations = SharedThreads::workers_for(setup_.sites.size());
  const std::size_t recorders = SharedThreads::receivers_for(sources);
  // Three of libzmq; guard, snapshot server, publisher, HTTP, channel, ring, one that stops them.
  constexpr std::size_t kThreads = 11;
  constexpr std::size_t kMaxTracing = 8;
  const std::size_t tracing =
      estimators_ready ? 0
                       : std::min<std::size_t>(std::thread::hardware_concurrency(), kMaxTracing);
  // Some 20 of libzmq, two of HTTP; the others are for clients. Each shared thread that reads or
  // records has one with which others wake it.
  constexpr std::size_t kDescriptors = 48;
  std::size_t compared = 0;
  for (const SiteSetup& site : setup_.sites) {
    compared += site.config.engine.compared.size();
  }
  // A worker has two for each site, which wait for the broker: its stream, and its results.
  const std::size_t streams = is_worker ? 2 * setup_.sites.size() : 0;
  return check_start_resources(
      kThreads + tracing + readers + recorders + estimations + compared + streams,
      kDescriptors + 4 * sources + receivers + recorders);
}

// At any stage of a start, every thread ends before the objects that it uses. The publisher's
// thread uses the pipeline, and the pipeline's threads write to the publisher.
Process::~Process() {
  if (http_) {
    http_->stop();
  }
  for (const auto& [name, site] : along_) {
    site->runtime->end();
  }
  for (const SiteSet::Site& site : sites_.all()) {
    site->runtime->end();
  }
  if (publisher_) {
    publisher_->halt();
  }
}

void Process::start() {
  publisher_->start();
  for (const SiteSet::Site& site : sites_.all()) {
    site->runtime->start();
  }
  if (claims_) {
    claims_->start();
  }
  if (gateway_) {
    gateway_->start();
    replicas_->start();
  }
  wait_until_started(working_stages());
  if (http_) {  // its handlers use running stages
    http_->start();
  }
  wait_until_started(stages());
}

std::vector<Stage> Process::stages() const {
  std::vector<Stage> stages = working_stages();
  if (http_) {
    stages.push_back({"http", &http_progress_});
  }
  return stages;
}

std::vector<SiteSet::Site> Process::running_sites() const {
  std::vector<SiteSet::Site> sites = sites_.all();
  sites.reserve(sites.size() + along_.size());
  for (const auto& [name, site] : along_) {
    sites.push_back(site);
  }
  return sites;
}

std::vector<Stage> Process::working_stages() const {
  std::vector<Stage> stages;
  const std::vector<SiteSet::Site> sites = running_sites();
  for (const SiteSet::Site& site : sites) {
    const std::vector<Stage> some = site->runtime->stages();
    stages.insert(stages.end(), some.begin(), some.end());
  }
  for (const Ending& abandoned : abandoned_) {
    if (has_runtime_of(sites, abandoned.site)) {
      continue;  // its successor could not start
    }
    const std::vector<Stage> some = abandoned.site->runtime->stages();
    // It still holds a thread that sites share. One of its own stops no other site.
    std::copy_if(some.begin(), some.end(), std::back_inserter(stages), [](const Stage& stage) {
      return stage.has_shared_thread;
    });
  }
  if (claims_) {
    stages.push_back({"claims", &claims_->progress()});
    stages.push_back({"alive", &claims_->sending()});
  }
  if (gateway_) {
    stages.push_back({"gateway", &gateway_->progress()});
    stages.push_back({"replicas", &replicas_->progress()});
  }
  stages.push_back({"publisher", &publisher_->progress()});
  stages.push_back({"connection guard", &guard_progress_});
  stages.push_back({"snapshot server", &snapshots_progress_});
  return stages;
}

std::vector<std::string> Process::stop(const std::string& reason,
                                       std::chrono::milliseconds patience) {
  // Three quarters to drain; the rest is for stages that do not return, and for later steps.
  const Shutdown::Time begin = std::chrono::steady_clock::now();
  const auto at = [&](int percent) { return begin + percent * patience / 100; };
  Shutdown shutdown;
  if (http_) {
    shutdown.run("http", at(10), [this] { http_->stop(); });
  }
  if (claims_) {
    claims_->leave();
  }
  std::vector<SiteSet::Site> sites = running_sites();
  std::erase_if(sites, [&](const SiteSet::Site& site) {  // that one is still being waited for
    return std::any_of(abandoned_.begin(), abandoned_.end(), [&](const Ending& one) {
      return one.site->runtime == site->runtime;
    });
  });
  // In parallel: each site drains independently.
  std::vector<Ending> endings = end_in_parallel(sites, {at(75), at(94), at(97)});
  if (gateway_) {
    shutdown.begin("replicas", [this] { replicas_->finish(); });
    shutdown.run("gateway", at(97), [this] { gateway_->finish(); });
    shutdown.wait_for("replicas", at(97));
  }
  if (claims_) {
    shutdown.run("claims", at(98), [this] { claims_->finish(); });
  }
  shutdown.run("publisher", at(100), [this, reason] { publisher_->finish(reason); });
  log_losses();  // of the last instant
  limited_log_->finish();
  std::vector<std::string> hung = shutdown.hung();
  const auto add_stuck = [&](Ending& ending) {
    const std::vector<std::string> stuck = stuck_stages(ending);
    hung.insert(hung.end(), stuck.begin(), stuck.end());
  };
  std::for_each(endings.begin(), endings.end(), add_stuck);
  std::for_each(abandoned_.begin(), abandoned_.end(), add_stuck);
  return hung;
}

}  // namespace rayloc
