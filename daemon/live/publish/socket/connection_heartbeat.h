// Time-out of a connection of a server's socket.
#pragma once

namespace rayloc {

// A connection that answers nothing for this long is closed, so that the queue of a machine that
// was switched off is freed.
inline constexpr int kHeartbeatIntervalMs = 10'000;
inline constexpr int kHeartbeatTimeoutMs = 60'000;

}  // namespace rayloc
