// SinkQueue: datagrams for several sinks, collected so that one call sends many of them, and none
// much before or after its neighbours of another sink.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "capture/transport/datagram_sink.h"

namespace rayloc {

class SinkQueue {
 public:
  static constexpr std::size_t kBatch = 64;  // datagrams, of all sinks together

  explicit SinkQueue(std::vector<std::unique_ptr<DatagramSink>> sinks) : sinks_(std::move(sinks)) {}

  // Copies the payload; queued datagrams are sent by flush() or when a batch is full. REQUIRES:
  // sink is a position in the list.
  Expected<void> queue(std::size_t sink, const Datagram& datagram);
  Expected<void> flush();
  // Flushes, and syncs all sinks.
  Expected<void> sync();

  // Sum over all sinks.
  SinkCounters counters() const;

 private:
  struct Queued {
    std::size_t sink;
    Datagram datagram;  // its payload is the next `size` bytes of payloads_
    std::size_t size;
  };

  std::vector<std::unique_ptr<DatagramSink>> sinks_;
  std::vector<Queued> queued_;
  std::vector<std::byte> payloads_;
};

}  // namespace rayloc
