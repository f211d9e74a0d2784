// ReplicaWatch: asks the servers regularly for the state of the replicas of all streams, so that an
// alert reports a replica that is offline or behind before a second server fails.
//
// Thread safety: start() and finish() from one thread, the rest from any.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "daemon/live/cluster/broker.h"
#include "daemon/pipeline/stage_progress.h"
#include "engine/base/timestamp.h"

namespace rayloc {

class ReplicaWatch {
 public:
  // `every`: interval between requests.
  explicit ReplicaWatch(std::shared_ptr<Broker> broker, Duration every = std::chrono::seconds(30))
      : broker_(std::move(broker)), every_(every) {}
  ~ReplicaWatch() { finish(); }
  ReplicaWatch(const ReplicaWatch&) = delete;
  ReplicaWatch& operator=(const ReplicaWatch&) = delete;

  void start();
  // Waits for a request without an answer, some seconds at most.
  void finish();

  // By stream, the number of its replicas that are offline or behind, and one more without a
  // leader. Nothing if the last request was not answered.
  std::optional<std::map<std::string, std::size_t>> faults() const;
  const StageProgress& progress() const { return progress_; }

 private:
  void run();

  const std::shared_ptr<Broker> broker_;
  const Duration every_;
  StageProgress progress_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<std::map<std::string, std::size_t>> faults_;  // guarded by mutex_
  bool finishing_ = false;                                    // guarded by mutex_
  std::thread thread_;
};

}  // namespace rayloc
