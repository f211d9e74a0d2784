// SnapshotServer: sends late subscribers the last message of each topic (snapshot.proto), on a
// ZeroMQ ROUTER socket and its own thread.
//
// A request is one frame, a v1::SnapshotRequest, from a DEALER or (with the empty frame that it
// adds) a REQ socket; the answer is one frame, a v1::SnapshotReply. Invalid requests are dropped
// and counted, and so are answers that the client does not read. No call blocks.
//
// Thread safety: one thread starts and ends it; counters() from any.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "engine/base/expected.h"

namespace rayloc {

class ConnectionGuard;
class LastMessages;

struct SnapshotCounters {
  std::uint64_t answered = 0;
  std::uint64_t malformed = 0;  // invalid requests
  std::uint64_t dropped = 0;    // answers that their client did not read
};

class SnapshotServer {
 public:
  struct Options {
    std::string endpoint = "tcp://127.0.0.1:5561";
    int adopted_fd = -1;  // as PublisherOptions::adopted_fd
    std::uint64_t epoch = 0;
    std::shared_ptr<const LastMessages> last;
    // Controls who may send requests; null: every client that can reach the endpoint.
    std::shared_ptr<ConnectionGuard> guard = nullptr;
    // Called on the server's thread in each iteration of its loop, several times a second.
    std::function<void()> on_round = {};
  };

  // Errors as Publisher::bind().
  static Expected<std::unique_ptr<SnapshotServer>> open(const Options& options);
  ~SnapshotServer();

  const std::string& endpoint() const;
  SnapshotCounters counters() const;

 private:
  class Impl;
  explicit SnapshotServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
