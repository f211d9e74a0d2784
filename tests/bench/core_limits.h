// The measured limits of one core: the roof over an inner loop.
#pragma once

namespace rayloc::bench {

struct CoreLimits {
  double flops = 0.0;  // [1/s], of multiply-adds in single precision, by its widest vectors
  double bytes = 0.0;  // [1/s], read in order from memory that no cache holds
};

// Returns the best of some tries, by the CPU time of this thread; takes a second.
CoreLimits core_limits();

}  // namespace rayloc::bench
