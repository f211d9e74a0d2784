#include "daemon/live/cluster/capture_role.h"

#include <cstdint>
#include <utility>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/sealed_message.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

StreamOptions site_stream(const std::string& site, StreamOptions options) {
  options.name = csi_stream(site);
  options.subjects = csi_subjects(site);
  options.republish_to = live_subjects(site);
  return options;
}

StreamOptions fill_stream(StreamOptions options) {
  constexpr std::chrono::hours kDays{72};  // chosen: a weekend, and time for maintenance
  constexpr std::int64_t kMaxBytes = std::int64_t{4} << 30U;  // chosen: the disk has other uses
  options.name = kFillStream;
  options.subjects = kFillSubjects;
  options.republish_to.clear();
  options.in_memory = false;
  options.max_age = kDays;
  options.max_messages_per_subject = 0;
  options.max_bytes = kMaxBytes;
  return options;
}

StreamOptions output_stream(StreamOptions options) {
  options.name = kOutputStream;
  options.subjects = kOutputSubjects;
  options.republish_to = kOutputAgain;
  return options;
}

Expected<std::unique_ptr<CaptureRole>> CaptureRole::open(std::shared_ptr<Broker> broker,
                                                         Options options) {
  std::unique_ptr<CaptureRole> role(new CaptureRole(std::move(broker), std::move(options)));
  auto requests = role->broker_->subscribe(
      resend_subject(role->options_.node),
      [self = role.get()](const BrokerMessage& m) { self->take_request(m); });
  RAYLOC_TRY(requests);
  role->requests_ = std::move(*requests);
  return role;
}

Expected<std::shared_ptr<BatchSender>> CaptureRole::add_site(const std::string& site) {
  BatchSender::Options options = options_.sender;
  options.site = site;
  options.node = options_.node;
  options.stream = site_stream(site, options.stream);
  auto output = broker_->subscribe(
      output_again_subject(site),
      [this, site](const BrokerMessage& message) { take_output(site, message); });
  RAYLOC_TRY(output);
  std::unique_lock lock(mutex_);
  options.epoch = options_.epoch + starts_++;
  auto sender = std::make_shared<BatchSender>(broker_, std::move(options));
  const auto before = std::exchange(senders_[site], sender);
  std::swap(outputs_[site], *output);
  lock.unlock();  // a subscription ends once its handler is idle, which may wait for the lock
  return sender;
}

void CaptureRole::remove_site(const std::string& site) {
  std::unique_ptr<Broker::Subscription> output;  // ends when the lock is released
  const std::lock_guard lock(mutex_);
  senders_.erase(site);
  std::swap(outputs_[site], output);
  outputs_.erase(site);
}

std::shared_ptr<BatchSender> CaptureRole::sender_of(const std::string& site) const {
  const std::lock_guard lock(mutex_);
  const auto found = senders_.find(site);
  return found == senders_.end() ? nullptr : found->second;
}

// Any client may publish there: unreadable requests are ignored.
void CaptureRole::take_request(const BrokerMessage& message) {
  v1::ResendRequest request;
  if (!unseal(message.data, request)) {
    return;
  }
  if (const auto sender = sender_of(request.site())) {
    sender->ask(request.epoch(), request.from_number(), request.to_number());
  }
}

void CaptureRole::take_output(const std::string& site, const BrokerMessage& message) {
  v1::OutputRecord record;
  if (!unseal(message.data, record) || !record.has_output()) {
    return;
  }
  const auto sender = sender_of(site);
  for (const v1::NodePosition& node : record.output().resume().nodes()) {
    if (sender && node.node() == options_.node) {
      sender->consumed(node.epoch(), node.number());
    }
  }
}

}  // namespace rayloc
