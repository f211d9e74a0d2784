// WorkDone: floating-point operations and bytes of the inner loops of this thread, computed from
// the sizes of each call: input of a roofline plot (tests/bench/live_bench).
//
// A multiply-add is two operations, a root, logarithm or exponential ten. A byte that a call reads
// or writes counts once, independent of its source and of the number of reads.
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
