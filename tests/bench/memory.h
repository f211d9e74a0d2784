// The memory of paths and of the whole benchmark.
#pragma once

#include <sys/resource.h>

#include <cstddef>
#include <cstdio>

#include "engine/trace/paths.h"

namespace rayloc::bench {

inline std::size_t bytes_of(const Paths& paths) {
  std::size_t bytes = 0;
  for (const Path& path : paths) {
    bytes += sizeof(Path) + path.interactions.capacity() * sizeof(Interaction);
  }
  return bytes;
}

inline void print_peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("peak memory: %.0f MB\n", static_cast<double>(usage.ru_maxrss) / 1e3);
}

}  // namespace rayloc::bench
