// RecordingGap: what a recording says that it does not hold.
//
// A gap stands in the file as a UDP datagram to the discard port (RFC 863: what is sent there is
// thrown away) from and to 127.0.0.1, with a line of text:
//
//   rayloc-gap datagrams=120 reason=no_room from=1763816400.123456 to=1763816401.000000
//
// So Wireshark shows it in its place, tcpreplay harms nobody with it, and PcapFileSource counts it
// instead of giving it out. `datagrams=unknown` after a crash: what was still in memory, and what
// came until the recorder ran again.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "capture/transport/datagram.h"

namespace rayloc {

struct RecordingGap {
  std::optional<std::uint64_t> datagrams;  // not recorded; nothing: nobody knows
  std::string reason;                      // a word: "buffer_full", "write_failed", "no_room", ...
  Timestamp from{};                        // of the first datagram, or the last one before
  Timestamp to{};                          // of the last datagram, or the moment of the repair

  friend bool operator==(const RecordingGap&, const RecordingGap&) = default;
};

// The text. Times are cut to microseconds.
std::string gap_text(const RecordingGap& gap);
// The mark around such a text, which it points to. Its time is `time`.
Datagram gap_mark(const std::string& text, Timestamp time);

// Nothing when the datagram is no mark.
std::optional<RecordingGap> recording_gap(const Datagram& datagram);

}  // namespace rayloc
