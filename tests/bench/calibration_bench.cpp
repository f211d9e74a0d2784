// The joint calibration of a furnished room beside the bare tracing of all its samples, once: the
// least that one of its rounds can cost.
//
// 3.5 x 2.9 x 2.7 m, arrays of 3 antennas, 128 tones, depth 3. The last lines are of least times.
// Build with the release preset and -DRAYLOC_BENCHMARKS=ON.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <string>
#include <vector>

#include "engine/calibrate/joint/joint_calibration.h"
#include "engine/scene/scene.h"
#include "tests/bench/best_times.h"
#include "tests/bench/memory.h"
#include "tests/support/surveyed_room.h"

namespace rayloc::bench {
namespace {

constexpr int kTones = 128;

// Arguments: points, access points, pieces of furniture.
test::SurveyedRoom room_of(const benchmark::State& state) {
  return test::make_surveyed_room({.points = static_cast<int>(state.range(0)),
                                   .access_points = static_cast<int>(state.range(1)),
                                   .furniture = static_cast<int>(state.range(2)),
                                   .tones = kTones});
}

void BM_Tracing(benchmark::State& state) {
  const test::SurveyedRoom room = room_of(state);
  const RoomUnknowns unknowns(room.plan, {});
  std::vector<SampleSite> sites;
  for (std::size_t p = 0; p < room.points.size(); ++p) {
    for (std::size_t a = 0; a < room.plan.access_points.size(); ++a) {
      sites.push_back({p, a, room.points[p].position});
    }
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(trace_samples(room.plan, unknowns, sites, room.plan.trace));
  }
}

void BM_Calibration(benchmark::State& state) {
  const test::SurveyedRoom room = room_of(state);
  JointCalibrationOptions options;
  options.trace = room.plan.trace;
  options.use = room.plan.trace;
  for (auto _ : state) {
    benchmark::DoNotOptimize(calibrate_jointly(room.plan, room.points, options, {}));
  }
  state.counters["surfaces"] = static_cast<double>(room.plan.scene->surfaces().size());
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->Args({36, 1, 3})->Args({72, 1, 3})->Args({143, 1, 3});
  benchmark->Args({143, 1, 8})->Args({143, 3, 3});
  benchmark->Unit(benchmark::kMillisecond)->Iterations(1)->MeasureProcessCPUTime();
}
BENCHMARK(BM_Tracing)->Apply(sizes);
BENCHMARK(BM_Calibration)->Apply(sizes);

void print_summary(const BestTimes& best) {
  for (const char* size : {"36/1/3", "72/1/3", "143/1/3", "143/1/8", "143/3/3"}) {
    const auto tracing = best.find(std::string("BM_Tracing/") + size);
    const auto calibration = best.find(std::string("BM_Calibration/") + size);
    if (tracing && calibration) {
      std::printf(
          "points/access points/furniture %s, %.0f surfaces: %.2f s, %.2f s of CPU; "
          "traced once %.2f s of CPU: %.0f times\n",
          size,
          calibration->counters.at("surfaces"),
          calibration->wall,
          calibration->cpu,
          tracing->cpu,
          calibration->cpu / tracing->cpu);
    }
  }
  print_peak_memory();
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  return rayloc::bench::run_benchmarks(argc, argv, rayloc::bench::print_summary);
}
