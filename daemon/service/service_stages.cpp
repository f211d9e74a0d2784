// The part of Service that starts and stops its threads.
#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "daemon/machine/start_resources.h"
#include "daemon/service/service.h"
#include "daemon/service/shutdown.h"

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

}  // namespace

// Before anything is opened that would run on the threads and descriptors that there are not.
// Before the room is prepared, too, which many threads do together.
Expected<void> Service::check_resources(bool estimators_ready) const {
  const std::size_t sources = setup_.config.sources.size();
  // Of libzmq three; guard, snapshot server, publisher, estimation, HTTP, channel, ring, one that
  // stops them; of a source its own and a recorder's.
  constexpr std::size_t kThreads = 12;
  constexpr std::size_t kMostTracing = 8;
  const std::size_t tracing =
      estimators_ready ? 0
                       : std::min<std::size_t>(std::thread::hardware_concurrency(), kMostTracing);
  // Of libzmq some 20, of HTTP two; the others are for clients.
  constexpr std::size_t kDescriptors = 48;
  return check_start_resources(kThreads + tracing + 2 * sources, kDescriptors + 4 * sources);
}

// However far a start has come: every thread ends before anything that it looks at. The publisher's
// looks at the pipeline, and the pipeline's give to the publisher.
Service::~Service() {
  if (http_) {
    http_->stop();
  }
  if (pipeline_) {
    pipeline_->hurry();
    pipeline_->stop();
  }
  if (publisher_) {
    publisher_->halt();
  }
}

void Service::start() {
  publisher_->start();
  pipeline_->start();
  wait_until_started(working_stages());
  if (http_) {  // what it answers is of stages that run
    http_->start();
  }
  wait_until_started(stages());
}

std::vector<Stage> Service::stages() const {
  std::vector<Stage> stages = working_stages();
  if (http_) {
    stages.push_back({"http", &http_progress_});
  }
  return stages;
}

std::vector<Stage> Service::working_stages() const {
  std::vector<Stage> stages = pipeline_->stages();
  stages.push_back({"publisher", &publisher_->progress()});
  for (std::size_t i = 0; i < recorders_.size(); ++i) {
    stages.push_back(
        {"recorder " + setup_.config.sources[i].access_point, &recorders_[i]->progress()});
  }
  if (snapshots_of_rings_) {
    stages.push_back({"ring snapshots", &snapshots_of_rings_->progress()});
  }
  stages.push_back({"connection guard", &guard_progress_});
  stages.push_back({"snapshot server", &snapshots_progress_});
  return stages;
}

std::vector<std::string> Service::stop(const std::string& reason,
                                       std::chrono::milliseconds patience) {
  // Three quarters to drain; the rest is for what does not come back, and for what follows it.
  const Shutdown::Time begin = std::chrono::steady_clock::now();
  const auto at = [&](int percent) { return begin + percent * patience / 100; };
  Shutdown shutdown;
  if (http_) {
    shutdown.run("http", at(10), [this] { http_->stop(); });
  }
  if (!shutdown.run("pipeline", at(75), [this] { pipeline_->stop(); })) {
    pipeline_->hurry();
    shutdown.wait_for("pipeline", at(94));
  }
  for (std::size_t i = 0; i < recorders_.size(); ++i) {
    shutdown.run("recorder " + setup_.config.sources[i].access_point, at(97), [this, i] {
      recorders_[i]->finish();
    });
  }
  if (snapshots_of_rings_) {
    shutdown.run("ring snapshots", at(97), [this] { snapshots_of_rings_->finish(); });
  }
  shutdown.run("publisher", at(100), [this, reason] { publisher_->finish(reason); });
  log_losses();  // of the last instant
  limited_log_->finish();
  std::vector<std::string> hung = shutdown.hung();
  std::replace(hung.begin(), hung.end(), std::string("pipeline"), stuck_in_pipeline());
  return hung;
}

// Which threads of it have not ended: one that has rests, and so does an estimation that waits; but
// the sources whose frames it waits for have ended then.
std::string Service::stuck_in_pipeline() const {
  std::string names;
  for (const Stage& stage : pipeline_->stages()) {
    if (!stage.progress->resting()) {
      names += (names.empty() ? "" : ", ") + stage.name;
    }
  }
  return names.empty() ? "estimation" : names;
}

}  // namespace rayloc
