// DatagramSource: where datagrams come from. One access point = one source, because every access
// point sends from 10.10.10.10: only the port, interface or file they arrive on tells them apart.
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

// received = delivered + sum(rejected); what the kernel dropped was never received and is counted
// apart.
struct SourceCounters {
  std::uint64_t received = 0;      // packets or datagrams read from the socket, interface or file
  std::uint64_t delivered = 0;     // handed to the caller as Datagram
  std::uint64_t bytes = 0;         // payload bytes delivered
  std::uint64_t kernel_drops = 0;  // SO_RXQ_OVFL, pcap_stats
  std::uint64_t clock_steps = 0;   // times that the machine's clock was set meanwhile; live sources
  // Of a recording: datagrams that its marks of gaps ("gap_mark" below, recording_gap.h) say were
  // received and not recorded, as far as known. Not part of `received`.
  std::uint64_t unrecorded = 0;
  // Times that a live source could not be read any more (ReopeningSource).
  std::uint64_t failures = 0;
  // By reason: "not_udp", "wrong_port", "ip_fragment", "truncated_capture", "length_mismatch",
  // "oversized", "interface_not_allowed", "sender_not_allowed", ...
  std::map<std::string, std::uint64_t> rejected;
  // Delivered from inside a tunnel, by its name: "MPLS".
  std::map<std::string, std::uint64_t> unwrapped;
  // Of the longest packet that is "truncated_capture": bytes in the capture and on the wire.
  std::uint32_t cut_captured = 0;
  std::uint32_t cut_original = 0;
};

// Adds what a source counted that goes on where another one ended. But for clock_steps: of who was
// there throughout.
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
  // No datagram with an earlier time will come from this source any more. Event time of idle
  // sources advances by it; it is what lets several sources merge by time without a delay.
  Timestamp watermark{};
  bool ended = false;  // the file is read to its end; never of a live source
  // A recording that is played is read to its end, but may be asked to go on elsewhere.
  bool rests = false;
  // It goes on elsewhere, for so many times now: nothing more comes of where it was, and times may
  // be earlier from now on. The batch is empty otherwise.
  std::optional<std::uint64_t> moved = {};
};

// The kernel's room for what waits to be read, where a source has such a thing.
struct ReceiveBuffer {
  int wanted_bytes = 0;
  int granted_bytes = 0;  // it counts its own bookkeeping in it
  // What an adopted socket had lost before it was taken over, since it was opened. Not part of
  // kernel_drops: most of it was counted by the process that read it then.
  std::uint32_t dropped_before = 0;
};

class DatagramSource {
 public:
  virtual ~DatagramSource() = default;

  // Replaces the contents of `batch` by what has arrived. A live source waits up to `timeout` for
  // the first datagram, and returns an empty batch with a new watermark if none came; a file
  // returns its next packets at once. An Error ends the source: what was read before it has been
  // delivered.
  virtual Expected<void> read(DatagramBatch& batch, Duration timeout) = 0;

  virtual SourceCounters counters() const = 0;

  // For messages and logs: "udp 0.0.0.0:5500", "recording.pcap", "interface eth7".
  virtual std::string description() const = 0;

  virtual ReceiveBuffer receive_buffer() const { return {}; }

  // What people should know of it, a line each: before it is read, and of what was read so far; for
  // the thread that reads.
  virtual std::vector<std::string> notices() const { return {}; }
  virtual std::vector<std::string> warnings() const { return {}; }

  // Why it cannot be read now, although it has not ended; empty while it can. For the thread that
  // reads.
  virtual std::string trouble() const { return {}; }
};

}  // namespace rayloc
