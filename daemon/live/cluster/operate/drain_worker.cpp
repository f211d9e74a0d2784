#include "daemon/live/cluster/operate/drain_worker.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/sealed_message.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {
namespace {

constexpr std::chrono::milliseconds kDrainStep{100};
constexpr std::chrono::milliseconds kDrainPatience{60000};  // longest lease

Expected<void> request_drain(Broker& broker, const std::string& worker) {
  std::atomic<bool> has_left{false};
  const auto states = broker.subscribe(worker_subject(worker), [&](const BrokerMessage& message) {
    v1::WorkerState state;
    has_left =
        has_left || (unseal(message.data, state) && state.leaving() && state.sites().empty());
  });
  RAYLOC_TRY(states);
  v1::DrainRequest request;
  request.set_worker(worker);
  const std::string bytes = seal(request);
  const auto deadline = std::chrono::steady_clock::now() + kDrainPatience;
  while (!has_left) {
    RAYLOC_TRY(broker.publish(drain_subject(worker), bytes));
    std::this_thread::sleep_for(kDrainStep);
    if (std::chrono::steady_clock::now() > deadline) {
      return make_error(ErrorKind::kUnavailable, "worker '" + worker + "' keeps its sites");
    }
  }
  return {};
}

}  // namespace

Expected<void> drain_worker(Broker& broker, const std::string& worker) {
  const auto view = inspect_cluster(broker);
  RAYLOC_TRY(view);
  if (view->workers.count(worker) == 0) {
    return make_error(
        ErrorKind::kUnavailable,
        "worker '" + worker + "' does not report; `rayloc cluster status` lists the workers");
  }
  return request_drain(broker, worker);
}

}  // namespace rayloc
