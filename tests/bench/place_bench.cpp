// The likelihood of single places (engine/likelihood/box) in the laboratory, one access point, 40
// MHz: microseconds per place, with 8 and 12 places a box. Warm boxes are in the processor's
// caches, cold ones come from memory. Each is set beside what whitening a cell costs in the same
// run, the unit of live_bench.
//
// Build with the release preset and -DRAYLOC_BENCHMARKS=ON.
#include <benchmark/benchmark.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "engine/likelihood/box/place_kernel.h"
#include "engine/likelihood/lane_kernel.h"
#include "engine/room/ray_at_height.h"
#include "engine/trace/path_tracer.h"
#include "tests/bench/best_times.h"
#include "tests/bench/laboratory_room.h"
#include "tests/bench/thousand_cells.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::bench {
namespace {

constexpr std::size_t kColdBoxes = 16'384;  // 67 MB
constexpr std::size_t kMaxPlaces = 12;

struct Prepared {
  std::vector<PlaceBox> boxes;
  DelayRows rows;
  std::size_t delay = 0;
  std::array<float, kMaxPlaces> x;
  std::array<float, kMaxPlaces> y;
  std::array<float, kMaxPlaces> z;

  BoxPlaces places(std::size_t count) const {
    return {std::span(x).first(count), std::span(y).first(count), std::span(z).first(count)};
  }
};

// The boxes differ by the place of their middle only: each has a block of memory of its own.
const Prepared& prepared() {
  static const Prepared kPrepared = [] {
    const RoomModel room = laboratory_room({});
    const RoomAccessPoint& ap = room.access_points[0];
    const ObservationModel model(room.grid, ap.rx_chains.size());
    const std::vector<Vec3d> offsets = offsets_of(ap.array);
    const PathTracer tracer(room.scene, room.trace);
    const auto rays = test::rays_to(tracer, room, ap.array, {4.0, 3.1, 1.2});
    const ObservationModel::Place place{rays, offsets, 0.007, 0.0, 0.014};
    Prepared result;
    for (std::size_t i = 0; i < kColdBoxes; ++i) {
      const double shift = 1e-6 * static_cast<double>(i);
      result.boxes.push_back(
          place_box(model, place, ap.error, {{shift, -shift, 0.0}, {0.05, 0.05, 0.15}}, kBoxRays));
    }
    const auto h = model.expected(place, ap.error);
    result.rows = delay_rows(model.observe(h), h.size());
    BoxBurst burst;
    whiten_delays_of_box(result.boxes[0], result.rows, {}, burst);
    result.delay = burst.delay;
    for (std::size_t i = 0; i < kMaxPlaces; ++i) {
      const float along = static_cast<float>(i) / static_cast<float>(kMaxPlaces) - 0.5F;
      result.x[i] = 0.1F * along;
      result.y[i] = -0.07F * along;
      result.z[i] = 0.3F * along;
    }
    return result;
  }();
  return kPrepared;
}

// Arguments: places a box, boxes in turn. As a moment of a track: prefetched, with a hint, and the
// obstructed case as well.
void BM_Box(benchmark::State& state) {
  const Prepared& p = prepared();
  const auto places = static_cast<std::size_t>(state.range(0));
  const auto boxes = static_cast<std::size_t>(state.range(1));
  std::array<float, kMaxPlaces> values{};
  BoxBurst burst;
  std::size_t next = 0;
  for (auto _ : state) {
    const PlaceBox& box = p.boxes[next];
    next = next + 1 < boxes ? next + 1 : 0;
    fetch(p.boxes[next + 1 < boxes ? next + 1 : 0].block());
    whiten_delays_of_box(box, p.rows, p.delay, burst);
    evaluate_places_of_box(box, burst, p.places(places), std::span(values).first(places));
    benchmark::DoNotOptimize(values);
  }
}
BENCHMARK(BM_Box)
    ->Args({8, 1})
    ->Args({12, 1})
    ->Args({8, kColdBoxes})
    ->Args({12, kColdBoxes})
    ->Unit(benchmark::kNanosecond)
    ->Repetitions(5);

void BM_WhitenABox(benchmark::State& state) {
  const Prepared& p = prepared();
  BoxBurst burst;
  for (auto _ : state) {
    whiten_delays_of_box(p.boxes[0], p.rows, p.delay, burst);
    benchmark::DoNotOptimize(burst);
  }
}
BENCHMARK(BM_WhitenABox)->Unit(benchmark::kNanosecond)->Repetitions(5);

void BM_MakeABox(benchmark::State& state) {
  const RoomModel room = laboratory_room({});
  const RoomAccessPoint& ap = room.access_points[0];
  const ObservationModel model(room.grid, ap.rx_chains.size());
  const std::vector<Vec3d> offsets = offsets_of(ap.array);
  const auto traced =
      test::rays_to(PathTracer(room.scene, room.trace), room, ap.array, {4.0, 3.1, 1.2});
  for (auto _ : state) {
    const auto rays = rays_at_height(traced, 0.15, room.device, ap.array);
    benchmark::DoNotOptimize(place_box(model,
                                       {rays, offsets, 0.007, 0.0, 0.014},
                                       ap.error,
                                       {{0.025, 0.025, 0.0}, {0.05, 0.05, 0.15}}));
  }
}
BENCHMARK(BM_MakeABox)->Unit(benchmark::kMicrosecond)->Repetitions(5);

void BM_ThousandCells(benchmark::State& state) {
  const ThousandCells cells(prepared().rows.coordinates());
  for (auto _ : state) {
    benchmark::DoNotOptimize(cells.whiten_all());
  }
}
BENCHMARK(BM_ThousandCells)->Unit(benchmark::kMicrosecond)->Repetitions(5);

void print_summary(const BestTimes& best) {
  const auto unit = best.find("BM_ThousandCells");
  for (const std::size_t boxes : {std::size_t{1}, kColdBoxes}) {
    for (const std::size_t places : {8U, 12U}) {
      const auto box = best.find("BM_Box/" + std::to_string(places) + "/" + std::to_string(boxes));
      if (box) {
        const double us = 1e6 * box->cpu / static_cast<double>(places);
        std::printf(
            "%zu places a box, %s: %.3f us a place", places, boxes == 1 ? "warm" : "cold", us);
        if (unit) {
          std::printf(", %.2f whitened cells", 1e-3 * us / unit->cpu);
        }
        std::printf("\n");
      }
    }
  }
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  return rayloc::bench::run_benchmarks(argc, argv, rayloc::bench::print_summary);
}
