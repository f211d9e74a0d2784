// The localization of people without a device in the laboratory (10.8 x 5.6 x 3 m), 40 MHz, between
// a fixed transmitter and access points: cold start, a snapshot, a step of the tracker, and how
// they grow; beside the least that each can cost, in the same run:
//   cold start   the bare tracing of a body in the middle of every fourth cell, which is as many
//                places as are traced
//   snapshot     and step: one trace of a body with its derivatives, which a descent would pay for
//                every step
// Then how long single fixes and steps take, p50 to p99.
// Build with the release preset and -DRAYLOC_BENCHMARKS=ON.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "engine/person/calibrate/empty_room.h"
#include "engine/person/person_localizer.h"
#include "engine/room/preprocess_burst.h"
#include "engine/trace/scattering/scattering.h"
#include "engine/track/person_tracker.h"
#include "tests/bench/best_times.h"
#include "tests/bench/laboratory_room.h"
#include "tests/bench/memory.h"
#include "tests/support/laboratory.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::bench {
namespace {

constexpr int kFrames = 10;  // of a burst and access point
constexpr std::size_t kPlaces = 24;

Transmitter transmitter() {
  return {{{9.6, 3.6, 1.2}, {}, AntennaPattern::kHalfWaveDipole, Polarization::kVertical}};
}

// Links of the antennas of every access point past a body.
std::vector<std::vector<TargetLink>> links_of(const RoomModel& room, int depth) {
  ScatteringOptions options;
  options.trace = room.trace;
  options.trace.max_depth = depth;
  const auto tracer = TargetTracer::create(room.scene, {}, options);
  std::vector<std::vector<TargetLink>> links;
  for (const RoomAccessPoint& ap : room.access_points) {
    links.push_back(tracer->links(transmitter(), array_elements<Receiver>(ap.array)));
  }
  return links;
}

// Channels of every access point past a body, or of the empty room.
std::vector<std::vector<std::complex<double>>> channels(
    const RoomModel& room,
    const std::vector<std::vector<TargetLink>>& links,
    const TargetPosition* place) {
  std::vector<std::vector<std::complex<double>>> result;
  for (std::size_t a = 0; a < room.access_points.size(); ++a) {
    auto h = test::channel_at(room, room.access_points[a], transmitter().position);
    for (std::size_t m = 0; place != nullptr && m < links[a].size(); ++m) {
      const auto row = links[a][m].trace(*place)->cfr(room.grid);
      for (std::size_t k = 0; k < row.size(); ++k) {
        h[m * row.size() + k] += row[k];
      }
    }
    result.push_back(std::move(h));
  }
  return result;
}

// depth: of the ways to and from the person together.
struct Prepared {
  std::shared_ptr<const RoomModel> room;
  PersonReference reference;
  PersonLocalizerOptions options;
  std::shared_ptr<const PersonLocalizer> localizer;
  std::vector<TargetPosition> places;
  std::vector<std::vector<CsiFrame>> bursts;  // [place]
  std::vector<std::vector<CsiFrame>> walk;    // [moment] of a walk, a frame of each
};

constexpr auto kInterval = std::chrono::milliseconds(80);  // of a tracker's moments
constexpr std::size_t kMoments = 120;                      // of the walk, a count

// North of the islands, from west to east and back.
TargetPosition place_of_walk(std::size_t moment, double length) {
  const double distance = 0.6 * length;
  const double along = std::fmod(0.08 * 0.8 * static_cast<double>(moment), 2.0 * distance);
  return {0.15 * length + std::min(along, 2.0 * distance - along), 3.7};
}

PersonReference reference_of(const RoomModel& room,
                             const std::vector<std::vector<TargetLink>>& links) {
  const auto frames =
      test::frames_of(room, channels(room, links, nullptr), {.count = 20, .snr_db = 35.0});
  std::vector<EmptyRoom> received;
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    received.push_back({i, preprocess_burst(room, i, frames, {}, warnings)->h});
  }
  return *fit_empty_room(room, transmitter(), received);
}

const Prepared& prepared(const LaboratorySize& size) {
  static std::map<LaboratorySize, Prepared> all;
  Prepared& one = all[size];
  if (one.localizer != nullptr) {
    return one;
  }
  RoomModel room = laboratory_room(size);
  room.trace.max_depth = 2;  // of the empty room
  one.room = std::make_shared<const RoomModel>(std::move(room));
  const auto links = links_of(*one.room, size.depth);
  one.reference = reference_of(*one.room, links);
  one.options.depth = size.depth;
  one.localizer = std::make_shared<const PersonLocalizer>(
      *PersonLocalizer::create(one.room, one.reference, one.options));
  for (const Vec3d& place : test::laboratory_positions(kPlaces)) {
    one.places.push_back({place.x * size.length / 10.8, place.y});
    one.bursts.push_back(
        test::frames_of(*one.room,
                        channels(*one.room, links, &one.places.back()),
                        {kFrames, 30.0, static_cast<unsigned>(one.bursts.size() + 1)}));
  }
  for (std::size_t i = 0; i < kMoments; ++i) {
    const TargetPosition place = place_of_walk(i, size.length);
    one.walk.push_back(test::frames_of(
        *one.room, channels(*one.room, links, &place), {1, 30.0, static_cast<unsigned>(i + 1)}));
  }
  return one;
}

void BM_ColdStart(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  for (auto _ : state) {
    benchmark::DoNotOptimize(PersonLocalizer::create(p.room, p.reference, p.options));
  }
}

// To the centre of each array, as a localizer traces.
std::vector<TargetLink> central_links(const Prepared& p) {
  ScatteringOptions options;
  options.trace = p.room->trace;
  options.trace.max_depth = p.options.depth;
  const auto tracer = TargetTracer::create(p.room->scene, {}, options);
  std::vector<TargetLink> links;
  for (const RoomAccessPoint& ap : p.room->access_points) {
    links.push_back(tracer->link(transmitter(),
                                 Receiver{{ap.array.pose.position,
                                           ap.array.pose.orientation,
                                           ap.array.pattern,
                                           ap.array.polarization}}));
  }
  return links;
}

void BM_BareTracing(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  const double step = 2.0 * p.options.cell;
  double places = 0.0;
  for (auto _ : state) {
    for (const TargetLink& link : central_links(p)) {
      for (double x = p.room->bounds_min.x + step; x < p.room->bounds_max.x; x += step) {
        for (double y = p.room->bounds_min.y + step; y < p.room->bounds_max.y; y += step) {
          benchmark::DoNotOptimize(link.trace({x, y}));
          places += 1.0;
        }
      }
    }
  }
  state.counters["places"] = places / static_cast<double>(state.iterations());
}

void BM_OneTrace(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  const auto links = central_links(p);
  std::size_t next = 0;
  for (auto _ : state) {
    for (const TargetLink& link : links) {
      benchmark::DoNotOptimize(link.differentiate(p.places[next % p.places.size()]));
    }
    ++next;
  }
}

void BM_Snapshot(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(p.localizer->locate(p.bursts[next++ % p.bursts.size()]));
  }
}

// A tracker that receives bursts one after the other, over and over.
class Tracked {
 public:
  Tracked(const Prepared& p, const std::vector<std::vector<CsiFrame>>& bursts)
      : access_points_(p.room->access_points.size()), bursts_(bursts), tracker_(p.localizer, {}) {}

  void step(int number) {
    std::vector<CsiFrame> moment = bursts_[static_cast<std::size_t>(number) % bursts_.size()];
    moment.resize(access_points_);  // a frame of each
    for (CsiFrame& frame : moment) {
      frame.time = Timestamp(kInterval * number);
    }
    tracker_.receive(moment, updates_);
    updates_.clear();
  }

 private:
  std::size_t access_points_;
  const std::vector<std::vector<CsiFrame>>& bursts_;
  PersonTracker tracker_;
  std::vector<PersonUpdate> updates_;
};

// A step of the tracker for a person who walks.
void BM_TrackerStep(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  Tracked tracked(p, p.walk);
  int next = 0;
  for (auto _ : state) {
    tracked.step(next++);
  }
}

// Arguments: depth, access points, length in millimetres.
void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->Args({2, 1, 10800})->Args({1, 1, 10800})->Args({3, 1, 10800});
  benchmark->Args({2, 1, 5400})->Args({2, 3, 10800});
  benchmark->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
}
void starts(benchmark::internal::Benchmark* benchmark) {
  sizes(benchmark);
  benchmark->Iterations(1);
}
BENCHMARK(BM_BareTracing)->Apply(starts);
BENCHMARK(BM_ColdStart)->Apply(starts);
BENCHMARK(BM_OneTrace)->Apply(sizes);
BENCHMARK(BM_Snapshot)->Apply(sizes);
BENCHMARK(BM_TrackerStep)->Apply(sizes);

void print_summary(const BestTimes& best) {
  for (const char* size : {"1/1/10800", "2/1/10800", "3/1/10800", "2/1/5400", "2/3/10800"}) {
    const auto of = [&](const char* name) { return best.find(std::string(name) + "/" + size); };
    const auto bare = of("BM_BareTracing");
    const auto cold = of("BM_ColdStart");
    const auto trace = of("BM_OneTrace");
    const auto snapshot = of("BM_Snapshot");
    const auto step = of("BM_TrackerStep");
    if (!bare || !cold || !trace || !snapshot || !step) {
      continue;
    }
    std::printf(
        "depth/access points/length %s, CPU: cold start %.2f s (%.1f times bare tracing of %.0f "
        "places), snapshot %.1f ms and tracker step %.1f ms (as long as %.0f and %.0f traces)\n",
        size,
        cold->cpu,
        cold->cpu / bare->cpu,
        bare->counters.at("places"),
        1e3 * snapshot->cpu,
        1e3 * step->cpu,
        snapshot->cpu / trace->cpu,
        step->cpu / trace->cpu);
  }
  const Prepared& p = prepared({.depth = 2});
  print_latency("snapshot, one access point", 400, [&](int i) {
    benchmark::DoNotOptimize(
        p.localizer->locate(p.bursts[static_cast<std::size_t>(i) % p.bursts.size()]));
  });
  Tracked walk(p, p.walk);
  print_latency("tracker step, one access point", 400, [&](int i) { walk.step(i); });
  Tracked jumps(p, p.bursts);
  print_latency(
      "the same, somebody who is somewhere else every time", 400, [&](int i) { jumps.step(i); });
  print_peak_memory();
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  return rayloc::bench::run_benchmarks(argc, argv, rayloc::bench::print_summary);
}
