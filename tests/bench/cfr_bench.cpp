// Complex multiply-adds per second, on one core.
//
// BM_MultiplyAddLimit, the baseline: sums of products of complex numbers in the first-level cache.
// Build with the release preset.
#include <benchmark/benchmark.h>

#include "tests/bench/multiply_add_limit.h"

namespace rayloc::bench {
namespace {

void BM_MultiplyAddLimit(benchmark::State& state) {
  const ComplexFactors factors;
  for (auto _ : state) {
    benchmark::DoNotOptimize(products(factors));
  }
  state.SetItemsProcessed(
      state.iterations() *
      static_cast<std::int64_t>(4 * ComplexFactors::kPasses * ComplexFactors::kSize));
}
BENCHMARK(BM_MultiplyAddLimit)->Repetitions(7)->ReportAggregatesOnly();

}  // namespace
}  // namespace rayloc::bench

BENCHMARK_MAIN();
