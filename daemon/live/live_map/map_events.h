// MapEvents: the messages that raylocd publishes, as the server-sent events of the map.
//
//   event: snapshot      the first one: the latest message on each subject
//   id: EPOCH-REVISION   returned as Last-Event-ID: the snapshot then has only newer messages
//   data: {"now": TIME, "epoch": "...", "resumed": false, "messages": [v1::Envelope, ...]}
//
//   event: update        the changes since, the latest message on each subject
//   data: {"now": TIME, "messages": [...]}
//
// A new epoch means that the daemon was restarted and that earlier state is void. `now` and `sent`
// of the envelopes use the same clock, so a viewer can compute the age of each message
// independently of its own clock.
//
// Thread safety: one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "daemon/live/http/event_feed.h"
#include "daemon/live/publish/message_board.h"
#include "engine/base/timestamp.h"

namespace rayloc {

class MapEvents : public EventFeed {
 public:
  MapEvents(std::shared_ptr<const MessageBoard> board,
            std::uint64_t epoch,
            std::function<Timestamp()> now)
      : board_(std::move(board)), epoch_(epoch), now_(std::move(now)) {}

  EventBatch take(EventCursor& cursor) override;

 private:
  std::uint64_t revision_of(const std::string& last_event_id) const;
  const std::string& json_of(const MessageBoard::Message& message);

  const std::shared_ptr<const MessageBoard> board_;
  const std::uint64_t epoch_;
  const std::function<Timestamp()> now_;
  // Texts by revision: several viewers receive the same.
  std::map<std::uint64_t, std::string> json_;
};

}  // namespace rayloc
