// CPU of a burst of a device that walks through the laboratory (40 MHz), by kind:
//   tracked      a burst of 0.2 s with its four filtered estimates, of a track that holds
//   acquisition  the first moment of a device, until its first filtered estimate
//   snapshot     a burst as a whole, anywhere in the room
// and how it grows with access points, the room's area, devices and an unknown height; then the
// same in an empty hall by its area, by access points and by bandwidth, at both heights. Each is
// set beside what whitening a thousand cells costs in the same run, eight delays each and nothing
// else: that is the unit in which two machines agree. A tracked burst is set beside the roof as
// well: what its inner loops compute and read (engine/base/work_done.h), at what one core can do at
// most. All on one thread. Memory is what the maps of an access point take, and what they have
// grown to. Build with the release preset and -DRAYLOC_BENCHMARKS=ON.
//
//   live_bench [--tracks grid|cloud] [bursts [devices [case]]]
//
// The case is a number, from 0 on; without it, all.
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
#include <string>
#include <string_view>
#include <vector>

#include <malloc.h>
#include <tbb/global_control.h>

#include "engine/base/work_done.h"
#include "engine/localize/localizer.h"
#include "engine/track/device_tracker.h"
#include "tests/bench/core_limits.h"
#include "tests/bench/hall_room.h"
#include "tests/bench/laboratory_room.h"
#include "tests/bench/memory.h"
#include "tests/bench/thousand_cells.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::bench {
namespace {

constexpr auto kMoment = std::chrono::milliseconds(50);
constexpr int kMoments = 4;     // of a burst
constexpr int kFrames = 1;      // of a moment and access point
constexpr int kSettling = 15;   // bursts before a track is measured: 3 s; a cloud begins at 2 s
constexpr double kSpeed = 0.8;  // [m/s]

struct Case {
  std::string name;
  RoomModel room;
  double length = 0.0;  // [m], of the way that devices walk, to and fro, and ...
  double y = 0.0;       // ... where that is
};

Case laboratory(const LaboratorySize& size, double height_sigma) {
  std::array<char, 96> name{};
  std::snprintf(name.data(),
                name.size(),
                "laboratory, %d access points, %.1f m long, height +-%.1f m",
                size.access_points,
                size.length,
                height_sigma);
  Case one{name.data(), laboratory_room(size), size.length, 3.1};
  one.room.device.height_sigma = height_sigma;
  return one;
}

Case hall(const HallSize& size, double height_sigma) {
  std::array<char, 96> name{};
  std::snprintf(name.data(),
                name.size(),
                "hall of %.0f m2, %zu access points, %d MHz, height +-%.1f m",
                size.area,
                size.access_points,
                size.bandwidth_mhz,
                height_sigma);
  Case one{name.data(), hall_room(size), hall_length(size), 0.55 * hall_length(size)};
  one.room.device.height_sigma = height_sigma;
  return one;
}

// Milliseconds of CPU of all threads.
double cpu_ms(const std::function<void()>& call) {
  const std::clock_t begin = std::clock();
  call();
  return 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

// Megabytes that are allocated.
double allocated() {
  const auto info = mallinfo2();
  return 1e-6 * static_cast<double>(info.uordblks + info.hblkhd);
}

struct Cost {
  std::vector<double> ms;

  double at(double share) {
    std::sort(ms.begin(), ms.end());
    return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
  }
};

// The time of whitening a thousand cells [ms].
double thousand_cells(std::size_t dimension) {
  const ThousandCells cells(dimension);
  Cost cost;
  for (int repeat = 0; repeat < 5; ++repeat) {
    cost.ms.push_back(cpu_ms([&] {
      volatile float keep = cells.whiten_all();
      static_cast<void>(keep);
    }));
  }
  return cost.at(0.0);
}

// Up and down the middle of the room.
Vec3d place_at(double seconds, const Case& of) {
  const double distance = 0.7 * of.length;
  const double along = std::fmod(kSpeed * seconds, 2.0 * distance);
  return {0.15 * of.length + (along < distance ? along : 2.0 * distance - along), of.y, 1.2};
}

// The moments of a walk: [moment], frames of all access points.
std::vector<std::vector<CsiFrame>> walk(const Case& of, int bursts) {
  std::vector<std::vector<CsiFrame>> moments;
  for (int i = 0; i < bursts * kMoments; ++i) {
    const double seconds = 1e-3 * static_cast<double>(i * kMoment.count());
    moments.push_back(test::frames_at(
        of.room, place_at(seconds, of), {kFrames, 30.0, static_cast<unsigned>(i + 1)}));
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

void print_roof(const WorkDone& done, std::size_t bursts, double ms, const CoreLimits& limits) {
  const auto count = static_cast<double>(bursts);
  const double computing = 1e3 * done.flops / count / limits.flops;
  const double reading = 1e3 * done.bytes / count / limits.bytes;
  std::printf(
      "    of a tracked burst %.1f Mflop, %.2f ms at the peak; %.1f MB, %.2f ms from memory; "
      "it takes %.1f times the roof\n",
      1e-6 * done.flops / count,
      computing,
      1e-6 * done.bytes / count,
      reading,
      ms / std::max(computing, reading));
}

struct Amounts {
  int bursts = 20;
  int devices = 20;
};

void measure(const Case& of,
             const Amounts& amounts,
             const DeviceTrackerOptions& options,
             const CoreLimits& limits) {
  const auto [bursts, devices] = amounts;
  const auto room = std::make_shared<const RoomModel>(of.room);
  const double before = allocated();
  std::shared_ptr<const Localizer> localizer;
  const double start =
      cpu_ms([&] { localizer = std::make_shared<const Localizer>(*Localizer::create(room, {})); });
  const double made = allocated();
  const auto moments = walk(of, kSettling + bursts);
  const auto received = localizer->receive(moments.front());
  const double unit = thousand_cells(received.arrays.front().map->dimension());
  std::printf("%s, %d devices: %zu cells; a thousand whitened in %.2f ms\n",
              of.name.c_str(),
              devices,
              localizer->grid().size(),
              unit);
  const auto aps = static_cast<double>(room->access_points.size());
  const double others = allocated() - made;
  DeviceTracker tracker(localizer, options);
  std::vector<DeviceUpdate> updates;
  WorkDone done;
  Cost acquisition;
  Cost tracked;
  for (int burst = 0; burst < kSettling + bursts; ++burst) {
    for (int device = 0; device < devices; ++device) {
      const auto moment = [&](int i) {
        tracker.receive(
            address(device), moments[static_cast<std::size_t>(burst * kMoments + i)], updates);
      };
      const WorkDone so_far = WorkDone::of_this_thread();
      const double first = cpu_ms([&] { moment(0); });
      const double later = cpu_ms([&] {
        for (int i = 1; i < kMoments; ++i) {
          moment(i);
        }
      });
      if (burst == 0) {
        acquisition.ms.push_back(first);
      } else if (burst >= kSettling) {
        tracked.ms.push_back(first + later);
        done.flops += WorkDone::of_this_thread().flops - so_far.flops;
        done.bytes += WorkDone::of_this_thread().bytes - so_far.bytes;
      }
      updates.clear();
    }
  }
  const double grown = allocated() - others;
  Cost snapshot;
  for (std::size_t i = 0; devices == 1 && i + kMoments <= moments.size(); i += 4 * kMoments) {
    snapshot.ms.push_back(cpu_ms([&] { localizer->locate(moments[i]); }));
  }
  print("tracked", tracked, unit);
  print_roof(done, tracked.ms.size(), tracked.at(0.5), limits);
  print("acquisition", acquisition, unit);
  if (!snapshot.ms.empty()) {
    print("snapshot", snapshot, unit);
  }
  std::printf("    start %.2f s of CPU; maps of an access point %.1f MB, %.1f MB after the walk\n",
              1e-3 * start,
              (made - before) / aps,
              (grown - before) / aps);
  std::fflush(stdout);
}

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  using rayloc::bench::measure;
  rayloc::DeviceTrackerOptions options;
  if (argc > 2 && argv[1] == std::string_view("--tracks")) {
    const std::string_view tracks = argv[2];
    if (tracks != "grid" && tracks != "cloud") {
      std::fprintf(stderr, "--tracks is grid or cloud\n");
      return 64;
    }
    options.track.uses_cloud = tracks == "cloud";
    argc -= 2;
    argv += 2;
  }
  const rayloc::bench::Amounts amounts{argc > 1 ? std::atoi(argv[1]) : 20,
                                       argc > 2 ? std::atoi(argv[2]) : 20};
  const int only = argc > 3 ? std::atoi(argv[3]) : -1;
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const auto limits = rayloc::bench::core_limits();
  std::printf("a core: %.1f Gflop/s in single precision, %.1f GB/s from memory\n",
              1e-9 * limits.flops,
              1e-9 * limits.bytes);
  int number = 0;
  const auto run = [&](const auto& make, int count) {
    if (only < 0 || only == number) {
      const int bursts = std::max(1, amounts.bursts / count);
      measure(make(), {bursts, count}, options, limits);
    }
    ++number;
  };
  for (const double sigma : {0.0, 0.3}) {
    const auto laboratory = [&](int access_points, double length) {
      return [=] { return rayloc::bench::laboratory({3, access_points, length}, sigma); };
    };
    run(laboratory(1, 10.8), 1);
    run(laboratory(3, 10.8), 1);
    run(laboratory(1, 5.4), 1);
    run(laboratory(1, 10.8), amounts.devices);
  }
  for (const double sigma : {0.0, 0.3}) {
    const auto hall = [&](double area, std::size_t access_points, int bandwidth) {
      run([=] { return rayloc::bench::hall({area, access_points, bandwidth}, sigma); }, 1);
    };
    for (const double area : {10.0, 100.0, 1000.0}) {
      hall(area, 1, 40);
    }
    for (const std::size_t access_points : {3U, 10U}) {
      hall(100.0, access_points, 40);
    }
    for (const int bandwidth : {20, 80, 160}) {
      hall(100.0, 1, bandwidth);
    }
  }
  rayloc::bench::print_peak_memory();
  return 0;
}
