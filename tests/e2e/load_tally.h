// Counts of the datagrams of a load test, by the daemon's heartbeat and by the sender.
#pragma once

#include <cstdint>
#include <vector>

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

// The same once `sent` datagrams are accounted for: received, or dropped by the kernel. Fails the
// test when they are not, or when something is lost on the way without being counted.
Tally accounted(const LiveDaemon& daemon, std::uint64_t sent);

// The rates of a load test, in the order of its attempts: the first one must hold, and only
// it counts when `variable` states a long run; otherwise the machine may be too busy for
// it.
std::vector<int> rates_of(const char* variable, int first);

// Datagrams by the last line of `rayloc send --json`: {"event":"end","datagrams":150000,...}.
std::uint64_t sent_by(const Process& sender);

}  // namespace rayloc::e2e
