// Paths over one edge, beside paths without: laboratory, 3 antennas, depth 3.
//
//   BM_Find      wedges of the scene
//   BM_Cold      from the scene's tracer to the paths of a device: what both ends light, and paths
//   BM_Cached    paths of 143 positions in turn, in trees that have been asked for them before
//   BM_Gradient  the same with the derivatives of every path by the device's place in plan
//
// Each with (1) and without (0) edges. The last lines are of least times. Build with the release
// preset and -DRAYLOC_BENCHMARKS=ON.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "engine/scene/wedges.h"
#include "engine/trace/array_tracer.h"
#include "engine/trace/interactions/interaction.h"
#include "tests/bench/best_times.h"
#include "tests/support/laboratory.h"

namespace rayloc::bench {
namespace {

constexpr std::size_t kSurveyed = 143;
constexpr int kDepth = 3;
constexpr std::size_t kUntilKnown = 6;  // rounds; trees learn where they are asked often
const std::array<Parameter, 2> kPlan{Parameter::transmitter_position(0),
                                     Parameter::transmitter_position(1)};

TraceOptions options_of(const benchmark::State& state) {
  return {.max_depth = kDepth, .diffraction = state.range(0) != 0};
}

Transmitter device_at(const Vec3d& position) { return Transmitter{{position, {}}}; }

void BM_Find(benchmark::State& state) {
  const auto scene = test::laboratory();
  for (auto _ : state) {
    benchmark::DoNotOptimize(find_wedges(*scene));
  }
}

void BM_Cold(benchmark::State& state) {
  const PathTracer tracer(test::laboratory(), options_of(state));
  const Transmitter device = device_at(test::laboratory_positions(1).front());
  for (auto _ : state) {
    const ArrayTracer array(tracer, test::laboratory_access_point());
    benchmark::DoNotOptimize(array.trace(device));
  }
}

// Paths to an antenna, and those of them over an edge, of a place on average.
void count_paths(const ArrayTracer& array,
                 const std::vector<Vec3d>& positions,
                 benchmark::State& state) {
  std::size_t paths = 0;
  std::size_t edges = 0;
  for (const Vec3d& position : positions) {
    for (const Paths& link : array.trace(device_at(position))) {
      paths += link.size();
      for (const Path& path : link) {
        const bool bends = std::any_of(path.interactions.begin(),
                                       path.interactions.end(),
                                       [](const Interaction& i) { return is_edge(i.kind); });
        edges += bends ? 1U : 0U;
      }
    }
  }
  const auto links = static_cast<double>(positions.size() * array.element_count());
  state.counters["paths"] = static_cast<double>(paths) / links;
  state.counters["edges"] = static_cast<double>(edges) / links;
}

// An array that has been asked for all positions often.
struct WarmArray {
  explicit WarmArray(const TraceOptions& options)
      : tracer(test::laboratory(), options), array(tracer, test::laboratory_access_point()) {
    for (std::size_t i = 0; i < kUntilKnown * kSurveyed; ++i) {
      benchmark::DoNotOptimize(array.trace(device_at(positions[i % kSurveyed])));
    }
  }
  std::vector<Vec3d> positions = test::laboratory_positions(kSurveyed);
  PathTracer tracer;
  ArrayTracer array;
};

void run_cached(benchmark::State& state, bool differentiate) {
  static std::array<std::unique_ptr<const WarmArray>, 2> arrays;  // without and with edges
  auto& warm = arrays[state.range(0) != 0 ? 1 : 0];
  if (warm == nullptr) {
    warm = std::make_unique<const WarmArray>(options_of(state));
  }
  std::size_t next = 0;
  for (auto _ : state) {
    const Transmitter device = device_at(warm->positions[next++ % kSurveyed]);
    const std::vector<Paths> paths = warm->array.trace(device);
    benchmark::DoNotOptimize(paths);
    if (differentiate) {
      benchmark::DoNotOptimize(warm->array.differentiate(device, paths, kPlan));
    }
  }
  count_paths(warm->array, warm->positions, state);
}

void BM_Cached(benchmark::State& state) { run_cached(state, false); }
void BM_Gradient(benchmark::State& state) { run_cached(state, true); }

void repeat(benchmark::internal::Benchmark* benchmark) {
  benchmark->Repetitions(7)->UseRealTime()->MeasureProcessCPUTime();
}
void both(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(0)->Arg(1)->Apply(repeat)->Unit(benchmark::kMicrosecond);
}
BENCHMARK(BM_Find)->Apply(repeat)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Cold)->Apply(both);
BENCHMARK(BM_Cached)->Apply(both);
BENCHMARK(BM_Gradient)->Apply(both);

void print_summary(const BestTimes& best) {
  for (const char* name : {"Cold", "Cached", "Gradient"}) {
    const auto without = best.find(std::string("BM_") + name + "/0");
    const auto with = best.find(std::string("BM_") + name + "/1");
    if (without && with) {
      std::printf("%s: %.0f us of wall clock, %.0f of CPU; without edges %.0f, %.0f\n",
                  name,
                  1e6 * with->wall,
                  1e6 * with->cpu,
                  1e6 * without->wall,
                  1e6 * without->cpu);
    }
  }
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  return rayloc::bench::run_benchmarks(argc, argv, rayloc::bench::print_summary);
}
