#include "daemon/live/cluster/nats/batch_requests.h"

#include <string_view>

#include "daemon/live/cluster/nats/message.h"
#include "daemon/live/cluster/nats/options.h"

namespace rayloc::nats {
namespace {

BatchReplies::Reply batch_reply(natsMsg* message) {
  BatchReplies::Reply reply;
  const char* value = nullptr;
  if (natsMsgHeader_Get(message, "Nats-Sequence", &value) != NATS_OK) {
    reply.status = natsMsgHeader_Get(message, "Status", &value) == NATS_OK ? value : "unknown";
    return reply;
  }
  reply.states_pending = natsMsgHeader_Get(message, "Nats-Num-Pending", &value) == NATS_OK;
  reply.message = received(message);
  return reply;
}

std::string request_for(const MessageRange& range) {
  return "{\"seq\":" + std::to_string(range.first) +
         ",\"batch\":" + std::to_string(range.messages) +
         ",\"max_bytes\":" + std::to_string(range.bytes) + "}";
}

}  // namespace

Expected<std::vector<BrokerMessage>> BatchRequests::get(const Link& link,
                                                        const std::string& stream,
                                                        const MessageRange& range) {
  const auto replies = std::make_shared<BatchReplies>();
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    number = ++last_;
    pending_[number] = replies;
  }
  const natsStatus status =
      natsConnection_PublishRequestString(link.connection(),
                                          ("$JS.API.DIRECT.GET." + stream).c_str(),
                                          (inbox_ + std::to_string(number)).c_str(),
                                          request_for(range).c_str());
  Expected<std::vector<BrokerMessage>> messages;
  if (status == NATS_OK) {
    messages = replies->wait(std::chrono::milliseconds(kRequestMs),
                             [&link] { return link.is_connected(); });
  } else {
    messages = tl::make_unexpected(error_of("request", status));
  }
  {
    const std::lock_guard lock(mutex_);
    pending_.erase(number);
  }
  if (!messages) {
    return make_error(ErrorKind::kUnavailable,
                      "stream " + stream + ": " + messages.error().message);
  }
  return messages;
}

void BatchRequests::take(natsMsg* message) {
  const std::string_view subject(natsMsg_GetSubject(message));
  std::shared_ptr<BatchReplies> replies;
  {
    const std::lock_guard lock(mutex_);
    const auto found = pending_.find(number_of(subject.substr(subject.rfind('.') + 1)));
    replies = found == pending_.end() ? nullptr : found->second;
  }
  if (replies) {
    replies->take(batch_reply(message));
  }
}

}  // namespace rayloc::nats
