// parallel_for, concurrency and serially: with kept.h the only concurrency of the engine (oneTBB).
//
// parallel_for: every index is visited exactly once, in any order and on any thread; each
// call of `body` writes only the data of its index. Results are then the same bytes for any
// number of threads.
#pragma once

#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace rayloc {

// body(i) for i in [0, count). `grain`: number of indices worth a separate task.
template <typename Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&body](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        body(i);
                      }
                    });
}

// Threads that parallel_for may use, including its caller's: a count. No result depends on it.
inline std::size_t concurrency() {
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

// body() without other threads, for a library that would otherwise use some and depend
// on their number.
template <typename Body>
void serially(const Body& body) {
  tbb::task_arena(1).execute(body);
}

}  // namespace rayloc
