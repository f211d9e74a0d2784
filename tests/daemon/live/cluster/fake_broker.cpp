#include "tests/daemon/live/cluster/fake_broker.h"

#include <algorithm>
namespace rayloc {

Expected<Published> FakeBroker::publish_behind(const std::string& subject,
                                               std::string_view data,
                                               std::uint64_t last) {
  wait_to_answer();
  if (!connected()) {
    return away();
  }
  if (data.size() > most) {
    return make_error(ErrorKind::kUnavailable, "maximum payload exceeded");
  }
  {
    const std::lock_guard lock(mutex_);
    std::uint64_t newest = 0;
    if (const Stream* const stream = stream_of(subject)) {
      for (const auto& [sequence, message] : stream->messages) {
        newest = message.subject == subject ? sequence : newest;
      }
    }
    if (newest != last) {
      return Published{};
    }
  }
  const std::uint64_t sequence = store(subject, data, "");
  if (sequence == 0) {
    return make_error(ErrorKind::kUnavailable, "no stream takes it");
  }
  return Published{true, sequence};
}

Expected<StreamState> FakeBroker::stream_state(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found = streams_.find(name);
  if (!connected_ || found == streams_.end()) {
    return away();
  }
  const Stream& stream = found->second;
  return StreamState{Timestamp(Duration(stream.created)),
                     stream.messages.empty() ? stream.last + 1 : stream.messages.begin()->first,
                     std::min(stream.last, leader_has_)};
}

Expected<std::optional<BrokerMessage>> FakeBroker::get(const std::string& name,
                                                       std::uint64_t sequence) {
  const std::lock_guard lock(mutex_);
  ++gets_;
  return found(name, sequence, replica_has_);
}

// The first one must exist; removed messages behind it are left out, as by the server.
Expected<std::vector<BrokerMessage>> FakeBroker::get_several(const std::string& name,
                                                             const MessageRange& range) {
  const std::lock_guard lock(mutex_);
  ++gets_;
  auto first = found(name, range.first, replica_has_);
  RAYLOC_TRY(first);
  std::vector<BrokerMessage> several;
  if (!*first) {
    return several;
  }
  const auto& messages = streams_[name].messages;
  std::size_t bytes = 0;
  for (auto one = messages.find(range.first); one != messages.end(); ++one) {
    const std::size_t limit = gives_several_ ? range.messages : 1;
    if (several.size() == limit || bytes >= range.bytes || one->first > replica_has_) {
      break;
    }
    several.push_back(one->second);
    bytes += one->second.data.size();
  }
  return several;
}

Expected<std::optional<BrokerMessage>> FakeBroker::get_of_leader(const std::string& name,
                                                                 std::uint64_t sequence) {
  const std::lock_guard lock(mutex_);
  return found(name, sequence, leader_has_);
}

Expected<std::optional<BrokerMessage>> FakeBroker::found(const std::string& name,
                                                         std::uint64_t sequence,
                                                         std::uint64_t has) {
  if (!connected_) {
    return away();
  }
  const auto& messages = streams_[name].messages;
  const auto one = messages.find(sequence);
  return one == messages.end() || sequence > has ? std::nullopt : std::optional(one->second);
}

Expected<std::optional<BrokerMessage>> FakeBroker::last_of(const std::string& name,
                                                           const std::string& subject) {
  wait_to_answer();
  const std::lock_guard lock(mutex_);
  if (!connected_) {
    return away();
  }
  std::optional<BrokerMessage> last;
  const auto stream = streams_.find(name);
  if (stream == streams_.end()) {
    return last;
  }
  for (const auto& [sequence, message] : stream->second.messages) {
    last = message.subject == subject ? std::optional(message) : last;
  }
  return last;
}

std::uint64_t FakeBroker::store(const std::string& subject,
                                std::string_view data,
                                const std::string& id) {
  BrokerMessage message{subject, 0, std::string(data)};
  std::string again;
  {
    const std::lock_guard lock(mutex_);
    Stream* const stream = stream_of(subject);
    if (stream == nullptr) {
      return 0;
    }
    if (!id.empty() && !stream->ids.insert(id).second) {
      return stream->last;
    }
    message.sequence = ++stream->last;
    stream->messages[message.sequence] = message;
    again = without_end(stream->options.republish_to) +
            subject.substr(without_end(stream->options.subjects).size());
  }
  deliver(message, again);
  return message.sequence;
}

void FakeBroker::deliver(const BrokerMessage& message, const std::string& subject) {
  std::vector<std::shared_ptr<Called>> handlers;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, one] : handlers_) {
      if (fits(one.first, subject)) {
        handlers.push_back(one.second);
      }
    }
  }
  for (const auto& handler : handlers) {
    const std::lock_guard call(handler->mutex);
    if (handler->call) {
      handler->call(BrokerMessage(message));
    }
  }
}

Expected<std::unique_ptr<Broker::Subscription>> FakeBroker::subscribe(const std::string& subject,
                                                                      Handler handler) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t id = ++subscriptions_;
  const auto called = std::make_shared<Called>();
  called->call = std::move(handler);
  handlers_[id] = {subject, called};
  return std::make_unique<Fake>(*this, id, called);
}

}  // namespace rayloc
