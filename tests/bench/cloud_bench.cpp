// A moment of a device that is followed by a cloud of places (engine/track), in the laboratory at
// 40 MHz, heights unknown: the weights of its places, with boxes that are kept and along a walk
// that makes them; the parts of it; and the summary of the cloud. CPU of one thread.
//
// Build with the release preset and -DRAYLOC_BENCHMARKS=ON.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <chrono>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/normal_draws.h"
#include "engine/localize/localizer.h"
#include "engine/track/cloud_evidence.h"
#include "engine/track/cloud_summary.h"
#include "tests/bench/best_times.h"
#include "tests/bench/laboratory_room.h"
#include "tests/support/cloud_scene.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::bench {
namespace {

constexpr auto kMoment = std::chrono::milliseconds(50);
constexpr double kStep = 0.04;      // [m], of a walk in a moment
constexpr std::size_t kKept = 32;   // moments of a device at one place
constexpr std::size_t kSteps = 50;  // of a walk

std::shared_ptr<const CloudRoom> room_of(int access_points) {
  static std::map<int, std::shared_ptr<const CloudRoom>> made;
  auto& one = made[access_points];
  if (one == nullptr) {
    RoomModel room = laboratory_room({3, access_points});
    room.device.height_sigma = 0.3;
    one = test::cloud_room(std::move(room));
  }
  return one;
}

struct Moment {
  RoomObservation observation;
  PlaceCloud cloud;
  std::vector<std::uint32_t> boxes;
};

using Channels = std::vector<std::vector<std::complex<double>>>;

Channels channels_at(const RoomModel& room, const Vec3d& at) {
  Channels channels;
  for (const RoomAccessPoint& ap : room.access_points) {
    channels.push_back(test::channel_at(room, ap, at));
  }
  return channels;
}

struct Spread {
  std::size_t places;
  double sigma;  // [m], in plan
};

Moment moment_of(const CloudRoom& room,
                 const Channels& channels,
                 const Vec3d& at,
                 std::size_t number,
                 const Spread& spread) {
  auto frames = test::frames_of(
      room.localizer->room(), channels, {1, 30.0, static_cast<unsigned>(number + 1)});
  for (CsiFrame& frame : frames) {
    frame.time = Timestamp(kMoment * number);
  }
  Moment moment{room.localizer->receive(frames), {}, {}};
  NormalDraws draws(number);
  for (std::size_t i = 0; i < spread.places; ++i) {
    CloudPlace place;
    place.x = static_cast<float>(at.x + spread.sigma * static_cast<double>(draws.normal()));
    place.y = static_cast<float>(at.y + spread.sigma * static_cast<double>(draws.normal()));
    place.z = static_cast<float>(at.z + 0.15 * static_cast<double>(draws.normal()));
    moment.cloud.add(place, 0.0F);
    moment.boxes.push_back(room.lattice.box_at(place.x, place.y, place.z));
  }
  return moment;
}

Vec3d walk(std::size_t number) { return {2.0 + kStep * static_cast<double>(number), 3.1, 1.2}; }

struct Setup {
  std::shared_ptr<const CloudRoom> room;
  Spread spread;

  explicit Setup(const benchmark::State& state)
      : room(room_of(static_cast<int>(state.range(0)))),
        spread{static_cast<std::size_t>(state.range(1)),
               1e-3 * static_cast<double>(state.range(2))} {}

  std::vector<Moment> at_rest(std::size_t count) const {
    const Channels& channels = channels_of(0);
    std::vector<Moment> result;
    for (std::size_t n = 0; n < count; ++n) {
      result.push_back(moment_of(*room, channels, walk(0), n, spread));
    }
    return result;
  }
  std::vector<Moment> along_a_walk(std::size_t count) const {
    std::vector<Moment> result;
    for (std::size_t n = 0; n < count; ++n) {
      result.push_back(moment_of(*room, channels_of(n), walk(n), n, spread));
    }
    return result;
  }

 private:
  // Traced once.
  const Channels& channels_of(std::size_t number) const {
    static std::map<std::pair<std::size_t, std::size_t>, Channels> made;
    const RoomModel& model = room->localizer->room();
    auto& one = made[{model.access_points.size(), number}];
    if (one.empty()) {
      one = channels_at(model, walk(number));
    }
    return one;
  }
};

// Arguments: access points, places, deviation of the cloud in plan [mm].
void sizes(benchmark::internal::Benchmark* of) {
  for (const int sigma : {50, 100, 200}) {
    of->Args({1, 1500, sigma});
  }
  for (const int sigma : {20, 50, 100}) {
    of->Args({3, 600, sigma});
  }
  of->Unit(benchmark::kMicrosecond);
}

void usual_sizes(benchmark::internal::Benchmark* of) {
  of->Args({1, 1500, 100})->Args({3, 600, 50})->Unit(benchmark::kMicrosecond);
}

void BM_WeighAtRest(benchmark::State& state) {
  const Setup setup(state);
  const auto moments = setup.at_rest(kKept);
  CloudEvidence evidence(setup.room);
  std::size_t next = 0;
  const auto weigh = [&](const Moment& moment) {
    return evidence.weigh(moment.observation, moment.cloud, moment.boxes, 0.25);
  };
  for (const Moment& moment : moments) {
    weigh(moment);
  }
  for (auto _ : state) {
    const auto weights = weigh(moments[next]);
    next = (next + 1) % kKept;
    benchmark::DoNotOptimize(weights);
  }
}
BENCHMARK(BM_WeighAtRest)->Apply(sizes)->Repetitions(3);

// Boxes are made at the edge of the cloud; those of the sample are kept, as they are in a room with
// devices.
void BM_WeighAWalk(benchmark::State& state) {
  const Setup setup(state);
  const auto moments = setup.along_a_walk(kSteps);
  CloudEvidence evidence(setup.room);
  for (const Moment& moment : setup.at_rest(4 * kKept)) {  // nearly all of the sample
    evidence.weigh(moment.observation, moment.cloud, moment.boxes, 0.25);
  }
  std::size_t next = 0;
  for (auto _ : state) {
    const Moment& moment = moments[next++];
    benchmark::DoNotOptimize(evidence.weigh(moment.observation, moment.cloud, moment.boxes, 0.25));
  }
}
BENCHMARK(BM_WeighAWalk)->Apply(usual_sizes)->Iterations(kSteps);

// Values of the cloud alone.
void BM_SearchPlaces(benchmark::State& state) {
  const Setup setup(state);
  const Moment moment = setup.at_rest(1).front();
  const double exponent = setup.room->localizer->room().likelihood_exponent;
  PlaceSearch search(moment.observation, exponent);
  const SearchedPlaces places{moment.cloud.x(), moment.cloud.y(), moment.cloud.z(), moment.boxes};
  for (auto _ : state) {
    benchmark::DoNotOptimize(search.log_likelihoods(places, PlaceSearch::Spread::kTogether));
  }
  state.counters["boxes"] = static_cast<double>(search.boxes());
}
BENCHMARK(BM_SearchPlaces)->Apply(sizes)->Repetitions(3);

void BM_PrepareSearch(benchmark::State& state) {
  const Setup setup(state);
  const Moment moment = setup.at_rest(1).front();
  const double exponent = setup.room->localizer->room().likelihood_exponent;
  for (auto _ : state) {
    benchmark::DoNotOptimize(PlaceSearch(moment.observation, exponent));
  }
}
BENCHMARK(BM_PrepareSearch)
    ->Args({1, 8, 10})
    ->Args({3, 8, 10})
    ->Unit(benchmark::kMicrosecond)
    ->Repetitions(3);

// The rest of the weights, with values that cost nothing.
void BM_WeighGivenValues(benchmark::State& state) {
  const Setup setup(state);
  const Moment moment = setup.at_rest(1).front();
  const double exponent = setup.room->localizer->room().likelihood_exponent;
  PlaceSearch search(moment.observation, exponent);
  std::map<std::size_t, std::vector<std::vector<float>>> known;
  CloudEvidence evidence(
      setup.room, [&](const auto&, const SearchedPlaces& places, PlaceSearch::Spread spread) {
        auto& values = known[places.x.size()];
        if (values.empty()) {
          values = search.log_likelihoods(places, spread);
        }
        return values;
      });
  for (auto _ : state) {
    benchmark::DoNotOptimize(evidence.weigh(moment.observation, moment.cloud, moment.boxes, 0.25));
  }
}
BENCHMARK(BM_WeighGivenValues)->Apply(usual_sizes)->Repetitions(3);

void BM_Summarise(benchmark::State& state) {
  const Setup setup(state);
  const Moment moment = setup.at_rest(1).front();
  const Grid& grid = setup.room->lattice.grid();
  const SearchArea& area = setup.room->localizer->area();
  for (auto _ : state) {
    LocationEstimate location;
    benchmark::DoNotOptimize(summarise_cloud(moment.cloud, grid, area.inside, {}, location));
  }
  state.counters["cells"] =
      static_cast<double>(summary_grid(moment.cloud, moment.cloud.weights(), grid).size());
}
BENCHMARK(BM_Summarise)->Apply(sizes)->Args({1, 1500, 500})->Repetitions(3);

// Runs once: a second time its boxes are kept.
void print_walk(const BestTimes& best) {
  for (const char* size : {"1/1500/100", "3/600/50"}) {
    const auto time = best.find(std::string("BM_WeighAWalk/") + size);
    if (time) {
      std::printf("a moment of a walk, %s: %.0f us\n", size, 1e6 * time->cpu);
    }
  }
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  return rayloc::bench::run_benchmarks(argc, argv, rayloc::bench::print_walk);
}
