// BatchRequests: requests for several messages of a stream, each with a number. The number is the
// last token of the subject of its replies, so that a late reply reaches no other request.
//
// Thread safety: any thread.
#pragma once

#include <nats/nats.h>

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "daemon/live/cluster/nats/batch_replies.h"
#include "daemon/live/cluster/nats/link.h"

namespace rayloc::nats {

class BatchRequests {
 public:
  // Beginning of the subjects of replies. To be called before the first request.
  void set_inbox(std::string inbox) { inbox_ = std::move(inbox); }
  // As Broker::get_several().
  Expected<std::vector<BrokerMessage>> get(const Link& link,
                                           const std::string& stream,
                                           const MessageRange& range);
  // A message to the inbox. Called by threads of libnats.
  void take(natsMsg* message);

 private:
  std::string inbox_;
  std::mutex mutex_;
  std::uint64_t last_ = 0;                                          // guarded by mutex_
  std::map<std::uint64_t, std::shared_ptr<BatchReplies>> pending_;  // guarded by mutex_
};

}  // namespace rayloc::nats
