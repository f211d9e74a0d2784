// TrafficClasses: what the datagrams of a transmitter have lately brought, so that a frame is known
// to be complete without being told which cores and streams the access point extracts.
//
// A class is a transmitter, a number of streams sent and a transform size: frames of one class come
// with the same slots (core and stream). A slot belongs to the class if one of its last
// kMemoryFrames frames had it. For the first kWarmUpFrames frames of a class nothing can be said.
// A function of the frames alone; at most kMaxClasses are remembered, the least recently used is
// forgotten first.
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

  // Slots that a frame of the fragment's class should have, or nothing while that is not known.
  std::optional<std::uint16_t> expected_slots(const CsiFragment& fragment);
  // Slots that the class has had so far, known or not.
  std::uint16_t slots_so_far(const CsiFragment& fragment) { return class_of(fragment).slots; }
  // A frame of that class is over and had these slots.
  void frame_closed(const CsiFragment& fragment, std::uint16_t slots);
  // A datagram came after its frame had been emitted: next time its slot is waited for.
  void slot_seen(const CsiFragment& fragment);
  // Whether the transmitter's frame before had the same 802.11 sequence control; notes this one.
  bool repeats_sequence_control(const CsiFragment& fragment);

 private:
  struct TrafficClass {
    std::uint64_t key = 0;
    std::uint64_t last_use = 0;
    std::uint64_t frames = 0;                           // closed so far
    std::array<std::uint64_t, kMaxSlots> last_frame{};  // value of `frames` when the slot was seen
    std::uint16_t slots = 0;                            // of the last kMemoryFrames frames
    std::optional<std::uint16_t> sequence_control;      // of the last frame opened
  };

  TrafficClass& class_of(const CsiFragment& fragment);
  TrafficClass& insert(std::uint64_t key);

  std::vector<TrafficClass> classes_;
  std::size_t current_ = 0;  // the class asked for last; asked for again most of the time
  std::uint64_t uses_ = 0;
};

}  // namespace rayloc
