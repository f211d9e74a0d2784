// parallel_for: the only concurrency of the engine (oneTBB).
//
// Every index is visited exactly once, in any order and on any thread; each call of `body` writes
// only what belongs to its index. Results are then the same bytes whatever the number of threads.
#pragma once

#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace rayloc {

// body(i) for i in [0, count). `grain`: indices that are worth a task of their own.
template <typename Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&body](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        body(i);
                      }
                    });
}

}  // namespace rayloc
