// What a client of the HTTP server may cost, and for how long.
#pragma once

#include <chrono>
#include <cstddef>

namespace rayloc {

struct HttpLimits {
  std::size_t head_bytes = 8192;  // request line and headers together
  // Past that the oldest one that has been answered is closed, else the oldest that had `chance`
  // to ask and is no viewer; while there is none of these, whoever comes waits to be accepted.
  std::size_t connections = 64;
  std::chrono::milliseconds chance{500};
  // From the connection to the end of the head, and for fetching the answer.
  std::chrono::milliseconds time{5000};
  // From the head of a request to the end of its body, where a route takes one.
  std::chrono::milliseconds body_time{30'000};
  // Streams of events: how many, how often one is asked what is new for it, and how long it may
  // take nothing of what waits for it.
  std::size_t viewers = 16;
  std::chrono::milliseconds event_interval{100};
  std::chrono::milliseconds event_patience{10'000};
  // A stream on which nothing is said for so long gets a comment: servers between us and the viewer
  // close what is silent (nginx after 60 s), and heartbeats may be as rare.
  std::chrono::milliseconds event_silence{15'000};
};

}  // namespace rayloc
