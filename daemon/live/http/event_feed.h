// EventFeed: the source of a stream of server-sent events (HTML standard, 9.2).
#pragma once

#include <cstdint>
#include <string>

namespace rayloc {

// The progress of one viewer.
struct EventCursor {
  bool begun = false;          // its first event has been sent
  std::string last_event_id;   // last id, as the viewer states it after a lost connection; or empty
  std::uint64_t revision = 0;  // value defined by the feed
  std::uint64_t joined = 0;    // revision at its first event
};

struct EventBatch {
  std::string text;             // whole events; empty: no new messages
  std::uint64_t coalesced = 0;  // messages that newer ones replaced before this viewer was served
};

class EventFeed {
 public:
  virtual ~EventFeed() = default;
  // Returns new events for that viewer and advances its cursor. Called on the server's thread.
  virtual EventBatch take(EventCursor& cursor) = 0;
};

}  // namespace rayloc
