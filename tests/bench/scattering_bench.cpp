// What a body in the room costs.
//
//   BM_Pair        one pair of rays past a round body
//   BM_PairSlopes  the same with its derivatives by where both ends are
//   BM_OvalPair, BM_OvalPairSlopes   past an elliptic one
//   BM_RoundBody, BM_OvalBody        what is computed once for a body
//   BM_Position    all pairs of a link in the laboratory, trees cached; argument: depth
//   BM_PositionSlopes                the same with derivatives by the position
//
// Build with the release preset and -DRAYLOC_BENCHMARKS=ON; one core: `taskset -c 0
// scattering_bench`.
#include <benchmark/benchmark.h>

#include <array>
#include <memory>
#include <utility>

#include "engine/em/cylinder_section.h"
#include "engine/trace/scattering.h"
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

void position(benchmark::State& state, bool slopes) {
  ScatteringOptions options;
  options.trace.max_depth = static_cast<int>(state.range(0));
  const auto tracer = TargetTracer::create(test::laboratory(), TargetBody{}, options);
  const Receiver receiver{{test::laboratory_access_point().pose.position, {}}};
  const Transmitter device{{test::laboratory_positions(8).back(), {}}};
  const TargetLink link = tracer->link(device, receiver);
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
}
void BM_Position(benchmark::State& state) { position(state, false); }
void BM_PositionSlopes(benchmark::State& state) { position(state, true); }

BENCHMARK(BM_Pair);
BENCHMARK(BM_PairSlopes);
BENCHMARK(BM_OvalPair);
BENCHMARK(BM_OvalPairSlopes);
BENCHMARK(BM_RoundBody)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_OvalBody)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Position)->DenseRange(1, 3)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_PositionSlopes)->DenseRange(1, 3)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace rayloc::bench

BENCHMARK_MAIN();
