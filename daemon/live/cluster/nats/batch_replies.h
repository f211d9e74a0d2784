// BatchReplies: collects the replies to one request for several messages of a stream (direct get
// with `batch`, nats-server 2.11 on): one reply for each message, then one of status 204. An older
// server ignores `batch`: its only reply is a message that does not state how many are pending.
//
// Thread safety: any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "daemon/live/cluster/broker.h"

namespace rayloc::nats {

class BatchReplies {
 public:
  struct Reply {
    std::string status = {};  // of a reply without a message, "404"; empty: it has one
    bool states_pending = false;
    BrokerMessage message = {};
  };

  void take(Reply&& reply) {
    {
      const std::lock_guard lock(mutex_);
      if (reply.status.empty()) {
        is_complete_ = is_complete_ || !reply.states_pending;
        messages_.push_back(std::move(reply.message));
      } else {
        is_complete_ = true;
        if (reply.status != kEndOfBatch && reply.status != kNoMessage) {
          fault_ = "the server replies with status " + reply.status;
        }
      }
      ++replies_;
    }
    changed_.notify_one();
  }

  // The messages, once they are complete, or no further reply has come for `patience`, or none can
  // come any more. An Error if there is no message then, or the server has refused the request.
  Expected<std::vector<BrokerMessage>> wait(std::chrono::milliseconds patience,
                                            const std::function<bool()>& may_come) {
    std::unique_lock lock(mutex_);
    std::size_t seen = replies_;
    for (std::chrono::milliseconds idle{0}; !is_complete_ && idle < patience && may_come();) {
      changed_.wait_for(lock, kCheck, [&] { return replies_ != seen; });
      idle = replies_ != seen ? std::chrono::milliseconds(0) : idle + kCheck;
      seen = replies_;
    }
    if (fault_.empty() && !is_complete_ && messages_.empty()) {
      fault_ = "no server answers";
    }
    if (!fault_.empty()) {
      return make_error(ErrorKind::kUnavailable, fault_);
    }
    return std::move(messages_);
  }

 private:
  static constexpr std::chrono::milliseconds kCheck{50};
  static constexpr const char* kEndOfBatch = "204";
  static constexpr const char* kNoMessage = "404";

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<BrokerMessage> messages_;  // guarded by mutex_, as the next
  bool is_complete_ = false;
  std::string fault_;
  std::size_t replies_ = 0;
};

}  // namespace rayloc::nats
