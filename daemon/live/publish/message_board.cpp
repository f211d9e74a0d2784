#include "daemon/live/publish/message_board.h"

#include <utility>

#include "rayloc/v1/envelope.pb.h"

namespace rayloc {
namespace {

constexpr std::uint64_t kEventsKept = 32;  // for each topic of events

std::string subject_of(const std::string& topic, const v1::Envelope& envelope) {
  if (envelope.has_location()) {
    return topic + std::to_string(envelope.location().kind());
  }
  if (envelope.has_compared()) {
    return topic + std::to_string(envelope.compared().kind());
  }
  if (envelope.has_track() || envelope.has_zone()) {
    return topic + std::to_string(envelope.sequence() % kEventsKept);
  }
  return topic;
}

}  // namespace

void MessageBoard::put(const std::string& topic, const v1::Envelope& envelope, std::string bytes) {
  if (envelope.has_csi()) {
    return;
  }
  std::string subject = subject_of(topic, envelope);
  auto shared = std::make_shared<const std::string>(std::move(bytes));
  const std::lock_guard lock(mutex_);
  presence_.add(envelope);
  ++revision_;
  const auto [of_subject, is_new] = of_subject_.try_emplace(subject, revision_);
  if (!is_new) {
    entries_.erase(of_subject->second);
    of_subject->second = revision_;
  }
  entries_.emplace(revision_, Entry{std::move(subject), std::move(shared)});
  if (entries_.size() > max_subjects_) {
    of_subject_.erase(entries_.begin()->second.subject);
    entries_.erase(entries_.begin());
  }
}

std::vector<MessageBoard::Message> MessageBoard::after(std::uint64_t revision,
                                                       std::size_t limit) const {
  std::vector<Message> messages;
  const std::lock_guard lock(mutex_);
  for (auto entry = entries_.upper_bound(revision);
       entry != entries_.end() && messages.size() < limit;
       ++entry) {
    messages.push_back({entry->first, entry->second.envelope});
  }
  return messages;
}

MessageBoard::PresenceNow MessageBoard::presence(Timestamp now) const {
  const std::lock_guard lock(mutex_);
  return {presence_.cells(now), presence_.kept(), presence_.left_out()};
}

std::uint64_t MessageBoard::revision() const {
  const std::lock_guard lock(mutex_);
  return revision_;
}

}  // namespace rayloc
