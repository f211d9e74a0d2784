// FrameAssembler: assembles the fragments of each 802.11 frame: receive chains (cores) x spatial
// streams x blocks of tones, in the order of the wire.
//
// A frame is (transmitter, sequence, sequence control); if the extractor has no frame counter, a
// second fragment for the same core and stream with other bytes opens a new frame. A frame is ready
// at once when every expected slot is whole, and otherwise when `timeout` has passed since its
// first datagram in event time, or when more than `max_pending` frames are open. Expected slots are
// those the datagram states; without a statement, those of the transmitter's recent traffic
// (traffic_classes.h) together with `expected_rx_chains`.
//
// Memory is bounded for any input: max_pending frames of at most 256 KiB, kRemembered emitted
// frames, TrafficClasses::kMaxClasses classes. Errors: none; push() returns the outcome for the
// fragment.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "capture/assemble/traffic_classes.h"
#include "capture/decode/csi_decoder.h"
#include "engine/base/timestamp.h"

namespace rayloc {

struct FrameAssemblerOptions {
  std::vector<std::uint8_t> expected_rx_chains;
  Duration timeout = std::chrono::milliseconds(20);
  std::size_t max_pending = 256;
};

// A frame as received on the wire: FFT order, rotated, with its unusable tones.
struct AssembledFrame {
  CsiFragment header;  // header of the first fragment; its `words` are no longer valid
  Timestamp time;      // time of the earliest datagram
  Timestamp time_last;
  std::uint64_t datagrams = 0;
  std::uint16_t slots = 0;          // slots of which any block arrived
  std::uint16_t missing_slots = 0;  // expected slots of which no block arrived
  bool complete = false;
  bool retry = false;  // the transmitter's previous frame had the same sequence control

  // Received blocks of kToneBlock tones, by slot.
  std::array<std::uint32_t, kMaxSlots> coverage{};
  std::array<std::uint64_t, kMaxSlots> digests{};  // for formats without a frame counter

  bool has_slot(std::size_t slot) const { return ((unsigned{slots} >> slot) & 1U) != 0; }
  // All blocks of a slot as bits of `coverage`.
  std::uint32_t full_coverage() const {
    return static_cast<std::uint32_t>((std::uint64_t{1} << (header.total_tones / kToneBlock)) - 1U);
  }
  bool is_whole(std::size_t slot) const { return coverage[slot] == full_coverage(); }
  // Returns true if every slot of which any block arrived is whole.
  bool is_rectangular() const;
  // The tones of a slot; those not in `coverage` are undefined. REQUIRES: has_slot(slot).
  std::span<const std::complex<float>> row(std::size_t slot) const {
    return {values.data() + std::size_t{row_of_slot[slot]} * header.total_tones,
            header.total_tones};
  }

  std::vector<std::complex<float>> values;  // rows in order of arrival; may be longer
  std::array<std::uint8_t, kMaxSlots> row_of_slot{};
  std::uint8_t rows = 0;
};

class FrameAssembler {
 public:
  enum class Outcome {
    kAccepted,
    kDuplicate,  // that part of the frame had already arrived
    kLate,       // the frame had been emitted without it
    kMismatch,   // the header contradicts the frame's first fragment
  };
  // Emitted frames remembered to recognise late fragments, and the time they are remembered.
  static constexpr std::size_t kRemembered = 256;
  static constexpr Duration kLateWindow = std::chrono::seconds(1);

  explicit FrameAssembler(FrameAssemblerOptions options);

  Outcome push(const CsiFragment& fragment, Timestamp time);
  // Makes frames ready that have timed out at `now`. `now` may be earlier than frames that are
  // being assembled (a watermark lags behind the datagrams read).
  void advance(Timestamp now);
  // A datagram of that time arrived: makes ready the frames that are so much later that the clock
  // must have been set back.
  void went_back_to(Timestamp time);
  // Makes everything ready.
  void flush();

  // Returns the next ready frame, or nullptr; valid until the next call of a member function.
  const AssembledFrame* next_ready();

  std::uint64_t datagrams_in_flight() const { return datagrams_in_flight_; }
  // Returns the earliest `time` of the frames not yet returned by next_ready(), or `otherwise` if
  // it is earlier.
  Timestamp earliest(Timestamp otherwise) const;

 private:
  struct Key {
    std::uint64_t address_and_sequence = 0;
    std::uint32_t rest = 0;  // sequence control; format, so that formats may be mixed
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct Pending {
    Key key;
    std::unique_ptr<AssembledFrame> frame;
  };
  struct Emitted {
    Timestamp time;
    std::array<std::uint32_t, kMaxSlots> coverage{};
    std::array<std::uint64_t, kMaxSlots> digests{};
  };

  static Key key_of(const CsiFragment& fragment);
  Pending* find_pending(const Key& key);
  Emitted* find_emitted(const Key& key, Timestamp time);
  // Classifies a fragment of an emitted frame; kAccepted if it begins a new frame.
  Outcome judge_emitted(const CsiFragment& fragment, Emitted& emitted, Timestamp time);
  AssembledFrame& open(const Key& key, const CsiFragment& fragment, Timestamp time);
  void add(AssembledFrame& frame, const CsiFragment& fragment, Timestamp time);
  // Slots required of a frame whose class has the slots `learned`.
  unsigned required_slots(const AssembledFrame& frame, unsigned learned) const;
  bool is_complete(const AssembledFrame& frame);
  void close(std::size_t position);
  template <typename Condition>
  void close_if(Condition condition);
  void remember(const Key& key, const AssembledFrame& frame);

  FrameAssemblerOptions options_;
  TrafficClasses traffic_;
  std::vector<Pending> pending_;  // in order of opening
  std::vector<std::unique_ptr<AssembledFrame>> ready_;
  std::size_t next_ready_ = 0;
  std::vector<std::unique_ptr<AssembledFrame>> spare_;
  std::vector<Key> emitted_keys_;  // keys of emitted_; separate because searched for each frame
  std::vector<Emitted> emitted_;   // emitted frames, a ring once it is full
  std::size_t next_emitted_ = 0;
  std::uint64_t datagrams_in_flight_ = 0;
};

}  // namespace rayloc
