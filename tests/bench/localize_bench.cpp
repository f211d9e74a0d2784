// The localization of devices in the laboratory (10.8 x 5.6 x 3 m), depth 3, 40 MHz: cold start
// with and without kept rays, a snapshot, a step of the tracker, and how they grow; beside the
// least that each can cost, in the same run:
//   cold start   the bare tracing of its cells
//   kept start   reading the kept bytes once, as a checksum does
//   snapshot     and step: for every cell, access point and coarsely searched delay, the
//                multiply-adds that whitening a burst takes, and nothing else
// Then how long single fixes and steps take, p50 to p99.
// Build with the release preset and -DRAYLOC_BENCHMARKS=ON.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "engine/base/content_hash.h"
#include "engine/grid/grid.h"
#include "engine/localize/localizer.h"
#include "engine/localize/path_grid.h"
#include "engine/trace/path_tracer.h"
#include "engine/track/device_tracker.h"
#include "engine/track/grid_filter.h"
#include "tests/bench/best_times.h"
#include "tests/bench/laboratory_room.h"
#include "tests/bench/memory.h"
#include "tests/support/laboratory.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::bench {
namespace {

constexpr int kFrames = 10;  // of a burst and access point

class MemoryStore : public PathGridStore {
 public:
  std::optional<std::string> load(const std::string& key) override {
    const auto found = kept.find(key);
    return found == kept.end() ? std::nullopt : std::optional(found->second);
  }
  void save(const std::string& key, std::string_view bytes) override { kept[key] = bytes; }
  void refuse(const std::string& /*key*/) override {}

  std::map<std::string, std::string> kept;
};

using Size = LaboratorySize;

// Built once, with the rays that it keeps.
struct Prepared {
  std::shared_ptr<const RoomModel> room;
  std::shared_ptr<MemoryStore> store = std::make_shared<MemoryStore>();
  std::shared_ptr<const Localizer> localizer;
  std::vector<std::vector<CsiFrame>> bursts;  // at different places
};

LocalizerOptions with(std::shared_ptr<PathGridStore> store) {
  LocalizerOptions options;
  options.path_grids = std::move(store);
  return options;
}

const Prepared& prepared(const Size& size) {
  static std::map<Size, Prepared> all;
  Prepared& one = all[size];
  if (one.localizer == nullptr) {
    one.room = std::make_shared<const RoomModel>(laboratory_room(size));
    one.localizer =
        std::make_shared<const Localizer>(*Localizer::create(one.room, with(one.store)));
    for (Vec3d place : test::laboratory_positions(40)) {
      place.x *= size.length / 10.8;
      one.bursts.push_back(test::frames_at(
          *one.room, place, {kFrames, 30.0, static_cast<unsigned>(one.bursts.size() + 1)}));
    }
  }
  return one;
}

void BM_ColdStart(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  for (auto _ : state) {
    benchmark::DoNotOptimize(Localizer::create(p.room, {}));
  }
  state.counters["cells"] = static_cast<double>(p.localizer->grid().size());
}

void BM_BareTracing(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  const Grid& grid = p.localizer->grid();
  for (auto _ : state) {
    for (const RoomAccessPoint& ap : p.room->access_points) {
      const PathTracer tracer(p.room->scene, p.room->trace);
      const ReceiverTracer at = tracer.at(Receiver{{ap.array.pose.position,
                                                    ap.array.pose.orientation,
                                                    ap.array.pattern,
                                                    ap.array.polarization}});
      for (std::size_t cell = 0; cell < grid.size(); ++cell) {
        benchmark::DoNotOptimize(at.trace(Transmitter{
            {grid.centre(cell), {}, p.room->device.pattern, p.room->device.polarization}}));
      }
    }
  }
}

void BM_KeptStart(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  for (auto _ : state) {
    benchmark::DoNotOptimize(Localizer::create(p.room, with(p.store)));
  }
  double bytes = 0.0;
  for (const auto& [key, kept] : p.store->kept) {
    bytes += static_cast<double>(kept.size());
  }
  state.counters["MB"] = 1e-6 * bytes;
}

void BM_KeptRays(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  for (auto _ : state) {
    for (const auto& [key, kept] : p.store->kept) {
      benchmark::DoNotOptimize(parse_path_grid(kept));
    }
  }
}

void BM_ChecksumOfKept(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  for (auto _ : state) {
    for (const auto& [key, kept] : p.store->kept) {
      ContentHash hash;
      hash.add(kept);
      benchmark::DoNotOptimize(hash.value());
    }
  }
}

// Whitening alone, for every cell and access point: W y of eight delays, W lower triangular.
void BM_BareWhitening(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  const ObservationModel model(p.room->grid, 3);
  const std::size_t dimension = model.dimension();
  const std::size_t terms = dimension * (dimension + 1) / 2;
  std::vector<float> w(2 * terms, 0.5F);
  std::vector<std::array<float, 16>> y(dimension);
  for (auto& row : y) {
    row.fill(0.25F);
  }
  const std::size_t count = p.localizer->grid().size() * p.room->access_points.size();
  for (auto _ : state) {
    std::array<float, 16> total{};
    for (std::size_t n = 0; n < count; ++n) {
      const float* a = w.data();
      for (std::size_t i = 0; i < dimension; ++i) {
        for (std::size_t j = 0; j <= i; ++j, a += 2) {
          for (std::size_t t = 0; t < 8; ++t) {
            total[t] += a[0] * y[j][t] - a[1] * y[j][t + 8];
            total[t + 8] += a[0] * y[j][t + 8] + a[1] * y[j][t];
          }
        }
      }
      benchmark::DoNotOptimize(total);
    }
  }
}

void BM_Snapshot(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(p.localizer->locate(p.bursts[next++ % p.bursts.size()]));
  }
}

// A tracker step of a device at another place in every burst, so that nothing is left out:
// hypotheses are as many as a map can hold.
void BM_TrackerStep(benchmark::State& state) {
  const Prepared& p = prepared(size_of(state));
  DeviceTracker tracker(p.localizer, {});
  std::vector<DeviceUpdate> updates;
  std::size_t next = 0;
  for (auto _ : state) {
    std::vector<CsiFrame> moment = p.bursts[next % p.bursts.size()];
    for (CsiFrame& frame : moment) {
      frame.time = Timestamp(std::chrono::milliseconds(50) * static_cast<int>(next));
    }
    tracker.receive(MacAddress{{2, 0, 0, 0, 0, 1}}, moment, updates);
    updates.clear();
    ++next;
  }
}

// The same of so many devices, one after the other, per moment of one.
void BM_TrackerStepOfMany(benchmark::State& state) {
  const Prepared& p = prepared({});
  DeviceTracker tracker(p.localizer, {});
  std::vector<DeviceUpdate> updates;
  const auto devices = static_cast<int>(state.range(0));
  int next = 0;
  for (auto _ : state) {
    const int device = next % devices;
    std::vector<CsiFrame> moment = p.bursts[static_cast<std::size_t>(next) % p.bursts.size()];
    for (CsiFrame& frame : moment) {
      frame.time = Timestamp(std::chrono::milliseconds(50) * (next / devices));
    }
    const MacAddress mac{{2, 0, 0, 0, 0, static_cast<std::uint8_t>(device)}};
    tracker.receive(mac, moment, updates);
    updates.clear();
    ++next;
  }
}

// Cores: of one. Arguments: depth, access points, length in millimetres.
void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->Args({3, 1, 10800})->Args({1, 1, 10800})->Args({2, 1, 10800});
  benchmark->Args({3, 1, 5400})->Args({3, 2, 10800})->Args({3, 3, 10800});
  benchmark->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
}
void starts(benchmark::internal::Benchmark* benchmark) {
  sizes(benchmark);
  benchmark->Iterations(1);
}
BENCHMARK(BM_BareTracing)->Apply(starts);
BENCHMARK(BM_ColdStart)->Apply(starts);
BENCHMARK(BM_ChecksumOfKept)->Apply(starts);
BENCHMARK(BM_KeptRays)->Apply(starts);
BENCHMARK(BM_KeptStart)->Apply(starts);
BENCHMARK(BM_BareWhitening)->Apply(sizes);
BENCHMARK(BM_Snapshot)->Apply(sizes);
BENCHMARK(BM_TrackerStep)->Apply(sizes);
BENCHMARK(BM_TrackerStepOfMany)
    ->Arg(1)
    ->Arg(16)
    ->Arg(128)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

void print_latencies() {
  const Prepared& p = prepared({});
  const auto burst = [&](int i) -> const std::vector<CsiFrame>& {
    return p.bursts[static_cast<std::size_t>(i) % p.bursts.size()];
  };
  print_latency("preprocessing of a snapshot's burst", 400, [&](int i) {
    benchmark::DoNotOptimize(p.localizer->receive(burst(i)));
  });
  print_latency("snapshot, one access point", 400, [&](int i) {
    benchmark::DoNotOptimize(p.localizer->locate(burst(i)));
  });
  std::vector<Localizer::Evidence> evidence;
  for (const std::vector<CsiFrame>& frames : p.bursts) {
    evidence.push_back(p.localizer->evidence(p.localizer->receive(frames)));
  }
  GridFilter filter(std::make_shared<const FreeSpace>(
                        make_free_space(*p.room->scene,
                                        p.localizer->grid(),
                                        {p.room->access_points.front().array.pose.position})),
                    {});
  print_latency("the filter alone, of a tracker step", 400, [&](int i) {
    const auto& received = evidence[static_cast<std::size_t>(i) % evidence.size()];
    filter.predict(std::chrono::milliseconds(50));
    filter.weigh_change(1.0);
    filter.update(received.log_likelihood, p.room->likelihood_exponent, received.outlier);
    benchmark::DoNotOptimize(filter.mass());
  });
  DeviceTracker tracker(p.localizer, {});
  std::vector<DeviceUpdate> updates;
  print_latency("tracker step with the burst's map, one access point", 400, [&](int i) {
    std::vector<CsiFrame> moment = burst(i);
    for (CsiFrame& frame : moment) {
      frame.time = Timestamp(std::chrono::milliseconds(50) * i);
    }
    tracker.receive(MacAddress{{2, 0, 0, 0, 0, 1}}, moment, updates);
    updates.clear();
  });
}

void print_summary(const BestTimes& best) {
  for (const char* size :
       {"1/1/10800", "2/1/10800", "3/1/10800", "3/1/5400", "3/2/10800", "3/3/10800"}) {
    const auto of = [&](const char* name) { return best.find(std::string(name) + "/" + size); };
    const auto bare = of("BM_BareTracing");
    const auto cold = of("BM_ColdStart");
    const auto checksum = of("BM_ChecksumOfKept");
    const auto rays = of("BM_KeptRays");
    const auto kept = of("BM_KeptStart");
    const auto whitening = of("BM_BareWhitening");
    const auto snapshot = of("BM_Snapshot");
    const auto step = of("BM_TrackerStep");
    if (!bare || !cold || !checksum || !rays || !kept || !whitening || !snapshot || !step) {
      continue;
    }
    std::printf(
        "depth/access points/length %s, %.0f cells, seconds of CPU: cold start %.2f (%.1f "
        "times bare tracing), with %.0f MB of kept rays %.2f, of it reading them %.3f (%.1f "
        "times their checksum)\n",
        size,
        cold->counters.at("cells"),
        cold->cpu,
        cold->cpu / bare->cpu,
        kept->counters.at("MB"),
        kept->cpu,
        rays->cpu,
        rays->cpu / checksum->cpu);
    std::printf(
        "  milliseconds of CPU: snapshot %.1f, tracker step %.1f (%.1f and %.1f times bare "
        "whitening)\n",
        1e3 * snapshot->cpu,
        1e3 * step->cpu,
        snapshot->cpu / whitening->cpu,
        step->cpu / whitening->cpu);
  }
  print_latencies();
  print_peak_memory();
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  return rayloc::bench::run_benchmarks(argc, argv, rayloc::bench::print_summary);
}
