// The bursts that the paper's calibration learns from and is checked on, and what of a scene their
// paths meet.
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

namespace rayloc {

inline constexpr std::size_t kLeastPaperSamples = 4;  // points of an access point

// What one access point heard of the device on one point.
struct PaperSample {
  std::size_t point = 0;
  std::size_t access_point = 0;
  Vec3d position;                       // [m]
  std::vector<std::complex<double>> h;  // [antenna][tone], chain gains removed
};

struct PaperSamples {
  std::vector<PaperSample> training;
  std::vector<PaperSample> held_out;
  std::vector<bool> met;  // of each object of the scene: a path of a training sample meets it
};

// Samples of which some antenna has no path in the room as given are left out. An Error that names
// the access point when its gains are not known, when it has a single antenna, or when
// fewer than kLeastPaperSamples of the points that it heard can be learned from; access points that
// heard nothing at all are left as they are, unless none heard anything.
// REQUIRES: of each point h has an entry for each access point, empty or [core][tone].
Expected<PaperSamples> gather_paper_samples(const RoomModel& room,
                                            std::span<const CalibrationPoint> points,
                                            const TraceOptions& tracing);

// The device of the room on that point.
Transmitter device_of(const RoomModel& room, const Vec3d& position);

// Of each access point that has a sample.
std::vector<std::optional<ArrayTracer>> array_tracers(const RoomModel& room,
                                                      const PathTracer& tracer,
                                                      std::span<const PaperSample> samples);

// The squared normalised correlation of each sample with what is expected in `scene`, with edges
// as they are (no softness), as the localizer takes them.
std::vector<double> correlations(const RoomModel& room,
                                 const std::shared_ptr<const Scene>& scene,
                                 std::span<const PaperSample> samples,
                                 int max_depth);

}  // namespace rayloc
