// BundleNotices: waits for notices that a site has another bundle.
//
// Thread safety: one thread; notices arrive on a thread of the broker.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>

#include "daemon/live/cluster/broker.h"
#include "engine/base/expected.h"

namespace rayloc {

class BundleNotices {
 public:
  // An Error where the broker refuses the subscription.
  static Expected<std::unique_ptr<BundleNotices>> subscribe(Broker& broker);

  // Returns after a notice that came since the last call, or 10 s later, since notices may be lost.
  // `is_stopped` is called every 0.2 s; true ends the wait.
  void wait(const std::function<bool()>& is_stopped);

 private:
  BundleNotices() = default;

  std::mutex mutex_;
  std::condition_variable wake_;
  bool is_notified_ = false;                            // guarded by mutex_
  std::unique_ptr<Broker::Subscription> subscription_;  // ends before the members that it uses
};

}  // namespace rayloc
