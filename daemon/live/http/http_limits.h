// Resource and time limits for a client of the HTTP server.
#pragma once

#include <chrono>
#include <cstddef>

namespace rayloc {

struct HttpLimits {
  std::size_t head_bytes = 8192;  // request line and headers together
  // Beyond it the oldest answered connection is closed, or else the oldest that had `chance` to
  // send a request and is no viewer; without any of these, new clients wait to be accepted.
  std::size_t connections = 64;
  std::chrono::milliseconds chance{500};
  // From the connection to the end of the head, and for reading the answer.
  std::chrono::milliseconds time{5000};
  // From the head of a request to the end of its body, if a route accepts one.
  std::chrono::milliseconds body_time{30'000};
  // Sum of the bodies that are awaited at the same time; a request above it is answered with 503.
  // Bodies of at most `small_body` are always accepted, and not counted.
  std::size_t awaited_bytes = std::size_t{128} << 20U;
  std::size_t small_body = std::size_t{64} << 10U;
  // Streams of events: their maximum number, the interval at which new messages are sent, and the
  // maximum time in which a viewer reads none of its pending data.
  std::size_t viewers = 16;
  std::chrono::milliseconds event_interval{100};
  std::chrono::milliseconds event_patience{10'000};
  // A stream without data for this long gets a comment: servers between us and the viewer close a
  // silent stream (nginx after 60 s), and heartbeats may be as rare.
  std::chrono::milliseconds event_silence{15'000};
};

}  // namespace rayloc
