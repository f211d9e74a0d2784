// WorkDone: floating-point operations and bytes of the inner loops of this thread, counted by the
// sizes of each call: what a roofline needs (tests/bench/live_bench).
//
// A multiply-add is two operations, a root, logarithm or exponential ten. A byte that a call reads
// or writes counts once, wherever it comes from and however often the call reads it.
#pragma once

#include <cstddef>

namespace rayloc {

struct WorkDone {
  double flops = 0.0;
  double bytes = 0.0;

  static WorkDone& of_this_thread() {
    thread_local WorkDone done;
    return done;
  }
  static void add(std::size_t flops, std::size_t bytes) {
    WorkDone& done = of_this_thread();
    done.flops += static_cast<double>(flops);
    done.bytes += static_cast<double>(bytes);
  }
};

}  // namespace rayloc
