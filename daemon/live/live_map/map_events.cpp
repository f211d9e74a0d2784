#include "daemon/live/live_map/map_events.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <google/protobuf/util/time_util.h>

#include "daemon/messages/json.h"
#include "daemon/messages/proto_time.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc {
namespace {

constexpr std::size_t kMessagesAtOnce = 256;  // maximum in one event; the rest follows in the next
constexpr std::size_t kJsonKept = 2048;       // messages

}  // namespace

EventBatch MapEvents::take(EventCursor& cursor) {
  const bool first = !cursor.begun;
  if (first) {
    cursor.begun = true;
    cursor.revision = revision_of(cursor.last_event_id);
    cursor.joined = board_->revision();
  }
  const std::uint64_t before = cursor.revision;
  const auto messages = board_->after(before, kMessagesAtOnce);
  if (messages.empty() && !first) {
    return {};
  }
  std::string list;
  std::uint64_t new_ones = 0;  // messages published since it joined: earlier ones were not missed
  for (const MessageBoard::Message& message : messages) {
    const std::string& json = json_of(message);
    if (!json.empty()) {
      list += (list.empty() ? "" : ",") + json;
    }
    new_ones += message.revision > cursor.joined ? 1U : 0U;
    cursor.revision = message.revision;
  }
  EventBatch batch;
  const std::uint64_t from = std::max(before, cursor.joined);
  batch.coalesced = cursor.revision > from ? cursor.revision - from - new_ones : 0;
  const std::string now = google::protobuf::util::TimeUtil::ToString(to_proto(now_()));
  batch.text = first ? "retry: 1000\nevent: snapshot\n" : "event: update\n";
  batch.text += "id: " + std::to_string(epoch_) + "-" + std::to_string(cursor.revision) +
                "\ndata: {\"now\":\"" + now + "\"";
  if (first) {
    batch.text += R"(,"epoch":")" + std::to_string(epoch_) + R"(","resumed":)" +
                  (before > 0 ? "true" : "false");
  }
  batch.text += R"(,"messages":[)" + list + "]}\n\n";
  return batch;
}

// 0 for an id of another start, of the future, or that was never sent.
std::uint64_t MapEvents::revision_of(const std::string& last_event_id) const {
  const std::string prefix = std::to_string(epoch_) + "-";
  std::uint64_t revision = 0;
  if (last_event_id.rfind(prefix, 0) != 0) {
    return 0;
  }
  const char* const end = last_event_id.data() + last_event_id.size();
  const auto read = std::from_chars(last_event_id.data() + prefix.size(), end, revision);
  return read.ec == std::errc() && read.ptr == end && revision <= board_->revision() ? revision : 0;
}

// Empty for a message that JSON cannot represent.
const std::string& MapEvents::json_of(const MessageBoard::Message& message) {
  const auto [json, is_new] = json_.try_emplace(message.revision);
  if (is_new) {
    v1::Envelope envelope;
    if (envelope.ParseFromString(*message.envelope)) {
      json->second = to_json(envelope).value_or(std::string());
    }
    // The oldest are removed; they are generated again on demand.
    while (json_.size() > kJsonKept && json_.begin() != json) {
      json_.erase(json_.begin());
    }
  }
  return json->second;
}

}  // namespace rayloc
