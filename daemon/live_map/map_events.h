// MapEvents: what raylocd publishes, as the server-sent events of the map.
//
//   event: snapshot      the first one: everything that was last said
//   id: EPOCH-REVISION   comes back as Last-Event-ID: then a snapshot holds only what is newer
//   data: {"now": TIME, "epoch": "...", "resumed": false, "messages": [v1::Envelope, ...]}
//
//   event: update        what has changed since, the latest of each subject
//   data: {"now": TIME, "messages": [...]}
//
// A new epoch means that the daemon was started again, and that what was known is void. `now` is by
// the clock that `sent` of the envelopes is by, so that a viewer can tell the age of each message
// whatever its own clock says.
//
// Thread safety: one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "daemon/http/event_feed.h"
#include "daemon/publish/message_board.h"
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
  // By revision: several viewers get the same.
  std::map<std::uint64_t, std::string> json_;
};

}  // namespace rayloc
