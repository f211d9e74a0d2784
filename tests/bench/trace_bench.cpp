// The tracer, beside what it could not be faster than.
//
//   BM_BareEmbree     the segments of shot rays by Embree alone (bare_shooting.h)
//   BM_Shooting       the same rays, with the sequences of surfaces that they meet (shooting.h)
//   BM_KnownPaths     paths whose surfaces are known (known_paths.h), 143 positions in turn
//   BM_CachedLink     the same found, in trees that have been asked for them before
//   BM_NewPlace       the same, queried the first time, and the fifth, when trees search closely
//   BM_ColdLink       trees and paths of devices in the laboratory, three antennas, depth 3
//   BM_RadioMap       10,000 cells of office floors of 100 to 100,000 triangles, tree included
//   BM_Depth          tree and paths of one antenna, 1 to 6 reflections, laboratory
//   BM_Triangles      the same at depth 3 in office floors of 100 to 100,000 triangles
//   BM_Receivers      the same for 1 to 10,000 positions in the laboratory
//
// The last four, each with what else would do the job on the same threads:
//   ...Rays           the same rays by Embree alone, from each antenna, and then known paths
//   ...Images         the plain image method (plain_image_method.h), where it ends
//
// The last lines are of least times. Build with the release preset and
// -DRAYLOC_BENCHMARKS=ON; one core: `taskset -c 0 trace_bench`.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/room/radio_map.h"
#include "engine/trace/array_tracer.h"
#include "engine/trace/images/image_tree.h"
#include "engine/trace/images/shooting.h"
#include "engine/trace/path_tracer.h"
#include "tests/bench/bare_shooting.h"
#include "tests/bench/best_times.h"
#include "tests/bench/known_paths.h"
#include "tests/bench/plain_image_method.h"
#include "tests/support/laboratory.h"
#include "tests/support/office_floor.h"

namespace rayloc::bench {
namespace {

constexpr std::size_t kRays = 1U << 18U;
constexpr std::size_t kSurveyed = 143;
constexpr int kDepth = 3;

struct Room {
  std::shared_ptr<const Scene> scene;
  Vec3d access_point;
};

// 0: the laboratory; else an office floor of so many triangles.
Room room(std::int64_t triangles) {
  if (triangles == 0) {
    return {test::laboratory(), test::laboratory_access_point().pose.position};
  }
  return {test::office_floor(static_cast<std::size_t>(triangles)), test::office_access_point()};
}

Transmitter device_at(const Vec3d& position) { return Transmitter{{position, {}}}; }

// The last reflection of a ray proposes nothing after it: as many segments as reflections.
void BM_BareEmbree(benchmark::State& state) {
  const Room where = room(state.range(0));
  const BareShooting bare(*where.scene);
  const auto directions = lattice_directions(kRays);
  std::size_t segments = 0;
  for (auto _ : state) {
    segments = bare.shoot(where.access_point, directions, kDepth - 1);
    benchmark::DoNotOptimize(segments);
  }
  state.counters["segments"] = static_cast<double>(segments);
}

void BM_Shooting(benchmark::State& state) {
  const Room where = room(state.range(0));
  const TraceOptions options{.max_depth = kDepth, .rays = kRays};
  ShotMirrors shot = shoot_mirrors(*where.scene, where.access_point, options);  // builds the scene
  for (auto _ : state) {
    shot = shoot_mirrors(*where.scene, where.access_point, options);
    benchmark::DoNotOptimize(shot);
  }
  state.counters["segments"] = static_cast<double>(shot.segments);
  state.counters["sequences"] = static_cast<double>(shot.trie.size() - 1);
}

std::vector<Receiver> antennas() {
  return array_elements<Receiver>(test::laboratory_access_point());
}

// The paths from every position to every antenna.
using KnownLinks = std::vector<std::vector<KnownPaths>>;

KnownLinks known_links(const PathTracer& tracer,
                       const std::vector<Vec3d>& positions,
                       const std::vector<Receiver>& receivers) {
  KnownLinks links(positions.size());
  for (const Receiver& receiver : receivers) {
    const ReceiverTracer at = tracer.at(receiver);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      links[i].emplace_back(at, tracer, device_at(positions[i]));
    }
  }
  return links;
}

void evaluate(const std::vector<KnownPaths>& links) {
  for (const KnownPaths& link : links) {
    benchmark::DoNotOptimize(link.evaluate());
  }
}

void BM_KnownPaths(benchmark::State& state) {
  const PathTracer tracer(test::laboratory(), {.max_depth = kDepth});
  const KnownLinks links = known_links(tracer, test::laboratory_positions(kSurveyed), antennas());
  std::size_t next = 0;
  for (auto _ : state) {
    evaluate(links[next++ % kSurveyed]);
  }
  std::size_t paths = 0;
  for (const std::vector<KnownPaths>& position : links) {
    for (const KnownPaths& link : position) {
      paths += link.size();
    }
  }
  state.counters["paths"] = static_cast<double>(paths) / kSurveyed;
}

// From nothing but the scene to the paths of `state.range(0)` positions.
void BM_ColdLink(benchmark::State& state) {
  const PathTracer tracer(test::laboratory(), {.max_depth = kDepth});
  const auto positions = test::laboratory_positions(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    const ArrayTracer array(tracer, test::laboratory_access_point());
    parallel_for(positions.size(), 1, [&](std::size_t i) {
      benchmark::DoNotOptimize(array.trace(device_at(positions[i])));
    });
  }
}

// One position after the other, each in a part of the room of its own.
void BM_CachedLink(benchmark::State& state) {
  const PathTracer tracer(test::laboratory(), {.max_depth = kDepth});
  const auto positions = test::laboratory_positions(kSurveyed);
  const ArrayTracer array(tracer, test::laboratory_access_point());
  constexpr std::size_t kUntilKnown = 6;  // rounds; the trees learn where they are asked often
  for (std::size_t i = 0; i < kUntilKnown * kSurveyed; ++i) {
    benchmark::DoNotOptimize(array.trace(device_at(positions[i % kSurveyed])));
  }
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(array.trace(device_at(positions[next++ % kSurveyed])));
  }
}

// All positions once, in trees that have been asked for each `state.range(0)` - 1 times.
void BM_NewPlace(benchmark::State& state) {
  const PathTracer tracer(test::laboratory(), {.max_depth = kDepth});
  const auto positions = test::laboratory_positions(kSurveyed);
  for (auto _ : state) {
    state.PauseTiming();
    const ArrayTracer array(tracer, test::laboratory_access_point());
    for (std::int64_t round = 1; round <= state.range(0); ++round) {
      if (round == state.range(0)) {
        state.ResumeTiming();
      }
      for (const Vec3d& position : positions) {
        benchmark::DoNotOptimize(array.trace(device_at(position)));
      }
    }
  }
}

// The baseline by rays. Beyond kSurveyed positions, the paths of the first ones are reused.
void by_rays(benchmark::State& state,
             const PathTracer& tracer,
             const std::vector<Receiver>& receivers,
             const std::vector<Vec3d>& positions) {
  const BareShooting bare(tracer.scene());
  const auto directions = lattice_directions(kRays);
  const std::vector<Vec3d> first(
      positions.begin(),
      positions.begin() + static_cast<std::ptrdiff_t>(std::min(positions.size(), kSurveyed)));
  const KnownLinks links = known_links(tracer, first, receivers);
  for (auto _ : state) {
    for (const Receiver& receiver : receivers) {
      benchmark::DoNotOptimize(
          bare.shoot(receiver.position, directions, tracer.options().max_depth - 1));
    }
    parallel_for(positions.size(), 1, [&](std::size_t i) { evaluate(links[i % first.size()]); });
  }
}

// The baseline by the plain image method.
void by_images(benchmark::State& state,
               const PathTracer& tracer,
               const std::vector<Receiver>& receivers,
               const std::vector<Vec3d>& positions) {
  const PlainImageMethod plain(tracer.scene(), tracer.options().max_depth);
  std::vector<std::size_t> paths(receivers.size() * positions.size());
  for (auto _ : state) {
    parallel_for(paths.size(), 1, [&](std::size_t i) {
      paths[i] = plain.count_paths(receivers[i % receivers.size()].position,
                                   positions[i / receivers.size()]);
    });
  }
  state.counters["paths"] = static_cast<double>(paths[0]);
}

using Baseline = decltype(by_rays);

template <Baseline kBaseline>
void BM_ColdLinkBy(benchmark::State& state) {
  const PathTracer tracer(test::laboratory(), {.max_depth = kDepth});
  kBaseline(state,
            tracer,
            antennas(),
            test::laboratory_positions(static_cast<std::size_t>(state.range(0))));
}

template <Baseline kBaseline>
void BM_DepthBy(benchmark::State& state) {
  const Room where = room(0);
  const PathTracer tracer(where.scene, {.max_depth = static_cast<int>(state.range(0))});
  kBaseline(state, tracer, {Receiver{{where.access_point, {}}}}, test::laboratory_positions(1));
}

template <Baseline kBaseline>
void BM_TrianglesBy(benchmark::State& state) {
  const Room where = room(state.range(0));
  const PathTracer tracer(where.scene, {.max_depth = kDepth});
  kBaseline(state, tracer, {Receiver{{where.access_point, {}}}}, {test::office_device()});
}

template <Baseline kBaseline>
void BM_ReceiversBy(benchmark::State& state) {
  const Room where = room(0);
  const PathTracer tracer(where.scene, {.max_depth = kDepth});
  kBaseline(state,
            tracer,
            {Receiver{{where.access_point, {}}}},
            test::laboratory_positions(static_cast<std::size_t>(state.range(0))));
}

ImageTree tree_of(const Room& where, int depth) {
  return ImageTree(*where.scene, where.access_point, {.max_depth = depth, .rays = kRays});
}

// The measure of growth: the tree and the paths of one position, one antenna.
void grow(benchmark::State& state, const Room& where, const Vec3d& device, int depth) {
  const PathTracer tracer(where.scene, {.max_depth = depth, .rays = kRays});
  const Receiver receiver{{where.access_point, {}}};
  std::size_t paths = 0;
  for (auto _ : state) {
    paths = tracer.trace(device_at(device), receiver).size();
  }
  const ImageTree tree = tree_of(where, depth);
  state.counters["paths"] = static_cast<double>(paths);
  state.counters["images"] = static_cast<double>(tree.size());
  state.counters["shot"] = tree.generator() == CandidateGenerator::kShooting ? 1.0 : 0.0;
  state.counters["MB"] = static_cast<double>(tree.bytes()) / 1e6;
}

void BM_Depth(benchmark::State& state) {
  grow(state, room(0), test::laboratory_positions(1)[0], static_cast<int>(state.range(0)));
}

void BM_Triangles(benchmark::State& state) {
  grow(state, room(state.range(0)), test::office_device(), kDepth);
}

// Paths to so many places of a room, tree included, one antenna.
void BM_Receivers(benchmark::State& state) {
  const PathTracer tracer(test::laboratory(), {.max_depth = kDepth});
  const auto positions = test::laboratory_positions(static_cast<std::size_t>(state.range(0)));
  const Receiver receiver{{test::laboratory_access_point().pose.position, {}}};
  std::vector<Paths> paths(positions.size());
  for (auto _ : state) {
    const ReceiverTracer at = tracer.at(receiver);
    parallel_for(
        positions.size(), 1, [&](std::size_t i) { paths[i] = at.trace(device_at(positions[i])); });
    state.counters["MB"] = static_cast<double>(at.tree().bytes()) / 1e6;
  }
  std::size_t count = 0;
  std::size_t bytes = 0;
  for (const Paths& link : paths) {
    count += link.size();
    for (const Path& path : link) {
      bytes += sizeof(Path) + path.interactions.capacity() * sizeof(Interaction);
    }
  }
  state.counters["bytes/path"] = static_cast<double>(bytes) / static_cast<double>(count);
}

// A map of an office floor in about 10,000 cells, tree included, on all cores.
void BM_RadioMap(benchmark::State& state) {
  constexpr double kCells = 10'000.0;
  const Room where = room(state.range(0));
  const PathTracer tracer(where.scene, {.max_depth = kDepth, .rays = kRays});
  const Vec3d lower = where.scene->bounds_min();
  const Vec3d upper = where.scene->bounds_max();
  const double step = std::sqrt((upper.x - lower.x) * (upper.y - lower.y) / kCells);
  const RadioMapGrid grid = radio_map_grid(lower, upper, test::office_device().z, step);
  AntennaArray array;
  array.pose.position = where.access_point;
  array.element_offset = {Vec3d{}};
  std::size_t received = 0;
  for (auto _ : state) {
    const RadioMap map = radio_map(tracer, array, grid);
    received = static_cast<std::size_t>(std::count_if(
        map.path_gain.begin(), map.path_gain.end(), [](double g) { return g > 0.0; }));
  }
  state.counters["cells"] = static_cast<double>(grid.size());
  state.counters["received"] = static_cast<double>(received);
}

void repeat(benchmark::internal::Benchmark* benchmark) {
  benchmark->Repetitions(7)->UseRealTime()->MeasureProcessCPUTime();
}
void in_rooms(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(0)->Arg(1000)->Arg(100'000)->Apply(repeat)->Unit(benchmark::kMillisecond);
}
void in_ms(benchmark::internal::Benchmark* benchmark) {
  benchmark->Apply(repeat)->Unit(benchmark::kMillisecond);
}
template <int kFirst, int kLast>
void by_tens(benchmark::internal::Benchmark* benchmark) {
  benchmark->RangeMultiplier(10)->Range(kFirst, kLast)->Apply(in_ms);
}
BENCHMARK(BM_BareEmbree)->Apply(in_rooms);
BENCHMARK(BM_Shooting)->Apply(in_rooms);
BENCHMARK(BM_KnownPaths)->Apply(repeat)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_ColdLink)->Arg(1)->Arg(kSurveyed)->Apply(in_ms);
BENCHMARK(BM_CachedLink)->Apply(repeat)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_NewPlace)->Arg(1)->Arg(5)->Apply(in_ms);
BENCHMARK(BM_Depth)->DenseRange(1, 6)->Apply(in_ms);
BENCHMARK(BM_Triangles)->Apply(by_tens<100, 100'000>);
BENCHMARK(BM_RadioMap)->Apply(by_tens<100, 100'000>);
BENCHMARK(BM_Receivers)->Apply(by_tens<1, 10'000>);

BENCHMARK(BM_ColdLinkBy<by_rays>)->Name("BM_ColdLinkRays")->Arg(1)->Arg(kSurveyed)->Apply(in_ms);
BENCHMARK(BM_ColdLinkBy<by_images>)->Name("BM_ColdLinkImages")->Arg(1)->Apply(in_ms);
BENCHMARK(BM_DepthBy<by_rays>)->Name("BM_DepthRays")->DenseRange(1, 6)->Apply(in_ms);
BENCHMARK(BM_DepthBy<by_images>)->Name("BM_DepthImages")->DenseRange(1, 3)->Apply(in_ms);
BENCHMARK(BM_TrianglesBy<by_rays>)->Name("BM_TrianglesRays")->Apply(by_tens<100, 100'000>);
BENCHMARK(BM_TrianglesBy<by_images>)->Name("BM_TrianglesImages")->Apply(by_tens<100, 1000>);
BENCHMARK(BM_ReceiversBy<by_rays>)->Name("BM_ReceiversRays")->Apply(by_tens<1, 10'000>);
BENCHMARK(BM_ReceiversBy<by_images>)->Name("BM_ReceiversImages")->Apply(by_tens<1, 10>);

// One benchmark beside its baselines.
void print_beside(const BestTimes& best, const std::string& name, const std::string& argument) {
  const auto found = best.find("BM_" + name + "/" + argument);
  if (!found) {
    return;
  }
  std::printf("%s %s: %.2f ms of wall clock, %.2f of CPU",
              name.c_str(),
              argument.c_str(),
              1e3 * found->wall,
              1e3 * found->cpu);
  for (const char* by : {"Rays", "Images"}) {
    const std::string beside = std::string("BM_").append(name).append(by).append("/");
    if (const auto baseline = best.find(beside + argument)) {
      std::printf(
          "; %s %.2f of CPU (%.2f times)", by, 1e3 * baseline->cpu, found->cpu / baseline->cpu);
    }
  }
  std::printf("\n");
}

void print_shooting(const BestTimes& best) {
  for (const char* scene : {"0", "1000", "100000"}) {
    const auto bare = best.find(std::string("BM_BareEmbree/") + scene);
    const auto shooting = best.find(std::string("BM_Shooting/") + scene);
    if (bare && shooting) {
      const double alone = bare->counters.at("segments") / 1e6 / bare->cpu;
      const double ours = shooting->counters.at("segments") / 1e6 / shooting->cpu;
      std::printf("shooting (%s): %.1f million segments/s a core, bare Embree %.1f: %.2f of it\n",
                  scene,
                  ours,
                  alone,
                  ours / alone);
    }
  }
}

void print_cached(const BestTimes& best) {
  const auto known = best.find("BM_KnownPaths");
  const auto cached = best.find("BM_CachedLink");
  if (known && cached) {
    std::printf("cached: %.0f us of wall clock, %.0f of CPU; known paths alone %.0f: %.1f times\n",
                1e6 * cached->wall,
                1e6 * cached->cpu,
                1e6 * known->cpu,
                cached->cpu / known->cpu);
  }
  for (const char* visit : {"1", "5"}) {
    if (const auto place = best.find(std::string("BM_NewPlace/") + visit)) {
      std::printf("place, time %s that it is asked for: %.0f us of wall clock, %.0f of CPU\n",
                  visit,
                  1e6 * place->wall / kSurveyed,
                  1e6 * place->cpu / kSurveyed);
    }
  }
}

void print_summary(const BestTimes& best) {
  print_shooting(best);
  print_cached(best);
  for (const char* positions : {"1", "143"}) {
    print_beside(best, "ColdLink", positions);
  }
  for (const char* depth : {"1", "2", "3", "4", "5", "6"}) {
    print_beside(best, "Depth", depth);
  }
  for (const char* triangles : {"100", "1000", "10000", "100000"}) {
    print_beside(best, "Triangles", triangles);
  }
  for (const char* positions : {"1", "10", "100", "1000", "10000"}) {
    print_beside(best, "Receivers", positions);
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("peak memory: %.0f MB\n", static_cast<double>(usage.ru_maxrss) / 1e3);
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 1;
  }
  rayloc::bench::BestTimes best;
  benchmark::RunSpecifiedBenchmarks(&best);
  rayloc::bench::print_summary(best);
}
