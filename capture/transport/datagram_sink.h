// DatagramSink: the destination of datagrams; the counterpart of DatagramSource.
//
// Implementations: UdpSender (udp_sender.h), RelaySender (relay_sender.h) and PcapRecorder
// (capture/record/pcap_recorder.h). A transport's row (transport_scheme.h) opens both.
// Thread safety: one thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "capture/transport/datagram_source.h"
#include "engine/base/expected.h"

namespace rayloc {

// given = delivered + lost().
struct SinkCounters {
  std::uint64_t given = 0;      // datagrams
  std::uint64_t delivered = 0;  // as far as this end can determine
  std::uint64_t bytes = 0;      // bytes of the payloads delivered; for a file, its current length
  std::uint64_t errors = 0;     // calls of write() that returned an Error
  // By reason: "not_written", "not_taken", "not_there", ...
  std::map<std::string, std::uint64_t> lost_by;

  std::uint64_t lost() const {
    std::uint64_t sum = 0;
    for (const auto& [reason, count] : lost_by) {
      sum += count;
    }
    return sum;
  }
};

class DatagramSink {
 public:
  virtual ~DatagramSink() = default;

  // Writes the datagrams of a batch, in order. An empty batch gives the current time to a sink that
  // carries watermarks. After an Error the next batch may be tried: there may be room again.
  virtual Expected<void> write(const DatagramBatch& batch) = 0;

  // Receives the counters of the source that feeds it; a sink that supports it reports earlier
  // losses to the other end.
  virtual void note_source(const SourceCounters& /*source*/) {}

  // Syncs the written data so that a crash does not lose it.
  virtual Expected<void> sync() { return {}; }

  virtual const SinkCounters& counters() const = 0;

  // For messages: "udp 10.0.0.7:5500", "recording.pcap", "unix socket /run/raylocd/eth0".
  virtual std::string description() const = 0;
};

}  // namespace rayloc
