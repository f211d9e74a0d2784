// Complex multiply-adds per second, on one core: one for each path and tone.
//
// BM_MultiplyAddLimit, the baseline: sums of products of complex numbers in the first-level cache.
// BM_Forward, BM_Adjoint: the kernel for three antennas, each with the paths and tones stated.
// All with the widest vectors of this processor, or those that --target=NAME (AVX2, SSE4, ...)
// names. The last lines are the ratios of the medians, of CPU time. Build with the release preset.
#include <benchmark/benchmark.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <map>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include <hwy/highway.h>

#include "engine/trace/cfr_kernel.h"
#include "tests/bench/multiply_add_limit.h"
#include "tests/support/path_columns.h"

namespace rayloc::bench {
namespace {

constexpr std::size_t kAntennas = 3;

// As many paths as the first argument of the benchmark.
test::PathColumns some_paths(const benchmark::State& state) {
  test::PathColumns paths;
  for (std::int64_t p = 0; p < state.range(0); ++p) {
    const auto u = static_cast<double>(p);
    paths.add(std::polar(1e-3, 1.7 * u), 10e-9 + 190e-9 * (std::sin(u * u) + 1.0));
  }
  return paths;
}

OfdmGrid neighbouring_tones(std::size_t size) {
  OfdmGrid grid{5.25e9, 312'500.0, std::vector<std::int16_t>(size)};
  std::iota(grid.tone_index.begin(), grid.tone_index.end(), std::int16_t{-64});
  return grid;
}

void count_path_tones(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * state.range(0) * state.range(1) *
                          static_cast<std::int64_t>(kAntennas));
}

void BM_MultiplyAddLimit(benchmark::State& state) {
  const ComplexFactors factors;
  for (auto _ : state) {
    benchmark::DoNotOptimize(products(factors));
  }
  state.SetItemsProcessed(
      state.iterations() *
      static_cast<std::int64_t>(4 * ComplexFactors::kPasses * ComplexFactors::kSize));
}

void BM_Forward(benchmark::State& state) {
  const test::PathColumns paths = some_paths(state);
  const CfrKernel kernel(neighbouring_tones(static_cast<std::size_t>(state.range(1))));
  std::vector<std::complex<double>> h(kernel.num_tones());
  for (auto _ : state) {
    for (std::size_t antenna = 0; antenna < kAntennas; ++antenna) {
      kernel.forward(paths.arrays(), h);
      benchmark::DoNotOptimize(h.data());
      benchmark::ClobberMemory();
    }
  }
  count_path_tones(state);
}

void BM_Adjoint(benchmark::State& state) {
  const test::PathColumns paths = some_paths(state);
  const CfrKernel kernel(neighbouring_tones(static_cast<std::size_t>(state.range(1))));
  const std::vector<std::complex<double>> g(kernel.num_tones(), {0.6, -0.8});
  for (auto _ : state) {
    for (std::size_t antenna = 0; antenna < kAntennas; ++antenna) {
      benchmark::DoNotOptimize(kernel.adjoint(paths.arrays(), g));
    }
  }
  count_path_tones(state);
}

void repeat(benchmark::internal::Benchmark* benchmark) {
  benchmark->Repetitions(7)->ReportAggregatesOnly()->Unit(benchmark::kMicrosecond);
}
void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->Apply(repeat)->ArgNames({"paths", "tones"});
  benchmark->Args({20, 128})->Args({150, 128})->Args({150, 57})->Args({2000, 2000});
}
BENCHMARK(BM_MultiplyAddLimit)->Apply(repeat);
BENCHMARK(BM_Forward)->Apply(sizes);
BENCHMARK(BM_Adjoint)->Apply(sizes);

// Prints as the console does, and keeps the medians.
class MedianReporter final : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      const auto rate = run.counters.find("items_per_second");
      if (run.aggregate_name == "median" && rate != run.counters.end()) {
        medians_[run.run_name.function_name + " " + run.run_name.args] = rate->second.value;
      }
    }
    ConsoleReporter::ReportRuns(runs);
  }

  void print_ratios() const {
    const auto limit = medians_.find("BM_MultiplyAddLimit ");
    if (limit == medians_.end()) {
      return;
    }
    for (const auto& [name, rate] : medians_) {
      std::printf(
          "%-42s %5.2f G/s, %.2f of the limit\n", name.c_str(), rate / 1e9, rate / limit->second);
    }
  }

 private:
  std::map<std::string, double> medians_;
};

// False when no code for a processor of this name can run here.
bool choose_target(std::string_view name) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (name == hwy::TargetName(target)) {
      hwy::SetSupportedTargetsForTest(target);
      return true;
    }
  }
  return false;
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  constexpr std::string_view kTarget = "--target=";
  benchmark::Initialize(&argc, argv);
  if (argc == 2 && std::string_view(argv[1]).starts_with(kTarget)) {
    if (!rayloc::bench::choose_target(std::string_view(argv[1]).substr(kTarget.size()))) {
      std::fprintf(stderr, "cfr_bench: %s does not run here\n", argv[1]);
      return 1;
    }
  } else if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 1;
  }
  rayloc::bench::MedianReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.print_ratios();
}
