// The laboratory (10.8 x 5.6 x 3 m) as a calibrated room at 40 MHz, for localization; and the time
// of single calls, since a mean hides the latency of a live system.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include "engine/room/room_model.h"

namespace rayloc::bench {

struct LaboratorySize {
  int depth = 3;
  int access_points = 1;
  double length = 10.8;  // [m], of the bounds of the room along x
  friend auto operator<=>(const LaboratorySize&, const LaboratorySize&) = default;
};

// The size that a benchmark's arguments state: depth, access points, length in millimetres.
inline LaboratorySize size_of(const benchmark::State& state) {
  return {static_cast<int>(state.range(0)),
          static_cast<int>(state.range(1)),
          1e-3 * static_cast<double>(state.range(2))};
}

// Access points are at its northern wall and at the opposite one; chain gains are those that
// test::frames_of() applies.
RoomModel laboratory_room(const LaboratorySize& size);

// Measures the CPU time [ms] of single calls, all threads together: the time of a call on one core
// that nothing else uses. Prints p50 to the maximum.
template <typename Call>
void print_latency(const char* name, int count, const Call& call) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    const std::clock_t begin = std::clock();
    call(i);
    times.push_back(1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  std::sort(times.begin(), times.end());
  const auto at = [&](double share) {
    return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  std::printf("%s, milliseconds of CPU of %d: p50 %.1f, p90 %.1f, p99 %.1f, most %.1f\n",
              name,
              count,
              at(0.5),
              at(0.9),
              at(0.99),
              times.back());
}

}  // namespace rayloc::bench
