// BurstCollector: groups the frames of each transmitter, over all access points, into bursts: the
// frames of a few hundred milliseconds that are explained by one position.
//
// A burst starts with a transmitter's first frame and ends `length` later, or when the transmitter
// has been silent for longer than `gap` (INTERFACE 2). The frames of a burst depend on their times
// alone. Its start depends on all earlier frames: a collector that begins in the middle is given
// the bursts that are open there, and then makes the same bursts.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "engine/channel/csi_frame.h"

namespace rayloc {

struct CollectorOptions {
  Duration length = std::chrono::milliseconds(200);
  Duration gap = std::chrono::milliseconds(250);
  // Frames kept per burst, access point and radio channel. When a transmitter sends more, every
  // second one is left out, then every fourth ..., so that the kept frames span the burst evenly;
  // the others are counted in Burst::surplus.
  std::size_t max_frames = 64;
  // Transmitters with an open burst; a frame of a further transmitter is refused (`refused()`), so
  // that a flood of forged addresses costs no memory.
  std::size_t max_transmitters = 256;
  // Transmitters that are accepted beyond the limit; their number is bounded.
  std::function<bool(const MacAddress& transmitter)> wanted = [](const MacAddress&) {
    return false;
  };
};

// An open burst.
struct BurstStart {
  MacAddress transmitter;
  Timestamp first;  // event time of the first and the last frame so far
  Timestamp last;
};

// All bursts that are open at `at`: each has a frame before it and ends after it.
struct OpenBursts {
  Timestamp at = Timestamp::min();
  std::vector<BurstStart> starts;  // by transmitter
};

struct Burst {
  MacAddress transmitter;
  Timestamp first;  // event time of the first and last frame, surplus ones included
  Timestamp last;
  // First frame of the oldest burst that this one has replaced (BurstQueue), otherwise `first`: the
  // transmitter has not been silent since.
  Timestamp received_since;
  std::vector<CsiFrame> frames;  // by (time, access point)
  std::uint64_t surplus = 0;

  // Sampling of the frames of one access point on one channel. A device that hops through its
  // channels in order would otherwise lose the same channels with every second frame.
  struct Sampling {
    std::uint64_t seen = 0;
    std::uint64_t stride = 1;
    std::size_t kept = 0;
  };
  std::map<std::pair<std::size_t, std::optional<RadioChannel>>, Sampling> sampling;
};

class BurstCollector {
 public:
  // `begin`: the bursts that are open where the frames begin. Frames before begin.at are taken if
  // they belong to these; with all of them each burst is as if every frame had been received. Other
  // frames belong to bursts that have already ended, and are passed over.
  explicit BurstCollector(CollectorOptions options, const OpenBursts& begin = {});

  // Adds a frame; appends the bursts that end by its time. REQUIRES: times never decrease.
  void add(CsiFrame&& frame, std::vector<Burst>& ended);

  // No frame before `time` follows: appends the bursts that have ended, by (end, transmitter).
  void advance(Timestamp time, std::vector<Burst>& ended);

  // End of the last open burst if no more frames arrive; Timestamp::min() without open bursts.
  Timestamp latest_end() const;
  // Initial state for a successor that receives the frames from `time` on. REQUIRES: all frames
  // before `time` were added, none after it, and advance(time) was called.
  OpenBursts open_starts(Timestamp time) const;

  // Frames of bursts that had ended before the first frame that counts.
  std::uint64_t passed_over() const { return passed_over_; }
  // Frames of transmitters beyond max_transmitters.
  std::uint64_t refused() const { return refused_; }
  std::size_t open_bursts() const { return open_.size(); }
  // Frames in bursts that are still open.
  std::uint64_t in_flight() const;
  // Lower bound of the first frames of bursts that end later, if no frame before `time` follows.
  Timestamp earliest_open(Timestamp time) const;

 private:
  Timestamp end_of(const Burst& burst) const;
  void keep(Burst& burst, CsiFrame&& frame) const;

  CollectorOptions options_;
  Timestamp begin_;
  std::map<MacAddress, Burst> open_;
  std::uint64_t passed_over_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace rayloc
