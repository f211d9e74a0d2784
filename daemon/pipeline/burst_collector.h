// BurstCollector: groups the frames of each transmitter, over all access points, into bursts: the
// frames of a few hundred milliseconds that are explained by one position.
//
// A burst starts with a transmitter's first frame and ends `length` later, or when the transmitter
// has been silent for longer than `gap` (INTERFACE 2). Which frames a burst holds depends on
// their times alone. So does where one starts, but on all that came before: who begins in the
// middle is told of the bursts that were open there, and then makes the same ones.
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
  // second one is left out, then every fourth ..., so that what is kept spans the burst evenly; the
  // others are counted in Burst::surplus.
  std::size_t max_frames = 64;
  // Transmitters with an open burst; a frame of a further one is refused (`refused()`), so that a
  // flood of made-up addresses costs no memory.
  std::size_t max_transmitters = 256;
  // Whose frames are taken all the same: of a bounded number of transmitters.
  std::function<bool(const MacAddress& transmitter)> wanted = [](const MacAddress&) {
    return false;
  };
};

// Of a burst that is open.
struct BurstStart {
  MacAddress transmitter;
  Timestamp first;  // event time of the first and the last frame so far
  Timestamp last;
};

// All that were open at `at`: they had a frame before it, and end behind it.
struct OpenBursts {
  Timestamp at = Timestamp::min();
  std::vector<BurstStart> starts;  // by transmitter
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

  // How densely the frames of one access point on one channel are kept: of a device that hops in
  // turn, every second frame of all would be the same channels' again.
  struct Sampling {
    std::uint64_t seen = 0;
    std::uint64_t stride = 1;
    std::size_t kept = 0;
  };
  std::map<std::pair<int, std::optional<RadioChannel>>, Sampling> sampling;
};

class BurstCollector {
 public:
  // `begin`: what was open where the frames begin. Of frames before begin.at, those of its bursts
  // are taken; with all of them each burst is as if everything had been heard. The others belong to
  // bursts that were over, and are passed over.
  explicit BurstCollector(CollectorOptions options, const OpenBursts& begin = {});

  // Adds a frame; appends the bursts that its time ends. REQUIRES: times never decrease.
  void add(CsiFrame&& frame, std::vector<Burst>& ended);

  // No frame before `time` comes any more: appends the bursts that are over, by (end, transmitter).
  void advance(Timestamp time, std::vector<Burst>& ended);

  // When the last of the open bursts ends if nothing more is heard; Timestamp::min() without any.
  Timestamp latest_end() const;
  // What a successor that hears the frames from `time` on has to begin with. REQUIRES: all frames
  // before `time` were added, none after it, and advance(time) was called.
  OpenBursts open_starts(Timestamp time) const;

  // Frames of bursts that were over before the first frame that counts.
  std::uint64_t passed_over() const { return passed_over_; }
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
  Timestamp begin_;
  std::map<MacAddress, Burst> open_;
  std::uint64_t passed_over_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace rayloc
