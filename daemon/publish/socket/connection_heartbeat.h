// When a connection of a server's socket is given up.
#pragma once

namespace rayloc {

// A connection that answers nothing for this long is closed, so that the queue of a machine that
// was switched off does not stay for ever.
inline constexpr int kHeartbeatIntervalMs = 10'000;
inline constexpr int kHeartbeatTimeoutMs = 60'000;

}  // namespace rayloc
