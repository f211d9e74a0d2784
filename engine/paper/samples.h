// The bursts for training and checking the paper's calibration, and the objects of a scene that
// their paths meet.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/trace/array_tracer.h"

namespace rayloc::paper {

inline constexpr std::size_t kMinSamples = 4;  // minimum points of an access point

// The burst that one access point received from the device at one point.
struct Sample {
  std::size_t point = 0;
  std::size_t access_point = 0;
  Vec3d position;                       // [m]
  std::vector<std::complex<double>> h;  // [antenna][tone], chain gains removed
};

struct Samples {
  std::vector<Sample> training;
  std::vector<Sample> held_out;
  std::vector<bool> met;  // of each object of the scene: a path of a training sample meets it
};

// Excludes samples with an antenna without a path in the given room. Errors, with the name of the
// access point: unknown gains, a single antenna, or fewer than kMinSamples usable points
// among those that it received. Access points without any samples are ignored, unless none has
// samples.
// REQUIRES: h of each point has an entry for each access point, empty or [rx_chain][tone].
Expected<Samples> gather_samples(const RoomModel& room,
                                 std::span<const CalibrationPoint> points,
                                 const TraceOptions& tracing);

// The device of the room at that point.
Transmitter device_of(const RoomModel& room, const Vec3d& position);

// Tracers of each access point with a sample.
std::vector<std::optional<ArrayTracer>> array_tracers(const RoomModel& room,
                                                      const PathTracer& tracer,
                                                      std::span<const Sample> samples);

// The squared normalised correlation of each sample with the expected array in `scene`, with hard
// edges (no softness), as in the localizer.
std::vector<double> correlations(const RoomModel& room,
                                 const std::shared_ptr<const Scene>& scene,
                                 std::span<const Sample> samples,
                                 int max_depth);

}  // namespace rayloc::paper
