// CPU of a burst of a device that walks through the laboratory (40 MHz), by kind:
//   tracked      a burst of 0.2 s with its four filtered estimates, of a track that holds
//   acquisition  the first moment of a device, until its first filtered estimate
//   snapshot     a burst as a whole, anywhere in the room
// and how it grows with access points, the room's area, devices and an unknown height. Each is set
// beside what whitening a thousand cells costs in the same run, eight delays each and nothing else:
// that is the unit in which two machines agree.
// Build with the release preset and -DRAYLOC_BENCHMARKS=ON.
//
//   live_bench [bursts [devices]]
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "engine/likelihood/lane_kernel.h"
#include "engine/localize/localizer.h"
#include "engine/track/device_tracker.h"
#include "tests/bench/laboratory_room.h"
#include "tests/bench/memory.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::bench {
namespace {

constexpr auto kMoment = std::chrono::milliseconds(50);
constexpr int kMoments = 4;     // of a burst
constexpr int kFrames = 1;      // of a moment and access point
constexpr int kSettling = 10;   // bursts before a track is measured
constexpr double kSpeed = 0.8;  // [m/s]

struct Case {
  LaboratorySize size;
  double height_sigma = 0.0;  // [m]
};

// Milliseconds of CPU of all threads.
double cpu_ms(const std::function<void()>& call) {
  const std::clock_t begin = std::clock();
  call();
  return 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

struct Cost {
  std::vector<double> ms;

  double at(double share) {
    std::sort(ms.begin(), ms.end());
    return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
  }
};

// Of whitening a thousand cells that lie one after the other in memory [ms].
double thousand_cells(std::size_t dimension) {
  constexpr std::size_t kCells = 1000;
  const std::size_t terms = dimension * (dimension + 1) / 2;
  const std::vector<std::complex<float>> w(kCells * terms, {0.5F, 0.25F});
  const std::vector<std::complex<float>> along(2 * dimension, {0.5F, 0.5F});
  LaneRow row;
  row.fill(0.25F);
  const std::vector<LaneRow> y(dimension, row);
  Cost cost;
  for (int repeat = 0; repeat < 5; ++repeat) {
    cost.ms.push_back(cpu_ms([&] {
      float sum = 0.0F;
      for (std::size_t n = 0; n < kCells; ++n) {
        fetch(std::span(w).subspan((n + 1) % kCells * terms, terms));
        std::array<LaneSums, 2> sums;
        sum += whiten(w.data() + n * terms, y, y, along, sums)[0];
      }
      volatile float keep = sum;
      static_cast<void>(keep);
    }));
  }
  return cost.at(0.0);
}

// Up and down the middle of the room.
Vec3d place_at(double seconds, double length) {
  const double way = 0.7 * length;
  const double along = std::fmod(kSpeed * seconds, 2.0 * way);
  return {0.15 * length + (along < way ? along : 2.0 * way - along), 3.1, 1.2};
}

// The moments of a walk: [moment], frames of all access points.
std::vector<std::vector<CsiFrame>> walk(const RoomModel& room, double length, int bursts) {
  std::vector<std::vector<CsiFrame>> moments;
  for (int i = 0; i < bursts * kMoments; ++i) {
    const double seconds = 1e-3 * static_cast<double>(i * kMoment.count());
    moments.push_back(test::frames_at(
        room, place_at(seconds, length), {kFrames, 30.0, static_cast<unsigned>(i + 1)}));
    for (CsiFrame& frame : moments.back()) {
      frame.time = Timestamp(kMoment * i);
    }
  }
  return moments;
}

MacAddress address(int device) {
  return {{2,
           0,
           0,
           0,
           static_cast<std::uint8_t>(device / 256),
           static_cast<std::uint8_t>(device % 256)}};
}

void print(const char* name, Cost& cost, double unit) {
  std::printf("    %-11s p50 %8.2f  p99 %8.2f ms of CPU; p50 %7.2f thousand cells\n",
              name,
              cost.at(0.5),
              cost.at(0.99),
              cost.at(0.5) / unit);
}

void measure(const Case& of, int bursts, int devices) {
  RoomModel model = laboratory_room(of.size);
  model.device.height_sigma = of.height_sigma;
  const auto room = std::make_shared<const RoomModel>(std::move(model));
  const auto localizer = std::make_shared<const Localizer>(*Localizer::create(room, {}));
  const auto moments = walk(*room, of.size.length, kSettling + bursts);
  const auto heard = localizer->hear(moments.front());
  const double unit = thousand_cells(heard.arrays.front().map->dimension());
  std::printf(
      "%d access points, %.1f m long, height +-%.1f m, %d devices: %zu cells; a thousand whitened "
      "in %.2f ms\n",
      of.size.access_points,
      of.size.length,
      of.height_sigma,
      devices,
      localizer->grid().size(),
      unit);
  DeviceTracker tracker(localizer, {});
  std::vector<DeviceUpdate> updates;
  Cost acquisition;
  Cost tracked;
  for (int burst = 0; burst < kSettling + bursts; ++burst) {
    for (int device = 0; device < devices; ++device) {
      const auto moment = [&](int i) {
        tracker.hear(
            address(device), moments[static_cast<std::size_t>(burst * kMoments + i)], updates);
      };
      const double first = cpu_ms([&] { moment(0); });
      const double others = cpu_ms([&] {
        for (int i = 1; i < kMoments; ++i) {
          moment(i);
        }
      });
      if (burst == 0) {
        acquisition.ms.push_back(first);
      } else if (burst >= kSettling) {
        tracked.ms.push_back(first + others);
      }
      updates.clear();
    }
  }
  Cost snapshot;
  for (std::size_t i = 0; devices == 1 && i + kMoments <= moments.size(); i += 4 * kMoments) {
    snapshot.ms.push_back(cpu_ms([&] { localizer->locate(moments[i]); }));
  }
  print("tracked", tracked, unit);
  print("acquisition", acquisition, unit);
  if (!snapshot.ms.empty()) {
    print("snapshot", snapshot, unit);
  }
  std::fflush(stdout);
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  using rayloc::bench::measure;
  const int bursts = argc > 1 ? std::atoi(argv[1]) : 20;
  const int devices = argc > 2 ? std::atoi(argv[2]) : 20;
  for (const double sigma : {0.0, 0.3}) {
    for (const int access_points : {1, 3}) {
      measure({{3, access_points, 10.8}, sigma}, bursts, 1);
    }
    measure({{3, 1, 5.4}, sigma}, bursts, 1);
    measure({{3, 1, 10.8}, sigma}, std::max(1, bursts / devices), devices);
  }
  rayloc::bench::print_peak_memory();
  return 0;
}
