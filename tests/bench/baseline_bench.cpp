// Measures the cost of published methods: a fix of each method that locates by single bursts, an
// epoch of each network, in the tests' room (3 x 2.4 m, three access points, 40 MHz), and the
// memory of the process. Widar2.0 and WiTraj work on a stream: their time is that of four seconds
// of 400 frames/s of three access points. Build with the release preset and
// -DRAYLOC_BENCHMARKS=ON.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/baselines/cifi/cifi.h"
#include "engine/baselines/dscp/dscp.h"
#include "engine/baselines/m3/m3.h"
#include "engine/baselines/spotfi/spotfi.h"
#include "engine/baselines/widar2/widar2.h"
#include "engine/baselines/witraj/witraj.h"
#include "tests/bench/memory.h"
#include "tests/support/synthetic_room.h"
#include "tests/support/walking_echo.h"

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

constexpr MacAddress kPlug = {{0x02, 0x52, 0x4c, 0x00, 0x00, 0x09}};
constexpr Vec3d kPlace = {1.0, -0.6, 1.2};

// A person on a circle beside the lines of sight.
const std::vector<CsiFrame>& stream() {
  static const auto kStream =
      test::frames_past(*room(), {kPlug, kPlace, 0.3}, 4.0, 0.0025, [](double t) {
        return Vec3d{0.2 + 0.35 * std::cos(1.2 * t), 0.4 + 0.35 * std::sin(1.2 * t), 1.2};
      });
  return kStream;
}

// Bursts of 0.2 s.
template <typename Walker>
void follow(Walker walker, benchmark::State& state) {
  constexpr std::size_t kBurst = 240;
  std::vector<LocationEstimate> out;
  for (std::size_t i = 0; i < stream().size(); i += kBurst) {
    walker.receive(std::span(stream()).subspan(i, std::min(kBurst, stream().size() - i)), out);
  }
  state.counters["estimates"] = static_cast<double>(out.size());
}

void widar2_four_seconds(benchmark::State& state) {
  stream();
  for (auto _ : state) {
    follow(*Widar2::create(room(), {kPlug, kPlace, {0, 1, 2}}, {}), state);
  }
}

void witraj_four_seconds(benchmark::State& state) {
  stream();
  for (auto _ : state) {
    follow(*Witraj::create(room(), {kPlug, kPlace, {0, 1, 2}}, Vec3d{0.55, 0.4, 1.2}, {}), state);
  }
}

BENCHMARK(widar2_four_seconds)->Unit(benchmark::kMillisecond);
BENCHMARK(witraj_four_seconds)->Unit(benchmark::kMillisecond);
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
