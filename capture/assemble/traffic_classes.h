// TrafficClasses: the slots that recent datagrams of a transmitter filled. They show when a frame
// is complete without a list of the cores and streams that the access point extracts.
//
// A class is a transmitter, a number of streams sent and a transform size: frames of one class have
// the same slots (core and stream). A slot belongs to the class if one of its last kMemoryFrames
// frames had it. The first kWarmUpFrames frames of a class give no prediction. The result is a
// function of the frames alone; at most kMaxClasses are kept, the least recently used is discarded
// first.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "capture/decode/csi_decoder.h"

namespace rayloc {

class TrafficClasses {
 public:
  static constexpr std::uint64_t kMemoryFrames = 32;
  static constexpr std::uint64_t kWarmUpFrames = 4;
  static constexpr std::size_t kMaxClasses = 256;

  TrafficClasses();

  // Slots that a frame of the fragment's class should have; empty while they are not learned.
  std::optional<std::uint16_t> expected_slots(const CsiFragment& fragment);
  // Slots observed for the class so far, learned or not.
  std::uint16_t slots_so_far(const CsiFragment& fragment) { return class_of(fragment).slots; }
  // Records that a frame of that class was closed with these slots.
  void frame_closed(const CsiFragment& fragment, std::uint16_t slots);
  // Records a datagram that came after its frame was emitted: later frames wait for its slot.
  void slot_seen(const CsiFragment& fragment);
  // True if the transmitter's previous frame had the same 802.11 sequence control; stores this one.
  bool repeats_sequence_control(const CsiFragment& fragment);

 private:
  struct TrafficClass {
    std::uint64_t key = 0;
    std::uint64_t last_use = 0;
    std::uint64_t frames = 0;                           // frames closed so far
    std::array<std::uint64_t, kMaxSlots> last_frame{};  // `frames` when the slot was last received
    std::uint16_t slots = 0;                            // slots of the last kMemoryFrames frames
    std::optional<std::uint16_t> sequence_control;      // sequence control of the last frame opened
  };

  TrafficClass& class_of(const CsiFragment& fragment);
  TrafficClass& insert(std::uint64_t key);

  std::vector<TrafficClass> classes_;
  std::size_t current_ = 0;  // index of the class of the previous query, which most queries repeat
  std::uint64_t uses_ = 0;
};

}  // namespace rayloc
