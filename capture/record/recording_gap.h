// RecordingGap: datagrams that a recording reports as missing.
//
// A gap is stored in the file as a UDP datagram to the discard port (RFC 863: datagrams sent there
// are discarded) from and to 127.0.0.1, with a line of text:
//
//   rayloc-gap datagrams=120 reason=no_room from=1763816400.123456 to=1763816401.000000
//
// Wireshark shows it at its position, tcpreplay sends it without harm, and PcapFileSource counts it
// instead of delivering it. `datagrams=unknown` after a crash: those still in memory, and those
// that arrived until the recorder ran again.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "capture/transport/datagram.h"

namespace rayloc {

struct RecordingGap {
  std::optional<std::uint64_t> datagrams;  // datagrams not recorded; empty: unknown
  std::string reason;                      // one word: "buffer_full", "write_failed", "no_room"...
  Timestamp from{};                        // time of the first datagram, or the last one before
  Timestamp to{};                          // time of the last datagram, or of the repair

  friend bool operator==(const RecordingGap&, const RecordingGap&) = default;
};

// The text of the mark. Times are truncated to microseconds.
std::string gap_text(const RecordingGap& gap);
// The mark with this text, which its payload refers to. Its time is `time`.
Datagram gap_mark(const std::string& text, Timestamp time);

// Returns the gap, or empty if the datagram is no mark.
std::optional<RecordingGap> recording_gap(const Datagram& datagram);

}  // namespace rayloc
