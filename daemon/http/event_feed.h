// EventFeed: where a stream of server-sent events comes from (HTML standard, 9.2).
#pragma once

#include <cstdint>
#include <string>

namespace rayloc {

// How far one viewer is.
struct EventCursor {
  bool begun = false;          // it has been given its first event
  std::string last_event_id;   // what it says it had before it lost its connection; else empty
  std::uint64_t revision = 0;  // the feed's own
  std::uint64_t joined = 0;    // revision at its first event
};

struct EventBatch {
  std::string text;             // whole events; empty: nothing is new
  std::uint64_t coalesced = 0;  // messages that newer ones replaced before this viewer was asked
};

class EventFeed {
 public:
  virtual ~EventFeed() = default;
  // What is new for that viewer; moves its cursor on. Called on the server's thread.
  virtual EventBatch take(EventCursor& cursor) = 0;
};

}  // namespace rayloc
