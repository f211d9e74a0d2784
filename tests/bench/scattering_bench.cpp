// Measures the cost of a body in the room.
//
//   BM_Pair        one pair of rays past a round body
//   BM_PairSlopes  the same with its derivatives by where both ends are
//   BM_OvalPair, BM_OvalPairSlopes   past an elliptic one
//   BM_RoundBody, BM_OvalBody        what is computed once for a body
//   BM_PlainLink       paths of a link in the laboratory without a body, tree cached; depth
//   BM_Position        all pairs of the same link past a body, trees cached
//   BM_PositionSlopes  the same with derivatives by the position
//
// The last lines set the pairs beside the plain link, by least times. Build with the release preset
// and -DRAYLOC_BENCHMARKS=ON; one core: `taskset -c 0 scattering_bench`.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "engine/em/cylinder_section.h"
#include "engine/trace/path_tracer.h"
#include "engine/trace/scattering/scattering.h"
#include "tests/bench/best_times.h"
#include "tests/bench/memory.h"
#include "tests/support/laboratory.h"

namespace rayloc::bench {
namespace {

constexpr Complex<double> kSkin{36.0, -13.9};
constexpr double kRadius = 21.7;  // 0.2 m at 5.18 GHz, times the wavenumber
constexpr std::array<double, 2> kOval{23.9, 15.2};
constexpr SectionRays kRays{180.0, 120.0, 0.3, 2.9, 0.9};

void respond(benchmark::State& state, const CylinderSection& section, bool slopes) {
  SectionRays rays = kRays;
  for (auto _ : state) {
    rays.phi_out += 1e-6;
    benchmark::DoNotOptimize(slopes ? section.respond(rays) : section.value(rays));
  }
}

void BM_Pair(benchmark::State& state) {
  respond(state, *make_circular_section(kRadius, kSkin), false);
}
void BM_PairSlopes(benchmark::State& state) {
  respond(state, *make_circular_section(kRadius, kSkin), true);
}
void BM_OvalPair(benchmark::State& state) {
  respond(state, **make_elliptic_section(kOval, kSkin), false);
}
void BM_OvalPairSlopes(benchmark::State& state) {
  respond(state, **make_elliptic_section(kOval, kSkin), true);
}

void BM_RoundBody(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(make_circular_section(kRadius, kSkin));
  }
}
void BM_OvalBody(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(make_elliptic_section(kOval, kSkin));
  }
}

Receiver access_point() { return {{test::laboratory_access_point().pose.position, {}}}; }
Transmitter device() { return {{test::laboratory_positions(8).back(), {}}}; }

void BM_PlainLink(benchmark::State& state) {
  const PathTracer tracer(test::laboratory(), {.max_depth = static_cast<int>(state.range(0))});
  const ReceiverTracer at = tracer.at(access_point());
  Transmitter moved = device();
  std::size_t paths = 0;
  for (auto _ : state) {
    moved.position.x += 1e-6;
    paths = at.trace(moved).size();
    benchmark::DoNotOptimize(paths);
  }
  state.counters["paths"] = static_cast<double>(paths);
}

void position(benchmark::State& state, bool slopes) {
  ScatteringOptions options;
  options.trace.max_depth = static_cast<int>(state.range(0));
  const auto tracer = TargetTracer::create(test::laboratory(), TargetBody{}, options);
  const TargetLink link = tracer->link(device(), access_point());
  const Vec3d place = test::laboratory_positions(9).back();
  TargetPosition at{place.x, place.y};
  std::size_t pairs = 0;
  for (auto _ : state) {
    at.x += 1e-6;
    if (slopes) {
      pairs = link.differentiate(at)->paths.size();
    } else {
      pairs = link.trace(at)->size();
    }
    benchmark::DoNotOptimize(pairs);
  }
  state.counters["pairs"] = static_cast<double>(pairs);
  state.counters["bytes/pair"] =
      static_cast<double>(bytes_of(*link.trace(at))) / static_cast<double>(pairs);
}
void BM_Position(benchmark::State& state) { position(state, false); }
void BM_PositionSlopes(benchmark::State& state) { position(state, true); }

void repeat(benchmark::internal::Benchmark* benchmark) { benchmark->Repetitions(5); }
void in_milliseconds(benchmark::internal::Benchmark* benchmark) {
  benchmark->Apply(repeat)->Unit(benchmark::kMillisecond);
}
void by_depth(benchmark::internal::Benchmark* benchmark) {
  benchmark->DenseRange(1, 3)->Apply(repeat)->Unit(benchmark::kMicrosecond);
}
BENCHMARK(BM_Pair)->Apply(repeat);
BENCHMARK(BM_PairSlopes)->Apply(repeat);
BENCHMARK(BM_OvalPair)->Apply(repeat);
BENCHMARK(BM_OvalPairSlopes)->Apply(repeat);
BENCHMARK(BM_RoundBody)->Apply(in_milliseconds);
BENCHMARK(BM_OvalBody)->Apply(in_milliseconds);
BENCHMARK(BM_PlainLink)->Apply(by_depth);
BENCHMARK(BM_Position)->Apply(by_depth);
BENCHMARK(BM_PositionSlopes)->Apply(by_depth);

void print_summary(const BestTimes& best) {
  for (int depth = 1; depth <= 3; ++depth) {
    const std::string argument = "/" + std::to_string(depth);
    const auto plain = best.find("BM_PlainLink" + argument);
    const auto pairs = best.find("BM_Position" + argument);
    const auto slopes = best.find("BM_PositionSlopes" + argument);
    if (plain && pairs && slopes) {
      std::printf(
          "depth %d: %.0f paths of the plain link %.0f us, %.0f pairs past a body %.0f us (%.0f "
          "bytes each), with derivatives %.0f us: each %.1f, %.1f times a path, CPU\n",
          depth,
          plain->counters.at("paths"),
          1e6 * plain->cpu,
          pairs->counters.at("pairs"),
          1e6 * pairs->cpu,
          pairs->counters.at("bytes/pair"),
          1e6 * slopes->cpu,
          pairs->cpu / pairs->counters.at("pairs") * plain->counters.at("paths") / plain->cpu,
          slopes->cpu / slopes->counters.at("pairs") * plain->counters.at("paths") / plain->cpu);
    }
  }
  print_peak_memory();
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  return rayloc::bench::run_benchmarks(argc, argv, rayloc::bench::print_summary);
}
