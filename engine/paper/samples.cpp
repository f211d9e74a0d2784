#include "engine/paper/samples.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/parallel.h"
#include "engine/observe/alignment.h"

namespace rayloc::paper {
namespace {

using Value = std::complex<double>;

Expected<void> check_access_point(const RoomAccessPoint& ap) {
  if (ap.gains.empty()) {
    return bad_input("access point " + ap.id +
                     ": its chain gains are not known; the paper's method needs them fitted first");
  }
  if (ap.rx_chains.size() < 2) {
    return bad_input("access point " + ap.id +
                     ": it has one antenna; the paper's method compares neighbouring ones");
  }
  return {};
}

// Every burst of a point that an access point received.
Expected<std::vector<Sample>> received(const RoomModel& room,
                                       std::span<const CalibrationPoint> points) {
  std::vector<Sample> samples;
  for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
    const RoomAccessPoint& access_point = room.access_points[ap];
    for (std::size_t i = 0; i < points.size(); ++i) {
      RAYLOC_CHECK(points[i].h.size() == room.access_points.size());
      const std::vector<Value>& h = points[i].h[ap];
      if (h.empty()) {
        continue;
      }
      RAYLOC_TRY(check_access_point(access_point));
      RAYLOC_CHECK(h.size() == access_point.rx_chains.size() * room.grid.size());
      std::vector<Value> field = h;
      remove_gains(access_point.gains, field);
      samples.push_back({i, ap, points[i].position, std::move(field)});
    }
  }
  if (samples.empty()) {
    return bad_input("no access point received the device at any calibration point");
  }
  return samples;
}

Expected<void> check_counts(const RoomModel& room,
                            const std::vector<Sample>& all,
                            const std::vector<Sample>& training) {
  const auto count = [](const std::vector<Sample>& samples, std::size_t ap) {
    return static_cast<std::size_t>(std::count_if(
        samples.begin(), samples.end(), [&](const auto& s) { return s.access_point == ap; }));
  };
  for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
    const std::size_t usable = count(training, ap);
    if (count(all, ap) > 0 && usable < kMinSamples) {
      return bad_input("access point " + room.access_points[ap].id + ": " + std::to_string(usable) +
                       " calibration points can be used, at least " + std::to_string(kMinSamples) +
                       " are needed");
    }
  }
  return {};
}

}  // namespace

Transmitter device_of(const RoomModel& room, const Vec3d& position) {
  return Transmitter{{position, {}, room.device.pattern, room.device.polarization}};
}

std::vector<std::optional<ArrayTracer>> array_tracers(const RoomModel& room,
                                                      const PathTracer& tracer,
                                                      std::span<const Sample> samples) {
  std::vector<std::optional<ArrayTracer>> result(room.access_points.size());
  for (const Sample& sample : samples) {
    if (!result[sample.access_point]) {
      result[sample.access_point].emplace(tracer, room.access_points[sample.access_point].array);
    }
  }
  return result;
}

Expected<Samples> gather_samples(const RoomModel& room,
                                 std::span<const CalibrationPoint> points,
                                 const TraceOptions& tracing) {
  auto all = received(room, points);
  RAYLOC_TRY(all);
  const auto tracers = array_tracers(room, PathTracer(room.scene, tracing), *all);
  std::vector<std::vector<Paths>> paths(all->size());
  parallel_for(all->size(), 4, [&](std::size_t i) {
    const Sample& sample = (*all)[i];
    paths[i] = tracers[sample.access_point]->trace(device_of(room, sample.position));
  });
  Samples result;
  result.met.resize(room.scene->objects().size());
  for (std::size_t i = 0; i < all->size(); ++i) {
    const Sample& sample = (*all)[i];
    if (std::any_of(paths[i].begin(), paths[i].end(), [](const Paths& p) { return p.empty(); })) {
      continue;
    }
    const bool held_out = points[sample.point].held_out;
    (held_out ? result.held_out : result.training).push_back(sample);
    for (const Paths& of_antenna : paths[i]) {
      for (const Path& path : of_antenna) {
        for (const Interaction& interaction : path.interactions) {
          result.met[interaction.object] = result.met[interaction.object] || !held_out;
        }
      }
    }
  }
  RAYLOC_TRY(check_counts(room, *all, result.training));
  return result;
}

std::vector<double> correlations(const RoomModel& room,
                                 const std::shared_ptr<const Scene>& scene,
                                 std::span<const Sample> samples,
                                 int max_depth) {
  const auto tracers = array_tracers(room, PathTracer(scene, {.max_depth = max_depth}), samples);
  const Aligner aligner(room.grid);
  std::vector<double> result(samples.size());
  parallel_for(samples.size(), 4, [&](std::size_t i) {
    const Sample& sample = samples[i];
    const auto paths = tracers[sample.access_point]->trace(device_of(room, sample.position));
    result[i] = aligner.align(array_csi(paths, room.grid), sample.h).correlation;
  });
  return result;
}

}  // namespace rayloc::paper
