// SharedThreads: the threads that all sites of one process share, so that their number depends on
// the processor cores and not on the sites (SHARED.md).
#pragma once

#include <algorithm>
#include <cstddef>

#include "daemon/pipeline/record/recorder_stage.h"
#include "daemon/pipeline/shared/receiver_pool.h"
#include "daemon/pipeline/shared/worker_pool.h"
#include "engine/base/parallel.h"

namespace rayloc {

struct SharedThreads {
  // Threads of estimation. At least two: one long turn does not keep all other sites waiting.
  static std::size_t default_workers() { return std::max<std::size_t>(2, concurrency()); }

  explicit SharedThreads(std::size_t receiver_threads = concurrency(),
                         std::size_t workers = default_workers())
      : receivers({.most_threads = receiver_threads}),
        recorders({receiver_threads, RecorderStage::kWriteInterval, "recorder"}),
        estimations(workers) {}

  // Threads for so many sources and sites, at most; for sources, those of either pool.
  static std::size_t receivers_for(std::size_t sources) { return std::min(sources, concurrency()); }
  static std::size_t workers_for(std::size_t sites) { return std::min(sites, default_workers()); }

  ReceiverPool receivers;
  ReceiverPool recorders;
  WorkerPool estimations;
};

}  // namespace rayloc
