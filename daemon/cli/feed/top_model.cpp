#include "daemon/cli/feed/top_model.h"

#include <algorithm>

#include "daemon/messages/proto_time.h"
#include "daemon/messages/topic.h"

namespace rayloc::cli {
namespace {

constexpr Duration kFilteredFor = std::chrono::seconds(5);

const v1::SourceReport* source_of(const v1::Heartbeat& heartbeat, const std::string& access_point) {
  for (const v1::SourceReport& source : heartbeat.sources()) {
    if (source.access_point() == access_point) {
      return &source;
    }
  }
  return nullptr;
}

}  // namespace

void TopModel::add(const std::string& topic,
                   const v1::Envelope& envelope,
                   Clock::time_point now,
                   bool from_snapshot) {
  if (envelope.epoch() != epoch_) {  // another start: tracks, zones and counters are new
    epoch_ = envelope.epoch();
    targets_.clear();
    zones_.clear();
    sources_.clear();
    heartbeat_.reset();
    previous_.reset();
    goodbye_.reset();
    newest_sent_ = {};
  }
  (void)gaps_.add(topic, envelope);
  if (const Timestamp sent = from_proto(envelope.sent()); sent >= newest_sent_) {
    newest_sent_ = sent;
    newest_came_ = now;
  }
  switch (envelope.body_case()) {
    case v1::Envelope::kLocation:
      add_location(envelope, now, from_snapshot);
      break;
    case v1::Envelope::kZone:
      zones_[envelope.zone().zone()] = envelope.zone();
      break;
    case v1::Envelope::kSource:
      sources_[envelope.source().access_point()] = envelope.source();
      break;
    case v1::Envelope::kHeartbeat:
      add_heartbeat(envelope.heartbeat(), now);
      break;
    case v1::Envelope::kGoodbye:
      goodbye_ = envelope.goodbye();
      break;
    default:
      break;
  }
  forget_old(now);
}

void TopModel::add_location(const v1::Envelope& envelope,
                            Clock::time_point now,
                            bool from_snapshot) {
  const v1::Location& location = envelope.location();
  Target& target = targets_[target_component(location.target())];
  target.received = now;
  const bool is_filtered = location.kind() == v1::LOCATION_KIND_FILTERED;
  std::optional<Stream>& stream = is_filtered ? target.filtered : target.snapshot;
  if (!stream) {
    stream.emplace();
  }
  stream->last = location;
  stream->sent = from_proto(envelope.sent());
  if (!from_snapshot) {
    stream->came.push_back(now);
  }
  while (!stream->came.empty() && now - stream->came.front() > kRateWindow) {
    stream->came.pop_front();
  }
}

void TopModel::add_heartbeat(const v1::Heartbeat& heartbeat, Clock::time_point now) {
  previous_ = std::move(heartbeat_);
  heartbeat_ = heartbeat;
  heartbeat_came_ = now;
  ++heartbeats_;
}

void TopModel::forget_old(Clock::time_point now) {
  std::erase_if(targets_,
                [&](const auto& target) { return now - target.second.received > kForgetAfter; });
  while (targets_.size() > kMaxTargets) {
    targets_.erase(
        std::min_element(targets_.begin(), targets_.end(), [](const auto& a, const auto& b) {
          return a.second.received < b.second.received;
        }));
  }
}

const TopModel::Stream& TopModel::shown(const Target& target) {
  const bool is_filtered =
      target.filtered &&
      (!target.snapshot || target.snapshot->sent - target.filtered->sent < kFilteredFor);
  return is_filtered ? *target.filtered : *target.snapshot;
}

std::vector<std::string> TopModel::zones_of(const std::string& component) const {
  std::vector<std::string> names;
  for (const auto& [name, event] : zones_) {
    const auto& inside = event.inside();
    if (std::any_of(inside.begin(), inside.end(), [&](const v1::Target& target) {
          return target_component(target) == component;
        })) {
      names.push_back(name);
    }
  }
  return names;
}

Timestamp TopModel::daemon_time(Clock::time_point now) const {
  return newest_sent_ + std::chrono::duration_cast<Duration>(now - newest_came_);
}

std::optional<TopModel::Clock::duration> TopModel::silence(Clock::time_point now) const {
  return heartbeat_ ? std::optional(now - heartbeat_came_) : std::nullopt;
}

double TopModel::rate(const Stream& stream, Clock::time_point now) {
  const auto recent = std::count_if(stream.came.begin(), stream.came.end(), [&](const auto& came) {
    return now - came <= kRateWindow;
  });
  return static_cast<double>(recent) / std::chrono::duration<double>(kRateWindow).count();
}

std::optional<double> TopModel::datagram_rate(const std::string& access_point) const {
  if (!heartbeat_ || !previous_) {
    return std::nullopt;
  }
  const v1::SourceReport* now = source_of(*heartbeat_, access_point);
  const v1::SourceReport* before = source_of(*previous_, access_point);
  const double elapsed = to_seconds(from_proto(heartbeat_->time()) - from_proto(previous_->time()));
  if (now == nullptr || before == nullptr || !(elapsed > 0.0)) {
    return std::nullopt;
  }
  if (now->counters().received() < before->counters().received()) {
    return std::nullopt;  // the site was prepared anew
  }
  const std::uint64_t received = now->counters().received() - before->counters().received();
  return static_cast<double>(received) / elapsed;
}

}  // namespace rayloc::cli
