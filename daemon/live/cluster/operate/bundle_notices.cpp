#include "daemon/live/cluster/operate/bundle_notices.h"

#include <utility>

#include "daemon/live/cluster/operate/site_bundle.h"

namespace rayloc {
namespace {

constexpr std::chrono::seconds kRecheckInterval{10};
constexpr std::chrono::milliseconds kNoticeStep{200};

}  // namespace

Expected<std::unique_ptr<BundleNotices>> BundleNotices::subscribe(Broker& broker) {
  std::unique_ptr<BundleNotices> notices(new BundleNotices());
  auto subscription =
      broker.subscribe(bundle_notices(), [&target = *notices](const BrokerMessage&) {
        const std::lock_guard lock(target.mutex_);
        target.is_notified_ = true;
        target.wake_.notify_one();
      });
  RAYLOC_TRY(subscription);
  notices->subscription_ = std::move(*subscription);
  return notices;
}

void BundleNotices::wait(const std::function<bool()>& is_stopped) {
  std::unique_lock lock(mutex_);
  for (auto waited = kNoticeStep; !is_notified_ && waited < kRecheckInterval && !is_stopped();
       waited += kNoticeStep) {
    wake_.wait_for(lock, kNoticeStep);
  }
  is_notified_ = false;
}

}  // namespace rayloc
