#include "daemon/live/cluster/gateway_role.h"

#include <pthread.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/sealed_message.h"

namespace rayloc {
namespace {

constexpr std::chrono::milliseconds kGatewayRound{100};

}  // namespace

bool OutputOrder::is_next(const v1::OutputRecord& record) {
  if (record.generation() < generation_ ||
      (record.generation() == generation_ && record.number() <= number_)) {
    return false;
  }
  generation_ = record.generation();
  number_ = record.number();
  return true;
}

Expected<std::unique_ptr<GatewayRole>> GatewayRole::open(std::shared_ptr<Broker> broker,
                                                         StreamOptions stream) {
  return std::unique_ptr<GatewayRole>(new GatewayRole(std::move(broker), std::move(stream)));
}

GatewayRole::~GatewayRole() { finish(); }

void GatewayRole::add(const std::string& site, Deliver deliver) {
  const std::lock_guard lock(mutex_);
  sites_[output_subject(site)] = {std::move(deliver), {}, 0};
}

void GatewayRole::remove(const std::string& site) {
  const std::lock_guard lock(mutex_);
  sites_.erase(output_subject(site));
}

void GatewayRole::start() {
  thread_ = std::thread([this] { run(); });
}

void GatewayRole::finish() {
  ending_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
}

void GatewayRole::run() {
  pthread_setname_np(pthread_self(), "gateway");  // for top -H
  while (!ending_) {
    progress_.beat();
    if (!reader_ && !open_reader()) {
      progress_.rest();
      std::this_thread::sleep_for(kGatewayRound);
      continue;
    }
    const auto message = reader_->next(kGatewayRound);
    if (message) {
      take(*message);
    }
    const std::lock_guard lock(mutex_);
    counters_.lost = reader_->counters().lost;
  }
  progress_.rest();
}

// Reads from the oldest of the last records of all sites on.
bool GatewayRole::open_reader() {
  if (!broker_->connected() || !broker_->ensure_stream(stream_)) {
    return false;
  }
  std::vector<std::string> subjects;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [subject, site] : sites_) {
      subjects.push_back(subject);
    }
  }
  const Expected<StreamState> state = broker_->stream_state(stream_.name);
  if (!state) {
    return false;
  }
  std::uint64_t first = state->last + 1;
  for (const std::string& subject : subjects) {
    const auto last = broker_->last_of(stream_.name, subject);
    if (!last) {
      return false;
    }
    if (*last) {
      first = std::min(first, (*last)->sequence);
      const std::lock_guard lock(mutex_);
      if (const auto site = sites_.find(subject); site != sites_.end()) {
        site->second.from = (*last)->sequence;
      }
    }
  }
  StreamReader::Options options;
  options.stream = stream_.name;
  options.again = stream_.republish_to;
  options.after = {state->created, first - 1};
  auto reader = StreamReader::open(broker_, std::move(options));
  if (!reader) {
    return false;
  }
  reader_ = std::move(*reader);
  begun_ = state->created;
  return true;
}

void GatewayRole::take(const BrokerMessage& message) {
  v1::OutputRecord record;
  const bool is_record = unseal(message.data, record).has_value();
  const bool is_first_stream = reader_->place().created == begun_;
  const std::lock_guard lock(mutex_);
  const auto site = sites_.find(message.subject);
  if (site == sites_.end()) {
    return;
  }
  if (is_first_stream && message.sequence <= site->second.from) {
    if (is_record) {
      (void)site->second.order.is_next(record);  // sets the order for its successors
    }
    return;
  }
  if (!is_record || !site->second.order.is_next(record)) {
    ++counters_.passed_over;
    return;
  }
  ++counters_.records;
  for (v1::OutputItem& item : *record.mutable_output()->mutable_items()) {
    ++counters_.items;
    site->second.deliver(std::move(item));
  }
}

GatewayRole::Counters GatewayRole::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace rayloc
