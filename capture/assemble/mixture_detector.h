// MixtureDetector: detects that several access points send to one source. Every AX-CSI access point
// sends from the same address and port, so the datagrams of two on one port differ only in their
// content. CSI of one array that is combined with CSI of another gives wrong positions.
//
// Evidence of a second access point:
//   - two running frame counters alternate, or two counters of one 802.11 frame are far apart;
//   - two sender addresses alternate;
//   - repeated counter values, with another 802.11 frame or CSI, alternate with new values;
//   - without a counter: every 802.11 sequence number comes equally often, with different CSI.
// Counters and sequence numbers are compared for each transmitter separately: in a recording that
// was merged from several devices, each device may have its own counter.
//
// Retransmissions repeat a sequence number but advance the counter by a few, and their number
// varies. A restarted access point, another recording that is sent to the source, a lossy link and
// a reordered datagram change the counter once and do not return to the old one: counter values
// repeat without new ones between them.
//
// The result is a function of the fragments and their times. Memory is bounded: kMaxTracks
// counters, kRecent frames. Thread safety: one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "capture/decode/csi_decoder.h"
#include "capture/transport/datagram.h"
#include "engine/base/timestamp.h"

namespace rayloc {

class MixtureDetector {
 public:
  enum class Evidence : std::uint8_t {
    kNone,
    kFrameCounters,
    kSenders,
    kSharedCounter,
    kSequenceNumbers
  };
  // A mixture is over after this time without evidence.
  static constexpr Duration kMemory = std::chrono::seconds(30);

  void add(const CsiFragment& fragment, const DatagramAddress& sender, Timestamp time);
  // Adds a datagram that holds a whole frame: only its sender is compared.
  void add(const DatagramAddress& sender, Timestamp time);

  // The latest evidence; kNone if the source has one access point.
  Evidence evidence() const { return evidence_; }
  bool is_mixture() const { return evidence_ != Evidence::kNone; }
  // Time of the first fragment, of the latest jump of a transmitter's counter, or of the newest
  // sender: for some time after it a second access point may still be undetected.
  Timestamp newest_beginning() const { return newest_beginning_; }

  // The input continues at another position: discards all observations.
  void reset() { *this = {}; }

 private:
  static constexpr std::size_t kMaxTracks = 64;
  static constexpr std::size_t kRecent = 256;
  static constexpr std::size_t kRecentParts = 16;
  // The longest runs of frames if two access points share counter values: of frames whose value
  // occurred before, and of frames with new values (the other access point may lose frames).
  static constexpr int kMaxShared = 8;
  static constexpr int kMaxNew = 32;

  // A frame counter that advances for one transmitter, or a sender address.
  struct Track {
    std::uint32_t value = 0;  // last counter value, or the address
    Timestamp time;           // of its last fragment
    MacAddress transmitter;   // of its last fragment
    std::uint16_t sequence_control = 0;
  };
  struct Tracks {
    std::vector<Track> tracks;  // tracks; that of the latest fragment is last
    int returns = 0;            // returns to a track after another one was followed
    Timestamp last_return;
  };
  // The position of one part of a frame, and its CSI.
  struct Part {
    std::uint16_t slot = 0;
    std::uint16_t first_tone = 0;
    std::uint64_t digest = 0;
  };
  struct Recent {
    bool used = false;
    bool is_shared = false;  // another frame had this counter value before
    std::uint16_t sequence = 0;
    std::uint16_t sequence_control = 0;
    MacAddress transmitter;
    Timestamp begin;
    Timestamp time;
    std::size_t parts = 0;
    std::array<Part, kRecentParts> part;
  };

  void observe(Evidence evidence, Timestamp time);
  // Returns true if the fragment belongs to another track than the one before and that track is not
  // new.
  bool follow(Tracks& all, const Track& now, std::uint32_t tolerance, Timestamp time);
  void add_counter(const CsiFragment& fragment, Timestamp time);
  void add_recent(const CsiFragment& fragment, Timestamp time);
  void add_shared(const CsiFragment& fragment, bool is_shared, Timestamp time);
  void add_sequence_number(const CsiFragment& fragment, Timestamp time);
  void close_run();

  Evidence evidence_ = Evidence::kNone;
  Timestamp last_evidence_;
  Timestamp newest_beginning_ = Timestamp::min();
  Tracks counters_;
  Tracks senders_;
  std::vector<Recent> recent_;  // [kRecent], by sequence modulo kRecent; empty before the first
  // Runs of at most kMaxShared frames with a shared counter value, at most kMaxNew frames apart.
  int shared_runs_ = 0;
  bool in_shared_run_ = false;
  int frames_in_run_ = 0;  // of the current run, shared or not
  std::uint16_t last_sequence_ = 0;
  // The current run of fragments with one 802.11 sequence number, and lengths of the last runs.
  CsiFragment run_;  // its first fragment; empty format: none
  Timestamp run_begin_;
  int run_length_ = 0;
  std::uint64_t run_digest_ = 0;
  std::vector<int> runs_;
};

// Text for a message: "two frame counters advance side by side". Empty for kNone.
std::string_view to_string(MixtureDetector::Evidence evidence);

}  // namespace rayloc
