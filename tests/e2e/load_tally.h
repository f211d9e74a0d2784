// What became of the datagrams of a load test, by the daemon's heartbeat and by the sender.
#pragma once

#include <cstdint>

#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e {

// Counters of the first source.
struct Tally {
  std::uint64_t received = 0;
  std::uint64_t rejected = 0;
  std::uint64_t kernel_drops = 0;
  std::uint64_t ring_dropped = 0;
  std::uint64_t processed = 0;
  std::uint64_t in_flight = 0;
  std::uint64_t frames = 0;
  std::uint64_t frames_dropped = 0;
  std::uint64_t frames_processed = 0;
  std::uint64_t frames_in_flight = 0;

  std::uint64_t lost() const { return rejected + kernel_drops + ring_dropped + frames_dropped; }
};

Tally tally_of(const nlohmann::json& heartbeat);

// Fails the test when datagrams or frames are unaccounted for.
void expect_conserved(const Tally& tally);

// The counters once nothing is on its way any more; those of the last heartbeat when that does
// not come.
Tally settled(const LiveDaemon& daemon);

// Of the line that ends what `rayloc send --json` says: {"event":"end","datagrams":150000,...}.
std::uint64_t sent_by(const Process& sender);

}  // namespace rayloc::e2e
