// DatagramSource: the origin of datagrams. One access point = one source, because every access
// point sends from 10.10.10.10: only the port, interface or file identifies it.
//
// Implementations: UdpSource (udp_source.h), PcapFileSource (pcap_source.h), PcapLiveSource
// (pcap_live_source.h), UnixSource (unix_source.h), and ReopeningSource around a live one.
// Thread safety: one thread reads; counters() may be called from another.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/transport/datagram.h"
#include "engine/base/expected.h"

namespace rayloc {

// received = delivered + sum(rejected); datagrams that the kernel dropped were never received and
// are counted separately.
struct SourceCounters {
  std::uint64_t received = 0;      // packets or datagrams read from the socket, interface or file
  std::uint64_t delivered = 0;     // returned to the caller as Datagram
  std::uint64_t bytes = 0;         // payload bytes delivered
  std::uint64_t kernel_drops = 0;  // SO_RXQ_OVFL, pcap_stats
  std::uint64_t clock_steps = 0;   // clock steps of the machine meanwhile; live sources
  // For a recording: datagrams that its marks of gaps ("gap_mark" below, recording_gap.h) report as
  // received and not recorded, if the number is stated. Not part of `received`.
  std::uint64_t unrecorded = 0;
  // Number of read failures of a live source (ReopeningSource).
  std::uint64_t failures = 0;
  // By reason: "not_udp", "wrong_port", "ip_fragment", "truncated_capture", "length_mismatch",
  // "oversized", "interface_not_allowed", "sender_not_allowed", ...
  std::map<std::string, std::uint64_t> rejected;
  // Datagrams delivered from inside a tunnel, by its name: "MPLS".
  std::map<std::string, std::uint64_t> unwrapped;
  // Sizes of the longest packet that is "truncated_capture": bytes in the capture and on the wire.
  std::uint32_t cut_captured = 0;
  std::uint32_t cut_original = 0;
};

// Adds the counters of a source that continues another one that ended. Excludes clock_steps, which
// the owner of both sources counts throughout.
inline void add_counts(SourceCounters& to, const SourceCounters& more) {
  to.received += more.received;
  to.delivered += more.delivered;
  to.bytes += more.bytes;
  to.kernel_drops += more.kernel_drops;
  to.unrecorded += more.unrecorded;
  to.failures += more.failures;
  for (const auto& [reason, count] : more.rejected) {
    to.rejected[reason] += count;
  }
  for (const auto& [tunnel, count] : more.unwrapped) {
    to.unwrapped[tunnel] += count;
  }
  if (more.cut_original > to.cut_original) {
    to.cut_captured = more.cut_captured;
    to.cut_original = more.cut_original;
  }
}

struct DatagramBatch {
  std::vector<Datagram> datagrams;  // in order of arrival
  // No datagram with an earlier time follows from this source. It advances the event time of idle
  // sources and lets several sources merge by time without a delay.
  Timestamp watermark{};
  bool ended = false;  // the file is read to its end; never set by a live source
  // A recording that is played is read to its end, but may be asked to seek.
  bool at_end = false;
  // Number of seeks so far: no datagram from before the seek follows, and times may be earlier
  // afterwards. The batch is empty otherwise.
  std::optional<std::uint64_t> moved = {};
};

// The kernel's receive buffer, if a source has one.
struct ReceiveBuffer {
  int wanted_bytes = 0;
  int granted_bytes = 0;  // includes the kernel's own bookkeeping
  // Losses of an adopted socket between its opening and its adoption. Not part of kernel_drops: the
  // process that read it then counted most of them.
  std::uint32_t dropped_before = 0;
};

class DatagramSource {
 public:
  virtual ~DatagramSource() = default;

  // Replaces the contents of `batch` by the datagrams received. A live source waits up to `timeout`
  // for the first datagram, and returns an empty batch with a new watermark if none arrives; a file
  // returns its next packets at once. An Error ends the source: datagrams read before it have been
  // delivered.
  virtual Expected<void> read(DatagramBatch& batch, Duration timeout) = 0;

  virtual SourceCounters counters() const = 0;

  // For messages and logs: "udp 0.0.0.0:5500", "recording.pcap", "interface eth7".
  virtual std::string description() const = 0;

  virtual ReceiveBuffer receive_buffer() const { return {}; }

  // The descriptor that is readable when datagrams have arrived, so that one thread can wait for
  // several sources and read each with a time-out of zero; -1: none while it is closed. Nothing for
  // a source that needs a thread of its own. For the thread that reads.
  virtual std::optional<int> poll_descriptor() const { return std::nullopt; }

  // Notices for the operator, a line each: those available before reading, and those from reading
  // so far; for the thread that reads.
  virtual std::vector<std::string> notices() const { return {}; }
  virtual std::vector<std::string> warnings() const { return {}; }

  // Reason for which it cannot be read now, although it has not ended; empty while it can. For the
  // thread that reads.
  virtual std::string trouble() const { return {}; }
};

}  // namespace rayloc
