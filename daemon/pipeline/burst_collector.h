// BurstCollector: groups the frames of each transmitter, over all access points, into bursts: the
// frames of a few hundred milliseconds that are explained by one position.
//
// A burst starts with a transmitter's first frame and ends `length` later, or when the transmitter
// has been silent for longer than `gap` (INTERFACE 2). Which frames a burst holds depends on
// their times alone.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "engine/channel/csi_frame.h"

namespace rayloc {

struct CollectorOptions {
  Duration length = std::chrono::milliseconds(200);
  Duration gap = std::chrono::milliseconds(250);
  // Frames kept per burst and access point. When a transmitter sends more, every second one is
  // left out, then every fourth ..., so that what is kept spans the burst evenly; the others are
  // counted in Burst::surplus.
  std::size_t max_frames = 64;
  // Transmitters with an open burst; a frame of a further one is refused (`refused()`), so that a
  // flood of made-up addresses costs no memory.
  std::size_t max_transmitters = 256;
  // Whose frames are taken all the same: of a bounded number of transmitters.
  std::function<bool(const MacAddress& transmitter)> wanted = [](const MacAddress&) {
    return false;
  };
};

struct Burst {
  MacAddress transmitter;
  Timestamp first;  // event time of the first and last frame, surplus ones included
  Timestamp last;
  // The first frame of the oldest burst that this one has replaced (BurstQueue), else `first`: the
  // transmitter has not been silent since.
  Timestamp heard_since;
  std::vector<CsiFrame> frames;  // by (time, access point)
  std::uint64_t surplus = 0;

  // How densely the frames of one access point are kept.
  struct Sampling {
    std::uint64_t seen = 0;
    std::uint64_t stride = 1;
    std::size_t kept = 0;
  };
  std::map<int, Sampling> sampling;  // by access point
};

class BurstCollector {
 public:
  explicit BurstCollector(CollectorOptions options) : options_(std::move(options)) {}

  // Adds a frame; appends the bursts that its time ends. REQUIRES: times never decrease.
  void add(CsiFrame&& frame, std::vector<Burst>& ended);

  // No frame before `time` comes any more: appends the bursts that are over, by (end, transmitter).
  void advance(Timestamp time, std::vector<Burst>& ended);

  // Frames of transmitters beyond max_transmitters.
  std::uint64_t refused() const { return refused_; }
  std::size_t open_bursts() const { return open_.size(); }
  // Frames in bursts that are still open.
  std::uint64_t in_flight() const;
  // No burst that ends later has an earlier first frame, if no frame before `time` comes any more.
  Timestamp earliest_open(Timestamp time) const;

 private:
  Timestamp end_of(const Burst& burst) const;
  void keep(Burst& burst, CsiFrame&& frame) const;

  CollectorOptions options_;
  std::map<MacAddress, Burst> open_;
  std::uint64_t refused_ = 0;
};

}  // namespace rayloc
