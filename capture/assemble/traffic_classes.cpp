#include "capture/assemble/traffic_classes.h"

#include <algorithm>

namespace rayloc {
namespace {

constexpr unsigned kTransmitterShift = 16;

std::uint64_t key_of(const CsiFragment& fragment) {
  std::uint64_t key = 0;
  for (const std::uint8_t octet : fragment.transmitter.octets) {
    key = key << 8U | octet;
  }
  const auto streams = static_cast<std::uint64_t>(fragment.transmitted_streams) & 0xfU;
  return key << kTransmitterShift | std::uint64_t{fragment.total_tones} << 4U | streams;
}

}  // namespace

TrafficClasses::TrafficClasses() { classes_.reserve(kMaxClasses); }

TrafficClasses::TrafficClass& TrafficClasses::insert(std::uint64_t key) {
  if (classes_.size() < kMaxClasses) {
    classes_.emplace_back();
    current_ = classes_.size() - 1;
  } else {
    const auto oldest = std::min_element(
        classes_.begin(), classes_.end(), [](const TrafficClass& a, const TrafficClass& b) {
          return a.last_use < b.last_use;
        });
    *oldest = {};
    current_ = static_cast<std::size_t>(oldest - classes_.begin());
  }
  classes_[current_].key = key;
  return classes_[current_];
}

TrafficClasses::TrafficClass& TrafficClasses::class_of(const CsiFragment& fragment) {
  const std::uint64_t key = key_of(fragment);
  if (current_ >= classes_.size() || classes_[current_].key != key) {
    const auto found = std::find_if(
        classes_.begin(), classes_.end(), [key](const TrafficClass& c) { return c.key == key; });
    if (found == classes_.end()) {
      insert(key);
    } else {
      current_ = static_cast<std::size_t>(found - classes_.begin());
    }
  }
  classes_[current_].last_use = ++uses_;
  return classes_[current_];
}

std::optional<std::uint16_t> TrafficClasses::expected_slots(const CsiFragment& fragment) {
  const TrafficClass& traffic = class_of(fragment);
  if (traffic.frames < kWarmUpFrames) {
    return std::nullopt;
  }
  return traffic.slots;
}

void TrafficClasses::frame_closed(const CsiFragment& fragment, std::uint16_t slots) {
  TrafficClass& traffic = class_of(fragment);
  ++traffic.frames;
  unsigned recent = 0;
  for (std::size_t slot = 0; slot < kMaxSlots; ++slot) {
    if (((unsigned{slots} >> slot) & 1U) != 0) {
      traffic.last_frame[slot] = traffic.frames;
    }
    const bool ever_seen = traffic.last_frame[slot] != 0;
    if (ever_seen && traffic.frames - traffic.last_frame[slot] < kMemoryFrames) {
      recent |= 1U << slot;
    }
  }
  traffic.slots = static_cast<std::uint16_t>(recent);
}

void TrafficClasses::slot_seen(const CsiFragment& fragment) {
  TrafficClass& traffic = class_of(fragment);
  if (traffic.frames == 0) {
    return;  // the class of its frame has been removed since
  }
  const std::size_t slot = slot_of(fragment.rx_chain, fragment.stream);
  traffic.last_frame[slot] = traffic.frames;
  traffic.slots = static_cast<std::uint16_t>(traffic.slots | (1U << slot));
}

bool TrafficClasses::repeats_sequence_control(const CsiFragment& fragment) {
  if (fragment.control_frame) {
    return false;
  }
  // A retry is often sent with fewer streams, so all classes of the transmitter are
  // searched.
  const std::uint64_t transmitter = class_of(fragment).key >> kTransmitterShift;
  bool repeats = false;
  for (TrafficClass& traffic : classes_) {
    if (traffic.key >> kTransmitterShift == transmitter) {
      repeats = repeats || traffic.sequence_control == fragment.sequence_control;
      traffic.sequence_control = fragment.sequence_control;
    }
  }
  return repeats;
}

}  // namespace rayloc
