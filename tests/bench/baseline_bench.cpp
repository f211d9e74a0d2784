// What the methods that others published cost: a fix of each that locates by single bursts, an
// epoch of each network, in the tests' room (3 x 2.4 m, three access points, 40 MHz), and the
// memory of it all. Widar2.0 and WiTraj work on a stream: their time is that of a replay (the study
// has it). Build with the release preset and -DRAYLOC_BENCHMARKS=ON.
#include <benchmark/benchmark.h>

#include <memory>
#include <utility>
#include <vector>

#include "engine/baselines/cifi/cifi.h"
#include "engine/baselines/dscp/dscp.h"
#include "engine/baselines/m3/m3.h"
#include "engine/baselines/spotfi/spotfi.h"
#include "tests/bench/memory.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::bench {
namespace {

std::shared_ptr<const RoomModel> room() {
  static const auto kRoom = std::make_shared<const RoomModel>(test::make_room());
  return kRoom;
}

const std::vector<CsiFrame>& burst() {
  static const auto kBurst = test::frames_at(*room(), {0.3, -0.2, 1.2}, {.count = 10});
  return kBurst;
}

TrainingInput survey() {
  TrainingInput input;
  input.room = room();
  input.values = {{"epochs", 1.0}};
  unsigned seed = 1;
  for (double x = -1.0; x < 1.05; x += 0.2) {
    for (double y = -0.8; y < 0.85; y += 0.2) {
      input.points.push_back(
          {{x, y, 1.2}, test::frames_at(*room(), {x, y, 1.2}, {.seed = seed++})});
    }
  }
  return input;
}

void spotfi_fix(benchmark::State& state) {
  const auto spotfi = *Spotfi::create(room(), {}, nullptr);
  for (auto _ : state) {
    benchmark::DoNotOptimize(spotfi.locate(burst(), 0));
  }
}

void m3_fix(benchmark::State& state) {
  const auto m3 = *M3::create(room(), {});
  for (auto _ : state) {
    benchmark::DoNotOptimize(m3.locate(burst()));
  }
}

template <auto kTrain, auto kMake>
void place_fix(benchmark::State& state) {
  auto classifier = *kMake(room(), {}, 1, 0.95, *kTrain(survey()));
  for (auto _ : state) {
    benchmark::DoNotOptimize(classifier.locate(burst(), 0));
  }
}

// An epoch with four fifths of the places and one with all.
template <auto kTrain>
void two_epochs(benchmark::State& state) {
  const TrainingInput input = survey();
  for (auto _ : state) {
    benchmark::DoNotOptimize(kTrain(input));
  }
  state.counters["places"] = static_cast<double>(input.points.size());
}

BENCHMARK(spotfi_fix)->Unit(benchmark::kMillisecond);
BENCHMARK(m3_fix)->Unit(benchmark::kMillisecond);
BENCHMARK(place_fix<&train_cifi, &make_cifi>)->Name("cifi_fix")->Unit(benchmark::kMillisecond);
BENCHMARK(place_fix<&train_dscp, &make_dscp>)->Name("dscp_fix")->Unit(benchmark::kMillisecond);
BENCHMARK(two_epochs<&train_cifi>)
    ->Name("cifi_two_epochs")
    ->Unit(benchmark::kSecond)
    ->Iterations(1);
BENCHMARK(two_epochs<&train_dscp>)
    ->Name("dscp_two_epochs")
    ->Unit(benchmark::kSecond)
    ->Iterations(1);

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  rayloc::bench::print_peak_memory();
  return 0;
}
