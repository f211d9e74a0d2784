// Throughput of the machine without a daemon, printed beside that with one: the same sizes, the
// same queues, nothing between.
#pragma once

namespace rayloc::e2e {

// Datagrams a second over loopback by sendmmsg(2) and recvmmsg(2), with nothing behind them.
void print_recvmmsg_alone();

// Frames of CSI a second by a publisher in this process to five subscribers, with nothing before
// it; what was delivered to them, and what they lost because it was faster. `high_water_mark`: of
// each subscriber's queue.
void print_xpub_alone(int high_water_mark);

}  // namespace rayloc::e2e
