// The part of Service that starts its threads and names them.
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "daemon/service/service.h"

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

}  // namespace rayloc
